//! Baselines, saved runs, journals and shards.
//!
//! A line of a journal begins with a hash of the rest. Changes are made to lines without hashes,
//! and the reader here adds those that are right; otherwise hardly any changed line would be read.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::{Duration, SystemTime};

use cohaul::backend::{BackendKind, BackendOptions, Tolerance};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, SavedRun, Simulation};
use cohaul_report::json;
use cohaul_report::manifest::Manifest;
use cohaul_report::text::Detail;
use cohaul_studies::check::Baseline;
use cohaul_studies::journal::{Header, load_single, marked, save_single, unmarked};
use cohaul_studies::runner::Records;
use cohaul_studies::sweep::files::write_sweep;
use cohaul_studies::sweep::report::{SweepSummary, sweep_text};
use cohaul_studies::sweep::{Shards, verified};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use tempfile::tempdir;

use crate::corpus;
use crate::scenes::short_run;
use crate::survey::{Format, survey};
use crate::watch::{TO_STOP, within};

const LONGEST: Duration = Duration::from_millis(100);

fn told(error: impl ToString) -> String {
    error.to_string()
}

fn read_baseline(input: &[u8]) -> Result<(), String> {
    let baseline = Baseline::parse(&String::from_utf8_lossy(input), "baseline", "baseline.json").map_err(told)?;
    short_run(&baseline.scenario, &baseline.options);
    let again =
        Baseline::parse(&baseline.to_json(), "baseline", "again").unwrap_or_else(|error| panic!("it is not written again: {error}"));
    assert_eq!(again, baseline, "it is written as another one");
    Ok(())
}

#[test]
fn changed_baselines_are_refused_or_run() {
    let texts = corpus::baselines();
    let files = corpus::values(&texts);
    survey(&Format { name: "baseline", texts, files, read: read_baseline }, 300);
}

pub static SCENES: LazyLock<[Scenario; 2]> = LazyLock::new(|| [corpus::scene(&corpus::small()), corpus::scene(corpus::ANTS)]);

/// States of both scenes on each backend.
static STATES: LazyLock<Vec<Value>> = LazyLock::new(|| {
    let times = [0.25, 3.0];
    let kinds = [BackendKind::QuasiStatic, BackendKind::Inertial, BackendKind::Rapier];
    let state = |(scenario, time): (&Scenario, f64), kind, keep| {
        let run = corpus::run_until(scenario, kind, keep, time);
        serde_json::to_value(run.save().unwrap()).unwrap()
    };
    let of_scene = |scene| kinds.map(|kind| state(scene, kind, Keep::Outcome));
    let traced = state((&SCENES[0], 0.05), BackendKind::Inertial, Keep::Trace);
    let tolerance = Tolerance::at_edge(1e-5, &SCENES[0].system.load);
    let within = [BackendKind::QuasiStatic, BackendKind::Inertial].map(|kind| {
        let mut run = Simulation::new(&SCENES[0], &BackendOptions::within(kind, tolerance), Keep::Outcome);
        run.run(|now| now < 0.25);
        serde_json::to_value(run.save().unwrap()).unwrap()
    });
    SCENES.iter().zip(times).flat_map(of_scene).chain([traced]).chain(within).collect()
});

/// A state as the record of a file.
fn read_state(input: &[u8]) -> Result<(), String> {
    let room = tempdir().unwrap();
    let path = room.path().join("state");
    let state: Value = serde_json::from_slice(input).map_err(|_| "no JSON".to_owned())?;
    save_single(&path, "run", &state).unwrap();
    let saved: Option<SavedRun> = load_single(&path, "run").map_err(told)?;
    resume(&saved.expect("there is a file"))
}

/// Resumes a state in the scene whose hash it has.
pub fn resume(saved: &SavedRun) -> Result<(), String> {
    let scenario = SCENES.iter().find(|scenario| scenario.hash() == saved.scenario_hash).unwrap_or(&SCENES[0]);
    let (resumed, time) = within(LONGEST, "a resumed run", || {
        let mut run = Simulation::resume(scenario, saved, Keep::Outcome)?;
        (0..3).for_each(|_| run.step());
        Ok::<_, cohaul::backend::RestoreError>(run.outcome())
    });
    assert!(time < LONGEST + TO_STOP, "a resumed run does not end when it is stopped");
    resumed.map_or(Ok(()), |outcome| outcome.map(drop).map_err(told))
}

#[test]
fn changed_states_are_refused_or_go_on() {
    let texts = STATES.iter().map(|state| state.to_string().into_bytes()).collect();
    survey(&Format { name: "state", texts, files: STATES.clone(), read: read_state }, 1500);
}

/// Lines with their hashes; the last one of a shard has a hash of all before it.
fn with_marks(input: &[u8]) -> String {
    let text = String::from_utf8_lossy(input);
    let mut whole = String::new();
    for line in text.lines() {
        let end = line.strip_prefix("end ").and_then(|rest| rest.split_once(' '));
        let line = match end {
            Some((n, hash)) if hash == RIGHT => {
                let digits: String = Sha256::digest(&whole).iter().map(|byte| format!("{byte:02x}")).collect();
                marked(&format!("end {n} {digits}"))
            }
            _ => marked(line),
        };
        whole.push_str(&line);
    }
    whole
}

/// Stands for the right hash at the end of a shard.
const RIGHT: &str = "right";

fn without_marks(text: &str) -> String {
    let lines = text.split_inclusive('\n').map(|line| unmarked(line.as_bytes()).unwrap());
    let line = |line: &str| match line.split(' ').collect::<Vec<_>>()[..] {
        ["end", n, _] => format!("end {n} {RIGHT}\n"),
        _ => format!("{line}\n"),
    };
    lines.map(line).collect()
}

