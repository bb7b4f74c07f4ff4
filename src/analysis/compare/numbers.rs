//! Dimensionless numbers of a run, and what theory predicts from them.
//!
//! ```text
//! epsilon = v sqrt(k m) / f    Phi = omega_n T_e    zeta    with omega_n = sqrt(k / m), f = mu m g
//! ```
//!
//! v is the root mean square speed of the attached tips, k the mean radial stiffness and T_e the
//! mean time between events. Under continuous driving, inertia moves the path by epsilon f / k
//! while the tips move, and by twice that where they stop. After a release the load moves as the
//! step response of a damped oscillator, to the end of its first swing or to the next event.
//! Without damping it moves `1 - cos(omega_n T_e)` times as far as without inertia, at most twice.

use std::f64::consts::PI;

use serde::Serialize;

use crate::analysis::estimate::InertiaEstimate;
use crate::math::{Summary, damped_rotation};
use crate::model::SpringLaw;
use crate::scenario::{Drive, Scenario, TipPath};
use crate::simulation::{EventKind, Trace};

/// Numbers of a load on springs. All are `null` without springs, and in a run in which the load
/// touches an obstacle: an obstacle drives and holds it as no spring does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Numbers {
    /// Inertia of the driven load compared with friction (1); `null` also without friction.
    pub epsilon: Option<f64>,
    /// Time between events in radians of the load's oscillation (rad); `null` also without events.
    pub phi: Option<f64>,
    /// Mean damping ratio of the springs (1).
    pub zeta: Option<f64>,
}

/// Theoretical prediction of the inertia effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Predicted {
    /// Inertia effect while the tips move, epsilon f / k (m); `null` without friction.
    pub while_driven_m: Option<f64>,
    /// Largest inertia effect where the tips stop, twice that (m); `null` without friction.
    pub where_tips_stop_m: Option<f64>,
    /// Distance over which friction dissipates the initial kinetic energy (m); `null` without
    /// friction.
    pub coasting_m: Option<f64>,
    /// Inertia effect estimated beside the quasi-static run (m); `null` if not estimated.
    pub estimated_m: Option<f64>,
    /// Whether the estimate calls inertia negligible; `null` also if it is too near to the
    /// tolerance to decide. See [`InertiaEstimate::is_negligible_within`].
    pub estimated_is_negligible: Option<bool>,
    /// Whether it is that of a load with inertia beside the quasi-static one, as among obstacles,
    /// and not of a reduced model.
    pub estimated_among_obstacles: bool,
    /// Displacement after a release divided by that without inertia (1); `null` without releases.
    pub release_factor: Option<f64>,
}

impl Numbers {
    pub fn of(scenario: &Scenario, trace: &Trace) -> Self {
        if touches_obstacle(trace) { Self::default() } else { Self::new(scenario, tip_speed(trace), time_between_events(trace)) }
    }

    /// Numbers of tips at a root mean square `speed` (m/s) with a mean time between events (s).
    fn new(scenario: &Scenario, speed: f64, between_events: Option<f64>) -> Self {
        let (stiffness, zeta) = mean_spring(scenario);
        if stiffness == 0.0 {
            return Self::default();
        }
        let mass = scenario.system.load.mass;
        let epsilon = finite(speed * (stiffness * mass).sqrt() / scenario.system.total_slip_limit());
        Self { epsilon, phi: between_events.and_then(|time| finite((stiffness / mass).sqrt() * time)), zeta: Some(zeta) }
    }

    /// Numbers that are known before a run: those of prescribed tips, or with ants those of tips
    /// that all move at the speed of a pulling ant. The events of ants follow from the run.
    pub fn before_run(scenario: &Scenario) -> Self {
        match &scenario.drive {
            Drive::Ants(drive) => Self::new(scenario, drive.pull_speed, None),
            Drive::Tips(paths) => {
                let speed = prescribed_speed(paths, scenario.duration);
                Self::new(scenario, speed, mean_gap(prescribed_events(paths, scenario.duration), scenario.duration))
            }
        }
    }

    /// Prediction for the inertial run, with the estimate beside the quasi-static one.
    pub fn predicted(
        &self,
        scenario: &Scenario,
        [quasi_static, inertial]: [&Trace; 2],
        tolerance_m: f64,
        is_rate_independent: bool,
    ) -> Predicted {
        self.predict(scenario, inertial).with_estimate(scenario, quasi_static, tolerance_m, is_rate_independent)
    }

