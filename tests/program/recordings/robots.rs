//! Three robots that bring a crate through a doorway, as a camera above them writes them down:
//! marks on the crate and on all robots, with noise and lost frames. The crate has inertia.
//! `COHAUL_REWRITE=1` writes the file anew.

use std::collections::BTreeMap;
use std::fmt::Write;

use cohaul::backend::BackendKind;
use cohaul::scenario::Scenario;
use cohaul_recordings::account::Kind;
use cohaul_recordings::import::{Asked, Import, import};
use cohaul_recordings::repair::Bounds;
use cohaul_recordings::scene::Roles;
use cohaul_recordings::tracks::Reading;

use crate::draws::Draws;
use crate::{root, scene, tips_by, trace_by};

const FILE: &str = "examples/recordings/robots.csv";
/// Frames per second.
const FPS: f64 = 25.0;
/// Standard deviations of the places (mm) and of the headings (degrees).
const NOISE: [f64; 2] = [0.1, 0.05];
/// Share of the marks that the camera loses (1).
const LOST: f64 = 0.02;

fn doorway() -> Scenario {
    scene("examples/recordings/doorway.json")
}

fn recording() -> String {
    let (scene, mut draws) = (doorway(), Draws::new(1));
    // The crate and both tips in each frame.
    let mut frames: BTreeMap<u64, ([f64; 3], [[f64; 2]; 2])> = BTreeMap::new();
    for line in tips_by(&scene, BackendKind::Inertial).lines().skip(1) {
        let cells: Vec<f64> = line.split(',').take(7).map(|cell| cell.parse().unwrap()).collect();
        let number = cells[0] * FPS;
        if (number - number.round()).abs() < 1e-6 {
            let frame = frames.entry(number.round() as u64).or_default();
            frame.0 = [cells[2], cells[3], cells[4]];
            frame.1[cells[1] as usize] = [cells[5], cells[6]];
        }
    }
    let mut text = "frame,robot,x_mm,y_mm,angle_deg\n".to_owned();
    for (number, (crate_pose, [red, green])) in frames {
        let blue = scene.system.world.obstacles[2].path.pose_at(number as f64 / FPS).position;
        let marks =
            [("crate", crate_pose), ("red", [red[0], red[1], 0.0]), ("green", [green[0], green[1], 0.0]), ("blue", [blue.x, blue.y, 0.0])];
        for (name, [x, y, heading]) in marks {
            let mut noisy = |value: f64, deviation: f64| {
                value + deviation * (-2.0 * draws.unit().ln()).sqrt() * (std::f64::consts::TAU * draws.unit()).cos()
            };
            let [x, y] = [x, y].map(|metres| noisy(1e3 * metres, NOISE[0]));
            let heading = noisy(heading.to_degrees(), NOISE[1]);
            // The first frame has all marks, so that the crate starts where it was seen.
            if !draws.is(LOST) || number == 0 {
                writeln!(text, "{number},{name},{x:.2},{y:.2},{heading:.2}").unwrap();
            }
        }
    }
    text
}

/// The options of the book.
fn asked() -> Asked {
    let pair = |track: &str, spring: usize| (track.to_owned(), spring);
    let roles = Roles {
        springs: vec![pair("red", 0), pair("green", 1)],
        load: vec!["crate".to_owned()],
        obstacles: vec![("blue".to_owned(), "pusher".to_owned())],
    };
    Asked { roles, bounds: Bounds { smooth: Some(5e-4), ..Bounds::default() }, ..Asked::default() }
}

#[test]
fn three_robots_in_a_doorway_are_read_and_move_the_crate_as_they_did() {
    let text = recording();
    let path = root::root().join(FILE);
    if std::env::var_os("COHAUL_REWRITE").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let stored = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(stored == text, "run this test with COHAUL_REWRITE=1");

    let like = std::fs::read(root::root().join("examples/recordings/doorway.json")).unwrap();
    let mut asked = asked();
    asked.units.fps = Some(FPS);
    let files = [Reading { file: FILE, bytes: text.as_bytes() }];
    let found = import(&files, Some(Reading { file: "doorway.json", bytes: &like }), &asked);
    let Import { scenario, account, .. } = found.unwrap_or_else(|error| panic!("{error}"));
    assert!(account.count(Kind::ReleasesInferred) == 0 && account.count(Kind::Bridged) > 5, "{}", account.text());
    // A smooth path is within the bound of places that are off by four deviations at most.
    let off = |truth: &Scenario| {
        let at = |scene: &Scenario, time: f64| scene.system.world.obstacles[2].path.pose_at(time).position;
        (0..1200).map(|k| 0.01 * f64::from(k)).map(|time| (at(truth, time) - at(&scenario, time)).norm()).fold(0.0, f64::max)
    };
    assert!(off(&doorway()) < 5e-4 + 4e-3 * NOISE[0], "{}", off(&doorway()));

    // A hundredth of the way is the tolerance of a verdict. The post magnifies small differences.
    let (found, wanted) = (effect(&scenario), effect(&doorway()));
    assert!((0.5..2.0).contains(&(found / wanted)) && found.min(wanted) > 0.01, "{found} m, {wanted} m");
}

/// Largest distance between the crates with and without inertia (m).
fn effect(scene: &Scenario) -> f64 {
    let [one, other] = [BackendKind::QuasiStatic, BackendKind::Inertial].map(|backend| trace_by(scene, backend).rows);
    one.iter().zip(&other).map(|(one, other)| (one.motion.pose.position - other.motion.pose.position).norm()).fold(0.0, f64::max)
}
