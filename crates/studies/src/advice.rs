//! Advice on a scenario before it runs, as text.

use cohaul::analysis::{Advice, Mode, Pull};
use cohaul::scenario::{Drive, Scenario};
use cohaul_report::quantity::{short, short_quantity};
use cohaul_report::text::Lines;

/// Most springs whose first pulls are listed one by one.
const MOST_LISTED: usize = 6;

/// The advice in labelled lines of at most 80 columns.
pub fn advice_text(scenario: &Scenario, advice: &Advice) -> String {
    let mut lines = Lines::default();
    let limits = format!("{} and {}", short_quantity(advice.slip_limit_n, "N"), short_quantity(advice.slip_torque_nm, "N m"));
    lines.row("weight", &format!("{}; the slip limit is {limits}", short_quantity(advice.weight_n, "N")));
    lines.row("frequencies", &frequencies(scenario, &advice.natural_frequencies));
    if !advice.first_pulls.is_empty() {
        lines.row("first pulls", &first_pulls(&advice.first_pulls));
    }
    let or_run = |value: Option<f64>, unit| value.map_or("known after a run".to_owned(), |value| short_quantity(value, unit));
    let numbers = &advice.numbers;
    lines.row("epsilon", &or_run(numbers.epsilon, ""));
    lines.row("Phi", &or_run(numbers.phi, "rad"));
    let times = &advice.expected_time_s;
    let of = |name: &str, time: Option<f64>| time.map_or(format!("{name} forever"), |time| format!("{name} {}", short_quantity(time, "s")));
    let runs = [of("quasi-static", times.quasi_static), of("inertial", times.inertial), of("rapier", times.rapier)].join(", ");
    lines.row("expected time", &format!("{runs}; {}", of("compare", times.compare)));
    lines.text
}

fn frequencies(scenario: &Scenario, modes: &[Mode]) -> String {
    if modes.is_empty() {
        return "none: no spring is attached and taut".to_owned();
    }
    let kind = |mode: &Mode| match mode.turning_share {
        share if share < 0.1 => "translation".to_owned(),
        share if share > 0.9 => "rotation".to_owned(),
        share => format!("{} % rotation", short(100.0 * share)),
    };
    let modes: Vec<String> = modes.iter().map(|mode| format!("{} ({})", short_quantity(mode.frequency_hz, "Hz"), kind(mode))).collect();
    let springs = match scenario.drive {
        Drive::Tips(_) => "on the springs attached first",
        Drive::Ants(_) => "on all springs",
    };
    format!("{}, {springs}", modes.join(", "))
}

fn first_pulls(pulls: &[Pull]) -> String {
    let said = |pull: &Pull| match pull.over_slip_limit {
        // A tip at rest pulls by the rounding of its position.
        Some(share) => format!("spring {}: {} of the slip limit", pull.spring, short(if share < 1e-9 { 0.0 } else { share })),
        None => format!("spring {}: {}", pull.spring, short_quantity(pull.pull_n, "N")),
    };
    if pulls.len() <= MOST_LISTED {
        return pulls.iter().map(said).collect::<Vec<_>>().join(", ");
    }
    let largest = pulls.iter().max_by(|a, b| a.pull_n.total_cmp(&b.pull_n)).expect("there are many");
    format!("at most that on {} ({} springs)", said(largest), pulls.len())
}
