//! Which features of the load and of the obstacles may touch, and how far apart the bodies are.

use serde::{Deserialize, Serialize};

use super::features::{Corner, Edge, Features};
use super::gap::FeaturePair;
use super::solve::SideMode;
use crate::backend::numerics::{DEEP, FLUSH_NORMAL, NEAR_MARGIN};
use crate::backend::springs::Place;
use crate::math::{Mat2, Pose, Vec2, rotation};
use crate::model::{Obstacle, System};

/// Features of a pair by their indices, by which contacts are recognised from step to step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PairKey {
    pub obstacle: usize,
    pub kind: PairKind,
    /// Index of the load's corner, or of its edge for `LineOnPoint`.
    pub of_load: usize,
    /// Index of the obstacle's edge for `PointOnLine`, or of its corner.
    pub of_obstacle: usize,
}

/// Kind of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PairKind {
    /// The load touches the side of an edge to whose left, or right, it lies.
    PointOnLine {
        is_left: bool,
    },
    PointOnPoint,
    LineOnPoint,
}

/// A pair of features with what does not change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    pub key: PairKey,
    pub features: FeaturePair,
    /// Coefficient of side friction (1).
    pub friction_coefficient: f64,
    /// Coefficient of restitution (1).
    pub restitution: f64,
    /// Whether it was closed when a step began.
    pub is_held: bool,
}

impl Pair {
    fn of(key: PairKey, features: FeaturePair, obstacle: &Obstacle) -> Self {
        Self { key, features, friction_coefficient: obstacle.friction_coefficient, restitution: obstacle.restitution, is_held: false }
    }

    /// The mode in which a contact is named: without friction nothing tells sticking from sliding.
    pub fn mode(&self, mode: SideMode) -> SideMode {
        if self.friction_coefficient == 0.0 && mode != SideMode::Open { SideMode::Slide { forward: true } } else { mode }
    }
}

/// The features of all bodies, and the obstacles near the load.
#[derive(Clone, Debug)]
pub struct Surroundings {
    pub(super) load: Features,
    /// Radius of the load about its origin (m).
    pub(super) radius: f64,
    pub(super) bodies: Vec<Body>,
    /// Obstacles that move, with their extents about their origins, and the least combined radius
    /// of round features by which the load may touch them (m).
    moving: Vec<(usize, f64, f64)>,
    /// Smallest extent of a part that matters when a long displacement is searched for contacts
    /// (m).
    fineness: f64,
    near: Near,
}

#[derive(Clone, Debug)]
pub(super) struct Body {
    pub features: Features,
    /// Centre of the obstacle in its frame, and its radius about it (m).
    centre: Vec2,
    radius: f64,
}

/// Obstacles within twice the `margin` (m) of a load at `about` (pose and time, s).
#[derive(Clone, Debug, Default)]
struct Near {
    obstacles: Vec<usize>,
    about: Option<(Pose, f64)>,
    margin: f64,
    /// The margin without regard to how far a step reached (m).
    usual: f64,
}

impl Surroundings {
    pub fn new(system: &System) -> Self {
        let body = |obstacle: &Obstacle| {
            let features = Features::of(&obstacle.outline);
            let (centre, radius) = features.bounding_circle();
            Body { features, centre, radius }
        };
        let bodies: Vec<Body> = system.world.obstacles.iter().map(body).collect();
        let load = Features::of(&system.world.outline);
        let sizes = bodies.iter().map(|body| &body.features).chain([&load]).flat_map(Features::sizes);
        let fineness = sizes.fold(system.load.radius, f64::min);
        let mut made = Self { fineness, load, radius: system.load.radius, bodies, moving: Vec::new(), near: Near::default() };
        (0..system.world.obstacles.len()).for_each(|index| made.meet_path(system, index));
        made
    }

