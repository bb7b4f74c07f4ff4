//! Loads without springs that a pusher turns.

use std::f64::consts::TAU;

use cohaul::backend::BackendKind::{Inertial, QuasiStatic};
use cohaul::backend::{BackendOptions, Status, build};
use cohaul::math::{Pose, RandomStreams, Stream, Twist, Vec2, direction, perpendicular, rotation};
use cohaul::model::{Ground, Load, Motion, Obstacle, ObstaclePath, Outline, OutlinePart, SupportPoint, System, World};

use crate::scenes::obstacle;

/// Distance from the centre of friction, over the size of the load (1), below which a line does not
/// count as passing it on one side: the load moves by a hundredth of that.
const CLEAR: f64 = 1e-3;
const PUSH: f64 = 1e-5;

/// A load on random supports, and a round pusher that touches it and is about to move.
struct Push {
    system: System,
    start: Pose,
    /// Moments about the centre of friction of three unit vectors at the contact, over the load's
    /// size (1): the pusher's displacement, and the two edges of the friction cone.
    votes: [f64; 3],
}

impl Push {
    fn new(seed: u64) -> Self {
        let streams = RandomStreams::new(seed);
        let mut n = 0;
        let mut unit = || {
            n += 1;
            streams.uniform(Stream::Scene, 0, n)
        };
        let size = 10f64.powf(-6.0 + 9.0 * unit());
        let half = size * Vec2::new(0.4 + 0.5 * unit(), 0.4 + 0.5 * unit());
        // A point of an edge, its inward normal and the edge's direction, all in load axes.
        let (inward, depth, length) = if unit() < 0.5 { (Vec2::x(), half.x, half.y) } else { (Vec2::y(), half.y, half.x) };
        let inward = if unit() < 0.5 { inward } else { -inward };
        let along = perpendicular(&inward);
        let point = -depth * inward + 0.95 * length * (2.0 * unit() - 1.0) * along;
        let friction_coefficient = if unit() < 0.2 { 0.0 } else { 1.5 * unit() };
        let course = (inward + 3.0 * (2.0 * unit() - 1.0) * along).normalize();

        let n_supports = 2 + (6.0 * unit()) as usize;
        let weight = 10f64.powf(-6.0 + 10.0 * unit());
        let supports: Vec<SupportPoint> = (0..n_supports)
            .map(|_| SupportPoint {
                offset: Vec2::new((2.0 * unit() - 1.0) * half.x, (2.0 * unit() - 1.0) * half.y),
                normal_load: weight * unit(),
                friction_coefficient: None,
            })
            .collect();
        let total: f64 = supports.iter().map(|support| support.normal_load).sum();
        let centre = supports.iter().map(|support| support.normal_load * support.offset).sum::<Vec2>() / total;
        let edge = |sign: f64| (inward + sign * friction_coefficient * along).normalize();
        let votes = [course, edge(1.0), edge(-1.0)].map(|vector| (point - centre).perp(&vector) / size);

        let start = Pose { position: size * direction(TAU * unit()), heading: TAU * unit() };
        let radius = 0.3 * size;
        let from = Pose { position: start.to_world(&(point - radius * inward)), heading: 0.0 };
        let to = Pose { position: from.position + PUSH * size * (rotation(start.heading) * course), ..from };
        let pusher = obstacle(OutlinePart::Disc { centre: Vec2::zeros(), radius }, friction_coefficient);
        let outline = Outline { parts: vec![rectangle(&half)] };
        let system = System {
            load: Load { mass: weight / 9.81, inertia: weight / 9.81 * size * size, radius: outline.extent() },
            ground: Ground { friction_coefficient: 0.1 + unit(), supports },
            springs: vec![],
            world: World {
                outline,
                obstacles: vec![Obstacle { path: ObstaclePath { waypoints: vec![(0.0, from), (1.0, to)] }, ..pusher }],
            },
        };
        Self { system, start, votes }
    }
}

fn rectangle(half: &Vec2) -> OutlinePart {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|corner| Vec2::from(corner).component_mul(half));
    OutlinePart::Polygon { corners: corners.to_vec() }
}

