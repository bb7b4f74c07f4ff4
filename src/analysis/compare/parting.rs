//! When two paths part, after what, and what takes them apart how far.

use serde::Serialize;

use super::Solution;
use super::difference::{Jumps, apart};
use super::numbers::natural_rate;
use crate::backend::{Transition, TransitionKind};
use crate::scenario::Scenario;
use crate::simulation::{Event, EventKind, Row};

/// The first instant at which two paths lie further apart than their own errors and the tolerance allow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Parting {
    pub time_s: f64,
    /// What happened last before; `None` when nothing had.
    pub after: Option<Occasion>,
}

/// Something that can make paths part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Occasion {
    pub kind: OccasionKind,
    /// That was grasped or let go; `null` for what the load did.
    pub spring: Option<usize>,
    /// That was captured or came free.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub support: Option<usize>,
    pub time_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OccasionKind {
    /// The load started with speed.
    Start,
    Grasp,
    Release,
    /// The load began to move out of rest.
    Onset,
    /// It came to rest.
    Stop,
    /// A support ceased to slip.
    Capture,
    /// The support that the load turned about slipped again.
    Freed,
    /// The load without inertia jumped.
    Jump,
}

/// Two paths of one load that are held against each other.
pub(super) struct Pair<'a> {
    a: &'a Solution,
    b: &'a Solution,
    /// Of the load (m).
    radius: f64,
    /// What counts as agreement (m).
    tolerance: f64,
    /// What the load does so soon (s) after a grasp or a release is its effect.
    moment: f64,
    /// Beside which instants count.
    jumps: &'a Jumps,
    /// Grasps and releases of springs that are stretched by more than the tolerance: others move nothing.
    events: Vec<Occasion>,
    /// Instants of jumps that are longer than the tolerance (s).
    long_jumps: Vec<f64>,
}

/// Displacements of the load's rim by inertia (m), at most, by what they come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct InertiaFrom {
    /// The load started with speed.
    pub start_m: f64,
    /// A grasp or a release left it out of balance, or it jumps without inertia.
    pub jumps_m: f64,
    /// Tips drove it or stopped.
    pub driving_m: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum From {
    Start,
    Jumps,
    Driving,
}

/// A time over which paths lie apart, so far.
#[derive(Clone, Copy)]
struct Stretch {
    from: From,
    /// (s)
    since: f64,
    /// Distance of the rims (m).
    largest: f64,
}

