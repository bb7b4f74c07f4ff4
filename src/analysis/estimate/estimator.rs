//! Follows a quasi-static run and records the displacement of the reduced model from it.

use serde::{Deserialize, Serialize};

use super::displacement::{Displacements, Ends, Largest};
use super::interval::{Interval, MergedTicks};
use super::reduced_model::{ModelStep, ReducedModel, Workspace};
use crate::analysis::attribution::{Attribution, Disturbance};
use crate::analysis::trigger::{ByTrigger, Trigger, TriggerKind};
use crate::backend::contact::Obstacles;
use crate::backend::friction::WarmStart;
use crate::backend::springs::{Attachments, Place, pulls_with};
use crate::backend::{Motion, RestoreError, Transition, TransitionKind};
use crate::math::{Pose, Vec2};
use crate::model::System;
use crate::scenario::Scenario;
use crate::simulation::{Event, EventKind, Row, Trace};

/// Largest edge displacement that counts as agreement, divided by the path length (1).
pub const TOLERANCE_SHARE: f64 = 0.01;
/// Factor by which an estimate must lie below or above the tolerance to decide (1). Of 2,000 random
/// scenes none is measured on the other side: `results/2026-11-26-answers`.
pub const CLEAR: f64 = 3.0;

/// Estimated inertia effect on a quasi-static run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct InertiaEstimate {
    /// Largest edge displacement (m).
    pub edge_displacement_max_m: f64,
    /// Edge displacement at the end of the run (m).
    pub edge_displacement_final_m: f64,
    /// Left out if inertia never moves the load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest: Option<Largest>,
    /// Largest edge displacements, each after the last disturbance that was at least as large as
    /// the oscillation that it met.
    pub by_trigger: ByTrigger,
    /// Length scale of the tolerance (m): the quasi-static path length, or the largest edge
    /// displacement from the start with inertia if that is longer.
    pub path_length_m: f64,
    /// Share of the quasi-static path length that lies in jumps (1).
    #[serde(skip_serializing_if = "is_zero")]
    pub jump_share: f64,
    /// Largest edge displacement divided by the path length (1); zero for a load at rest.
    pub share: f64,
    /// Whether inertia is negligible within 1 % of the path, left out where that is not known; see
    /// [`InertiaEstimate::is_negligible_within`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub is_negligible: Option<bool>,
    /// Whether the reduced inertial model turned too far from the load: the lengths above are then
    /// orders of magnitude.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_invalid: bool,
    /// Whether the load touched an obstacle, or the model met one. The model has none, so that the
    /// lengths above say nothing about the run from then on.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub touches_obstacle: bool,
}

fn is_zero(share: &f64) -> bool {
    *share == 0.0
}

/// Follows a run: its methods are called for what happens to the load, in order.
#[derive(Clone, Debug)]
pub struct Estimator {
    system: System,
    workspace: Workspace,
    /// Least rest length of the attached springs (m).
    shortest: f64,
    /// Time of one radian of the load's oscillation on all attached springs (s).
    radian: f64,
    /// `None` without any.
    obstacles: Option<Obstacles>,
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
    #[serde(default)]
    touches_obstacle: bool,
}

/// Longest interval of a load that slips (rad of its oscillation): forces and directions are
/// steady.
const MOST_PHASE: f64 = 1.0 / 3.0;
/// Longest interval of a load at rest (rad of its oscillation): only forces change.
const MOST_PHASE_AT_REST: f64 = 1.0;

/// Distance of an obstacle from the model, over that of the model from the load, up to which the
/// model meets it (1): between the ends of an interval its oscillation goes as much farther.
const NEXT_TO_MODEL: f64 = 0.15;
/// Number of looks for obstacles in an interval at most (1).
const MOST_LOOKS: f64 = 1000.0;

impl InertiaEstimate {
    /// Estimate from the trace of a quasi-static run of `scenario`.
    pub fn of(scenario: &Scenario, trace: &Trace) -> Self {
        Self::beside(scenario, trace, false)
    }

    /// Estimate from the trace of a quasi-static run of `scenario`, without its dashpots if it
    /// `is_rate_independent`.
    pub fn beside(scenario: &Scenario, trace: &Trace, is_rate_independent: bool) -> Self {
        let mut estimator = Estimator::new(&scenario.system, &scenario.start).beside_rate_independent(is_rate_independent);
        let mut targets = vec![Vec2::zeros(); scenario.system.springs.len()];
        let until = |row: &Row| trace.transitions.partition_point(|transition| transition.time <= row.time);
        for rows in trace.rows.windows(2) {
            estimator.advance_through([&rows[0], &rows[1]], &trace.events, &mut targets);
            estimator.note(&trace.transitions[until(&rows[0])..until(&rows[1])]);
        }
        estimator.estimate()
    }

    /// Whether inertia is negligible within a tolerance (m). It is not for an invalid model. `None`
    /// for a load that touched an obstacle, and for an estimate within a factor of 3 of the
    /// tolerance.
    pub fn is_negligible_within(&self, tolerance_m: f64) -> Option<bool> {
        match self.edge_displacement_max_m {
            _ if self.touches_obstacle => None,
            _ if self.is_invalid => Some(false),
            effect if effect <= tolerance_m / CLEAR => Some(true),
            effect => (effect >= CLEAR * tolerance_m).then_some(false),
        }
    }
}

