//! The prescribed and the replayed tier: three backends, one question, paths compared point by point.

use std::sync::Arc;

use serde::Serialize;

use super::{Difference, Numbers, Parting, Predicted, Settings, Solution, Tier, Verdict};
use crate::backend::{BackendKind, Status, StepReport};
use crate::scenario::Scenario;
use crate::simulation::{Driver, Keep, Replay, Simulation, driver_of};

/// What a pathwise comparison found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pathwise {
    pub tier: Tier,
    /// Inertial minus quasi-static.
    pub inertia_effect: Difference,
    /// Rapier, at the step asked for, minus inertial.
    pub engine_error: Difference,
    /// The part of it that goes with the step: rapier at the step asked for minus its own limit.
    pub engine_step_error: Difference,
    /// The part of it that no step removes: the limit minus inertial.
    pub engine_model_error: Difference,
    pub own_error: OwnErrors,
    pub numbers: Numbers,
    pub predicted: Predicted,
    pub verdict: Verdict,
    /// What the verdict is on.
    pub rim: Rim,
    /// Displacement of the load's rim that counted as agreement (m).
    pub tolerance_m: f64,
    /// Length of the way of the load's rim (m): shift plus radius times turn.
    pub path_length_m: f64,
    pub first_parting: Partings,
    pub backends: Backends,
    #[serde(skip)]
    pub solutions: [Solution; 3],
}

/// Own errors of the limits: `all` is that of both exact methods, which bounds what the differences can show; the engine's bounds its model error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OwnErrors {
    #[serde(flatten)]
    pub all: Difference,
    pub quasi_static: Difference,
    pub inertial: Difference,
    pub rapier: Difference,
}

/// Displacements of the load's rim (m), at most: shift plus radius times turn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rim {
    pub inertia_m: f64,
    pub engine_m: f64,
    pub own_m: f64,
}

/// What each backend's path took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Backends {
    pub quasi_static: Cost,
    pub inertial: Cost,
    pub rapier: Cost,
}

/// The step of the run that is shown (s), and the counts and the worst ending of all runs behind a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    pub step_s: f64,
    pub steps: StepReport,
}

fn cost(solution: &Solution) -> Cost {
    Cost { step_s: solution.step_s, steps: solution.steps }
}

/// `null` where paths stay together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Partings {
    pub by_inertia: Option<Parting>,
    pub by_engine: Option<Parting>,
}

/// Compares under the scenario's own prescribed tips. `watch` sees the share done (1) and says whether to go on; `None` when it said no.
pub fn prescribed(scenario: &Scenario, settings: &Settings, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
    compare(Tier::Prescribed, scenario, settings, || driver_of(scenario), watch)
}

/// Records a run of the scenario's ants and drives what their tips did into all backends.
pub fn replayed(scenario: &Scenario, settings: &Settings, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
    const RECORDING: f64 = 0.05;
    let mut run = Simulation::new(scenario, &settings.options(scenario, settings.recorded_from), Keep::Trace);
    run.run(|time| watch(RECORDING * time / scenario.duration));
    if !run.is_finished() {
        return None;
    }
    let (recorded, outcome) = run.into_results();
    let (recorded, n_springs) = (Arc::new(recorded), scenario.system.springs.len());
    let replayed = Scenario { duration: outcome.time, ..scenario.clone() };
    let driver = || Box::new(Replay::new(Arc::clone(&recorded), n_springs)) as Box<dyn Driver>;
    compare(Tier::Replayed, &replayed, settings, driver, |share| watch(RECORDING + (1.0 - RECORDING) * share))
}

fn compare(
    tier: Tier,
    scenario: &Scenario,
    settings: &Settings,
    driver: impl Fn() -> Box<dyn Driver> + Sync,
    watch: impl Fn(f64) -> bool + Sync,
) -> Option<Pathwise> {
    let find = |at: usize, kind| {
        let progress = |share: f64| watch((at as f64 + share) / 3.0);
        Solution::find(scenario, &settings.options(scenario, kind), &driver, progress)
    };
    let quasi_static = find(0, BackendKind::QuasiStatic)?;
    let inertial = find(1, BackendKind::Inertial)?;
    let rapier = find(2, BackendKind::Rapier)?;
    Some(judged(tier, scenario, settings, [quasi_static, inertial, rapier]))
}

fn judged(tier: Tier, scenario: &Scenario, settings: &Settings, solutions: [Solution; 3]) -> Pathwise {
    let [quasi_static, inertial, rapier] = &solutions;
    let own = [quasi_static, inertial, rapier].map(|solution| Difference::own(&solution.limit));
    let own_error = OwnErrors { all: own[0].max(&own[1]), quasi_static: own[0], inertial: own[1], rapier: own[2] };
    let inertia_effect = Difference::between(&inertial.points, &quasi_static.points);
    let engine_error = Difference::between(&rapier.points, &inertial.points);
    let radius = scenario.system.load.radius;
    let path_length_m = inertial.path_length(radius).max(quasi_static.path_length(radius));
    // A load that stays where it is has no path: a millionth of its radius stands in.
    let tolerance_m = settings.agreement * path_length_m.max(1e-6 * radius);
    let [inertia, engine, own] = [&inertia_effect, &engine_error, &own_error.all].map(|difference| difference.displacement(radius));
    let numbers = Numbers::of(scenario, &inertial.trace);
    let failed = solutions.iter().any(|solution| solution.steps.status == Status::Failed);
    let verdict = if failed { Verdict::NotComputed } else { Verdict::on_paths(inertia, engine, own, tolerance_m) };
    Pathwise {
        tier,
        inertia_effect,
        engine_error,
        engine_step_error: Difference::between(&rapier.points, &rapier.limit),
        engine_model_error: Difference::between(&rapier.limit, &inertial.limit),
        own_error,
        numbers,
        predicted: numbers.predict(scenario, &inertial.trace, tolerance_m).with_estimate(scenario, &quasi_static.trace),
        verdict,
        rim: Rim { inertia_m: inertia, engine_m: engine, own_m: own },
        backends: Backends { quasi_static: cost(quasi_static), inertial: cost(inertial), rapier: cost(rapier) },
        tolerance_m,
        path_length_m,
        first_parting: Partings {
            by_inertia: Parting::of(inertial, quasi_static, radius, tolerance_m),
            by_engine: Parting::of(rapier, inertial, radius, tolerance_m),
        },
        solutions,
    }
}
