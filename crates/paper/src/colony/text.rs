//! Results of a colony as text and as tables.

use super::ants::FittedKey;
use super::report::{Colony, Quantity, Speed};
use cohaul::backend::Status;
use cohaul_report::quantity::{quantity, short_quantity};
use cohaul_report::table::{Table, wrapped};
use cohaul_report::text::WIDTH;

/// What the command prints: the answer, the fitted ants, the numbers, and what to mind.
pub fn colony_text(found: &Colony) -> String {
    let facts = &found.recording;
    let frames =
        format!("{} frames, {} apart, up to {} pulling ants", facts.n_frames, quantity(facts.frame_period_s, "s"), facts.most_held);
    let mut text = format!("{}\n\nrecording\n  {frames}\n", wrapped(&found.answer, 0, WIDTH));
    text += &format!("fitted ants (95 % intervals)\n{}", keys(&found.keys).text());
    text += &format!("beside the runs of the fitted ants and the paper\n{}", quantities(&found.quantities).text());
    text += &format!("load speed by the number of pulling ants (Fig. 9)\n{}", group_sizes(found).text());
    text += &format!("changes of mean (Fig. 11)\n{}", changes(found).text());
    text += &format!("runs of the fitted ants\n{}", backends(found).text());
    text
}

fn number(value: Option<f64>, unit: &str) -> String {
    value.map_or("-".to_owned(), |value| short_quantity(value, unit))
}

fn limits(key: &FittedKey) -> String {
    match (key.low, key.high) {
        (Some(low), Some(high)) => format!("{} to {}", quantity(low, key.unit), quantity(high, key.unit)),
        (Some(low), None) => format!("{} or more", quantity(low, key.unit)),
        (None, Some(high)) => format!("{} or less", quantity(high, key.unit)),
        (None, None) => "not determined".to_owned(),
    }
}

/// Fitted values beside those of the given scenario and of the paper.
pub(super) fn keys(keys: &[FittedKey]) -> Table {
    let rows = keys.iter().map(|key| {
        let shown = |value: Option<f64>| number(value, key.unit);
        [key.symbol.to_owned(), quantity(key.value, key.unit), limits(key), shown(Some(key.given)), shown(key.printed)]
    });
    Table::new("Fitted ants", ["", "fitted", "interval", "scenario", "paper"]).with_rows(rows)
}

/// Numbers of the recording beside those of the runs and of the paper.
pub(super) fn quantities(all: &[Quantity]) -> Table {
    let rows = all.iter().map(|of| {
        let range = of
            .fitted_95
            .map_or("-".to_owned(), |range| format!("{} to {}", short_quantity(range.low, of.unit), short_quantity(range.high, of.unit)));
        let within = of.is_within.map_or("", |is_within| if is_within { "" } else { "*" });
        let paper = match (of.paper_measured, of.paper_simulated) {
            (None, None) => "-".to_owned(),
            (measured, simulated) => format!("{} / {}", number(measured, of.unit), number(simulated, of.unit)),
        };
        [of.name.to_owned(), format!("{}{within}", number(of.recorded, of.unit)), range, paper]
    });
    Table::new("Recording, runs and paper", ["", "recorded", "95 % of runs", "paper: ants / simulated"]).with_rows(rows)
}

/// Load speed, its standard deviation, and the share of the time.
fn speed(of: &Option<Speed>) -> [String; 3] {
    let shown = |value: fn(&Speed) -> f64, unit| number(of.as_ref().map(value), unit);
    [shown(|of| of.mean_m_per_s, "m/s"), shown(|of| of.sd_m_per_s, "m/s"), shown(|of| of.share, "")]
}

/// Load speed with its standard deviation, and the share of the time.
pub(super) fn group_sizes(found: &Colony) -> Table {
    let rows = found
        .group_size
        .iter()
        .map(|of| [vec![of.n_pulling.to_string()], speed(&of.recorded).to_vec(), speed(&of.fitted).to_vec()].concat());
    Table::new("Load speed by group size", ["pulling", "recorded", "sd", "time", "fitted ants", "sd", "time"]).with_rows(rows)
}

/// The likeliest change of each series of the recording.
pub(super) fn changes(found: &Colony) -> Table {
    let of = &found.changes;
    let row = |(name, unit, change, paper): (&str, &str, Option<_>, &str)| {
        let change: Option<crate::paper::At<crate::paper::Change>> = change;
        let at = change.map_or("-".to_owned(), |at| quantity(at.time_s, "s"));
        let means = change.map_or("too short to tell".to_owned(), |at| {
            format!("{} to {}", short_quantity(at.change.mean_before, unit), short_quantity(at.change.mean_after, unit))
        });
        let p = change.map_or("-".to_owned(), |at| short_quantity(at.change.p_value, ""));
        [name.to_owned(), at, means, p, paper.to_owned()]
    };
    let all = [
        ("load speed", "m/s", of.speed, "rises"),
        ("turn rate", "rad/s", of.turn_rate, "rises"),
        ("interaction", "N", of.interaction, "falls to half"),
    ];
    Table::new("Changes of mean", ["", "at", "from ... to", "p", "paper"]).with_rows(all.map(row))
}

fn status(status: Status) -> &'static str {
    match status {
        Status::Converged => "converged",
        Status::NotConverged => "not converged",
        Status::Failed => "failed",
    }
}

/// Runs of each backend.
pub(super) fn backends(found: &Colony) -> Table {
    let rows = found.backends.iter().map(|of| {
        [
            of.backend.name().to_owned(),
            of.n_runs.to_string(),
            of.n_arrived.to_string(),
            status(of.status).to_owned(),
            short_quantity(of.pull_mean_n, "N"),
            short_quantity(of.load_speed_m_per_s, "m/s"),
        ]
    });
    Table::new("Runs of the fitted ants", ["backend", "runs", "arrived", "status", "mean pull", "load speed"]).with_rows(rows)
}
