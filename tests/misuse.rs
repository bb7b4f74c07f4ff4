//! What a caller in code may get wrong is answered by a status, an error or a panic that says so,
//! and never by numbers that look like an answer.

use std::path::Path;
use std::sync::Arc;

use cohaul::analysis::estimate::with_estimate;
use cohaul::backend::friction::FrictionSolver;
use cohaul::backend::{Backend, BackendKind, BackendOptions, Integrator, Status, Tolerance, build};
use cohaul::math::{Mat3, Vec2, Vec3};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Replay, Simulation, controller_of};

fn scenario(name: &str) -> Scenario {
    Scenario::read(&Path::new("scenarios").join(name)).unwrap()
}

/// Both exact backends, of either order, at fixed steps and under error control.
fn exact(scenario: &Scenario) -> Vec<BackendOptions> {
    let fixed = |kind| BackendOptions::new(kind, 1e-3);
    let tolerance = Tolerance::at_edge(1e-6, &scenario.system.load);
    vec![
        fixed(BackendKind::QuasiStatic),
        BackendOptions { second_order: true, ..fixed(BackendKind::QuasiStatic) },
        fixed(BackendKind::Inertial),
        BackendOptions { integrator: Integrator::Euler, ..fixed(BackendKind::Inertial) },
        BackendOptions::within(BackendKind::QuasiStatic, tolerance),
        BackendOptions::within(BackendKind::Inertial, tolerance),
    ]
}

fn moving(scenario: &Scenario, options: &BackendOptions) -> Box<dyn Backend> {
    let mut load = build(&scenario.system, scenario.start, options);
    load.attach(0, Vec2::new(0.04, 0.0));
    let n = scenario.system.springs.len();
    assert_eq!(load.advance(&vec![Vec2::new(0.05, 0.01); n], 0.01).status, Status::Converged);
    load
}

/// Nothing moves, nothing is booked, and what makes sense afterwards goes on as if nothing had
/// been.
#[test]
fn tips_that_go_nowhere_and_times_that_do_not_pass_are_failures() {
    let scenario = scenario("analytic/centre-pull.json");
    let there = [Vec2::new(0.05, 0.02)];
    for options in exact(&scenario) {
        let undisturbed = {
            let mut load = moving(&scenario, &options);
            load.advance(&there, 0.01);
            load.motion()
        };
        let nowhere = [f64::NAN, f64::INFINITY, 1e300].map(|x| (Vec2::new(x, 0.0), 0.01));
        let never = [0.0, -0.01, f64::NAN, f64::INFINITY].map(|duration| (there[0], duration));
        for (target, duration) in nowhere.into_iter().chain(never) {
            let mut load = moving(&scenario, &options);
            let (before, books) = (load.motion(), load.energy());
            let report = load.advance(&[target], duration);
            let what = format!("{target:?} in {duration} s by {options:?}");
            assert!(report.status == Status::Failed && report.n_not_converged > 0, "{what}: {report:?}");
            assert_eq!((load.motion(), load.energy(), load.tip(0)), (before, books, Some(Vec2::new(0.05, 0.01))), "{what}");
            let mut again = build(&scenario.system, scenario.start, &options);
            again.restore(&load.save().unwrap()).unwrap();
            for load in [&mut load, &mut again] {
                assert_eq!(load.advance(&there, 0.01).status, Status::Converged, "{what}");
                assert_eq!(load.motion(), undisturbed, "{what}");
            }
        }
    }
}

/// A time that does not pass is no end of a run of rapier either; and who estimates inertia beside
/// a run sees nothing of what was refused.
#[test]
fn what_is_refused_leaves_engine_and_estimate_as_they_were() {
    let scenario = scenario("analytic/centre-pull.json");
    let there = [Vec2::new(0.05, 0.02)];
    let engine = BackendOptions::new(BackendKind::Rapier, 1e-3);
    for duration in [0.0, -0.01, f64::NAN, f64::INFINITY] {
        let mut load = moving(&scenario, &engine);
        let before = load.motion();
        assert_eq!((load.advance(&there, duration).status, load.motion()), (Status::Failed, before));
        assert_eq!(load.advance(&there, 0.01).status, Status::Converged);
    }
    let estimate = |with_refused: bool| {
        let (mut load, estimator) = with_estimate(&scenario.system, scenario.start, &BackendOptions::new(BackendKind::QuasiStatic, 1e-3));
        load.attach(0, Vec2::zeros());
        for tick in 1..=100 {
            let target = [Vec2::new(1e-3 * f64::from(tick), 0.0)];
            if with_refused && tick % 10 == 0 {
                assert_eq!(load.advance(&[Vec2::new(f64::NAN, 0.0)], 0.01).status, Status::Failed);
                assert_eq!(load.advance(&target, -1.0).status, Status::Failed);
            }
            load.advance(&target, 0.01);
        }
        let estimated = estimator.borrow().estimate();
        assert!(estimated.edge_displacement_max_m > 1e-4, "{estimated:?}");
        estimated
    };
    assert_eq!(estimate(true), estimate(false));
}

