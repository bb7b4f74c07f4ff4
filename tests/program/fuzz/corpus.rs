//! The files that are changed: those of the project, and small ones made here.

use std::fs;
use std::path::{Path, PathBuf};

use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation};
use cohaul_report::tips_csv::write_tips;
use serde_json::{Value, json};

/// Files in a folder and below it with this ending, in the order of their names.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.extension().is_some_and(|own| own == ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Texts of at most this length (bytes), so that thousands of them are read in a second.
const LONGEST: usize = 60_000;

fn texts(folder: &str, ending: &str) -> Vec<Vec<u8>> {
    let texts = files(&crate::root::root().join(folder), ending).into_iter().map(|path| fs::read(path).unwrap());
    texts.filter(|text| text.len() < LONGEST).collect()
}

pub fn values(texts: &[Vec<u8>]) -> Vec<Value> {
    texts.iter().map(|text| serde_json::from_slice(text).unwrap()).collect()
}

/// All scenarios of the project.
pub fn scenarios() -> Vec<Vec<u8>> {
    [texts("scenarios", "json"), texts("tests/common", "json"), vec![small().into_bytes()]].concat()
}

/// The project's baselines with every twentieth row of their paths.
pub fn baselines() -> Vec<Vec<u8>> {
    let read = |path: PathBuf| -> Value { serde_json::from_slice(&fs::read(path).unwrap()).unwrap() };
    let mut values: Vec<Value> = files(&crate::root::root().join("tests/baselines"), "json").into_iter().map(read).collect();
    for value in &mut values {
        let rows = value["path"]["rows"].as_array_mut().unwrap();
        let last = rows.len() - 1;
        *rows = rows.iter().enumerate().filter(|(at, _)| at % 20 == 0 || *at == last).map(|(_, row)| row.clone()).collect();
    }
    values.iter().map(|value| value.to_string().into_bytes()).collect()
}

/// Two tips pull a load along a wall while a pusher comes.
pub fn small() -> String {
    let scene = json!({
        "name": "tips beside a wall", "duration_s": 0.5, "control_period_s": 0.01,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122, "side_friction_coefficient": 0.3, "restitution": 0.2 },
        "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.008 } } },
        "springs": [{ "ring": { "n": 3, "radius_m": 0.0122, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
            "torsional_stiffness_nm_per_rad": 4.52e-4, "damping_ratio": 0.1 } }],
        "obstacles": [
            { "name": "wall", "outline": { "rectangle": { "size_m": [0.01, 0.2] } }, "position_m": [0.02, 0.0] },
            { "name": "pusher", "outline": { "disc": { "radius_m": 0.01 } },
              "path": { "waypoints": [[0, -0.05, 0, 0], [0.3, -0.02, 0.01, 0]] } }],
        "drive": { "kind": "tips", "paths": [
            { "spring": 0, "waypoints": [[0.0, 0.0385, 0.0], [0.2, 0.09, 0.01], [0.5, 0.09, 0.03]], "release_s": 0.45 },
            { "spring": 2, "waypoints": [[0.01, -0.02, -0.034], [0.1, 0.0, -0.034]], "release_s": 0.15 } ] }
    });
    scene.to_string()
}

pub const ANTS: &str = include_str!("../../../scenarios/paper/four-ants-four-springs.json");

pub fn scene(text: &str) -> Scenario {
    Scenario::parse(text, "scene").unwrap()
}

/// The run of a scene on a backend up to a time (s).
pub fn run_until<'a>(scenario: &'a Scenario, kind: BackendKind, keep: Keep, time: f64) -> Simulation<'a> {
    let options = BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
    let mut run = Simulation::new(scenario, &options, keep);
    run.run(|now| now < time);
    run
}

/// Tables of tips that two scenes wrote.
pub fn tips() -> Vec<Vec<u8>> {
    let table = |text: &str, time: f64| {
        let scenario = scene(text);
        let run = run_until(&scenario, BackendKind::QuasiStatic, Keep::Trace, time);
        let mut table = Vec::new();
        write_tips(run.trace(), &mut table).unwrap();
        table
    };
    let in_root = "time_s,spring,tip_in_root_x_m,tip_in_root_y_m\n0,0,0.027,0\n0,1,0.03,0.001\n0.1,0,0.028,0.002\n";
    vec![table(&small(), 0.5), table(ANTS, 4.0), in_root.as_bytes().to_vec()]
}
