//! What a comparison says first: whether neglecting inertia was justified, in one sentence.

use crate::analysis::compare::{ClosedLoop, Measure, Pathwise, Verdict};
use crate::output::page::Answer;
use crate::output::quantity::{number, quantity};
use crate::studies::compare::report::{named, occasion};

/// Whether paths allow to neglect inertia: their distance, own errors counted against the answer, beside what counts as agreement.
pub fn of_paths(found: &Pathwise) -> Answer {
    let [least, most] = found.rim.inertia_range_m;
    match found.verdict {
        Verdict::NotComputed => Answer::Open,
        _ if !found.backends.are_known() => Answer::Open,
        _ if least > found.tolerance_m => Answer::No,
        _ if most <= found.tolerance_m => Answer::Yes,
        _ => Answer::Open,
    }
}

pub fn sentence_of_paths(found: &Pathwise) -> String {
    let answer = of_paths(found);
    if found.verdict == Verdict::NotComputed {
        return "Whether quasi-static is justified cannot be told: a run failed.".to_owned();
    }
    let inertia = quantity(found.rim.inertia_m, "m");
    let effect = format!("inertia moves the load's rim by up to {inertia}{}", share_of_way(found.rim.inertia_m, found));
    match answer {
        Answer::No => {
            let first = found.first_parting.by_inertia.map_or(String::new(), |parting| {
                let after = parting.after.map_or(String::new(), |after| format!(", after {}", occasion(&after)));
                format!("; the paths first part by more at {}{after}", quantity(parting.time_s, "s"))
            });
            format!("Quasi-static is NOT justified on this scene: {effect}. Up to {} would count as agreement{first}.", allowed(found))
        }
        Answer::Yes if found.rim.inertia_m == 0.0 => {
            "Quasi-static is justified on this scene: inertia does not move the load at all.".to_owned()
        }
        Answer::Yes => format!("Quasi-static is justified on this scene: {effect}, within the {} that count as agreement.", allowed(found)),
        _ if !found.backends.are_known() => {
            format!("Whether quasi-static is justified cannot be told: {effect}, by paths of which some strides did not converge.")
        }
        _ => format!(
            "Whether quasi-static is justified cannot be told: {effect}, where {} is agreement, but these paths may themselves be wrong by {}.",
            allowed(found),
            quantity(found.rim.own_m, "m")
        ),
    }
}

/// The engine's part, for who would use it.
pub fn engine_sentence(found: &Pathwise) -> String {
    if found.verdict == Verdict::NotComputed {
        return String::new();
    }
    let [least, most] = found.rim.engine_range_m;
    let within = match (least > found.tolerance_m, most <= found.tolerance_m) {
        (true, _) => "beyond agreement",
        (_, true) => "within agreement",
        _ => "about as much as agreement allows",
    };
    format!(
        "Rapier, as set up here, adds {} of its own{}: {within}.",
        quantity(found.rim.engine_m, "m"),
        share_of_way(found.rim.engine_m, found)
    )
}

/// Displacement of the rim that counts as agreement, as a share where there is a way.
fn allowed(found: &Pathwise) -> String {
    let share = found.tolerance_m / found.path_length_m;
    if has_way(found) {
        format!("{} % ({})", short(100.0 * share), quantity(found.tolerance_m, "m"))
    } else {
        quantity(found.tolerance_m, "m")
    }
}

fn share_of_way(displacement: f64, found: &Pathwise) -> String {
    if !has_way(found) {
        return String::new();
    }
    format!(", {} % of its way of {}", short(100.0 * displacement / found.path_length_m), quantity(found.path_length_m, "m"))
}

fn has_way(found: &Pathwise) -> bool {
    found.path_length_m > 0.0 && (found.rim.inertia_m / found.path_length_m).is_finite() && found.tolerance_m <= found.path_length_m
}

