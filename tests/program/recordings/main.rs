//! Imports of recordings and drawings, and the files that ship with them.
//!
//! ```text
//! samples.rs   a recording in the form of every tracker: generated, read, exported, read again
//! losses.rs    lost rows, jitter and swapped names on scenes: no invented release, the same verdict
//! reports.rs   files as other people have sent them
//! drawings.rs  outlines against their closed forms, and what is named as not read
//! obstacles.rs  what moves obstacles: lost, swapped, far off, turned, noisy
//! robots.rs    three robots in a doorway: the recording that ships, and its verdict
//! program.rs   the command: faults, files, exit codes
//! ```

mod drawings;
#[path = "../../differential/draws.rs"]
#[allow(dead_code, reason = "other tests use more of it")]
mod draws;
mod losses;
mod obstacles;
mod program;
mod reports;
mod robots;
#[path = "../../common/root.rs"]
mod root;
mod samples;

use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::scenario::{Drive, Scenario, ScenarioError, TipPath};
use cohaul::simulation::{Keep, Simulation, Trace};
use cohaul_recordings::account::Account;
use cohaul_recordings::repair::Bounds;
use cohaul_recordings::scene::{Imported, Roles, scenario};
use cohaul_recordings::tracks::{Reading, Tracks, Units, read};
use cohaul_report::tips_csv::write_tips;

/// A scene of the repository.
fn scene(path: &str) -> Scenario {
    Scenario::read(&root::root().join(path)).unwrap_or_else(|error| panic!("{error}"))
}

/// The tips of a quasi-static run of a scene, as `run --tips` writes them.
fn tips_of(scene: &Scenario) -> String {
    tips_by(scene, BackendKind::QuasiStatic)
}

fn trace_by(scene: &Scenario, backend: BackendKind) -> Trace {
    let mut run = Simulation::new(scene, &BackendOptions::new(backend, scene.control_period), Keep::Trace);
    run.run(|_| true);
    run.into_results().0
}

fn tips_by(scene: &Scenario, backend: BackendKind) -> String {
    let mut table = Vec::new();
    write_tips(&trace_by(scene, backend), &mut table).unwrap();
    String::from_utf8(table).unwrap()
}

fn tracks_of(text: &str, units: &Units) -> Result<(Tracks, Account), ScenarioError> {
    let mut account = Account::default();
    let tracks = read(&[Reading { file: "recording.csv", bytes: text.as_bytes() }], None, units, &mut account)?;
    Ok((tracks, account))
}

fn imported(text: &str, like: &Scenario, bounds: &Bounds) -> (Scenario, Account) {
    let (tracks, mut account) = tracks_of(text, &Units::default()).unwrap_or_else(|error| panic!("{error}"));
    let made = scenario(tracks, &Roles::default(), bounds, like, "recording.csv", &mut account);
    let Imported { scenario, .. } = made.unwrap_or_else(|error| panic!("{error}"));
    (scenario, account)
}

fn paths(scenario: &Scenario) -> &[TipPath] {
    match &scenario.drive {
        Drive::Tips(paths) => paths,
        Drive::Ants(_) => panic!("tips"),
    }
}

fn n_releases(scenario: &Scenario) -> usize {
    paths(scenario).iter().filter(|path| path.release.is_some()).count()
}
