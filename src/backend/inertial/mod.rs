//! The reference dynamics: the load's equation of motion with its springs, dashpots and exact Coulomb friction.
//!
//! ```text
//! euler.rs     implicit Euler: the quasi-static step with the mass matrix added; first order
//! midpoint.rs  springs at the middle of the step, friction at the end velocity and led back by how it changes; second order
//! dashpots.rs  damping as springs about the shape at the start of a step
//! ```
//!
//! Both hold a load that sticks exactly where it is. Euler is stable at any step, and so is midpoint but where it takes Fox and Goodwin's weights, up to sqrt(6) radians of
//! an oscillation: it takes them where a step resolves the oscillations of springs at their rest shapes, and springs stretched many times over turn the load faster. Euler damps numerically by the ratio omega h / 2 and becomes the
//! quasi-static step as the mass goes to zero, by the same code; midpoint damps nothing and rings where a step does not resolve an oscillation.

mod dashpots;
mod euler;
mod midpoint;

use serde::{Deserialize, Serialize};

use super::controlled::{self, FirstOrder, Pace, Way};
use super::forecast::Forecast;
use super::friction::{FrictionSolver, Regime, WarmStart};
use super::springs::{Attachment, Attachments};
use super::springs::{Place, SpringBlocks};
use super::transition::{Transition, TransitionKind};
use super::{Backend, EnergyLedger, Motion, RestoreError, SaveError, SavedState, Skip, Skips, Status, StepReport, Stepping, n_steps_in};
use crate::math::{Arc, Mat2, Pose, Twist, Vec2, perpendicular, rotation};
use crate::model::System;
use dashpots::Dashpots;
use midpoint::Past;

/// Longest stride under error control, in radians of the fastest oscillation.
const LONGEST_STRIDE: f64 = 2.0;

/// Speed of a support up to which it may stop or have stopped within a stride, over what turns about it change the load's speed by in the meantime (1).
const MOST_OF_A_CIRCLE: f64 = 2.0;

pub struct Inertial {
    system: System,
    stepping: Stepping,
    integrator: Integrator,
    skips: Skips,
    resolving_step: f64,
    is_damped: bool,
    solver: FrictionSolver,
    state: State,
    /// The held springs as they are evaluated, unless the state is stale.
    springs: SpringBlocks,
    dashpots: Dashpots,
    /// Grips at the start of an advance.
    from: Vec<Attachment>,
    transitions: Vec<Transition>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct State {
    motion: Motion,
    held: Attachments,
    energy: EnergyLedger,
    /// Force of each spring's dashpot on its tip in the last step (N, world); zero for free springs.
    dashpot_on_tip: Vec<Vec2>,
    /// The load stood still through the last step, with tips that did too, and nothing was grasped or let go since.
    settled: bool,
    regime: Regime,
    /// Nothing was grasped or let go since the step that ended in the regime.
    undisturbed: bool,
    forecast: Forecast,
    /// Friction of the last midpoint steps.
    #[serde(default)]
    past: Option<Past>,
    /// The held springs have changed since they were last evaluated.
    is_stale: bool,
    /// Rotation by the heading as the springs were last evaluated with it: only that gives them the same bits again.
    turn: Mat2,
    /// Of strides under error control.
    #[serde(default)]
    pace: Pace,
    warm_start: WarmStart,
}

/// How a step is cut from the equation of motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// First order; the quasi-static step in the limit of no mass.
    Euler,
    /// Second order, in turning slips as in straight ones.
    #[default]
    Midpoint,
}

/// One step to take.
struct Problem<'a> {
    system: &'a System,
    start: Motion,
    past: Option<Past>,
    /// Springs with their tips where the step evaluates them.
    springs: &'a mut SpringBlocks,
    /// Dashpots as springs of this step.
    dashpots: Option<&'a mut SpringBlocks>,
    forecast: &'a mut Forecast,
    /// (s)
    step: f64,
    /// Longest step that takes a load without damping through a radian of its fastest oscillation (s); zero with damping.
    resolving_step: f64,
}

/// One step taken.
struct Stepped {
    motion: Motion,
    /// Pose at which the springs and dashpots acted.
    stage: Pose,
    /// Energy lost to friction (J).
    friction: f64,
    regime: Regime,
    /// For the next one.
    past: Option<Past>,
    report: StepReport,
}

