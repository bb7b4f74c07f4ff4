//! Gap and slip of two features, as functions of the pose of the load in the obstacle's frame.
//!
//! With the load's pose (x, R(theta)), a point p of it, rounded by r_l, and a point c of the
//! obstacle, rounded by r_o; with N the unit normal from obstacle to load and T = J N, J the
//! quarter turn:
//!
//! ```text
//! point on line    gap = N.P - d - r_l              slip = T.P - r_l theta              P = x + R p
//! point on point   gap = |P - c| - r_l - r_o        slip = (r_l + r_o) alpha - r_l theta    alpha = angle of P - c
//! line on point    gap = m.(b - a) - r_o            slip = (J m).b + r_o theta          b = R'(c - x)
//! ```
//!
//! Slip is a function of the pose, so that sticking and rolling are constraints on poses and
//! nothing creeps. Steps are made of the changes of gap and slip, by the displacement of the point
//! that touches: as differences of places they would have the rounding of those, which over a short
//! step is a velocity. A body twist of the load is the same in the frame of a moving obstacle, so
//! that the derivatives by an increment hold there as well.

use crate::backend::numerics::STRAIGHT_EDGE;
use crate::backend::springs::{Place, Travel};
use crate::math::{Mat3, Vec2, Vec3, perpendicular, unwrap_near};
use crate::model::Reaction;

/// Two features that may touch. Points and lines of the load are in its frame, those of the
/// obstacle in the obstacle's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FeaturePair {
    /// Point of the load, rounded, on a line of the obstacle: normal.P = offset.
    PointOnLine { point: Vec2, rounding: f64, normal: Vec2, offset: f64 },
    /// Point of the load, rounded, on a point of the obstacle; `reach` is the sum of the roundings
    /// (m).
    PointOnPoint { point: Vec2, rounding: f64, centre: Vec2, reach: f64 },
    /// Line of the load on a point of the obstacle, rounded: normal.b = offset.
    LineOnPoint { normal: Vec2, offset: f64, centre: Vec2, rounding: f64 },
}

impl FeaturePair {
    /// Gap (m) for a load at this place in the obstacle's frame.
    pub fn gap(&self, at: &Place) -> f64 {
        match self {
            Self::PointOnLine { point, rounding, normal, offset } => normal.dot(&world(at, point)) - offset - rounding,
            Self::PointOnPoint { point, centre, reach, .. } => (world(at, point) - centre).norm() - reach,
            Self::LineOnPoint { normal, offset, centre, rounding } => normal.dot(&body(at, centre)) - offset - rounding,
        }
    }

    /// Distance of the features (m) where they lie `beside` each other (m) and their `gap` (m) is
    /// one to the line beyond the edge.
    pub fn distance_beside(&self, gap: f64, beside: f64) -> f64 {
        match self {
            Self::PointOnLine { rounding, .. } | Self::LineOnPoint { rounding, .. } => Vec2::new(gap + rounding, beside).norm() - rounding,
            Self::PointOnPoint { .. } => gap,
        }
    }

