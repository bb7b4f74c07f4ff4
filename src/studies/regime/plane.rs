//! A panel over the plane of Phi and epsilon: cells as rectangles about their points, lines over them, both axes logarithmic.

use std::fmt::Write;

use crate::output::chart::axis::power_label;
use crate::studies::regime::Grid;
use crate::studies::stress::heat_map::{Anchor, escaped, text, tick, viridis};

/// Size of a panel and space around it (px).
pub const WIDTH: f64 = 226.0;
pub const HEIGHT: f64 = 196.0;
pub const LEFT: f64 = 66.0;
pub const GAP: f64 = 18.0;
pub const TOP: f64 = 30.0;
pub const BOTTOM: f64 = 46.0;
/// Above all panels (px).
pub const HEAD: f64 = 30.0;

/// What a cell shows.
#[derive(Clone, Debug, PartialEq)]
pub enum Fill {
    Color(String),
    /// Below what the paths' own errors could make.
    Unresolved,
    /// Nothing moves.
    Rests,
    /// No path was found.
    NotFound,
    /// Nothing is said here.
    Nothing,
}

/// How a line over the cells looks: solid ones are drawn twice, once wide in white, so that they show on any colour; dashes show what is beneath.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    pub color: &'static str,
    pub dash: &'static str,
    pub width: f64,
}

/// Of what was measured.
pub const MEASURED: Pen = Pen { color: "#000000", dash: "", width: 2.2 };
pub const MEASURED_ABOVE: Pen = Pen { color: "#000000", dash: "", width: 1.1 };
/// Of what theory expects.
pub const PREDICTED: Pen = Pen { color: "#d0006f", dash: "7 4", width: 2.0 };
pub const PREDICTED_ABOVE: Pen = Pen { color: "#d0006f", dash: "2 3", width: 2.0 };
/// Of the rules of thumb.
pub const RULE: Pen = Pen { color: "#333333", dash: "1.5 3", width: 1.6 };

pub fn head(width: f64, height: f64, title: &str) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"DejaVu Sans, Verdana, Liberation Sans, Arial, sans-serif\" font-size=\"11\">\n\
         <defs>\n\
         <pattern id=\"rests\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\"><rect width=\"7\" height=\"7\" fill=\"#f2f2f2\"/>\
         <circle cx=\"3.5\" cy=\"3.5\" r=\"0.9\" fill=\"#888888\"/></pattern>\n\
         <pattern id=\"unresolved\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\"><rect width=\"6\" height=\"6\" fill=\"#ffffff\"/>\
         <path d=\"M-1,5 l2,2 M0,0 l6,6 M5,-1 l2,2\" stroke=\"#777777\" stroke-width=\"1\"/></pattern>\n\
         <pattern id=\"lost\" width=\"8\" height=\"8\" patternUnits=\"userSpaceOnUse\"><rect width=\"8\" height=\"8\" fill=\"#bbbbbb\"/>\
         <path d=\"M0,0 l8,8 M8,0 l-8,8\" stroke=\"#000000\" stroke-width=\"0.8\"/></pattern>\n\
         </defs>\n<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
    );
    text(&mut svg, [10.0, 20.0], Anchor::Start, 14.0, title);
    svg
}

/// One panel on its page.
pub struct Plane<'a> {
    pub grid: &'a Grid,
    /// Corner at the top left of the cells (px).
    pub corner: [f64; 2],
    /// Middles and half widths of the words that stand in it (px).
    words: Vec<([f64; 2], f64)>,
}

impl<'a> Plane<'a> {
    /// In this column and row of panels.
    pub fn at(grid: &'a Grid, column: usize, row: usize) -> Self {
        let corner = [LEFT + column as f64 * (WIDTH + GAP), HEAD + row as f64 * (TOP + HEIGHT + BOTTOM) + TOP];
        Self { grid, corner, words: Vec::new() }
    }

    /// Logarithms (decimal) of the lowest and highest edge of the cells.
    fn span(values: &[f64]) -> [f64; 2] {
        let [low, high] = [values[0].log10(), values[values.len() - 1].log10()];
        let half = 0.5 * (high - low) / (values.len() - 1).max(1) as f64;
        [low - half, high + half]
    }

    /// Place of a point of the plane (px).
    pub fn place(&self, phi: f64, epsilon: f64) -> [f64; 2] {
        let share = |value: f64, [low, high]: [f64; 2]| (value.log10() - low) / (high - low);
        let (x, y) = (share(phi, Self::span(&self.grid.phis)), share(epsilon, Self::span(&self.grid.epsilons)));
        [self.corner[0] + x * WIDTH, self.corner[1] + (1.0 - y) * HEIGHT]
    }

