//! Means over the seeds of one point and method. Such rows follow each other, so that a table of
//! any length needs memory for one group only.

use serde::{Deserialize, Serialize};

use super::column::{BEFORE, fields_of, text_of};
use super::error::SweepError;
use super::plan::Identity;
use cohaul::math::{Interval, Summary, proportion_interval};
use cohaul_report::table::Field;

/// Columns whose means a group has.
pub const MEASURES: [&str; 7] =
    ["time_to_nest_s", "mean_speed_m_per_s", "path_length_m", "pull_mean_n", "pull_sd_n", "n_pulls", "defect_j"];

/// Mean, spread and interval of the mean of one measure over the `n` runs that have it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distribution {
    pub n: u64,
    /// `null` without runs.
    pub mean: Option<f64>,
    /// `null` below two runs.
    pub sd: Option<f64>,
    /// `null` below two runs.
    pub mean_interval_95: Option<Interval>,
}

impl Distribution {
    pub fn of(summary: &Summary) -> Self {
        let n = summary.n();
        Self { n, mean: (n > 0).then(|| summary.mean()), sd: (n > 1).then(|| summary.sd()), mean_interval_95: summary.mean_interval(0.95) }
    }
}

/// Rows that differ by their seed alone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Group {
    pub point: u64,
    /// Values of the parameters as text, in the order of their columns.
    pub parameters: Vec<String>,
    pub backend: String,
    pub step_s: Option<f64>,
    pub n: u64,
    pub n_finished: u64,
    pub n_failed: u64,
    /// Number of runs with a nest, and of those that reached it.
    pub n_with_nest: u64,
    pub n_arrived: u64,
    /// `null` without a nest.
    pub arrival_share: Option<f64>,
    /// Interval of Wilson.
    pub arrival_interval_95: Option<Interval>,
    /// Statistics of [`MEASURES`], in their order.
    pub measures: Vec<Distribution>,
    /// Mean share of the time with 0, 1, 2 ... attached springs (1).
    pub time_shares: Vec<f64>,
}

impl Group {
    pub fn measure(&self, name: &str) -> &Distribution {
        &self.measures[MEASURES.iter().position(|measure| *measure == name).expect("a measure of groups")]
    }
}

/// A group to which rows are added.
struct Open {
    variant: u64,
    group: Group,
    /// Of the columns that are summed up.
    sums: Vec<Summary>,
}

/// Collects rows into groups.
pub struct Grouper<'a> {
    identity: &'a Identity,
    /// Places of the columns backend, step_s, status and arrived.
    read: [usize; 4],
    /// Places of the columns that are summed up: [`MEASURES`], then the shares of time.
    summed: Vec<usize>,
    open: Option<Open>,
}

impl<'a> Grouper<'a> {
    pub fn new(identity: &'a Identity) -> Self {
        let at = |name: &str| identity.column(name).expect("every table has it");
        let is_share = |at: &usize| identity.columns[*at].name.starts_with("time_share_");
        let summed = MEASURES.into_iter().map(at).chain((0..identity.columns.len()).filter(is_share)).collect();
        Self { identity, read: ["backend", "step_s", "status", "arrived"].map(at), summed, open: None }
    }

    /// Adds a line. Returns the group before it when the line belongs to another one.
    ///
    /// # Errors
    /// When the line does not fit the columns.
    pub fn add(&mut self, line: &str) -> Result<Option<Group>, SweepError> {
        let fields = fields_of(line, &self.identity.columns)?;
        let [backend, step, status, arrived] = self.read.map(|at| &fields[at]);
        let whole = |at: usize| if let Field::Whole(value) = fields[at] { value } else { 0 };
        let (cell, point) = (whole(0), whole(2));
        let variant = cell / self.identity.n_seeds % self.identity.variants.len() as u64;
        let is_other = self.open.as_ref().is_none_or(|open| (open.group.point, open.variant) != (point, variant));
        let before = if is_other { self.finish() } else { None };
        let Open { group, sums, .. } = self.open.get_or_insert_with(|| {
            let parameters = fields[BEFORE.len()..][..self.identity.design.axes.len()].iter().map(text_of).collect();
            let group = Group { point, parameters, backend: text_of(backend), step_s: step.number(), ..Group::default() };
            Open { variant, group, sums: vec![Summary::default(); self.summed.len()] }
        });
        group.n += 1;
        group.n_finished += u64::from(text_of(status) == "finished");
        group.n_failed += u64::from(text_of(status) == "failed");
        if let Field::Truth(arrived) = arrived {
            group.n_with_nest += 1;
            group.n_arrived += u64::from(*arrived);
        }
        sums.iter_mut().zip(&self.summed).for_each(|(sum, at)| sum.extend(fields[*at].number()));
        Ok(before)
    }

    /// The last group.
    pub fn finish(&mut self) -> Option<Group> {
        let Open { group, sums, .. } = self.open.take()?;
        let (measures, shares) = sums.split_at(MEASURES.len());
        Some(Group {
            arrival_share: (group.n_with_nest > 0).then(|| group.n_arrived as f64 / group.n_with_nest as f64),
            arrival_interval_95: proportion_interval(group.n_arrived, group.n_with_nest, 0.95),
            measures: measures.iter().map(Distribution::of).collect(),
            time_shares: shares.iter().map(Summary::mean).collect(),
            ..group
        })
    }
}
