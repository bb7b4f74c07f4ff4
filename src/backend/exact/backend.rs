//! The calls of a backend, for all exact methods.

use serde::{Deserialize, Serialize};

use super::control::{Pace, Task};
use super::extrapolation;
use super::load::{Exact, Method, State};
use crate::backend::contact::Touching;
use crate::backend::friction::{ContactMode, WarmStart};
use crate::backend::interface::Backend;
use crate::backend::report::{EnergyLedger, Motion, RestoreError, SaveError, SavedState, SideContact, StepReport, Transition};
use crate::backend::springs::{AttachedSprings, AttachedTip, Place, SavedSprings, TipPaths, pulls_with};
use crate::backend::stepping::{Stepping, n_steps_in};
use crate::math::{Pose, Vec2, Vec3, rotation};
use crate::model::{ObstaclePath, ObstaclePose, System};

#[derive(Serialize, Deserialize)]
struct Saved<H> {
    state: State<H>,
    springs: SavedSprings,
    pace: Pace,
    warm_start: WarmStart,
    /// Paths of the obstacles that were steered.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    steered: Vec<(usize, ObstaclePath)>,
}

impl<M: Method> Backend for Exact<M> {
    fn attach(&mut self, spring: usize, tip: Vec2) {
        self.catch_up();
        let Self { springs, system, state, .. } = self;
        let brought = springs.attach(&system.springs, spring, tip, &state.motion.pose);
        state.energy.attach(brought);
        state.disturb::<M>(spring, pulls_with(system, spring, brought));
    }

    fn release(&mut self, spring: usize) {
        self.catch_up();
        let Self { springs, system, state, .. } = self;
        let lost = springs.release(&system.springs, spring, &state.motion.pose);
        state.energy.release(lost, springs.energy(&system.springs, &state.motion.pose));
        state.disturb::<M>(spring, true);
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        self.transitions.clear();
        if !self.springs.can_move(tip_targets, duration) {
            return StepReport::refused();
        }
        let mut report = StepReport::default();
        M::restore_balance(self, &mut report);
        if self.skip_rest(tip_targets, duration, &mut report) {
            self.pass(duration);
            return report;
        }
        let mut from = std::mem::take(&mut self.from);
        from.clear();
        from.extend_from_slice(&self.springs);
        let paths = TipPaths { from: &from, targets: tip_targets, duration };
        match self.stepping {
            Stepping::Fixed(longest) => {
                let longest = M::longest_step(self, &paths, longest, &mut report);
                self.take_steps(&paths, n_steps_in(duration, longest), &mut report);
                report.swing_rad = self.springs.blocks().take_most_swung();
            }
            Stepping::Controlled(control) => {
                M::begin_advance(self, &paths);
                let longest = M::longest_macro_step(self, &paths);
                report.add(&extrapolation::advance(self, &Task { paths, longest, control }));
            }
        }
        self.from = from;
        self.pass(duration);
        report
    }

    fn steer(&mut self, obstacle: usize, course: &[(f64, Pose)]) -> bool {
        let is_steered = self.steered.steer(&mut self.system.world, obstacle, self.state.side.time, course);
        if is_steered {
            self.meet_paths(&[obstacle]);
        }
        is_steered
    }

    fn steered(&self) -> Vec<ObstaclePose> {
        self.steered.poses(&self.system.world, self.state.side.time)
    }

    fn motion(&self) -> Motion {
        self.state.motion
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.springs.tip(spring)
    }

    fn pull(&self, spring: usize) -> Vec2 {
        M::pull_with_dashpot(&self.state, spring, self.springs.pull(&self.system.springs, spring, &self.state.motion.pose))
    }

    fn read_tips(&self, tips: &mut [AttachedTip]) {
        self.springs.read_tips(&self.system.springs, &self.state.motion.pose, tips);
        if M::has_dashpots(&self.state) {
            tips.iter_mut().for_each(|tip| tip.pull = M::pull_with_dashpot(&self.state, tip.spring, tip.pull));
        }
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        let Self { state, springs, solver, system, .. } = self;
        let pose = &state.motion.pose;
        if !springs.are_ahead() {
            return solver.forces_in_world(pose.heading);
        }
        let pulls = -springs.reaction(&system.springs, pose).gradient;
        let in_load = rotation(pose.heading).tr_mul(&pulls.xy());
        let drive = Vec3::new(in_load.x, in_load.y, pulls.z);
        solver.at_rest_under(&drive, state.certificate.forces()).forces_in_world(pose.heading)
    }

