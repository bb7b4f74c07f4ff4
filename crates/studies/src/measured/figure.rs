//! Figures of measured runs: every difference of each run, and where the model error points.

use super::report::Measured;
use super::run::Found;
use cohaul_report::chart::panel::{Across, Curve, Entry, Mark, Panel, Scale, Shape, Style};
use cohaul_report::chart::print::{Drawing, Width};
use cohaul_report::chart::{COLUMN_WIDTH, MILLI, PANEL_HEIGHT, drawing};

/// Size below which a difference stands at this size (mm): a nanometre.
const LEAST: f64 = 1e-6;

/// Both figures side by side, as SVG.
pub fn figure(found: &Measured) -> String {
    drawn(found, 2, [COLUMN_WIDTH, PANEL_HEIGHT]).svg()
}

/// The same for print.
pub fn figure_for_print(found: &Measured, width: Width) -> Drawing {
    let n_columns = match width {
        Width::OneColumn => 1,
        Width::TwoColumns => 2,
    };
    drawn(found, n_columns, [width.px() / n_columns as f64, 205.0])
}

fn drawn(found: &Measured, n_columns: usize, size: [f64; 2]) -> Drawing {
    let styles = [Style::of_trace(0), Style::of_trace(1), Style::of_pair(0), Style::of_pair(1)];
    let names = ["model error", "inertia effect", "engine error", "reference error"];
    let mut legend: Vec<Entry> = names.into_iter().zip(styles).map(|(name, style)| Entry::line(name, style)).collect();
    if found.own_limit.is_some() {
        legend.push(Entry::line("the measurement's own limit", Style::TOLERANCE));
    }
    drawing(&[by_run(found, styles), directions(found)], &[legend], n_columns, size)
}

/// Differences of each run, those of the smallest model error first.
fn by_run(found: &Measured, styles: [Style; 4]) -> Panel {
    let mut runs: Vec<&Found> = found.found().map(|(_, of)| of).collect();
    runs.sort_by(|a, b| a.model_error.edge_displacement_m.total_cmp(&b.model_error.edge_displacement_m));
    let mut panel = Panel::new("runs, by model error", "edge displacement (mm)", Scale::Log);
    if let Some(limit) = found.own_limit {
        // A logarithmic axis has marks at logarithms.
        panel.marks.push(Mark { at: Across::Horizontal((MILLI * limit.edge_displacement_m).log10()), style: Style::TOLERANCE });
    }
    let differences = |of: &Found| {
        let model_error = of.model_error.edge_displacement_m;
        [Some(model_error), Some(of.inertia_effect_m), of.engine_error_m, Some(of.reference_error_m)]
    };
    for (which, style) in styles.into_iter().enumerate() {
        let point = |(at, found): (usize, &&Found)| {
            [at as f64 + 1.0, differences(found)[which].map_or(f64::NAN, |value| (MILLI * value).max(LEAST))]
        };
        panel.curves.push(Curve::new(runs.iter().enumerate().map(point).collect(), style, Shape::Marked));
    }
    panel
}

/// Measured minus simulated position at the last pose, along and across the measured displacement.
fn directions(found: &Measured) -> Panel {
    let mut panel = Panel::new("model error along the displacement (mm)", "to its left (mm)", Scale::Plane);
    let points: Vec<[f64; 2]> = found.found().map(|(_, of)| [MILLI * of.model_error.along_m, MILLI * of.model_error.across_m]).collect();
    panel.marks.extend([Across::Horizontal(0.0), Across::Vertical(0.0)].map(|at| Mark { at, style: Style::START }));
    panel.curves.push(Curve::new(points, Style::of_trace(0), Shape::Dots));
    panel
}
