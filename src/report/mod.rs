//! Floor 5: what people and programs read of a run: JSON, tables, figures, an output folder and a progress bar.
//!
//! Everything here takes results that exist and moves nothing. Numbers leave for programs in SI units with all their digits (JSON, CSV), for
//! people with four digits and SI prefixes (text, figures). A number that is not finite never leaves silently: JSON and CSV refuse it by name.
//!
//! ```text
//! json.rs      RunSummary: the object that `run --json` prints
//! lines.rs     lines of numbers, fast
//! table.rs     trace.csv, events.csv and transitions.csv
//! manifest.rs  where a result comes from: scenario, seed, versions, machine, command
//! folder.rs    an output folder that is there whole or not at all; sibling.rs the hidden one beside it that becomes it
//! run.rs       the files of one run, put into such a folder
//! figure/      SVG figures over one or several traces
//! html/        reports as one HTML file each, with a replay
//! quantity.rs  a number with its unit, for people
//! comparison.rs  a comparison: JSON, text and files
//! check.rs     a check against baselines: JSON, text and files
//! stress.rs    stress maps: JSON, text and files; stress_map.rs draws one as a heat map
//! regime.rs    the regime map: JSON, text and files; regime_map.rs its figures, of panels of regime_plane.rs; regime_page.rs its page
//! text.rs      a run summary as a text table
//! paper.rs     the paper's results: JSON; paper_why.rs the reasons, paper_text.rs as text, paper_files.rs its files, paper_readme.rs the page beside them
//! verification.rs  a verification: JSON, text and files
//! calibration.rs  a calibration, a design, forces on tips: JSON and files; calibration_text.rs as text
//! tips.rs      tips.csv
//! bench.rs     a benchmark: JSON; bench_text.rs as text, bench_files.rs its files
//! sweep.rs    a sweep: JSON and text; sweep_files.rs its files, sweep_parquet.rs its table as Parquet
//! progress.rs  a progress bar on standard error
//! ```

mod bench;
mod bench_files;
mod bench_text;
mod calibration;
mod calibration_text;
mod check;
mod comparison;
pub mod figure;
mod folder;
pub mod html;
mod json;
mod lines;
mod manifest;
mod paper;
mod paper_files;
mod paper_readme;
mod paper_text;
mod paper_why;
mod progress;
mod quantity;
mod regime;
mod regime_map;
mod regime_page;
mod regime_plane;
mod run;
mod sibling;
mod stress;
mod stress_map;
mod sweep;
mod sweep_files;
#[cfg(feature = "parquet")]
mod sweep_parquet;
pub mod table;
mod text;
mod tips;
mod verification;

#[cfg(test)]
pub(crate) mod synthetic;

pub use bench::{BenchLine, Benchmark, FitLine, GrowthLine, Noise, SolverLine};
pub use bench_files::write_benchmark;
pub use bench_text::bench_text;
pub use calibration::{DesignReport, FORCE_COLUMNS, ForcesReport, fit_json, write_calibration, write_design, write_tip_forces};
pub use calibration_text::fit_text;
pub use check::{CheckReport, check_text, this_build, write_check};
pub use comparison::{Comparison, Tiers, compare_text, write_comparison};
pub use folder::{FolderError, MANIFEST, OutputFile, OutputFolder, check_files, check_target};
pub use json::{
    Accuracy, AntSummary, DefectSummary, EnergySummary, FinalState, NotFinite, PullForce, RunSummary, StepSummary, TransitionSummary,
    finite,
};
pub use manifest::{Libraries, Machine, Manifest, sha256_hex};
pub use paper::{FitRow, Paper, Runs as PaperRuns, SetLine, TableRow, TransitionRow, largest};
pub use paper_files::write_paper;
pub use paper_text::paper_text;
pub use progress::Progress;
pub use quantity::{number, quantity};
pub use regime::{CellLine, MapLine, Regime, RuleLine, is_sound_by_rule, regime_text, write_regime};
pub use run::{RunFiles, RunWriter};
pub use stress::{Stress, stress_list, stress_text, write_stress};
pub use sweep::{Cost, FAILED, Failure, NOT_CONVERGED, NOT_WITHIN_TOLERANCE, SweepSummary, sweep_text};
pub use sweep_files::write_sweep;
pub use text::{convergence_warning, inertia_warning, run_text};
pub use tips::{TIP_COLUMNS, write_tips};
pub use verification::{Line, Question, Verification, list_text, verify_text, write_verification};
