//! Comparison of paths: the prescribed and the replayed tier.

use serde::{Serialize, Serializer};

use super::attributed::Attributed;
use super::damping::{DampingEffect, is_damped};
use super::difference::{Difference, Jumps};
use super::divergence::{Divergence, PathPair};
use super::doubt::{self, Doubt, DoubtKind};
use super::engine::EngineName;
use super::jump_mode::JumpMode;
use super::numbers::{Numbers, Predicted};
use super::quantity::{FirstDivergence, Verdicts};
use super::question::Question;
use super::same_stop::same_stop;
use super::settings::{LEAST_MOTION, Settings, Tier};
use super::solution::Solution;
use super::suggestion::{Differences, Driver, SuggestedChange, Tried};
use super::verdict::{Cause, InertiaAnswer, Verdict};
use super::verdicts::{Extras, Runs};
use crate::analysis::trigger::ByTrigger;
use crate::backend::{BackendKind, BackendOptions, Status, Tolerance, TransitionKind};
use crate::scenario::Scenario;
use crate::simulation::MakeBackend;
use crate::stop::Stop;

/// Result of a comparison of paths.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pathwise {
    pub tier: Tier,
    pub engine: EngineName,
    /// Inertial minus quasi-static.
    pub inertia_effect: Difference,
    /// Engine, at the step asked for, minus inertial.
    pub engine_error: Difference,
    /// Quasi-static minus its rate-independent form; left out without damped springs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_effect: Option<DampingEffect>,
    /// Part of the engine error that vanishes with the step: engine minus its own limit.
    pub time_step_error: Difference,
    /// Measured power of the step with which that part falls; `null` where it is less than a
    /// thousandth of the tolerance, or does not fall.
    pub time_step_order: Option<f64>,
    /// Part of the engine error that does not vanish: the limit of the engine minus inertial.
    pub model_error: Difference,
    pub reference_error: ReferenceError,
    pub numbers: Numbers,
    pub predicted: Predicted,
    /// Verdict on the path.
    pub verdict: Verdict,
    pub verdicts: Verdicts,
    /// Reasons to doubt the exact runs, in the order of time; left out if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<Doubt>,
    /// Largest net pull at a control tick, with inertia or without, over the sum of all slip limits
    /// (1); `null` without friction. Below 1 a pull through the centre moves nothing.
    pub largest_pull_over_slip_limit: Option<f64>,
    /// Causes of what exceeds the tolerance of the path: those of its verdict.
    pub causes: Vec<Cause>,
    /// Changes that make the differences smaller than the tolerance, all of them together.
    pub suggested_changes: Vec<SuggestedChange>,
    /// What is left of the inertia effect after all of them; left out if they were not tried.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tried: Option<Tried>,
    /// Largest edge displacements, on which the verdict is based.
    pub edge_displacement: EdgeDisplacement,
    /// Largest edge displacement that counts as agreement (m).
    pub tolerance_m: f64,
    /// Length scale of the tolerance (m): the quasi-static path length, or the largest edge
    /// displacement from the start with inertia if that is longer. The path length with inertia is
    /// not used, because it grows as long as the load oscillates.
    pub path_length_m: f64,
    /// Longest time between two instants at which the paths are compared (s).
    pub sampled_every_s: f64,
    pub first_divergence: FirstDivergence,
    /// Paths of the quasi-static and inertial backends, and of the engine.
    #[serde(rename = "backends", serialize_with = "by_backend")]
    pub solutions: [Solution; 3],
    #[serde(skip)]
    pub(super) extras: Extras,
}

/// Time-step error over the tolerance of the path below which it has no order (1).
const LEAST_TIME_STEP: f64 = 1e-3;

/// Numerical errors of the paths. The flattened fields bound the error of the quasi-static and
/// inertial paths, and with it what a difference can show.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReferenceError {
    #[serde(flatten)]
    pub all: Difference,
    pub quasi_static: Difference,
    pub inertial: Difference,
    /// Error of the engine's limit, which bounds the error of the model error.
    pub engine: Difference,
}

/// Largest edge displacements between the paths. The ranges extend by the reference error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EdgeDisplacement {
    /// (m)
    pub inertia_effect_m: f64,
    /// (m)
    pub inertia_effect_range_m: [f64; 2],
    pub by_trigger: ByTrigger,
    /// (m)
    pub engine_error_m: f64,
    /// (m)
    pub engine_error_range_m: [f64; 2],
    /// (m)
    pub reference_error_m: f64,
}

/// Largest reference error, divided by the tolerance (1), unless its own tolerance was given.
const LARGEST_REFERENCE_ERROR: f64 = 0.05;
/// Factor by which the reference error of the path is reduced if it leaves a verdict open (1).
const SHARPER: f64 = 30.0;

