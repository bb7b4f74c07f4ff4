//! Overlap of outlines, lines of sight past them, and their closest points.

use parry2d_f64::math::{Pose as ParryPose, Vector};
use parry2d_f64::query::{Ray, contact};
use parry2d_f64::shape::Shape;

use super::pieces;
use super::{ConvexPiece, convex_pieces};
use crate::math::{Pose, Vec2};
use crate::model::Outline;

/// Point of an outline that is closest to another point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// Point of the edge (m, world).
    pub point: Vec2,
    /// Distance from it, negative inside of the outline (m).
    pub distance: f64,
}

/// Largest depth to which two outlines at two poses overlap: that of their convex pieces, which is
/// the shortest displacement that separates such a pair (m). `None` when they do not overlap or
/// only touch.
///
/// # Panics
/// When a polygon crosses itself.
pub fn overlap_depth(a: &Outline, at_a: &Pose, b: &Outline, at_b: &Pose) -> Option<f64> {
    let sizes = [a.extent(), b.extent()];
    if (at_a.position - at_b.position).norm() > sizes[0] + sizes[1] {
        return None;
    }
    let [pieces_a, pieces_b] = [a, b].map(|outline| convex_pieces(outline).expect("polygons do not cross themselves"));
    depth_of_pieces(&pieces_a, at_a, &pieces_b, at_b, sizes)
}

/// Shortest displacement (m, world) that brings the outline `b` out of `a` along the normal of the
/// pair of convex pieces that overlaps most deeply: zero for outlines that do not overlap. `None`
/// where a few such displacements do not part them, as in a notch.
///
/// # Panics
/// When a polygon crosses itself.
pub fn way_out(a: &Outline, at_a: &Pose, b: &Outline, at_b: &Pose) -> Option<Vec2> {
    const MOST_DISPLACEMENTS: usize = 20;
    let sizes = [a.extent(), b.extent()];
    let [pieces_a, pieces_b] = [a, b].map(|outline| convex_pieces(outline).expect("polygons do not cross themselves"));
    let mut moved = *at_b;
    for _ in 0..MOST_DISPLACEMENTS {
        let Some((depth, normal)) = deepest_of_pieces(&pieces_a, at_a, &pieces_b, &moved, sizes) else {
            return Some(moved.position - at_b.position);
        };
        moved.position += depth * normal;
    }
    None
}

/// Gap between two outlines at two poses, negative where they overlap (m); `None` for an outline
/// without parts.
///
/// # Panics
/// When a polygon crosses itself.
pub fn gap(a: &Outline, at_a: &Pose, b: &Outline, at_b: &Pose) -> Option<f64> {
    let sizes = [a.extent(), b.extent()];
    let [pieces_a, pieces_b] = [a, b].map(|outline| convex_pieces(outline).expect("polygons do not cross themselves"));
    let reach = (at_a.position - at_b.position).norm() + sizes[0] + sizes[1];
    closest_pieces(&pieces_a, at_a, &pieces_b, at_b, sizes, reach).map(|(gap, _)| gap)
}

/// Indices of two parts of an outline that overlap, with the depth (m).
///
/// # Panics
/// When a polygon crosses itself.
pub fn overlap_of_parts(outline: &Outline) -> Option<(usize, usize, f64)> {
    let pieces: Vec<_> = outline.parts.iter().map(|part| pieces::of_part(part).expect("polygons do not cross themselves")).collect();
    let (still, sizes) = (Pose::new(0.0, 0.0, 0.0), [outline.extent(); 2]);
    let pairs = (0..pieces.len()).flat_map(|one| (one + 1..pieces.len()).map(move |other| (one, other)));
    pairs.into_iter().find_map(|(one, other)| {
        let depth = depth_of_pieces(&pieces[one], &still, &pieces[other], &still, sizes)?;
        Some((one, other, depth))
    })
}

/// Depth over the larger size up to which outlines count as touching (1): the error of distances of
/// parry2d is about 5e-9.
const TOUCH: f64 = 2e-8;
/// Smallest size over the larger one that is still resolved (1).
const FINEST: f64 = 1e-9;

