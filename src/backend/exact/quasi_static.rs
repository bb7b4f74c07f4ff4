//! The method of the paper: springs and friction balance at every instant, and inertia is
//! neglected.
//!
//! Without dashpots the path of the load does not depend on the speed of the tips: the method is
//! rate-independent, and equal nodes give equal bits. It is of first order in the step, or of
//! second order while the load goes on slipping (`bdf2`). Where an attached or released spring
//! leaves the load out of balance, the load jumps to the nearest balance before the tips move on.
//! Where moving tips remove the balance, a snap-through leads to another one within the step
//! (`jumps`). With dashpots the load relaxes there (`relaxation`).

use serde::{Deserialize, Serialize};

use super::bdf2::{self, Past};
use super::contact::GroundContact;
use super::control;
use super::load::{Exact, Method, SnapStart, State};
use super::viscous::{Viscous, ViscousMemory};
use crate::backend::contact::{Resistance, Scope, SideWork, Task};
use crate::backend::friction::{ConeSolver, ContactMode, FrictionSolver};
use crate::backend::increment::{Increment, Potential, Step, minimise};
use crate::backend::numerics::{HELD_PIECES, JUMP_WORK, LARGEST_BEND, LONGEST_TIP_DISPLACEMENT, PATH_PIECES, PATH_WORK};
use crate::backend::report::{Motion, RestoreError, Skip, Skips, Status, StepReport, TransitionKind};
use crate::backend::springs::{Place, TipPaths};
use crate::backend::stepping::Stepping;
use crate::math::{Pose, Twist, Vec2, Vec3};
use crate::model::System;
use crate::stop;

/// The quasi-static method.
pub struct QuasiStatic {
    /// Whether steps are of second order where they can be.
    second_order: bool,
    /// The dashpots of the springs.
    pub(super) viscous: Viscous,
    jumps: Jumps,
}

/// Steps among obstacles that lead to a balance that is not near.
struct Jumps {
    are_allowed: bool,
    has_jumped: bool,
}

/// What a quasi-static step leaves for the next one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Memory {
    /// The last step, if all supports slipped in it and in the one before, for the second order.
    past: Option<Past>,
    #[serde(default, skip_serializing_if = "ViscousMemory::is_empty")]
    pub(super) viscous: ViscousMemory,
}

impl Exact<QuasiStatic> {
    /// A load at rest at the pose of `start`. Without inertia there is no other start.
    pub fn quasi_static(system: &System, start: Motion, stepping: Stepping, skips: Skips) -> Self {
        let motion = Motion { twist: Twist::ZERO, ..start };
        // Macro-steps are long already, and their states are taken back.
        let skips = if matches!(stepping, Stepping::Fixed(_)) { skips } else { skips.without(Skip::StickCertificate) };
        let (viscous, memory) = Viscous::of(system);
        let jumps = Jumps { are_allowed: true, has_jumped: false };
        let (method, memory) = (QuasiStatic { second_order: false, viscous, jumps }, Memory { past: None, viscous: memory });
        Self::with(method, memory, (system.clone(), motion), stepping, skips)
    }

    /// This load without the dashpots of its springs: the rate-independent model of the paper.
    pub fn rate_independent(mut self) -> Self {
        self.method.viscous = Viscous::default();
        self.state.memory.viscous = ViscousMemory::default();
        self
    }

    /// This load with another solver of the friction problem and another order of the steps.
    pub fn with_options(mut self, solver: ConeSolver, second_order: bool) -> Self {
        self.solver = FrictionSolver::by(solver, &self.system.ground, self.system.load.radius);
        self.method.second_order = second_order;
        self
    }

    /// Step along the paths of the tips between two shares of them (1), to where the tips are.
    #[inline(always)]
    fn plain_step(&mut self, paths: &TipPaths, from: f64, to: f64) -> StepReport {
        let before = self.state.motion.pose;
        let step = (to - from) * paths.duration;
        // Shares of the path keep the answer the same to the last bit at another speed of the tips.
        // The second order and dashpots need the time.
        let needs_time = self.method.second_order || self.method.viscous.acts;
        let times = [from, to].map(|share| self.state.side.time + share * paths.duration);
        let report = self.balance(Some(if needs_time { step } else { to - from }), times);
        let state = &mut self.state;
        let after = state.motion.pose;
        state.motion.twist = Twist { linear: (after.position - before.position) / step, angular: (after.heading - before.heading) / step };
        state.contact = GroundContact::Known(state.contact.last());
        report
    }

