//! Energy that every quasi-static step among fixed obstacles must and must not take. A spring is
//! the only drive. Without side friction the new pose minimises the energy over all poses without
//! overlap, of which the old pose is one, so that both bounds are those of a free load. With side
//! friction the step is no minimum, and the upper bound holds with the loss at the walls.

use std::f64::consts::TAU;

use cohaul::backend::{Backend, Status};
use cohaul::math::{RandomStreams, Stream, Vec2, direction};
use cohaul::model::{Obstacle, OutlinePart, System};

use crate::bounded::{Findings, audited};
use crate::scenes::*;

/// Half the width of a square room (m).
const ROOM: f64 = 0.025;

/// A square room about the origin, as one closed line.
fn room(friction_coefficient: f64) -> Obstacle {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]];
    obstacle(OutlinePart::Polyline { points: corners.map(|corner| ROOM * Vec2::from(corner)).to_vec() }, friction_coefficient)
}

/// A tip that walks at random in and about the room draws the load along its walls and into its
/// corners.
fn walk(system: &System, stride: f64, seed: u64) -> Findings {
    let streams = RandomStreams::new(seed);
    let (mut run, found) = audited(system, at_rest(0.0, 0.0));
    let (mut tip, mut n_touching) = (Vec2::zeros(), 0);
    run.attach(0, tip);
    for tick in 0..1500 {
        let course = direction(TAU * streams.uniform(Stream::Target, 0, tick / 40));
        tip += stride * if tip.norm() > 1.8 * BEHIND { -tip.normalize() } else { course };
        let report = run.advance(&[tip], 1e-3);
        assert_eq!(report.status, Status::Converged, "seed {seed}, tick {tick} {report:?}");
        n_touching += u32::from(!run.side_contacts().is_empty());
    }
    let found = *found.borrow();
    assert!(n_touching > 1000 && found.n_moving > 80 && found.least_loss >= 0.0, "{n_touching} {found:?}");
    found
}

/// Rounding of sums of energies that cancel, as without obstacles (1).
const BOUND: f64 = 1e-13;

#[test]
fn each_step_along_smooth_walls_keeps_within_the_two_bounds() {
    for (seed, stride) in [(0, 1e-3), (0, 3e-3), (1, 1e-3), (1, 3e-3), (2, 1e-3), (3, 3e-3)] {
        for system in [disc(vec![room(0.0)]), boxed(vec![room(0.0)], Vec2::zeros())] {
            let found = walk(&system, stride, seed);
            assert!(found.above < BOUND && found.below < BOUND && found.misbooked < BOUND && found.n_jumps == 0, "{seed} {found:?}");
        }
    }
}

#[test]
fn no_step_along_rough_walls_gains_energy() {
    for seed in 0..4 {
        for (stride, friction) in [(1e-3, 0.3), (3e-3, 0.3), (1e-3, 1.5), (3e-3, 1.5)] {
            let found = walk(&disc(vec![room(friction)]), stride, seed);
            assert!(found.above < BOUND, "{seed} {stride} {friction} {found:?}");
        }
    }
}