/// Factor between the tolerances of two runs whose distance shows what an error of the path makes
/// of the commands of a controller that follows the load (1).
const COARSER: f64 = 4.0;

impl ReferenceError {
    fn of(solutions: &[Solution; 3], radius: f64) -> Self {
        let [quasi_static, inertial, engine] = solutions.each_ref().map(|solution| Difference::error_of(&solution.limit, radius));
        Self { all: quasi_static.max(&inertial), quasi_static, inertial, engine }
    }
}

impl EdgeDisplacement {
    fn new(inertia_effect_m: f64, by_trigger: ByTrigger, engine_error_m: f64, reference_error_m: f64) -> Self {
        let range = |value: f64| [(value - reference_error_m).max(0.0), value + reference_error_m];
        Self {
            inertia_effect_m,
            inertia_effect_range_m: range(inertia_effect_m),
            by_trigger,
            engine_error_m,
            engine_error_range_m: range(engine_error_m),
            reference_error_m,
        }
    }
}

impl Pathwise {
    /// The runs with their names.
    pub fn named_runs(&self) -> impl Iterator<Item = (&str, &Solution)> {
        self.engine.after_exact().into_iter().zip(&self.solutions)
    }

    /// Whether the reference error is known: all macro-steps of both reference runs converged.
    pub fn references_converged(&self) -> bool {
        self.solutions[..2].iter().all(|solution| solution.steps.status == Status::Converged)
    }

    /// Whether the load with inertia hits an obstacle from which it rebounds.
    fn has_rebounds(&self, scenario: &Scenario) -> bool {
        let rebounds = |obstacle: usize| scenario.system.world.obstacles.get(obstacle).is_some_and(|it| it.restitution > 0.0);
        let is_rebound = |kind: &TransitionKind| matches!(kind, TransitionKind::Impact { obstacle, .. } if rebounds(*obstacle));
        self.solutions[1].trace.transitions.iter().any(|transition| is_rebound(&transition.kind))
    }

    /// Makes no claim where the runs do not allow one.
    fn withdraw(&mut self) {
        if self.solutions.iter().any(|solution| solution.steps.status == Status::Failed) {
            self.verdicts.withdraw();
        } else if let Some(first) = self.doubts.first() {
            let is_not_unique = self.doubts.iter().any(|doubt| doubt.kind == DoubtKind::NotUnique);
            self.verdicts.doubt(first.time_s, is_not_unique);
        }
        self.verdict = self.verdicts.path.verdict;
        self.causes.clone_from(&self.verdicts.path.causes);
    }

    /// Changes against the causes, which leave this part, `aim`, of what the first ones leave (1).
    pub(super) fn suggestions(&self, scenario: &Scenario, settings: &Settings, aim: f64) -> Vec<SuggestedChange> {
        let (largest, tolerance) = (&self.edge_displacement, self.tolerance_m);
        if self.verdict == Verdict::Inconclusive && self.doubts.is_empty() {
            return vec![SuggestedChange::TighterTolerance { tolerance_m: LARGEST_REFERENCE_ERROR * tolerance }];
        }
        let [model, model_uncertainty] = [&self.model_error, &self.reference_error.engine].map(|error| error.edge_displacement_max_m);
        let model = (model - model_uncertainty - largest.reference_error_m).max(0.0);
        let radius = scenario.system.load.radius;
        // That of the quasi-static path length alone applies after the changes.
        let tolerance_without_inertia = aim * settings.tolerance_path(self.solutions[0].path_length(radius), radius);
        let (driver, has_springs) = (Driver::of(scenario), !scenario.system.springs.is_empty());
        let differences = Differences { engine: largest.engine_error_m, model, tolerance, tolerance_without_inertia, driver, has_springs };
        let mode = JumpMode::of(scenario, &self.solutions[0]);
        // Nothing brings a load to a tolerance of no motion.
        let moves_without_inertia = self.solutions[0].path_length(radius) > LEAST_MOTION * radius;
        let by_inertia = self.causes.contains(&Cause::Inertia) && moves_without_inertia;
        let mut changes = if by_inertia { differences.against_inertia(&largest.by_trigger, &self.predicted, &mode) } else { Vec::new() };
        if self.causes.iter().any(|cause| cause.is_of_engine()) {
            changes.extend(match (self.causes.contains(&Cause::Engine), self.time_step_order) {
                (true, Some(_)) => Some(SuggestedChange::MoreHalvings { halvings: settings.halvings + 2 }),
                // An engine that does not converge has no limit to be found.
                (true, None) => None,
                (false, order) => Some(differences.against_engine(self.solutions[2].step_s.unwrap_or_default(), order)),
            });
        }
        changes
    }
}

