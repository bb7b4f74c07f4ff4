//! Units that fit the values of a panel.

use crate::chart::panel::{Across, Panel, Scale};

/// Prefixes of SI units and what they stand for, from large to small.
const PREFIXES: [(&str, f64); 5] = [("k", 1e3), ("", 1.0), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9)];

/// Prefix with which values up to `largest` are numbers below 1000, and the factor to such numbers.
fn fitting(largest: f64) -> (&'static str, f64) {
    if !(largest > 0.0 && largest.is_finite()) {
        return ("", 1.0);
    }
    // Rounded as ticks are: 999.9999999 mm is a metre.
    let fits = |(_, size): &&(&str, f64)| largest * (1.0 + 1e-9) >= *size;
    let (prefix, size) = PREFIXES.iter().find(fits).unwrap_or(&PREFIXES[PREFIXES.len() - 1]);
    (prefix, (1.0 / size).round().max(1e-3))
}

impl Panel {
    /// The panel, whose values are in `unit`, with the prefix that fits the largest one. The labels
    /// say the unit: of both axes of a plane, else of the y axis.
    pub(super) fn in_fitting_unit(mut self, unit: &str) -> Self {
        let is_plane = self.scale == Scale::Plane;
        let first = if is_plane { 0 } else { 1 };
        let of_points = self.curves.iter().flat_map(|curve| &curve.points).flat_map(|point| &point[first..]);
        let levels = self.marks.iter().filter_map(|mark| mark.at.level());
        let sizes = of_points.copied().chain(levels).filter(|value| value.is_finite()).map(f64::abs);
        let (prefix, factor) = fitting(sizes.fold(0.0, f64::max).min(self.ceiling.unwrap_or(f64::INFINITY)));
        for curve in &mut self.curves {
            curve.points.iter_mut().flat_map(|point| &mut point[first..]).for_each(|value| *value *= factor);
            for column in &mut curve.columns {
                [&mut column.low, &mut column.mean, &mut column.high].into_iter().for_each(|value| *value *= factor);
            }
        }
        for mark in &mut self.marks {
            if let Across::Horizontal(level) = &mut mark.at {
                *level *= factor;
            }
        }
        self.ceiling = self.ceiling.map(|ceiling| factor * ceiling);
        let labels = if is_plane { vec![&mut self.x_label, &mut self.y_label] } else { vec![&mut self.y_label] };
        labels.into_iter().for_each(|label| *label = format!("{label} ({prefix}{unit})"));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::panel::{Curve, Mark, Shape, Style};

    #[test]
    fn the_largest_value_chooses_the_prefix() {
        for (largest, prefix, number) in [
            (2.0, "", 2.0),
            (0.672, "m", 672.0),
            (20.0, "", 20.0),
            (2e3, "k", 2.0),
            (5e6, "k", 5e3),
            (4e-6, "µ", 4.0),
            (7e-10, "n", 0.7),
            (0.0, "", 0.0),
        ] {
            let (found, factor) = fitting(largest);
            // One rounding of a product.
            assert!(found == prefix && (largest * factor - number).abs() <= 1e-15 * number, "{largest}: {found}");
        }
    }

    /// A mark counts as the curves do, and all values of a panel are in one unit.
    #[test]
    fn curves_marks_and_labels_have_one_unit() {
        let style = Style::TOLERANCE;
        let mut panel = Panel::new("time (s)", "pull", Scale::Linear);
        panel.curves.push(Curve { points: vec![[0.0, 2e-3], [1.0, -4e-3]], columns: Vec::new(), style, shape: Shape::Graph });
        let small = panel.clone().in_fitting_unit("N");
        assert_eq!((small.y_label.as_str(), small.curves[0].points[1]), ("pull (mN)", [1.0, -4.0]));
        panel.marks.push(Mark { at: Across::Horizontal(20.0), style });
        let large = panel.in_fitting_unit("N");
        assert_eq!((large.x_label.as_str(), large.y_label.as_str()), ("time (s)", "pull (N)"));
        assert_eq!((large.curves[0].points[1], large.marks[0].at), ([1.0, -4e-3], Across::Horizontal(20.0)));
    }
}
