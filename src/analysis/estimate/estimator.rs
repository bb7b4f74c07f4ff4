//! Follows a quasi-static run and keeps how far the load's shadow lies from it, and why.

use serde::{Deserialize, Serialize};

use super::apart::{Apart, Both, Cause, Largest, Occasion};
use super::shadow::{Followed, Shadow, Tick, Tools};
use super::slip::apart;
use super::stride::Stride;
use crate::backend::friction::WarmStart;
use crate::backend::springs::{Attachments, pulls_with};
use crate::backend::{Motion, RestoreError};
use crate::math::{Pose, Vec2};
use crate::model::System;
use crate::scenario::Scenario;
use crate::simulation::{Event, EventKind, Row, Trace};

/// What inertia would have done. Displacements are those of the load's rim: shift plus radius times turn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct InertiaEstimate {
    /// Largest shift plus radius times turn at one instant, as in a comparison of paths (m).
    pub displacement_max_m: f64,
    /// At the end of the run (m).
    pub displacement_final_m: f64,
    /// Left out where the load would be in no other place at any time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest: Option<Largest>,
    /// Largest displacement after a start with speed (m).
    pub from_start_m: f64,
    /// After jumps at grasps and releases (m).
    pub from_jumps_m: f64,
    /// While tips drive the load, or stop to (m).
    pub from_driving_m: f64,
    /// Length of the way of the load's rim without inertia, or how far the load with inertia gets from where it started, whichever is longer (m).
    pub path_length_m: f64,
    /// Largest displacement over [`InertiaEstimate::path_length_m`] (1); zero where the load stays.
    pub share: f64,
    /// Whether the share is at most that which counts as agreement, of a load that was not lost.
    pub is_negligible: bool,
    /// Whether the load with inertia has turned so far away from the one without that all that is known of it is that: the lengths above are no more than their orders.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_lost: bool,
}

/// Follows a run call by call: what happens to the load is told to it, in the order in which it happens.
#[derive(Clone, Debug)]
pub struct Estimator {
    system: System,
    tools: Tools,
    /// Least rest length of the held springs (m).
    shortest: f64,
    /// Time in which a load on the held springs side by side swings by a radian (s).
    radian: f64,
    state: State,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct State {
    held: Attachments,
    shadow: Shadow,
    /// Where the present stride began, or will (s).
    time: f64,
    stride: Stride,
    /// Way of tips and load since the swings' branches were last looked at (m).
    gone: f64,
    /// The last grasp that pulled or release since the load last moved on.
    event: Option<(Cause, usize)>,
    /// Of the load without inertia, on the rim (m/s).
    speed: f64,
    occasion: Occasion,
    apart: Apart,
    /// Way of the rim without inertia (m).
    way: f64,
    start: Pose,
    /// How far from there the rim with inertia has been (m).
    reach: f64,
    warm_start: WarmStart,
    /// Of the supports when the shadow last rested (N, load axes).
    bearing: Vec<Vec2>,
    /// The shadow has been too far away to be followed well.
    #[serde(default)]
    is_lost: bool,
}

/// Longest stride of a load that slips, in radians of the held springs' oscillation (1): so long, forces and directions of slip are steady.
const MOST_PHASE: f64 = 1.0 / 3.0;
/// Of one that rests, where nothing but forces changes.
const MOST_PHASE_AT_REST: f64 = 1.0;

impl InertiaEstimate {
    /// From the trace of a quasi-static run of `scenario`; `agreement` is the share of its way that counts as negligible (1).
    pub fn of(scenario: &Scenario, trace: &Trace, agreement: f64) -> Self {
        let mut estimator = Estimator::new(&scenario.system, &scenario.start);
        let mut targets = vec![Vec2::zeros(); scenario.system.springs.len()];
        for rows in trace.rows.windows(2) {
            estimator.advance_through([&rows[0], &rows[1]], &trace.events, &mut targets);
        }
        estimator.estimate(agreement)
    }
}

impl Estimator {
    pub fn new(system: &System, start: &Motion) -> Self {
        let tools = Tools::new(system);
        let shadow = Shadow::new(system, start);
        let cause = if shadow.speed > 0.0 { Cause::Start } else { Cause::Driving };
        let state = State {
            held: Attachments::default(),
            shadow,
            time: 0.0,
            stride: Stride::new(system.springs.len()),
            gone: 0.0,
            event: None,
            speed: 0.0,
            occasion: Occasion { cause, spring: None, time: 0.0 },
            apart: Apart::default(),
            way: 0.0,
            start: start.pose,
            reach: 0.0,
            warm_start: tools.solver.warm_start().clone(),
            bearing: tools.bearing.forces().to_vec(),
            is_lost: false,
        };
        Self { system: system.clone(), tools, shortest: f64::INFINITY, radian: f64::INFINITY, state }
    }

