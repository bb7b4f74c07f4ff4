//! The backend: it divides a duration into engine steps, runs them and keeps the energy ledger.

use serde::{Deserialize, Serialize};

use super::aggregate::fold;
use super::ground::GroundFriction;
use super::joints::{BodyState, Engine, SpringJoint};
use super::ledger::{add_friction, add_springs};
use super::options::{EngineSettings, RapierOptions, SpringModel};
use super::residual::residual;
use super::rest::is_at_rest;
use super::springs::{PreparedSpring, SpringState, SpringSum};
use super::step::Step;
use crate::backend::friction::WarmStart;
use crate::backend::springs::{Attachment, Attachments};
use crate::backend::{
    Backend, BackendOptions, EnergyLedger, Motion, RestoreError, SaveError, SavedState, Skip, Skips, Status, StepReport, n_steps_in,
};
use crate::math::{Pose, Twist, Vec2, Wrench};
use crate::model::System;

/// A load under rapier.
pub struct Rapier {
    system: System,
    /// Largest friction force of all supports together (N).
    slip_limit: f64,
    springs: Vec<PreparedSpring>,
    /// Longest step (s).
    step: f64,
    options: RapierOptions,
    skips: Skips,
    engine: Box<dyn Engine>,
    friction: GroundFriction,
    /// Whether the joints of the engine do not belong to the present attachments.
    is_stale: bool,
    state: State,
    /// Attached springs at the pose of the state, in the order of the attachments.
    attached: Vec<SpringState>,
    work: Work,
}

/// Buffers that are reused from step to step. All lists of springs have the order of the
/// attachments.
#[derive(Default)]
struct Work {
    /// Attachments at the start of the advance.
    begin: Vec<Attachment>,
    /// Attachments at the start of the step.
    from: Vec<Attachment>,
    joints: Vec<SpringJoint>,
    folded: Vec<SpringJoint>,
    /// Attached springs at the end of the step.
    attached: Vec<SpringState>,
    /// Force of each attached spring's dashpots on its tip (N, world).
    dashpots: Vec<Vec2>,
    wrenches: Vec<Wrench>,
}

/// State of a run without that of the friction solver.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct State {
    body: BodyState,
    /// Heading with its whole turns, which the engine does not count (rad).
    heading: f64,
    attachments: Attachments,
    /// Energy of the run without its elastic and kinetic part.
    ledger: EnergyLedger,
    /// Friction force on each support of the ground (N, world).
    friction_forces: Vec<Vec2>,
    /// Force of each spring's dashpots on its tip in the last step (N, world); zero for free
    /// springs.
    dashpot_on_tip: Vec<Vec2>,
    /// Whether a step had no finite answer: nothing moves any more.
    has_failed: bool,
    /// Whether the load was at rest in the last step, and stays so until an attachment or a tip
    /// changes.
    #[serde(default)]
    is_at_rest: bool,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Saved {
    options: RapierOptions,
    state: State,
    warm_start: Option<WarmStart>,
}

/// Residual above which a step counts as not converged (1). A thousandth of the forces is less than
/// the error of a step of a millisecond. Converged iterations end near 1e-15 in f64. In f32 they
/// end near 1e-5, and at 1e-3 for a step of 10 us.
const TOLERANCE: f64 = 1e-3;

/// Speed below which a load is at rest (m/s, rad/s): the engine's iterations shrink a speed to the
/// smallest numbers there are, not to zero. At this speed a load moves less than the diameter of a
/// nucleus in a thousand years.
const REST_SPEED: f64 = 1e-30;

/// Motion at the end of a step without a finite answer.
const NOT_FINITE: Motion = Motion {
    pose: Pose { position: Vec2::new(f64::NAN, f64::NAN), heading: f64::NAN },
    twist: Twist { linear: Vec2::new(f64::NAN, f64::NAN), angular: f64::NAN },
};

