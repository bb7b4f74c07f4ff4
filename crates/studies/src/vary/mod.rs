//! Comparison of the backends over one or two parameters of a scene.
//!
//! At each point a quasi-static run with its inertia estimate comes first. All three backends are
//! compared where the estimate does not lie clearly on one side of the tolerance, where there is no
//! valid estimate, and at the corners of the map. Elsewhere the estimate alone decides whether
//! quasi-static is valid for the path.
//!
//! ```text
//! mod.rs      one point, and all points as tasks
//! report.rs   the answer, the table and the text
//! figure.rs   two parameters as maps, one parameter as curves
//! files.rs    page, table, figure and summary in an output folder
//! ```

mod figure;
pub mod files;
pub mod report;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::compare::answer;
use crate::runner::Tasks;
use crate::stress::guard::guarded;
use crate::sweep::{Ask, Axis, Design, Plan, SweepError, Variant};
use cohaul::analysis::compare::{EngineAnswer, InertiaAnswer, Pathwise, QuantityVerdict, Settings, ThreeWay, Verdict};
use cohaul::analysis::estimate::{CLEAR, with_estimate};
use cohaul::backend::{BackendKind, Integrator, closed_share};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Health, Keep, Simulation, controller_of};
use cohaul_report::page::Answer;

/// What is asked of every point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Question {
    pub settings: Settings,
    /// Whether all three backends are compared at every point.
    pub everywhere: bool,
}

/// One point of the map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Values of the parameters.
    pub values: Vec<Value>,
    /// `null` if there is no valid estimate.
    pub estimate: Option<Estimated>,
    /// Path, heading, pulls, contact forces, speed and energy on all backends; `null` where the
    /// estimate decided.
    pub compared: Option<[Compared; 6]>,
    /// Why there is no result.
    pub failure: Option<String>,
}

/// Inertia effect on the path, from a quasi-static run alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimated {
    /// Largest edge displacement (m).
    pub inertia_effect_m: f64,
    /// Largest edge displacement that counts as agreement (m).
    pub tolerance_m: f64,
}

/// Verdict on one quantity, in its unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compared {
    pub verdict: Verdict,
    pub inertia: InertiaAnswer,
    pub engine: EngineAnswer,
    /// The verdict in words: the causes of what exceeds a tolerance.
    pub words: String,
    /// Whether quasi-static is valid; `null` if the reference error or a doubtful run leaves it
    /// open, or if nothing moved.
    pub is_valid: Option<bool>,
    pub inertia_effect: f64,
    pub engine_error: f64,
    pub reference_error: f64,
    pub tolerance: f64,
}

/// Plan of the points of the scenario in the `text` of a `file` over these axes.
///
/// # Errors
/// When the scenario breaks a rule, or has no such parameters.
pub fn plan(file: String, text: String, axes: Vec<Axis>, seed: Option<u64>, settings: &Settings) -> Result<Plan, SweepError> {
    Plan::new(Ask {
        file,
        text,
        design: Design::new(axes, None)?,
        variants: vec![Variant {
            backend: BackendKind::QuasiStatic,
            step_s: settings.step_s,
            tolerance_m: settings.reference_tolerance_m,
            integrator: Integrator::default(),
            rapier: settings.rapier,
            skips: settings.skips,
        }],
        first_seed: seed,
        n_seeds: 1,
    })
}

/// All points of `plan` as tasks.
pub fn tasks<'a>(plan: &'a Plan, question: &'a Question) -> Tasks<'a, Cell> {
    Tasks::equal(plan.identity.n_cells as usize, move |point, go_on| Cell::of(plan, question, point as u64, go_on))
}

/// Whether every parameter has its first or last value at a point.
fn is_corner(plan: &Plan, mut point: u64) -> bool {
    plan.identity.design.axes.iter().rev().filter_map(|axis| axis.n_values()).all(|n| {
        let at = point % n;
        point /= n;
        at == 0 || at + 1 == n
    })
}

impl Cell {
    /// Point `point` of the plan; `None` when `go_on` ended it.
    fn of(plan: &Plan, question: &Question, point: u64, go_on: &(dyn Fn() -> bool + Sync)) -> Option<Self> {
        let values = plan.values(point);
        let mut cell = Self { values, estimate: None, compared: None, failure: None };
        let found = guarded(|| {
            let scenario = match plan.scenario(&cell.values) {
                Ok(scenario) => Scenario { seed: plan.identity.first_seed, ..scenario },
                Err(error) => return Some((None, Err(error.to_string()))),
            };
            let estimate = Estimated::of(&scenario, &question.settings, go_on)?;
            let decides = estimate.is_some_and(|estimate| estimate.is_clear()) && !question.everywhere && !is_corner(plan, point);
            let compared = if decides { Ok(None) } else { compared(&scenario, &question.settings, go_on)?.map(Some) };
            Some((estimate, compared))
        });
        match found {
            Ok(None) => return None,
            Ok(Some((estimate, Ok(compared)))) => cell = Self { estimate, compared, ..cell },
            Ok(Some((estimate, Err(why)))) => cell = Self { estimate, failure: Some(why), ..cell },
            Err(panic) => cell.failure = Some(format!("panicked: {panic}")),
        }
        Some(cell)
    }

