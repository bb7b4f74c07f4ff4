//! A box that a spring presses on a wall and pulls along it, past joints, ends and steps of the
//! wall.
//!
//! The box of 0.2 m x 0.1 m and 1 kg hangs on a spring of 200 N/m at its centre. The tip presses
//! it on the wall with 14 N within 0.5 s, and then goes to each target within 1.25 s. A sliding
//! load lags behind the tip by the slip limit over the stiffness.

use std::env;
use std::fs;
use std::path::Path;

use cohaul::backend::BackendKind::{self, Inertial, QuasiStatic};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use crate::run::{Run, Steps, expect_none, off, run, step_error};
use crate::scene::{Body, GRAVITY, Part, Point, Scene, Spring, fixed, rectangle};

/// Height of the wall, and of the centre of the box on it (m).
pub const TOP: f64 = -0.06;
pub const REST: f64 = -0.01;
/// Stiffness of the spring (N/m).
const STIFFNESS: f64 = 200.0;
/// Lag of the box by the friction of the ground, and by a side friction of 0.2 under 14 N (m).
pub const GROUND_LAG: f64 = 0.3 * GRAVITY / STIFFNESS;
pub const SIDE_LAG: f64 = 0.2 * 14.0 / STIFFNESS;
/// Side friction of rough walls (1).
pub const ROUGH: f64 = 0.2;
/// Time of each way of the tip, and of pressing (s).
const WAY: f64 = 1.25;
const PRESSING: f64 = 0.5;
/// Where a wall ends or has a joint that the front corner passes (m).
pub const JOINT: f64 = 0.237;
/// Largest error of a known answer without inertia (m, rad): rounding of a thousand steps and the
/// distance at which a gap is closed.
const ROUNDING: f64 = 1e-9;
/// Tolerance that runs with inertia are given, and the error that they may have (m): error control
/// estimates the error, and does not bound it strictly.
const ASKED: f64 = 1e-6;
const KEPT: f64 = 2e-6;
/// Largest distance of runs with inertia of two poses of one scene (1), over the size, apart from
/// the error of their steps, which may be divided at joints.
const SAME: f64 = 1e-9;

/// Obstacles of a rectangle from `from` to `to` whose top is at `top` (m).
pub fn block(from: f64, to: f64, top: f64, friction: f64) -> Body {
    raised(from, to, top, 0.1, friction)
}

fn raised(from: f64, to: f64, top: f64, height: f64, friction: f64) -> Body {
    fixed(vec![rectangle([0.5 * (from + to), top - 0.5 * height], [to - from, height])], friction)
}

pub fn line(points: &[Point], friction: f64) -> Body {
    fixed(vec![Part::Line(points.to_vec())], friction)
}

/// 25 flush blocks of 0.1 m.
pub fn tiles(friction: f64) -> Vec<Body> {
    let edge = |k: u32| -0.95 + 0.1 * f64::from(k);
    (0..25).map(|k| block(edge(k), edge(k + 1), TOP, friction)).collect()
}

/// A wall in one piece that is longer than all ways.
pub fn one_piece(friction: f64) -> Vec<Body> {
    vec![block(-3.0, 3.0, TOP, friction)]
}

fn box_of_load() -> Vec<Part> {
    vec![rectangle([0.0; 2], [0.2, 0.1])]
}

/// A grid of 16 supports under the box that carry the same load.
pub fn supports(mass: f64) -> Vec<(Point, f64)> {
    let offset = |k: u32| 0.25 * (f64::from(k) - 1.5);
    (0..16).map(|k| ([0.2 * offset(k % 4), 0.1 * offset(k / 4)], mass * GRAVITY / 16.0)).collect()
}

/// The box at these obstacles, with a tip that goes to `targets` (m).
pub fn pressed(name: &str, obstacles: Vec<Body>, targets: &[f64]) -> Scene {
    let mut path = vec![[0.0, 0.0, 0.0], [PRESSING, 0.0, -0.08]];
    path.extend(targets.iter().zip(1..).map(|(x, k)| [PRESSING + WAY * f64::from(k), *x, -0.08]));
    Scene {
        name: name.into(),
        duration: PRESSING + WAY * targets.len() as f64,
        control_period: 0.005,
        load: box_of_load(),
        mass: 1.0,
        inertia: (0.04 + 0.01) / 12.0,
        start: [0.0; 3],
        velocity: [0.0; 3],
        ground_friction: 0.3,
        supports: supports(1.0),
        springs: vec![Spring { root: [0.0; 2], stiffness: STIFFNESS, path }],
        obstacles,
    }
}

