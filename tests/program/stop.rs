//! Stops act in the midst of a control period, on every backend, and a run that was stopped there
//! goes on from its last checkpoint to the same bits.

#[path = "../common/root.rs"]
mod root;

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use cohaul::backend::{Backend, BackendKind, BackendOptions, Hook, Skips, StepReport, Tolerance, Wrapped, build};
use cohaul::math::Vec2;
use cohaul::model::SupportPoint;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation, backend_of, controller_of};
use cohaul::stop::{Stop, caught};
use serde_json::{Value, json};

fn centre_pull() -> Scenario {
    Scenario::read(&root::root().join("scenarios/analytic/centre-pull.json")).unwrap()
}

fn among_obstacles() -> Scenario {
    Scenario::read(&root::root().join("scenarios/robots/tow-past-corner.json")).unwrap()
}

fn default_options(kind: BackendKind, scenario: &Scenario) -> BackendOptions {
    BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period)
}

/// Options of each backend at steps of a nanosecond, and of those with error control.
fn all_options(scenario: &Scenario) -> Vec<BackendOptions> {
    let fixed = BackendKind::ALL.map(|kind| BackendOptions { skips: Skips::NONE, ..BackendOptions::new(kind, 1e-9) });
    let within = |kind| BackendOptions::within(kind, Tolerance::at_edge(1e-12, &scenario.system.load));
    fixed.into_iter().chain([BackendKind::QuasiStatic, BackendKind::Inertial].map(within)).collect()
}

/// A day in steps of a nanosecond is 9e13 steps: a test that ends at all was stopped. A stop that
/// was asked for before leaves the load where it was.
#[test]
fn a_day_long_advance_is_left_at_once_on_every_backend() {
    for scenario in [centre_pull(), among_obstacles()] {
        for options in all_options(&scenario) {
            let mut backend = build(&scenario.system, scenario.start, &options);
            let tip = scenario.start.pose.to_world(&scenario.system.springs[0].rest_tip());
            backend.attach(0, tip);
            let far = vec![tip + Vec2::new(0.1, 0.02); scenario.system.springs.len()];
            let before = backend.motion();
            let stop = Stop::default();
            stop.ask();
            assert!(stop.run(|| backend.advance(&far, 86_400.0)).is_none(), "{options:?}");
            assert_eq!(backend.motion(), before, "{options:?}: no step was made");
            // With error control a macro-step may be a day long where it meets the tolerance.
            if options.tolerance.is_some() {
                continue;
            }
            let mut backend = build(&scenario.system, scenario.start, &options);
            backend.attach(0, tip);
            let stop = Stop::default();
            let ended = std::thread::scope(|scope| {
                scope.spawn(|| {
                    sleep(Duration::from_millis(20));
                    stop.ask();
                });
                stop.run(|| backend.advance(&far, 86_400.0))
            });
            assert!(ended.is_none(), "{options:?}");
        }
    }
}

/// Asks for a stop in one of its advances, and lets time for a checkpoint pass in an earlier one.
struct Asks {
    n_left: u32,
    stop: Stop,
}

impl Hook for Asks {
    fn advance(&mut self, inside: &mut dyn Backend, tip_targets: &[Vec2], duration: f64) -> StepReport {
        self.n_left -= 1;
        match self.n_left {
            3 => sleep(Duration::from_millis(1050)),
            0 => self.stop.ask(),
            _ => {}
        }
        inside.advance(tip_targets, duration)
    }
}

#[test]
fn a_run_that_is_stopped_in_a_step_resumes_to_the_same_bits() {
    let scenarios = [centre_pull(), among_obstacles()].map(|scenario| {
        let duration = 30.0 * scenario.control_period;
        Scenario { duration, ..scenario }
    });
    let case = |scenario: &Scenario, options: &BackendOptions| {
        let mut whole = Simulation::new(scenario, options, Keep::Trace);
        whole.run(|_| true);
        let whole = whole.into_results();

        let stop = Stop::default();
        let hook = Asks { n_left: 20, stop: stop.clone() };
        let backend = Box::new(Wrapped { inside: backend_of(scenario, options), hook });
        let stopped = Simulation::from_parts(scenario, options, Keep::Trace, controller_of(scenario), backend);
        let mut stopped = stopped.with_checkpoints();
        assert!(stop.run(|| stopped.run(|_| true)).is_none(), "{options:?}");
        assert!(stopped.is_stopped() && !stopped.is_finished());
        let saved = stopped.save().unwrap();
        assert!(saved.time() > 0.0 && saved.time() < stopped.time(), "the second checkpoint");
        let read = serde_json::from_str(&serde_json::to_string(&saved).unwrap()).unwrap();
        let mut resumed = Simulation::resume(scenario, &read, Keep::Trace).unwrap();
        resumed.run(|_| true);
        assert_eq!(resumed.into_results(), whole, "{options:?}");
    };
    std::thread::scope(|scope| {
        for scenario in &scenarios {
            let fixed = BackendKind::ALL.map(|kind| default_options(kind, scenario));
            let within = BackendOptions::within(BackendKind::Inertial, Tolerance::at_edge(1e-5, &scenario.system.load));
            for options in fixed.into_iter().chain([within]) {
                scope.spawn(move || case(scenario, &options));
            }
        }
    });
}

