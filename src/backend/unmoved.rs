//! The place of a backend that could not be made.

use super::interface::Backend;
use super::report::{EnergyLedger, Motion, Status, StepReport};
use crate::math::Vec2;

/// A run that could not start, and fails at its first step. The load keeps this motion.
pub struct Unmoved(pub Motion);

impl Backend for Unmoved {
    fn attach(&mut self, _: usize, _: Vec2) {}

    fn release(&mut self, _: usize) {}

    fn advance(&mut self, _: &[Vec2], _: f64) -> StepReport {
        StepReport { status: Status::Failed, ..StepReport::default() }
    }

    fn motion(&self) -> Motion {
        self.0
    }

    fn tip(&self, _: usize) -> Option<Vec2> {
        None
    }

    fn pull(&self, _: usize) -> Vec2 {
        Vec2::zeros()
    }

    fn energy(&self) -> EnergyLedger {
        EnergyLedger::default()
    }
}
