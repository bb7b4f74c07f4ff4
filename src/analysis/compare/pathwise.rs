//! The prescribed and the replayed tier: three backends, one question, paths compared point by point.

use std::sync::Arc;

use serde::Serialize;

use super::difference::Jumps;
use super::parting::Pair;
use super::remedy::Apart;
use super::{Difference, InertiaFrom, Numbers, Parting, Predicted, Remedy, Settings, Solution, Tier, Verdict, numbers};
use crate::backend::{BackendKind, BackendOptions, Status, StepReport};
use crate::scenario::{Drive, Scenario};
use crate::simulation::{Driver, Keep, Make, Replay, Simulation, built, driver_of};

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
    /// All that parts the paths beyond the tolerance, own errors counted against it; the larger one names the verdict.
    pub causes: Vec<Cause>,
    /// What would bring the paths together.
    pub remedies: Vec<Remedy>,
    /// What the verdict is on.
    pub rim: Rim,
    /// Displacement of the load's rim that counted as agreement (m).
    pub tolerance_m: f64,
    /// Length that displacements are told as shares of (m): of the way of the load's rim without inertia, shift plus radius times turn, or how far the load with
    /// inertia gets from where it started, whichever is longer. That one's way is no measure: the longer it rings, the longer that is.
    pub path_length_m: f64,
    /// Longest time between two instants at which the paths are compared (s).
    pub between_instants_s: f64,
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

/// Displacements of the load's rim (m), at most: shift plus radius times turn at one instant. Those between paths are known up to the own error, which the ranges take
/// in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rim {
    pub inertia_m: f64,
    pub inertia_range_m: [f64; 2],
    /// What that is from.
    pub inertia_from: InertiaFrom,
    pub engine_m: f64,
    pub engine_range_m: [f64; 2],
    pub own_m: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    Inertia,
    Engine,
}

impl Rim {
    fn new(inertia_m: f64, inertia_from: InertiaFrom, engine_m: f64, own_m: f64) -> Self {
        let range = |value: f64| [(value - own_m).max(0.0), value + own_m];
        Self { inertia_m, inertia_range_m: range(inertia_m), inertia_from, engine_m, engine_range_m: range(engine_m), own_m }
    }

    fn causes(&self, tolerance: f64) -> Vec<Cause> {
        let parts = [(Cause::Inertia, self.inertia_range_m), (Cause::Engine, self.engine_range_m)];
        parts.into_iter().filter(|(_, [least, _])| *least > tolerance).map(|(cause, _)| cause).collect()
    }
}

/// What each backend's path took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Backends {
    pub quasi_static: Cost,
    pub inertial: Cost,
    pub rapier: Cost,
}

/// The step of the run that is shown (s; left out under error control), and the counts and the worst ending of all runs behind a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_s: Option<f64>,
    pub steps: StepReport,
}

fn cost(solution: &Solution) -> Cost {
    Cost { step_s: solution.step_s, steps: solution.steps }
}

impl Backends {
    /// Whether own errors say how wrong the exact paths may be: strides that did not converge are wrong by nobody knows how much.
    pub fn are_known(&self) -> bool {
        [self.quasi_static, self.inertial].iter().all(|cost| cost.steps.status == Status::Converged)
    }
}

/// `null` where paths stay together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Partings {
    pub by_inertia: Option<Parting>,
    pub by_engine: Option<Parting>,
}

/// Compares under the scenario's own prescribed tips. `watch` sees the share done (1) and says whether to go on; `None` when it said no.
///
/// # Panics
/// When the scenario has ants: they would decide otherwise on each path.
pub fn prescribed(scenario: &Scenario, settings: &Settings, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
    prescribed_with(scenario, settings, &built, watch)
}

