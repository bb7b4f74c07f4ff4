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

/// How a hand holds what it drags.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Where the hand is (m, world).
    pub to: Vec2,
    /// How fast what is held comes to the hand (1/s): half of the distance is left after 1.7 times
    /// its inverse.
    pub rate: f64,
}

/// Takes what the handle names from where it is at the beginning of the span towards the hand. A
/// spring and a damper of critical damping are between the two, so that a hand whose place comes in
/// leaps is followed smoothly, and one that moves steadily at a constant distance. At the end of
/// the span it stays where it is. `rest_tip` is the tip of the spring while it is free (m, world).
///
/// # Errors
/// When nothing of that name can be dragged, with the reason.
pub fn drag(scenario: &mut Scenario, handle: Handle, pull: Pull, span: Span, rest_tip: Vec2) -> Result<Reach, String> {
    if !(pull.to.x.is_finite() && pull.to.y.is_finite()) {
        return Err("drag: must go to a finite place".to_owned());
    }
    if n_waypoints(scenario) > MOST_WAYPOINTS {
        return Err(format!("drag: at most {MOST_WAYPOINTS} waypoints are recorded; save the scene or begin anew"));
    }
    let (radius, period, duration) = (scenario.system.load.radius, scenario.control_period, span.to - span.from);
    scenario.duration = scenario.duration.max(span.to);
    // Between two places a control period apart it went straight.
    let reached = |[before, now]: [Vec2; 2], most: f64| {
        within(now, pull.followed(now, limited((now - before) / period, FASTEST * radius), duration), most)
    };
    match handle {
        Handle::Spring(spring) => {
            check_spring(scenario, spring)?;
            let Drive::Tips(paths) = &mut scenario.drive else { return Err("drag: switch the ants off first".to_owned()) };
            let farthest = FASTEST * radius * duration;
            Ok(drag_tip(
                paths,
                spring,
                span,
                |path| {
                    reached(path.map_or([rest_tip; 2], |path| [span.from - period, span.from].map(|time| position(path, time))), farthest)
                },
                rest_tip,
            ))
        }
        Handle::Pusher(number) => {
            let farthest = (FASTEST * radius).min(LONGEST_PUSH * radius / period) * duration;
            let path = scenario.system.world.obstacles.get_mut(number).map(|obstacle| &mut obstacle.path).filter(|path| path.moves());
            let path = path.ok_or_else(|| format!("drag: must be an obstacle that moves, found obstacle {number}"))?;
            let [before, now] = [span.from - period, span.from].map(|time| path.pose_at(time));
            let has_waypoint =
                path.waypoints.iter().any(|(time, _)| *time == span.from) || path.waypoints[path.waypoints.len() - 1].0 < span.from;
            path.waypoints.retain(|(time, _)| *time < span.from);
            let target = Pose { position: reached([before.position, now.position], farthest), heading: now.heading };
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

impl Pull {
    /// Where something is after a time (s) that was at `from` with this velocity (m/s): solution of
    /// x'' = rate^2 (to - x) - 2 rate x'.
    fn followed(&self, from: Vec2, velocity: Vec2, duration: f64) -> Vec2 {
        let (away, left) = (from - self.to, (-self.rate * duration).exp());
        self.to + left * (away + duration * (velocity + self.rate * away))
    }
}

/// `vector`, shortened to this length if it is longer.
fn limited(vector: Vec2, most: f64) -> Vec2 {
    let length = vector.norm();
    if length <= most { vector } else { most / length * vector }
}

fn within(from: Vec2, to: Vec2, farthest: f64) -> Vec2 {
    from + limited(to - from, farthest)
}

/// Where a tip is, at rest before the first waypoint and after the last.
fn position(path: &TipPath, time: f64) -> Vec2 {
    let next = path.waypoints.partition_point(|at| at.time <= time);
    let Some(last) = next.checked_sub(1).map(|at| path.waypoints[at]) else { return path.waypoints[0].position };
    match path.waypoints.get(next) {
        Some(after) => last.position + (time - last.time) / (after.time - last.time) * (after.position - last.position),
        None => last.position,
    }
}

/// Takes the tip of a spring to where `reached` says, by the path that it had.
fn drag_tip(
    paths: &mut Vec<TipPath>,
    spring: usize,
    Span { from, to }: Span,
    reached: impl Fn(Option<&TipPath>) -> Vec2,
    rest_tip: Vec2,
) -> Reach {
    paths.retain(|path| path.spring != spring || path.waypoints[0].time <= from);
    let Some(path) = paths.iter_mut().find(|path| path.spring == spring && is_attached(path, from)) else {
        let start = Waypoint { time: from, position: rest_tip };
        paths.push(TipPath { spring, waypoints: vec![start, Waypoint { time: to, position: reached(None) }], release: None });
        return Reach::Future;
    };
    path.release = None;
    let end = reached(Some(path));
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
    path.waypoints.push(Waypoint { time: to, position: end });
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
