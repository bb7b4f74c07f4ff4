//! What a baseline stores of a run: rows chosen evenly over its time, its decisions, and its end.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::measure::{COLUMNS, Row, row_of};
use cohaul::backend::{EnergyLedger, Status};
use cohaul::simulation::run_facts::{FACTS, Fact, Kind, Run, Value};
use cohaul::simulation::{EventKind, Trace};

/// Number of grasps and releases that are stored. After the first difference no other needs a
/// comparison.
pub const MOST_EVENTS: usize = 1000;

#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Rows in the order of time; the last one is the end.
    pub rows: Vec<Row>,
    /// The first [`MOST_EVENTS`] grasps and releases.
    pub events: Vec<Event>,
    pub ending: Ending,
}

/// A grasp or a release, as a file has it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    pub time_s: f64,
    pub event: EventKind,
    pub spring: usize,
    /// `null` for a prescribed path.
    pub ant: Option<usize>,
}

/// How a run ended, besides the state in its last row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ending {
    /// Time of the end, which is the time to the nest of a load that arrived (s).
    pub time_s: f64,
    /// `null` without ants.
    pub arrived: Option<bool>,
    /// Number of all grasps and releases, stored or not.
    pub n_events: u64,
    pub steps: Steps,
    #[serde(flatten)]
    pub numbers: Numbers,
}

/// Worst status of the steps, and their counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Steps {
    pub status: Status,
    #[serde(flatten)]
    pub numbers: Numbers,
}

/// Numbers of a run by the columns of [`FACTS`].
pub type Numbers = BTreeMap<String, Number>;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Number {
    Count(u64),
    Number(f64),
}

impl Number {
    pub fn as_f64(self) -> f64 {
        match self {
            Number::Count(value) => value as f64,
            Number::Number(value) => value,
        }
    }
}

/// The numbers of a run that a baseline stores beside its rows.
pub fn stored_facts() -> impl Iterator<Item = &'static Fact> {
    FACTS
        .iter()
        .filter(|fact| fact.is_reproducible && fact.kind != Kind::Flag && !fact.column.is_empty() && !COLUMNS.contains(&fact.column))
}

/// Column of an energy, and its value in a ledger (J).
pub type ContactEnergy = (&'static str, fn(&EnergyLedger) -> f64);

/// Energies of a load among obstacles. A baseline stores those that are not zero.
pub const CONTACT_ENERGIES: [ContactEnergy; 3] = [
    ("side_friction_j", |ledger| ledger.side_friction),
    ("impacts_j", |ledger| ledger.impacts),
    ("obstacle_work_j", |ledger| ledger.obstacle_work),
];

impl Record {
    /// Record of a run with at most `n_rows` rows: the start, the end, and ticks between them as
    /// evenly as possible. A run of more than one row keeps two at least.
    pub fn of(trace: &Trace, run: &Run, n_rows: usize) -> Self {
        let rows = chosen(trace.rows.len(), n_rows).map(|at| row_of(&trace.rows[at]));
        Self {
            rows: rows.collect(),
            events: trace.events.iter().take(MOST_EVENTS).map(Event::of).collect(),
            ending: Ending::of(trace, run),
        }
    }
}

/// Indices of at most `n` of `n_all` entries, the first and the last among them.
fn chosen(n_all: usize, n: usize) -> impl Iterator<Item = usize> {
    let n = n.max(2).min(n_all);
    // Integer arithmetic, rounded to the nearest: n - 1 gaps over n_all - 1.
    let gaps = n.saturating_sub(1).max(1);
    (0..n).map(move |k| (2 * k * (n_all - 1) + gaps) / (2 * gaps))
}

impl Event {
    pub fn of(event: &cohaul::simulation::Event) -> Self {
        Self { time_s: event.time, event: event.kind, spring: event.spring, ant: event.ant }
    }

    /// The event as a trace has it, without the position of its tip, which is not stored.
    pub fn without_tip(&self) -> cohaul::simulation::Event {
        let tip = cohaul::math::Vec2::zeros();
        cohaul::simulation::Event { time: self.time_s, spring: self.spring, ant: self.ant, tip, kind: self.event }
    }

    /// Whether both are the same decision, at instants that differ by at most `tolerance` (s).
    pub fn equals(&self, other: &Self, tolerance: f64) -> bool {
        let same = (self.event, self.spring, self.ant) == (other.event, other.spring, other.ant);
        same && (self.time_s - other.time_s).abs() <= tolerance
    }
}

impl Ending {
    pub fn of(trace: &Trace, run: &Run) -> Self {
        let of_steps = |fact: &&Fact| fact.name.starts_with("steps.");
        let entry = |fact: &Fact| match fact.value(run) {
            Value::Number(value) => Some((fact.column.to_owned(), Number::Number(value))),
            Value::Count(value) => Some((fact.column.to_owned(), Number::Count(value))),
            _ => None,
        };
        let of_contacts = CONTACT_ENERGIES.iter().map(|(column, value)| (*column, value(&run.outcome.energy)));
        let of_contacts = of_contacts.filter(|(_, energy)| *energy != 0.0);
        let of_contacts = of_contacts.map(|(column, energy)| (column.to_owned(), Number::Number(energy)));
        Self {
            time_s: run.outcome.time,
            arrived: run.outcome.arrived,
            n_events: trace.events.len() as u64,
            steps: Steps { status: run.outcome.steps.status, numbers: stored_facts().filter(of_steps).filter_map(entry).collect() },
            numbers: stored_facts().filter(|fact| !of_steps(fact)).filter_map(entry).chain(of_contacts).collect(),
        }
    }

    /// The number with this column, if it is there.
    pub fn number(&self, column: &str) -> Option<f64> {
        self.numbers.get(column).or_else(|| self.steps.numbers.get(column)).map(|number| number.as_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_rows_are_even_and_hold_both_ends() {
        let of = |n_all, n| chosen(n_all, n).collect::<Vec<_>>();
        assert_eq!(of(11, 6), [0, 2, 4, 6, 8, 10]);
        assert_eq!(of(5, 100), [0, 1, 2, 3, 4]);
        assert_eq!((of(9, 0), of(1, 7)), (vec![0, 8], vec![0]));
        let many = of(120_001, 200);
        assert_eq!((many.len(), many[0], many[199]), (200, 0, 120_000));
        // Gaps of 603.01 rows.
        assert!(many.windows(2).all(|pair| (603..=604).contains(&(pair[1] - pair[0]))));
        assert!(of(101, 97).windows(2).all(|pair| pair[0] < pair[1]), "none twice");
    }
}