    /// The same step with dashpots.
    // A function of its own: most loads have none.
    #[inline(never)]
    fn damped_step(&mut self, paths: &TipPaths, from: f64, to: f64) -> StepReport {
        let before = self.state.motion.pose;
        let step = (to - from) * paths.duration;
        self.set_dashpots(step);
        let mut report = self.plain_step(paths, from, to);
        report.add(&self.account_for_dashpots(step));
        self.note_settled(&before, paths);
        report
    }

    /// Moves the load to the balance for the tips as the springs have them, or leaves it where it
    /// is when there is no finite answer. `step` measures the path of the tips; `None` when they
    /// stand. Obstacles move between two `times` (s).
    pub(super) fn balance(&mut self, step: Option<f64>, times: [f64; 2]) -> StepReport {
        if self.obstacles.is_some() {
            return self.balance_among_obstacles(step, times);
        }
        let increment = self.increment(step);
        self.accept(increment, step)
    }

    /// [`Self::balance`] where there are obstacles, which divide a path that would pass through
    /// one.
    // A function of its own: most loads have no obstacles.
    #[inline(never)]
    fn balance_among_obstacles(&mut self, step: Option<f64>, [mut from, to]: [f64; 2]) -> StepReport {
        let (mut report, mut work) = self.leg(step, [from, to], None);
        self.state.side.now = to;
        let most = if matches!(self.stepping, Stepping::Fixed(_)) { PATH_WORK } else { JUMP_WORK };
        let mut n_held = 0;
        for _ in 0..PATH_PIECES {
            stop::point();
            let goes_on = n_held < HELD_PIECES && report.n_iterations < most;
            let Some(share) = work.cut.filter(|_| goes_on) else { break };
            n_held += u32::from(share == 1.0);
            self.method.jumps.has_jumped |= work.resistance.is_some() && !self.method.viscous.acts;
            from += share * (to - from);
            let (next, next_work) = self.leg(None, [from, to], work.resistance);
            report.add(&StepReport { n_steps: 0, ..next });
            work = SideWork { uncertainty: work.uncertainty + next_work.uncertainty, ..next_work };
        }
        if work.cut.is_some() {
            report.add(&StepReport { status: Status::NotConverged, n_not_converged: 1, ..StepReport::default() });
        }
        self.state.side.uncertainty = work.uncertainty;
        report
    }

    /// One leg of the path to a balance among obstacles, after one against a `resistance`, and its
    /// work at the obstacles.
    fn leg(&mut self, step: Option<f64>, [from, to]: [f64; 2], resistance: Option<Resistance>) -> (StepReport, SideWork) {
        let start = *self.springs.place();
        let guess = step.and_then(|step| self.state.forecast.increment(step));
        let Self { method, springs, system, solver, obstacles: Some(obstacles), state, .. } = self else {
            unreachable!("there are obstacles");
        };
        let potential = Potential { dashpots: method.viscous.blocks(), ..Potential::of(springs.blocks(), start) };
        let mut problem = Step { potential, ground: &system.ground, length: system.load.radius };
        let may_jump = method.jumps.are_allowed;
        let task =
            Task { from, to, step: to - from, guess, has_inertia: false, may_jump, scope: Scope::Near, is_smooth: false, resistance };
        let (increment, work) = obstacles.find(system, &mut problem, solver, &mut state.side.touching, &task);
        let report = self.accept(increment, step);
        if report.status != Status::Failed {
            self.state.energy.side_friction += work.friction;
            self.state.energy.obstacle_work += work.of_obstacles;
        }
        (report, work)
    }

