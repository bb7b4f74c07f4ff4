//! Maps of cells: panels of coloured cells over two parameters, with lines of equal value and other
//! lines over them, side by side on one page with a legend below.
//!
//! Cells of a panel have equal size, so that an axis may be linear or logarithmic, begin at zero or
//! have names. Places on a panel are shares of its width and height (0 to 1, from the lower left).

use kuva::backend::svg::SvgBackend;
use kuva::plot::ContourPlot;
use kuva::render::color::Color;
use kuva::render::layout::Layout;
use kuva::render::render::{Primitive, Scene, TextAnchor, render_multiple};

use crate::output::chart::axis::power_label;
use crate::output::chart::canvas::{FONTS, plain};
use crate::output::chart::panel::Style;

/// One panel.
#[derive(Clone, Debug, Default)]
pub struct CellMap {
    pub title: String,
    pub x: CellAxis,
    pub y: CellAxis,
    /// Colours or patterns of the cells, row by row from the lowest one.
    pub fills: Vec<String>,
    /// Lines over the cells.
    pub lines: Vec<(Vec<[f64; 2]>, Style)>,
    pub levels: Vec<Level>,
    /// Bars between two places, with a dot at both ends.
    pub bars: Vec<[[f64; 2]; 2]>,
    /// Words on free places: each stands at the first of its places where it fits.
    pub words: Vec<(String, Vec<[f64; 2]>)>,
}

/// An axis of a panel.
#[derive(Clone, Debug, Default)]
pub struct CellAxis {
    pub name: String,
    /// Number of cells.
    pub n: usize,
    /// Places of the ticks and their labels.
    pub ticks: Vec<(f64, String)>,
}

/// The lines on which a field has one value, with a word on the longest of them.
#[derive(Clone, Debug)]
pub struct Level {
    /// Values of the field in rows of equal y, from the middles of the first cells to those of the
    /// last; NaN where there is none.
    pub field: Vec<Vec<f64>>,
    pub at: f64,
    pub style: Style,
    pub word: &'static str,
}

/// Part of a legend.
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
const GAP: f64 = 20.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 48.0;
const HEAD: f64 = 28.0;
const LEGEND_LINE: f64 = 23.0;
/// Mean advance of a letter of the legend (px).
const LETTER: f64 = 6.6;

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
    let n_columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let inner = n_columns.max(size.least_columns) as f64 * (size.width + GAP);
    let width = (inner / n_columns.max(1) as f64 - GAP).min(2.0 * size.width);
    let mut scene = Scene::new(size.left + inner, 0.0);
    scene.font_family = Some(FONTS.to_owned());
    scene.text_color = Some("black".to_owned());
    scene.defs.extend(PATTERNS.map(str::to_owned));
    text(&mut scene, [8.0, 18.0], TextAnchor::Start, 13, title);
    let row_height = TOP + size.height + BOTTOM;
    for (row, maps) in rows.iter().enumerate() {
        for (column, map) in maps.iter().enumerate() {
            let left = size.left + column as f64 * (width + GAP);
            let top = HEAD + row as f64 * row_height + TOP;
            Area { left, top, width, height: size.height, words: Vec::new() }.draw(&mut scene, map, column == 0);
        }
    }
    let mut y = HEAD + rows.len() as f64 * row_height + LEGEND_LINE;
    for keys in legend {
        y = draw_keys(&mut scene, keys, y) + LEGEND_LINE;
    }
    scene.height = y;
    let svg = SvgBackend::new().render_scene(&scene);
    svg.replacen("<svg ", &format!("<svg viewBox=\"0 0 {} {}\" ", scene.width, scene.height), 1)
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
        let longest: Vec<Vec<(f64, f64)>> = map.levels.iter().map(|level| self.level(scene, map, level)).collect();
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

    /// Draws the lines of a level and returns the longest of them.
    fn level(&self, scene: &mut Scene, map: &CellMap, level: &Level) -> Vec<(f64, f64)> {
        let nodes = |n: usize| (0..n).map(|i| i as f64 / (n.max(2) - 1) as f64).collect::<Vec<f64>>();
        let (n, m) = (level.field.first().map_or(0, Vec::len), level.field.len());
        let plot = ContourPlot::new().with_grid(level.field.clone(), nodes(n), nodes(m)).with_levels(&[level.at]).with_line_color("black");
        let (width, height) = (self.width * (1.0 - 1.0 / map.x.n as f64), self.height * (1.0 - 1.0 / map.y.n as f64));
        let layout = Layout::new((0.0, 1.0), (0.0, 1.0))
            .with_width(width)
            .with_height(height)
            .with_force_margins(0.0, 0.0)
            .with_force_margins_y(0.0, 0.0)
            .with_x_axis_min(0.0)
            .with_x_axis_max(1.0)
            .with_y_axis_min(0.0)
            .with_y_axis_max(1.0)
            .with_show_grid(false);
        let drawn = render_multiple(vec![plot.into()], layout);
        let paths = drawn.elements.into_iter().filter_map(|it| if let Primitive::Path(path) = it { Some(path.d) } else { None });
        let (x, y) = (self.left + 0.5 * (self.width - width), self.top + 0.5 * (self.height - height));
        let lines = joined(paths.flat_map(|path| segments(&path)).collect());
        let lines: Vec<Vec<(f64, f64)>> =
            lines.into_iter().map(|line| line.into_iter().map(|[px, py]| (x + px, y + py)).collect()).collect();
        lines.iter().for_each(|line| stroke(scene, line.clone(), &level.style));
        lines.into_iter().max_by_key(Vec::len).unwrap_or_default()
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
        if is_first && !map.y.name.is_empty() {
            let (x, y) = (self.left - 46.0, self.top + 0.5 * self.height);
            let content = plain(&map.y.name);
            scene.add(Primitive::Text {
                x,
                y,
                content,
                size: 11,
                anchor: TextAnchor::Middle,
                rotate: Some(-90.0),
                bold: false,
                color: None,
            });
        }
    }
}