/// Runs the program.
fn cohaul(args: &[&str]) -> i32 {
    let status = crate::root::cohaul().args(args).arg("--quiet").output().unwrap().status;
    status.code().unwrap()
}

/// A small sweep as one finished shard, without marks, and a saved run as the program writes it.
pub static WRITTEN: LazyLock<(String, Vec<u8>)> = LazyLock::new(|| {
    let room = tempdir().unwrap();
    let path = |name: &str| room.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("scene.json"), corpus::small()).unwrap();
    let (scene, out, state) = (path("scene.json"), path("out"), path("state"));
    assert_eq!(cohaul(&["run", &scene, "--state", &state, "--stop-s", "0.1"]), 130);
    let axes = ["--vary", "load.mass_kg=0.001,0.002", "--vary", "inertia_scale=1,2", "--seeds", "1"];
    let args = [&["sweep", &scene, "--shard", "1/1", "--out", &out][..], &axes].concat();
    assert_eq!(cohaul(&args), 0, "{args:?}");
    let shard = fs::read_to_string(Path::new(&out).join("shards/1-of-1.rows")).unwrap();
    (without_marks(&shard), fs::read(state).unwrap())
});

fn file(room: &tempfile::TempDir, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
    let path = room.path().join(name);
    fs::write(&path, text).unwrap();
    path
}

/// The file with these bytes as a shard, as `merge` reads it.
fn merge(text: &[u8]) -> Result<(), String> {
    let room = tempdir().unwrap();
    let path = file(&room, "a.rows", text);
    let shards = Shards::gather(std::slice::from_ref(&path)).map_err(told)?;
    verified(&path, &Header::read(&path).map_err(told)?).map_err(told)?;
    let identity = &shards.identity;
    let base = Scenario::parse(&identity.scenario.to_string(), "scenario").map_err(told)?;
    let summary = SweepSummary::new(identity, &base.name, None);
    let manifest = Manifest::new(&json!({}), String::new(), None, &json!({}), Vec::new(), SystemTime::UNIX_EPOCH);
    let found = write_sweep(&room.path().join("out"), identity, &shards, summary, &manifest).map_err(told)?;
    json::check(&found).unwrap_or_else(|error| panic!("summary: {error}"));
    assert!(!sweep_text(&found, Detail::Full).contains("NaN"));
    Ok(())
}

fn merge_marked(input: &[u8]) -> Result<(), String> {
    merge(with_marks(input).as_bytes())
}

#[test]
fn changed_shards_are_refused_or_merged() {
    let (shard, _) = &*WRITTEN;
    let texts = || vec![shard.clone().into_bytes()];
    survey(&Format { name: "shard", texts: texts(), files: Vec::new(), read: merge_marked }, 400);
    survey(
        &Format { name: "bytes of a shard", texts: vec![with_marks(shard.as_bytes()).into_bytes()], files: Vec::new(), read: merge },
        300,
    );
    // The first line, changed as JSON.
    let (head, rows) = shard.split_once('\n').unwrap();
    let whole = json!({ "head": serde_json::from_str::<Value>(head).unwrap(), "rows": rows });
    let texts = vec![whole.to_string().into_bytes()];
    let files = corpus::values(&texts);
    survey(&Format { name: "header of a shard", texts, files, read: merge_header }, 400);
}

pub fn merge_header(input: &[u8]) -> Result<(), String> {
    let whole: Value = serde_json::from_slice(input).map_err(told)?;
    let rows = whole["rows"].as_str().unwrap_or_default();
    merge_marked(format!("{}\n{rows}", whole["head"]).as_bytes())
}

/// A journal of a study, as it is opened again.
pub fn read_journal(input: &[u8]) -> Result<(), String> {
    let room = tempdir().unwrap();
    let path = file(&room, "journal", with_marks(input));
    let records: Records<Vec<f64>> = Records::open(&path, STUDY, &json!({ "step_s": 0.1 })).map_err(told)?;
    assert!(records.wall_s().is_finite());
    Ok(())
}

pub const STUDY: &str = "bench";

#[test]
fn changed_journals_are_refused_or_go_on() {
    let room = tempdir().unwrap();
    let path = room.path().join("journal");
    let mut records: Records<Vec<f64>> = Records::open(&path, STUDY, &json!({ "step_s": 0.1 })).unwrap();
    (0..5_usize).rev().for_each(|task| records.keep(task, vec![0.5; task]).unwrap());
    drop(records);
    let text = without_marks(&fs::read_to_string(&path).unwrap());
    survey(&Format { name: "journal", texts: vec![text.into_bytes()], files: Vec::new(), read: read_journal }, 800);
}

fn read_state_file(input: &[u8]) -> Result<(), String> {
    let room = tempdir().unwrap();
    let saved: Option<SavedRun> = load_single(&file(&room, "state", input), "run").map_err(told)?;
    resume(&saved.expect("there is a file"))
}

fn read_marked_state_file(input: &[u8]) -> Result<(), String> {
    read_state_file(with_marks(input).as_bytes())
}

#[test]
fn changed_files_of_states_are_refused_or_go_on() {
    let (_, state) = &*WRITTEN;
    let bare = without_marks(std::str::from_utf8(state).unwrap());
    survey(&Format { name: "bytes of a file of a state", texts: vec![state.clone()], files: Vec::new(), read: read_state_file }, 800);
    survey(&Format { name: "file of a state", texts: vec![bare.into_bytes()], files: Vec::new(), read: read_marked_state_file }, 800);
}
