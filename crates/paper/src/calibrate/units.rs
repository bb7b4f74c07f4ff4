//! Units of a recording that its rows show to be wrong.

use super::recording::{Recording, Sample, Tip};
use super::sensor::Sensor;
use cohaul::math::Pose;
use cohaul_report::quantity::quantity;

/// Distance of a typical tip from its place at rest, in rest lengths, above which the headings are
/// looked at (1): springs are seldom stretched by half of their length all the time.
const FAR: f64 = 0.5;
/// Share of that distance (1) to which headings in degrees must bring the tips.
const NEARER: f64 = 0.5;

/// The rule that the headings of a recording break when they are in degrees, and the largest
/// heading; `None` if they may be radians.
///
/// Tips are near the ends of their springs. Headings in another unit turn the springs away from
/// them.
pub fn headings_in_degrees(recording: &Recording, sensor: &Sensor) -> Option<(String, f64)> {
    let [as_given, as_degrees] = [1.0, std::f64::consts::PI / 180.0].map(|unit| typical_distance(recording, sensor, unit));
    let rest_length = sensor.springs.iter().map(|spring| spring.rest_length).fold(0.0, f64::max);
    let largest = recording.samples.iter().filter_map(|sample| Some(pose(sample)?.heading.abs())).fold(0.0, f64::max);
    let are_degrees = as_given > FAR * rest_length && as_degrees < NEARER * as_given;
    let [given, degrees] = [as_given, as_degrees].map(|distance| quantity(distance, "m"));
    let rule = format!(
        "must be in radians (multiply by pi / 180): read as degrees, they bring a typical tip from {given} to {degrees} from the end \
         of its spring"
    );
    are_degrees.then_some((rule, largest))
}

fn pose(sample: &Sample) -> Option<Pose> {
    match sample.tip {
        Tip::InWorld { load, .. } => Some(load),
        Tip::InRoot(_) => None,
    }
}

/// Median distance of the tips from their places at rest (m), with headings times `unit`.
fn typical_distance(recording: &Recording, sensor: &Sensor, unit: f64) -> f64 {
    let distance = |sample: &Sample| match sample.tip {
        Tip::InWorld { load, tip } => {
            let load = Pose { heading: unit * load.heading, ..load };
            Some((tip - load.to_world(&sensor.spring(sample.spring).rest_tip())).norm())
        }
        Tip::InRoot(_) => None,
    };
    let mut distances: Vec<f64> = recording.samples.iter().filter_map(distance).collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied().unwrap_or(0.0)
}
