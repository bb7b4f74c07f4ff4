//! The comparison of the scene, beside the runs.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, Weak};
use std::thread;
use std::time::{Duration, Instant};

use super::message::{Estimated, Judged, Tell};
use super::scene::LiveScene;
use cohaul::analysis::ExpectedCost;
use cohaul::analysis::compare::{Settings, ThreeWay};
use cohaul::analysis::estimate::with_estimate;
use cohaul::backend::BackendKind;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::run_facts::Run;
use cohaul::simulation::{Keep, Simulation, controller_of};
use cohaul::stop::Stop;
use cohaul_report::page::Answer;
use cohaul_report::quantity::short_quantity;
use cohaul_studies::compare::answer::verdict_text;
use cohaul_studies::compare::comparison::{Comparison, Tiers};
use cohaul_studies::run::answer::{inertia_sentence, is_negligible};

/// A slider that moves asks many times; only a scene that has stood for this long is compared.
const PATIENCE: Duration = Duration::from_millis(250);
/// Time that a comparison is expected to take at most (s). Others are left to `cohaul compare`.
const LONGEST: f64 = 120.0;
/// Time between two reports of how far a comparison is.
const REPORT: Duration = Duration::from_millis(200);

/// Compares the last scene it was asked for. At its end the comparison stops.
pub struct Judge {
    stale: Stop,
    /// One comparison at a time in the whole process.
    turn: Arc<Mutex<()>>,
}

impl Judge {
    pub fn new(turn: Arc<Mutex<()>>) -> Self {
        Self { stale: Stop::default(), turn }
    }

    /// Forgets the scene before, estimates the inertia effect on this one and compares it; `tell`
    /// hears of it.
    pub fn ask(&mut self, scene: &LiveScene, tell: impl Fn(Tell) + Clone + Send + 'static) {
        self.stale.ask();
        self.stale = Stop::default();
        let (stale, turn) = (self.stale.clone(), Arc::clone(&self.turn));
        let (scene, settings) = (scene.clone(), settings(scene));
        thread::spawn(move || {
            let is_wanted = || !stale.is_asked();
            thread::sleep(PATIENCE);
            if !is_wanted() {
                return;
            }
            match stale.run(|| estimated(&scene, is_wanted)).flatten() {
                Some(estimate) => tell(Tell::Estimate(estimate)),
                None => return,
            }
            tell(Tell::Comparing { share: 0.0 });
            // A comparison before this one that panicked leaves nothing half done here.
            let of_process = turn.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            let share = Arc::new(AtomicU64::new(0));
            report(Arc::downgrade(&share), tell.clone());
            let watch = |done: f64| {
                share.fetch_max(done.to_bits(), Ordering::Relaxed);
                is_wanted()
            };
            let judged = stale.run(|| judged(&scene.scenario, &settings, watch)).flatten();
            drop(of_process);
            drop(share);
            if let Some(judged) = judged {
                tell(Tell::Verdict(judged));
            }
        });
    }
}

impl Drop for Judge {
    fn drop(&mut self) {
        self.stale.ask();
    }
}

/// Tells how far a comparison is, as long as there is one. A page that does not listen delays this
/// thread alone.
fn report(share: Weak<AtomicU64>, tell: impl Fn(Tell) + Send + 'static) {
    thread::spawn(move || {
        while let Some(done) = share.upgrade().map(|share| f64::from_bits(share.load(Ordering::Relaxed))) {
            tell(Tell::Comparing { share: done });
            thread::sleep(REPORT);
        }
    });
}

/// The inertia estimate of the whole scene, from a quasi-static run alone; `None` when it is no
/// longer wanted.
fn estimated(scene: &LiveScene, is_wanted: impl Fn() -> bool) -> Option<Estimated> {
    let scenario = &scene.scenario;
    let options = scene.settings.options(BackendKind::QuasiStatic, scenario);
    let (backend, estimator) = with_estimate(&scenario.system, scenario.start, &options);
    let mut run = Simulation::from_parts(scenario, &options, Keep::Outcome, controller_of(scenario), backend);
    run.run(|_| is_wanted());
    if !is_wanted() {
        return None;
    }
    let (estimate, outcome) = (estimator.borrow().estimate(), run.outcome());
    let run = Run { scenario, options: &options, outcome: &outcome, path_length: None, wall_time: None };
    let negligible = match is_negligible(&run, Some(&estimate)) {
        Answer::Yes => "yes",
        Answer::No => "no",
        Answer::Partly | Answer::Open | Answer::None => "open",
    };
    Some(Estimated { negligible, sentence: inertia_sentence(&run, &estimate) })
}

fn settings(scene: &LiveScene) -> Settings {
    let step_s = scene.settings.steps_s[BackendKind::Rapier as usize];
    Settings { step_s, rapier: scene.settings.rapier, check_suggestions: false, ..Settings::default() }
}

/// The answer on the whole scene; `None` when it is no longer wanted.
fn judged(scenario: &Scenario, settings: &Settings, watch: impl Fn(f64) -> bool + Sync) -> Option<Judged> {
    let cost = ExpectedCost::of_comparison(scenario, settings).time_s;
    if cost > LONGEST {
        let answer = format!("Not compared here: it would take about {}. Save the scene for `cohaul compare`.", short_quantity(cost, "s"));
        return Some(Judged { valid: "open", answer, quantities: Vec::new(), numbers: None });
    }
    let clock = Instant::now();
    let runs = ThreeWay::new(scenario, settings);
    let tiers = match scenario.drive {
        Drive::Tips(_) => Tiers { prescribed: Some(runs.prescribed(watch)?), ..Tiers::default() },
        Drive::Ants(_) => Tiers { replayed: Some(runs.replayed(watch)?), ..Tiers::default() },
    };
    let compared = Comparison::new(scenario, settings, tiers, clock.elapsed().as_secs_f64());
    let found = compared.tiers.pathwise().next()?;
    let share = |of: f64, tolerance: f64| Some(of / tolerance).filter(|share| share.is_finite());
    let quantities = found.verdicts.named().map(|(name, of)| {
        let (effect, error) = of.deciding().map_or((of.inertia_effect / of.tolerance, of.engine_error / of.tolerance), |measure| {
            (measure.inertia_effect / measure.tolerance, measure.engine_error / measure.tolerance)
        });
        (name, share(effect, 1.0), share(error, 1.0), verdict_text(of))
    });
    let valid = match compared.is_valid() {
        Answer::Yes => "yes",
        Answer::No => "no",
        Answer::Partly => "partly",
        Answer::Open | Answer::None => "open",
    };
    Some(Judged {
        valid,
        answer: compared.answer.clone(),
        quantities: quantities.to_vec(),
        numbers: Some(found.numbers).filter(|numbers| numbers.zeta.is_some()),
    })
}