/// What is known with inertia.
enum WithInertia {
    /// The box moves as along a wall in one piece with this friction.
    OnePiece(f64),
    /// It ends there, whatever happens on the way.
    Ends,
    /// Its front stays at this place up to its turn, so that its centre stays behind this one (m).
    Caught(f64),
}
use WithInertia::{Caught, Ends, OnePiece};

struct Case {
    scene: Scene,
    /// Position (m) and heading (rad) at the end without inertia.
    right: [f64; 3],
    /// Largest turn on the way (rad).
    most_turned: f64,
    inertial: WithInertia,
}

fn case(name: &str, obstacles: Vec<Body>, targets: &[f64], x: f64, inertial: WithInertia) -> Case {
    Case { scene: pressed(name, obstacles, targets), right: [x, REST, 0.0], most_turned: ROUNDING, inertial }
}

/// A box whose four corners are cut by 2 mm.
fn chamfered() -> Vec<Part> {
    let (a, b, c) = (0.1, 0.05, 0.002);
    vec![Part::Polygon(vec![[c - a, -b], [a - c, -b], [a, c - b], [a, b - c], [a - c, b], [c - a, b], [-a, b - c], [-a, c - b]])]
}

/// A smooth plate below the box that moves up and along, until its end passes the box's corner.
fn pusher() -> Case {
    let plate =
        Body { path: vec![[0.0, 0.04, -0.0601, 0.0], [3.0, 0.19, -0.03, 0.0]], ..fixed(vec![rectangle([0.0; 2], [0.4, 0.02])], 0.0) };
    let mut case = case("pusher", vec![plate], &[], 0.0, Ends);
    case.scene.springs.clear();
    case.scene.duration = 3.0;
    case.right = [0.0, 0.03, 0.0];
    case
}

/// Walls that end or have a joint under the way of the front corner.
fn ends_and_joints() -> Vec<Case> {
    let long = -1.763;
    let (smooth, rough) = (GROUND_LAG, GROUND_LAG + SIDE_LAG);
    let waiting = 0.137 + GROUND_LAG;
    let pair = |friction| vec![block(long, JOINT, TOP, friction), block(JOINT, 2.237, TOP, friction)];
    let mut chamfer = case("chamfer", tiles(ROUGH), &[0.6], 0.6 - rough, OnePiece(ROUGH));
    chamfer.scene.load = chamfered();
    let mut halves = case("halves", pair(ROUGH), &[0.6], 0.6 - rough, OnePiece(ROUGH));
    halves.scene.load = [-0.05, 0.05].map(|x| rectangle([x, 0.0], [0.1, 0.1])).to_vec();
    vec![
        case("end", vec![line(&[[-2.0, TOP], [JOINT, TOP]], 0.0)], &[0.22], 0.22 - smooth, OnePiece(0.0)),
        case("end-block", vec![block(long, JOINT, TOP, 0.0)], &[0.22], 0.22 - smooth, OnePiece(0.0)),
        case("end-pause", vec![block(long, JOINT, TOP, 0.0)], &[waiting, waiting, 0.22], 0.22 - smooth, OnePiece(0.0)),
        case("end-back", vec![block(long, JOINT, TOP, ROUGH)], &[0.23, 0.05], 0.05 + rough, OnePiece(ROUGH)),
        case("joint", pair(0.0), &[0.6], 0.6 - smooth, OnePiece(0.0)),
        case("joint-start", vec![block(-1.9, 0.1, TOP, ROUGH), block(0.1, 2.1, TOP, ROUGH)], &[0.3], 0.3 - rough, OnePiece(ROUGH)),
        case("tiles", tiles(ROUGH), &[0.6], 0.6 - rough, OnePiece(ROUGH)),
        case("tiles-back", tiles(ROUGH), &[0.3, -0.1], -0.1 + rough, OnePiece(ROUGH)),
        case("gap", vec![block(long, JOINT, TOP, ROUGH), block(0.287, 2.237, TOP, ROUGH)], &[0.6], 0.6 - rough, OnePiece(ROUGH)),
        case(
            "overlap",
            vec![block(long, JOINT, TOP, ROUGH), block(0.2, 2.237, TOP, ROUGH), line(&[[-0.3, TOP], [0.1, TOP]], ROUGH)],
            &[0.6],
            0.6 - rough,
            OnePiece(ROUGH),
        ),
        case("bend-down", vec![line(&[[-2.0, TOP], [JOINT, TOP], [1.237, -0.16]], 0.0)], &[0.22], 0.22 - smooth, OnePiece(0.0)),
        chamfer,
        halves,
    ]
}

