//! Summary of a sweep: the object that `sweep --json` and `merge --json` print, and its text.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::sweep::{Distribution, Group, Identity};
use cohaul::formats::{self, Format, Versioned};
use cohaul::math::Interval;
use cohaul::simulation::Health;
use cohaul_report::quantity::quantity;
use cohaul_report::table::{Layout, wrapped};
use cohaul_report::text::{Detail, WIDTH};

/// Summary of a sweep. All but the cost follows from the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepSummary {
    pub scenario: String,
    pub n_runs: u64,
    pub n_points: u64,
    pub n_seeds: u64,
    pub first_seed: u64,
    pub parameters: Vec<String>,
    /// Number of runs by how they ended.
    pub statuses: BTreeMap<String, u64>,
    /// The first runs that failed.
    pub failures: Vec<Failure>,
    pub n_groups: u64,
    /// Runs that differ by their seed alone, together; `null` where there are too many:
    /// `groups.csv` has them all.
    pub groups: Option<Vec<Group>>,
    /// Only of a sweep that ran: a merge has run nothing.
    pub cost: Option<Cost>,
}

impl Versioned for SweepSummary {
    const FORMAT: Format = formats::SWEEP;
}

/// What the runs of the last call took; those of an earlier one that was stopped are not counted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// (s)
    pub wall_s: f64,
    /// Of all threads (s).
    pub cpu_s: f64,
    pub n_threads: usize,
    /// Number of runs that took it.
    #[serde(default)]
    pub n_runs: u64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    pub cell: u64,
    pub cause: String,
}

/// Status of a run that failed; see [`cohaul::simulation::rules`].
pub const FAILED: &str = "failed";
/// Status of a run that is doubtful.
pub const DOUBTFUL: &str = "doubtful";
/// Status of a run under error control whose estimated error is too large.
pub const NOT_WITHIN_TOLERANCE: &str = "not-within-tolerance";

/// How many groups a summary holds.
pub const MOST_GROUPS: usize = 1000;
/// How many failures are named.
pub const MOST_FAILURES: usize = 10;
/// How many groups the text shows.
const MOST_SHOWN: usize = 40;

impl SweepSummary {
    /// Summary of a table without rows.
    pub fn new(identity: &Identity, name: &str, cost: Option<Cost>) -> Self {
        Self {
            scenario: name.to_owned(),
            n_runs: 0,
            n_points: identity.design.n_points(),
            n_seeds: identity.n_seeds,
            first_seed: identity.first_seed,
            parameters: identity.parameters().iter().map(|column| column.name.clone()).collect(),
            statuses: BTreeMap::new(),
            failures: Vec::new(),
            n_groups: 0,
            groups: Some(Vec::new()),
            cost,
        }
    }

    pub fn add_group(&mut self, group: Group) {
        self.n_groups += 1;
        match &mut self.groups {
            Some(groups) if groups.len() < MOST_GROUPS => groups.push(group),
            groups => *groups = None,
        }
    }

    /// Of a run's status, see [`FAILED`], [`DOUBTFUL`] and [`NOT_WITHIN_TOLERANCE`].
    pub fn n_of(&self, status: &str) -> u64 {
        self.statuses.get(status).copied().unwrap_or(0)
    }

    /// Account of the worst run.
    pub fn worst(&self) -> Health {
        match () {
            () if self.n_of(FAILED) + self.n_of(NOT_WITHIN_TOLERANCE) > 0 => Health::Failed,
            () if self.n_of(DOUBTFUL) > 0 => Health::Doubtful,
            () => Health::Ok,
        }
    }

    /// Warnings about runs whose numbers are less accurate than asked for.
    pub fn warnings(&self) -> Vec<String> {
        let kinds = [(DOUBTFUL, "are doubtful"), (NOT_WITHIN_TOLERANCE, "exceed their tolerance at the finest macro-steps")];
        let found = kinds.iter().map(|(status, what)| (self.n_of(status), what)).filter(|(n, _)| *n > 0);
        found.map(|(n, what)| format!("{n} of {} runs {what}; they are included in the means", self.n_runs)).collect()
    }