/// Ends of the segments in the path of a contour plot, without those that touch a missing value.
fn segments(path: &str) -> Vec<[[f64; 2]; 2]> {
    let numbers: Vec<f64> = path.split_whitespace().filter_map(|word| word.trim_start_matches(['M', 'L']).parse().ok()).collect();
    let segments = numbers.chunks_exact(4).map(|ends| [[ends[0], ends[1]], [ends[2], ends[3]]]);
    segments.filter(|segment| segment.iter().flatten().all(|value| value.is_finite())).collect()
}

/// The segments as whole lines, so that dashes run on from one to the next.
fn joined(mut segments: Vec<[[f64; 2]; 2]>) -> Vec<Vec<[f64; 2]>> {
    let mut lines = Vec::new();
    while let Some([a, b]) = segments.pop() {
        let mut line = vec![a, b];
        for _ in 0..2 {
            let is_end = |end: &[f64; 2], line: &Vec<[f64; 2]>| {
                let last = line[line.len() - 1];
                (end[0] - last[0]).abs() + (end[1] - last[1]).abs() < 0.03
            };
            while let Some(at) = segments.iter().position(|ends| ends.iter().any(|end| is_end(end, &line))) {
                let [a, b] = segments.swap_remove(at);
                line.push(if is_end(&a, &line) { b } else { a });
            }
            // Then on from its other end.
            line.reverse();
        }
        lines.push(line);
    }
    lines
}

