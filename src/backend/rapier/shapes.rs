//! Outlines as shapes of rapier for one precision. The file is included twice, like `world.rs`.

use super::convert::narrow;
use super::engine::parry::shape::ConvexPolygon;
use super::engine::prelude::{Pose, SharedShape, Vector};

use super::Real;
use crate::model::geometry::{ConvexPiece, convex_pieces, without_straight_points};
use crate::model::{Outline, OutlinePart};

/// Shape of an outline in the frame of its body; `None` for an outline that touches nothing. It has
/// all corners of the outline at which the outline turns, rounded to this precision.
pub fn shape_of(outline: &Outline) -> Option<(Pose, SharedShape)> {
    let parts = outline.parts.iter().map(straightened).collect();
    let pieces = convex_pieces(&Outline { parts }).expect("polygons do not cross themselves");
    let mut shapes: Vec<_> = pieces.iter().map(shape_of_piece).collect();
    match shapes.len() {
        0 => None,
        1 => shapes.pop(),
        _ => Some((Pose::IDENTITY, SharedShape::compound(shapes))),
    }
}

/// The part with one wall where several lie in one line. The engine lets a load catch on the ends
/// between them.
fn straightened(part: &OutlinePart) -> OutlinePart {
    match part {
        OutlinePart::Polyline { points } => OutlinePart::Polyline { points: without_straight_points(points) },
        OutlinePart::Disc { .. } | OutlinePart::Polygon { .. } => part.clone(),
    }
}

fn shape_of_piece(piece: &ConvexPiece) -> (Pose, SharedShape) {
    let here = |shape| (Pose::IDENTITY, shape);
    match piece {
        ConvexPiece::Disc { centre, radius } => (Pose::from_translation(narrow(centre)), SharedShape::ball(*radius as Real)),
        ConvexPiece::Wall { ends: [a, b] } => here(SharedShape::segment(narrow(a), narrow(b))),
        ConvexPiece::Polygon { corners } => here(hull(corners.iter().map(narrow).collect())),
    }
}

/// Convex polygon with these corners. Where rounding leaves fewer than three of them apart, it is
/// the segment or the point that they have become.
fn hull(mut corners: Vec<Vector>) -> SharedShape {
    corners.dedup();
    if corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    match *corners.as_slice() {
        [point] => SharedShape::segment(point, point),
        [a, b] => SharedShape::segment(a, b),
        _ => {
            let polygon = ConvexPolygon::from_convex_polyline_unmodified(corners);
            SharedShape::new(polygon.expect("its corners are three or more, and apart"))
        }
    }
}
