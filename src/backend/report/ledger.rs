//! The energy ledger of a run.

use serde::{Deserialize, Serialize};

use crate::backend::numerics::CLOSED_LEDGER;

/// Largest defect outside of jumps, over the largest entry, with which a ledger counts as closed
/// (1). A run at fixed steps has the error of its steps, and is allowed what the comparison that
/// uses it takes as agreement, `tolerance_share` (1).
pub fn closed_share(has_error_control: bool, tolerance_share: f64) -> f64 {
    if has_error_control { CLOSED_LEDGER } else { CLOSED_LEDGER.max(tolerance_share) }
}

/// Energy of a run, by where it is and where it went (J).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyLedger {
    /// Elastic energy of the attached springs now.
    pub elastic: f64,
    /// Kinetic energy of the load now; zero for a method without inertia.
    pub kinetic: f64,
    /// Energy lost to friction so far.
    pub friction: f64,
    /// Energy lost to side friction with obstacles so far.
    #[serde(default, skip_serializing_if = "crate::math::is_zero")]
    pub side_friction: f64,
    /// Energy lost in impacts on obstacles so far.
    #[serde(default, skip_serializing_if = "crate::math::is_zero")]
    pub impacts: f64,
    /// Energy lost in the dashpots of the springs so far.
    pub damping: f64,
    /// Energy of the springs that were released so far. A free spring relaxes at once.
    pub released: f64,
    /// Work on the tips so far, with that of attaching deformed springs.
    pub tip_work: f64,
    /// Work of moving obstacles on the load so far.
    #[serde(default, skip_serializing_if = "crate::math::is_zero")]
    pub obstacle_work: f64,
    /// Kinetic energy at the start.
    pub initial: f64,
    /// Energy lost in jumps of a load without inertia so far. With inertia it would become motion.
    pub jumps: f64,
    /// Energy that the moving load lost by the discretisation so far: the work of the springs on
    /// it, less friction and the change of kinetic energy.
    pub numerical_damping: f64,
}

/// Defect of a ledger by its causes (J). The parts add up to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DefectParts {
    /// Negative of the energy lost in jumps.
    pub jumps: f64,
    /// Negative of the energy that steps took from the moving load.
    pub numerical_damping: f64,
    /// Remaining part: error of the trapezoid rule for work.
    pub quadrature: f64,
}

impl EnergyLedger {
    /// Adds an attached spring with the energy `brought` (J), which is work on its tip.
    pub fn attach(&mut self, brought: f64) {
        self.tip_work += brought;
        self.elastic += brought;
    }

    /// Removes a released spring with the energy `lost` (J), which leaves `elastic` (J) in the
    /// others.
    pub fn release(&mut self, lost: f64, elastic: f64) {
        self.released += lost;
        self.elastic = elastic;
    }

    /// Adds work on the tips (J), after which the springs hold the energy `elastic` (J).
    pub fn add_tip_work(&mut self, work: f64, elastic: f64) {
        self.tip_work += work;
        self.elastic = elastic;
    }

    /// Energy lost to friction, impacts, damping and released springs (J).
    pub fn dissipated(&self) -> f64 {
        self.friction + self.side_friction + self.impacts + self.damping + self.released
    }

    /// Energy that appeared from nowhere (J). It is negative by numerical damping, and by jumps of
    /// a method without inertia.
    pub fn defect(&self) -> f64 {
        self.elastic + self.kinetic + self.dissipated() - self.tip_work - self.obstacle_work - self.initial
    }

    /// Size of the largest entry (J).
    pub fn largest_entry(&self) -> f64 {
        let Self { elastic, kinetic, tip_work, obstacle_work, initial, jumps, .. } = *self;
        let losses = [self.friction, self.side_friction, self.impacts, self.damping, self.released];
        [elastic, kinetic, tip_work, obstacle_work, initial, jumps].into_iter().chain(losses).map(f64::abs).fold(0.0, f64::max)
    }

    /// Whether no more energy appeared or vanished outside of jumps than a `share` (1) of the
    /// energy `size` (J), which is the largest entry of the whole run. A defect that is no number
    /// closes no ledger.
    pub fn is_closed(&self, share: f64, size: f64) -> bool {
        (self.defect() + self.jumps).abs() <= share * size
    }

    /// Defect by its causes.
    ///
    /// With W the work of the springs on the load in a step by the trapezoid rule, D the loss to
    /// friction and dashpots, K the kinetic and U the elastic energy,
    ///
    /// ```text
    /// defect of a step = dU + dK + D - tip work = (dK + D - W) + (dU + W - tip work)
    /// ```
    ///
    /// The first bracket is the balance of the load. For implicit Euler it is minus 1/2 |dv|^2_M +
    /// 1/2 dx' K (dx - dp) to leading order, of first order in the step. The second is the balance
    /// of the springs. Their energy depends only on poses and tips, so that only the trapezoid rule
    /// errs, in second order.
    pub fn defect_parts(&self) -> DefectParts {
        let (jumps, numerical_damping) = (0.0 - self.jumps, 0.0 - self.numerical_damping);
        DefectParts { jumps, numerical_damping, quadrature: self.defect() - jumps - numerical_damping }
    }
}
