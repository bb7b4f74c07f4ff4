//! Two runs of one question: how far apart, in what, and from when on.

use serde::Serialize;

use super::measure::row_at;
use super::record::{Ending, Event, stored_facts};
use super::{MEASURES, Measure, Quantity, Record, Row, Tolerances};
use crate::backend::Status;
use crate::simulation::Trace;
use crate::simulation::run_facts::{Kind, Run};

/// What a run of now and a stored one differ in.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    /// Where and what they part in first; `null` where they stay together up to the end.
    pub first_divergence: Option<Divergence>,
    /// The first grasp or release that is not in both; `null` where decisions are the same.
    pub decisions_part: Option<Decision>,
    /// Largest difference in each measure, those within their tolerances included.
    pub deviations: Vec<Deviation>,
    /// Whether the load reached the nest; `null` where it is as it was.
    pub arrival_change: Option<Change<Option<bool>>>,
    /// The worst ending of a step; `null` where it is as it was.
    pub status_change: Option<Change<Status>>,
    /// Rows that were compared, as stored and as found.
    #[serde(skip)]
    pub pairs: Vec<(Row, Row)>,
}

/// The largest difference in one measure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// Name with its unit.
    pub measure: &'static str,
    pub quantity: Quantity,
    pub difference: f64,
    pub tolerance: f64,
    /// When it was that large; `null` for what a run has once.
    pub time_s: Option<f64>,
    pub expected: Vec<f64>,
    pub found: Vec<f64>,
}

/// The first instant at which something is beyond its tolerance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Divergence {
    pub time_s: f64,
    /// The stored row before, where all agreed; `null` when it is the first.
    pub agreed_until_s: Option<f64>,
    /// Name with its unit, or `decision`.
    pub measure: &'static str,
    pub expected: Told,
    pub found: Told,
    /// The last event of the stored run before.
    pub last_event: Option<Event>,
}

/// One side of a divergence.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Told {
    Numbers(Vec<f64>),
    /// `null` when there is none.
    Event(Option<Event>),
}

/// Where decisions part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Decision {
    /// The earlier of both instants.
    pub time_s: f64,
    /// Decisions before that are the same.
    pub n_alike: usize,
    /// `null` when the stored run has no more.
    pub expected: Option<Event>,
    /// `null` when the run of now has no more.
    pub found: Option<Event>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Change<T> {
    pub expected: T,
    pub found: T,
}

impl Difference {
    /// Between what is stored of a run and a run of now.
    pub fn between(stored: &Record, trace: &Trace, run: &Run, tolerances: &Tolerances) -> Self {
        let ending = Ending::of(trace, run);
        let pairs: Vec<_> = stored.rows.iter().map_while(|row| Some((*row, row_at(&trace.rows, row[0])?))).collect();
        let decisions_part = decision(stored, trace, tolerances.time_s);
        let on_path = MEASURES.iter().filter_map(|measure| on_path(measure, &pairs, tolerances));
        let deviations: Vec<_> = on_path.chain(at_end(&stored.ending, &ending, tolerances)).collect();
        let path_parts = path_parts(stored, &pairs, tolerances).or_else(|| end_parts(stored, &deviations));
        Self {
            first_divergence: earlier(decisions_part.map(|part| decision_divergence(stored, &part)), path_parts),
            decisions_part,
            arrival_change: change(stored.ending.arrived, ending.arrived),
            status_change: change(stored.ending.steps.status, ending.steps.status),
            deviations,
            pairs,
        }
    }

    /// Whether anything is beyond its tolerance.
    pub fn is_any(&self) -> bool {
        self.changes_kind() || self.deviations.iter().any(Deviation::is_beyond)
    }

    /// Whether there is no difference at all, however small.
    pub fn is_none(&self) -> bool {
        !self.changes_kind() && self.deviations.iter().all(|deviation| deviation.difference == 0.0)
    }

    /// The deviations that are beyond their tolerances.
    pub fn beyond(&self) -> impl Iterator<Item = &Deviation> {
        self.deviations.iter().filter(|deviation| deviation.is_beyond())
    }

    /// The largest difference over its tolerance (1), of those with a tolerance.
    pub fn largest_share(&self) -> f64 {
        let shares = self.deviations.iter().filter(|deviation| deviation.tolerance > 0.0);
        shares.map(|deviation| deviation.difference / deviation.tolerance).fold(0.0, f64::max)
    }

    fn changes_kind(&self) -> bool {
        self.decisions_part.is_some() || self.arrival_change.is_some() || self.status_change.is_some()
    }
}

impl Deviation {
    pub fn is_beyond(&self) -> bool {
        self.difference > self.tolerance
    }
}

/// The instant at which two rows lie furthest apart in a measure.
fn on_path(measure: &Measure, pairs: &[(Row, Row)], tolerances: &Tolerances) -> Option<Deviation> {
    let apart = |(expected, found): &(Row, Row)| measure.apart(expected, found);
    // Of equals the earliest.
    let (expected, found) = pairs.iter().rev().max_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    Some(Deviation {
        measure: measure.name,
        quantity: measure.quantity,
        difference: measure.apart(expected, found),
        tolerance: tolerances.for_quantity(measure.quantity),
        time_s: Some(expected[0]),
        expected: measure.values(expected),
        found: measure.values(found),
    })
}