    /// Prediction for the inertial run in `trace`.
    fn predict(&self, scenario: &Scenario, trace: &Trace) -> Predicted {
        let (stiffness, _) = mean_spring(scenario);
        let limit = scenario.system.total_slip_limit();
        let length = if stiffness > 0.0 { limit / stiffness } else { 0.0 };
        let while_driven_m = self.epsilon.and_then(|epsilon| finite(epsilon * length));
        let initial = trace.rows.first().map_or(0.0, |row| row.energy.initial);
        let has_ropes = scenario.system.springs.iter().any(|spring| spring.law == SpringLaw::Rope);
        let n_releases = trace.events.iter().filter(|event| event.kind == EventKind::Release).count();
        Predicted {
            while_driven_m,
            where_tips_stop_m: while_driven_m.map(|error| 2.0 * error),
            coasting_m: finite(initial / limit),
            // A rope that becomes slack does not swing back.
            release_factor: if n_releases > 0 && !has_ropes { self.release_factor() } else { None },
            ..Predicted::default()
        }
    }

    /// Displacement after a step of the force, divided by that without inertia (1): the first
    /// swing, or the part of it until the next event. Friction then stops the load.
    fn release_factor(&self) -> Option<f64> {
        let zeta = self.zeta?;
        let half_swing = if zeta < 1.0 { PI / (1.0 - zeta * zeta).sqrt() } else { f64::INFINITY };
        let phi = self.phi.unwrap_or(f64::INFINITY).min(half_swing);
        if phi.is_infinite() {
            return Some(1.0);
        }
        let (cos, sin) = damped_rotation(zeta, 1.0, phi);
        finite(1.0 - (cos + zeta * sin))
    }
}

impl Predicted {
    /// This prediction with the estimate from the trace of the quasi-static run, and whether that
    /// is negligible within a tolerance (m).
    fn with_estimate(self, scenario: &Scenario, quasi_static: &Trace, tolerance_m: f64, is_rate_independent: bool) -> Self {
        let estimate = InertiaEstimate::beside(scenario, quasi_static, is_rate_independent);
        let estimated_is_negligible = estimate.is_negligible_within(tolerance_m);
        let estimated_among_obstacles = !scenario.system.world.obstacles.is_empty();
        Self { estimated_m: Some(estimate.edge_displacement_max_m), estimated_is_negligible, estimated_among_obstacles, ..self }
    }
}

/// Whether the load touches an obstacle in a run.
fn touches_obstacle(trace: &Trace) -> bool {
    trace.transitions.iter().any(|transition| transition.kind.obstacle().is_some())
}

/// A number that can be predicted; `None` where the formula has no finite value.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Natural frequency omega_n of the load on a mean spring (rad/s).
pub(super) fn natural_rate(scenario: &Scenario) -> f64 {
    (mean_spring(scenario).0 / scenario.system.load.mass).sqrt()
}

/// Mean radial stiffness (N/m) and damping ratio of the springs.
pub(super) fn mean_spring(scenario: &Scenario) -> (f64, f64) {
    let springs = &scenario.system.springs;
    let n = springs.len().max(1) as f64;
    let sum = |part: fn(&crate::model::PolarSpring) -> f64| springs.iter().map(part).sum::<f64>();
    // An empty sum is minus zero.
    (sum(|spring| spring.radial_stiffness) / n + 0.0, sum(|spring| spring.damping_ratio) / n + 0.0)
}

/// Root mean square speed of the attached tips (m/s).
fn tip_speed(trace: &Trace) -> f64 {
    let mut squares = Summary::default();
    for pair in trace.rows.windows(2) {
        let duration = pair[1].time - pair[0].time;
        for tip in &pair[1].tips {
            let attached_before = pair[0].tips.iter().find(|before| before.spring == tip.spring);
            if let Some(before) = attached_before.filter(|_| duration > 0.0) {
                squares.add(((tip.position - before.position) / duration).norm_squared());
            }
        }
    }
    squares.mean().sqrt()
}

