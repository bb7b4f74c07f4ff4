//! A path that was recorded elsewhere, by a camera or another program, beside those of a run on
//! each backend.

use serde::Serialize;

use crate::csv_input;
use cohaul::analysis::compare::{Pathwise, Solution};
use cohaul::backend::{EnergyLedger, Motion};
use cohaul::math::{Pose, Twist};
use cohaul::scenario::ScenarioError;
use cohaul::simulation::{AttachedTips, Row, Trace};
use cohaul_report::chart::difference::over_time;
use cohaul_report::chart::{self, Labelled, Scene};
use cohaul_report::page::Block;
use cohaul_report::quantity::of_run::short_quantity;
use cohaul_report::table::Table;

/// Columns of a path; others are passed over, so that `trace.csv` is one.
const COLUMNS: [&str; 4] = ["time_s", "x_m", "y_m", "heading_rad"];

/// A recorded path and its differences from the path of each backend.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Beside {
    pub file: String,
    /// Number of recorded instants (1).
    pub n: usize,
    /// Difference from the path of each backend.
    pub differences: Vec<FromRecorded>,
    /// The recorded path; it has poses only.
    #[serde(skip)]
    pub trace: Trace,
}

/// Difference of the path of a backend from a recorded one, at the recorded instants.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FromRecorded {
    pub backend: String,
    /// Number of recorded instants within the run (1).
    pub n: usize,
    /// Largest distance (m).
    pub position_max_m: f64,
    /// Distance at the last of these instants (m).
    pub position_final_m: f64,
    /// Root mean square of the distances (m).
    pub position_rms_m: f64,
    /// Largest difference of headings (rad).
    pub heading_max_rad: f64,
}

/// The path in the table `text` of the file `name`.
///
/// # Errors
/// When the table is no path over increasing times.
pub fn recorded_path(text: &str, name: &str) -> Result<Trace, ScenarioError> {
    let mut table = csv_input::Table::parse(text, name, &[])?;
    table.require(&COLUMNS);
    let mut table = table.whole()?;
    let mut rows: Vec<Row> = Vec::with_capacity(table.n_rows());
    for row in 0..table.n_rows() {
        let [Some(time), Some(x), Some(y), Some(heading)] = COLUMNS.map(|column| table.number(row, column)) else { continue };
        if rows.last().is_some_and(|last| time <= last.time) {
            table.at(row, COLUMNS[0], "must be later than in the row before", time);
        }
        let motion = Motion { pose: Pose::new(x, y, heading), twist: Twist::ZERO };
        let energy = EnergyLedger::default();
        rows.push(Row { time, motion, energy, tips: AttachedTips::new(), contacts: Vec::new(), steered: Vec::new(), error: None });
    }
    if table.n_rows() == 0 {
        table.report("rows", "must hold poses", "none");
    }
    table.whole()?;
    Ok(Trace { rows, ..Trace::default() })
}

impl Beside {
    /// A recorded path beside those of a comparison.
    ///
    /// # Errors
    /// When no recorded instant lies within the runs.
    pub fn new(file: &str, trace: Trace, found: &Pathwise) -> Result<Self, String> {
        let of = |(name, solution): (&str, &Solution)| from_recorded(name, &trace, &solution.trace);
        let Some(differences) = found.named_runs().map(of).collect() else {
            let times = trace.rows.first().zip(trace.rows.last()).map_or([0.0; 2], |(first, last)| [first.time, last.time]);
            return Err(format!("{file}: must have a time within the runs, found {} to {} s", times[0], times[1]));
        };
        Ok(Self { file: file.to_owned(), n: trace.rows.len(), differences, trace })
    }

    /// Label and value of a line for each backend.
    pub fn lines(&self) -> Vec<(String, String)> {
        let line = |(at, of): (usize, &FromRecorded)| {
            let [largest, last] = [of.position_max_m, of.position_final_m].map(|value| short_quantity(value, "m"));
            let heading = short_quantity(of.heading_max_rad, "rad");
            let label = if at == 0 { "recorded path" } else { "" };
            (label.to_owned(), format!("from {}: at most {largest} and {heading}, at the end {last}", of.backend))
        };
        self.differences.iter().enumerate().map(line).collect()
    }

    /// The section of a report: the four paths, and the differences from the recorded one.
    pub fn section(&self, found: &Pathwise, scene: &Scene) -> Vec<Block> {
        let columns = ["backend", "instants", "largest distance", "root mean square", "at the end", "largest difference of headings"];
        let mut table = Table::new(format!("Differences from the path in {}", self.file), columns);
        for of in &self.differences {
            let metres = [of.position_max_m, of.position_rms_m, of.position_final_m].map(|value| short_quantity(value, "m"));
            let cells = [of.backend.clone(), of.n.to_string()].into_iter().chain(metres);
            table.push(cells.chain([short_quantity(of.heading_max_rad, "rad")]));
        }
        let runs = Labelled::compared(found.engine.after_exact(), found.solutions.iter().map(|solution| &solution.trace));
        let all: Vec<Labelled> = [Labelled { label: "recorded", trace: &self.trace }].into_iter().chain(runs).collect();
        let apart = "Edge displacement of each path from the recorded one over time, and the tolerance.";
        vec![
            Block::Table(table),
            Block::figure(chart::path(&all, scene), "The recorded path and those of the three runs."),
            Block::figure(chart::edge_difference(&all, scene), apart),
        ]
    }
}

fn from_recorded(backend: &str, recorded: &Trace, run: &Trace) -> Option<FromRecorded> {
    let differences = over_time(recorded, run);
    let largest = |of: fn(&chart::difference::Difference) -> f64| differences.iter().map(of).fold(0.0, f64::max);
    let squares: f64 = differences.iter().map(|at| at.position * at.position).sum();
    Some(FromRecorded {
        backend: backend.to_owned(),
        n: differences.len(),
        position_max_m: largest(|at| at.position),
        position_final_m: differences.last()?.position,
        position_rms_m: (squares / differences.len() as f64).sqrt(),
        heading_max_rad: largest(|at| at.heading),
    })
}
