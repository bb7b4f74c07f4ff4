//! Supports that stand for a uniform pressure on the whole outline of the load.
//!
//! A disc has rings of equal supports. Their radii are the nodes of Gauss's quadrature with the
//! weight r dr, which is exact for polynomials of r: the friction torque of a disc that spins about
//! its centre, 2/3 mu m g R, is met to rounding with any number of supports, and one ring of three
//! supports is the tripod at 2 R / 3. A polygon is cut by a rectangular grid. The cell's part of
//! the weight stands at the cell's centroid, so that the centre of pressure is the centroid of the
//! outline.
//!
//! Largest error of the friction force and of its torque over all centres of rotation, over mu m g
//! and mu m g R with the extent R of the outline:
//!
//! | n | disc, force | disc, torque | square, force | square, torque |
//! |---|---|---|---|---|
//! | 12 | 12.4 % | 9.2 % | 9.6 % | 9.1 % |
//! | 24 | 5.9 % | 4.8 % | 4.7 % | 4.6 % |
//! | 48 | 3.5 % | 2.7 % | 2.5 % | 2.5 % |
//! | 96 | 1.8 % | 1.6 % | 1.3 % | 1.3 % |
//!
//! The error is largest where the centre of rotation is on a support, which then has no friction.
//! The torque of a square that spins about its centre is too small by at most 0.5 / n of itself.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{DMatrix, SymmetricEigen};

use super::geometry::{AreaMoments, ConvexPiece, area_moments, convex_pieces, moments_of_polygon};
use super::{Outline, OutlinePart, SupportPoint};
use crate::math::{Vec2, direction};

/// Number of supports on a ring over that of rings (1). Neighbours on a ring are then about as far
/// from each other as neighbouring rings.
const RING_OVER_RINGS: f64 = 8.0 / 3.0;

/// About `n` supports that share the `weight` (N) in proportion to the area of the outline that
/// each of them stands for. Parts of the outline must not overlap.
///
/// # Panics
/// When a polygon crosses itself.
pub fn uniform_supports(outline: &Outline, n: usize, weight: f64) -> Vec<SupportPoint> {
    let total = area_moments(outline).area;
    let mut supports = Vec::new();
    for part in &outline.parts {
        let alone = Outline { parts: vec![part.clone()] };
        let share = area_moments(&alone).area / total;
        // Each part has a support at least.
        let n_part = ((n as f64 * share).round() as usize).max(1);
        let of_part = match part {
            OutlinePart::Disc { centre, radius } => rings(centre, *radius, n_part),
            OutlinePart::Polygon { .. } => cells(&alone, n_part),
            OutlinePart::Polyline { .. } => continue,
        };
        supports.extend(of_part.into_iter().map(|(offset, fraction)| SupportPoint {
            offset,
            normal_load: weight * share * fraction,
            friction_coefficient: None,
        }));
    }
    supports
}

/// Points of a disc with their fractions of its area.
fn rings(centre: &Vec2, radius: f64, n: usize) -> Vec<(Vec2, f64)> {
    if n == 1 {
        return vec![(*centre, 1.0)];
    }
    let n_rings = ((n as f64 / RING_OVER_RINGS).sqrt().round() as usize).max(1);
    let n_on_ring = (n as f64 / n_rings as f64).round() as usize;
    let mut points = Vec::new();
    for (ring, (node, fraction)) in radial_nodes(n_rings).into_iter().enumerate() {
        // Every second ring is turned by half a step.
        let first = FRAC_PI_2 + if ring % 2 == 1 { 0.5 * TAU / n_on_ring as f64 } else { 0.0 };
        for index in 0..n_on_ring {
            let bearing = first + TAU * index as f64 / n_on_ring as f64;
            points.push((centre + radius * node * direction(bearing), fraction / n_on_ring as f64));
        }
    }
    points
}

