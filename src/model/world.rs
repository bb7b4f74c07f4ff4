//! What the load can touch: its own outline, obstacles, and the laws of their contact.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Outline;
use crate::math::{Pose, Twist, Vec2};

/// Outline of the load, the obstacles about it, and the laws of their contact. Nothing in it
/// changes during a run; obstacles move along paths that are given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct World {
    /// Outline of the load.
    pub outline: Outline,
    /// Obstacles. An obstacle is named by its index.
    pub obstacles: Vec<Obstacle>,
}

/// A body that the load cannot push away: it stands still or moves along a given path.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Name in reports.
    pub name: String,
    /// Shape in the obstacle's frame.
    pub outline: Outline,
    /// Coulomb's coefficient of friction between load and obstacle, combined from both (1).
    pub friction_coefficient: f64,
    /// Coefficient of restitution of an impact of the load on it, from 0 to 1 (1).
    pub restitution: f64,
    /// Motion of the obstacle's frame.
    pub path: ObstaclePath,
}

/// Poses over time: straight in position and heading between the waypoints, constant before the
/// first and after the last one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObstaclePath {
    /// Times (s), strictly increasing, and poses (m, rad, world); at least one.
    pub waypoints: Vec<(f64, Pose)>,
}

/// Where an obstacle is, or shall be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObstaclePose {
    /// Index in [`World::obstacles`].
    pub obstacle: usize,
    /// Pose of the obstacle's frame (m, rad, world).
    pub pose: Pose,
}

/// Combination of the coefficients of side friction of the load and an obstacle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SideFrictionRule {
    /// Square root of the product.
    #[default]
    GeometricMean,
    /// Arithmetic mean.
    Average,
    /// The smaller one.
    Min,
    /// The product.
    Multiply,
    /// The larger one.
    Max,
}

impl SideFrictionRule {
    /// Coefficient of the contact of two bodies with these coefficients (1).
    pub fn combine(self, a: f64, b: f64) -> f64 {
        match self {
            Self::GeometricMean => (a * b).sqrt(),
            Self::Average => 0.5 * (a + b),
            Self::Min => a.min(b),
            Self::Multiply => a * b,
            Self::Max => a.max(b),
        }
    }
}

impl World {
    /// Whether there is nothing that the load could touch.
    pub fn is_empty(&self) -> bool {
        self.obstacles.is_empty()
    }

    /// First time after `time` at which an obstacle changes its velocity; infinite without one (s).
    pub fn next_corner(&self, time: f64) -> f64 {
        let moving = self.obstacles.iter().map(|obstacle| &obstacle.path).filter(|path| path.moves());
        moving.filter_map(|path| path.next_waypoint(time)).fold(f64::INFINITY, f64::min)
    }
}

impl Obstacle {
    /// Bound of the path length of any point of the obstacle between two times (m).
    pub fn path_length(&self, from: f64, to: f64) -> f64 {
        if self.path.moves() { self.path.length(self.outline.extent(), from, to) } else { 0.0 }
    }
}

/// Share of a step in which a waypoint lies at its end (1).
const CORNER: f64 = 1e-6;

impl ObstaclePath {
    /// An obstacle that stands still.
    pub fn fixed(pose: Pose) -> Self {
        Self { waypoints: vec![(0.0, pose)] }
    }

    /// Replaces what comes after `now` (s) by a `course` of times from now (s) and poses. It leads
    /// from where the obstacle is, or from the pose of the time 0. The part of the path that ends
    /// now stays.
    pub fn steer(&mut self, now: f64, course: &[(f64, Pose)]) {
        let here = (now, self.pose_at(now));
        let n_before = self.waypoints.partition_point(|(time, _)| *time < now);
        self.waypoints.truncate(n_before);
        self.waypoints.drain(..n_before.saturating_sub(1));
        if course.first().is_none_or(|(after, _)| *after > 0.0) {
            self.waypoints.push(here);
        }
        self.waypoints.extend(course.iter().map(|(after, pose)| (now + after, *pose)));
    }

    /// Whether the obstacle ever moves.
    pub fn moves(&self) -> bool {
        self.waypoints.len() > 1
    }

    /// Waypoints around `time` (s): those before and after it, the same one before the first and
    /// after the last.
    fn around(&self, time: f64) -> (&(f64, Pose), &(f64, Pose)) {
        let next = self.waypoints.partition_point(|(at, _)| *at <= time);
        let last = self.waypoints.len() - 1;
        (&self.waypoints[next.saturating_sub(1)], &self.waypoints[next.min(last)])
    }

