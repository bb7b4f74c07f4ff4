//! Whatever ends a sweep, the same command goes on to the same table.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use cohaul::math::{RandomStreams, Stream};
use tempfile::tempdir;

use crate::common::{command, done, names, refused, scene, sweep, tables};

const N_RUNS: usize = 600;
const ARGS: [&str; 4] = ["--seeds", "200", "--vary", "load.mass_kg=0.0012,0.0016,0.002"];
const THREADS: [&str; 2] = ["--threads", "2"];

fn started(scene: &Path, out: &Path) -> Child {
    command(scene, &ARGS, out).args(THREADS).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Lines of the journal that end.
fn n_lines(journal: &Path) -> usize {
    fs::read(journal).map_or(0, |bytes| bytes.iter().filter(|byte| **byte == b'\n').count())
}

/// Ten times at moments from before the first row to past the middle: moments are chosen by the
/// number of rows that are there, at most 360 in all, and then drawn within the time of a few rows,
/// so that slow machines and fast ones do as many.
#[test]
fn a_sweep_killed_ten_times_has_the_same_table_as_one_that_was_not() {
    let room = tempdir().unwrap();
    let (scene, whole, out) = (scene(room.path()), room.path().join("whole"), room.path().join("out"));
    let begun = Instant::now();
    done(&sweep(&scene, &[&ARGS[..], &THREADS].concat(), &whole));
    let few_rows = begun.elapsed() / 120;
    let (streams, journal) = (RandomStreams::new(11), room.path().join("out.journal"));
    for kill in 0..10 {
        let [rows, pause] = streams.uniform_pair(Stream::Scene, 0, kill);
        let mut child = started(&scene, &out);
        let (enough, begun) = (n_lines(&journal) + (40.0 * rows) as usize, Instant::now());
        while kill > 0 && n_lines(&journal) < enough && begun.elapsed() < Duration::from_secs(20) {
            sleep(Duration::from_millis(1));
        }
        sleep(few_rows.mul_f64(pause));
        assert_eq!(child.try_wait().unwrap(), None, "there was something left to kill");
        // On Unix this is signal 9.
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(!out.exists());
    }
    let n_kept = n_lines(&journal) - 1;
    assert!((20..N_RUNS).contains(&n_kept), "{n_kept} rows were kept");
    done(&sweep(&scene, &ARGS, &out));
    assert_eq!(tables(&out), tables(&whole));
    assert_eq!(names(room.path()), ["out", "short.json", "whole"], "nothing is left beside the table");
}

/// The last moments: all rows are there and no folder, or the folder stands half-written beside, or
/// whole with the journal still there.
#[test]
fn a_sweep_killed_while_it_wrote_its_folder_writes_it_again() {
    let room = tempdir().unwrap();
    let (scene, out, parts) = (scene(room.path()), room.path().join("out"), room.path().join("parts"));
    let args = ["--seeds", "6"];
    done(&sweep(&scene, &[&args[..], &["--shard", "1/1"]].concat(), &parts));
    // A finished shard of all cells is a journal and a last line that no journal has.
    let journal = room.path().join("out.journal");
    let leave = || fs::copy(parts.join("shards/1-of-1.rows"), &journal).unwrap();
    leave();
    let half = room.path().join(".out.partial-1-0");
    fs::create_dir(&half).unwrap();
    fs::write(half.join("runs.csv"), "half").unwrap();
    done(&sweep(&scene, &args, &out));
    let first = tables(&out);
    leave();
    done(&sweep(&scene, &args, &out));
    assert_eq!(tables(&out), first);
    assert_eq!(names(room.path()), ["out", "parts", "short.json"]);
}

#[test]
fn ctrl_c_keeps_what_is_done_and_says_how_to_go_on() {
    let room = tempdir().unwrap();
    let (scene, out, whole) = (scene(room.path()), room.path().join("out"), room.path().join("whole"));
    let journal = room.path().join("out.journal");
    let child = command(&scene, &ARGS, &out).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    while n_lines(&journal) < 5 && begun.elapsed() < Duration::from_secs(20) {
        sleep(Duration::from_millis(1));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let stopped = child.wait_with_output().unwrap();
    assert_eq!(stopped.status.code(), Some(130));
    let told = String::from_utf8(stopped.stderr).unwrap();
    assert!(told.contains(&format!("of {N_RUNS} runs; the same command continues from")), "{told}");
    let kept = n_lines(&journal) - 1;
    // Another sweep does not go on from it, and says what differs.
    let text = refused(&sweep(&scene, &["--seeds", "201"], &out));
    assert!(text.contains("out.journal: is of another sweep:") && text.contains("n_seeds is 200, not 201"), "{text}");
    let again = sweep(&scene, &ARGS, &out);
    done(&again);
    let text = String::from_utf8(again.stderr).unwrap();
    assert!(text.contains(&format!("continues after {kept} runs, {} are left", N_RUNS - kept)), "{text}");
    done(&sweep(&scene, &ARGS, &whole));
    assert_eq!(tables(&out), tables(&whole));
}
