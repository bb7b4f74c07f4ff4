//! Predictions of theory for the scenes, in units of 1 / omega_n, v / omega_n and v.
//!
//! While a load on one spring slips forward under a tip at speed v, the stretch beyond f / k is a
//! free oscillation s of the load, whatever the friction. The load then lags the quasi-static one
//! by s. With a dashpot the load slips from `k s + c v = f` on, that is from s = -2 zeta. Where the
//! force of the dashpot alone exceeds friction, it slips from the grasp on, at s = -1 / epsilon. A
//! load released at speed u coasts by `epsilon u^2 / 2`.
//!
//! In the tug of war slip starts at s = Phi, by which both tips have moved, at the rate 1. A load
//! that stops (s' = 1) rests until the tip has caught up.

use std::f64::consts::{PI, TAU};

use cohaul::math::{bisected, damped_rotation};

/// Largest epsilon at which the rule of thumb calls quasi-static valid (1).
pub const EPSILON_MAX: f64 = 0.05;
/// Smallest Phi at which the rule of thumb calls quasi-static valid (rad).
pub const PHI_MIN: f64 = TAU;
/// Smallest zeta at which the rule of thumb calls quasi-static valid (1).
pub const ZETA_MIN: f64 = 0.5;

/// Stretch beyond f / k and its rate, `time` after the values of `start`, under spring and dashpot
/// alone.
pub fn stretch(zeta: f64, [stretch, rate]: [f64; 2], time: f64) -> [f64; 2] {
    let (cos, sin) = damped_rotation(zeta, 1.0, time);
    [stretch * cos + (rate + zeta * stretch) * sin, rate * cos - (stretch + zeta * rate) * sin]
}

/// Stretch beyond f / k at which a load at rest begins to slip, when spring and dashpot pull it
/// from the rest shape on.
pub fn onset(epsilon: f64, zeta: f64) -> f64 {
    -(2.0 * zeta).min(1.0 / epsilon)
}

/// Displacement of a load that is pulled for Phi since the quasi-static slip onset and then
/// released, over the displacement without inertia, undamped: `[phi - sin phi + (epsilon / 2) (1 -
/// cos phi)^2] / phi`.
pub fn excursion_undamped(phi: f64, epsilon: f64) -> f64 {
    (phi - phi.sin() + 0.5 * epsilon * (1.0 - phi.cos()).powi(2)) / phi
}

/// Displacement ratio as in [`excursion_undamped`], with a dashpot.
pub fn excursion(phi: f64, epsilon: f64, zeta: f64) -> f64 {
    let [behind, rate] = excursion_stretch(phi, epsilon, zeta);
    (phi - behind + coast(epsilon, 1.0 - rate)) / phi
}

/// Largest distance of the load of [`excursion`] from the quasi-static one, over the path length of
/// the latter.
pub fn excursion_distance_ratio(phi: f64, epsilon: f64, zeta: f64) -> f64 {
    const INTERVAL: f64 = 0.02;
    let early = onset(epsilon, zeta);
    let n = ((phi - early) / INTERVAL).ceil();
    let distance = |i: usize| {
        let time = early + (phi - early) * i as f64 / n;
        (time.min(0.0) - excursion_stretch(time, epsilon, zeta)[0]).abs()
    };
    let driven = (0..=n as usize).map(distance).fold(0.0, f64::max);
    driven.max(phi * (excursion(phi, epsilon, zeta) - 1.0).abs()) / phi
}

fn excursion_stretch(time: f64, epsilon: f64, zeta: f64) -> [f64; 2] {
    let early = onset(epsilon, zeta);
    stretch(zeta, [early, 1.0], time - early)
}

/// Displacement after a step of the force, over the displacement without inertia, when the next
/// event comes after Phi. The load makes one half swing, or a part of it where Phi is shorter.
/// Undamped the factor is `1 - cos phi`, at most 2. After the half swing it is `1 + exp(-pi zeta /
/// sqrt(1 - zeta^2))`.
pub fn release_factor(phi: f64, zeta: f64) -> f64 {
    let half_swing = if zeta < 1.0 { PI / (1.0 - zeta * zeta).sqrt() } else { f64::INFINITY };
    1.0 - stretch(zeta, [1.0, 0.0], phi.min(half_swing))[0]
}

/// Displacement of the load in the tug of war over that without inertia: the mean of the laws for
/// jump and drive.
pub fn release(phi: f64, epsilon: f64, zeta: f64) -> f64 {
    0.5 * (release_factor(phi, zeta) + excursion(phi, epsilon, zeta))
}

