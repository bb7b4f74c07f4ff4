//! Power laws and lines through costs, by least squares of relative deviations: a cost of a
//! thousand springs is no better known than that of one.

/// y = factor n^exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    pub factor: f64,
    pub exponent: f64,
    /// Standard error of the exponent; `None` through two points.
    pub exponent_error: Option<f64>,
}

/// y = offset + slope n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    pub offset: f64,
    pub slope: f64,
    /// Standard error of the slope; `None` through two points.
    pub slope_error: Option<f64>,
}

/// Through points of positive coordinates; `None` below two different abscissas.
pub fn power_law(points: &[[f64; 2]]) -> Option<PowerLaw> {
    let logarithms: Vec<[f64; 3]> = points.iter().map(|[n, y]| [n.ln(), y.ln(), 1.0]).collect();
    let (offset, exponent, exponent_error) = weighted(&logarithms)?;
    Some(PowerLaw { factor: offset.exp(), exponent, exponent_error })
}

/// Through points of positive ordinates, each with a weight of one over its square; `None` below
/// two different abscissas.
pub fn line(points: &[[f64; 2]]) -> Option<Line> {
    let weighed: Vec<[f64; 3]> = points.iter().map(|[n, y]| [*n, *y, 1.0 / (y * y)]).collect();
    let (offset, slope, slope_error) = weighted(&weighed)?;
    Some(Line { offset, slope, slope_error })
}

/// Offset, slope and the standard error of the slope of the line through (x, y, weight).
fn weighted(points: &[[f64; 3]]) -> Option<(f64, f64, Option<f64>)> {
    let sum = |of: &dyn Fn(&[f64; 3]) -> f64| points.iter().map(|point| point[2] * of(point)).fold(0.0, |sum, part| sum + part);
    let weight = sum(&|_| 1.0);
    let (x, y) = (sum(&|point| point[0]) / weight, sum(&|point| point[1]) / weight);
    let square = sum(&|point| (point[0] - x).powi(2));
    let slope = sum(&|point| (point[0] - x) * (point[1] - y)) / square;
    if !(slope.is_finite() && square > 0.0) {
        return None;
    }
    let offset = y - slope * x;
    let left = sum(&|point| (point[1] - offset - slope * point[0]).powi(2));
    let error = (points.len() > 2).then(|| (left / (points.len() - 2) as f64 / square).sqrt());
    Some((offset, slope, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [f64; 7] = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0];

    #[test]
    fn a_power_law_is_recovered_with_its_error() {
        let exact = power_law(&SIZES.map(|n| [n, 3e-7 * n.powf(1.5)])).unwrap();
        // Rounding of logarithms.
        assert!((exact.exponent - 1.5).abs() < 1e-13 && (exact.factor / 3e-7 - 1.0).abs() < 1e-12, "{exact:?}");
        assert!(exact.exponent_error.unwrap() < 1e-13);
        // A tenth up and down in turn: the exponent is off by less than a few standard errors,
        // which are not zero.
        let shaken = power_law(&[0, 1, 2, 3, 4, 5, 6].map(|i| [SIZES[i], SIZES[i] * [1.1, 0.9][i % 2]])).unwrap();
        let error = shaken.exponent_error.unwrap();
        assert!(error > 0.005 && error < 0.03 && (shaken.exponent - 1.0).abs() < 3.0 * error, "{shaken:?}");
    }

    #[test]
    fn a_line_is_recovered_although_its_offset_is_a_thousandth() {
        let fit = line(&SIZES.map(|n| [n, 2e-6 + 3e-8 * n])).unwrap();
        assert!((fit.slope / 3e-8 - 1.0).abs() < 1e-12 && (fit.offset / 2e-6 - 1.0).abs() < 1e-12, "{fit:?}");
        // Ten per cent at the largest size would move an unweighted offset by more than itself.
        let bent = line(&SIZES.map(|n| [n, (2e-6 + 3e-8 * n) * if n == 1000.0 { 1.1 } else { 1.0 }])).unwrap();
        assert!((bent.offset / 2e-6 - 1.0).abs() < 0.02, "{bent:?}");
    }

    #[test]
    fn one_point_has_no_fit_and_two_have_no_error() {
        assert_eq!(power_law(&[[1.0, 1.0]]), None);
        assert_eq!(line(&[[1.0, 1.0], [1.0, 2.0]]), None);
        assert_eq!(power_law(&[[1.0, 2.0], [10.0, 20.0]]).unwrap().exponent_error, None);
    }
}
