//! The estimate for a load on an open plane: follows a quasi-static run and records the
//! displacement of the reduced model from it.

use serde::{Deserialize, Serialize};

use super::displacement::{Displacements, Ends};
use super::follower::{Follower, InertiaEstimate, jump_lengths, jump_share};
use super::interval::{Interval, MergedTicks};
use super::reduced_model::{ModelStep, ReducedModel, Workspace};
use crate::analysis::attribution::{Attribution, Disturbance};
use crate::analysis::trigger::{Trigger, TriggerKind};
use crate::backend::friction::WarmStart;
use crate::backend::springs::{Attachments, pulls_with};
use crate::backend::{Motion, RestoreError, Transition};
use crate::math::{Pose, Vec2};
use crate::model::System;

/// Follows a run with the reduced inertial model.
#[derive(Clone, Debug)]
pub struct OpenPlane {
    system: System,
    workspace: Workspace,
    /// Least rest length of the attached springs (m).
    shortest: f64,
    /// Time of one radian of the load's oscillation on all attached springs (s).
    radian: f64,
    state: State,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct State {
    attachments: Attachments,
    model: ReducedModel,
    /// Start of the merged ticks (s).
    time: f64,
    ticks: MergedTicks,
    /// Path length of tips and load since the branches of the swings were last updated (m).
    since_branches: f64,
    /// Last grasp or release since the load last moved.
    event: Option<(TriggerKind, usize)>,
    /// Time of a quasi-static jump without a grasp or a release, in the merged ticks (s).
    #[serde(default)]
    jump: Option<f64>,
    attribution: Attribution,
    displacements: Displacements,
    /// Quasi-static path length (m), and that of the jumps in it.
    path_length: f64,
    #[serde(default)]
    jumps_length: f64,
    start: Pose,
    /// Largest edge displacement of the model from the start (m).
    reach: f64,
    warm_start: WarmStart,
    /// Forces on the supports when the model last rested (N, load axes).
    resting_forces: Vec<Vec2>,
    /// Whether the model was invalid at some time.
    #[serde(default)]
    is_invalid: bool,
}

/// Longest interval of a load that slips (rad of its oscillation): forces and directions are
/// steady.
const MOST_PHASE: f64 = 1.0 / 3.0;
/// Longest interval of a load at rest (rad of its oscillation): only forces change.
const MOST_PHASE_AT_REST: f64 = 1.0;

impl OpenPlane {
    pub fn new(system: &System, start: &Motion, is_rate_independent: bool) -> Self {
        let workspace = Workspace::new(system, is_rate_independent);
        let model = ReducedModel::new(system, start);
        let state = State {
            attachments: Attachments::default(),
            model,
            time: 0.0,
            ticks: MergedTicks::new(system.springs.len()),
            since_branches: 0.0,
            event: None,
            jump: None,
            attribution: Attribution::new(model.speed > 0.0),
            displacements: Displacements::default(),
            path_length: 0.0,
            jumps_length: 0.0,
            start: start.pose,
            reach: 0.0,
            warm_start: workspace.solver.warm_start().clone(),
            resting_forces: workspace.static_friction.forces().to_vec(),
            is_invalid: false,
        };
        Self { workspace, shortest: f64::INFINITY, radian: f64::INFINITY, state, system: system.clone() }
    }

    /// Updates what follows from the attachments.
    fn change(&mut self) {
        self.workspace.springs.change();
        let (springs, attachments) = (&self.system.springs, &self.state.attachments);
        self.shortest = attachments.iter().map(|attachment| springs[attachment.spring].rest_length).fold(f64::INFINITY, f64::min);
        self.radian = (self.system.load.mass / attachments.largest_stiffness(springs)).sqrt();
    }

    /// Advances the model through the merged ticks.
    fn end_ticks(&mut self) {
        let Self { system, workspace, state, .. } = self;
        let MergedTicks { before, after, duration, .. } = state.ticks;
        if duration == 0.0 {
            return;
        }
        state.ticks.duration = 0.0;
        let last = state.model;
        let is_event = state.event.is_some();
        let interval =
            Interval { before: &before, after: &after, attachments: &state.attachments, targets: &state.ticks.targets, is_event, duration };
        let step = state.model.advance(system, &interval, workspace);
        state.is_invalid |= step.is_invalid;
        let tips = state.attachments.move_tips(&state.ticks.targets);
        let rests = before == after && !is_event && state.attribution.rests() && step == ModelStep::default();
        let distance = if rests { 0.0 } else { after.edge_displacement(&before, system.load.radius) };
        self.follow_swings(&after, tips + distance);
        if rests {
            self.state.time += duration;
        } else {
            self.record(&last, [&before, &after], distance, duration, &step);
        }
    }

    /// Updates the branches of the swings after a `length` (m) that may change a swing noticeably.
    fn follow_swings(&mut self, pose: &Pose, length: f64) {
        const FAR: f64 = 0.2;
        let Self { system, state, .. } = self;
        state.since_branches += length;
        if state.since_branches > FAR * self.shortest {
            state.attachments.accept(&system.springs, pose);
            state.since_branches = 0.0;
            self.workspace.springs.change();
        }
    }