/// Three digits, and no zeros that say nothing.
pub fn short(value: f64) -> String {
    if !(1e-3..1e4).contains(&value.abs()) {
        return number(value);
    }
    let decimals = (2 - value.abs().log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Whether distributions allow to neglect inertia.
pub fn of_ensemble(found: &ClosedLoop) -> Answer {
    let differs = found.measures.iter().any(|measure| measure.inertia_effect.differs());
    let is_equal = found.measures.iter().filter(|measure| measure.is_there()).all(|measure| measure.inertia_effect.is_equal);
    match found.verdict {
        Verdict::NotComputed | Verdict::Decorrelated => Answer::Open,
        _ if differs => Answer::No,
        _ if is_equal => Answer::Yes,
        _ => Answer::Open,
    }
}

pub fn sentence_of_ensemble(found: &ClosedLoop) -> String {
    let seeds = format!("{} paired seed{}", found.n_seeds, if found.n_seeds == 1 { "" } else { "s" });
    if found.verdict == Verdict::NotComputed {
        return "What inertia does in the closed loop cannot be told: a run failed.".to_owned();
    }
    match of_ensemble(found) {
        Answer::No => {
            let shifted: Vec<String> = found.measures.iter().filter(|measure| measure.inertia_effect.differs()).map(shift).collect();
            format!("In the closed loop, over {seeds}, inertia shifts {}.", shifted.join("; "))
        }
        Answer::Yes => format!("In the closed loop, over {seeds}, inertia shifts no measure by more than 5 %."),
        _ => {
            let example = found.measures.first().filter(|measure| measure.inertia_effect.interval.is_some()).map(shift);
            let example = example.map_or(String::new(), |shift| format!(": {shift}"));
            format!(
                "In the closed loop {seeds} are too few to tell whether inertia shifts what is measured{example}. More seeds would tell."
            )
        }
    }
}

fn shift(measure: &Measure) -> String {
    let (name, unit) = named(measure.name);
    let effect = &measure.inertia_effect;
    let range = effect.interval.map(|interval| {
        let [low, high] = [interval.low, interval.high].map(|end| quantity(end, unit));
        format!(" ({} % interval {low} to {high})", short(100.0 * effect.level))
    });
    format!("{name} by {}{}", quantity(effect.mean, unit), range.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::compare::{Settings, closed_loop, prescribed};
    use crate::scenario::Scenario;

    fn compared(text: &str) -> Pathwise {
        prescribed(&Scenario::parse(text, "a scene").unwrap(), &Settings::default(), |_| true).unwrap()
    }

    /// Of fewer than 56 seeds, all of which fail to arrive, nobody can say that the share is known to 5 %.
    #[test]
    fn a_nest_that_nobody_reaches_does_not_leave_the_answer_open() {
        let mut scenario = Scenario::parse(include_str!("../../../scenarios/paper/four-ants-four-springs.json"), "four ants").unwrap();
        scenario.system.ground.friction_coefficient *= 40.0;
        scenario.duration = 1.0;
        let found = closed_loop(&scenario, &Settings::default(), 56, |_| true).unwrap();
        assert_eq!((found.verdict, of_ensemble(&found)), (Verdict::Agree, Answer::Yes));
        assert_eq!(sentence_of_ensemble(&found), "In the closed loop, over 56 paired seeds, inertia shifts no measure by more than 5 %.");
    }

    /// A load let go at 2.5 times its slip limit overshoots by as much as it goes without inertia; one held below the limit stays.
    #[test]
    fn the_first_sentence_answers_the_question() {
        let mut found = compared(include_str!("../../../scenarios/analytic/release-jump.json"));
        let sentence = sentence_of_paths(&found);
        assert_eq!(of_paths(&found), Answer::No);
        assert!(sentence.starts_with("Quasi-static is NOT justified on this scene: inertia moves the load's rim by up to "), "{sentence}");
        assert!(sentence.contains(" Up to 1 % (") && sentence.ends_with(", after the release of spring 1."), "{sentence}");
        // On both sides of what counts as agreement, a hair away.
        let tolerance = found.tolerance_m;
        for (range, answer, says) in [
            ([0.0, tolerance], Answer::Yes, "is justified"),
            ([tolerance, 1.001 * tolerance], Answer::Open, "cannot be told"),
            ([1.001 * tolerance, 1.002 * tolerance], Answer::No, "is NOT justified"),
        ] {
            found.rim.inertia_range_m = range;
            assert_eq!(of_paths(&found), answer);
            assert!(sentence_of_paths(&found).contains(says), "{says}");
        }
        found.verdict = Verdict::NotComputed;
        assert_eq!((of_paths(&found), engine_sentence(&found)), (Answer::Open, String::new()));
        assert!(sentence_of_paths(&found).ends_with("cannot be told: a run failed."));
    }

    #[test]
    fn a_load_that_stays_has_no_shares_of_its_way() {
        let found = compared(include_str!("../../../scenarios/stress/hold-below-limit.json"));
        assert_eq!(of_paths(&found), Answer::Yes);
        let sentences = [sentence_of_paths(&found), engine_sentence(&found)];
        assert_eq!(sentences[0], "Quasi-static is justified on this scene: inertia does not move the load at all.");
        assert!(!sentences[1].contains('%') && !sentences[1].contains("NaN"), "{}", sentences[1]);
    }

    #[test]
    fn percentages_have_three_digits_and_no_idle_zeros() {
        for (value, text) in
            [(1.0, "1"), (1.3533, "1.35"), (0.0996, "0.0996"), (10.0, "10"), (123.4, "123"), (0.5, "0.5"), (1e-5, "1.000e-5")]
        {
            assert_eq!(short(value), text);
        }
    }
}
