//! Corners that meet corners: which pairs of features touch there, and which hide each other.
//!
//! What the origin of a load may not enter, at its heading, is the Minkowski sum S = O - R L of an
//! obstacle O and the reflected load. Two features touch where they make a face of S. With N the
//! normal from obstacle to load, e_i the directions of the edges that leave a corner of the load,
//! and f_j those that leave a corner of the obstacle, the line with the normal N through both
//! corners is a face of S if and only if N lies in both normal cones (the Gauss map):
//!
//! ```text
//! e_i.N >= 0    f_j.N <= 0    for all i, j
//! ```
//!
//! Inside an edge this holds of itself for bodies that do not overlap. It decides at the end of an
//! edge, where corner meets corner. Past the end of a wall, the front of a load is no face.
//!
//! Two convex bodies are apart where at least one face of S has no negative gap. Where two faces
//! meet in a corner of S, they are alternatives: the load is held by one of them, and the others
//! are covered by it. At the joint of two flush blocks the front of a load meets a face of the next
//! block, which the top of that block covers. Different convex parts demand their faces each by
//! themselves, so that a load in an enclosed corner touches both sides of it. Where a load crosses
//! all faces of a corner within a step, it touches the one that it crosses last. A corner of S
//! holds nothing: between the normals of its faces nothing drives a load back.

use smallvec::SmallVec;

use super::features::Corner;
use super::surroundings::{Pair, PairKind, Surroundings};
use crate::backend::numerics::{ALIKE, ALONG, CONE_ROUNDING, CORNER_ROUNDING, DEEP, EDGE_END, FLUSH_OVERLAP};
use crate::backend::springs::Place;
use crate::math::{Mat2, Vec2, perpendicular};

/// What a normal is for two corners that meet.
enum Meeting {
    Face,
    NoFace,
    /// The edge of the obstacle is enclosed there by the next one, which is a face of its own.
    Enclosed,
}

/// A corner of the load that meets one of an obstacle.
struct Vertex<'a> {
    corner: &'a Corner,
    other: &'a Corner,
    /// Unit vector along the edge of the pair, away from where the corners meet.
    along: Vec2,
}

/// A face that may cover another one: its normal in the frame of the body that it belongs to.
enum Face {
    OfObstacle(Vec2),
    OfLoad(Vec2),
}

impl Face {
    fn normal(&self, turn: &Mat2) -> Vec2 {
        match self {
            Face::OfObstacle(normal) => *normal,
            Face::OfLoad(normal) => turn * normal,
        }
    }
}

impl Vertex<'_> {
    /// Whether a normal lies in both normal cones, but for this sine of an angle (1) to an edge
    /// that lies along that of the pair.
    fn is_in_cones(&self, normal: &Vec2, turn: &Mat2, along: f64) -> [bool; 2] {
        let allowed = |edge: &Vec2| if edge.dot(&self.along) > 0.0 { along } else { CONE_ROUNDING };
        let of_load = self.corner.edges.iter().map(|edge| turn * edge).all(|edge| edge.dot(normal) >= -allowed(&edge));
        [of_load, self.other.edges.iter().all(|edge| edge.dot(normal) <= allowed(edge))]
    }

    fn meeting(&self, normal: &Vec2, turn: &Mat2, kind: PairKind) -> Meeting {
        match (self.is_in_cones(normal, turn, ALONG), kind) {
            ([true, true], _) => Meeting::Face,
            ([_, false], PairKind::PointOnLine { .. }) if self.other.edges.len() == 2 => Meeting::Enclosed,
            _ => Meeting::NoFace,
        }
    }

    /// Faces of the sum that meet here, for a load with this `turn`, other than the one with this
    /// normal.
    fn others(&self, normal: &Vec2, turn: &Mat2) -> SmallVec<[Face; 4]> {
        let both = |edge: &Vec2| [perpendicular(edge), -perpendicular(edge)];
        let of_obstacle = self.other.edges.iter().flat_map(both).map(Face::OfObstacle);
        let of_load = self.corner.edges.iter().flat_map(both).map(Face::OfLoad);
        let is_other = |face: &Face| {
            let at = face.normal(turn);
            at.dot(normal) < ALIKE && self.is_in_cones(&at, turn, CONE_ROUNDING) == [true; 2]
        };
        of_obstacle.chain(of_load).filter(is_other).collect()
    }

    /// Gap at a face (m) for a load at this place.
    fn gap(&self, face: &Face, at: &Place) -> f64 {
        face.normal(&at.turn).dot(&(at.pose.position + at.turn * self.corner.at - self.other.at))
    }
}

