//! Outlines of loads and obstacles, as plain geometry.

use crate::math::Vec2;

/// Shape in the plane: the union of its parts, in the frame of the body. The origin of a load's
/// frame is its centre of mass.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// Parts, which may overlap. An outline without parts touches nothing.
    pub parts: Vec<OutlinePart>,
}

/// Part of an outline.
#[derive(Clone, Debug, PartialEq)]
pub enum OutlinePart {
    /// A disc.
    Disc {
        /// Position of the centre (m).
        centre: Vec2,
        /// (m)
        radius: f64,
    },
    /// A polygon that does not cross itself, convex or not.
    Polygon {
        /// Corners, counter-clockwise (m).
        corners: Vec<Vec2>,
    },
    /// An open chain of straight walls without thickness, which may be touched from both sides.
    Polyline {
        /// Ends of the walls, one after another (m).
        points: Vec<Vec2>,
    },
}

impl Outline {
    /// Disc of this radius (m) about the origin.
    pub fn disc(radius: f64) -> Self {
        Self { parts: vec![OutlinePart::Disc { centre: Vec2::zeros(), radius }] }
    }

    /// Radius of an outline that is one disc about the origin (m).
    pub fn centred_radius(&self) -> Option<f64> {
        match self.parts.as_slice() {
            [OutlinePart::Disc { centre, radius }] if centre.norm() == 0.0 => Some(*radius),
            _ => None,
        }
    }

    /// Corners of polygons, and ends of walls (m).
    pub fn corners(&self) -> impl Iterator<Item = Vec2> + '_ {
        self.parts
            .iter()
            .flat_map(|part| match part {
                OutlinePart::Disc { .. } => &[],
                OutlinePart::Polygon { corners: points } | OutlinePart::Polyline { points } => points.as_slice(),
            })
            .copied()
    }

    /// Largest distance of a point of the outline from the origin (m).
    pub fn extent(&self) -> f64 {
        let farthest = |points: &[Vec2]| points.iter().map(|point| point.norm()).fold(0.0, f64::max);
        let of_part = |part: &OutlinePart| match part {
            OutlinePart::Disc { centre, radius } => centre.norm() + radius,
            OutlinePart::Polygon { corners } => farthest(corners),
            OutlinePart::Polyline { points } => farthest(points),
        };
        self.parts.iter().map(of_part).fold(0.0, f64::max)
    }
}
