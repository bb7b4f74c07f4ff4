//! A map of comparisons as a figure: colours and lines of equal effect over two parameters, curves
//! over one.

use super::Cell;
use super::report::{Map, QUANTITIES, share, value_text};
use crate::sweep::Axis;
use cohaul::analysis::compare::InertiaAnswer;
use cohaul::simulation::run_facts::split_unit;
use cohaul_report::chart::axis::power_label;
use cohaul_report::chart::cells::{CROSSED, CellAxis, CellMap, DOTTED, GAP, HATCHED, Key, Level, Size, cell_drawing, viridis};
use cohaul_report::chart::panel::{Across, Curve, Entry, Mark, Panel, Scale, Shape, Style};
use cohaul_report::chart::print::{Drawing, Width};
use cohaul_report::chart::{COLUMN_WIDTH, PANEL_HEIGHT, drawing};

/// How the panels of a figure are laid out.
struct Layout {
    /// Maps over two parameters, and panels of curves, side by side.
    n_columns: [usize; 2],
    map: Size,
    /// Most labels at an axis of a map.
    n_labels: usize,
    /// Size of a panel of curves (px).
    curves: [f64; 2],
    /// Without a title, which a caption has on paper, and with short names of axes.
    is_printed: bool,
}

const ON_SCREEN: Layout = Layout {
    n_columns: [3, 2],
    map: Size { width: 300.0, height: 220.0, left: 80.0, least_columns: 3 },
    n_labels: 7,
    curves: [COLUMN_WIDTH, PANEL_HEIGHT],
    is_printed: false,
};

/// The map as SVG.
pub fn figure(map: &Map) -> String {
    drawn(map, &ON_SCREEN).svg()
}

/// The map for print.
pub fn figure_for_print(map: &Map, width: Width) -> Drawing {
    const LEFT: f64 = 82.0;
    let (n_maps, n_curves, height) = match width {
        Width::OneColumn => (2, 1, 130.0),
        Width::TwoColumns => (3, 2, 180.0),
    };
    let of_panel = (width.px() - LEFT) / n_maps as f64 - GAP;
    let map_size = Size { width: of_panel, height, left: LEFT, least_columns: n_maps };
    let curves = [width.px() / n_curves as f64, 205.0];
    drawn(map, &Layout { n_columns: [n_maps, n_curves], map: map_size, n_labels: 4, curves, is_printed: true })
}

fn drawn(map: &Map, layout: &Layout) -> Drawing {
    match &map.axes[..] {
        [y, x] => cells(map, y, x, layout),
        _ => curves(map, layout),
    }
}

/// Inertia effect over the tolerance, a panel a quantity; the last parameter goes to the right.
fn cells(map: &Map, y: &Axis, x: &Axis, layout: &Layout) -> Drawing {
    let n_right = x.n_values().unwrap_or(1) as usize;
    let n_up = map.cells.len() / n_right;
    let axes =
        [axis(x, (0..n_right).map(|at| &map.cells[at]), 1, layout), axis(y, (0..n_up).map(|at| &map.cells[at * n_right]), 0, layout)];
    let panel = |quantity: &usize| {
        let fills = map.cells.iter().map(|cell| fill(cell, *quantity)).collect();
        let decade = |cell: &Cell| share(cell, *quantity).map_or(f64::NAN, |share| share.max(10.0f64.powi(DECADES[0])).log10());
        let field: Vec<Vec<f64>> = map.cells.chunks(n_right).map(|row| row.iter().map(decade).collect()).collect();
        let levels = LEVELS.map(|(at, style, word)| Level { field: field.clone(), at, style, word }).to_vec();
        let [x, y] = axes.clone();
        CellMap { title: QUANTITIES[*quantity].0.to_owned(), x, y, fills, levels, ..CellMap::default() }
    };
    let panels: Vec<CellMap> = map.quantities().iter().map(panel).collect();
    let rows: Vec<Vec<CellMap>> = panels.chunks(layout.n_columns[0]).map(<[CellMap]>::to_vec).collect();
    let title = if layout.is_printed { "" } else { &*map.scenario };
    cell_drawing(title, &rows, &legend(map), layout.map)
}

/// Decades of the colours: effects beyond them have the colours of the ends.
const DECADES: [i32; 2] = [-2, 2];
/// Lines of equal effect: their decades, styles and words.
const LEVELS: [(f64, Style, &str); 3] = [(-1.0, THIN, "0.1"), (0.0, BOLD, "1"), (1.0, THIN, "10")];
const BOLD: Style = Style { color: "#000000", dash: "", width: 2.2 };
const THIN: Style = Style { color: "#000000", dash: "4 3", width: 1.0 };

/// Colour of an effect over the tolerance (1).
fn color(share: f64) -> String {
    let [low, high] = DECADES.map(f64::from);
    viridis(((share.log10() - low) / (high - low)).clamp(0.0, 1.0))
}

/// Colour or pattern of a quantity at a point.
fn fill(cell: &Cell, quantity: usize) -> String {
    let answer = cell.compared.as_ref().map(|of| of[quantity].inertia);
    match share(cell, quantity) {
        _ if cell.failure.is_some() => CROSSED.to_owned(),
        _ if answer == Some(InertiaAnswer::NothingMoved) => DOTTED.to_owned(),
        _ if answer == Some(InertiaAnswer::Open) => HATCHED.to_owned(),
        Some(share) => color(share),
        None => NOT_COMPARED.to_owned(),
    }
}

