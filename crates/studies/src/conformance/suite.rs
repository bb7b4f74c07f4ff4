//! All tests, as tasks.

use std::ops::RangeInclusive;

use super::asked::Asked;
use super::test::{Answer, Test};
use super::{contact, invariance, springs, stops};
use crate::runner::Tasks;
use crate::subject::Meet;

pub use super::stops::first_scene;

/// Step at which engines are asked, unless another is chosen (s).
pub const STEP_S: f64 = 1e-3;
/// Steps that the tests allow (s): few enough in six seconds to keep a row of each, and at least
/// three in the shortest stop.
pub const STEPS_S: RangeInclusive<f64> = 1e-5..=0.01;

/// All tests, in the order of their numbers.
pub fn all() -> Vec<Test> {
    let mut tests = [&stops::TESTS[..], &springs::TESTS, &contact::TESTS, &invariance::TESTS].concat();
    let number = |test: &Test| test.key[1..].trim_end_matches(char::is_alphabetic).parse::<u32>().expect("keys have numbers");
    tests.sort_by_key(|test| (number(test), test.key));
    tests
}

/// One task a test: its answer. An engine without inertia is asked only what does not need it.
pub fn tasks<'a>(tests: &'a [Test], meet: &'a Meet<'a>, step_s: f64, has_inertia: bool) -> Tasks<'a, Answer> {
    Tasks::equal(tests.len(), move |at, go_on| {
        let test = &tests[at];
        if test.has_inertia && !has_inertia {
            return Some(test.refused("the answer is that of a load with inertia, which this engine has not"));
        }
        test.ask(&Asked::new(meet, step_s, go_on))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conformance::Outcome;
    use crate::subject::Fresh;
    use cohaul::backend::{BackendKind, BackendOptions, Tolerance};
    use cohaul::scenario::Scenario;
    use cohaul::simulation::backend_of;

    fn answers(meet: &Meet, step_s: f64) -> Vec<Answer> {
        tasks(&all(), meet, step_s, true).finished(&|_| true).unwrap()
    }

    /// Tolerance of error control over the load's radius (1).
    const TOLERANCE: f64 = 1e-8;
    /// What that is of an answer at most (1): answers are an eighth of the radius or more.
    const ASKED_FOR: f64 = 8.0 * TOLERANCE;

    /// Every answer is what the exact backend finds under error control: to what error control was
    /// asked for, and to what the answer itself is known to.
    #[test]
    fn every_known_answer_is_found_by_the_exact_backend_under_error_control() {
        let meet = |scenario: &Scenario, _: &BackendOptions| {
            let load = &scenario.system.load;
            let options = BackendOptions::within(BackendKind::Inertial, Tolerance::at_edge(TOLERANCE * load.radius, load));
            Ok(Fresh { backend: backend_of(scenario, &options), complaint: Box::new(|| None) })
        };
        for answer in answers(&meet, STEP_S) {
            assert_eq!(answer.outcome, Outcome::Answered, "{answer:?}");
            assert!(!answer.measures.is_empty(), "{answer:?}");
            for measure in &answer.measures {
                let asked_for = ASKED_FOR * (measure.error / measure.relative_error).abs();
                let bound = measure.accuracy.max(if asked_for.is_finite() { asked_for } else { 0.0 });
                assert!(measure.error.abs() <= bound, "{} {measure:?} {bound:e}", answer.key);
            }
        }
    }
}
