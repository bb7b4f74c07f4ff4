//! The reference dynamics: the load's equation of motion with its springs, dashpots and exact
//! Coulomb friction, by implicit Euler (`euler`, first order) or the midpoint rule (`midpoint`,
//! second order).
//!
//! Both hold a load that sticks exactly where it is. Euler is stable at any step, damps numerically
//! by the ratio omega h / 2, and becomes the quasi-static step as the mass goes to zero, by the
//! same code. Midpoint damps nothing and oscillates where a step does not resolve an oscillation.
//! It is stable at any step too, except with Fox and Goodwin's weights, which are stable up to
//! sqrt(6) radians of an oscillation. It takes those where a step resolves the oscillations of
//! springs at their rest shapes; springs stretched many times turn the load faster.

use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use super::contact::GroundContact;
use super::dashpots::Dashpots;
use super::load::{Exact, Method, State};
use super::one_step::{Among, Integrator, PastFriction, Problem, Stepped, Touched};
use super::{control, euler, midpoint, resolution};
use crate::backend::contact::{Instant, PairKey, Scope, SideMode, SideWork, Touching, Turn, gap_rounding};
use crate::backend::friction::ContactMode;
use crate::backend::numerics::{LONGEST_MACRO_STEP, ROUNDED_FORCE, SLOW_SUPPORT};
use crate::backend::report::{Motion, RestoreError, Skips, Status, StepReport};
use crate::backend::springs::TipPaths;
use crate::backend::stepping::Stepping;
use crate::math::{Arc, Twist, Vec2, perpendicular, rotation};
use crate::model::{Load, System};

/// The methods with inertia.
pub struct Inertial {
    pub(super) integrator: Integrator,
    resolving_step: f64,
    pub(super) is_damped: bool,
    /// Whether steps are shortened where springs are deformed far.
    adapts_step: bool,
    pub(super) dashpots: Dashpots,
}

/// What a step with inertia leaves for the next one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Memory {
    /// Force of each spring's dashpot on its tip in the last step (N, world); zero for free
    /// springs.
    dashpot_on_tip: Vec<Vec2>,
    past: Option<PastFriction>,
    /// The last step, if the load touched in the same modes all along.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) touched: Option<Touched>,
}

impl Memory {
    /// Forgets the last steps, after a change of velocity.
    pub(super) fn forget_steps(&mut self) {
        (self.past, self.touched) = (None, None);
    }
}

impl Exact<Inertial> {
    pub fn inertial(system: &System, start: Motion, stepping: Stepping, integrator: Integrator, skips: Skips) -> Self {
        let is_damped = system.springs.iter().any(|spring| spring.damping_ratio > 0.0);
        let resolving_step = if is_damped { 0.0 } else { 1.0 / system.fastest_rate() };
        let memory = Memory { dashpot_on_tip: vec![Vec2::zeros(); system.springs.len()], past: None, touched: None };
        let method = Inertial { integrator, resolving_step, is_damped, adapts_step: false, dashpots: Dashpots::default() };
        Self::with(method, memory, (system.clone(), start), stepping, skips)
    }

    /// This backend with steps that are shortened, or not, where springs are deformed far.
    pub fn adapting(mut self, adapts_step: bool) -> Self {
        self.method.adapts_step = adapts_step;
        self
    }

    /// Shifts the speed of a load that turns about a support by half of a `step` (s). The sign 1
    /// takes it back from an instant to the middle of the step before it, where steps have it, and
    /// -1 takes it forward. A step from the speed of an instant sees only half of the force that
    /// keeps the load on its circle. It would prevent the slip onset of a support, or stop a
    /// slipping support, at any length of the step.
    fn shift_speed(&mut self, support: usize, step: f64, sign: f64) {
        let Motion { pose, mut twist } = self.state.motion;
        let arm = rotation(pose.heading) * self.system.ground.supports[support].offset;
        let mean_arm = Arc::of(-twist.angular * step).mean_rotation() * arm;
        twist.linear += sign * twist.angular * perpendicular(&(arm - mean_arm));
        self.set_speed(twist);
    }