    /// Time that the runs of the last call took; `None` when it had none left.
    pub fn took(&self) -> Option<String> {
        let Cost { wall_s, n_threads, n_runs, .. } = self.cost.filter(|cost| cost.n_runs > 0)?;
        let last = if n_runs < self.n_runs { format!("the last {n_runs} in ") } else { String::new() };
        Some(format!("{last}{} on {n_threads} thread{}", quantity(wall_s, "s"), if n_threads == 1 { "" } else { "s" }))
    }
}

/// A row for each group, then how runs ended.
pub fn sweep_text(found: &SweepSummary, detail: Detail) -> String {
    let mut text = String::new();
    let mut say = |line: &str| text += &format!("{}\n", wrapped(line, 2, WIDTH - 2));
    let groups = found.groups.as_deref().unwrap_or_default();
    let table = group_table(found, &groups[..groups.len().min(MOST_SHOWN)], detail);
    if ["+-", " ("].iter().any(|mark| table.contains(mark)) {
        say("(in brackets and after +-: intervals at 95 %)");
    }
    if groups.len() > MOST_SHOWN || found.groups.is_none() {
        say(&format!("... {} groups in all: see groups.csv", found.n_groups));
    }
    for Failure { cell, cause } in &found.failures {
        say(&format!("failed: cell {cell}: {cause}"));
    }
    let statuses: Vec<String> = found.statuses.iter().map(|(status, n)| format!("{n} {status}")).collect();
    let took = found.took().map_or_else(String::new, |took| format!("; {took}"));
    say(&format!("{} runs of {}: {}{took}", found.n_runs, found.scenario, statuses.join(", ")));
    table + &text
}

/// Most parameters that have a column of their own.
const MOST_KEYS: usize = 3;
/// Columns that are printed with `--verbose` only.
const RARE: [&str; 1] = ["pull, sd"];

/// The groups as a table that fits a terminal. Quantities that no group has are left out.
fn group_table(found: &SweepSummary, groups: &[Group], detail: Detail) -> String {
    let mut rows = group_rows(found, groups);
    let n_keys = rows[0].iter().position(|name| name == RUNS).expect("there is such a column");
    let is_empty = |at: usize| rows[1..].iter().all(|row| row[at] == NONE);
    let is_rare = |at: usize| detail == Detail::Brief && RARE.contains(&rows[0][at].as_str());
    let is_shown: Vec<bool> = (0..rows[0].len()).map(|at| at < n_keys || !(is_empty(at) || is_rare(at))).collect();
    for row in &mut rows {
        let mut at = is_shown.iter();
        row.retain(|_| at.next().is_some_and(|is_shown| *is_shown));
    }
    let n_parameters = found.parameters.len();
    if n_parameters <= MOST_KEYS {
        return Layout { rows, has_head: true, n_keys, ..Layout::default() }.text();
    }
    let rows = with_one_key(&rows, n_parameters);
    Layout { rows, has_head: true, n_keys: n_keys + 1 - n_parameters, ..Layout::default() }.text()
}

/// The rows with their first `n` columns in one, which names each value.
fn with_one_key(rows: &[Vec<String>], n: usize) -> Vec<Vec<String>> {
    let key =
        |row: &Vec<String>| rows[0][..n].iter().zip(row).map(|(name, value)| format!("{name} {value}")).collect::<Vec<_>>().join(", ");
    let keys = std::iter::once("point".to_owned()).chain(rows[1..].iter().map(key));
    keys.zip(rows).map(|(key, row)| std::iter::once(key).chain(row[n..].iter().cloned()).collect()).collect()
}

/// Name of the column of numbers of runs, the first after those that say what a group is of.
const RUNS: &str = "runs";
/// Field of a quantity that a group has not.
const NONE: &str = "-";

