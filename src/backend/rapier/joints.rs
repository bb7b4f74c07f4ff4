//! What a step asks of the engine, as plain data in f64 and world axes: the cut at which rapier ends.

use serde::{Deserialize, Serialize};

use crate::backend::Motion;
use crate::math::{Pose, Twist, Vec2, Vec3, Wrench, direction, perpendicular, unwrap_near};

/// One axis of a spring joint. With v the speed of the load along the axis, the engine applies `force - (h k + d) v` to the load, so that a
/// positive stiffness makes the step implicit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLaw {
    /// k (N/m, or N m/rad about the point).
    pub stiffness: f64,
    /// d (N s/m, or N m s/rad).
    pub damping: f64,
    /// Force on a load that does not move in this step (N, or N m).
    pub force: f64,
}

/// A spring between the load and a point of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringJoint {
    /// Where the force acts, from the load's origin (m).
    pub arm: Vec2,
    /// Unit vector of the first axis; the second is a quarter turn on.
    pub direction: Vec2,
    /// Laws of both axes.
    pub axes: [Option<AxisLaw>; 2],
    /// Law of the turn about the point.
    pub turning: Option<AxisLaw>,
}

impl SpringJoint {
    /// Unit vectors of both axes.
    pub fn directions(&self) -> [Vec2; 2] {
        [self.direction, perpendicular(&self.direction)]
    }

    pub fn is_damped(&self) -> bool {
        self.axes.iter().flatten().any(|law| law.damping != 0.0)
    }

    /// Force (N, world) that has the component `along` each axis with a law.
    pub fn force(&self, along: impl Fn(&AxisLaw, &Vec2) -> f64) -> Vec2 {
        let mut force = Vec2::zeros();
        for (law, axis) in self.axes.iter().zip(self.directions()) {
            if let Some(law) = law {
                force += along(law, &axis) * axis;
            }
        }
        force
    }
}

/// Friction under one support along one or two axes, or the hold of a load that sticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionJoint {
    /// Index in [`crate::model::Ground::supports`].
    pub support: usize,
    /// Where the force acts in the load's frame (m).
    pub offset: Vec2,
    /// Unit vector of the first axis; the second is a quarter turn on.
    pub direction: Vec2,
    /// Largest force along each axis (N); infinite holds, zero leaves the axis out.
    pub limits: [f64; 2],
    /// Largest moment against turning (N m), likewise.
    pub turning_limit: f64,
    /// Force on the load (N, world) where all supports stick and the engine's own distribution over them means nothing.
    pub stuck_force: Option<Vec2>,
}

/// Everything that rapier keeps of the load from one step to the next. Its numbers are the engine's own, so f64 holds them exactly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyState {
    /// (m)
    pub position: Vec2,
    /// Cosine and sine of the heading.
    pub rotation: Vec2,
    /// (m/s)
    pub velocity: Vec2,
    /// (rad/s)
    pub turn_rate: f64,
}

impl BodyState {
    pub fn of(motion: &Motion) -> Self {
        BodyState {
            position: motion.pose.position,
            rotation: direction(motion.pose.heading),
            velocity: motion.twist.linear,
            turn_rate: motion.twist.angular,
        }
    }

    /// The engine knows a heading up to whole turns; `heading_near` counts them.
    pub fn motion(&self, heading_near: f64) -> Motion {
        self.motion_at(unwrap_near(self.rotation.y.atan2(self.rotation.x), heading_near))
    }

    /// With a heading that is known already.
    pub fn motion_at(&self, heading: f64) -> Motion {
        Motion { pose: Pose { position: self.position, heading }, twist: Twist { linear: self.velocity, angular: self.turn_rate } }
    }

    /// The rotation with the rounding of its length taken out, which in f32 is 1e-7.
    pub fn facing(&self) -> Vec2 {
        self.rotation / self.rotation.norm()
    }

    pub fn is_finite(&self) -> bool {
        [self.position, self.rotation, self.velocity].iter().flatten().all(|v| v.is_finite()) && self.turn_rate.is_finite()
    }
}

/// A world of rapier with one load in it.
pub trait Engine {
    fn body(&self) -> BodyState;

    /// Starts from a fresh world with the load in this state and room for so many joints. What follows depends on nothing that was before.
    fn rebuild(&mut self, body: &BodyState, n_friction: usize, n_springs: usize);

    /// Sets all joints and moves the load over `duration` (s), under the wrench `push` about its origin (N, N, N m) as well. The answer no says that
    /// the engine found no finite state.
    fn step(&mut self, duration: f64, friction: &[FrictionJoint], springs: &[SpringJoint], push: Option<&Vec3>) -> bool;

    /// Force (N, world) of a friction joint on the load, and its moment about where it acts (N m), in the last step; in that step's last substep,
    /// when the engine makes several.
    fn friction_wrench(&self, joint: usize) -> Wrench;
}
