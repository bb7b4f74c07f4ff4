//! Held springs as joints: the exact force of the law at the pose of the load, and a positive stiffness around it.
//!
//! Along the spring the length grows at the rate -e_r . v and the force by k_r times that; across it the swing grows at -e_t . v / l and the
//! force by k_t / l^2 times e_t . v, with v the velocity of the load's material point at the tip. What is left of the second derivative of the
//! energy turns the force with the frame; it has no sign, so the engine does not get it, and the frames are set anew in every step instead.

use super::joints::{AxisLaw, SpringJoint};
use crate::backend::held::{Grip, HeldSprings};
use crate::math::{Mat3, Pose, Vec2, Vec3, direction, perpendicular, rotation};
use crate::model::spring::SHORTEST_LENGTH;
use crate::model::support::wrench_of;
use crate::model::{PolarSpring, System};

/// The held springs of `held` as joints of a load at `pose`; `from` tells where the tips were at the start of the step of `duration` (s).
pub fn spring_joints(system: &System, held: &HeldSprings, from: &[Grip], pose: &Pose, duration: f64) -> Vec<SpringJoint> {
    held.grips().iter().zip(from).map(|(grip, before)| spring_joint(system, grip, pose, &((grip.tip - before.tip) / duration))).collect()
}

fn spring_joint(system: &System, grip: &Grip, pose: &Pose, tip_velocity: &Vec2) -> SpringJoint {
    let spring = &system.springs[grip.spring];
    let shape = grip.shape(&system.springs, pose);
    let turn = rotation(pose.heading + spring.bearing);
    let radial = turn * direction(shape.swing);
    let pull = turn * spring.pull_in_root(&shape);
    let [along, across] = axis_rates(system, spring, shape.length);
    let law = |(stiffness, damping): (f64, f64), axis: &Vec2| {
        let force = pull.dot(axis) + damping * tip_velocity.dot(axis);
        (stiffness > 0.0).then_some(AxisLaw { stiffness, damping, force })
    };
    SpringJoint {
        arm: grip.tip - pose.position,
        direction: radial,
        axes: [law(along, &radial), law(across, &perpendicular(&radial))],
        turning: None,
    }
}

/// Stiffness (N/m) and damping (N s/m) along and across a spring of this length.
fn axis_rates(system: &System, spring: &PolarSpring, length: f64) -> [(f64, f64); 2] {
    let (radial_damping, torsional_damping) = system.dashpot(spring);
    let along = (spring.radial_stiffness, radial_damping);
    if spring.is_isotropic() {
        return [along, along];
    }
    let length = length.max(SHORTEST_LENGTH * spring.rest_length).max(f64::MIN_POSITIVE);
    [along, (spring.torsional_stiffness / length / length, torsional_damping / length / length)]
}

/// What all spring joints together do to the load, about its origin and in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringSum {
    /// K (N/m, N, N m/rad), positive semidefinite.
    pub stiffness: Mat3,
    /// D (N s/m, N s, N m s/rad), positive semidefinite.
    pub damping: Mat3,
    /// W: on a load that does not move (N, N, N m).
    pub wrench: Vec3,
    /// Sum of the sizes of the forces (N): what a residual is compared with.
    pub force_scale: f64,
}

impl SpringSum {
    pub fn of(joints: &[SpringJoint]) -> Self {
        let mut sum = Self { stiffness: Mat3::zeros(), damping: Mat3::zeros(), wrench: Vec3::zeros(), force_scale: 0.0 };
        for joint in joints {
            for (law, axis) in joint.axes.iter().zip([joint.direction, perpendicular(&joint.direction)]) {
                if let Some(law) = law {
                    sum.add(law, &wrench_of(&joint.arm, &axis));
                }
            }
        }
        sum
    }

    fn add(&mut self, law: &AxisLaw, unit_wrench: &Vec3) {
        let square = unit_wrench * unit_wrench.transpose();
        self.stiffness += law.stiffness * square;
        self.damping += law.damping * square;
        self.wrench += law.force * unit_wrench;
        self.force_scale += law.force.abs();
    }
}