    /// `fills` in rows of equal epsilon, and the frame that what is drawn over them may be kept within.
    pub fn cells(&self, svg: &mut String, fills: &[Fill]) {
        let ([left, top], name) = (self.corner, self.frame_name());
        writeln!(svg, "<clipPath id=\"{name}\"><rect x=\"{left}\" y=\"{top}\" width=\"{WIDTH}\" height=\"{HEIGHT}\"/></clipPath>")
            .expect("a string takes all");
        let (n, m) = (self.grid.phis.len(), self.grid.epsilons.len());
        let (width, height) = (WIDTH / n as f64, HEIGHT / m as f64);
        for (row, fills) in fills.chunks(n).enumerate() {
            let y = self.corner[1] + HEIGHT - (row + 1) as f64 * height;
            let mut from = 0;
            for run in fills.chunk_by(|one, next| one == next) {
                let (x, wide) = (self.corner[0] + from as f64 * width, run.len() as f64 * width);
                let paint = paint(&run[0]);
                // A hair wider than it is, so that no seam shows between neighbours.
                let (wide, high) = (wide + 0.3, height + 0.3);
                writeln!(svg, "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{wide:.1}\" height=\"{high:.1}\" fill=\"{paint}\"/>")
                    .expect("a string takes all");
                from += run.len();
            }
        }
    }

    /// Frame, ticks at decades, and names of the axes where they are wanted.
    pub fn frame(&self, svg: &mut String, title: &str, y_name: Option<&str>) {
        let [left, top] = self.corner;
        text(svg, [left, top - 8.0], Anchor::Start, 12.0, title);
        writeln!(svg, "<rect x=\"{left}\" y=\"{top}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"none\" stroke=\"black\"/>")
            .expect("a string takes all");
        for decade in decades(Self::span(&self.grid.phis)) {
            let [x, _] = self.place(10f64.powi(decade), 1.0);
            tick(svg, [x, top + HEIGHT], [x, top + HEIGHT + 4.0]);
            text(svg, [x, top + HEIGHT + 16.0], Anchor::Middle, 10.0, &decade_label(decade));
        }
        text(svg, [left + 0.5 * WIDTH, top + HEIGHT + 31.0], Anchor::Middle, 11.0, "Phi = omega_n T_e");
        for decade in decades(Self::span(&self.grid.epsilons)) {
            let [_, y] = self.place(1.0, 10f64.powi(decade));
            tick(svg, [left - 4.0, y], [left, y]);
            if y_name.is_some() {
                text(svg, [left - 6.0, y + 3.5], Anchor::End, 10.0, &decade_label(decade));
            }
        }
        if let Some(name) = y_name {
            let (x, y) = (left - 44.0, top + 0.5 * HEIGHT);
            writeln!(svg, "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" transform=\"rotate(-90 {x} {y})\">{}</text>", escaped(name))
                .expect("a string takes all");
        }
    }

    /// A line through points (Phi, epsilon).
    pub fn line(&self, svg: &mut String, points: &[[f64; 2]], pen: &Pen) {
        let at: Vec<String> =
            points.iter().map(|[phi, epsilon]| self.place(*phi, *epsilon)).map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        stroke(svg, &at.join(" "), pen);
    }

    /// Planes of several figures on a page may have the same name where they have the same frame.
    fn frame_name(&self) -> String {
        let [left, top] = self.corner;
        format!("plane-{left:.0}-{top:.0}")
    }

    /// What is drawn, as far as it lies within the frame of the cells.
    pub fn inside(&self, svg: &mut String, draw: impl FnOnce(&mut String)) {
        writeln!(svg, "<g clip-path=\"url(#{})\">", self.frame_name()).expect("a string takes all");
        draw(svg);
        svg.push_str("</g>\n");
    }

    /// A word on a white halo, at the first of these points (Phi, epsilon) at which it lies in the frame and on no other; none where there is no such point.
    pub fn label(&mut self, svg: &mut String, points: impl IntoIterator<Item = [f64; 2]>, size: f64, content: &str) {
        // Letters are about half as wide as high.
        let half = 0.25 * size * content.chars().count() as f64;
        let is_free = |[x, y]: &[f64; 2]| {
            let is_aside = |([other_x, other_y], other): &([f64; 2], f64)| (x - other_x).abs() > half + other || (y - other_y).abs() > size;
            let ([right, down], is_in) = ([x - self.corner[0], y - self.corner[1]], |at: f64, low: f64, high: f64| low <= at && at <= high);
            is_in(right, half, WIDTH - half) && is_in(down, size, HEIGHT) && self.words.iter().all(is_aside)
        };
        if let Some(place) = points.into_iter().map(|[phi, epsilon]| self.place(phi, epsilon)).find(is_free) {
            haloed(svg, place, size, content);
            self.words.push((place, half));
        }
    }
}

/// A line through places (px).
pub fn stroke(svg: &mut String, points: &str, Pen { color, dash, width }: &Pen) {
    let halo = width + 1.6;
    if dash.is_empty() {
        writeln!(svg, "<polyline points=\"{points}\" fill=\"none\" stroke=\"white\" stroke-opacity=\"0.75\" stroke-width=\"{halo}\"/>")
            .expect("a string takes all");
    }
    writeln!(svg, "<polyline points=\"{points}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-dasharray=\"{dash}\"/>")
        .expect("a string takes all");
}