/// Two blocks, the second higher by `up` (m), or lower where `up` is negative.
pub fn step(up: f64, target: f64) -> Scene {
    pressed("step", vec![block(-1.763, JOINT, TOP, 0.0), block(JOINT, 2.237, TOP + up, 0.0)], &[target])
}

fn steps_and_inner_corners() -> Vec<Case> {
    let down = |name: &str, up: f64, target: f64, most_turned: f64, inertial| {
        let scene = Scene { name: name.into(), ..step(up, target) };
        let y = if target > 0.3 { REST + up } else { REST };
        Case { scene, right: [target - GROUND_LAG, y, 0.0], most_turned, inertial }
    };
    let up = |name: &str, up: f64| Case {
        scene: Scene { name: name.into(), ..step(up, 0.22) },
        right: [0.137, REST, 0.0],
        most_turned: ROUNDING,
        inertial: Caught(0.137),
    };
    vec![
        // The box turns by the height of the step over half of its length, and rounding.
        down("down-1um", -1e-6, 0.6, 1.1e-5, Ends),
        down("down-5mm", -5e-3, 0.22, ROUNDING, OnePiece(0.0)),
        up("up-1um", 1e-6),
        up("up-5mm", 5e-3),
        case("inner", vec![line(&[[-2.0, TOP], [0.3, TOP], [0.3, 0.3]], 0.0)], &[0.25], 0.2, Ends),
        case(
            "joint-inner",
            vec![block(-1.763, JOINT, TOP, 0.0), block(JOINT, 0.3, TOP, 0.0), raised(0.3, 1.0, 0.1, 0.3, 0.0)],
            &[0.25],
            0.2,
            Ends,
        ),
    ]
}

fn cases() -> Vec<Case> {
    ends_and_joints().into_iter().chain(steps_and_inner_corners()).chain([pusher()]).collect()
}

/// Place of a mass of 1 kg at the time `t` (s) after its tip left at `speed` (m/s), under a
/// friction by which it lags (m).
///
/// It starts as soon as the spring exceeds friction, at lag / speed. From then on its distance from
/// the tip oscillates about the lag with the rate w: x = v s - (v / w) sin w s, with s = t - lag /
/// v. Its speed v (1 - cos w s) never becomes negative, so that the friction keeps its direction.
fn after(speed: f64, lag: f64, t: f64) -> f64 {
    let (rate, since) = (STIFFNESS.sqrt(), t - lag / speed);
    speed * since - speed / rate * (rate * since).sin()
}

/// What is wrong with the end of a run.
fn wrong(name: &str, found: &Run, right: [f64; 3], allowed: f64) -> Option<String> {
    let error = off(found.end(), right);
    (error > allowed).then(|| format!("{name}: ends at {:?}, right is {right:?}, {:?}", found.end(), found.status))
}

#[test]
fn a_box_that_slides_slowly_past_joints_ends_and_steps_ends_where_it_must() {
    let wrong_of = |case: &Case| {
        let found = run(&case.scene, QuasiStatic, Steps::Default);
        let turned = found.most_turned();
        let turned_too_far = || format!("{}: turns by {turned:e} rad on the way", case.scene.name);
        wrong(&case.scene.name, &found, case.right, ROUNDING).or_else(|| (turned > case.most_turned).then(turned_too_far))
    };
    expect_none(cases().par_iter().filter_map(wrong_of).collect());
}

