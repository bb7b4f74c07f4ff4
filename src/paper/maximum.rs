//! The largest pull of a sample of the printed size.
//!
//! The largest of k units is the largest of k largest values. Those of units follow Gumbel's law, as the tail of pulls falls like an exponential: with mean a and
//! standard deviation s over units, the largest of k has the mean a + b ln k and the quantiles a + b (ln k - gamma - ln(-ln p)), where b = s sqrt(6) / pi. The printed
//! number is one draw of it, so the interval is that of a draw and not of a mean.

use std::f64::consts::PI;

use serde::Serialize;

use super::units::Unit;
use crate::math::{Interval, Summary};
use crate::paper::facts::RunFacts;

/// What the largest of a sample of one size is expected to be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extreme {
    /// Mean of the largest (N).
    pub expected: f64,
    /// In which 95 % of the largest lie (N).
    pub draw_95: Interval,
    /// The largest that was met (N), in a sample of `n` pulls.
    pub met: f64,
    pub n: u64,
}

const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;

/// The largest pull of a sample of `n_pulls` that is made of runs such as `of` takes from each unit; `None` below two units.
pub fn extreme<'a>(units: &[Unit<'a>], of: impl Fn(&Unit<'a>) -> Vec<&'a RunFacts>, n_pulls: u64) -> Option<Extreme> {
    let (mut largest, mut n) = (Summary::default(), 0);
    for unit in units {
        let runs = of(unit);
        n += runs.iter().map(|run| run.pulls.n()).sum::<u64>();
        largest.extend(runs.iter().map(|run| run.pulls.max()).reduce(f64::max));
    }
    if largest.n() < 2 || n == 0 {
        return None;
    }
    let n_units = n_pulls as f64 * largest.n() as f64 / n as f64;
    let scale = largest.sd() * 6f64.sqrt() / PI;
    let shifted = largest.mean() + scale * n_units.ln();
    let quantile = |share: f64| shifted - scale * (EULER_GAMMA + (-share.ln()).ln());
    Some(Extreme { expected: shifted, draw_95: Interval { low: quantile(0.025), high: quantile(0.975) }, met: largest.max(), n })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Chance, Stream};
    use crate::paper::{Trial, units};

    fn facts(pulls: Summary) -> RunFacts {
        RunFacts {
            arrived: true,
            time_s: 1.0,
            displacement_m: 0.0,
            status: Default::default(),
            pulls,
            n_grasps: 0,
            pulls_by_time: Summary::default(),
            by_size: Vec::new(),
            by_mean_size: Vec::new(),
            changes: Default::default(),
        }
    }

    /// Exponential pulls of mean one: the largest of n is ln n + gamma on average, which runs of 300 foresee for 30000.
    #[test]
    fn the_largest_of_many_is_foreseen_from_few() {
        let chance = Chance::new(11);
        let runs: Vec<RunFacts> = (0..400)
            .map(|run| {
                let mut pulls = Summary::default();
                pulls.extend((0..300).map(|i| -chance.uniform(Stream::Scene, run, i).ln()));
                facts(pulls)
            })
            .collect();
        let units = units(runs.iter().enumerate().map(|(seed, run)| (Trial::FourFour, seed as u64, run)));
        let found = extreme(&units, |unit| unit.of(Trial::FourFour).into_iter().collect(), 30_000).unwrap();
        let known = 30_000f64.ln() + EULER_GAMMA;
        // Standard error of the mean and of ln(100) times that of the scale over 400 runs: 0.064 and 0.24.
        assert!((found.expected - known).abs() < 0.75, "{} {known}", found.expected);
        assert!(found.draw_95.low < known && known < found.draw_95.high && found.n == 120_000);
    }
}