    /// Whether quasi-static is valid for the path, by the comparison or else by the estimate.
    pub fn is_valid_for_path(&self) -> Option<bool> {
        match (&self.compared, self.failure.is_some()) {
            (_, true) => None,
            (Some(compared), _) => compared[0].is_valid,
            (None, _) => self.estimate.map(|estimate| estimate.margin() <= 1.0),
        }
    }

    /// Whether all backends were compared, and the load moved on none.
    pub fn nothing_moved(&self) -> bool {
        self.compared.as_ref().is_some_and(|compared| compared[0].verdict == Verdict::NothingMoved)
    }

    /// The estimate, if it alone decided.
    pub fn decided_by_estimate(&self) -> Option<Estimated> {
        self.estimate.filter(|_| self.compared.is_none() && self.failure.is_none())
    }
}

impl Estimated {
    /// Estimate for the path that a comparison would take as quasi-static; the inner `None` if
    /// there is no valid one, the outer if `go_on` ended the run.
    fn of(scenario: &Scenario, settings: &Settings, go_on: &dyn Fn() -> bool) -> Option<Option<Self>> {
        let options = match scenario.drive {
            Drive::Tips(_) => settings.under_error_control(scenario, BackendKind::QuasiStatic),
            Drive::Ants(_) => settings.at_fixed_step(scenario, BackendKind::QuasiStatic),
        };
        // Ants that another backend has recorded take other paths.
        if matches!(scenario.drive, Drive::Ants(_)) && settings.recorded_from != BackendKind::QuasiStatic {
            return Some(None);
        }
        let (backend, estimator) = with_estimate(&scenario.system, scenario.start, &options);
        let mut run = Simulation::from_parts(scenario, &options, Keep::Outcome, controller_of(scenario), backend);
        run.run(|_| go_on());
        if !run.is_finished() {
            return None;
        }
        let estimate = estimator.borrow().estimate();
        let found =
            Self { inertia_effect_m: estimate.edge_displacement_max_m, tolerance_m: settings.tolerance_share * estimate.path_length_m };
        let outcome = run.outcome();
        let share = closed_share(options.tolerance.is_some(), settings.tolerance_energy_share);
        let is_closed = outcome.energy.is_closed(share, outcome.energy.largest_entry());
        let is_trusted = outcome.account.health == Health::Ok && outcome.doubtful.is_empty() && is_closed;
        let is_valid = is_trusted && !estimate.is_invalid;
        // A load that hardly moves has no margin.
        Some(Some(found).filter(|found| is_valid && found.margin().is_finite()))
    }

    /// Estimated inertia effect over the tolerance (1).
    pub fn margin(&self) -> f64 {
        self.inertia_effect_m / self.tolerance_m
    }

    fn is_clear(&self) -> bool {
        self.margin() <= CLEAR.recip() || self.margin() >= CLEAR
    }
}

/// Verdicts of a comparison of paths, or why there are none; the outer `None` if `go_on` ended it.
fn compared(scenario: &Scenario, settings: &Settings, go_on: &(dyn Fn() -> bool + Sync)) -> Option<Result<[Compared; 6], String>> {
    let runs = ThreeWay::new(scenario, settings);
    let found = match scenario.drive {
        Drive::Tips(_) => runs.prescribed(|_| go_on())?,
        Drive::Ants(_) => runs.replayed(|_| go_on())?,
    };
    let verdicts = of_quantities(&found);
    let numbers = |of: &Compared| [of.inertia_effect, of.engine_error, of.reference_error, of.tolerance];
    Some(match found.verdict {
        Verdict::NotComputed => Err(answer::failed_runs(&found)),
        _ if verdicts.iter().flat_map(numbers).all(f64::is_finite) => Ok(verdicts),
        _ => Err("a number of the comparison is not finite".to_owned()),
    })
}

fn of_quantities(found: &Pathwise) -> [Compared; 6] {
    let of = |(_, of): (&str, &QuantityVerdict)| Compared {
        verdict: of.verdict,
        inertia: of.inertia,
        engine: of.engine,
        words: answer::verdict_text(of),
        is_valid: match answer::is_valid(of) {
            Answer::Yes if of.verdict != Verdict::NothingMoved => Some(true),
            Answer::No => Some(false),
            _ => None,
        },
        inertia_effect: of.inertia_effect,
        engine_error: of.engine_error,
        reference_error: of.reference_error,
        tolerance: of.tolerance,
    };
    found.verdicts.named().map(of)
}