/// Tolerance of reference runs (m) with which a verdict on this tolerance (m) is possible.
pub(super) fn needed_reference_error(tolerance_m: f64) -> f64 {
    0.5 * LARGEST_REFERENCE_ERROR * tolerance_m
}

/// The step and the counts of each path.
fn by_backend<S: Serializer>(solutions: &[Solution; 3], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(["quasi_static", "inertial", "engine"].into_iter().zip(solutions))
}

pub(super) fn compare(question: &Question, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
    let options = question.settings.at_fixed_step(question.scenario, BackendKind::Rapier);
    let engine = question.solution(&options, question.engine.1, |share| watch(share / 3.0))?;
    if let Some(([quasi_static, inertial, _], extras)) = question.exact {
        return Some(judge(question, [quasi_static.clone(), inertial.clone(), engine], extras.clone()));
    }
    let found = compare_models(question, Some(engine), &watch)?;
    let extras = extras(question, &found, &watch)?;
    if extras.without_restitution.is_none() && extras.rate_independent.is_none() {
        return Some(found);
    }
    Some(judge(question, found.solutions, extras))
}

/// The runs that tell parts of the inertia effect, each to the error that the verdict needs. A
/// failed run tells nothing. `None` if `watch` says no.
fn extras(question: &Question, found: &Pathwise, watch: &(impl Fn(f64) -> bool + Sync)) -> Option<Extras> {
    let Question { scenario, settings, references, .. } = *question;
    let reference_tolerance_m = settings.reference_tolerance_m.or(Some(LARGEST_REFERENCE_ERROR * found.tolerance_m));
    let settings = Settings { reference_tolerance_m, ..*settings };
    let run = |question: &Question, settings: &Settings, kind| {
        let options = settings.under_error_control(question.scenario, kind);
        let mut solution = question.solution(&options, references, |_| watch(1.0))?;
        solution.shorten_to(found.solutions[0].points.len());
        Some(Some(solution).filter(|solution| solution.steps.status != Status::Failed))
    };
    let mut extras = Extras::default();
    if is_damped(scenario) && !settings.rate_independent {
        let settings = Settings { rate_independent: true, ..settings };
        extras.rate_independent = run(question, &settings, BackendKind::QuasiStatic)?;
    }
    if found.has_rebounds(scenario) && found.verdicts.named().iter().any(|(_, of)| of.inertia == InertiaAnswer::NotNegligible) {
        let mut scenario = scenario.clone();
        scenario.system.world.obstacles.iter_mut().for_each(|obstacle| obstacle.restitution = 0.0);
        extras.without_restitution = run(&Question { scenario: &scenario, ..*question }, &settings, BackendKind::Inertial)?;
    }
    Some(extras)
}

/// Compares the quasi-static with the inertial path. The latter stands for that of an engine too,
/// whose error is zero.
pub(super) fn compare_without_engine(question: &Question, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
    compare_models(question, None, &watch)
}

fn compare_models(question: &Question, engine: Option<Solution>, watch: &(impl Fn(f64) -> bool + Sync)) -> Option<Pathwise> {
    let Question { tier, scenario, settings, references: make, .. } = *question;
    let find = |at: f64, options: &BackendOptions, make: &MakeBackend| question.solution(options, make, |share| watch((at + share) / 3.0));
    let reference = |at, kind, settings: &Settings| {
        let options = settings.under_error_control(scenario, kind);
        let mut found = find(at, &options, make)?;
        if tier == Tier::Controlled {
            let coarser = options.tolerance.map(|it| Tolerance::at_edge(COARSER * it.position_m, &scenario.system.load));
            found.add_distance_from(&find(at, &BackendOptions { tolerance: coarser, ..options }, make)?);
        }
        Some(found)
    };
    let has_engine = engine.is_some();
    let judged = |settings: &Settings, engine: Option<Solution>| {
        let stop = Stop::current();
        let find = |at, kind| stop.within(|| reference(at, kind, settings));
        let (quasi_static, inertial) = rayon::join(|| find(1.0, BackendKind::QuasiStatic), || find(2.0, BackendKind::Inertial));
        let (quasi_static, inertial) = (quasi_static?, inertial?);
        let engine = engine.unwrap_or_else(|| inertial.clone());
        Some(judge(question, [quasi_static, inertial, engine], Extras::default()))
    };
    let found = judged(settings, engine)?;
    if settings.reference_tolerance_m.is_some() {
        return Some(found);
    }
    let again = |found: Pathwise, tolerance_m: f64| {
        let [_, _, engine] = found.solutions;
        judged(&Settings { reference_tolerance_m: Some(tolerance_m), ..*settings }, has_engine.then_some(engine))
    };
    // The tolerance of the verdict is known only now.
    let needed = LARGEST_REFERENCE_ERROR * found.tolerance_m;
    let found_tolerance = found.tolerance_m;
    let found =
        if found.edge_displacement.reference_error_m <= needed { found } else { again(found, needed_reference_error(found_tolerance))? };
    // A difference may be close to its tolerance, and another quantity may need a smaller error
    // than the path.
    let error = found.edge_displacement.reference_error_m;
    if !found.verdicts.are_open() || !found.doubts.is_empty() || error == 0.0 {
        return Some(found);
    }
    let sharper = again(found.clone(), error / SHARPER)?;
    Some(if sharper.references_converged() { sharper } else { found })
}

