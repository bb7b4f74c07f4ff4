//! The backend itself: cuts a duration into engine steps, asks each of the engine and keeps the books.

use serde::{Deserialize, Serialize};

use super::RapierOptions;
use super::SpringModel;
use super::aggregate::fold;
use super::ground::Footing;
use super::joints::{BodyState, Engine};
use super::ledger::Books;
use super::residual::residual;
use super::springs::{SpringSum, spring_joints};
use super::step::Step;
use crate::backend::friction::WarmStart;
use crate::backend::held::{Grip, HeldSprings};
use crate::backend::{Backend, EnergyLedger, Motion, RestoreError, SavedState, Status, StepReport, n_steps_in};
use crate::math::{Twist, Vec2};
use crate::model::System;

/// A load under rapier.
pub struct Transport {
    system: System,
    /// Longest step (s).
    step: f64,
    options: RapierOptions,
    engine: Box<dyn Engine>,
    footing: Footing,
    /// Whether the engine has other joints than the held springs ask for.
    is_stale: bool,
    state: State,
}

/// What a run is besides its friction solver: all that [`Backend::save`] needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct State {
    body: BodyState,
    /// With its whole turns, which the engine does not count (rad).
    heading: f64,
    held: HeldSprings,
    books: Books,
    /// On each support of the ground (N, world).
    friction_forces: Vec<Vec2>,
    /// Force of each spring's dashpots on its tip in the last step (N, world); zero for free ones.
    dashpot_on_tip: Vec<Vec2>,
    /// The engine had no finite answer once: nothing moves any more.
    has_failed: bool,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Saved {
    options: RapierOptions,
    state: State,
    warm_start: Option<WarmStart>,
}

impl Transport {
    pub fn new(system: System, start: Motion, step: f64, options: RapierOptions, engine: Box<dyn Engine>) -> Self {
        let body = engine.body();
        let mut state = State {
            body,
            heading: body.motion(start.pose.heading).pose.heading,
            held: HeldSprings::default(),
            books: Books::default(),
            friction_forces: vec![Vec2::zeros(); system.ground.supports.len()],
            dashpot_on_tip: vec![Vec2::zeros(); system.springs.len()],
            has_failed: false,
        };
        state.books.initial = system.load.kinetic_energy(&state.motion().twist);
        let footing = Footing::new(&system, options.friction);
        Self { system, step, options, engine, footing, is_stale: true, state }
    }

    /// One step of `duration` (s) that ends with the tips where `state.held` has them now; `from` tells where they were.
    fn advance_one(&mut self, from: Vec<Grip>, duration: f64) -> StepReport {
        if self.is_at_rest() {
            self.state.friction_forces.fill(Vec2::zeros());
            return StepReport { n_steps: 1, n_skipped: 1, ..StepReport::default() };
        }
        let mut report = StepReport { n_steps: 1, ..StepReport::default() };
        let step = self.ask(from, duration, &mut report);
        if self.keep(&step) {
            report.residual = report.residual.max(residual(&self.system, &step));
            if report.residual > TOLERANCE {
                report.status = Status::NotConverged;
                report.n_not_converged = 1;
            }
        } else {
            report.status = Status::Failed;
            report.n_not_converged = 1;
        }
        report
    }

    /// Nothing pulls at a load that does not move: it stays, by any friction law.
    fn is_at_rest(&self) -> bool {
        let twist = self.state.motion().twist;
        self.state.held.is_empty() && twist.linear.amax().max(twist.angular.abs()) < REST_SPEED
    }

    /// Poses the step as joints, has the engine make it, and reads the answer.
    fn ask(&mut self, from: Vec<Grip>, duration: f64, report: &mut StepReport) -> Step {
        let start = self.state.motion();
        let springs = spring_joints(&self.system, &self.state.held, &from, &start.pose, duration);
        let sum = SpringSum::of(&springs);
        let friction = self.footing.joints(&self.system, &start, &sum, duration, report);
        let folded = (self.options.springs == SpringModel::Aggregate && !springs.is_empty()).then(|| vec![fold(&sum, duration)]);
        let asked = folded.as_deref().unwrap_or(&springs);
        if std::mem::take(&mut self.is_stale) {
            self.engine.rebuild(&self.state.body, friction.len(), asked.len());
        }
        let is_finite = self.engine.step(duration, &friction, asked);
        let end = if is_finite { self.engine.body().motion(self.state.heading) } else { NOWHERE };
        let wrenches = (0..friction.len()).map(|joint| self.engine.friction_wrench(joint)).collect();
        Step { duration, start, end, from, springs, sum, friction, wrenches }
    }

    /// Takes over where the step ended. A step without a finite end is undone, and nothing moves from then on.
    fn keep(&mut self, step: &Step) -> bool {
        let mut next = self.state.clone();
        next.body = self.engine.body();
        next.heading = step.end.pose.heading;
        next.held.accept(&self.system.springs, &step.end.pose);
        next.books.add_friction(&self.system.load, step);
        next.books.add_springs(&self.system.springs, &next.held, step, &mut next.dashpot_on_tip);
        next.friction_forces.fill(Vec2::zeros());
        for (joint, wrench) in step.friction.iter().zip(&step.wrenches) {
            next.friction_forces[joint.support] += joint.stuck_force.unwrap_or(wrench.force);
        }
        let is_finite = next.is_finite() && self.ledger_of(&next).defect().is_finite();
        if is_finite {
            self.state = next;
        } else {
            self.state.has_failed = true;
            self.is_stale = true;
        }
        is_finite
    }

