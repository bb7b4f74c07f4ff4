//! What is wrong is said before anything runs, by path and rule, and leaves no file.

use tempfile::tempdir;

use crate::common::{merge, names, refused, scene, sweep};

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
        (&["--vary", "drive.preset=default,fast"], "drive.preset: must be"),
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
        (&["--backend", "rapier", "--tolerance", "1e-6"], "--tolerance: must be of quasi-static or inertial"),
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
    assert!(refused(&merge(&[&scene], &out)).contains("is no file of rows of a sweep"));
    assert!(!out.join("manifest.json").exists());
}
