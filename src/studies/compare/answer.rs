//! The answer of a comparison: whether the quasi-static backend is valid, and the engine error.

use crate::analysis::compare::{ClosedLoop, Measure, Pathwise, Verdict};
use crate::output::page::Answer;
use crate::output::quantity::{short, short_quantity};

/// Whether the inertia effect lies below the tolerance, whatever the reference error hides.
pub fn of_paths(found: &Pathwise) -> Answer {
    let [least, most] = found.edge_displacement.inertia_effect_range_m;
    match found.verdict {
        Verdict::NotComputed => Answer::Open,
        _ if !found.references_converged() => Answer::Open,
        _ if least > found.tolerance_m => Answer::No,
        _ if most <= found.tolerance_m => Answer::Yes,
        _ => Answer::Open,
    }
}

/// The answer from paths, in words: the inertia effect, then the engine error.
pub fn sentence_of_paths(found: &Pathwise) -> String {
    const UNKNOWN: &str = "It is not known whether quasi-static is valid here";
    if found.verdict == Verdict::NotComputed {
        return format!("{UNKNOWN}: a run failed.");
    }
    let effect = short_quantity(found.edge_displacement.inertia_effect_m, "m");
    let moves = format!("inertia moves the load by up to {effect} of edge displacement");
    let tolerance = tolerance(found);
    let inertia = match of_paths(found) {
        Answer::No => format!("Quasi-static is not valid here: {moves}, more than the tolerance of {tolerance}."),
        Answer::Yes if found.edge_displacement.inertia_effect_m == 0.0 => {
            "Quasi-static is valid here: inertia does not move the load.".to_owned()
        }
        Answer::Yes => format!("Quasi-static is valid here: {moves}, less than the tolerance of {tolerance}."),
        _ if !found.references_converged() => format!("{UNKNOWN}: some macro-steps of the reference runs did not converge."),
        _ => {
            let error = short_quantity(found.edge_displacement.reference_error_m, "m");
            format!("{UNKNOWN}: {moves}, too close to the tolerance of {tolerance} for the reference error of {error}.")
        }
    };
    format!("{inertia} {}", engine_sentence(found))
}

fn engine_sentence(found: &Pathwise) -> String {
    let [least, most] = found.edge_displacement.engine_error_range_m;
    let compared = match (least > found.tolerance_m, most <= found.tolerance_m) {
        (true, _) => "above the tolerance",
        (_, true) => "below the tolerance",
        _ => "too close to the tolerance to decide",
    };
    format!("The engine error of rapier is {}, {compared}.", short_quantity(found.edge_displacement.engine_error_m, "m"))
}

/// The tolerance, and what it is a share of if the load moves.
pub fn tolerance(found: &Pathwise) -> String {
    let tolerance = short_quantity(found.tolerance_m, "m");
    if found.tolerance_m > found.path_length_m {
        return tolerance;
    }
    let share = short(100.0 * found.tolerance_m / found.path_length_m);
    format!("{tolerance} ({share} % of the {} path length)", short_quantity(found.path_length_m, "m"))
}

/// Whether the distributions agree with and without inertia.
pub fn of_ensemble(found: &ClosedLoop) -> Answer {
    let differs = found.measures.iter().any(|measure| measure.inertia_effect.differs());
    let is_equal = found.measures.iter().filter(|measure| measure.exists()).all(|measure| measure.inertia_effect.is_equal);
    match found.verdict {
        Verdict::NotComputed | Verdict::Decorrelated => Answer::Open,
        _ if differs => Answer::No,
        _ if is_equal => Answer::Yes,
        _ => Answer::Open,
    }
}

