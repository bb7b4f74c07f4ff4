//! Friction from nothing to a hundred, loads that slide and loads that must stick, and supports of
//! all numbers and arrangements.

use std::f64::consts::TAU;

use super::super::map::{Asked, Axis, Cell, Map};
use super::super::scene::{Scene, isotropic, rest_tip, ring, spring, support};
use crate::verify::scenes::{GRAVITY, LOAD_RADIUS, MASS, RADIAL, SLIP_STRETCH, SUPPORT_RADIUS};
use cohaul::math::{RandomStreams, Stream, Vec2, direction};
use cohaul::scenario::format::SupportEntry;

pub fn maps() -> Vec<Map> {
    let friction = || Axis::log("friction_coefficient", 1e-6, 1e2, 33);
    let arrangements_and_drives = DRIVES.iter().flat_map(|drive| ARRANGEMENTS.map(|arrangement| format!("{arrangement}, {drive}")));
    vec![
        Map {
            name: "friction-speed",
            what: "a load is thrown and slides, 100 steps of 1 ms; closed answer",
            x: friction().and_zero(),
            y: Axis::log("speed_m_per_s", 1e-9, 1e3, 31),
            cell: slide,
        },
        Map {
            name: "friction-margin",
            what: "a load is pulled beside its centre by just less than moves it; it must stick",
            x: friction(),
            y: Axis::log("margin_share", 1e-9, 0.5, 31),
            cell: hold,
        },
        Map {
            name: "supports",
            what: "1 to 1000 supports share the weight while one spring is drawn, or while the load is thrown; exact answer at finer steps",
            x: Axis::counts("n_supports", 1.0, 1000.0, 34),
            y: Axis::of_names("arrangement_and_drive", arrangements_and_drives.collect()),
            cell: supports,
        },
    ]
}

fn slide(friction: f64, speed: f64) -> Cell {
    let mut scene = Scene::paper(1e-3, 100);
    scene.friction_coefficient = friction;
    scene.load.velocity_m_per_s = [speed, 0.0];
    let (braking, time) = (friction * GRAVITY, scene.duration());
    let way = if braking * time < speed { speed * time - 0.5 * braking * time * time } else { 0.5 * speed * speed / braking };
    // A stop within the first step cannot be told from another one there.
    let scale = way.max(speed * scene.step);
    scene.cell(Asked::shift(0.0, way, scale))
}

/// Critical force along x at twice the arm of the support on the y axis: f a (b + a) / (b^2 + a b +
/// a^2) with b = 2 a, 3/7 of the limit.
fn hold(friction: f64, margin: f64) -> Cell {
    let root = Vec2::new(0.0, 2.0 * SUPPORT_RADIUS);
    let pull = (1.0 - margin) * 3.0 / 7.0 * friction * MASS * GRAVITY;
    let tip = root + Vec2::new(pull / RADIAL, 0.0);
    let mut scene = Scene::paper(1e-3, 80).pulled(isotropic(root), &[(0.0, root), (40.0, tip)]);
    scene.friction_coefficient = friction;
    let turned = |i: usize| support(SUPPORT_RADIUS * direction(0.25 * TAU + TAU * i as f64 / 3.0), MASS * GRAVITY / 3.0);
    scene.supports = (0..3).map(turned).collect();
    scene.cell(Asked { sticks: true, ..Asked::default() })
}

const ARRANGEMENTS: [&str; 11] = [
    "ring",
    "random",
    "line along",
    "line across",
    "nearly a line",
    "one point",
    "one point outside",
    "nearly one point",
    "far apart",
    "one carries all",
    "one carries nearly all",
];
const DRIVES: [&str; 3] = ["drawn ahead", "drawn aside", "thrown"];

fn supports(n: f64, row: f64) -> Cell {
    const N_STEPS: u32 = 40;
    let (n, row) = (n as usize, row as usize);
    let mut scene = Scene::paper(2e-3, N_STEPS);
    scene.supports = arranged(row % ARRANGEMENTS.len(), n);
    let last = f64::from(N_STEPS);
    let tip = rest_tip(0.0);
    let scene = match row / ARRANGEMENTS.len() {
        0 => scene.pulled(spring(0.0), &[(0.0, tip), (last, tip + Vec2::new(2.0 * SLIP_STRETCH, 0.0))]),
        1 => scene.pulled(spring(0.0), &[(0.0, tip), (last, tip + Vec2::new(0.5, 1.0) * SLIP_STRETCH)]),
        _ => {
            scene.load.velocity_m_per_s = [0.2, 0.1];
            scene.load.turn_rate_rad_per_s = 7.0;
            scene
        }
    };
    scene.cell(Asked::finer())
}

fn arranged(kind: usize, n: usize) -> Vec<SupportEntry> {
    let weight = MASS * GRAVITY;
    let each = weight / n as f64;
    let equal = |place: &dyn Fn(usize) -> Vec2| (0..n).map(|i| support(place(i), each)).collect::<Vec<_>>();
    // From -1 to 1; one alone stands in the middle.
    let along = |i: usize| if n > 1 { 2.0 * i as f64 / (n - 1) as f64 - 1.0 } else { 0.0 };
    let random = |i: usize| {
        let [u, v] = RandomStreams::new(1).uniform_pair(Stream::Scene, 0, i as u64);
        LOAD_RADIUS * u.sqrt() * direction(TAU * v)
    };
    let unequal = |rest: f64| {
        let mut supports = ring(n, SUPPORT_RADIUS, weight);
        let carries = |i: usize| if i == 0 { weight - rest * (n - 1) as f64 } else { rest };
        supports.iter_mut().enumerate().for_each(|(i, support)| support.normal_load_n = Some(carries(i)));
        supports
    };
    match kind {
        0 => ring(n, SUPPORT_RADIUS, weight),
        1 => equal(&random),
        2 => equal(&|i| Vec2::new(SUPPORT_RADIUS * along(i), 0.0)),
        3 => equal(&|i| Vec2::new(0.0, SUPPORT_RADIUS * along(i))),
        4 => equal(&|i| SUPPORT_RADIUS * Vec2::new(along(i), if i % 2 == 0 { 1e-9 } else { -1e-9 })),
        5 => equal(&|_| Vec2::zeros()),
        6 => equal(&|_| Vec2::new(0.3, 0.9) * SUPPORT_RADIUS),
        7 => ring(n, 1e-9 * SUPPORT_RADIUS, weight),
        8 => ring(n, 1e3 * LOAD_RADIUS, weight),
        9 => unequal(0.0),
        _ => unequal(1e-12 * weight),
    }
}
