//! The command: what it prints and writes, its faults and its exit codes.

use cohaul::scenario::Scenario;
use serde_json::{Value, json};

use crate::root;

/// Standard output, standard error and exit code of `scenario import`.
fn import(arguments: &[&str]) -> (String, String, Option<i32>) {
    let output = root::cohaul().args(["scenario", "import"]).args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (text(&output.stdout), text(&output.stderr), output.status.code())
}

const LIKE: [&str; 2] = ["--like", "examples/recordings/ants.json"];

#[test]
fn a_scenario_and_what_was_done_are_written_side_by_side() {
    let room = tempfile::tempdir().unwrap();
    let path = |name: &str| room.path().join(name).to_str().unwrap().to_owned();
    let (out, tracks, tips) = (path("made.json"), path("tracks.csv"), path("tips.csv"));
    let options = [
        "examples/recordings/deeplabcut.csv",
        "--fps",
        "50",
        "--scale-m",
        "1e-4",
        "--min-confidence",
        "0.5",
        "--origin-m",
        "0.04",
        "-0.07",
        "--load",
        "rear",
        "front",
        "--out",
        &out,
        "--tracks",
        &tracks,
        "--tips",
        &tips,
    ];
    let (printed, error, code) = import(&[&options[..], &LIKE].concat());
    assert_eq!((error.as_str(), code), ("", Some(0)), "{printed}");
    assert!(printed.lines().all(|line| line.chars().count() <= 80), "{printed}");
    assert!(printed.starts_with("DeepLabCut: examples/recordings/deeplabcut.csv\n") && printed.contains("gaps bridged"), "{printed}");
    let made = Scenario::read(out.as_ref()).unwrap();
    assert!(made.start.pose.position.norm() < 1e-6, "{:?}", made.start.pose);
    let notes: Value = serde_json::from_str(&std::fs::read_to_string(path("made.import.json")).unwrap()).unwrap();
    assert_eq!(notes["format"]["name"], "cohaul import");
    // The exported tables make the same scenario.
    for table in [&tracks, &tips] {
        let again = path("again.json");
        let marks: &[&str] = if table == &tracks { &["--load", "rear", "front"] } else { &[] };
        let (printed, error, code) = import(&[&[table.as_str(), "--out", &again][..], marks, &LIKE].concat());
        assert_eq!((error.as_str(), code), ("", Some(0)), "{printed}");
        assert_eq!(Scenario::read(again.as_ref()).unwrap(), made, "{table}");
    }
    let (printed, _, code) = import(&[&["examples/recordings/t-block.svg", "--out", &out][..], &LIKE].concat());
    assert!(code == Some(0) && printed.contains("origin, moved to the centroid"), "{printed}");
}

#[test]
fn faults_name_file_place_rule_and_what_was_found() {
    let room = tempfile::tempdir().unwrap();
    let path = |name: &str, text: &str| {
        let path = room.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let words = path("words.csv", "time_s,ant,x_m,y_m\n0,1,0,0\n0.1,1,here,0\n");
    let twice = path("twice.csv", "time_s,ant,x_m,y_m\n0,1,0,0\n0,1,1,0\n");
    let pixels = path("pixels.csv", "frame,ant,x_px,y_px\n0,1,0,0\n1,1,1,0\n");
    let three = path("three.csv", "time_s,ant,x_m,y_m\n0,1,0,0\n0,2,1,0\n0,3,2,0\n");
    let hdf = path("tracks.h5", "\u{fffd}");
    std::fs::write(&hdf, b"\x89HDF\r\n").unwrap();
    for (file, why) in [
        (&words, "words.csv: line 3, x_m: must be a number, or empty where nothing was seen, found here"),
        (&twice, "twice.csv: line 3: must have track 1 once in a frame, as on line 2, found another place at the same time"),
        (&pixels, "pixels.csv: header: must have times, or need --fps, found frames only"),
        (&three, "three.csv: tracks: must have as many tracks as the scenario has springs, 2, or --spring TRACK=INDEX"),
        (&hdf, "must be a table of text, found an HDF5 file: export CSV"),
    ] {
        let (printed, error, code) = import(&[&[file.as_str()][..], &LIKE].concat());
        assert!(printed.is_empty() && code == Some(2) && error.contains(why), "{error}");
    }
    let (_, error, code) = import(&[&words]);
    assert!(code == Some(2) && error.contains("--like: is required"), "{error}");
    let chosen = ["--spring", "3=0", "--spring", "two=1"];
    let (_, error, code) = import(&[&[three.as_str()][..], &chosen, &LIKE].concat());
    assert!(code == Some(2) && error.contains("--spring: must name a track of the recording, 1, 2, 3, found two"), "{error}");
}

/// Springs that are attached again and again, far from where the load has started.
#[test]
fn a_long_recording_gives_no_warnings_of_tips_far_away() {
    let room = tempfile::tempdir().unwrap();
    let file = room.path().join("long.csv");
    let mut text = "time_s,spring,tip_x_m,tip_y_m\n".to_owned();
    for k in 0..4000 {
        let time = 0.01 * f64::from(k);
        // Both ants walk 0.4 m; each lets go every second.
        for spring in 0..2 {
            let phase = (time + 0.5 * f64::from(spring)).fract();
            let along = 0.01 * time;
            let [x, y] = [[0.05 + along, 0.0], [along, 0.05]][spring as usize];
            if phase > 0.2 {
                text += &format!("{time},{spring},{x},{y}\n");
            }
        }
    }
    std::fs::write(&file, text).unwrap();
    let (printed, error, code) =
        import(&[&[file.to_str().unwrap(), "--out", room.path().join("m.json").to_str().unwrap()][..], &LIKE].concat());
    assert!(code == Some(0) && printed.contains("releases inferred"), "{printed}");
    assert!(!error.contains("should be near the tip"), "{error}");
}

/// A run names the command that puts an outline right, and that does.
#[test]
fn a_closed_ring_is_refused_with_the_command_that_puts_it_right() {
    let room = tempfile::tempdir().unwrap();
    let [ring, right] = ["ring.json", "right.json"].map(|name| room.path().join(name).to_str().unwrap().to_owned());
    let corners = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.0, 0.1], [0.0, 0.0]];
    let scene = json!({
        "name": "a closed ring",
        "duration_s": 1.0,
        "control_period_s": 0.01,
        "load": { "mass_kg": 1.0, "outline": { "polygon": { "points_m": corners } } },
        "ground": { "friction_coefficient": 0.3, "supports": { "uniform": { "n": 16 } } },
        "springs": [],
        "drive": { "kind": "tips", "paths": [] },
    });
    std::fs::write(&ring, scene.to_string()).unwrap();
    let check = |file: &str| crate::root::cohaul().args(["scenario", "check", file]).output().unwrap();
    let error = String::from_utf8(check(&ring).stderr).unwrap();
    assert!(error.contains(&format!("`cohaul scenario import {ring} --out right.json`")), "{error}");
    let (_, error, code) = import(&[&ring, "--out", &right]);
    assert!(code == Some(0), "{error}");
    assert!(check(&right).status.success(), "{}", String::from_utf8_lossy(&check(&right).stderr));
}
