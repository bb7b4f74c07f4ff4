//! Outlines as shapes of rapier for one precision. The file is included twice, like `world.rs`.

use super::engine::parry::shape::TriMesh;
use super::engine::parry::transformation::hertel_mehlhorn;
use super::engine::prelude::{Pose, SharedShape, Vector};

use super::Real;
use crate::math::Vec2;
use crate::model::{Outline, OutlinePart};

/// Shape of an outline in the frame of its body; `None` for an outline that touches nothing.
pub fn shape_of(outline: &Outline) -> Option<(Pose, SharedShape)> {
    let mut pieces: Vec<(Pose, SharedShape)> = outline.parts.iter().flat_map(pieces_of).collect();
    match pieces.len() {
        0 => None,
        1 => pieces.pop(),
        _ => Some((Pose::IDENTITY, SharedShape::compound(pieces))),
    }
}

/// Convex pieces of a part.
fn pieces_of(part: &OutlinePart) -> Vec<(Pose, SharedShape)> {
    let here = |shape| (Pose::IDENTITY, shape);
    match part {
        OutlinePart::Disc { centre, radius } => vec![(Pose::from_translation(narrow(centre)), SharedShape::ball(*radius as Real))],
        OutlinePart::Polygon { corners } => {
            let corners: Vec<_> = corners.iter().map(narrow).collect();
            convex_pieces(corners).into_iter().filter_map(SharedShape::convex_polyline).map(here).collect()
        }
        OutlinePart::Polyline { points } => {
            points.windows(2).map(|ends| here(SharedShape::segment(narrow(&ends[0]), narrow(&ends[1])))).collect()
        }
    }
}

/// Convex polygons that make up the polygon with these corners. The partition is exact: it cuts
/// along diagonals, and moves no corner.
fn convex_pieces(corners: Vec<Vector>) -> Vec<Vec<Vector>> {
    if is_convex(&corners) {
        return vec![corners];
    }
    // A polygon that crosses itself has no triangles. Outlines do not contain any.
    TriMesh::from_polygon(corners).map_or_else(Vec::new, |mesh| hertel_mehlhorn(mesh.vertices(), mesh.indices()))
}

fn is_convex(corners: &[Vector]) -> bool {
    let n = corners.len();
    (0..n).all(|at| {
        let [a, b, c] = [at, at + 1, at + 2].map(|i| corners[i % n]);
        let (first, second) = (b - a, c - b);
        first.x * second.y - first.y * second.x >= 0.0
    })
}

fn narrow(v: &Vec2) -> Vector {
    Vector::new(v.x as Real, v.y as Real)
}
