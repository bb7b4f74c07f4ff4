//! The paper's backend: the load moves so that springs and friction balance at every instant; inertia is neglected.
//!
//! Its path does not depend on how fast the tips go along theirs: the method is rate-independent, and equal nodes give equal bits. First order in
//! the step. Where a grasp or a release leaves the load out of balance, it jumps to the nearest balance before the tips move on; where
//! moving tips take the balance away, it snaps to another one within the step. Dashpots act through rates, so they do not act here.

mod jumps;
mod second_order;

use serde::{Deserialize, Serialize};

use super::controlled::{self, FirstOrder, Pace, Way};
use super::forecast::Forecast;
use super::friction::{FrictionSolver, Regime, WarmStart};
use super::increment::{Increment, Potential, minimise};
use super::springs::{Accepted, Place, SpringBlocks};
use super::springs::{Attachment, Attachments, pulls_with};
use super::stick_bound::StickBound;
use super::transition::{Transition, TransitionKind};
use super::{
    AttachedTip, Backend, ConeSolver, EnergyLedger, Motion, RestoreError, SaveError, SavedState, Skip, Skips, Status, StepReport, Stepping,
    n_steps_in,
};
use crate::math::{Mat2, Pose, Twist, Vec2, Vec3, rotation};
use crate::model::System;
use second_order::Past;

/// Farthest that a tip goes in one stride under error control while the load is at rest, over its radius (1): what rests at all nodes of a stride and slips between them is
/// not seen to.
const LONGEST_TIP_WAY: f64 = 0.125;

pub struct QuasiStatic {
    system: System,
    stepping: Stepping,
    /// Whether steps are of second order where they can be.
    second_order: bool,
    skips: Skips,
    solver: FrictionSolver,
    state: State,
    /// The held springs as they are evaluated, unless the state is stale.
    springs: SpringBlocks,
    /// Grips at the start of an advance.
    from: Vec<Attachment>,
    transitions: Vec<Transition>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct State {
    motion: Motion,
    held: Attachments,
    energy: EnergyLedger,
    /// A grasp or a release has changed the forces since the last balance, by more than what counts as none of it: ants grasp tips at rest.
    disturbed: bool,
    regime: Regime,
    /// Nothing was grasped or let go since the step that ended in the regime.
    regime_is_known: bool,
    forecast: Forecast,
    /// The last step, if the load slipped on all supports in it and in the one before.
    #[serde(default)]
    past: Option<Past>,
    /// The held springs have changed since they were last evaluated.
    is_stale: bool,
    /// Their tips have gone on since then, with a load that surely stood: its books lag behind.
    is_waiting: bool,
    stick: StickBound,
    /// Rotation by the heading as the springs were last evaluated with it: only that gives them the same bits again.
    turn: Mat2,
    /// Of strides under error control.
    #[serde(default)]
    pace: Pace,
    warm_start: WarmStart,
}

impl QuasiStatic {
    /// A load at the pose of `start`, at rest: without inertia there is no other start.
    pub fn new(system: System, start: Motion, stepping: Stepping, skips: Skips) -> Self {
        let solver = FrictionSolver::new(&system.ground, system.load.radius);
        let motion = Motion { twist: Twist::ZERO, ..start };
        let warm_start = solver.warm_start().clone();
        // Strides under error control are long already, and take their states back.
        let skips = if matches!(stepping, Stepping::Fixed(_)) { skips } else { skips.without(Skip::StickBound) };
        let state = State {
            motion,
            held: Attachments::default(),
            energy: EnergyLedger::default(),
            disturbed: false,
            regime: Regime::Stick,
            regime_is_known: false,
            forecast: Forecast::default(),
            past: None,
            is_stale: true,
            is_waiting: false,
            stick: StickBound::default(),
            pace: Pace::default(),
            turn: Mat2::identity(),
            warm_start,
        };
        Self {
            system,
            stepping,
            second_order: false,
            skips,
            solver,
            state,
            springs: SpringBlocks::default(),
            from: Vec::new(),
            transitions: Vec::new(),
        }
    }

    /// The same with its friction problems handed to `solver`.
    pub fn through(self, solver: ConeSolver) -> Self {
        Self { solver: FrictionSolver::by(solver, &self.system.ground, self.system.load.radius), ..self }
    }

    /// The same with steps of second order where the load goes on slipping.
    pub fn of_second_order(self) -> Self {
        Self { second_order: true, ..self }
    }

    /// Tips that stand still leave the load where it is.
    fn rest(&mut self, why: Skip, duration: f64, report: &mut StepReport) {
        let n_steps = match self.stepping {
            Stepping::Fixed(longest) => n_steps_in(duration, longest),
            Stepping::Controlled(_) => 1,
        };
        let before = std::mem::replace(&mut self.state.regime, Regime::Stick);
        self.note_transition(before, 0.0);
        self.state.motion.twist = Twist::ZERO;
        // What a load did before it rested says nothing of how it goes on.
        self.state.past = None;
        self.state.forecast.forget();
        if self.state.is_stale {
            // Somebody may ask for their forces, again and again.
            self.gather();
        }
        report.leave_out(why, n_steps);
    }

