//! The phase change of the paper in one run: at one time the load speed and its turn rate rise, and
//! the sum of the interaction forces falls (Section VII, Fig. 11).
//!
//! At every place that leaves a tenth of the series on both sides, the contrast of a series is the
//! difference of its two means over the standard error of that difference for independent values,
//! signed so that the printed direction is positive. The statistic is the smallest of the three
//! contrasts, at the place where it is largest: it is large only where all three series change
//! together and as printed. Its significance is that among series of the same blocks in random
//! order, with the three series kept together: that is a run without phases, in which neighbouring
//! values and the three series are as correlated as in the run.

use serde::{Deserialize, Serialize};

use super::change::{LEVEL, MARGIN, ROUNDING, p_value, shuffled};
use cohaul::math::RandomStreams;

/// The best place of the printed phase change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhaseChange {
    /// Number of values before it.
    pub at: usize,
    /// Contrasts of speed, turn rate and interaction there (1); positive as printed.
    pub contrasts: [f64; 3],
    /// Fraction of the random orders, including the observed one, with as large a statistic (1).
    pub p_value: f64,
}

/// Directions that the paper prints: up, up, down.
const SIGNS: [f64; 3] = [1.0, 1.0, -1.0];

impl PhaseChange {
    /// Whether it is more than chance makes of series without phases, but for one in twenty.
    pub fn is_significant(&self) -> bool {
        self.p_value <= LEVEL
    }
}

/// The phase change in `series`: speed, turn rate and interaction at the same times. `None` for
/// series shorter than four blocks, and where one of them is constant.
pub fn phase_change(series: [&[f64]; 3], block: usize, seed: u64) -> Option<PhaseChange> {
    let n = series[0].len();
    if n < 4 * block.max(1) || series.iter().any(|values| values.len() != n) {
        return None;
    }
    let (at, contrasts) = best(series)?;
    let statistic = smallest(&contrasts);
    let streams = RandomStreams::new(seed);
    let p_value = p_value(|order| {
        // Draws depend on the number of blocks alone, so that the three series stay together.
        let [speed, turn_rate, interaction] = series.map(|values| shuffled(values, block.max(1), &streams, order));
        best([&speed, &turn_rate, &interaction]).is_some_and(|(_, other)| smallest(&other) >= statistic - ROUNDING)
    });
    Some(PhaseChange { at, contrasts, p_value })
}

fn smallest(contrasts: &[f64; 3]) -> f64 {
    contrasts.iter().copied().fold(f64::INFINITY, f64::min)
}

fn best(series: [&[f64]; 3]) -> Option<(usize, [f64; 3])> {
    let n = series[0].len();
    let mean = series.map(|values| values.iter().sum::<f64>() / n as f64);
    let mut sd = [0.0; 3];
    for k in 0..3 {
        sd[k] = (series[k].iter().map(|value| (value - mean[k]).powi(2)).sum::<f64>() / n as f64).sqrt();
        // Rounding of a constant series is no spread.
        if sd[k] <= 1e-12 * mean[k].abs() {
            return None;
        }
    }
    let margin = ((MARGIN * n as f64) as usize).max(1);
    let mut sums = [0.0; 3];
    let mut found: Option<(usize, [f64; 3])> = None;
    for at in 1..=n - margin {
        (0..3).for_each(|k| sums[k] += series[k][at - 1] - mean[k]);
        let (before, after) = (at as f64, (n - at) as f64);
        // The mean before lies sum / before below the mean of all, that after sum / after above.
        let scale = (n as f64 / (before * after)).sqrt();
        let contrasts = std::array::from_fn(|k| -SIGNS[k] * sums[k] * scale / sd[k]);
        if at >= margin && found.is_none_or(|(_, other)| smallest(&contrasts) > smallest(&other)) {
            found = Some((at, contrasts));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::math::Stream;

    /// Three series that drift slowly and together, each with a step of `steps` standard deviations
    /// at two thirds.
    fn run(seed: u64, n: usize, steps: [f64; 3]) -> [Vec<f64>; 3] {
        let streams = RandomStreams::new(seed);
        let mut level = [0.0; 3];
        let mut series = [const { Vec::new() }; 3];
        for i in 0..n {
            let shared = streams.normal_pair(Stream::Scene, 9, i as u64).x;
            for k in 0..3 {
                let own = streams.normal_pair(Stream::Scene, k as u32, i as u64).x;
                level[k] = 0.5 * level[k] + 0.75f64.sqrt() * (0.6 * shared + 0.8 * own);
                series[k].push(10.0 + level[k] + if i < 2 * n / 3 { 0.0 } else { steps[k] });
            }
        }
        series
    }

    fn found(seed: u64, steps: [f64; 3]) -> PhaseChange {
        let [speed, turn_rate, interaction] = run(seed, 160, steps);
        phase_change([&speed, &turn_rate, &interaction], 8, seed).unwrap()
    }

    #[test]
    fn a_change_as_printed_is_found_where_it_is() {
        let change = found(3, [2.0, 2.0, -2.0]);
        assert!(change.at.abs_diff(106) <= 4 && change.p_value < 0.01, "{change:?}");
        assert!(change.contrasts.iter().all(|contrast| *contrast > 3.0), "{change:?}");
    }

    /// Of 200 runs without phases at most 5 % are significant, up to three standard deviations of
    /// that number, 0.046. A change in which one of the three goes the other way is no phase
    /// change.
    #[test]
    fn runs_without_phases_and_other_changes_are_not_found() {
        for steps in [[0.0; 3], [2.0, 2.0, 2.0], [2.0, -2.0, -2.0], [-2.0, -2.0, 2.0]] {
            let n_found = (0..200).filter(|seed| found(1000 + seed, steps).is_significant()).count();
            assert!(n_found <= 19, "{steps:?}: {n_found}");
        }
        let n_found = (0..200).filter(|seed| found(1000 + seed, [2.0, 2.0, -2.0]).is_significant()).count();
        assert!(n_found >= 180, "{n_found}");
    }

    #[test]
    fn short_and_constant_series_have_no_phases() {
        let (rising, constant): (Vec<f64>, Vec<f64>) = ((0..40).map(f64::from).collect(), vec![0.1; 40]);
        assert_eq!(phase_change([&rising, &rising, &constant], 2, 0), None);
        assert_eq!(phase_change([&rising, &rising, &rising], 11, 0), None);
        assert_eq!(phase_change([&[], &[], &[]], 2, 0), None);
    }
}
