//! Corners and edges by which outlines touch.

use smallvec::SmallVec;

use crate::backend::numerics::{PIECE, STRAIGHT_EDGE};
use crate::math::{Vec2, perpendicular};
use crate::model::{Outline, OutlinePart};

/// A convex corner, or the centre of a disc.
#[derive(Clone, Debug, PartialEq)]
pub struct Corner {
    /// Position in the body's frame (m).
    pub at: Vec2,
    /// Radius of the disc about it (m); zero for a sharp corner.
    pub rounding: f64,
    /// Unit vectors along the edges that end here, away from it.
    pub edges: SmallVec<[Vec2; 2]>,
    /// Unit vector between them, into the body; zero for a disc.
    pub inwards: Vec2,
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
    /// Unit vectors along the edges that begin at its ends, away from them, where both can be
    /// touched from two sides.
    pub neighbours: [Option<Vec2>; 2],
    /// Length by which it goes on behind each end (m), on its left, or with a minus on its right:
    /// there the next edge encloses a corner, and what passes through it passes through both.
    pub behind: [f64; 2],
    /// Indices of the corners at its ends; `None` where the next edge encloses the end, or goes
    /// straight on.
    pub corners: [Option<usize>; 2],
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
        Self {
            from: *from,
            along: (to - from) / length,
            length,
            has_two_sides,
            neighbours: [None; 2],
            behind: [0.0; 2],
            corners: [None; 2],
        }
    }

    /// Outward normal of an edge that is touched from outside.
    pub fn normal(&self) -> Vec2 {
        -perpendicular(&self.along)
    }

    /// Whether a point lies on the left of an edge with two sides. Beyond an end where another edge
    /// begins, the left is what the two edges enclose there.
    pub fn has_on_left(&self, point: &Vec2) -> bool {
        let offset = point - self.from;
        let at = self.along.dot(&offset);
        match self.neighbours {
            [Some(next), _] if at < 0.0 => is_between(&offset, &self.along, &next),
            [_, Some(next)] if at > self.length => is_between(&(offset - self.length * self.along), &next, &-self.along),
            _ => self.along.perp(&offset) > 0.0,
        }
    }

    /// As [`Self::beyond`], with what goes on behind the ends on one side.
    pub fn beyond_on(&self, is_left: bool, point: &Vec2) -> f64 {
        let at = self.along.dot(&(point - self.from));
        let [before, after] = self.behind.map(|length| if is_left { length } else { -length }.max(0.0));
        (-at - before).max(at - self.length - after)
    }

    /// Index of the corner at the end that is nearer to a point, and unit vector along the edge
    /// away from it; `None` for an end without a corner.
    pub fn corner_near(&self, point: &Vec2) -> Option<(usize, Vec2)> {
        let is_behind_middle = self.along.dot(&(point - self.from)) > 0.5 * self.length;
        if is_behind_middle { Some((self.corners[1]?, -self.along)) } else { Some((self.corners[0]?, self.along)) }
    }

    /// Whether the edge ends at a point.
    pub fn ends_at(&self, point: &Vec2) -> bool {
        let offset = point - self.from;
        offset.norm().min((offset - self.length * self.along).norm()) <= STRAIGHT_EDGE * self.length
    }

    /// Distance by which a point lies beyond the ends of the edge, along it (m); negative between
    /// them.
    pub fn beyond(&self, point: &Vec2) -> f64 {
        let at = self.along.dot(&(point - self.from));
        (-at).max(at - self.length)
    }

    pub fn end(&self) -> Vec2 {
        self.from + self.length * self.along
    }

    /// Whether an edge with these ends crosses this one, all ends being farther than this from the
    /// other's line (m).
    pub fn crosses(&self, ends: &[Vec2; 2], least: f64) -> bool {
        let way = (ends[1] - ends[0]).normalize();
        let [one, other] = ends.map(|end| self.side(&end));
        let [from, to] = [self.from, self.end()].map(|end| way.perp(&(end - ends[0])));
        let are_apart = |a: f64, b: f64| a.min(b) < -least && a.max(b) > least;
        are_apart(one, other) && are_apart(from, to)
    }

    /// Whether a corner lies on this edge, and the edge lies between the two that begin there in
    /// these directions, by more than `least` (m) within a `reach` (m).
    pub fn enters(&self, corner: &Vec2, ways: &[Vec2; 2], [least, reach]: [f64; 2]) -> bool {
        let [one, other] = if ways[0].perp(&ways[1]) > 0.0 { *ways } else { [ways[1], ways[0]] };
        let at = self.along.dot(&(corner - self.from));
        let depth = |along: &Vec2, length: f64| length.min(reach) * one.perp(along).min(along.perp(&other));
        self.distance(corner) <= least && (depth(&self.along, self.length - at) > least || depth(&-self.along, at) > least)
    }

    /// Distance of a point from the line (m), positive on the left.
    fn side(&self, point: &Vec2) -> f64 {
        self.along.perp(&(point - self.from))
    }

    /// Distance of a point from the edge (m).
    pub fn distance(&self, point: &Vec2) -> f64 {
        self.beyond(point).max(0.0).hypot(self.side(point))
    }
}

