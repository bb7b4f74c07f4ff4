//! Means over the seeds of one point and backend. Such rows follow each other, so that a table of any length needs memory for one group only.

use serde::{Deserialize, Serialize};

use super::column::fields_of;
use super::error::SweepError;
use super::plan::Identity;
use crate::math::{Interval, Summary, proportion_interval};
use crate::output::table::Field;

/// Measures of a run that groups have means of: those of `compare` and some more.
pub const MEASURES: [&str; 7] =
    ["time_to_nest_s", "mean_speed_m_per_s", "path_length_m", "pull_mean_n", "pull_sd_n", "n_pulls", "defect_j"];

/// Mean, spread and interval of the mean of one measure; `n` counts the runs that have it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distribution {
    pub n: u64,
    /// `null` without any.
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Group {
    pub point: u64,
    /// In the order of the columns, as text.
    pub parameters: Vec<String>,
    pub backend: String,
    pub step_s: Option<f64>,
    pub n: u64,
    pub n_finished: u64,
    pub n_failed: u64,
    /// Runs with a nest, and those that came there.
    pub n_with_nest: u64,
    pub n_arrived: u64,
    /// `null` without a nest.
    pub arrival_share: Option<f64>,
    /// Wilson's interval.
    pub arrival_interval_95: Option<Interval>,
    /// In the order of [`MEASURES`].
    pub measures: Vec<Distribution>,
    /// Mean share of time with 0, 1, 2 ... springs held (1).
    pub time_shares: Vec<f64>,
}

impl Group {
    pub fn measure(&self, name: &str) -> &Distribution {
        &self.measures[MEASURES.iter().position(|measure| *measure == name).expect("a measure of groups")]
    }
}

/// A group that rows are still added to.
struct Open {
    point: u64,
    variant: u64,
    parameters: Vec<String>,
    backend: String,
    step_s: Option<f64>,
    n: u64,
    n_finished: u64,
    n_failed: u64,
    n_with_nest: u64,
    n_arrived: u64,
    measures: Vec<Summary>,
    shares: Vec<Summary>,
}

/// Rows on their way into groups.
pub struct Grouper<'a> {
    identity: &'a Identity,
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

    /// Adds a line; what comes back is the group before it, when the line is of another one.
    ///
    /// # Errors
    /// When the line does not fit the columns.
    pub fn add(&mut self, line: &str) -> Result<Option<Group>, SweepError> {
        let unfit = || SweepError::Output(format!("a row does not fit the table's columns: {line}"));
        let fields = fields_of(line, &self.identity.columns).ok_or_else(unfit)?;
        let (Field::Whole(cell), Field::Whole(point)) = (&fields[0], &fields[2]) else { return Err(unfit()) };
        let variant = cell / self.identity.n_seeds % self.identity.variants.len() as u64;
        let is_other = self.open.as_ref().is_none_or(|open| (open.point, open.variant) != (*point, variant));
        let before = if is_other { self.finish() } else { None };
        let columns = &self.columns;
        let open = self.open.get_or_insert_with(|| {
            let first = self.identity.first_parameter();
            let parameters = fields[first..first + self.identity.design.axes.len()].iter().map(text).collect();
            columns.open(*point, variant, parameters, &fields)
        });
        columns.add(open, &fields);
        Ok(before)
    }

    /// The last group.
    pub fn finish(&mut self) -> Option<Group> {
        self.open.take().map(Open::closed)
    }
}

fn text(field: &Field) -> String {
    match field {
        Field::Word(word) => word.clone(),
        field => {
            let mut text = String::new();
            field.write(&mut text);
            text
        }
    }
}

impl Places {
    fn open(&self, point: u64, variant: u64, parameters: Vec<String>, fields: &[Field]) -> Open {
        Open {
            point,
            variant,
            parameters,
            backend: text(&fields[self.backend]),
            step_s: fields[self.step].number(),
            n: 0,
            n_finished: 0,
            n_failed: 0,
            n_with_nest: 0,
            n_arrived: 0,
            measures: vec![Summary::default(); self.measures.len()],
            shares: vec![Summary::default(); fields.len() - self.first_share],
        }
    }

    fn add(&self, open: &mut Open, fields: &[Field]) {
        let is = |status: &str| u64::from(matches!(&fields[self.status], Field::Word(word) if word == status));
        open.n += 1;
        open.n_finished += is("finished");
        open.n_failed += is("failed");
        if let Field::Truth(arrived) = fields[self.arrived] {
            open.n_with_nest += 1;
            open.n_arrived += u64::from(arrived);
        }
        let values = self.measures.iter().map(|at| fields[*at].number());
        open.measures.iter_mut().zip(values).for_each(|(summary, value)| summary.extend(value));
        let shares = fields[self.first_share..].iter().map(Field::number);
        open.shares.iter_mut().zip(shares).for_each(|(summary, value)| summary.extend(value));
    }
}

impl Open {
    fn closed(self) -> Group {
        Group {
            point: self.point,
            parameters: self.parameters,
            backend: self.backend,
            step_s: self.step_s,
            n: self.n,
            n_finished: self.n_finished,
            n_failed: self.n_failed,
            n_with_nest: self.n_with_nest,
            n_arrived: self.n_arrived,
            arrival_share: (self.n_with_nest > 0).then(|| self.n_arrived as f64 / self.n_with_nest as f64),
            arrival_interval_95: proportion_interval(self.n_arrived, self.n_with_nest, 0.95),
            measures: self.measures.iter().map(Distribution::of).collect(),
            time_shares: self.shares.iter().map(Summary::mean).collect(),
        }
    }
}
