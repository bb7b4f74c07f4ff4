//! Differences between two runs of the same question: in what, by how much, and from when on.

use serde::Serialize;

use super::measure::{MEASURES, Measure, Quantity, Row, row_at};
use super::record::{CONTACT_ENERGIES, Ending, Event, Record, stored_facts};
use super::tolerance::Tolerances;
use cohaul::backend::Status;
use cohaul::simulation::Trace;
use cohaul::simulation::run_facts::{Kind, Run};

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    /// First instant at which a tolerance is exceeded; `null` when the runs agree up to the end.
    pub first_divergence: Option<Divergence>,
    /// First grasp or release that is not in both runs; `null` when all decisions are equal.
    pub first_different_decision: Option<Decision>,
    /// Largest difference in each measure, those within their tolerances included.
    pub deviations: Vec<Deviation>,
    /// Change of whether the load reached the nest; `null` without one.
    pub arrival_change: Option<Change<Option<bool>>>,
    /// Change of the worst status of all steps; `null` without one.
    pub status_change: Option<Change<Status>>,
    /// Compared rows, stored and found.
    #[serde(skip)]
    pub pairs: Vec<(Row, Row)>,
}

/// Largest difference in one measure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// Name with its unit.
    pub measure: &'static str,
    pub quantity: Quantity,
    pub difference: f64,
    pub tolerance: f64,
    /// Instant of that difference (s); `null` for a number that a run has once.
    pub time_s: Option<f64>,
    pub expected: Vec<f64>,
    pub found: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Divergence {
    pub time_s: f64,
    /// Time of the stored row before, at which everything agreed; `null` at the first row.
    pub agreed_until_s: Option<f64>,
    /// Name with its unit, or `decision`.
    pub measure: &'static str,
    pub expected: Side,
    pub found: Side,
    /// Last event of the stored run up to then.
    pub last_event: Option<Event>,
}

/// Value of one of the two runs at a divergence.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Side {
    Numbers(Vec<f64>),
    /// `null` when the run has no more decisions.
    Event(Option<Event>),
}

/// First decision in which two runs differ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Decision {
    /// Earlier one of the two instants.
    pub time_s: f64,
    /// Number of equal decisions before.
    pub n_equal: usize,
    /// `null` when the stored run has no more.
    pub expected: Option<Event>,
    /// `null` when the new run has no more.
    pub found: Option<Event>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Change<T> {
    pub expected: T,
    pub found: T,
}

impl Difference {
    pub fn between(stored: &Record, trace: &Trace, run: &Run, tolerances: &Tolerances) -> Self {
        let ending = Ending::of(trace, run);
        let pairs: Vec<_> = stored.rows.iter().map_while(|row| Some((*row, row_at(&trace.rows, row[0])?))).collect();
        let first_different_decision = different_decision(stored, trace, tolerances.time_s);
        let on_path = MEASURES.iter().filter_map(|measure| on_path(measure, &pairs, tolerances));
        let deviations: Vec<_> = on_path.chain(at_end(&stored.ending, &ending, tolerances)).collect();
        let path_divergence = path_divergence(stored, &pairs, tolerances).or_else(|| end_divergence(stored, &deviations));
        Self {
            first_divergence: earlier(first_different_decision.map(|different| decision_divergence(stored, &different)), path_divergence),
            first_different_decision,
            arrival_change: change(stored.ending.arrived, ending.arrived),
            status_change: change(stored.ending.steps.status, ending.steps.status),
            deviations,
            pairs,
        }
    }

    /// Whether any tolerance is exceeded.
    pub fn is_any(&self) -> bool {
        self.changes_kind() || self.deviations.iter().any(Deviation::is_beyond)
    }

    /// Whether all numbers are equal.
    pub fn is_none(&self) -> bool {
        !self.changes_kind() && self.deviations.iter().all(|deviation| deviation.difference == 0.0)
    }

    pub fn beyond(&self) -> impl Iterator<Item = &Deviation> {
        self.deviations.iter().filter(|deviation| deviation.is_beyond())
    }

    /// Largest deviation over its tolerance (1), of those whose tolerance is not zero.
    pub fn largest_share(&self) -> f64 {
        let shares = self.deviations.iter().filter(|deviation| deviation.tolerance > 0.0);
        shares.map(|deviation| deviation.difference / deviation.tolerance).fold(0.0, f64::max)
    }

    fn changes_kind(&self) -> bool {
        self.first_different_decision.is_some() || self.arrival_change.is_some() || self.status_change.is_some()
    }
}

impl Deviation {
    pub fn is_beyond(&self) -> bool {
        self.difference > self.tolerance
    }
}

