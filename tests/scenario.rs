//! Every scenario that ships is one the schema knows, reads, and survives expansion; the reference
//! scenes hold the numbers that their known answers rest on.

#[path = "common/random_scenes.rs"]
mod random_scenes;

use std::fs;
use std::path::{Path, PathBuf};

use cohaul::math::Vec2;
use cohaul::model::behaviour::{GraspPace, ReleasePace};
use cohaul::scenario::presets::{self, Preset};
use cohaul::scenario::{AntDrive, Drive, Scenario, ScenarioError, TipPath, format};
use serde_json::{Value, json};

use random_scenes::random_scenario;

/// mu m g of the paper's load (N).
const SLIP_LIMIT: f64 = 1.4 * 0.0016 * 9.81;
const STIFFNESS: f64 = 0.664;

/// Position of a tip (m) at a time (s), given where the undeformed springs end (m).
type TipFormula = fn(f64, f64) -> [f64; 2];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios")
}

fn read(name: &str) -> Scenario {
    Scenario::read(&root().join(name)).unwrap_or_else(|error| panic!("{error}"))
}

fn every_file() -> Vec<PathBuf> {
    let list = |folder: &Path| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let mut files: Vec<_> = list(&root()).iter().filter(|path| path.is_dir()).flat_map(|folder| list(folder)).collect();
    files.sort();
    // A wrong folder would pass every test below; the number is that of the files that were
    // written.
    assert!(files.len() >= 26, "{files:?}");
    files
}

fn tip_paths(scenario: &Scenario) -> &[TipPath] {
    match &scenario.drive {
        Drive::Tips(paths) => paths,
        Drive::Ants(_) => panic!("prescribed paths expected"),
    }
}

fn with_drive(drive: Value) -> Result<Scenario, ScenarioError> {
    let text = json!({
        "name": "ants", "duration_s": 10, "control_period_s": 0.0025,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122 },
        "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.008 } } },
        "springs": [{ "ring": { "n": 4, "radius_m": 0.0122, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
            "torsional_stiffness_nm_per_rad": 4.52e-4 } }],
        "drive": drive
    });
    Scenario::parse(&text.to_string(), "ants.json")
}

fn ants_of(drive: Value) -> AntDrive {
    match with_drive(drive).unwrap_or_else(|error| panic!("{error}")).drive {
        Drive::Ants(ants) => ants,
        Drive::Tips(_) => panic!("ants expected"),
    }
}

#[test]
fn every_file_fits_the_schema_and_its_expansion_reads_back_equal() {
    let schema = jsonschema::validator_for(format::schema()).unwrap();
    for file in every_file() {
        let text = fs::read_to_string(&file).unwrap();
        let value: Value = serde_json::from_str(&text).unwrap();
        assert!(schema.is_valid(&value), "{}: {}", file.display(), schema.iter_errors(&value).next().unwrap());
        let scenario = Scenario::read(&file).unwrap_or_else(|error| panic!("{error}"));
        let expansion = serde_json::to_string_pretty(&scenario.expanded()).unwrap();
        assert!(schema.is_valid(&serde_json::from_str(&expansion).unwrap()), "{}", file.display());
        let again = Scenario::parse(&expansion, "expansion").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(again, scenario, "{}", file.display());
        assert_eq!(again.hash(), scenario.hash());
        assert_eq!(scenario.expanded().checked("in code").unwrap(), scenario);
        // The short forms were taken apart, so the comparison above is not of a text with itself.
        assert_ne!(expansion, text);
    }
}

#[test]
fn an_expansion_leaves_nothing_to_defaults() {
    let expansion = serde_json::to_value(read("paper/four-ants-four-springs.json").expanded()).unwrap();
    assert_eq!(expansion["springs"].as_array().unwrap().len(), 4);
    assert_eq!(expansion["ground"]["supports"].as_array().unwrap().len(), 3);
    assert!(expansion["load"]["inertia_kg_m2"].is_number());
    let properties = format::schema()["$defs"]["AntsEntry"]["properties"].as_object().unwrap().clone();
    for key in properties.keys().filter(|key| *key != "preset") {
        assert!(!expansion["drive"][key].is_null(), "{key}");
    }
    assert!(expansion["drive"].get("preset").is_none());
}

