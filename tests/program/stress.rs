//! Stress maps: nothing breaks unexplained, faults of a backend are called by their names, and a
//! table does not depend on how it was made.

#[path = "../common/root.rs"]
mod root;

use std::fs;
use std::process::Output;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use cohaul::backend::{Backend, BackendOptions, EnergyLedger, Motion, Status, StepReport};
use cohaul::math::Vec2;
use cohaul::scenario::Scenario;
use cohaul::simulation::backend_of;
use cohaul_studies::methods::Method;
use cohaul_studies::runner::Records;
use cohaul_studies::stress::{Axis, Effort, Map, Outcome, Row, all, tasks};
use serde_json::Value;
use tempfile::tempdir;

fn n_cells(maps: &[Map]) -> usize {
    maps.iter().map(Map::n_cells).sum()
}

fn quick(name: &str) -> Map {
    all().iter().find(|map| map.name == name).unwrap().at(Effort::Quick)
}

fn all_methods() -> Vec<Method> {
    Method::all_stressed().collect()
}

fn rows(maps: &[Map], methods: &[Method]) -> Vec<Row> {
    tasks(maps, methods, &backend_of).finished(&|_| true).unwrap().concat()
}

#[test]
fn the_maps_have_ten_thousand_cells_and_names_of_their_own() {
    let maps = all();
    assert!(n_cells(&maps) >= 10_000, "{}", n_cells(&maps));
    let mut names: Vec<&str> = maps.iter().map(|map| map.name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), maps.len());
    for map in &maps {
        for axis in [&map.x, &map.y] {
            assert!(axis.values.windows(2).all(|pair| pair[0] < pair[1]), "{}: {axis:?}", map.name);
        }
    }
}

/// Thousands of springs are for the full maps: unoptimised they take minutes.
#[test]
fn quick_maps_have_no_panic_no_nan_and_nothing_unexplained() {
    let mut maps: Vec<Map> = all().iter().map(|map| map.at(Effort::Quick)).collect();
    for map in &mut maps {
        if map.name == "springs" {
            map.x.values.retain(|n| *n < 100.0);
        }
        if map.name.starts_with("hours") {
            map.y.values.truncate(1);
        }
    }
    let rows = rows(&maps, &all_methods());
    assert_eq!(rows.len(), all_methods().len() * n_cells(&maps));
    let defects: Vec<&Row> = rows.iter().filter(|row| row.outcome.is_defect()).collect();
    assert!(defects.is_empty(), "{} {defects:#?}", defects.len());
    for row in &rows {
        assert_eq!(row.cause.is_empty(), row.outcome == Outcome::Finished, "{row:?}");
    }
    // A stress that nothing fails under is none, and one that all fails under tells nothing.
    let share = |method, outcome| {
        let of_method = || rows.iter().filter(move |row| row.method == method);
        of_method().filter(|row| row.outcome == outcome).count() as f64 / of_method().count() as f64
    };
    assert!(share(Method::QUASI_STATIC, Outcome::Finished) > 0.5 && share(Method::QUASI_STATIC, Outcome::NotConverged) > 0.0);
    assert!(share(Method::RAPIER, Outcome::Finished) > 0.2 && share(Method::RAPIER_ENGINE_DEFAULTS, Outcome::NotConverged) > 0.3);
}

#[test]
fn a_table_is_the_same_on_one_thread_and_two_and_in_two_parts() {
    let maps = [quick("grasp"), quick("friction-margin")];
    let on = |n: usize| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(|| rows(&maps, &all_methods()));
    let whole = on(1);
    assert_eq!(whole, on(2));
    let left = AtomicUsize::new(7);
    let room = tempdir().unwrap();
    let open = || Records::open(&room.path().join("journal"), "stress", &"here").unwrap();
    let methods = all_methods();
    let tasks = tasks(&maps, &methods, &backend_of);
    let mut part = open();
    tasks.run(&mut part, &|_| left.fetch_update(Relaxed, Relaxed, |n| n.checked_sub(1)).is_ok()).unwrap();
    assert_eq!(part.n_done(), 7);
    drop(part);
    let mut resumed = open();
    assert_eq!(resumed.n_done(), 7);
    tasks.run(&mut resumed, &|_| true).unwrap();
    assert_eq!(resumed.complete(n_cells(&maps)).ok().unwrap().0.concat(), whole);
}

