//! What a search consists of: its sizes, its seeds, and how close sets must come.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::space::{Block, Design};

/// What a search consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Rows of both matrices of the design; it has as many sets for each choice and two more.
    pub n_rows: u64,
    /// Number of further sets, in the smallest box around those that came closest.
    pub n_within: u64,
    /// Seeds of the first look at each set.
    pub n_screening_seeds: u64,
    /// Seeds of the second look.
    pub n_judging_seeds: u64,
    /// Of the sets that came close, at most so many are looked at again.
    pub most_judged: usize,
}

/// Seeds of searches begin here, far from those of the study.
const FIRST_SEED: u64 = 1_000_001;
/// First of the seeds that show what seeds alone do, and of the second look.
const OTHER_SEED: u64 = 2_000_001;
const JUDGING_SEED: u64 = 3_000_001;
/// Distance up to which a set is looked at again (1). Few seeds scatter by a third of what counts
/// as near.
pub const CLOSE: f64 = 4.0 / 3.0;
/// Distance up to which a set is accepted (1).
pub const ACCEPTED: f64 = 1.0;

impl Plan {
    pub(super) fn design(&self) -> Design {
        Design::new(self.n_rows)
    }

    /// Number of different sets, those within the box included.
    pub fn n_sets(&self) -> usize {
        self.design().n_sets() + self.n_within as usize
    }

    pub(super) fn screening_seeds(&self, block: Block) -> Range<u64> {
        let first = if block == Block::OtherSeeds { OTHER_SEED } else { FIRST_SEED };
        first..first + self.n_screening_seeds
    }

    pub(super) fn judging_seeds(&self) -> Range<u64> {
        JUDGING_SEED..JUDGING_SEED + self.n_judging_seeds
    }
}
