//! The answer of a comparison: for which quantities the quasi-static backend is valid, and where
//! the engine error exceeds a tolerance.

use crate::compare::doubt;
use cohaul::analysis::compare::{Cause, ClosedLoop, EngineAnswer, InertiaAnswer, Measure, Pathwise};
use cohaul::analysis::compare::{QuantityVerdict, RunMeasure, Solution, Verdict};
use cohaul::backend::Status;
use cohaul_report::page::Answer;
use cohaul_report::quantity::of_run::short_quantity;
use cohaul_report::quantity::short;

/// Whether quasi-static is valid: for all quantities, for the path but not for all, or not for the
/// path.
pub fn of_paths(found: &Pathwise) -> Answer {
    let answers = found.verdicts.named().map(|(_, of)| is_valid(of));
    match answers[0] {
        _ if found.verdict == Verdict::NothingMoved => Answer::Open,
        Answer::Yes if answers.iter().any(|of| *of != Answer::Yes) => Answer::Partly,
        path => path,
    }
}

/// Whether the inertia effect on a quantity is within its tolerance. A load that never moves has
/// none.
pub fn is_valid(of: &QuantityVerdict) -> Answer {
    match of.inertia {
        InertiaAnswer::Negligible | InertiaAnswer::NothingMoved => Answer::Yes,
        InertiaAnswer::NotNegligible => Answer::No,
        InertiaAnswer::Open => Answer::Open,
    }
}

/// The verdict on a quantity in words: the causes of what exceeds a tolerance, or that nothing
/// does. What is left open beside a cause is said.
pub fn verdict_text(of: &QuantityVerdict) -> String {
    words_of(of, [true; 2])
}

/// The verdict in words, of the inertia effect, of the engine error, or of both.
pub fn words_of(of: &QuantityVerdict, [inertia, engine]: [bool; 2]) -> String {
    let is_of = |cause: &&Cause| if cause.is_of_engine() { engine } else { inertia };
    let mut words: Vec<&str> = of.causes.iter().filter(is_of).map(|cause| cause.text()).collect();
    if inertia && engine && (words.is_empty() || of.verdict == Verdict::Inconclusive) {
        words.insert(0, of.verdict.text());
        return words.join(", ");
    }
    words.extend((inertia && of.inertia == InertiaAnswer::Open).then_some("inertia open"));
    words.extend((engine && of.engine == EngineAnswer::Open).then_some("engine open"));
    words.join(", ")
}

fn engine_is_within(of: &QuantityVerdict) -> Answer {
    match of.engine {
        EngineAnswer::Within => Answer::Yes,
        EngineAnswer::NotWithin => Answer::No,
        EngineAnswer::Open => Answer::Open,
    }
}

/// The answer from paths, in words: the quantities for which quasi-static is valid and those for
/// which it is not, then the engine error.
pub fn sentence_of_paths(found: &Pathwise) -> String {
    const UNKNOWN: &str = "It is not known whether quasi-static is valid here";
    if found.verdict == Verdict::NotComputed {
        return format!("{UNKNOWN}, because {}.", failed_runs(found));
    }
    if let Some(why) = doubt::of_paths(found) {
        let known = known_sentences(found);
        return match known.is_empty() {
            true => format!("{UNKNOWN}, nor what the engine error is: the comparison is inconclusive, because {why}."),
            false => format!("{} All else is inconclusive, because {why}.", known.join(" ")),
        };
    }
    let inertia = if found.verdict == Verdict::NothingMoved { nothing_moved(found) } else { inertia_sentence(found) };
    format!("{inertia} {}", engine_sentence(found))
}

/// What is known in spite of a doubt: differences beyond the tolerance before it.
fn known_sentences(found: &Pathwise) -> Vec<String> {
    let is_known = |of: fn(&QuantityVerdict) -> Answer| found.verdicts.shown().any(|(_, verdict)| of(verdict) == Answer::No);
    let inertia = is_known(is_valid).then(|| format!("Quasi-static is not valid for {}.", list(&with_answer(found, Answer::No, |_| true))));
    let engine = is_known(engine_is_within)
        .then(|| format!("The engine error of {} exceeds the tolerance for {}.", found.engine.name, beyond(found)));
    inertia.into_iter().chain(engine).collect()
}

