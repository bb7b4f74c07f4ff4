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

/// Largest velocity at which a penetration is removed, over the radius of the load (1/s): the
/// engine's default, with the radius as the unit of length.
pub const FASTEST_CORRECTION: f64 = 3.0;

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
    /// Distance by which the contact may close in the step; negative where it must open by as much
    /// (m).
    pub room: f64,
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

    /// Distance by which the contact may close in a step of `duration` (s) that a load with the
    /// twist `start` begins; negative where it must open by as much (m).
    ///
    /// Where the velocity at the start closes the gap within the step, the step holds the impact,
    /// and the load leaves by Newton's law. Elsewhere it may close the gap by the end of the step.
    /// A penetration is removed at `fastest` (m/s) at most.
    pub fn room_in(&self, start: &Twist, duration: f64, fastest: f64) -> f64 {
        let shift = duration * self.velocity_of(start)[0];
        let room = self.gap.max(-duration * fastest);
        let is_bounce = self.restitution > 0.0 && shift < -room.max(0.0);
        if is_bounce { room.min(self.restitution * shift) } else { room }
    }

    /// Time from the start of a step, with the twist `start`, until the load bounces off (s);
    /// `None` where it does not.
    pub fn bounces_at(&self, start: &Twist) -> Option<f64> {
        let is_bounce = self.push > 0.0 && self.gap >= 0.0 && self.room < 0.0;
        is_bounce.then(|| -self.gap / self.velocity_of(start)[0])
    }
}
