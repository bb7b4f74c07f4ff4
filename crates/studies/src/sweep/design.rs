//! Points of a design: every combination of the lists, with the last one fastest, times every point
//! of the sample over the ranges.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::axis::{Axis, Values};
use super::error::SweepError;
use super::{hypercube, sobol};
use cohaul::math::{RandomStreams, Stream};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Design {
    pub axes: Vec<Axis>,
    pub sample: Option<Sample>,
}

/// Sample of the ranges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    pub method: Method,
    pub n: u64,
    /// Seed of the random numbers. Sobol's sequence is shifted by random bits with a seed, and
    /// fixed without.
    pub seed: Option<u64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    LatinHypercube,
    Sobol,
}

impl Design {
    /// # Errors
    /// When a range has no sample or a sample no range, an axis is repeated, or there are too many
    /// points.
    pub fn new(axes: Vec<Axis>, sample: Option<Sample>) -> Result<Self, SweepError> {
        let design = Self { axes, sample };
        let n_ranges = design.axes.iter().filter(|axis| axis.n_values().is_none()).count();
        let range = design.axes.iter().find(|axis| axis.n_values().is_none());
        match (range, sample) {
            (Some(axis), None) => return Err(SweepError::axis(&axis.path, "must be a list or a grid without --sample", "a range")),
            (None, Some(_)) => return Err(SweepError::axis("--sample", "must have a range LOW..HIGH to sample", "none")),
            (Some(_), Some(Sample { n: 0, .. })) => return Err(SweepError::axis("--sample", "must have at least 1 point", 0)),
            (Some(_), Some(Sample { method: Method::Sobol, n, .. })) => {
                if n_ranges > sobol::MOST_DIMENSIONS {
                    let rule = format!("must have at most {} ranges for sobol", sobol::MOST_DIMENSIONS);
                    return Err(SweepError::axis("--sample", rule, n_ranges));
                }
                if n > sobol::MOST_POINTS {
                    return Err(SweepError::axis("--sample", format!("must have at most {} points for sobol", sobol::MOST_POINTS), n));
                }
            }
            _ => {}
        }
        for (at, axis) in design.axes.iter().enumerate() {
            if design.axes[..at].iter().any(|before| before.path == axis.path) {
                return Err(SweepError::axis(&axis.path, "must be varied once", "it again"));
            }
        }
        design.checked_n_points().map(|_| design)
    }

    fn checked_n_points(&self) -> Result<u64, SweepError> {
        let of_sample = self.sample.map_or(1, |sample| sample.n);
        let product = self.axes.iter().filter_map(Axis::n_values).try_fold(of_sample, u64::checked_mul);
        product.ok_or_else(|| SweepError::axis("--vary", "must make less than 2^64 points", "more"))
    }

    /// Number of points, one without any axis.
    pub fn n_points(&self) -> u64 {
        self.checked_n_points().expect("a design is made with fewer points")
    }

    /// Values of all axes at point `index`. `is_whole` tells for each axis whether it takes whole
    /// numbers.
    pub fn point(&self, index: u64, is_whole: &[bool]) -> Vec<Value> {
        let n_sampled = self.sample.map_or(1, |sample| sample.n);
        let (mut combination, sampled) = (index / n_sampled, index % n_sampled);
        let counts = self.axes.iter().rev().filter_map(Axis::n_values);
        let mut places: Vec<u64> = counts.map(|n| take_digit(&mut combination, n)).collect();
        let mut dimension = 0;
        let values = self.axes.iter().zip(is_whole).map(|(axis, is_whole)| match &axis.values {
            Values::List(_) | Values::Grid { .. } => axis.value(places.pop().expect("a place a list")),
            Values::Range { low, high, is_logarithmic } => {
                dimension += 1;
                Values::within(*low, *high, *is_logarithmic, *is_whole, self.coordinate(sampled, dimension - 1))
            }
        });
        values.collect()
    }

    /// Coordinate of a sampled point along one range, in [0, 1).
    fn coordinate(&self, index: u64, dimension: usize) -> f64 {
        let sample = self.sample.expect("ranges come with a sample");
        match sample.method {
            Method::LatinHypercube => hypercube::coordinate(sample.seed.unwrap_or(1), index, sample.n, dimension as u32),
            Method::Sobol => {
                let shift = sample.seed.map_or(0, |seed| shift(seed, dimension));
                f64::from(sobol::coordinate(index, dimension) ^ shift) / 2f64.powi(32)
            }
        }
    }
}

/// Random bits by which a whole axis is shifted, which keeps the points evenly distributed.
fn shift(seed: u64, dimension: usize) -> u32 {
    (RandomStreams::new(seed).uniform(Stream::Design, dimension as u32, u64::MAX) * 2f64.powi(32)) as u32
}

fn take_digit(rest: &mut u64, base: u64) -> u64 {
    let digit = *rest % base;
    *rest /= base;
    digit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn design(specs: &[&str], sample: Option<Sample>) -> Result<Design, SweepError> {
        Design::new(specs.iter().map(|spec| spec.parse().unwrap()).collect(), sample)
    }

    fn sample(method: Method, n: u64, seed: Option<u64>) -> Option<Sample> {
        Some(Sample { method, n, seed })
    }

    #[test]
    fn a_grid_has_every_combination_with_the_last_axis_fastest() {
        let design = design(&["a=1,2", "b=x,y,z"], None).unwrap();
        let points: Vec<String> = (0..design.n_points()).map(|index| format!("{:?}", design.point(index, &[false; 2]))).collect();
        assert_eq!(points.len(), 6);
        assert_eq!(design.point(0, &[false; 2]), [Value::from(1), "x".into()]);
        assert_eq!(design.point(4, &[false; 2]), [Value::from(2), "y".into()]);
        assert_eq!(design.point(5, &[false; 2]), [Value::from(2), "z".into()]);
    }

    #[test]
    fn samples_stay_within_their_ranges_and_repeat_by_their_seed_alone() {
        for method in [Method::LatinHypercube, Method::Sobol] {
            let of = |seed| design(&["a=log:1e-4..1e-2", "n=2..5", "w=u,v"], sample(method, 64, seed)).unwrap();
            let points = |seed| (0..128).map(|index| of(seed).point(index, &[false, true, false])).collect::<Vec<_>>();
            let one = points(Some(1));
            assert_eq!(one, points(Some(1)));
            assert_ne!(one, points(Some(2)));
            assert_eq!(
                one[..64].iter().map(|point| &point[..2]).collect::<Vec<_>>(),
                one[64..].iter().map(|point| &point[..2]).collect::<Vec<_>>()
            );
            let below = one[..64].iter().filter(|point| point[0].as_f64().unwrap() < 1e-3).count();
            // Half of the points below the middle of the logarithms: both methods are stratified
            // there.
            assert_eq!(below, 32);
            for n in 2..=5u64 {
                assert_eq!(one[..64].iter().filter(|point| point[1] == n).count(), 16, "{method:?}");
            }
        }
    }

    #[test]
    fn ranges_and_samples_need_each_other() {
        for (specs, sample, why) in [
            (&["a=1..2"][..], None, "a: must be a list or a grid without --sample"),
            (&["a=1,2"], sample(Method::Sobol, 4, None), "--sample: must have a range"),
            (&["a=1..2"], sample(Method::Sobol, 0, None), "at least 1 point"),
            (&["a=1,2", "a=3,4"], None, "a: must be varied once"),
        ] {
            let error = design(specs, sample).unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
    }
}
