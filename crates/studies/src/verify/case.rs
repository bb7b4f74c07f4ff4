//! A question, the methods that it is put to, and the bounds of their answers.

use serde::{Deserialize, Serialize};

use super::measured::{Errors, Measured};
use crate::methods::Method;
use crate::runner::Effort;
use crate::subject::Runs;
use crate::variants::names;
use cohaul::backend::{BackendOptions, Tolerance};
use cohaul::model::Load;

/// A scene, what is measured in it, and the known answer.
pub struct Case {
    pub name: String,
    pub family: Family,
    pub what: String,
    /// Where the known answer comes from.
    pub source: String,
    pub run: Run,
    pub plans: Vec<Plan>,
}

/// Puts the question to a backend or an engine.
pub type Run = Box<dyn Fn(&Runs) -> Measured + Send + Sync>;

/// Cases that test the same law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    Slide,
    Tripod,
    Pull,
    Release,
    LimitSurface,
    MaxMin,
    Towing,
    Contact,
    Symmetry,
    Mass,
    Reference,
    Peers,
}

/// Steps or tolerances at which a method is tried, and what its errors should be.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub method: Method,
    pub levels: Levels,
    pub n_levels: usize,
    pub expected: Expected,
    pub bound: Bound,
    /// Bound of the extrapolated answer, at the shortest step; `None` where there is none.
    pub limit: Option<Bound>,
}

/// How exact the runs of a plan are, the least exact one first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Levels {
    /// Steps of at most this length (s), successively halved.
    Steps(f64),
    /// Tolerances on the edge displacement of this load, from a millimetre on, each a tenth of the
    /// one before.
    Tolerances(Load),
}

/// How the error should fall with the step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind", content = "power")]
pub enum Expected {
    /// With this power of the step; measured between successive steps.
    Order(f64),
    /// Anyhow, but within a bound that falls with this power: where an event lies within its step
    /// decides the rest.
    Within(f64),
    /// There is no error but rounding.
    Exact,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    pub errors: Errors,
    pub reason: String,
}

impl Case {
    /// The answer of a backend of these options, beside the known one.
    pub fn run(&self, options: &BackendOptions) -> Measured {
        (self.run)(&Runs::of(*options))
    }
}

/// The cases that ask rapier, put to an engine of the user in its place, at the same steps and
/// within the same bounds: those of a method of first order. A higher order is right as well.
pub fn put_to(method: Method, mut cases: Vec<Case>) -> Vec<Case> {
    for case in &mut cases {
        case.plans.retain(|plan| plan.method == Method::RAPIER);
        for plan in &mut case.plans {
            let expected = if let Expected::Order(order) = plan.expected { Expected::Within(order) } else { plan.expected };
            *plan = Plan { method, expected, limit: None, ..plan.clone() };
        }
    }
    cases.retain(|case| !case.plans.is_empty());
    cases
}

impl Family {
    pub fn name(self) -> &'static str {
        names::<Self>()[self as usize]
    }
}

/// The loosest of the tolerances asked for (m), and their number: down to 10 nm.
const LOOSEST: f64 = 1e-3;
const N_TOLERANCES: usize = 6;

impl Plan {
    /// A method of first order, extrapolated: within `bound` at the longest step, and within
    /// `limit` in the limit of small ones.
    pub fn first_order(method: Method, step_s: f64, n_levels: usize, bound: Bound, limit: Bound) -> Self {
        Self { method, levels: Levels::Steps(step_s), n_levels, expected: Expected::Order(1.0), bound, limit: Some(limit) }
    }

    pub fn of_order(order: f64, method: Method, step_s: f64, n_levels: usize, bound: Bound) -> Self {
        Self { method, levels: Levels::Steps(step_s), n_levels, expected: Expected::Order(order), bound, limit: None }
    }

    /// Within a bound that falls with the step to this power.
    pub fn within(power: f64, method: Method, step_s: f64, n_levels: usize, bound: Bound) -> Self {
        Self { method, levels: Levels::Steps(step_s), n_levels, expected: Expected::Within(power), bound, limit: None }
    }

