//! A load that an exact method moves, and what a method may choose.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::contact::GroundContact;
use super::control::{Pace, Task};
use super::side::SideState;
use crate::backend::contact::{Obstacles, SideForce};
use crate::backend::friction::{ContactMode, FrictionSolver};
use crate::backend::report::{EnergyLedger, Motion, RestoreError, Skip, Skips, Status, StepReport, Transition, TransitionKind};
use crate::backend::shortcuts::{Forecast, StickCertificate};
use crate::backend::springs::{AttachedSprings, Attachment, Attachments, TipPaths};
use crate::backend::steered::Steered;
use crate::backend::stepping::{Stepping, n_steps_in};
use crate::math::{Pose, Twist, Vec2};
use crate::model::System;
use crate::stop;

/// One method: how it takes a step, and what it remembers from step to step.
pub trait Method: Sized + Send {
    type Memory: Clone + Serialize + DeserializeOwned + Send;

    /// Takes the tips from one share of their paths to another, and the load with them.
    fn step(load: &mut Exact<Self>, paths: &TipPaths, from: f64, to: f64) -> StepReport;

    /// Whether the load stays at rest while no tip moves. It is at rest from then on.
    fn rest(load: &mut Exact<Self>) -> bool;

    /// Whether the load continues in its last contact mode after a spring was attached or released.
    fn keeps_mode(load: &Exact<Self>) -> bool;

    /// Takes note of obstacles that have another velocity between two times (s) than before.
    fn meet_waypoint(_load: &mut Exact<Self>, _times: [f64; 2]) -> StepReport {
        StepReport::default()
    }

    /// Longest step that the load takes in an advance in place of the `longest` one (s).
    fn longest_step(_load: &mut Exact<Self>, _paths: &TipPaths, longest: f64, _report: &mut StepReport) -> f64 {
        longest
    }

    /// Takes note of the paths of an advance under error control that begins.
    fn begin_advance(_load: &mut Exact<Self>, _paths: &TipPaths) {}

    /// Longest macro-step under error control (s).
    fn longest_macro_step(load: &Exact<Self>, paths: &TipPaths) -> f64;

    /// Forgets what an attached or released spring makes invalid.
    fn disturb(state: &mut State<Self::Memory>, spring: usize);

    /// Takes the load to a balance that an attached or released spring has disturbed.
    fn restore_balance(_load: &mut Exact<Self>, _report: &mut StepReport) {}

    /// Completes a snap-through that has begun since the `start`. See `jumps`.
    fn complete_snap_through(
        _load: &mut Exact<Self>,
        _start: &SnapStart,
        _allowed: impl FnOnce(&Exact<Self>) -> f64,
        _report: &mut StepReport,
    ) -> Option<TransitionKind> {
        None
    }

    /// Length below which macro-steps are not shortened further (s).
    fn shortest_macro_step(_load: &Exact<Self>, _task: &Task) -> f64 {
        0.0
    }

    /// Lets the next steps lead to a balance that is not near, or not, and forgets the jumps so
    /// far.
    fn allow_jumps(_load: &mut Exact<Self>, _are_allowed: bool) {}

    /// Whether a step has found no balance, and a jump might lead to one.
    fn is_about_to_jump(_load: &Exact<Self>, _report: &StepReport) -> bool {
        false
    }

    /// Whether a step has led to a balance that is not near.
    fn has_jumped(_load: &Exact<Self>) -> bool {
        false
    }

    /// Prepares for a row of `n_steps` equal steps over a macro-step (s), and returns the support
    /// that [`Method::end_row`] needs.
    fn begin_row(_load: &mut Exact<Self>, _macro_step: f64, _n_steps: usize) -> Option<usize> {
        None
    }

    /// Takes the result of steps of this length (s) to the instant at which they end.
    fn end_row(_load: &mut Exact<Self>, _support: Option<usize>, _step: f64) {}

    /// Quantities that change smoothly, besides those of all methods.
    fn extra_flow(_state: &State<Self::Memory>) -> Vec<f64> {
        Vec::new()
    }

    /// Replaces these quantities.
    fn set_extra_flow(_state: &mut State<Self::Memory>, _system: &System, _flow: &[f64]) {}

    /// Whether pulls contain forces of dashpots.
    fn has_dashpots(_state: &State<Self::Memory>) -> bool {
        false
    }

    /// Pull on a tip with its dashpot, from the pull that the spring alone needs (N, world).
    fn pull_with_dashpot(_state: &State<Self::Memory>, _spring: usize, pull: Vec2) -> Vec2 {
        pull
    }

    /// # Errors
    /// When a restored memory does not fit the system.
    fn check(_memory: &Self::Memory, _system: &System) -> Result<(), RestoreError> {
        Ok(())
    }
}

