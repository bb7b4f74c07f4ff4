//! One change of mean in a series, and its significance.
//!
//! Two segments of constant mean are fitted by least squares at every place that leaves a tenth of
//! the series on both sides. The statistic is the fraction of the spread about one mean that the
//! second mean removes. Neighbouring values are correlated even without a change. The significance
//! is therefore that among series of the same blocks of values in random order.

use serde::{Deserialize, Serialize};

use cohaul::math::{RandomStreams, Stream};

/// The best place for one change of mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Number of values before it.
    pub at: usize,
    pub mean_before: f64,
    pub mean_after: f64,
    /// Spread that the second mean takes away, over that about one mean (1).
    pub explained: f64,
    /// Fraction of the random orders, including the observed one, that remove as much spread (1).
    pub p_value: f64,
}

/// Chance below which a change is not put down to it (1).
pub(super) const LEVEL: f64 = 0.05;

impl Change {
    /// Whether it is more than chance makes of series without one, but for one in twenty.
    pub fn is_significant(&self) -> bool {
        self.p_value <= LEVEL
    }
}

/// Fraction of a series on either side in which no change is searched (1).
pub(super) const MARGIN: f64 = 0.1;
/// Series in random order.
const N_ORDERS: u32 = 199;
/// Statistics that differ by less count as equal (1). Orders that only move blocks on one side of
/// the change give the same value, summed in another order. A series of few blocks has many of
/// these.
pub(super) const ROUNDING: f64 = 1e-9;

/// The best change of mean in `values`. Its significance is that among orders of blocks of `block`
/// values. `None` for a constant series or one shorter than four blocks.
pub fn change_of_mean(values: &[f64], block: usize, seed: u64) -> Option<Change> {
    let block = block.max(1);
    if values.len() < 4 * block {
        return None;
    }
    let (at, explained) = best(values)?;
    let streams = RandomStreams::new(seed);
    let as_much_is = explained * (1.0 - ROUNDING);
    let p_value = p_value(|order| best(&shuffled(values, block, &streams, order)).is_some_and(|(_, other)| other >= as_much_is));
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    Some(Change { at, mean_before: mean(&values[..at]), mean_after: mean(&values[at..]), explained, p_value })
}

/// Place and share of the change that takes away the most; `None` of a constant series.
fn best(values: &[f64]) -> Option<(usize, f64)> {
    let n = values.len();
    let mean = values.iter().sum::<f64>() / n as f64;
    let spread: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    // Rounding of a constant series is no spread.
    if spread <= 1e-24 * (n as f64) * mean * mean {
        return None;
    }
    let margin = ((MARGIN * n as f64) as usize).max(1);
    let mut sum = 0.0;
    let mut found = (0, 0.0);
    for (i, value) in values.iter().enumerate().take(n - margin) {
        sum += value - mean;
        let (before, after) = ((i + 1) as f64, (n - i - 1) as f64);
        let explained = sum * sum * (1.0 / before + 1.0 / after) / spread;
        if i + 1 >= margin && explained > found.1 {
            found = (i + 1, explained);
        }
    }
    (found.0 > 0).then_some(found)
}

/// Fraction of the random orders, including the observed one, that are `as_much` (1).
pub(super) fn p_value(as_much: impl Fn(u32) -> bool) -> f64 {
    (1 + (0..N_ORDERS).filter(|order| as_much(*order)).count()) as f64 / f64::from(1 + N_ORDERS)
}

/// The blocks of the series in a random order (Fisher and Yates); the last, shorter one goes along.
pub(super) fn shuffled(values: &[f64], block: usize, streams: &RandomStreams, order: u32) -> Vec<f64> {
    let mut blocks: Vec<&[f64]> = values.chunks(block).collect();
    for i in (1..blocks.len()).rev() {
        let drawn = streams.uniform(Stream::Resample, order, i as u64);
        blocks.swap(i, (drawn * (i + 1) as f64) as usize);
    }
    blocks.concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(n: usize, seed: u64) -> Vec<f64> {
        let streams = RandomStreams::new(seed);
        (0..n).map(|i| streams.normal_pair(Stream::Scene, 0, i as u64).x).collect()
    }

    #[test]
    fn a_step_is_found_where_it_is() {
        let values: Vec<f64> = noise(120, 1).iter().enumerate().map(|(i, value)| 0.5 * value + if i < 45 { 0.0 } else { 1.5 }).collect();
        let change = change_of_mean(&values, 4, 7).unwrap();
        // A step of three standard deviations is located to a few values.
        assert!(change.at.abs_diff(45) <= 3, "{change:?}");
        assert!(change.p_value < 0.01 && change.mean_after - change.mean_before > 1.0, "{change:?}");
    }

    /// Without a change the p-value is uniform. At most 5 % are below 0.05, up to the spread of 200
    /// trials (three standard deviations, 0.046).
    #[test]
    fn noise_alone_seldom_changes() {
        let n_found = (0..200).filter(|seed| change_of_mean(&noise(60, 100 + seed), 4, *seed).unwrap().is_significant()).count();
        assert!(n_found <= 19, "{n_found}");
    }

    /// Of six blocks the last three have another mean. 2 of 20 orders separate the same three
    /// blocks and remove as much spread, whatever the rounding of their sums.
    #[test]
    fn orders_that_part_the_same_blocks_are_as_good() {
        let mut sum = 0.0;
        for seed in 0..40 {
            let values: Vec<f64> =
                noise(48, seed).iter().enumerate().map(|(i, value)| 0.05 * value + if i < 24 { 0.1 } else { 0.7 }).collect();
            let p_value = change_of_mean(&values, 8, seed).unwrap().p_value;
            let unlike: Vec<f64> = values.iter().map(|value| value / 3.0 + 0.1).collect();
            assert_eq!(change_of_mean(&unlike, 8, seed).unwrap().p_value, p_value, "{seed}: the unit of values is no matter");
            sum += p_value;
        }
        // 2 of 20, and the series itself: 0.1045 on average. The mean of 40 fractions of 199 orders
        // has a standard deviation of 0.0034, of which five are allowed.
        assert!((sum / 40.0 - 0.1045).abs() < 0.017, "{sum}");
    }

    /// What blocks are for: values that drift slowly change their mean without any transition.
    #[test]
    fn slow_noise_is_judged_by_blocks() {
        let slow = |seed| {
            let noise = noise(160, seed);
            noise
                .iter()
                .scan(0.0, |level, value| {
                    *level = 0.7 * *level + value;
                    Some(*level)
                })
                .collect::<Vec<f64>>()
        };
        let n_found = |block| (0..100).filter(|seed| change_of_mean(&slow(500 + seed), block, *seed).unwrap().is_significant()).count();
        let (alone, in_blocks) = (n_found(1), n_found(16));
        assert!(alone >= 2 * in_blocks.max(5), "{alone} {in_blocks}");
        assert!(in_blocks <= 15, "{in_blocks}");
    }

    #[test]
    fn short_and_constant_series_have_no_change() {
        assert_eq!(change_of_mean(&[1.0, 2.0, 3.0], 1, 0), None);
        assert_eq!(change_of_mean(&[0.1; 40], 2, 0), None);
        assert_eq!(change_of_mean(&[], 2, 0), None);
    }
}