fn on_path(measure: &Measure, pairs: &[(Row, Row)], tolerances: &Tolerances) -> Option<Deviation> {
    let apart = |(expected, found): &(Row, Row)| measure.apart(expected, found);
    // The earliest of equal ones.
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

/// The stored numbers that a run has once. A number that the stored run did not have is not
/// compared.
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
        // Last digits decide which steps need a solve: few of them are no measure of how many may
        // do.
        let n_steps = if fact.name.starts_with("pull_force_n.") { 0.0 } else { stored.number("n_steps").unwrap_or(0.0) };
        Some(count(fact.column, expected, found, expected.max(n_steps)))
    });
    let of_contacts = CONTACT_ENERGIES.iter().filter_map(move |(column, _)| {
        let (expected, found) = (stored.number(column), now.number(column));
        let energy = |side: Option<f64>| side.unwrap_or(0.0);
        (expected.or(found).is_some()).then(|| once(column, Quantity::Energy, energy(expected), energy(found), tolerances.energy_j))
    });
    [end, events].into_iter().chain(numbers).chain(of_contacts)
}

/// First stored row that exceeds a tolerance, in the measure that exceeds it most.
fn path_divergence(stored: &Record, pairs: &[(Row, Row)], tolerances: &Tolerances) -> Option<Divergence> {
    let excess = |measure: &Measure, (expected, found): &(Row, Row)| {
        let (apart, tolerance) = (measure.apart(expected, found), tolerances.for_quantity(measure.quantity));
        (apart > tolerance).then(|| apart / tolerance)
    };
    let at = pairs.iter().position(|pair| MEASURES.iter().any(|measure| excess(measure, pair).is_some()))?;
    let beyond = MEASURES.iter().filter_map(|measure| Some((measure, excess(measure, &pairs[at])?)));
    // The first of equal ones, as all are when tolerances are zero.
    let (measure, _) = beyond.reduce(|most, next| if next.1 > most.1 { next } else { most })?;
    let (expected, found) = &pairs[at];
    Some(Divergence {
        time_s: expected[0],
        agreed_until_s: at.checked_sub(1).map(|before| pairs[before].0[0]),
        measure: measure.name,
        expected: Side::Numbers(measure.values(expected)),
        found: Side::Numbers(measure.values(found)),
        last_event: last_event(stored, expected[0]),
    })
}

/// Divergence of two runs that end at different times.
fn end_divergence(stored: &Record, deviations: &[Deviation]) -> Option<Divergence> {
    let end = deviations.iter().find(|deviation| deviation.quantity == Quantity::Time && deviation.is_beyond())?;
    let time_s = end.expected[0].min(end.found[0]);
    Some(Divergence {
        time_s,
        agreed_until_s: stored.rows.iter().map(|row| row[0]).rfind(|time| *time < time_s),
        measure: end.measure,
        expected: Side::Numbers(end.expected.clone()),
        found: Side::Numbers(end.found.clone()),
        last_event: last_event(stored, time_s),
    })
}

/// Last stored event up to `time` (s).
fn last_event(stored: &Record, time: f64) -> Option<Event> {
    let after = stored.events.partition_point(|event| event.time_s <= time);
    after.checked_sub(1).map(|at| stored.events[at])
}

/// First decision in which the runs differ, among the stored ones.
fn different_decision(stored: &Record, trace: &Trace, tolerance: f64) -> Option<Decision> {
    let kept = stored.events.len();
    let is_whole = kept as u64 == stored.ending.n_events;
    // Later decisions of the stored run are not known.
    let n_known = if is_whole { trace.events.len().max(kept) } else { kept };
    let (expected, found) = (|at: usize| stored.events.get(at).copied(), |at: usize| trace.events.get(at).map(Event::of));
    let is_equal = |at: &usize| matches!((expected(*at), found(*at)), (Some(a), Some(b)) if a.equals(&b, tolerance));
    let n_equal = (0..n_known).find(|at| !is_equal(at))?;
    let (expected, found) = (expected(n_equal), found(n_equal));
    let time_s = expected.iter().chain(&found).map(|event| event.time_s).fold(f64::INFINITY, f64::min);
    Some(Decision { time_s, n_equal, expected, found })
}

fn decision_divergence(stored: &Record, different: &Decision) -> Divergence {
    Divergence {
        time_s: different.time_s,
        agreed_until_s: stored.rows.iter().map(|row| row[0]).rfind(|time| *time < different.time_s),
        measure: "decision",
        expected: Side::Event(different.expected),
        found: Side::Event(different.found),
        last_event: different.n_equal.checked_sub(1).map(|at| stored.events[at]),
    }
}

/// The earlier divergence. A decision precedes its effect on the path at the same instant.
fn earlier(decision: Option<Divergence>, path: Option<Divergence>) -> Option<Divergence> {
    match (decision, path) {
        (Some(decision), Some(path)) => Some(if decision.time_s <= path.time_s { decision } else { path }),
        (decision, path) => decision.or(path),
    }
}

fn change<T: PartialEq>(expected: T, found: T) -> Option<Change<T>> {
    (expected != found).then_some(Change { expected, found })
}
