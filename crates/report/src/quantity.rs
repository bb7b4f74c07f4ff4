//! Numbers with units, for people: three or four significant digits and an SI prefix.

/// `value` in `unit` with four significant digits and the prefix that puts one to three digits
/// before the point: `12.35 mm`.
///
/// Values of 1000 and above keep the plain unit, as `3600 s`. Kilograms count in grams. A unit that
/// begins with a power, as `m^2`, has no prefix, for the prefix would be raised with it.
pub fn quantity(value: f64, unit: &str) -> String {
    quantity_of(4, value, unit)
}

/// `value` in `unit` with three significant digits and no trailing zeros, as in `6.72 mm`.
pub fn short_quantity(value: f64, unit: &str) -> String {
    if unit.is_empty() {
        return short(value);
    }
    let text = quantity_of(3, value, unit);
    text.split_once(' ').map_or(text.clone(), |(number, unit)| format!("{} {unit}", without_zeros(number)))
}

/// Results of runs and comparisons: as [`super::quantity`], with zero for what is rounding.
pub mod of_run {
    /// Size below which a length, an angle, a force, a speed or an energy is rounding (SI units).
    const ROUNDING: f64 = 1e-12;

    pub fn quantity(value: f64, unit: &str) -> String {
        super::quantity(beyond_rounding(value, unit), unit)
    }

    pub fn short_quantity(value: f64, unit: &str) -> String {
        super::short_quantity(beyond_rounding(value, unit), unit)
    }

    pub fn is_rounding(value: f64) -> bool {
        value.abs() < ROUNDING
    }

    /// Numbers without a unit, such as residuals, are as small as they are.
    fn beyond_rounding(value: f64, unit: &str) -> f64 {
        if is_rounding(value) && !unit.is_empty() { 0.0 } else { value }
    }
}

/// `value` with three significant digits and no trailing zeros.
pub fn short(value: f64) -> String {
    if !(1e-3..1e4).contains(&value.abs()) {
        return number(value);
    }
    let decimals = (2 - value.abs().log10().floor() as i32).max(0) as usize;
    without_zeros(&format!("{value:.decimals$}")).to_owned()
}

