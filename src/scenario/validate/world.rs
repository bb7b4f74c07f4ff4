//! Rules of obstacles, and of their contact with the load.

use super::load::CheckedLoad;
use super::outline;
use super::shared::{SHORTEST_PART, check_waypoints, is_control};
use crate::math::Pose;
use crate::model::geometry::overlap_depth;
use crate::model::{Obstacle, ObstaclePath, Outline, SideFrictionRule, World};
use crate::scenario::error::{Findings, is_in_range, number, short};
use crate::scenario::format::ObstacleEntry;

/// Largest number of obstacles (1).
const MOST_OBSTACLES: usize = 1000;

/// The world around a load, where that is known. Coefficients of the load and of an obstacle are
/// combined here: those of friction by the `rule`, those of restitution to the larger one.
pub fn world(
    entries: &[ObstacleEntry],
    rule: SideFrictionRule,
    load: Option<&CheckedLoad>,
    control_period: Option<f64>,
    findings: &mut Findings,
) -> World {
    if entries.len() > MOST_OBSTACLES {
        findings.report("obstacles", format!("must be at most {MOST_OBSTACLES}"), entries.len());
        return World::default();
    }
    let shortest = SHORTEST_PART * control_period.filter(|period| *period > 0.0).unwrap_or_default();
    let mut obstacles = Vec::new();
    for (index, entry) in entries.iter().enumerate() {
        let place = format!("obstacles[{index}]");
        check_name(&entries[..index], entry, &place, findings);
        let Some(mut obstacle) = obstacle(entry, &place, shortest, findings) else { continue };
        if let Some(load) = load {
            obstacle.friction_coefficient = rule.combine(load.side_friction, obstacle.friction_coefficient);
            obstacle.restitution = obstacle.restitution.max(load.restitution);
            check_against(load, &obstacle, control_period, &place, findings);
        }
        obstacles.push(obstacle);
    }
    World { outline: load.and_then(|load| load.outline.clone()).unwrap_or_default(), obstacles }
}

fn check_name(before: &[ObstacleEntry], entry: &ObstacleEntry, place: &str, findings: &mut Findings) {
    let path = format!("{place}.name");
    let name = &entry.name;
    if name.trim().is_empty() {
        findings.report(path, "must not be empty", format_args!("{name:?}"));
    } else if name.chars().any(is_control) {
        findings.report(path, "must not contain control characters", format_args!("{name:?}"));
    } else if let Some(first) = before.iter().position(|other| other.name == *name) {
        findings.report(path, format!("must not be the name of another obstacle, obstacles[{first}]"), format_args!("{name:?}"));
    }
}

/// The obstacle with its own coefficients; `None` where outline or path break a rule. From one of
/// its waypoints to the next there is at least the time `shortest` (s).
fn obstacle(entry: &ObstacleEntry, place: &str, shortest: f64, findings: &mut Findings) -> Option<Obstacle> {
    findings.not_negative(format_args!("{place}.friction_coefficient"), entry.friction_coefficient);
    outline::restitution(format_args!("{place}.restitution"), entry.restitution, findings);
    let outline = outline::outline(&entry.outline, &format!("{place}.outline"), findings);
    let n_before = findings.0.len();
    let path = obstacle_path(entry, place, shortest, findings);
    (findings.0.len() == n_before).then_some(Obstacle {
        name: entry.name.clone(),
        outline: outline?,
        friction_coefficient: entry.friction_coefficient,
        restitution: entry.restitution,
        path,
    })
}

fn obstacle_path(entry: &ObstacleEntry, place: &str, shortest: f64, findings: &mut Findings) -> ObstaclePath {
    let (position, heading) = (entry.position_m.unwrap_or_default(), entry.heading_rad.unwrap_or_default());
    findings.finite_vector(format_args!("{place}.position_m"), &position);
    findings.finite(format_args!("{place}.heading_rad"), heading);
    let fixed = ObstaclePath::fixed(Pose { position: position.into(), heading });
    let Some(path) = &entry.path else { return fixed };
    if entry.position_m.is_some() || entry.heading_rad.is_some() {
        let rule = "must not be given together with position_m or heading_rad: its first waypoint is the start";
        findings.report(format_args!("{place}.path"), rule, "both");
    }
    check_waypoints(&path.waypoints, &format!("{place}.path.waypoints"), shortest, findings);
    if let Some([time, ..]) = path.waypoints.first().filter(|[time, ..]| *time > 0.0 && *time < shortest) {
        let rule = format!("must be zero or at least {} s, {SHORTEST_PART:e} control periods", short(shortest));
        findings.report(format_args!("{place}.path.waypoints[0][0]"), rule, number(*time));
    }
    match path.waypoints.as_slice() {
        [] => fixed,
        // An obstacle with one waypoint stands still.
        [[_, x, y, heading]] => ObstaclePath::fixed(Pose::new(*x, *y, *heading)),
        several => ObstaclePath { waypoints: several.iter().map(|[time, x, y, heading]| (*time, Pose::new(*x, *y, *heading))).collect() },
    }
}

/// Rules of a load and an obstacle at the start and on the obstacle's path.
fn check_against(load: &CheckedLoad, obstacle: &Obstacle, control_period: Option<f64>, place: &str, findings: &mut Findings) {
    let Some(outline) = &load.outline else { return };
    let Pose { position, heading } = load.start.pose;
    if [position.x, position.y, heading].into_iter().all(is_in_range) {
        check_start(outline, &load.start.pose, obstacle, place, findings);
    }
    let Some(period) = control_period.filter(|period| *period > 0.0 && period.is_finite()) else { return };
    let (width, radius) = (2.0 * outline.extent(), obstacle.outline.extent());
    for (index, pair) in obstacle.path.waypoints.windows(2).enumerate() {
        let [(from, a), (to, b)] = [pair[0], pair[1]];
        let displacement = b.edge_displacement(&a, radius) * period / (to - from);
        if displacement > width {
            let rule = format!("must be reached with at most {} m in a control period, twice the extent of the load", number(width));
            findings.report(format_args!("{place}.path.waypoints[{}]", index + 1), rule, format_args!("{} m", number(displacement)));
        }
    }
}

fn check_start(outline: &Outline, start: &Pose, obstacle: &Obstacle, place: &str, findings: &mut Findings) {
    if let Some(depth) = overlap_depth(outline, start, &obstacle.outline, &obstacle.path.pose_at(0.0)) {
        let rule = format!("must not overlap the load at the start, as {:?} does", obstacle.name);
        findings.report(place, rule, format_args!("a depth of {depth:.3e} m"));
    }
}
