//! The regime map: cells against closed forms, on both sides of each threshold, and what must not
//! matter.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use cohaul_report::manifest::Manifest;
use cohaul_studies::regime::files::write_regime;
use cohaul_studies::regime::report::Regime;
use cohaul_studies::regime::{Cause, Cell, Effort, Grid, Law, LawOutcome, RELATIVE_TOLERANCE, Scene, Setting, cells, tasks, theory};
use cohaul_studies::runner::Records;
use serde_json::{Value, from_value};
use tempfile::tempdir;

fn at(phi: f64, epsilon: f64, zeta: f64) -> Setting {
    Setting { phi, epsilon, zeta, mass_factor: 1.0 }
}

fn measured(scene: Scene, at: Setting) -> Cell {
    let cell = Cell::measure(scene, &at, || true).unwrap();
    assert!(cell.is_converged && cell.moves() && cell.end_speed_m_per_s == 0.0, "{cell:?}");
    cell
}

/// Error control keeps paths within 1e-4 of the path length of a tip between two events.
const TOLERANCE: f64 = 1e-4;

/// `[phi - sin phi + (epsilon / 2) (1 - cos phi)^2] / phi`: before, at and after a quarter, a half
/// and a whole period, for slow tips and for fast ones.
#[test]
fn an_undamped_excursion_goes_as_far_as_the_closed_form() {
    for (phi, epsilon) in [(0.3, 1e-3), (0.3, 1.0), (1.5, 0.1), (FRAC_PI_2, 0.5), (PI, 0.0593), (4.0, 1.0), (6.4, 0.0445), (30.0, 0.3)] {
        let cell = measured(Scene::Excursion, at(phi, epsilon, 0.0));
        let ratio = cell.displacement_ratio().unwrap();
        let known = theory::excursion_undamped(phi, epsilon);
        assert!((ratio - known).abs() < TOLERANCE, "{phi} {epsilon}: {ratio} {known}");
        // Two computations, not one compared with itself.
        assert!(ratio != known);
        // Distances are sampled at ticks of 0.1 rad: a largest one between two ticks is missed by
        // an eighth of the square of the tick.
        let (ratio, known) = (cell.distance_ratio().unwrap(), theory::excursion_distance_ratio(phi, epsilon, 0.0));
        assert!((ratio / known - 1.0).abs() < 2e-3, "{phi} {epsilon}: {ratio} {known}");
    }
}

/// Below, at and above critical damping; the last is so fast that its dashpot alone moves the load
/// at the grasp.
#[test]
fn a_damped_excursion_begins_earlier_and_ends_as_the_closed_form() {
    for (phi, epsilon, zeta) in [(0.3, 0.01, 0.1), (2.0, 0.2, 0.5), (2.0, 0.1, 1.0), (0.7, 0.05, 2.0), (3.0, 1.0, 1.0)] {
        let ratio = measured(Scene::Excursion, at(phi, epsilon, zeta)).displacement_ratio().unwrap();
        let known = theory::excursion(phi, epsilon, zeta);
        assert!((ratio - known).abs() < TOLERANCE, "{phi} {epsilon} {zeta}: {ratio} {known}");
        assert!((known - theory::excursion_undamped(phi, epsilon)).abs() > 10.0 * TOLERANCE);
    }
}

/// In the tug of war jump and drive add up: with slow tips the excess over the drive is the release
/// factor, below one before a quarter of a period, above one after it.
#[test]
fn a_release_falls_short_before_a_quarter_of_a_period_and_overshoots_after_it() {
    let epsilon = 1e-3;
    let factor = |phi: f64, zeta: f64| {
        let displacement = 2.0 * measured(Scene::TugOfWar, at(phi, epsilon, zeta)).displacement_ratio().unwrap();
        // The drive without the jump, by its closed form; what friction takes from the speed after
        // the jump, epsilon u^2 / 2, is a thousandth.
        let [_, rate] = theory::stretch(zeta, [phi, 1.0], phi);
        displacement - (1.0 - theory::stretch(zeta, [0.0, 1.0], phi)[0] / phi) - 0.5 * epsilon * (1.0 - rate).powi(2) / phi
    };
    for (phi, side) in [(1.45, -1.0), (1.7, 1.0)] {
        let found = factor(phi, 0.0);
        assert!((found - (1.0 - phi.cos())).abs() < 3.0 * TOLERANCE, "{phi}: {found}");
        assert!(side * (found - 1.0) > 0.1);
    }
    let damped = factor(2.0, 0.5);
    assert!((damped - theory::release_factor(2.0, 0.5)).abs() < 3.0 * TOLERANCE, "{damped}");
}

