//! Figures of one run as in the paper: series with their change of mean, times of change, snapshots
//! and path.

use std::f64::consts::TAU;

use crate::paper::style::{OTHER, OURS, PRINTED};
use crate::paper::{At, Change, Changes, RunFacts, Series, Shown, Snapshot, WINDOW_S};
use cohaul::math::{Vec2, direction};
use cohaul_report::chart::MILLI;
use cohaul_report::chart::panel::{Across, Curve, Entry, Mark, Panel, Scale, Shape, Style};
use cohaul_report::quantity::number;

const BEFORE: Style = Style { color: "#000000", dash: "", width: 1.6 };

/// Speed, turn rate and interaction over time, each with its best change of mean, and the times of
/// change of all runs.
pub fn transition(shown: &Shown, runs: &[&RunFacts]) -> (Vec<Panel>, Vec<Entry>) {
    let panels = [over_time(&shown.series, &shown.changes, shown.window_s).to_vec(), vec![when(runs)]].concat();
    let trial = shown.trial.map_or(String::new(), |trial| format!(", trial {}", trial.name()));
    let entries = vec![
        Entry::line(format!("means over {} s{trial}, seed {}", number(WINDOW_S), shown.seed), OURS),
        Entry::line("two means", BEFORE),
        Entry::upright("likeliest change", PRINTED),
        Entry::line("d: speed", OURS),
        Entry::line("turn rate", OTHER),
        Entry::line("interaction", BEFORE),
    ];
    (panels, entries)
}

/// Speed, turn rate and interaction over time, each with its best change of mean within a `window`
/// of time (s).
pub(crate) fn over_time(series: &Series, changes: &Changes, window: [f64; 2]) -> [Panel; 3] {
    [
        one_over_time("load speed (mm/s)", (series, &series.speed, MILLI), &changes.speed, window),
        one_over_time("turn rate (rad/s)", (series, &series.turn_rate, 1.0), &changes.turn_rate, window),
        one_over_time("interaction forces (mN)", (series, &series.interaction, MILLI), &changes.interaction, window),
    ]
}

/// One of the series with its values and their factor to the unit of the label.
fn one_over_time(label: &str, (of, values, unit): (&Series, &[f64], f64), change: &Option<At<Change>>, [from, to]: [f64; 2]) -> Panel {
    let start = of.start_s;
    let mut panel = Panel::new("time (s)", label, Scale::FromZero);
    let points = values.iter().enumerate().map(|(at, value)| [start + of.window_s * (at as f64 + 0.5), unit * value]).collect();
    panel.curves.push(Curve::new(points, OURS, Shape::Graph));
    if let Some(At { time_s, change }) = change {
        panel.marks.push(Mark { at: Across::Vertical(*time_s), style: PRINTED });
        panel.curves.push(Curve::new(vec![[from, unit * change.mean_before], [*time_s, unit * change.mean_before]], BEFORE, Shape::Path));
        panel.curves.push(Curve::new(vec![[*time_s, unit * change.mean_after], [to, unit * change.mean_after]], BEFORE, Shape::Path));
        let what = if change.is_significant() { "change" } else { "no change beyond chance: likeliest" };
        panel.note = Some(format!("{what} at {} s, p = {}", number(*time_s), number(change.p_value)));
    }
    panel
}

/// Share of runs whose change is significant and has come, over the time of the run.
fn when(runs: &[&RunFacts]) -> Panel {
    let mut panel = Panel::new("time over that of the run (1)", "runs with a change (1)", Scale::FromZero);
    panel.curves.push(Curve::new(vec![[0.0, 0.0], [1.0, 1.0]], OURS, Shape::Unseen));
    for ((_, change), style) in Changes::OF_SERIES.into_iter().zip([OURS, OTHER, BEFORE]) {
        let found = runs.iter().filter_map(|run| Some((change(&run.changes)?, run.time_s)));
        let significant = found.filter(|(at, _)| at.change.is_significant());
        let mut shares: Vec<f64> = significant.map(|(at, duration)| at.time_s / duration).collect();
        shares.sort_by(f64::total_cmp);
        let n = runs.len().max(1) as f64;
        let steps = shares.iter().enumerate().map(|(at, share)| [*share, (at + 1) as f64 / n]);
        let points: Vec<[f64; 2]> = std::iter::once([0.0, 0.0]).chain(steps).chain([[1.0, shares.len() as f64 / n]]).collect();
        panel.curves.push(Curve::new(points, style, Shape::Steps));
    }
    panel.marks.push(Mark { at: Across::Horizontal(0.05), style: Style { dash: "2 2.5", ..PRINTED } });
    panel.note = Some(format!("{} runs; dotted: by chance alone", runs.len()));
    panel
}

