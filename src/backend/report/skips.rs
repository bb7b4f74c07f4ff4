//! Work that a run skips because its outcome is known, and how often it was skipped.
//!
//! Each kind can be switched off. Results then differ by no more than the kind says.

use serde::{Deserialize, Serialize};

/// A kind of work that may be skipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Skip {
    /// Steps of a load at rest without attached springs.
    FreeLoad,
    /// Steps of a load at rest whose tips do not move. After a single step in which the load turns
    /// far, a further one with tips at rest would still correct what the constant twist of the
    /// first left.
    StillTips,
    /// Solutions of the friction problem while the tips have not moved far enough to make the load
    /// slip (quasi-static, at fixed steps).
    #[serde(alias = "stick-bound")]
    StickCertificate,
    /// Springs that are too far from an ant to be sensed.
    DistantAnts,
}

/// The kinds of work that are skipped: all, unless switched off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Skips {
    pub free_load: bool,
    pub still_tips: bool,
    #[serde(alias = "stick_bound")]
    pub stick_certificate: bool,
    pub distant_ants: bool,
}

impl Skips {
    pub const ALL: Skips = Skips { free_load: true, still_tips: true, stick_certificate: true, distant_ants: true };
    pub const NONE: Skips = Skips { free_load: false, still_tips: false, stick_certificate: false, distant_ants: false };

    /// Whether work of this kind is skipped.
    pub fn has(&self, skip: Skip) -> bool {
        match skip {
            Skip::FreeLoad => self.free_load,
            Skip::StillTips => self.still_tips,
            Skip::StickCertificate => self.stick_certificate,
            Skip::DistantAnts => self.distant_ants,
        }
    }

    /// These kinds without one.
    pub fn without(self, skip: Skip) -> Self {
        match skip {
            Skip::FreeLoad => Skips { free_load: false, ..self },
            Skip::StillTips => Skips { still_tips: false, ..self },
            Skip::StickCertificate => Skips { stick_certificate: false, ..self },
            Skip::DistantAnts => Skips { distant_ants: false, ..self },
        }
    }

    /// These kinds without some.
    pub fn without_all(self, skips: &[Skip]) -> Self {
        skips.iter().fold(self, |kept, skip| kept.without(*skip))
    }
}

impl Default for Skips {
    fn default() -> Self {
        Skips::ALL
    }
}

/// How often work was skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SkipCounts {
    /// Steps.
    pub free_load: u64,
    /// Steps.
    pub still_tips: u64,
    /// Steps.
    #[serde(alias = "stick_bound")]
    pub stick_certificate: u64,
    /// Ants at ticks.
    pub distant_ants: u64,
}

impl SkipCounts {
    pub fn count(&mut self, why: Skip, n: u64) {
        match why {
            Skip::FreeLoad => self.free_load += n,
            Skip::StillTips => self.still_tips += n,
            Skip::StickCertificate => self.stick_certificate += n,
            Skip::DistantAnts => self.distant_ants += n,
        }
    }

    pub fn add(&mut self, other: &SkipCounts) {
        self.free_load += other.free_load;
        self.still_tips += other.still_tips;
        self.stick_certificate += other.stick_certificate;
        self.distant_ants += other.distant_ants;
    }
}