/// Cells of a quantity that was not compared, because the estimate decided for the path.
const NOT_COMPARED: &str = "#eeeeee";

/// The colours, and the patterns that occur.
fn legend(map: &Map) -> Vec<Vec<Key>> {
    let [low, high] = DECADES;
    let colors = (4 * low..=4 * high).map(|quarter| {
        let label = if quarter % 4 == 0 { power_label(f64::from(quarter / 4)) } else { String::new() };
        (color(10.0f64.powf(0.25 * f64::from(quarter))), label)
    });
    let scale = Key::Scale { name: "inertia effect / tolerance".to_owned(), colors: colors.collect() };
    let patterns = [
        (DOTTED, "nothing moved"),
        (HATCHED, "open"),
        (CROSSED, "not computed"),
        (NOT_COMPARED, "not compared: the estimate decides for the path"),
    ];
    let quantities = map.quantities();
    let occurs = |fill_of: &str| map.cells.iter().any(|cell| quantities.iter().any(|at| fill(cell, *at) == fill_of));
    let patterns = patterns.into_iter().filter(|(fill_of, _)| occurs(fill_of));
    vec![vec![scale], patterns.map(|(fill, name)| Key::Swatch(fill.to_owned(), name.to_owned())).collect()]
}

/// Labels at some of the values.
fn axis<'a>(axis: &Axis, cells: impl Iterator<Item = &'a Cell>, parameter: usize, layout: &Layout) -> CellAxis {
    let labels: Vec<String> = cells.map(|cell| value_text(&cell.values[parameter])).collect();
    let n = labels.len();
    let tick = |(at, label): (usize, String)| ((at as f64 + 0.5) / n as f64, label);
    CellAxis {
        name: for_people(&axis.path),
        n,
        ticks: labels.into_iter().enumerate().step_by(n.div_ceil(layout.n_labels)).map(tick).collect(),
    }
}

/// Smallest share of the tolerance that has a place of its own (1).
pub const LEAST: f64 = 1e-3;

/// Differences over the tolerance, a panel a quantity, and the estimate with the path.
fn curves(map: &Map, layout: &Layout) -> Drawing {
    let numbers: Option<Vec<f64>> = map.cells.iter().map(|cell| cell.values[0].as_f64()).collect();
    // Words stand in their order.
    let places = numbers.unwrap_or_else(|| (0..map.cells.len()).map(|at| at as f64).collect());
    let (low, high) = places.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (x.min(low), x.max(high)));
    let scale = if low > 0.0 && high / low >= 20.0 { Scale::LogLog } else { Scale::Log };
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|a, b| places[*a].total_cmp(&places[*b]));
    let curve = |style: Style, of: &dyn Fn(&Cell) -> Option<f64>| {
        let share = |at: &usize| of(&map.cells[*at]).map_or(f64::NAN, |share| share.max(LEAST));
        Curve::new(order.iter().map(|at| [places[*at], share(at)]).collect(), style, Shape::Marked)
    };
    let styles = [Style::of_pair(0), Style::of_pair(1), Style::of_trace(2).thin()];
    let panel = |quantity: usize| {
        let (name, label) = (QUANTITIES[quantity].0, "difference / tolerance (1)");
        let y_label = if layout.is_printed { label.to_owned() } else { format!("{name}: {label}") };
        let mut panel = Panel::new(&for_people(&map.axes[0].path), &y_label, scale);
        panel.note = layout.is_printed.then(|| name.to_owned());
        // A logarithmic axis has marks at logarithms.
        panel.marks.push(Mark { at: Across::Horizontal(0.0), style: Style::SLIP_LIMIT });
        panel.curves.push(Curve::new(vec![[low, 0.1], [high, 10.0]], styles[0], Shape::Unseen));
        panel.curves.push(curve(styles[0], &|cell| cell.compared.as_ref().map(|of| of[quantity].inertia_effect / of[quantity].tolerance)));
        panel.curves.push(curve(styles[1], &|cell| cell.compared.as_ref().map(|of| of[quantity].engine_error / of[quantity].tolerance)));
        if quantity == 0 {
            panel.curves.push(curve(styles[2], &|cell| cell.estimate.map(|estimate| estimate.margin())));
        }
        panel
    };
    let panels: Vec<Panel> = map.quantities().into_iter().map(panel).collect();
    let names = ["inertia effect", "engine error", "estimated inertia effect on the path"];
    let mut legend: Vec<Entry> = names.into_iter().zip(styles).map(|(name, style)| Entry::line(name, style)).collect();
    legend.push(Entry::line("tolerance", Style::SLIP_LIMIT));
    drawing(&panels, &[legend], layout.n_columns[1], layout.curves)
}

/// Name of a parameter in words with its unit, such as `load mass (kg)`.
fn for_people(path: &str) -> String {
    let (name, unit) = split_unit(path);
    let name = name.replace(['.', '_'], " ");
    if unit.is_empty() { name } else { format!("{name} ({unit})") }
}