/// The same with an engine of the caller's in rapier's place. `engine` makes it, and is asked for three: at the step that `settings` give, and at halves of it
/// twice. It is told as rapier is: `engine_error`, [`Cause::Engine`], the last of [`Pathwise::solutions`].
///
/// What is put in place here is the reference itself at a fixed step. An engine of one's own implements [`Backend`](crate::backend::Backend).
///
/// ```
/// use cohaul::backend::{Backend, BackendKind, BackendOptions};
/// use cohaul::analysis::compare::{Cause, Settings, prescribed_with};
/// use cohaul::scenario::Scenario;
/// use cohaul::simulation::built;
///
/// let engine = |scenario: &Scenario, options: &BackendOptions| -> Box<dyn Backend> {
///     built(scenario, &BackendOptions::new(BackendKind::Inertial, options.step_s))
/// };
/// let scenario = Scenario::read("scenarios/analytic/ramp-and-hold.json".as_ref())?;
/// let settings = Settings { step_s: Some(1e-3), ..Settings::default() };
/// let found = prescribed_with(&scenario, &settings, &engine, |_share| true).expect("nobody says to stop");
/// assert_eq!(found.causes, [Cause::Inertia]);
/// assert!(found.rim.engine_m < 0.01 * found.tolerance_m);
/// # Ok::<(), cohaul::scenario::ScenarioError>(())
/// ```
///
/// # Panics
/// As [`prescribed`].
pub fn prescribed_with(scenario: &Scenario, settings: &Settings, engine: &Make, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
    assert!(matches!(scenario.drive, Drive::Tips(_)), "a scenario with ants has no prescribed tips");
    compare(Tier::Prescribed, scenario, settings, engine, || driver_of(scenario), watch)
}

/// Records a run of the scenario's ants and drives what their tips did into all backends.
pub fn replayed(scenario: &Scenario, settings: &Settings, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
    replayed_with(scenario, settings, &built, watch)
}

/// The same with an engine of the caller's in rapier's place, as in [`prescribed_with`]; what is recorded and replayed is a run of a backend of the library.
pub fn replayed_with(scenario: &Scenario, settings: &Settings, engine: &Make, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
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
    compare(Tier::Replayed, &replayed, settings, engine, driver, |share| watch(RECORDING + (1.0 - RECORDING) * share))
}

fn compare(
    tier: Tier,
    scenario: &Scenario,
    settings: &Settings,
    engine: &Make,
    driver: impl Fn() -> Box<dyn Driver> + Sync,
    watch: impl Fn(f64) -> bool + Sync,
) -> Option<Pathwise> {
    let part = |at: f64| move |share: f64| (at + share) / 3.0;
    let find = |at, options: &BackendOptions, make: &Make| {
        Solution::find(scenario, options, settings.parts_of_period(scenario), make, &driver, |share| watch(part(at)(share)))
    };
    let rapier = find(0.0, &settings.options(scenario, BackendKind::Rapier), engine)?;
    let exact = |settings: &Settings| {
        let find = |at, kind| find(at, &settings.within(scenario, kind), &built);
        let (quasi_static, inertial) = rayon::join(|| find(1.0, BackendKind::QuasiStatic), || find(2.0, BackendKind::Inertial));
        Some([quasi_static?, inertial?])
    };
    let [quasi_static, inertial] = exact(settings)?;
    let found = judged(tier, scenario, settings, [quasi_static, inertial, rapier]);
    if settings.tolerance_m.is_some() || found.rim.own_m <= LARGEST_OWN_ERROR * found.tolerance_m {
        return Some(found);
    }
    // Now it is known what the paths have to be good for.
    let finer = Settings { tolerance_m: Some(0.5 * LARGEST_OWN_ERROR * found.tolerance_m), ..*settings };
    let [quasi_static, inertial] = exact(&finer)?;
    let [_, _, rapier] = found.solutions;
    Some(judged(tier, scenario, settings, [quasi_static, inertial, rapier]))
}

/// Own error over what counts as agreement (1) from which on the exact paths are found anew, unless their tolerance was asked for.
const LARGEST_OWN_ERROR: f64 = 0.05;

