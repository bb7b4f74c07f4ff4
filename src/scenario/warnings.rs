//! What is odd about a valid scenario: a run goes through, and may not be what its author meant.

use super::Scenario;
use super::error::{Finding, Findings};
use crate::math::{Pose, Vec2};
use crate::model::World;
use crate::model::geometry::overlap_depth;

impl Scenario {
    /// Warnings about this scenario, each with its place, what should be, and what was found. The
    /// list is empty for most scenarios.
    pub fn warnings(&self) -> Vec<Finding> {
        let mut findings = Findings::default();
        overlapping_obstacles(&self.system.world, &mut findings);
        findings.0
    }
}

/// Obstacles inside each other at the start: each acts as if it were alone.
fn overlapping_obstacles(world: &World, findings: &mut Findings) {
    let poses: Vec<Pose> = world.obstacles.iter().map(|obstacle| obstacle.path.pose_at(0.0)).collect();
    for (index, obstacle) in world.obstacles.iter().enumerate() {
        for (before, other) in world.obstacles[..index].iter().enumerate() {
            let distance: Vec2 = poses[index].position - poses[before].position;
            if distance.norm() > obstacle.outline.extent() + other.outline.extent() {
                continue;
            }
            if let Some(depth) = overlap_depth(&obstacle.outline, &poses[index], &other.outline, &poses[before]) {
                let rule = format!("should not overlap another obstacle, as {:?} does at the start", obstacle.name);
                findings.report(format_args!("obstacles[{index}]"), rule, format_args!("a depth of {depth:.3e} m in {:?}", other.name));
            }
        }
    }
}
