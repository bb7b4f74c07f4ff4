//! What is wrong is said before anything runs, by path and rule, and leaves no file.

use std::fs;
use std::process::Output;

use serde_json::{Value, json};
use tempfile::tempdir;

use crate::common::{done, merge, names, refused, rows, scene, sweep};

#[test]
fn what_is_wrong_is_named_before_anything_runs() {
    let room = tempdir().unwrap();
    let (scene, out) = (scene(room.path()), room.path().join("out"));
    for (args, why) in [
        (&["--vary", "load.mas_kg=1,2"][..], "load.mas_kg: must be a parameter of the scenario"),
        (&["--vary", "load.mass_kg=0.001,-0.001"], "with load.mass_kg = -0.001: "),
        (&["--vary", "load.mass_kg=0.001,-0.001"], "load.mass_kg: must be positive, found -0.001"),
        (&["--vary", "load.mass_kg=0.001,heavy"], "load.mass_kg: must be a number, found \"heavy\""),
        (&["--vary", "load.mass_kg=1..2"], "load.mass_kg: must be a list or a grid without --sample"),
        (&["--vary", "load.mass_kg"], "must be PATH=VALUES"),
        (&["--vary", "drive.preset=paper,fast"], "drive.preset: must be"),
        (&["--vary", "seed=1,2"], "seed: must be set by --seed and --seeds"),
        (&["--scale-inertia", "1,0"], "inertia_scale: must be a positive number, found 0"),
        (&["--sample", "sobol", "8"], "--sample: must have a range"),
        (&["--sample", "monte-carlo", "8", "--vary", "load.mass_kg=1..2"], "--sample: must be latin-hypercube or sobol"),
        (&["--seeds", "0"], "--seeds: must be at least 1"),
        (&["--seeds", "2", "--seed", "18446744073709551615"], "the last seed below 2^64"),
        (&["--threads", "0"], "--threads: must be from 1 to 1024, found 0"),
        (&["--threads", "1000000"], "--threads: must be from 1 to 1024, found 1000000"),
        (
            &["--vary", "load.mass_kg=1,2", "--vary", "/load/mass_kg=3,4"],
            "/load/mass_kg: must be varied once, found it again as load.mass_kg",
        ),
        (&["--step-s", "1e-15"], "--step-s: must be at least"),
        (&["--shard", "3/2"], "must be I/N from 1/N to N/N, found 3/2"),
        (&["--backend", "inertial", "--backend", "inertial"], "must name every backend and step once"),
        (&["--backend", "rapier", "--tolerance", "1e-6"], "--tolerance: applies to quasi-static and inertial only"),
        (&["--step-s", "0"], "must be positive"),
        (&["--seeds", "1000000000"], "--shard: must leave at most 100000000 runs to one part, found 1000000000"),
        (&["--seeds", "18446744073709551615", "--vary", "load.mass_kg=1,2", "--seed", "0"], "less than 2^64 runs"),
    ] {
        let text = refused(&sweep(&scene, args, &out));
        assert!(text.contains(why), "{args:?}: {text}");
        let left: Vec<String> = names(room.path()).into_iter().filter(|name| name != "out").collect();
        assert_eq!(left, ["short.json"], "{args:?}");
    }
    assert!(refused(&sweep(&room.path().join("none.json"), &[], &out)).contains("none.json"));
    assert!(refused(&merge(&[&room.path().join("none")], &out)).contains("none"));
    assert!(refused(&merge(&[room.path()], &out)).contains("no finished shard found"));
    assert!(refused(&merge(&[&scene], &out)).contains("is not a journal that this version of cohaul reads"));
    assert!(!out.join("manifest.json").exists());
}

/// What is finished stays what it was: no other command takes its place, and a table that somebody
/// changed or lost is not called finished.
#[test]
fn a_finished_sweep_is_neither_replaced_nor_taken_for_what_it_is_not() {
    let room = tempdir().unwrap();
    let (scene, out) = (scene(room.path()), room.path().join("out"));
    done(&sweep(&scene, &["--seeds", "2"], &out));
    let run = crate::root::cohaul().arg("run").arg(&scene).arg("--out").arg(&out).output().unwrap();
    let text = refused(&run);
    assert!(text.contains("out: must not hold a finished sweep"), "{text}");
    let again = sweep(&scene, &["--seeds", "2"], &out);
    assert!(String::from_utf8(again.stderr.clone()).unwrap().contains("is finished"));
    let printed = done(&again);

    let (runs, before) = (out.join("runs.csv"), fs::read_to_string(out.join("runs.csv")).unwrap());
    fs::write(&runs, before.replacen("quasi-static", "quasi-statik", 1)).unwrap();
    let text = refused(&sweep(&scene, &["--seeds", "2"], &out));
    assert!(text.contains("runs.csv: must be as it was written, found another hash"), "{text}");
    fs::remove_file(&runs).unwrap();
    let text = refused(&sweep(&scene, &["--seeds", "2"], &out));
    assert!(text.contains("runs.csv: must be as it was written, found nothing"), "{text}");
    fs::write(&runs, before).unwrap();
    assert_eq!(done(&sweep(&scene, &["--seeds", "2"], &out)), printed);
}

