//! Every scenario that ships is one the schema knows, reads, and survives expansion; the reference
//! scenes hold the numbers that their known answers rest on.

#[path = "common/random_scenes.rs"]
mod random_scenes;

use std::fs;
use std::path::{Path, PathBuf};

use cohaul::math::Vec2;
use cohaul::model::behaviour::{GraspPace, ReleasePace};
use cohaul::model::open_choices::OPEN_CHOICES;
use cohaul::model::{Outline, OutlinePart, paper};
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
    assert!(files.len() >= 55, "{files:?}");
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
    let among_obstacles = serde_json::to_value(read("paper/wall-with-gap.json").expanded()).unwrap();
    // What ants do about obstacles is not said where there are none.
    let of_avoidance = ["avoidance", "body_radius_m", "look_ahead_m"];
    for key in properties.keys().filter(|key| *key != "preset") {
        assert!(!among_obstacles["drive"][key].is_null(), "{key}");
        assert_eq!(expansion["drive"][key].is_null(), of_avoidance.contains(&key.as_str()), "{key}");
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
        text.replacen("\"../../docs/src/reference/scenario.schema.json\"", "\"https://example.org/scenario.json\"", 1),
        text.replace("\"kind\": \"ants\",", "\"kind\": \"ants\", \"preset\": \"paper\", \"pull_speed_m_per_s\": 0.0252,"),
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
    // Every key of a drive is printed, or an open choice with a range, or no part of the paper's
    // text.
    let open: Vec<&str> = OPEN_CHOICES.iter().filter_map(|choice| choice.key?.strip_prefix("drive.")).collect();
    let own = ["kind", "n_ants", "preset", "nest_position_m", "avoidance", "body_radius_m", "look_ahead_m"];
    for key in ants.as_object().unwrap().keys().map(String::as_str) {
        let (is_printed, is_open) = (paper::ANTS.iter().any(|printed| printed.key == key), open.contains(&key));
        // zeta is printed, its unit is not.
        let n_places = [own.contains(&key), is_printed, is_open].into_iter().filter(|is| *is).count();
        assert_eq!(n_places, if key == "release_steepness_per_n" { 2 } else { 1 }, "{key}");
        assert!(own.contains(&key) || is_inferred(key) != is_printed, "{key}");
    }
    assert_eq!(ants["pull_speed_m_per_s"]["default"], 0.0252);
}