    /// Moves the load by an increment and adds its energies to the ledger.
    #[inline]
    fn accept(&mut self, increment: Increment, step: Option<f64>) -> StepReport {
        let before = self.state.motion.pose;
        let Self { state, springs, .. } = self;
        match step {
            Some(step) => state.forecast.learn(&increment, step),
            None => state.forecast.forget(),
        }
        let goes_on = self.method.second_order && increment.mode == ContactMode::Slip && state.forecast.has_two();
        let past = |duration| Past { shift: increment.shift, turn: increment.twist.z, duration };
        state.memory.past = step.filter(|_| goes_on).map(past);
        let Increment { twist, shift, friction, mode, mut report } = increment;
        let mut pose = Pose { position: before.position + shift, heading: before.heading + twist.z };
        if pose.is_finite() {
            state.contact = GroundContact::Known(mode);
            state.energy.friction += friction;
        } else {
            report.status = Status::Failed;
            pose = before;
        }
        let accepted = springs.accept(&pose);
        if (accepted.of_tips + accepted.elastic).is_finite() {
            state.energy.add_tip_work(accepted.of_tips, accepted.elastic);
        } else {
            report.status = Status::Failed;
        }
        if state.contact.last() == ContactMode::Stick
            && self.skips.stick_certificate
            && !self.method.viscous.acts
            && pose == before
            && report.status == Status::Converged
            && state.side.touching.is_empty()
        {
            state.certificate.renew(&self.system.springs, springs, &self.solver);
        } else {
            state.certificate.forget();
        }
        state.motion.pose = pose;
        report
    }

    /// Increment of the pose without obstacles, of second order where that is possible.
    fn increment(&mut self, step: Option<f64>) -> Increment {
        let start = *self.springs.place();
        let guess = step.and_then(|step| self.state.forecast.increment(step));
        if self.state.memory.past.is_some()
            && let (Some(duration), Some(guess)) = (step, &guess)
            && let Some(found) = self.increment_by_differences(&start, duration, guess)
        {
            return found;
        }
        let Self { method, springs, system, solver, .. } = self;
        let potential = Potential { dashpots: method.viscous.blocks(), ..Potential::of(springs.blocks(), start) };
        minimise(potential, &system.ground, solver, system.load.radius, guess)
    }

    /// Increment of second order, if there is one near the guess.
    // A function of its own, as are those of dashpots: most steps need the registers.
    #[inline(never)]
    fn increment_by_differences(&mut self, start: &Place, duration: f64, guess: &Vec3) -> Option<Increment> {
        let past = self.state.memory.past?;
        if !self.carry_dashpots_on(&past, duration) {
            return None;
        }
        let Self { method, springs, system, solver, .. } = self;
        let blocks = (springs.blocks(), method.viscous.blocks());
        let found = bdf2::step(system, (start, &past), duration, guess, blocks, solver);
        if found.is_none() {
            self.set_dashpots(duration);
        }
        found
    }
}

impl Method for QuasiStatic {
    type Memory = Memory;

    fn step(load: &mut Exact<Self>, paths: &TipPaths, from: f64, to: f64) -> StepReport {
        load.catch_up();
        load.springs.refresh(&load.system.springs, &load.state.motion.pose);
        load.springs.place_tips(paths, to);
        if load.method.viscous.acts { load.damped_step(paths, from, to) } else { load.plain_step(paths, from, to) }
    }

    fn begin_advance(load: &mut Exact<Self>, paths: &TipPaths) {
        load.pace_relaxation(paths);
    }

    /// Round obstacles that touch the load and move far in a step would pass to its other side.
    fn longest_step(load: &mut Exact<Self>, paths: &TipPaths, longest: f64, _report: &mut StepReport) -> f64 {
        if !load.is_pushed(paths.duration) {
            return longest;
        }
        let Exact { obstacles, system, state, .. } = load;
        let from = state.side.time;
        let bend = obstacles.as_ref().map_or(0.0, |obstacles| obstacles.longest_bend(system, from, from + paths.duration));
        longest.min(LARGEST_BEND * paths.duration / bend)
    }