    /// Takes note of the path of an obstacle, which is a new one.
    pub fn meet_path(&mut self, system: &System, index: usize) {
        let Obstacle { path, outline, .. } = &system.world.obstacles[index];
        self.near.about = None;
        let known = self.moving.iter().position(|(other, ..)| *other == index);
        if let Some(at) = known.filter(|_| !path.moves()) {
            self.moving.remove(at);
        } else if known.is_none() && path.moves() {
            let corners = self.bodies[index].features.corners.iter();
            let pairs = corners.flat_map(|corner| self.load.corners.iter().map(move |own| corner.rounding + own.rounding));
            let bend = pairs.filter(|reach| *reach > 0.0).fold(f64::INFINITY, f64::min);
            self.moving.push((index, outline.extent(), bend));
        }
    }

    /// Bound of the path lengths of all obstacles between two times (m).
    pub fn longest_path(&self, system: &System, from: f64, to: f64) -> f64 {
        let lengths = self.moving.iter().map(|(index, extent, _)| system.world.obstacles[*index].path.length(*extent, from, to));
        lengths.fold(0.0, f64::max)
    }

    /// Path of an obstacle between two times (s), over the radius by which it bends about the load
    /// or the load about it (1); the largest one.
    pub fn longest_bend(&self, system: &System, from: f64, to: f64) -> f64 {
        let bends = self.moving.iter().map(|(index, extent, bend)| system.world.obstacles[*index].path.length(*extent, from, to) / bend);
        bends.fold(0.0, f64::max)
    }

    /// Length (m) in which a load that moves farther may pass over a feature.
    pub fn fineness(&self) -> f64 {
        self.fineness
    }

    /// Place of the load at `load` in the frame of an obstacle at `obstacle`.
    pub fn relative(load: &Place, obstacle: &Pose) -> Place {
        let offset = load.pose.position - obstacle.position;
        // Few obstacles are turned, and each is looked at several times in a step.
        if obstacle.heading == 0.0 {
            return Place { pose: Pose { position: offset, ..load.pose }, turn: load.turn };
        }
        let back = rotation(-obstacle.heading);
        let pose = Pose { position: back * offset, heading: load.pose.heading - obstacle.heading };
        Place::turned(pose, back * load.turn.column(0))
    }

    /// Lower bound of the distance between load and obstacles (m) at `time` (s), exact where it is
    /// less than `reach` (m) or the margin of the list of near obstacles.
    pub fn clearance(&mut self, system: &System, load: &Place, time: f64, reach: f64) -> f64 {
        self.update_near(system, load, time, reach);
        let mut least = self.near.margin.max(reach);
        for obstacle in &self.near.obstacles {
            let at = Self::relative(load, &system.world.obstacles[*obstacle].path.pose_at(time));
            least = least.min(self.distance(*obstacle, &at));
        }
        least
    }

    /// Obstacles near a load at `load` and `time` (s).
    pub fn near(&mut self, system: &System, load: &Place, time: f64) -> &[usize] {
        self.update_near(system, load, time, 0.0);
        &self.near.obstacles
    }

    /// Renews the list of near obstacles where the load or an obstacle has moved too far for it,
    /// and where it lacks obstacles within `reach` (m) or has those of a longer one.
    fn update_near(&mut self, system: &System, load: &Place, time: f64, reach: f64) {
        let (obstacles, &Near { margin, usual, .. }) = (&system.world.obstacles, &self.near);
        let moved = |(pose, since): &(Pose, f64)| load.pose.edge_displacement(pose, self.radius) + self.longest_path(system, *since, time);
        let holds = |about: &(Pose, f64)| moved(about) + reach.max(margin) <= 2.0 * margin;
        if (margin == usual || reach > usual) && self.near.about.as_ref().is_some_and(holds) {
            return;
        }
        let distance = |index: usize| {
            let at = obstacles[index].path.pose_at(time).to_world(&self.bodies[index].centre);
            (at - load.pose.position).norm() - self.radius - self.bodies[index].radius
        };
        // A list far from all obstacles holds for long.
        let least = (0..obstacles.len()).map(distance).fold(f64::INFINITY, f64::min);
        let usual = (0.5 * least).max(NEAR_MARGIN * self.radius);
        let margin = usual.max(reach);
        let is_near = |index: &usize| distance(*index) <= 2.0 * margin;
        self.near = Near { obstacles: (0..obstacles.len()).filter(is_near).collect(), about: Some((load.pose, time)), margin, usual };
    }

