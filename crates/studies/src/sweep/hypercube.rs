//! Latin hypercubes, point by point: one of n points is in each of n equal intervals of every axis.
//!
//! The interval of a point is a permutation of its index that depends on seed and axis: a Feistel
//! network over the next power of four, applied until the result is below n (Black and Rogaway,
//! "Ciphers with arbitrary finite domains", CT-RSA 2002).

use cohaul::math::{RandomStreams, Stream};

/// Rounds of the network. Four make it pseudorandom (Luby and Rackoff), six also in small domains.
const ROUNDS: u32 = 6;

/// Coordinate `dimension` of point `index` of `n`, in (0, 1).
pub fn coordinate(seed: u64, index: u64, n: u64, dimension: u32) -> f64 {
    let streams = RandomStreams::new(seed);
    let within = streams.uniform(Stream::Design, dimension, index);
    // Rounding must not reach 1.
    let share = (permuted(&streams, index, n, dimension) as f64 + within) / n as f64;
    share.min(1.0 - f64::EPSILON)
}

/// Image of `index` under a permutation of `n`.
fn permuted(streams: &RandomStreams, index: u64, n: u64, dimension: u32) -> u64 {
    let half_bits = (64 - n.saturating_sub(1).leading_zeros()).div_ceil(2).max(1);
    let mut at = index;
    loop {
        at = encrypted(streams, at, half_bits, dimension);
        if at < n {
            return at;
        }
    }
}

fn encrypted(streams: &RandomStreams, at: u64, half_bits: u32, dimension: u32) -> u64 {
    let mask = (1u64 << half_bits) - 1;
    let (mut left, mut right) = (at >> half_bits, at & mask);
    for round in 1..=ROUNDS {
        // Agents beyond all dimensions, so that no draw is that of a point.
        let draw = streams.uniform(Stream::Design, (round << 16) | dimension, right);
        (left, right) = (right, left ^ (draw * (mask + 1) as f64) as u64);
    }
    (left << half_bits) | right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_interval_of_every_axis_has_one_point() {
        for n in [1, 2, 3, 17, 64, 1000] {
            for dimension in 0..3 {
                let mut cells: Vec<u64> = (0..n).map(|index| (coordinate(5, index, n, dimension) * n as f64) as u64).collect();
                cells.sort_unstable();
                assert!(cells.iter().enumerate().all(|(at, cell)| at as u64 == *cell), "{n}, {dimension}");
            }
        }
    }

    /// Different axes and seeds are uncorrelated: the correlation of 1000 pairs has a standard
    /// deviation of 0.032, and the bound is four of them.
    #[test]
    fn axes_and_seeds_are_independent() {
        let n = 1000;
        let ranks = |seed, dimension| (0..n).map(move |index| coordinate(seed, index, n, dimension) - 0.5);
        let correlation =
            |a: (u64, u32), b: (u64, u32)| ranks(a.0, a.1).zip(ranks(b.0, b.1)).map(|(x, y)| 12.0 * x * y).sum::<f64>() / n as f64;
        for (a, b) in [((1, 0), (1, 1)), ((1, 0), (1, 2)), ((1, 0), (2, 0)), ((1, 1), (7, 1))] {
            assert!(correlation(a, b).abs() < 0.13, "{a:?} {b:?}: {}", correlation(a, b));
        }
        // Nor with the index.
        let index: f64 = ranks(1, 0).enumerate().map(|(at, x)| 12.0 * x * (at as f64 / n as f64 - 0.5)).sum();
        assert!((index / n as f64).abs() < 0.13, "{index}");
    }
}
