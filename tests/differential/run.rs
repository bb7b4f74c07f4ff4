//! Runs of the exact backends, and distances between them.

use std::path::Path;
use std::time::Duration;
use std::{env, fs};

use cohaul::backend::BackendKind::{Inertial, QuasiStatic};
use cohaul::backend::{BackendKind, BackendOptions, EnergyLedger, Status, Tolerance};
use cohaul::math::Pose;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation, backend_of, controller_of};
use serde_json::json;

use crate::scene::Scene;

/// The backends whose answers are exact up to their steps.
pub const EXACT: [BackendKind; 2] = [QuasiStatic, Inertial];

/// How a run divides its time.
#[derive(Clone, Copy, Debug)]
pub enum Steps {
    /// Steps of the default length.
    Default,
    /// Steps of half that length.
    Halved,
    /// Steps of this length (s).
    Of(f64),
    /// Error control with this tolerance (m).
    Within(f64),
}

/// What a run came to.
#[derive(Clone, Debug)]
pub struct Run {
    /// Poses at the instants of the control periods.
    pub poses: Vec<Pose>,
    pub status: Status,
    pub energy: EnergyLedger,
    /// Time of the processor that it took.
    pub took: Duration,
}

/// Time of the processor that this thread has used, in hundredths of a second: other processes do
/// not count. It is zero where the system has no such file.
fn processor_time() -> Duration {
    let stat = fs::read_to_string("/proc/thread-self/stat").unwrap_or_default();
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace();
    let ticks: u64 = fields.skip(11).take(2).filter_map(|field| field.parse::<u64>().ok()).sum();
    Duration::from_millis(10 * ticks)
}

/// Time of the processor after which a run is given up.
const GIVEN_UP: Duration = Duration::from_secs(8);

/// Runs a scenario to its end, or until it is given up.
pub fn run_scenario(scenario: &Scenario, kind: BackendKind, steps: Steps) -> Run {
    let by_default = BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
    let options = match steps {
        Steps::Default => by_default,
        Steps::Halved => BackendOptions { step_s: 0.5 * by_default.step_s, ..by_default },
        Steps::Of(step_s) => BackendOptions { step_s, ..by_default },
        Steps::Within(tolerance) => BackendOptions::within(kind, Tolerance::at_edge(tolerance, &scenario.system.load)),
    };
    let begun = processor_time();
    let start = |options: &BackendOptions| {
        Simulation::from_parts(scenario, options, Keep::Trace, controller_of(scenario), backend_of(scenario, options))
    };
    let mut run = start(&options);
    let goes_on = |_| processor_time().saturating_sub(begun) < GIVEN_UP;
    if options.tolerance.is_some() {
        run.run_to_tolerance(start, goes_on)
    } else {
        run.run(goes_on)
    }
    let took = processor_time().saturating_sub(begun);
    let (trace, outcome) = run.into_results();
    Run {
        poses: trace.rows.iter().map(|row| row.motion.pose).collect(),
        status: if took < GIVEN_UP { outcome.steps.status } else { outcome.steps.status.max(Status::NotConverged) },
        energy: outcome.energy,
        took,
    }
}

/// Runs a scene to its end.
pub fn run(scene: &Scene, kind: BackendKind, steps: Steps) -> Run {
    let run = run_scenario(&scene.scenario(), kind, steps);
    if run.took >= GIVEN_UP {
        println!("{} {steps:?}, {}: takes {:.1?} for {} instants", kind.name(), scene.name, run.took, run.poses.len());
        keep(&format!("slow-{}-{}", kind.name(), scene.name.replace(' ', "-")), scene, run.end());
    }
    run
}

/// Distance of two divisions of time over the distance from half of the step (1): each error is
/// about twice that distance for steps of first order, and both may have the other sign.
const OTHER_STEPS: f64 = 4.0;

/// Largest distance over the size of two runs of a scene whose steps of the default length are
/// divided at other instants (1), if `plain` is one of them.
pub fn step_error(scene: &Scene, kind: BackendKind, plain: &Run) -> f64 {
    OTHER_STEPS * run(scene, kind, Steps::Halved).apart(plain, scene.size())
}

impl Run {
    /// Position (m) and heading (rad) at the end; no numbers where the run was given up at once.
    pub fn end(&self) -> [f64; 3] {
        self.poses.last().map_or([f64::NAN; 3], |pose| [pose.position.x, pose.position.y, pose.heading])
    }

    /// Whether all steps met their tolerances.
    pub fn has_converged(&self) -> bool {
        self.status == Status::Converged
    }

    /// Largest heading on the way, in magnitude (rad).
    pub fn most_turned(&self) -> f64 {
        self.poses.iter().map(|pose| pose.heading.abs()).fold(0.0, f64::max)
    }

    /// Largest distance from another run at an instant: coordinates over the load's size, and
    /// headings (1, rad). It is infinite where one of them was given up.
    pub fn apart(&self, other: &Self, size: f64) -> f64 {
        if self.poses.len() != other.poses.len() {
            // One of them was given up.
            return f64::INFINITY;
        }
        self.distances(other, size).fold(0.0, f64::max)
    }

    /// Distance from another run at each instant, as in [`Run::apart`].
    fn distances<'a>(&'a self, other: &'a Self, size: f64) -> impl Iterator<Item = f64> + 'a {
        let distance = move |(a, b): (&Pose, &Pose)| ((a.position - b.position).amax() / size).max((a.heading - b.heading).abs());
        // A distance that is not a number counts as infinite.
        self.poses.iter().zip(&other.poses).map(distance).map(|one| if one.is_nan() { f64::INFINITY } else { one })
    }

    /// Number of the first instant at which another run is farther than `allowed` of the size.
    pub fn parts_at(&self, other: &Self, size: f64, allowed: f64) -> Option<usize> {
        self.distances(other, size).position(|one| one > allowed)
    }
}

/// Largest difference of three numbers (m, m, rad).
pub fn off(found: [f64; 3], right: [f64; 3]) -> f64 {
    let worst = found.iter().zip(right).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if found.iter().all(|value| value.is_finite()) { worst } else { f64::INFINITY }
}

/// Fails with all findings.
pub fn expect_none(findings: Vec<String>) {
    assert!(findings.is_empty(), "{} wrong:\n{}", findings.len(), findings.join("\n"));
}

/// Writes a scene and its right end (m, m, rad) into the folder `COHAUL_DUMP`, where there is one.
pub fn keep(name: &str, scene: &Scene, right: [f64; 3]) {
    let Ok(folder) = env::var("COHAUL_DUMP") else { return };
    let folder = Path::new(&folder);
    fs::write(folder.join(format!("{name}.json")), format!("{:#}", scene.json())).expect("the scene is written");
    fs::write(folder.join(format!("{name}.right")), json!(right).to_string()).expect("the answer is written");
}
