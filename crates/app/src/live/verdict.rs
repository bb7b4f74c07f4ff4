//! The comparison of the scene, beside the runs.

use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use super::message::{Judged, Tell};
use super::scene::LiveScene;
use cohaul::analysis::ExpectedCost;
use cohaul::analysis::compare::{Settings, ThreeWay};
use cohaul::backend::BackendKind;
use cohaul::scenario::{Drive, Scenario};
use cohaul::stop::Stop;
use cohaul_report::page::Answer;
use cohaul_report::quantity::short_quantity;
use cohaul_studies::compare::answer::verdict_text;
use cohaul_studies::compare::comparison::{Comparison, Tiers};

/// A slider that moves asks many times; only a scene that has stood for this long is compared.
const PATIENCE: Duration = Duration::from_millis(250);
/// Time that a comparison is expected to take at most (s). Others are left to `cohaul compare`.
const LONGEST: f64 = 120.0;

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

    /// Forgets the scene before and compares this one; `tell` hears of it.
    pub fn ask(&mut self, scene: &LiveScene, tell: impl Fn(Tell) + Send + 'static) {
        self.stale.ask();
        self.stale = Stop::default();
        let (stale, turn) = (self.stale.clone(), Arc::clone(&self.turn));
        let (scenario, settings) = (scene.scenario.clone(), settings(scene));
        thread::spawn(move || {
            let is_wanted = || !stale.is_asked();
            thread::sleep(PATIENCE);
            if !is_wanted() {
                return;
            }
            tell(Tell::Comparing);
            // A comparison before this one that panicked leaves nothing half done here.
            let _turn = turn.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            if let Some(judged) = stale.run(|| judged(&scenario, &settings, is_wanted)).flatten() {
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

fn settings(scene: &LiveScene) -> Settings {
    let step_s = scene.settings.steps_s[BackendKind::Rapier as usize];
    Settings { step_s, rapier: scene.settings.rapier, check_suggestions: false, ..Settings::default() }
}

/// The answer on the whole scene; `None` when it is no longer wanted.
fn judged(scenario: &Scenario, settings: &Settings, is_wanted: impl Fn() -> bool + Sync) -> Option<Judged> {
    let cost = ExpectedCost::of_comparison(scenario, settings).time_s;
    if cost > LONGEST {
        let answer = format!("Not compared here: it would take about {}. Save the scene for `cohaul compare`.", short_quantity(cost, "s"));
        return Some(Judged { valid: "open", answer, quantities: Vec::new(), numbers: None });
    }
    let clock = Instant::now();
    let (runs, watch) = (ThreeWay::new(scenario, settings), |_share: f64| is_wanted());
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