    fn ledger_of(&self, state: &State) -> EnergyLedger {
        let motion = state.motion();
        EnergyLedger {
            elastic: state.held.energy(&self.system.springs, &motion.pose),
            kinetic: self.system.load.kinetic_energy(&motion.twist),
            friction: state.books.friction,
            damping: state.books.damping,
            released: state.books.released,
            tip_work: state.books.tip_work,
            initial: state.books.initial,
            jumps: 0.0,
            numerical_damping: state.books.numerical_damping,
        }
    }
}

/// Residual above which a step counts as not converged. A thousandth of the forces is less than what a step of a millisecond errs by
/// itself; converged sweeps end near 1e-15 in f64, and in f32 near 1e-5, at a step of 10 us 1e-3.
const TOLERANCE: f64 = 1e-3;

/// Speeds below this (m/s, rad/s) are rest: the engine's sweeps shrink a speed to the smallest numbers there are, not to zero. A load that
/// fast moves less than the diameter of a nucleus in a thousand years.
const REST_SPEED: f64 = 1e-30;

/// The end of a step that has none.
const NOWHERE: Motion = Motion {
    pose: crate::math::Pose { position: Vec2::new(f64::NAN, f64::NAN), heading: f64::NAN },
    twist: Twist { linear: Vec2::new(f64::NAN, f64::NAN), angular: f64::NAN },
};

impl State {
    fn motion(&self) -> Motion {
        self.body.motion(self.heading)
    }

    /// Nothing without a value gets into the books: a tip too far away for its energy ends the run instead.
    fn finite_or_fail(&mut self, energy: f64) -> f64 {
        self.has_failed |= !energy.is_finite();
        if energy.is_finite() { energy } else { 0.0 }
    }

    fn is_finite(&self) -> bool {
        self.body.is_finite()
            && self.heading.is_finite()
            && self.held.grips().iter().all(|grip| grip.tip.iter().all(|v| v.is_finite()) && grip.swing.is_finite())
            && self.books.is_finite()
            && self.friction_forces.iter().chain(&self.dashpot_on_tip).flatten().all(|v| v.is_finite())
    }
}

impl Backend for Transport {
    fn grasp(&mut self, spring: usize, tip: Vec2) {
        let pose = self.state.motion().pose;
        let energy = self.state.held.grasp(&self.system.springs, spring, tip, &pose);
        self.state.books.tip_work += self.state.finite_or_fail(energy);
        self.is_stale = true;
    }

    fn release(&mut self, spring: usize) {
        let pose = self.state.motion().pose;
        let energy = self.state.held.release(&self.system.springs, spring, &pose);
        self.state.books.released += self.state.finite_or_fail(energy);
        self.state.dashpot_on_tip[spring] = Vec2::zeros();
        self.is_stale = true;
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let n_steps = n_steps_in(duration, self.step);
        let (start, step) = (self.state.held.grips().to_vec(), duration / n_steps as f64);
        let mut report = StepReport::default();
        for done in 1..=n_steps {
            if self.state.has_failed {
                report.status = Status::Failed;
                break;
            }
            let from = self.state.held.clone();
            self.state.held.place_tips(&start, tip_targets, done as f64 / n_steps as f64);
            report.add(&self.advance_one(from.grips().to_vec(), step));
            if self.state.has_failed {
                self.state.held = from;
            }
        }
        report
    }

    fn motion(&self) -> Motion {
        self.state.motion()
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.state.held.tip(spring)
    }

    fn force_on_tip(&self, spring: usize) -> Vec2 {
        self.state.held.force_on_tip(&self.system.springs, spring, &self.state.motion().pose) + self.state.dashpot_on_tip[spring]
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        self.state.friction_forces.clone()
    }

    fn energy(&self) -> EnergyLedger {
        self.ledger_of(&self.state)
    }

    fn save(&self) -> SavedState {
        SavedState::of(&Saved { options: self.options, state: self.state.clone(), warm_start: self.footing.warm_start().cloned() })
    }

    fn restore(&mut self, state: &SavedState) -> Result<(), RestoreError> {
        let saved: Saved = state.read()?;
        let misfit = |what: &str| Err(RestoreError(what.to_owned()));
        if saved.options != self.options {
            return misfit("it was saved under other options of rapier");
        }
        if saved.state.friction_forces.len() != self.system.ground.supports.len() {
            return misfit("it has another number of supports");
        }
        if saved.state.dashpot_on_tip.len() != self.system.springs.len() {
            return misfit("it has another number of springs");
        }
        saved.state.held.check(&self.system.springs)?;
        self.footing.set_warm_start(saved.warm_start)?;
        self.state = saved.state;
        self.is_stale = true;
        Ok(())
    }
}
