//! The estimate for a load among obstacles: a load with inertia at fixed steps beside the
//! quasi-static one.
//!
//! Obstacles push, hold and hit a load as no single oscillator does, so that nothing is reduced
//! here but the accuracy: the steps are longer than those of a run with inertia.

use serde::{Deserialize, Serialize};

use super::displacement::Largest;
use super::follower::{Follower, InertiaEstimate, jump_lengths, jump_share};
use crate::analysis::attribution::{Attribution, Disturbance};
use crate::analysis::trigger::{ByTrigger, Trigger, TriggerKind};
use crate::backend::springs::{Attachments, pulls_with};
use crate::backend::{Backend, BackendKind, BackendOptions, Motion, RestoreError, SavedState, Status, Transition, build};
use crate::math::{Pose, Vec2};
use crate::model::System;

/// Follows a run with a load with inertia.
pub struct AmongObstacles {
    system: System,
    load: Box<dyn Backend>,
    is_rate_independent: bool,
    state: State,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct State {
    /// That of the load with inertia; `None` but in a saved state.
    load: Option<SavedState>,
    /// (s)
    time: f64,
    /// The springs as the quasi-static load has them.
    attachments: Attachments,
    event: Option<(TriggerKind, usize)>,
    jump: Option<f64>,
    /// Obstacle that one of the loads touched, hit or left in the last advance.
    obstacle: Option<usize>,
    attribution: Attribution,
    by_trigger: ByTrigger,
    largest: Option<Largest>,
    /// Edge displacement of the loads from one another now (m).
    displacement: f64,
    /// Quasi-static path length (m), and that of the jumps in it.
    path_length: f64,
    jumps_length: f64,
    start: Pose,
    /// Largest edge displacement of the load with inertia from the start (m).
    reach: f64,
    is_invalid: bool,
    touches_obstacle: bool,
}

/// Longest step (rad of the fastest oscillation, and s). Euler's method then damps that oscillation
/// by a ratio of an eighth, and a step is no longer than one of the quasi-static run by default.
const LONGEST_PHASE: f64 = 0.25;
const LONGEST_STEP: f64 = 2.5e-3;
/// Shortest step (s): a stiffer spring is followed as far as that.
const SHORTEST_STEP: f64 = 1e-5;

/// Step of the load with inertia (s).
pub fn step_among_obstacles(system: &System) -> f64 {
    (LONGEST_PHASE / system.fastest_rate()).clamp(SHORTEST_STEP, LONGEST_STEP)
}

impl AmongObstacles {
    pub fn new(system: &System, start: &Motion, is_rate_independent: bool) -> Self {
        let load = build(system, *start, &BackendOptions::new(BackendKind::Inertial, step_among_obstacles(system)));
        let state = State {
            load: None,
            time: 0.0,
            attachments: Attachments::default(),
            event: None,
            jump: None,
            obstacle: None,
            attribution: Attribution::new(start.twist.edge_speed(system.load.radius) > 0.0),
            by_trigger: ByTrigger::default(),
            largest: None,
            displacement: 0.0,
            path_length: 0.0,
            jumps_length: 0.0,
            start: start.pose,
            reach: 0.0,
            is_invalid: false,
            touches_obstacle: false,
        };
        Self { system: system.clone(), load, is_rate_independent, state }
    }

    /// Takes note of an obstacle in the transitions of one of both loads.
    fn meet(&mut self, transitions: &[Transition]) {
        let met = transitions.iter().find_map(|transition| transition.kind.obstacle());
        self.state.touches_obstacle |= met.is_some();
        self.state.obstacle = self.state.obstacle.or(met);
    }

