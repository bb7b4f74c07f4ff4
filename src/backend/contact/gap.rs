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
//! nothing creeps. A body twist of the load is the same in the frame of a moving obstacle, so that
//! the derivatives by an increment hold there as well.

use super::features::STRAIGHT;
use crate::backend::springs::Place;
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
            Self::PointOnLine { rounding, .. } | Self::LineOnPoint { rounding, .. } => (gap + rounding).hypot(beside) - rounding,
            Self::PointOnPoint { .. } => gap,
        }
    }

    /// Depth of a point behind a line (m), with this `gap` (m).
    pub fn depth(&self, gap: f64) -> f64 {
        match self {
            Self::PointOnLine { rounding, .. } | Self::LineOnPoint { rounding, .. } => -gap - rounding,
            Self::PointOnPoint { .. } => 0.0,
        }
    }

    /// Whether two pairs have the same line.
    pub fn is_in_line(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::PointOnLine { normal, .. }, Self::PointOnLine { normal: other, .. })
            | (Self::LineOnPoint { normal, .. }, Self::LineOnPoint { normal: other, .. }) => (normal - other).norm() <= STRAIGHT,
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

    /// Gap (m), as the energy of the answer, with its derivatives along the load's axes.
    pub fn gap_with_derivatives(&self, at: &Place) -> Reaction {
        let (gradient, hessian) = match self {
            Self::PointOnLine { point, normal, .. } => of_point_on_line(&(at.turn * point), normal),
            Self::PointOnPoint { point, centre, .. } => {
                let Polar { normal, distance, normal_rate, across_rate, bend, .. } = Polar::of(at, point, centre);
                (normal_rate, across_rate * across_rate.transpose() / distance - turns(bend.dot(&normal)))
            }
            Self::LineOnPoint { normal, centre, .. } => of_line_on_point(&(at.turn * normal), &(centre - at.pose.position)),
        };
        Reaction { energy: self.gap(at), gradient, hessian }.in_axes(&at.turn)
    }

    /// Slip (m), as the energy of the answer, with its derivatives along the load's axes.
    pub fn slip_with_derivatives(&self, at: &Place, near: f64) -> Reaction {
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
        Reaction { energy: self.slip(at, near), gradient, hessian }.in_axes(&at.turn)
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
