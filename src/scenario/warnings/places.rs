//! Places that do not fit the load: tips far from their springs, springs that cannot move the load,
//! and places far away.

use std::collections::BTreeMap;

use crate::math::Vec2;
use crate::model::PolarSpring;
use crate::scenario::error::{Findings, short};
use crate::scenario::{AntDrive, Drive, Scenario, TipPath};

/// Largest distance of a tip from that of the undeformed spring when it is attached, over the rest
/// length (1). A tip that belongs to another spring is mostly farther away.
const FARTHEST_TIP: f64 = 0.5;
/// The same for a spring without rest length, over the load's radius (1).
const FARTHEST_TIP_OF_ISOTROPIC: f64 = 20.0;
/// Least sum of all pulls on a load at rest over what it takes to move it (1).
const WEAKEST_PULL: f64 = 0.1;
/// Largest distance from the start over the size of load and springs (1).
const FARTHEST: f64 = 1000.0;

pub fn check(scenario: &Scenario, findings: &mut Findings) {
    far_places(scenario, findings);
    match &scenario.drive {
        Drive::Tips(paths) => {
            tips(scenario, paths, findings);
            weak_pulls(scenario, most_pulled(scenario, paths), findings);
        }
        Drive::Ants(drive) => {
            let n = drive.n_ants.min(scenario.system.springs.len());
            let arms = scenario.system.springs.iter().map(|spring| spring.rest_tip().norm());
            let pull = n as f64 * drive.release.strong_pull;
            weak_pulls(scenario, Some([pull, pull * arms.fold(0.0, f64::max)]), findings);
            nest(scenario, drive, findings);
        }
    }
}

/// Places farther from the start than any load is towed.
fn far_places(scenario: &Scenario, findings: &mut Findings) {
    let system = &scenario.system;
    let size = system.load.radius + system.springs.iter().map(|spring| spring.rest_length).fold(0.0, f64::max);
    let mut near = |path: String, position: Vec2, extent: f64| {
        let distance = (position - scenario.start.pose.position).norm() - extent;
        let is_far = distance > FARTHEST * size;
        if is_far {
            let most = short(FARTHEST * size);
            let rule =
                format!("should be in metres, and within {most} m of the load's start, {FARTHEST} times the size of load and springs");
            findings.report(path, rule, format_args!("a distance of {} m", short(distance)));
        }
        is_far
    };
    for (index, obstacle) in system.world.obstacles.iter().enumerate() {
        let extent = obstacle.outline.extent();
        let place = |at: usize| match obstacle.path.moves() {
            true => format!("obstacles[{index}].path.waypoints[{at}]"),
            false => format!("obstacles[{index}].position_m"),
        };
        let mut poses = obstacle.path.waypoints.iter().enumerate();
        poses.any(|(at, (_, pose))| near(place(at), pose.position, extent));
    }
    match &scenario.drive {
        Drive::Tips(paths) => {
            for (index, path) in paths.iter().enumerate() {
                let mut points = path.waypoints.iter().enumerate();
                points.any(|(at, point)| near(format!("drive.paths[{index}].waypoints[{at}]"), point.position, 0.0));
            }
        }
        Drive::Ants(drive) => drop(near("drive.nest_position_m".into(), drive.nest_position, 0.0)),
    }
}

/// Tips that are attached far from their springs. The load may have been moved by then, as far as
/// whatever moves it.
fn tips(scenario: &Scenario, paths: &[TipPath], findings: &mut Findings) {
    let (system, pose) = (&scenario.system, &scenario.start.pose);
    let by_tips = moved_by_tips(paths);
    for ((index, path), by_tips) in paths.iter().enumerate().zip(by_tips) {
        let (spring, first) = (&system.springs[path.spring], &path.waypoints[0]);
        let distance = (first.position - pose.to_world(&spring.rest_tip())).norm();
        let most = farthest_tip(spring, system.load.radius) + by_tips + moved_otherwise(scenario, first.time);
        if distance > most {
            let rule = format!("should be near the tip of the undeformed spring {}: within {} m", path.spring, short(most));
            findings.report(format_args!("drive.paths[{index}].waypoints[0]"), rule, format_args!("a distance of {} m", short(distance)));
        }
    }
}

fn farthest_tip(spring: &PolarSpring, radius: f64) -> f64 {
    if spring.rest_length > 0.0 { FARTHEST_TIP * spring.rest_length } else { FARTHEST_TIP_OF_ISOTROPIC * radius }
}

