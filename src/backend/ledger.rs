//! The books of a run's energy.

use serde::{Deserialize, Serialize};

/// Where the energy of a run is and where it went (J).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyLedger {
    /// In the held springs now.
    pub elastic: f64,
    /// In the moving load now; zero for a method without inertia.
    pub kinetic: f64,
    /// Lost to the ground by friction so far.
    pub friction: f64,
    /// Lost in the springs' dashpots so far.
    pub damping: f64,
    /// Lost with springs that were let go so far: a free spring relaxes by itself.
    pub released: f64,
    /// Done by the tips' holders so far, grasps of deformed springs included.
    pub tip_work: f64,
    /// At the start, kinetic.
    pub initial: f64,
    /// Lost in jumps of a load without inertia so far; one with inertia would have got it into motion.
    pub jumps: f64,
    /// Lost by the moving load so far to nobody but the way in which steps are cut: what the springs did on it less what friction took and what it has
    /// kept in motion.
    pub numerical_damping: f64,
}

/// Where a ledger's defect comes from (J). The parts add up to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DefectParts {
    /// Minus what was lost in jumps.
    pub jumps: f64,
    /// Minus what steps took from the moving load.
    pub numerical_damping: f64,
    /// What remains: error of the trapezoid sums of work.
    pub quadrature: f64,
}

impl EnergyLedger {
    /// Books a grasp whose spring brings `brought` (J): its holder deformed it.
    pub fn book_grasp(&mut self, brought: f64) {
        self.tip_work += brought;
        self.elastic += brought;
    }

    /// Books a release whose spring takes `lost` (J) and leaves `elastic` (J) in the others.
    pub fn book_release(&mut self, lost: f64, elastic: f64) {
        self.released += lost;
        self.elastic = elastic;
    }

    /// All that was lost on purpose: friction, damping and released springs (J).
    pub fn dissipated(&self) -> f64 {
        self.friction + self.damping + self.released
    }

    /// Energy that appeared from nowhere (J): negative is numerical damping, or a jump of a method without inertia.
    pub fn defect(&self) -> f64 {
        self.elastic + self.kinetic + self.dissipated() - self.tip_work - self.initial
    }

    /// The defect by its causes.
    ///
    /// With W the trapezoid work of the springs on the load in a step, D what friction and dashpots took there, K the kinetic and U the elastic energy,
    ///
    /// ```text
    /// defect of a step = dU + dK + D - tip work = (dK + D - W) + (dU + W - tip work)
    /// ```
    ///
    /// The first bracket is the load's own balance: for implicit Euler minus 1/2 |dv|^2_M + 1/2 dx' K (dx - dp) to leading order, first order in the step. The
    /// second is that of the springs, whose energy depends on nothing but poses and tips, so that only the trapezoids are wrong there: second order.
    pub fn defect_parts(&self) -> DefectParts {
        let (jumps, numerical_damping) = (0.0 - self.jumps, 0.0 - self.numerical_damping);
        DefectParts { jumps, numerical_damping, quadrature: self.defect() - jumps - numerical_damping }
    }
}