/// After a whole swing the load stands `1 + exp(-pi zeta / sqrt(1 - zeta^2))` jumps ahead of where
/// it was, and waits for the tip: at Phi = 4.2 it still does.
#[test]
fn the_load_rests_after_an_overshoot_until_the_tip_has_caught_up() {
    for (phi, zeta) in [(5.0, 0.0), (4.2, 0.1), (9.0, 0.0), (60.0, 0.1)] {
        let cell = measured(Scene::TugOfWar, at(phi, 5e-3, zeta));
        let (found, known) = (cell.displacement_ratio().unwrap(), theory::release_exact(phi, 5e-3, zeta).unwrap());
        assert!((found - known).abs() < TOLERANCE, "{phi} {zeta}: {found} {known}");
    }
    // The sum of jump and drive predicts a displacement half too large, and the cause is named.
    let cell = measured(Scene::TugOfWar, at(60.0, 5e-3, 0.0));
    assert!(Law::Release.ratio(&cell).unwrap() < 0.8);
    assert_eq!(Law::Release.cause(&cell), Cause::Waiting);
}

/// The distance ratio of an undamped excursion is 1 / Phi: a percent at Phi = 100, whatever the
/// speed.
#[test]
fn agreement_ends_where_a_hundred_radians_begin() {
    for epsilon in [0.01, 0.3] {
        let ratio = |phi: f64| measured(Scene::Excursion, at(phi, epsilon, 0.0)).distance_ratio().unwrap();
        let (before, after) = (ratio(98.0), ratio(102.0));
        assert!(before > RELATIVE_TOLERANCE && after < RELATIVE_TOLERANCE, "{before} {after}");
    }
}

/// A quarter of the mass at the same friction, with tips twice as fast for half as long, is the
/// same point of the plane; in the haul on springs that turn the load the moment of inertia
/// follows.
#[test]
fn only_phi_epsilon_and_zeta_matter() {
    for (scene, phi, epsilon) in [(Scene::Excursion, 2.0, 0.3), (Scene::TugOfWar, 2.0, 0.1), (Scene::Haul, 3.0, 0.15)] {
        let here = measured(scene, at(phi, epsilon, 0.1));
        let there = measured(scene, Setting { mass_factor: 0.25, ..at(phi, epsilon, 0.1) });
        let (a, b) = (here.distance_ratio().unwrap(), there.distance_ratio().unwrap());
        let error = here.reference_error_ratio().unwrap() + there.reference_error_ratio().unwrap();
        assert!((a - b).abs() < 3.0 * TOLERANCE + error && error < 0.01 && a > 0.05, "{scene:?}: {a} {b} {error}");
    }
}

/// Between two events tips move too little for three springs to move the load: nothing moves, with
/// inertia or without, and the cell has no ratio.
#[test]
fn a_haul_that_rests_has_no_ratio() {
    let cell = Cell::measure(Scene::Haul, &at(1.0, 0.01, 0.0), || true).unwrap();
    assert_eq!((cell.distance_ratio(), cell.displacement_ratio(), cell.distance_m), (None, None, 0.0));
    assert!(!cell.moves() && cell.is_converged);
}

fn small(scene: Scene) -> Grid {
    Grid { scene, phis: vec![0.5, 2.0, 8.0], epsilons: vec![0.02, 0.5], zetas: vec![0.0, 1.0] }
}

