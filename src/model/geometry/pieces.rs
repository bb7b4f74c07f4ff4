//! Convex pieces of an outline.

use parry2d_f64::math::Vector;
use parry2d_f64::shape::{Ball, ConvexPolygon, Segment, Shape, TriMesh};
use parry2d_f64::transformation::hertel_mehlhorn_idx;

use super::without_straight_corners;
use crate::math::Vec2;
use crate::model::{Outline, OutlinePart};

/// Convex piece of an outline, in the frame of the body.
#[derive(Clone, Debug, PartialEq)]
pub enum ConvexPiece {
    /// A disc.
    Disc {
        /// Position of the centre (m).
        centre: Vec2,
        /// (m)
        radius: f64,
    },
    /// A convex polygon.
    Polygon {
        /// Corners, counter-clockwise (m).
        corners: Vec<Vec2>,
    },
    /// A straight wall without thickness.
    Wall {
        /// Both ends (m).
        ends: [Vec2; 2],
    },
}

/// Convex pieces whose union is the outline. Pieces of one part do not overlap. A concave polygon
/// is cut along its diagonals into at most four times the smallest number of pieces (Hertel and
/// Mehlhorn); `None` when that fails, as for a polygon that crosses itself.
pub fn convex_pieces(outline: &Outline) -> Option<Vec<ConvexPiece>> {
    let pieces = outline.parts.iter().map(of_part).collect::<Option<Vec<_>>>()?;
    Some(pieces.concat())
}

pub(super) fn of_part(part: &OutlinePart) -> Option<Vec<ConvexPiece>> {
    match part {
        OutlinePart::Disc { centre, radius } => Some(vec![ConvexPiece::Disc { centre: *centre, radius: *radius }]),
        OutlinePart::Polygon { corners } => of_polygon(corners),
        OutlinePart::Polyline { points } => Some(points.windows(2).map(|ends| ConvexPiece::Wall { ends: [ends[0], ends[1]] }).collect()),
    }
}

fn of_polygon(corners: &[Vec2]) -> Option<Vec<ConvexPiece>> {
    let corners = without_straight_corners(corners);
    let n = corners.len();
    if n < 3 {
        return None;
    }
    let turns_left = |at: usize| (corners[(at + 1) % n] - corners[at]).perp(&(corners[(at + 2) % n] - corners[(at + 1) % n])) > 0.0;
    if (0..n).all(turns_left) {
        return Some(vec![ConvexPiece::Polygon { corners }]);
    }
    // Scaled to order one, for the absolute tolerances of parry2d.
    let size = corners.iter().map(|corner| (corner - corners[0]).norm()).fold(0.0, f64::max);
    let scaled = corners.iter().map(|corner| (corner - corners[0]) / size).map(|at| Vector::new(at.x, at.y)).collect();
    let mesh = TriMesh::from_polygon(scaled)?;
    let pieces = hertel_mehlhorn_idx(mesh.vertices(), mesh.indices());
    let polygon = |piece: Vec<u32>| ConvexPiece::Polygon { corners: piece.into_iter().map(|at| corners[at as usize]).collect() };
    Some(pieces.into_iter().map(polygon).collect())
}

impl ConvexPiece {
    /// The piece as a shape of parry2d, `scale` (1/m) times as large, with the offset of the
    /// shape's origin from that of the body, scaled too.
    pub(super) fn shape(&self, scale: f64) -> (Vector, Box<dyn Shape>) {
        let vector = |at: &Vec2| Vector::new(scale * at.x, scale * at.y);
        match self {
            Self::Disc { centre, radius } => (vector(centre), Box::new(Ball::new(scale * radius))),
            Self::Wall { ends: [a, b] } => (Vector::ZERO, Box::new(Segment::new(vector(a), vector(b)))),
            Self::Polygon { corners } => {
                let polygon = ConvexPolygon::from_convex_polyline_unmodified(corners.iter().map(vector).collect());
                (Vector::ZERO, Box::new(polygon.expect("a piece has three corners or more")))
            }
        }
    }
}