/// Largest depth of two lists of pieces of bodies with these `sizes` (m).
fn depth_of_pieces(a: &[ConvexPiece], at_a: &Pose, b: &[ConvexPiece], at_b: &Pose, sizes: [f64; 2]) -> Option<f64> {
    deepest_of_pieces(a, at_a, b, at_b, sizes).map(|(depth, _)| depth)
}

/// The same with the normal of the deepest pair, which points out of the first body (m and 1,
/// world).
fn deepest_of_pieces(a: &[ConvexPiece], at_a: &Pose, b: &[ConvexPiece], at_b: &Pose, sizes: [f64; 2]) -> Option<(f64, Vec2)> {
    let (gap, normal) = closest_pieces(a, at_a, b, at_b, sizes, 0.0)?;
    (-gap > TOUCH * sizes[0].max(sizes[1])).then_some((-gap, normal))
}

/// Smallest gap between pieces of two bodies that are nearer than `reach` (m), negative where they
/// overlap, and its normal, which points out of the first body (m and 1, world).
fn closest_pieces(a: &[ConvexPiece], at_a: &Pose, b: &[ConvexPiece], at_b: &Pose, sizes: [f64; 2], reach: f64) -> Option<(f64, Vec2)> {
    // Positions relative to the first body and sizes of order one keep all digits.
    let larger = sizes[0].max(sizes[1]);
    let size = sizes[0].min(sizes[1]).max(FINEST * larger).max(f64::MIN_POSITIVE);
    let scale = 1.0 / size;
    let origin = at_a.position;
    let placed = |piece: &ConvexPiece, at: &Pose| Placed::new(piece, at, &origin, scale);
    let placed_b: Vec<Placed> = b.iter().map(|piece| placed(piece, at_b)).collect();
    let mut closest: Option<(f64, Vec2)> = None;
    for one in a.iter().map(|piece| placed(piece, at_a)) {
        for other in &placed_b {
            let found =
                contact(&one.pose, &*one.shape, &other.pose, &*other.shape, scale * reach).expect("parry2d knows all pairs of pieces");
            let Some(found) = found else { continue };
            if closest.is_none_or(|(gap, _)| size * found.dist < gap) {
                closest = Some((size * found.dist, Vec2::new(found.normal1.x, found.normal1.y)));
            }
        }
    }
    closest
}

/// First point at which the segment `from` - `to` (m, world) meets an outline, as its fraction of
/// the segment; zero when `from` is inside (1). `None` when the line of sight is free.
///
/// # Panics
/// When a polygon crosses itself.
pub fn first_hit(outline: &Outline, at: &Pose, from: &Vec2, to: &Vec2) -> Option<f64> {
    let scale = 1.0 / outline.extent().max(f64::MIN_POSITIVE);
    let origin = at.position;
    let vector = |v: Vec2| Vector::new(scale * v.x, scale * v.y);
    let ray = Ray::new(vector(from - origin), vector(to - from));
    let pieces = convex_pieces(outline).expect("polygons do not cross themselves");
    let hits = pieces.iter().filter_map(|piece| {
        let placed = Placed::new(piece, at, &origin, scale);
        placed.shape.cast_ray(&placed.pose, &ray, 1.0, true)
    });
    hits.min_by(f64::total_cmp)
}

/// Closest point of an outline to `point` (m, world); `None` for an outline without parts. Inside
/// of a concave polygon or a compound it is that of the deepest convex piece.
///
/// # Panics
/// When a polygon crosses itself.
pub fn closest_point(outline: &Outline, at: &Pose, point: &Vec2) -> Option<Closest> {
    let scale = 1.0 / outline.extent().max(f64::MIN_POSITIVE);
    let origin = at.position;
    let query = Vector::new(scale * (point.x - origin.x), scale * (point.y - origin.y));
    let pieces = convex_pieces(outline).expect("polygons do not cross themselves");
    let closest = pieces.iter().map(|piece| {
        let placed = Placed::new(piece, at, &origin, scale);
        let found = placed.shape.project_point(&placed.pose, query, false);
        let distance = (found.point - query).length() / scale;
        let is_inside = found.is_inside && !matches!(piece, ConvexPiece::Wall { .. });
        Closest { point: origin + Vec2::new(found.point.x, found.point.y) / scale, distance: if is_inside { -distance } else { distance } }
    });
    closest.min_by(|one, other| one.distance.total_cmp(&other.distance))
}

