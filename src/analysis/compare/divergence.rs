//! First divergence of two paths, and the attribution of an inertia effect to triggers.

use serde::Serialize;

use super::difference::Jumps;
use super::numbers::natural_rate;
use super::solution::{Point, Solution};
use crate::analysis::trigger::{ByTrigger, Trigger, TriggerKind};
use crate::backend::{Transition, TransitionKind};
use crate::scenario::Scenario;
use crate::simulation::{Event, EventKind, Row};

/// First instant at which the edge displacement between two paths exceeds the tolerance and their
/// numerical errors together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Divergence {
    /// Time from the start of the run (s).
    pub time_s: f64,
    /// Last trigger before that time; `null` if there was none.
    pub trigger: Option<Trigger>,
}

/// Two paths of one load.
pub(super) struct PathPair<'a> {
    a: &'a Solution,
    b: &'a Solution,
    /// Radius of the load (m).
    radius: f64,
    /// Largest edge displacement that counts as agreement (m).
    tolerance: f64,
    /// Motions of the load that begin within this time after a grasp or a release are its effect
    /// (s).
    response_time: f64,
    /// Jumps after which paths are not compared.
    jumps: &'a Jumps,
    /// Grasps and releases of springs that are stretched by more than the tolerance: others move
    /// nothing.
    events: Vec<Trigger>,
    /// Times of the jumps that are longer than the tolerance (s).
    long_jumps: Vec<f64>,
}

/// Interval in which two paths differ by more than the tolerance, up to the present instant.
#[derive(Clone, Copy)]
struct Separation {
    kind: TriggerKind,
    /// Start of the interval (s).
    since: f64,
    /// Largest edge displacement in it (m).
    largest: f64,
}