impl Surroundings {
    /// Overlap that is none (m) for a load at this place in an obstacle's frame.
    pub fn flush(&self, at: &Place) -> f64 {
        FLUSH_OVERLAP * self.radius + CORNER_ROUNDING * at.pose.position.norm()
    }

    /// Distance by which the features of a pair are from touching each other along their edges (m),
    /// for a load that has moved between two places in the obstacle's frame. They touch at the
    /// second one where the gap is closed and this is not positive. It is the distance by which
    /// they lie beside each other, or the load's radius where they are no face, or where another
    /// face covers them.
    pub fn beyond(&self, pair: &Pair, [before, at]: [&Place; 2]) -> f64 {
        let (beside, flush) = (self.beside(&pair.key, at), self.flush(at));
        let is_at_end = beside >= -EDGE_END * self.radius;
        if beside > flush || pair.key.kind == PairKind::PointOnPoint || !is_at_end && pair.features.gap(at) >= -flush {
            return beside;
        }
        let Some(vertex) = self.vertex(pair, at) else { return beside };
        let normal = pair.features.normal(at);
        match vertex.meeting(&normal, &at.turn, pair.key.kind) {
            Meeting::Enclosed => beside,
            Meeting::NoFace => {
                if is_at_end {
                    self.radius
                } else {
                    beside
                }
            }
            Meeting::Face if pair.is_held => beside,
            Meeting::Face => {
                let own = [before, at].map(|at| pair.features.gap(at));
                let others = vertex.others(&normal, &at.turn);
                let is_covered =
                    others.iter().any(|face| covers([before, at].map(|at| vertex.gap(face, at)), own, [flush, DEEP * self.radius]));
                if is_covered { self.radius } else { beside }
            }
        }
    }

    /// The corners that meet where the features of a pair end; `None` for a disc, and where the
    /// edge ends in no corner.
    fn vertex(&self, pair: &Pair, at: &Place) -> Option<Vertex<'_>> {
        let (load, body) = (&self.load, &self.bodies[pair.key.obstacle].features);
        let (of_load, of_obstacle) = (pair.key.of_load, pair.key.of_obstacle);
        let (corner, other, along) = match pair.key.kind {
            PairKind::PointOnPoint => return None,
            PairKind::PointOnLine { .. } => {
                let point = at.pose.position + at.turn * load.corners[of_load].at;
                let (other, along) = body.edges[of_obstacle].corner_near(&point)?;
                (&load.corners[of_load], &body.corners[other], along)
            }
            PairKind::LineOnPoint => {
                let point = at.turn.tr_mul(&(body.corners[of_obstacle].at - at.pose.position));
                let (corner, along) = load.edges[of_load].corner_near(&point)?;
                (&load.corners[corner], &body.corners[of_obstacle], at.turn * along)
            }
        };
        (corner.rounding == 0.0 && other.rounding == 0.0).then_some(Vertex { corner, other, along })
    }
}

/// Whether one face covers another, by the gaps (m) of both before and behind a displacement: it is
/// not crossed by more than the overlap that is none (m), or it is crossed later. A face that was
/// closed is crossed where it is `deep` (m) inside: trial poses of a load that slides along it err
/// by more than rounding.
fn covers(face: [f64; 2], covered: [f64; 2], [flush, deep]: [f64; 2]) -> bool {
    let is_apart = |[before, behind]: [f64; 2]| behind >= if before.abs() <= flush { -deep } else { -flush };
    if is_apart(face) || is_apart(covered) {
        return is_apart(face);
    }
    let crossed = |[before, behind]: [f64; 2]| if before < -flush { -1.0 } else { before.max(0.0) / (before.max(0.0) - behind) };
    let (one, other) = (crossed(face), crossed(covered));
    one > other || one == other && face[1] > covered[1]
}

#[cfg(test)]
mod tests {
    use super::super::gate::Gate;
    use super::*;
    use crate::math::{Pose, RandomStreams, Stream, direction};
    use crate::model::{Ground, Load, Obstacle, ObstaclePath, Outline, OutlinePart, System, World};