fn without_zeros(number: &str) -> &str {
    if number.contains('.') && !number.contains('e') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

fn quantity_of(n_digits: usize, value: f64, unit: &str) -> String {
    if unit.is_empty() {
        return number(value);
    }
    if let Some(rest) = unit.strip_prefix("kg") {
        return quantity_of(n_digits, 1e3 * value, &format!("g{rest}"));
    }
    let Some(digits) = Digits::of(n_digits, value) else { return format!("{} {unit}", number(value)) };
    let head = unit.split([' ', '/']).next().unwrap_or_default();
    let thousands = digits.exponent.div_euclid(3);
    let prefix = match thousands {
        0 => "",
        -1 => "m",
        -2 => "µ",
        -3 => "n",
        -4 => "p",
        _ => return format!("{} {unit}", number(value)),
    };
    if thousands < 0 && head.contains('^') {
        return format!("{} {unit}", number(value));
    }
    format!("{} {prefix}{unit}", digits.times_ten_to(-3 * thousands))
}

/// `value` with four significant digits; in powers of ten below 1e-3 and from 1e7. Whole numbers
/// between keep all their digits.
pub fn number(value: f64) -> String {
    match Digits::of(4, value) {
        None if value == 0.0 => "0".to_owned(),
        None => format!("{value}"),
        Some(digits) if (-3..3).contains(&digits.exponent) => digits.times_ten_to(0),
        Some(digits) if (3..7).contains(&digits.exponent) => format!("{value:.0}"),
        Some(_) => format!("{value:.3e}"),
    }
}

/// Whether a word is a unit as [`quantity`] writes it, with a prefix or without one.
pub fn is_unit(word: &str) -> bool {
    const UNITS: [&str; 16] = ["%", "s", "m", "g", "N", "J", "W", "Pa", "Hz", "rad", "1/s", "m/s", "rad/s", "N/m", "m/rad", "m/s^2"];
    UNITS.contains(&word) || word.strip_prefix(['p', 'n', 'µ', 'm', 'k', 'M']).is_some_and(|unit| UNITS[1..].contains(&unit))
}

/// A number rounded to some significant digits: `significand` in [1, 10) times a power of ten.
/// Rounding comes first, so that 0.99996 mm is 1.000 mm and not 1000.0 µm.
struct Digits {
    significand: String,
    exponent: i32,
}

impl Digits {
    /// `None` for zero and what is not finite.
    fn of(n_digits: usize, value: f64) -> Option<Self> {
        if value == 0.0 || !value.is_finite() {
            return None;
        }
        let text = format!("{value:.*e}", n_digits - 1);
        let (significand, exponent) = text.split_once('e')?;
        Some(Self { significand: significand.to_owned(), exponent: exponent.parse().ok()? })
    }

    /// The number times ten to the `power`, its digits shifted and not computed anew. For results
    /// from 0.001 to below 1000.
    fn times_ten_to(&self, power: i32) -> String {
        let exponent = self.exponent + power;
        let sign = if self.significand.starts_with('-') { "-" } else { "" };
        let digits: String = self.significand.chars().filter(char::is_ascii_digit).collect();
        if exponent < 0 {
            return format!("{sign}0.{}{digits}", "0".repeat((-exponent - 1) as usize));
        }
        let (whole, part) = digits.split_at(exponent as usize + 1);
        format!("{sign}{whole}.{part}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_prefix_changes_at_thousands_after_rounding() {
        for (value, text) in [
            (0.012345, "12.35 mm"),
            (1.0, "1.000 m"),
            (999.94, "999.9 m"),
            (0.99994, "999.9 mm"),
            (0.99996, "1.000 m"),
            (1e-3, "1.000 mm"),
            (0.99994e-3, "999.9 µm"),
            (0.99996e-3, "1.000 mm"),
            (1e-6, "1.000 µm"),
            (0.99994e-6, "999.9 nm"),
            (1e-12, "1.000 pm"),
        ] {
            assert_eq!(quantity(value, "m"), text);
            assert_eq!(quantity(-value, "m"), format!("-{text}"));
        }
    }

    #[test]
    fn zero_tiny_large_and_broken_values_have_no_prefix() {
        for (value, text) in [
            (0.0, "0 s"),
            (-0.0, "0 s"),
            (2.5e-13, "2.500e-13 s"),
            (f64::from_bits(1), "4.941e-324 s"),
            (999.96, "1000 s"),
            (3600.0, "3600 s"),
            (123_456.0, "123456 s"),
            (1.5e9, "1.500e9 s"),
            (f64::NAN, "NaN s"),
            (f64::NEG_INFINITY, "-inf s"),
        ] {
            assert_eq!(quantity(value, "s"), text);
        }
    }

    #[test]
    fn kilograms_count_in_grams_and_powers_keep_their_unit() {
        assert_eq!(quantity(0.0016, "kg"), "1.600 g");
        assert_eq!(quantity(1.19e-7, "kg m^2"), "119.0 µg m^2");
        assert_eq!(quantity(0.01, "m^2"), "0.01000 m^2");
        assert_eq!(quantity(2e-5, "m^2"), "2.000e-5 m^2");
        assert_eq!(quantity(0.03, "m/s"), "30.00 mm/s");
        assert_eq!(quantity(2.25e-3, "m/s^2"), "2.250 mm/s^2");
    }

    #[test]
    fn short_numbers_have_three_digits_and_no_trailing_zeros() {
        for (value, text) in
            [(1.0, "1"), (1.3533, "1.35"), (0.0996, "0.0996"), (10.0, "10"), (123.4, "123"), (0.5, "0.5"), (1e-5, "1.000e-5")]
        {
            assert_eq!(short(value), text);
        }
        for (value, text) in [(0.01045, "10.4 mm"), (0.0025, "2.5 ms"), (0.6721, "672 mm"), (-0.01, "-10 mm"), (0.0, "0 m")] {
            let unit = text.chars().last().unwrap().to_string();
            assert_eq!(short_quantity(value, &unit), text);
        }
    }

    #[test]
    fn rounding_of_a_run_is_zero_in_all_of_its_units() {
        for unit in ["m", "rad", "N", "m/s", "J"] {
            assert_eq!(
                [of_run::quantity(-9.9e-13, unit), of_run::short_quantity(9.9e-13, unit)],
                [format!("0 {unit}"), format!("0 {unit}")]
            );
            assert_eq!(
                [of_run::quantity(-1.1e-12, unit), of_run::short_quantity(2e-12, unit)],
                [format!("-1.100 p{unit}"), format!("2 p{unit}")]
            );
        }
        assert_eq!(of_run::quantity(1e-14, ""), "1.000e-14");
    }

    #[test]
    fn plain_numbers_keep_four_digits() {
        for (value, text) in [(0.0, "0"), (0.5, "0.5000"), (-0.0012345, "-0.001234"), (3e-13, "3.000e-13"), (30440.0, "30440")] {
            assert_eq!(number(value), text);
        }
    }
}