    /// Takes the tips to their targets.
    fn follow(&mut self, tip_targets: &[Vec2], duration: f64, report: &mut StepReport) {
        if std::mem::take(&mut self.state.disturbed) {
            report.add(&self.jump());
        }
        let why = if self.state.held.is_empty() { Skip::FreeLoad } else { Skip::StillTips };
        if self.skips.has(why) && self.state.held.tips_are_at(tip_targets) {
            self.rest(why, duration, report);
            return;
        }
        let mut from = std::mem::take(&mut self.from);
        from.clear();
        from.extend_from_slice(&self.state.held);
        let way = Way { from: &from, targets: tip_targets, duration, longest: f64::INFINITY };
        match self.stepping {
            Stepping::Fixed(longest) => self.steps(&way, n_steps_in(duration, longest), report),
            Stepping::Controlled(control) => {
                let (mut pace, mut transitions) = (std::mem::take(&mut self.state.pace), std::mem::take(&mut self.transitions));
                // Tips that are at their targets leave no limit.
                let n_looks = self.state.held.longest_displacement(tip_targets) / (LONGEST_TIP_WAY * self.system.load.radius);
                let is_at_rest = self.state.regime == Regime::Stick;
                let way = Way { longest: if is_at_rest { duration / n_looks } else { f64::INFINITY }, ..way };
                report.add(&controlled::advance(self, &way, &control, &mut pace, &mut transitions));
                (self.state.pace, self.transitions) = (pace, transitions);
            }
        }
        self.from = from;
    }

    fn steps(&mut self, way: &Way, n_steps: u64, report: &mut StepReport) {
        let share = |i: u64| i as f64 / n_steps as f64;
        let mut done = 0;
        while done < n_steps {
            done += self.wait(way, done, n_steps, report);
            if done == n_steps {
                break;
            }
            let (start, defect, regime) = (self.state.motion.pose, self.state.energy.defect(), self.state.regime);
            let cost = self.step_to(way, share(done), share(done + 1));
            done += 1;
            report.add(&cost);
            let time = share(done) * way.duration;
            let snap = self.snap(&start, defect, Self::work_error, report);
            self.transitions.extend(snap.map(|kind| Transition { time, kind }));
            self.note_transition(regime, time);
        }
    }

    fn work_error(&self) -> f64 {
        self.springs.work_error()
    }

    fn note_transition(&mut self, before: Regime, time: f64) {
        let kind = TransitionKind::between(before, self.state.regime);
        self.transitions.extend(kind.map(|kind| Transition { time, kind }));
    }

    /// Takes over what was grasped, let go, moved on or put in place of the state.
    fn gather(&mut self) {
        self.catch_up();
        if std::mem::take(&mut self.state.is_stale) {
            let place = Place::of(&self.state.motion.pose);
            self.springs.gather(&self.system.springs, &self.state.held);
            self.springs.start(&place);
            self.state.turn = place.turn;
        }
    }

    /// Brings the books of a load that stood while tips moved up to where they are.
    fn catch_up(&mut self) {
        if std::mem::take(&mut self.state.is_waiting) {
            let accepted = self.springs.accept(&self.state.motion.pose);
            self.book(&accepted);
        }
    }

    /// Takes over what the springs have accepted.
    fn book(&mut self, accepted: &Accepted) {
        self.state.energy.tip_work += accepted.of_tips;
        self.state.energy.elastic = accepted.elastic;
        self.springs.scatter(self.state.held.as_mut_slice());
    }

    /// Leaves out the next of the way's steps, of which some are `done`, as far as the load surely sticks, and gives their number.
    fn wait(&mut self, way: &Way, done: u64, n_steps: u64, report: &mut StepReport) -> u64 {
        let State { stick, held, .. } = &mut self.state;
        if !self.skips.stick_bound || !stick.is_made() {
            return 0;
        }
        let share = |n: u64| n as f64 / n_steps as f64;
        // One step is known from where it ends, which takes less than a bound for all of it and reaches farther.
        let n_left = n_steps - done;
        let n_bound = if n_left > 1 { stick.n_sure(&self.system.springs, held, way.targets, n_left, &self.solver) } else { 0 };
        let n_sure = n_bound.max(1);
        self.springs.place_tips(way.from, way.targets, share(done + n_sure));
        let wrench = -self.springs.look();
        if n_bound == 0 && !stick.holds(&wrench, self.springs.tips(), &self.solver) {
            self.springs.place_tips(way.from, way.targets, share(done));
            self.springs.look();
            return 0;
        }
        held.place_tips(way.from, way.targets, share(done + n_sure));
        (self.state.is_waiting, self.state.regime_is_known) = (true, true);
        self.state.motion.twist = Twist::ZERO;
        let before = std::mem::replace(&mut self.state.regime, Regime::Stick);
        self.note_transition(before, share(done + 1) * way.duration);
        report.leave_out(Skip::StickBound, n_sure);
        n_sure
    }