/// Draws keys from the left, on as many lines as they need; gives the last of these (px).
fn draw_keys(scene: &mut Scene, keys: &[Key], y: f64) -> f64 {
    let (first, last) = (60.0, scene.width - 10.0);
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

fn text(scene: &mut Scene, [x, y]: [f64; 2], anchor: TextAnchor, size: u32, content: &str) {
    if !content.is_empty() {
        scene.add(Primitive::Text { x, y, content: plain(content), size, anchor, rotate: None, bold: false, color: None });
    }
}

/// From dark blue (0) over green to yellow (1), evenly brighter: the stops are those of
/// matplotlib's viridis.
pub fn viridis(share: f64) -> String {
    kuva::plot::ColorMap::Viridis.map(share)
}

impl CellAxis {
    /// An axis of cells about `values`, with up to `most` ticks: whole decades where the values go
    /// by factors over more than 50, zero apart.
    pub fn of(name: impl Into<String>, values: &[f64], most: usize) -> Self {
        let n = values.len();
        let first = usize::from(values[0] == 0.0);
        let (low, high) = (values[first], values[n - 1]);
        if low > 0.0 && high / low >= 50.0 {
            return Self::decades(name, values, most);
        }
        let tick = |at: usize| ((at as f64 + 0.5) / n as f64, format!("{:.2}", values[at]));
        Self { name: name.into(), n, ticks: (0..n).step_by(n.div_ceil(most)).map(tick).collect() }
    }

    /// An axis of cells about `values`, which go by factors and may begin with zero, with up to
    /// `most` ticks at whole decades.
    pub fn decades(name: impl Into<String>, values: &[f64], most: usize) -> Self {
        let (n, first) = (values.len(), usize::from(values[0] == 0.0));
        let middle = |at: f64| (at + 0.5) / n as f64;
        let above = &values[first..];
        let (low, high) = ((above[0].log10() - 1e-9).ceil() as i32, (above[above.len() - 1].log10() + 1e-9).floor() as i32);
        let step = ((high - low).max(1) as usize).div_ceil(most - 1);
        let label =
            |decade: i32| if (0..3).contains(&decade) { 10_i32.pow(decade as u32).to_string() } else { power_label(f64::from(decade)) };
        let tick = |decade: i32| (middle(first as f64 + place(above, 10f64.powi(decade))), label(decade));
        let zero = (first == 1).then(|| (middle(0.0), "0".to_owned()));
        Self { name: name.into(), n, ticks: zero.into_iter().chain((low..=high).step_by(step).map(tick)).collect() }
    }

    /// An axis of cells with names.
    pub fn of_names(names: &[&str]) -> Self {
        let n = names.len();
        let ticks = names.iter().enumerate().map(|(at, name)| ((at as f64 + 0.5) / n as f64, (*name).to_owned())).collect();
        Self { name: String::new(), n, ticks }
    }
}

/// Place of `value` among `values`, which go by factors: 0 at the first, 1 at the second.
pub fn place(values: &[f64], value: f64) -> f64 {
    let next = values.partition_point(|other| *other < value * (1.0 - 1e-9)).clamp(1, values.len().max(2) - 1);
    let (Some(a), Some(b)) = (values.get(next - 1), values.get(next)) else { return 0.0 };
    next as f64 - 1.0 + (value.log10() - a.log10()) / (b.log10() - a.log10())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_stand_at_the_cells_of_their_values() {
        let values: Vec<f64> = std::iter::once(0.0).chain((-6..=0).map(|decade| 10f64.powi(decade))).collect();
        let ticks = CellAxis::of("step", &values, 7).ticks;
        assert_eq!(ticks.len(), 8);
        assert_eq!((ticks[0].1.as_str(), ticks[1].1.as_str(), ticks[7].1.as_str()), ("0", "10⁻⁶", "1"));
        // The middle of the second of eight cells, and of the last.
        assert!((ticks[1].0 - 1.5 / 8.0).abs() < 1e-9 && (ticks[7].0 - 7.5 / 8.0).abs() < 1e-9, "{ticks:?}");
        assert!((place(&[0.3, 3.0, 30.0], 0.03) + 1.0).abs() < 1e-12, "beyond the first value");
    }

    /// A circle by the chords of a grid is one closed line; squares with a missing value have none.
    #[test]
    fn lines_of_equal_value_are_whole_and_leave_gaps() {
        let field = |hole: bool| -> Vec<Vec<f64>> {
            let axis = || (-10..=10).map(|i| 0.1 * f64::from(i));
            axis().map(|y| axis().map(|x| if hole && x > 0.0 { f64::NAN } else { x.hypot(y) }).collect()).collect()
        };
        let style = Style { color: "#d0006f", dash: "7 4", width: 2.0 };
        let axis = CellAxis { n: 21, ..CellAxis::default() };
        let map = CellMap { x: axis.clone(), y: axis, ..CellMap::default() };
        let area = Area { left: 0.0, top: 0.0, width: 210.0, height: 210.0, words: Vec::new() };
        let drawn = |hole: bool| {
            let mut scene = Scene::new(210.0, 210.0);
            let line = area.level(&mut scene, &map, &Level { field: field(hole), at: 0.73, style, word: "" });
            (scene.elements.len(), line)
        };
        let (n_lines, line) = drawn(false);
        assert_eq!(n_lines, 1);
        // 73 px about the middle of the panel, to the square of the grid over eight radii.
        assert!(line.iter().all(|(x, y)| ((x - 105.0).hypot(y - 105.0) - 73.0).abs() < 0.3), "{line:?}");
        assert!((line[0].0 - line[line.len() - 1].0).abs() < 0.1);
        let (_, half) = drawn(true);
        assert!(!half.is_empty() && half.iter().all(|(x, _)| *x < 106.0), "{half:?}");
    }

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