/// Bound of the distance by which tips have moved the load before each path begins (m): the path
/// length of the tip that is the fastest at each instant. It is in the order of the paths.
fn moved_by_tips(paths: &[TipPath]) -> Vec<f64> {
    /// What happens at a time, in this order.
    #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    enum Change {
        Begins(usize),
        Faster(u64),
        Slower(u64),
    }
    let mut changes: Vec<(f64, Change)> = Vec::new();
    for (index, path) in paths.iter().enumerate() {
        changes.push((path.waypoints[0].time, Change::Begins(index)));
        for pair in path.waypoints.windows(2) {
            let duration = pair[1].time - pair[0].time;
            // The bits of positive numbers have the order of the numbers.
            let speed = ((pair[1].position - pair[0].position).norm() / duration).to_bits();
            changes.extend([(pair[0].time, Change::Faster(speed)), (pair[1].time, Change::Slower(speed))]);
        }
    }
    changes.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let (mut speeds, mut moved, mut last) = (BTreeMap::<u64, usize>::new(), 0.0, 0.0);
    let mut found = vec![0.0; paths.len()];
    for (time, change) in changes {
        let fastest = speeds.last_key_value().map_or(0.0, |(speed, _)| f64::from_bits(*speed));
        moved += fastest * (time - last);
        last = time;
        match change {
            Change::Begins(index) => found[index] = moved,
            Change::Faster(speed) => *speeds.entry(speed).or_default() += 1,
            Change::Slower(speed) => {
                let left = speeds.get_mut(&speed).map_or(0, |n| {
                    *n -= 1;
                    *n
                });
                if left == 0 {
                    speeds.remove(&speed);
                }
            }
        }
    }
    found
}

/// Bound of the distance by which anything else has moved the load before `time` (s): the path
/// length of an obstacle, or the coast of the load's speed at the start (m).
fn moved_otherwise(scenario: &Scenario, time: f64) -> f64 {
    if time == 0.0 {
        return 0.0;
    }
    let by_obstacles = scenario.system.world.obstacles.iter().map(|obstacle| obstacle.path_length(0.0, time)).fold(0.0, f64::max);
    by_obstacles + scenario.start.twist.linear.norm() * time
}

/// Sums of the largest forces and torques of all tips on a load that stays where it starts (N,
/// N m); `None` if something else moves the load.
fn most_pulled(scenario: &Scenario, paths: &[TipPath]) -> Option<[f64; 2]> {
    let (system, start) = (&scenario.system, &scenario.start);
    let is_at_rest = start.twist.linear.norm() == 0.0 && start.twist.angular == 0.0;
    let is_pushed = system.world.obstacles.iter().any(|obstacle| obstacle.path.moves());
    if !is_at_rest || is_pushed || paths.is_empty() {
        return None;
    }
    let mut most = [0.0; 2];
    for path in paths {
        let spring = &system.springs[path.spring];
        let rest = start.pose.to_world(&spring.rest_tip());
        let stretch = path.waypoints.iter().map(|point| (point.position - rest).norm()).fold(0.0, f64::max);
        let pull = spring.largest_stiffness() * stretch;
        most = [most[0] + pull, most[1] + pull * spring.rest_tip().norm()];
    }
    Some(most)
}

/// Pulls that are far too weak to move the load.
fn weak_pulls(scenario: &Scenario, most: Option<[f64; 2]>, findings: &mut Findings) {
    let (limit, torque) = (scenario.system.total_slip_limit(), scenario.system.total_slip_torque());
    let Some([pull, turn]) = most.filter(|_| limit > 0.0) else { return };
    let share = (pull / limit).max(if torque > 0.0 { turn / torque } else { 0.0 });
    if share < WEAKEST_PULL {
        let found = format!("{} of the slip limit, {} N, at most", short(share), short(limit));
        findings.report("load", "should be light enough to be moved: masses are in kilograms, stiffnesses in N/m", found);
    }
}

/// A nest that the load has reached before it starts.
fn nest(scenario: &Scenario, drive: &AntDrive, findings: &mut Findings) {
    let distance = (drive.nest_position - scenario.start.pose.position).norm();
    if distance <= drive.arrival_radius {
        let rule = format!("should be below the distance of the nest from the load's start, {} m: the run ends at once", short(distance));
        findings.report("drive.arrival_radius_m", rule, format_args!("{} m", short(drive.arrival_radius)));
    }
}