/// What is wrong with a run with inertia at fixed steps.
fn wrong_with_inertia(case: &Case) -> Option<String> {
    let name = &case.scene.name;
    let found = run(&case.scene, Inertial, Steps::Default);
    match case.inertial {
        OnePiece(friction) => {
            let scene = Scene { obstacles: one_piece(friction), ..case.scene.clone() };
            let whole = run(&scene, Inertial, Steps::Default);
            let apart = found.apart(&whole, case.scene.size());
            let is_far = apart > SAME + step_error(&scene, Inertial, &whole);
            is_far.then(|| format!("{name}: {apart:e} of the size from the wall in one piece, {:?}", found.end()))
        }
        Ends if name == "down-1um" => {
            // It tips by 10 urad, whose lever of a decimetre shifts it by a micrometre.
            let right = [after(0.6 / WAY, GROUND_LAG, WAY), case.right[1], 0.0];
            wrong(name, &found, right, 2e-6 + case.scene.size() * step_error(&case.scene, Inertial, &found))
        }
        // Rounding, and the part of the lag that the last steps of a decaying motion still close.
        Ends => wrong(name, &found, case.right, 1e-8),
        Caught(behind) => {
            let farthest = found.poses.iter().map(|pose| pose.position.x).fold(f64::MIN, f64::max);
            // A front corner that is held stays there, and the box turns about it by up to 0.3 rad.
            let (least, most) = (behind - 0.02, behind + 0.02);
            (!(least..most).contains(&farthest)).then(|| format!("{name}: reaches {farthest}, is caught at {behind}"))
        }
    }
}

#[test]
fn a_box_with_inertia_passes_joints_and_ends_as_a_wall_in_one_piece() {
    expect_none(cases().par_iter().filter_map(wrong_with_inertia).collect());
}

#[test]
fn a_box_with_inertia_follows_its_closed_form_past_joints() {
    let closed = |name: &str, speed: f64, lag: f64| (name.to_owned(), [after(speed, lag, WAY), REST, 0.0]);
    let rights = [
        closed("end", 0.22 / WAY, GROUND_LAG),
        closed("end-block", 0.22 / WAY, GROUND_LAG),
        closed("bend-down", 0.22 / WAY, GROUND_LAG),
        closed("joint", 0.6 / WAY, GROUND_LAG),
        closed("joint-start", 0.3 / WAY, GROUND_LAG + SIDE_LAG),
        closed("tiles", 0.6 / WAY, GROUND_LAG + SIDE_LAG),
        closed("gap", 0.6 / WAY, GROUND_LAG + SIDE_LAG),
        closed("overlap", 0.6 / WAY, GROUND_LAG + SIDE_LAG),
        closed("chamfer", 0.6 / WAY, GROUND_LAG + SIDE_LAG),
        closed("halves", 0.6 / WAY, GROUND_LAG + SIDE_LAG),
    ];
    let wrong_of = |(name, right): &(String, [f64; 3])| {
        let case = cases().into_iter().find(|case| case.scene.name == *name).expect("there is such a case");
        wrong(name, &run(&case.scene, Inertial, Steps::Within(ASKED)), *right, KEPT)
    };
    expect_none(rights.par_iter().filter_map(wrong_of).collect());
}

/// The least step that catches, over the size of the box (1). The size is 0.112 m, so that steps of
/// 0.05 nm pass and steps of 0.2 nm catch.
#[test]
fn only_steps_up_beyond_a_billionth_of_the_size_catch() {
    let heights = [0.0, 1e-12, 1e-11, 5e-11, 2e-10, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 5e-3];
    let both: Vec<(f64, f64)> = heights.iter().flat_map(|height| [(*height, 1.0), (*height, -1.0)]).collect();
    let wrong_of = |(height, sign): &(f64, f64)| {
        let found = run(&step(sign * height, 0.22), QuasiStatic, Steps::Default);
        let is_caught = *sign > 0.0 && *height >= 2e-10;
        let right = if is_caught { 0.137 } else { 0.22 - GROUND_LAG };
        // A box that rides over a step that is none is raised by as much.
        let [x, y, heading] = found.end();
        let error = (x - right).abs().max((y - REST).abs()).max(heading.abs());
        (error > ROUNDING).then(|| format!("step of {:e} m: ends at {:?}, right is x {right}", sign * height, found.end()))
    };
    expect_none(both.par_iter().filter_map(wrong_of).collect());
}

/// Writes the scenes and their right answers into the folder `COHAUL_DUMP`.
#[test]
#[ignore = "writes files"]
fn dump_known_scenes() {
    let folder = env::var("COHAUL_DUMP").expect("COHAUL_DUMP names a folder");
    let folder = Path::new(&folder);
    let write = |name: &str, value: &Value| fs::write(folder.join(format!("{name}.json")), format!("{value:#}")).expect("written");
    let mut answers = Map::new();
    for case in cases() {
        write(&case.scene.name, &case.scene.json());
        answers
            .insert(case.scene.name.clone(), json!({ BackendKind::QuasiStatic.name(): case.right, "most_turned_rad": case.most_turned }));
    }
    write("answers", &Value::Object(answers));
}
