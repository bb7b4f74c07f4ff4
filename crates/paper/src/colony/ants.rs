//! The fitted ants as a scenario.

use serde::Serialize;

use crate::calibrate::Sensor;
use crate::calibrate::behaviour::{BehaviourReport, Parameter};
use cohaul::backend::Motion;
use cohaul::math::Pose;
use cohaul::model::paper;
use cohaul::scenario::{AntDrive, Drive, Scenario};

/// A key of the ants' drive, and where its value comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedKey {
    /// Key of `drive` in a scenario.
    pub key: &'static str,
    pub symbol: &'static str,
    pub unit: &'static str,
    /// Value in the scenario of the fitted ants.
    pub value: f64,
    /// Whether the recording determines the value. A value that it does not is that of the
    /// likeliest law, or that of the given scenario where nothing was fitted.
    pub is_determined: bool,
    /// Ends of the 95 % interval; `null` where the recording set no limit.
    pub low: Option<f64>,
    pub high: Option<f64>,
    /// Value in the given scenario.
    pub given: f64,
    /// Value that the paper prints.
    pub printed: Option<f64>,
}

/// Reason why a scenario has no place for fitted ants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotFitted {
    #[error("drive.kind: must be \"ants\", whose nest, number and search the fitted ants share")]
    NoAnts,
}

/// The scenario `like` with the fitted ants, its springs with the stiffnesses of the sensor, and
/// the load at `start`; and the keys of its drive that were fitted.
///
/// # Errors
/// When `like` has no ants.
pub fn fitted_ants(
    like: &Scenario,
    found: &BehaviourReport,
    sensor: &Sensor,
    start: Pose,
) -> Result<(Scenario, Vec<FittedKey>), NotFitted> {
    let Drive::Ants(given) = &like.drive else { return Err(NotFitted::NoAnts) };
    let mut ants = given.clone();
    if let Some(release) = &found.release {
        (ants.release, ants.release_pace) = (release.law, found.pace);
    }
    if let Some(steering) = &found.steering {
        [ants.steering_gain, ants.steering_half_angle, ants.pull_speed] = steering.best;
    }
    let keys = keys(given, &ants, found);
    let mut made = Scenario { name: format!("{}, fitted ants", like.name), drive: Drive::Ants(ants), ..like.clone() };
    made.start = Motion { pose: start, ..like.start };
    for (spring, measured) in made.system.springs.iter_mut().zip(&sensor.springs) {
        (spring.radial_stiffness, spring.torsional_stiffness) = (measured.radial_stiffness, measured.torsional_stiffness);
    }
    Ok((made, keys))
}

/// Key, symbol and unit of a fitted parameter, and its value in a drive.
type Field = (&'static str, &'static str, &'static str, fn(&AntDrive) -> f64);

/// In the order of [`BehaviourReport::parameters`].
const RELEASE: [Field; 3] = [
    ("release_steepness_per_n", "zeta", "1/N", |ants| ants.release.steepness),
    ("strong_pull_n", "F_m", "N", |ants| ants.release.strong_pull),
    ("release_decision_period_s", "D_r", "s", |ants| ants.release.period),
];
const STEERING: [Field; 3] = [
    ("steering_gain_per_s", "k", "1/s", |ants| ants.steering_gain),
    ("steering_half_angle_rad", "beta", "rad", |ants| ants.steering_half_angle),
    ("pull_speed_m_per_s", "v", "m/s", |ants| ants.pull_speed),
];

fn keys(given: &AntDrive, ants: &AntDrive, found: &BehaviourReport) -> Vec<FittedKey> {
    let none = Parameter::default();
    let release = found.release.as_ref().map_or([none; 3], |of| [of.steepness_per_n, of.strong_pull_n, of.decision_period_s]);
    let steering =
        found.steering.as_ref().map_or([none; 3], |of| [of.steering_gain_per_s, of.steering_half_angle_rad, of.pull_speed_m_per_s]);
    let printed = |key: &str| paper::ANTS.iter().find(|printed| printed.key == key).map(|printed| printed.value);
    let of = |((key, symbol, unit, value), own): (Field, Parameter)| FittedKey {
        key,
        symbol,
        unit,
        value: value(ants),
        is_determined: own.value.is_some(),
        low: own.low,
        high: own.high,
        given: value(given),
        printed: printed(key),
    };
    RELEASE.into_iter().zip(release).chain(STEERING.into_iter().zip(steering)).map(of).collect()
}
