//! Figures of a benchmark: error over CPU time, and cost over size.

use crate::bench::{Ending, GrowthPoint, Quantity, Row, SceneFacts};
use crate::methods::Method;
use cohaul_report::chart::panel::{Entry, Panel, Scale, Shape, Style};
use cohaul_report::chart::{COLUMN_WIDTH, PANEL_HEIGHT, WORK_HEIGHT, grid};

/// Errors below this fraction of the path length are rounding, and are drawn there (1).
const LEAST_ERROR: f64 = 1e-16;
/// Where settings without an error are drawn (1): just below the top of the axis.
const NO_ERROR: f64 = 0.6;
/// Width of a panel of growth.
const GROWTH_WIDTH: f64 = 340.0;
/// Methods that both panels show, for orientation.
const SHARED: [&str; 2] = ["quasi-static", "inertial midpoint"];

/// Error against CPU time of the settings in one scene (both logarithmic): exact methods, and the
/// engine's variants beside two of them, over the same axes. What took longer than `budget` (s) is
/// drawn there.
pub fn work_precision_figure(facts: &SceneFacts, rows: &[Row], budget: f64) -> String {
    let rows: Vec<&Row> = rows.iter().filter(|row| row.scene == facts.scene).collect();
    let is_engine = |method: &str| method.parse::<Method>().is_ok_and(|method| !method.kind.is_exact());
    let exact = |method: &str| !is_engine(method);
    let engine = |method: &str| is_engine(method) || SHARED.contains(&method);
    let room = rows.iter().filter_map(|row| point(row, budget)).collect::<Vec<_>>();
    let panels = [panel(&rows, &exact, budget, &room), panel(&rows, &engine, budget, &room)];
    let entries = |of: &dyn Fn(&str) -> bool| {
        let shown = Method::all().map(|method| method.name).filter(|name| of(name) && rows.iter().any(|row| row.method == *name));
        shown.map(|name| Entry::line(name, style(name))).collect::<Vec<Entry>>()
    };
    let failures = Entry::line("crosses: not converged, no answer, or too long", FAILURE);
    let legends = [entries(&exact), [entries(&is_engine), vec![failures]].concat()];
    grid(&panels, &legends, 2, COLUMN_WIDTH, WORK_HEIGHT)
}

fn panel(rows: &[&Row], of: &dyn Fn(&str) -> bool, budget: f64, room: &[[f64; 2]]) -> Panel {
    let mut panel = Panel::new("CPU time (s)", "largest error / path length (1)", Scale::LogLog);
    panel.add(room.to_vec(), FAILURE, Shape::Unseen);
    for method in Method::all().filter(|method| of(method.name)) {
        let own = |is_shown: fn(&Row) -> bool| {
            let own = rows.iter().filter(|row| row.method == method.name && is_shown(row));
            own.filter_map(|row| point(row, budget)).collect()
        };
        panel.add(own(|row| row.share.is_some()), style(method.name), Shape::Marked);
        panel.add(own(|row| row.ending != Ending::Converged), style(method.name), Shape::Crosses);
    }
    let n = |is_counted: fn(&Row) -> bool| rows.iter().filter(|row| of(&row.method) && is_counted(row)).count();
    let counts = [
        (n(|row| !row.is_answered()), "too long"),
        (n(|row| row.ending == Ending::NotConverged), "not converged"),
        (n(|row| row.ending == Ending::Failed), "failed"),
    ];
    let notes: Vec<String> = counts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
    panel.note = (!notes.is_empty()).then(|| notes.join(", "));
    panel
}

/// CPU time and error of a setting, the budget and no error where it was too long; `None` of what
/// was never tried.
fn point(row: &Row, budget: f64) -> Option<[f64; 2]> {
    let time = row.timing().map_or(0.8 * budget, |timing| timing.min_s);
    let is_tried = !matches!(row.ending, Ending::LeftOut(_));
    is_tried.then(|| [time, row.share.map_or(NO_ERROR, |error| error.max(LEAST_ERROR))])
}

const FAILURE: Style = Style { color: "#666666", dash: "1 3", width: 1.0 };

/// A colour for each kind of exact method and each friction of the engine, dashes for its variants.
fn style(method: &str) -> Style {
    let (color, dash, width) = match method {
        "quasi-static" => ("#0072B2", "", 2.2),
        "quasi-static second order" => ("#56B4E9", "", 2.2),
        "quasi-static clarabel" => ("#0072B2", "2 2.5", 1.5),
        "quasi-static controlled" => ("#56B4E9", "7 3", 1.8),
        "inertial euler" => ("#E69F00", "", 1.5),
        "inertial midpoint" => ("#D55E00", "", 2.2),
        "inertial controlled" => ("#D55E00", "7 3", 1.5),
        "rapier aligned" => ("#000000", "", 1.8),
        "rapier polygon" => ("#009E73", "", 1.5),
        "rapier box" => ("#CC79A7", "", 1.5),
        "rapier aligned f32" => ("#000000", "2 2.5", 1.5),
        "rapier aligned aggregate" => ("#777777", "7 3", 1.5),
        "rapier aligned force" => ("#777777", "2 2.5", 1.5),
        "rapier engine defaults" => ("#CC79A7", "7 3", 1.5),
        "rapier engine defaults f32" => ("#CC79A7", "2 2.5", 1.5),
        of_user => {
            let of_user = Method::all().filter(|method| method.is_of_user).position(|method| method.name == of_user);
            return of_user.map_or(Style { color: "#999999", dash: "9 3 2 3", width: 1.5 }, Style::of_pair);
        }
    };
    Style { color, dash, width }
}

/// Cost of a step, or of a tick of ants, against the size of a scene (both logarithmic): a panel a
/// quantity, a curve a backend.
pub fn growth_figure(points: &[GrowthPoint]) -> String {
    let of_quantity = |points: &[GrowthPoint]| {
        let quantity = points[0].quantity;
        let cost = if quantity == Quantity::Ants { "CPU time of a tick (s)" } else { "CPU time of a step (s)" };
        let mut panel = Panel::new(&format!("number of {}", quantity.name()), cost, Scale::LogLog);
        for curve in points.chunk_by(|one, next| one.backend == next.backend) {
            let costs = curve.iter().filter_map(|point| Some([point.n as f64, point.timing()?.min_s])).collect();
            panel.add(costs, backend_style(curve[0].backend.name()), Shape::Marked);
        }
        panel
    };
    let panels: Vec<Panel> = points.chunk_by(|one, next| one.quantity == next.quantity).map(of_quantity).collect();
    let mut backends: Vec<&str> = points.iter().map(|point| point.backend.name()).collect();
    backends.sort_unstable();
    backends.dedup();
    let legend = backends.into_iter().map(|backend| Entry::line(backend, backend_style(backend))).collect();
    grid(&panels, &[legend], panels.len(), GROWTH_WIDTH, PANEL_HEIGHT)
}

fn backend_style(backend: &str) -> Style {
    match backend {
        "inertial" => style("inertial midpoint"),
        "rapier" => style("rapier aligned"),
        other => style(other),
    }
}