impl Rapier {
    pub fn new(system: System, start: Motion, options: &BackendOptions, engine: Box<dyn Engine>) -> Self {
        let body = engine.body();
        let mut state = State {
            body,
            heading: body.motion(start.pose.heading).pose.heading,
            attachments: Attachments::default(),
            ledger: EnergyLedger::default(),
            friction_forces: vec![Vec2::zeros(); system.ground.supports.len()],
            dashpot_on_tip: vec![Vec2::zeros(); system.springs.len()],
            has_failed: false,
            is_at_rest: false,
        };
        state.ledger.initial = system.load.kinetic_energy(&state.motion().twist);
        Self {
            slip_limit: system.total_slip_limit(),
            springs: PreparedSpring::of(&system),
            step: options.step_s,
            options: options.rapier,
            skips: options.skips,
            engine,
            friction: GroundFriction::new(&system, options.rapier.friction),
            is_stale: true,
            state,
            attached: Vec::new(),
            work: Work::default(),
            system,
        }
    }

    /// Reason why all further steps of an advance are known. `tips_stay` states whether the advance
    /// moves no attached tip.
    fn known(&self, tips_stay: bool) -> Option<Skip> {
        let State { attachments, body, is_at_rest, .. } = &self.state;
        if attachments.is_empty() {
            // Nothing pulls at a load at rest: it stays at rest under any friction law.
            let is_still = body.velocity.amax().max(body.turn_rate.abs()) < REST_SPEED;
            return (self.skips.free_load && is_still).then_some(Skip::FreeLoad);
        }
        (self.skips.still_tips && *is_at_rest && tips_stay).then_some(Skip::StillTips)
    }

    fn skip(&mut self, why: Skip, n_steps: u64) -> StepReport {
        if why == Skip::FreeLoad {
            self.state.friction_forces.fill(Vec2::zeros());
        }
        let mut report = StepReport::default();
        report.leave_out(why, n_steps);
        report
    }

    /// Makes one step of `duration` (s), from the tips of `work.from` to those of the state.
    fn advance_one(&mut self, work: &mut Work, duration: f64) -> StepReport {
        let mut report = StepReport { n_steps: 1, ..StepReport::default() };
        let start = self.state.motion();
        let facing = self.state.body.facing();
        let sum = self.set_joints(work, &start, &facing, duration, &mut report);
        let is_finite = self.step_engine(work, duration, &sum);
        let body = self.engine.body();
        let end = if is_finite { body.motion(self.state.heading) } else { NOT_FINITE };
        let facing_at_end = body.facing();
        work.attached.clear();
        work.attached.extend(self.state.attachments.iter().map(|attachment| self.state_of(attachment, &body, &facing_at_end)));
        let step = Step {
            duration,
            start,
            end,
            facing,
            from: &work.from,
            to: &self.state.attachments,
            springs: [&self.attached, &work.attached],
            joints: &work.joints,
            sum: &sum,
            is_explicit: self.options.springs == SpringModel::Force,
            friction: self.friction.joints(),
            wrenches: &work.wrenches,
        };
        let mut ledger = self.state.ledger;
        add_friction(&mut ledger, &self.system.load, &step);
        add_springs(&mut ledger, &step, &mut work.dashpots);
        report.residual = report.residual.max(residual(&self.system.load, self.slip_limit, &step));
        let is_at_rest = report.residual <= TOLERANCE && self.repeats(&step, &body);
        if !self.accept(work, body, end.pose.heading, ledger) {
            return StepReport { status: Status::Failed, n_not_converged: 1, n_steps: 1, residual: 0.0, ..report };
        }
        self.state.is_at_rest = is_at_rest;
        if report.residual > TOLERANCE {
            report.status = Status::NotConverged;
            report.n_not_converged = 1;
        }
        report
    }