    /// Velocity that is turned along these contacts, which were closed before a step, to its chord
    /// or back; `None` where it stays.
    fn turned(&self, closed: &[Touching], at: (Instant, Turn), creeping: &mut SmallVec<[PairKey; 2]>) -> Option<Twist> {
        let obstacles = self.obstacles.as_ref().filter(|_| self.state.motion.twist != Twist::ZERO)?;
        let now = |before: &Touching| {
            let now = self.state.side.touching.iter().find(|now| now.key == before.key);
            now.copied().unwrap_or(Touching { mode: SideMode::Open, ..*before })
        };
        let touching: SmallVec<[Touching; 2]> = closed.iter().map(now).collect();
        obstacles.turned(&self.system, &self.state.motion, &touching, at, creeping)
    }

    /// Whether a contact that was closed before presses no more.
    fn has_opened(&self, closed: &[Touching]) -> bool {
        let presses = |before: &Touching| self.state.side.touching.iter().any(|now| now.key == before.key && now.mode != SideMode::Open);
        !closed.iter().all(presses)
    }

    /// Corrects the velocity at an instant.
    pub(super) fn set_speed(&mut self, twist: Twist) {
        let State { motion, energy, .. } = &mut self.state;
        motion.twist = twist;
        let kinetic = self.system.load.kinetic_energy(&twist);
        energy.numerical_damping -= kinetic - energy.kinetic;
        energy.kinetic = kinetic;
    }

    /// Takes a step of a load that touches nothing.
    pub(super) fn step_freely(&mut self, paths: &TipPaths, from: f64, to: f64) -> StepReport {
        self.step_by(self.method.integrator, paths, [from, to], None)
    }

    /// Takes a step of a load that touches obstacles, with the features in `scope`. It is one of
    /// implicit Euler, along a chord (see `Turn`). A load that parts is free, and its step begins
    /// with the velocity of its path, if it parts from there as well.
    pub(super) fn step_touching(&mut self, paths: &TipPaths, span: [f64; 2], scope: Scope) -> StepReport {
        let step_on = |load: &mut Self| load.step_by(Integrator::Euler, paths, span, Some(scope));
        if self.state.side.touching.is_empty() {
            return step_on(self);
        }
        let [from, to] = span.map(|share| self.time_at(paths, share));
        let instant = |time: f64| Instant { time, within: 0.5 * (from + to) };
        let step = (span[1] - span[0]) * paths.duration;
        let (closed, mut creeping) = (self.state.side.touching.clone(), SmallVec::new());
        let report = match self.turned(&closed, (instant(from), Turn::ToChord(step)), &mut creeping) {
            None => step_on(self),
            Some(chord) => {
                let start = self.snapshot();
                self.set_speed(chord);
                let mut report = step_on(self);
                if self.has_opened(&closed) {
                    let end = self.snapshot();
                    self.reset(&start);
                    let free = step_on(self);
                    if self.has_opened(&closed) {
                        return StepReport {
                            n_solves: free.n_solves + report.n_solves,
                            n_iterations: free.n_iterations + report.n_iterations,
                            ..free
                        };
                    }
                    report.add(&free.work());
                    self.reset(&end);
                }
                report
            }
        };
        if let Some(path) = self.turned(&closed, (instant(to), Turn::ToPath(step)), &mut creeping) {
            self.set_speed(path);
        }
        report
    }