impl<'a> PathPair<'a> {
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
        // Springs that are attached from the beginning belong to a start with speed, unless they
        // alone make the load jump.
        let first_tick = rows.first().map_or(0.0, |row| row.time + scenario.control_period);
        let begins_with_jump = long_jumps.first().is_some_and(|jump| *jump < first_tick);
        let is_of_start =
            |event: &&Event| starts_with_speed(a) && !begins_with_jump && rows.first().is_some_and(|row| event.time <= row.time);
        let events = a.trace.events.iter().filter(|event| is_stretched(event) && !is_of_start(event)).map(of_event).collect();
        let rate = natural_rate(scenario);
        let response_time = if rate > 0.0 { rate.recip() } else { 0.0 };
        Self { a, b, radius, tolerance, response_time, jumps, events, long_jumps }
    }

    pub fn first_divergence(&self) -> Option<Divergence> {
        self.instants().find(|(.., are_apart)| *are_apart).map(|(time, ..)| self.divergence_at(time))
    }

    /// First instant at which the headings differ by more than the `tolerance` (rad) and their
    /// numerical errors together.
    pub fn first_divergence_of_heading(&self, tolerance: f64) -> Option<Divergence> {
        let are_apart = |a: &Point, b: &Point| a.difference(b).1 > tolerance + a.error.heading + b.error.heading;
        self.points().find(|(a, b)| are_apart(a, b)).map(|(a, _)| self.divergence_at(a.time))
    }

    /// Divergence at an instant (s), with the last trigger before it.
    pub fn divergence_at(&self, time_s: f64) -> Divergence {
        Divergence { time_s, trigger: self.last_before(time_s) }
    }

    /// Pairs of points that are compared.
    fn points(&self) -> impl Iterator<Item = (&'a Point, &'a Point)> {
        self.a.points.iter().zip(&self.b.points).filter(|(a, _)| self.jumps.allow(a.time))
    }

    /// Attribution of the difference between an inertial path `a` and the quasi-static path `b`.
    ///
    /// A difference belongs to what separated the paths, until it grows further after a sudden
    /// event, or after the load set out again since its start.
    pub fn by_trigger(&self) -> ByTrigger {
        let sudden = self.sudden();
        let coasts_until = self.coasts_until(&sudden);
        let mut largest = ByTrigger::default();
        let mut separation: Option<Separation> = None;
        for (time, distance, are_apart) in self.instants() {
            let last_sudden = sudden[..sudden.partition_point(|sudden| *sudden <= time)].last().copied();
            let kind_now = || {
                let is_sudden = |trigger: Trigger| last_sudden.is_some_and(|sudden| (trigger.time_s - sudden).abs() <= self.response_time);
                match self.last_before(time) {
                    _ if time <= coasts_until => TriggerKind::Start,
                    Some(trigger) if is_sudden(trigger) => TriggerKind::Jump,
                    _ => TriggerKind::Driving,
                }
            };
            let kind = match separation {
                Some(Separation { kind, largest, .. }) if distance <= largest => kind,
                Some(Separation { since, .. }) if last_sudden.is_some_and(|sudden| sudden > since) => TriggerKind::Jump,
                Some(Separation { kind: TriggerKind::Start, .. }) => kind_now(),
                Some(Separation { kind, .. }) => kind,
                None => kind_now(),
            };
            let so_far = separation.filter(|it| it.kind == kind).unwrap_or(Separation { kind, since: time, largest: 0.0 });
            separation = are_apart.then_some(Separation { largest: so_far.largest.max(distance), ..so_far });
            let part = largest.of_mut(kind);
            *part = part.max(distance);
        }
        largest
    }

    /// Instants of the comparison: time (s), edge displacement (m), and whether that exceeds the
    /// tolerance and both numerical errors.
    fn instants(&self) -> impl Iterator<Item = (f64, f64, bool)> {
        self.points().map(|(a, b)| {
            let error = a.error.position + b.error.position + self.radius * (a.error.heading + b.error.heading);
            let distance = a.pose.edge_displacement(&b.pose, self.radius);
            (a.time, distance, distance > self.tolerance + error)
        })
    }

    /// Last trigger before an instant (s).
    fn last_before(&self, time: f64) -> Option<Trigger> {
        let until = self.jumps.since_tick(time).map_or(time, f64::next_up);
        let event = self.events[..self.events.partition_point(|event| event.time_s < until)].last();
        let since = event.map_or(f64::NEG_INFINITY, |event| event.time_s + self.response_time);
        let transition = |solution: &Solution| {
            let transitions = &solution.trace.transitions;
            let last = transitions[..transitions.partition_point(|transition| transition.time < until)].last()?;
            (last.time > since).then(|| of_transition(last))
        };
        let of_load = [self.a, self.b].into_iter().filter_map(transition).max_by(|a, b| a.time_s.total_cmp(&b.time_s));
        of_load.or(event.copied()).or_else(|| starts_with_speed(self.a).then_some(Trigger::new(TriggerKind::Start, 0.0)))
    }

    /// Times of grasps and releases of stretched springs, and of long jumps (s).
    fn sudden(&self) -> Vec<f64> {
        let mut sudden: Vec<f64> = self.events.iter().map(|event| event.time_s).chain(self.long_jumps.iter().copied()).collect();
        sudden.sort_by(f64::total_cmp);
        sudden
    }

    /// Number of grasps and releases that move the load.
    pub fn n_sudden(&self) -> usize {
        self.events.len()
    }

    /// End of the motion that began with the start speed (s); minus infinity after a start at rest.
    fn coasts_until(&self, sudden: &[f64]) -> f64 {
        if !starts_with_speed(self.a) {
            return f64::NEG_INFINITY;
        }
        let transitions = &self.a.trace.transitions;
        let onsets = transitions.iter().filter(|transition| transition.kind == TransitionKind::SlipOnset).map(|onset| onset.time);
        onsets.chain(sudden.iter().copied()).fold(f64::INFINITY, f64::min)
    }
}

fn starts_with_speed(solution: &Solution) -> bool {
    solution.trace.rows.first().is_some_and(|row| row.energy.initial > 0.0)
}

fn of_event(event: &Event) -> Trigger {
    let kind = match event.kind {
        EventKind::Grasp => TriggerKind::Grasp,
        EventKind::Release => TriggerKind::Release,
    };
    Trigger { spring: Some(event.spring), ..Trigger::new(kind, event.time) }
}

fn of_transition(transition: &Transition) -> Trigger {
    let trigger = |kind| Trigger::new(kind, transition.time);
    match transition.kind {
        TransitionKind::SlipOnset => trigger(TriggerKind::SlipOnset),
        TransitionKind::Stop => trigger(TriggerKind::Stop),
        TransitionKind::Pinning { support } => Trigger { support: Some(support), ..trigger(TriggerKind::Pinning) },
        TransitionKind::Unpinning { support } => Trigger { support: Some(support), ..trigger(TriggerKind::Unpinning) },
        TransitionKind::Touch { obstacle }
        | TransitionKind::Separation { obstacle }
        | TransitionKind::SideStick { obstacle }
        | TransitionKind::SideSlip { obstacle }
        | TransitionKind::Impact { obstacle, .. } => Trigger { obstacle: Some(obstacle), ..trigger(TriggerKind::Contact) },
        TransitionKind::Jump { .. } => trigger(TriggerKind::Jump),
    }
}