/// The stored numbers that a run has once. A number that the stored run did not have is not compared.
fn at_end<'a>(stored: &'a Ending, now: &'a Ending, tolerances: &'a Tolerances) -> impl Iterator<Item = Deviation> + 'a {
    let once = |measure, quantity, expected: f64, found: f64, tolerance| Deviation {
        measure,
        quantity,
        difference: (found - expected).abs(),
        tolerance,
        time_s: None,
        expected: vec![expected],
        found: vec![found],
    };
    let count = move |measure, expected: f64, found: f64, whole: f64| {
        once(measure, Quantity::Count, expected, found, tolerances.count_share * whole)
    };
    let end = once("time_s", Quantity::Time, stored.time_s, now.time_s, tolerances.time_s);
    let events = count("n_events", stored.n_events as f64, now.n_events as f64, stored.n_events as f64);
    let numbers = stored_facts().filter_map(move |fact| {
        let (expected, found) = (stored.number(fact.column)?, now.number(fact.column).unwrap_or(0.0));
        if fact.kind == Kind::Number {
            let quantity = Quantity::of_unit(fact.unit());
            return Some(once(fact.column, quantity, expected, found, tolerances.for_quantity(quantity)));
        }
        // Last digits decide which steps need a solve: few of them are no measure of how many may do.
        let n_steps = if fact.name.starts_with("pull_force_n.") { 0.0 } else { stored.number("n_steps").unwrap_or(0.0) };
        Some(count(fact.column, expected, found, expected.max(n_steps)))
    });
    [end, events].into_iter().chain(numbers)
}

/// The first stored row that is beyond a tolerance, told by what is furthest beyond.
fn path_parts(stored: &Record, pairs: &[(Row, Row)], tolerances: &Tolerances) -> Option<Divergence> {
    let excess = |measure: &Measure, (expected, found): &(Row, Row)| {
        let (apart, tolerance) = (measure.apart(expected, found), tolerances.for_quantity(measure.quantity));
        (apart > tolerance).then(|| apart / tolerance)
    };
    let at = pairs.iter().position(|pair| MEASURES.iter().any(|measure| excess(measure, pair).is_some()))?;
    let beyond = MEASURES.iter().filter_map(|measure| Some((measure, excess(measure, &pairs[at])?)));
    // Of equals the first, as all are where tolerances are zero.
    let (measure, _) = beyond.reduce(|most, next| if next.1 > most.1 { next } else { most })?;
    let (expected, found) = &pairs[at];
    Some(Divergence {
        time_s: expected[0],
        agreed_until_s: at.checked_sub(1).map(|before| pairs[before].0[0]),
        measure: measure.name,
        expected: Told::Numbers(measure.values(expected)),
        found: Told::Numbers(measure.values(found)),
        last_event: last_event(stored, expected[0]),
    })
}

/// One of two runs is over while the other goes on.
fn end_parts(stored: &Record, deviations: &[Deviation]) -> Option<Divergence> {
    let end = deviations.iter().find(|deviation| deviation.quantity == Quantity::Time && deviation.is_beyond())?;
    let time_s = end.expected[0].min(end.found[0]);
    Some(Divergence {
        time_s,
        agreed_until_s: stored.rows.iter().map(|row| row[0]).rfind(|time| *time < time_s),
        measure: end.measure,
        expected: Told::Numbers(end.expected.clone()),
        found: Told::Numbers(end.found.clone()),
        last_event: last_event(stored, time_s),
    })
}

/// The last stored event up to `time` (s).
fn last_event(stored: &Record, time: f64) -> Option<Event> {
    let after = stored.events.partition_point(|event| event.time_s <= time);
    after.checked_sub(1).map(|at| stored.events[at])
}

/// The first decision that the runs do not share, among those that are kept.
fn decision(stored: &Record, trace: &Trace, tolerance: f64) -> Option<Decision> {
    let kept = stored.events.len();
    let is_whole = kept as u64 == stored.ending.n_events;
    // What the stored run did after the last one kept is not known.
    let n_known = if is_whole { trace.events.len().max(kept) } else { kept };
    let (expected, found) = (|at: usize| stored.events.get(at).copied(), |at: usize| trace.events.get(at).map(Event::of));
    let is_alike = |at: &usize| matches!((expected(*at), found(*at)), (Some(a), Some(b)) if a.is_like(&b, tolerance));
    let n_alike = (0..n_known).find(|at| !is_alike(at))?;
    let (expected, found) = (expected(n_alike), found(n_alike));
    let time_s = expected.iter().chain(&found).map(|event| event.time_s).fold(f64::INFINITY, f64::min);
    Some(Decision { time_s, n_alike, expected, found })
}

fn decision_divergence(stored: &Record, part: &Decision) -> Divergence {
    Divergence {
        time_s: part.time_s,
        agreed_until_s: stored.rows.iter().map(|row| row[0]).rfind(|time| *time < part.time_s),
        measure: "decision",
        expected: Told::Event(part.expected),
        found: Told::Event(part.found),
        last_event: part.n_alike.checked_sub(1).map(|at| stored.events[at]),
    }
}

/// Of two the earlier; a decision comes before what it does to the path at the same instant.
fn earlier(decision: Option<Divergence>, path: Option<Divergence>) -> Option<Divergence> {
    match (decision, path) {
        (Some(decision), Some(path)) => Some(if decision.time_s <= path.time_s { decision } else { path }),
        (decision, path) => decision.or(path),
    }
}

fn change<T: PartialEq>(expected: T, found: T) -> Option<Change<T>> {
    (expected != found).then_some(Change { expected, found })
}
