//! Ranges of axes, their ticks, and the labels of those.

/// A linear axis with a tick at every multiple of `step`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    pub low: f64,
    pub high: f64,
    pub step: f64,
}

/// Range below which values differ by rounding alone, in any unit that is shown: loads of a
/// nanometre move by more.
const ROUNDING: f64 = 1e-14;
/// Free space above and below the values, as a share of their range.
const PADDING: f64 = 0.05;

impl Axis {
    /// Exactly from the lowest to the highest value.
    pub fn tight(values: impl Iterator<Item = f64>, n_steps: f64) -> Self {
        let (low, high) = range(values).unwrap_or((0.0, 1.0));
        if low < high { Self::new(low, high, n_steps) } else { Self::new(low, low + 1.0, n_steps) }
    }

    /// Around the values, with some space.
    pub fn around(values: impl Iterator<Item = f64>, n_steps: f64) -> Self {
        let (low, high) = range(values).unwrap_or((0.0, 1.0));
        // Values that differ by rounding only are one value; it stands in the middle of a range of
        // its own size, zero in one of the unit's.
        let least = (1e-9 * low.abs().max(high.abs())).max(ROUNDING);
        let room = match high.abs() {
            _ if high - low > least => PADDING * (high - low),
            size if size > ROUNDING => 0.5 * size,
            _ => 1.0,
        };
        Self::new(low - room, high + room, n_steps)
    }

    /// From zero (or the lowest value, when that is negative) to above the values.
    pub fn from_zero(values: impl Iterator<Item = f64>, n_steps: f64) -> Self {
        let (low, high) = range(values.chain([0.0])).unwrap_or((0.0, 1.0));
        if high - low <= ROUNDING {
            return Self::new(0.0, 1.0, n_steps);
        }
        let room = PADDING * (high - low);
        Self::new(if low < 0.0 { low - room } else { 0.0 }, high + room, n_steps)
    }

    /// The same with ticks at whole numbers only.
    pub fn whole(self) -> Self {
        Self { step: self.step.max(1.0), ..self }
    }

    /// Whole decades around decimal logarithms, at most `n_steps` ticks apart by whole decades.
    pub fn decades(logarithms: impl Iterator<Item = f64>, n_steps: f64) -> Self {
        let (low, high) = range(logarithms).unwrap_or((-1.0, 0.0));
        let (low, high) = (low.floor(), high.ceil());
        let high = if high > low { high } else { low + 1.0 };
        Self { low, high, step: ((high - low) / n_steps).ceil() }
    }

    /// For `n` names at 1, 2, ... with a tick at each.
    pub fn of_names(n: usize) -> Self {
        Self { low: 0.5, high: n as f64 + 0.5, step: 1.0 }
    }

    fn new(low: f64, high: f64, n_steps: f64) -> Self {
        Self { low, high, step: nice_step((high - low) / n_steps) }
    }

    pub fn span(&self) -> f64 {
        self.high - self.low
    }

    /// The same middle, `span` wide.
    fn widened(&self, span: f64) -> Self {
        let middle = 0.5 * (self.low + self.high);
        Self { low: middle - 0.5 * span, high: middle + 0.5 * span, step: self.step }
    }

    /// Two axes of the same scale on an area of `width` x `height` (px): one of them is widened,
    /// both have the ticks of the finer.
    pub fn equal(x: Axis, y: Axis, width: f64, height: f64) -> (Axis, Axis) {
        let per_pixel = (x.span() / width).max(y.span() / height);
        // A tick every 55 px or more.
        let step = nice_step(55.0 * per_pixel);
        (Axis { step, ..x.widened(per_pixel * width) }, Axis { step, ..y.widened(per_pixel * height) })
    }

    pub fn label(&self, value: f64) -> String {
        // Ticks are multiples of the step up to rounding; zero is no "-0".
        let value = (value / self.step).round() * self.step + 0.0;
        let decimals = -(self.step * (1.0 + 1e-9)).log10().floor();
        let text = if (0.0..=4.0).contains(&decimals.max(0.0)) && value.abs() < 1e6 {
            format!("{value:.*}", decimals.max(0.0) as usize)
        } else if value == 0.0 {
            "0".to_owned()
        } else {
            format!("{value:.3e}").replace(".000e", "e").replace("00e", "e")
        };
        text.replace('-', "−")
    }
}

/// Label of a power of ten: `10⁻³`.
pub fn power_label(exponent: f64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    format!("10{}", format!("{:.0}", exponent + 0.0).chars().map(raised).collect::<String>())
}

/// Lowest and highest of the finite values.
pub fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.filter(|value| value.is_finite()).fold(none, |(low, high), value| (value.min(low), value.max(high)));
    (low <= high).then_some((low, high))
}

/// The 1, 2 or 5 times a power of ten that is at least `least`.
fn nice_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|digit| digit * power).find(|step| *step >= least * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_one_two_or_five() {
        for (least, step) in [(1.0, 1.0), (1.1, 2.0), (0.03, 0.05), (6.0, 10.0), (2e-7, 2e-7), (0.099, 0.1)] {
            assert!((nice_step(least) / step - 1.0).abs() < 1e-12, "{least}");
        }
    }

    #[test]
    fn labels_have_the_digits_of_the_step() {
        let label = |step, value| Axis { low: 0.0, high: 1.0, step }.label(value);
        assert_eq!(label(0.5, 1.5), "1.5");
        assert_eq!(label(0.1, -0.30000000000000004), "−0.3");
        assert_eq!(label(50.0, 250.0), "250");
        assert_eq!(label(0.2, -1e-17), "0.0");
        assert_eq!((label(5e-7, 1.5e-6), label(5e-7, -1e-22)), ("1.5e−6".into(), "0".into()));
        assert_eq!((power_label(-13.0), power_label(0.0), power_label(-0.0)), ("10⁻¹³".into(), "10⁰".into(), "10⁰".into()));
    }

    #[test]
    fn no_values_one_value_and_broken_values_have_an_axis() {
        for values in [vec![], vec![3.0], vec![0.0, 0.0], vec![-8e-20, 2e-19], vec![f64::NAN, -2.0, f64::INFINITY], vec![0.1 + 0.2, 0.3]] {
            let of = || values.iter().copied();
            for axis in [Axis::tight(of(), 5.0), Axis::around(of(), 5.0), Axis::from_zero(of(), 5.0), Axis::decades(of(), 5.0)] {
                assert!(axis.low < axis.high && axis.step > 0.0 && axis.span() / axis.step <= 5.0 + 1e-9, "{values:?}: {axis:?}");
            }
        }
    }

    #[test]
    fn equal_axes_have_the_same_length_for_the_same_number() {
        let (x, y) = Axis::equal(Axis::new(0.0, 300.0, 5.0), Axis::new(-10.0, 20.0, 5.0), 400.0, 300.0);
        assert!((x.span() / 400.0 - y.span() / 300.0).abs() < 1e-12);
        assert_eq!((x.low, x.high, 0.5 * (y.low + y.high)), (0.0, 300.0, 5.0));
        assert_eq!(x.step, y.step);
    }
}
