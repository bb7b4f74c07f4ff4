//! The two exact models at one value of the parameter.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::compare::{answer, doubt};
use crate::stress::guard::guarded;
use crate::sweep::Plan;
use cohaul::analysis::compare::{Pathwise, QuantityVerdict, Settings, ThreeWay, Verdict};
use cohaul::scenario::Scenario;
use cohaul_report::page::Answer;

/// What the two exact models show at one value of the parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Value of the parameter, in its unit.
    pub value: f64,
    /// Path, heading, pulls, contact forces, speed and energy; `null` for pulls without a spring
    /// that is ever attached, for contact forces without an obstacle that is ever touched, and for
    /// all if there is no result.
    pub effects: [Option<Effect>; 6],
    /// Why nothing is claimed from some time on.
    pub doubt: Option<String>,
    /// Why there is no result.
    pub failure: Option<String>,
}

/// Inertia effect on one quantity, in its unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    pub class: Class,
    pub inertia_effect: f64,
    pub reference_error: f64,
    pub tolerance: f64,
}

/// What is known of quasi-static at one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// The inertia effect is within the tolerance, whatever the reference error hides.
    Valid,
    /// It exceeds the tolerance.
    NotValid,
    /// The reference error or a doubtful run leaves it open.
    Open,
    /// The load does not move.
    NothingMoves,
    /// There is no result.
    Failed,
}

impl Point {
    /// Compares the models at a `value`; `None` when `go_on` ended it.
    pub fn of(plan: &Plan, settings: &Settings, value: f64, go_on: &(dyn Fn() -> bool + Sync)) -> Option<Self> {
        let failed = |why: String| Self { value, effects: [None; 6], doubt: None, failure: Some(why) };
        let found = guarded(|| match plan.scenario(&[Value::from(value)]) {
            Ok(scenario) => {
                let scenario = Scenario { seed: plan.identity.first_seed, ..scenario };
                ThreeWay::new(&scenario, settings).without_engine(|_| go_on()).map(Ok)
            }
            Err(error) => Some(Err(error.to_string())),
        });
        Some(match found {
            Ok(None) => return None,
            Ok(Some(Ok(found))) => Self::found(value, &found).unwrap_or_else(failed),
            Ok(Some(Err(why))) => failed(why),
            Err(panic) => failed(format!("panicked: {panic}")),
        })
    }

    fn found(value: f64, found: &Pathwise) -> Result<Self, String> {
        if found.verdict == Verdict::NotComputed {
            return Err(answer::failed_runs(found));
        }
        let shown: Vec<&str> = found.verdicts.shown().map(|(name, _)| name).collect();
        let effects = found.verdicts.named().map(|(name, of)| shown.contains(&name).then(|| Effect::of(of)));
        match effects.iter().flatten().all(Effect::is_finite) {
            true => Ok(Self { value, effects, doubt: doubt::of_paths(found), failure: None }),
            false => Err("a number of the comparison is not finite".to_owned()),
        }
    }

    /// What is known of a quantity.
    pub fn class(&self, quantity: usize) -> Class {
        match (self.effects[quantity], &self.failure) {
            (Some(effect), _) => effect.class,
            (None, Some(_)) => Class::Failed,
            (None, None) => Class::NothingMoves,
        }
    }

    /// Inertia effect on a quantity over its tolerance (1).
    pub fn share(&self, quantity: usize) -> Option<f64> {
        self.effects[quantity].map(|effect| effect.inertia_effect / effect.tolerance)
    }
}

impl Effect {
    fn of(of: &QuantityVerdict) -> Self {
        let class = match answer::is_valid(of) {
            _ if of.verdict == Verdict::NothingMoved => Class::NothingMoves,
            Answer::Yes => Class::Valid,
            Answer::No => Class::NotValid,
            _ => Class::Open,
        };
        Self { class, inertia_effect: of.inertia_effect, reference_error: of.reference_error, tolerance: of.tolerance }
    }

    fn is_finite(&self) -> bool {
        [self.inertia_effect, self.reference_error, self.tolerance, self.inertia_effect / self.tolerance].iter().all(|it| it.is_finite())
    }
}
