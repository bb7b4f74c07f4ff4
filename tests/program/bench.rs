//! Run time against error: what is claimed of errors and of the tables made from them; no test
//! asserts a time.

#[path = "../common/root.rs"]
mod root;

use std::fs;
use std::process::Output;

use cohaul::analysis::compare::EngineName;
use cohaul::backend::CLARABEL_ACCURACY;
use cohaul::backend::{BackendKind, BackendOptions, ConeSolver, RapierOptions, Status};
use cohaul::math::{Vec2, Vec3};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation};
use cohaul_report::json;
use cohaul_studies::bench::figure::work_precision_figure;
use cohaul_studies::bench::report::Benchmark;
use cohaul_studies::bench::text::bench_text;
use cohaul_studies::bench::{
    BenchError, Effort, Ending, Host, LEVELS, Level, Measured, Plan, Problem, Reference, Row, Scene, Sequence, Solver, bench, equal_errors,
    four_ants, kkt_residual, problems_of, standard_scenes,
};
use cohaul_studies::methods::{METHODS, Method};
use cohaul_studies::runner::Records;
use cohaul_studies::subject::{Ended, Meet, built_in, own};
use serde_json::Value;
use tempfile::tempdir;

fn scene(name: &str) -> Scene {
    standard_scenes().into_iter().find(|scene| scene.name == name).unwrap_or_else(|| panic!("{name}"))
}

fn reference(scene: &Scene, kind: BackendKind) -> Reference {
    Reference::find(&scene.scenario, kind, |_| true).unwrap().unwrap()
}

/// Largest edge displacements from the reference, of a method at its levels (m).
fn errors(scene: &Scene, method: &str, levels: &[Level]) -> Vec<f64> {
    let method = method.parse::<Method>().unwrap();
    let reference = reference(scene, if method.kind == BackendKind::QuasiStatic { method.kind } else { BackendKind::Inertial });
    let row = |level: &Level| Row::measure(scene, (&method, &own), *level, (&reference, 1.0), f64::INFINITY, |_| true).unwrap();
    levels.iter().map(|level| row(level).errors_m.unwrap()[0]).collect()
}

