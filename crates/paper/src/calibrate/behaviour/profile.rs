//! Minimum of a cost over three parameters, and intervals by the profile of the cost.
//!
//! The interval of a parameter holds all its values at which the cost, minimised over the two
//! others, exceeds the minimum by at most an allowed rise. Unlike an interval from the curvature,
//! it shows where data set no limit: an end beyond the bounds of the search is open.
//!
//! Where no value lies beyond the edge of a model, the best value cannot lie there either, and the
//! cost of the truth rises less above the minimum. The rise that a test allows then depends on the
//! distance from the edge ([`threshold`]).

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};

use cohaul::math::{Mat3, Vec3, bisected};

#[derive(Clone, Copy, Debug)]
pub struct Slope {
    pub cost: f64,
    pub gradient: Vec3,
    /// Second derivatives, or a positive semidefinite stand-in for them.
    pub curvature: Mat3,
}

/// A cost over three parameters. A point may leave something behind that makes the next one near by
/// cheaper.
pub trait Cost {
    fn at(&mut self, point: &Vec3) -> Slope;

    /// Least and largest value of each parameter.
    fn bounds(&self) -> [[f64; 2]; 3];

    /// Change of the cost that means nothing.
    fn resolution(&self) -> f64 {
        0.0
    }

    /// Whether a point is so far out that the cost hardly depends on the parameter `index`.
    /// An interval that reaches such a point is open.
    fn is_far_out(&self, _point: &Vec3, _index: usize) -> bool {
        false
    }

    /// Fraction of the allowed rise that is allowed where the parameter `index` has its value of
    /// this point. Near the edge of what the model can do, a smaller rise is as rare.
    fn allowed_share(&mut self, _point: &Vec3, _index: usize) -> f64 {
        1.0
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Minimum {
    pub point: Vec3,
    pub slope: Slope,
}

/// A fitted or given parameter. A number never comes without a limit: the value is `null` where the
/// data set none, and where the best value is at the edge of what is possible.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Parameter {
    pub value: Option<f64>,
    /// Ends of the 95 % interval; `null` where the data set no limit on this side.
    pub low: Option<f64>,
    pub high: Option<f64>,
    /// Whether the value was given, and not fitted.
    pub is_given: bool,
}

impl Parameter {
    pub fn given(value: f64) -> Self {
        Self { value: Some(value), low: None, high: None, is_given: true }
    }

