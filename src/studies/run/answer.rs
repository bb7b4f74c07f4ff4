//! The answer of a run: where the load ended, and whether inertia is negligible.

use crate::analysis::estimate::{InertiaEstimate, TOLERANCE_SHARE};
use crate::backend::Status;
use crate::output::page::Answer;
use crate::output::quantity::{short, short_quantity};
use crate::simulation::run_facts::Run;

/// Whether the estimate calls inertia negligible; [`Answer::None`] without an estimate.
pub fn is_negligible(run: &Run, estimate: Option<&InertiaEstimate>) -> Answer {
    match estimate {
        _ if run.outcome.steps.status == Status::Failed => Answer::Open,
        None => Answer::None,
        Some(estimate) => match estimate.is_negligible {
            Some(true) => Answer::Yes,
            Some(false) => Answer::No,
            None => Answer::Open,
        },
    }
}

pub fn sentence(run: &Run, estimate: Option<&InertiaEstimate>) -> String {
    let inertia = estimate.map_or(String::new(), |estimate| format!(" {}", inertia_sentence(estimate)));
    format!("{}{inertia}", end_sentence(run))
}

fn end_sentence(run: &Run) -> String {
    let (outcome, steps) = (run.outcome, &run.outcome.steps);
    let time = short_quantity(outcome.time, "s");
    if steps.status == Status::Failed {
        return format!("The run failed: a step had no finite solution, so that the result at {time} is not valid.");
    }
    let [x, y] = [0, 1].map(|axis| short_quantity(outcome.motion.pose.position[axis], "m"));
    let end = match outcome.arrived {
        Some(true) => format!("The load reached the nest after {time} at ({x}, {y})"),
        Some(false) => format!("The load did not reach the nest within {time} and ended at ({x}, {y})"),
        None => format!("The load ended at ({x}, {y}) after {time}"),
    };
    match steps.n_not_converged {
        0 => format!("{end}; all {} steps converged.", steps.n_steps),
        n => format!("{end}; {n} of {} steps did not converge.", steps.n_steps),
    }
}

fn inertia_sentence(estimate: &InertiaEstimate) -> String {
    let effect = short_quantity(estimate.edge_displacement_max_m, "m");
    if estimate.touches_obstacle {
        return "Whether inertia is negligible is not known: the load touches an obstacle, and the inertia estimate has none.".to_owned();
    }
    if estimate.is_invalid {
        return "Inertia is not negligible: with it the load turns further than the inertia estimate can follow.".to_owned();
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
