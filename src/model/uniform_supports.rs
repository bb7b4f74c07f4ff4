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

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_1_SQRT_2, PI};

    use super::*;
    use crate::math::perpendicular;

    const COUNTS: [usize; 4] = [12, 24, 48, 96];

    fn polygon(list: &[[f64; 2]]) -> Outline {
        Outline { parts: vec![OutlinePart::Polygon { corners: list.iter().copied().map(Vec2::from).collect() }] }
    }

    fn rectangle(x: f64, y: f64) -> Outline {
        polygon(&[[-x, -y], [x, -y], [x, y], [-x, y]])
    }

    /// Force and torque about the origin of the friction on supports that turn about `centre`.
    fn friction(supports: &[SupportPoint], centre: &Vec2) -> (Vec2, f64) {
        let mut sum = (Vec2::zeros(), 0.0);
        for support in supports {
            let arm = support.offset - centre;
            // A support at the centre of rotation has no friction.
            let force = if arm.norm() == 0.0 { Vec2::zeros() } else { support.normal_load * perpendicular(&arm.normalize()) };
            sum = (sum.0 + force, sum.1 + support.offset.perp(&force));
        }
        sum
    }

    /// Complete elliptic integrals K and E of this parameter by the arithmetic-geometric mean.
    fn elliptic(parameter: f64) -> (f64, f64) {
        let (mut a, mut b, mut sum, mut power) = (1.0, (1.0 - parameter).sqrt(), 0.5 * parameter, 0.5);
        for _ in 0..8 {
            let c = 0.5 * (a - b);
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
            power *= 2.0;
            sum += power * c * c;
        }
        (0.5 * PI / a, 0.5 * PI / a * (1.0 - sum))
    }

    /// Friction of a unit disc under a unit weight that turns about `centre`: integrals of the
    /// uniform pressure in closed form.
    fn disc_friction(centre: &Vec2) -> (Vec2, f64) {
        let ratio = centre.norm();
        let square = ratio * ratio;
        let (force, torque) = if ratio <= 1.0 {
            let (k, e) = elliptic(square);
            let force = 4.0 / (3.0 * PI * ratio) * ((square + 1.0) * e + (square - 1.0) * k);
            (force, 4.0 / (9.0 * PI) * ((4.0 - 2.0 * square) * e + (square - 1.0) * k))
        } else {
            let (k, e) = elliptic(1.0 / square);
            let force = 4.0 / (3.0 * PI) * ((square + 1.0) * e - (square - 1.0) * k);
            (force, 4.0 * ratio / (9.0 * PI) * ((4.0 - 2.0 * square) * e + (2.0 * square - 5.0 + 3.0 / square) * k))
        };
        (-force * perpendicular(&(centre / ratio)), torque)
    }

    /// Friction of a rectangle of half sides `x` and `y` under a unit weight that turns about
    /// `centre`. With G the mean distance from the centre, the mean unit vector from there is -grad
    /// G. Both follow from the integral of the distance over a rectangle with a corner at the
    /// centre.
    fn rectangle_friction(x: f64, y: f64, centre: &Vec2) -> (Vec2, f64) {
        let part = |a: f64, b: f64| a.abs().powi(3) * a.signum() / 6.0 * (b / a.abs()).asinh();
        let integral = |a: f64, b: f64| a * b * a.hypot(b) / 3.0 + part(a, b) + part(b, a);
        let slope = |a: f64, b: f64| 0.5 * (b * a.hypot(b) + a * a * (b / a.abs()).asinh());
        let (left, right, down, up) = (-x - centre.x, x - centre.x, -y - centre.y, y - centre.y);
        let over = |f: &dyn Fn(f64, f64) -> f64| (f(right, up) - f(left, up) - f(right, down) + f(left, down)) / (4.0 * x * y);
        let mean_direction = Vec2::new(over(&slope), over(&|a, b| slope(b, a)));
        let force = perpendicular(&mean_direction);
        (force, over(&integral) + centre.perp(&force))
    }

    /// Largest errors of force and torque (over the extent) for centres within 1.5 extents.
    fn worst(outline: &Outline, n: usize, exact: impl Fn(&Vec2) -> (Vec2, f64)) -> (f64, f64) {
        let supports = uniform_supports(outline, n, 1.0);
        let extent = outline.extent();
        let mut worst: (f64, f64) = (0.0, 0.0);
        let anywhere = (1..3000).map(|index| {
            // Irrational steps: no centre is on a support or on a line of symmetry.
            let at = |step: f64| 1.5 * extent * (2.0 * (index as f64 * step).fract() - 1.0);
            Vec2::new(at(0.754_877_666_246_693), at(0.569_840_290_998_053))
        });
        let beside =
            supports.iter().flat_map(|support| (0..16).map(|way| support.offset + 1e-6 * direction(0.1 + TAU * way as f64 / 16.0)));
        for centre in anywhere.chain(beside) {
            let ((force, torque), (true_force, true_torque)) = (friction(&supports, &centre), exact(&centre));
            worst = (worst.0.max((force - true_force).norm()), worst.1.max((torque - true_torque).abs() / extent));
        }
        worst
    }

    #[test]
    fn the_weight_and_its_centre_are_those_of_the_outline() {
        let (x, y) = (5.0 / 4.0, 3.0 / 4.0);
        let l = polygon(&[[-x, -y], [3.0 - x, -y], [3.0 - x, 1.0 - y], [1.0 - x, 1.0 - y], [1.0 - x, 2.0 - y], [-x, 2.0 - y]]);
        let square =
            |at: f64| OutlinePart::Polygon { corners: [[at, 0.0], [at + 1.0, 0.0], [at + 1.0, 1.0], [at, 1.0]].map(Vec2::from).into() };
        let mixed = Outline { parts: vec![OutlinePart::Disc { centre: Vec2::new(-2.0, 1.0), radius: 0.5 }, square(0.0), square(3.0)] };
        for outline in [Outline::disc(0.0122), rectangle(0.0122, 0.008), l, mixed] {
            for n in [3, 4, 16, 97, 1000] {
                let supports = uniform_supports(&outline, n, 0.0157);
                let centroid = area_moments(&outline).centroid();
                let weight: f64 = supports.iter().map(|support| support.normal_load).sum();
                let centre = supports.iter().map(|support| support.normal_load * support.offset).sum::<Vec2>() / weight;
                // Rounding of up to a thousand summands.
                assert!((weight / 0.0157 - 1.0).abs() < 1e-13, "{weight}");
                assert!((centre - centroid).norm() < 1e-13 * outline.extent(), "{centre} {centroid}");
                assert!(supports.iter().all(|support| support.normal_load > 0.0));
                // Cells at the edge of a concave outline are cut, so that there are a few more.
                let n_found = supports.len();
                assert!(n_found >= 3 && (n < 16 || (0.7..1.6).contains(&(n_found as f64 / n as f64))), "{n}: {n_found}");
            }
        }
    }

    /// 2/3 mu m g R for a disc, exactly; the mean distance from the centre for a rectangle.
    #[test]
    fn spinning_friction_is_that_of_the_pressure() {
        let spin = |outline: &Outline, n| friction(&uniform_supports(outline, n, 1.0), &Vec2::zeros()).1;
        for n in [3, 8, 12, 24, 48, 96, 1000] {
            // Rounding of the eigenvalues of the Jacobi matrix.
            assert!((spin(&Outline::disc(0.3), n) - 0.2).abs() < 1e-14, "{n}");
        }
        let (x, y): (f64, f64) = (0.9, 0.4);
        let mean = x.hypot(y) / 3.0 + x * x / (6.0 * y) * (y / x).asinh() + y * y / (6.0 * x) * (x / y).asinh();
        for n in COUNTS {
            // Midpoints are too near to the centre by 0.35 to 0.51 of 1 / n.
            let error = spin(&rectangle(x, y), n) / mean - 1.0;
            assert!((-0.52 / n as f64..-0.2 / n as f64).contains(&error), "{n}: {error}");
        }
    }

    /// The table above. The tolerance is its rounding.
    #[test]
    fn friction_has_the_stated_accuracy() {
        let side = FRAC_1_SQRT_2;
        let discs = [(0.124, 0.092), (0.059, 0.048), (0.035, 0.027), (0.018, 0.016)];
        let squares = [(0.096, 0.091), (0.047, 0.046), (0.025, 0.025), (0.013, 0.013)];
        let mut sharp = 0;
        for (n, (disc, square)) in COUNTS.into_iter().zip(discs.into_iter().zip(squares)) {
            let found = [
                (worst(&Outline::disc(1.0), n, disc_friction), disc),
                (worst(&rectangle(side, side), n, |centre| rectangle_friction(side, side, centre)), square),
            ];
            for ((force, torque), (force_bound, torque_bound)) in found {
                assert!(force < force_bound && torque < torque_bound, "{n}: {force} {torque}");
                sharp += usize::from(force > 0.9 * force_bound) + usize::from(torque > 0.9 * torque_bound);
            }
        }
        // Bounds that nothing comes near to would state nothing.
        assert_eq!(sharp, 16);
    }
}
