//! The same table whatever it went through.

use std::fs;

use tempfile::tempdir;

use crate::common::{done, merge, names, refused, rows, scene, sweep, tables};

const ARGS: [&str; 8] =
    ["--seeds", "5", "--vary", "drive.pull_speed_m_per_s=0.02,0.03", "--scale-inertia", "0.1,1", "--backend", "quasi-static"];

#[test]
fn threads_and_shards_in_any_order_make_the_same_table() {
    let room = tempdir().unwrap();
    let scene = scene(room.path());
    let args = [&ARGS[..], &["--backend", "inertial"]].concat();
    let out = |name: &str| room.path().join(name);
    let with = |more: &[&str], name: &str| done(&sweep(&scene, &[&args[..], more].concat(), &out(name)));
    with(&["--threads", "1"], "one");
    with(&["--threads", "3"], "three");
    assert_eq!(tables(&out("one")), tables(&out("three")));
    for shard in ["3/3", "1/3", "2/3"] {
        with(&["--shard", shard, "--threads", "2"], "parts");
    }
    let text = done(&merge(&[&out("parts")], &out("merged")));
    assert!(text.contains("40 runs of"), "{text}");
    assert_eq!(tables(&out("one")), tables(&out("merged")));
    let rows = rows(&out("one").join("runs.csv"));
    assert_eq!(rows.len(), 40);
    // What is the same everywhere must not be so for want of difference: every cell has a key of
    // its own, and every one a path, but that without inertia a scale of inertia changes nothing.
    let n_different = |column: &str| {
        let mut values: Vec<&String> = rows.iter().map(|row| &row[column]).collect();
        values.sort_unstable();
        values.dedup();
        values.len()
    };
    assert_eq!((n_different("key"), n_different("path_length_m")), (40, 30));
}

#[test]
fn a_finished_shard_is_skipped_and_a_damaged_one_is_not_taken() {
    let room = tempdir().unwrap();
    let (scene, out, merged) = (scene(room.path()), room.path().join("out"), room.path().join("merged"));
    let shard = |part: &str| sweep(&scene, &["--seeds", "4", "--shard", part], &out);
    assert!(done(&shard("1/2")).contains("shard 1 of 2 is finished: 2 runs"));
    let file = out.join("shards/1-of-2.rows");
    let before = (fs::read(&file).unwrap(), fs::metadata(&file).unwrap().modified().unwrap());
    assert!(done(&shard("1/2")).contains("was finished"));
    assert_eq!((fs::read(&file).unwrap(), fs::metadata(&file).unwrap().modified().unwrap()), before);
    assert!(refused(&merge(&[&out], &merged)).contains("cells 2 to 3 are missing"));
    done(&shard("2/2"));
    assert_eq!(names(&out.join("shards")), ["1-of-2.rows", "2-of-2.rows"]);
    assert!(refused(&merge(&[&out, &file], &merged)).contains("cells 0 to 1 are double"));
    // A shard of another sweep is known before its work, and by merge.
    let other = sweep(&scene, &["--seeds", "4", "--seed", "9", "--shard", "1/2"], &out);
    assert!(refused(&other).contains("first_seed is 1, not 9"));
    let elsewhere = room.path().join("elsewhere");
    done(&sweep(&scene, &["--seeds", "4", "--seed", "9", "--shard", "2/2"], &elsewhere));
    let text = refused(&merge(&[&file, &elsewhere], &merged));
    assert!(text.contains("is of another sweep: first_seed is 9, not 1"), "{text}");
    let text = fs::read_to_string(&file).unwrap().replacen("finished", "Finished", 1);
    fs::write(&file, text).unwrap();
    assert!(refused(&shard("1/2")).contains("cut off or damaged"));
    assert!(refused(&merge(&[&out], &merged)).contains("cut off or damaged"));
    assert!(!merged.exists());
}

#[test]
fn a_finished_sweep_is_not_run_again_and_not_written_over_by_another() {
    let room = tempdir().unwrap();
    let (scene, out) = (scene(room.path()), room.path().join("out"));
    let first = done(&sweep(&scene, &["--seeds", "3"], &out));
    let written = fs::metadata(out.join("runs.csv")).unwrap().modified().unwrap();
    let again = sweep(&scene, &["--seeds", "3"], &out);
    assert_eq!(done(&again), first);
    assert!(String::from_utf8(again.stderr).unwrap().contains("is finished"));
    assert_eq!(fs::metadata(out.join("runs.csv")).unwrap().modified().unwrap(), written);
    let text = refused(&sweep(&scene, &["--seeds", "3", "--backend", "inertial"], &out));
    assert!(text.contains("is of another sweep: columns") || text.contains("is of another sweep: variants"), "{text}");
    assert!(refused(&sweep(&scene, &["--seeds", "3", "--shard", "1/2"], &out)).contains("holds a finished output"));
}