    fn step_by(&mut self, integrator: Integrator, paths: &TipPaths, [from, to]: [f64; 2], scope: Option<Scope>) -> StepReport {
        let step = (to - from) * paths.duration;
        let Exact { method, system, springs, state, solver, obstacles, .. } = self;
        let stage_at = match integrator {
            Integrator::Euler => to,
            Integrator::Midpoint => 0.5 * (from + to),
        };
        springs.refresh(&system.springs, &state.motion.pose);
        springs.place_tips(paths, stage_at);
        if method.is_damped {
            let time = step * (stage_at - from) / (to - from);
            method.dashpots.renew(system, springs, &state.motion.pose, time);
        }
        let side = &mut state.side;
        let end = side.time + to * paths.duration;
        side.now = end;
        let problem = Problem {
            system,
            start: state.motion,
            past: state.memory.past,
            springs: springs.blocks(),
            dashpots: method.dashpots.blocks(),
            forecast: &mut state.forecast,
            among: obstacles.as_mut().zip(scope).map(|(obstacles, scope)| Among { obstacles, touching: &mut side.touching, end, scope }),
            step,
            resolving_step: method.resolving_step,
        };
        let stepped = match integrator {
            Integrator::Euler => euler::step(problem, solver),
            Integrator::Midpoint => midpoint::step(problem, solver),
        };
        if !stepped.motion.pose.is_finite() || !stepped.motion.twist.is_finite() {
            springs.invalidate();
            return StepReport { status: Status::Failed, ..stepped.report };
        }
        if stage_at != to {
            springs.place_tips(paths, to);
        }
        if self.accept(&stepped, step) { stepped.report } else { StepReport { status: Status::Failed, ..stepped.report } }
    }

    /// Accepts a step (s) and adds its energies to the ledger. Returns `false` for energies that
    /// are not finite: the ledger and the load then stay as they were.
    #[inline]
    pub(super) fn accept(&mut self, Stepped { motion, stage, friction, mode, past, side, .. }: &Stepped, step: f64) -> bool {
        let Self { method: Inertial { dashpots, .. }, state, springs, .. } = self;
        let damping = dashpots.loss(stage, step);
        let mut on_dashpots = 0.0;
        for ((force, tip), last) in dashpots.forces(stage).zip(springs.block_tips()).zip(springs.iter()) {
            on_dashpots -= force.dot(&(tip - last.tip));
            state.memory.dashpot_on_tip[last.spring] = force;
        }
        let accepted = springs.accept(&motion.pose);
        let kinetic = self.system.load.kinetic_energy(&motion.twist);
        let SideWork { friction: side_friction, of_obstacles, .. } = side.unwrap_or_default();
        // A dashpot stores nothing: the work on its tip goes to the load, less what it dissipates.
        let on_load = accepted.on_load + on_dashpots - damping + (of_obstacles - side_friction);
        let numerical_damping = on_load - friction - (kinetic - state.energy.kinetic);
        if !(numerical_damping + accepted.of_tips + accepted.elastic).is_finite() {
            springs.invalidate();
            state.memory.dashpot_on_tip.fill(Vec2::zeros());
            return false;
        }
        let stood_still = accepted.tips_stood && motion.twist == Twist::ZERO && state.motion.twist == Twist::ZERO;
        state.contact = if stood_still { GroundContact::Settled(*mode) } else { GroundContact::Known(*mode) };
        (state.motion, state.memory.past, state.memory.touched) = (*motion, *past, None);
        let energy = &mut state.energy;
        energy.friction += friction;
        energy.side_friction += side_friction;
        energy.obstacle_work += of_obstacles;
        energy.damping += damping;
        energy.add_tip_work(accepted.of_tips + on_dashpots, accepted.elastic);
        energy.numerical_damping += numerical_damping;
        energy.kinetic = kinetic;
        true
    }
}

impl Method for Inertial {
    type Memory = Memory;

    #[inline]
    fn step(load: &mut Exact<Self>, paths: &TipPaths, from: f64, to: f64) -> StepReport {
        if load.obstacles.is_some() { load.step_among_obstacles(paths, from, to) } else { load.step_freely(paths, from, to) }
    }

    fn meet_waypoint(load: &mut Exact<Self>, times: [f64; 2]) -> StepReport {
        load.meet_waypoint(times)
    }

    fn rest(load: &mut Exact<Self>) -> bool {
        matches!(load.state.contact, GroundContact::Settled(_))
    }

    fn keeps_mode(load: &Exact<Self>) -> bool {
        // A load at rest may start at once.
        load.state.motion.twist != Twist::ZERO
    }

    #[inline]
    fn longest_step(load: &mut Exact<Self>, paths: &TipPaths, longest: f64, report: &mut StepReport) -> f64 {
        let adapted = |report| resolution::longest_step(&load.system, &load.state.motion.pose, paths, longest, report);
        if load.method.adapts_step { adapted(report) } else { longest }
    }

