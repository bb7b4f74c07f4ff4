//! Obstacles that were steered away from the paths of their scenario.

use super::numerics::LARGEST_ENTRY;
use super::report::RestoreError;
use crate::math::Pose;
use crate::model::{ObstaclePath, ObstaclePose, World};

/// Obstacles that were steered. Their present paths are those of the world.
#[derive(Clone, Debug, Default)]
pub(super) struct Steered(Vec<Given>);

/// An obstacle with the path that the scenario gives it.
#[derive(Clone, Debug)]
struct Given {
    obstacle: usize,
    path: ObstaclePath,
}

impl Steered {
    /// Steers an obstacle from `now` (s) on: see [`super::Backend::steer`]. Returns whether it did.
    pub fn steer(&mut self, world: &mut World, obstacle: usize, now: f64, course: &[(f64, Pose)]) -> bool {
        let Some(path) = world.obstacles.get_mut(obstacle).map(|obstacle| &mut obstacle.path) else { return false };
        let after_now = course.iter().all(|(after, _)| *after >= 0.0);
        if course.is_empty() || !after_now || !is_path(course) {
            return false;
        }
        self.keep(obstacle, path);
        path.steer(now, course);
        true
    }

    fn keep(&mut self, obstacle: usize, path: &ObstaclePath) {
        if self.0.iter().all(|given| given.obstacle != obstacle) {
            self.0.push(Given { obstacle, path: path.clone() });
            self.0.sort_by_key(|given| given.obstacle);
        }
    }

    /// Poses of all obstacles that were steered at `time` (s), in their order.
    pub fn poses(&self, world: &World, time: f64) -> Vec<ObstaclePose> {
        let pose = |given: &Given| ObstaclePose { obstacle: given.obstacle, pose: world.obstacles[given.obstacle].path.pose_at(time) };
        self.0.iter().map(pose).collect()
    }

    /// Present paths of all obstacles that were steered.
    pub fn save(&self, world: &World) -> Vec<(usize, ObstaclePath)> {
        self.0.iter().map(|given| (given.obstacle, world.obstacles[given.obstacle].path.clone())).collect()
    }

    /// Continues with the saved paths, and returns the obstacles that have other ones than before.
    ///
    /// # Errors
    /// When a path is none, or is one of an obstacle that is not there.
    pub fn restore(&mut self, world: &mut World, saved: Vec<(usize, ObstaclePath)>) -> Result<Vec<usize>, RestoreError> {
        let n = world.obstacles.len();
        if let Some((obstacle, _)) = saved.iter().find(|(obstacle, path)| *obstacle >= n || !is_path(&path.waypoints)) {
            return Err(RestoreError(format!("obstacle {obstacle} of {n} is steered along what is no path")));
        }
        let mut changed: Vec<usize> = self.0.iter().map(|given| given.obstacle).collect();
        for Given { obstacle, path } in self.0.drain(..) {
            world.obstacles[obstacle].path = path;
        }
        for (obstacle, path) in saved {
            changed.push(obstacle);
            self.keep(obstacle, &world.obstacles[obstacle].path);
            world.obstacles[obstacle].path = path;
        }
        Ok(changed)
    }
}

/// Whether these are times that increase, and poses to compute with.
fn is_path(waypoints: &[(f64, Pose)]) -> bool {
    let increases = waypoints.windows(2).all(|pair| pair[0].0 < pair[1].0);
    let entries = waypoints.iter().flat_map(|(time, pose)| [*time, pose.position.x, pose.position.y, pose.heading]);
    !waypoints.is_empty() && increases && entries.into_iter().all(|entry| entry.abs() <= LARGEST_ENTRY)
}
