//! Dashpots of the quasi-static method: what a step needs of them, and what they leave for the
//! next.

use serde::{Deserialize, Serialize};

use super::dashpots::Dashpots;
use crate::backend::report::{EnergyLedger, RestoreError};
use crate::backend::springs::SpringBlocks;
use crate::math::Vec2;
use crate::model::{PolarSpring, SpringShape, System};

/// The dashpots of the springs and what a step needs of its start.
#[derive(Default)]
pub struct Viscous {
    /// Whether the dashpots of a system with damped springs act.
    pub acts: bool,
    pub dashpots: Dashpots,
    /// Tips (m, world) and shapes of the attached springs at the start of the step.
    pub start: Vec<(Vec2, SpringShape)>,
    /// Whether the step is one by backward differences.
    pub by_differences: bool,
}

/// What the dashpots leave for the next step. All lists are empty where none acts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViscousMemory {
    /// Force of each spring's dashpot on its tip at the end of the last step (N, world); zero for
    /// free springs.
    pub on_tip: Vec<Vec2>,
    /// Velocity of the tip of each spring in the last advance (m/s); `None` since it was attached
    /// or released, and for all springs since any was.
    pub velocities: Vec<Option<Vec2>>,
    /// Attached tips at the start of the last step (m, world).
    pub tips: Vec<Vec2>,
}

impl ViscousMemory {
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Forgets what an attached or released `spring` makes invalid.
    pub fn disturb(&mut self, spring: usize) {
        if let Some(on_tip) = self.on_tip.get_mut(spring) {
            *on_tip = Vec2::zeros();
        }
        self.velocities.fill(None);
        self.tips.clear();
    }

    /// Force of a spring's dashpot on its tip (N, world).
    pub fn on_tip(&self, spring: usize) -> Option<&Vec2> {
        self.on_tip.get(spring)
    }

    /// # Errors
    /// When restored lists do not fit the springs.
    pub fn check(&self, system: &System) -> Result<(), RestoreError> {
        let n_springs = system.springs.len();
        let n_wrong = [self.on_tip.len(), self.velocities.len()].into_iter().find(|n| *n != 0 && *n != n_springs);
        n_wrong.map_or(Ok(()), |n| Err(RestoreError(format!("{n} dashpots for {n_springs} springs"))))
    }
}

impl Viscous {
    /// The dashpots of a system, and their memory.
    pub fn of(system: &System) -> (Self, ViscousMemory) {
        let acts = system.springs.iter().any(|spring| is_damped(system, spring));
        let n = if acts { system.springs.len() } else { 0 };
        let memory = ViscousMemory { on_tip: vec![Vec2::zeros(); n], velocities: vec![None; n], tips: Vec::new() };
        (Self { acts, ..Self::default() }, memory)
    }

    /// The dashpots of the step as springs, if there are any.
    pub fn blocks(&mut self) -> Option<&mut SpringBlocks> {
        self.dashpots.blocks()
    }
}

/// Whether a spring has a dashpot.
pub fn is_damped(system: &System, spring: &PolarSpring) -> bool {
    system.dashpot(spring) != (0.0, 0.0)
}

impl ViscousMemory {
    /// Quantities that change smoothly: the loss (J) and the forces on the tips (N); none where no
    /// dashpot acts.
    pub fn flow(&self, energy: &EnergyLedger) -> Vec<f64> {
        if self.on_tip.is_empty() {
            return Vec::new();
        }
        std::iter::once(energy.damping).chain(self.on_tip.iter().flat_map(|force| [force.x, force.y])).collect()
    }

    /// Replaces these quantities.
    pub fn set_flow(&mut self, energy: &mut EnergyLedger, flow: &[f64]) {
        let Some((damping, forces)) = flow.split_first().filter(|_| !self.on_tip.is_empty()) else { return };
        energy.damping = *damping;
        for (force, entries) in self.on_tip.iter_mut().zip(forces.chunks_exact(2)) {
            *force = Vec2::new(entries[0], entries[1]);
        }
    }
}
