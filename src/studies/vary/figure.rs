//! A map of comparisons as a figure: cells with letters over two parameters, curves over one.

use super::Cell;
use super::report::{LETTERS, Map, QUANTITIES, letter, value_text};
use crate::output::chart::cells::{CellAxis, CellMap, Key, Size, cell_maps};
use crate::output::chart::panel::{Across, Curve, Entry, Mark, Panel, Scale, Shape, Style};
use crate::output::chart::{COLUMN_WIDTH, PANEL_HEIGHT, grid};
use crate::studies::sweep::Axis;

/// The map as SVG.
pub fn figure(map: &Map) -> String {
    match &map.axes[..] {
        [y, x] => cells(map, y, x),
        _ => curves(map),
    }
}

/// A panel a quantity; the last parameter goes to the right.
fn cells(map: &Map, y: &Axis, x: &Axis) -> String {
    let n_right = x.n_values().unwrap_or(1) as usize;
    let n_up = map.cells.len() / n_right;
    let axes = [axis(x, (0..n_right).map(|at| &map.cells[at]), 1), axis(y, (0..n_up).map(|at| &map.cells[at * n_right]), 0)];
    let panel = |quantity: usize| {
        let fill = |cell: &Cell| color(letter(cell, quantity)).to_owned();
        // A letter in the middle of each cell.
        let word = |at: usize| {
            let place = [(at % n_right) as f64 + 0.5, (at / n_right) as f64 + 0.5];
            (letter(&map.cells[at], quantity).to_string(), vec![[place[0] / n_right as f64, place[1] / n_up as f64]])
        };
        let [x, y] = axes.clone();
        let words = (0..map.cells.len()).map(word).collect();
        CellMap { title: QUANTITIES[quantity].0.to_owned(), x, y, fills: map.cells.iter().map(fill).collect(), words, ..CellMap::default() }
    };
    let panels: Vec<CellMap> = (0..QUANTITIES.len()).map(panel).collect();
    let shown = |letter_of: char| map.cells.iter().any(|cell| (0..QUANTITIES.len()).any(|at| letter(cell, at) == letter_of));
    let keys = LETTERS.iter().filter(|(letter, ..)| shown(*letter));
    let keys: Vec<Key> = keys.map(|(letter, color, meaning)| Key::Swatch((*color).to_owned(), format!("{letter} {meaning}"))).collect();
    let rows: Vec<Vec<CellMap>> = panels.chunks(3).map(<[CellMap]>::to_vec).collect();
    let legend: Vec<Vec<Key>> = keys.chunks(4).map(<[Key]>::to_vec).collect();
    cell_maps(&map.scenario, &rows, &legend, Size { width: 300.0, height: 220.0, left: 80.0, least_columns: 3 })
}

/// Labels at up to seven of the values.
fn axis<'a>(axis: &Axis, cells: impl Iterator<Item = &'a Cell>, parameter: usize) -> CellAxis {
    let labels: Vec<String> = cells.map(|cell| value_text(&cell.values[parameter])).collect();
    let n = labels.len();
    let tick = |(at, label): (usize, String)| ((at as f64 + 0.5) / n as f64, label);
    CellAxis { name: axis.path.clone(), n, ticks: labels.into_iter().enumerate().step_by(n.div_ceil(7)).map(tick).collect() }
}

fn color(letter: char) -> &'static str {
    LETTERS.iter().find(|(other, ..)| *other == letter).map_or("#ffffff", |(_, color, _)| color)
}

/// Smallest share of the tolerance that has a place of its own (1).
pub const LEAST: f64 = 1e-3;

/// Differences over the tolerance, a panel a quantity, and the estimate with the path.
fn curves(map: &Map) -> String {
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
        let mut panel = Panel::new(&map.axes[0].path, &format!("{}: difference / tolerance (1)", QUANTITIES[quantity].0), scale);
        // A logarithmic axis has marks at logarithms.
        panel.marks.push(Mark { at: Across::Horizontal(0.0), style: Style::SLIP_LIMIT });
        panel.curves.push(Curve::new(vec![[low, 0.1], [high, 10.0]], styles[0], Shape::Unseen));
        panel.curves.push(curve(styles[0], &|cell| cell.compared.map(|of| of[quantity].inertia_effect / of[quantity].tolerance)));
        panel.curves.push(curve(styles[1], &|cell| cell.compared.map(|of| of[quantity].engine_error / of[quantity].tolerance)));
        if quantity == 0 {
            panel.curves.push(curve(styles[2], &|cell| cell.estimate.map(|estimate| estimate.margin())));
        }
        panel
    };
    let panels: Vec<Panel> = (0..QUANTITIES.len()).map(panel).collect();
    let names = ["inertia effect", "engine error", "estimated inertia effect on the path"];
    let mut legend: Vec<Entry> = names.into_iter().zip(styles).map(|(name, style)| Entry::line(name, style)).collect();
    legend.push(Entry::line("tolerance", Style::SLIP_LIMIT));
    grid(&panels, &[legend], 2, COLUMN_WIDTH, PANEL_HEIGHT)
}