/// A load that an exact method moves.
pub struct Exact<M: Method> {
    pub(super) method: M,
    pub(super) system: System,
    pub(super) stepping: Stepping,
    pub(super) skips: Skips,
    pub(super) solver: FrictionSolver,
    pub(super) springs: AttachedSprings,
    /// Obstacles, if there are any.
    pub(super) obstacles: Option<Obstacles>,
    pub(super) steered: Steered,
    pub(super) state: State<M::Memory>,
    pub(super) pace: Pace,
    /// Attachments at the start of an advance.
    pub(super) from: Vec<Attachment>,
    pub(super) transitions: Vec<Transition>,
}

/// Number of entries of a flow that all methods have: pose, twist and four energies (1).
const N_COMMON: usize = 10;

/// What changes during a run, besides the attached springs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State<H> {
    pub motion: Motion,
    pub energy: EnergyLedger,
    pub contact: GroundContact,
    pub forecast: Forecast,
    pub certificate: StickCertificate,
    #[serde(default, skip_serializing_if = "SideState::is_initial")]
    pub side: SideState,
    pub memory: H,
}

/// Where a step began, to recognise a snap-through by the energy that is missing afterwards.
pub struct SnapStart {
    pub pose: Pose,
    /// Defect of the energy ledger (J).
    pub defect: f64,
    /// Whether the load touched an obstacle.
    pub touches: bool,
}

/// State and attachments at the start of a macro-step.
#[derive(Clone)]
pub struct Snapshot<H> {
    pub state: State<H>,
    pub attachments: Attachments,
}

impl<M: Method> Exact<M> {
    pub(super) fn with(method: M, memory: M::Memory, (system, motion): (System, Motion), stepping: Stepping, skips: Skips) -> Self {
        let kinetic = system.load.kinetic_energy(&motion.twist);
        let last = if motion.twist == Twist::ZERO { ContactMode::Stick } else { ContactMode::Slip };
        let state = State {
            motion,
            energy: EnergyLedger { kinetic, initial: kinetic, ..EnergyLedger::default() },
            contact: GroundContact::Unknown { last, jump_is_pending: false },
            forecast: Forecast::default(),
            certificate: StickCertificate::default(),
            side: SideState::default(),
            memory,
        };
        Self {
            method,
            stepping,
            skips,
            solver: FrictionSolver::new(&system.ground, system.load.radius),
            springs: AttachedSprings::default(),
            obstacles: Obstacles::of(&system),
            steered: Steered::default(),
            state,
            pace: Pace::default(),
            from: Vec::new(),
            transitions: Vec::new(),
            system,
        }
    }

    /// Skips an advance in which no tip moves and the load stays at rest.
    pub(super) fn skip_rest(&mut self, tip_targets: &[Vec2], duration: f64, report: &mut StepReport) -> bool {
        let why = if self.springs.is_empty() { Skip::FreeLoad } else { Skip::StillTips };
        let rests = self.skips.has(why) && self.springs.tips_are_at(tip_targets) && !self.is_pushed(duration) && M::rest(self);
        if rests {
            let n_steps = match self.stepping {
                Stepping::Fixed(longest) => n_steps_in(duration, longest),
                Stepping::Controlled(_) => 1,
            };
            report.leave_out(why, n_steps);
        }
        rests
    }

    /// Takes so many equal steps along the paths of the tips.
    pub(super) fn take_steps(&mut self, paths: &TipPaths, n_steps: u64, report: &mut StepReport) {
        let share = |n: u64| n as f64 / n_steps as f64;
        let mut done = 0;
        let is_free = self.is_free(paths.duration);
        while done < n_steps {
            stop::point();
            if is_free {
                done += self.skip_certain_steps(paths, [done, n_steps], report);
            }
            if done == n_steps {
                break;
            }
            let touching = self.obstacles.is_some().then(|| self.state.side.touching.clone());
            let (start, last) = (self.state.snap_start(), self.state.contact.last());
            let n_not_unique = report.doubts.n_not_unique;
            report.add(&M::step(self, paths, share(done), share(done + 1)));
            done += 1;
            let time = share(done) * paths.duration;
            let jump = M::complete_snap_through(self, &start, |load| load.springs.last_work_error(), report);
            self.transitions.extend(jump.map(|kind| Transition { time, kind }));
            self.note_mode_change(last, time);
            if let Some(touching) = touching {
                self.note_not_unique(n_not_unique, report, time);
                self.note_contacts(&touching, time);
                if !is_free {
                    self.pass_gate(report, time, false);
                }
            }
            if report.status == Status::Failed {
                break;
            }
        }
    }

