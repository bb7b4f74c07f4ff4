//! Figures of the results beside the printed numbers: pulls, group sizes, backends and inertia.

use crate::paper::TableRow;
use crate::paper::figure_run;
use crate::paper::report::Paper;
use crate::paper::style::{OTHER, OURS, PRINTED};
use crate::paper::{Estimate, Extreme, Measure, RunFacts, Sample, Sampling, Shown, Trial, Unit};
use cohaul::math::Interval;
use cohaul::model::paper as printed;
use cohaul_report::chart::MILLI;
use cohaul_report::chart::canvas::natural_height;
use cohaul_report::chart::panel::{Across, Curve, Entry, Mark, Panel, Scale, Shape, Style};
use cohaul_report::chart::print::Width;
use cohaul_report::chart::{PANEL_HEIGHT, ROW_HEIGHT, WIDTH, alone, grid};
use cohaul_report::quantity::quantity;

const FAINT: Style = Style { color: "#999999", dash: "2 2.5", width: 1.0 };
/// Half width of a bar, and of the cap of a whisker.
const BAR: f64 = 0.36;
const CAP: f64 = 0.12;

/// The outline of a bar about `x` with this half width.
pub(crate) fn bar(x: f64, half_width: f64, height: f64, style: Style) -> Curve {
    let (left, right) = (x - half_width, x + half_width);
    Curve::new(vec![[left, 0.0], [left, height], [right, height], [right, 0.0]], style, Shape::Path)
}

/// An upright line with caps of this half width at its ends.
pub(crate) fn whisker(x: f64, half_width: f64, Interval { low, high }: Interval, style: Style) -> Curve {
    let (left, right) = (x - half_width, x + half_width);
    Curve::new(vec![[left, low], [right, low], [x, low], [x, high], [left, high], [right, high]], style, Shape::Path)
}

/// A point with its interval, in print units.
fn dot(x: f64, estimate: &Estimate, unit: f64, style: Style) -> Vec<Curve> {
    let scaled = |interval: Interval| Interval { low: unit * interval.low, high: unit * interval.high };
    let whiskers = estimate.interval_95.map(|interval| whisker(x, CAP, scaled(interval), style));
    std::iter::once(Curve::new(vec![[x, unit * estimate.value]], style, Shape::Dots)).chain(whiskers).collect()
}

/// Load speed by the number of pulling ants, and fractions of time by that number beside the
/// printed counts.
pub fn group_size(found: &Paper) -> (Vec<Panel>, Vec<Entry>) {
    let mut speed = Panel::new("pulling ants", "load speed (mm/s)", Scale::FromZero);
    let mut headway = Panel::new("ants on ten springs", "speed towards the nest (mm/s)", Scale::FromZero);
    let mut share = Panel::new("pulling ants of ten", "share of time with six or more (1)", Scale::FromZero);
    for (panel, low) in [(&mut speed, 0.4), (&mut headway, 0.4), (&mut share, 5.4)] {
        panel.curves.push(Curve::new(vec![[low, 0.0], [10.6, 0.0]], FAINT, Shape::Unseen));
    }
    for speeds in &found.load_speed {
        let x = speeds.n_transporting as f64;
        if let Some(estimate) = &speeds.headway_m_per_s {
            headway.curves.push(bar(x, BAR, MILLI * estimate.value, OURS));
            headway.curves.extend(dot(x, estimate, MILLI, OURS));
        }
        let Some(estimate) = &speeds.load_speed_m_per_s else { continue };
        speed.curves.push(bar(x, BAR, MILLI * estimate.value, OURS));
        let sd = speeds.sd_over_runs_m_per_s.unwrap_or_default();
        let spread = Interval { low: MILLI * (estimate.value - sd).max(0.0), high: MILLI * (estimate.value + sd) };
        speed.curves.push(whisker(x, CAP, spread, FAINT));
        speed.curves.extend(dot(x, estimate, MILLI, OURS));
    }
    speed.note = Some("whiskers: 95 %; dotted: spread of runs".to_owned());
    for size in printed::SMALLEST_OF_TEN..=10 {
        let x = size as f64;
        share.curves.push(Curve::new(vec![[x, printed::share_of_size(size)]], PRINTED, Shape::Crosses));
        if let Some(ours) = row(found, Measure::SizeShare(size)).and_then(|row| row.ours) {
            share.curves.push(bar(x, BAR, ours.value, OURS));
            share.curves.extend(dot(x, &ours, 1.0, OURS));
        }
    }
    (vec![speed, headway, share], vec![Entry::line("ours", OURS), Entry::line("paper (crosses)", PRINTED)])
}