    /// Whether two pairs have the same line.
    pub fn is_in_line(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::PointOnLine { normal, .. }, Self::PointOnLine { normal: other, .. })
            | (Self::LineOnPoint { normal, .. }, Self::LineOnPoint { normal: other, .. }) => (normal - other).norm() <= STRAIGHT_EDGE,
            _ => false,
        }
    }

    /// Slip coordinate (m), on the branch nearest to `near` (m).
    pub fn slip(&self, at: &Place, near: f64) -> f64 {
        match self {
            Self::PointOnLine { point, rounding, normal, .. } => perpendicular(normal).dot(&world(at, point)) - rounding * at.pose.heading,
            Self::PointOnPoint { point, rounding, centre, reach } => {
                let arm = world(at, point) - centre;
                let turned = rounding * at.pose.heading;
                reach * unwrap_near(arm.y.atan2(arm.x), (near + turned) / reach) - turned
            }
            Self::LineOnPoint { normal, centre, rounding, .. } => perpendicular(normal).dot(&body(at, centre)) + rounding * at.pose.heading,
        }
    }

    /// Point of contact in the obstacle's frame (m).
    pub fn contact_point(&self, at: &Place) -> Vec2 {
        match self {
            Self::PointOnLine { point, rounding, normal, .. } => world(at, point) - *rounding * normal,
            Self::PointOnPoint { point, rounding, centre, .. } => {
                let point = world(at, point);
                point - *rounding * (point - centre).normalize()
            }
            Self::LineOnPoint { normal, centre, rounding, .. } => centre - *rounding * (at.turn * normal),
        }
    }

    /// Unit normal from obstacle to load, in the obstacle's frame.
    pub fn normal(&self, at: &Place) -> Vec2 {
        match self {
            Self::PointOnLine { normal, .. } => *normal,
            Self::PointOnPoint { point, centre, .. } => (world(at, point) - centre).normalize(),
            Self::LineOnPoint { normal, .. } => -(at.turn * normal),
        }
    }

    /// Change of the gap (m) by a travel from `start` to `end`, with all its digits.
    pub fn gap_change(&self, [start, end]: [&Place; 2], travel: &Travel) -> f64 {
        match self {
            Self::PointOnLine { point, normal, .. } => normal.dot(&travel.of_point(&(start.turn * point))),
            Self::PointOnPoint { point, centre, .. } => {
                let (before, moved) = (world(start, point) - centre, travel.of_point(&(start.turn * point)));
                moved.dot(&(2.0 * before + moved)) / (before.norm() + (before + moved).norm())
            }
            Self::LineOnPoint { normal, centre, .. } => -(end.turn * normal).dot(&travel.of_point(&(centre - start.pose.position))),
        }
    }

    /// Change of the slip coordinate (m), by less than half a turn, with all its digits.
    pub fn slip_change(&self, [start, end]: [&Place; 2], travel: &Travel) -> f64 {
        let turn = travel.arc.angle();
        match self {
            Self::PointOnLine { point, rounding, normal, .. } => {
                perpendicular(normal).dot(&travel.of_point(&(start.turn * point))) - rounding * turn
            }
            Self::PointOnPoint { point, rounding, centre, reach } => {
                let (before, moved) = (world(start, point) - centre, travel.of_point(&(start.turn * point)));
                reach * before.perp(&moved).atan2(before.dot(&(before + moved))) - rounding * turn
            }
            Self::LineOnPoint { normal, centre, rounding, .. } => {
                rounding * turn - (end.turn * perpendicular(normal)).dot(&travel.of_point(&(centre - start.pose.position)))
            }
        }
    }

    /// This `gap` (m), as the energy of the answer, with its derivatives along the load's axes.
    pub fn gap_with_derivatives(&self, at: &Place, gap: f64) -> Reaction {
        let (gradient, hessian) = match self {
            Self::PointOnLine { point, normal, .. } => of_point_on_line(&(at.turn * point), normal),
            Self::PointOnPoint { point, centre, .. } => {
                let Polar { normal, distance, normal_rate, across_rate, bend, .. } = Polar::of(at, point, centre);
                (normal_rate, across_rate * across_rate.transpose() / distance - turns(bend.dot(&normal)))
            }
            Self::LineOnPoint { normal, centre, .. } => of_line_on_point(&(at.turn * normal), &(centre - at.pose.position)),
        };
        Reaction { energy: gap, gradient, hessian }.in_axes(&at.turn)
    }

    /// This `slip` (m), as the energy of the answer, with its derivatives along the load's axes.
    pub fn slip_with_derivatives(&self, at: &Place, slip: f64) -> Reaction {
        let (gradient, hessian) = match self {
            Self::PointOnLine { point, rounding, normal, .. } => {
                let (gradient, hessian) = of_point_on_line(&(at.turn * point), &perpendicular(normal));
                (gradient - Vec3::new(0.0, 0.0, *rounding), hessian)
            }
            Self::PointOnPoint { point, rounding, centre, reach } => {
                let Polar { across, distance, normal_rate, across_rate, bend, .. } = Polar::of(at, point, centre);
                let mixed = normal_rate * across_rate.transpose();
                let angle = -(mixed + mixed.transpose()) / (distance * distance) - turns(bend.dot(&across) / distance);
                (*reach / distance * across_rate - Vec3::new(0.0, 0.0, *rounding), *reach * angle)
            }
            Self::LineOnPoint { normal, centre, rounding, .. } => {
                let (gradient, hessian) = of_line_on_point(&(at.turn * perpendicular(normal)), &(centre - at.pose.position));
                (gradient + Vec3::new(0.0, 0.0, *rounding), hessian)
            }
        };
        Reaction { energy: slip, gradient, hessian }.in_axes(&at.turn)
    }
}

