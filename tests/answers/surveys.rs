//! Surveys of random scenes: suggestions are followed, and what is printed side by side agrees.
//!
//! The long surveys are run by hand: `cargo test --test answers --release -- --ignored --nocapture
//! survey`.

use cohaul::analysis::compare::{Pathwise, Settings, SuggestedChange, ThreeWay};
use cohaul::output::page::Answer;
use cohaul::scenario::{Drive, Scenario};
use cohaul::studies::compare::answer::is_valid;
use cohaul::studies::compare::text::tried;

use crate::random_scenes::random_scenario;

fn compared(scenario: &Scenario, check_suggestions: bool) -> Pathwise {
    let settings = Settings { check_suggestions, ..Settings::default() };
    ThreeWay::new(scenario, &settings).prescribed(|_| true).unwrap()
}

/// Random scenes with prescribed tips, by their seeds.
fn scenes(first: u64) -> impl Iterator<Item = (u64, Scenario)> {
    (first..).map(|seed| (seed, random_scenario(seed))).filter(|(_, scenario)| matches!(scenario.drive, Drive::Tips(_)))
}

/// Follows the suggestions of scenes from this seed on until `n` that differ by inertia were
/// compared again. The result is what was said before: the number of scenes for which the changes
/// were enough, were not, and were not tried.
fn followed(first: u64, n: usize) -> [usize; 3] {
    let mut counts = [0; 3];
    for (seed, mut scenario) in scenes(first) {
        if counts.iter().sum::<usize>() == n {
            break;
        }
        let found = compared(&scenario, true);
        if !found.suggested_changes.iter().any(SuggestedChange::is_of_scene) {
            continue;
        }
        let text = tried(&found).expect("there is a change");
        let Some(said) = found.tried else {
            assert!(text.starts_with("not checked: a trial would take"), "{seed}: {text}");
            counts[2] += 1;
            println!("{seed}: {text}, {:?}", found.suggested_changes);
            continue;
        };
        found.suggested_changes.iter().for_each(|change| change.apply(&mut scenario));
        let again = compared(&scenario, false);
        let path = &again.verdicts.path;
        // Both runs are within their reference errors of the truth, one in twenty of the tolerance.
        let allowed = path.reference_error + 0.05 * said.tolerance_m;
        println!("{seed}: {text}; again {:.4e} of {:.4e} m, {:?}", path.inertia_effect, path.tolerance, found.suggested_changes);
        assert!((path.inertia_effect - said.inertia_effect_m).abs() <= allowed, "{seed}: {text}, again {path:?}");
        assert_eq!(text.starts_with("checked"), said.is_enough);
        let is_close = (path.inertia_effect - path.tolerance).abs() <= allowed;
        assert!(is_close || said.is_enough == (is_valid(path) == Answer::Yes), "{seed}: {text}, again {path:?}");
        counts[usize::from(!said.is_enough)] += 1;
    }
    counts
}

/// Estimates on the other side of the tolerance than the measured inertia effect, with the seed,
/// and both over the tolerance (1); all `n` scenes from this seed on.
fn contradictions(first: u64, n: usize) -> Vec<(u64, [f64; 2])> {
    let mut found = Vec::new();
    for (seed, scenario) in scenes(first).take(n) {
        let compared = compared(&scenario, false);
        let (path, Some(estimate)) = (&compared.verdicts.path, compared.predicted.estimated_m) else { continue };
        let [estimated, measured] = [estimate, path.inertia_effect].map(|effect| effect / path.tolerance);
        let is_other = match is_valid(path) {
            Answer::Yes => estimated > 1.0,
            Answer::No => estimated <= 1.0,
            _ => false,
        };
        if is_other {
            println!("{seed}: estimated {estimated:.3}, measured {measured:.3} of the tolerance");
            found.push((seed, [estimated, measured]));
        }
    }
    found
}

#[test]
fn what_is_said_of_suggestions_is_what_happens_when_they_are_followed() {
    let counts = followed(5000, 2);
    assert!(counts[0] >= 1, "{counts:?}");
}

#[test]
#[ignore = "takes minutes; a shorter version runs always"]
fn survey_of_fifty_followed_suggestions() {
    println!("enough, not enough, not checked: {:?}", followed(5000, 50));
}

/// Estimate and measurement lie on one side of the tolerance, but for estimates that are wrong by
/// less than the factor beyond which one alone decides a point of a map.
#[test]
fn estimates_contradict_no_measurement_by_more_than_their_margin() {
    for (seed, [estimated, measured]) in contradictions(7000, 3) {
        let ratio = (estimated / measured).max(measured / estimated);
        assert!(ratio < cohaul::studies::vary::CLEAR, "{seed}: {estimated} and {measured}");
    }
}

#[test]
#[ignore = "takes long; a shorter version runs always"]
fn survey_of_contradictions() {
    let n = std::env::var("COHAUL_SCENES").ok().and_then(|n| n.parse().ok()).unwrap_or(2000);
    let found = contradictions(7000, n);
    let worst = found.iter().map(|(_, [a, b])| (a / b).max(b / a)).fold(1.0, f64::max);
    println!("{} of {n} on the other side, by up to a factor of {worst:.3} ", found.len());
    assert!(worst < cohaul::studies::vary::CLEAR);
}