fn row(found: &Paper, measure: Measure) -> Option<&TableRow> {
    found.table.iter().find(|row| row.quantity == measure.name())
}

/// Mean and standard deviation of pulls by trial, and the largest pull against the size of the
/// sample.
pub fn pulls(found: &Paper, units: &[Unit], largest: Option<Extreme>) -> (Vec<Panel>, Vec<Entry>) {
    let mut moments = Panel::new("ants / springs", "pull at decisions (mN)", Scale::FromZero);
    moments.note = Some("with a zero at each grasp".to_owned());
    moments.x_names = Trial::ALL.map(Trial::name).to_vec();
    for (level, style) in [(printed::PULL_MEAN_N, PRINTED), (printed::PULL_SD_N, Style { dash: "2 2.5", ..PRINTED })] {
        moments.marks.push(Mark { at: Across::Horizontal(MILLI * level), style });
    }
    for (at, trial) in Trial::ALL.into_iter().enumerate() {
        let sample = Sample::One(trial);
        let measures = [Measure::PullMean, Measure::PullSd].map(|of| of(sample, Sampling::AtDecisions));
        for (measure, (style, shift)) in measures.into_iter().zip([(OURS, -0.12), (OTHER, 0.12)]) {
            if let Some(ours) = row(found, measure).and_then(|row| row.ours) {
                moments.curves.extend(dot(1.0 + at as f64 + shift, &ours, MILLI, style));
            }
        }
    }
    let mut extremes = Panel::new("pulls in the sample, decimal logarithm (1)", "largest pull (mN)", Scale::Linear);
    extremes.curves.push(Curve::new(running_maximum(units), OURS, Shape::Steps));
    extremes.curves.push(Curve::new(vec![[(printed::N_PULLS as f64).log10(), MILLI * printed::PULL_MAX_N]], PRINTED, Shape::Crosses));
    extremes.curves.push(Curve::new(vec![[6.0, MILLI * printed::PULL_MAX_N]], FAINT, Shape::Unseen));
    if let Some(largest) = largest {
        let n = (printed::N_PULLS as f64).log10();
        extremes.curves.push(Curve::new(vec![[n, MILLI * largest.expected]], OTHER, Shape::Dots));
        extremes.curves.push(Curve::new(vec![[n, MILLI * largest.draw_95.low], [n, MILLI * largest.draw_95.high]], OTHER, Shape::Path));
        let (low, high) = (quantity(largest.draw_95.low, "N"), quantity(largest.draw_95.high, "N"));
        extremes.note = Some(format!("expected at the printed size: {low} to {high}"));
    }
    let entries = vec![
        Entry::line("mean", OURS),
        Entry::line("standard deviation", OTHER),
        Entry::line("paper: mean 5.0 mN", PRINTED),
        Entry::line("standard deviation 5.1 mN", Style { dash: "2 2.5", ..PRINTED }),
        Entry::line("largest, cross: paper; orange: 95 % of samples of that size", PRINTED),
    ];
    (vec![moments, extremes], entries)
}

/// Largest pull over the decimal logarithm of the number of pulls, as one run follows another.
fn running_maximum(units: &[Unit]) -> Vec<[f64; 2]> {
    let (mut n, mut largest) = (0.0, 0.0f64);
    let runs = units.iter().flat_map(|unit| Sample::Printed.runs(unit));
    runs.map(|run| {
        n += run.pulls.n() as f64;
        largest = largest.max(run.pulls.max());
        [n.log10(), MILLI * largest]
    })
    .collect()
}

/// Quantities that inertia may move, on every set of the preset; each in a panel.
pub fn backends(found: &Paper) -> (Vec<Panel>, Vec<Entry>) {
    let sets: Vec<usize> = (0..found.sets.len()).filter(|set| found.sets[*set].preset == found.preset).collect();
    let panel = |measure: Measure| {
        let mut panel = Panel::new(
            "method; × n: inertial, n times the inertia",
            &format!("{} ({})", short(measure), measure.unit().replace('N', "mN")),
            Scale::FromZero,
        );
        let unit = if measure.unit() == "N" { MILLI } else { 1.0 };
        let Some(row) = row(found, measure) else { return panel };
        let mut missing = Vec::new();
        for (at, set) in sets.iter().enumerate() {
            let name = short_name(&found.sets[*set].name);
            let (value, style) = if *set == 0 { (row.ours, OURS) } else { (row.on_others[set - 1].value, OTHER) };
            match value {
                Some(estimate) => panel.curves.extend(dot(1.0 + at as f64, &estimate, unit, style)),
                None => missing.push(name.clone()),
            }
            panel.x_names.push(name);
        }
        panel.note = (!missing.is_empty()).then(|| format!("no value: {}", missing.join(", ")));
        if let Some(ours) = &row.ours {
            panel.marks.push(Mark { at: Across::Horizontal(unit * ours.value), style: FAINT });
        }
        if let Some(printed) = row.printed {
            panel.marks.push(Mark { at: Across::Horizontal(unit * printed), style: PRINTED });
        }
        panel
    };
    let entries = vec![Entry::line(found.sets[0].name.clone(), OURS), Entry::line("other sets", OTHER), Entry::line("paper", PRINTED)];
    (Measure::MOVABLE.map(panel).to_vec(), entries)
}

