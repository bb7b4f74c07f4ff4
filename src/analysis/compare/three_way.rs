//! The entry to a comparison: one question to three backends.

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use rayon::prelude::*;

use super::engine::EngineName;
use super::ensemble::{self, ClosedLoop};
use super::pathwise::{self, Pathwise};
use super::question::Question;
use super::seed_runs::{self, SeedRuns};
use super::settings::{MakeController, OwnMeasure, Settings, Tier};
use super::trial;
use crate::scenario::{Drive, Scenario};
use crate::simulation::{Controller, Keep, MakeBackend, Replay, Simulation, Trace, backend_of, controller_of};
use crate::stop::Stop;

/// A comparison of the quasi-static and inertial backends with rapier, or with another engine.
///
/// All methods call `watch` with the share done (1). If it answers `false`, the comparison stops
/// and returns `None`.
///
/// This example takes the inertial backend at a fixed step as the engine. An engine of your own
/// implements [`Backend`](crate::backend::Backend).
///
/// ```
/// use cohaul::backend::{Backend, BackendKind, BackendOptions};
/// use cohaul::analysis::compare::{Cause, Settings, ThreeWay};
/// use cohaul::scenario::Scenario;
/// use cohaul::simulation::backend_of;
///
/// let engine = |scenario: &Scenario, options: &BackendOptions| -> Box<dyn Backend> {
///     backend_of(scenario, &BackendOptions::new(BackendKind::Inertial, options.step_s))
/// };
/// let scenario = Scenario::read("scenarios/analytic/ramp-and-hold.json".as_ref())?;
/// let settings = Settings { step_s: Some(1e-3), ..Settings::default() };
/// let found = ThreeWay::new(&scenario, &settings).engine(&engine).prescribed(|_share| true).unwrap();
/// assert_eq!(found.causes, [Cause::Inertia]);
/// assert!(found.edge_displacement.engine_error_m < 0.01 * found.tolerance_m);
/// # Ok::<(), cohaul::scenario::ScenarioError>(())
/// ```
#[derive(Clone, Copy)]
pub struct ThreeWay<'a> {
    scenario: &'a Scenario,
    settings: &'a Settings,
    engine: (&'a EngineName, &'a MakeBackend<'a>),
    references: &'a MakeBackend<'a>,
    controller: &'a MakeController<'a>,
    own: Option<&'a OwnMeasure<'a>>,
    exact: Option<&'a Pathwise>,
}

static RAPIER: EngineName = ThreeWay::RAPIER;
static UNNAMED: EngineName = EngineName { name: Cow::Borrowed("engine"), version: None };

/// Share of the time of a replayed comparison that the recorded run takes (1).
const RECORDING: f64 = 0.05;

impl<'a> ThreeWay<'a> {
    /// Name of the engine of this library.
    pub const RAPIER: EngineName = EngineName { name: Cow::Borrowed("rapier"), version: None };

    pub fn new(scenario: &'a Scenario, settings: &'a Settings) -> Self {
        let (engine, controller) = ((&RAPIER, &backend_of as &MakeBackend), &controller_of as &MakeController);
        Self { scenario, settings, engine, references: &backend_of, controller, own: None, exact: None }
    }

    /// Replaces rapier by another engine, which is called "engine" until it is
    /// [`named`](ThreeWay::named). Each comparison of paths makes one at the step of the settings,
    /// and one at each halving of it.
    pub fn engine(self, make: &'a MakeBackend<'a>) -> Self {
        Self { engine: (&UNNAMED, make), ..self }
    }

    /// Names the engine, in all results.
    pub fn named(self, name: &'a EngineName) -> Self {
        Self { engine: (name, self.engine.1), ..self }
    }

    /// Takes the exact paths of another engine's comparison of the same scene, of the same tier, in
    /// place of new ones. They are as exact as that needed, and suggested changes are not tried.
    pub fn beside(self, other: &'a Pathwise) -> Self {
        Self { exact: Some(other), ..self }
    }

    /// Replaces what makes the quasi-static and the inertial backend, for instance by what observes
    /// them in a [`Wrapped`](crate::backend::Wrapped) backend. The options say which one to make.
    pub fn references(self, references: &'a MakeBackend<'a>) -> Self {
        Self { references, ..self }
    }

    /// Replaces the controller of the scenario by one of your own.
    pub fn controller(self, controller: &'a MakeController<'a>) -> Self {
        Self { controller, ..self }
    }

    /// Judges a measure of your own too, where paths are compared.
    pub fn measure(self, own: &'a OwnMeasure<'a>) -> Self {
        Self { own: Some(own), ..self }
    }