/// Displacement ratio of the tug of war in closed form, with the first stop, the wait and the
/// second slip onset. `None` where the spring pushes the load back.
pub fn release_exact(phi: f64, epsilon: f64, zeta: f64) -> Option<f64> {
    let start = [phi, 1.0];
    let ratio = |time: f64, behind: f64| (time + phi - behind) / (2.0 * phi);
    let released = |[behind, rate]: [f64; 2]| ratio(phi, behind) + coast(epsilon, 1.0 - rate) / (2.0 * phi);
    let Some(stop) = first_stop(zeta, start, phi) else { return Some(released(stretch(zeta, start, phi))) };
    let [stopped, _] = stretch(zeta, start, stop);
    if stopped + 2.0 * zeta < -2.0 / epsilon {
        return None;
    }
    let again = stop - 2.0 * zeta - stopped;
    Some(if phi <= again { ratio(stop, stopped) } else { released(stretch(zeta, [-2.0 * zeta, 1.0], phi - again)) })
}

/// Time at which the load of the tug of war first stops after the release; `None` if that is not
/// before `until`.
pub fn first_stop(zeta: f64, start: [f64; 2], until: f64) -> Option<f64> {
    const INTERVAL: f64 = 0.01;
    let speed = |time: f64| 1.0 - stretch(zeta, start, time)[1];
    let n = (until / INTERVAL).ceil() as usize;
    // The load starts from rest.
    let after = (2..=n).find(|i| speed(INTERVAL * *i as f64) <= 0.0)?;
    let [_, stop] = bisected([after - 1, after].map(|i| INTERVAL * i as f64), 60, |time| speed(time) > 0.0);
    (stop < until).then_some(stop)
}

/// Displacement of a load that is released at this speed.
fn coast(epsilon: f64, speed: f64) -> f64 {
    0.5 * epsilon * speed * speed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Second differences of the oscillation give back its equation; 1e-4 of a radian leaves 1e-8
    /// of truncation and as much of rounding.
    #[test]
    fn the_stretch_obeys_its_equation_on_all_sides_of_critical_damping() {
        for zeta in [0.0, 0.3, 0.999, 1.0, 1.001, 2.0] {
            let at = |time: f64| stretch(zeta, [0.7, -0.4], time);
            let (h, t) = (1e-4, 1.3);
            let [s, rate] = at(t);
            let second = (at(t + h)[1] - at(t - h)[1]) / (2.0 * h);
            assert!((second + 2.0 * zeta * rate + s).abs() < 1e-7, "{zeta}");
            assert!(((at(t + h)[0] - at(t - h)[0]) / (2.0 * h) - rate).abs() < 1e-7, "{zeta}");
            assert_eq!(at(0.0), [0.7, -0.4]);
        }
    }

    /// Taylor's series of the printed formula: phi^2 / 6 + epsilon phi^3 / 8 to leading orders; a
    /// whole period leaves nothing.
    #[test]
    fn excursions_begin_slowly_and_end_as_without_inertia() {
        let (phi, epsilon) = (1e-2_f64, 0.5_f64);
        let series = phi * phi / 6.0 + epsilon * phi.powi(3) / 8.0;
        assert!((excursion_undamped(phi, epsilon) / series - 1.0).abs() < 1e-4);
        assert!((excursion_undamped(TAU, epsilon) - 1.0).abs() < 1e-15);
        assert!((excursion(1.7, 0.3, 0.0) - excursion_undamped(1.7, 0.3)).abs() < 1e-15);
    }

    #[test]
    fn a_release_falls_short_below_a_quarter_period_and_overshoots_beyond() {
        assert!(release_factor(0.5 * PI - 1e-6, 0.0) < 1.0 && release_factor(0.5 * PI + 1e-6, 0.0) > 1.0);
        for zeta in [0.0_f64, 0.1, 0.5] {
            let damped = (1.0 - zeta * zeta).sqrt();
            let whole = 1.0 + (-PI * zeta / damped).exp();
            assert!((release_factor(50.0, zeta) - whole).abs() < 1e-14);
        }
        // Critically damped, nothing overshoots.
        assert!((0..1000).all(|i| release_factor(0.1 * f64::from(i), 1.0) <= 1.0));
    }

    /// Before the load first stops the two laws add up, but for the coast of the speed that the
    /// jump has given.
    #[test]
    fn jump_and_drive_add_up_until_the_load_stops() {
        let phi = 2.0;
        assert_eq!(first_stop(0.0, [phi, 1.0], 10.0).map(|stop| (1e6 * (stop - 2.0 * (PI - phi.atan()))).round()), Some(0.0));
        let without_coast = |law: &dyn Fn(f64) -> f64| law(1e-12);
        let sum = without_coast(&|epsilon| release(phi, epsilon, 0.0));
        let whole = without_coast(&|epsilon| release_exact(phi, epsilon, 0.0).unwrap());
        assert!((sum - whole).abs() < 1e-11, "{sum} {whole}");
        assert!(release_exact(phi, 0.5, 0.0).unwrap() > release(phi, 0.5, 0.0) + 0.1);
    }
}
