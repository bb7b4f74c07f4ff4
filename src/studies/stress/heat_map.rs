//! A stress map as a heat map in SVG: a panel a backend with the outcome of every cell, and one below with the error where an answer is known.
//!
//! Cells are rectangles of equal size, so that axes are those of their values: even on a logarithmic grid, zero and names included. Neighbours of one colour are
//! one rectangle.

use std::fmt::Write;

use crate::output::chart::axis::power_label;
use crate::studies::methods::Method;
use crate::studies::stress::{Axis, Map, Outcome, Row};

/// Size of the cells' area of a panel, and space around it (px).
const WIDTH: f64 = 260.0;
const HEIGHT: f64 = 210.0;
const NAMED_HEIGHT: f64 = 330.0;
const LEFT: f64 = 62.0;
const NAMED_LEFT: f64 = 210.0;
const GAP: f64 = 26.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 52.0;
const COLUMNS: usize = 3;
const LEGEND_LINE: f64 = 20.0;

/// Decades of the error's colours: from rounding to a hundred ways.
const LOWEST: f64 = -16.0;
const HIGHEST: f64 = 2.0;
const NOTHING: &str = "#eeeeee";

pub fn heat_map(map: &Map, rows: &[&Row]) -> String {
    let methods: Vec<Method> = Method::all_stressed().filter(|method| rows.iter().any(|row| row.method == *method)).collect();
    let has_errors = rows.iter().any(|row| row.numbers.error_share.is_some());
    let sheet = Sheet::of(map, methods.len(), has_errors);
    let mut svg = sheet.head(map);
    for (at, method) in methods.iter().enumerate() {
        let of_method: Vec<&Row> = rows.iter().filter(|row| row.method == *method).copied().collect();
        let outcomes: Vec<String> = of_method.iter().map(|row| outcome_color(row.outcome).to_owned()).collect();
        sheet.panel(&mut svg, map, at, method.key, &outcomes);
        if has_errors {
            let errors: Vec<String> = of_method.iter().map(|row| error_color(row.numbers.error_share)).collect();
            sheet.panel(&mut svg, map, at + sheet.n_slots, &format!("{}, error", method.key), &errors);
        }
    }
    sheet.legends(&mut svg, rows, has_errors);
    svg.push_str("</svg>\n");
    svg
}

/// Where things stand on the page.
struct Sheet {
    left: f64,
    area_height: f64,
    n_columns: usize,
    /// Places of panels in the block of outcomes; those of errors follow.
    n_slots: usize,
    n_rows: usize,
}

impl Sheet {
    fn of(map: &Map, n_methods: usize, has_errors: bool) -> Self {
        let is_named = !map.y.names.is_empty();
        let n_columns = n_methods.clamp(1, COLUMNS);
        let n_rows = n_methods.div_ceil(n_columns).max(1);
        Self {
            left: if is_named { NAMED_LEFT } else { LEFT },
            area_height: if is_named { NAMED_HEIGHT } else { HEIGHT },
            n_columns,
            n_slots: n_rows * n_columns,
            n_rows: if has_errors { 2 * n_rows } else { n_rows },
        }
    }

    fn row_height(&self) -> f64 {
        TOP + self.area_height + BOTTOM
    }

    fn width(&self) -> f64 {
        self.left + self.n_columns as f64 * (WIDTH + GAP) + 8.0
    }

    fn below_panels(&self) -> f64 {
        26.0 + self.n_rows as f64 * self.row_height()
    }