const SPRING: Style = Style { color: "#999999", dash: "", width: 1.0 };
const HELD: Style = Style { color: "#D55E00", dash: "", width: 1.6 };
const LOAD: Style = Style { color: "#000000", dash: "", width: 1.4 };
const ANT: Style = Style { color: "#0072B2", dash: "", width: 1.2 };
/// What is drawn around the load in a snapshot (m).
const VIEW: f64 = 0.1;
/// Length of an ant's body behind its mandibles (m): a sign, not a size.
const BODY: f64 = 0.01;

/// Load, springs and ants at some instants.
pub fn snapshots(shown: &Shown) -> (Vec<Panel>, Vec<Entry>) {
    let entries = vec![
        Entry::line("load", LOAD),
        Entry::line("free spring", SPRING),
        Entry::line("attached spring", HELD),
        Entry::line("ant, dot at its mandibles", ANT),
        Entry::line("nest", Style::NEST),
    ];
    (shown.snapshots.iter().map(|snapshot| view(snapshot, shown)).collect(), entries)
}

fn view(snapshot: &Snapshot, shown: &Shown) -> Panel {
    let mut panel = Panel::new("x (mm)", "y (mm)", Scale::Plane);
    let centre = snapshot.load.position;
    let is_seen = |point: &Vec2| (point - centre).amax() <= VIEW;
    let corners = [Vec2::new(VIEW, VIEW), Vec2::new(-VIEW, -VIEW)].map(|corner| mm(centre + corner));
    panel.curves.push(Curve::new(corners.to_vec(), SPRING, Shape::Unseen));
    if is_seen(&shown.nest) {
        panel.curves.push(circle(shown.nest, shown.arrival_radius, Style::NEST));
    }
    panel.curves.extend(outline(snapshot, shown, LOAD));
    for ([root, tip], is_held) in &snapshot.springs {
        panel.curves.push(Curve::new(vec![mm(*root), mm(*tip)], if *is_held { HELD } else { SPRING }, Shape::Path));
    }
    let in_view: Vec<_> = snapshot.ants.iter().filter(|ant| is_seen(&ant.position)).collect();
    for ant in &in_view {
        let tail = ant.position - BODY * direction(ant.heading);
        panel.curves.push(Curve::new(vec![mm(ant.position), mm(tail)], ANT, Shape::Path));
        panel.curves.push(Curve::new(vec![mm(ant.position)], ANT, Shape::Dots));
    }
    panel.note = Some(format!("{} s, {} pull", number(snapshot.time), snapshot.n_pulling));
    panel
}

/// The path of the load, its outlines at the snapshots, and the nest.
pub fn path(shown: &Shown) -> Panel {
    let mut panel = Panel::new("x (mm)", "y (mm)", Scale::Plane);
    panel.curves.push(circle(shown.nest, shown.arrival_radius, Style::NEST));
    panel.curves.push(Curve::new(shown.path.iter().map(|point| mm(*point)).collect(), OURS, Shape::Path));
    for snapshot in &shown.snapshots {
        panel.curves.extend(outline(snapshot, shown, LOAD.thin()));
    }
    panel
}

/// The load and its heading.
fn outline(snapshot: &Snapshot, shown: &Shown, style: Style) -> [Curve; 2] {
    let (centre, radius) = (snapshot.load.position, shown.load_radius);
    let rim = centre + radius * direction(snapshot.load.heading);
    [circle(centre, radius, style), Curve::new(vec![mm(centre), mm(rim)], style, Shape::Path)]
}

fn circle(centre: Vec2, radius: f64, style: Style) -> Curve {
    Curve::new((0..=72).map(|k| mm(centre + radius * direction(TAU * f64::from(k) / 72.0))).collect(), style, Shape::Path)
}

fn mm(point: Vec2) -> [f64; 2] {
    [MILLI * point.x, MILLI * point.y]
}