#[test]
fn a_key_beats_its_preset_and_a_preset_beats_the_default() {
    let ants = |drive| ants_of(drive);
    assert_eq!(ants(json!({ "kind": "ants", "n_ants": 4 })), presets::ants(Preset::Paper, 4));
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

/// The preset "paper" has every printed value; each other one names the keys in which it departs
/// from them where people read of it.
#[test]
fn no_preset_replaces_a_printed_value_silently() {
    assert_eq!(Preset::Paper.departures(), []);
    let schema = format::schema();
    let variants = schema["$defs"]["Preset"]["oneOf"].as_array().unwrap();
    for (preset, variant) in Preset::ALL.into_iter().zip(variants) {
        assert_eq!(variant["const"], preset.name());
        let text = variant["description"].as_str().unwrap();
        let departures = preset.departures();
        assert!(departures.iter().all(|departure| !departure.reason.is_empty()), "{preset:?}");
        for printed in paper::ANTS {
            let departs = departures.iter().any(|departure| departure.printed.key == printed.key);
            assert_eq!(text.contains(printed.key), departs, "{preset:?}: {}", printed.key);
        }
    }
    assert_eq!(Preset::default(), Preset::Paper);
    let [half_angle, offset] = Preset::Fitted.departures().try_into().unwrap();
    assert_eq!((half_angle.printed.symbol, half_angle.value), ("beta", 0.6));
    assert_eq!((offset.printed.symbol, offset.value), ("r", 0.0));
}

/// Mass and diameter of both structures; structure 1 yields mainly across its springs, structure 2
/// about as much along them.
#[test]
fn the_structures_are_those_of_the_paper() {
    for (name, mass, diameter, stiffness_ratio) in [
        ("structure-1", paper::STRUCTURE_1_MASS_KG, paper::STRUCTURE_1_DIAMETER_M, 5.0..f64::INFINITY),
        ("structure-2", paper::LOAD_MASS_KG, paper::DIAMETER_M, 0.8..1.25),
    ] {
        let scenario = Scenario::read(format!("scenarios/paper/{name}.json").as_ref()).unwrap();
        assert_eq!(scenario.system.load.mass, mass, "{name}");
        for spring in &scenario.system.springs {
            assert!((2.0 * spring.rest_tip().norm() - diameter).abs() < 1e-9, "{name}");
            let across = spring.torsional_stiffness / spring.rest_length.powi(2);
            assert!(stiffness_ratio.contains(&(spring.radial_stiffness / across)), "{name}");
        }
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

/// A scene of one load, `load`, without anything else but `obstacles`.
fn of_load(load: Value, supports: Value, obstacles: Value) -> Result<Scenario, ScenarioError> {
    let text = json!({
        "name": "a load", "duration_s": 1, "control_period_s": 0.01, "load": load,
        "ground": { "friction_coefficient": 0.5, "gravity_m_per_s2": 10, "supports": supports },
        "springs": [], "obstacles": obstacles, "drive": { "kind": "tips", "paths": [] }
    });
    Scenario::parse(&text.to_string(), "load.json")
}

fn tripod() -> Value {
    json!({ "tripod": { "radius_m": 0.1 } })
}

/// m (w^2 + h^2) / 12 of a rectangle, m R^2 / 2 of a disc, and Steiner's theorem for two discs.
#[test]
fn mass_and_inertia_follow_from_the_outline() {
    let load = |load: Value| of_load(load, tripod(), json!([])).unwrap_or_else(|error| panic!("{error}")).system.load;
    let rectangle = load(json!({ "density_kg_per_m2": 2.0, "outline": { "rectangle": { "size_m": [3, 1] } } }));
    assert!((rectangle.mass - 6.0).abs() < 1e-15 && (rectangle.inertia - 5.0).abs() < 1e-14, "{rectangle:?}");
    assert_eq!(rectangle.radius, 1.5f64.hypot(0.5));
    let (short, long) =
        (json!({ "mass_kg": 0.0016, "radius_m": 0.0122 }), json!({ "mass_kg": 0.0016, "outline": { "disc": { "radius_m": 0.0122 } } }));
    assert_eq!(load(short), load(long));
    let disc = load(json!({ "density_kg_per_m2": 3.0, "radius_m": 2 }));
    assert!((disc.mass / (12.0 * std::f64::consts::PI) - 1.0).abs() < 1e-15 && disc.inertia == 0.5 * disc.mass * 2.0 * 2.0);
    let disc_at = |x: f64| json!({ "outline": { "disc": { "radius_m": 1 } }, "position_m": [x, 0] });
    let two = load(json!({ "mass_kg": 2, "outline": { "compound": { "parts": [disc_at(-2.0), disc_at(2.0)] } } }));
    assert!((two.inertia - 2.0 * (0.5 + 4.0)).abs() < 1e-14 && two.radius == 3.0, "{two:?}");
    // A load that is not uniform may have its centre of mass anywhere.
    let hammer = load(json!({ "mass_kg": 1, "inertia_kg_m2": 0.1, "outline": { "polygon": { "points_m": [[0, 0], [3, 0], [0, 1]] } } }));
    assert_eq!((hammer.inertia, hammer.radius), (0.1, 3.0));
}

#[test]
fn outlines_are_placed_and_turned_counter_clockwise() {
    let load = json!({ "mass_kg": 1, "inertia_kg_m2": 1, "outline": { "compound": { "parts": [{
        "outline": { "polygon": { "points_m": [[0, 0], [0, 1], [2, 1], [2, 0]] } },
        "position_m": [1, 0], "heading_rad": std::f64::consts::FRAC_PI_2 }] } } });
    let scenario = of_load(load, tripod(), json!([])).unwrap();
    let [OutlinePart::Polygon { corners }] = scenario.system.world.outline.parts.as_slice() else { panic!("one polygon is expected") };
    for (corner, by_hand) in corners.iter().zip([[1.0, 0.0], [1.0, 2.0], [0.0, 2.0], [0.0, 0.0]]) {
        assert!((corner - Vec2::from(by_hand)).norm() < 1e-15, "{corners:?}");
    }
    assert_eq!(read("paper/four-ants-four-springs.json").system.world.outline, Outline::disc(0.0122));
}

/// Each rule combines 0.2 and 0.8 to another number.
#[test]
fn side_friction_is_combined_by_the_rule_and_restitution_is_the_larger_one() {
    let found = |rule: &str| {
        let text = json!({
            "name": "a wall", "duration_s": 1, "control_period_s": 0.01,
            "load": { "mass_kg": 1, "radius_m": 1, "side_friction_coefficient": 0.2, "restitution": 0.3 },
            "ground": { "friction_coefficient": 0.5, "supports": tripod() }, "springs": [], "side_friction_rule": rule,
            "obstacles": [
                { "name": "a", "outline": { "disc": { "radius_m": 1 } }, "position_m": [5, 0], "friction_coefficient": 0.8 },
                { "name": "b", "outline": { "disc": { "radius_m": 1 } }, "position_m": [-5, 0], "restitution": 0.7 } ],
            "drive": { "kind": "tips", "paths": [] }
        });
        let scenario = Scenario::parse(&text.to_string(), rule).unwrap();
        assert_eq!(scenario.expanded().checked("again").unwrap(), scenario);
        let [a, b] = scenario.system.world.obstacles.as_slice() else { panic!("two obstacles are expected") };
        assert_eq!((a.restitution, b.restitution), (0.3, 0.7));
        a.friction_coefficient
    };
    for (rule, by_hand) in [("geometric-mean", 0.4), ("average", 0.5), ("min", 0.2), ("multiply", 0.16), ("max", 0.8)] {
        assert!((found(rule) - by_hand).abs() < 1e-16, "{rule}: {}", found(rule));
    }
}

/// Every form of an outline and of a motion survives expansion, and without obstacles nothing of
/// the world stands in the expanded file, so that hashes of such scenes stay.
#[test]
fn a_world_survives_expansion() {
    let wall = json!({ "polyline": { "points_m": [[-9, -9], [9, -9], [9, 9]] } });
    let part = |x: f64| json!({ "outline": { "disc": { "radius_m": 0.5 } }, "position_m": [x, 0], "heading_rad": 0.7 });
    let obstacles = json!([
        { "name": "wall", "outline": wall, "friction_coefficient": 0.3, "restitution": 0.5 },
        { "name": "post aside", "outline": { "compound": { "parts": [part(4.0)] } }, "heading_rad": 1.0 },
        { "name": "both", "outline": { "compound": { "parts": [part(4.0), { "outline": wall }] } } },
        { "name": "box", "outline": { "rectangle": { "size_m": [1, 1] } }, "path": { "waypoints": [[0, 5, 5, 0], [1000, 5, 6, 1]] } },
        { "name": "late", "outline": { "disc": { "radius_m": 1 } }, "path": { "waypoints": [[7, -5, 5, 1]] } }
    ]);
    let load = json!({ "density_kg_per_m2": 1, "outline": { "compound": { "parts": [part(-1.0), part(1.0)] } } });
    let scenario = of_load(load.clone(), json!({ "uniform": { "n": 16 } }), obstacles).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scenario.system.world.obstacles.len(), 5);
    let expansion = serde_json::to_string(&scenario.expanded()).unwrap();
    let again = Scenario::parse(&expansion, "expansion").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((again.hash(), &again), (scenario.hash(), &scenario));
    let alone = of_load(json!({ "mass_kg": 1, "radius_m": 1, "side_friction_coefficient": 0.3 }), tripod(), json!([])).unwrap();
    let expansion = serde_json::to_string(&alone.expanded()).unwrap();
    assert!(["obstacles", "side", "restitution", "outline"].iter().all(|key| !expansion.contains(key)), "{expansion}");
}

/// A support's own coefficient replaces that of the ground, and its slip limit is that of a support
/// with the same product of coefficient and normal load.
#[test]
fn a_support_may_have_its_own_friction() {
    let load = json!({ "mass_kg": 2, "radius_m": 0.4 });
    let support = |x: f64, load: f64, friction: Option<f64>| match friction {
        Some(friction) => json!({ "offset_m": [x, 0.1], "normal_load_n": load, "friction_coefficient": friction }),
        None => json!({ "offset_m": [x, 0.1], "normal_load_n": load }),
    };
    let own = json!([support(-0.2, 10.0, Some(0.25)), support(0.2, 10.0, None), support(0.1, 5.0, Some(0.0))]);
    let scenario = of_load(load.clone(), own, json!([])).unwrap();
    let ground = &scenario.system.ground;
    let limits: Vec<f64> = ground.slip_limits().collect();
    assert_eq!(limits, [2.5, 10.0 * ground.friction_coefficient, 0.0]);
    let expansion = serde_json::to_string(&scenario.expanded()).unwrap();
    assert_eq!(Scenario::parse(&expansion, "expansion").unwrap(), scenario);
    let error = of_load(load, json!([support(0.0, 1.0, Some(-0.1))]), json!([])).unwrap_err().to_string();
    assert!(
        error.contains("ground.supports[0].friction_coefficient: must be zero or positive, found -0.1")
            || error.contains("ground.supports[0].friction_coefficient"),
        "{error}"
    );
}

/// The number of supports of a uniform pressure follows from a tolerance of friction.
#[test]
fn a_uniform_pressure_takes_a_number_or_a_tolerance() {
    let of = |uniform: Value| {
        let load = json!({ "mass_kg": 2, "outline": { "rectangle": { "size_m": [0.4, 0.4] } } });
        of_load(load, json!({ "uniform": uniform }), json!([]))
            .map(|scenario| scenario.system.ground.supports.len())
            .map_err(|error| error.to_string())
    };
    assert_eq!(of(json!({ "tolerance": 0.02 })).unwrap(), 100);
    assert_eq!(of(json!({ "n": 100 })).unwrap(), 100);
    for (uniform, fault) in [
        (json!({}), "ground.supports.uniform: must have n or tolerance, found neither"),
        (json!({ "n": 16, "tolerance": 0.1 }), "ground.supports.uniform: must have either n or tolerance, found both"),
        (json!({ "tolerance": 1e-5 }), "ground.supports.uniform.tolerance: must be from 0.0002 to 0.6666666666666666, found"),
    ] {
        let found = of(uniform).unwrap_err();
        assert!(found.contains(fault), "{found}");
    }
}

#[test]
fn uniform_supports_carry_the_weight_below_the_centre_of_mass() {
    let uniform = json!({ "uniform": { "n": 16 } });
    let load = json!({ "mass_kg": 2, "outline": { "rectangle": { "size_m": [0.4, 0.4] } } });
    let supports = of_load(load, uniform.clone(), json!([])).unwrap().system.ground.supports;
    assert_eq!(supports.len(), 16);
    assert!(supports.iter().all(|support| (support.normal_load - 20.0 / 16.0).abs() < 1e-14));
    // Mass and inertia of a load that is not uniform do not tell its pressure.
    let corner = json!({ "mass_kg": 1, "inertia_kg_m2": 0.1, "outline": { "polygon": { "points_m": [[0, 0], [3, 0], [0, 3]] } } });
    let error = of_load(corner, uniform, json!([])).unwrap_err().to_string();
    assert!(error.contains("load.outline: must have its centroid at the origin") && error.lines().count() == 1, "{error}");
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

/// Known answers of contact are for the paper's mass, friction and stiffness, with the tip on the
/// centre of the load, and for obstacles that the load does not overlap at the start.
#[test]
fn scenes_of_contact_have_the_numbers_of_their_known_answers() {
    let files: Vec<_> = every_file().into_iter().filter(|file| file.parent().unwrap().ends_with("contact")).collect();
    assert!(files.len() >= 12, "{files:?}");
    for file in files {
        let Scenario { system, .. } = Scenario::read(&file).unwrap();
        assert!(!system.world.is_empty() && (system.total_slip_limit() - SLIP_LIMIT).abs() < 1e-15, "{}", file.display());
        assert!(system.springs.iter().all(|spring| spring.radial_stiffness == STIFFNESS && spring.rest_length == 0.0));
    }
    // Twice the slip limit pulls the load of the jump.
    let jump = read("contact/jump-to-wall.json");
    let pull = STIFFNESS * tip_paths(&jump)[0].waypoints[0].position.x;
    assert!((pull - 2.0 * SLIP_LIMIT).abs() < 1e-16, "{pull}");
}

/// Springs that are held from the start have no slack there: their tips begin at the rest shape, or
/// at the root of an isotropic spring, unless the scene says otherwise by its name. Scenes of
/// contact start where their known answers do.
#[test]
fn prescribed_tips_start_at_rest() {
    for file in every_file() {
        let scenario = Scenario::read(&file).unwrap();
        let Drive::Tips(paths) = &scenario.drive else { continue };
        if file.file_name().unwrap().to_str().unwrap().starts_with("hold-") || file.parent().unwrap().ends_with("contact") {
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
