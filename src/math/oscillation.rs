//! Free motion of a damped oscillator, `x'' + 2 a x' + w^2 x = 0`.

use super::Arc;

/// `exp(-a t) cos(b t)` (1) and `exp(-a t) sin(b t) / b` (s) at the `time` t (s), with `b^2 = w^2 -
/// a^2` of either sign: a is the `decay` rate (1/s) and w^2 is `natural_squared` (rad^2/s^2).
///
/// The motion from the displacement x and the speed v is `x (cos + a sin) + v sin`. Far above
/// critical damping the two exponentials stay finite, and the slow one keeps its rate.
pub fn damped_rotation(decay: f64, natural_squared: f64, time: f64) -> (f64, f64) {
    let square = natural_squared - decay * decay;
    let rate = if square < 0.0 { decay * (1.0 - natural_squared / decay / decay).sqrt() } else { square.sqrt() };
    let fade = || if decay == 0.0 { 1.0 } else { (-decay * time).exp() };
    if rate * time < 1e-6 {
        let fade = fade();
        return (fade, fade * time);
    }
    if square > 0.0 {
        let (turn, fade) = (Arc::of(rate * time).rotation(), fade());
        return (fade * turn.m11, fade * turn.m21 / rate);
    }
    // The difference a - |b| = w^2 / (a + |b|), without cancellation.
    let (slow, fast) = ((-natural_squared / (decay + rate) * time).exp(), (-(rate + decay) * time).exp());
    (0.5 * (slow + fast), 0.5 * (slow - fast) / rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Below critical damping the formula itself; above, the sum of two exponentials from the roots
    /// of `s^2 + 2 a s + w^2`. Values and rates are of order one.
    #[test]
    fn the_motion_is_that_of_the_roots_at_any_damping() {
        for time in [0.3, 2.0, 40.0] {
            let (cos, sin) = damped_rotation(0.2, 1.0, time);
            let rate = 0.96f64.sqrt();
            assert!((cos - (-0.2 * time).exp() * (rate * time).cos()).abs() < 1e-14);
            assert!((sin - (-0.2 * time).exp() * (rate * time).sin() / rate).abs() < 1e-14);
            let (cos, sin) = damped_rotation(2.0, 1.0, time);
            let roots = [2.0 - 3f64.sqrt(), 2.0 + 3f64.sqrt()].map(|root| (-root * time).exp());
            assert!((cos - 0.5 * (roots[0] + roots[1])).abs() < 1e-14 && (sin - 0.5 * (roots[0] - roots[1]) / 3f64.sqrt()).abs() < 1e-14);
        }
    }

    /// An overdamped oscillator returns as `exp(-w^2 t / 2 a)`, up to a relative 1 / (2 a / w)^2 of
    /// its rate, where `exp(-a t)` and `cosh` alone leave the range of numbers.
    #[test]
    fn an_overdamped_oscillator_returns_slowly_and_stays_finite() {
        for decay in [1e2, 1e5, 1e9, 1e200] {
            let (cos, sin) = damped_rotation(decay, 1.0, 2.0 * decay);
            assert!((cos + decay * sin - (-1.0f64).exp()).abs() < 1e-4, "{decay}: {cos} {sin}");
        }
        let (cos, sin) = damped_rotation(20.0, 1.0, 1e6);
        assert!(cos == 0.0 && sin == 0.0, "{cos} {sin}");
    }
}