    /// First time of a waypoint after `time` (s).
    fn next_waypoint(&self, time: f64) -> Option<f64> {
        let next = self.waypoints.partition_point(|(at, _)| *at <= time);
        self.waypoints.get(next).map(|(at, _)| *at)
    }

    /// Bound of the path length of the points within `extent` (m) of the origin between two times
    /// (m).
    pub fn length(&self, extent: f64, from: f64, to: f64) -> f64 {
        if from == to {
            return 0.0;
        }
        let (from, to) = (from.min(to), from.max(to));
        let mut last = self.pose_at(from);
        let mut length = 0.0;
        let corners = self.waypoints.iter().filter(|(time, _)| *time > from && *time < to).map(|(_, pose)| *pose);
        for next in corners.chain([self.pose_at(to)]) {
            length += next.edge_displacement(&last, extent);
            last = next;
        }
        length
    }

    /// Pose at `time` (s).
    pub fn pose_at(&self, time: f64) -> Pose {
        let ((from, a), (to, b)) = self.around(time);
        if to <= from {
            return *a;
        }
        let share = ((time - from) / (to - from)).clamp(0.0, 1.0);
        a.towards(b, share)
    }

    /// Shift (m) and turn (rad) in a step of this length (s) between two times, of which the
    /// difference of poses has fewer digits.
    pub fn displacement(&self, [from, to]: [f64; 2], step: f64) -> (Vec2, f64) {
        let is_within = |at: f64| (at - from).min(to - at) > CORNER * (to - from);
        if self.waypoints.iter().any(|(at, _)| is_within(*at)) {
            let [from, to] = [from, to].map(|time| self.pose_at(time));
            return (to.position - from.position, to.heading - from.heading);
        }
        let twist = self.twist_after(0.5 * (from + to));
        (step * twist.linear, step * twist.angular)
    }

    /// Twist just after `time` (s).
    pub fn twist_after(&self, time: f64) -> Twist {
        let ((from, a), (to, b)) = self.around(time);
        if to <= from || time < *from {
            return Twist { linear: Vec2::zeros(), angular: 0.0 };
        }
        Twist { linear: (b.position - a.position) / (to - from), angular: (b.heading - a.heading) / (to - from) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steered_obstacle_leaves_its_path_from_where_it_is() {
        let at = |x: f64| Pose::new(x, 0.0, 0.0);
        let mut path = ObstaclePath { waypoints: vec![(0.0, at(0.0)), (1.0, at(1.0)), (4.0, at(4.0))] };
        path.steer(2.0, &[(1.0, at(0.0))]);
        assert_eq!(path.waypoints, [(1.0, at(1.0)), (2.0, at(2.0)), (3.0, at(0.0))]);
        assert_eq!([1.5, 2.5, 9.0].map(|time| path.pose_at(time).position.x), [1.5, 1.0, 0.0]);
        // The second part begins where the first one ends, and keeps its velocity.
        path.steer(3.0, &[(0.5, at(2.0)), (1.0, at(3.0))]);
        assert_eq!(path.twist_after(2.5).linear.x, -2.0);
        assert_eq!([3.25, 3.75].map(|time| path.twist_after(time).linear.x), [4.0, 2.0]);
        let mut placed = ObstaclePath::fixed(at(0.0));
        placed.steer(0.0, &[(0.0, at(7.0))]);
        assert_eq!(placed, ObstaclePath::fixed(at(7.0)));
    }

    #[test]
    fn an_obstacle_stands_before_and_after_its_path() {
        let path = ObstaclePath { waypoints: vec![(1.0, Pose::new(0.0, 0.0, 0.0)), (3.0, Pose::new(2.0, -1.0, 0.5))] };
        assert_eq!(path.pose_at(0.0), Pose::new(0.0, 0.0, 0.0));
        assert_eq!(path.pose_at(2.0), Pose::new(1.0, -0.5, 0.25));
        assert_eq!(path.pose_at(9.0), Pose::new(2.0, -1.0, 0.5));
        // Within a part of the path, beside its corners and beyond them.
        for [from, to] in [[0.0, 0.5], [1.0, 1.5], [1.25, 3.0], [0.5, 2.0], [2.0, 4.0]] {
            let ([a, b], (shift, turn)) = ([from, to].map(|time| path.pose_at(time)), path.displacement([from, to], to - from));
            assert!((b.position - a.position - shift).norm() < 1e-15 && (b.heading - a.heading - turn).abs() < 1e-15, "{from} {to}");
        }
        assert_eq!(path.twist_after(0.5), Twist::ZERO);
        assert_eq!(path.twist_after(1.0), Twist { linear: Vec2::new(1.0, -0.5), angular: 0.25 });
        assert_eq!(path.twist_after(3.0), Twist::ZERO);
    }
}