/// Powers with which errors fall when the step is halved.
fn orders(scene: &Scene, method: &str, longest: f64) -> Vec<f64> {
    let levels: Vec<Level> = (0..4).map(|i| Level::Step(longest * 0.5f64.powi(i))).collect();
    errors(scene, method, &levels).windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

#[test]
fn errors_fall_with_the_order_of_the_method() {
    let pull = scene("ramp-and-hold");
    // Onset and rest lie anywhere within a step: some of the error jumps about by that.
    for (method, order) in [("inertial euler", 1.0), ("inertial midpoint", 2.0), ("rapier aligned", 1.0)] {
        let found = orders(&pull, method, 2e-3);
        let mean = found.iter().sum::<f64>() / 3.0;
        assert!((mean - order).abs() < 0.2 && found.iter().all(|found| (found - order).abs() < 0.7), "{method}: {found:?}");
    }
    // Without inertia that scene is exact at any step; a turning slip is not.
    assert!(errors(&pull, "quasi-static", &[Level::Step(8e-3)])[0] < 1e-15);
    let found = orders(&scene("four-tips-held"), "quasi-static", 0.02);
    assert!(found.iter().all(|order| (order - 1.0).abs() < 0.2), "{found:?}");
}

/// The closed forms and error control know nothing of each other.
#[test]
fn closed_forms_are_met_under_error_control() {
    let mut n_known = 0;
    for scene in standard_scenes() {
        for (kind, method) in [(BackendKind::QuasiStatic, "quasi-static controlled"), (BackendKind::Inertial, "inertial controlled")] {
            let Some(_) = cohaul_studies::known_answers::known(&scene.scenario, kind) else { continue };
            let error = errors(&scene, method, &[Level::Tolerance(1e-7)])[0];
            // A shift of the tolerance and a turn that moves the rim as far.
            assert!(error < 2e-7, "{} {}: {error}", scene.name, kind.name());
            n_known += 1;
        }
    }
    // Slide and spin with inertia; the pull, and the pull that stops, both ways.
    assert_eq!(n_known, 6);
}

/// A box that slides along a rough wall is 9 mm short of the closed form without the wall. A load
/// without springs that a post pushes has a path without inertia too.
#[test]
fn references_among_obstacles_know_the_obstacles() {
    let wall = reference(&scene("box-wall-friction"), BackendKind::QuasiStatic);
    let end = wall.poses.last().unwrap().position;
    // K2 of the known answers, at a tolerance of 1e-8 of the path length.
    assert!((end.x - 20.906024096e-3).abs() < 1e-9 && end.y.abs() < 1e-12, "{end}");
    assert!(wall.source.starts_with("quasi-static within"), "{}", wall.source);
    let pushed = scene("push-aside");
    assert!(METHODS.iter().all(|method| pushed.asks(method)));
    let path = reference(&pushed, BackendKind::QuasiStatic);
    assert!(path.poses.last().unwrap().heading < -0.5, "the box turns off the post");
}

fn end_of(scenario: &Scenario, cone_solver: ConeSolver) -> cohaul::simulation::Outcome {
    let options = BackendOptions { cone_solver, ..BackendOptions::new(BackendKind::QuasiStatic, 0.04) };
    let mut run = Simulation::new(scenario, &options, Keep::Outcome);
    run.run(|_| true);
    run.outcome()
}

#[test]
fn clarabel_moves_the_load_as_the_exact_solver_does_but_by_other_bits() {
    let scene = scene("four-tips-prescribed");
    let scenario = Scenario { duration: 6.0, ..scene.scenario };
    let [exact, clarabel] = [ConeSolver::Exact, ConeSolver::Clarabel].map(|solver| end_of(&scenario, solver));
    assert_eq!((exact.steps.status, clarabel.steps.status), (Status::Converged, Status::Converged));
    let [a, b] = [exact, clarabel].map(|outcome| outcome.motion.pose);
    let (apart, way) = ((a.position - b.position).norm(), a.position.norm());
    assert!(way > 0.04 && apart < CLARABEL_ACCURACY * way && apart > 0.0, "{apart} of {way}");
    assert!((a.heading - b.heading).abs() < CLARABEL_ACCURACY && a.heading != b.heading);
}

#[test]
fn the_cone_solver_is_an_option_that_the_exact_one_does_not_show() {
    let exact = BackendOptions::new(BackendKind::QuasiStatic, 1e-3);
    let text = serde_json::to_string(&exact).unwrap();
    assert!(!text.contains("cone_solver") && serde_json::from_str::<BackendOptions>(&text).unwrap() == exact);
    let clarabel = BackendOptions { cone_solver: ConeSolver::Clarabel, ..exact };
    let text = serde_json::to_string(&clarabel).unwrap();
    assert!(text.contains("\"cone_solver\":\"clarabel\"") && serde_json::from_str::<BackendOptions>(&text).unwrap() == clarabel);
}

#[test]
fn the_residual_of_a_friction_problem_is_rounding_for_the_exact_solver_and_sees_a_wrong_answer() {
    let scenario = four_ants();
    let (ground, length) = (&scenario.system.ground, scenario.system.load.radius);
    let problems = problems_of(&scenario, 300);
    assert_eq!(problems.len(), 300);
    let mut solver = cohaul::backend::friction::FrictionSolver::new(ground, length);
    let mut n_moving = 0;
    for problem in &problems {
        let increment = solver.solve(&problem.hessian, &problem.drive).increment;
        let resistances: Vec<Vec2> = solver.forces().iter().map(|force| -force).collect();
        let residual = |problem: &Problem| kkt_residual(ground, length, problem, &increment, &resistances);
        // Some tens of roundings.
        assert!(residual(problem) < 1e-13, "{}", residual(problem));
        let pushed = Problem { drive: 1.001 * problem.drive, ..*problem };
        // A thousandth of the drive is out of balance, at least half of it in one entry.
        let drive = problem.drive.component_div(&Vec3::new(1.0, 1.0, length)).norm();
        let out_of_balance = 5e-4 * drive / (scenario.system.total_slip_limit() + 1.001 * drive);
        n_moving += usize::from(increment.norm() > 0.0);
        assert!(residual(&pushed) > out_of_balance, "{} {out_of_balance}", residual(&pushed));
    }
    assert!(n_moving > 30, "{n_moving}");
}

fn measured(plan: &Plan) -> Measured {
    bench(plan, &mut Records::in_memory(), &mut |_| true).unwrap()
}

fn plan(scene: Scene, budget_s: f64) -> Plan<'static> {
    Plan { scenes: vec![scene], engines: Vec::new(), effort: Effort { repeats: 2, budget_s, quick: true }, solvers: None, growth: None }
}

