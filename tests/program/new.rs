//! `cohaul scenario new`: what it writes passes the checks and runs, and nothing is overwritten.

#[path = "../common/root.rs"]
mod root;

use std::fs;
use std::path::Path;
use std::process::Output;

use cohaul::scenario::{Scenario, format};
use serde_json::Value;

fn call(folder: &Path, args: &[&str]) -> Output {
    root::cohaul().current_dir(folder).args(args).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// Options of scenes from a crate to a coin, with one robot and with many, on ice and on rubber.
const SCENES: [&str; 8] = [
    "",
    "--robots 1 --outline disc --size 0.3 --mass 1.5 --friction 0.2 --speed 0.05",
    "--robots 3 --outline box --size 0.4x0.3 --mass 2 --friction 0.5 --speed 0.1",
    "--robots 7 --outline disc --size 2 --mass 300 --friction 0.8 --speed 0.5",
    "--robots 2 --outline box --size 0.05 --mass 0.02 --friction 1.5 --speed 0.01",
    "--robots 4 --outline box --size 3x0.2 --mass 20 --friction 0 --speed 1",
    "--robots 100 --outline disc --size 0.0244 --mass 0.0016 --friction 1.4 --speed 0.05",
    "--robots 5 --outline box --size 1x1 --mass 50 --friction 0.01 --speed 3",
];

#[test]
fn new_scenes_pass_the_check_without_a_warning_and_run() {
    let room = tempfile::tempdir().unwrap();
    let schema = jsonschema::validator_for(format::schema()).unwrap();
    for (at, options) in SCENES.iter().enumerate() {
        let file = format!("scene-{at}.json");
        let args: Vec<&str> = ["scenario", "new", &file].into_iter().chain(options.split_whitespace()).collect();
        let output = call(room.path(), &args);
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""), "{options}");
        let path = room.path().join(&file);
        let value: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        assert!(schema.is_valid(&value), "{options}");
        let named = value["$schema"].as_str().unwrap();
        let beside: Value = serde_json::from_str(&fs::read_to_string(room.path().join(named)).unwrap()).unwrap();
        assert_eq!(&beside, format::schema());
        let scenario = Scenario::read(&path).unwrap();
        assert_eq!(scenario.warnings(), [], "{options}");
        let output = call(room.path(), &["run", &file, "--json"]);
        assert_eq!(output.status.code(), Some(0), "{options}: {}", text(&output.stderr));
        let run: Value = serde_json::from_str(text(&output.stdout)).unwrap();
        // The tips go four radii along x, and the load follows but for the stretch of its springs.
        let (moved, radius) = (run["final"]["position_m"][0].as_f64().unwrap(), scenario.system.load.radius);
        assert!((moved / radius - 4.0).abs() < 0.5, "{options}: {moved} of {radius}");
        assert_eq!(run["steps"]["n_not_converged"], 0, "{options}");
    }
}

#[test]
fn nothing_is_overwritten_and_wrong_options_write_nothing() {
    let room = tempfile::tempdir().unwrap();
    let refused = |args: &[&str], words: &[&str]| {
        let output = call(room.path(), &[&["scenario", "new"], args].concat());
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {told}");
        assert!(words.iter().all(|word| told.contains(word)), "{args:?}: {told}");
    };
    refused(&["x.json", "--outline", "disc", "--size", "0.4x0.3"], &["--size", "one length for a disc"]);
    refused(&["x.json", "--size", "40cm"], &["--size", "as in 0.4x0.3"]);
    refused(&["x.json", "--robots", "0"], &["--robots", "from 1 to 100"]);
    refused(&["x.json", "--mass", "-2"], &["--mass", "must be positive"]);
    refused(&["x.json", "--mass", "1e60"], &["--mass", "from 1e-50 to 1e50"]);
    refused(&["."], &["must be a file, found a folder"]);
    assert_eq!(fs::read_dir(room.path()).unwrap().count(), 0);
    assert_eq!(call(room.path(), &["scenario", "new", "x.json"]).status.code(), Some(0));
    let before = fs::read(room.path().join("x.json")).unwrap();
    refused(&["x.json", "--mass", "3"], &["x.json: already exists", "--force"]);
    assert_eq!(fs::read(room.path().join("x.json")).unwrap(), before);
    assert_eq!(call(room.path(), &["scenario", "new", "x.json", "--mass", "3", "--force"]).status.code(), Some(0));
    assert_ne!(fs::read(room.path().join("x.json")).unwrap(), before);
}
