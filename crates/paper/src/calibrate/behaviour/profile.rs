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

/// A cost over three parameters, in which further unknowns may be hidden.
///
/// The hidden unknowns are fitted anew at each point, by steps from those of a point near by. The
/// cost is then a function of both. A search therefore has to keep the hidden unknowns of a point
/// with the point: those of a point far out may have settled in another minimum, and would raise
/// the cost of every point that came after it.
pub trait Cost {
    /// Best values of the hidden unknowns at a point.
    type Hidden: Clone;

    /// The cost at a point, with the hidden unknowns fitted by steps from `near`.
    fn at(&self, point: &Vec3, near: &Self::Hidden) -> (Slope, Self::Hidden);

    /// Hidden unknowns at a point after a search of all their minima.
    fn look_around(&self, _point: &Vec3, found: &Self::Hidden) -> Self::Hidden {
        found.clone()
    }

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
    fn allowed_share(&self, _point: &Vec3, _index: usize) -> f64 {
        1.0
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Minimum<H> {
    pub point: Vec3,
    pub slope: Slope,
    pub hidden: H,
}

impl<H> Minimum<H> {
    /// A point as the start of a search.
    pub fn start<C: Cost<Hidden = H>>(cost: &C, point: &Vec3, near: &H) -> Self {
        let (slope, hidden) = cost.at(point, near);
        Self { point: *point, slope, hidden }
    }
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

    /// Whether the interval has no width. No recording with noise tells a parameter exactly: the
    /// search for the ends has failed then.
    pub fn is_collapsed(&self) -> bool {
        let is_wide = |(low, high): (f64, f64)| high - low > COLLAPSED * low.abs().max(high.abs());
        self.low.zip(self.high).is_some_and(|ends| !is_wide(ends))
    }

    /// The parameter as a rising function of this one.
    pub fn map(self, of: impl Fn(f64) -> f64) -> Self {
        Self { value: self.value.map(&of), low: self.low.map(&of), high: self.high.map(&of), ..self }
    }
}

/// Relative width below which an interval has none (1): rounding of tips, which is the least noise
/// of a recording, leaves a width of 1e-9 and more.
const COLLAPSED: f64 = 1e-12;

/// Largest number of passes over all intervals: a pass that finds a lower minimum is repeated.
pub const N_PASSES: usize = 5;
/// Relative change of the cost below which a minimum counts as found.
const CONVERGED: f64 = 1e-9;

/// Minimum from a start by damped Newton steps (Levenberg and Marquardt) within the bounds, with
/// some parameters `fixed`.
pub fn minimum<C: Cost>(cost: &C, start: Minimum<C::Hidden>, fixed: [bool; 3]) -> Minimum<C::Hidden> {
    let bounds = cost.bounds();
    let mut best = start;
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
        let next = Minimum::start(cost, &point, &best.hidden);
        let (gain, whole) = (best.slope.cost - next.slope.cost, next.slope.cost.abs());
        if gain > 0.0 {
            best = next;
            damping *= 0.2;
        } else {
            damping = f64::max(10.0 * damping, 1e-6);
        }
        if gain.abs() <= CONVERGED * whole + cost.resolution() || damping > 1e8 {
            break;
        }
    }
    best
}

/// The parameter `index` with its interval at the allowed `rise` of the cost. A lower minimum that
/// turns up on the way replaces `best`.
pub fn parameter<C: Cost>(cost: &C, best: &mut Minimum<C::Hidden>, index: usize, rise: f64) -> Parameter {
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

/// Width of a bracket, in expected distances of the end from the minimum, below which a rise counts
/// as a jump of the cost.
const JUMP: f64 = 1e-4;

/// Excess above which a bracket is halved.
const STEEP: f64 = 5.0;

/// A value of the parameter, with the least cost over the others.
struct Tried<H> {
    value: f64,
    /// Square root of the rise over the allowed one, less 1: nearly linear in the parameter.
    excess: f64,
    is_far_out: bool,
    at: Minimum<H>,
}

/// The search for one end of an interval.
struct End<'a, C: Cost> {
    cost: &'a C,
    index: usize,
    rise: f64,
    best: &'a mut Minimum<C::Hidden>,
}

impl<C: Cost> End<'_, C> {
    fn tried(&mut self, value: f64, near: &Minimum<C::Hidden>) -> Tried<C::Hidden> {
        let mut point = near.point;
        point[self.index] = value;
        let fixed = std::array::from_fn(|i| i == self.index);
        let at = minimum(self.cost, Minimum::start(self.cost, &point, &near.hidden), fixed);
        if at.slope.cost < self.best.slope.cost {
            *self.best = at.clone();
        }
        let allowed = self.rise * self.cost.allowed_share(&at.point, self.index);
        let excess = ((at.slope.cost - self.best.slope.cost) / allowed).sqrt() - 1.0;
        Tried { value, excess, is_far_out: self.cost.is_far_out(&at.point, self.index), at }
    }