#[test]
fn the_hash_is_that_of_the_scenario_and_not_of_its_writing() {
    let text = fs::read_to_string(root().join("paper/four-ants-four-springs.json")).unwrap();
    let hash = |text: &str| Scenario::parse(text, "text").unwrap().hash();
    let other_writings = [
        text.replace('\n', " "),
        text.replace("300.0", "3e2").replace("0.0016", "1.6E-3"),
        text.replace("\"gravity_m_per_s2\": 9.81,", ""),
        text.replace("\"radius_m\": 0.0122 },", "\"radius_m\": 0.0122, \"heading_rad\": -0.0, \"position_m\": [0, -0.0] },"),
        text.replacen('{', "{ \"$schema\": \"https://example.org/scenario.json\",", 1),
        text.replace("\"kind\": \"ants\",", "\"kind\": \"ants\", \"preset\": \"default\", \"pull_speed_m_per_s\": 0.05,"),
    ];
    for writing in other_writings {
        assert_ne!(writing, text);
        assert_eq!(hash(&writing), hash(&text), "{writing}");
    }
    assert_ne!(hash(&text.replace("\"seed\": 1", "\"seed\": 2")), hash(&text));
    assert_ne!(hash(&text.replace("0.0016", "0.0016000000000000003")), hash(&text));
    assert_eq!(hash(&text).len(), 64);
}

#[test]
fn the_schema_describes_every_key_and_says_what_is_inferred() {
    let schema = format::schema();
    let definitions = schema["$defs"].as_object().unwrap();
    for (name, definition) in definitions.iter().chain([(&"file".to_string(), schema)]) {
        for (key, property) in definition["properties"].as_object().into_iter().flatten() {
            let described = property["description"].is_string();
            assert!(described || ["kind", "tripod", "ring"].contains(&key.as_str()), "{name}.{key}");
        }
    }
    let ants = &definitions["AntsEntry"]["properties"];
    let is_inferred = |key: &str| ants[key]["description"].as_str().unwrap().contains("is inferred");
    for key in ["pull_speed_m_per_s", "sensing_range_m", "steering_half_angle_rad", "release_decision_period_s"] {
        assert!(is_inferred(key), "{key}");
    }
    assert!(!is_inferred("grasp_probability") && !is_inferred("steering_gain_per_s"));
    assert_eq!(ants["pull_speed_m_per_s"]["default"], 0.05);
}

#[test]
fn a_key_beats_its_preset_and_a_preset_beats_the_default() {
    let ants = |drive| ants_of(drive);
    assert_eq!(ants(json!({ "kind": "ants", "n_ants": 4 })), presets::ants(Preset::Default, 4));
    let speedy = ants(json!({ "kind": "ants", "n_ants": 4, "preset": "paper-speed" }));
    assert_eq!((speedy.pull_speed, speedy.release.period, speedy.release_pace), (0.08, 0.106, ReleasePace::Hazard));
    let own = ants(json!({ "kind": "ants", "n_ants": 4, "preset": "paper-speed", "pull_speed_m_per_s": 0.05 }));
    assert_eq!((own.pull_speed, own.release.period), (0.05, 0.106));
    let aged = ants(json!({ "kind": "ants", "n_ants": 1, "preset": "aged" }));
    assert_eq!((aged.pull_speed, aged.release.period, aged.release_pace), (0.08, 0.08, ReleasePace::Aged));
    let newtons = ants(json!({ "kind": "ants", "n_ants": 1, "preset": "literal-newtons" }));
    assert_eq!((newtons.grasp_pace, newtons.release_pace, newtons.release.steepness), (GraspPace::PerTick, ReleasePace::PerTick, 100.0));
    let millinewtons = ants(json!({ "kind": "ants", "n_ants": 1, "preset": "literal-millinewtons" }));
    // The millinewton reading is a hard limit at F_m / 2 = 10 mN: a tenth of a millinewton below
    // and above it.
    assert!(millinewtons.release.probability(9.9e-3) < 1e-4 && millinewtons.release.probability(10.1e-3) > 1.0 - 1e-4);
    for preset in Preset::ALL {
        let name = serde_json::to_value(preset).unwrap();
        assert_eq!(ants(json!({ "kind": "ants", "n_ants": 2, "preset": name })), presets::ants(preset, 2));
    }
}