/// Whether a direction lies between two others, counter-clockwise from the first to the second.
fn is_between(direction: &Vec2, first: &Vec2, second: &Vec2) -> bool {
    let (behind_first, before_second) = (first.perp(direction) > 0.0, direction.perp(second) > 0.0);
    if first.perp(second) >= 0.0 { behind_first && before_second } else { behind_first || before_second }
}

impl Corner {
    fn new(at: &Vec2, edges: SmallVec<[Vec2; 2]>) -> Self {
        let inwards = edges.iter().sum::<Vec2>().try_normalize(0.0).unwrap_or_default();
        Self { at: *at, rounding: 0.0, edges, inwards }
    }

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
                    features.corners.push(Corner { rounding: *radius, ..Corner::new(centre, SmallVec::new()) });
                }
                OutlinePart::Polygon { corners } => features.add_polygon(corners),
                OutlinePart::Polyline { points } => features.add_polyline(points),
            }
        }
        features
    }

    fn add_polygon(&mut self, corners: &[Vec2]) {
        let (n, first) = (corners.len(), self.edges.len());
        let mut of_points = vec![None; n];
        for (k, at) in corners.iter().enumerate() {
            let edge = Edge::between(at, &corners[(k + 1) % n], false);
            let before = (corners[(k + n - 1) % n] - at).normalize();
            // The interior lies on the left, so that a convex corner turns left.
            if (-before).perp(&edge.along) > STRAIGHT_EDGE {
                of_points[k] = Some(self.corners.len());
                self.corners.push(Corner::new(at, SmallVec::from_slice(&[before, edge.along])));
            }
            self.edges.push(edge);
        }
        for k in 0..n {
            self.edges[first + k].corners = [of_points[k], of_points[(k + 1) % n]];
            self.join(first + k, first + (k + 1) % n);
        }
    }

    /// Joins two edges at the end of the first one.
    fn join(&mut self, one: usize, other: usize) {
        let [first, second] = [self.edges[one], self.edges[other]];
        let turn = first.along.perp(&second.along);
        if turn.abs() > STRAIGHT_EDGE {
            let behind = PIECE * first.length.min(second.length) * turn.signum();
            self.edges[one].behind[1] = behind;
            self.edges[other].behind[0] = behind;
        }
    }

    fn add_polyline(&mut self, points: &[Vec2]) {
        let mut of_points = vec![None; points.len()];
        for (k, at) in points.iter().enumerate() {
            let before = k.checked_sub(1).map(|k| (points[k] - at).normalize());
            let after = points.get(k + 1).map(|next| (next - at).normalize());
            let is_straight =
                before.zip(after).is_some_and(|(before, after)| before.perp(&after).abs() <= STRAIGHT_EDGE && before.dot(&after) < 0.0);
            if !is_straight {
                of_points[k] = Some(self.corners.len());
                self.corners.push(Corner::new(at, before.into_iter().chain(after).collect()));
            }
        }
        let first = self.edges.len();
        let ends = points.windows(2).zip(of_points.windows(2));
        self.edges
            .extend(ends.map(|(ends, corners)| Edge { corners: [corners[0], corners[1]], ..Edge::between(&ends[0], &ends[1], true) }));
        for at in first + 1..self.edges.len() {
            let [one, other] = [self.edges[at - 1].along, self.edges[at].along];
            self.edges[at - 1].neighbours[1] = Some(other);
            self.edges[at].neighbours[0] = Some(-one);
            self.join(at - 1, at);
        }
    }

    /// Centre (m) and radius (m) of a circle about all features.
    pub fn bounding_circle(&self) -> (Vec2, f64) {
        let ends = self.edges.iter().flat_map(|edge| [edge.from, edge.end()]).map(|end| (end, 0.0));
        let extents: Vec<(Vec2, f64)> = self.corners.iter().map(|corner| (corner.at, corner.rounding)).chain(ends).collect();
        let Some((first, _)) = extents.first() else { return (Vec2::zeros(), 0.0) };
        let (low, high) = extents.iter().fold((*first, *first), |(low, high), (at, rounding)| {
            let reach = Vec2::repeat(*rounding);
            (low.inf(&(at - reach)), high.sup(&(at + reach)))
        });
        let centre = 0.5 * (low + high);
        (centre, extents.iter().map(|(at, rounding)| (at - centre).norm() + rounding).fold(0.0, f64::max))
    }

    /// Lengths of edges and diameters of discs (m).
    pub fn sizes(&self) -> impl Iterator<Item = f64> + '_ {
        let discs = self.corners.iter().filter(|corner| corner.rounding > 0.0).map(|corner| 2.0 * corner.rounding);
        self.edges.iter().map(|edge| edge.length).chain(discs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::direction;

    fn features(part: OutlinePart) -> Features {
        Features::of(&Outline { parts: vec![part] })
    }

    /// Beyond the bend of a line the left of both edges is the corner that they enclose.
    #[test]
    fn a_bent_line_has_its_left_where_it_bends_to() {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.5, 0.5]].map(Vec2::from);
        let edges = features(OutlinePart::Polyline { points: points.to_vec() }).edges;
        // Between the second edge and the line of the first one, and above both.
        let (outside, inside) = (Vec2::new(1.2, 0.1), Vec2::new(1.1, 0.2));
        for edge in &edges {
            assert!(!edge.has_on_left(&outside) && edge.has_on_left(&inside), "{edge:?}");
        }
        // Below the second edge, behind its beginning, and right of the first one.
        assert!(edges.iter().all(|edge| !edge.has_on_left(&Vec2::new(0.8, -0.05))));
        // Nothing begins where the line ends: the edge's own line has two sides there.
        assert!(edges[1].has_on_left(&Vec2::new(1.6, 0.7)) && !edges[1].has_on_left(&Vec2::new(1.7, 0.6)));
    }

    /// A point that has passed through an enclosed corner lies behind both edges, and beside none.
    #[test]
    fn edges_go_on_behind_the_corner_that_they_enclose() {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]].map(Vec2::from);
        let edges = features(OutlinePart::Polygon { corners: corners.to_vec() }).edges;
        let behind = Vec2::new(0.9, 0.9);
        for edge in &edges[2..4] {
            assert!(edge.beyond(&behind) > 0.09 && edge.beyond_on(false, &behind) < 0.0, "{edge:?}");
            assert_eq!(edge.beyond_on(true, &behind), edge.beyond(&behind));
        }
        // Behind other corners they do not.
        let outside = Vec2::new(2.1, 1.1);
        assert_eq!(edges[1].beyond_on(false, &outside), edges[1].beyond(&outside));
    }

    /// An edge that ends at a corner or passes through it enters what the corner encloses, by the
    /// depth of its end. One along a side of it or along the outside does not, nor one beside it.
    #[test]
    fn an_edge_enters_a_body_through_its_corner() {
        let ways = [direction(0.6), direction(-0.6)];
        let enters = |from: [f64; 2], to: [f64; 2], least: f64| {
            let edge = features(OutlinePart::Polyline { points: vec![from.into(), to.into()] }).edges[0];
            let [one, other] = [ways, [ways[1], ways[0]]].map(|ways| edge.enters(&Vec2::zeros(), &ways, [least, 1.0]));
            assert_eq!(one, other);
            one
        };
        let [x, y] = [0.6f64.cos(), 0.6f64.sin()];
        for (from, to, depth) in [
            ([-1.0, 0.0], [0.25, 0.0], 0.25 * y),
            ([0.0, 0.0], [0.25, 0.0], 0.25 * y),
            ([-1.0, 0.0], [2.0, 0.0], y),
            ([0.0, -1.0], [0.0, 1.0], 0.0),
            ([-x, -y], [x, y], 0.0),
            ([-1.0, 0.0], [-0.01, 0.0], 0.0),
            ([0.5, 0.0], [1.5, 0.0], 0.0),
            ([-1.0, 1.0], [1.0, 1.0], 0.0),
        ] {
            for (a, b) in [(from, to), (to, from)] {
                assert_eq!(enters(a, b, 1e-8), depth > 0.0, "{a:?} {b:?}");
                assert!(depth == 0.0 || enters(a, b, 0.999 * depth) && !enters(a, b, 1.001 * depth), "{a:?} {b:?}");
            }
        }
    }
}
