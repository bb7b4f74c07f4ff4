//! Thresholds in known laws. All but the oscillating one are closed forms; the factors of damped
//! tows and releases are those of the linear oscillator, to three digits.

use cohaul::analysis::compare::Settings;
use cohaul_studies::threshold::Class::{self, NotValid, Valid};
use cohaul_studies::threshold::PRECISION;
use cohaul_studies::threshold::report::Thresholds;

use crate::scenes::{
    LIMIT, MASS, STIFFNESS, STRETCH, bands, boundaries, pusher, rate, release, searched, searched_with, tow, tow_and_stop,
};

/// Largest distance of a threshold from its law (1).
const WITHIN: f64 = 0.05;

fn assert_changes(found: &Thresholds, quantity: &str, answers: &[Class], laws: &[f64]) {
    let (classes, values) = boundaries(found, quantity);
    eprintln!("{quantity}: {classes:?} {values:?}, law {laws:?}, {} points\n{}", found.points.len(), found.answer);
    assert_eq!(classes, answers, "{quantity}: {values:?}, law {laws:?}\n{}", found.text());
    for (value, law) in values.iter().zip(laws) {
        assert!((value / law - 1.0).abs() < WITHIN, "{quantity}: {value}, law {law}\n{}", found.text());
    }
    for band in &bands(found, quantity)[1..] {
        let [from, to] = band.from.range;
        // The answers on both sides of the limit, and the reference error between them.
        assert!(from <= band.from.value && band.from.value <= to && to / from < 1.0 + 3.0 * PRECISION, "{band:?}");
    }
}

/// Behind a pusher that stops, the load coasts by v^2 / (2 mu g). At 1 % of the whole path, on
/// 0.2 m and at mu = 0.4, the limit is 0.12591 m/s.
const PUSHED: f64 = 0.12591;

#[test]
fn behind_a_pusher_that_stops_the_limit_is_one_of_speed() {
    let speed = 0.2;
    let found = searched(&pusher(speed, 0.2, 0.4), "speed=0.1:4");
    assert_changes(&found, "path", &[Valid, NotValid], &[PUSHED / speed]);
    assert!(found.answer.contains("up to 126 mm/s (path"), "{}", found.answer);
}

/// A larger scene at the same speed has a smaller Froude number v^2 / (g l).
#[test]
fn behind_a_pusher_that_stops_the_limit_in_size_goes_by_the_froude_number() {
    let speed = 0.2;
    let found = searched(&pusher(speed, 0.2, 0.4), "size=0.5:8");
    assert_changes(&found, "path", &[NotValid, Valid], &[(speed / PUSHED).powi(2)]);
    assert!(found.answer.contains("times the size on (path"), "{}", found.answer);
}

#[test]
fn behind_a_pusher_that_stops_the_limit_is_one_of_friction() {
    let speed = 0.1;
    let found = searched(&pusher(speed, 0.2, 0.4), "ground.friction_coefficient=0.1:1");
    assert_changes(&found, "path", &[NotValid, Valid], &[0.4 * (speed / PUSHED).powi(2)]);
    assert!(found.answer.contains("from ground.friction_coefficient = 0.25"), "{}", found.answer);
}

/// Lag g v / omega of a towed load behind the quasi-static one, and its peak pull
/// f (1 + p epsilon).
fn limits_of_tow(g: f64, p: f64, way: f64) -> [f64; 2] {
    let settings = Settings::default();
    let share = settings.tolerance_pull_share / (1.0 - settings.tolerance_pull_share);
    [settings.tolerance_share * (way - STRETCH) * rate() / g, share / p * LIMIT / (STIFFNESS * MASS).sqrt()]
}

fn check_tow(damping_ratio: f64, g: f64, p: f64) -> Thresholds {
    let (speed, way) = (0.05, 0.2);
    let found = searched(&tow(damping_ratio, speed, way), "speed=0.25:8");
    let [of_path, of_pulls] = limits_of_tow(g, p, way);
    assert_changes(&found, "path", &[Valid, NotValid], &[of_path / speed]);
    assert_changes(&found, "pulls", &[Valid, NotValid], &[of_pulls / speed]);
    found
}

#[test]
fn an_undamped_tow_has_limits_of_path_and_pull_and_none_of_speed() {
    let found = check_tow(0.0, 1.0, 1.0);
    // The load reaches twice the speed of the tip, whatever that is.
    assert_changes(&found, "speed", &[NotValid], &[]);
    assert!(found.answer.contains("at no speed from 12.5 mm/s to 400 mm/s (speed)"), "{}", found.answer);
}