/// Name of a set of runs that fits below an axis.
fn short_name(name: &str) -> String {
    name.replace("quasi-static", "no inertia").replace("inertia x ", "× ")
}

fn short(measure: Measure) -> String {
    measure.name().replace("standard deviation", "sd").replace(", 4/4 and 5/10", "")
}

/// Mean inertial force by smoothing time for every trial, beside the printed inertial force and the
/// friction.
pub fn inertial_force(found: &Paper) -> (Vec<Panel>, Vec<Entry>) {
    let mut panel = Panel::new("smoothing time (s)", "mean inertial force m a (mN)", Scale::LogLog);
    let mut entries = Vec::new();
    for (trial, color) in Trial::ALL.into_iter().zip(["#000000", "#0072B2", "#E69F00", "#009E73"]) {
        let style = Style { color, dash: "", width: 1.6 };
        let rows = found.inertial_force.iter().filter(|row| row.trial == trial);
        let points: Vec<[f64; 2]> = rows.filter_map(|row| Some([row.smoothing_s, MILLI * row.mean_n.as_ref()?.value])).collect();
        panel.curves.push(Curve::new(points.clone(), style, Shape::Path));
        panel.curves.push(Curve::new(points, style, Shape::Dots));
        entries.push(Entry::line(format!("{} ants on springs", trial.name()), style));
    }
    for (level, style) in [(printed::INERTIAL_FORCE_N, PRINTED), (printed::FRICTION_FORCE_N, FRICTION)] {
        let ends = [2e-3, 60.0].map(|smoothing| [smoothing, MILLI * level]);
        panel.curves.push(Curve::new(ends.to_vec(), style, Shape::Path));
    }
    entries.push(Entry::line("paper: inertial force 1e-4 mN", PRINTED));
    entries.push(Entry::line("paper: friction 22 mN", FRICTION));
    (vec![panel], entries)
}

const FRICTION: Style = Style { color: "#999999", dash: "7 3", width: 1.6 };

/// Name of the file, caption and SVG of each figure.
pub type Figures = Vec<(&'static str, &'static str, String)>;

/// All figures: pulls, group sizes, backends, the inertial force, and one run. None is wider than a
/// page in print, on which its text then has 6 to 8 pt.
pub fn of_paper(found: &Paper, units: &[Unit], largest: Option<Extreme>, shown: Option<&Shown>) -> Figures {
    let page = Width::TwoColumns.px();
    let columns = |drawn| in_grid(drawn, 2, page / 2.0, PANEL_HEIGHT);
    let mut figures = vec![
        ("pulls", "Pulls by trial, and the largest one against the size of the sample", columns(pulls(found, units, largest))),
        (
            "group-size",
            "Speed by the number of pulling ants, and time by that number beside the printed samples",
            columns(group_size(found)),
        ),
    ];
    if found.sets.len() > 1 {
        figures.push(("backends", "What inertia and the engine move", columns(backends(found))));
    }
    if !found.inertial_force.is_empty() {
        let svg = in_grid(inertial_force(found), 1, WIDTH, 1.4 * PANEL_HEIGHT);
        figures.push(("inertial-force", "Inertial force of the load by smoothing time", svg));
    }
    if let Some(shown) = shown {
        let runs: Vec<&RunFacts> = units.iter().filter_map(|unit| unit.of(shown.trial?)).collect();
        let series = in_grid(figure_run::transition(shown, &runs), 1, WIDTH, ROW_HEIGHT);
        let caption = "Speed, turn rate and interaction forces of one run of four ants, with their changes of mean";
        figures.push(("transition", caption, series));
        figures.push(("snapshots", "The same run, in moments", in_grid(figure_run::snapshots(shown), 3, page / 3.0, page / 3.0)));
        let path = figure_run::path(shown);
        figures.push(("path", "Its path", alone(&path, vec![], natural_height(&path, WIDTH))));
    }
    figures
}

fn in_grid((panels, legend): (Vec<Panel>, Vec<Entry>), n_columns: usize, width: f64, height: f64) -> String {
    grid(&panels, &[legend], n_columns, width, height)
}
