//! One step of the backend: contacts, joints, the engine, and the ledger.

use super::aggregate::fold;
use super::backend::{NOT_FINITE, Rapier, Work};
use super::contact_ledger::add_contacts;
use super::contacts::ObstacleStep;
use super::ground::Drive;
use super::joints::{BodyState, StepInputs};
use super::ledger::{add_friction, add_springs};
use super::options::{EngineSettings, Precision, SpringModel};
use super::residual::{gap_rounding, residual, violation};
use super::springs::{SpringSum, turned};
use super::step::Step;
use crate::backend::numerics::{ENGINE_TOLERANCE, FASTEST_CORRECTION, MORE_SWEEPS};
use crate::backend::report::{Motion, Status, StepReport};
use crate::math::{Twist, Vec2, direction};
use crate::model::Load;
use crate::stop;

impl Rapier {
    /// Makes one step of `duration` (s), from the tips of `work.from` to those of the state, with
    /// the obstacles of `work.obstacles`.
    pub(super) fn advance_one(&mut self, work: &mut Work, duration: f64) -> StepReport {
        let mut report = StepReport { n_steps: 1, ..StepReport::default() };
        let start = self.state.motion();
        let facing = self.state.body.facing();
        self.find_contacts(work, duration);
        let sum = self.set_joints(work, &start, &facing, duration, &mut report);
        let is_finite = self.step_until_solved(work, duration, &sum);
        let of_engine = self.engine.body();
        let moved = if is_finite { of_engine.motion(self.state.heading) } else { NOT_FINITE };
        let body = self.after_bounce(work, of_engine);
        let end = if is_finite { body.motion(self.state.heading) } else { NOT_FINITE };
        let facing_at_end = body.facing();
        work.attached.clear();
        work.attached.extend(self.state.attachments.iter().map(|attachment| self.state_of(attachment, &body, &facing_at_end)));
        let (mut dashpots, mut touches) = (std::mem::take(&mut work.dashpots), std::mem::take(&mut work.touches));
        let mut happened = std::mem::take(&mut work.happened);
        let step = self.finished(work, duration, &sum, end);
        let mut ledger = self.state.ledger;
        let counted = Step { contacts: &work.counted, ..step };
        touches.clone_from(&self.state.touches);
        let from_contacts = add_contacts(&mut ledger, &counted, &mut touches, &mut happened);
        add_friction(&mut ledger, &self.system.load, &step, from_contacts);
        add_springs(&mut ledger, &step, &mut dashpots);
        report.residual = report.residual.max(residual(&self.system.load, self.slip_limit, &step));
        let is_at_rest = report.residual <= ENGINE_TOLERANCE && self.repeats(&step, &body);
        (work.dashpots, work.touches, work.happened) = (dashpots, touches, happened);
        if !self.accept(work, body, end.pose.heading, ledger) {
            return StepReport { status: Status::Failed, n_not_converged: 1, n_steps: 1, residual: 0.0, ..report };
        }
        self.state.is_at_rest = is_at_rest;
        self.add_unbooked(&start, &end, duration);
        if self.options.precision != Precision::F64 {
            report.lost_share = self.lost_share(&start, &moved, duration);
        }
        if report.residual > ENGINE_TOLERANCE || report.lost_share > 0.0 {
            report.status = Status::NotConverged;
            report.n_not_converged = 1;
        }
        report
    }

    /// Share of the path that the poses of the engine have lost by rounding, with a step of
    /// `duration` (s), where it is too large (1); zero where it is not.
    fn lost_share(&mut self, start: &Motion, end: &Motion, duration: f64) -> f64 {
        let (n_substeps, radius) = (self.options.settings.n_substeps(), self.system.load.radius);
        self.state.rounding.add([start, end], duration, n_substeps, radius);
        self.state.rounding.excess(radius).unwrap_or_default()
    }

