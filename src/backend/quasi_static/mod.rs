//! The paper's backend: the load moves so that springs and friction balance at every instant; inertia is neglected.
//!
//! Its path does not depend on how fast the tips go along theirs: the method is rate-independent, and equal nodes give equal bits. First order in
//! the step. Where a grasp or a release leaves the load out of balance, it jumps to the nearest balance before the tips move on. Dashpots
//! act through rates, so they do not act here.

pub mod conic;

use serde::{Deserialize, Serialize};

use super::friction::{FrictionSolver, WarmStart};
use super::held::{Grip, HeldSprings};
use super::increment::{Increment, Potential, Stage, minimise};
use super::{Backend, EnergyLedger, Motion, RestoreError, SavedState, Status, StepReport, n_steps_in};
use crate::math::{Twist, Vec2};
use crate::model::System;

/// Legs of one jump. Each is shorter than the last by orders of magnitude, and three are rarely needed.
const MOST_LEGS: u32 = 10;

pub struct QuasiStatic {
    system: System,
    longest_step: f64,
    solver: FrictionSolver,
    state: State,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct State {
    motion: Motion,
    held: HeldSprings,
    energy: EnergyLedger,
    /// A grasp or a release has changed the forces since the last balance.
    disturbed: bool,
    warm_start: WarmStart,
}

impl QuasiStatic {
    /// A load at the pose of `start`, at rest: without inertia there is no other start. `longest_step` in seconds.
    pub fn new(system: System, start: Motion, longest_step: f64) -> Self {
        let solver = FrictionSolver::new(&system.ground, system.load.radius);
        let motion = Motion { twist: Twist::ZERO, ..start };
        let warm_start = solver.warm_start().clone();
        let state = State { motion, held: HeldSprings::default(), energy: EnergyLedger::default(), disturbed: false, warm_start };
        Self { system, longest_step, solver, state }
    }

    /// Moves the load from where a grasp or a release has left it to the balance for tips that stand still. The friction of a long way depends on
    /// the way, here one constant twist; where that ends the load may have to go on, by far less, before it stays.
    fn jump(&mut self, grips: &[Grip]) -> StepReport {
        let mut report = StepReport::default();
        for _ in 0..MOST_LEGS {
            let before = self.state.motion.pose;
            report.add(&self.balance(grips));
            if self.state.motion.pose == before {
                break;
            }
        }
        report
    }

    /// Moves the load to the balance for the tips as they are; `from` are the grips before they moved.
    fn balance(&mut self, from: &[Grip]) -> StepReport {
        let before = self.state.motion.pose;
        let potential =
            Potential { start: before, springs: &[(&self.system.springs, &self.state.held)], inertia: None, springs_at: Stage::END };
        let Increment { twist, friction, mut report } =
            minimise(&potential, &self.system.ground, &mut self.solver, self.system.load.radius);
        let pose = before.moved_by(&twist);
        if !pose.is_finite() {
            report.status = Status::Failed;
            return report;
        }
        self.state.motion.pose = pose;
        self.state.held.accept(&self.system.springs, &pose);
        self.state.energy.friction += friction;
        self.state.energy.tip_work += self.state.held.trapezoid_work(&self.system.springs, from, &before, &pose);
        self.state.energy.elastic = self.state.held.energy(&self.system.springs, &pose);
        report
    }
}

impl Backend for QuasiStatic {
    fn grasp(&mut self, spring: usize, tip: Vec2) {
        let brought = self.state.held.grasp(&self.system.springs, spring, tip, &self.state.motion.pose);
        self.state.energy.book_grasp(brought);
        self.state.disturbed |= brought != 0.0;
    }

    fn release(&mut self, spring: usize) {
        let lost = self.state.held.release(&self.system.springs, spring, &self.state.motion.pose);
        self.state.energy.book_release(lost, self.state.held.energy(&self.system.springs, &self.state.motion.pose));
        self.state.disturbed = true;
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let mut report = StepReport::default();
        let from = self.state.held.grips().to_vec();
        if self.state.disturbed {
            report.add(&self.jump(&from));
            self.state.disturbed = false;
        }
        let n_steps = n_steps_in(duration, self.longest_step);
        if self.state.held.tips_are_at(tip_targets) {
            self.state.motion.twist = Twist::ZERO;
            report.add(&StepReport { n_steps, n_skipped: n_steps, ..StepReport::default() });
            return report;
        }
        for i in 1..=n_steps {
            let before = self.state.motion.pose;
            let last = self.state.held.grips().to_vec();
            self.state.held.place_tips(&from, tip_targets, i as f64 / n_steps as f64);
            report.add(&self.balance(&last));
            let after = self.state.motion.pose;
            let step = duration / n_steps as f64;
            self.state.motion.twist =
                Twist { linear: (after.position - before.position) / step, angular: (after.heading - before.heading) / step };
        }
        report
    }

    fn motion(&self) -> Motion {
        self.state.motion
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.state.held.tip(spring)
    }

    fn force_on_tip(&self, spring: usize) -> Vec2 {
        self.state.held.force_on_tip(&self.system.springs, spring, &self.state.motion.pose)
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        self.solver.forces_in_world(self.state.motion.pose.heading)
    }

    fn energy(&self) -> EnergyLedger {
        self.state.energy
    }

    fn save(&self) -> SavedState {
        SavedState::of(&State { warm_start: self.solver.warm_start().clone(), ..self.state.clone() })
    }

    fn restore(&mut self, state: &SavedState) -> Result<(), RestoreError> {
        let state: State = state.read()?;
        state.held.check(&self.system.springs)?;
        self.solver.set_warm_start(state.warm_start.clone())?;
        self.state = state;
        Ok(())
    }
}