    /// The parameter as a rising function of this one.
    pub fn map(self, of: impl Fn(f64) -> f64) -> Self {
        Self { value: self.value.map(&of), low: self.low.map(&of), high: self.high.map(&of), ..self }
    }
}

/// Largest number of passes over all intervals: a pass that finds a lower minimum is repeated.
pub const N_PASSES: usize = 5;
/// Relative change of the cost below which a minimum counts as found.
const CONVERGED: f64 = 1e-9;

/// Minimum from a start by damped Newton steps (Levenberg and Marquardt) within the bounds, with
/// some parameters `fixed`.
pub fn minimum(cost: &mut impl Cost, start: &Vec3, fixed: [bool; 3]) -> Minimum {
    let bounds = cost.bounds();
    let mut best = Minimum { point: *start, slope: cost.at(start) };
    let mut damping = 1e-4;
    for _ in 0..200 {
        let Slope { gradient, curvature, .. } = best.slope;
        let is_held = |i: usize| {
            let [low, high] = bounds[i];
            let is_pressed = best.point[i] <= low && gradient[i] > 0.0 || best.point[i] >= high && gradient[i] < 0.0;
            fixed[i] || is_pressed || curvature[(i, i)] <= 0.0
        };
        let (mut matrix, mut right) = (curvature, -gradient);
        for i in 0..3 {
            matrix[(i, i)] *= 1.0 + damping;
            if is_held(i) {
                matrix.row_mut(i).fill(0.0);
                matrix.column_mut(i).fill(0.0);
                (matrix[(i, i)], right[i]) = (1.0, 0.0);
            }
        }
        let Some(step) = matrix.cholesky().map(|factor| factor.solve(&right)) else {
            damping = f64::max(10.0 * damping, 1e-6);
            continue;
        };
        let point = Vec3::from_fn(|i, _| (best.point[i] + step[i]).clamp(bounds[i][0], bounds[i][1]));
        let slope = cost.at(&point);
        let gain = best.slope.cost - slope.cost;
        if gain > 0.0 {
            best = Minimum { point, slope };
            damping *= 0.2;
        } else {
            damping = f64::max(10.0 * damping, 1e-6);
        }
        if gain.abs() <= CONVERGED * slope.cost.abs() + cost.resolution() || damping > 1e8 {
            break;
        }
    }
    best
}

/// The parameter `index` with its interval at the allowed `rise` of the cost. A lower minimum that
/// turns up on the way replaces `best`.
pub fn parameter(cost: &mut impl Cost, best: &mut Minimum, index: usize, rise: f64) -> Parameter {
    let [low, high] = cost.bounds()[index];
    // A parameter without any effect on the cost.
    if best.slope.curvature[(index, index)] <= 0.0 {
        return Parameter::default();
    }
    let ends = [low, high].map(|bound| end(cost, best, (index, bound), rise));
    let value = best.point[index];
    let is_sure = match ends {
        [Some(_), Some(_)] => true,
        [None, None] => false,
        _ => low < value && value < high && !cost.is_far_out(&best.point, index),
    };
    Parameter { value: is_sure.then_some(value), low: ends[0], high: ends[1], is_given: false }
}

/// Twice the rise of the log-likelihood that a test at `level` allows for a value `distance`
/// standard deviations away from the edge of its range: the value of Feldman and Cousins, Physical
/// Review D 57, 3873 (1998), for the mean of a normal law that cannot be negative.
///
/// With d the distance, x the measured value and max(x, 0) the best one, twice the rise is
/// (x - d)^2 for positive x and d^2 - 2 x d for negative. It exceeds s^2 > d^2 above d + s and
/// below (d^2 - s^2) / (2 d).
pub fn threshold(level: f64, distance: f64) -> f64 {
    let normal = Normal::standard();
    let [one_sided, two_sided] = [level, 0.5 + 0.5 * level].map(|share| normal.inverse_cdf(share));
    if distance >= two_sided {
        return two_sided * two_sided;
    }
    let below = |root: f64| normal.cdf(-(distance * distance + root * root) / (2.0 * distance));
    let [_, root] = bisected([one_sided, two_sided], 60, |root| normal.cdf(root) - below(root) < level);
    root * root
}

/// Largest share of the rise by which an end may miss it, in the square root.
const END: f64 = 1e-3;

/// End of an interval between the minimum and a bound; `None` if it is beyond the bound.
fn end(cost: &mut impl Cost, best: &mut Minimum, (index, bound): (usize, f64), rise: f64) -> Option<f64> {
    let (from, mut start) = (best.point[index], best.point);
    // The square root of the rise is nearly linear in the parameter.
    let mut excess = |value: f64, best: &mut Minimum| {
        start[index] = value;
        let found = minimum(cost, &start, std::array::from_fn(|i| i == index));
        start = found.point;
        if found.slope.cost < best.slope.cost {
            *best = found;
        }
        let allowed = rise * cost.allowed_share(&found.point, index);
        (value, ((found.slope.cost - best.slope.cost) / allowed).sqrt() - 1.0, cost.is_far_out(&found.point, index))
    };
    let variance = best.slope.curvature.try_inverse().map_or(f64::INFINITY, |inverse| inverse[(index, index)]);
    let mut step = (2.0 * rise * variance).sqrt();
    if !(step > 0.0 && step < (bound - from).abs()) {
        step = 0.1 * (bound - from).abs();
    }
    let (mut near, mut far) = ((from, -1.0, false), (from, -1.0, false));
    while far.1 < 0.0 {
        if far.0 == bound {
            return None;
        }
        near = far;
        let value = if step < (bound - near.0).abs() { near.0 + step.copysign(bound - from) } else { bound };
        far = excess(value, best);
        step *= 2.0;
    }
    // Regula falsi with Illinois' halving.
    for _ in 0..40 {
        let value = far.0 - far.1 * (far.0 - near.0) / (far.1 - near.1);
        if far.1.abs() <= END || value == near.0 || value == far.0 {
            break;
        }
        let found = excess(value, best);
        if (found.1 < 0.0) == (far.1 < 0.0) {
            near.1 *= 0.5;
        } else {
            near = far;
        }
        far = found;
    }
    (!far.2).then_some(far.0)
}

#[cfg(test)]
mod tests {
    use super::threshold;

    /// Known limits: the one-sided test at the edge, the two-sided one far from it. Between them
    /// the probability of a rise within the threshold, by the sum over a fine grid of measured
    /// values, is the level.
    #[test]
    fn the_threshold_near_an_edge_keeps_its_level() {
        assert!((threshold(0.95, 0.0) - 1.644_853_627f64.powi(2)).abs() < 1e-8);
        assert!((threshold(0.95, 2.0) - 1.959_963_985f64.powi(2)).abs() < 1e-8);
        for distance in [0.01, 0.5, 1.0, 1.5, 1.9] {
            let allowed = threshold(0.95, distance);
            let rise = |x: f64| (x - distance).powi(2) - (x - x.max(0.0)).powi(2);
            let density = |x: f64| (-0.5 * (x - distance).powi(2)).exp() / std::f64::consts::TAU.sqrt();
            let step = 1e-4;
            let grid = (-120_000..120_000).map(|i| (f64::from(i) + 0.5) * step);
            let within: f64 = grid.filter(|x| rise(*x) <= allowed).map(|x| density(x) * step).sum();
            // A grid cell at either end holds at most 0.4 of its width.
            assert!((within - 0.95).abs() < step, "{distance}: {within}");
        }
    }
}
