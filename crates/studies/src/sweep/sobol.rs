//! Sobol's sequence, point by point: shards need any point without those before it.
//!
//! The direction numbers are the first of the table `new-joe-kuo-6` of S. Joe and F. Y. Kuo,
//! "Constructing Sobol sequences with better two-dimensional projections", SIAM J. Sci. Comput. 30
//! (2008) 2635-2654. Points are ordered by the Gray code of the index, as by Antonov and Saleev.

/// Degree, inner coefficients of the primitive polynomial, and first direction numbers of
/// dimensions 2, 3, ...
const PRIMITIVE: [(u32, u32, &[u32]); MOST_DIMENSIONS - 1] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
    (5, 11, &[1, 1, 5, 1, 1]),
    (5, 13, &[1, 1, 1, 3, 11]),
    (5, 14, &[1, 3, 5, 5, 31]),
    (6, 1, &[1, 3, 3, 9, 7, 49]),
    (6, 13, &[1, 1, 1, 15, 21, 21]),
    (6, 16, &[1, 3, 1, 13, 27, 49]),
];

/// Largest number of sampled parameters.
pub const MOST_DIMENSIONS: usize = 16;

/// Number of points of the sequence.
pub const MOST_POINTS: u64 = 1 << 32;

/// Coordinate `dimension` of point `index`, as 32 bits after the binary point.
///
/// # Panics
/// From [`MOST_DIMENSIONS`] and [`MOST_POINTS`] on.
pub fn coordinate(index: u64, dimension: usize) -> u32 {
    assert!(index < MOST_POINTS, "a point of 32 bits");
    let gray = (index ^ (index >> 1)) as u32;
    let directions = directions(dimension);
    (0..32).filter(|bit| gray >> bit & 1 == 1).fold(0, |sum, bit| sum ^ directions[bit as usize])
}

/// The direction numbers v_1 ... v_32, each shifted to its place.
fn directions(dimension: usize) -> [u32; 32] {
    let Some(before) = dimension.checked_sub(1) else { return std::array::from_fn(|bit| 1 << (31 - bit)) };
    let (degree, inner, first) = PRIMITIVE[before];
    let degree = degree as usize;
    let mut v = [0u32; 32];
    for bit in 0..32 {
        v[bit] = if bit < degree { first[bit] << (31 - bit) } else { v[bit - degree] ^ (v[bit - degree] >> degree) };
        for k in 1..degree.min(bit + 1) {
            if bit >= degree && inner >> (degree - 1 - k) & 1 == 1 {
                v[bit] ^= v[bit - k];
            }
        }
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::math::{RandomStreams, Stream};

    fn point(index: u64, n: usize) -> Vec<f64> {
        (0..n).map(|dimension| f64::from(coordinate(index, dimension)) / 2f64.powi(32)).collect()
    }

    /// The first points that Joe and Kuo print for three dimensions.
    #[test]
    fn the_first_points_are_the_published_ones() {
        let first = [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
            [0.875, 0.875, 0.125],
            [0.625, 0.125, 0.875],
            [0.125, 0.625, 0.375],
            [0.1875, 0.3125, 0.9375],
            [0.6875, 0.8125, 0.4375],
        ];
        for (index, expected) in first.iter().enumerate() {
            assert_eq!(point(index as u64, 3), expected);
        }
    }

    /// The property of Sobol's sequence: one of the first 2^k points is in each of 2^k equal
    /// intervals of every axis.
    #[test]
    fn every_axis_is_stratified_at_every_power_of_two() {
        for dimension in 0..MOST_DIMENSIONS {
            for k in [1, 4, 9] {
                let mut cells: Vec<u32> = (0..1u64 << k).map(|index| coordinate(index, dimension) >> (32 - k)).collect();
                cells.sort_unstable();
                assert!(cells.iter().enumerate().all(|(at, cell)| at as u32 == *cell), "{dimension}, {k}");
            }
        }
    }

    /// Warnock's formula of the L2 star discrepancy squared.
    fn discrepancy(points: &[Vec<f64>]) -> f64 {
        let (n, d) = (points.len() as f64, points[0].len() as i32);
        let single: f64 = points.iter().map(|x| x.iter().map(|x| 1.0 - x * x).product::<f64>()).sum();
        let pairs = points.iter().flat_map(|x| points.iter().map(move |y| x.iter().zip(y).map(|(x, y)| 1.0 - x.max(*y)).product::<f64>()));
        3f64.powi(-d) - 2f64.powi(1 - d) / n * single + pairs.sum::<f64>() / (n * n)
    }

    /// Random points have (2^-d - 3^-d) / n on average. 256 points of Sobol have less than a tenth
    /// of it in two dimensions, and less than a third in five, where so few points are nearer to
    /// random ones.
    #[test]
    fn points_are_more_even_than_random_ones() {
        for (d, share) in [(2, 0.1), (5, 1.0 / 3.0)] {
            let random_mean = (2f64.powi(-d) - 3f64.powi(-d)) / 256.0;
            let sobol: Vec<_> = (0..256).map(|index| point(index, d as usize)).collect();
            let streams = RandomStreams::new(1);
            let draw = |index: u64| (0..d as u32).map(|dimension| streams.uniform(Stream::Design, dimension, index)).collect();
            let random: Vec<Vec<f64>> = (0..256).map(draw).collect();
            assert!(discrepancy(&sobol) < share * random_mean, "{d}: {} of {random_mean}", discrepancy(&sobol));
            assert!(discrepancy(&random) > 0.4 * random_mean, "{d}: {} of {random_mean}", discrepancy(&random));
        }
    }
}
