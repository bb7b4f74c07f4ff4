//! Drags as paths of tips and pushers: what a hand does is written into the scenario.

use serde::{Deserialize, Serialize};

use cohaul::math::{Pose, Vec2};
use cohaul::scenario::{Drive, Scenario, TipPath, Waypoint};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Handle {
    Spring(usize),
    /// This obstacle, which must be one that moves.
    Pusher(usize),
}

/// How a change of the scene reaches into time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// The run up to now is the same.
    Future,
    /// The run begins anew.
    Whole,
}

/// Speed of a dragged tip or pusher at most, in radii of the load in a second (1/s). A hand that
/// leaps is no hammer, and no pusher may pass through the load within one control period.
const FASTEST: f64 = 8.0;
/// Part of the load's radius by which a pusher may move at most in a control period (1).
const LONGEST_PUSH: f64 = 0.25;
/// Waypoints that are recorded at most in one scene (1): minutes of dragging.
const MOST_WAYPOINTS: usize = 20_000;

/// An interval of a drag: from one control tick to a later one (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    pub from: f64,
    pub to: f64,
}

/// Takes what the handle names from where it is at the beginning of the span towards a place (m,
/// world), as far as a hand goes until the end of it. There it then stays. `rest_tip` is the tip of
/// the spring while it is free.
///
/// # Errors
/// When nothing of that name can be dragged, with the reason.
pub fn drag(scenario: &mut Scenario, handle: Handle, to: Vec2, span: Span, rest_tip: Vec2) -> Result<Reach, String> {
    if !(to.x.is_finite() && to.y.is_finite()) {
        return Err("drag: must go to a finite place".to_owned());
    }
    if n_waypoints(scenario) > MOST_WAYPOINTS {
        return Err(format!("drag: at most {MOST_WAYPOINTS} waypoints are recorded; save the scene or begin anew"));
    }
    let farthest = FASTEST * scenario.system.load.radius * (span.to - span.from);
    scenario.duration = scenario.duration.max(span.to);
    match handle {
        Handle::Spring(spring) => {
            check_spring(scenario, spring)?;
            let Drive::Tips(paths) = &mut scenario.drive else { return Err("drag: switch the ants off first".to_owned()) };
            Ok(drag_tip(paths, spring, |from| reached(from, to, farthest), span, rest_tip))
        }
        Handle::Pusher(number) => {
            let farthest = farthest.min(LONGEST_PUSH * scenario.system.load.radius * (span.to - span.from) / scenario.control_period);
            let path = scenario.system.world.obstacles.get_mut(number).map(|obstacle| &mut obstacle.path).filter(|path| path.moves());
            let path = path.ok_or_else(|| format!("drag: must be an obstacle that moves, found obstacle {number}"))?;
            let now = path.pose_at(span.from);
            let has_waypoint =
                path.waypoints.iter().any(|(time, _)| *time == span.from) || path.waypoints[path.waypoints.len() - 1].0 < span.from;
            path.waypoints.retain(|(time, _)| *time < span.from);
            let target = Pose { position: reached(now.position, to, farthest), heading: now.heading };
            path.waypoints.extend([(span.from, now), (span.to, target)]);
            Ok(if has_waypoint { Reach::Future } else { Reach::Whole })
        }
    }
}

/// Lets go of the tip of a spring at a control tick (s).
///
/// # Errors
/// When no hand can hold it, with the reason.
pub fn release(scenario: &mut Scenario, spring: usize, now: f64) -> Result<Reach, String> {
    check_spring(scenario, spring)?;
    let Drive::Tips(paths) = &mut scenario.drive else { return Err("release: switch the ants off first".to_owned()) };
    let is_held = |path: &TipPath| path.spring == spring && is_attached(path, now) && path.waypoints[0].time < now;
    let path =
        paths.iter_mut().find(|path| is_held(path)).ok_or_else(|| format!("release: must be an attached spring, found spring {spring}"))?;
    path.release = Some(now);
    Ok(Reach::Future)
}

fn check_spring(scenario: &Scenario, spring: usize) -> Result<(), String> {
    let n = scenario.system.springs.len();
    if spring < n { Ok(()) } else { Err(format!("spring: must be below {n}, found {spring}")) }
}

fn is_attached(path: &TipPath, now: f64) -> bool {
    path.waypoints[0].time <= now && path.release.is_none_or(|release| release > now)
}

fn reached(from: Vec2, to: Vec2, farthest: f64) -> Vec2 {
    let way = to - from;
    let length = way.norm();
    if length <= farthest { to } else { from + farthest / length * way }
}

fn drag_tip(paths: &mut Vec<TipPath>, spring: usize, reached: impl Fn(Vec2) -> Vec2, Span { from, to }: Span, rest_tip: Vec2) -> Reach {
    paths.retain(|path| path.spring != spring || path.waypoints[0].time <= from);
    let Some(path) = paths.iter_mut().find(|path| path.spring == spring && is_attached(path, from)) else {
        let start = Waypoint { time: from, position: rest_tip };
        paths.push(TipPath { spring, waypoints: vec![start, Waypoint { time: to, position: reached(rest_tip) }], release: None });
        return Reach::Future;
    };
    path.release = None;
    let next = path.waypoints.partition_point(|at| at.time <= from);
    let last = path.waypoints[next - 1];
    // Within a straight part the position is rounded, and the part before ends there from now on.
    let (now, reach) = match path.waypoints.get(next) {
        Some(after) if last.time < from => {
            let share = (from - last.time) / (after.time - last.time);
            (last.position + share * (after.position - last.position), Reach::Whole)
        }
        _ => (last.position, Reach::Future),
    };
    path.waypoints.truncate(next);
    if last.time < from {
        path.waypoints.push(Waypoint { time: from, position: now });
    }
    path.waypoints.push(Waypoint { time: to, position: reached(now) });
    reach
}

fn n_waypoints(scenario: &Scenario) -> usize {
    let of_tips = match &scenario.drive {
        Drive::Tips(paths) => paths.iter().map(|path| path.waypoints.len()).sum(),
        Drive::Ants(_) => 0,
    };
    let pushers = scenario.system.world.obstacles.iter().filter(|obstacle| obstacle.path.moves());
    of_tips + pushers.map(|obstacle| obstacle.path.waypoints.len()).sum::<usize>()
}
