//! Groups of a sweep -> panels: means with their intervals over a parameter, or the times to the
//! nest as a histogram where only seeds differ.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::sweep::{Axis, Group, Identity, Values};
use cohaul::math::Interval;
use cohaul_report::chart::panel::{Curve, Entry, Panel, Scale, Shape, Style};
use cohaul_report::chart::{COLUMN_WIDTH, PANEL_HEIGHT, grid};

/// Times to the nest by backend and step, up to so many that a histogram shows them well.
#[derive(Clone, Debug, Default)]
pub struct Times(BTreeMap<String, Vec<f64>>);

const MOST_TIMES: usize = 100_000;

impl Times {
    pub fn add(&mut self, variant: String, time: f64) {
        let times = self.0.entry(variant).or_default();
        if times.len() < MOST_TIMES {
            times.push(time);
        }
    }
}

/// A mean over seeds, and its label on an axis.
struct Shown {
    label: &'static str,
    scale: Scale,
    of: fn(&Group) -> (Option<f64>, Option<Interval>),
}

const SHOWN: [Shown; 4] = [
    Shown { label: "time to nest, if arrived (s)", scale: Scale::Linear, of: |group| mean(group, "time_to_nest_s") },
    Shown { label: "arrived (share of runs)", scale: Scale::FromZero, of: |group| (group.arrival_share, group.arrival_interval_95) },
    Shown { label: "mean pull (mN)", scale: Scale::FromZero, of: |group| in_milli(mean(group, "pull_mean_n")) },
    Shown { label: "displacement over time (mm/s)", scale: Scale::FromZero, of: |group| in_milli(mean(group, "mean_speed_m_per_s")) },
];

fn mean(group: &Group, name: &str) -> (Option<f64>, Option<Interval>) {
    let measure = group.measure(name);
    (measure.mean, measure.mean_interval_95)
}

fn in_milli((mean, interval): (Option<f64>, Option<Interval>)) -> (Option<f64>, Option<Interval>) {
    let milli = |value| cohaul_report::chart::MILLI * value;
    (mean.map(milli), interval.map(|it| Interval { low: milli(it.low), high: milli(it.high) }))
}

/// Largest number of curves that can be distinguished.
const MOST_CURVES: usize = 8;

/// The panels and their legend; `None` where there is nothing to show.
pub fn panels(identity: &Identity, groups: &[Group], times: &Times) -> Option<(Vec<Panel>, Vec<Entry>)> {
    match x_axis(identity, groups) {
        Some(x) => Some(over_parameter(&x, identity, groups)),
        None => histogram(times),
    }
}

/// The parameter on the horizontal axis.
struct X {
    at: usize,
    name: String,
    is_logarithmic: bool,
    /// Whether the parameter is sampled, so that its values are points without a line.
    is_sampled: bool,
}

impl X {
    fn of(&self, group: &Group) -> Option<f64> {
        let value: f64 = group.parameters[self.at].parse().ok()?;
        Some(if self.is_logarithmic { value.log10() } else { value })
    }
}

/// The parameter of numbers that takes most, which leaves fewest curves; a sampled one before
/// others, as a line over another would join what has nothing in common.
fn x_axis(identity: &Identity, groups: &[Group]) -> Option<X> {
    let mut axes: Vec<(usize, &Axis)> = identity.design.axes.iter().enumerate().collect();
    axes.sort_by_key(|(_, axis)| axis.n_values().map(Reverse));
    axes.into_iter().find_map(|(at, axis)| {
        let numbers: Vec<f64> = groups.iter().map(|group| group.parameters[at].parse().ok()).collect::<Option<_>>()?;
        let [low, high] = ends(numbers);
        // From a range of 20 on, values below a tenth of it would stand on one spot.
        let is_logarithmic = low > 0.0 && high / low >= 20.0;
        let is_sampled = matches!(axis, Axis { values: Values::Range { .. }, .. });
        (low < high).then(|| X { at, name: axis.path.clone(), is_logarithmic, is_sampled })
    })
}

