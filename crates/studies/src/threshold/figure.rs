//! Inertia effect over tolerance against the parameter, a curve for each quantity.

use super::point::Point;
use super::report::Thresholds;
use crate::vary::report::QUANTITIES;
use cohaul_report::chart::panel::{Across, Curve, Entry, Mark, Panel, Scale, Shape, Style};
use cohaul_report::chart::print::{Drawing, Width};
use cohaul_report::chart::{TIME_HEIGHT, alone, drawing};

/// Smallest share of the tolerance that has a place of its own (1).
pub const LEAST: f64 = 1e-3;

/// The curves as SVG.
pub fn figure(found: &Thresholds) -> String {
    let (panel, legend) = panel(found);
    alone(&panel, vec![legend], TIME_HEIGHT)
}

/// The curves for print.
pub fn figure_for_print(found: &Thresholds, width: Width) -> Drawing {
    let (panel, legend) = panel(found);
    let height = if width == Width::OneColumn { 280.0 } else { 400.0 };
    drawing(&[panel], &[legend], 1, [width.px(), height])
}

/// The panel and its legend.
fn panel(found: &Thresholds) -> (Panel, Vec<Entry>) {
    let parameter = &found.parameter;
    let mut panel = Panel::new(&parameter.label(), "inertia effect / tolerance (1)", Scale::LogLog);
    // A logarithmic axis has marks at logarithms.
    panel.marks.push(Mark { at: Across::Horizontal(0.0), style: Style::SLIP_LIMIT });
    let [from, to] = parameter.range.map(|end| parameter.place(end));
    panel.curves.push(Curve::new(vec![[from, 0.1], [to, 10.0]], style(0), Shape::Unseen));
    let shown = |at: &usize| found.quantities.iter().any(|of| of.quantity == QUANTITIES[*at].0);
    let shown: Vec<usize> = (0..QUANTITIES.len()).filter(shown).collect();
    let share = |point: &Point, at: usize| point.share(at).map_or(f64::NAN, |share| share.max(LEAST));
    for at in &shown {
        let points = found.points.iter().map(|point| [parameter.place(point.value), share(point, *at)]);
        panel.curves.push(Curve::new(points.collect(), style(*at), Shape::Marked));
    }
    let mut legend: Vec<Entry> = shown.iter().map(|at| Entry::line(QUANTITIES[*at].0, style(*at))).collect();
    legend.push(Entry::line("tolerance", Style::SLIP_LIMIT));
    (panel, legend)
}

/// The look of a quantity.
fn style(quantity: usize) -> Style {
    match quantity {
        0..=3 => Style::of_trace(quantity),
        _ => Style::of_pair(quantity - 4),
    }
}