/// Three supports under the centre of mass by hand: moments about the axes give the loads.
#[test]
fn loads_left_out_follow_from_the_centre_of_mass() {
    let file = |supports: Value| {
        json!({
            "name": "", "duration_s": 1, "control_period_s": 0.1,
            "load": { "mass_kg": 2, "radius_m": 0.5 },
            "ground": { "friction_coefficient": 0.5, "gravity_m_per_s2": 10, "supports": supports },
            "springs": [], "drive": { "kind": "tips", "paths": [] }
        })
        .to_string()
    };
    let corner = json!([{ "offset_m": [-1, -1] }, { "offset_m": [3, -1] }, { "offset_m": [-1, 1] }]);
    let scenario = Scenario::parse(&file(corner), "corner").unwrap();
    let loads: Vec<f64> = scenario.system.ground.supports.iter().map(|support| support.normal_load).collect();
    for (load, by_hand) in loads.iter().zip([5.0, 5.0, 10.0]) {
        assert!((load - by_hand).abs() < 1e-14, "{loads:?}");
    }
    // Default inertia m R^2 / 2.
    assert_eq!(scenario.system.load.inertia, 0.25);
    // On the edge between two supports the third carries nothing and the load still stands.
    let edge = json!([{ "offset_m": [-1, 0] }, { "offset_m": [1, 0] }, { "offset_m": [0, 1] }]);
    assert_eq!(Scenario::parse(&file(edge), "edge").unwrap().system.ground.supports[2].normal_load, 0.0);
    let short = Scenario::parse(&file(json!({ "tripod": { "radius_m": 0.3 } })), "tripod").unwrap();
    let first = short.system.ground.supports[0];
    assert!((first.offset.y - 0.3).abs() < 1e-16 && first.offset.x.abs() < 1e-16);
    assert_eq!(first.normal_load, 20.0 / 3.0);
    let ring = json!({ "ring": { "n": 3, "radius_m": 0.3, "first_bearing_rad": std::f64::consts::FRAC_PI_2 } });
    assert_eq!(Scenario::parse(&file(ring), "ring").unwrap().system, short.system);
}

#[test]
fn a_group_of_springs_stands_in_place_and_points_outwards() {
    let springs = read("paper/ten-ants-ten-springs.json").system.springs;
    assert_eq!(springs.len(), 10);
    for (index, spring) in springs.iter().enumerate() {
        let bearing = std::f64::consts::TAU * index as f64 / 10.0;
        assert_eq!(spring.bearing, bearing);
        // Rounding of a sine and a cosine times 12 mm.
        assert!((spring.root - 0.0122 * cohaul::math::direction(bearing)).norm() < 1e-17);
        assert!((spring.rest_tip().norm() - 0.0385).abs() < 1e-16);
    }
}

/// A load that carries the numbers of the paper: slip limit, tripod radius 2 R_L / 3, and chi = I /
/// (m a^2) = 9 / 8.
#[test]
fn the_paper_load_has_the_derived_constants() {
    let system = read("paper/four-ants-four-springs.json").system;
    assert!((system.total_slip_limit() - SLIP_LIMIT).abs() < 1e-16);
    let arm = system.ground.supports[1].offset.norm();
    assert!((system.load.inertia / (system.load.mass * arm * arm) - 1.125).abs() < 1e-14);
}

/// Springs that are held from the start have no slack there: their tips begin at the rest shape, or
/// at the root of an isotropic spring, unless the scene says otherwise by its name.
#[test]
fn prescribed_tips_start_at_rest() {
    for file in every_file() {
        let scenario = Scenario::read(&file).unwrap();
        let Drive::Tips(paths) = &scenario.drive else { continue };
        if file.file_name().unwrap().to_str().unwrap().starts_with("hold-") {
            continue;
        }
        for path in paths.iter().filter(|path| path.waypoints[0].time == 0.0) {
            let rest = scenario.start.pose.to_world(&scenario.system.springs[path.spring].rest_tip());
            // Tips are written with nine decimals.
            assert!((path.waypoints[0].position - rest).norm() < 1e-9, "{} {}", file.display(), path.spring);
        }
    }
}

/// Opposed springs load each other to 2.5 times the slip limit f, so their sum never moves the
/// load; letting one go leaves the net force F_0 = 2.5 f. Then a method without inertia moves
/// by (F_0 - f) / k = 1.5 f / k, and an undamped load by 2 (F_0 - f) / k = 3 f / k. There the
/// spring pushes back with half of f, which friction holds: no second swing.
#[test]
fn the_release_jump_leaves_two_and_a_half_slip_limits() {
    let scenario = read("analytic/release-jump.json");
    let paths = tip_paths(&scenario);
    let end = |path: &TipPath| path.waypoints.last().unwrap().position;
    assert_eq!(end(&paths[0]), -end(&paths[1]));
    assert!(scenario.system.springs.iter().all(|spring| spring.is_isotropic() && spring.root.norm() == 0.0));
    let released_force = STIFFNESS * end(&paths[0]).x;
    assert!((released_force / SLIP_LIMIT - 2.5).abs() < 1e-14);
    assert_eq!((paths[0].release, paths[1].release), (None, Some(1.5)));
    // A half swing lasts pi / omega_n = 0.154 s.
    assert!(scenario.duration > 1.5 + 0.2);
}