    /// Whether a converged `step` to the state `after` repeats itself.
    fn repeats(&self, step: &Step, after: &BodyState) -> bool {
        self.options.settings == EngineSettings::Recommended
            && self.friction.may_rest()
            && step.from.iter().zip(step.to).all(|(before, after)| before.tip == after.tip)
            && is_at_rest(step, &self.state.body, after, self.system.load.radius)
    }

    /// Writes the joints of a step to `work` and returns the sum of the springs.
    fn set_joints(&mut self, work: &mut Work, start: &Motion, facing: &Vec2, duration: f64, report: &mut StepReport) -> SpringSum {
        work.joints.clear();
        for (attachment, before) in self.state.attachments.iter().zip(&work.from) {
            let tip_velocity = (attachment.tip - before.tip) / duration;
            work.joints.push(self.springs[attachment.spring].joint(attachment, &tip_velocity, &start.pose.position, facing));
        }
        let sum = match self.options.springs {
            SpringModel::Joint | SpringModel::Aggregate => SpringSum::of(&work.joints),
            SpringModel::Force => SpringSum::explicit(&work.joints, &start.twist),
        };
        self.friction.set_joints(&self.system, start, facing, &sum, duration, report);
        sum
    }

    /// Makes a step of the engine and reads the wrenches of friction. Returns `false` when the
    /// engine found no finite state.
    fn step_engine(&mut self, work: &mut Work, duration: f64, sum: &SpringSum) -> bool {
        work.folded.clear();
        let (springs, push) = match self.options.springs {
            SpringModel::Joint => (&work.joints, None),
            SpringModel::Aggregate => {
                work.folded.extend((!work.joints.is_empty()).then(|| fold(sum, duration)));
                (&work.folded, None)
            }
            SpringModel::Force => (&work.folded, Some(&sum.wrench)),
        };
        let friction = self.friction.joints();
        if std::mem::take(&mut self.is_stale) {
            self.engine.rebuild(&self.state.body, friction.len(), springs.len());
        }
        let is_finite = self.engine.step(duration, friction, springs, push);
        work.wrenches.clear();
        work.wrenches.extend((0..friction.len()).map(|joint| self.engine.friction_wrench(joint)));
        is_finite
    }

    /// Takes the end of a step as the new state. Returns `false` for an end that is not finite: it
    /// is not taken, and nothing moves from then on.
    fn accept(&mut self, work: &mut Work, body: BodyState, heading: f64, ledger: EnergyLedger) -> bool {
        let is_finite = body.is_finite()
            && heading.is_finite()
            && self.state.attachments.iter().all(|attachment| attachment.tip.x.is_finite() && attachment.tip.y.is_finite())
            && work.attached.iter().all(|spring| spring.swing.is_finite())
            && work.dashpots.iter().all(|force| force.x.is_finite() && force.y.is_finite())
            && work.wrenches.iter().all(|wrench| wrench.force.x.is_finite() && wrench.force.y.is_finite())
            && ledger.numerical_damping.is_finite()
            && self.with_present_energy(ledger, &work.attached, &body.motion_at(heading)).defect().is_finite();
        if !is_finite {
            self.state.has_failed = true;
            self.is_stale = true;
            return false;
        }
        let state = &mut self.state;
        (state.body, state.heading, state.ledger) = (body, heading, ledger);
        state.attachments.set_swings(work.attached.iter().map(|spring| spring.swing));
        for (attachment, force) in state.attachments.iter().zip(&work.dashpots) {
            state.dashpot_on_tip[attachment.spring] = *force;
        }
        state.friction_forces.fill(Vec2::zeros());
        for (joint, wrench) in self.friction.joints().iter().zip(&work.wrenches) {
            state.friction_forces[joint.support] += joint.stuck_force.unwrap_or(wrench.force);
        }
        std::mem::swap(&mut self.attached, &mut work.attached);
        true
    }

    fn state_of(&self, attachment: &Attachment, body: &BodyState, facing: &Vec2) -> SpringState {
        self.springs[attachment.spring].state(attachment, &body.position, facing)
    }

