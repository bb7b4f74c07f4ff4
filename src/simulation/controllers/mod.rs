//! What moves the tips: ants that decide, prescribed paths, or a recorded run.

mod ants;
mod avoiding;
mod controller;
mod periods;
mod releases;
mod replay;
mod sensing;
mod tips;

use crate::scenario::{Drive, Scenario};

pub use ants::{Ants, follow_ants};
pub use controller::{Commands, Controller, View};
pub use replay::Replay;
pub use tips::Tips;

/// The controller that the scenario asks for.
pub fn controller_of(scenario: &Scenario) -> Box<dyn Controller> {
    match &scenario.drive {
        Drive::Tips(paths) => Box::new(Tips::new(scenario, paths)),
        Drive::Ants(drive) => Box::new(Ants::new(scenario, drive)),
    }
}
