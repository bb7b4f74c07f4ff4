//! What is odd about a valid scenario: a run goes through, and may not be what its author meant.
//!
//! Each rule has a wide margin: the shipped scenarios, from ants to a table of 100 kg, keep all of
//! them. What breaks one has most often a number in another unit, an index of another spring, or a
//! time after the end.
//!
//! ```text
//! units.rs      millimetres, grams, degrees, percent: numbers that do not fit the others
//! places.rs     tips far from their springs, springs that cannot move the load, far places
//! times.rs      what happens after the end, and runs that are too short
//! obstacles.rs  obstacles inside each other
//! ```

mod obstacles;
mod places;
mod times;
mod units;

use super::Scenario;
use super::error::{Finding, Findings};

impl Scenario {
    /// Warnings about this scenario, each with its place, what should be, and what was found. The
    /// list is empty for most scenarios.
    pub fn warnings(&self) -> Vec<Finding> {
        let mut findings = Findings::default();
        units::check(self, &mut findings);
        places::check(self, &mut findings);
        times::check(self, &mut findings);
        obstacles::check(&self.system.world, &mut findings);
        findings.0
    }
}
