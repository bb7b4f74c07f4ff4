//! What error control costs at obstacles, and what it reaches: a survey of random scenes.
//!
//! Half of the scenes have one obstacle (`random_scene.rs`), half have up to twenty
//! (`contact/random_scene.rs`). Each runs at three tolerances on both exact backends, and is
//! measured against a run with a hundredth of the tightest tolerance, or against fine fixed steps.

use std::sync::mpsc;
use std::time::Duration;
use std::{fs, thread};

use cohaul::backend::{BackendKind, BackendOptions, PoseError, Status, StepReport, Tolerance, TransitionKind};
use cohaul::math::Pose;
use cohaul::scenario::{Drive, Scenario, TipPath, Waypoint};
use cohaul::simulation::{Keep, Outcome, Simulation, Trace};
use cohaul::stop::Stop;
use rayon::prelude::*;

use crate::contact_scene;
use crate::draws::asked;
use crate::random_scene::Random;
use crate::run::EXACT;
use crate::scene::{Body, Part, Scene, fixed, rectangle};

/// Time after which a run is given up.
const DEADLINE: Duration = Duration::from_secs(60);
/// Tolerances over the size (1), and one in metres.
const OF_SIZE: [f64; 2] = [1e-3, 1e-5];
const IN_METRES: f64 = 1e-6;
/// Tolerance of the truth over the tightest one (1).
const TRUTH: f64 = 1e-2;
/// Scale of the scenes with many obstacles (m), and the number of them that are drawn for one.
const SCALE: f64 = 0.01;
/// Steps of the truth in a control period where error control does not decide.
const FINE: f64 = 128.0;

/// Time of the processor that this thread has used (s).
fn processor_time() -> f64 {
    let stat = fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds: f64 = stat.split_whitespace().next().and_then(|text| text.parse().ok()).unwrap_or_default();
    1e-9 * nanoseconds
}

/// Result of `work`; `None` where it takes longer than the deadline.
fn in_time<T>(work: impl FnOnce() -> T) -> Option<T> {
    let stop = Stop::default();
    let (done, waits) = mpsc::channel::<()>();
    thread::scope(|scope| {
        let asks = stop.clone();
        scope.spawn(move || {
            if waits.recv_timeout(DEADLINE) == Err(mpsc::RecvTimeoutError::Timeout) {
                asks.ask();
            }
        });
        let result = stop.run(work);
        drop(done);
        result
    })
}

/// The scenario of a seed: one obstacle for even seeds, many for odd ones.
fn scenario(seed: u64, has_inertia: bool) -> Scenario {
    if seed.is_multiple_of(2) {
        return Random::new(seed, has_inertia).scene.scenario();
    }
    let mut scene = (0..).map(|more| contact_scene::Scene::new(1000 * more + seed)).find(|scene| scene.scale == SCALE).expect("half are");
    let n = scene.waypoints[0].len() - 1;
    let path = |spring: usize| {
        let share = |k: usize| k as f64 / n as f64;
        let waypoints = (0..=n).map(|k| Waypoint { time: share(k), position: scene.tip(spring, share(k)) }).collect();
        TipPath { spring, waypoints, release: (spring == 0).then_some(1.0 / 3.0) }
    };
    let paths = (0..scene.attached.len()).filter(|spring| scene.attached[*spring]).map(path).collect();
    // Obstacles that move at each other squeeze a load, which then has no answer.
    scene.system.world.obstacles.iter_mut().for_each(|obstacle| obstacle.path.waypoints.truncate(1));
    let base = Random::new(0, false).scene.scenario();
    Scenario {
        name: format!("many {seed}"),
        duration: 1.0,
        control_period: 1.0 / 30.0,
        start: scene.start,
        drive: Drive::Tips(paths),
        system: scene.system,
        ..base
    }
}

struct Ran {
    trace: Trace,
    outcome: Outcome,
    took: f64,
    n_runs: u32,
}

