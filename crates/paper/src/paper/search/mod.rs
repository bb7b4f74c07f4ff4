//! Search for all parameter sets that the paper allows, and what holds over them.
//!
//! Every set has all printed values. What the paper leaves open is varied within the ranges of
//! [`OPEN_CHOICES`](cohaul::model::open_choices::OPEN_CHOICES). A first look at every set finds
//! those that come close to the calibration targets: mean and standard deviation of the pulls, and
//! the fractions of six to ten pulling ants. A second look at the close ones, with seeds of its
//! own, accepts those within the stated distance. All other printed numbers and the claims are held
//! out: they are reported over the accepted sets, with and without inertia.
//!
//! ```text
//! plan.rs         sizes, seeds, and limits of the distance
//! space.rs        searched choices, the design, and a set as scenarios
//! screen.rs       first look: the distance to the targets
//! judge.rs        second look: quantities and claims, with and without inertia
//! sensitivity.rs  what a quantity depends on: Sobol indices
//! accepted.rs     what holds over the accepted sets
//! rank.rs         accepted sets by the printed facts that they meet
//! report.rs       the whole result in numbers
//! text.rs, figure.rs, files.rs   the same for people, and in files
//! ```

mod accepted;
mod figure;
pub mod files;
mod judge;
mod plan;
mod rank;
pub mod report;
mod screen;
mod sensitivity;
mod space;
pub mod text;

use serde::{Deserialize, Serialize};

use cohaul::model::open_choices::Chosen;
use cohaul_studies::runner::Tasks;
pub use judge::{Judged, reported};
pub use plan::{ACCEPTED, CLOSE, Plan};
pub use screen::{SCREENED, Screened};
use space::{Block, Design, Within};

/// What came of a task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    Screened(Screened),
    Judged(Box<Judged>),
}

/// Share of the design around which the box is (1), and least number of sets.
const NEAREST: f64 = 0.02;
const FEWEST_NEAREST: usize = 8;

impl Plan {
    /// Number of tasks of the first look at the design, and at all sets.
    pub fn n_first(&self) -> [usize; 2] {
        let n = self.design().n_tasks();
        [n, n + self.n_within as usize]
    }

    /// What is known after the first look at the design.
    pub fn after_design<'a>(&self, screened: impl IntoIterator<Item = &'a Answer>) -> Stage {
        let design = self.design();
        let distance = |(set, answer): (usize, &Answer)| Some((answer.distance()?, set));
        let mut all: Vec<(f64, usize)> = screened.into_iter().take(design.n_sets()).enumerate().filter_map(distance).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n = ((NEAREST * all.len() as f64) as usize).max(FEWEST_NEAREST).min(all.len());
        let nearest: Vec<usize> = all[..n].iter().map(|(_, set)| *set).collect();
        Stage { within: Some(design.around(&nearest)), close: Vec::new() }
    }

    /// What is known after the first look at all sets: those that came close, as many as are looked
    /// at again, spread evenly over all of them.
    pub fn after_first<'a>(&self, stage: Stage, screened: impl IntoIterator<Item = &'a Answer>) -> Stage {
        let design = self.design();
        let is_close = |answer: &Answer| answer.distance().is_some_and(|distance| distance <= CLOSE);
        let all = screened.into_iter().enumerate().filter(|(task, answer)| design.is_set(*task) && is_close(answer));
        let all: Vec<usize> = all.map(|(task, _)| task).collect();
        let n = all.len().min(self.most_judged);
        Stage { close: (0..n).map(|at| all[at * all.len() / n]).collect(), ..stage }
    }

    /// Tasks of everything that is known by now: the first look at the design, at the sets within
    /// the box, and the second look at those that came close.
    pub fn tasks<'a>(&'a self, stage: &'a Stage) -> Tasks<'a, Answer> {
        let design = self.design();
        let n_within = if stage.within.is_some() { self.n_within as usize } else { 0 };
        // A look at a set within the box mostly ends early. The second look has both methods, more
        // seeds, and one more trial that lasts longest.
        let again = 24.0 * self.n_judging_seeds as f64 / self.n_screening_seeds as f64;
        let costs = [(design.n_tasks(), 1.0), (n_within, 0.4), (stage.close.len(), again)];
        let costs = costs.into_iter().flat_map(|(n, cost)| std::iter::repeat_n(cost, n)).collect();
        let run = move |task: usize, go_on: &(dyn Fn() -> bool + Sync)| {
            let close = task.checked_sub(design.n_tasks() + n_within).map(|at| stage.close[at]);
            let values = self.values(&design, stage, close.unwrap_or(task));
            let set = (&design.searched[..], &values[..]);
            if close.is_some() {
                judge::judged(set, self.judging_seeds(), go_on).map(|found| Answer::Judged(Box::new(found)))
            } else if task < design.n_tasks() {
                screen::screened(set, self.screening_seeds(design.place(task).0), go_on).map(Answer::Screened)
            } else {
                screen::screened_briefly(set, self.screening_seeds(Block::A), go_on).map(Answer::Screened)
            }
        };
        Tasks { costs, run: Box::new(run) }
    }

    /// Values of the set of a task of the first look.
    fn values(&self, design: &Design, stage: &Stage, task: usize) -> Vec<Chosen> {
        match (task.checked_sub(design.n_tasks()), &stage.within) {
            (Some(index), Some(within)) => design.values_within(within, index),
            _ => design.values(task),
        }
    }
}

/// What earlier looks have told: the box of further sets, and the tasks of those that came close.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stage {
    within: Option<Within>,
    pub close: Vec<usize>,
}

impl Answer {
    fn distance(&self) -> Option<f64> {
        if let Self::Screened(found) = self { found.distance } else { None }
    }
}