/// Mason's voting theorem: a pushed load turns to the side on which two of three lines through the
/// contact pass its centre of friction, which are the line of pushing and the two edges of the
/// friction cone. The theorem asks for nothing else of the pressure.
#[test]
fn a_pushed_load_turns_as_the_lines_vote() {
    let (mut n_turned, mut n_by_the_pusher) = ([0, 0], 0);
    for seed in 0..600 {
        let Push { system, start, votes } = Push::new(seed);
        if votes.iter().any(|vote| vote.abs() < CLEAR) {
            continue;
        }
        let mut load = build(&system, Motion { pose: start, twist: Twist::ZERO }, &BackendOptions::new(QuasiStatic, 0.25));
        assert_eq!(load.advance(&[], 1.0).status, Status::Converged, "{seed}");
        let turn = load.motion().pose.heading - start.heading;
        let majority = votes.iter().map(|vote| vote.signum()).sum::<f64>().signum();
        // A turn of the whole push over the size of the load would be PUSH.
        assert!(turn * majority > 1e-6 * PUSH, "{seed}: {turn:e} {votes:?}");
        n_turned[usize::from(turn > 0.0)] += 1;
        n_by_the_pusher += u32::from(votes[1] * votes[2] < 0.0);
    }
    assert!(n_turned[0] > 200 && n_turned[1] > 200 && n_by_the_pusher > 40, "{n_turned:?} {n_by_the_pusher}");
}

/// A box that the whole face of another one pushes along a line through its centre of friction.
/// Where the push is in the friction cone and the line meets the face, the box sticks to it.
struct FacePush {
    system: System,
    start: Motion,
    /// Displacement of the pusher (m).
    shift: Vec2,
}

impl FacePush {
    /// `case` says which of their corners lie on one line, and whether both are aligned with the
    /// axes, in which case numbers that are equal have no rounding. Pushes of even seeds are along
    /// the normal.
    fn new(seed: u64, case: usize) -> Self {
        let streams = RandomStreams::new(seed);
        let mut n = 0;
        let mut unit = || {
            n += 1;
            streams.uniform(Stream::Scene, 1, n)
        };
        let (half, depth) = (Vec2::new(0.3 + 0.7 * unit(), 0.3 + 0.7 * unit()), 0.05 + 0.3 * unit());
        let heading = if case.is_multiple_of(2) { 0.0 } else { TAU * unit() };
        let (width, offset) = match case / 2 {
            0 => (half.y, 0.0),
            1 => (0.5 * half.y, 0.5 * half.y),
            2 => (0.3 * half.y, 0.2 * half.y),
            _ => (2.0 * half.y, 0.3 * half.y),
        };
        let [low, high] = [(offset - width).max(-half.y), (offset + width).min(half.y)];
        let friction_coefficient = 0.2 + unit();
        let slope = if seed.is_multiple_of(2) { 0.0 } else { 0.9 * friction_coefficient * (2.0 * unit() - 1.0) };
        let support = |offset: Vec2| SupportPoint { offset, normal_load: 1.0, friction_coefficient: None };
        // Pairs of supports about a point on the line of the push.
        let on_line = Vec2::new(-half.x, low + (0.1 + 0.8 * unit()) * (high - low)) + half.x * Vec2::new(1.0, slope);
        let supports = (0..3)
            .flat_map(|_| {
                let arm = Vec2::new((2.0 * unit() - 1.0) * half.x, (2.0 * unit() - 1.0) * half.y);
                [support(on_line + arm), support(on_line - arm)]
            })
            .collect();
        let pose = Pose { position: Vec2::new(unit(), unit()), heading };
        let shift = rotation(heading) * (0.5 * Vec2::new(1.0, slope));
        let from = Pose { position: pose.to_world(&Vec2::new(-half.x - depth, offset)), heading };
        let to = Pose { position: from.position + shift, heading };
        let outline = Outline { parts: vec![rectangle(&half)] };
        let pusher = obstacle(rectangle(&Vec2::new(depth, width)), friction_coefficient);
        let system = System {
            load: Load { mass: 6.0 / 9.81, inertia: 2.0 / 9.81, radius: outline.extent() },
            ground: Ground { friction_coefficient: 0.5, supports },
            springs: vec![],
            world: World {
                outline,
                obstacles: vec![Obstacle { path: ObstaclePath { waypoints: vec![(0.0, from), (1.0, to)] }, ..pusher }],
            },
        };
        Self { system, start: Motion { pose, twist: Twist { linear: shift, angular: 0.0 } }, shift }
    }
}

