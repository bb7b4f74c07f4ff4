//! Limit of small steps of an engine, from runs at three steps, each a half of the one before.
//!
//! An error of the order r falls with the step as h^r. With p(h) the path at the step h, the limit
//! is then p(h/4) + (p(h/4) - p(h/2)) / (2^r - 1). The order is measured: 2^r is the distance of
//! p(h) from p(h/2) over that of p(h/2) from p(h/4), each as the root mean square over the path.
//! From 0.8 to 1.2 it counts as 1, and another one is known as badly, to 0.2: slip onsets, stops
//! and pinnings do not fall on nodes and spoil the expansion in the step.
//!
//! The error of the limit is the largest of three distances, times Roache's factor of safety for
//! three grids, 1.25 (Annu. Rev. Fluid Mech. 29, 123, 1997): that between the limits from the
//! coarser and from the finer two paths, that between the two finest paths, and what a smaller
//! order by 0.2 adds to the latter.

use crate::backend::PoseError;
use crate::math::Pose;

/// How an engine converges with its step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Convergence {
    /// Measured order; `None` where the paths at all steps are equal, or do not converge.
    pub order: Option<f64>,
    /// Distance of the finest of three values from the limit, over its distance from the second
    /// (1).
    reach: f64,
    /// By how much that may be too small, and 1 at least (1).
    doubt: f64,
}

/// Factor of safety of the error of a limit of small steps (1).
const SAFETY: f64 = 1.25;
/// Half of the width of the orders that count as 1, and error of other ones (1).
const ORDER_ERROR: f64 = 0.2;
/// Orders beyond which none is believed (1). At the smallest, 81 % of the error of the coarsest
/// path are left in the finest but one; no engine has been seen beyond the largest.
const ORDERS: [f64; 2] = [0.25, 4.0];

impl Default for Convergence {
    /// Of first order.
    fn default() -> Self {
        Self { order: None, reach: reach(1.0), doubt: 1.0 }
    }
}

impl Convergence {
    /// From the distance of the first path from the second, and of the second from the third.
    pub fn of(first: f64, second: f64) -> Self {
        if first == 0.0 && second == 0.0 {
            return Self::default();
        }
        let measured = (first / second).log2();
        let order = measured.clamp(ORDERS[0], ORDERS[1]);
        if (order - 1.0).abs() <= ORDER_ERROR {
            return Self { order: Some(order), ..Self::default() };
        }
        let doubt = reach(order - ORDER_ERROR) - reach(order);
        Self { order: Some(order).filter(|_| measured >= ORDERS[0]), reach: reach(order), doubt: doubt.max(1.0) }
    }

    /// The limit of poses at three steps, and its error.
    pub fn of_poses(&self, [a, b, c]: [&Pose; 3]) -> (Pose, PoseError) {
        let beyond = |a: &Pose, b: &Pose| Pose {
            position: b.position + self.reach * (b.position - a.position),
            heading: b.heading + self.reach * (b.heading - a.heading),
        };
        let (before, limit) = (beyond(a, b), beyond(b, c));
        let error = PoseError {
            position: self.error((limit.position - before.position).norm(), (c.position - b.position).norm()),
            heading: self.error((limit.heading - before.heading).abs(), (c.heading - b.heading).abs()),
        };
        (limit, error)
    }

    /// The limit of a number at three steps, and its error. A number may have an order of its own,
    /// by which its limit would lie elsewhere.
    pub fn of_numbers(&self, [a, b, c]: [f64; 3]) -> (f64, f64) {
        let (before, limit) = (b + self.reach * (b - a), c + self.reach * (c - b));
        let own = ((a - b) / (b - c)).log2();
        let by_own = if own.is_nan() { limit } else { c + reach(own.clamp(ORDERS[0], ORDERS[1])) * (c - b) };
        (limit, self.error((limit - before).abs(), (c - b).abs()).max(SAFETY * (limit - by_own).abs()))
    }

    fn error(&self, between_limits: f64, between_finest: f64) -> f64 {
        SAFETY * between_limits.max(self.doubt * between_finest)
    }
}

/// Distance of a value from the limit over its distance from that at twice the step (1).
fn reach(order: f64) -> f64 {
    (order.exp2() - 1.0).recip()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values with the limit 0.3 and an error of 0.1 at the first step.
    fn at_three_steps(order: f64) -> [f64; 3] {
        [0.0, -order, -2.0 * order].map(|power| 0.3 + 0.1 * power.exp2())
    }

    fn convergence([a, b, c]: [f64; 3]) -> Convergence {
        Convergence::of((a - b).abs(), (b - c).abs())
    }

    #[test]
    fn a_measured_order_leads_to_the_limit() {
        for order in [0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0] {
            let values = at_three_steps(order);
            let found = convergence(values);
            let (limit, error) = found.of_numbers(values);
            // Rounding of differences of a tenth of the values, times what lies beyond them.
            assert!((found.order.unwrap() - order).abs() < 1e-12 && (limit - 0.3).abs() < 1e-13, "{order}: {limit}");
            // Never less than the distance of the two finest values.
            assert!(error > (values[1] - values[2]).abs(), "{order}: {error}");
        }
    }

    /// A path of first order, and a number of any.
    #[test]
    fn another_order_than_that_of_the_path_is_within_the_error() {
        for of_path in [0.5, 1.0, 2.0] {
            let path = convergence(at_three_steps(of_path));
            for order in [0.4, 0.5, 0.8, 1.2, 1.5, 2.0, 3.0] {
                let (limit, error) = path.of_numbers(at_three_steps(order));
                assert!((limit - 0.3).abs() <= error, "{of_path}, {order}: {limit} within {error}");
            }
        }
    }

    #[test]
    fn an_order_that_is_badly_measured_is_within_the_error() {
        for order in [0.4, 0.5, 0.75, 1.0, 1.25, 2.0] {
            for off in [-0.15, 0.15] {
                let [a, b, c] = at_three_steps(order + off).map(|x| Pose::new(x, 0.0, x));
                let (limit, error) = convergence(at_three_steps(order)).of_poses([&a, &b, &c]);
                assert!((limit.position.x - 0.3).abs() <= error.position && (limit.heading - 0.3).abs() <= error.heading, "{order}{off:+}");
            }
        }
    }

    /// The steps change nothing, or ever more.
    #[test]
    fn without_convergence_the_limit_is_unknown() {
        let (limit, error) = Convergence::of(0.0, 0.0).of_numbers([0.7; 3]);
        assert_eq!((Convergence::of(0.0, 0.0).order, limit, error), (None, 0.7, 0.0));
        let values = [0.1, 0.2, 0.4];
        let found = convergence(values);
        let (_, error) = found.of_numbers(values);
        assert!(found.order.is_none() && error > 10.0 * 0.2, "{error}");
        // Equal at the two finest steps by chance.
        let (limit, error) = Convergence::of(0.1, 0.0).of_numbers([0.1, 0.2, 0.2]);
        assert!(limit == 0.2 && error > 0.005, "{limit} {error}");
    }
}
