//! Axis of a map of cells: the number of cells along it, and the places and labels of its ticks.

use crate::chart::axis::power_label;

#[derive(Clone, Debug, Default)]
pub struct CellAxis {
    pub name: String,
    pub n: usize,
    /// Places of the ticks and their labels.
    pub ticks: Vec<(f64, String)>,
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

    pub fn of_names(names: &[String]) -> Self {
        let n = names.len();
        let ticks = names.iter().enumerate().map(|(at, name)| ((at as f64 + 0.5) / n as f64, name.clone())).collect();
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
}