fn over_parameter(x: &X, identity: &Identity, groups: &[Group]) -> (Vec<Panel>, Vec<Entry>) {
    let mut curves: Vec<(String, Vec<&Group>)> = Vec::new();
    for group in groups {
        let name = curve_name(x, identity, group);
        match curves.iter_mut().find(|(other, _)| *other == name) {
            Some((_, members)) => members.push(group),
            None => curves.push((name, vec![group])),
        }
    }
    curves.iter_mut().for_each(|(_, members)| members.sort_by(|a, b| x.of(a).partial_cmp(&x.of(b)).unwrap_or(std::cmp::Ordering::Equal)));
    let label = if x.is_logarithmic { format!("log₁₀ {}", x.name) } else { x.name.clone() };
    let [low, high] = ends(groups.iter().filter_map(|group| x.of(group)));
    let panel = |shown: &Shown| {
        let mut panel = Panel::new(&label, shown.label, shown.scale);
        // Nothing, a little beyond the first and last values of all groups: panels have the same
        // axis, and strokes at its ends can be seen.
        let room = 0.04 * (high - low);
        let y = groups.iter().find_map(|group| (shown.of)(group).0);
        panel.curves.extend(y.map(|y| Curve::new(vec![[low - room, y], [high + room, y]], style(0), Shape::Unseen)));
        let shift = |at: usize| BESIDE * (high - low) * (at as f64 - 0.5 * (curves.len().min(MOST_CURVES) - 1) as f64);
        let shown_curves = curves.iter().take(MOST_CURVES).enumerate();
        shown_curves.for_each(|(at, (_, members))| panel.curves.extend(drawn(x, shown, members, shift(at), style(at))));
        if curves.len() > MOST_CURVES {
            panel.note = Some(format!("{MOST_CURVES} of {} combinations", curves.len()));
        }
        panel
    };
    let is_there = |shown: &&Shown| groups.iter().any(|group| (shown.of)(group).0.is_some());
    let sign = if x.is_sampled { " (crosses)" } else { "" };
    let entries = curves.iter().take(MOST_CURVES).enumerate().map(|(at, (name, _))| Entry::line(format!("{name}{sign}"), style(at)));
    (SHOWN.iter().filter(is_there).map(panel).collect(), entries.collect())
}

/// Distance of one curve from the next to the right, over the span of the axis (1): at the same
/// places their intervals would hide each other.
const BESIDE: f64 = 0.006;

/// The smallest and the largest of some values.
fn ends(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    values.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [value.min(low), value.max(high)])
}

/// What a curve's groups share: the backend at its step and, with their names, all lists but the
/// one to the right.
fn curve_name(x: &X, identity: &Identity, group: &Group) -> String {
    let pairs = identity.design.axes.iter().zip(&group.parameters).enumerate();
    let others =
        pairs.filter(|(at, (axis, _))| *at != x.at && axis.n_values().is_some()).map(|(_, (axis, value))| format!("{} {value}", axis.path));
    std::iter::once(identity.variant_name(&group.backend, group.step_s)).chain(others).collect::<Vec<_>>().join(", ")
}

/// Means, and the interval of each as an upright stroke, which ends at zero: nothing shown can be
/// less. All of it `shift`ed to the right.
fn drawn(x: &X, shown: &Shown, members: &[&Group], shift: f64, style: Style) -> Vec<Curve> {
    let points = members.iter().filter_map(|group| Some([x.of(group)? + shift, (shown.of)(group).0?])).collect();
    let shape = if x.is_sampled { Shape::Crosses } else { Shape::Marked };
    let strokes = members.iter().filter_map(|group| {
        let (at, interval) = (x.of(group)? + shift, (shown.of)(group).1?);
        Some(Curve::new(vec![[at, interval.low.max(0.0)], [at, interval.high]], style.thin(), Shape::Path))
    });
    std::iter::once(Curve::new(points, style, shape)).chain(strokes).collect()
}

fn style(at: usize) -> Style {
    const COLORS: [&str; MOST_CURVES] = ["#0072B2", "#D55E00", "#000000", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#777777"];
    Style { color: COLORS[at % MOST_CURVES], dash: "", width: 1.6 }
}

/// Runs a bin of the time to the nest, a curve a backend.
fn histogram(times: &Times) -> Option<(Vec<Panel>, Vec<Entry>)> {
    let all = || times.0.values().flatten().copied();
    let [low, high] = ends(all());
    if !low.is_finite() {
        return None;
    }
    // As many bins as the root of the number of runs: a bin in the middle then has about as many.
    let n_bins = (all().count() as f64 / times.0.len() as f64).sqrt().ceil().clamp(4.0, 60.0);
    let width = if high > low { (high - low) / n_bins } else { 1.0 };
    let mut panel = Panel::new("time to nest (s)", "runs", Scale::Count);
    let mut entries = Vec::new();
    for (at, (backend, times)) in times.0.iter().enumerate() {
        let mut counts = vec![0u32; n_bins as usize];
        times.iter().for_each(|time| counts[(((time - low) / width) as usize).min(n_bins as usize - 1)] += 1);
        let edge = |bin: usize| low + bin as f64 * width;
        let mut points: Vec<[f64; 2]> = vec![[low, 0.0]];
        points.extend(counts.iter().enumerate().flat_map(|(bin, n)| [[edge(bin), f64::from(*n)], [edge(bin + 1), f64::from(*n)]]));
        points.push([edge(counts.len()), 0.0]);
        panel.curves.push(Curve::new(points, style(at), Shape::Path));
        entries.push(Entry::line(backend.clone(), style(at)));
    }
    Some((vec![panel], entries))
}

/// Means of a sweep's groups over the parameter that takes most numbers, or a histogram of the
/// times to the nest where only seeds differ; `None` where there is neither.
pub fn sweep(identity: &Identity, groups: &[Group], times: &Times) -> Option<String> {
    let (panels, legend) = panels(identity, groups, times)?;
    Some(grid(&panels, &[legend], panels.len().clamp(1, 2), COLUMN_WIDTH, PANEL_HEIGHT))
}