/// Which runs failed and when, in words.
pub fn failed_runs(found: &Pathwise) -> String {
    let failed = found.named_runs().filter(|(_, solution)| solution.steps.status == Status::Failed);
    let in_words = |(name, solution): (&str, &Solution)| {
        let time = solution.failed_at.map(|time| format!(" at {}", short_quantity(time, "s")));
        format!("the {name} run failed{}", time.unwrap_or_default())
    };
    let mut failed: Vec<String> = failed.map(in_words).collect();
    // Without an engine the inertial run stands for two.
    failed.dedup();
    format!("{}: a step had no finite solution", list(&failed))
}

fn nothing_moved(found: &Pathwise) -> String {
    let is_pulled = found.verdicts.pulls.measures.iter().any(|measure| measure.quasi_static.max(measure.inertial) > 0.0);
    let pull = match found.largest_pull_over_slip_limit {
        Some(0.0) => "nothing pulls the load".to_owned(),
        Some(share) => format!("the largest net pull is {} % of the slip limit", short(100.0 * share)),
        None if is_pulled => "there is no friction".to_owned(),
        None => "there is no friction, and nothing pulls the load".to_owned(),
    };
    format!("Nothing moved: no answer; {pull}.")
}

fn inertia_sentence(found: &Pathwise) -> String {
    let [valid, not_valid] = [Answer::Yes, Answer::No].map(|answer| list(&with_answer(found, answer, |_| true)));
    let [open, not_unique] = [false, true].map(|is| list(&with_answer(found, Answer::Open, |of| is_not_unique(of) == is)));
    let sentence = match (is_valid(&found.verdicts.path), valid.is_empty(), not_valid.is_empty()) {
        (Answer::Yes, _, true) => format!("Quasi-static is valid for {valid}"),
        (Answer::Yes, _, false) => format!("Quasi-static is valid for {valid} but not for {not_valid}"),
        (_, true, true) => "It is not known whether quasi-static is valid here".to_owned(),
        (_, true, false) => format!("Quasi-static is not valid for {not_valid}"),
        (_, false, true) => format!("Quasi-static is valid for {valid}"),
        (_, false, false) => format!("Quasi-static is not valid for {not_valid}; it is valid for {valid}"),
    };
    let causes = causes_beside_inertia(found);
    let open = if open.is_empty() { open } else { format!(" Too close to the tolerance for the reference error: {open}.") };
    let not_unique = if not_unique.is_empty() { not_unique } else { format!(" Not determined by the laws: {not_unique}.") };
    format!("{sentence}.{causes}{open}{not_unique}")
}

/// Whether other answers of the runs are as right.
fn is_not_unique(of: &QuantityVerdict) -> bool {
    of.causes.contains(&Cause::NotUnique)
}

/// What causes the inertia effect where it is not inertia alone, as a sentence.
fn causes_beside_inertia(found: &Pathwise) -> String {
    let causes = causes(found, |cause| matches!(cause, Cause::Inertia | Cause::Impact));
    match &causes[..] {
        [only] if *only == Cause::Impact.text() => " The cause is impact.".to_owned(),
        [_, _] => format!(" The causes are {}.", list(&causes)),
        _ => String::new(),
    }
}

/// The causes of this kind in all quantities, each once.
fn causes(found: &Pathwise, is_of_kind: fn(Cause) -> bool) -> Vec<String> {
    let mut causes: Vec<Cause> = found.verdicts.shown().flat_map(|(_, of)| of.causes.clone()).filter(|cause| is_of_kind(*cause)).collect();
    causes.sort_unstable();
    causes.dedup();
    causes.into_iter().map(|cause| cause.text().to_owned()).collect()
}