/// An engine of the user is measured as rapier is, and stands beside it in tables and figures.
#[test]
fn engines_of_users_are_measured_beside_the_methods() {
    let (rapier, refuses) = (built_in(BackendKind::Rapier, RapierOptions::default()), |_: &Scenario, _: &BackendOptions| {
        Err(Ended::Refused("too small".to_owned()))
    });
    let engines: [(&str, &Meet); 2] = [("rapier again", &rapier), ("shy", &refuses)];
    let engines = engines.map(|(name, meet)| (Method::of_user(name).unwrap(), meet)).to_vec();
    let plan = Plan { engines, ..plan(scene("slide-spin"), 0.5) };
    let found = measured(&plan);
    let of = |name: &str| found.rows.iter().filter(|row| row.method == name).collect::<Vec<_>>();
    let (own, again) = (of("rapier aligned"), of("rapier again"));
    assert!(
        own.len() == again.len() && own.iter().zip(&again).all(|(one, other)| one.errors_m == other.errors_m && one.errors_m.is_some())
    );
    assert!(again.iter().all(|row| !row.seconds.is_empty()));
    assert_eq!(of("shy")[0].cause(), Some("refused: too small".to_owned()));
    let names = ["rapier again", "shy"].map(|name| EngineName { name: name.into(), version: Some("2".to_owned()) });
    let found = Benchmark { engines: names.to_vec(), ..Benchmark::new(Host::here(), plan.effort, found, 1.0) };
    let text = bench_text(&found);
    assert!(text.contains("rapier again 2: real time") && found.equal_error.iter().any(|line| line.method == "rapier again"), "{text}");
    let figure = work_precision_figure(&found.scenes[0], &found.measured.rows, 0.5);
    assert!(figure.contains("rapier again"));
}

#[test]
fn settings_that_take_too_long_are_rows_and_nothing_finer_is_tried() {
    let plan = plan(scene("slide"), 1e-9);
    let found = measured(&plan);
    let n_methods = METHODS.iter().filter(|method| method.kind != BackendKind::QuasiStatic).count();
    assert_eq!(found.rows.iter().filter(|row| row.ending == Ending::TooLong(1e-9)).count(), n_methods);
    assert!(found.rows.len() > 2 * n_methods && found.rows.iter().all(|row| !row.is_answered() && row.cause().is_some()));
    assert!(found.rows.iter().all(|row| row.timing().is_none() && row.cause().unwrap().contains("longer than")));
    let benchmark = Benchmark::new(Host::here(), plan.effort, found, 0.1);
    assert!(benchmark.equal_error.iter().all(|line| line.cpu_s.is_none() && line.step_s.is_none()));
    let text = json::pretty(&benchmark).unwrap() + &bench_text(&benchmark);
    assert!(!text.contains("NaN") && text.contains("settings failed or took too long"));
}