impl Inertial {
    pub fn new(system: System, start: Motion, stepping: Stepping, integrator: Integrator, skips: Skips) -> Self {
        let solver = FrictionSolver::new(&system.ground, system.load.radius);
        let kinetic = system.load.kinetic_energy(&start.twist);
        let state = State {
            motion: start,
            held: Attachments::default(),
            energy: EnergyLedger { kinetic, initial: kinetic, ..EnergyLedger::default() },
            dashpot_on_tip: vec![Vec2::zeros(); system.springs.len()],
            settled: false,
            regime: if start.twist == Twist::ZERO { Regime::Stick } else { Regime::Slip },
            undisturbed: false,
            forecast: Forecast::default(),
            past: None,
            is_stale: true,
            turn: Mat2::identity(),
            pace: Pace::default(),
            warm_start: solver.warm_start().clone(),
        };
        let is_damped = system.springs.iter().any(|spring| spring.damping_ratio > 0.0);
        let resolving_step = if is_damped { 0.0 } else { 1.0 / system.fastest_rate() };
        Self {
            system,
            stepping,
            integrator,
            skips,
            resolving_step,
            is_damped,
            solver,
            state,
            springs: SpringBlocks::default(),
            dashpots: Dashpots::default(),
            from: Vec::new(),
            transitions: Vec::new(),
        }
    }

    fn steps(&mut self, way: &Way, n_steps: u64) -> StepReport {
        let mut report = StepReport::default();
        let share = |i: u64| i as f64 / n_steps as f64;
        for i in 1..=n_steps {
            let before = self.state.regime;
            report.add(&self.step(way, share(i - 1), share(i)));
            let kind = TransitionKind::between(before, self.state.regime);
            self.transitions.extend(kind.map(|kind| Transition { time: share(i) * way.duration, kind }));
        }
        report
    }

    /// Takes over what was grasped, let go or put in place of the state.
    fn gather(&mut self) {
        if std::mem::take(&mut self.state.is_stale) {
            self.springs.gather(&self.system.springs, &self.state.held);
            self.springs.start(&Place::of(&self.state.motion.pose));
        }
    }

    /// Takes the speed of a load that turns about a support back from an instant to the middle of the `step` (s) before it, where steps have it, with the
    /// sign 1, and on from there with -1. A step from the speed of an instant sees but half of what holds the load on its circle: a support that is about to
    /// slip would be told not to, and one that has begun to would be told to stop, however short the steps.
    fn lean(&mut self, support: usize, step: f64, sign: f64) {
        let State { motion: Motion { pose, twist }, energy, .. } = &mut self.state;
        let arm = rotation(pose.heading) * self.system.ground.supports[support].offset;
        let mean_arm = Arc::of(-twist.angular * step).mean_rotation() * arm;
        twist.linear += sign * twist.angular * perpendicular(&(arm - mean_arm));
        let kinetic = self.system.load.kinetic_energy(twist);
        energy.numerical_damping -= kinetic - energy.kinetic;
        energy.kinetic = kinetic;
    }

    /// Makes a step (s) that was taken the state, with the books of its energies.
    fn take(&mut self, Stepped { motion, stage, friction, regime, past, .. }: &Stepped, step: f64) {
        let accepted = self.springs.accept(&motion.pose);
        let damping = self.dashpots.loss(stage, step);
        let mut on_dashpots = 0.0;
        for ((force, tip), last) in self.dashpots.forces(stage).zip(self.springs.tips()).zip(self.state.held.iter()) {
            on_dashpots -= force.dot(&(tip - last.tip));
            self.state.dashpot_on_tip[last.spring] = force;
        }
        self.state.turn = self.springs.place().turn;
        self.springs.scatter(self.state.held.as_mut_slice());
        let kinetic = self.system.load.kinetic_energy(&motion.twist);
        let state = &mut self.state;
        state.settled = accepted.tips_stood && motion.twist == Twist::ZERO && state.motion.twist == Twist::ZERO;
        (state.motion, state.regime, state.past, state.undisturbed) = (*motion, *regime, *past, true);
        let energy = &mut state.energy;
        energy.friction += friction;
        energy.damping += damping;
        energy.tip_work += accepted.of_tips + on_dashpots;
        // A dashpot keeps nothing: what its tip's holder does and it does not take goes to the load.
        let on_load = accepted.on_load + on_dashpots - damping;
        energy.numerical_damping += on_load - friction - (kinetic - energy.kinetic);
        (energy.elastic, energy.kinetic) = (accepted.elastic, kinetic);
    }
}