/// The quantities with this answer that are of a kind, in words.
fn with_answer(found: &Pathwise, answer: Answer, is_of_kind: impl Fn(&QuantityVerdict) -> bool) -> Vec<String> {
    let quantities = found.verdicts.shown().filter(|(_, of)| is_valid(of) == answer && is_of_kind(of));
    quantities.map(|(name, of)| quantity_in_words(name, of, found, answer)).collect()
}

/// A quantity, and what inertia does to it unless it is valid.
fn quantity_in_words(name: &str, of: &QuantityVerdict, found: &Pathwise, answer: Answer) -> String {
    let effect = short_quantity(of.inertia_effect, of.unit);
    match (name, of.deciding()) {
        ("path", _) => format!("the path ({effect} of {})", short_quantity(found.path_length_m, "m")),
        ("measure", Some(measure)) if answer == Answer::Yes => plural(measure),
        (_, _) if answer == Answer::Yes => in_general(name).to_owned(),
        (_, None) => format!("the {name} ({effect})"),
        (_, Some(measure)) => format!("{} ({})", plural(measure), instead(measure.inertial, measure.quasi_static, of.unit)),
    }
}

fn in_general(name: &str) -> &str {
    match name {
        "energy" => "the energy dissipated",
        "contacts" => "the contact forces",
        "heading" => "the heading",
        "path" => "the path",
        other => other,
    }
}

/// Name of a number in a sentence.
fn plural(measure: &RunMeasure) -> String {
    if measure.spring.or(measure.obstacle).is_some() { format!("{}s", measure.name) } else { format!("the {}", measure.name) }
}

/// Two values that differ, with as many digits as show it.
pub fn instead(value: f64, other: f64, unit: &str) -> String {
    format!("{} instead of {}", short_quantity(value, unit), short_quantity(other, unit))
}