    pub fn exact(method: Method, step_s: f64, n_levels: usize, bound: Bound) -> Self {
        Self { method, levels: Levels::Steps(step_s), n_levels, expected: Expected::Exact, bound, limit: None }
    }

    /// Under error control, within what is asked for: a shift of the tolerance, and a turn that
    /// moves the edge of `load` as far; ratios as exactly as turns. Bounds are of the same units as
    /// `errors`.
    pub fn controlled(method: Method, load: &Load, errors: &Errors) -> Self {
        let turn = LOOSEST / load.radius;
        let errors = Errors {
            metres: errors.metres.and(Some(LOOSEST)),
            radians: errors.radians.and(Some(turn)),
            ratio: errors.ratio.and(Some(turn)),
        };
        let bound = Bound { errors, reason: "asked for".to_owned() };
        let levels = Levels::Tolerances(*load);
        Self { method, levels, n_levels: N_TOLERANCES, expected: Expected::Within(1.0), bound, limit: None }
    }

    /// Options of the runs, the least exact ones first: without the shortest step, which is half of
    /// the work, or with every second tolerance, if it is to be quick.
    pub fn options(&self, effort: Effort) -> Vec<BackendOptions> {
        let is_quick = effort == Effort::Quick;
        let levels = 0..self.n_levels as i32;
        match self.levels {
            Levels::Steps(longest) => {
                let n = if is_quick { (self.n_levels - 1).max(1) } else { self.n_levels };
                levels.take(n).map(|level| self.method.options(longest * 0.5f64.powi(level))).collect()
            }
            Levels::Tolerances(load) => {
                let tolerance = |level| Tolerance::at_edge(LOOSEST * 0.1f64.powi(level), &load);
                let stride = if is_quick { 2 } else { 1 };
                levels.step_by(stride).map(|level| self.method.within(tolerance(level))).collect()
            }
        }
    }

    /// What an error may be over the bound at the least exact level, where it falls in proportion
    /// with the level (1).
    pub fn share(&self, options: &BackendOptions) -> f64 {
        match (self.levels, &options.tolerance) {
            (Levels::Steps(longest), _) => options.step_s / longest,
            (Levels::Tolerances(_), tolerance) => tolerance.map_or(f64::NAN, |tolerance| tolerance.position_m / LOOSEST),
        }
    }

    /// Shown without a bound.
    pub fn shown(method: Method, step_s: f64, n_levels: usize) -> Self {
        Self::within(0.0, method, step_s, n_levels, Bound { errors: Errors::NONE, reason: "information only".to_owned() })
    }
}

impl Expected {
    pub fn name(self) -> &'static str {
        match self {
            Expected::Order(_) => "order",
            Expected::Within(_) => "within",
            Expected::Exact => "exact",
        }
    }

    /// Power of the step with which a bound falls.
    pub fn power(self) -> f64 {
        match self {
            Expected::Order(power) | Expected::Within(power) => power,
            Expected::Exact => 0.0,
        }
    }
}

impl Bound {
    pub fn metres(metres: f64, reason: &str) -> Self {
        Self { errors: Errors { metres: Some(metres), ..Errors::NONE }, reason: reason.to_owned() }
    }

    pub fn radians(radians: f64, reason: &str) -> Self {
        Self { errors: Errors { radians: Some(radians), ..Errors::NONE }, reason: reason.to_owned() }
    }

    pub fn ratio(ratio: f64, reason: &str) -> Self {
        Self { errors: Errors { ratio: Some(ratio), ..Errors::NONE }, reason: reason.to_owned() }
    }

    pub fn pose(metres: f64, radians: f64, reason: &str) -> Self {
        Self { errors: Errors { metres: Some(metres), radians: Some(radians), ratio: None }, reason: reason.to_owned() }
    }

    /// The bound at a step that is `share` of the longest, where it falls with this power of it.
    pub fn at(&self, share: f64, power: f64) -> Errors {
        self.errors.map(|bound| bound * share.powf(power))
    }
}
