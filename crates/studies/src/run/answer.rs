//! The answer of a run: where the load ended, and whether inertia is negligible.

use cohaul::analysis::compare::LEAST_MOTION;
use cohaul::analysis::estimate::{InertiaEstimate, TOLERANCE_SHARE};
use cohaul::simulation::Health;
use cohaul::simulation::run_facts::Run;
use cohaul_report::account_words;
use cohaul_report::page::Answer;
use cohaul_report::quantity::of_run::short_quantity;
use cohaul_report::quantity::short;

/// Whether the estimate calls inertia negligible; [`Answer::None`] without an estimate.
pub fn is_negligible(run: &Run, estimate: Option<&InertiaEstimate>) -> Answer {
    match estimate {
        _ if run.outcome.account.health == Health::Failed => Answer::Open,
        None => Answer::None,
        Some(estimate) if nothing_moved(run, estimate) => Answer::Open,
        Some(estimate) => match estimate.is_negligible {
            Some(true) => Answer::Yes,
            Some(false) => Answer::No,
            None => Answer::Open,
        },
    }
}

pub fn sentence(run: &Run, estimate: Option<&InertiaEstimate>) -> String {
    // A failed run has no path to which an effect could be compared.
    let estimate = estimate.filter(|_| run.outcome.account.health != Health::Failed);
    let inertia = estimate.map_or(String::new(), |estimate| format!(" {}", inertia_sentence(run, estimate)));
    format!("{}{inertia}", end_sentence(run))
}

fn end_sentence(run: &Run) -> String {
    let (outcome, steps) = (run.outcome, &run.outcome.steps);
    let time = short_quantity(outcome.time, "s");
    let cause = account_words::cause(&outcome.account).unwrap_or_default();
    if outcome.account.health == Health::Failed {
        return format!("The run failed: {cause}. The result at {time} is not valid.");
    }
    let [x, y] = [0, 1].map(|axis| short_quantity(outcome.motion.pose.position[axis], "m"));
    let end = match outcome.arrived {
        Some(true) => format!("The load reached the nest after {time} at ({x}, {y})"),
        Some(false) => format!("The load did not reach the nest within {time} and ended at ({x}, {y})"),
        None => format!("The load ended at ({x}, {y}) after {time}"),
    };
    match steps.n_not_converged {
        _ if outcome.account.health == Health::Doubtful => format!("{end}. This is doubtful: {cause}."),
        0 => format!("{end}; all {} steps converged.", steps.n_steps),
        n => format!("{end}; {n} of {} steps did not converge.", steps.n_steps),
    }
}

/// Whether the load stayed at rest, with inertia by estimate and without.
fn nothing_moved(run: &Run, estimate: &InertiaEstimate) -> bool {
    estimate.path_length_m <= LEAST_MOTION * run.scenario.system.load.radius
}

/// What the estimate says of inertia.
pub fn inertia_sentence(run: &Run, estimate: &InertiaEstimate) -> String {
    let effect = short_quantity(estimate.edge_displacement_max_m, "m");
    if estimate.is_invalid {
        return "Inertia is not negligible: with it the load turns further than the inertia estimate can follow.".to_owned();
    }
    if nothing_moved(run, estimate) {
        return "Nothing moved, so that there is no answer on inertia.".to_owned();
    }
    if estimate.edge_displacement_max_m == 0.0 {
        return "Inertia is negligible: by estimate it does not move the load.".to_owned();
    }
    let (is_negligible, compared) = match estimate.is_negligible {
        Some(true) => ("Inertia is negligible", "less than"),
        Some(false) => ("Inertia is not negligible", "more than"),
        None => ("Whether inertia is negligible is not known", "too near to"),
    };
    let moves = format!("{is_negligible}: by estimate it moves the load by up to {effect} of edge displacement");
    format!("{moves}, {compared} the tolerance of {}.", tolerance(estimate))
}

/// The tolerance, and what it is a share of.
pub fn tolerance(estimate: &InertiaEstimate) -> String {
    let (share, length) = (short(100.0 * TOLERANCE_SHARE), short_quantity(estimate.path_length_m, "m"));
    format!("{} ({share} % of the {length} path length)", short_quantity(TOLERANCE_SHARE * estimate.path_length_m, "m"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::analysis::estimate::with_estimate;
    use cohaul::backend::{BackendKind, BackendOptions};
    use cohaul::scenario::Scenario;
    use cohaul::simulation::{Keep, Outcome, Simulation, controller_of};

    /// A quasi-static run with its inertia estimate.
    fn estimated(scenario: &Scenario) -> (BackendOptions, Outcome, InertiaEstimate) {
        let options = BackendOptions::at_step(None, BackendKind::QuasiStatic, &scenario.system, scenario.control_period);
        let (backend, estimator) = with_estimate(&scenario.system, scenario.start, &options);
        let mut run = Simulation::from_parts(scenario, &options, Keep::Outcome, controller_of(scenario), backend);
        run.run(|_| true);
        let estimate = estimator.borrow().estimate();
        (options, run.outcome(), estimate)
    }

    fn answered(scenario: &Scenario) -> (Answer, String) {
        let (options, outcome, estimate) = estimated(scenario);
        let run = Run { scenario, options: &options, outcome: &outcome, path_length: None, wall_time: None };
        (is_negligible(&run, Some(&estimate)), sentence(&run, Some(&estimate)))
    }

    #[test]
    fn a_failed_run_says_nothing_on_inertia() {
        let scenario = Scenario::parse(include_str!("../../../../scenarios/analytic/release-jump.json"), "released").unwrap();
        let (options, mut outcome, estimate) = estimated(&scenario);
        outcome.account.health = Health::Failed;
        let run = Run { scenario: &scenario, options: &options, outcome: &outcome, path_length: None, wall_time: None };
        let sentence = sentence(&run, Some(&estimate));
        assert!(sentence.ends_with(" is not valid."), "{sentence}");
    }

    #[test]
    fn a_load_at_rest_gives_no_answer_on_inertia() {
        let scenario = Scenario::parse(include_str!("../../../../scenarios/stress/hold-below-limit.json"), "held").unwrap();
        let (answer, sentence) = answered(&scenario);
        assert_eq!(answer, Answer::Open);
        assert!(sentence.ends_with("Nothing moved, so that there is no answer on inertia."), "{sentence}");
    }
}
