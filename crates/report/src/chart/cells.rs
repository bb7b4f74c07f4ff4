//! Maps of cells: panels of coloured cells over two parameters, with lines of equal value and other
//! lines over them, side by side on one page with a legend below.
//!
//! Cells of a panel have equal size, so that an axis may be linear or logarithmic, begin at zero or
//! have names. Places on a panel are shares of its width and height (0 to 1, from the lower left).

use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene, TextAnchor};

use crate::chart::canvas::{empty, plain};
pub use crate::chart::cell_axis::{CellAxis, place};
pub use crate::chart::level::Level;
use crate::chart::panel::Style;
use crate::chart::print::Drawing;

#[derive(Clone, Debug, Default)]
pub struct CellMap {
    pub title: String,
    pub x: CellAxis,
    pub y: CellAxis,
    /// Colours or patterns of the cells, row by row from the lowest one.
    pub fills: Vec<String>,
    pub lines: Vec<(Vec<[f64; 2]>, Style)>,
    pub levels: Vec<Level>,
    /// Bars between two places, with a dot at both ends.
    pub bars: Vec<[[f64; 2]; 2]>,
    /// Words on free places: each stands at the first of its places where it fits.
    pub words: Vec<(String, Vec<[f64; 2]>)>,
}

#[derive(Clone, Debug)]
pub enum Key {
    Line(Style, String),
    Swatch(String, String),
    /// The bar with dots at its ends.
    Bar(String),
    /// Colours with labels below some of them.
    Scale {
        name: String,
        colors: Vec<(String, String)>,
    },
}

/// Size of the panels of a page (px).
#[derive(Clone, Copy, Debug)]
pub struct Size {
    pub width: f64,
    pub height: f64,
    /// Space for the labels of the y axis of the first column.
    pub left: f64,
    /// Least number of panels that the page has room for side by side, for the legend. Fewer ones
    /// are wider, up to twice their width.
    pub least_columns: usize,
}

/// Patterns of cells without a number.
pub const DOTTED: &str = "url(#dotted)";
pub const HATCHED: &str = "url(#hatched)";
pub const CROSSED: &str = "url(#crossed)";

/// Space between panels, above and below them, and above all (px).
pub const GAP: f64 = 20.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 48.0;
const HEAD: f64 = 28.0;
const LEGEND_LINE: f64 = 23.0;
/// Mean advance of a letter of the legend (px).
const LETTER: f64 = 6.6;
/// The same of the labels of ticks.
const TICK_LETTER: f64 = 6.2;

const PATTERNS: [&str; 3] = [
    "<pattern id=\"dotted\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\"><rect width=\"7\" height=\"7\" fill=\"#f2f2f2\"/>\
     <circle cx=\"3.5\" cy=\"3.5\" r=\"0.9\" fill=\"#888888\"/></pattern>",
    "<pattern id=\"hatched\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\"><rect width=\"6\" height=\"6\" fill=\"#ffffff\"/>\
     <path d=\"M-1,5 l2,2 M0,0 l6,6 M5,-1 l2,2\" stroke=\"#777777\" stroke-width=\"1\"/></pattern>",
    "<pattern id=\"crossed\" width=\"8\" height=\"8\" patternUnits=\"userSpaceOnUse\"><rect width=\"8\" height=\"8\" fill=\"#bbbbbb\"/>\
     <path d=\"M0,0 l8,8 M8,0 l-8,8\" stroke=\"#000000\" stroke-width=\"0.8\"/></pattern>",
];

/// A page of panels, row by row, with `legend` below, as SVG.
pub fn cell_maps(title: &str, rows: &[Vec<CellMap>], legend: &[Vec<Key>], size: Size) -> String {
    cell_drawing(title, rows, legend, size).svg()
}

/// The same, to be written on a screen or on paper.
pub fn cell_drawing(title: &str, rows: &[Vec<CellMap>], legend: &[Vec<Key>], size: Size) -> Drawing {
    let n_columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let inner = n_columns.max(size.least_columns) as f64 * (size.width + GAP);
    let width = (inner / n_columns.max(1) as f64 - GAP).min(2.0 * size.width);
    let mut scene = empty(size.left + inner, 0.0);
    scene.defs.extend(PATTERNS.map(str::to_owned));
    text(&mut scene, [8.0, 18.0], TextAnchor::Start, 13, title);
    let head = if title.is_empty() { 0.0 } else { HEAD };
    let row_height = TOP + size.height + BOTTOM;
    for (row, maps) in rows.iter().enumerate() {
        for (column, map) in maps.iter().enumerate() {
            let left = size.left + column as f64 * (width + GAP);
            let top = head + row as f64 * row_height + TOP;
            Area { left, top, width, height: size.height, words: Vec::new() }.draw(&mut scene, map, column == 0);
        }
    }
    let mut y = head + rows.len() as f64 * row_height + LEGEND_LINE;
    for keys in legend {
        y = draw_keys(&mut scene, keys, y) + LEGEND_LINE;
    }
    scene.height = y;
    Drawing(scene)
}