    fn head(&self, map: &Map) -> String {
        let (width, height) = (self.width(), self.below_panels() + 4.0 * LEGEND_LINE + 30.0);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"DejaVu Sans, Verdana, Liberation Sans, Arial, sans-serif\" font-size=\"11\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
        );
        text(&mut svg, [8.0, 18.0], Anchor::Start, 13.0, &format!("{}: {}", map.name, map.what));
        svg
    }

    /// Corner at the top left of the cells of a panel.
    fn corner(&self, slot: usize) -> [f64; 2] {
        let (column, row) = (slot % self.n_columns, slot / self.n_columns);
        [self.left + column as f64 * (WIDTH + GAP), 26.0 + row as f64 * self.row_height() + TOP]
    }

    fn panel(&self, svg: &mut String, map: &Map, slot: usize, title: &str, colors: &[String]) {
        let [left, top] = self.corner(slot);
        let (n_x, n_y) = (map.x.values.len(), map.y.values.len());
        let (width, height) = (WIDTH / n_x as f64, self.area_height / n_y as f64);
        text(svg, [left, top - 8.0], Anchor::Start, 12.0, title);
        for (row, colors) in colors.chunks(n_x).enumerate() {
            let y = top + self.area_height - (row + 1) as f64 * height;
            let mut from = 0;
            for run in colors.chunk_by(|one, next| one == next) {
                let (x, wide) = (left + from as f64 * width, run.len() as f64 * width);
                // A hair wider than it is, so that no seam shows between neighbours.
                writeln!(
                    svg,
                    "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"{}\"/>",
                    wide + 0.3,
                    height + 0.3,
                    run[0]
                )
                .expect("a string takes all");
                from += run.len();
            }
        }
        writeln!(svg, "<rect x=\"{left}\" y=\"{top}\" width=\"{WIDTH}\" height=\"{}\" fill=\"none\" stroke=\"black\"/>", self.area_height)
            .expect("a string takes all");
        self.x_axis(svg, &map.x, [left, top]);
        self.y_axis(svg, &map.y, [left, top], slot.is_multiple_of(self.n_columns));
    }

    fn x_axis(&self, svg: &mut String, axis: &Axis, [left, top]: [f64; 2]) {
        let bottom = top + self.area_height;
        for (at, label) in ticks(axis, 7) {
            let x = left + at * WIDTH;
            tick(svg, [x, bottom], [x, bottom + 4.0]);
            text(svg, [x, bottom + 16.0], Anchor::Middle, 10.0, &label);
        }
        text(svg, [left + 0.5 * WIDTH, bottom + 32.0], Anchor::Middle, 11.0, &title(axis.name));
    }

    fn y_axis(&self, svg: &mut String, axis: &Axis, [left, top]: [f64; 2], is_first: bool) {
        let size = if axis.names.is_empty() { 10.0 } else { 8.5 };
        for (at, label) in ticks(axis, 8) {
            let y = top + (1.0 - at) * self.area_height;
            tick(svg, [left - 4.0, y], [left, y]);
            if is_first {
                text(svg, [left - 6.0, y + 0.35 * size], Anchor::End, size, &label);
            }
        }
        if is_first && axis.names.is_empty() {
            let (x, y) = (left - 46.0, top + 0.5 * self.area_height);
            writeln!(
                svg,
                "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" transform=\"rotate(-90 {x} {y})\">{}</text>",
                escaped(&title(axis.name))
            )
            .expect("a string takes all");
        }
    }

    /// Outcomes that occur with their numbers, and the colours of errors.
    fn legends(&self, svg: &mut String, rows: &[&Row], has_errors: bool) {
        let (mut x, mut y) = (LEFT, self.below_panels() + LEGEND_LINE);
        for outcome in Outcome::ALL {
            let n = rows.iter().filter(|row| row.outcome == outcome).count();
            if n == 0 {
                continue;
            }
            if x > self.width() - 180.0 {
                (x, y) = (LEFT, y + LEGEND_LINE);
            }
            swatch(svg, [x, y - 10.0], 14.0, outcome_color(outcome));
            let label = format!("{} ({n})", outcome.name());
            text(svg, [x + 20.0, y], Anchor::Start, 11.0, &label);
            x += 40.0 + 7.2 * label.len() as f64;
        }
        if has_errors {
            self.error_legend(svg, y + 1.4 * LEGEND_LINE);
        }
    }

    fn error_legend(&self, svg: &mut String, y: f64) {
        text(svg, [LEFT, y], Anchor::Start, 11.0, "error over way");
        let n = (HIGHEST - LOWEST) as i32;
        for step in 0..=n {
            let (decade, x) = (LOWEST + f64::from(step), LEFT + 100.0 + 20.0 * f64::from(step));
            swatch(svg, [x, y - 10.0], 20.3, &error_color(Some(10f64.powf(decade))));
            if step % 3 == 0 {
                text(svg, [x + 10.0, y + 16.0], Anchor::Middle, 10.0, &power_label(decade));
            }
        }
        let x = LEFT + 130.0 + 20.0 * f64::from(n);
        swatch(svg, [x, y - 10.0], 14.0, NOTHING);
        text(svg, [x + 20.0, y], Anchor::Start, 11.0, "no answer to compare with");
    }
}

/// Okabe and Ito's colours for what is a finding, black and red for what is a defect.
fn outcome_color(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Finished => "#dcebf5",
        Outcome::Refused => "#c8c8c8",
        Outcome::Error => "#f0e442",
        Outcome::Drift => "#cc79a7",
        Outcome::Creep => "#009e73",
        Outcome::NotConverged => "#e69f00",
        Outcome::EnergyFromNowhere => "#d55e00",
        Outcome::TooLong => "#8c8c8c",
        Outcome::Failed => "#0072b2",
        Outcome::Unexplained => "#ff00ff",
        Outcome::NotFinite => "#000000",
        Outcome::Panicked => "#b00000",
    }
}

/// From dark blue (rounding) to yellow (a hundred ways).
fn error_color(error: Option<f64>) -> String {
    let Some(error) = error else { return NOTHING.to_owned() };
    // In tenths of the range, so that neighbours of one colour are one rectangle.
    let decade = error.max(1e-300).log10().clamp(LOWEST, HIGHEST).round();
    viridis((decade - LOWEST) / (HIGHEST - LOWEST))
}

