//! Search for all parameter sets that the paper allows, and what holds over them.
//!
//! Every set has all printed values. What the paper leaves open is varied within the ranges of
//! [`OPEN_CHOICES`](crate::model::open_choices::OPEN_CHOICES). A first look at every set finds
//! those that come close to the calibration targets: mean and standard deviation of the pulls, and
//! the fractions of six to ten pulling ants. A second look at the close ones, with seeds of its
//! own, accepts those within the stated distance. All other printed numbers and the claims are held
//! out: they are reported over the accepted sets, with and without inertia.
//!
//! ```text
//! space.rs        searched choices, the design, and a set as scenarios
//! screen.rs       first look: the distance to the targets
//! judge.rs        second look: quantities and claims, with and without inertia
//! sensitivity.rs  what a quantity depends on: Sobol indices
//! report.rs       the accepted sets in numbers
//! text.rs, figure.rs, files.rs   the same for people, and in files
//! ```

mod figure;
pub mod files;
mod judge;
pub mod report;
mod screen;
mod sensitivity;
mod space;
pub mod text;

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::trial::Case;
use crate::backend::BackendKind;
use crate::scenario::presets::Preset;
use crate::studies::runner::Tasks;
pub use judge::{Judged, reported};
pub use screen::{SCREENED, Screened};
use space::{Block, Design, Templates};

/// What a search consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Rows of both matrices of the design; it has as many sets for each choice and two more.
    pub n_rows: u64,
    /// Seeds of the first look at each set.
    pub n_screening_seeds: u64,
    /// Seeds of the second look.
    pub n_judging_seeds: u64,
    /// Of the sets that came close, at most so many are looked at again.
    pub most_judged: usize,
}

/// What came of a task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    Screened(Screened),
    Judged(Box<Judged>),
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

/// Model of a set before its own choices.
fn case() -> Case {
    Case::new(Preset::Paper, BackendKind::QuasiStatic)
}

impl Plan {
    fn design(&self) -> Design {
        Design::new(self.n_rows)
    }

    /// Number of different sets of the first look.
    pub fn n_sets(&self) -> usize {
        self.design().n_sets()
    }

    fn screening_seeds(&self, block: Block) -> Range<u64> {
        let first = if block == Block::OtherSeeds { OTHER_SEED } else { FIRST_SEED };
        first..first + self.n_screening_seeds
    }

    fn judging_seeds(&self) -> Range<u64> {
        JUDGING_SEED..JUDGING_SEED + self.n_judging_seeds
    }

    /// The first look at every set, as tasks.
    pub fn screening(&self) -> Tasks<'_, Answer> {
        let design = self.design();
        let templates = Templates::new(&design.searched);
        let run = move |set: usize, go_on: &(dyn Fn() -> bool + Sync)| screen::screened(&templates, self, set, go_on).map(Answer::Screened);
        Tasks::equal(design.n_tasks(), run)
    }

    /// Sets that came close, as many as are looked at again, spread evenly over all of them.
    pub fn close<'a>(&self, screened: impl IntoIterator<Item = &'a Answer>) -> Vec<usize> {
        let is_close =
            |answer: &Answer| matches!(answer, Answer::Screened(found) if found.distance.is_some_and(|distance| distance <= CLOSE));
        let all: Vec<usize> =
            screened.into_iter().take(self.n_sets()).enumerate().filter(|(_, answer)| is_close(answer)).map(|(set, _)| set).collect();
        let n = all.len().min(self.most_judged);
        (0..n).map(|at| all[at * all.len() / n]).collect()
    }

    /// The first look, and after it the second look at the sets `close`, as tasks.
    pub fn all<'a>(&'a self, close: &'a [usize]) -> Tasks<'a, Answer> {
        let (first, templates) = (self.screening(), Templates::new(&self.design().searched));
        let n_first = first.costs.len();
        // Both methods, on more seeds and one more trial that lasts longest.
        let cost = 12.0 * self.n_judging_seeds as f64 / self.n_screening_seeds as f64;
        let costs = first.costs.iter().copied().chain(close.iter().map(|_| cost)).collect();
        let run = move |task: usize, go_on: &(dyn Fn() -> bool + Sync)| match task.checked_sub(n_first) {
            None => (first.run)(task, go_on),
            Some(at) => judge::judged(&templates, self, close[at], go_on).map(|found| Answer::Judged(Box::new(found))),
        };
        Tasks { costs, run: Box::new(run) }
    }
}