    fn longest_macro_step(load: &Exact<Self>, paths: &TipPaths) -> f64 {
        let attached = paths.from.iter().map(|attachment| &load.system.springs[attachment.spring]);
        LONGEST_MACRO_STEP / load.system.fastest_rate_on(attached)
    }

    /// At obstacles: the step h in which the rounding e of a position asks for the force m e / h^2,
    /// with m the mass of the load.
    fn shortest_macro_step(load: &Exact<Self>, _task: &control::Task) -> f64 {
        let (Load { mass, radius, .. }, limit) = (load.system.load, load.system.total_slip_limit());
        if load.state.side.touching.is_empty() || limit == 0.0 {
            return 0.0;
        }
        (gap_rounding(&load.state.motion.pose, radius) * mass / (ROUNDED_FORCE * limit)).sqrt()
    }

    fn disturb(state: &mut State<Memory>, spring: usize) {
        state.memory.forget_steps();
        state.memory.dashpot_on_tip[spring] = Vec2::zeros();
    }

    fn extra_flow(State { energy, memory, .. }: &State<Memory>) -> Vec<f64> {
        let dashpots = memory.dashpot_on_tip.iter().flat_map(|force| [force.x, force.y]);
        [energy.damping, energy.numerical_damping].into_iter().chain(dashpots).collect()
    }

    fn set_extra_flow(state: &mut State<Memory>, system: &System, flow: &[f64]) {
        if let GroundContact::Settled(mode) = state.contact
            && state.motion.twist != Twist::ZERO
        {
            state.contact = GroundContact::Known(mode);
        }
        [state.energy.damping, state.energy.numerical_damping] = [flow[0], flow[1]];
        for (force, entries) in state.memory.dashpot_on_tip.iter_mut().zip(flow[2..].chunks_exact(2)) {
            *force = Vec2::new(entries[0], entries[1]);
        }
        state.energy.kinetic = system.load.kinetic_energy(&state.motion.twist);
    }

    /// The support about which the load turns, or is about to turn or has just ceased to turn as
    /// far as a macro-step can tell.
    fn begin_row(load: &mut Exact<Self>, macro_step: f64, n_steps: usize) -> Option<usize> {
        let Motion { pose, twist } = load.state.motion;
        let (turn, supports) = (rotation(pose.heading), &load.system.ground.supports);
        let arm = |support: usize| turn * supports[support].offset;
        let speed = |support: usize| twist.velocity_at(&arm(support)).norm();
        let is_slow = |support: &usize| speed(*support) <= SLOW_SUPPORT * twist.angular.powi(2) * arm(*support).norm() * macro_step;
        let support = match load.mode() {
            Some(ContactMode::Pinned(support)) => Some(support),
            Some(ContactMode::Slip) => (0..supports.len()).min_by(|a, b| speed(*a).total_cmp(&speed(*b))).filter(is_slow),
            _ => None,
        };
        if let Some(support) = support {
            load.shift_speed(support, macro_step / n_steps as f64, 1.0);
        }
        support
    }

    fn end_row(load: &mut Exact<Self>, support: Option<usize>, step: f64) {
        let support = if let ContactMode::Pinned(support) = load.state.contact.last() { Some(support) } else { support };
        if let Some(support) = support {
            load.shift_speed(support, step, -1.0);
        }
    }

    fn has_dashpots(_state: &State<Memory>) -> bool {
        true
    }

    fn pull_with_dashpot(state: &State<Memory>, spring: usize, pull: Vec2) -> Vec2 {
        let on_tip = state.memory.dashpot_on_tip[spring] - pull;
        -on_tip
    }

    fn check(memory: &Memory, system: &System) -> Result<(), RestoreError> {
        let (n_dashpots, n_springs) = (memory.dashpot_on_tip.len(), system.springs.len());
        if n_dashpots == n_springs { Ok(()) } else { Err(RestoreError(format!("{n_dashpots} dashpots for {n_springs} springs"))) }
    }
}