    /// State of the load at the end of a step that the engine ended in `body`. The engine moves a
    /// load that bounces through the whole step with its velocity after the bounce; here it has its
    /// old velocity until it touches.
    fn after_bounce(&self, work: &Work, body: BodyState) -> BodyState {
        let before = self.state.motion().twist;
        let times = work.contacts.iter().filter_map(|contact| contact.bounces_at(&before));
        let first = times.fold(f64::INFINITY, f64::min);
        if first == f64::INFINITY || self.options.settings != EngineSettings::Recommended {
            return body;
        }
        let turn = direction(first * (before.angular - body.turn_rate));
        let position = body.position + first * (before.linear - body.velocity);
        BodyState { position, rotation: turned(&body.rotation, &turn), ..body }
    }

    /// Adds the energy that the ledger of a step with contacts leaves open. Friction works at the
    /// speed after the step, and contacts at the mean of the speeds before and after it.
    fn add_unbooked(&mut self, start: &Motion, end: &Motion, duration: f64) {
        if self.state.contacts.is_empty() {
            return;
        }
        let (before, after) = (start.twist, end.twist);
        let change = Twist { linear: after.linear - before.linear, angular: after.angular - before.angular };
        let pull: f64 = self.attached.iter().map(|spring| spring.pull.norm()).sum();
        self.state.unbooked += 0.5 * duration * (self.slip_limit + pull) * change.edge_speed(self.system.load.radius);
    }

    /// Writes the contacts that a step of `duration` (s) meets to `work`.
    fn find_contacts(&mut self, work: &mut Work, duration: f64) {
        if self.system.world.is_empty() {
            return;
        }
        if self.options.settings != EngineSettings::Recommended {
            // The engine keeps its contacts; those of the last step are the best guess.
            self.engine.read_contacts(&mut work.contacts);
            self.limit_contacts(work, duration);
            return;
        }
        // Each step starts a new world. The contacts that the engine keeps follow the load up to a
        // degree and a millimetre, and their impulses would be state that cannot be saved.
        self.rebuild(&work.obstacles);
        let reach = self.reach(&work.obstacles, duration);
        self.engine.find_contacts(reach, &mut work.contacts);
        self.limit_contacts(work, duration);
    }

    /// Writes the velocities of the obstacles at the contacts, and the room there, in a step of
    /// `duration` (s) that starts in the present state. The arms of the contacts, also of those
    /// that the engine shows after the step, begin at the position of that state.
    fn limit_contacts(&self, work: &mut Work, duration: f64) {
        let (motion, fastest) = (self.state.motion(), FASTEST_CORRECTION * self.system.load.radius);
        for contact in &mut work.contacts {
            let step = &work.obstacles[contact.obstacle];
            contact.velocity = step.twist.velocity_at(&(motion.pose.position + contact.arm - step.start.position));
            contact.room = contact.room_in(&motion.twist, duration, fastest);
        }
    }

    /// Bound of the displacement of the load towards an obstacle in a step of `duration` (s) (m).
    fn reach(&self, obstacles: &[ObstacleStep], duration: f64) -> f64 {
        let Load { mass, inertia, radius } = self.system.load;
        let speed = self.state.motion().twist.edge_speed(radius);
        let fastest = obstacles
            .iter()
            .zip(&self.system.world.obstacles)
            .fold(0.0, |fastest: f64, (step, obstacle)| fastest.max(step.twist.edge_speed(obstacle.outline.extent())));
        let pull: f64 = self.attached.iter().map(|spring| spring.pull.norm()).sum();
        // A force at the edge moves the edge as if the load were lighter.
        let acceleration = pull / mass * (1.0 + mass * radius * radius / inertia);
        duration * (speed + fastest + duration * acceleration)
    }

