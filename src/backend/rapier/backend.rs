//! The backend: it divides a duration into engine steps, runs them and keeps the energy ledger.

use serde::{Deserialize, Serialize};

use super::contact_ledger::Touch;
use super::contacts::{ContactPoint, ObstacleStep};
use super::ground::GroundFriction;
use super::joints::{BodyState, Engine, SpringJoint};
use super::options::{EngineSettings, RapierOptions};
use super::rest::is_at_rest;
use super::rounding::Rounding;
use super::springs::{PreparedSpring, SpringState};
use super::step::Step;
use crate::backend::friction::WarmStart;
use crate::backend::interface::Backend;
use crate::backend::numerics::REST_SPEED;
use crate::backend::options::BackendOptions;
use crate::backend::report::{
    Balance, EnergyLedger, Motion, RestoreError, SaveError, SavedState, SideContact, Skip, Skips, Status, StepReport, Transition,
    TransitionKind,
};
use crate::backend::springs::{Attachment, Attachments};
use crate::backend::steered::Steered;
use crate::backend::stepping::n_steps_in;
use crate::math::{Pose, Twist, Vec2, Wrench};
use crate::model::{ObstaclePath, ObstaclePose, System};
use crate::stop;

/// A load under rapier.
pub struct Rapier {
    pub(super) system: System,
    /// Largest friction force of all supports together (N).
    pub(super) slip_limit: f64,
    pub(super) springs: Vec<PreparedSpring>,
    /// Longest step (s).
    pub(super) step: f64,
    pub(super) options: RapierOptions,
    pub(super) skips: Skips,
    pub(super) engine: Box<dyn Engine>,
    pub(super) friction: GroundFriction,
    /// Whether the joints of the engine do not belong to the present attachments.
    pub(super) is_stale: bool,
    steered: Steered,
    pub(super) state: State,
    /// Attached springs at the pose of the state, in the order of the attachments.
    pub(super) attached: Vec<SpringState>,
    pub(super) transitions: Vec<Transition>,
    pub(super) work: Work,
}

/// Buffers that are reused from step to step. All lists of springs have the order of the
/// attachments.
#[derive(Default)]
pub(super) struct Work {
    /// Attachments at the start of the advance.
    pub(super) begin: Vec<Attachment>,
    /// Attachments at the start of the step.
    pub(super) from: Vec<Attachment>,
    pub(super) joints: Vec<SpringJoint>,
    pub(super) folded: Vec<SpringJoint>,
    /// Attached springs at the end of the step.
    pub(super) attached: Vec<SpringState>,
    /// Force of each attached spring's dashpots on its tip (N, world).
    pub(super) dashpots: Vec<Vec2>,
    pub(super) wrenches: Vec<Wrench>,
    pub(super) obstacles: Vec<ObstacleStep>,
    /// Contacts of the step with the forces of the engine.
    pub(super) contacts: Vec<ContactPoint>,
    /// Contacts of the step with the forces that count.
    pub(super) counted: Vec<ContactPoint>,
    /// What the step found at each obstacle.
    pub(super) touches: Vec<Touch>,
    pub(super) happened: Vec<TransitionKind>,
}

/// State of a run without that of the friction solver.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct State {
    pub(super) body: BodyState,
    /// Heading with its whole turns, which the engine does not count (rad).
    pub(super) heading: f64,
    pub(super) attachments: Attachments,
    /// Energy of the run without its elastic and kinetic part.
    pub(super) ledger: EnergyLedger,
    /// Friction force on each support of the ground (N, world).
    pub(super) friction_forces: Vec<Vec2>,
    /// Force of each spring's dashpots on its tip in the last step (N, world); zero for free
    /// springs.
    pub(super) dashpot_on_tip: Vec<Vec2>,
    /// Whether a step had no finite answer: nothing moves any more.
    pub(super) has_failed: bool,
    /// Whether the load was at rest in the last step, and stays so until an attachment or a tip
    /// changes.
    #[serde(default)]
    pub(super) is_at_rest: bool,
    /// Sum of the durations of all advances (s): the time of the paths of obstacles.
    #[serde(default)]
    pub(super) elapsed: f64,
    /// What the last steps found at each obstacle.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) touches: Vec<Touch>,
    /// What the poses of the engine have lost by rounding, in single precision.
    #[serde(default)]
    pub(super) rounding: Rounding,
    /// Energy that went into the run.
    #[serde(default)]
    pub(super) balance: Balance,
    /// Energy that the ledger has left open since the balance was judged (J).
    #[serde(default)]
    pub(super) unbooked: f64,
    /// Contacts that pushed the load in the last step.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) contacts: Vec<SideContact>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Saved {
    options: RapierOptions,
    state: State,
    warm_start: Option<WarmStart>,
    /// Contact forces under a load at rest (normal and tangent, N).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    held: Vec<[f64; 2]>,
    /// What the engine keeps from step to step, where it keeps contacts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    memory: Option<String>,
    /// Paths of the obstacles that were steered.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    steered: Vec<(usize, ObstaclePath)>,
}

