//! The paper's Figures 9, 11 and 12 for a recording, beside a run of the fitted ants.

use super::measures::{nest_of, series};
use super::recorded::Recorded;
use super::report::{Colony, Speed};
use crate::paper::figure::{bar, whisker};
use crate::paper::figure_run::{over_time, path, snapshots};
use crate::paper::{Changes, Series, Shown, Snapshot, shown_springs};
use cohaul::math::{Interval, Vec2};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::Row;
use cohaul_report::chart::MILLI;
use cohaul_report::chart::panel::{Curve, Entry, Panel, Scale, Shape, Style};
use cohaul_report::chart::print::{Drawing, Width};
use cohaul_report::chart::{COLUMN_WIDTH, PANEL_HEIGHT, ROW_HEIGHT, drawing};

const RECORDED: Style = Style { color: "#000000", dash: "", width: 1.6 };
const CHANGE: Style = Style { color: "#D55E00", dash: "7 3", width: 1.6 };
const FITTED: Style = Style { color: "#0072B2", dash: "", width: 1.6 };

/// Panels and legend of a figure.
pub type Drawn = (Vec<Panel>, Vec<Entry>);

/// A figure of the page: file, caption, panels with their legend, columns, and size of a panel
/// (px).
pub struct Figure {
    pub name: &'static str,
    pub caption: &'static str,
    drawn: Drawn,
    n_columns: usize,
    size: [f64; 2],
}

impl Figure {
    pub fn svg(&self) -> String {
        drawing(&self.drawn.0, std::slice::from_ref(&self.drawn.1), self.n_columns, self.size).svg()
    }

    /// For print: on one column panels stand below each other.
    pub fn for_print(&self, width: Width) -> Drawing {
        let n_columns = if width == Width::OneColumn { 1 } else { self.n_columns };
        let panel = width.px() / n_columns as f64;
        drawing(&self.drawn.0, std::slice::from_ref(&self.drawn.1), n_columns, [panel, panel * self.size[1] / self.size[0]])
    }
}

/// All figures of a colony. `run` are the frames of one run of the fitted ants, and `period` is the
/// time between them (s).
pub fn figures(found: &Colony, recorded: &Recorded, run: &[Row], period: f64, fitted: &Scenario) -> Vec<Figure> {
    let shown = shown(found, recorded, fitted);
    let (columns, snapshot) = ([COLUMN_WIDTH, PANEL_HEIGHT], [330.0, 330.0]);
    vec![
        Figure {
            name: "group-size",
            caption: "Load speed by the number of pulling ants (the paper's Fig. 9), with standard deviations, and time by that number",
            drawn: group_size(found),
            n_columns: 2,
            size: columns,
        },
        Figure {
            name: "series",
            caption: "Load speed, turn rate and interaction forces over time (the paper's Fig. 11): recording on the left, one run of the \
                      fitted ants on the right",
            drawn: over_times(recorded, run, period, (nest_of(fitted), found.first_seed)),
            n_columns: 2,
            size: [COLUMN_WIDTH, ROW_HEIGHT],
        },
        Figure {
            name: "snapshots",
            caption: "The recording in moments (the paper's Fig. 12, top): springs with an ant are orange",
            drawn: (snapshots(&shown).0, snapshot_entries()),
            n_columns: 3,
            size: snapshot,
        },
        Figure {
            name: "path",
            caption: "Path and heading of the load (the paper's Fig. 12, bottom), and those of one run of the fitted ants",
            drawn: paths(&shown, recorded, run),
            n_columns: 2,
            size: [COLUMN_WIDTH, 1.4 * PANEL_HEIGHT],
        },
    ]
}