    /// Starts a new world of the engine with the state of the load.
    pub(super) fn rebuild(&mut self, obstacles: &[ObstacleStep]) {
        self.is_stale = false;
        let n_springs = match self.options.springs {
            SpringModel::Joint => self.state.attachments.len(),
            SpringModel::Aggregate => usize::from(!self.state.attachments.is_empty()),
            SpringModel::Force => 0,
        };
        self.engine.rebuild(&self.state.body, self.friction.n_joints(), n_springs, obstacles);
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
        let rounding = gap_rounding(&self.system.load, &start.pose, self.options.precision.digit());
        let drive = Drive { motion: start, facing, sum: &sum, duration, contacts: &work.contacts, rounding };
        self.friction.set_joints(&self.system, &drive, report);
        sum
    }

    /// Makes a step of the engine, with more sweeps until contacts and springs agree. Returns
    /// `false` when the engine found no finite state.
    fn step_until_solved(&mut self, work: &mut Work, duration: f64, sum: &SpringSum) -> bool {
        for (at, more) in MORE_SWEEPS.into_iter().enumerate() {
            stop::point();
            if at > 0 {
                self.rebuild(&work.obstacles);
            }
            let is_finite = self.step_engine(work, duration, sum, more);
            let may_repeat = self.options.settings == EngineSettings::Recommended && !work.contacts.is_empty();
            if !is_finite || !may_repeat || self.violation(work, duration, sum) <= self.solved() {
                return is_finite;
            }
        }
        true
    }

    /// Largest violation of the equations of the step that the engine made (1).
    fn violation(&self, work: &Work, duration: f64, sum: &SpringSum) -> f64 {
        let step = self.finished(work, duration, sum, self.engine.body().motion(self.state.heading));
        violation(&self.system.load, self.slip_limit, &step)
    }

    /// Violation below which more sweeps bring nothing (1).
    fn solved(&self) -> f64 {
        match self.options.precision {
            Precision::F64 => 1e-7,
            #[cfg(feature = "rapier-f32")]
            Precision::F32 => 1e-4,
        }
    }

    /// The step that ended with the motion `end`.
    fn finished<'a>(&'a self, work: &'a Work, duration: f64, sum: &'a SpringSum, end: Motion) -> Step<'a> {
        Step {
            duration,
            start: self.state.motion(),
            end,
            facing: self.state.body.facing(),
            from: &work.from,
            to: &self.state.attachments,
            springs: [&self.attached, &work.attached],
            joints: &work.joints,
            sum,
            is_explicit: self.options.springs == SpringModel::Force,
            friction: self.friction.joints(),
            wrenches: &work.wrenches,
            digit: self.options.precision.digit(),
            contacts: &work.contacts,
        }
    }

    /// Makes a step of the engine with `more` times its usual sweeps, and reads the wrenches of
    /// friction. Returns `false` when the engine found no finite state.
    fn step_engine(&mut self, work: &mut Work, duration: f64, sum: &SpringSum, more: usize) -> bool {
        work.folded.clear();
        let (springs, push) = match self.options.springs {
            SpringModel::Joint => (&work.joints, None),
            SpringModel::Aggregate => {
                work.folded.extend((!work.joints.is_empty()).then(|| fold(sum, duration)));
                (&work.folded, None)
            }
            SpringModel::Force => (&work.folded, Some(&sum.wrench)),
        };
        if self.is_stale {
            self.rebuild(&work.obstacles);
        }
        let friction = self.friction.joints();
        let is_finite = self.engine.step(duration, &StepInputs { friction, springs, push, obstacles: &work.obstacles, more_sweeps: more });
        self.engine.read_contacts(&mut work.contacts);
        self.limit_contacts(work, duration);
        work.counted.clear();
        work.counted.extend_from_slice(&work.contacts);
        for (contact, [push, rub]) in work.counted.iter_mut().zip(self.friction.held()) {
            (contact.push, contact.rub) = (*push, *rub);
        }
        work.wrenches.clear();
        work.wrenches.extend((0..friction.len()).map(|joint| self.engine.friction_wrench(joint)));
        is_finite
    }
}