/// Nodes and weights of Gauss's quadrature on [0, 1] with the weight 2 r dr: the eigenvalues and
/// the squared first components of the eigenvectors of the Jacobi matrix (Golub and Welsch 1969),
/// with the recurrence of the Jacobi polynomials P^(0,1).
fn radial_nodes(n: usize) -> Vec<(f64, f64)> {
    let mut jacobi = DMatrix::zeros(n, n);
    for k in 0..n {
        let at = k as f64;
        jacobi[(k, k)] = 1.0 / ((2.0 * at + 1.0) * (2.0 * at + 3.0));
        if k > 0 {
            let beside = (at * (at + 1.0)).sqrt() / (2.0 * at + 1.0);
            (jacobi[(k, k - 1)], jacobi[(k - 1, k)]) = (beside, beside);
        }
    }
    let eigen = SymmetricEigen::new(jacobi);
    let mut nodes: Vec<(f64, f64)> = (0..n).map(|k| (0.5 * (1.0 + eigen.eigenvalues[k]), eigen.eigenvectors[(0, k)].powi(2))).collect();
    nodes.sort_by(|one, other| one.0.total_cmp(&other.0));
    nodes
}

/// Centroids of the cells of a grid over polygons with their fractions of the area. Cells at the
/// edge of the outline are cut, so that there may be more of them than `n`.
fn cells(outline: &Outline, n: usize) -> Vec<(Vec2, f64)> {
    let total = area_moments(outline).area;
    let pieces: Vec<Vec<Vec2>> =
        convex_pieces(outline).expect("polygons do not cross themselves").into_iter().filter_map(corners).collect();
    let all = || pieces.iter().flatten();
    let low = all().fold(Vec2::repeat(f64::INFINITY), |low, corner| low.inf(corner));
    let high = all().fold(Vec2::repeat(f64::NEG_INFINITY), |high, corner| high.sup(corner));
    let size = high - low;
    // Cells of the box: as many per area as n on the outline.
    let in_box = n as f64 * size.x * size.y / total;
    let across = (in_box * size.x / size.y).sqrt().round().max(1.0);
    // Halves go up, whatever their rounding.
    let up = (in_box / across + HALF_SLACK).round().max(1.0);
    let line = |column: usize, row: usize| low + Vec2::new(size.x * column as f64 / across, size.y * row as f64 / up);
    let mut points = Vec::new();
    for column in 0..across as usize {
        for row in 0..up as usize {
            let (from, to) = (line(column, row), line(column + 1, row + 1));
            let cut = pieces.iter().map(|piece| moments_of_polygon(&clipped(piece, &from, &to)));
            let cell = cut.fold(AreaMoments::default(), AreaMoments::plus);
            if cell.area > SMALLEST_CELL * total {
                points.push((cell.centroid(), cell.area / total));
            }
        }
    }
    points
}

/// Rounding of a number of rows (1).
const HALF_SLACK: f64 = 1e-9;
/// Area over that of the outline below which the cut part of a cell is rounding (1).
const SMALLEST_CELL: f64 = 1e-12;

fn corners(piece: ConvexPiece) -> Option<Vec<Vec2>> {
    match piece {
        ConvexPiece::Polygon { corners } => Some(corners),
        ConvexPiece::Disc { .. } | ConvexPiece::Wall { .. } => None,
    }
}

/// The part of a convex polygon inside of the rectangle between two corners (Sutherland and
/// Hodgman).
fn clipped(polygon: &[Vec2], low: &Vec2, high: &Vec2) -> Vec<Vec2> {
    let sides = [(Vec2::x(), high.x), (-Vec2::x(), -low.x), (Vec2::y(), high.y), (-Vec2::y(), -low.y)];
    sides.iter().fold(polygon.to_vec(), |polygon, (normal, limit)| cut_off(&polygon, normal, *limit))
}

/// The part of a convex polygon up to `limit` along a `normal`.
fn cut_off(polygon: &[Vec2], normal: &Vec2, limit: f64) -> Vec<Vec2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (index, here) in polygon.iter().enumerate() {
        let next = &polygon[(index + 1) % polygon.len()];
        let (beyond, next_beyond) = (normal.dot(here) - limit, normal.dot(next) - limit);
        if beyond <= 0.0 {
            kept.push(*here);
        }
        if (beyond < 0.0 && next_beyond > 0.0) || (beyond > 0.0 && next_beyond < 0.0) {
            kept.push(here + (next - here) * (beyond / (beyond - next_beyond)));
        }
    }
    kept
}