fn run(scenario: &Scenario, options: &BackendOptions) -> Option<Ran> {
    let begun = processor_time();
    let mut n_runs = 1;
    let start = |options: &BackendOptions| Simulation::new(scenario, options, Keep::Trace);
    let (trace, outcome) = in_time(|| {
        let mut run = start(options);
        let again = |options: &BackendOptions| {
            n_runs += 1;
            start(options)
        };
        if options.tolerance.is_some() {
            run.run_to_tolerance(again, |_| true)
        } else {
            run.run(|_| true)
        }
        run.into_results()
    })?;
    Some(Ran { trace, outcome, took: processor_time() - begun, n_runs })
}

/// Largest shift, or turn about the load's edge, between two runs up to `until` (s), in metres.
fn apart(one: &Trace, other: &Trace, radius: f64, until: f64) -> f64 {
    let poses = |trace: &Trace| trace.rows.iter().filter(|row| row.time <= until).map(|row| row.motion.pose).collect::<Vec<Pose>>();
    let (one, other) = (poses(one), poses(other));
    let distance = |(a, b): (&Pose, &Pose)| (a.position - b.position).norm().max(radius * (a.heading - b.heading).abs());
    one.iter().zip(&other).map(distance).fold(0.0, f64::max)
}

fn of_edge(error: PoseError, radius: f64) -> f64 {
    error.position.max(radius * error.heading)
}

/// The truth and its own error (m): `None` where neither way finds one.
fn truth(scenario: &Scenario, kind: BackendKind, tightest: f64) -> Option<(Trace, f64)> {
    let radius = scenario.system.load.radius;
    let options = BackendOptions::within(kind, Tolerance::at_edge(TRUTH * tightest, &scenario.system.load));
    if let Some(found) = run(scenario, &options).filter(|found| found.outcome.steps.status == Status::Converged) {
        let error = found.outcome.error.map_or(0.0, |error| of_edge(error, radius));
        return Some((found.trace, error));
    }
    let steps = |n: f64| {
        let plain = BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
        run(scenario, &BackendOptions { step_s: scenario.control_period / n, ..plain })
    };
    let (coarse, fine) = (steps(0.5 * FINE)?, steps(FINE)?);
    let error = 2.0 * apart(&coarse.trace, &fine.trace, radius, f64::INFINITY);
    Some((fine.trace, error))
}

fn of_seed(seed: u64, kind: BackendKind) -> Vec<String> {
    let scenario = scenario(seed, kind.has_inertia());
    let radius = scenario.system.load.radius;
    let [loose, tight] = OF_SIZE.map(|share| share * radius);
    let tolerances = [loose, tight, IN_METRES];
    let truth = truth(&scenario, kind, tight.min(IN_METRES));
    let row = |tolerance: f64| {
        let options = BackendOptions::within(kind, Tolerance::at_edge(tolerance, &scenario.system.load));
        let Some(found) = run(&scenario, &options) else {
            return format!("{seed},{},{tolerance:.2e},given-up,60000,0,0,0,0,0,NaN,NaN,NaN,NaN,9,0", kind.name());
        };
        let outcome = &found.outcome;
        let (steps, times) = (outcome.steps, outcome.doubtful);
        let ends = [times.not_converged_s, outcome.failed_at, times.not_unique_s];
        let decided_until = ends.into_iter().flatten().fold(f64::INFINITY, f64::min);
        let n_uncertain =
            found.trace.transitions.iter().filter(|it| matches!(it.kind, TransitionKind::Jump { is_uncertain: true, .. })).count();
        let (error, of_truth) =
            truth.as_ref().map_or((f64::NAN, f64::NAN), |(truth, of_truth)| (apart(&found.trace, truth, radius, decided_until), *of_truth));
        format!(
            "{seed},{},{tolerance:.2e},{:?},{:.2},{},{},{},{},{},{:.2e},{:.2e},{:.2e},{:.3},{:.3},{n_uncertain}",
            kind.name(),
            steps.status,
            1e3 * found.took,
            found.n_runs,
            steps.n_steps,
            steps.n_rejected,
            steps.n_solves,
            steps.n_iterations,
            error / tolerance,
            of_truth / tolerance,
            outcome.error.map_or(0.0, |error| of_edge(error, radius)) / tolerance,
            decided_until.min(scenario.duration),
            times.not_unique_s.unwrap_or(9.0),
        )
    };
    tolerances.map(row).to_vec()
}