impl FirstOrder for Inertial {
    type State = State;

    fn state(&self) -> &State {
        &self.state
    }

    fn set_state(&mut self, state: State) {
        self.state = State { is_stale: true, ..state };
    }

    /// The support about which the load turns or, as far as a stride can tell, is about to or has just ceased to.
    fn begin_row(&mut self, stride: f64, n_steps: usize) -> Option<usize> {
        let Motion { pose, twist } = self.state.motion;
        let (turn, supports) = (rotation(pose.heading), &self.system.ground.supports);
        let arm = |support: usize| turn * supports[support].offset;
        let speed = |support: usize| twist.velocity_at(&arm(support)).norm();
        let is_slow = |support: &usize| speed(*support) <= MOST_OF_A_CIRCLE * twist.angular.powi(2) * arm(*support).norm() * stride;
        let support = match self.regime() {
            Some(Regime::Pinned(support)) => Some(support),
            Some(Regime::Slip) => (0..supports.len()).min_by(|a, b| speed(*a).total_cmp(&speed(*b))).filter(is_slow),
            _ => None,
        };
        if let Some(support) = support {
            self.lean(support, stride / n_steps as f64, 1.0);
        }
        support
    }

    fn end_row(&mut self, support: Option<usize>, step: f64) {
        let support = if let Regime::Pinned(support) = self.state.regime { Some(support) } else { support };
        if let Some(support) = support {
            self.lean(support, step, -1.0);
        }
    }

    fn step(&mut self, way: &Way, from: f64, to: f64) -> StepReport {
        let step = (to - from) * way.duration;
        let stage_at = match self.integrator {
            Integrator::Euler => to,
            Integrator::Midpoint => 0.5 * (from + to),
        };
        self.gather();
        self.springs.place_tips(way.from, way.targets, stage_at);
        if self.is_damped {
            let time = step * (stage_at - from) / (to - from);
            self.dashpots.renew(&self.system, &self.state.held, self.springs.tips(), &self.state.motion.pose, time);
        }
        let problem = Problem {
            system: &self.system,
            start: self.state.motion,
            past: self.state.past,
            springs: &mut self.springs,
            dashpots: self.dashpots.blocks(),
            forecast: &mut self.state.forecast,
            step,
            resolving_step: self.resolving_step,
        };
        let stepped = match self.integrator {
            Integrator::Euler => euler::step(problem, &mut self.solver),
            Integrator::Midpoint => midpoint::step(problem, &mut self.solver),
        };
        if !stepped.motion.pose.is_finite() || !stepped.motion.twist.is_finite() {
            self.state.is_stale = true;
            return StepReport { status: Status::Failed, ..stepped.report };
        }
        if stage_at != to {
            self.springs.place_tips(way.from, way.targets, to);
        }
        self.take(&stepped, step);
        stepped.report
    }

    fn regime(&self) -> Option<Regime> {
        // A load that moves goes on as it did, whatever was grasped or let go; one at rest may start at once.
        (self.state.undisturbed || self.state.motion.twist != Twist::ZERO).then_some(self.state.regime)
    }

    fn moving(&self) -> (&System, &Motion) {
        (&self.system, &self.state.motion)
    }

    fn last_regime(&self) -> Regime {
        self.state.regime
    }

    fn flow(&self) -> Vec<f64> {
        let State { motion, energy, dashpot_on_tip, .. } = &self.state;
        let losses = [energy.friction, energy.tip_work, energy.damping, energy.numerical_damping];
        let dashpots = dashpot_on_tip.iter().flat_map(|force| [force.x, force.y]);
        motion.entries().into_iter().chain(losses).chain(dashpots).collect()
    }

