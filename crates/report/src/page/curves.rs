//! Curves over time as a page draws them: the panels of the figures as data, for the script.

use serde::Serialize;

use crate::chart::panel::{Across, Curve, Entry, Panel, Scale, Shape, Style};
use crate::chart::{Labelled, Scene, over_time_panels, thin};
use crate::page::packed::Packed;

/// Plots over time that follow the replay before them.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    pub(crate) caption: String,
    pub(crate) plots: Vec<Plot>,
}

/// A plot as curves.js reads it, in the units of its labels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Plot {
    x: String,
    y: String,
    scale: &'static str,
    /// The y axis is cut here.
    ceiling: Option<f64>,
    note: Option<String>,
    curves: Vec<Line>,
    levels: Vec<Level>,
    instants: Vec<Instant>,
}

/// A curve; of y the decimal logarithm where the axis is logarithmic. No value is a gap.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Line {
    label: String,
    color: &'static str,
    dash: &'static str,
    width: f64,
    /// Constant up to the next point.
    steps: bool,
    x: Packed,
    y: Packed,
}

/// A line across the plot, as the tolerance.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Level {
    label: String,
    y: f64,
    color: &'static str,
    dash: &'static str,
}

/// A grasp or a release.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Instant {
    time: f64,
    color: &'static str,
    dash: &'static str,
}

/// Columns of a plot in which the extremes of a curve are kept (1): more than a screen has.
const COLUMNS: usize = 1500;

impl Curves {
    /// What the overview figure of these traces shows over time.
    pub fn over_time(traces: &[Labelled], scene: &Scene, caption: impl Into<String>) -> Self {
        let plots = over_time_panels(traces, scene).iter().map(|(panel, legend)| Plot::of(panel, legend)).collect();
        Self { caption: caption.into(), plots }
    }
}

impl Plot {
    fn of(panel: &Panel, legend: &[Entry]) -> Self {
        let scale = match panel.scale {
            Scale::FromZero => "from_zero",
            Scale::Count => "count",
            Scale::Log => "log",
            Scale::Linear | Scale::LogLog | Scale::Plane => "linear",
        };
        let (mut levels, mut instants) = (Vec::new(), Vec::new());
        for mark in &panel.marks {
            let Style { color, dash, .. } = mark.style;
            match mark.at {
                Across::Horizontal(y) => levels.push(Level { label: name_of(mark.style, legend), y, color, dash }),
                Across::Vertical(time) => instants.push(Instant { time, color, dash }),
            }
        }
        let curves = panel.curves.iter().map(|curve| line(curve, name_of(curve.style, legend), panel.scale == Scale::Log)).collect();
        let (ceiling, note) = (panel.ceiling, panel.note.clone());
        Self { x: panel.x_label.clone(), y: panel.y_label.clone(), scale, ceiling, note, curves, levels, instants }
    }
}

fn name_of(style: Style, legend: &[Entry]) -> String {
    legend.iter().find(|entry| entry.style == style).map_or(String::new(), |entry| entry.label.clone())
}

fn line(curve: &Curve, label: String, is_logarithmic: bool) -> Line {
    let value = |y: f64| if is_logarithmic { y.log10() } else { y };
    let points: Vec<[f64; 2]> = curve.points.iter().map(|[x, y]| [*x, value(*y)]).collect();
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    for run in points.split(|point| !(point[0] + point[1]).is_finite()).filter(|run| !run.is_empty()) {
        // The gap before it.
        if !xs.is_empty() {
            xs.push(Some(run[0][0]));
            ys.push(None);
        }
        for [x, y] in thin::by_column(run, COLUMNS) {
            xs.push(Some(x));
            ys.push(Some(y));
        }
    }
    let Style { color, dash, width } = curve.style;
    Line { label, color, dash, width, steps: curve.shape == Shape::Steps, x: Packed::long(&xs), y: Packed::long(&ys) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;

    /// A plot holds what the traces do: the largest difference, and the gap where there is none,
    /// beside the tolerance.
    #[test]
    fn differences_keep_their_extremes_gaps_and_tolerance() {
        let (a, mut b) = (synthetic::trace(40_000, 1.0), synthetic::trace(40_000, 1.0));
        b.rows[20_000..30_000].iter_mut().for_each(|row| row.motion.pose.position.x += 1e-4);
        b.rows[25_001].motion.pose.position.x += 7e-3;
        let traces = [Labelled { label: "quasi-static", trace: &a }, Labelled { label: "inertial", trace: &b }];
        let scene = Scene { radius: 0.0122, ..Scene::default() }.within(2e-3, 0.1);
        let curves = Curves::over_time(&traces, &scene, "a caption");
        let plot = &curves.plots[0];
        assert_eq!((plot.y.as_str(), plot.scale), ("edge displacement apart (mm)", "log"));
        assert_eq!((plot.levels[0].label.as_str(), plot.levels[0].y), ("tolerance", 2.0));
        assert_eq!(plot.curves[0].label, "inertial − quasi-static");
        let values = plot.curves[0].y.unpacked();
        let largest = values.iter().flatten().fold(f64::NEG_INFINITY, |most: f64, value| most.max(*value));
        // 32 bits over two decades.
        assert!((10_f64.powf(largest) - 7.1).abs() < 1e-6, "{largest}");
        let times = plot.curves[0].x.unpacked();
        let within = a.rows[20_000].time..=a.rows[29_999].time;
        assert!(times.iter().flatten().all(|time| *time > within.start() - 1e-6 && *time < within.end() + 1e-6));
        assert!(values.len() < 4 * COLUMNS + 10, "{}", values.len());
    }
}