    /// Frequency of the load on the attached springs (rad/s) and its damping ratio (1).
    fn oscillation(&self) -> [f64; 2] {
        let Self { system, state, .. } = self;
        let springs = || state.attachments.iter().map(|attachment| &system.springs[attachment.spring]);
        let rate = (springs().map(|spring| spring.radial_stiffness).sum::<f64>() / system.load.mass).sqrt();
        let damping: f64 = springs().map(|spring| system.dashpot(spring).0).sum();
        let has_none = self.is_rate_independent || damping == 0.0;
        [rate, if has_none { 0.0 } else { 0.5 * damping / (system.load.mass * rate) }]
    }
}

impl Follower for AmongObstacles {
    fn attach(&mut self, spring: usize, tip: Vec2, pose: &Pose) {
        let brought = self.state.attachments.attach(&self.system.springs, spring, tip, pose);
        if pulls_with(&self.system, spring, brought) {
            self.state.event = Some((TriggerKind::Grasp, spring));
        }
        self.load.attach(spring, tip);
    }

    fn release(&mut self, spring: usize, pose: &Pose) {
        self.state.attachments.release(&self.system.springs, spring, pose);
        self.state.event = Some((TriggerKind::Release, spring));
        self.load.release(spring);
    }

    fn note(&mut self, transitions: &[Transition]) {
        self.meet(transitions);
        for length in jump_lengths(transitions, self.system.load.radius) {
            self.state.jump = Some(self.state.time);
            self.state.jumps_length += length;
        }
    }

    fn advance(&mut self, before: &Pose, after: &Pose, tip_targets: &[Vec2], duration: f64) {
        let radius = self.system.load.radius;
        let (last, [rate, damping_ratio]) = (self.load.motion(), self.oscillation());
        let report = self.load.advance(tip_targets, duration);
        self.state.is_invalid |= report.status == Status::Failed;
        let transitions = self.load.transitions().to_vec();
        self.meet(&transitions);
        let state = &mut self.state;
        state.attachments.move_tips(tip_targets);
        let of_event = |(kind, spring)| Trigger { spring: Some(spring), ..Trigger::new(kind, state.time) };
        let event = state.event.take().map(of_event);
        let displacement = after.edge_displacement(before, radius);
        state.attribution.meet(&Disturbance {
            time: state.time,
            duration,
            displacement,
            event: event.or(state.jump.take().map(|time| Trigger::new(TriggerKind::Jump, time))),
            obstacle: state.obstacle.take(),
            distance: last.pose.edge_displacement(before, radius),
            speed_with_inertia: last.twist.edge_speed(radius),
            rate,
            braking: self.system.braking(),
            damping_ratio,
        });
        let pose = self.load.motion().pose;
        state.time += duration;
        state.path_length += displacement;
        state.reach = state.reach.max(pose.edge_displacement(&state.start, radius));
        state.displacement = pose.edge_displacement(after, radius);
        if state.displacement > state.by_trigger.max() {
            state.largest = Some(Largest { time_s: state.time, trigger: state.attribution.trigger });
        }
        state.by_trigger.add(state.attribution.trigger.kind, state.displacement);
    }

    fn estimate(&self) -> InertiaEstimate {
        let State { by_trigger, largest, displacement, path_length, jumps_length, reach, is_invalid, touches_obstacle, .. } = self.state;
        InertiaEstimate {
            edge_displacement_max_m: by_trigger.max(),
            edge_displacement_final_m: displacement,
            largest,
            by_trigger,
            path_length_m: path_length.max(reach),
            jump_share: jump_share(jumps_length, path_length),
            share: 0.0,
            is_negligible: None,
            is_invalid,
            touches_obstacle,
        }
        .concluded()
    }

    fn save(&self) -> serde_json::Value {
        let state = State { load: self.load.save().ok(), ..self.state.clone() };
        serde_json::to_value(state).expect("a state is plain data")
    }

    fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
        let mut state = State::deserialize(state).map_err(RestoreError::unreadable)?;
        state.attachments.check(&self.system.springs)?;
        let load = state.load.take().ok_or_else(|| RestoreError("it has no load with inertia beside it".into()))?;
        self.load.restore(&load)?;
        self.state = state;
        Ok(())
    }
}