/// In units of the scene the answers are the same. Six numbers that pass through a power of the
/// scale keep all digits but the last few, of which a run of 60 steps loses some more; f32 begins
/// with seven.
#[test]
fn a_scene_in_other_units_has_the_same_answer() {
    let exact = [Method::QUASI_STATIC, Method::INERTIAL_MIDPOINT, Method::INERTIAL_EULER, Method::RAPIER];
    for row in rows(&[quick("scales")], &all_methods()) {
        let Some(error) = row.numbers.error_share else { panic!("{row:?}") };
        let bound = if exact.contains(&row.method) { 1e-9 } else { 1e-3 };
        assert!(error < bound, "{row:?}");
    }
}

/// A fault put into a backend that has none.
#[derive(Clone, Copy, Debug)]
enum Fault {
    NotANumber,
    Panics,
    GivesEnergy,
    Creeps,
    LeavesTheAxis,
    GoesTooFar,
    LosesATip,
    StopsConverging,
    Fails,
}

struct Broken {
    inside: Box<dyn Backend>,
    fault: Fault,
    n_steps: u32,
}

impl Broken {
    fn by(&self, size: f64) -> f64 {
        f64::from(self.n_steps) * size
    }
}

impl Backend for Broken {
    fn attach(&mut self, spring: usize, tip: Vec2) {
        self.inside.attach(spring, tip);
    }

    fn release(&mut self, spring: usize) {
        self.inside.release(spring);
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        self.n_steps += 1;
        let report = self.inside.advance(tip_targets, duration);
        match (self.fault, self.n_steps) {
            (Fault::Panics, 20) => panic!("a test double breaks"),
            (Fault::StopsConverging, 20) => StepReport { status: Status::NotConverged, n_not_converged: 1, residual: 0.1, ..report },
            (Fault::Fails, 20) => StepReport { status: Status::Failed, ..report },
            _ => report,
        }
    }

    fn motion(&self) -> Motion {
        let mut motion = self.inside.motion();
        match self.fault {
            Fault::NotANumber if self.n_steps == 30 => motion.twist.angular = f64::NAN,
            Fault::Creeps => motion.pose.position.x += self.by(1e-12),
            Fault::LeavesTheAxis => motion.pose.position.y += self.by(1e-6),
            Fault::GoesTooFar => motion.pose.position.x *= 1.2,
            _ => (),
        }
        motion
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        let tip = self.inside.tip(spring);
        if matches!(self.fault, Fault::LosesATip) && self.n_steps > 9 { tip.map(|tip| tip + Vec2::new(1e-9, 0.0)) } else { tip }
    }

    fn pull(&self, spring: usize) -> Vec2 {
        self.inside.pull(spring)
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        self.inside.friction_forces()
    }

    fn energy(&self) -> EnergyLedger {
        let mut energy = self.inside.energy();
        if matches!(self.fault, Fault::GivesEnergy) {
            energy.elastic += self.by(0.01) * energy.tip_work.abs();
        }
        energy
    }
}

/// One well-behaved cell of this map on a quasi-static backend with a fault, which is nowhere else.
fn judged(map: &str, fault: Option<Fault>) -> Row {
    let map = all().into_iter().find(|of_all| of_all.name == map).unwrap();
    let (x, y) = if map.name == "friction-margin" { (1.0, 0.5) } else { (1e-3, 0.664) };
    let value = |name, value| Axis { name, values: vec![value], names: Vec::new() };
    let map = Map { x: value(map.x.name, x), y: value(map.y.name, y), ..map };
    let make = move |scenario: &Scenario, options: &BackendOptions| -> Box<dyn Backend> {
        let inside = backend_of(scenario, options);
        fault.map_or_else(|| backend_of(scenario, options), |fault| Box::new(Broken { inside, fault, n_steps: 0 }))
    };
    let rows = tasks(&[map], &[Method::QUASI_STATIC], &make).finished(&|_| true).unwrap();
    rows[0][0].clone()
}

#[test]
fn every_fault_of_a_backend_is_called_by_its_name() {
    for map in ["friction-margin", "step-stiffness"] {
        assert_eq!(judged(map, None).outcome, Outcome::Finished);
    }
    // In cells that explain none of it, what a judge finds is unexplained and says what.
    for (map, fault, outcome, cause) in [
        ("step-stiffness", Fault::NotANumber, Outcome::NotFinite, "turn rate at step 30"),
        ("step-stiffness", Fault::Panics, Outcome::Panicked, "a test double breaks at crates/app/../../tests/program/stress.rs"),
        ("step-stiffness", Fault::GivesEnergy, Outcome::Unexplained, "energy-from-nowhere without"),
        ("friction-margin", Fault::Creeps, Outcome::Unexplained, "creep without"),
        ("step-stiffness", Fault::LeavesTheAxis, Outcome::Unexplained, "drift without"),
        ("step-stiffness", Fault::GoesTooFar, Outcome::Unexplained, "error without"),
        ("step-stiffness", Fault::LosesATip, Outcome::Unexplained, "tip 0 is not where it was sent at step 10"),
        ("step-stiffness", Fault::StopsConverging, Outcome::Unexplained, "not-converged without"),
        ("step-stiffness", Fault::Fails, Outcome::Unexplained, "failed without"),
    ] {
        let row = judged(map, Some(fault));
        assert_eq!((row.outcome, row.cause.starts_with(cause)), (outcome, true), "{fault:?}: {row:?}");
    }
}