    fn step_to(&mut self, way: &Way, from: f64, to: f64) -> StepReport {
        self.gather();
        let before = self.state.motion.pose;
        self.springs.place_tips(way.from, way.targets, to);
        let step = (to - from) * way.duration;
        // A path at another pace is the same to the last bit where only shares of the way count, but two orders need the time.
        let answer = self.balance(Some(if self.second_order { step } else { to - from }));
        let after = self.state.motion.pose;
        self.state.motion.twist =
            Twist { linear: (after.position - before.position) / step, angular: (after.heading - before.heading) / step };
        self.state.regime_is_known = true;
        answer
    }

    /// Moves the load to the balance for the tips as they are, or leaves it where it is when there is no finite answer.
    /// `step` measures the tips' way on which it does so; `None` when they stand.
    fn balance(&mut self, step: Option<f64>) -> StepReport {
        let before = self.state.motion.pose;
        let increment = self.increment(step);
        match step {
            Some(step) => self.state.forecast.learn(&increment, step),
            None => self.state.forecast.forget(),
        }
        let goes_on = self.second_order && increment.regime == Regime::Slip && self.state.forecast.has_two();
        let past = |duration| Past { shift: increment.shift, turn: increment.twist.z, duration };
        self.state.past = step.filter(|_| goes_on).map(past);
        let Increment { twist, shift, friction, regime, mut report } = increment;
        let mut pose = Pose { position: before.position + shift, heading: before.heading + twist.z };
        if pose.is_finite() {
            self.state.regime = regime;
            self.state.energy.friction += friction;
        } else {
            report.status = Status::Failed;
            pose = before;
        }
        let accepted = self.springs.accept(&pose);
        self.state.turn = self.springs.place().turn;
        self.book(&accepted);
        match self.state.regime {
            Regime::Stick if self.skips.stick_bound && pose == before && report.status == Status::Converged => {
                self.state.stick.renew(&self.system.springs, &self.state.held, self.springs.place(), &self.solver);
            }
            _ => self.state.stick.forget(),
        }
        self.state.motion.pose = pose;
        report
    }

    /// The increment from where the load is: of second order where that is asked for and can be.
    fn increment(&mut self, step: Option<f64>) -> Increment {
        let start = *self.springs.place();
        let guess = step.and_then(|step| self.state.forecast.increment(step));
        if let (Some(past), Some(duration), Some(guess)) = (&self.state.past, step, &guess) {
            let found = second_order::step(&self.system, (&start, past), duration, guess, &mut self.springs, &mut self.solver);
            if let Some(found) = found {
                return found;
            }
        }
        let potential = Potential::of(&mut self.springs, start);
        minimise(potential, &self.system.ground, &mut self.solver, self.system.load.radius, guess)
    }
}

impl FirstOrder for QuasiStatic {
    type State = State;

    fn state(&self) -> &State {
        &self.state
    }

    fn set_state(&mut self, state: State) {
        self.state = State { is_stale: true, ..state };
    }

    fn step(&mut self, way: &Way, from: f64, to: f64) -> StepReport {
        self.step_to(way, from, to)
    }

    fn regime(&self) -> Option<Regime> {
        // After a grasp or release a load may go on in another regime at once; one at rest may stay for a while, and its onset is to be found.
        (self.state.regime_is_known || self.state.regime == Regime::Stick).then_some(self.state.regime)
    }

    fn last_regime(&self) -> Regime {
        self.state.regime
    }

    fn moving(&self) -> (&System, &Motion) {
        (&self.system, &self.state.motion)
    }

    fn flow(&self) -> Vec<f64> {
        let State { motion, energy, .. } = &self.state;
        motion.entries().into_iter().chain([energy.friction, energy.tip_work]).collect()
    }

    fn set_flow(&mut self, flow: &[f64]) {
        self.state.motion = Motion::of_entries(flow);
        (self.state.energy.friction, self.state.energy.tip_work) = (flow[6], flow[7]);
        self.state.held.accept(&self.system.springs, &self.state.motion.pose);
        self.state.energy.elastic = self.state.held.energy(&self.system.springs, &self.state.motion.pose);
        self.state.is_stale = true;
        self.state.stick.forget();
    }

