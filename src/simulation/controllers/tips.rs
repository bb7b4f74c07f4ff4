//! Prescribed tips: straight between waypoints, at rest after the last.

use super::controller::{Commands, Controller, View, check_attached};
use crate::backend::{AttachedTip, RestoreError, SaveError};
use crate::math::Vec2;
use crate::scenario::{Scenario, TipPath, Waypoint};
use crate::simulation::clock::SAME_INSTANT;
use crate::simulation::trace::{Event, EventKind};

/// Moves tips along prescribed paths. All follows from the time, so there is no state.
pub struct Tips {
    paths: Vec<TipPath>,
    /// Number of the first waypoint of each path after the last instant: where the next search
    /// begins.
    after: Vec<usize>,
    /// Times of all waypoints and releases, in order (s).
    instants: Vec<f64>,
    /// Number of the first of them after the last instant: where the next search begins.
    next: usize,
    targets: Vec<Vec2>,
    /// Whether a spring has several paths, of which those count that it is attached on.
    has_several: bool,
}

impl Tips {
    /// A controller of the tips along `paths`. A time within rounding of a tick becomes that tick,
    /// and times within rounding of each other become one, so that no step has length zero. A tip
    /// that would be let go at the instant of its grasp is never attached.
    pub fn new(scenario: &Scenario, paths: &[TipPath]) -> Self {
        let same = SAME_INSTANT * scenario.control_period;
        let (instants, all_exact) = instants_of(paths, scenario.control_period);
        let rounded = |time: f64| instants[instants.partition_point(|instant| *instant < time - same)];
        let with_rounded_times = |path: &TipPath| TipPath {
            spring: path.spring,
            waypoints: path.waypoints.iter().map(|at| Waypoint { time: rounded(at.time), ..*at }).collect(),
            release: path.release.map(rounded),
        };
        let is_attached = |path: &TipPath| path.release.is_none_or(|release| release > path.waypoints[0].time);
        let (paths, instants) = if all_exact && paths.iter().all(is_attached) {
            (paths.to_vec(), instants)
        } else {
            let paths: Vec<TipPath> = paths.iter().map(with_rounded_times).filter(is_attached).collect();
            let (instants, _) = instants_of(&paths, scenario.control_period);
            (paths, instants)
        };
        let n_springs = scenario.system.springs.len();
        let mut has_path = vec![false; n_springs];
        let has_several = paths.iter().any(|path| std::mem::replace(&mut has_path[path.spring], true));
        let (after, targets) = (vec![0; paths.len()], vec![Vec2::zeros(); n_springs]);
        Self { paths, after, instants, next: 0, targets, has_several }
    }

    /// Number of the first instant after `time` (s).
    fn first_after(&self, time: f64) -> usize {
        let is_it = |at: usize| is_first_after(at, self.instants.len(), time, |at| self.instants[at]);
        let near = [self.next, self.next + 1].into_iter().find(|at| is_it(*at));
        near.unwrap_or_else(|| self.instants.partition_point(|instant| *instant <= time))
    }
}

/// Times of the waypoints of a path and of its release (s).
fn times_of(path: &TipPath) -> impl Iterator<Item = f64> + '_ {
    path.waypoints.iter().map(|at| at.time).chain(path.release)
}

/// Times of all waypoints and releases in order (s), and whether none of them was changed. A time
/// within rounding of a tick is replaced by the tick, and a group of times within rounding by its
/// first.
fn instants_of(paths: &[TipPath], control_period: f64) -> (Vec<f64>, bool) {
    let same = SAME_INSTANT * control_period;
    let mut all_exact = true;
    let mut at_tick = |time: f64| {
        // Times are not negative, so that this rounds to the nearest; a time too large for a whole
        // number is no tick.
        let tick = (time / control_period + 0.5) as i64 as f64 * control_period;
        if (time - tick).abs() > same {
            return time;
        }
        all_exact &= time == tick;
        tick
    };
    let mut instants: Vec<f64> = Vec::new();
    for path in paths {
        let (first, known) = (paths[0].waypoints.len(), instants.len());
        instants.extend(times_of(path).map(&mut at_tick));
        // Paths mostly turn at the same times.
        if known >= first && instants[known..] == instants[..first] {
            instants.truncate(known);
        }
    }
    instants.sort_by(f64::total_cmp);
    instants.dedup_by(|later, kept| {
        let is_same = *later - *kept <= same;
        all_exact &= !is_same || *later == *kept;
        is_same
    });
    (instants, all_exact)
}

/// Whether `at` is the number of the first of `n` instants after `time` (s).
fn is_first_after(at: usize, n: usize, time: f64, instant: impl Fn(usize) -> f64) -> bool {
    at <= n && (at == n || instant(at) > time) && (at == 0 || instant(at - 1) <= time)
}

/// Number of the first waypoint of a path after `time` (s), searched for near `guess` first.
fn first_after(path: &TipPath, time: f64, guess: usize) -> usize {
    let is_it = |at: usize| is_first_after(at, path.waypoints.len(), time, |at| path.waypoints[at].time);
    let near = [guess, guess + 1].into_iter().find(|at| is_it(*at));
    near.unwrap_or_else(|| path.waypoints.partition_point(|at| at.time <= time))
}

/// Position on a path at `time` (s), where `after` is the first later waypoint (m, world). Before
/// the first waypoint and after the last one, the path rests there.
fn position_at(path: &TipPath, time: f64, after: usize) -> Vec2 {
    match (after.checked_sub(1).map(|i| path.waypoints[i]), path.waypoints.get(after)) {
        (Some(last), Some(next)) => {
            let share = (time - last.time) / (next.time - last.time);
            last.position + share * (next.position - last.position)
        }
        (Some(last), None) => last.position,
        (None, next) => next.expect("a path has a waypoint").position,
    }
}

impl Controller for Tips {
    fn decide(&mut self, view: &View, commands: &mut Commands) {
        let mut event = |path: &TipPath, kind| {
            let tip = position_at(path, view.time, first_after(path, view.time, 0));
            commands.events.push(Event { time: view.time, spring: path.spring, ant: None, tip, kind });
        };
        for path in self.paths.iter().filter(|path| path.release == Some(view.time)) {
            event(path, EventKind::Release);
        }
        for path in self.paths.iter().filter(|path| path.waypoints[0].time == view.time) {
            event(path, EventKind::Grasp);
        }
    }

    fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
        let now = view.time;
        let is_attached = |path: &TipPath| path.waypoints[0].time <= now && path.release.is_none_or(|release| release > now);
        for (path, after) in self.paths.iter().zip(&mut self.after) {
            if self.has_several && !is_attached(path) {
                continue;
            }
            *after = first_after(path, until, *after);
            self.targets[path.spring] = position_at(path, until, *after);
        }
        self.next = self.first_after(until);
        &self.targets
    }

    fn next_instant(&self, time: f64) -> Option<f64> {
        self.instants.get(self.first_after(time)).copied()
    }

    fn save(&self) -> Result<serde_json::Value, SaveError> {
        Ok(serde_json::Value::Null)
    }

    fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
        if state.is_null() {
            Ok(())
        } else {
            Err(RestoreError("the state is that of another controller, and prescribed tips have none".into()))
        }
    }

    fn check(&self, _tick: u64, time: f64, tips: &[AttachedTip]) -> Result<(), RestoreError> {
        let is_attached = |path: &&TipPath| path.waypoints[0].time < time && path.release.is_none_or(|release| release >= time);
        let springs = self.paths.iter().filter(is_attached).map(|path| path.spring).collect();
        check_attached(springs, time, tips)
    }
}