/// Motion at the end of a step without a finite answer.
pub(super) const NOT_FINITE: Motion = Motion {
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
            elapsed: 0.0,
            touches: vec![Touch::default(); system.world.obstacles.len()],
            rounding: Rounding::default(),
            balance: Balance::default(),
            unbooked: 0.0,
            contacts: Vec::new(),
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
            steered: Steered::default(),
            state,
            attached: Vec::new(),
            transitions: Vec::new(),
            work: Work::default(),
            system,
        }
    }

    /// Whether an obstacle touches the load or moves at the time `start` (s) or later.
    fn is_disturbed(&self, start: f64) -> bool {
        let moves = |path: &ObstaclePath| path.moves() && path.waypoints.last().is_some_and(|(end, _)| *end > start);
        self.state.touches.iter().any(Touch::is_closed) || self.system.world.obstacles.iter().any(|obstacle| moves(&obstacle.path))
    }

    /// Reason why all further steps of an advance are known. `tips_stay` states whether the advance
    /// moves no attached tip, and `start` is the time of the next step (s).
    fn known(&self, tips_stay: bool, start: f64) -> Option<Skip> {
        if self.is_disturbed(start) {
            return None;
        }
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

    /// Whether a converged `step` to the state `after` repeats itself.
    pub(super) fn repeats(&self, step: &Step, after: &BodyState) -> bool {
        self.options.settings == EngineSettings::Recommended
            && self.friction.may_rest()
            && step.from.iter().zip(step.to).all(|(before, after)| before.tip == after.tip)
            && is_at_rest(step, &self.state.body, after, self.system.load.radius)
    }

    /// Takes the end of a step as the new state. Returns `false` for an end that is not finite: it
    /// is not taken, and nothing moves from then on.
    pub(super) fn accept(&mut self, work: &mut Work, body: BodyState, heading: f64, ledger: EnergyLedger) -> bool {
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
        std::mem::swap(&mut state.touches, &mut work.touches);
        state.contacts.clear();
        let pushing = work.counted.iter().filter(|contact| contact.push > 0.0);
        state.contacts.extend(pushing.map(|contact| contact.at(&state.body.motion_at(heading).pose)));
        state.friction_forces.fill(Vec2::zeros());
        for (joint, wrench) in self.friction.joints().iter().zip(&work.wrenches) {
            state.friction_forces[joint.support] += joint.stuck_force.unwrap_or(wrench.force);
        }
        std::mem::swap(&mut self.attached, &mut work.attached);
        true
    }

    pub(super) fn state_of(&self, attachment: &Attachment, body: &BodyState, facing: &Vec2) -> SpringState {
        self.springs[attachment.spring].state(attachment, &body.position, facing)
    }

    /// The ledger with the elastic energy of `attached` and the kinetic energy of `motion`.
    fn with_present_energy(&self, ledger: EnergyLedger, attached: &[SpringState], motion: &Motion) -> EnergyLedger {
        let elastic = attached.iter().fold(0.0, |sum, spring| sum + spring.energy);
        EnergyLedger { elastic, kinetic: self.system.load.kinetic_energy(&motion.twist), ..ledger }
    }

    /// Energy that the rounding of the engine's positions moves in a step (J): the forces on the
    /// load times a last digit of its place.
    fn rounding_energy(&self) -> f64 {
        let pull: f64 = self.attached.iter().map(|spring| spring.pull.norm()).sum();
        let push: f64 = self.state.contacts.iter().map(|contact| contact.force.norm()).sum();
        let reach = self.state.body.position.norm() + self.system.load.radius;
        self.options.precision.digit() * (self.slip_limit + pull + push) * reach
    }

    /// Whether the engine keeps contacts from step to step. With the recommended settings each step
    /// finds them anew.
    fn keeps_contacts(&self) -> bool {
        self.options.settings == EngineSettings::EngineDefaults && !self.system.world.is_empty()
    }

    /// Obstacles where they are now.
    fn obstacles_now(&self) -> Vec<ObstacleStep> {
        let mut steps = Vec::new();
        ObstacleStep::all(&self.system.world, [self.state.elapsed; 2], 1.0, &mut steps);
        steps
    }

    /// The engine needs other joints, and a load at rest may start to move.
    fn forget_joints(&mut self) {
        self.is_stale = true;
        self.state.is_at_rest = false;
    }
}

