//! Outlines with many corners: whatever the precision, the load is where its outline is.

use std::f64::consts::TAU;

use cohaul::backend::Status;
use cohaul::backend::rapier::{Precision, RapierOptions};
use cohaul::math::{Pose, Vec2, direction};
use cohaul::model::{Ground, Load, Obstacle, ObstaclePath, Outline, OutlinePart, System, World};

use crate::obstacle_scenes::{box_outline, standing, without_springs};
use crate::scenes::{at_rest, backend, paper_body};

/// Largest distance of a corner from the origin (m).
const SIZE: f64 = 0.05;
/// Radius of the post (m), and the distance by which it drives into where the load was (m).
const POST: f64 = 0.1 * SIZE;
const DRIVE: f64 = 0.55 * SIZE;
const N_STEPS: usize = 120;

/// Numbers between 0 and 1 by a linear congruence, so that the outlines are the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Regular,
    /// Corners at random places of an ellipse.
    Convex,
    /// Corners at random distances in even directions.
    Star,
    /// A smooth outline with dents.
    Lobes,
}

fn corners(kind: Kind, n: usize, random: &mut Random) -> Vec<Vec2> {
    let even = |at: usize| TAU * at as f64 / n as f64;
    let mut angles: Vec<f64> = (0..n).map(|at| even(at) + 0.8 * TAU / n as f64 * random.next()).collect();
    angles.sort_by(f64::total_cmp);
    match kind {
        Kind::Regular => (0..n).map(|at| SIZE * direction(even(at))).collect(),
        Kind::Convex => angles.iter().map(|angle| SIZE * Vec2::new(angle.cos(), 0.6 * angle.sin())).collect(),
        Kind::Star => (0..n).map(|at| SIZE * (0.6 + 0.4 * random.next()) * direction(even(at))).collect(),
        Kind::Lobes => angles.iter().map(|angle| SIZE * (0.8 + 0.2 * (5.0 * angle).cos()) * direction(*angle)).collect(),
    }
}

