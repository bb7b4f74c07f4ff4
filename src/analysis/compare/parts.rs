//! What the differences between the runs consist of.
//!
//! The inertia effect is that of inertial impacts that do not rebound, and what the rebound adds:
//! restitution does not vanish with the mass. The engine error is the distance of the engine from
//! its own limit of small steps, and that of the limit from the inertial run.

use serde::{Deserialize, Serialize};

use super::limit::Convergence;
use super::verdict::{Cause, causes_among};

/// What there is of the runs that tell parts of the differences.
#[derive(Clone, Default)]
pub(super) struct Others<T> {
    /// Engine at smaller steps. The last three, that at its own step before them, show the limit.
    pub finer: Vec<T>,
    pub convergence: Convergence,
    /// Inertial, with impacts that do not rebound.
    pub without_restitution: Option<T>,
    /// Quasi-static without dashpots.
    pub rate_independent: Option<T>,
}

impl<T> Others<T> {
    pub fn map<'a, U>(&'a self, of: impl Fn(&'a T) -> U) -> Others<U> {
        Others {
            finer: self.finer.iter().map(&of).collect(),
            convergence: self.convergence,
            without_restitution: self.without_restitution.as_ref().map(&of),
            rate_independent: self.rate_independent.as_ref().map(&of),
        }
    }
}

/// Parts of the differences in one number, in its unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Parts {
    /// Inertial, with impacts that do not rebound, minus quasi-static.
    pub inertia: f64,
    /// Inertial minus inertial with impacts that do not rebound; zero where nothing rebounds.
    pub impact: f64,
    /// Engine minus its limit of small steps.
    pub time_step: f64,
    /// That limit minus inertial.
    pub engine_model: f64,
    /// Error of the limit, which bounds the error of both parts of the engine error.
    pub limit_error: f64,
    /// Quasi-static minus quasi-static without dashpots: no part of the inertia effect; zero
    /// without dashpots.
    pub dashpots: f64,
}

impl Parts {
    /// Parts of a number with these values on the quasi-static, inertial and engine run.
    pub(super) fn of_numbers([quasi_static, inertial, engine]: [f64; 3], others: &Others<f64>) -> Self {
        let without_restitution = others.without_restitution.unwrap_or(inertial);
        let (limit, limit_error) = others.limit(engine);
        Self {
            inertia: (without_restitution - quasi_static).abs(),
            impact: (inertial - without_restitution).abs(),
            time_step: (engine - limit).abs(),
            engine_model: (limit - inertial).abs(),
            limit_error,
            dashpots: others.rate_independent.map_or(0.0, |without| (quasi_static - without).abs()),
        }
    }

    /// Causes of an inertia effect and an engine error, as far as each exceeds the tolerance. All
    /// are in one unit.
    pub(super) fn causes(self, exceeds: [bool; 2], reference_error: f64, tolerance: f64) -> impl Iterator<Item = Cause> {
        let of_inertia = causes_among([self.inertia, self.impact], reference_error, tolerance);
        let of_engine = causes_among([self.time_step, self.engine_model], self.limit_error + reference_error, tolerance);
        let [inertia, impact] = if of_inertia == [false; 2] { [true, self.impact > 0.0] } else { of_inertia };
        let [step, model] = of_engine;
        let causes = [
            (Cause::Inertia, exceeds[0] && inertia),
            (Cause::Impact, exceeds[0] && impact),
            (Cause::TimeStep, exceeds[1] && step),
            (Cause::EngineModel, exceeds[1] && model),
            (Cause::Engine, exceeds[1] && of_engine == [false; 2]),
        ];
        causes.into_iter().filter(|(_, is_cause)| *is_cause).map(|(cause, _)| cause)
    }
}

impl Others<f64> {
    /// Limit of small steps of a number and its error, from its value on the engine at its own
    /// step.
    fn limit(&self, engine: f64) -> (f64, f64) {
        let all: Vec<f64> = [engine].into_iter().chain(self.finer.iter().copied()).collect();
        all.last_chunk().map_or((engine, 0.0), |last| self.convergence.of_numbers(*last))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The time-step error is 0.4, the model error 0.3, and nothing is uncertain.
    #[test]
    fn parts_of_an_engine_error_of_first_order_are_its_own() {
        let others = Others { finer: vec![1.5, 1.4], ..Others::default() };
        let parts = Parts::of_numbers([1.0, 1.0, 1.7], &others);
        // Rounding of sums.
        assert!((parts.time_step - 0.4).abs() < 1e-15 && (parts.engine_model - 0.3).abs() < 1e-15, "{parts:?}");
        assert!((parts.limit_error - 1.25 * 0.1).abs() < 1e-15, "{parts:?}");
        let causes = |tolerance: f64| parts.causes([false, true], 0.0, tolerance).collect::<Vec<_>>();
        assert_eq!(causes(0.15), [Cause::TimeStep, Cause::EngineModel]);
        assert_eq!(causes(0.25), [Cause::TimeStep]);
        // Without either part the tolerance would hold.
        assert_eq!(causes(0.6), [Cause::TimeStep, Cause::EngineModel]);
        assert_eq!(Parts { limit_error: 0.5, ..parts }.causes([false, true], 0.0, 0.5).collect::<Vec<_>>(), [Cause::Engine]);
    }

    #[test]
    fn what_rebounds_is_no_inertia() {
        let others = Others { without_restitution: Some(1.01), rate_independent: Some(0.8), ..Others::default() };
        let parts = Parts::of_numbers([1.0, 1.5, 1.5], &others);
        assert_eq!(parts.causes([true, false], 0.0, 0.1).collect::<Vec<_>>(), [Cause::Impact]);
        assert!((parts.dashpots - 0.2).abs() < 1e-15);
    }
}
