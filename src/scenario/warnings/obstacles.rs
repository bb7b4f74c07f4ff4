//! Obstacles that overlap.

use crate::math::{Pose, Vec2};
use crate::model::World;
use crate::model::geometry::overlap_depth;
use crate::scenario::error::Findings;

/// Obstacles inside each other at the start: each acts as if it were alone.
pub fn check(world: &World, findings: &mut Findings) {
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
