//! The closed loop of a comparison: what is measured over seeds, and one seed to watch.

use crate::analysis::compare::{ClosedLoop, Distribution, Measure};
use crate::output::chart::{self, Labelled, Scene, trace_color};
use crate::output::page::bars::{self, Spread, SpreadLine};
use crate::output::page::replay::{Replay, Shown};
use crate::output::page::{Block, Table};
use crate::output::quantity::quantity;
use crate::scenario::Scenario;
use crate::studies::compare::page::backend_names;
use crate::studies::compare::report::{named, shift};
use crate::studies::compare::sentence::sentence_of_ensemble;

pub fn blocks(found: &ClosedLoop, scenario: &Scenario) -> Vec<Block> {
    let shown: Vec<Shown> = backend_names().into_iter().zip(&found.traces).map(|(label, trace)| Shown { label, trace }).collect();
    let part = |time: Option<f64>| time.map_or("never".to_owned(), |time| format!("at {}", quantity(time, "s")));
    let parted = format!(
        "Decisions first differ from those of the inertial run {} without inertia, and {} on rapier: from there on paths say nothing.",
        part(found.decisions_part.quasi_static_s),
        part(found.decisions_part.rapier_s)
    );
    let spreads: Vec<Spread> = found.measures.iter().map(spread).collect();
    let chart = Block::Chart {
        svg: bars::spreads(&spreads),
        caption:
            "A dot a seed, the mean as an upright, its 95 % interval as a bar. Each measure has its own axis, which need not begin at zero."
                .to_owned(),
    };
    let ends = found.traces.iter().filter_map(|trace| trace.rows.last()).map(|row| row.time);
    // Well after decisions part.
    let opens_at = 0.4 * ends.fold(f64::INFINITY, f64::min).min(1e300);
    let replay = Replay::new(
        format!("One run on each backend, seed {}: each ant decides by what it meets there", found.first_seed),
        scenario,
        &shown,
        opens_at,
    );
    let labelled: Vec<Labelled> = shown.iter().map(|run| Labelled { label: run.label, trace: run.trace }).collect();
    let overview =
        Block::figure(chart::overview(&labelled, &Scene::of(scenario)), format!("The runs of seed {} over time.", found.first_seed));
    vec![
        Block::text(sentence_of_ensemble(found)),
        Block::text(parted),
        chart,
        Block::Table(shifts(found)),
        Block::Replay(Box::new(replay)),
        Block::Folded { heading: "These runs over time".to_owned(), blocks: vec![overview] },
    ]
}

fn spread(measure: &Measure) -> Spread {
    let (name, unit) = named(measure.name);
    let of = [&measure.quasi_static, &measure.inertial, &measure.rapier];
    let line = |(at, found): (usize, &Distribution)| SpreadLine {
        name: backend_names()[at].to_owned(),
        color: trace_color(at),
        values: measure.values.iter().filter_map(|values| values[at]).collect(),
        mean: if found.n > 0 { found.mean } else { f64::NAN },
        interval: found.mean_interval_95.map(|interval| [interval.low, interval.high]),
        text: if found.n > 0 { format!("{} ± {}", quantity(found.mean, unit), quantity(found.sd, unit)) } else { "none".to_owned() },
    };
    Spread { name, unit, lines: of.into_iter().enumerate().map(line).collect() }
}

fn shifts(found: &ClosedLoop) -> Table {
    let table = Table::new("Paired differences of means over seeds, with intervals", ["measure", "by inertia", "by the engine"]);
    found.measures.iter().fold(table, |table, measure| {
        let (name, unit) = named(measure.name);
        table.row([name, shift(&measure.inertia_effect, unit), shift(&measure.engine_error, unit)])
    })
}
