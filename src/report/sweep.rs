//! A sweep: what `sweep --json` and `merge --json` print, and the same as text.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::{Deserialize, Serialize};

use super::quantity;
use crate::math::Interval;
use crate::sweep::{Distribution, Group, Identity};

/// What a sweep amounts to. Only the cost is not of the table alone.
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
    /// Runs that differ by their seed alone, together; `null` where there are too many: `groups.csv` has them all.
    pub groups: Option<Vec<Group>>,
    /// Only of a sweep that ran: a merge has run nothing.
    pub cost: Option<Cost>,
}

/// What the runs of the last call took; those of an earlier one that was stopped are not counted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// (s)
    pub wall_s: f64,
    /// Of all threads (s).
    pub cpu_s: f64,
    pub n_threads: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    pub cell: u64,
    pub cause: String,
}

/// How many groups a summary holds.
pub const MOST_GROUPS: usize = 1000;
/// How many failures are named.
pub const MOST_FAILURES: usize = 10;
/// How many groups the text shows.
const MOST_SHOWN: usize = 40;

impl SweepSummary {
    /// Of a table without rows so far.
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

    pub fn n_failed(&self) -> u64 {
        self.statuses.get("failed").copied().unwrap_or(0)
    }

    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a summary is plain data");
        text.push('\n');
        text
    }
}

/// A line a group, then how runs ended.
pub fn sweep_text(found: &SweepSummary) -> String {
    let mut text = String::new();
    let groups = found.groups.as_deref().unwrap_or_default();
    text.push_str(&table(found, &groups[..groups.len().min(MOST_SHOWN)]));
    writeln!(text, "(in brackets and after +-: intervals at 95 %)").expect("a string takes all");
    if groups.len() > MOST_SHOWN || found.groups.is_none() {
        writeln!(text, "... {} groups in all: see groups.csv", found.n_groups).expect("a string takes all");
    }
    for Failure { cell, cause } in &found.failures {
        writeln!(text, "failed: cell {cell}: {cause}").expect("a string takes all");
    }
    let statuses: Vec<String> = found.statuses.iter().map(|(status, n)| format!("{n} {status}")).collect();
    let took = found.cost.map_or_else(String::new, |Cost { wall_s, n_threads, .. }| {
        format!("; {} on {n_threads} thread{}", quantity(wall_s, "s"), if n_threads == 1 { "" } else { "s" })
    });
    writeln!(text, "{} runs of {}: {}{took}", found.n_runs, found.scenario, statuses.join(", ")).expect("a string takes all");
    text
}

/// Names of the columns, then a row a group.
pub(super) fn group_rows(found: &SweepSummary, groups: &[Group]) -> Vec<Vec<String>> {
    let measured = ["backend", "runs", "arrived", "their time to nest", "pull, mean", "pull, sd", "speed"];
    let head: Vec<String> = found.parameters.iter().map(String::as_str).chain(measured).map(str::to_owned).collect();
    std::iter::once(head).chain(groups.iter().map(line)).collect()
}

fn table(found: &SweepSummary, groups: &[Group]) -> String {
    let rows = group_rows(found, groups);
    let width = |at: usize| rows.iter().map(|row| row[at].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows[0].len()).map(width).collect();
    let padded = |row: &Vec<String>| {
        let cells: Vec<String> = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        format!("{}\n", cells.join("  ").trim_end())
    };
    rows.iter().map(padded).collect()
}

fn line(group: &Group) -> Vec<String> {
    let arrived = match (group.arrival_share, group.arrival_interval_95) {
        (Some(share), Some(Interval { low, high })) => format!("{:.1} % ({:.1} to {:.1})", 100.0 * share, 100.0 * low, 100.0 * high),
        _ => "-".to_owned(),
    };
    let mean = |name: &str, unit: &str| mean_text(group.measure(name), unit);
    let measures = [mean("time_to_nest_s", "s"), mean("pull_mean_n", "N"), mean("pull_sd_n", "N"), mean("mean_speed_m_per_s", "m/s")];
    group.parameters.iter().cloned().chain([group.backend.clone(), group.n.to_string(), arrived]).chain(measures).collect()
}

/// Mean and half of its 95 % interval.
fn mean_text(distribution: &Distribution, unit: &str) -> String {
    match (distribution.mean, distribution.mean_interval_95) {
        (Some(mean), Some(Interval { low, high })) => format!("{} +- {}", quantity(mean, unit), quantity(0.5 * (high - low), unit)),
        (Some(mean), None) => quantity(mean, unit),
        _ => "-".to_owned(),
    }
}