    /// The same value once more, with the hidden unknowns searched for everywhere.
    fn looked_around(&mut self, tried: &Tried<C::Hidden>) -> Tried<C::Hidden> {
        let hidden = self.cost.look_around(&tried.at.point, &tried.at.hidden);
        self.tried(tried.value, &Minimum { hidden, ..tried.at.clone() })
    }
}

/// Largest number of looks around at a jump of the cost.
const MOST_LOOKS: usize = 4;

impl<C: Cost> End<'_, C> {
    /// The first value towards the bound, in growing steps, that is not in the interval, and the
    /// last one that is; `None` if the bound is in the interval.
    fn beyond(&mut self, mut near: Tried<C::Hidden>, bound: f64, mut step: f64) -> Option<[Tried<C::Hidden>; 2]> {
        loop {
            let left = bound - near.value;
            if left == 0.0 {
                return None;
            }
            let tried = self.tried(if step < left.abs() { near.value + step.copysign(left) } else { bound }, &near.at);
            if tried.excess >= 0.0 {
                return Some([near, tried]);
            }
            near = tried;
            step *= 2.0;
        }
    }

    /// Narrows a bracket of the end to the tolerance or to this width, by regula falsi with
    /// Illinois' halving. Each search begins at the point within the interval.
    fn narrowed(&mut self, [mut near, mut far]: [Tried<C::Hidden>; 2], width: f64) -> [Tried<C::Hidden>; 2] {
        let (mut inner, mut outer, mut was_within) = (near.excess, far.excess, None);
        while near.excess < -END && far.excess > END && (far.value - near.value).abs() > width {
            // A rise so steep tells little about where the end is.
            let back = if far.excess > STEEP { 0.5 } else { outer / (outer - inner) };
            let tried = self.tried(far.value - back * (far.value - near.value), &near.at);
            let is_within = tried.excess < 0.0;
            let halved = if was_within == Some(is_within) { 0.5 } else { 1.0 };
            if is_within {
                (inner, outer, near) = (tried.excess, halved * outer, tried);
            } else {
                (inner, outer, far) = (halved * inner, tried.excess, tried);
            }
            was_within = Some(is_within);
        }
        [near, far]
    }
}

/// End of an interval between the minimum and a bound; `None` if it is beyond the bound.
fn end<C: Cost>(cost: &C, best: &mut Minimum<C::Hidden>, (index, bound): (usize, f64), rise: f64) -> Option<f64> {
    let from = best.point[index];
    let variance = best.slope.curvature.try_inverse().map_or(f64::INFINITY, |inverse| inverse[(index, index)]);
    let mut step = (2.0 * rise * variance).sqrt();
    if !(step > 0.0 && step < (bound - from).abs()) {
        step = 0.1 * (bound - from).abs();
    }
    let width = step * JUMP;
    let mut near = Tried { value: from, excess: -1.0, is_far_out: false, at: best.clone() };
    let mut search = End { cost, index, rise, best };
    for look in 0.. {
        let bracket = search.beyond(near, bound, step)?;
        let [within, beyond] = search.narrowed(bracket, width);
        if within.excess >= -END {
            return (!within.is_far_out).then_some(within.value);
        }
        let is_jump = beyond.excess > END && look < MOST_LOOKS;
        let again = if is_jump { search.looked_around(&beyond) } else { beyond };
        if again.excess >= 0.0 {
            return (!again.is_far_out).then_some(again.value);
        }
        near = again;
    }
    unreachable!("the looks around are counted")
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