/// From dark blue (0) over green to yellow (1), evenly brighter: the stops are those of matplotlib's viridis.
pub(crate) fn viridis(share: f64) -> String {
    const STOPS: [[f64; 3]; 6] =
        [[68.0, 1.0, 84.0], [65.0, 68.0, 135.0], [42.0, 120.0, 142.0], [34.0, 168.0, 132.0], [122.0, 209.0, 81.0], [253.0, 231.0, 37.0]];
    let at = share * (STOPS.len() - 1) as f64;
    let low = (at as usize).min(STOPS.len() - 2);
    let share = at - low as f64;
    let [r, g, b] = [0, 1, 2].map(|i| ((1.0 - share) * STOPS[low][i] + share * STOPS[low + 1][i]).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Places (share of the axis) and labels: names, or up to `most` values. Whole decades where the values go by factors.
fn ticks(axis: &Axis, most: usize) -> Vec<(f64, String)> {
    let n = axis.values.len();
    let middle = |at: f64| (at + 0.5) / n as f64;
    if !axis.names.is_empty() {
        return axis.names.iter().enumerate().map(|(at, name)| (middle(at as f64), (*name).to_owned())).collect();
    }
    let first = usize::from(axis.values[0] == 0.0);
    let zero = (first == 1).then(|| (middle(0.0), "0".to_owned()));
    let values = &axis.values[first..];
    let (low, high) = (values[0], values[values.len() - 1]);
    if low <= 0.0 || high / low < 50.0 {
        let step = n.div_ceil(most);
        return (0..n).step_by(step).map(|at| (middle(at as f64), format!("{:.2}", axis.values[at]))).collect();
    }
    let (low, high) = ((low.log10() - 1e-9).ceil() as i32, (high.log10() + 1e-9).floor() as i32);
    let step = ((high - low) as usize).div_ceil(most - 1).max(1);
    let place = |decade: i32| {
        let value = 10f64.powi(decade);
        let next = values.partition_point(|other| *other < value * (1.0 - 1e-9)).min(values.len() - 1);
        let before = next.saturating_sub(1);
        let (a, b) = (values[before].log10(), values[next].log10());
        let at = if b > a { before as f64 + (f64::from(decade) - a) / (b - a) } else { next as f64 };
        middle(first as f64 + at)
    };
    let decades = (low..=high).step_by(step).map(|decade| (place(decade), power_label(f64::from(decade))));
    zero.into_iter().chain(decades).collect()
}

/// `step_s` as `step (s)`.
fn title(name: &str) -> String {
    const UNITS: [(&str, &str); 8] = [
        ("_n_per_m", "N/m"),
        ("_m_per_s", "m/s"),
        ("_kg", "kg"),
        ("_rad", "rad"),
        ("_s", "s"),
        ("_h", "h"),
        ("_m", "m"),
        ("_rest_lengths", "rest lengths"),
    ];
    let plain = |name: &str| name.replace('_', " ");
    let unit = UNITS.iter().find(|(ending, _)| name.ends_with(ending));
    unit.map_or_else(|| plain(name), |(ending, unit)| format!("{} ({unit})", plain(name.strip_suffix(ending).unwrap_or(name))))
}

pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

pub(crate) fn text(svg: &mut String, [x, y]: [f64; 2], anchor: Anchor, size: f64, content: &str) {
    let anchor = match anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-size=\"{size}\">{}</text>", escaped(content))
        .expect("a string takes all");
}

pub(crate) fn tick(svg: &mut String, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) {
    writeln!(svg, "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"black\"/>").expect("a string takes all");
}

pub(crate) fn swatch(svg: &mut String, [x, y]: [f64; 2], width: f64, color: &str) {
    writeln!(svg, "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width}\" height=\"12\" fill=\"{color}\"/>").expect("a string takes all");
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_stand_at_the_cells_of_their_values() {
        let axis = Axis::log("step_s", 1e-6, 1.0, 7).and_zero();
        let labels = ticks(&axis, 7);
        assert_eq!(labels.len(), 8);
        assert_eq!((labels[0].1.as_str(), labels[1].1.as_str(), labels[7].1.as_str()), ("0", "10⁻⁶", "10⁰"));
        // The middle of the second of eight cells, and of the last.
        assert!((labels[1].0 - 1.5 / 8.0).abs() < 1e-9 && (labels[7].0 - 7.5 / 8.0).abs() < 1e-9, "{labels:?}");
    }

    #[test]
    fn names_become_titles_with_units() {
        for (name, expected) in [
            ("step_s", "step (s)"),
            ("stiffness_n_per_m", "stiffness (N/m)"),
            ("speed_m_per_s", "speed (m/s)"),
            ("margin_share", "margin share"),
        ] {
            assert_eq!(title(name), expected);
        }
    }

    #[test]
    fn colours_of_errors_end_at_their_range() {
        assert_eq!(error_color(Some(0.0)), error_color(Some(1e-16)));
        assert_eq!(error_color(Some(1e9)), "#fde725");
        assert_eq!(error_color(None), NOTHING);
    }
}