#[test]
fn a_lightly_damped_tow_has_limits_of_path_and_pull() {
    check_tow(0.3, 0.578, 0.672);
}

#[test]
fn a_tow_with_critical_damping_has_limits_of_path_and_pull_and_any_speed() {
    let found = check_tow(1.0, 0.204, 0.368);
    assert_changes(&found, "heading", &[Valid], &[]);
    assert!(found.answer.contains("at every speed from 12.5 mm/s to 400 mm/s (heading"), "{}", found.answer);
}

/// epsilon grows with the root of the inertia at the same friction.
#[test]
fn a_tow_has_limits_of_inertia() {
    let (speed, way) = (0.05, 0.2);
    let found = searched(&tow(0.0, speed, way), "inertia=0.1:2");
    let [of_path, of_pulls] = limits_of_tow(1.0, 1.0, way).map(|limit| (limit / speed).powi(2));
    assert_changes(&found, "path", &[Valid, NotValid], &[of_path]);
    assert_changes(&found, "pulls", &[Valid, NotValid], &[of_pulls]);
    assert!(found.answer.contains("times the inertia (path)"), "{}", found.answer);
}

/// After a release the loads with and without inertia differ by r A, with A the displacement to the
/// balance.
#[test]
fn a_release_has_a_limit_of_damping() {
    // r = 0.139 at critical damping, without an overshoot that would be a longer path.
    let settings = Settings { tolerance_share: 0.139, ..Settings::default() };
    let found = searched_with(&release(0.4, 0.04, 0.0), "springs.*.damping_ratio=0.3:3", &settings);
    assert_changes(&found, "path", &[NotValid, Valid], &[1.0]);
}

/// A = stretch - f / k, and the path is A and the way on which the load is towed later. The force
/// at the release over the slip limit is varied by friction.
#[test]
fn a_release_has_a_limit_of_its_force() {
    let (way, r) = (0.2, 0.315);
    let share = Settings::default().tolerance_share;
    let displacement = share * way / (r - share);
    let found = searched(&release(0.5, STRETCH + displacement, way), "ground.friction_coefficient=1:1.6");
    assert_changes(&found, "path", &[NotValid, Valid], &[1.4]);
}

/// The displacement after a release belongs to no speed.
#[test]
fn a_release_without_damping_has_no_limit_of_speed() {
    let found = searched(&release(0.0, 0.04, 0.0), "speed");
    assert_changes(&found, "path", &[NotValid], &[]);
    assert!(found.answer.contains("at no speed from 2.5 mm/s to 2.56 m/s (path"), "{}", found.answer);
}

/// Largest distance between the loads with and without inertia over the largest that counts as
/// agreement (1), in closed form: the load lags by v / omega at most while the tip moves, and ends
/// by 2 (v / omega) |sin(omega tau / 2)| ahead, with the time tau from slip to stop.
fn share_of_tow_and_stop(speed: f64, way: f64, tolerance_share: f64) -> f64 {
    let lag = speed / rate();
    let phase = rate() * (way - STRETCH) / speed;
    let ahead = 2.0 * lag * (0.5 * phase).sin().abs();
    let largest_lag = lag * if phase < std::f64::consts::FRAC_PI_2 { phase.sin() } else { 1.0 };
    largest_lag.max(ahead) / (tolerance_share * (way - STRETCH + ahead))
}

/// The end of a tow depends on the phase of the oscillation at which the tip stops: there are
/// several ranges of speed.
#[test]
fn a_tow_that_stops_is_valid_in_several_ranges() {
    let (speed, way, tolerance_share) = (0.1, 0.1, 0.1);
    let settings = Settings { tolerance_share, ..Settings::default() };
    let found = searched_with(&tow_and_stop(speed, way), "speed=0.5:2:41", &settings);
    let n = 30_000;
    let factor = |at: usize| 0.5 * 4f64.powf(at as f64 / f64::from(n));
    let is_valid = |at: usize| share_of_tow_and_stop(speed * factor(at), way, tolerance_share) <= 1.0;
    let laws: Vec<f64> = (0..n as usize).filter(|at| is_valid(*at) != is_valid(at + 1)).map(factor).collect();
    let mut answers = vec![if is_valid(0) { Valid } else { NotValid }];
    laws.iter().for_each(|_| answers.push(if answers.last() == Some(&Valid) { NotValid } else { Valid }));
    assert!(laws.len() >= 3, "{laws:?}");
    assert_changes(&found, "path", &answers, &laws);
}