    fn set_flow(&mut self, flow: &[f64]) {
        let state = &mut self.state;
        state.motion = Motion::of_entries(flow);
        state.settled &= state.motion.twist == Twist::ZERO;
        let energy = &mut state.energy;
        [energy.friction, energy.tip_work, energy.damping, energy.numerical_damping] = [flow[6], flow[7], flow[8], flow[9]];
        state
            .dashpot_on_tip
            .iter_mut()
            .zip(flow[10..].chunks_exact(2))
            .for_each(|(force, entries)| *force = Vec2::new(entries[0], entries[1]));
        state.held.accept(&self.system.springs, &state.motion.pose);
        state.energy.elastic = state.held.energy(&self.system.springs, &state.motion.pose);
        state.energy.kinetic = self.system.load.kinetic_energy(&state.motion.twist);
        self.state.is_stale = true;
    }
}

impl Backend for Inertial {
    fn attach(&mut self, spring: usize, tip: Vec2) {
        let brought = self.state.held.attach(&self.system.springs, spring, tip, &self.state.motion.pose);
        self.state.energy.book_grasp(brought);
        (self.state.settled, self.state.undisturbed, self.state.past) = (false, false, None);
        self.state.is_stale = true;
    }

    fn release(&mut self, spring: usize) {
        let lost = self.state.held.release(&self.system.springs, spring, &self.state.motion.pose);
        self.state.energy.book_release(lost, self.state.held.energy(&self.system.springs, &self.state.motion.pose));
        self.state.dashpot_on_tip[spring] = Vec2::zeros();
        (self.state.settled, self.state.undisturbed, self.state.past) = (false, false, None);
        self.state.is_stale = true;
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        self.transitions.clear();
        if !self.state.held.can_move(tip_targets, duration) {
            return StepReport::refused();
        }
        let n_steps = match self.stepping {
            Stepping::Fixed(longest) => n_steps_in(duration, longest),
            Stepping::Controlled(_) => 1,
        };
        let why = if self.state.held.is_empty() { Skip::FreeLoad } else { Skip::StillTips };
        if self.skips.has(why) && self.state.settled && self.state.held.tips_are_at(tip_targets) {
            let mut report = StepReport::default();
            report.leave_out(why, n_steps);
            return report;
        }
        let mut from = std::mem::take(&mut self.from);
        from.clear();
        from.extend_from_slice(&self.state.held);
        let report = match self.stepping {
            Stepping::Fixed(_) => self.steps(&Way { from: &from, targets: tip_targets, duration, longest: f64::INFINITY }, n_steps),
            Stepping::Controlled(control) => {
                let held = from.iter().map(|attachment| &self.system.springs[attachment.spring]);
                let longest = LONGEST_STRIDE / self.system.fastest_rate_on(held);
                let way = Way { from: &from, targets: tip_targets, duration, longest };
                let (mut pace, mut transitions) = (std::mem::take(&mut self.state.pace), std::mem::take(&mut self.transitions));
                let report = controlled::advance(self, &way, &control, &mut pace, &mut transitions);
                (self.state.pace, self.transitions) = (pace, transitions);
                report
            }
        };
        self.from = from;
        report
    }

    fn motion(&self) -> Motion {
        self.state.motion
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.state.held.tip(spring)
    }

    fn pull(&self, spring: usize) -> Vec2 {
        let State { held, motion, is_stale, dashpot_on_tip, .. } = &self.state;
        let pull = match held.place(spring) {
            Some(at) if !is_stale => self.springs.pull(at),
            _ => held.pull(&self.system.springs, spring, &motion.pose),
        };
        let on_tip = dashpot_on_tip[spring] - pull;
        -on_tip
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        self.solver.forces_in_world(self.state.motion.pose.heading)
    }

    fn energy(&self) -> EnergyLedger {
        self.state.energy
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
        if state.dashpot_on_tip.len() != self.system.springs.len() {
            return Err(RestoreError(format!("{} dashpots for {} springs", state.dashpot_on_tip.len(), self.system.springs.len())));
        }
        self.solver.set_warm_start(state.warm_start.clone())?;
        self.state = state;
        if !self.state.is_stale {
            self.springs.gather(&self.system.springs, &self.state.held);
            self.springs.start(&Place { pose: self.state.motion.pose, turn: self.state.turn });
        }
        Ok(())
    }
}