impl Estimator {
    pub fn new(system: &System, start: &Motion) -> Self {
        let workspace = Workspace::new(system);
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
            touches_obstacle: false,
        };
        Self { workspace, shortest: f64::INFINITY, radian: f64::INFINITY, obstacles: Obstacles::of(system), state, system: system.clone() }
    }

    /// This estimator beside a quasi-static load without dashpots, or with them.
    pub fn beside_rate_independent(mut self, is_rate_independent: bool) -> Self {
        self.workspace.beside_rate_independent = is_rate_independent;
        self
    }

    /// A spring was grasped at its `tip` (m, world), with the load at `pose`.
    pub fn attach(&mut self, spring: usize, tip: Vec2, pose: &Pose) {
        self.end_ticks();
        let brought = self.state.attachments.attach(&self.system.springs, spring, tip, pose);
        if pulls_with(&self.system, spring, brought) {
            self.state.event = Some((TriggerKind::Grasp, spring));
        }
        self.change();
    }

    /// A spring was released, with the load at `pose`.
    pub fn release(&mut self, spring: usize, pose: &Pose) {
        self.end_ticks();
        self.state.attachments.release(&self.system.springs, spring, pose);
        self.state.event = Some((TriggerKind::Release, spring));
        self.change();
    }

    /// These transitions occurred in the last advance.
    pub fn note(&mut self, transitions: &[Transition]) {
        self.state.touches_obstacle |= transitions.iter().any(|transition| transition.kind.obstacle().is_some());
        for transition in transitions {
            if let TransitionKind::Jump { shift, turn, .. } = transition.kind {
                self.state.jump = Some(self.state.time);
                self.state.jumps_length += shift + self.system.load.radius * turn.abs();
            }
        }
    }

    /// Updates what follows from the attachments.
    fn change(&mut self) {
        self.workspace.springs.change();
        let (springs, attachments) = (&self.system.springs, &self.state.attachments);
        self.shortest = attachments.iter().map(|attachment| springs[attachment.spring].rest_length).fold(f64::INFINITY, f64::min);
        self.radian = (self.system.load.mass / attachments.largest_stiffness(springs)).sqrt();
    }

    /// The load moved between two poses while the tips moved to `tip_targets`, one entry a spring
    /// (m, world), within `duration` (s).
    pub fn advance(&mut self, before: &Pose, after: &Pose, tip_targets: &[Vec2], duration: f64) {
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
        self.look_for_obstacles(&last.pose, ends[1]);
    }

    /// Takes note of obstacles on the way of the model from its `last` pose, next to a load at
    /// `load`.
    fn look_for_obstacles(&mut self, last: &Pose, load: &Pose) {
        let Self { system, obstacles: Some(obstacles), state, .. } = self else { return };
        if state.touches_obstacle {
            return;
        }
        let (end, radius) = (&state.model.pose, system.load.radius);
        let reach = NEXT_TO_MODEL * end.edge_displacement(load, radius);
        // A load that moves by less than its radius leaps over nothing.
        let n_looks = (end.edge_displacement(last, radius) / radius).ceil().clamp(1.0, MOST_LOOKS);
        let shift = end.position - last.position;
        state.touches_obstacle = (0..n_looks as u32).any(|look| {
            let share = 1.0 - f64::from(look) / n_looks;
            let pose = Pose { position: last.position + share * shift, heading: last.heading + share * (end.heading - last.heading) };
            obstacles.is_near(system, &Place::of(&pose), state.time, reach)
        });
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
            damping_ratio: if self.workspace.beside_rate_independent { 0.0 } else { step.damping_ratio },
        });
    }

    pub fn estimate(&self) -> InertiaEstimate {
        let mut so_far = self.clone();
        so_far.end_ticks();
        let State { displacements, path_length, jumps_length, reach, is_invalid, touches_obstacle, .. } = &so_far.state;
        let edge_displacement_max_m = displacements.by_trigger.max();
        let path_length_m = path_length.max(*reach);
        let mut estimate = InertiaEstimate {
            edge_displacement_max_m,
            edge_displacement_final_m: displacements.shift + self.system.load.radius * displacements.turn,
            largest: displacements.largest,
            by_trigger: displacements.by_trigger,
            path_length_m,
            // A jump and the slide after it in one tick may go back and forth, so that the tick is
            // shorter than the jump.
            jump_share: if *path_length > 0.0 { (jumps_length / path_length).min(1.0) } else { 0.0 },
            share: if path_length_m > 0.0 { edge_displacement_max_m / path_length_m } else { 0.0 },
            is_negligible: None,
            is_invalid: *is_invalid,
            touches_obstacle: *touches_obstacle,
        };
        estimate.is_negligible = estimate.is_negligible_within(TOLERANCE_SHARE * path_length_m);
        estimate
    }

    /// State that [`Estimator::restore`] takes.
    pub fn save(&self) -> serde_json::Value {
        let (warm_start, resting_forces) = (self.workspace.solver.warm_start().clone(), self.workspace.static_friction.forces().to_vec());
        let state = State { warm_start, resting_forces, ..self.state.clone() };
        serde_json::to_value(state).expect("a state is plain data")
    }

    /// # Errors
    /// If the state is not from an estimator of the same system.
    pub fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
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