/// Bars of two kinds side by side, with whiskers.
fn group_size(found: &Colony) -> Drawn {
    let mut speed = Panel::new("pulling ants", "load speed (mm/s)", Scale::FromZero);
    let mut share = Panel::new("pulling ants", "share of time (1)", Scale::FromZero);
    let last = found.group_size.len() as f64 + 0.6;
    for panel in [&mut speed, &mut share] {
        panel.curves.push(Curve::new(vec![[0.4, 0.0], [last, 0.0]], RECORDED, Shape::Unseen));
    }
    for of in &found.group_size {
        for (own, style, shift) in [(of.recorded, RECORDED, -0.18), (of.fitted, FITTED, 0.18)] {
            let (Some(Speed { mean_m_per_s: mean, sd_m_per_s: sd, share: time, .. }), x) = (own, of.n_pulling as f64 + shift) else {
                continue;
            };
            speed.curves.push(bar(x, 0.16, MILLI * mean, style));
            let spread = Interval { low: MILLI * (mean - sd).max(0.0), high: MILLI * (mean + sd) };
            speed.curves.push(whisker(x, 0.08, spread, style.thin()));
            share.curves.push(bar(x, 0.16, time, style));
        }
    }
    (vec![speed, share], vec![Entry::line("recording", RECORDED), Entry::line("fitted ants", FITTED)])
}

fn over_times(recorded: &Recorded, run: &[Row], period: f64, (nest, seed): (Option<Vec2>, u64)) -> Drawn {
    let of = |rows: &[Row], period: f64, name: &str| {
        let gathered = Series::once_gathered(rows, period, nest);
        let mut panels = over_time(&series(rows, period), &Changes::of(&gathered, seed), gathered.span());
        panels.iter_mut().for_each(|panel| panel.x_label = format!("{name}: time (s)"));
        panels
    };
    let sides = [of(&recorded.rows, recorded.period, "recording"), of(run, period, "fitted ants")];
    let panels = (0..3).flat_map(|at| sides.iter().map(move |side| side[at].clone())).collect();
    let entries = [Entry::line("means over 0.5 s", FITTED), Entry::line("two means", RECORDED), Entry::upright("likeliest change", CHANGE)];
    (panels, entries.to_vec())
}

fn snapshot_entries() -> Vec<Entry> {
    let held = Style { color: "#D55E00", dash: "", width: 1.6 };
    let free = Style { color: "#999999", dash: "", width: 1.0 };
    vec![
        Entry::line("load", RECORDED),
        Entry::line("free spring", free),
        Entry::line("spring with an ant", held),
        Entry::line("nest", Style::NEST),
    ]
}

fn paths(shown: &Shown, recorded: &Recorded, run: &[Row]) -> Drawn {
    let mut plane = path(shown);
    let place = |row: &Row| [MILLI * row.motion.pose.position.x, MILLI * row.motion.pose.position.y];
    plane.curves.iter_mut().filter(|curve| curve.style == FITTED).for_each(|curve| curve.style = RECORDED);
    plane.curves.push(Curve::new(run.iter().map(place).collect(), FITTED, Shape::Path));
    let mut heading = Panel::new("time (s)", "heading (rad)", Scale::Linear);
    for (rows, style) in [(&recorded.rows[..], RECORDED), (run, FITTED)] {
        let from = rows.first().map_or(0.0, |row| row.time);
        let points = rows.iter().map(|row| [row.time - from, row.motion.pose.heading]).collect();
        heading.curves.push(Curve::new(points, style, Shape::Graph));
    }
    (vec![plane, heading], vec![Entry::line("recording", RECORDED), Entry::line("fitted ants", FITTED), Entry::line("nest", Style::NEST)])
}

/// Instants that are shown, over the length of the recording (1).
const SHARES: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];

/// The recording as data of the paper's figures. Ants are known by the tips that they hold alone.
fn shown(found: &Colony, recorded: &Recorded, fitted: &Scenario) -> Shown {
    let rows = &recorded.rows;
    let snapshot = |share: f64| {
        let row = &rows[(share * (rows.len() - 1) as f64) as usize];
        Snapshot { time: row.time, load: row.motion.pose, springs: shown_springs(fitted, row), ants: Vec::new(), n_pulling: row.tips.len() }
    };
    let (nest, arrival_radius) = match &fitted.drive {
        Drive::Ants(ants) => (ants.nest_position, ants.arrival_radius),
        _ => (Vec2::zeros(), 0.0),
    };
    Shown {
        trial: None,
        seed: found.first_seed,
        changes: found.changes,
        window_s: Series::once_gathered(rows, recorded.period, nest_of(fitted)).span(),
        series: series(rows, recorded.period),
        path: rows.iter().map(|row| row.motion.pose.position).collect(),
        snapshots: SHARES.map(snapshot).to_vec(),
        load_radius: fitted.system.load.radius,
        nest,
        arrival_radius,
    }
}
