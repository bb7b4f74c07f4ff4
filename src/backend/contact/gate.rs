//! Whether a load lies inside an obstacle, told without the features by which steps are made.
//!
//! Both outlines are unions of convex pieces. Two pieces are apart where one face of their
//! Minkowski sum has a gap:
//!
//! ```text
//! separation = max over faces of the least distance of a corner of the other piece
//! ```
//!
//! A face is an edge of either piece or, for a disc, the line from its centre to the nearest corner
//! of the other piece (the separating axis theorem). Steps decide by pairs of corners and edges
//! (`corners`); that they agree with this is asked of every pose that is accepted.

use crate::backend::numerics::{GATE_ROUNDING, INSIDE};
use crate::backend::springs::Place;
use crate::math::{Vec2, perpendicular};
use crate::model::geometry::{ConvexPiece, convex_pieces};
use crate::model::{Outline, System};

/// A convex piece with its faces.
#[derive(Clone, Debug)]
struct Piece {
    corners: Vec<Vec2>,
    /// Radius of a disc (m); zero for others.
    rounding: f64,
    /// Outward unit normal of each edge and its distance from the origin (m).
    faces: Vec<(Vec2, f64)>,
    /// Circle about the piece (m).
    centre: Vec2,
    radius: f64,
}

/// Pieces of an outline.
#[derive(Clone, Debug)]
struct Body {
    pieces: Vec<Piece>,
    extent: f64,
}

/// The outlines of a load and of all obstacles, as pieces.
#[derive(Clone, Debug)]
pub struct Gate {
    load: Body,
    obstacles: Vec<Body>,
}

impl Piece {
    fn new(piece: &ConvexPiece) -> Self {
        let (corners, rounding) = match piece {
            ConvexPiece::Disc { centre, radius } => (vec![*centre], *radius),
            ConvexPiece::Polygon { corners } => (corners.clone(), 0.0),
            ConvexPiece::Wall { ends } => (ends.to_vec(), 0.0),
        };
        // The two edges of a wall are its two sides.
        let n = if corners.len() == 1 { 0 } else { corners.len() };
        let face = |at: usize| {
            let (from, to) = (corners[at], corners[(at + 1) % n]);
            let normal = -perpendicular(&(to - from)).normalize();
            (normal, normal.dot(&from))
        };
        let faces = (0..n).map(face).collect();
        let centre = corners.iter().sum::<Vec2>() / corners.len() as f64;
        let radius = corners.iter().map(|corner| (corner - centre).norm()).fold(0.0, f64::max) + rounding;
        Self { corners, rounding, faces, centre, radius }
    }

    /// Largest gap of the faces of this piece and another one, whose points `seen` moves to the
    /// frame of this one (m); the first one that is not less than `enough` (m).
    fn widest_gap(&self, other: &Self, enough: f64, seen: impl Fn(&Vec2) -> Vec2) -> f64 {
        let reach = self.rounding + other.rounding;
        let mut widest = f64::NEG_INFINITY;
        for (normal, offset) in &self.faces {
            let least = other.corners.iter().map(|corner| normal.dot(&seen(corner))).fold(f64::INFINITY, f64::min);
            widest = widest.max(least - offset - reach);
            if widest >= enough {
                return widest;
            }
        }
        let [centre] = self.corners[..] else { return widest };
        let arms = || other.corners.iter().map(|corner| seen(corner) - centre);
        let nearest = arms().min_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
        let along = nearest.and_then(|arm| arm.try_normalize(0.0)).unwrap_or_else(Vec2::x);
        widest.max(arms().map(|arm| along.dot(&arm)).fold(f64::INFINITY, f64::min) - reach)
    }

    /// Separation from a piece of the load at this place (m); an upper bound where it is positive.
    fn separation(&self, load: &Self, at: &Place, enough: f64) -> f64 {
        let to_obstacle = |point: &Vec2| at.pose.position + at.turn * point;
        let apart = (to_obstacle(&load.centre) - self.centre).norm() - self.radius - load.radius;
        if apart >= enough {
            return apart;
        }
        let of_obstacle = self.widest_gap(load, enough, to_obstacle);
        if of_obstacle >= enough {
            return of_obstacle;
        }
        of_obstacle.max(load.widest_gap(self, enough, |point| at.turn.tr_mul(&(point - at.pose.position))))
    }
}

