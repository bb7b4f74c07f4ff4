//! Follows a quasi-static run and estimates the inertia effect on it.

use super::among_obstacles::AmongObstacles;
use super::follower::{Follower, InertiaEstimate};
use super::open_plane::OpenPlane;
use crate::backend::{Motion, RestoreError, Transition};
use crate::math::{Pose, Vec2};
use crate::model::System;
use crate::scenario::Scenario;
use crate::simulation::{Event, EventKind, Row, Trace};

/// Follows a run: its methods are called for what happens to the load, in order. On an open plane a
/// reduced inertial model runs beside the load, among obstacles a load with inertia.
pub struct Estimator(Box<dyn Follower>);

impl Estimator {
    /// Beside a quasi-static load without dashpots if it `is_rate_independent`, else with them.
    pub fn new(system: &System, start: &Motion, is_rate_independent: bool) -> Self {
        match system.world.obstacles.is_empty() {
            true => Self(Box::new(OpenPlane::new(system, start, is_rate_independent))),
            false => Self(Box::new(AmongObstacles::new(system, start, is_rate_independent))),
        }
    }

    /// A spring was grasped at its `tip` (m, world), with the load at `pose`.
    pub fn attach(&mut self, spring: usize, tip: Vec2, pose: &Pose) {
        self.0.attach(spring, tip, pose);
    }

    /// A spring was released, with the load at `pose`.
    pub fn release(&mut self, spring: usize, pose: &Pose) {
        self.0.release(spring, pose);
    }

    /// These transitions occurred in the last advance.
    pub fn note(&mut self, transitions: &[Transition]) {
        self.0.note(transitions);
    }

    /// The load moved between two poses while the tips moved to `tip_targets`, one entry a spring
    /// (m, world), within `duration` (s).
    pub fn advance(&mut self, before: &Pose, after: &Pose, tip_targets: &[Vec2], duration: f64) {
        self.0.advance(before, after, tip_targets, duration);
    }

    pub fn estimate(&self) -> InertiaEstimate {
        self.0.estimate()
    }

    /// State that [`Estimator::restore`] takes.
    pub fn save(&self) -> serde_json::Value {
        self.0.save()
    }

    /// # Errors
    /// If the state is not from an estimator of the same system.
    pub fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
        self.0.restore(state)
    }

    /// Advances between two rows of a trace; `targets` holds the tips.
    fn advance_through(&mut self, rows: [&Row; 2], events: &[Event], targets: &mut [Vec2]) {
        let [last, next] = rows;
        let pose = last.motion.pose;
        // The load has not moved yet after the events at its row.
        let first = events.partition_point(|event| event.time < last.time);
        let until = events.partition_point(|event| event.time < next.time);
        for event in &events[first..until] {
            targets[event.spring] = event.tip;
            match event.kind {
                EventKind::Grasp => self.attach(event.spring, event.tip, &pose),
                EventKind::Release => self.release(event.spring, &pose),
            }
        }
        next.tips.iter().for_each(|tip| targets[tip.spring] = tip.position);
        let at_end = events[until..].iter().take_while(|event| event.time == next.time);
        at_end.filter(|event| event.kind == EventKind::Release).for_each(|event| targets[event.spring] = event.tip);
        self.advance(&pose, &next.motion.pose, targets, next.time - last.time);
    }
}

impl InertiaEstimate {
    /// Estimate from the trace of a quasi-static run of `scenario`.
    pub fn of(scenario: &Scenario, trace: &Trace) -> Self {
        Self::beside(scenario, trace, false)
    }

    /// Estimate from the trace of a quasi-static run of `scenario`, without its dashpots if it
    /// `is_rate_independent`.
    pub fn beside(scenario: &Scenario, trace: &Trace, is_rate_independent: bool) -> Self {
        let mut estimator = Estimator::new(&scenario.system, &scenario.start, is_rate_independent);
        let mut targets = vec![Vec2::zeros(); scenario.system.springs.len()];
        let until = |row: &Row| trace.transitions.partition_point(|transition| transition.time <= row.time);
        for rows in trace.rows.windows(2) {
            estimator.advance_through([&rows[0], &rows[1]], &trace.events, &mut targets);
            estimator.note(&trace.transitions[until(&rows[0])..until(&rows[1])]);
        }
        estimator.estimate()
    }
}
