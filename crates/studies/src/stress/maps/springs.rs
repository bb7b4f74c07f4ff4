//! Springs far from their shape at rest: grasped anywhere, drawn past their root, wound round it,
//! jerked, and by the thousand.

use std::f64::consts::{PI, TAU};

use super::super::map::{Asked, Axis, Cell, Map};
use super::super::scene::{Scene, rest_tip, spring, stiff_spring};
use crate::verify::scenes::{LOAD_RADIUS, RADIAL, REST_LENGTH, SLIP_LIMIT};
use cohaul::math::{Vec2, direction};
use cohaul::scenario::format::SpringEntry;

pub fn maps() -> Vec<Map> {
    vec![
        Map {
            name: "grasp",
            what: "a spring is grasped at any length and swing and held, so that the load jumps; exact answer at finer steps",
            x: Axis::log("length_rest_lengths", 1e-3, 1e2, 31),
            y: Axis::linear("swing_rad", 0.0, PI, 31),
            cell: grasp,
        },
        Map {
            name: "root",
            what: "a tip is drawn straight past the root of its spring, at some distance; exact answer at finer steps",
            x: Axis::log("way_per_step_rest_lengths", 4e-3, 2.0, 28),
            y: Axis::log("miss_rest_lengths", 1e-12, 1.0, 31).and_zero(),
            cell: root,
        },
        Map {
            name: "wind",
            what: "a tip goes round the root of its spring, 40 steps; exact answer at finer steps",
            x: Axis::log("angle_per_step_rad", 1e-3, 3.0, 29),
            y: Axis::log("radius_rest_lengths", 1e-2, 1e2, 29),
            cell: wind,
        },
        Map {
            name: "jump",
            what: "a tip goes far away within one step, 40 steps; exact answer at finer steps",
            x: Axis::log("jump_rest_lengths", 1e-3, 1e6, 28),
            y: Axis::log("torsion_share", 1e-6, 1e6, 25).and_zero(),
            cell: jump,
        },
        Map {
            name: "springs",
            what: "up to 3000 springs of unlike stiffness haul the load, 10 steps; exact answer at finer steps",
            x: Axis::counts("n_springs", 1.0, 3000.0, 16),
            y: Axis::log("stiffness_contrast", 1.0, 1e12, 9),
            cell: springs,
        },
    ]
}

/// The tip at this length (m) and swing (rad) of the spring at bearing zero.
fn tip_at(length: f64, swing: f64) -> Vec2 {
    Vec2::new(LOAD_RADIUS, 0.0) + length * direction(swing)
}

fn grasp(length: f64, swing: f64) -> Cell {
    Scene::paper(2e-3, 40).pulled(spring(0.0), &[(0.0, tip_at(length * REST_LENGTH, swing))]).cell(Asked::finer())
}

/// From a rest length ahead to one behind the root. The load is ten times as hard to move as the
/// paper's: the tip gets past.
fn root(way: f64, miss: f64) -> Cell {
    let n_steps = (2.0 / way).round().max(1.0);
    let aside = |ahead: f64| Vec2::new(LOAD_RADIUS + ahead * REST_LENGTH, miss * REST_LENGTH);
    let mut scene = Scene::paper(2e-3, n_steps as u32).pulled(spring(0.0), &[(0.0, aside(1.0)), (n_steps, aside(-1.0))]);
    scene.friction_coefficient *= 10.0;
    scene.cell(Asked::finer())
}

fn wind(angle: f64, radius: f64) -> Cell {
    const N_STEPS: u32 = 40;
    let way: Vec<(f64, Vec2)> = (0..=N_STEPS).map(|i| (f64::from(i), tip_at(radius * REST_LENGTH, f64::from(i) * angle))).collect();
    Scene::paper(2e-3, N_STEPS).pulled(spring(0.0), &way).cell(Asked::finer())
}

/// Aside by half a radian, with torsion in shares of what makes the spring as stiff across as
/// along.
fn jump(jump: f64, torsion: f64) -> Cell {
    let spring = SpringEntry { torsional_stiffness_nm_per_rad: torsion * RADIAL * REST_LENGTH.powi(2), ..spring(0.0) };
    let (start, far) = (rest_tip(0.0), rest_tip(0.0) + jump * REST_LENGTH * direction(0.5));
    Scene::paper(2e-3, 40).pulled(spring, &[(0.0, start), (1.0, start), (2.0, far)]).cell(Asked::finer())
}

/// All around the load, together four times the paper's stiffness, drawn ahead until the load
/// slips.
fn springs(n: f64, contrast: f64) -> Cell {
    const N_STEPS: u32 = 10;
    let n = n as usize;
    let weight = |i: usize| if n > 1 { contrast.powf(i as f64 / (n - 1) as f64) } else { 1.0 };
    let total: f64 = (0..n).map(weight).sum();
    let stretch = 2.0 * SLIP_LIMIT / (4.0 * RADIAL);
    let scene = (0..n).fold(Scene::paper(2e-3, N_STEPS), |scene, i| {
        // Neighbours in stiffness stand far apart.
        let bearing = TAU * (i * 7919 % n) as f64 / n as f64;
        let tip = rest_tip(bearing);
        scene.pulled(
            stiff_spring(bearing, 4.0 * RADIAL * weight(i) / total),
            &[(0.0, tip), (f64::from(N_STEPS), tip + Vec2::new(stretch, 0.3 * stretch))],
        )
    });
    scene.cell(Asked::finer())
}