    /// Records an interval in which load or model moved, started or stopped, from the `last` state
    /// of the model.
    fn record(&mut self, last: &ReducedModel, ends: [&Pose; 2], distance: f64, duration: f64, step: &ModelStep) {
        self.attribute(last, ends[0], distance, duration, step);
        let state = &mut self.state;
        state.time += duration;
        state.path_length += distance;
        state.reach = state.reach.max(state.model.pose.edge_displacement(&state.start, self.system.load.radius));
        let of_both = Ends { load: ends, model: [last, &state.model], duration, is_short: duration <= MOST_PHASE * self.radian };
        state.displacements.add(&of_both, self.system.load.radius, state.time, &state.attribution.trigger);
    }

    /// Adds an interval of this `duration` (s) to the attribution, in which the load moved by a
    /// `displacement` (m) and the model took a `step`.
    fn attribute(&mut self, last: &ReducedModel, before: &Pose, displacement: f64, duration: f64, step: &ModelStep) {
        let state = &mut self.state;
        let of_event = |(kind, spring)| Trigger { spring: Some(spring), ..Trigger::new(kind, state.time) };
        let event = state.event.take().map(of_event);
        state.attribution.meet(&Disturbance {
            time: state.time,
            duration,
            displacement,
            event: event.or(state.jump.take().map(|time| Trigger::new(TriggerKind::Jump, time))),
            obstacle: None,
            distance: last.pose.edge_displacement(before, self.system.load.radius),
            speed_with_inertia: last.speed,
            rate: step.frequency,
            braking: self.system.braking(),
            damping_ratio: if self.workspace.beside_rate_independent { 0.0 } else { step.damping_ratio },
        });
    }
}

impl Follower for OpenPlane {
    fn attach(&mut self, spring: usize, tip: Vec2, pose: &Pose) {
        self.end_ticks();
        let brought = self.state.attachments.attach(&self.system.springs, spring, tip, pose);
        if pulls_with(&self.system, spring, brought) {
            self.state.event = Some((TriggerKind::Grasp, spring));
        }
        self.change();
    }

    fn release(&mut self, spring: usize, pose: &Pose) {
        self.end_ticks();
        self.state.attachments.release(&self.system.springs, spring, pose);
        self.state.event = Some((TriggerKind::Release, spring));
        self.change();
    }

    fn note(&mut self, transitions: &[Transition]) {
        for length in jump_lengths(transitions, self.system.load.radius) {
            self.state.jump = Some(self.state.time);
            self.state.jumps_length += length;
        }
    }

    fn advance(&mut self, before: &Pose, after: &Pose, tip_targets: &[Vec2], duration: f64) {
        let (State { ticks, attachments, .. }, rests) = (&self.state, before == after);
        let longest = self.radian * if rests { MOST_PHASE_AT_REST } else { MOST_PHASE };
        let continues =
            || ticks.rest() == rests && ticks.duration + duration <= longest && ticks.continue_to(attachments, tip_targets, duration);
        if ticks.are_begun() && !continues() {
            self.end_ticks();
        }
        self.state.ticks.extend([before, after], tip_targets, duration);
        // A model that moves alone turns at every tick.
        let moves_alone = rests && self.state.model.speed > 0.0;
        if moves_alone || self.state.event.is_some() {
            self.end_ticks();
        }
    }

    fn estimate(&self) -> InertiaEstimate {
        let mut so_far = self.clone();
        so_far.end_ticks();
        let State { displacements, path_length, jumps_length, reach, is_invalid, .. } = so_far.state;
        InertiaEstimate {
            edge_displacement_max_m: displacements.by_trigger.max(),
            edge_displacement_final_m: displacements.shift + self.system.load.radius * displacements.turn,
            largest: displacements.largest,
            by_trigger: displacements.by_trigger,
            path_length_m: path_length.max(reach),
            jump_share: jump_share(jumps_length, path_length),
            share: 0.0,
            is_negligible: None,
            is_invalid,
            touches_obstacle: false,
        }
        .concluded()
    }

    fn save(&self) -> serde_json::Value {
        let (warm_start, resting_forces) = (self.workspace.solver.warm_start().clone(), self.workspace.static_friction.forces().to_vec());
        let state = State { warm_start, resting_forces, ..self.state.clone() };
        serde_json::to_value(state).expect("a state is plain data")
    }

    fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
        let system = &self.system;
        let state = State::deserialize(state).map_err(RestoreError::unreadable)?;
        state.attachments.check(&system.springs)?;
        self.workspace.solver.set_warm_start(state.warm_start.clone())?;
        if !self.workspace.static_friction.set_forces(&state.resting_forces) {
            return Err(RestoreError(format!("{} forces on {} supports", state.resting_forces.len(), system.ground.supports.len())));
        }
        if state.ticks.targets.len() != system.springs.len() {
            return Err(RestoreError(format!("{} tips of {} springs", state.ticks.targets.len(), system.springs.len())));
        }
        self.state = state;
        self.change();
        Ok(())
    }
}