impl Body {
    fn of(outline: &Outline) -> Self {
        // A scenario has no polygon that crosses itself.
        let pieces = convex_pieces(outline).unwrap_or_default().iter().map(Piece::new).collect();
        Self { pieces, extent: outline.extent() }
    }
}

impl Gate {
    pub fn of(system: &System) -> Self {
        let obstacles = system.world.obstacles.iter().map(|obstacle| Body::of(&obstacle.outline)).collect();
        Self { load: Body::of(&system.world.outline), obstacles }
    }

    /// Depth by which a load at `at`, in the frame of an obstacle, lies inside of it (m); zero for
    /// what is rounding.
    pub fn depth(&self, obstacle: usize, at: &Place) -> f64 {
        let body = &self.obstacles[obstacle];
        let allowed = INSIDE * self.load.extent + GATE_ROUNDING * (at.pose.position.norm() + body.extent);
        let pairs = body.pieces.iter().flat_map(|piece| self.load.pieces.iter().map(move |load| (piece, load)));
        let least = pairs.map(|(piece, load)| piece.separation(load, at, -allowed)).fold(0.0, f64::min);
        if least < -allowed { -least } else { 0.0 }
    }

    /// Whether the load at a place seen from an obstacle is nearer to it than `distance` (m).
    pub fn is_within(&self, obstacle: usize, at: &Place, distance: f64) -> bool {
        let is_near = |piece: &Piece| self.load.pieces.iter().any(|load| piece.separation(load, at, distance) < distance);
        self.obstacles[obstacle].pieces.iter().any(is_near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pose;
    use crate::model::OutlinePart;

    fn depth(load: OutlinePart, obstacle: OutlinePart, at: Pose) -> f64 {
        let [load, body] = [load, obstacle].map(|part| Body::of(&Outline { parts: vec![part] }));
        Gate { load, obstacles: vec![body] }.depth(0, &Place::of(&at))
    }

    fn square() -> OutlinePart {
        OutlinePart::Polygon { corners: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Vec2::from).to_vec() }
    }

    /// Depths of squares, discs and walls, as far as they overlap along the shortest way out.
    #[test]
    fn depth_is_the_shortest_way_out() {
        let disc = |radius: f64| OutlinePart::Disc { centre: Vec2::zeros(), radius };
        let wall = || OutlinePart::Polyline { points: [[-5.0, 0.0], [5.0, 0.0]].map(Vec2::from).to_vec() };
        let half = 0.5 * std::f64::consts::SQRT_2;
        for (load, obstacle, at, want) in [
            (square(), square(), Pose::new(1.9, 1.5, 0.0), 0.1),
            (square(), square(), Pose::new(2.0, 0.3, 0.0), 0.0),
            (square(), square(), Pose::new(2.0 - 1e-10, 0.3, 0.0), 0.0),
            (square(), square(), Pose::new(2.4, 0.0, std::f64::consts::FRAC_PI_4), 2.0 * half - 1.4),
            (disc(1.0), square(), Pose::new(1.0 + 0.9 * half, 1.0 + 0.9 * half, 0.0), 0.1),
            (disc(1.0), disc(0.5), Pose::new(0.0, 1.4, 0.0), 0.1),
            (disc(1.0), wall(), Pose::new(0.0, 0.9, 0.0), 0.1),
            (disc(1.0), wall(), Pose::new(5.9, 0.0, 0.0), 0.1),
            (square(), wall(), Pose::new(2.0, -0.7, 0.0), 0.3),
            (square(), wall(), Pose::new(6.5, 0.0, 0.0), 0.0),
        ] {
            let found = depth(load.clone(), obstacle.clone(), at);
            // Some roundings of lengths of 5 m.
            assert!((found - want).abs() < 1e-14, "{load:?} {obstacle:?} {at:?}: {found} for {want}");
        }
    }

    /// A polygon that is not convex is cut into pieces: a load in its notch lies outside.
    #[test]
    fn a_notch_is_outside() {
        let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 3.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        let notched = || OutlinePart::Polygon { corners: corners.map(Vec2::from).to_vec() };
        let disc = || OutlinePart::Disc { centre: Vec2::zeros(), radius: 0.5 };
        assert_eq!(depth(disc(), notched(), Pose::new(1.5, 1.5, 0.0)), 0.0);
        assert!((depth(disc(), notched(), Pose::new(1.5, 1.4, 0.0)) - 0.1).abs() < 1e-14);
    }
}