#[test]
fn a_scene_against_the_rules_is_refused_with_their_words() {
    let map = Map { x: Axis { values: vec![-1.0], ..quick("friction-speed").x }, ..quick("friction-speed") };
    for row in rows(&[map], &[Method::QUASI_STATIC]) {
        assert_eq!(row.outcome, Outcome::Refused);
        assert!(row.cause.contains("ground.friction_coefficient") && row.cause.contains("found -1"), "{row:?}");
    }
}

fn call(args: &[&str]) -> Output {
    root::cohaul().arg("stress").args(args).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

#[test]
fn the_program_lists_its_maps_and_writes_them_whole() {
    let list = call(&["--list"]);
    assert_eq!((list.status.code(), text(&list.stdout).lines().filter(|line| !line.starts_with("   ")).count()), (Some(0), all().len()));
    let room = tempdir().unwrap();
    let out = room.path().join("out");
    let output = call(&[
        "--map",
        "step-mass",
        "supports",
        "--backend",
        "quasi-static",
        "rapier",
        "--quick",
        "--json",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
    let found: Value = serde_json::from_str(text(&output.stdout)).unwrap();
    assert_eq!((&found["holds"], &found["n_cells"], &found["n_runs"]), (&true.into(), &32.into(), &64.into()));
    let mut names: Vec<_> = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["cells.csv", "manifest.json", "report.html", "step-mass.svg", "summary.json", "supports.svg"]);
    assert_eq!(fs::read_dir(room.path()).unwrap().count(), 1, "no state is left beside");
    let mut table = csv::Reader::from_path(out.join("cells.csv")).unwrap();
    assert!(table.headers().unwrap().iter().take(3).eq(["map", "x_name", "x"]));
    assert_eq!(table.records().map(Result::unwrap).count(), 64);
    let figure = fs::read_to_string(out.join("supports.svg")).unwrap();
    assert!(figure.starts_with("<svg") && !figure.contains("NaN") && !figure.contains("inf") && figure.contains("ring, drawn ahead"));
    let sums = |counts: &Value| {
        counts.as_object().unwrap().values().flat_map(|of| of.as_object().unwrap().values()).filter_map(Value::as_u64).sum::<u64>()
    };
    assert_eq!(sums(&found["outcomes"]), 64);
}

/// A journal of another question, or of an earlier version, is refused and stays.
#[test]
fn a_foreign_state_and_nonsense_are_usage() {
    let room = tempdir().unwrap();
    let out = room.path().join("out");
    let state = room.path().join("out.journal");
    drop(Records::<Value>::open(&state, "stress", &serde_json::json!({ "maps": ["wind"] })).unwrap());
    let asked = fs::read_to_string(&state).unwrap();
    let folder = out.to_str().unwrap();
    for (args, word) in [
        (&["--map", "flying"][..], "flying"),
        (&["--backend", "flying"], "flying"),
        (&["--map"], "--map"),
        (&["--list", "--json"], "--list"),
        (&["flying"], "flying"),
        (&["--map", "wind", "--quick", "--out", folder], "is of another stress: backends is absent"),
    ] {
        let output = call(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert_eq!(text(&output.stdout), "", "{args:?}");
        assert!(text(&output.stderr).contains(word) && !text(&output.stderr).contains("panicked"), "{args:?}: {}", text(&output.stderr));
    }
    assert_eq!(fs::read_to_string(&state).unwrap(), asked);
    let old = r#"{"asked":{"version":"0","commit":null,"maps":["wind"],"backends":["rapier"],"effort":"full"},"wall_s":1.0,"done":{}}"#;
    fs::write(&state, old).unwrap();
    let output = call(&["--map", "wind", "--quick", "--out", folder]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("not a journal that this version of cohaul reads"));
    assert_eq!(fs::read_to_string(&state).unwrap(), old);
}