/// A convex piece in a frame that is scaled and shifted against the world.
struct Placed {
    pose: ParryPose,
    shape: Box<dyn Shape>,
}

impl Placed {
    /// The piece of a body at the pose `at`, relative to the point `origin` (m, world), `scale`
    /// (1/m) times as large.
    fn new(piece: &ConvexPiece, at: &Pose, origin: &Vec2, scale: f64) -> Self {
        let (offset, shape) = piece.shape(scale);
        let position = scale * (at.position - origin);
        let body = ParryPose::new(Vector::new(position.x, position.y), at.heading);
        let pose = ParryPose::from_parts(body.transform_point(offset), body.rotation);
        Self { pose, shape }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::OutlinePart;

    const HERE: Pose = Pose { position: Vec2::new(0.0, 0.0), heading: 0.0 };

    fn polygon(list: &[[f64; 2]]) -> Outline {
        Outline { parts: vec![OutlinePart::Polygon { corners: list.iter().copied().map(Vec2::from).collect() }] }
    }

    fn wall(list: &[[f64; 2]]) -> Outline {
        Outline { parts: vec![OutlinePart::Polyline { points: list.iter().copied().map(Vec2::from).collect() }] }
    }

    fn l_shape() -> Outline {
        polygon(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]])
    }

    #[test]
    fn the_way_out_is_along_the_normal_by_the_depth() {
        let (disc, post) = (Outline::disc(0.0122), Outline::disc(0.005));
        let way = |distance: f64| way_out(&disc, &HERE, &post, &Pose::new(0.6 * distance, 0.8 * distance, 1.0)).unwrap();
        assert_eq!(way(0.0172), Vec2::zeros());
        for distance in [0.0162, 0.0172, 0.1] {
            let found = gap(&disc, &HERE, &post, &Pose::new(0.6 * distance, 0.8 * distance, 1.0)).unwrap();
            assert!((found - (distance - 0.0172)).abs() < 1e-9, "{distance}: {found}");
        }
        assert!((way(0.0162) - 1e-3 * Vec2::new(0.6, 0.8)).norm() < 1e-12);
        // Out of the notch of an L on the shortest way, and not through its other arm.
        let found = way_out(&l_shape(), &HERE, &Outline::disc(0.1), &Pose::new(2.0, 1.05, 0.0)).unwrap();
        assert!((found - Vec2::new(0.0, 0.05)).norm() < 1e-7, "{found}");
        let notch = way_out(&l_shape(), &HERE, &Outline::disc(0.1), &Pose::new(1.05, 1.05, 0.0)).unwrap();
        // Two displacements, one out of each arm.
        assert!((notch - Vec2::new(0.05, 0.05)).norm() < 1e-7, "{notch}");
    }

    /// Two discs at the distance d overlap by r + s - d, and a disc and a wall by r - d.
    #[test]
    fn depths_are_those_of_the_plane() {
        let (disc, post) = (Outline::disc(0.0122), Outline::disc(0.005));
        let depth = |distance: f64| overlap_depth(&disc, &HERE, &post, &Pose::new(0.6 * distance, 0.8 * distance, 1.0));
        assert_eq!(depth(0.0172), None);
        assert!((depth(0.0162).unwrap() - 1e-3).abs() < 1e-12);
        let straight = wall(&[[-1.0, 0.0], [1.0, 0.0]]);
        let above = |height: f64| overlap_depth(&disc, &Pose::new(0.3, height, 0.0), &straight, &HERE);
        assert_eq!(above(0.0122), None);
        // The error of parry2d, about 5e-9 of the size.
        assert!((above(0.0112).unwrap() - 1e-3).abs() < 1e-9);
    }

    #[test]
    fn a_body_in_the_notch_of_an_l_does_not_overlap() {
        let disc = Outline::disc(0.5);
        assert_eq!(overlap_depth(&l_shape(), &HERE, &disc, &Pose::new(1.5, 1.5, 0.0)), None);
        let depth = overlap_depth(&l_shape(), &HERE, &disc, &Pose::new(2.0, 1.4, 0.0)).unwrap();
        assert!((depth - 0.1).abs() < 1e-8, "{depth}");
        // The same in a turned frame.
        let at = Pose::new(5.0, -7.0, 2.1);
        let turned = Pose { position: at.to_world(&Vec2::new(2.0, 1.4)), heading: 0.3 };
        assert!((overlap_depth(&l_shape(), &at, &disc, &turned).unwrap() - 0.1).abs() < 1e-8);
    }

    #[test]
    fn pieces_of_a_concave_polygon_have_its_area() {
        let comb = polygon(&[
            [0.0, 0.0],
            [5.0, 0.0],
            [5.0, 2.0],
            [4.0, 2.0],
            [4.0, 1.0],
            [3.0, 1.0],
            [3.0, 2.0],
            [2.0, 2.0],
            [2.0, 1.0],
            [0.0, 1.0],
        ]);
        for (outline, area) in [(l_shape(), 4.0), (comb, 7.0)] {
            let pieces = convex_pieces(&outline).unwrap();
            let areas = pieces.iter().map(|piece| match piece {
                ConvexPiece::Polygon { corners } => super::super::moments_of_polygon(corners).area,
                other => panic!("{other:?}"),
            });
            assert!((areas.sum::<f64>() - area).abs() < 1e-14);
            assert!(pieces.len() > 1);
            assert_eq!(overlap_of_parts(&outline), None);
        }
    }

    #[test]
    fn parts_that_share_an_edge_only_touch() {
        let square =
            |x: f64| OutlinePart::Polygon { corners: [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]].map(Vec2::from).to_vec() };
        assert_eq!(overlap_of_parts(&Outline { parts: vec![square(0.0), square(1.0)] }), None);
        let (one, other, depth) = overlap_of_parts(&Outline { parts: vec![square(0.0), square(5.0), square(0.9)] }).unwrap();
        assert!((one, other) == (0, 2) && (depth - 0.1).abs() < 1e-8, "{depth}");
    }

    #[test]
    fn sight_ends_at_the_first_edge() {
        let hit = |outline: &Outline, from: [f64; 2], to: [f64; 2]| first_hit(outline, &HERE, &from.into(), &to.into());
        assert!((hit(&Outline::disc(1.0), [-3.0, 0.0], [1.0, 0.0]).unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(hit(&Outline::disc(1.0), [-3.0, 1.1], [1.0, 1.1]), None);
        assert_eq!(hit(&Outline::disc(1.0), [-3.0, 0.0], [-1.1, 0.0]), None);
        assert_eq!(hit(&Outline::disc(1.0), [0.5, 0.0], [3.0, 0.0]), Some(0.0));
        assert!((hit(&l_shape(), [2.0, 3.0], [2.0, -1.0]).unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(hit(&l_shape(), [1.5, 1.5], [2.5, 1.2]), None);
        let straight = wall(&[[0.0, -1.0], [0.0, 1.0]]);
        assert!((hit(&straight, [-1.0, 0.0], [3.0, 0.0]).unwrap() - 0.25).abs() < 1e-12);
        assert_eq!(hit(&straight, [-1.0, 1.5], [3.0, 1.5]), None);
    }

    #[test]
    fn the_closest_point_has_a_signed_distance() {
        let at = Pose::new(2.0, 0.0, 1.0);
        let found = closest_point(&Outline::disc(0.5), &at, &Vec2::new(0.0, 0.0)).unwrap();
        assert!((found.point - Vec2::new(1.5, 0.0)).norm() < 1e-12 && (found.distance - 1.5).abs() < 1e-12);
        let inside = closest_point(&l_shape(), &HERE, &Vec2::new(2.0, 0.2)).unwrap();
        assert!((inside.distance + 0.2).abs() < 1e-8 && (inside.point - Vec2::new(2.0, 0.0)).norm() < 1e-8, "{inside:?}");
        let beside = closest_point(&wall(&[[0.0, 0.0], [1.0, 0.0]]), &HERE, &Vec2::new(2.0, 0.0)).unwrap();
        assert!((beside.distance - 1.0).abs() < 1e-12);
        assert_eq!(closest_point(&Outline::default(), &HERE, &Vec2::new(0.0, 0.0)), None);
    }
}
