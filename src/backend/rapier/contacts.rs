//! Contacts of the load with obstacles as plain data in f64 and world axes.

use crate::backend::numerics::{APART_CONTACTS, RIGHT_NORMAL};
use crate::backend::report::SideContact;
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

/// Normal of a pair of contacts between two straight sides, with these arms and gaps (m), for which
/// the engine has `found` one.
///
/// The normal is perpendicular to one of the sides, and the line through the contacts lies between
/// both. Where sides touch up to rounding, the engine takes the normal from the difference of two
/// points that are the same, and it may be wrong by degrees.
pub fn normal_of_sides(found: Vec2, arms: [Vec2; 2], gaps: [f64; 2]) -> Vec2 {
    let along = arms[1] - arms[0];
    let length = along.norm();
    let is_right = found.dot(&along).abs() <= (gaps[1] - gaps[0]).abs() + RIGHT_NORMAL * length;
    if is_right || length <= APART_CONTACTS * arms[0].norm() {
        return found;
    }
    let across = perpendicular(&along) / length;
    across * across.dot(&found).signum()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Sides that touch are perpendicular to their normal, and the one of sides at an angle stays.
    #[test]
    fn a_wrong_normal_of_two_sides_is_replaced() {
        let arms = [Vec2::new(-0.012, -0.008), Vec2::new(0.012, -0.008)];
        assert_eq!(normal_of_sides(Vec2::new(-0.09, 0.996), arms, [4e-8, 0.0]), Vec2::y());
        let tilted = Vec2::new(-0.01, 1.0).normalize();
        assert_eq!(normal_of_sides(tilted, arms, [0.0, 2.4e-4]), tilted);
        // Contacts at one point show no direction.
        assert_eq!(normal_of_sides(Vec2::x(), [arms[0], arms[0]], [0.0; 2]), Vec2::x());
    }
}
