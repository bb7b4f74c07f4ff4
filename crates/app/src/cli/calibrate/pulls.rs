//! `cohaul calibrate pulls`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::super::choice::positive;
use super::super::console::{self, Tone};
use super::super::error::CliError;
use super::super::input::{name_of, read_text};
use super::super::output::{OutputArgs, measured_manifest};
use cohaul_paper::calibrate::files::write_result;
use cohaul_paper::calibrate::text::pulls_text;
use cohaul_paper::calibrate::{PullSeries, block_duration, compare_pulls};
use cohaul_report::json;
use cohaul_report::quantity::quantity;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul calibrate forces camera.csv --scenario ants.json --out out/measured
  cohaul calibrate forces out/run --out out/simulated
  cohaul calibrate pulls out/measured --against out/simulated --block-s 20

Columns of the tables: time_s and force_n, as in forces.csv of `calibrate
forces`. Pulls of one block depend on each other: a block should last longer
than the load keeps its pose. Files in DIR: pulls.json and manifest.")]
pub struct PullsArgs {
    /// Tables of pulls (CSV), or output folders of `calibrate forces`: one sample
    #[arg(required = true, num_args = 1..)]
    forces: Vec<PathBuf>,
    /// Tables of the other sample
    #[arg(long, required = true, num_args = 1.., value_name = "FORCES")]
    against: Vec<PathBuf>,
    /// Duration of a block (s) [default: a whole table, or a tenth of one if
    /// there are too few]
    #[arg(long, value_name = "S", value_parser = positive)]
    block_s: Option<f64>,
    /// Number of permutations of the blocks
    #[arg(long, value_name = "N", default_value = "9999", value_parser = clap::value_parser!(u32).range(99..=1_000_000))]
    permutations: u32,
    /// Seed of the permutations
    #[arg(long, value_name = "N", default_value = "1")]
    seed: u64,
    #[command(flatten)]
    output: OutputArgs,
}

/// Correlation of neighbouring blocks above which they are too short.
const CORRELATED: f64 = 0.3;

pub fn pulls(args: &PullsArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    args.output.check()?;
    let mut texts = String::new();
    let mut read =
        |paths: &[PathBuf]| -> Result<Vec<PullSeries>, CliError> { paths.iter().map(|path| series_of(path, &mut texts)).collect() };
    let (one, other) = (read(&args.forces)?, read(&args.against)?);
    let block_s = args.block_s.or_else(|| block_duration([&one, &other]));
    if let (None, Some(duration)) = (args.block_s, block_s) {
        let duration = quantity(duration, "s");
        console::note(format_args!("the tables are cut into blocks of {duration}; --block-s sets another duration"));
    }
    let cut = |paths: &[PathBuf], series: &[PullSeries]| -> Result<Vec<Vec<Vec<f64>>>, CliError> {
        let all = paths.iter().zip(series);
        all.map(|(path, series)| series.blocks(block_s).map_err(|rule| CliError::Usage(format!("--block-s: {}: {rule}", name_of(path)))))
            .collect()
    };
    let (one, other) = (cut(&args.forces, &one)?, cut(&args.against, &other)?);
    let found = compare_pulls([&one, &other], args.permutations, args.seed).map_err(|rule| CliError::Usage(format!("blocks: {rule}")))?;
    json::check(&found)?;
    if let Some(out) = &args.output.out {
        let options = json!({
            "forces": args.forces,
            "against": args.against,
            "block_s": block_s,
            "permutations": args.permutations,
            "seed": args.seed
        });
        let manifest = measured_manifest("calibrate pulls", ("tables of pulls", &texts), &options, started);
        write_result(out, "pulls.json", &found, &manifest)?;
    }
    args.output.print(&found, || pulls_text(&found), Tone::Good)?;
    if found.block_correlation.is_some_and(|correlation| correlation > CORRELATED) {
        console::warn("neighbouring blocks are correlated: with longer blocks, the p-value may be larger");
    }
    Ok(ExitCode::SUCCESS)
}

/// The pulls of one table, whose text is added to `texts`.
fn series_of(path: &Path, texts: &mut String) -> Result<PullSeries, CliError> {
    let file = if path.is_dir() { path.join("forces.csv") } else { path.to_owned() };
    let text = read_text(&file)?;
    let series = PullSeries::parse(&text, &name_of(&file))?;
    texts.push_str(&text);
    Ok(series)
}
