//! Corners and edges by which outlines touch.

use smallvec::SmallVec;

use crate::math::{Vec2, perpendicular};
use crate::model::{Outline, OutlinePart};

/// Sine of the angle between two edges below which they are one (1): the corner between them can
/// not be touched before they are.
pub const STRAIGHT: f64 = 1e-9;

/// A convex corner, or the centre of a disc.
#[derive(Clone, Debug, PartialEq)]
pub struct Corner {
    /// Position in the body's frame (m).
    pub at: Vec2,
    /// Radius of the disc about it (m); zero for a sharp corner.
    pub rounding: f64,
    /// Unit vectors along the edges that end here, away from it.
    pub edges: SmallVec<[Vec2; 2]>,
}

/// A straight edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// One end in the body's frame (m).
    pub from: Vec2,
    /// Unit vector to the other end.
    pub along: Vec2,
    /// (m)
    pub length: f64,
    /// Whether it can be touched from both sides. Otherwise the body lies on the left of `along`.
    pub has_two_sides: bool,
}

/// All features of an outline.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    pub corners: Vec<Corner>,
    pub edges: Vec<Edge>,
}

impl Edge {
    fn between(from: &Vec2, to: &Vec2, has_two_sides: bool) -> Self {
        let length = (to - from).norm();
        Self { from: *from, along: (to - from) / length, length, has_two_sides }
    }

    /// Outward normal of an edge that is touched from outside.
    pub fn normal(&self) -> Vec2 {
        -perpendicular(&self.along)
    }

    /// Distance by which a point lies beyond the ends of the edge, along it (m); negative between
    /// them.
    pub fn beyond(&self, point: &Vec2) -> f64 {
        let at = self.along.dot(&(point - self.from));
        (-at).max(at - self.length)
    }
}

impl Corner {
    /// Distance by which a point, seen from the corner, lies beside an edge that ends here (m). The
    /// corner is nearer than the edges where it is negative.
    pub fn beside(&self, point: &Vec2) -> f64 {
        self.edges.iter().map(|along| along.dot(&(point - self.at))).fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Features {
    pub fn of(outline: &Outline) -> Self {
        let mut features = Self::default();
        for part in &outline.parts {
            match part {
                OutlinePart::Disc { centre, radius } => {
                    features.corners.push(Corner { at: *centre, rounding: *radius, edges: SmallVec::new() });
                }
                OutlinePart::Polygon { corners } => features.add_polygon(corners),
                OutlinePart::Polyline { points } => features.add_polyline(points),
            }
        }
        features
    }

    fn add_polygon(&mut self, corners: &[Vec2]) {
        let n = corners.len();
        for (k, at) in corners.iter().enumerate() {
            let edge = Edge::between(at, &corners[(k + 1) % n], false);
            let before = (corners[(k + n - 1) % n] - at).normalize();
            // The interior lies on the left, so that a convex corner turns left.
            if (-before).perp(&edge.along) > STRAIGHT {
                self.corners.push(Corner { at: *at, rounding: 0.0, edges: SmallVec::from_slice(&[before, edge.along]) });
            }
            self.edges.push(edge);
        }
    }

    fn add_polyline(&mut self, points: &[Vec2]) {
        for (k, at) in points.iter().enumerate() {
            let before = k.checked_sub(1).map(|k| (points[k] - at).normalize());
            let after = points.get(k + 1).map(|next| (next - at).normalize());
            let is_straight =
                before.zip(after).is_some_and(|(before, after)| before.perp(&after).abs() <= STRAIGHT && before.dot(&after) < 0.0);
            if !is_straight {
                self.corners.push(Corner { at: *at, rounding: 0.0, edges: before.into_iter().chain(after).collect() });
            }
        }
        self.edges.extend(points.windows(2).map(|ends| Edge::between(&ends[0], &ends[1], true)));
    }
}