    fn finish_snap(&mut self, before: &State, report: &mut StepReport) -> Option<TransitionKind> {
        let (start, end) = (before.motion.pose, self.state.motion.pose);
        let allowed = self.state.held.work_error(&self.system.springs, &before.held, &start, &end);
        self.snap(&start, before.energy.defect(), |_| allowed, report)
    }
}

impl Backend for QuasiStatic {
    fn attach(&mut self, spring: usize, tip: Vec2) {
        self.catch_up();
        let brought = self.state.held.attach(&self.system.springs, spring, tip, &self.state.motion.pose);
        self.state.energy.book_grasp(brought);
        self.state.disturbed |= pulls_with(&self.system, spring, brought);
        self.state.forecast.forget();
        (self.state.regime_is_known, self.state.past, self.state.is_stale) = (false, None, true);
        self.state.stick.forget();
    }

    fn release(&mut self, spring: usize) {
        self.catch_up();
        let lost = self.state.held.release(&self.system.springs, spring, &self.state.motion.pose);
        self.state.energy.book_release(lost, self.state.held.energy(&self.system.springs, &self.state.motion.pose));
        (self.state.disturbed, self.state.is_stale) = (true, true);
        self.state.stick.forget();
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let mut report = StepReport::default();
        self.transitions.clear();
        if self.state.held.can_move(tip_targets, duration) {
            self.follow(tip_targets, duration, &mut report);
        } else {
            report = StepReport::refused();
        }
        report
    }

    fn motion(&self) -> Motion {
        self.state.motion
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.state.held.tip(spring)
    }

    fn pull(&self, spring: usize) -> Vec2 {
        let State { held, motion, is_stale, is_waiting, .. } = &self.state;
        match held.place(spring) {
            Some(at) if *is_waiting => self.springs.pull_there(at),
            Some(at) if !is_stale => self.springs.pull(at),
            _ => held.pull(&self.system.springs, spring, &motion.pose),
        }
    }

    fn read_tips(&self, tips: &mut [AttachedTip]) {
        let State { held, motion, is_stale, is_waiting, .. } = &self.state;
        for (tip, attachment) in tips.iter_mut().zip(held.iter()) {
            tip.position = attachment.tip;
        }
        if *is_waiting || !is_stale {
            self.springs.see_pulls(*is_waiting, |at, pull| tips[at].pull = pull);
        } else {
            tips.iter_mut().for_each(|tip| tip.pull = held.pull(&self.system.springs, tip.spring, &motion.pose));
        }
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        let pose = &self.state.motion.pose;
        if !self.state.is_waiting {
            return self.solver.forces_in_world(pose.heading);
        }
        let pulls = -self.state.held.reaction(&self.system.springs, pose).gradient;
        let in_load = rotation(pose.heading).tr_mul(&pulls.xy());
        self.solver.bearing(&Vec3::new(in_load.x, in_load.y, pulls.z), self.state.stick.forces()).forces_in_world(pose.heading)
    }

    fn energy(&self) -> EnergyLedger {
        let energy = self.state.energy;
        if !self.state.is_waiting {
            return energy;
        }
        let elastic = self.springs.energy_there();
        EnergyLedger { elastic, tip_work: energy.tip_work + (elastic - energy.elastic), ..energy }
    }

    fn transitions(&self) -> &[Transition] {
        &self.transitions
    }

    fn save(&self) -> Result<SavedState, SaveError> {
        Ok(SavedState::of(&State { warm_start: self.solver.warm_start().clone(), ..self.state.clone() }))
    }

    fn restore(&mut self, state: &SavedState) -> Result<(), RestoreError> {
        let state: State = state.read()?;
        state.held.check(&self.system.springs)?;
        self.solver.set_warm_start(state.warm_start.clone())?;
        let (n_forces, n_supports) = (state.stick.forces().len(), state.warm_start.forces.len());
        if n_forces != n_supports && (state.is_waiting || n_forces > 0) {
            return Err(RestoreError(format!("a certificate of rest with forces on {n_forces} supports, not on {n_supports}")));
        }
        // Roundings of many steps, and nothing else.
        let is_by_heading = (state.turn - rotation(state.motion.pose.heading)).amax() < 1e-6;
        if !state.is_stale && !is_by_heading {
            return Err(RestoreError(format!("a rotation that is not by the heading, {} rad", state.motion.pose.heading)));
        }
        self.state = state;
        if !self.state.is_stale {
            let place = Place { pose: self.state.motion.pose, turn: self.state.turn };
            let (attachments, mut accepted) = (&self.state.held, self.state.held.to_vec());
            if self.state.is_waiting {
                self.state.stick.put_back(&mut accepted);
            }
            self.springs.gather(&self.system.springs, &accepted);
            self.springs.start(&place);
            if self.state.is_waiting {
                self.springs.set_tips(attachments);
                self.springs.look();
            }
        }
        Ok(())
    }
}
