//! Warnings of long runs, before they start.

use super::console;
use cohaul::analysis::{CostLimit, ExpectedCost, fastest_rate};
use cohaul::scenario::{Finding, Scenario};
use cohaul_report::progress::LONG;
use cohaul_report::quantity::{short, short_quantity};

/// Warns of a command that is expected to take long, with what would make it cheaper.
pub fn warn_of_cost(command: &str, scenario: &Scenario, cost: &ExpectedCost) {
    if let Some(found) = long_run(command, scenario, cost) {
        console::warn(format_args!("{}; {}", found.found, found.rule));
    }
}

/// The expected cost of a command as a finding, if the command is expected to take long.
pub fn long_run(command: &str, scenario: &Scenario, cost: &ExpectedCost) -> Option<Finding> {
    if cost.time_s <= LONG {
        return None;
    }
    let (path, limit, cheaper) = match cost.limit {
        CostLimit::ControlPeriod => {
            ("control_period_s", "at least one in each control period".to_owned(), "a longer control period or a shorter duration")
        }
        CostLimit::Step => ("duration_s", "as many as the step demands".to_owned(), "a longer step (--step-s) or a shorter duration"),
        CostLimit::Ants => {
            let limit = "and in each control period every ant looks about".to_owned();
            ("drive.n_ants", limit, "fewer ants, a longer control period or a shorter duration")
        }
        CostLimit::Oscillation => {
            let rate = short_quantity(fastest_rate(scenario), "rad/s");
            let limit = format!("one for every two radians of the fastest oscillation, {rate}");
            ("springs", limit, "softer springs, a larger mass, a shorter duration or a run at a fixed step (--step-s)")
        }
    };
    Some(Finding {
        path: path.to_owned(),
        rule: format!("it is cheaper with {cheaper}"),
        found: format!(
            "`cohaul {command}` may take {} on one core: {} steps, {limit}",
            duration_in_words(cost.time_s),
            short(cost.n_steps)
        ),
    })
}

/// A time in words, to one or two digits (s).
pub fn duration_in_words(time: f64) -> String {
    const UNITS: [(f64, &str); 3] = [(86_400.0, "days"), (3600.0, "hours"), (60.0, "minutes")];
    let unit = UNITS.into_iter().find(|(length, _)| time >= 2.0 * length);
    let (length, name) = unit.unwrap_or((1.0, "seconds"));
    let n = time / length;
    if n < 1000.0 { format!("{n:.0} {name}") } else { format!("{n:.0e} {name}") }
}