    /// Distance of the load from an obstacle in whose frame it is `at` (m). It is exact, but for a
    /// load that overlaps the obstacle.
    fn distance(&self, obstacle: usize, at: &Place) -> f64 {
        let body = &self.bodies[obstacle].features;
        let mut least = f64::INFINITY;
        for corner in &self.load.corners {
            let point = at.pose.position + at.turn * corner.at;
            let of_edges = body.edges.iter().map(|edge| edge.distance(&point));
            let of_corners = body.corners.iter().map(|other| (other.at - point).norm() - other.rounding);
            least = of_edges.chain(of_corners).fold(least, |least, distance| least.min(distance - corner.rounding));
        }
        for other in &body.corners {
            let point = at.turn.tr_mul(&(other.at - at.pose.position));
            let of_edges = self.load.edges.iter().map(|edge| edge.distance(&point));
            least = of_edges.fold(least, |least, distance| least.min(distance - other.rounding));
        }
        least
    }

    /// Whether the outline of a load at `load` crosses that of an obstacle at `time` (s) by more
    /// than `rounding` (m).
    pub fn crosses(&mut self, system: &System, load: &Place, time: f64, rounding: f64) -> bool {
        self.update_near(system, load, time, 0.0);
        let crosses = |index: &usize| {
            let (body, at) = (&self.bodies[*index].features, Self::relative(load, &system.world.obstacles[*index].path.pose_at(time)));
            let to_obstacle = |point: &Vec2| at.pose.position + at.turn * point;
            let to_load = |point: &Vec2| at.turn.tr_mul(&(point - at.pose.position));
            let edges = || self.load.edges.iter().map(|edge| [to_obstacle(&edge.from), to_obstacle(&edge.end())]);
            let discs = |features: &Features| -> Vec<_> {
                features.corners.iter().filter(|corner| corner.rounding > 0.0).map(|disc| (disc.at, disc.rounding)).collect()
            };
            let mut of_load = discs(&self.load).into_iter().map(|(centre, radius)| (to_obstacle(&centre), radius));
            let mut of_body = discs(body).into_iter().map(|(centre, radius)| (to_load(&centre), radius));
            let touches =
                |edges: &[Edge], (centre, radius): (Vec2, f64)| edges.iter().any(|edge| edge.distance(&centre) < radius - rounding);
            let enter = |edges: &[Edge], corner: Vec2, turn: &Mat2, ways: &[Vec2]| {
                let Ok(ways) = <&[Vec2; 2]>::try_from(ways) else { return false };
                edges.iter().any(|edge| edge.enters(&corner, &ways.map(|way| turn * way), [rounding, self.fineness]))
            };
            body.edges.iter().any(|edge| edges().any(|ends| edge.crosses(&ends, rounding)))
                || self.load.corners.iter().any(|it| enter(&body.edges, to_obstacle(&it.at), &at.turn, &it.edges))
                || body.corners.iter().any(|it| enter(&self.load.edges, to_load(&it.at), &at.turn.transpose(), &it.edges))
                || of_load.any(|disc| touches(&body.edges, disc))
                || of_body.any(|disc| touches(&self.load.edges, disc))
        };
        self.near.obstacles.iter().any(crosses)
    }

    /// Pairs of features that a load at `load` (world) may touch within a displacement of `reach`
    /// (m) relative to the near obstacles, which stand as at `time` (s).
    pub fn pairs(&mut self, system: &System, load: &Place, time: f64, reach: f64, pairs: &mut Vec<Pair>) {
        self.update_near(system, load, time, reach);
        for index in &self.near.obstacles {
            let obstacle = &system.world.obstacles[*index];
            let at = Self::relative(load, &obstacle.path.pose_at(time));
            self.pairs_with(*index, obstacle, &at, reach, pairs);
        }
    }

