//! What is known of a scenario before it runs: its slip limit, its natural frequencies, its first
//! pulls, its dimensionless numbers and its run times.
//!
//! With the stiffness matrix K of the attached springs about the load's start and the mass matrix
//! M, the natural frequencies are the eigenvalues of `M^-1/2 K M^-1/2`. The springs are those that
//! are attached first. With ants they are all springs, undeformed.

use serde::Serialize;

use super::ExpectedCost;
use super::compare::Numbers;
use crate::backend::{BackendKind, BackendOptions};
use crate::math::{Mat3, Vec3};
use crate::model::{PolarSpring, SpringShape};
use crate::scenario::{Drive, Scenario, TipPath};

/// What is known of a scenario before it runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Advice {
    /// Sum of the normal loads (N).
    pub weight_n: f64,
    /// Largest force of friction on a load that does not turn (N).
    pub slip_limit_n: f64,
    /// Largest torque of friction on a load that turns about its origin (N m).
    pub slip_torque_nm: f64,
    /// Oscillations of the load on the springs attached first, the slowest first.
    pub natural_frequencies: Vec<Mode>,
    /// Pull on each spring when it is attached, if the load cannot have moved before.
    pub first_pulls: Vec<Pull>,
    /// Dimensionless numbers; `null` where they follow from a run only.
    pub numbers: Numbers,
    pub expected_time_s: ExpectedTimes,
}

/// A natural oscillation of the load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mode {
    /// Oscillations per second (Hz).
    pub frequency_hz: f64,
    /// Part of the kinetic energy that belongs to the turning of the load (1): 0 for a translation,
    /// 1 for a rotation.
    pub turning_share: f64,
}

/// Pull on a spring when it is attached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pull {
    pub spring: usize,
    /// Force on the tip (N).
    pub pull_n: f64,
    /// The force over the slip limit (1); `null` without friction.
    pub over_slip_limit: Option<f64>,
}

/// Expected run times on one core (s); `null` beyond the range of floating-point numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ExpectedTimes {
    pub quasi_static: Option<f64>,
    pub inertial: Option<f64>,
    pub rapier: Option<f64>,
    pub compare: Option<f64>,
}

impl Advice {
    pub fn of(scenario: &Scenario) -> Self {
        let system = &scenario.system;
        let slip_limit_n = system.total_slip_limit();
        let first = first_attached(scenario);
        let over = |pull: f64| finite(pull / slip_limit_n);
        let pull = |(spring, of, shape): &(usize, &PolarSpring, SpringShape)| {
            let pull_n = of.pull(&scenario.start.pose, shape).norm();
            Pull { spring: *spring, pull_n, over_slip_limit: over(pull_n) }
        };
        Self {
            weight_n: system.ground.supports.iter().map(|support| support.normal_load).sum(),
            slip_limit_n,
            slip_torque_nm: system.total_slip_torque(),
            natural_frequencies: modes(scenario, &first),
            first_pulls: match scenario.drive {
                Drive::Tips(_) => first.iter().map(pull).filter(|pull| pull.pull_n.is_finite()).collect(),
                Drive::Ants(_) => Vec::new(),
            },
            numbers: Numbers::before_run(scenario),
            expected_time_s: ExpectedTimes::of(scenario),
        }
    }
}

impl ExpectedTimes {
    fn of(scenario: &Scenario) -> Self {
        let run = |kind| {
            let options = BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
            finite(ExpectedCost::of_estimated_run(scenario, &options).time_s)
        };
        Self {
            quasi_static: run(BackendKind::QuasiStatic),
            inertial: run(BackendKind::Inertial),
            rapier: run(BackendKind::Rapier),
            compare: finite(ExpectedCost::of_compare(scenario).time_s),
        }
    }
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Springs that are attached first, with their shapes about the load's start.
fn first_attached(scenario: &Scenario) -> Vec<(usize, &PolarSpring, SpringShape)> {
    let (springs, pose) = (&scenario.system.springs, &scenario.start.pose);
    let shaped = |index: usize, tip| (index, &springs[index], springs[index].shape(pose, &tip, 0.0));
    match &scenario.drive {
        Drive::Ants(_) => springs.iter().enumerate().map(|(index, spring)| shaped(index, pose.to_world(&spring.rest_tip()))).collect(),
        Drive::Tips(paths) => {
            let start = |path: &TipPath| path.waypoints[0].time;
            let first = paths.iter().map(start).fold(f64::INFINITY, f64::min);
            paths.iter().filter(|path| start(path) == first).map(|path| shaped(path.spring, path.waypoints[0].position)).collect()
        }
    }
}

/// Oscillations of the load on springs; a mode without stiffness, or of springs that are pushed
/// together too far, is left out.
fn modes(scenario: &Scenario, springs: &[(usize, &PolarSpring, SpringShape)]) -> Vec<Mode> {
    let load = &scenario.system.load;
    let stiffness: Mat3 = springs.iter().map(|(_, spring, shape)| spring.reaction(&scenario.start.pose, shape).hessian).sum();
    let root = Vec3::new(load.mass, load.mass, load.inertia).map(|mass| 1.0 / mass.sqrt());
    let scaled = Mat3::from_diagonal(&root) * stiffness * Mat3::from_diagonal(&root);
    if !scaled.iter().all(|entry| entry.is_finite()) {
        return Vec::new();
    }
    let found = scaled.symmetric_eigen();
    let largest = found.eigenvalues.amax();
    let mode = |(at, square): (usize, &f64)| Mode {
        frequency_hz: square.sqrt() / std::f64::consts::TAU,
        turning_share: found.eigenvectors[(2, at)].powi(2),
    };
    // Rounding leaves a mode without stiffness at 1e-16 of the largest eigenvalue.
    let stiff = found.eigenvalues.iter().enumerate().filter(|(_, square)| **square > 1e-12 * largest);
    let mut modes: Vec<Mode> = stiff.map(mode).filter(|mode| mode.frequency_hz.is_finite()).collect();
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    modes
}