/// Signed distance of a point to a polygon (m), negative inside: over all edges, and by the
/// winding.
fn distance(corners: &[Vec2], point: &Vec2) -> f64 {
    let n = corners.len();
    let (mut nearest, mut is_inside) = (f64::INFINITY, false);
    for at in 0..n {
        let (a, b) = (corners[at], corners[(at + 1) % n]);
        let along = ((point - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
        nearest = nearest.min((point - a - along * (b - a)).norm());
        let crosses = (a.y > point.y) != (b.y > point.y);
        is_inside ^= crosses && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x);
    }
    if is_inside { -nearest } else { nearest }
}

/// The load with this outline, and a post that drives into it from the direction `from`.
fn pushed(outline: Outline, from: Vec2) -> System {
    let reach = 1.02 * SIZE + POST;
    let at = |distance: f64| Pose::new(distance * from.x, distance * from.y, 0.0);
    let path = ObstaclePath { waypoints: vec![(0.0, at(reach)), (0.12, at(reach - DRIVE))] };
    let post = Obstacle { path, friction_coefficient: 0.2, ..standing(Outline::disc(POST)) };
    let body = paper_body();
    System {
        load: Load { radius: SIZE, inertia: 0.4 * body.load.mass * SIZE * SIZE, ..body.load },
        ground: Ground { friction_coefficient: 0.3, ..body.ground },
        world: World { outline, obstacles: vec![post] },
        ..body
    }
}

/// Pushes the load, and returns its pose at the end and how deep the post was in its outline (m).
fn push(corners: &[Vec2], from: Vec2, precision: Precision) -> (Pose, f64) {
    let system = pushed(Outline { parts: vec![OutlinePart::Polygon { corners: corners.to_vec() }] }, from);
    let options = RapierOptions { precision, ..RapierOptions::default() };
    let mut load = backend(&system, at_rest(Pose::new(0.0, 0.0, 0.0)), 1e-3, options);
    let mut deepest: f64 = 0.0;
    for step in 1..=N_STEPS {
        load.advance(&[], 1e-3);
        let post = system.world.obstacles[0].path.pose_at(1e-3 * step as f64).position;
        let pose = load.motion().pose;
        deepest = deepest.max(POST - distance(corners, &pose.to_local(&post)));
    }
    (load.motion().pose, deepest)
}

/// A post never enters an outline with 30 to 1000 corners, and takes the load along.
#[test]
fn no_post_passes_through_an_outline() {
    let mut random = Random(7);
    for case in 0..40 {
        let kind = [Kind::Regular, Kind::Convex, Kind::Star, Kind::Lobes][case % 4];
        let n = 30 + (970.0 * (case / 4) as f64 / 9.0) as usize;
        let corners = corners(kind, n, &mut random);
        let from = direction(TAU * random.next());
        // Positions are rounded to 1e-8 of the size in single precision. The load turns in a step
        // while its contact keeps its normal, and slides over corners: a thousandth of the size is
        // the share at which a step counts as not converged.
        for precision in [Precision::F64, Precision::F32] {
            let (pose, deepest) = push(&corners, from, precision);
            assert!(deepest < 2e-3 * SIZE, "{kind:?} {n} {precision:?}: {deepest} m deep");
            let displacement = pose.edge_displacement(&Pose::new(0.0, 0.0, 0.0), SIZE);
            assert!(displacement > 0.1 * DRIVE, "{kind:?} {n} {precision:?}: {pose:?}");
        }
    }
}

/// An L of six corners, and the same L with `n` points on each of its edges.
fn ell(n: usize) -> Vec<Vec2> {
    let corners = [[-0.4, -0.4], [0.8, -0.4], [0.8, 0.0], [0.0, 0.0], [0.0, 0.8], [-0.4, 0.8]].map(|[x, y]| {
        let turned = Vec2::new(x, y);
        SIZE * Vec2::new(0.8 * turned.x - 0.6 * turned.y, 0.6 * turned.x + 0.8 * turned.y)
    });
    let between = |at: usize| (0..n).map(move |k| corners[at] + k as f64 / n as f64 * (corners[(at + 1) % 6] - corners[at]));
    (0..6).flat_map(between).collect()
}

#[test]
fn corners_on_straight_edges_change_nothing() {
    for from in [0.3, 1.7, 2.9, 4.4].map(direction) {
        // Corners on an edge are rounded, so that the edge is not quite straight.
        for (precision, rounding) in [(Precision::F64, 1e-11), (Precision::F32, 1e-4)] {
            let [few, many] = [1, 30].map(|n| push(&ell(n), from, precision));
            assert!(few.0.edge_displacement(&many.0, SIZE) < rounding * SIZE, "{from:?} {precision:?}: {few:?} {many:?}");
        }
    }
}

/// A regular polygon with many corners is a disc: both precisions agree with it.
#[test]
fn a_polygon_with_many_corners_is_a_disc() {
    let from = direction(0.4);
    let end_of = |outline, precision| {
        let mut system = pushed(outline, from);
        // The post meets the load beside its centre.
        for (_, pose) in &mut system.world.obstacles[0].path.waypoints {
            pose.position += 0.3 * SIZE * direction(0.4 + 0.25 * TAU);
        }
        let mut load = backend(&system, at_rest(Pose::new(0.0, 0.0, 0.0)), 1e-3, RapierOptions { precision, ..RapierOptions::default() });
        let report = load.advance(&[], 0.12);
        // Sweeps in single precision end a little above the tolerance of a step.
        assert!(report.status == Status::Converged || precision == Precision::F32, "{report:?}");
        load.motion().pose
    };
    for precision in [Precision::F64, Precision::F32] {
        let disc = end_of(Outline::disc(SIZE), precision);
        for n in [240, 1000] {
            let corners = corners(Kind::Regular, n, &mut Random(1));
            let polygon = end_of(Outline { parts: vec![OutlinePart::Polygon { corners }] }, precision);
            // Edges of the polygon lie within 1 - cos(pi / n) of the disc, and their normals differ
            // by up to pi / n from those of the disc, half of which the next edge takes back.
            let error = polygon.edge_displacement(&disc, SIZE);
            assert!(error < TAU / n as f64 * DRIVE, "{n} {precision:?}: {error} {polygon:?} {disc:?}");
        }
    }
}

/// The box of the known answers with corners that single precision cannot tell apart.
#[test]
fn corners_closer_than_a_rounding_are_one() {
    let OutlinePart::Polygon { corners } = &box_outline().parts[0] else { unreachable!() };
    let mut doubled = corners.clone();
    doubled.insert(1, corners[0] + Vec2::new(3e-10, -1e-10));
    let system = without_springs(Outline { parts: vec![OutlinePart::Polygon { corners: doubled }] }, vec![standing(Outline::disc(POST))]);
    for precision in [Precision::F64, Precision::F32] {
        let options = RapierOptions { precision, ..RapierOptions::default() };
        let start = at_rest(Pose::new(0.0, 3.0 * SIZE, 0.0));
        assert_eq!(backend(&system, start, 1e-3, options).advance(&[], 1e-2).status, Status::Converged);
    }
}
