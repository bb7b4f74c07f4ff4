//! The backend itself: cuts a duration into engine steps, asks each of the engine and keeps the books.

use serde::{Deserialize, Serialize};

use super::aggregate::fold;
use super::ground::Footing;
use super::joints::{BodyState, Engine, SpringJoint};
use super::ledger::Books;
use super::residual::residual;
use super::rest::stood;
use super::springs::{Anchor, SpringSum, Strand};
use super::step::Step;
use super::{EngineSettings, RapierOptions, SpringModel};
use crate::backend::friction::WarmStart;
use crate::backend::springs::{Attachment, Attachments};
use crate::backend::{
    Backend, BackendOptions, EnergyLedger, Motion, RestoreError, SaveError, SavedState, Skip, Skips, Status, StepReport, n_steps_in,
};
use crate::math::{Twist, Vec2, Wrench};
use crate::model::System;

/// A load under rapier.
pub struct Transport {
    system: System,
    /// What all supports together resist at most (N).
    slip_limit: f64,
    anchors: Vec<Anchor>,
    /// Longest step (s).
    step: f64,
    options: RapierOptions,
    skips: Skips,
    engine: Box<dyn Engine>,
    footing: Footing,
    /// Whether the engine has other joints than the held springs ask for.
    is_stale: bool,
    state: State,
    /// The held springs at the state's pose, in the order of the attachments.
    strands: Vec<Strand>,
    work: Work,
}

/// What a step needs room for, kept from one to the next.
#[derive(Default)]
struct Work {
    /// Grips at the start of the advance and of the step.
    begin: Vec<Attachment>,
    from: Vec<Attachment>,
    springs: Vec<SpringJoint>,
    folded: Vec<SpringJoint>,
    strands: Vec<Strand>,
    /// Force of each held spring's dashpots on its tip (N, world).
    dashpots: Vec<Vec2>,
    wrenches: Vec<Wrench>,
}

/// What a run is besides its friction solver: all that [`Backend::save`] needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct State {
    body: BodyState,
    /// With its whole turns, which the engine does not count (rad).
    heading: f64,
    held: Attachments,
    books: Books,
    /// On each support of the ground (N, world).
    friction_forces: Vec<Vec2>,
    /// Force of each spring's dashpots on its tip in the last step (N, world); zero for free ones.
    dashpot_on_tip: Vec<Vec2>,
    /// The engine had no finite answer once: nothing moves any more.
    has_failed: bool,
    /// The load stood in the last step, and so it will as long as nothing is grasped, let go or moved.
    #[serde(default)]
    rests: bool,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Saved {
    options: RapierOptions,
    state: State,
    warm_start: Option<WarmStart>,
}

impl Transport {
    pub fn new(system: System, start: Motion, options: &BackendOptions, engine: Box<dyn Engine>) -> Self {
        let body = engine.body();
        let mut state = State {
            body,
            heading: body.motion(start.pose.heading).pose.heading,
            held: Attachments::default(),
            books: Books::default(),
            friction_forces: vec![Vec2::zeros(); system.ground.supports.len()],
            dashpot_on_tip: vec![Vec2::zeros(); system.springs.len()],
            has_failed: false,
            rests: false,
        };
        state.books.initial = system.load.kinetic_energy(&state.motion().twist);
        Self {
            slip_limit: system.total_slip_limit(),
            anchors: Anchor::of(&system),
            step: options.step_s,
            options: options.rapier,
            skips: options.skips,
            engine,
            footing: Footing::new(&system, options.rapier.friction),
            is_stale: true,
            state,
            strands: Vec::new(),
            work: Work::default(),
            system,
        }
    }

    /// Why all steps until something is grasped, let go or moved are known without making them; `tips_stay` says whether this advance moves no held tip.
    fn known(&self, tips_stay: bool) -> Option<Skip> {
        let State { held, body, rests, .. } = &self.state;
        if held.is_empty() {
            // Nothing pulls at a load that does not move: it stays, by any friction law.
            let is_still = body.velocity.amax().max(body.turn_rate.abs()) < REST_SPEED;
            return (self.skips.free_load && is_still).then_some(Skip::FreeLoad);
        }
        (self.skips.still_tips && *rests && tips_stay).then_some(Skip::StillTips)
    }

    /// Leaves out `n_steps`.
    fn skip(&mut self, why: Skip, n_steps: u64) -> StepReport {
        if why == Skip::FreeLoad {
            self.state.friction_forces.fill(Vec2::zeros());
        }
        let mut report = StepReport::default();
        report.leave_out(why, n_steps);
        report
    }