/// A face that pushes a face: the box moves with the pusher, however long steps are, and whatever
/// other corners lie on the same line. Two corners that stick are one constraint more than a load
/// can break.
#[test]
fn a_face_that_pushes_a_face_sticks_to_it() {
    for (seed, case, n_steps) in (0..40).flat_map(|seed| (0..8).flat_map(move |case| [3_u32, 20, 101].map(|n| (seed, case, n)))) {
        let FacePush { system, start, shift } = FacePush::new(seed, case);
        for kind in [QuasiStatic, Inertial] {
            let mut load = build(&system, start, &BackendOptions::new(kind, 1.0 / f64::from(n_steps)));
            let report = load.advance(&[], 1.0);
            let name = format!("{seed} {case} {n_steps} {}", kind.name());
            assert_eq!(report.status, Status::Converged, "{name}");
            let moved = load.motion().pose.position - start.pose.position;
            // What counts as a closed gap; the turn is that over the length of a face.
            assert!((moved - shift).norm() < 1e-11, "{name}: {moved:?} {shift:?}");
            assert!((load.motion().pose.heading - start.pose.heading).abs() < 1e-11, "{name}");
            // Without a tangential force and without corners on one line, nothing is on the edge of
            // sliding, and the first step alone takes more than one solution.
            let is_plain = kind == QuasiStatic && seed % 2 == 0 && matches!(case, 4 | 6);
            assert!(!is_plain || report.n_solves <= u64::from(n_steps) + 4, "{name}: {report:?}");
        }
    }
}

/// A fence turns a box that it meets by a corner until a face lies along it. The load has no
/// springs, so that its step has a stiffness across its slip only, and the corner that turns under
/// it a negative one along it.
#[test]
fn a_fence_aligns_a_box() {
    let half = Vec2::new(0.05, 0.03);
    let outline = Outline { parts: vec![rectangle(&half)] };
    let paths = [Pose::new(0.0, -0.07, 0.0), Pose::new(0.0, 0.08, 0.0)];
    let fence = obstacle(rectangle(&Vec2::new(0.15, 0.01)), 0.2);
    let supports =
        (0..6).map(|k| SupportPoint { offset: 0.03 * direction(TAU * f64::from(k) / 6.0), normal_load: 1.0, friction_coefficient: None });
    let system = System {
        load: Load { mass: 0.5, inertia: 6e-4, radius: outline.extent() },
        ground: Ground { friction_coefficient: 0.3, supports: supports.collect() },
        springs: vec![],
        world: World {
            outline,
            obstacles: vec![Obstacle { path: ObstaclePath { waypoints: vec![(0.0, paths[0]), (1.0, paths[1])] }, ..fence }],
        },
    };
    let start = Motion { pose: Pose::new(0.0, 0.0, 0.5), twist: Twist::ZERO };
    let n_steps = 200_u32;
    let mut load = build(&system, start, &BackendOptions::new(QuasiStatic, 1.0 / f64::from(n_steps)));
    let report = load.advance(&[], 1.0);
    assert_eq!(report.status, Status::Converged);
    let Pose { position, heading } = load.motion().pose;
    // What counts as a closed gap, over the length of a face.
    assert!(heading.abs() < 1e-9 && (position.y - 0.12).abs() < 1e-10, "{position:?} {heading:e}");
    // A search takes three or more.
    assert!(report.n_solves < (n_steps + n_steps / 2).into(), "{report:?}");
}
