//! Samples of pulls: from which trials, and taken when.
//!
//! The paper prints one mean, one standard deviation and one largest value of 520,057 pulls, and
//! says neither from which trials nor when they were taken. Every reading is shown.

use super::facts::RunFacts;
use super::trial::Trial;
use super::units::Unit;
use cohaul::math::Summary;

/// Which trials a sample of pulls comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    /// 4/4 and 5/10: the groups of two to five ants make up nearly the printed size of the sample.
    Printed,
    One(Trial),
}

impl Sample {
    pub fn trials(self) -> Vec<Trial> {
        match self {
            Sample::Printed => vec![Trial::FourFour, Trial::FIVE_TEN],
            Sample::One(trial) => vec![trial],
        }
    }

    pub fn runs<'a>(self, unit: &Unit<'a>) -> Vec<&'a RunFacts> {
        self.trials().into_iter().filter_map(|trial| unit.of(trial)).collect()
    }

    pub(super) fn name(self) -> String {
        match self {
            Sample::Printed => "4/4 and 5/10".to_owned(),
            Sample::One(trial) => trial.name(),
        }
    }
}

/// When pulls are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// At the ants' decisions, with a zero at each grasp: the first instant of an attachment.
    AtDecisions,
    /// At the ants' decisions after the grasp.
    WithoutZeros,
    /// At every control period.
    ByTime,
}

impl Sampling {
    pub const ALL: [Sampling; 3] = [Sampling::AtDecisions, Sampling::WithoutZeros, Sampling::ByTime];

    pub fn name(self) -> &'static str {
        match self {
            Sampling::AtDecisions => "at decisions, with a zero at each grasp",
            Sampling::WithoutZeros => "at decisions, without zeros",
            Sampling::ByTime => "at every control period",
        }
    }

    /// Pulls of a run.
    pub fn pulls(self, run: &RunFacts) -> Summary {
        if self == Sampling::ByTime { run.pulls_by_time } else { run.pulls }
    }
}

/// A sample of pulls from many runs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pool {
    pub n: f64,
    sum: f64,
    squares: f64,
}

impl Pool {
    pub fn of(units: &[Unit], sample: Sample, sampling: Sampling) -> Self {
        Self::of_runs(units.iter().flat_map(|unit| sample.runs(unit)), sampling)
    }

    pub fn of_runs<'a>(runs: impl IntoIterator<Item = &'a RunFacts>, sampling: Sampling) -> Self {
        let mut pool = Self::default();
        for run in runs {
            let pulls = sampling.pulls(run);
            let (n, mean, sd) = (pulls.n() as f64, pulls.mean(), pulls.sd());
            pool.n += n;
            pool.sum += n * mean;
            pool.squares += (n - 1.0).max(0.0) * sd * sd + n * mean * mean;
            // A zero adds neither to the sum nor to the squares.
            pool.n -= if sampling == Sampling::WithoutZeros { run.n_grasps as f64 } else { 0.0 };
        }
        pool
    }

    pub fn mean(&self) -> Option<f64> {
        (self.n > 0.0).then(|| self.sum / self.n)
    }

    pub fn sd(&self) -> Option<f64> {
        let mean = self.mean()?;
        (self.n > 1.0).then(|| ((self.squares - self.n * mean * mean).max(0.0) / (self.n - 1.0)).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::units::units;

    /// Two runs of pulls 3, 5 and 4, 8 with three zeros: moments by hand.
    #[test]
    fn zeros_are_taken_out_of_the_moments() {
        let run = |seed, pulls: &[f64], n_grasps| {
            (Trial::FourFour, seed, RunFacts { pulls: Summary::of(pulls.iter().copied()), n_grasps, ..RunFacts::nothing() })
        };
        let runs = [run(0, &[0.0, 3.0, 0.0, 5.0], 2), run(1, &[0.0, 4.0, 8.0], 1)];
        let units = units(&runs);
        let all = Pool::of(&units, Sample::Printed, Sampling::AtDecisions);
        assert!((all.mean().unwrap() - 20.0 / 7.0).abs() < 1e-12);
        let some = Pool::of(&units, Sample::Printed, Sampling::WithoutZeros);
        // 3, 4, 5, 8: mean 5, squares of 4 + 1 + 0 + 9.
        assert!((some.mean().unwrap() - 5.0).abs() < 1e-12 && (some.sd().unwrap() - (14.0f64 / 3.0).sqrt()).abs() < 1e-12, "{some:?}");
    }
}