    /// One step of `duration` (s) that ends with the tips where `state.held` has them now; `work.from` tells where they were.
    fn advance_one(&mut self, work: &mut Work, duration: f64) -> StepReport {
        let mut report = StepReport { n_steps: 1, ..StepReport::default() };
        let start = self.state.motion();
        let facing = self.state.body.facing();
        let sum = self.pose(work, &start, &facing, duration, &mut report);
        let is_finite = self.ask(work, duration, &sum);
        let body = self.engine.body();
        let end = if is_finite { body.motion(self.state.heading) } else { NOWHERE };
        let facing_at_end = body.facing();
        let strands = self.state.held.iter().map(|grip| self.anchors[grip.spring].strand(grip, &body.position, &facing_at_end));
        work.strands.clear();
        work.strands.extend(strands);
        let step = Step {
            duration,
            start,
            end,
            facing,
            from: &work.from,
            to: &self.state.held,
            strands: [&self.strands, &work.strands],
            springs: &work.springs,
            sum: &sum,
            is_explicit: self.options.springs == SpringModel::Force,
            friction: self.footing.joints(),
            wrenches: &work.wrenches,
        };
        let mut books = self.state.books;
        books.add_friction(&self.system.load, &step);
        books.add_springs(&step, &mut work.dashpots);
        report.residual = report.residual.max(residual(&self.system.load, self.slip_limit, &step));
        let rests = report.residual <= TOLERANCE && self.rests_after(&step, &body);
        if !self.keep(work, body, end.pose.heading, books) {
            return StepReport { status: Status::Failed, n_not_converged: 1, n_steps: 1, residual: 0.0, ..report };
        }
        self.state.rests = rests;
        if report.residual > TOLERANCE {
            report.status = Status::NotConverged;
            report.n_not_converged = 1;
        }
        report
    }

    /// Whether a converged `step` to the state `after` is one that repeats itself.
    fn rests_after(&self, step: &Step, after: &BodyState) -> bool {
        self.options.settings == EngineSettings::Recommended
            && self.footing.may_hold()
            && step.from.iter().zip(step.to).all(|(before, after)| before.tip == after.tip)
            && stood(step, &self.state.body, after, self.system.load.radius)
    }

    /// Writes the step down as joints; returns the sum of the springs.
    fn pose(&mut self, work: &mut Work, start: &Motion, facing: &Vec2, duration: f64, report: &mut StepReport) -> SpringSum {
        work.springs.clear();
        for (grip, before) in self.state.held.iter().zip(&work.from) {
            let tip_velocity = (grip.tip - before.tip) / duration;
            work.springs.push(self.anchors[grip.spring].joint(grip, &tip_velocity, &start.pose.position, facing));
        }
        let sum = match self.options.springs {
            SpringModel::Joint | SpringModel::Aggregate => SpringSum::of(&work.springs),
            SpringModel::Force => SpringSum::explicit(&work.springs, &start.twist),
        };
        self.footing.pose(&self.system, start, facing, &sum, duration, report);
        sum
    }

    /// Has the engine make the step and reads the forces of friction. The answer no says that it found no finite state.
    fn ask(&mut self, work: &mut Work, duration: f64, sum: &SpringSum) -> bool {
        work.folded.clear();
        let (springs, push) = match self.options.springs {
            SpringModel::Joint => (&work.springs, None),
            SpringModel::Aggregate => {
                work.folded.extend((!work.springs.is_empty()).then(|| fold(sum, duration)));
                (&work.folded, None)
            }
            SpringModel::Force => (&work.folded, Some(&sum.wrench)),
        };
        let friction = self.footing.joints();
        if std::mem::take(&mut self.is_stale) {
            self.engine.rebuild(&self.state.body, friction.len(), springs.len());
        }
        let is_finite = self.engine.step(duration, friction, springs, push);
        work.wrenches.clear();
        work.wrenches.extend((0..friction.len()).map(|joint| self.engine.friction_wrench(joint)));
        is_finite
    }

    /// Takes over where the step ended. A step without a finite end is not taken over, and nothing moves from then on.
    fn keep(&mut self, work: &mut Work, body: BodyState, heading: f64, books: Books) -> bool {
        let strands = &work.strands;
        let motion = body.motion_at(heading);
        let elastic = strands.iter().fold(0.0, |sum, strand| sum + strand.energy);
        let is_finite = body.is_finite()
            && heading.is_finite()
            && self.state.held.iter().all(|grip| grip.tip.x.is_finite() && grip.tip.y.is_finite())
            && strands.iter().all(|strand| strand.swing.is_finite())
            && work.dashpots.iter().all(|force| force.x.is_finite() && force.y.is_finite())
            && work.wrenches.iter().all(|wrench| wrench.force.x.is_finite() && wrench.force.y.is_finite())
            && books.is_finite()
            && self.ledger_of(&books, elastic, &motion).defect().is_finite();
        if !is_finite {
            self.state.has_failed = true;
            self.is_stale = true;
            return false;
        }
        let state = &mut self.state;
        (state.body, state.heading, state.books) = (body, heading, books);
        state.held.set_swings(strands.iter().map(|strand| strand.swing));
        for (grip, force) in state.held.iter().zip(&work.dashpots) {
            state.dashpot_on_tip[grip.spring] = *force;
        }
        state.friction_forces.fill(Vec2::zeros());
        for (joint, wrench) in self.footing.joints().iter().zip(&work.wrenches) {
            state.friction_forces[joint.support] += joint.stuck_force.unwrap_or(wrench.force);
        }
        std::mem::swap(&mut self.strands, &mut work.strands);
        true
    }