#[test]
fn the_reference_tips_follow_their_formulas() {
    let scenario = read("analytic/qs-ref-1.json");
    let rim = 0.0122 + 0.0263;
    let formulas: [(usize, TipFormula); 3] = [
        (0, |s, rim| [rim + 0.06 * s, 0.02 * (3.0 * s).sin()]),
        (1, |s, rim| [0.03 * s, rim + 0.02 * s - 0.01 * s * s]),
        (3, |s, rim| [0.045 * s + 0.01 * (4.0 * s).sin(), -rim - 0.01 * s]),
    ];
    for (path, (spring, formula)) in tip_paths(&scenario).iter().zip(formulas) {
        assert_eq!((path.spring, path.waypoints.len()), (spring, 1001));
        for (index, waypoint) in path.waypoints.iter().enumerate() {
            let s = index as f64 / 1000.0;
            assert_eq!(waypoint.time, s);
            // Rounding of positions of order 0.1 m, and one sine of another library.
            assert!((waypoint.position - cohaul::math::Vec2::from(formula(s, rim))).norm() < 5e-17, "{spring} {index}");
        }
    }
}

/// Start values of the tripod scenes in units of sqrt(mu g a) and sqrt(mu g / a), and every scene
/// long enough to come to rest.
#[test]
fn sliding_scenes_start_at_their_numbers_and_outlast_them() {
    let rows = [
        ("tripod-slide-spin-pinned", 1.125, 0.3, 1.17304797462500),
        ("tripod-spin-pinned", 1.125, 3.0, 3.66144901874697),
        ("tripod-slide-spin-free", 0.2, 0.3, 1.00552965937042),
    ];
    for (name, chi, turn_rate, end) in rows {
        let scenario = read(&format!("analytic/{name}.json"));
        let load = &scenario.system.load;
        let arm: f64 = 2.0 * load.radius / 3.0;
        let acceleration = 1.4 * 9.81;
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-14;
        assert!(close(load.inertia, chi * load.mass * arm * arm), "{name}");
        assert!(close(scenario.start.twist.linear.x, (acceleration * arm).sqrt()), "{name}");
        assert!(close(scenario.start.twist.angular, turn_rate * (acceleration / arm).sqrt()), "{name}");
        assert!(scenario.duration > end * (arm / acceleration).sqrt(), "{name}");
    }
    // v / (mu g) = 14.6 ms and omega I / (mu m g a) = 54 ms.
    assert!(read("analytic/slide.json").duration > 0.0146);
    assert!(read("analytic/spin.json").duration > 0.054);
    assert!(read("analytic/slide-spin.json").duration > 0.054);
}

/// Held below the limit: 0.9 of the slip limit through the centre, and 0.9 of 2/3 of it across a
/// support, where a force at right angles to the arm b = a of a tripod with a support there starts
/// to move it: F / f = a (b + a) / (b^2 + a b + a^2).
#[test]
fn held_pulls_are_nine_tenths_of_the_critical_force() {
    for (name, critical) in [("hold-below-limit", 1.0), ("hold-below-limit-off-centre", 2.0 / 3.0)] {
        let scenario = read(&format!("stress/{name}.json"));
        let spring = scenario.system.springs[0];
        let pull = STIFFNESS * (tip_paths(&scenario)[0].waypoints[0].position - spring.root).norm();
        assert!((pull / (critical * SLIP_LIMIT) - 0.9).abs() < 1e-14, "{name}");
    }
}

#[test]
fn a_seed_has_one_random_scenario_and_another_seed_another() {
    assert_eq!(random_scenario(7), random_scenario(7));
    assert_ne!(random_scenario(7).system, random_scenario(8).system);
}

#[test]
fn random_scenarios_are_different_and_keep_to_their_ranges() {
    let scenes: Vec<Scenario> = (0..300).map(random_scenario).collect();
    let share = |keep: &dyn Fn(&&Scenario) -> bool| scenes.iter().filter(keep).count() as f64 / 300.0;
    // Five standard deviations of a share of 300 are 0.14 at most.
    assert!((share(&|scene| matches!(scene.drive, Drive::Ants(_))) - 1.0 / 6.0).abs() < 0.14);
    assert!((share(&|scene| scene.start.twist.linear.norm() > 0.0) - 1.0 / 6.0).abs() < 0.14);
    let masses = || scenes.iter().map(|scene| scene.system.load.mass);
    assert!(masses().fold(f64::INFINITY, f64::min) < 1e-4 && masses().fold(0.0, f64::max) > 0.1);
    for scene in &scenes {
        assert!((1..=10).contains(&scene.system.springs.len()) && scene.system.total_slip_limit() > 0.0, "{}", scene.name);
        assert!(scene.system.springs.iter().all(|spring| (0.0..=2.0).contains(&spring.damping_ratio)));
        // The weight acts at the load's origin.
        let moment: Vec2 = scene.system.ground.supports.iter().map(|support| support.normal_load * support.offset).sum();
        assert!(moment.norm() < 1e-15 * scene.system.load.mass.max(1.0), "{}", scene.name);
    }
}