/// A disc pushes a box with three supports by a face beside its centre, and the box turns about one
/// of them.
fn pushed_about_a_support() -> Scenario {
    let load = rectangle([0.0; 2], [0.2, 0.1]);
    let pusher =
        Body { path: vec![[0.0; 4], [1.0, 0.0, 0.02, 0.0]], ..fixed(vec![Part::Disc { centre: [0.08, -0.0701], radius: 0.02 }], 0.2) };
    let supports = [[-0.05, 0.0], [0.02, 0.04], [0.02, -0.04]].map(|offset| (offset, 3.0)).to_vec();
    let scene = Scene {
        name: "pushed about a support".into(),
        duration: 1.0,
        control_period: 0.1,
        load: vec![load],
        mass: 0.9,
        inertia: 0.004,
        start: [0.0; 3],
        velocity: [0.0; 3],
        ground_friction: 0.4,
        supports,
        springs: Vec::new(),
        obstacles: vec![pusher],
    };
    scene.scenario()
}

/// A load that is pushed while it turns about a support is solved from its last solution: each step
/// takes one or two solutions and a few iterations, in place of dozens.
#[test]
fn steps_about_a_support_start_from_the_last_one() {
    let scenario = pushed_about_a_support();
    for kind in EXACT {
        let step_s = 1e-3;
        let options = BackendOptions { step_s, ..BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period) };
        let found = run(&scenario, &options).expect("it takes little time");
        let StepReport { n_steps, n_solves, n_iterations, .. } = found.outcome.steps;
        assert!(n_solves <= 4 * n_steps && n_iterations <= 5 * n_steps, "{}: {n_solves} {n_iterations}", kind.name());
        assert_eq!((found.outcome.steps.status, n_steps), (Status::Converged, 1000), "{}", kind.name());
    }
}

/// Most iterations and solved problems of a run of one second and the one beside it (1): a million
/// for each of the two at once and one for the second, and a tenth for the macro-steps that go
/// beyond it.
const MOST_WORK: u64 = 4_400_000;

/// Random scenes in which quasi-static runs would go on for minutes end in seconds, and say from
/// when on they are not decided.
#[test]
fn runs_at_obstacles_end_after_bounded_work() {
    for seed in [15, 19] {
        let scenario = scenario(seed, false);
        let tolerance = Tolerance::at_edge(OF_SIZE[0] * scenario.system.load.radius, &scenario.system.load);
        let found = run(&scenario, &BackendOptions::within(BackendKind::QuasiStatic, tolerance)).expect("it takes seconds");
        let (StepReport { n_solves, n_iterations, .. }, doubtful) = (found.outcome.steps, found.outcome.doubtful);
        assert!(n_solves + n_iterations < MOST_WORK, "{seed}: {n_solves} {n_iterations}");
        assert_eq!(found.outcome.steps.status, Status::NotConverged, "{seed}");
        assert!(doubtful.not_converged_s.is_some_and(|time| time < scenario.duration), "{seed}: {doubtful:?}");
    }
}

/// `COHAUL_SEED` is the first seed in place of 0, `COHAUL_COUNT` the number of scenes.
#[test]
#[ignore = "takes minutes"]
fn survey_of_the_cost_of_error_control() {
    let (first, count) = (asked("COHAUL_SEED", 0), asked("COHAUL_COUNT", 300));
    println!(
        "seed,backend,tolerance_m,status,cpu_ms,runs,steps,rejected,solves,iterations,error,of_truth,reported,decided_s,not_unique_s,uncertain_jumps"
    );
    let tasks: Vec<_> = (first..first + count).flat_map(|seed| EXACT.map(|kind| (seed, kind))).collect();
    tasks.into_par_iter().with_max_len(1).for_each(|(seed, kind)| {
        for line in of_seed(seed, kind) {
            println!("{line}");
        }
    });
}