pub fn haloed(svg: &mut String, [x, y]: [f64; 2], size: f64, content: &str) {
    let content = escaped(content);
    for style in ["stroke=\"white\" stroke-width=\"3\" stroke-linejoin=\"round\" fill=\"white\" fill-opacity=\"0.9\"", "fill=\"black\""] {
        writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" font-size=\"{size}\" {style}>{content}</text>")
            .expect("a string takes all");
    }
}

pub fn paint(fill: &Fill) -> &str {
    match fill {
        Fill::Color(color) => color,
        Fill::Unresolved => "url(#unresolved)",
        Fill::Rests => "url(#rests)",
        Fill::NotFound => "url(#lost)",
        Fill::Nothing => "#ffffff",
    }
}

/// Decades of the share's colours.
pub const SHARES: [f64; 2] = [-4.0, 0.0];

/// From dark (1e-4 of the way and less) to bright (the whole way and more), in tenths of a decade.
pub fn share_color(share: f64) -> String {
    let decade = (10.0 * share.max(1e-300).log10()).round() / 10.0;
    viridis((decade.clamp(SHARES[0], SHARES[1]) - SHARES[0]) / (SHARES[1] - SHARES[0]))
}

/// From blue (a quarter and less) over white (one) to orange (four and more), in twentieths.
pub fn ratio_color(ratio: f64) -> String {
    let power = (10.0 * ratio.max(1e-300).log2()).round() / 10.0;
    let share = (0.5 * power.abs()).clamp(0.0, 1.0).powf(0.7);
    let end = if power < 0.0 { [8.0, 69.0, 148.0] } else { [191.0, 84.0, 0.0] };
    let [r, g, b] = end.map(|end: f64| (255.0 + share * (end - 255.0)).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn decades([low, high]: [f64; 2]) -> impl Iterator<Item = i32> {
    (low - 1e-9).ceil() as i32..=(high + 1e-9).floor() as i32
}

fn decade_label(decade: i32) -> String {
    match decade {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        2 => "100".to_owned(),
        _ => power_label(f64::from(decade)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::regime::{Effort, Scene};

    /// Points stand in the middle of their cells: the first half a cell from the edge, the last as far from the other.
    #[test]
    fn points_stand_in_the_middle_of_their_cells() {
        let grid = Grid::of(Scene::Excursion, Effort::Quick);
        let plane = Plane { grid: &grid, corner: [0.0, 0.0], words: Vec::new() };
        let [x, y] = plane.place(grid.phis[0], grid.epsilons[0]);
        assert!((x - WIDTH / 12.0).abs() < 1e-9 && (y - HEIGHT * 11.0 / 12.0).abs() < 1e-9);
        let [x, y] = plane.place(grid.phis[5], grid.epsilons[5]);
        assert!((x - WIDTH * 11.0 / 12.0).abs() < 1e-9 && (y - HEIGHT / 12.0).abs() < 1e-9);
    }

    /// Along one line, as many words as it has room for, each aside of the others; where the first point of the next lies under one of them, a later one takes it.
    #[test]
    fn words_lie_in_the_frame_and_on_no_other() {
        let grid = Grid::of(Scene::Excursion, Effort::Quick);
        let (mut plane, mut svg) = (Plane::at(&grid, 0, 0), String::new());
        let middle = grid.epsilons[2];
        let line: Vec<[f64; 2]> =
            (0..200).map(|k| [grid.phis[0] * (grid.phis[5] / grid.phis[0]).powf(f64::from(k) / 199.0), middle]).collect();
        (0..40).for_each(|_| plane.label(&mut svg, line.iter().copied(), 10.0, "0.9"));
        let places: Vec<f64> = plane.words.iter().map(|([x, _], _)| x - plane.corner[0]).collect();
        // Words of 7.5 px a half on either side.
        assert!(places.len() > 5 && places.windows(2).all(|pair| pair[1] - pair[0] > 15.0), "{places:?}");
        assert!(places.iter().all(|x| (7.5..=WIDTH - 7.5).contains(x)));
        assert_eq!(svg.matches(">0.9<").count(), 2 * places.len(), "each with its halo, and no more than have room");
    }

    #[test]
    fn colours_end_at_their_ranges_and_part_at_one() {
        assert_eq!((share_color(1e-9), share_color(7.0)), (share_color(1e-4), share_color(1.0)));
        assert_eq!((ratio_color(1.0), ratio_color(9.0), ratio_color(0.0)), ("#ffffff".to_owned(), ratio_color(4.0), ratio_color(0.25)));
        assert_ne!(ratio_color(0.8), ratio_color(1.25));
    }
}