    #[inline]
    fn rest(load: &mut Exact<Self>) -> bool {
        // As a tip stops, its dashpot ceases to pull, and the load may start.
        if load.method.viscous.acts && load.is_damped() {
            load.springs.refresh(&load.system.springs, &load.state.motion.pose);
            return matches!(load.state.contact, GroundContact::Settled(ContactMode::Stick));
        }
        let last = load.state.contact.last();
        load.state.contact = GroundContact::Known(ContactMode::Stick);
        load.note_mode_change(last, 0.0);
        load.state.motion.twist = Twist::ZERO;
        // The motion before the rest says nothing of the motion after it.
        load.state.memory.past = None;
        load.state.forecast.forget();
        // The pulls may be read again and again.
        load.springs.refresh(&load.system.springs, &load.state.motion.pose);
        true
    }

    fn keeps_mode(load: &Exact<Self>) -> bool {
        // A load that slips may go on in another mode at once. One at rest may stay for a while,
        // and its slip onset is to be located.
        load.state.contact.last() == ContactMode::Stick
    }

    fn longest_macro_step(load: &Exact<Self>, paths: &TipPaths) -> f64 {
        let n_longest = load.springs.longest_displacement(paths.targets) / (LONGEST_TIP_DISPLACEMENT * load.system.load.radius);
        if load.state.contact.last() == ContactMode::Stick { paths.duration / n_longest } else { f64::INFINITY }
    }

    /// In the time in which a change is located, tips and obstacles move by next to nothing. Damped
    /// springs change their forces by the time as well.
    fn shortest_macro_step(load: &Exact<Self>, control::Task { paths, control, .. }: &control::Task) -> f64 {
        let (Some(obstacles), time) = (load.obstacles.as_ref().filter(|_| !load.method.viscous.acts), load.state.side.time) else {
            return 0.0;
        };
        let of_obstacles = obstacles.longest_path(&load.system, time, time + paths.duration);
        paths.duration * control.located() / load.springs.longest_displacement(paths.targets).max(of_obstacles)
    }

    /// With dashpots the load relaxes where it would jump, in steps of any length.
    fn allow_jumps(load: &mut Exact<Self>, are_allowed: bool) {
        load.method.jumps = Jumps { are_allowed: are_allowed || load.method.viscous.acts, has_jumped: false };
    }

    fn is_about_to_jump(load: &Exact<Self>, report: &StepReport) -> bool {
        !load.method.viscous.acts && load.obstacles.is_some() && !load.method.jumps.has_jumped && report.status != Status::Converged
    }

    fn has_jumped(load: &Exact<Self>) -> bool {
        load.method.jumps.has_jumped
    }

    fn disturb(state: &mut State<Memory>, spring: usize) {
        state.forecast.forget();
        state.memory.past = None;
        state.memory.viscous.disturb(spring);
    }

    fn restore_balance(load: &mut Exact<Self>, report: &mut StepReport) {
        if load.state.contact.take_jump() && load.can_jump() {
            report.add(&load.jump());
        }
    }

    fn complete_snap_through(
        load: &mut Exact<Self>,
        start: &SnapStart,
        allowed: impl FnOnce(&Exact<Self>) -> f64,
        report: &mut StepReport,
    ) -> Option<TransitionKind> {
        load.snap_through(start, allowed, report)
    }

    fn extra_flow(state: &State<Memory>) -> Vec<f64> {
        state.memory.viscous.flow(&state.energy)
    }

    fn set_extra_flow(state: &mut State<Memory>, _system: &System, flow: &[f64]) {
        state.memory.viscous.set_flow(&mut state.energy, flow);
    }

    fn has_dashpots(state: &State<Memory>) -> bool {
        !state.memory.viscous.on_tip.is_empty()
    }

    fn pull_with_dashpot(state: &State<Memory>, spring: usize, pull: Vec2) -> Vec2 {
        state.memory.viscous.on_tip(spring).map_or(pull, |on_tip| pull - on_tip)
    }

    fn check(memory: &Memory, system: &System) -> Result<(), RestoreError> {
        memory.viscous.check(system)
    }
}