#[test]
fn shards_of_other_cuts_and_links_to_nothing_are_named_before_anything_runs() {
    let room = tempdir().unwrap();
    let (scene, out) = (scene(room.path()), room.path().join("out"));
    done(&sweep(&scene, &["--seeds", "6", "--shard", "1/3"], &out));
    let text = refused(&sweep(&scene, &["--step-s", "5", "--step-s", "10"], &room.path().join("twice")));
    assert!(text.contains("must name every backend and step once"), "{text}");
    let text = refused(&sweep(&scene, &["--seeds", "6", "--shard", "1/2"], &out));
    assert!(text.contains("1-of-3.rows: must be one of 2 parts"), "{text}");
    done(&sweep(&scene, &["--seeds", "6", "--shard", "2/3"], &out));

    #[cfg(unix)]
    {
        let link = room.path().join("link");
        std::os::unix::fs::symlink(room.path().join("nowhere"), &link).unwrap();
        for link in [link.clone(), link.join("")] {
            let text = refused(&sweep(&scene, &[], &link));
            assert!(text.contains(": is a link to what is not there"), "{text}");
        }
        assert_eq!(names(room.path()), ["link", "out", "short.json"]);
    }
}

/// Options that change nothing are told, and so are runs that end otherwise than they were asked
/// to.
#[test]
fn what_does_nothing_and_what_is_not_met_are_told() {
    let room = tempdir().unwrap();
    let (scene, out) = (scene(room.path()), |name: &str| room.path().join(name));
    let warned = |output: &Output, code: i32| {
        assert_eq!(output.status.code(), Some(code));
        String::from_utf8(output.stderr.clone()).unwrap()
    };
    let text = warned(&sweep(&scene, &["--scale-inertia", "1,10"], &out("a")), 0);
    assert!(
        text.contains("warning: --scale-inertia: changes nothing; it applies to inertial and rapier only, found quasi-static"),
        "{text}"
    );
    let text = warned(&sweep(&crate::root::root().join("scenarios/analytic/slide.json"), &["--seeds", "2", "--step-s", "5"], &out("b")), 0);
    assert!(text.contains("warning: --seeds: changes nothing; it applies to ants only, found tips"), "{text}");
    assert!(text.contains("warning: --step-s: steps end with the control period, 0.001 s, found 5 s"), "{text}");
    assert!(warned(&sweep(&scene, &["--seeds", "2"], &out("c")), 0).is_empty());

    // Below what the strides of a double can do.
    let mut stiff: Value =
        serde_json::from_str(&fs::read_to_string(crate::root::root().join("scenarios/stress/stiff-light.json")).unwrap()).unwrap();
    stiff["duration_s"] = json!(0.01);
    let short = room.path().join("stiff-light.json");
    fs::write(&short, stiff.to_string()).unwrap();
    let missed = sweep(&short, &["--backend", "inertial", "--tolerance", "1e-14"], &out("d"));
    let text = warned(&missed, 1);
    assert!(text.contains("warning: 1 of 1 runs exceed their tolerance"), "{text}");
    let rows = rows(&out("d").join("runs.csv"));
    assert_eq!((&rows[0]["status"][..], rows[0]["cause"].is_empty()), ("not-within-tolerance", false));
    assert!(fs::read_to_string(out("d").join("report.html")).unwrap().contains("exceed their tolerance"));
}

/// A backend at two steps is two rows, two curves and two names; a file may begin with a byte order
/// mark, and a folder need not be text.
#[test]
fn several_steps_are_told_apart_and_names_may_be_any() {
    let room = tempdir().unwrap();
    let (scene, out) = (scene(room.path()), room.path().join("out"));
    let marked = room.path().join("marked.json");
    fs::write(&marked, format!("\u{feff}{}", fs::read_to_string(&scene).unwrap())).unwrap();
    let args = ["--step-s", "0.0005", "--step-s", "0.00125", "--vary", "drive.n_ants=2,3"];
    let printed = done(&sweep(&marked, &args, &out));
    let heads: Vec<&str> = printed.lines().find(|line| line.contains("backend")).unwrap().split_whitespace().collect();
    assert_eq!(heads[..3], ["drive.n_ants", "backend", "step"], "{printed}");
    assert!(printed.contains("500.0 µs") && printed.contains("1.250 ms"), "{printed}");
    let svg = fs::read_to_string(out.join("figure.svg")).unwrap();
    assert!(svg.contains("quasi-static at 0.0005 s") && svg.contains("quasi-static at 0.00125 s"));
    // Without it a browser cuts what it shows smaller.
    assert!(svg.contains("viewBox=\"0 0 "));

    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        let odd = room.path().join(std::ffi::OsStr::from_bytes(b"no\xfftext"));
        done(&sweep(&scene, &["--seeds", "2"], &odd));
        assert!(odd.join("runs.csv").exists());
    }
}
