//! Crossings and orientation of a polygon.

use parry2d_f64::math::Vector;
use parry2d_f64::utils::segments_intersection2d;

use super::moments_of_polygon;
use crate::math::Vec2;

/// Distance over the size of a polygon within which a corner counts as a point of another side (1).
const TOUCH: f64 = 1e-12;

/// Indices of two sides of a polygon that cross, touch, or lie on each other; `None` for a simple
/// polygon. Side i starts at corner i. Neighbouring sides share a corner, and must not fold back.
pub fn first_crossing(corners: &[Vec2]) -> Option<(usize, usize)> {
    let n = corners.len();
    let size = corners.iter().map(|corner| (corner - corners[0]).norm()).fold(0.0, f64::max);
    // Tolerances of parry2d are absolute, for lengths of order one.
    let scaled: Vec<Vector> = corners.iter().map(|corner| (corner - corners[0]) / size).map(|at| Vector::new(at.x, at.y)).collect();
    let end = |side: usize| scaled[(side + 1) % n];
    let folds_back = |side: usize, next: usize| {
        let (along, on) = (end(side) - scaled[side], end(next) - scaled[next]);
        along.dot(on) < 0.0 && along.perp_dot(on).abs() <= TOUCH * along.length() * on.length()
    };
    let cross = |one: usize, other: usize| segments_intersection2d(scaled[one], end(one), scaled[other], end(other), TOUCH).is_some();
    let pairs = (0..n).flat_map(|one| (one + 1..n).map(move |other| (one, other)));
    pairs.into_iter().find(|&(one, other)| match (other - one == 1, one + n - other == 1) {
        (true, _) => folds_back(one, other),
        (_, true) => folds_back(other, one),
        _ => cross(one, other),
    })
}

/// The polygon with its corners counter-clockwise; a clockwise one is reversed but for its first
/// corner.
pub fn turned_counter_clockwise(mut corners: Vec<Vec2>) -> Vec<Vec2> {
    if moments_of_polygon(&corners).area < 0.0 {
        corners[1..].reverse();
    }
    corners
}

/// The polygon without corners at which it goes straight on.
pub fn without_straight_corners(corners: &[Vec2]) -> Vec<Vec2> {
    let n = corners.len();
    let is_straight = |at: usize| {
        let (before, after) = (corners[at] - corners[(at + n - 1) % n], corners[(at + 1) % n] - corners[at]);
        before.perp(&after).abs() <= TOUCH * before.norm() * after.norm()
    };
    (0..n).filter(|at| !is_straight(*at)).map(|at| corners[at]).collect()
}

/// The open chain without points at which it goes straight on. Both ends stay, and so does a point
/// at which the chain turns back.
pub fn without_straight_points(points: &[Vec2]) -> Vec<Vec2> {
    let goes_on = |at: usize| {
        let (before, after) = (points[at] - points[at - 1], points[at + 1] - points[at]);
        before.perp(&after).abs() <= TOUCH * before.norm() * after.norm() && before.dot(&after) > 0.0
    };
    let is_end = |at: usize| at == 0 || at + 1 == points.len();
    (0..points.len()).filter(|at| is_end(*at) || !goes_on(*at)).map(|at| points[at]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_keeps_its_ends_and_the_points_at_which_it_turns() {
        let chain = points(&[[0.0, 0.0], [0.1, 0.0], [0.7, 0.0], [1.0, 0.0], [1.0, 0.5], [1.0, 2.0], [1.0, 1.0]]);
        assert_eq!(without_straight_points(&chain), points(&[[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [1.0, 1.0]]));
        assert_eq!(without_straight_points(&chain[..2]), chain[..2]);
    }

    fn points(list: &[[f64; 2]]) -> Vec<Vec2> {
        list.iter().copied().map(Vec2::from).collect()
    }

    #[test]
    fn crossings_are_found_at_any_scale() {
        let star = [[0.0, 1.0], [0.6, -0.8], [-1.0, 0.3], [1.0, 0.3], [-0.6, -0.8]];
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        let pinched = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        let spike = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 0.5], [0.0, 1.0]];
        let flat = [[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]];
        let concave = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let straight = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0]];
        for scale in [1e-9, 1e-3, 1.0, 1e6] {
            let crossing = |list: &[[f64; 2]]| first_crossing(&points(list).iter().map(|at| scale * at).collect::<Vec<_>>());
            assert_eq!(crossing(&bow), Some((0, 2)));
            assert_eq!(crossing(&pinched), Some((0, 2)));
            assert_eq!(crossing(&spike), Some((1, 2)));
            assert!(crossing(&star).is_some() && crossing(&flat).is_some());
            assert_eq!((crossing(&concave), crossing(&straight)), (None, None));
        }
    }

    #[test]
    fn a_clockwise_polygon_is_turned_round() {
        let square = points(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        let clockwise = points(&[[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
        assert_eq!(turned_counter_clockwise(clockwise), square);
        assert_eq!(turned_counter_clockwise(square.clone()), square);
        let more = points(&[[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(without_straight_corners(&more), square);
    }
}
