//! Loads without springs that a pusher turns.

use std::f64::consts::TAU;

use cohaul::backend::BackendKind::QuasiStatic;
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
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|corner| Vec2::from(corner).component_mul(&half)).to_vec();
        let outline = Outline { parts: vec![OutlinePart::Polygon { corners }] };
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