/// Root mean square speed of prescribed tips while they are attached, up to the end (m/s).
fn prescribed_speed(paths: &[TipPath], end: f64) -> f64 {
    let (mut squares, mut duration) = (0.0, 0.0);
    for path in paths {
        let until = path.release.unwrap_or(end).min(end);
        for pair in path.waypoints.windows(2) {
            let time = (pair[1].time.min(until) - pair[0].time).max(0.0);
            let speed = (pair[1].position - pair[0].position).norm() / (pair[1].time - pair[0].time);
            squares += time * speed * speed;
        }
        duration += (until - path.waypoints[0].time).max(0.0);
    }
    if duration > 0.0 { (squares / duration).sqrt() } else { 0.0 }
}

/// Times at which prescribed tips are attached and released, in order (s).
fn prescribed_events(paths: &[TipPath], end: f64) -> Vec<f64> {
    let times = paths.iter().flat_map(|path| path.waypoints.first().map(|point| point.time).into_iter().chain(path.release));
    let mut times: Vec<f64> = times.filter(|time| *time <= end).collect();
    times.sort_by(f64::total_cmp);
    times
}

/// Mean time between one event of a run and the next, or the end (s).
fn time_between_events(trace: &Trace) -> Option<f64> {
    mean_gap(trace.events.iter().map(|event| event.time).collect(), trace.rows.last()?.time)
}

/// Mean time between one of these times and the next, or the end (s); equal times count once.
fn mean_gap(mut times: Vec<f64>, end: f64) -> Option<f64> {
    times.push(end);
    times.dedup();
    let gaps = times.len().checked_sub(1).filter(|gaps| *gaps > 0)?;
    Some((times[gaps] - times[0]) / gaps as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::{BackendKind, BackendOptions};
    use crate::simulation::{Keep, Simulation, backend_of, controller_of};

    /// Prescribed tips have the numbers of their run. Each row of a trace counts alike, so that the
    /// speeds may differ by a row in the number of rows, one in 1500.
    #[test]
    fn prescribed_tips_have_their_numbers_before_the_run() {
        for name in ["analytic/release-jump", "analytic/ramp-and-hold", "paper/four-tips-prescribed"] {
            let path = format!("{}/scenarios/{name}.json", env!("CARGO_MANIFEST_DIR"));
            let scenario = Scenario::read(path.as_ref()).unwrap();
            let options = BackendOptions::at_step(None, BackendKind::QuasiStatic, &scenario.system, scenario.control_period);
            let backend = backend_of(&scenario, &options);
            let mut run = Simulation::from_parts(&scenario, &options, Keep::Trace, controller_of(&scenario), backend);
            run.run(|_| true);
            let (found, expected) = (Numbers::before_run(&scenario), Numbers::of(&scenario, &run.into_results().0));
            let ratio = |of: fn(&Numbers) -> Option<f64>| of(&found).unwrap() / of(&expected).unwrap() - 1.0;
            assert!(ratio(|numbers| numbers.epsilon).abs() < 1e-3, "{name}: {found:?} {expected:?}");
            assert!(ratio(|numbers| numbers.phi).abs() < 1e-12, "{name}: {found:?} {expected:?}");
        }
    }

    fn factor(phi: f64, zeta: f64) -> f64 {
        Numbers { epsilon: Some(0.1), phi: Some(phi), zeta: Some(zeta) }.release_factor().unwrap()
    }

    /// Closed forms of the step response: 1 + exp(-pi zeta / sqrt(1 - zeta^2)) for a whole swing,
    /// and 1 - cos Phi without damping.
    #[test]
    fn releases_overshoot_with_time_and_fall_short_without() {
        // Rounding of order one throughout.
        assert!((factor(10.0, 0.0) - 2.0).abs() < 1e-15);
        assert!((factor(PI / 2.0, 0.0) - 1.0).abs() < 1e-15);
        assert!((factor(0.5, 0.0) - (1.0 - 0.5f64.cos())).abs() < 1e-15);
        assert!((factor(100.0, 0.3) - (1.0 + (-PI * 0.3 / 0.91f64.sqrt()).exp())).abs() < 1e-14);
        assert!((factor(2.0, 1.0) - (1.0 - 3.0 * (-2.0f64).exp())).abs() < 1e-14);
        // Continuous in the damping through critical, to first order in the difference.
        assert!((factor(2.0, 1.0 - 1e-9) - factor(2.0, 1.0 + 1e-9)).abs() < 1e-8);
        assert!(factor(2.0, 3.0) < 1.0 && factor(1e6, 0.5) > 1.0);
    }
}