/// Without a checkpoint there is nothing to go on from, and the run does not count as ended.
#[test]
fn a_stopped_run_without_checkpoints_is_not_saved() {
    let scenario = centre_pull();
    let stop = Stop::default();
    stop.ask();
    let mut run = Simulation::new(&scenario, &default_options(BackendKind::Inertial, &scenario), Keep::Outcome);
    assert!(stop.run(|| run.run(|_| true)).is_none());
    assert!(run.is_stopped() && !run.is_finished() && run.save().is_err());
    assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| caught(|| run.step()))).is_err(), "it does not go on");
}

/// Two supports on each of many points. Their number is so large that a quadratic search would take
/// minutes.
#[test]
fn the_start_of_a_run_on_a_million_supports_is_linear() {
    let mut scenario = centre_pull();
    let one = |at: usize| {
        let (bearing, share) = (0.7 * (at % 500_000) as f64, ((at % 500_000) as f64 / 500_000.0).sqrt());
        SupportPoint { offset: 0.03 * share * Vec2::new(bearing.cos(), bearing.sin()), normal_load: 1e-8, friction_coefficient: None }
    };
    scenario.system.ground.supports = (0..1_000_000).map(one).collect();
    let run = Simulation::new(&scenario, &default_options(BackendKind::QuasiStatic, &scenario), Keep::Outcome);
    assert_eq!(run.time(), 0.0);
}

/// A scene with a control period of a day, of millions of steps.
fn slow_scene(folder: &Path, n_supports: usize) -> String {
    let text = fs::read_to_string(root::root().join("scenarios/analytic/centre-pull.json")).unwrap();
    let mut scene: Value = serde_json::from_str(&text).unwrap();
    (scene["duration_s"], scene["control_period_s"]) = (864_000.0.into(), 86_400.0.into());
    scene["drive"]["paths"][0]["waypoints"] = json!([[0.0, 0.0, 0.0], [864_000.0, 50.0, 3.0]]);
    let support = |at: usize| {
        let bearing = 0.7 * at as f64;
        json!({ "offset_m": [0.03 * bearing.cos(), 0.03 * bearing.sin()], "normal_load_n": 0.0156 / n_supports as f64 })
    };
    if n_supports > 3 {
        scene["ground"]["supports"] = (0..n_supports).map(support).collect();
    }
    let path = folder.join("slow.json");
    fs::write(&path, scene.to_string()).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Exit code and the time from an interrupt to the end of the program.
#[cfg(unix)]
fn interrupted(args: &[&str], after: Duration) -> (Option<i32>, String, Duration) {
    let mut command = root::cohaul();
    let child = command.args(args).stdout(std::process::Stdio::null()).stderr(std::process::Stdio::piped()).spawn().unwrap();
    sleep(after);
    let begin = Instant::now();
    assert!(std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned(), begin.elapsed())
}

/// The limit of the time is that of a busy machine; without a stop the program would go on for
/// hours.
#[cfg(unix)]
#[test]
fn an_interrupt_ends_the_program_in_the_midst_of_a_control_period() {
    let room = tempfile::tempdir().unwrap();
    let (scene, state) = (slow_scene(room.path(), 3), room.path().join("state.json"));
    let state = state.to_str().unwrap();
    for backend in ["quasi-static", "inertial", "rapier"] {
        let args = ["run", &scene, "--backend", backend, "--no-skip", "stick-certificate", "--state", state];
        let (code, text, time) = interrupted(&args, Duration::from_millis(800));
        assert_eq!(code, Some(130), "{text}");
        assert!(text.contains("continues from"), "{text}");
        assert!(time < Duration::from_secs(5), "{backend}: {time:?}");
        eprintln!("{backend}: {time:?}");
        fs::remove_file(state).unwrap();
    }
    let (code, text, time) = interrupted(&["compare", &scene], Duration::from_millis(800));
    assert_eq!(code, Some(130), "{text}");
    assert!(time < Duration::from_secs(5), "{time:?}");
    eprintln!("compare: {time:?}");
}