    /// The load at `pose` was grasped at the `tip` of a spring (m, world).
    pub fn attach(&mut self, spring: usize, tip: Vec2, pose: &Pose) {
        self.end_stride();
        let brought = self.state.held.attach(&self.system.springs, spring, tip, pose);
        if pulls_with(&self.system, spring, brought) {
            self.state.event = Some((Cause::Grasp, spring));
        }
        self.change();
    }

    /// A spring of the load at `pose` was let go.
    pub fn release(&mut self, spring: usize, pose: &Pose) {
        self.end_stride();
        self.state.held.release(&self.system.springs, spring, pose);
        self.state.event = Some((Cause::Release, spring));
        self.change();
    }

    /// Takes note of other springs than before.
    fn change(&mut self) {
        self.tools.springs.change();
        let (springs, held) = (&self.system.springs, &self.state.held);
        self.shortest = held.iter().map(|grip| springs[grip.spring].rest_length).fold(f64::INFINITY, f64::min);
        self.radian = (self.system.load.mass / held.largest_stiffness(springs)).sqrt();
    }

    /// The load went from one pose to another while the tips went to `tip_targets` (m, world, one entry a spring) within `duration` (s).
    pub fn advance(&mut self, before: &Pose, after: &Pose, tip_targets: &[Vec2], duration: f64) {
        let (State { stride, held, .. }, rests) = (&self.state, before == after);
        let longest = self.radian * if rests { MOST_PHASE_AT_REST } else { MOST_PHASE };
        let goes_on = || stride.rests() == rests && stride.duration + duration <= longest && stride.leads_on(held, tip_targets, duration);
        if stride.is_begun() && !goes_on() {
            self.end_stride();
        }
        self.state.stride.extend([before, after], tip_targets, duration);
        // What a shadow does alone turns on itself, tick by tick.
        let moves_alone = rests && self.state.shadow.speed > 0.0;
        if moves_alone || self.state.event.is_some() {
            self.end_stride();
        }
    }

    /// Lets the shadow follow through the ticks so far.
    fn end_stride(&mut self) {
        let Self { system, tools, state, .. } = self;
        let Stride { before, after, duration, .. } = state.stride;
        if duration == 0.0 {
            return;
        }
        state.stride.duration = 0.0;
        let last = state.shadow;
        let is_event = state.event.is_some();
        let tick = Tick { before: &before, after: &after, held: &state.held, targets: &state.stride.targets, is_event, duration };
        let followed = state.shadow.follow(system, &tick, tools);
        state.is_lost |= followed.is_lost;
        let tips = state.held.move_tips(&state.stride.targets);
        let rests = before == after && !is_event && state.speed == 0.0 && followed == Followed::default();
        let distance = if rests { 0.0 } else { apart(&before, &after, system.load.radius) };
        self.follow_swings(&after, tips + distance);
        if rests {
            self.state.time += duration;
        } else {
            self.note(&last, [&before, &after], distance, duration, &followed);
        }
    }

    /// Keeps the branches of the swings, as soon as tips and load have gone far enough for swings to have changed by some share of a turn.
    fn follow_swings(&mut self, pose: &Pose, way: f64) {
        const FAR: f64 = 0.2;
        let Self { system, state, .. } = self;
        state.gone += way;
        if state.gone > FAR * self.shortest {
            state.held.accept(&system.springs, pose);
            state.gone = 0.0;
            self.tools.springs.change();
        }
    }