    fn question(&self, tier: Tier) -> Question<'a> {
        let Self { scenario, settings, engine, references, controller, own, exact } = *self;
        let exact = exact.map(|other| (&other.solutions, &other.extras));
        Question { tier, scenario, settings, engine, references, controller, own, exact }
    }

    /// Compares paths under prescribed tip motions.
    ///
    /// # Panics
    /// If the scenario has ants: they would decide differently on each path.
    pub fn prescribed(&self, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
        assert!(matches!(self.scenario.drive, Drive::Tips(_)), "a scenario with ants has no prescribed tips");
        trial::compare(&self.question(Tier::Prescribed), watch)
    }

    /// Records a run of a backend of this library, replays its grasps, releases and tip motions on
    /// all backends, and compares paths.
    pub fn replayed(&self, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
        self.on_record(&watch, |question, watch| trial::compare(question, watch))
    }

    /// Compares the quasi-static with the inertial path alone, under prescribed or recorded tip
    /// motions. The inertial path stands for that of an engine too, whose error is zero.
    pub fn without_engine(&self, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
        match self.scenario.drive {
            Drive::Tips(_) => pathwise::compare_without_engine(&self.question(Tier::Prescribed), watch),
            Drive::Ants(_) => self.on_record(&watch, |question, watch| pathwise::compare_without_engine(question, watch)),
        }
    }

    /// Compares paths under the recorded motions of one run.
    fn on_record(
        &self,
        watch: &(dyn Fn(f64) -> bool + Sync),
        compare: impl Fn(&Question, &(dyn Fn(f64) -> bool + Sync)) -> Option<Pathwise>,
    ) -> Option<Pathwise> {
        let Self { scenario, settings, controller, .. } = *self;
        let options = settings.at_fixed_step(scenario, settings.recorded_from);
        let mut run = Simulation::from_parts(scenario, &options, Keep::Trace, controller(scenario), backend_of(scenario, &options));
        run.run(|time| watch(RECORDING * time / scenario.duration));
        if !run.is_finished() {
            return None;
        }
        let (recorded, outcome) = run.into_results();
        let (recorded, n_springs) = (Arc::new(recorded), scenario.system.springs.len());
        let replayed = Scenario { duration: outcome.time, ..scenario.clone() };
        let replay = |_: &Scenario| Box::new(Replay::new(Arc::clone(&recorded), n_springs)) as Box<dyn Controller>;
        let question = Question { scenario: &replayed, controller: &replay, ..self.question(Tier::Replayed) };
        compare(&question, &|share| watch(RECORDING + (1.0 - RECORDING) * share))
    }

    /// Compares paths under a controller that follows the load: each run has a controller of its
    /// own, and answers to it. The reference error contains what an error of the path makes of the
    /// commands.
    ///
    /// A run that ends early, since its load has arrived, ends the comparison of all.
    pub fn controlled(&self, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
        trial::compare(&self.question(Tier::Controlled), watch)
    }

    /// Runs `n_seeds` consecutive seeds from the scenario's seed on all backends, and compares
    /// distributions.
    ///
    /// # Panics
    /// Without a seed.
    pub fn closed_loop(&self, n_seeds: usize, watch: impl Fn(f64) -> bool + Sync) -> Option<ClosedLoop> {
        assert!(n_seeds > 0, "a comparison over seeds needs at least one");
        let (n_done, stop) = (AtomicUsize::new(0), Stop::current());
        let runs: Option<Vec<(SeedRuns, Option<[Trace; 3]>)>> = (0..n_seeds)
            .into_par_iter()
            .map(|at| {
                let watch = |share: f64| watch((n_done.load(Relaxed) as f64 + share) / n_seeds as f64);
                let (runs, traces) = stop.within(|| self.seed_runs(at, watch))?;
                n_done.fetch_add(1, Relaxed);
                // Figures show the first seed only.
                Some((runs, (at == 0).then_some(traces)))
            })
            .collect();
        let (seeds, traces): (Vec<_>, Vec<_>) = runs?.into_iter().unzip();
        let first = traces.into_iter().next().flatten().expect("there is a first seed");
        Some(self.judged(&seeds, first))
    }

    /// Runs the seed `at` places after the scenario's on all backends. Returns what
    /// [`ThreeWay::judged`] needs of it, and the traces of the three runs.
    pub fn seed_runs(&self, at: usize, watch: impl Fn(f64) -> bool) -> Option<(SeedRuns, [Trace; 3])> {
        seed_runs::seed_runs(&self.question(Tier::ClosedLoop), at, watch)
    }

    /// Compares distributions over consecutive seeds, all of which have run. The traces are those
    /// of the first seed.
    ///
    /// # Panics
    /// Without a seed.
    pub fn judged(&self, seeds: &[SeedRuns], first: [Trace; 3]) -> ClosedLoop {
        assert!(!seeds.is_empty(), "a comparison over seeds needs at least one");
        ensemble::judge(self.scenario, self.engine.0, seeds, first)
    }
}