    fn pairs_with(&self, index: usize, obstacle: &Obstacle, at: &Place, reach: f64, pairs: &mut Vec<Pair>) {
        let body = &self.bodies[index].features;
        let deepest = -DEEP * self.radius;
        let mut add = |kind, of_load, of_obstacle, features: FeaturePair| {
            let pair = Pair::of(PairKey { obstacle: index, kind, of_load, of_obstacle }, features, obstacle);
            let gap = features.gap(at);
            // Features beside each other are no nearer than that.
            if gap > reach {
                return;
            }
            let beside = self.beside(&pair.key, at);
            let is_near = if beside > 0.0 { features.distance_beside(gap, beside) <= reach } else { (deepest..=reach).contains(&gap) };
            if is_near {
                pairs.push(pair);
            }
        };
        for (i, corner) in self.load.corners.iter().enumerate() {
            let point = at.pose.position + at.turn * corner.at;
            // A corner on an edge lies on the side of the load about it.
            let inside = point + 2.0 * DEEP * self.radius * (at.turn * corner.inwards);
            for (j, edge) in body.edges.iter().enumerate() {
                let kind = PairKind::PointOnLine { is_left: edge.has_two_sides && edge.has_on_left(&inside) };
                add(kind, i, j, point_on_line(corner, edge, kind));
            }
            for (j, other) in body.corners.iter().enumerate().filter(|(_, other)| corner.rounding + other.rounding > 0.0) {
                add(PairKind::PointOnPoint, i, j, point_on_point(corner, other));
            }
        }
        for (j, other) in body.corners.iter().enumerate() {
            for (i, edge) in self.load.edges.iter().enumerate() {
                add(PairKind::LineOnPoint, i, j, line_on_point(edge, other));
            }
        }
    }

    /// Whether the features that touch change from one pair to the other while a load at `at` and
    /// `time` (s) slides or rolls on smoothly: a disc from an edge to its corner, a corner from an
    /// edge to the next one on the same line, an edge on an edge over the end of one of them, or
    /// all of these from one obstacle to another one that is flush with it.
    pub fn continues(&self, (system, load, time): (&System, &Place, f64), [one, other]: [&Pair; 2]) -> bool {
        use PairKind::{LineOnPoint, PointOnLine, PointOnPoint};
        let (a, b) = (&one.key, &other.key);
        if a.obstacle != b.obstacle {
            let [(normal, _), (other, gap)] = [one, other].map(|pair| {
                let obstacle = system.world.obstacles[pair.key.obstacle].path.pose_at(time);
                let at = Self::relative(load, &obstacle);
                (rotation(obstacle.heading) * pair.features.normal(&at), pair.features.gap(&at))
            });
            return (normal - other).norm() <= FLUSH_NORMAL && gap.abs() <= self.flush(load);
        }
        match (a.kind, b.kind) {
            (PointOnPoint, PointOnLine { .. }) | (PointOnLine { .. }, PointOnPoint) => a.of_load == b.of_load,
            (PointOnPoint, LineOnPoint) | (LineOnPoint, PointOnPoint) => a.of_obstacle == b.of_obstacle,
            (PointOnLine { .. }, PointOnLine { .. }) => a.of_load == b.of_load && one.features.is_in_line(&other.features),
            (LineOnPoint, LineOnPoint) => a.of_obstacle == b.of_obstacle && one.features.is_in_line(&other.features),
            (PointOnLine { .. }, LineOnPoint) => self.slide_over_an_end(a, b),
            (LineOnPoint, PointOnLine { .. }) => self.slide_over_an_end(b, a),
            _ => false,
        }
    }

    /// Whether the corner and the edge of a pair end where the edge and the corner of another do.
    fn slide_over_an_end(&self, corner_on_edge: &PairKey, edge_on_corner: &PairKey) -> bool {
        let (load, body) = (&self.load, &self.bodies[corner_on_edge.obstacle].features);
        load.edges[edge_on_corner.of_load].ends_at(&load.corners[corner_on_edge.of_load].at)
            && body.edges[corner_on_edge.of_obstacle].ends_at(&body.corners[edge_on_corner.of_obstacle].at)
    }

    /// Whether there are features with this key.
    pub fn has(&self, key: &PairKey) -> bool {
        let (load, Some(body)) = (&self.load, self.bodies.get(key.obstacle)) else { return false };
        let body = &body.features;
        let [n_load, n_body] = match key.kind {
            PairKind::PointOnLine { .. } => [load.corners.len(), body.edges.len()],
            PairKind::PointOnPoint => [load.corners.len(), body.corners.len()],
            PairKind::LineOnPoint => [load.edges.len(), body.corners.len()],
        };
        key.of_load < n_load && key.of_obstacle < n_body
    }