    /// Notes a stride in which load or shadow moved, or began or ceased to: where the shadow was `last`, and how it and the load went on.
    fn note(&mut self, last: &Shadow, ends: [&Pose; 2], distance: f64, duration: f64, followed: &Followed) {
        let swing = |speed: f64| if followed.frequency > 0.0 { speed / followed.frequency } else { 0.0 };
        let amplitude =
            (apart(ends[0], &last.pose, self.system.load.radius).powi(2) + swing((last.speed - self.state.speed).abs()).powi(2)).sqrt();
        self.note_occasion(distance, duration, amplitude, swing);
        let state = &mut self.state;
        state.time += duration;
        state.way += distance;
        state.reach = state.reach.max(apart(&state.start, &state.shadow.pose, self.system.load.radius));
        let both = Both { load: ends, shadow: [last, &state.shadow], duration, is_short: duration <= MOST_PHASE * self.radian };
        state.apart.note(&both, self.system.load.radius, state.time, &state.occasion);
    }

    /// A disturbance that is larger than the oscillation it meets (m) is what the displacement comes from henceforth: a jump by its way, a change of speed by the
    /// swing that it gives.
    fn note_occasion(&mut self, distance: f64, duration: f64, amplitude: f64, swing: impl Fn(f64) -> f64) {
        let state = &mut self.state;
        let speed = distance / duration;
        let jump = state.event.take().filter(|_| distance > 0.0 && distance >= amplitude);
        if let Some((cause, spring)) = jump {
            state.occasion = Occasion { cause, spring: Some(spring), time: state.time };
        } else if speed != state.speed && swing((speed - state.speed).abs()) >= amplitude {
            state.occasion = Occasion { cause: Cause::Driving, spring: None, time: state.time };
        }
        // The speed of a jump is that of the steps it took.
        state.speed = if jump.is_some() { 0.0 } else { speed };
    }

    /// What has been found so far; `agreement` is the share of the way that counts as negligible (1).
    pub fn estimate(&self, agreement: f64) -> InertiaEstimate {
        let mut so_far = self.clone();
        so_far.end_stride();
        let State { apart, way, reach, is_lost, .. } = &so_far.state;
        let displacement_max_m = apart.displacement_max();
        let path_length_m = way.max(*reach);
        InertiaEstimate {
            displacement_max_m,
            displacement_final_m: apart.shift + self.system.load.radius * apart.turn,
            largest: apart.largest,
            from_start_m: apart.from_start,
            from_jumps_m: apart.from_jumps,
            from_driving_m: apart.from_driving,
            path_length_m,
            share: if path_length_m > 0.0 { displacement_max_m / path_length_m } else { 0.0 },
            is_negligible: !is_lost && displacement_max_m <= agreement * path_length_m,
            is_lost: *is_lost,
        }
    }

    pub fn save(&self) -> serde_json::Value {
        let (warm_start, bearing) = (self.tools.solver.warm_start().clone(), self.tools.bearing.forces().to_vec());
        let state = State { warm_start, bearing, ..self.state.clone() };
        serde_json::to_value(state).expect("a state is plain data")
    }

    /// # Errors
    /// When the state is not one that an estimator of this system saved.
    pub fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
        let system = &self.system;
        let state = State::deserialize(state).map_err(|error| RestoreError(error.to_string()))?;
        state.held.check(&system.springs)?;
        self.tools.solver.set_warm_start(state.warm_start.clone())?;
        if !self.tools.bearing.set_forces(&state.bearing) {
            return Err(RestoreError(format!("{} forces on {} supports", state.bearing.len(), system.ground.supports.len())));
        }
        if state.stride.targets.len() != system.springs.len() {
            return Err(RestoreError(format!("{} tips of {} springs", state.stride.targets.len(), system.springs.len())));
        }
        self.state = state;
        self.change();
        Ok(())
    }

    /// What a trace tells between two of its rows; `targets` keeps where the tips are.
    fn advance_through(&mut self, rows: [&Row; 2], events: &[Event], targets: &mut [Vec2]) {
        let [last, next] = rows;
        let pose = last.motion.pose;
        // The load of a row has not moved yet after what happened there.
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