/// The answer from distributions, in words.
pub fn sentence_of_ensemble(found: &ClosedLoop) -> String {
    let seeds = format!("{} paired seed{}", found.n_seeds, if found.n_seeds == 1 { "" } else { "s" });
    if found.verdict == Verdict::NotComputed {
        return "It is not known what inertia changes in the closed loop: a run failed.".to_owned();
    }
    match of_ensemble(found) {
        Answer::No => {
            let changed: Vec<&Measure> = found.measures.iter().filter(|measure| measure.inertia_effect.differs()).collect();
            let (name, unit) = name_and_unit(changed[0].name);
            let mean = short_quantity(changed[0].inertia_effect.mean, unit);
            let others = match changed.len() {
                1 => String::new(),
                2 => ", and one other measure".to_owned(),
                n => format!(", and {} other measures", n - 1),
            };
            format!("Inertia changes the {name} in the closed loop by {mean}{others}, over {seeds}.")
        }
        Answer::Yes => format!("Inertia changes no measure of the closed loop by more than 5 %, over {seeds}."),
        _ => format!("In the closed loop, {seeds} are too few to tell what inertia changes."),
    }
}

/// Name of a measure without its unit, and the unit.
pub fn name_and_unit(name: &str) -> (String, &'static str) {
    if name == "n_transporting" {
        return ("number transporting".to_owned(), "");
    }
    let units = [("_m_per_s", "m/s"), ("_s", "s"), ("_n", "N")];
    let found = units.iter().find_map(|(ending, unit)| Some((name.strip_suffix(ending)?, *unit)));
    let (name, unit) = found.unwrap_or((name, ""));
    (name.replace('_', " "), unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::compare::{Settings, ThreeWay};
    use crate::scenario::Scenario;

    fn compared(text: &str) -> Pathwise {
        ThreeWay::new(&Scenario::parse(text, "a scene").unwrap(), &Settings::default()).prescribed(|_| true).unwrap()
    }

    /// 56 seeds that all fail to arrive are the fewest for which the fraction is known to 5 %.
    #[test]
    fn a_nest_that_no_run_reaches_does_not_leave_the_answer_open() {
        let mut scenario = Scenario::parse(include_str!("../../../scenarios/paper/four-ants-four-springs.json"), "four ants").unwrap();
        scenario.system.ground.friction_coefficient *= 40.0;
        scenario.duration = 1.0;
        let found = ThreeWay::new(&scenario, &Settings::default()).closed_loop(56, |_| true).unwrap();
        assert_eq!((found.verdict, of_ensemble(&found)), (Verdict::Agree, Answer::Yes));
        let expected = "Inertia changes no measure of the closed loop by more than 5 %, over 56 paired seeds.";
        assert_eq!(sentence_of_ensemble(&found), expected);
    }

    /// A load that is released at 2.5 times its slip limit overshoots by its displacement without
    /// inertia.
    #[test]
    fn the_first_sentence_answers_the_question() {
        let mut found = compared(include_str!("../../../scenarios/analytic/release-jump.json"));
        let sentence = sentence_of_paths(&found);
        assert_eq!(of_paths(&found), Answer::No);
        assert!(sentence.starts_with("Quasi-static is not valid here: inertia moves the load by up to "), "{sentence}");
        assert!(sentence.contains(" (1 % of the "), "{sentence}");
        // Just below and just above the tolerance.
        let tolerance = found.tolerance_m;
        for (range, answer, says) in [
            ([0.0, tolerance], Answer::Yes, "Quasi-static is valid"),
            ([tolerance, 1.001 * tolerance], Answer::Open, "It is not known"),
            ([1.001 * tolerance, 1.002 * tolerance], Answer::No, "Quasi-static is not valid"),
        ] {
            found.edge_displacement.inertia_effect_range_m = range;
            assert_eq!(of_paths(&found), answer);
            assert!(sentence_of_paths(&found).starts_with(says), "{says}");
        }
        found.verdict = Verdict::NotComputed;
        assert_eq!(of_paths(&found), Answer::Open);
        assert!(sentence_of_paths(&found).ends_with("a run failed."));
    }

    #[test]
    fn a_load_at_rest_has_no_shares_of_its_path_length() {
        let found = compared(include_str!("../../../scenarios/stress/hold-below-limit.json"));
        assert_eq!(of_paths(&found), Answer::Yes);
        let sentence = sentence_of_paths(&found);
        assert!(sentence.starts_with("Quasi-static is valid here: inertia does not move the load. The engine error"), "{sentence}");
        assert!(!sentence.contains('%') && !sentence.contains("NaN"), "{sentence}");
    }
}