    /// The pair with this key.
    pub fn pair(&self, system: &System, key: PairKey) -> Pair {
        Pair::of(key, self.features(&key), &system.world.obstacles[key.obstacle])
    }

    /// Features of a pair.
    pub fn features(&self, key: &PairKey) -> FeaturePair {
        let (load, body) = (&self.load, &self.bodies[key.obstacle].features);
        match key.kind {
            PairKind::PointOnLine { .. } => point_on_line(&load.corners[key.of_load], &body.edges[key.of_obstacle], key.kind),
            PairKind::PointOnPoint => point_on_point(&load.corners[key.of_load], &body.corners[key.of_obstacle]),
            PairKind::LineOnPoint => line_on_point(&load.edges[key.of_load], &body.corners[key.of_obstacle]),
        }
    }

    /// Whether a point of the load, with its rounding, that has moved straight on from `start` to
    /// the other side of an edge has passed around an end of it where no other edge begins.
    pub fn passes_end(&self, pair: &Pair, start: &Place, end: &Place) -> bool {
        let PairKey { obstacle, kind, of_load, of_obstacle } = pair.key;
        if !matches!(kind, PairKind::PointOnLine { .. }) || !self.bodies[obstacle].features.edges[of_obstacle].has_two_sides {
            return false;
        }
        let (corner, edge) = (&self.load.corners[of_load], &self.bodies[obstacle].features.edges[of_obstacle]);
        let [before, after] = [start, end].map(|at| pair.features.gap(at) + corner.rounding);
        if before <= 0.0 || after >= 0.0 {
            return false;
        }
        let [from, to] = [start, end].map(|at| edge.along.dot(&(at.pose.position + at.turn * corner.at - edge.from)));
        let crossed = from + before / (before - after) * (to - from);
        let [is_before, is_behind] = edge.neighbours.map(|neighbour| neighbour.is_none());
        crossed < 0.0 && is_before || crossed > edge.length && is_behind
    }

    /// Distance by which the features of a pair lie beside each other (m) for a load at this place
    /// in the obstacle's frame. See [`Self::beyond`] for whether they may touch there.
    pub fn beside(&self, key: &PairKey, at: &Place) -> f64 {
        let PairKey { obstacle, kind, of_load, of_obstacle } = *key;
        let body = &self.bodies[obstacle].features;
        match kind {
            PairKind::PointOnLine { is_left } => {
                body.edges[of_obstacle].beyond_on(is_left, &(at.pose.position + at.turn * self.load.corners[of_load].at))
            }
            PairKind::PointOnPoint => {
                let (corner, other) = (&self.load.corners[of_load], &body.corners[of_obstacle]);
                let seen = at.turn.tr_mul(&(other.at - at.pose.position));
                other.beside(&(at.pose.position + at.turn * corner.at)).max(corner.beside(&seen))
            }
            PairKind::LineOnPoint => {
                self.load.edges[of_load].beyond_on(false, &at.turn.tr_mul(&(body.corners[of_obstacle].at - at.pose.position)))
            }
        }
    }
}

fn point_on_line(corner: &Corner, edge: &Edge, kind: PairKind) -> FeaturePair {
    let is_left = matches!(kind, PairKind::PointOnLine { is_left: true });
    let normal = if is_left { -edge.normal() } else { edge.normal() };
    FeaturePair::PointOnLine { point: corner.at, rounding: corner.rounding, normal, offset: normal.dot(&edge.from) }
}

fn point_on_point(corner: &Corner, other: &Corner) -> FeaturePair {
    let reach = corner.rounding + other.rounding;
    FeaturePair::PointOnPoint { point: corner.at, rounding: corner.rounding, centre: other.at, reach }
}

fn line_on_point(edge: &Edge, other: &Corner) -> FeaturePair {
    let normal = edge.normal();
    FeaturePair::LineOnPoint { normal, offset: normal.dot(&edge.from), centre: other.at, rounding: other.rounding }
}