    /// Convex polygon with corners at random angles on an ellipse with half axes up to 1 m, about
    /// its origin.
    fn polygon(draw: &mut impl FnMut() -> f64) -> Outline {
        let (n, axes) = (3 + (6.0 * draw()) as usize, Vec2::new(0.3 + 0.7 * draw(), 0.3 + 0.7 * draw()));
        let step = std::f64::consts::TAU / n as f64;
        let corners = (0..n).map(|k| axes.component_mul(&direction(step * (k as f64 + 0.8 * draw())))).collect();
        Outline { parts: vec![OutlinePart::Polygon { corners }] }
    }

    fn system(outline: Outline, obstacle: Outline) -> System {
        let path = ObstaclePath::fixed(Pose::new(0.0, 0.0, 0.0));
        let obstacle = Obstacle { name: String::new(), outline: obstacle, friction_coefficient: 0.0, restitution: 0.0, path };
        System {
            load: Load { mass: 1.0, radius: 1.0, inertia: 1.0 },
            ground: Ground { friction_coefficient: 1.0, supports: Vec::new() },
            springs: Vec::new(),
            world: World { outline, obstacles: vec![obstacle] },
        }
    }

    /// How far a load goes in (m). Corners are farther apart, and edges longer.
    const DEPTH: f64 = 1e-5;

    /// Whether some features touch with a negative gap, of those that were near before.
    fn overlaps(system: &System, before: &Place, at: &Place) -> bool {
        let (mut surroundings, mut pairs) = (Surroundings::new(system), Vec::new());
        surroundings.pairs(system, before, 0.0, 10.0 * DEPTH, &mut pairs);
        pairs.iter().any(|pair| pair.features.gap(at) < 0.0 && surroundings.beyond(pair, [before, at]) <= 0.0)
    }

    /// A convex load that comes straight to a convex obstacle, at any heading, touches it by its
    /// features where the pieces of both begin to overlap, and not before.
    #[test]
    fn features_touch_where_pieces_do() {
        let mut n_touched = 0;
        for seed in 0..2000 {
            let (streams, mut count) = (RandomStreams::new(seed), 0);
            let mut draw = || {
                count += 1;
                streams.uniform(Stream::Scene, 0, count)
            };
            let system = system(polygon(&mut draw), polygon(&mut draw));
            let (gate, heading) = (Gate::of(&system), std::f64::consts::TAU * draw());
            let (start, aim) = (3.0 * direction(std::f64::consts::TAU * draw()), 0.2 * Vec2::new(draw(), draw()));
            let place = |share: f64| {
                let position = start + share * (aim - start);
                Place::of(&Pose { position, heading })
            };
            let (mut apart, mut inside) = (0.0, 1.0);
            if gate.depth(0, &place(inside)) == 0.0 {
                continue;
            }
            while inside - apart > 1e-15 {
                let middle = 0.5 * (apart + inside);
                *(if gate.depth(0, &place(middle)) > 0.0 { &mut inside } else { &mut apart }) = middle;
            }
            let step = DEPTH / (aim - start).norm();
            let [earlier, before, touching] = [-3.0, -1.0, 1.0].map(|n| place(inside + n * step));
            assert!(!overlaps(&system, &earlier, &before), "{seed}: before it touches");
            assert!(overlaps(&system, &before, &touching), "{seed}: where it touches");
            n_touched += 1;
        }
        assert!(n_touched > 1800, "{n_touched}");
    }

    /// A face that is not crossed covers one that is, and of two that are crossed the later one
    /// counts. One that was crossed before the displacement covers nothing.
    #[test]
    fn the_face_that_is_crossed_last_counts() {
        const FLUSH: [f64; 2] = [1e-9, 1e-6];
        for (face, covered, expected) in [
            ([0.0, 0.0], [0.1, -0.2], true),
            ([0.0, -1e-7], [0.1, -0.2], true),
            ([0.0, -1e-5], [0.1, -0.2], false),
            ([0.0, -1e-10], [0.1, -0.2], true),
            ([-1e-6, -1e-6], [0.1, -0.2], false),
            ([0.2, -0.1], [0.1, -0.2], true),
            ([0.1, -0.2], [0.2, -0.1], false),
            ([0.1, 0.2], [-0.1, -0.1], true),
            ([-0.1, -0.1], [0.1, 0.2], false),
            // Both began inside: the nearer face counts.
            ([-0.1, -0.1], [-0.2, -0.2], true),
            ([-0.2, -0.2], [-0.1, -0.1], false),
        ] {
            assert_eq!(covers(face, covered, FLUSH), expected, "{face:?} {covered:?}");
        }
    }
}