/// Words as a list: `a, b and c`.
fn list(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The engine error of a comparison beside another one of the same scene, as a sentence.
pub fn sentence_of_engine(found: &Pathwise) -> String {
    if found.verdict == Verdict::NotComputed {
        return format!("The engine error of {} is not known, because {}.", found.engine.name, failed_runs(found));
    }
    match doubt::of_paths(found) {
        Some(_) if beyond(found).is_empty() => format!("The engine error of {} is inconclusive.", found.engine.name),
        Some(_) => format!("The engine error of {} exceeds the tolerance for {}.", found.engine.name, beyond(found)),
        None => engine_sentence(found),
    }
}

fn engine_sentence(found: &Pathwise) -> String {
    let (exceeds, of_engine) = (beyond(found), format!("The engine error of {}", found.engine.name));
    let open = found.verdicts.shown().filter(|(_, of)| engine_is_within(of) == Answer::Open && !is_not_unique(of));
    let open = list(&open.map(|(name, _)| in_general(name).to_owned()).collect::<Vec<_>>());
    let on_path = short_quantity(found.edge_displacement.engine_error_m, "m");
    let sentence = match (exceeds.is_empty(), open.is_empty()) {
        (true, true) => format!("{of_engine} is within all tolerances ({on_path} on the path){}", cancelling(found)),
        (true, false) => format!("{of_engine} is too close to the tolerance to decide for {open}"),
        (false, true) => format!("{of_engine} exceeds the tolerance for {exceeds}{}", by_engine(found)),
        (false, false) => {
            let by = by_engine(found);
            format!("{of_engine} exceeds the tolerance for {exceeds}{by}, and is too close to decide for {open}")
        }
    };
    format!("{sentence}.")
}

/// The parts of an engine error on the path that each exceed the tolerance and cancel, in words.
fn cancelling(found: &Pathwise) -> String {
    let parts = [&found.time_step_error, &found.model_error].map(|error| error.edge_displacement_max_m);
    let least = found.tolerance_m + found.reference_error.engine.edge_displacement_max_m;
    if parts.iter().any(|part| *part <= least) {
        return String::new();
    }
    let [step, model] = parts.map(|part| short_quantity(part, "m"));
    format!(", but its time step ({step}) and its model ({model}) cancel at this step")
}

/// What causes the engine error, in words.
fn by_engine(found: &Pathwise) -> String {
    match &causes(found, Cause::is_of_engine)[..] {
        [only] if *only == Cause::Engine.text() => ", whose parts cannot be told apart at this step".to_owned(),
        [] => String::new(),
        causes => format!(" (cause: {})", list(causes)),
    }
}

/// The quantities for which the engine error exceeds the tolerance, as a list.
fn beyond(found: &Pathwise) -> String {
    let in_words = |(name, of): (&str, &QuantityVerdict)| match of.worst_of_engine() {
        None => format!("the {name} ({})", short_quantity(of.engine_error, of.unit)),
        Some(measure) => format!("{} ({})", plural(measure), instead(measure.engine, measure.inertial, of.unit)),
    };
    list(&found.verdicts.shown().filter(|(_, of)| engine_is_within(of) == Answer::No).map(in_words).collect::<Vec<_>>())
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
        _ if !found.doubts.is_empty() => Answer::Open,
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
    if let Some(why) = doubt::of_ensemble(found) {
        return format!("It is not known what inertia changes in the closed loop: the comparison is inconclusive, because {why}.");
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
        _ => {
            let enough = match found.n_seeds_needed {
                Some(n) => format!("about {} would do", rounded_up(n)),
                None => "at least 2 are needed to tell how many would do".to_owned(),
            };
            format!("Too few seeds: {seeds} do not tell what inertia changes in the closed loop; {enough}.")
        }
    }
}

/// A number of seeds, rounded up to two digits: means and spreads of few seeds say no more.
pub fn rounded_up(n: u64) -> u64 {
    let unit = 10u64.pow(n.max(1).ilog10().saturating_sub(1));
    n.div_ceil(unit) * unit
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
    use cohaul::analysis::compare::{Answers, Settings, ThreeWay};
    use cohaul::scenario::Scenario;

    fn compared(text: &str) -> Pathwise {
        ThreeWay::new(&Scenario::parse(text, "a scene").unwrap(), &Settings::default()).prescribed(|_| true).unwrap()
    }

    #[test]
    fn numbers_of_seeds_are_rounded_up_to_two_digits() {
        assert_eq!([1, 9, 10, 56, 100, 101, 1234].map(rounded_up), [1, 9, 10, 56, 100, 110, 1300]);
    }

    /// 56 seeds that all fail to arrive are the fewest for which the fraction is known to 5 %.
    #[test]
    fn a_nest_that_no_run_reaches_does_not_leave_the_answer_open() {
        let mut scenario = Scenario::parse(include_str!("../../../../scenarios/paper/four-ants-four-springs.json"), "four ants").unwrap();
        scenario.system.ground.friction_coefficient *= 40.0;
        scenario.duration = 1.0;
        let found = ThreeWay::new(&scenario, &Settings::default()).closed_loop(56, |_| true).unwrap();
        assert_eq!((found.verdict, of_ensemble(&found)), (Verdict::Agree, Answer::Yes));
        let expected = "Inertia changes no measure of the closed loop by more than 5 %, over 56 paired seeds.";
        assert_eq!(sentence_of_ensemble(&found), expected);
        assert_eq!(found.n_seeds_needed, None);
        // Fewer seeds say so.
        let found = ThreeWay::new(&scenario, &Settings::default()).closed_loop(4, |_| true).unwrap();
        let expected = "Too few seeds: 4 paired seeds do not tell what inertia changes in the closed loop; about 56 would do.";
        assert_eq!(sentence_of_ensemble(&found), expected);
    }

    /// A load that is released at 2.5 times its slip limit overshoots by its displacement without
    /// inertia.
    #[test]
    fn the_first_sentence_answers_the_question() {
        let mut found = compared(include_str!("../../../../scenarios/analytic/release-jump.json"));
        let sentence = sentence_of_paths(&found);
        assert_eq!(of_paths(&found), Answer::No);
        assert!(sentence.starts_with("Quasi-static is not valid for the path ("), "{sentence}");
        // Just below and just above the tolerance.
        let tolerance = found.verdicts.path.tolerance;
        for (effect, answer, says) in [
            (0.9 * tolerance, Answer::Partly, "Quasi-static is valid for the path ("),
            (tolerance, Answer::Open, "Quasi-static is not valid for "),
            (1.1 * tolerance, Answer::No, "Quasi-static is not valid for the path ("),
        ] {
            let path = &mut found.verdicts.path;
            (path.inertia_effect, path.reference_error) = (effect, 1e-3 * tolerance);
            path.inertia = Answers::of([path.inertia_share_range(), path.engine_share_range()]).inertia;
            assert_eq!(of_paths(&found), answer);
            let sentence = sentence_of_paths(&found);
            assert!(sentence.starts_with(says), "{sentence}");
            assert_eq!(sentence.contains("Too close to the tolerance"), answer == Answer::Open, "{sentence}");
        }
        found.verdicts.path.inertia = InertiaAnswer::Open;
        found.verdict = Verdict::NotComputed;
        (found.solutions[2].steps.status, found.solutions[2].failed_at) = (Status::Failed, Some(0.25));
        assert_eq!(of_paths(&found), Answer::Open);
        let sentence = sentence_of_paths(&found);
        assert!(sentence.ends_with(" because the rapier run failed at 250 ms: a step had no finite solution."), "{sentence}");
        found.solutions[0].steps.status = Status::Failed;
        let sentence = sentence_of_paths(&found);
        assert!(sentence.contains(" because the quasi-static run failed and the rapier run failed at 250 ms: "), "{sentence}");
    }

    #[test]
    fn a_load_without_springs_has_no_verdict_on_pulls() {
        let found = compared(include_str!("../../../../scenarios/contact/pusher.json"));
        assert_eq!(found.verdicts.shown().map(|(name, _)| name).collect::<Vec<_>>(), ["path", "heading", "contacts", "speed", "energy"]);
        let sentence = sentence_of_paths(&found);
        assert!(sentence.contains("valid for") && !sentence.contains("pulls"), "{sentence}");
    }

    #[test]
    fn a_load_at_a_wall_on_ice_is_pulled_and_does_not_move() {
        let text = r#"{ "name": "ice", "duration_s": 0.1, "control_period_s": 0.005, "load": { "mass_kg": 1, "radius_m": 0.1 },
            "ground": { "friction_coefficient": 0, "supports": { "tripod": { "radius_m": 0.07 } } },
            "springs": [{ "root_m": [0, 0], "bearing_rad": 0, "rest_length_m": 0, "radial_stiffness_n_per_m": 100, "torsional_stiffness_nm_per_rad": 0 }],
            "obstacles": [{ "name": "wall", "outline": { "polyline": { "points_m": [[0.1, -0.5], [0.1, 0.5]] } } }],
            "drive": { "kind": "tips", "paths": [{ "spring": 0, "waypoints": [[0, 0, 0], [0.1, 0.1, 0]] }] } }"#;
        let sentence = sentence_of_paths(&compared(text));
        assert!(sentence.starts_with("Nothing moved: no answer; there is no friction. The engine"), "{sentence}");
    }

    #[test]
    fn a_load_at_rest_gives_no_answer_but_how_near_it_is_to_slip() {
        let found = compared(include_str!("../../../../scenarios/stress/hold-below-limit.json"));
        assert_eq!(of_paths(&found), Answer::Open);
        let sentence = sentence_of_paths(&found);
        let expected = "Nothing moved: no answer; the largest net pull is 90 % of the slip limit. The engine error";
        assert!(sentence.starts_with(expected) && !sentence.contains("NaN"), "{sentence}");
    }
}
