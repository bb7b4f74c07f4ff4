//! Contacts with obstacles between two steps.

use serde::{Deserialize, Serialize};

use crate::backend::contact::Touching;
use crate::backend::report::{ImpactLaw, RestoreError};
use crate::model::System;

/// Contacts with obstacles between two steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SideState {
    /// Time at the start of the advance (s). It is counted only where there are obstacles.
    pub time: f64,
    /// Time at the end of the last step (s).
    pub now: f64,
    /// Time at which obstacles have the velocity that they had in the last part of the motion (s);
    /// `None` before any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<f64>,
    /// Closed contacts.
    pub touching: Vec<Touching>,
    /// Impacts that are not reported yet.
    pub impacts: Vec<Impact>,
    /// Number of steps that were divided at a touch since the last report (1).
    #[serde(default, skip_serializing_if = "crate::math::is_zero")]
    pub n_divided: usize,
    /// Energy that the last step may have mistaken at obstacles (J).
    pub uncertainty: f64,
}

/// An impact on an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Impact {
    /// (s)
    pub time: f64,
    pub obstacle: usize,
    /// Energy lost (J).
    pub loss: f64,
    pub law: ImpactLaw,
}

impl SideState {
    /// Whether nothing was touched, and no time has passed.
    pub fn is_initial(&self) -> bool {
        *self == Self::default()
    }

    /// # Errors
    /// When a restored contact is one with an obstacle that is not there.
    pub fn check(&self, system: &System) -> Result<(), RestoreError> {
        let n_obstacles = system.world.obstacles.len();
        let touched = self.touching.iter().map(|touching| touching.key.obstacle);
        match touched.chain(self.impacts.iter().map(|impact| impact.obstacle)).find(|obstacle| *obstacle >= n_obstacles) {
            Some(obstacle) => Err(RestoreError(format!("a contact with obstacle {obstacle} of {n_obstacles}"))),
            None => Ok(()),
        }
    }
}