fn judged(tier: Tier, scenario: &Scenario, settings: &Settings, solutions: [Solution; 3]) -> Pathwise {
    let [quasi_static, inertial, rapier] = &solutions;
    let radius = scenario.system.load.radius;
    let own = [quasi_static, inertial, rapier].map(|solution| Difference::own(&solution.limit, radius));
    let own_error = OwnErrors { all: own[0].max(&own[1]), quasi_static: own[0], inertial: own[1], rapier: own[2] };
    let jumps = Jumps::of(&quasi_static.trace, scenario.control_period);
    let inertia_effect = Difference::but_in_jumps(&inertial.points, &quasi_static.points, radius, &jumps);
    let engine_error = Difference::between(&rapier.points, &inertial.points, radius);
    let way_without_inertia = quasi_static.path_length(radius);
    let path_length_m = way_without_inertia.max(inertial.reach(radius));
    // A load that stays where it is has no path: a millionth of its radius stands in.
    let agreement = |way: f64| settings.agreement * way.max(1e-6 * radius);
    let tolerance_m = agreement(path_length_m);
    let engine_step_error = Difference::between(&rapier.points, &rapier.limit, radius);
    let engine_model_error = Difference::between(&rapier.limit, &inertial.limit, radius);
    let pair = |paths, jumps| Pair::new(paths, scenario, tolerance_m, jumps);
    let no_jumps = Jumps::default();
    let (by_inertia, by_engine) = (pair([inertial, quasi_static], &jumps), pair([rapier, inertial], &no_jumps));
    let first_parting = Partings { by_inertia: by_inertia.first_parting(), by_engine: by_engine.first_parting() };
    let [inertia, engine, own] = [&inertia_effect, &engine_error, &own_error.all].map(|difference| difference.rim_max_m);
    let rim = Rim::new(inertia, by_inertia.inertia_from(), engine, own);
    let apart = Apart {
        engine,
        engine_model: (engine_model_error.rim_max_m - own_error.rapier.rim_max_m - own).max(0.0),
        tolerance: tolerance_m,
        tolerance_without_inertia: agreement(way_without_inertia),
    };
    let numbers = Numbers::of(scenario, &inertial.trace);
    let failed = solutions.iter().any(|solution| solution.steps.status == Status::Failed);
    let backends = Backends { quasi_static: cost(quasi_static), inertial: cost(inertial), rapier: cost(rapier) };
    let is_known = backends.are_known();
    let verdict = match (failed, is_known) {
        (true, _) => Verdict::NotComputed,
        (_, false) => Verdict::BelowOwnError,
        _ => Verdict::on_paths(inertia, engine, own, tolerance_m),
    };
    let causes = if is_known { rim.causes(tolerance_m) } else { Vec::new() };
    let predicted = numbers.predict(scenario, inertial, by_inertia.n_sudden(), tolerance_m).with_estimate(scenario, &quasi_static.trace);
    let remedies = match verdict {
        Verdict::BelowOwnError if is_known => vec![Remedy::TighterTolerance { tolerance_m: LARGEST_OWN_ERROR * tolerance_m }],
        _ => {
            let tick_angle = scenario.control_period * numbers::natural_rate(scenario);
            let against = |cause: &Cause| match cause {
                Cause::Inertia => apart.against_inertia(&rim.inertia_from, &numbers, &predicted, tick_angle),
                Cause::Engine => vec![apart.against_engine(rapier.step_s.unwrap_or_default())],
            };
            causes.iter().flat_map(against).collect()
        }
    };
    Pathwise {
        tier,
        inertia_effect,
        engine_error,
        engine_step_error,
        engine_model_error,
        own_error,
        numbers,
        predicted,
        verdict,
        causes,
        remedies,
        rim,
        backends,
        tolerance_m,
        path_length_m,
        between_instants_s: scenario.control_period / settings.parts_of_period(scenario) as f64,
        first_parting,
        solutions,
    }
}
