//! Attached springs as joints: the exact force of the law at the pose of the load, and a positive
//! stiffness around it.
//!
//! Along the spring the length grows at the rate -e_r . v, and the force by k_r times that. Across
//! it the swing grows at -e_t . v / l, and the force by k_t / l^2 times e_t . v. Here v is the
//! velocity of the load's material point at the tip. The rest of the second derivative of the
//! energy turns the force with the frame. It is indefinite, so the engine does not get it; the
//! frames are set anew in every step instead.

use super::joints::{AxisLaw, SpringJoint};
use crate::backend::springs::Attachment;
use crate::math::{Mat3, Twist, Vec2, Vec3, direction, perpendicular, unwrap_near};
use crate::model::support::wrench_of;
use crate::model::{PolarSpring, SpringShape, System};

/// A spring with all quantities that do not change during a run.
#[derive(Clone, Copy, Debug)]
pub struct PreparedSpring {
    spring: PolarSpring,
    /// Cosine and sine of the bearing.
    bearing: Vec2,
    /// Root in axes turned by the bearing (m).
    root: Vec2,
    /// Dashpot coefficients (N s/m, N m s/rad).
    damping: (f64, f64),
}

/// State of an attached spring at one pose of the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringState {
    /// Force of the spring on the load (N, world).
    pub pull: Vec2,
    /// Elastic energy (J).
    pub energy: f64,
    /// Swing (rad).
    pub swing: f64,
}

impl PreparedSpring {
    pub fn of(system: &System) -> Vec<Self> {
        let prepared = |spring: &PolarSpring| {
            let bearing = direction(spring.bearing);
            Self { spring: *spring, bearing, root: seen_from(&bearing, &spring.root), damping: system.dashpot(spring) }
        };
        system.springs.iter().map(prepared).collect()
    }

    /// State of the spring with a load at `position` (m) whose x axis points along the unit vector
    /// `facing`.
    pub fn state(&self, attachment: &Attachment, position: &Vec2, facing: &Vec2) -> SpringState {
        let turn = turned(facing, &self.bearing);
        let shape = self.shape(attachment, position, &turn);
        SpringState { pull: turned(&turn, &self.spring.pull_in_root(&shape)), energy: self.spring.energy(&shape), swing: shape.swing }
    }

    /// The spring as a joint, whose tip has arrived with `tip_velocity` (m/s).
    pub fn joint(&self, attachment: &Attachment, tip_velocity: &Vec2, position: &Vec2, facing: &Vec2) -> SpringJoint {
        let turn = turned(facing, &self.bearing);
        let shape = self.shape(attachment, position, &turn);
        let radial = turned(&turn, &self.spring.polar_axis(&shape).1);
        let pull = turned(&turn, &self.spring.pull_in_root(&shape));
        let stiffness = self.spring.along_and_across(shape.length, self.spring.stiffness_at(shape.length));
        let damping = self.spring.along_and_across(shape.length, self.damping);
        let law = |at: usize, axis: &Vec2| {
            let (stiffness, damping) = (stiffness[at], damping[at]);
            let force = pull.dot(axis) + damping * tip_velocity.dot(axis);
            (stiffness > 0.0).then_some(AxisLaw { stiffness, damping, force })
        };
        SpringJoint {
            arm: attachment.tip - position,
            direction: radial,
            axes: [law(0, &radial), law(1, &perpendicular(&radial))],
            turning: None,
        }
    }

    /// [`PolarSpring::shape`] without a sine: `turn` is the unit vector of the root's x axis.
    fn shape(&self, attachment: &Attachment, position: &Vec2, turn: &Vec2) -> SpringShape {
        let tip_in_root = seen_from(turn, &(attachment.tip - position)) - self.root;
        let length = tip_in_root.norm();
        let swing = if length > 0.0 { unwrap_near(tip_in_root.y.atan2(tip_in_root.x), attachment.swing) } else { attachment.swing };
        SpringShape { tip_in_root, length, swing }
    }
}

/// `v` turned by the angle of the unit vector `facing`.
pub fn turned(facing: &Vec2, v: &Vec2) -> Vec2 {
    Vec2::new(facing.x * v.x - facing.y * v.y, facing.y * v.x + facing.x * v.y)
}

/// `v` turned back by the angle of the unit vector `facing`.
pub fn seen_from(facing: &Vec2, v: &Vec2) -> Vec2 {
    Vec2::new(facing.x * v.x + facing.y * v.y, facing.x * v.y - facing.y * v.x)
}

/// Sum of all spring joints, about the load's origin and in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringSum {
    /// Stiffness K, positive semidefinite (N/m, N, N m/rad).
    pub stiffness: Mat3,
    /// Damping D, positive semidefinite (N s/m, N s, N m s/rad).
    pub damping: Mat3,
    /// Wrench W on a load at rest (N, N, N m).
    pub wrench: Vec3,
    /// Sum of the sizes of the forces, which a residual is compared with (N).
    pub force_scale: f64,
}

impl SpringSum {
    const NONE: SpringSum = SpringSum {
        stiffness: Mat3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        damping: Mat3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        wrench: Vec3::new(0.0, 0.0, 0.0),
        force_scale: 0.0,
    };

    /// Sum of joints whose forces depend on the motion of the load.
    pub fn of(joints: &[SpringJoint]) -> Self {
        let mut sum = Self::NONE;
        for joint in joints {
            for (law, axis) in joint.axes.iter().zip(joint.directions()) {
                if let Some(law) = law {
                    sum.add(law, &wrench_of(&joint.arm, &axis));
                }
            }
        }
        sum.stiffness.fill_lower_triangle_with_upper_triangle();
        sum.damping.fill_lower_triangle_with_upper_triangle();
        sum
    }

    /// Sum as a constant wrench: that of springs and dashpots at the start of a step, on a load
    /// with `twist` there.
    pub fn explicit(joints: &[SpringJoint], twist: &Twist) -> Self {
        let mut sum = Self::NONE;
        for joint in joints {
            let velocity = twist.velocity_at(&joint.arm);
            let force = joint.force(|law, axis| law.force - law.damping * velocity.dot(axis));
            sum.wrench += wrench_of(&joint.arm, &force);
            sum.force_scale += force.norm();
        }
        sum
    }

    /// Adds one axis to the upper triangles.
    fn add(&mut self, law: &AxisLaw, unit_wrench: &Vec3) {
        add_square(&mut self.stiffness, law.stiffness, unit_wrench);
        if law.damping != 0.0 {
            add_square(&mut self.damping, law.damping, unit_wrench);
        }
        self.wrench += law.force * unit_wrench;
        self.force_scale += law.force.abs();
    }
}

fn add_square(upper: &mut Mat3, factor: f64, v: &Vec3) {
    let scaled = factor * v;
    upper.m11 += scaled.x * v.x;
    upper.m12 += scaled.x * v.y;
    upper.m13 += scaled.x * v.z;
    upper.m22 += scaled.y * v.y;
    upper.m23 += scaled.y * v.z;
    upper.m33 += scaled.z * v.z;
}
