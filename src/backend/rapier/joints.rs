//! Input and output of an engine step as plain data in f64 and world axes: the interface to rapier.

use serde::{Deserialize, Serialize};

use super::contacts::{ContactPoint, ObstacleStep};
use crate::backend::report::Motion;
use crate::math::{Pose, Twist, Vec2, Vec3, Wrench, direction, perpendicular, unwrap_near};

/// One axis of a spring joint. With v the speed of the load along the axis, the engine applies
/// `force - (h k + d) v` to the load, so that a positive stiffness makes the step implicit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLaw {
    /// Stiffness k (N/m, or N m/rad about the point).
    pub stiffness: f64,
    /// Damping d (N s/m, or N m s/rad).
    pub damping: f64,
    /// Force on a load at rest (N, or N m).
    pub force: f64,
}

/// A joint between the load and a point of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringJoint {
    /// Point where the force acts, from the load's origin (m).
    pub arm: Vec2,
    /// Unit vector of the first axis; the second is a quarter turn on.
    pub direction: Vec2,
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

/// Friction under one support along one or two axes, or the joint that stops a load that sticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionJoint {
    /// Index in [`crate::model::Ground::supports`].
    pub support: usize,
    /// Point where the force acts, in the load's frame (m).
    pub offset: Vec2,
    /// Unit vector of the first axis; the second is a quarter turn on.
    pub direction: Vec2,
    /// Largest force along each axis (N). An infinite limit stops the load, zero removes the axis.
    pub limits: [f64; 2],
    /// Largest moment against turning (N m). An infinite limit stops the load, zero removes the
    /// axis.
    pub turning_limit: f64,
    /// Force on the load where all supports stick, in place of the engine's arbitrary distribution
    /// (N, world).
    pub stuck_force: Option<Vec2>,
}

/// State of the load that rapier keeps from step to step. The numbers of the engine fit into f64
/// exactly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyState {
    /// Position (m).
    pub position: Vec2,
    /// Cosine and sine of the heading.
    pub rotation: Vec2,
    /// Velocity (m/s).
    pub velocity: Vec2,
    /// Turn rate (rad/s).
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

    /// Motion of the load. The engine's heading is known up to whole turns; `heading_near` decides
    /// between them.
    pub fn motion(&self, heading_near: f64) -> Motion {
        self.motion_at(unwrap_near(self.rotation.y.atan2(self.rotation.x), heading_near))
    }

    /// Motion of the load with this `heading` (rad).
    pub fn motion_at(&self, heading: f64) -> Motion {
        Motion { pose: Pose { position: self.position, heading }, twist: Twist { linear: self.velocity, angular: self.turn_rate } }
    }

    /// Unit vector of the load's x axis. In f32 the length of the rotation differs from one by
    /// 1e-7.
    pub fn facing(&self) -> Vec2 {
        self.rotation / self.rotation.norm()
    }

    pub fn is_finite(&self) -> bool {
        [self.position, self.rotation, self.velocity].iter().flatten().all(|v| v.is_finite()) && self.turn_rate.is_finite()
    }
}

/// What acts on the load in a step.
pub struct StepInputs<'a> {
    pub friction: &'a [FrictionJoint],
    pub springs: &'a [SpringJoint],
    /// Additional wrench about the load's origin (N, N, N m).
    pub push: Option<&'a Vec3>,
    pub obstacles: &'a [ObstacleStep],
    /// Factor on the number of the solver's sweeps under the recommended settings (1).
    pub more_sweeps: usize,
}

/// A world of rapier with one load.
pub trait Engine: Send {
    fn body(&self) -> BodyState;

    /// Starts a new world with the load in this state, with these numbers of joints and with the
    /// obstacles where their steps begin. No earlier step affects it.
    fn rebuild(&mut self, body: &BodyState, n_friction: usize, n_springs: usize, obstacles: &[ObstacleStep]);

    /// Lets an obstacle move from the next rebuild on. Returns whether it stood still so far.
    fn let_move(&mut self, obstacle: usize) -> bool;

    /// Writes the contacts that the next step meets within `reach` (m) to `contacts`, without
    /// forces. The velocities of the obstacles and the room are left out.
    fn find_contacts(&mut self, reach: f64, contacts: &mut Vec<ContactPoint>);

    /// Sets all joints and moves the load and the obstacles for `duration` (s). Returns `false`
    /// when the engine found no finite state.
    fn step(&mut self, duration: f64, inputs: &StepInputs) -> bool;

    /// Writes the contacts of the last step, with its mean forces, to `contacts`. The velocities of
    /// the obstacles and the room are left out.
    fn read_contacts(&self, contacts: &mut Vec<ContactPoint>);

    /// What the engine keeps from step to step beside the state of the load, as JSON.
    fn memory(&self) -> String;

    /// Starts a world with the load in this state from what another one kept.
    ///
    /// # Errors
    /// When `memory` is not that of such a world.
    fn recall(&mut self, memory: &str) -> Result<(), serde_json::Error>;

    /// Force of a friction joint on the load (N, world) and its moment about the point where it
    /// acts (N m) in the last substep.
    fn friction_wrench(&self, joint: usize) -> Wrench;
}