/// Point of the load in the obstacle's frame.
fn world(at: &Place, point: &Vec2) -> Vec2 {
    at.pose.position + at.turn * point
}

/// Point of the obstacle in the load's frame.
fn body(at: &Place, point: &Vec2) -> Vec2 {
    at.turn.tr_mul(&(point - at.pose.position))
}

/// Derivatives by (x, y, theta) of direction.P with P = x + R p and R p the `arm`.
fn of_point_on_line(arm: &Vec2, direction: &Vec2) -> (Vec3, Mat3) {
    (direction.push(direction.dot(&perpendicular(arm))), turns(-direction.dot(arm)))
}

/// Derivatives by (x, y, theta) of `D.(c - x)` for a `direction` D that turns with the load, with c
/// - x the `arm`.
fn of_line_on_point(direction: &Vec2, arm: &Vec2) -> (Vec3, Mat3) {
    let turned = perpendicular(direction);
    let hessian = Mat3::new(0.0, 0.0, -turned.x, 0.0, 0.0, -turned.y, -turned.x, -turned.y, -direction.dot(arm));
    ((-direction).push(turned.dot(arm)), hessian)
}

/// Second derivative by the heading alone.
fn turns(value: f64) -> Mat3 {
    Mat3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, value)
}

/// A point of the load seen from a point of the obstacle, with the rates by (x, y, theta).
struct Polar {
    normal: Vec2,
    across: Vec2,
    /// (m)
    distance: f64,
    /// Rate of the point along the normal.
    normal_rate: Vec3,
    /// Rate of the point across it.
    across_rate: Vec3,
    /// The arm R p, the negative of the point's second derivative by the heading (m).
    bend: Vec2,
}

impl Polar {
    fn of(at: &Place, point: &Vec2, centre: &Vec2) -> Self {
        let bend = at.turn * point;
        let arm = at.pose.position + bend - centre;
        let distance = arm.norm();
        let normal = arm / distance;
        let across = perpendicular(&normal);
        let turning = perpendicular(&bend);
        Self {
            normal,
            across,
            distance,
            normal_rate: normal.push(normal.dot(&turning)),
            across_rate: across.push(across.dot(&turning)),
            bend,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Arc, Pose};

    fn pairs() -> [FeaturePair; 3] {
        let (point, centre) = (Vec2::new(0.02, -0.03), Vec2::new(0.05, 0.04));
        let normal = crate::math::direction(0.7);
        [
            FeaturePair::PointOnLine { point, rounding: 0.005, normal, offset: 0.01 },
            FeaturePair::PointOnPoint { point, rounding: 0.005, centre, reach: 0.02 },
            FeaturePair::LineOnPoint { normal, offset: 0.03, centre, rounding: 0.01 },
        ]
    }

    /// Changes are differences of what they change for a long travel, and for a short one the slope
    /// along it: less the curvature, which is a share of the travel, no digit is lost.
    #[test]
    fn changes_of_gap_and_slip_keep_all_digits() {
        let start = Place::of(&Pose::new(0.3, -0.2, 0.4));
        let twist = Vec3::new(0.02, -0.03, 0.5);
        for pair in pairs() {
            for size in [1.0, 1e-3, 1e-9, 1e-12] {
                let (shift, arc) = (size * twist.xy(), Arc::of(size * twist.z));
                let travel = Travel { shift: start.turn * arc.shift(&shift), arc };
                let end = start.after(&travel);
                let (gap, slip) = (pair.gap_change([&start, &end], &travel), pair.slip_change([&start, &end], &travel));
                let before = pair.slip(&start, 0.0);
                // Some roundings of lengths of 0.5 m and of their differences.
                assert!((gap - (pair.gap(&end) - pair.gap(&start))).abs() < 5e-16, "{pair:?} {size}");
                assert!((slip - (pair.slip(&end, before) - before)).abs() < 5e-16, "{pair:?} {size}");
                let slopes = [pair.gap_with_derivatives(&start, 0.0), pair.slip_with_derivatives(&start, 0.0)];
                let along = slopes.map(|it| it.gradient.dot(&(size * twist)));
                // The second derivatives are at most 0.2 m/rad^2, or 20 1/m.
                let bent = 0.1 * size * size + 1e-15 * size;
                assert!((gap - along[0]).abs() < bent && (slip - along[1]).abs() < bent, "{pair:?} {size}: {gap:e} {slip:e} {along:?}");
            }
        }
    }
}