/// All but the times, which nobody knows beforehand.
fn untimed(found: &Measured) -> (Vec<Row>, Vec<usize>) {
    let rows = found.rows.iter().map(|row| Row { seconds: Vec::new(), ..row.clone() }).collect();
    (rows, found.rows.iter().map(|row| row.seconds.len()).collect())
}

#[test]
fn a_benchmark_that_was_stopped_goes_on_and_measures_nothing_twice() {
    let whole = measured(&plan(scene("spin"), 10.0));
    let (room, mut n_stops) = (tempdir().unwrap(), 0);
    let found = loop {
        let mut n_calls = 0;
        let mut stop_soon = |share: f64| {
            assert!((0.0..=1.0).contains(&share), "{share}");
            n_calls += 1;
            n_calls < 400
        };
        let mut records = Records::open(&room.path().join("journal"), "bench", &"here").unwrap();
        match bench(&plan(scene("spin"), 10.0), &mut records, &mut stop_soon) {
            Ok(found) => break found,
            Err(BenchError::Stopped) => n_stops += 1,
            Err(error) => panic!("{error}"),
        }
        assert!(n_stops < 100);
    };
    assert!(n_stops > 1, "{n_stops}");
    assert_eq!(untimed(&found), untimed(&whole));
    assert!(untimed(&whole).1.iter().all(|n| *n == 2));
    assert_eq!(found.scenes, whole.scenes);
}

#[test]
fn error_control_reaches_levels_that_no_engine_does_and_costs_are_monotone() {
    let found = measured(&plan(scene("tripod-spin-pinned"), 10.0));
    let table = equal_errors(&found.rows);
    for method in METHODS.iter() {
        let costs: Vec<Option<f64>> = table.iter().filter(|line| line.method == method.name).map(|line| line.cpu_s).collect();
        assert!(costs.is_empty() == (method.kind == BackendKind::QuasiStatic));
        assert!(costs.is_empty() || costs.len() == LEVELS.len());
        // A level that is not reached ends the list, and no finer one costs less.
        assert!(costs.windows(2).all(|pair| pair[1].is_none() || pair[0].is_some_and(|cost| cost <= pair[1].unwrap())), "{costs:?}");
    }
    let reached = |method: &str| table.iter().filter(|line| line.method == method && line.cpu_s.is_some()).count();
    assert_eq!(reached("inertial controlled"), LEVELS.len());
    assert!(reached("inertial midpoint") > reached("inertial euler") && reached("inertial midpoint") > reached("rapier aligned"));
}

#[test]
fn times_that_spread_warn_and_are_counted() {
    let mut found = measured(&plan(scene("slide"), 1e-9));
    let noise = |found: &Measured| Benchmark::new(Host::here(), plan(scene("slide"), 1.0).effort, found.clone(), 0.1);
    found.rows.iter_mut().for_each(|row| row.seconds = vec![1.0, 1.1, 1.2]);
    let calm = noise(&found);
    assert!(!calm.noise.is_noisy && calm.noise.n_spread == 0 && !calm.warnings.iter().any(|warning| warning.contains("busy")));
    // A fifth of them.
    found.rows.iter_mut().step_by(5).for_each(|row| row.seconds = vec![1.0, 1.4, 1.5]);
    let busy = noise(&found);
    assert!(busy.noise.is_noisy && busy.warnings.iter().any(|warning| warning.contains("too busy")), "{:?}", busy.warnings);
}

