//! Contacts of the load with obstacles as plain data in f64 and world axes.

use crate::backend::SideContact;
use crate::math::{Pose, Twist, Vec2, perpendicular};
use crate::model::World;

/// Motion of an obstacle in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleStep {
    pub start: Pose,
    pub end: Pose,
    /// Mean twist.
    pub twist: Twist,
}

impl ObstacleStep {
    /// Motions of all obstacles of `world` from the time `start` to `end` (s), which lies
    /// `duration` (s) later.
    pub fn all(world: &World, [start, end]: [f64; 2], duration: f64, steps: &mut Vec<ObstacleStep>) {
        steps.clear();
        steps.extend(world.obstacles.iter().map(|obstacle| {
            let [start, end] = [start, end].map(|time| obstacle.path.pose_at(time));
            let linear = (end.position - start.position) / duration;
            ObstacleStep { start, end, twist: Twist { linear, angular: (end.heading - start.heading) / duration } }
        }));
    }
}

/// A point at which the load touches an obstacle or comes close to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    pub obstacle: usize,
    /// Point from the load's origin (m).
    pub arm: Vec2,
    /// Unit vector from the obstacle to the load. The tangent is a quarter turn on.
    pub normal: Vec2,
    /// Distance at the start of the step; negative in a penetration (m).
    pub gap: f64,
    /// Velocity of the obstacle at the point (m/s).
    pub velocity: Vec2,
    /// Coefficient of friction (1).
    pub friction: f64,
    /// Coefficient of restitution (1).
    pub restitution: f64,
    /// Force on the load along the normal in the step (N).
    pub push: f64,
    /// Force on the load along the tangent in the step (N).
    pub rub: f64,
}

impl ContactPoint {
    pub fn tangent(&self) -> Vec2 {
        perpendicular(&self.normal)
    }

    /// Force on the load in the step (N).
    pub fn force(&self) -> Vec2 {
        self.push * self.normal + self.rub * self.tangent()
    }

    /// The contact of a load whose origin is at `pose` after the step.
    pub fn at(&self, pose: &Pose) -> SideContact {
        SideContact { obstacle: self.obstacle, point: pose.position + self.arm, force: self.force() }
    }

    /// Velocity of a load with `twist` at the point, relative to the obstacle: along the normal and
    /// along the tangent (m/s).
    pub fn velocity_of(&self, twist: &Twist) -> [f64; 2] {
        let relative = twist.velocity_at(&self.arm) - self.velocity;
        [relative.dot(&self.normal), relative.dot(&self.tangent())]
    }

    /// Whether the load bounced off in a step from the twist `start` to `end`.
    pub fn bounced(&self, start: &Twist, end: &Twist) -> bool {
        self.restitution > 0.0 && self.push > 0.0 && self.velocity_of(start)[0] < 0.0 && self.velocity_of(end)[0] > 0.0
    }
}