fn judge(question: &Question, mut solutions: [Solution; 3], extras: Extras) -> Pathwise {
    let Question { tier, scenario, settings, .. } = *question;
    let n_instants = solutions.iter().map(|solution| solution.points.len()).min().unwrap_or_default();
    solutions.iter_mut().for_each(|solution| solution.shorten_to(n_instants));
    let ([quasi_static, inertial, engine_run], radius) = (&solutions, scenario.system.load.radius);
    let reference_error = ReferenceError::of(&solutions, radius);
    let (jumps, none) = (Jumps::of(&quasi_static.trace, scenario.control_period), Jumps::default());
    let inertia_effect = Difference::outside_jumps(&inertial.points, &quasi_static.points, radius, &jumps);
    let of_engine = |path| Difference::between(&engine_run.points, path, radius);
    let (engine_error, time_step_error) = (of_engine(&inertial.points), of_engine(&engine_run.limit));
    let path_length_m = quasi_static.path_length(radius).max(inertial.reach(radius));
    let tolerance_m = settings.tolerance_path(path_length_m, radius);
    let attributed = Attributed::new(&scenario.system, [inertial, quasi_static], &jumps, settings.rate_independent);
    let pair = |paths, jumps, attributed| PathPair::new(paths, scenario, tolerance_m, jumps, attributed);
    let (by_inertia, by_engine) = (pair([inertial, quasi_static], &jumps, Some(&attributed)), pair([engine_run, inertial], &none, None));
    let [inertia, engine, reference] = [&inertia_effect, &engine_error, &reference_error.all].map(|it| it.edge_displacement_max_m);
    let edge_displacement = EdgeDisplacement::new(inertia, attributed.by_trigger, engine, reference);
    let runs = Runs {
        scenario,
        settings,
        own: question.own,
        solutions: &solutions,
        extras: &extras,
        jumps: &jumps,
        pairs: [&by_inertia, &by_engine],
        poses: [&inertia_effect, &engine_error, &reference_error.all],
    };
    let (verdicts, largest_pull_over_slip_limit) = (runs.verdicts(tolerance_m), runs.largest_pull_share());
    let numbers = Numbers::of(scenario, &inertial.trace);
    let mut found = Pathwise {
        tier,
        engine: question.engine.0.clone(),
        inertia_effect,
        engine_error,
        damping_effect: extras.rate_independent.as_ref().map(|without| DampingEffect::between(scenario, quasi_static, without)),
        time_step_error,
        time_step_order: engine_run.convergence.order.filter(|_| time_step_error.edge_displacement_max_m > LEAST_TIME_STEP * tolerance_m),
        model_error: Difference::between(&engine_run.limit, &inertial.limit, radius),
        reference_error,
        predicted: numbers.predicted(scenario, [quasi_static, inertial].map(|run| &run.trace), tolerance_m, settings.rate_independent),
        numbers,
        verdict: verdicts.path.verdict,
        largest_pull_over_slip_limit,
        doubts: doubts(scenario, &solutions, &verdicts),
        causes: Vec::new(),
        suggested_changes: Vec::new(),
        tried: None,
        edge_displacement,
        tolerance_m,
        path_length_m,
        sampled_every_s: scenario.control_period / settings.parts_of_period(tier, scenario) as f64,
        first_divergence: verdicts.path.first_divergence,
        verdicts,
        solutions,
        extras,
    };
    found.withdraw();
    found.suggested_changes = found.suggestions(scenario, settings, 1.0);
    found
}

/// Reasons to doubt the exact runs, in the order of time.
fn doubts(scenario: &Scenario, solutions: &[Solution; 3], verdicts: &Verdicts) -> Vec<Doubt> {
    let mut doubts = doubt::of_references(&solutions[..2], scenario);
    let diverges = |first: FirstDivergence| first.engine_error.map(|Divergence { time_s, .. }| time_s);
    let times = [verdicts.path.first_divergence, verdicts.heading.first_divergence].into_iter().filter_map(diverges);
    doubts.extend(times.reduce(f64::min).and_then(|time| same_stop(scenario, solutions, time)));
    doubt::in_order(doubts)
}
