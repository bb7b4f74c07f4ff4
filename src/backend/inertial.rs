//! The reference dynamics: the quasi-static step with the mass matrix added, and exact friction.
//!
//! ```text
//! minimise over x    1/2 |q exp x - q - h v|^2_M / h^2 + U(q exp x, tips at the end) + dashpots + sum_i c_i |B_i x|
//! ```
//!
//! This is the implicit Euler step of the load's equation of motion with Coulomb friction: unconditionally stable, first order, with exact sticking,
//! and with the numerical damping ratio omega h / 2. As the mass goes to zero it is the quasi-static step, by the same code.
//!
//! A dashpot is a spring of stiffness c / h about the shape at the start of the step: its energy is the Rayleigh potential of that step.

use serde::{Deserialize, Serialize};

use super::friction::{FrictionSolver, WarmStart};
use super::held::{Grip, HeldSprings};
use super::increment::{Coasting, Increment, Potential, minimise};
use super::{Backend, EnergyLedger, Motion, RestoreError, SavedState, Status, StepReport, n_steps_in};
use crate::math::{Pose, Twist, Vec2, rotation};
use crate::model::{PolarSpring, System};

pub struct Inertial {
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
    /// Force of each spring's dashpot on its tip in the last step (N, world); zero for free ones.
    dashpot_on_tip: Vec<Vec2>,
    /// The load stood still through the last step, with tips that did too, and nothing was grasped or let go since.
    settled: bool,
    warm_start: WarmStart,
}

/// Dashpots of one step as springs.
struct Dashpots {
    springs: Vec<PolarSpring>,
    held: HeldSprings,
}

impl Inertial {
    /// `longest_step` in seconds.
    pub fn new(system: System, start: Motion, longest_step: f64) -> Self {
        let solver = FrictionSolver::new(&system.ground, system.load.radius);
        let kinetic = kinetic_energy(&system, &start.twist);
        let state = State {
            motion: start,
            held: HeldSprings::default(),
            energy: EnergyLedger { kinetic, initial: kinetic, ..EnergyLedger::default() },
            dashpot_on_tip: vec![Vec2::zeros(); system.springs.len()],
            settled: false,
            warm_start: solver.warm_start().clone(),
        };
        Self { system, longest_step, solver, state }
    }

    /// One step of `step` seconds with the tips as they are; `from` are the grips before they moved.
    fn step(&mut self, from: &[Grip], step: f64) -> StepReport {
        let Motion { pose: before, twist } = self.state.motion;
        let springs = &self.system.springs;
        let dashpots = Dashpots::new(&self.system, &self.state.held, from, &before, step);
        let coasting = Coasting {
            shift: step * twist.linear,
            turn: step * twist.angular,
            stiffness: (self.system.load.mass / (step * step), self.system.load.inertia / (step * step)),
        };
        let potential = Potential {
            start: before,
            springs: &[(springs, &self.state.held), (&dashpots.springs, &dashpots.held)],
            inertia: Some(coasting),
        };
        let Increment { twist: increment, friction, mut report } =
            minimise(&potential, &self.system.ground, &mut self.solver, self.system.load.radius);
        let pose = before.moved_by(&increment);
        let twist = Twist { linear: before.shift_by(&increment) / step, angular: increment.z / step };
        if !pose.is_finite() || !twist.is_finite() {
            report.status = Status::Failed;
            return report;
        }
        self.state.held.accept(springs, &pose);
        let tips_stood = self.state.held.grips().iter().zip(from).all(|(now, last)| now.tip == last.tip);
        self.state.settled = tips_stood && twist == Twist::ZERO && self.state.motion.twist == Twist::ZERO;
        self.state.motion = Motion { pose, twist };
        self.account(friction, &dashpots, from, &before);
        report
    }