#[test]
fn a_map_is_the_same_on_one_thread_and_two_and_in_two_parts() {
    let grids = [small(Scene::Excursion), small(Scene::TugOfWar)];
    let on =
        |n: usize| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(|| tasks(&grids).finished(&|_| true).unwrap());
    let whole = on(1);
    assert_eq!(whole.len(), cells(&grids).len());
    assert_eq!(whole, on(2));
    let left = AtomicUsize::new(400);
    let room = tempdir().unwrap();
    let open = || Records::open(&room.path().join("journal"), "regime", &"here").unwrap();
    let mut part = open();
    tasks(&grids).run(&mut part, &|_| left.fetch_update(Relaxed, Relaxed, |n| n.checked_sub(1)).is_ok()).unwrap();
    assert!((1..whole.len()).contains(&part.n_done()), "{}", part.n_done());
    drop(part);
    let mut resumed = open();
    tasks(&grids).run(&mut resumed, &|_| true).unwrap();
    assert_eq!(resumed.complete(whole.len()).ok().unwrap().0, whole);
    // Laws that are exact hold in every cell, and none that fails does so without a reason.
    let found: Vec<Cell> = whole;
    for outcome in LawOutcome::all(&found) {
        assert!(!outcome.causes.contains_key(&Cause::Unknown), "{outcome:?}");
        if outcome.law == Law::Excursion {
            assert!(outcome.n_within == outcome.n_cells && outcome.n_cells == 6, "{outcome:?}");
        }
    }
}

#[test]
fn the_plane_is_covered_from_end_to_end() {
    for effort in [Effort::Full, Effort::Quick] {
        for grid in Scene::ALL.map(|scene| Grid::of(scene, effort)) {
            let (longest, slowest) = if grid.scene == Scene::Haul { (2.9, 0.021) } else { (299.0, 0.0011) };
            assert!(grid.phis[0] <= 0.3 && *grid.phis.last().unwrap() > longest);
            assert!(grid.epsilons[0] <= slowest && *grid.epsilons.last().unwrap() > 0.99);
            let last = grid.setting(grid.n_cells() - 1);
            let ends = [&grid.phis, &grid.epsilons, &grid.zetas].map(|values| *values.last().unwrap());
            assert_eq!([last.phi, last.epsilon, last.zeta], ends);
        }
    }
}

/// The cells in the repository and the page beside them belong to this program: from those cells it
/// writes that page. `COHAUL_REWRITE=1` stores what it writes, but for the manifest of the run.
#[test]
fn the_stored_page_is_what_the_program_writes_from_the_stored_cells() {
    let stored = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("results/regime");
    let summary: Value = serde_json::from_slice(&std::fs::read(stored.join("summary.json")).unwrap()).unwrap();
    let stored_cells = csv::Reader::from_path(stored.join("regime.csv")).unwrap().deserialize().collect::<Result<Vec<Cell>, _>>().unwrap();
    let paper: Vec<Cell> = from_value(summary["paper"].clone()).unwrap();
    let grids = Scene::ALL.map(|scene| Grid::of(scene, Effort::Full));
    assert_eq!(stored_cells.len(), cells(&grids).len());
    let found = Regime::new(&grids, stored_cells, paper, false, summary["wall_s"].as_f64().unwrap());
    let (room, nothing) = (tempdir().unwrap(), Value::Null);
    let manifest = Manifest::new(&nothing, String::new(), None, &nothing, Vec::new(), std::time::SystemTime::now());
    let written = room.path().join("regime");
    write_regime(&written, &found, &manifest).unwrap();
    if std::env::var_os("COHAUL_REWRITE").is_some() {
        let files = std::fs::read_dir(&written).unwrap().map(|entry| entry.unwrap());
        for file in files.filter(|file| file.file_name() != "manifest.json") {
            std::fs::copy(file.path(), stored.join(file.file_name())).unwrap();
        }
    }
    let text = |folder: &std::path::Path, name| std::fs::read_to_string(folder.join(name)).unwrap();
    assert_eq!(text(&written, "README.md"), text(&stored, "README.md"));
    let head = |folder| text(folder, "regime.csv").lines().next().unwrap().to_owned();
    assert_eq!(head(&written), head(&stored));
}
