//! Steps short enough for the springs as they are attached.
//!
//! The default step resolves the fastest oscillation of the load on springs at rest. A spring that
//! is stretched many times turns the load faster, with the torque of its tension, and the tip of a
//! spring that is attached close to its root resists a motion across the spring with the torsional
//! stiffness over the square of the length. The fastest oscillation of the load at its present pose
//! is the square root of the largest eigenvalue of M^-1/2 H M^-1/2, with the mass matrix M and the
//! second derivatives H of the energy of all attached springs.

use crate::backend::numerics::{LARGEST_ANGLE, SHORTEST_STEP, SMALL_DEFORMATION, UNRESOLVED_ANGLE};
use crate::backend::report::StepReport;
use crate::backend::springs::{Attachment, TipPaths};
use crate::math::{Mat3, Pose, Vec2, Vec3};
use crate::model::System;

/// The `longest` step (s), or a shorter one if springs that are deformed far demand it. The report
/// gets the angle of the fastest oscillation where no step is short enough.
pub fn longest_step(system: &System, pose: &Pose, paths: &TipPaths, longest: f64, report: &mut StepReport) -> f64 {
    let ends =
        [|attachment: &Attachment, _: &[Vec2]| attachment.tip, |attachment: &Attachment, targets: &[Vec2]| targets[attachment.spring]];
    let rates = ends.map(|end| {
        let tips = || paths.from.iter().map(|attachment| (attachment, end(attachment, paths.targets)));
        if tips().all(|(attachment, tip)| is_near_rest(system, pose, attachment.spring, &tip)) {
            0.0
        } else {
            fastest_rate(system, pose, tips())
        }
    });
    let rate = rates[0].max(rates[1]);
    if longest.min(paths.duration) * rate <= LARGEST_ANGLE {
        return longest;
    }
    let step = (0.5 * LARGEST_ANGLE / rate).max(SHORTEST_STEP).min(longest);
    let angle = step.min(paths.duration) * rate;
    if angle > UNRESOLVED_ANGLE {
        report.unresolved_rad = report.unresolved_rad.max(angle);
    }
    step
}

fn is_near_rest(system: &System, pose: &Pose, spring: usize, tip: &Vec2) -> bool {
    let spring = &system.springs[spring];
    let length = (tip - pose.to_world(&spring.root)).norm();
    (length - spring.rest_length).abs() <= SMALL_DEFORMATION * spring.rest_length.max(system.load.radius)
}

/// Rate of the fastest oscillation of the load at `pose` on springs with these tips (rad/s).
fn fastest_rate<'a>(system: &System, pose: &Pose, tips: impl Iterator<Item = (&'a Attachment, Vec2)>) -> f64 {
    let second_derivatives = tips.fold(Mat3::zeros(), |sum, (attachment, tip)| {
        let spring = &system.springs[attachment.spring];
        sum + spring.reaction(pose, &spring.shape(pose, &tip, attachment.swing)).hessian
    });
    let [linear, angular] = [system.load.mass, system.load.inertia].map(|mass| mass.sqrt().recip());
    let scale = Mat3::from_diagonal(&Vec3::new(linear, linear, angular));
    let scaled = scale * second_derivatives * scale;
    if scaled.iter().all(|entry| entry.is_finite()) { scaled.symmetric_eigenvalues().amax().sqrt() } else { f64::INFINITY }
}