/// The cells of a panel on the page (px), and the words on them: middles and half widths.
struct Area {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    words: Vec<([f64; 2], f64)>,
}

impl Area {
    fn draw(&mut self, scene: &mut Scene, map: &CellMap, is_first: bool) {
        let (left, top, width, height) = (self.left, self.top, self.width, self.height);
        text(scene, [left, top - 8.0], TextAnchor::Start, 12, &map.title);
        self.cells(scene, map);
        let id = format!("cells-{left:.0}-{top:.0}");
        scene.defs.push(format!("<clipPath id=\"{id}\"><rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"/></clipPath>"));
        scene.add(Primitive::ClipStart { x: left, y: top, width, height, id });
        for (points, style) in &map.lines {
            stroke(scene, points.iter().map(|place| self.at(*place)).collect(), style);
        }
        let longest = map.levels.iter().map(|level| {
            let lines = level.lines([left, top], [width, height], [map.x.n, map.y.n]);
            lines.iter().for_each(|line| stroke(scene, line.clone(), &level.style));
            lines.into_iter().max_by_key(Vec::len).unwrap_or_default()
        });
        let longest: Vec<Vec<(f64, f64)>> = longest.collect();
        for [from, to] in map.bars.iter().map(|ends| ends.map(|end| self.at(end))) {
            bar(scene, from, to);
        }
        scene.add(Primitive::ClipEnd);
        for (level, points) in map.levels.iter().zip(longest) {
            let (before, after) = points.split_at(points.len() / 5);
            self.word(scene, level.word, after.iter().chain(before).copied());
        }
        for (word, places) in &map.words {
            let places: Vec<(f64, f64)> = places.iter().map(|place| self.at(*place)).collect();
            self.word(scene, word, places);
        }
        rect(scene, [left, top], [width, height], "none", true);
        self.axes(scene, map, is_first);
    }

    fn at(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        (self.left + x * self.width, self.top + (1.0 - y) * self.height)
    }

    /// Neighbours of one colour are one rectangle.
    fn cells(&self, scene: &mut Scene, map: &CellMap) {
        let (width, height) = (self.width / map.x.n as f64, self.height / map.y.n as f64);
        for (row, fills) in map.fills.chunks(map.x.n).enumerate() {
            let (mut from, y) = (0, self.top + self.height - (row + 1) as f64 * height);
            for run in fills.chunk_by(|one, next| one == next) {
                // A little larger, so that no seam shows between neighbours.
                let size = [run.len() as f64 * width + 0.3, height + 0.3];
                rect(scene, [self.left + from as f64 * width, y], size, &run[0], false);
                from += run.len();
            }
        }
    }

    /// A word with a white halo at the first of these places that lies inside and on no other word.
    fn word(&mut self, scene: &mut Scene, word: &str, places: impl IntoIterator<Item = (f64, f64)>) {
        let half = 2.8 * word.chars().count() as f64;
        let is_free = |(x, y): &(f64, f64)| {
            let is_aside = |([other_x, other_y], other): &([f64; 2], f64)| (x - other_x).abs() > half + other || (y - other_y).abs() > 10.0;
            let (right, down) = (x - self.left, y - self.top);
            (half..=self.width - half).contains(&right) && (10.0..=self.height).contains(&down) && self.words.iter().all(is_aside)
        };
        let Some((x, y)) = places.into_iter().find(is_free).filter(|_| !word.is_empty()) else { return };
        scene.add(Primitive::Rect {
            x: x - half - 1.0,
            y: y - 8.5,
            width: 2.0 * half + 2.0,
            height: 11.0,
            fill: "white".into(),
            stroke: None,
            stroke_width: None,
            opacity: Some(0.75),
        });
        text(scene, [x, y], TextAnchor::Middle, 10, word);
        self.words.push(([x, y], half));
    }

    fn axes(&self, scene: &mut Scene, map: &CellMap, is_first: bool) {
        let bottom = self.top + self.height;
        for (share, label) in &map.x.ticks {
            let (x, _) = self.at([*share, 0.0]);
            stroke_thin(scene, [x, bottom], [x, bottom + 4.0]);
            text(scene, [x, bottom + 16.0], TextAnchor::Middle, 10, label);
        }
        text(scene, [self.left + 0.5 * self.width, bottom + 32.0], TextAnchor::Middle, 11, &map.x.name);
        for (share, label) in &map.y.ticks {
            let (_, y) = self.at([0.0, *share]);
            stroke_thin(scene, [self.left - 4.0, y], [self.left, y]);
            if is_first {
                text(scene, [self.left - 6.0, y + 3.5], TextAnchor::End, 10, label);
            }
        }
        if is_first {
            let letters = map.y.ticks.iter().map(|(_, label)| label.chars().count()).max().unwrap_or(0);
            // Beside the longest label.
            let (x, y) = (self.left - (14.0 + TICK_LETTER * letters as f64).max(46.0), self.top + 0.5 * self.height);
            turned_text(scene, [x, y], TextAnchor::Middle, 11, &map.y.name, Some(-90.0));
        }
    }
}

/// Draws keys from the left, on as many lines as they need; gives the last of these (px).
fn draw_keys(scene: &mut Scene, keys: &[Key], y: f64) -> f64 {
    let (first, last) = ((0.06 * scene.width).min(60.0), scene.width - 10.0);
    let (mut x, mut y, mut lowest) = (first, y, y);
    for key in keys {
        let letters = |name: &String| LETTER * name.chars().count() as f64;
        let width = match key {
            Key::Line(_, name) | Key::Bar(name) => 38.0 + letters(name),
            Key::Swatch(_, name) => 30.0 + letters(name),
            Key::Scale { name, colors } => letters(name) + 10.0 + SHADE * colors.len() as f64,
        };
        if x > first && x + width > last {
            (x, y) = (first, y + LEGEND_LINE);
        }
        match key {
            Key::Line(style, name) => {
                stroke(scene, vec![(x, y - 4.0), (x + 30.0, y - 4.0)], style);
                text(scene, [x + 36.0, y], TextAnchor::Start, 11, name);
            }
            Key::Bar(name) => {
                bar(scene, (x, y - 4.0), (x + 30.0, y - 4.0));
                text(scene, [x + 38.0, y], TextAnchor::Start, 11, name);
            }
            Key::Swatch(fill, name) => {
                rect(scene, [x, y - 11.0], [22.0, 14.0], fill, true);
                text(scene, [x + 28.0, y], TextAnchor::Start, 11, name);
            }
            Key::Scale { name, colors } => {
                text(scene, [x, y], TextAnchor::Start, 11, name);
                for (at, (color, label)) in colors.iter().enumerate() {
                    let x = x + letters(name) + 10.0 + SHADE * at as f64;
                    rect(scene, [x, y - 10.0], [SHADE + 0.3, 12.0], color, false);
                    text(scene, [x + 0.5 * SHADE, y + 14.0], TextAnchor::Middle, 9, label);
                }
                lowest = y + 12.0;
            }
        }
        x += width + 24.0;
        lowest = lowest.max(y);
    }
    lowest
}

/// Width of a shade of a scale (px).
const SHADE: f64 = 9.0;

/// A line; a solid one has a white halo, so that it shows on any colour.
fn stroke(scene: &mut Scene, points: Vec<(f64, f64)>, style: &Style) {
    let dash = (!style.dash.is_empty()).then(|| style.dash.to_owned());
    if dash.is_none() {
        scene.add(Primitive::PolyLine {
            points: points.clone(),
            stroke: "#ffffff".into(),
            stroke_width: style.width + 1.6,
            stroke_dasharray: None,
        });
    }
    scene.add(Primitive::PolyLine { points, stroke: style.color.into(), stroke_width: style.width, stroke_dasharray: dash });
}

fn stroke_thin(scene: &mut Scene, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) {
    scene.add(Primitive::Line { x1, y1, x2, y2, stroke: "black".into(), stroke_width: 1.0, stroke_dasharray: None });
}

fn bar(scene: &mut Scene, from: (f64, f64), to: (f64, f64)) {
    stroke(scene, vec![from, to], &Style { color: "#000000", dash: "", width: 1.2 });
    for (cx, cy) in [from, to] {
        let (fill, stroke) = (Color::from("white"), Some(Color::from("black")));
        scene.add(Primitive::Circle { cx, cy, r: 2.6, fill, fill_opacity: None, stroke, stroke_width: Some(1.2) });
    }
}

fn rect(scene: &mut Scene, [x, y]: [f64; 2], [width, height]: [f64; 2], fill: &str, is_framed: bool) {
    let (stroke, stroke_width) = if is_framed { (Some("black".into()), Some(1.0)) } else { (None, None) };
    scene.add(Primitive::Rect { x, y, width, height, fill: fill.into(), stroke, stroke_width, opacity: None });
}

fn text(scene: &mut Scene, place: [f64; 2], anchor: TextAnchor, size: u32, content: &str) {
    turned_text(scene, place, anchor, size, content, None);
}

fn turned_text(scene: &mut Scene, [x, y]: [f64; 2], anchor: TextAnchor, size: u32, content: &str, rotate: Option<f64>) {
    if !content.is_empty() {
        scene.add(Primitive::Text { x, y, content: plain(content), size, anchor, rotate, bold: false, color: None });
    }
}

/// From dark blue (0) over green to yellow (1), evenly brighter: the stops are those of
/// matplotlib's viridis.
pub fn viridis(share: f64) -> String {
    kuva::plot::ColorMap::Viridis.map(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As many words as there is room for, and no two on each other.
    #[test]
    fn words_lie_inside_and_on_no_other() {
        let mut area = Area { left: 0.0, top: 0.0, width: 200.0, height: 100.0, words: Vec::new() };
        let mut scene = Scene::new(200.0, 100.0);
        (0..40).for_each(|_| area.word(&mut scene, "0.9", (0..200).map(|x| (f64::from(x), 50.0))));
        let places: Vec<f64> = area.words.iter().map(|([x, _], _)| *x).collect();
        assert!(places.len() > 5 && places.windows(2).all(|pair| pair[1] - pair[0] > 16.0), "{places:?}");
    }
}