fn call(args: &[&str]) -> Output {
    root::cohaul().arg("bench").args(args).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

const SLIDE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/analytic/slide.json");
const ANTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/paper/four-ants-four-springs.json");

#[test]
fn the_program_writes_tables_figures_and_manifest_whole() {
    let room = tempdir().unwrap();
    let out = room.path().join("out");
    let folder = out.to_str().unwrap();
    // No setting takes so long, on however busy a machine.
    let output = call(&[SLIDE, "--solvers", "--quick", "--repeats", "1", "--budget-s", "1000", "--out", folder]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    assert!(
        table.starts_with("slide: path length 1.456 mm\n") && table.contains("inertial midpoint") && table.contains("exact, warm"),
        "{table}"
    );
    let mut names: Vec<_> = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(
        names,
        ["bench.csv", "bench.json", "equal-error.csv", "manifest.json", "report.html", "solvers.csv", "work-precision-slide.svg"]
    );
    // Nothing beside it.
    assert_eq!(fs::read_dir(room.path()).unwrap().count(), 1);
    let json: Value = serde_json::from_str(&fs::read_to_string(out.join("bench.json")).unwrap()).unwrap();
    let rows = json["rows"].as_array().unwrap();
    let mut table = csv::Reader::from_path(out.join("bench.csv")).unwrap();
    let records: Vec<_> = table.records().map(Result::unwrap).collect();
    assert_eq!(records.len(), rows.len());
    for (record, row) in records.iter().zip(rows) {
        assert_eq!((&record[1], record[4].parse().ok()), (row["method"].as_str().unwrap(), row["error_max_m"].as_f64()));
        assert!(row["reference"].as_str().unwrap().contains("closed form") && row["n_runs"] == 1);
    }
    let figure = fs::read_to_string(out.join("work-precision-slide.svg")).unwrap();
    assert!(figure.starts_with("<svg") && !figure.contains("NaN") && figure.contains("CPU time (s)"));
    let solvers = json["solvers"].as_array().unwrap();
    assert_eq!(solvers.len(), 2 * Solver::ALL.len());
    assert!(solvers.iter().any(|line| line["problems"] == Sequence::Moving.name() && line["n_problems"].as_u64().unwrap() > 100));
    // Both solve the same problems; how exactly tells them apart.
    let residual = |at: usize| solvers[at]["residual_max"].as_f64().unwrap();
    assert!(residual(0) < 1e-13 && residual(1) > 1e-13 && residual(1) < 1e-6, "{} {}", residual(0), residual(1));
}

#[test]
fn the_program_prints_one_object_and_keeps_nothing_of_a_finished_benchmark() {
    let room = tempdir().unwrap();
    let state = room.path().join("state");
    let output = call(&[SLIDE, "--quick", "--repeats", "1", "--budget-s", "0.01", "--json", "--state", state.to_str().unwrap()]);
    let found: Value = serde_json::from_str(text(&output.stdout)).unwrap();
    assert_eq!(found["scenes"][0]["scene"], "slide");
    assert!(found["host"]["rustc"].as_str().unwrap().starts_with("rustc"));
    assert!(!state.exists());
}

#[test]
fn nonsense_is_usage() {
    let room = tempdir().unwrap();
    fs::write(room.path().join("mine.txt"), "mine").unwrap();
    let taken = room.path().to_str().unwrap();
    let foreign = room.path().join("mine.txt");
    let other = room.path().join("other.journal");
    drop(Records::<Value>::open(&other, "bench", &serde_json::json!({ "version": "0" })).unwrap());
    for (args, word) in [
        (&["no-such-file.json"][..], "no-such-file"),
        (&[ANTS], "prescribed tips"),
        (&[SLIDE, SLIDE], "twice"),
        (&[SLIDE, "--repeats", "0"], "--repeats"),
        (&[SLIDE, "--repeats", "-1"], "-1"),
        (&[SLIDE, "--budget-s", "0"], "--budget-s"),
        (&[SLIDE, "--out", taken], "not empty"),
        (&[SLIDE, "--state", foreign.to_str().unwrap()], "not a journal"),
        (&[SLIDE, "--state", other.to_str().unwrap()], "is of another bench"),
    ] {
        let output = call(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert_eq!(text(&output.stdout), "", "{args:?}");
        assert!(text(&output.stderr).contains(word) && !text(&output.stderr).contains("panicked"), "{args:?}: {}", text(&output.stderr));
    }
    assert!(foreign.exists() && other.exists());
}