impl State {
    pub(super) fn motion(&self) -> Motion {
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
        let begin = self.state.elapsed;
        let time_after = |done: u64| begin + duration * (done as f64 / n_steps as f64);
        self.transitions.clear();
        let mut work = std::mem::take(&mut self.work);
        work.begin.clear();
        work.begin.extend_from_slice(&self.state.attachments);
        let tips_stay = self.state.attachments.tips_are_at(tip_targets);
        let mut report = StepReport::default();
        for done in 1..=n_steps {
            stop::point();
            if self.state.has_failed {
                report.status = Status::Failed;
                break;
            }
            let start = time_after(done - 1);
            if let Some(why) = self.known(tips_stay, start) {
                report.add(&self.skip(why, n_steps + 1 - done));
                break;
            }
            work.from.clear();
            work.from.extend_from_slice(&self.state.attachments);
            self.state.attachments.place_tips(&work.begin, tip_targets, done as f64 / n_steps as f64);
            ObstacleStep::all(&self.system.world, [start, time_after(done)], step, &mut work.obstacles);
            report.add(&self.advance_one(&mut work, step));
            let time = time_after(done) - begin;
            self.transitions.extend(work.happened.drain(..).map(|kind| Transition { time, kind }));
            if self.state.has_failed {
                self.state.attachments.as_mut_slice().copy_from_slice(&work.from);
            }
        }
        self.state.elapsed += duration;
        self.work = work;
        let unbooked = std::mem::take(&mut self.state.unbooked) + report.n_steps as f64 * self.rounding_energy();
        self.state.balance.judge(&self.energy(), unbooked, &mut report);
        report
    }

    fn steer(&mut self, obstacle: usize, course: &[(f64, Pose)]) -> bool {
        let is_steered = self.steered.steer(&mut self.system.world, obstacle, self.state.elapsed, course);
        if is_steered && self.engine.let_move(obstacle) {
            self.is_stale = true;
        }
        is_steered
    }

    fn steered(&self) -> Vec<ObstaclePose> {
        self.steered.poses(&self.system.world, self.state.elapsed)
    }

    fn transitions(&self) -> &[Transition] {
        &self.transitions
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

    fn side_contacts(&self) -> Vec<SideContact> {
        self.state.contacts.clone()
    }

    fn energy(&self) -> EnergyLedger {
        self.with_present_energy(self.state.ledger, &self.attached, &self.state.motion())
    }

    fn save(&self) -> Result<SavedState, SaveError> {
        let warm_start = self.friction.warm_start().cloned();
        let memory = (self.keeps_contacts() && !self.is_stale).then(|| self.engine.memory());
        let (held, steered) = (self.friction.held().to_vec(), self.steered.save(&self.system.world));
        Ok(SavedState::of(&Saved { options: self.options, state: self.state.clone(), warm_start, held, memory, steered }))
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
        if saved.state.touches.len() != self.system.world.obstacles.len() {
            return misfit("it has another number of obstacles");
        }
        RestoreError::check_motion(&saved.state.motion())?;
        saved.state.attachments.check(&self.system.springs)?;
        self.friction.set_warm_start(saved.warm_start)?;
        self.friction.set_held(saved.held);
        for obstacle in self.steered.restore(&mut self.system.world, saved.steered)? {
            self.engine.let_move(obstacle);
        }
        self.state = saved.state;
        let (body, facing) = (&self.state.body, self.state.body.facing());
        self.attached = self.state.attachments.iter().map(|attachment| self.state_of(attachment, body, &facing)).collect();
        self.is_stale = true;
        if let Some(memory) = &saved.memory {
            self.rebuild(&self.obstacles_now());
            self.engine.recall(memory).map_err(RestoreError::unreadable)?;
        }
        Ok(())
    }
}