/// A tip that is grasped nowhere pulls nobody, and its release leaves the books as they were.
#[test]
fn a_grasp_nowhere_fails_until_it_is_let_go() {
    let scenario = scenario("analytic/release-jump.json");
    for options in exact(&scenario) {
        let mut load = moving(&scenario, &options);
        let targets = [Vec2::new(0.05, 0.01); 2];
        load.attach(1, Vec2::new(f64::NAN, 0.0));
        assert_eq!(load.advance(&targets, 0.01).status, Status::Failed, "{options:?}");
        load.release(1);
        assert_eq!(load.advance(&targets, 0.01).status, Status::Converged, "{options:?}");
        let energy = load.energy();
        assert!(energy.defect().is_finite() && energy.tip_work.is_finite(), "{energy:?}");
    }
}

#[test]
fn problems_without_a_value_have_no_answer() {
    let scenario = scenario("paper/four-ants-four-springs.json");
    let mut solver = FrictionSolver::new(&scenario.system.ground, scenario.system.load.radius);
    let (h, w) = (Mat3::from_diagonal(&Vec3::new(0.664, 0.664, 1e-4)), Vec3::new(0.03, 0.0, 0.0));
    let answer = solver.solve(&h, &w);
    assert!(answer.residual < 1e-12);
    for (h, w) in [(h * f64::NAN, w), (h, Vec3::new(f64::NAN, 0.0, 0.0)), (h, Vec3::new(0.0, f64::INFINITY, 0.0))] {
        assert_eq!(solver.solve(&h, &w).residual, f64::INFINITY);
    }
    assert_eq!(solver.solve(&h, &w), answer, "and it forgets nothing by it");
}

#[test]
fn steps_and_tolerances_must_be_positive() {
    let scenario = scenario("analytic/centre-pull.json");
    let tolerance = |position_m| Tolerance { position_m, ..Tolerance::at_edge(1e-6, &scenario.system.load) };
    let fixed = [0.0, -1e-3, f64::NAN].map(|step| BackendOptions::new(BackendKind::QuasiStatic, step));
    let controlled = [0.0, -1e-3, f64::NAN].map(|error| BackendOptions::within(BackendKind::Inertial, tolerance(error)));
    for options in fixed.iter().chain(&controlled) {
        let built = std::panic::catch_unwind(|| drop(build(&scenario.system, scenario.start, options)));
        let said = *built.unwrap_err().downcast::<String>().unwrap();
        assert!(said.contains("must be positive, found "), "{said}");
    }
}

/// A replay in parts of control periods, stopped and gone on with: rows and path as without the
/// stop. With the scenario's own controller in its place it is refused, or is another run.
#[test]
fn a_run_of_another_controller_resumes() {
    let scenario = Scenario { duration: 2.0, ..scenario("paper/four-ants-four-springs.json") };
    let options = BackendOptions::new(BackendKind::Inertial, 1e-3);
    let recorded = {
        let mut run = Simulation::new(&scenario, &BackendOptions::new(BackendKind::QuasiStatic, 2.5e-3), Keep::Trace);
        run.run(|_| true);
        Arc::new(run.into_results().0)
    };
    let replay = || Box::new(Replay::new(Arc::clone(&recorded), scenario.system.springs.len()));
    let whole = {
        let mut run = Simulation::with_controller(&scenario, &options, Keep::Trace, replay()).with_rows_per_period(3);
        run.run(|_| true);
        // A step after the end is none.
        run.step();
        run.into_results().0
    };
    let mut run = Simulation::with_controller(&scenario, &options, Keep::Trace, replay()).with_rows_per_period(3);
    run.run(|time| time < 0.9);
    let saved = run.save().unwrap();
    let backend = build(&scenario.system, scenario.start, &options);
    let mut resumed = Simulation::resume_from_parts(&scenario, &saved, Keep::Trace, replay(), backend).unwrap();
    resumed.run(|_| true);
    assert_eq!(resumed.into_results().0, whole);
    assert_eq!(whole.rows.len(), 3 * 800 + 1);
    let other = Simulation::resume_from_parts(
        &scenario,
        &saved,
        Keep::Trace,
        controller_of(&scenario),
        build(&scenario.system, scenario.start, &options),
    );
    assert!(other.is_err());
}
