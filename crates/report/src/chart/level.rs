//! Lines of equal value of a field over the cells of a map.

use kuva::plot::ContourPlot;
use kuva::render::render::{Primitive, render_multiple};

use crate::chart::canvas::axes_between;
use crate::chart::panel::Style;

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

impl Level {
    /// The lines (px) in a panel of `[n_x, n_y]` cells whose upper left corner and size these are.
    pub(super) fn lines(&self, [left, top]: [f64; 2], [width, height]: [f64; 2], [n_x, n_y]: [usize; 2]) -> Vec<Vec<(f64, f64)>> {
        let nodes = |n: usize| (0..n).map(|i| i as f64 / (n.max(2) - 1) as f64).collect::<Vec<f64>>();
        let (n, m) = (self.field.first().map_or(0, Vec::len), self.field.len());
        let plot = ContourPlot::new().with_grid(self.field.clone(), nodes(n), nodes(m)).with_levels(&[self.at]).with_line_color("black");
        let (inner_width, inner_height) = (width * (1.0 - 1.0 / n_x as f64), height * (1.0 - 1.0 / n_y as f64));
        let layout = axes_between((0.0, 1.0), (0.0, 1.0), [inner_width, inner_height], [0.0; 4]);
        let drawn = render_multiple(vec![plot.into()], layout);
        let paths = drawn.elements.into_iter().filter_map(|it| if let Primitive::Path(path) = it { Some(path.d) } else { None });
        let (x, y) = (left + 0.5 * (width - inner_width), top + 0.5 * (height - inner_height));
        let lines = joined(paths.flat_map(|path| segments(&path)).collect());
        lines.into_iter().map(|line| line.into_iter().map(|[px, py]| (x + px, y + py)).collect()).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle by the chords of a grid is one closed line; squares with a missing value have none.
    #[test]
    fn lines_of_equal_value_are_whole_and_leave_gaps() {
        let field = |hole: bool| -> Vec<Vec<f64>> {
            let axis = || (-10..=10).map(|i| 0.1 * f64::from(i));
            axis().map(|y| axis().map(|x| if hole && x > 0.0 { f64::NAN } else { x.hypot(y) }).collect()).collect()
        };
        let style = Style { color: "#d0006f", dash: "7 4", width: 2.0 };
        let drawn = |hole: bool| Level { field: field(hole), at: 0.73, style, word: "" }.lines([0.0; 2], [210.0; 2], [21; 2]);
        let lines = drawn(false);
        assert_eq!(lines.len(), 1);
        let line = &lines[0];
        // 73 px about the middle of the panel, to the square of the grid over eight radii.
        assert!(line.iter().all(|(x, y)| ((x - 105.0).hypot(y - 105.0) - 73.0).abs() < 0.3), "{line:?}");
        assert!((line[0].0 - line[line.len() - 1].0).abs() < 0.1);
        let half = drawn(true).concat();
        assert!(!half.is_empty() && half.iter().all(|(x, _)| *x < 106.0), "{half:?}");
    }
}
