//! The dimensionless numbers of a run and what theory predicts from them.
//!
//! ```text
//! epsilon = v sqrt(k m) / f    Phi = omega_n T_e    zeta    with omega_n = sqrt(k / m), f = mu m g
//! ```
//!
//! v is the root mean square speed of the held tips, k the mean radial stiffness, T_e the mean time for which a tip is held. Under continuous driving inertia
//! moves the path by epsilon f / k while the tips go and twice that where they stop. After a release the load overshoots: with damping zeta by the factor
//! `1 + exp(-pi zeta / sqrt(1 - zeta^2))` where half a swing fits between events, and by `1 - cos(omega_n T_e)` where it does not.

use std::f64::consts::PI;

use serde::Serialize;

use crate::math::Summary;
use crate::scenario::Scenario;
use crate::simulation::{EventKind, Trace};

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Numbers {
    /// Inertia of the driven load against friction; `null` without friction, where nothing ever sticks.
    pub epsilon: Option<f64>,
    /// Time between events against that of an oscillation; `null` when no tip is ever held.
    pub phi: Option<f64>,
    /// Damping over critical damping.
    pub zeta: f64,
}

/// epsilon up to which inertia is small.
const SLOW: f64 = 0.05;

/// What theory expects of inertia.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Predicted {
    /// Path error while tips move on (m): epsilon f / k; `null` without friction.
    pub while_driven_m: Option<f64>,
    /// Path error where tips stop (m): at most twice that.
    pub where_tips_stop_m: Option<f64>,
    /// Way on which friction takes up the energy that the load starts with (m), which a load without inertia does not go; `null` without
    /// friction.
    pub coasting_m: Option<f64>,
    /// Distance that the load goes after a release, over what it would go without inertia (1).
    pub release_factor: f64,
    /// Whether neglecting inertia is sound: epsilon below 0.05, a start at less than that share of f / k from rest, and no releases or such that
    /// are far apart and damped (Phi above 2 pi, zeta above 0.5).
    pub quasi_static_is_sound: bool,
}

impl Numbers {
    /// Of the run in `trace`.
    pub fn of(scenario: &Scenario, trace: &Trace) -> Self {
        let (stiffness, zeta) = mean_spring(scenario);
        let mass = scenario.system.load.mass;
        let limit = scenario.system.total_slip_limit();
        let epsilon = (limit > 0.0).then(|| tip_speed(trace) * (stiffness * mass).sqrt() / limit);
        Self { epsilon, phi: hold_time(trace).map(|time| (stiffness / mass).sqrt() * time), zeta }
    }

    pub fn predict(&self, scenario: &Scenario, trace: &Trace) -> Predicted {
        let (stiffness, _) = mean_spring(scenario);
        let limit = scenario.system.total_slip_limit();
        let length = if stiffness > 0.0 { limit / stiffness } else { 0.0 };
        let while_driven_m = self.epsilon.map(|epsilon| epsilon * length);
        let initial = trace.rows.first().map_or(0.0, |row| row.energy.initial);
        let coasting_m = (limit > 0.0).then(|| initial / limit);
        let n_releases = trace.events.iter().filter(|event| event.kind == EventKind::Release).count();
        let damped_out = self.phi.is_none_or(|phi| phi > 2.0 * PI) && self.zeta > 0.5;
        let starts_slow = coasting_m.is_some_and(|coasting| coasting <= SLOW * length);
        Predicted {
            while_driven_m,
            where_tips_stop_m: while_driven_m.map(|error| 2.0 * error),
            coasting_m,
            release_factor: self.release_factor(),
            quasi_static_is_sound: self.epsilon.is_some_and(|epsilon| epsilon < SLOW) && starts_slow && (n_releases == 0 || damped_out),
        }
    }

    fn release_factor(&self) -> f64 {
        if self.zeta >= 1.0 {
            return 1.0;
        }
        let damped = (1.0 - self.zeta * self.zeta).sqrt();
        match self.phi {
            Some(phi) if phi < PI / damped => 1.0 - phi.cos(),
            _ => 1.0 + (-PI * self.zeta / damped).exp(),
        }
    }
}

/// Mean radial stiffness (N/m) and damping ratio of the springs.
fn mean_spring(scenario: &Scenario) -> (f64, f64) {
    let springs = &scenario.system.springs;
    let n = springs.len().max(1) as f64;
    let sum = |part: fn(&crate::model::PolarSpring) -> f64| springs.iter().map(part).sum::<f64>();
    // An empty sum is minus zero.
    (sum(|spring| spring.radial_stiffness) / n + 0.0, sum(|spring| spring.damping_ratio) / n + 0.0)
}

/// Root mean square speed of held tips (m/s).
fn tip_speed(trace: &Trace) -> f64 {
    let mut squares = Summary::default();
    for pair in trace.rows.windows(2) {
        let duration = pair[1].time - pair[0].time;
        for tip in &pair[1].tips {
            let held_before = pair[0].tips.iter().find(|before| before.spring == tip.spring);
            if let Some(before) = held_before.filter(|_| duration > 0.0) {
                squares.add(((tip.position - before.position) / duration).norm_squared());
            }
        }
    }
    squares.mean().sqrt()
}

/// Mean time from a grasp to its release or the end (s).
fn hold_time(trace: &Trace) -> Option<f64> {
    let end = trace.rows.last()?.time;
    let mut times = Summary::default();
    for (at, grasp) in trace.events.iter().enumerate().filter(|(_, event)| event.kind == EventKind::Grasp) {
        let release = trace.events[at..].iter().find(|event| event.spring == grasp.spring && event.kind == EventKind::Release);
        times.add(release.map_or(end, |event| event.time) - grasp.time);
    }
    (times.n() > 0).then(|| times.mean())
}