/// Names of the columns, then a row a group. Steps have a column where a backend has several.
pub(crate) fn group_rows(found: &SweepSummary, groups: &[Group]) -> Vec<Vec<String>> {
    let n_different = groups.iter().map(|group| (group.point, &group.backend)).collect::<BTreeSet<_>>().len();
    let steps = (n_different < groups.len()).then_some("step");
    let measured = [RUNS, "arrived", "their time to nest", "pull, mean", "pull, sd", "speed"];
    let head: Vec<&str> = found.parameters.iter().map(String::as_str).chain(["backend"]).chain(steps).chain(measured).collect();
    let head = head.into_iter().map(str::to_owned).collect();
    let mut rows: Vec<Vec<String>> = std::iter::once(head).chain(groups.iter().map(|group| line(group, steps.is_some()))).collect();
    for at in 0..found.parameters.len() {
        let values: Vec<String> = rows[1..].iter().map(|row| row[at].clone()).collect();
        rows[1..].iter_mut().zip(shortened(&values)).for_each(|(row, text)| row[at] = text);
    }
    rows
}

/// Numbers with the fewest digits, from four on, with which different ones stay different; what has
/// no more digits than that, and words, as they are.
fn shortened(values: &[String]) -> Vec<String> {
    let with = |digits: usize| -> Vec<String> {
        let short = |text: &String| {
            let rounded = text.parse().ok().and_then(|value: f64| format!("{value:.*e}", digits - 1).parse::<f64>().ok());
            rounded.map(|value| serde_json::json!(value).to_string()).filter(|short| short.len() < text.len())
        };
        values.iter().map(|text| short(text).unwrap_or_else(|| text.clone())).collect()
    };
    let n_different = |texts: &[String]| texts.iter().collect::<BTreeSet<_>>().len();
    let n_values = n_different(values);
    (4..17).map(with).find(|texts| n_different(texts) == n_values).unwrap_or_else(|| values.to_vec())
}

fn line(group: &Group, with_step: bool) -> Vec<String> {
    let arrived = match (group.arrival_share, group.arrival_interval_95) {
        (Some(share), Some(Interval { low, high })) => format!("{:.1} % ({:.1} to {:.1})", 100.0 * share, 100.0 * low, 100.0 * high),
        _ => NONE.to_owned(),
    };
    let mean = |name: &str, unit: &str| mean_text(group.measure(name), unit);
    let measures = [mean("time_to_nest_s", "s"), mean("pull_mean_n", "N"), mean("pull_sd_n", "N"), mean("mean_speed_m_per_s", "m/s")];
    let step = with_step.then(|| group.step_s.map_or("-".to_owned(), |step| quantity(step, "s")));
    let head = group.parameters.iter().cloned().chain([group.backend.clone()]).chain(step);
    head.chain([group.n.to_string(), arrived]).chain(measures).collect()
}

/// Mean and half of its 95 % interval.
fn mean_text(distribution: &Distribution, unit: &str) -> String {
    match (distribution.mean, distribution.mean_interval_95) {
        (Some(mean), Some(Interval { low, high })) => format!("{} +- {}", quantity(mean, unit), quantity(0.5 * (high - low), unit)),
        (Some(mean), None) => quantity(mean, unit),
        _ => NONE.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_told_with_as_many_digits_as_tell_them_apart() {
        for (values, told) in [
            (["0.0017782794100389228", "0.0031622776601683794", "10.0"], ["0.001778", "0.003162", "10.0"]),
            (["0.10000400000000001", "0.1000041", "0.2"], ["0.100004", "0.1000041", "0.2"]),
            (["1.0", "1.0000000000000002", "1.0"], ["1.0", "1.0000000000000002", "1.0"]),
            (["hazard", "12345678", "1e-300"], ["hazard", "12345678", "1e-300"]),
        ] {
            assert_eq!(shortened(&values.map(str::to_owned)), told);
        }
    }
}
