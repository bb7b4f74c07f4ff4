//! Rows of a verification -> panels: error against step, one panel a family of cases.

use crate::output::chart::panel::{Curve, Entry, Panel, Scale, Shape, Style};
use crate::output::chart::{COLUMN_WIDTH, PANEL_HEIGHT, grid};
use crate::studies::methods::Method;
use crate::studies::verify::{Expected, Family, Row, RowKind};

/// Families with a curve to show, each with its panel, and the legend of all.
pub fn panels(rows: &[Row]) -> (Vec<Panel>, Vec<Entry>) {
    let panels = Family::ALL.into_iter().filter_map(|family| panel(family, rows)).collect();
    let shown = |method: &Method| rows.iter().any(|row| row.method == *method && on_curve(row).is_some());
    let entries = Method::all_verified().filter(shown).map(|method| Entry::line(method.short_name, style(method)));
    (panels, entries.collect())
}

fn panel(family: Family, rows: &[Row]) -> Option<Panel> {
    let mut panel = Panel::new("step (s)", "error (m)", Scale::LogLog);
    let of_family: Vec<&Row> = rows.iter().filter(|row| row.family == family).collect();
    for plan in of_family.chunk_by(|one, next| one.case == next.case && one.method == next.method) {
        let points: Vec<[f64; 2]> = plan.iter().filter_map(|row| on_curve(row)).collect();
        // One step shows no slope.
        if points.len() > 1 {
            panel.curves.push(Curve { columns: Vec::new(), points, style: style(plan[0].method), shape: Shape::Graph });
        }
    }
    panel.note = Some(family.name().to_owned());
    (!panel.curves.is_empty()).then_some(panel)
}

/// Step and error of a row; nothing of what has no step, no length, or no error but rounding.
fn on_curve(row: &Row) -> Option<[f64; 2]> {
    let is_length = row.errors.metres.is_some() || row.errors.radians.is_some();
    (row.kind == RowKind::AtStep && row.expected != Expected::Exact && is_length).then_some([row.step_s?, row.size?])
}

fn style(method: Method) -> Style {
    let styles = [
        (Method::QUASI_STATIC, Style::of_trace(0)),
        (Method::INERTIAL_EULER, Style::of_trace(1)),
        (Method::INERTIAL_MIDPOINT, Style::of_pair(0)),
        (Method::RAPIER, Style::of_trace(2)),
        (Method::RAPIER_ENGINE_DEFAULTS, Style::of_trace(3)),
    ];
    styles.into_iter().find(|(known, _)| *known == method).map_or(Style::of_pair(1), |(_, style)| style)
}

/// Error of a verification against the step (both logarithmic): a panel a family of cases, a curve
/// a case and backend. Angles count by the displacement of a support.
pub fn convergence(rows: &[Row]) -> String {
    let (panels, legend) = panels(rows);
    grid(&panels, &[legend], 2, COLUMN_WIDTH, PANEL_HEIGHT)
}