impl<'a> Pair<'a> {
    pub fn new([a, b]: [&'a Solution; 2], scenario: &Scenario, tolerance: f64, jumps: &'a Jumps) -> Self {
        let rows = &a.trace.rows;
        let is_stretched = |event: &&Event| {
            let at = rows.partition_point(|row| row.time < event.time);
            let pull = |row: &Row| row.tips.iter().find(|tip| tip.spring == event.spring).map_or(0.0, |tip| tip.pull.norm());
            let pull = rows[at.saturating_sub(1)..rows.len().min(at + 1)].iter().map(pull).fold(0.0, f64::max);
            pull > scenario.system.springs[event.spring].radial_stiffness * tolerance
        };
        let radius = scenario.system.load.radius;
        let is_long = |transition: &&Transition| match transition.kind {
            TransitionKind::Jump { shift, turn, .. } => shift + radius * turn.abs() > tolerance,
            _ => false,
        };
        let long_jumps: Vec<f64> = b.trace.transitions.iter().filter(is_long).map(|transition| transition.time).collect();
        // What a load that starts with speed is held by from the beginning is a part of its start, unless that alone makes it jump.
        let first_tick = rows.first().map_or(0.0, |row| row.time + scenario.control_period);
        let begins_with_jump = long_jumps.first().is_some_and(|jump| *jump < first_tick);
        let is_of_start =
            |event: &&Event| starts_with_speed(a) && !begins_with_jump && rows.first().is_some_and(|row| event.time <= row.time);
        let events = a.trace.events.iter().filter(|event| is_stretched(event) && !is_of_start(event)).map(Occasion::of_event).collect();
        let rate = natural_rate(scenario);
        let moment = if rate > 0.0 { rate.recip() } else { 0.0 };
        Self { a, b, radius, tolerance, moment, jumps, events, long_jumps }
    }

    /// Where a point of the load first lies further apart than both own errors and the tolerance together.
    pub fn first_parting(&self) -> Option<Parting> {
        let (time_s, ..) = self.instants().find(|(.., are_apart)| *are_apart)?;
        Some(Parting { time_s, after: self.last_before(time_s) })
    }

    /// What takes the path of a load with inertia, `a`, from that of the same one without, `b`. While paths lie apart all comes from what parted them, but for what
    /// takes them further still: something sudden, or anything once the load has set out again since its start.
    pub fn inertia_from(&self) -> InertiaFrom {
        let sudden = self.sudden();
        let coasts_until = self.coasts_until(&sudden);
        let mut largest = InertiaFrom::default();
        let mut stretch: Option<Stretch> = None;
        for (time, distance, are_apart) in self.instants() {
            let last_sudden = sudden[..sudden.partition_point(|sudden| *sudden <= time)].last().copied();
            let from_now = || {
                let is_sudden = |occasion: Occasion| last_sudden.is_some_and(|sudden| (occasion.time_s - sudden).abs() <= self.moment);
                match self.last_before(time) {
                    _ if time <= coasts_until => From::Start,
                    Some(occasion) if is_sudden(occasion) => From::Jumps,
                    _ => From::Driving,
                }
            };
            let from = match stretch {
                Some(Stretch { from, largest, .. }) if distance <= largest => from,
                Some(Stretch { since, .. }) if last_sudden.is_some_and(|sudden| sudden > since) => From::Jumps,
                Some(Stretch { from: From::Start, .. }) => from_now(),
                Some(Stretch { from, .. }) => from,
                None => from_now(),
            };
            let so_far = stretch.filter(|stretch| stretch.from == from).unwrap_or(Stretch { from, since: time, largest: 0.0 });
            stretch = are_apart.then_some(Stretch { largest: so_far.largest.max(distance), ..so_far });
            let part = match from {
                From::Start => &mut largest.start_m,
                From::Jumps => &mut largest.jumps_m,
                From::Driving => &mut largest.driving_m,
            };
            *part = part.max(distance);
        }
        largest
    }

    /// Those that count (s), with how far a point of the load can be apart (m) and whether that is more than own errors and the tolerance.
    fn instants(&self) -> impl Iterator<Item = (f64, f64, bool)> {
        let both = self.a.points.iter().zip(&self.b.points).filter(|(a, _)| self.jumps.let_count(a.time));
        both.map(|(a, b)| {
            let own = a.position_error + b.position_error + self.radius * (a.heading_error + b.heading_error);
            let (shift, turn) = apart(a, b);
            let distance = shift + self.radius * turn;
            (a.time, distance, distance > self.tolerance + own)
        })
    }

    /// What happened last before an instant (s).
    fn last_before(&self, time: f64) -> Option<Occasion> {
        let until = self.jumps.since_tick(time).map_or(time, f64::next_up);
        let event = self.events[..self.events.partition_point(|event| event.time_s < until)].last();
        // What the load does at once is an effect.
        let since = event.map_or(f64::NEG_INFINITY, |event| event.time_s + self.moment);
        let transition = |solution: &Solution| {
            let transitions = &solution.trace.transitions;
            let last = transitions[..transitions.partition_point(|transition| transition.time < until)].last()?;
            (last.time > since).then(|| Occasion::of_transition(last))
        };
        let of_load = [self.a, self.b].into_iter().filter_map(transition).max_by(|a, b| a.time_s.total_cmp(&b.time_s));
        of_load.or(event.copied()).or_else(|| {
            starts_with_speed(self.a).then_some(Occasion { kind: OccasionKind::Start, spring: None, support: None, time_s: 0.0 })
        })
    }

    /// Instants of grasps and releases of stretched springs, and of long jumps (s).
    fn sudden(&self) -> Vec<f64> {
        let mut sudden: Vec<f64> = self.events.iter().map(|event| event.time_s).chain(self.long_jumps.iter().copied()).collect();
        sudden.sort_by(f64::total_cmp);
        sudden
    }

    /// Number of grasps and releases that move something.
    pub fn n_sudden(&self) -> usize {
        self.events.len()
    }

    /// How long the load does nothing but go on as it started, and stop (s); less than nothing when it started from rest.
    fn coasts_until(&self, sudden: &[f64]) -> f64 {
        if !starts_with_speed(self.a) {
            return f64::NEG_INFINITY;
        }
        let transitions = &self.a.trace.transitions;
        let onsets = transitions.iter().filter(|transition| transition.kind == TransitionKind::Onset).map(|onset| onset.time);
        onsets.chain(sudden.iter().copied()).fold(f64::INFINITY, f64::min)
    }
}

fn starts_with_speed(solution: &Solution) -> bool {
    solution.trace.rows.first().is_some_and(|row| row.energy.initial > 0.0)
}

impl Occasion {
    fn of_event(event: &Event) -> Self {
        let kind = match event.kind {
            EventKind::Grasp => OccasionKind::Grasp,
            EventKind::Release => OccasionKind::Release,
        };
        Self { kind, spring: Some(event.spring), support: None, time_s: event.time }
    }

    fn of_transition(transition: &Transition) -> Self {
        let (kind, support) = match transition.kind {
            TransitionKind::Onset => (OccasionKind::Onset, None),
            TransitionKind::Stop => (OccasionKind::Stop, None),
            TransitionKind::Capture { support } => (OccasionKind::Capture, Some(support)),
            TransitionKind::Freed { support } => (OccasionKind::Freed, Some(support)),
            TransitionKind::Jump { .. } => (OccasionKind::Jump, None),
        };
        Self { kind, spring: None, support, time_s: transition.time }
    }
}