    /// Skips the next of `n_steps` steps, of which some are `done`, as far as the stick certificate
    /// reaches, and returns their number.
    fn skip_certain_steps(&mut self, paths: &TipPaths, [done, n_steps]: [u64; 2], report: &mut StepReport) -> u64 {
        if !(self.skips.stick_certificate && self.state.certificate.is_made()) {
            return 0;
        }
        let Self { state, springs, system, solver, .. } = self;
        let n_certain = state.certificate.advance_tips(&system.springs, springs, (paths, [done, n_steps]), solver);
        if n_certain > 0 {
            let last = state.contact.last();
            state.contact = GroundContact::Known(ContactMode::Stick);
            state.motion.twist = Twist::ZERO;
            self.note_mode_change(last, (done + 1) as f64 / n_steps as f64 * paths.duration);
            report.leave_out(Skip::StickCertificate, n_certain);
        }
        n_certain
    }

    /// Records the transition at `time` (s) if the contact mode is no longer the `last` one.
    pub(super) fn note_mode_change(&mut self, last: ContactMode, time: f64) {
        let kind = self.state.contact.transition_from(last);
        self.transitions.extend(kind.map(|kind| Transition { time, kind }));
    }

    /// Accepts the work of tips that moved while the load stood still by its stick certificate.
    pub(super) fn catch_up(&mut self) {
        if self.springs.are_ahead() {
            let accepted = self.springs.accept(&self.state.motion.pose);
            self.state.energy.add_tip_work(accepted.of_tips, accepted.elastic);
        }
    }

    /// Contact mode of the last step; `None` when it may be another one by now.
    pub(super) fn mode(&self) -> Option<ContactMode> {
        let contact = &self.state.contact;
        contact.known().or_else(|| M::keeps_mode(self).then_some(contact.last()))
    }

    pub(super) fn snapshot(&self) -> Snapshot<M::Memory> {
        Snapshot { state: self.state.clone(), attachments: Attachments::clone(&self.springs) }
    }

    pub(super) fn reset(&mut self, to: &Snapshot<M::Memory>) {
        self.state = to.state.clone();
        self.springs.reset(to.attachments.clone());
    }

    /// All quantities that change smoothly: pose and twist (m, rad, m/s, rad/s), energy lost to
    /// friction, work of the tips, energy lost to side friction and work of obstacles (J), then
    /// those of the method, and the forces of closed contacts (N).
    pub(super) fn flow(&self) -> Vec<f64> {
        let State { motion, energy, .. } = &self.state;
        let energies = [energy.friction, energy.tip_work, energy.side_friction, energy.obstacle_work];
        let flow = motion.entries().into_iter().chain(energies).chain(M::extra_flow(&self.state));
        if self.obstacles.is_some() { flow.chain(self.state.side_flow()).collect() } else { flow.collect() }
    }

    /// Normal forces of closed contacts in a flow (N), if it is one of the same contacts.
    pub(super) fn forces_in<'a>(&self, flow: &'a [f64]) -> Option<impl Iterator<Item = f64> + 'a> {
        let forces = &flow[N_COMMON + M::extra_flow(&self.state).len()..];
        let is_of_same = forces.len() == 2 * self.state.side.touching.len();
        is_of_same.then(|| forces.chunks_exact(2).map(|force| force[0]))
    }

    /// Replaces these quantities.
    pub(super) fn set_flow(&mut self, flow: &[f64]) {
        let Self { state, springs, system, obstacles, .. } = self;
        state.motion = Motion::of_entries(flow);
        if let Some(obstacles) = obstacles.as_ref().filter(|_| !state.side.touching.is_empty()) {
            state.motion.pose = obstacles.close(system, &state.motion.pose, &state.side.touching, state.side.now);
        }
        (state.energy.friction, state.energy.tip_work) = (flow[6], flow[7]);
        (state.energy.side_friction, state.energy.obstacle_work) = (flow[8], flow[9]);
        springs.accept_outside(&system.springs, &state.motion.pose);
        state.energy.elastic = springs.energy(&system.springs, &state.motion.pose);
        M::set_extra_flow(state, system, &flow[N_COMMON..]);
        if self.obstacles.is_some() {
            let n_extra = M::extra_flow(state).len();
            state.set_forces(&flow[N_COMMON + n_extra..]);
        }
    }
}

impl<H> State<H> {
    /// Forces of closed contacts (N).
    fn side_flow(&self) -> impl Iterator<Item = f64> + '_ {
        self.side.touching.iter().flat_map(|touching| [touching.force.normal, touching.force.tangential])
    }

    /// Replaces these forces, if they are of the same contacts.
    fn set_forces(&mut self, forces: &[f64]) {
        if forces.len() == 2 * self.side.touching.len() {
            for (touching, force) in self.side.touching.iter_mut().zip(forces.chunks_exact(2)) {
                touching.force = SideForce { normal: force[0].max(0.0), tangential: force[1] };
            }
        }
    }

    pub fn snap_start(&self) -> SnapStart {
        SnapStart { pose: self.motion.pose, defect: self.energy.defect(), touches: !self.side.touching.is_empty() }
    }
}