    /// Puts the tips back to where they were.
    fn withdraw(&mut self, from: &[Attachment]) {
        let mut tips = vec![Vec2::zeros(); self.system.springs.len()];
        from.iter().for_each(|grip| tips[grip.spring] = grip.tip);
        self.state.held.place_tips(from, &tips, 1.0);
    }

    fn strand_of(&self, grip: &Attachment) -> Strand {
        self.anchors[grip.spring].strand(grip, &self.state.body.position, &self.state.body.facing())
    }

    fn ledger_of(&self, books: &Books, elastic: f64, motion: &Motion) -> EnergyLedger {
        EnergyLedger {
            elastic,
            kinetic: self.system.load.kinetic_energy(&motion.twist),
            friction: books.friction,
            damping: books.damping,
            released: books.released,
            tip_work: books.tip_work,
            initial: books.initial,
            jumps: 0.0,
            numerical_damping: books.numerical_damping,
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
        self.body.motion_at(self.heading)
    }

    /// Nothing without a value gets into the books: a tip too far away for its energy ends the run instead.
    fn finite_or_fail(&mut self, energy: f64) -> f64 {
        self.has_failed |= !energy.is_finite();
        if energy.is_finite() { energy } else { 0.0 }
    }
}

impl Backend for Transport {
    fn attach(&mut self, spring: usize, tip: Vec2) {
        let pose = self.state.motion().pose;
        let energy = self.state.held.attach(&self.system.springs, spring, tip, &pose);
        self.state.books.tip_work += self.state.finite_or_fail(energy);
        let at = self.state.held.partition_point(|grip| grip.spring < spring);
        self.strands.insert(at, self.strand_of(&self.state.held[at]));
        self.is_stale = true;
        self.state.rests = false;
    }

    fn release(&mut self, spring: usize) {
        let pose = self.state.motion().pose;
        let at = self.state.held.partition_point(|grip| grip.spring < spring);
        let energy = self.state.held.release(&self.system.springs, spring, &pose);
        self.strands.remove(at);
        self.state.books.released += self.state.finite_or_fail(energy);
        self.state.dashpot_on_tip[spring] = Vec2::zeros();
        self.is_stale = true;
        self.state.rests = false;
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        if !(duration > 0.0 && duration.is_finite()) {
            return StepReport::refused();
        }
        let n_steps = n_steps_in(duration, self.step);
        let step = duration / n_steps as f64;
        let mut work = std::mem::take(&mut self.work);
        work.begin.clear();
        work.begin.extend_from_slice(&self.state.held);
        let tips_stay = self.state.held.tips_are_at(tip_targets);
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
            work.from.extend_from_slice(&self.state.held);
            self.state.held.place_tips(&work.begin, tip_targets, done as f64 / n_steps as f64);
            report.add(&self.advance_one(&mut work, step));
            if self.state.has_failed {
                self.withdraw(&work.from);
            }
        }
        self.work = work;
        report
    }

    fn motion(&self) -> Motion {
        self.state.motion()
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.state.held.tip(spring)
    }

    fn pull(&self, spring: usize) -> Vec2 {
        self.state.held.place(spring).map_or(Vec2::zeros(), |at| -(self.state.dashpot_on_tip[spring] - self.strands[at].pull))
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        self.state.friction_forces.clone()
    }

    fn energy(&self) -> EnergyLedger {
        let elastic = self.strands.iter().fold(0.0, |sum, strand| sum + strand.energy);
        self.ledger_of(&self.state.books, elastic, &self.state.motion())
    }

    fn save(&self) -> Result<SavedState, SaveError> {
        Ok(SavedState::of(&Saved { options: self.options, state: self.state.clone(), warm_start: self.footing.warm_start().cloned() }))
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
        self.strands = self.state.held.iter().map(|grip| self.strand_of(grip)).collect();
        self.is_stale = true;
        Ok(())
    }
}