    fn account(&mut self, friction: f64, dashpots: &Dashpots, from: &[Grip], before: &Pose) {
        let State { motion, held, energy, dashpot_on_tip, .. } = &mut self.state;
        let springs = &self.system.springs;
        energy.friction += friction;
        energy.tip_work += held.trapezoid_work(springs, from, before, &motion.pose);
        energy.elastic = held.energy(springs, &motion.pose);
        energy.kinetic = kinetic_energy(&self.system, &motion.twist);
        // Twice the Rayleigh potential of the step.
        energy.damping += 2.0 * dashpots.held.energy(&dashpots.springs, &motion.pose);
        for (at, grip) in dashpots.held.grips().iter().enumerate() {
            let force = dashpots.held.force_on_tip(&dashpots.springs, grip.spring, &motion.pose);
            energy.tip_work -= force.dot(&(grip.tip - from[at].tip));
            dashpot_on_tip[held.grips()[at].spring] = force;
        }
    }
}

impl Dashpots {
    /// One spring a held spring, or none at all without damping; the index of a dashpot is the place of its grip.
    fn new(system: &System, held: &HeldSprings, from: &[Grip], before: &Pose, step: f64) -> Self {
        let mut dashpots = Dashpots { springs: Vec::new(), held: HeldSprings::default() };
        if system.springs.iter().all(|spring| spring.damping_ratio == 0.0) {
            return dashpots;
        }
        for (at, (grip, last)) in held.grips().iter().zip(from).enumerate() {
            let spring = &system.springs[grip.spring];
            let (radial, torsional) = system.dashpot(spring);
            let shape = last.shape(&system.springs, before);
            dashpots.springs.push(spring.about(&shape, radial / step, torsional / step));
            dashpots.held.grasp(&dashpots.springs, at, grip.tip, before);
        }
        dashpots
    }
}

fn kinetic_energy(system: &System, twist: &Twist) -> f64 {
    0.5 * system.load.mass * twist.linear.norm_squared() + 0.5 * system.load.inertia * twist.angular * twist.angular
}

impl Backend for Inertial {
    fn grasp(&mut self, spring: usize, tip: Vec2) {
        let brought = self.state.held.grasp(&self.system.springs, spring, tip, &self.state.motion.pose);
        self.state.energy.tip_work += brought;
        self.state.energy.elastic += brought;
        self.state.settled = false;
    }

    fn release(&mut self, spring: usize) {
        let lost = self.state.held.release(&self.system.springs, spring, &self.state.motion.pose);
        self.state.energy.released += lost;
        self.state.energy.elastic = self.state.held.energy(&self.system.springs, &self.state.motion.pose);
        self.state.dashpot_on_tip[spring] = Vec2::zeros();
        self.state.settled = false;
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let n_steps = n_steps_in(duration, self.longest_step);
        if self.state.settled && self.state.held.tips_are_at(tip_targets) {
            return StepReport { n_steps, n_skipped: n_steps, ..StepReport::default() };
        }
        let mut report = StepReport::default();
        let from = self.state.held.grips().to_vec();
        for i in 1..=n_steps {
            let last = self.state.held.grips().to_vec();
            self.state.held.place_tips(&from, tip_targets, i as f64 / n_steps as f64);
            report.add(&self.step(&last, duration / n_steps as f64));
        }
        report
    }

    fn motion(&self) -> Motion {
        self.state.motion
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.state.held.get(spring).map(|grip| grip.tip)
    }

    fn force_on_tip(&self, spring: usize) -> Vec2 {
        self.state.held.force_on_tip(&self.system.springs, spring, &self.state.motion.pose) + self.state.dashpot_on_tip[spring]
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        let turn = rotation(self.state.motion.pose.heading);
        self.solver.forces().iter().map(|force| turn * force).collect()
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
        if state.dashpot_on_tip.len() != self.system.springs.len() {
            return Err(RestoreError(format!("{} dashpots for {} springs", state.dashpot_on_tip.len(), self.system.springs.len())));
        }
        self.solver.set_warm_start(state.warm_start.clone())?;
        self.state = state;
        Ok(())
    }
}