    /// The ledger with the elastic energy of `attached` and the kinetic energy of `motion`.
    fn with_present_energy(&self, ledger: EnergyLedger, attached: &[SpringState], motion: &Motion) -> EnergyLedger {
        let elastic = attached.iter().fold(0.0, |sum, spring| sum + spring.energy);
        EnergyLedger { elastic, kinetic: self.system.load.kinetic_energy(&motion.twist), ..ledger }
    }

    /// The engine needs other joints, and a load at rest may start to move.
    fn forget_joints(&mut self) {
        self.is_stale = true;
        self.state.is_at_rest = false;
    }
}

impl State {
    fn motion(&self) -> Motion {
        self.body.motion_at(self.heading)
    }
}

impl Backend for Rapier {
    fn attach(&mut self, spring: usize, tip: Vec2) {
        let pose = self.state.motion().pose;
        self.state.ledger.tip_work += self.state.attachments.attach(&self.system.springs, spring, tip, &pose);
        let at = self.state.attachments.partition_point(|attachment| attachment.spring < spring);
        self.attached.insert(at, self.state_of(&self.state.attachments[at], &self.state.body, &self.state.body.facing()));
        self.forget_joints();
    }

    fn release(&mut self, spring: usize) {
        let pose = self.state.motion().pose;
        let at = self.state.attachments.partition_point(|attachment| attachment.spring < spring);
        self.state.ledger.released += self.state.attachments.release(&self.system.springs, spring, &pose);
        self.attached.remove(at);
        self.state.dashpot_on_tip[spring] = Vec2::zeros();
        self.forget_joints();
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        if !(duration > 0.0 && duration.is_finite()) {
            return StepReport::refused();
        }
        let n_steps = n_steps_in(duration, self.step);
        let step = duration / n_steps as f64;
        let mut work = std::mem::take(&mut self.work);
        work.begin.clear();
        work.begin.extend_from_slice(&self.state.attachments);
        let tips_stay = self.state.attachments.tips_are_at(tip_targets);
        let mut report = StepReport::default();
        for done in 1..=n_steps {
            if self.state.has_failed {
                report.status = Status::Failed;
                break;
            }
            if let Some(why) = self.known(tips_stay) {
                report.add(&self.skip(why, n_steps + 1 - done));
                break;
            }
            work.from.clear();
            work.from.extend_from_slice(&self.state.attachments);
            self.state.attachments.place_tips(&work.begin, tip_targets, done as f64 / n_steps as f64);
            report.add(&self.advance_one(&mut work, step));
            if self.state.has_failed {
                self.state.attachments.as_mut_slice().copy_from_slice(&work.from);
            }
        }
        self.work = work;
        report
    }

    fn motion(&self) -> Motion {
        self.state.motion()
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.state.attachments.tip(spring)
    }

    fn pull(&self, spring: usize) -> Vec2 {
        let at = self.state.attachments.place(spring);
        at.map_or(Vec2::zeros(), |at| -(self.state.dashpot_on_tip[spring] - self.attached[at].pull))
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        self.state.friction_forces.clone()
    }

    fn energy(&self) -> EnergyLedger {
        self.with_present_energy(self.state.ledger, &self.attached, &self.state.motion())
    }

    fn save(&self) -> Result<SavedState, SaveError> {
        Ok(SavedState::of(&Saved { options: self.options, state: self.state.clone(), warm_start: self.friction.warm_start().cloned() }))
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
        saved.state.attachments.check(&self.system.springs)?;
        self.friction.set_warm_start(saved.warm_start)?;
        self.state = saved.state;
        let (body, facing) = (&self.state.body, self.state.body.facing());
        self.attached = self.state.attachments.iter().map(|attachment| self.state_of(attachment, body, &facing)).collect();
        self.is_stale = true;
        Ok(())
    }
}
