//! Figure of a verification: error against step, one panel a family of cases.

use crate::methods::Method;
use crate::verify::{Expected, Row, RowKind};
use cohaul_report::chart::panel::{Entry, Panel, Scale, Shape, Style};
use cohaul_report::chart::{COLUMN_WIDTH, PANEL_HEIGHT, grid};

/// Error of a verification against the step (both logarithmic): a panel a family of cases with a
/// curve to show, a curve a case and backend. Angles count by the displacement of a support.
pub fn convergence(rows: &[Row]) -> String {
    let panels: Vec<Panel> = rows.chunk_by(|one, next| one.family == next.family).filter_map(panel).collect();
    let shown = |method: &Method| rows.iter().any(|row| row.method == *method && on_curve(row).is_some());
    let entries = Method::all().filter(shown).map(|method| Entry::line(method.short_name, style(method)));
    grid(&panels, &[entries.collect()], 2, COLUMN_WIDTH, PANEL_HEIGHT)
}

fn panel(rows: &[Row]) -> Option<Panel> {
    let mut panel = Panel::new("step (s)", "error (m)", Scale::LogLog);
    for plan in rows.chunk_by(|one, next| one.case == next.case && one.method == next.method) {
        let points: Vec<[f64; 2]> = plan.iter().filter_map(on_curve).collect();
        // One step shows no slope.
        if points.len() > 1 {
            panel.add(points, style(plan[0].method), Shape::Graph);
        }
    }
    panel.note = Some(rows[0].family.name().to_owned());
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
