//! Means over the seeds of one point and method. Such rows follow each other, so that a table of
//! any length needs memory for one group only.

use serde::{Deserialize, Serialize};

use super::column::{fields_of, text_of};
use super::error::SweepError;
use super::plan::Identity;
use crate::math::{Interval, Summary, proportion_interval};
use crate::output::table::Field;

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
    measures: Vec<Summary>,
    time_shares: Vec<Summary>,
}

/// Collects rows into groups.
pub struct Grouper<'a> {
    identity: &'a Identity,
    /// Indices of the columns that groups read.
    columns: Places,
    open: Option<Open>,
}

struct Places {
    backend: usize,
    step: usize,
    status: usize,
    arrived: usize,
    measures: Vec<usize>,
    first_share: usize,
}

impl<'a> Grouper<'a> {
    pub fn new(identity: &'a Identity) -> Self {
        let at = |name: &str| identity.column(name).expect("every table has it");
        let columns = Places {
            backend: at("backend"),
            step: at("step_s"),
            status: at("status"),
            arrived: at("arrived"),
            measures: MEASURES.iter().map(|name| at(name)).collect(),
            first_share: identity.columns.iter().position(|column| column.name.starts_with("time_share_")).expect("every table has it"),
        };
        Self { identity, columns, open: None }
    }

    /// Adds a line. Returns the group before it when the line belongs to another one.
    ///
    /// # Errors
    /// When the line does not fit the columns.
    pub fn add(&mut self, line: &str) -> Result<Option<Group>, SweepError> {
        let fields = fields_of(line, &self.identity.columns)?;
        let whole = |at: usize| if let Field::Whole(value) = fields[at] { value } else { 0 };
        let (cell, point) = (whole(0), whole(2));
        let variant = cell / self.identity.n_seeds % self.identity.variants.len() as u64;
        let is_other = self.open.as_ref().is_none_or(|open| (open.group.point, open.variant) != (point, variant));
        let before = if is_other { self.finish() } else { None };
        let (identity, columns) = (self.identity, &self.columns);
        let open = self.open.get_or_insert_with(|| {
            let first = identity.first_parameter();
            let parameters = fields[first..first + identity.design.axes.len()].iter().map(text_of).collect();
            let (backend, step_s) = (text_of(&fields[columns.backend]), fields[columns.step].number());
            let summaries = |n: usize| vec![Summary::default(); n];
            Open {
                variant,
                group: Group { point, parameters, backend, step_s, ..Group::default() },
                measures: summaries(columns.measures.len()),
                time_shares: summaries(fields.len() - columns.first_share),
            }
        });
        open.add(columns, &fields);
        Ok(before)
    }

    /// The last group.
    pub fn finish(&mut self) -> Option<Group> {
        self.open.take().map(Open::closed)
    }
}

impl Open {
    fn add(&mut self, columns: &Places, fields: &[Field]) {
        let status = text_of(&fields[columns.status]);
        self.group.n += 1;
        self.group.n_finished += u64::from(status == "finished");
        self.group.n_failed += u64::from(status == "failed");
        if let Field::Truth(arrived) = fields[columns.arrived] {
            self.group.n_with_nest += 1;
            self.group.n_arrived += u64::from(arrived);
        }
        let values = columns.measures.iter().map(|at| fields[*at].number());
        self.measures.iter_mut().zip(values).for_each(|(summary, value)| summary.extend(value));
        let shares = fields[columns.first_share..].iter().map(Field::number);
        self.time_shares.iter_mut().zip(shares).for_each(|(summary, value)| summary.extend(value));
    }

    fn closed(self) -> Group {
        let Group { n_arrived, n_with_nest, .. } = self.group;
        Group {
            arrival_share: (n_with_nest > 0).then(|| n_arrived as f64 / n_with_nest as f64),
            arrival_interval_95: proportion_interval(n_arrived, n_with_nest, 0.95),
            measures: self.measures.iter().map(Distribution::of).collect(),
            time_shares: self.time_shares.iter().map(Summary::mean).collect(),
            ..self.group
        }
    }
}