    fn side_contacts(&self) -> Vec<SideContact> {
        self.side_forces().collect()
    }

    fn energy(&self) -> EnergyLedger {
        let energy = self.state.energy;
        if !self.springs.are_ahead() {
            return energy;
        }
        let elastic = self.springs.energy_ahead();
        EnergyLedger { elastic, tip_work: energy.tip_work + (elastic - energy.elastic), ..energy }
    }

    fn transitions(&self) -> &[Transition] {
        &self.transitions
    }

    fn save(&self) -> Result<SavedState, SaveError> {
        let (state, springs, pace) = (self.state.clone(), self.springs.save(), self.pace.clone());
        let (warm_start, steered) = (self.solver.warm_start().clone(), self.steered.save(&self.system.world));
        Ok(SavedState::of(&Saved { state, springs, pace, warm_start, steered }))
    }

    fn restore(&mut self, state: &SavedState) -> Result<(), RestoreError> {
        let Saved::<M::Memory> { state, springs, pace, warm_start, steered } = state.read()?;
        M::check(&state.memory, &self.system)?;
        state.certificate.check(&self.solver, self.system.springs.len())?;
        state.side.check(&self.system)?;
        state.check(&self.system)?;
        pace.check()?;
        let changed = self.steered.restore(&mut self.system.world, steered)?;
        self.meet_paths(&changed);
        self.check_outside(&state)?;
        let springs = AttachedSprings::restored(springs, &self.system.springs, &state.motion.pose)?;
        self.solver.set_warm_start(warm_start)?;
        (self.state, self.springs, self.pace) = (state, springs, pace);
        Ok(())
    }
}

impl<M: Method> Exact<M> {
    /// Takes note of obstacles that have new paths.
    fn meet_paths(&mut self, of: &[usize]) {
        if let Some(obstacles) = &mut self.obstacles {
            of.iter().for_each(|obstacle| obstacles.meet_path(&self.system, *obstacle));
        }
    }

    /// # Errors
    /// When the load of a restored state lies inside an obstacle, or touches what is not there.
    fn check_outside(&mut self, state: &State<M::Memory>) -> Result<(), RestoreError> {
        let (Self { obstacles, system, .. }, place) = (self, Place::of(&state.motion.pose));
        let is_there = |touching: &Touching| obstacles.as_ref().is_some_and(|obstacles| obstacles.have(touching));
        if let Some(touching) = state.side.touching.iter().find(|touching| !is_there(touching)) {
            return Err(RestoreError(format!("a contact of features that are not there: {:?}", touching.key)));
        }
        let depth = obstacles.as_mut().map_or(0.0, |obstacles| obstacles.depth(system, &place, state.side.time));
        if depth > 0.0 { Err(RestoreError(format!("a load {depth:e} m inside an obstacle"))) } else { Ok(()) }
    }
}

impl<H> State<H> {
    /// # Errors
    /// When a restored motion is none to compute with, or when the load turns about a support that
    /// is not there.
    fn check(&self, system: &System) -> Result<(), RestoreError> {
        RestoreError::check_motion(&self.motion)?;
        let n_supports = system.ground.supports.len();
        match self.contact.last() {
            ContactMode::Pinned(support) if support >= n_supports => {
                Err(RestoreError(format!("a load that turns about support {support} of {n_supports}")))
            }
            _ => Ok(()),
        }
    }

    /// Forgets what an attached or released spring makes invalid. It changes the forces if it
    /// `pulls`.
    fn disturb<M: Method<Memory = H>>(&mut self, spring: usize, pulls: bool) {
        self.contact.disturb(pulls);
        self.certificate.forget();
        M::disturb(self, spring);
    }
}
