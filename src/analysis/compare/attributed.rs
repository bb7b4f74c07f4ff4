//! Attribution of the measured inertia effect to triggers.

use super::difference::Jumps;
use super::solution::Solution;
use crate::analysis::attribution::{Attribution, Disturbance};
use crate::analysis::trigger::{ByTrigger, Trigger, TriggerKind};
use crate::backend::{Transition, TransitionKind};
use crate::model::System;
use crate::simulation::{Event, EventKind, Row};

/// Triggers of the distance between the paths with and without inertia.
pub(super) struct Attributed {
    /// Triggers in the order of time, each until the next one.
    triggers: Vec<Trigger>,
    pub by_trigger: ByTrigger,
}

/// Pull below which a grasp or a release moves nothing, over the sum of the slip limits (1).
const LEAST_PULL: f64 = 1e-6;

impl Attributed {
    /// Attribution of an inertial path beside the quasi-static one, outside of its jumps.
    /// A `rate_independent` quasi-static load has no dashpots.
    pub fn new(system: &System, [inertial, quasi_static]: [&Solution; 2], jumps: &Jumps, rate_independent: bool) -> Self {
        let (with, without) = (&inertial.trace.rows, &quasi_static.trace.rows);
        let mut attribution = Attribution::new(starts_with_speed(inertial));
        let mut found = Self { triggers: vec![attribution.trigger], by_trigger: ByTrigger::default() };
        let events = pulling_events(system, quasi_static);
        let radius = system.load.radius;
        for at in 1..without.len().min(with.len()) {
            let (before, after) = (&without[at - 1], &without[at]);
            let span = [before.time, after.time];
            attribution.meet(&Disturbance {
                time: before.time,
                duration: after.time - before.time,
                displacement: after.motion.pose.edge_displacement(&before.motion.pose, radius),
                event: last_in(&events, span).or_else(|| jump_in(quasi_static, span)),
                obstacle: obstacle_in(quasi_static, span).or_else(|| obstacle_in(inertial, span)),
                distance: with[at - 1].motion.pose.edge_displacement(&before.motion.pose, radius),
                speed_with_inertia: with[at - 1].motion.twist.edge_speed(radius),
                rate: rate_on(system, after),
                braking: system.braking(),
                damping_ratio: if rate_independent { 0.0 } else { damping_on(system, after) },
            });
            if found.triggers.last() != Some(&attribution.trigger) {
                found.triggers.push(attribution.trigger);
            }
            if jumps.allow(after.time) {
                let distance = with[at].motion.pose.edge_displacement(&after.motion.pose, radius);
                found.by_trigger.add(attribution.trigger.kind, distance);
            }
        }
        found
    }

    /// Trigger of the distance at an instant (s); `None` at the start of a load at rest.
    pub fn trigger_at(&self, time: f64) -> Option<Trigger> {
        self.triggers[..self.triggers.partition_point(|trigger| trigger.time_s < time)].last().copied()
    }
}

/// Whether the load has kinetic energy at the start.
pub(super) fn starts_with_speed(solution: &Solution) -> bool {
    solution.trace.rows.first().is_some_and(|row| row.energy.initial > 0.0)
}

/// Grasps and releases of springs that pull.
fn pulling_events(system: &System, quasi_static: &Solution) -> Vec<Trigger> {
    let rows = &quasi_static.trace.rows;
    let pulls = |event: &&Event| {
        let at = rows.partition_point(|row| row.time < event.time);
        let pull = |row: &Row| row.tips.iter().find(|tip| tip.spring == event.spring).map_or(0.0, |tip| tip.pull.norm());
        let pull = rows[at.saturating_sub(1)..rows.len().min(at + 1)].iter().map(pull).fold(0.0, f64::max);
        pull > LEAST_PULL * system.total_slip_limit()
    };
    quasi_static.trace.events.iter().filter(pulls).map(of_event).collect()
}

pub(super) fn of_event(event: &Event) -> Trigger {
    let kind = match event.kind {
        EventKind::Grasp => TriggerKind::Grasp,
        EventKind::Release => TriggerKind::Release,
    };
    Trigger { spring: Some(event.spring), ..Trigger::new(kind, event.time) }
}

/// Last event from the start of a span until before its end.
fn last_in(events: &[Trigger], [from, to]: [f64; 2]) -> Option<Trigger> {
    events[..events.partition_point(|event| event.time_s < to)].last().filter(|event| event.time_s >= from).copied()
}

/// Transitions after the start of a span, up to its end.
fn transitions_in(solution: &Solution, [from, to]: [f64; 2]) -> &[Transition] {
    let transitions = &solution.trace.transitions;
    let until = |time: f64| transitions.partition_point(|transition| transition.time <= time);
    &transitions[until(from)..until(to)]
}

fn jump_in(quasi_static: &Solution, span: [f64; 2]) -> Option<Trigger> {
    let jumps = |transition: &&Transition| matches!(transition.kind, TransitionKind::Jump { .. });
    transitions_in(quasi_static, span).iter().find(jumps).map(|jump| Trigger::new(TriggerKind::Jump, jump.time))
}

fn obstacle_in(solution: &Solution, span: [f64; 2]) -> Option<usize> {
    transitions_in(solution, span).iter().find_map(|transition| transition.kind.obstacle())
}

/// Frequency of the load on the springs that are attached in a row (rad/s).
fn rate_on(system: &System, row: &Row) -> f64 {
    let stiffness: f64 = row.tips.iter().map(|tip| system.springs[tip.spring].radial_stiffness).sum();
    (stiffness / system.load.mass).sqrt()
}

/// Damping ratio of that oscillation (1).
fn damping_on(system: &System, row: &Row) -> f64 {
    let damping: f64 = row.tips.iter().map(|tip| system.dashpot(&system.springs[tip.spring]).0).sum();
    if damping > 0.0 { 0.5 * damping / (system.load.mass * rate_on(system, row)) } else { 0.0 }
}
