//! Prescribed tips: straight between waypoints, held after the last.

use super::{Driver, Event, EventKind, Orders, SAME_INSTANT, View};
use crate::backend::{Motion, RestoreError};
use crate::math::Vec2;
use crate::scenario::{Scenario, TipPath, Waypoint};

/// Drives tips along paths. It has no state of its own: all follows from the time.
pub struct Tips {
    paths: Vec<TipPath>,
    /// Number of the first waypoint of each path after the last instant asked for: where to look first.
    after: Vec<usize>,
    /// All times of waypoints and releases, in order (s).
    instants: Vec<f64>,
    /// Number of the first of them after the last instant asked for: where to look first.
    next: usize,
    targets: Vec<Vec2>,
}

impl Tips {
    /// Times within rounding of a tick are that tick, and times within rounding of each other are one, so that no step of no length arises. A tip
    /// that would be let go at the instant of its grasp is never held.
    pub fn new(scenario: &Scenario, paths: &[TipPath]) -> Self {
        let same = SAME_INSTANT * scenario.control_period;
        let (instants, all_exact) = instants_of(paths, scenario.control_period);
        let snap = |time: f64| instants[instants.partition_point(|instant| *instant < time - same)];
        let snapped = |path: &TipPath| TipPath {
            spring: path.spring,
            waypoints: path.waypoints.iter().map(|at| Waypoint { time: snap(at.time), ..*at }).collect(),
            release: path.release.map(snap),
        };
        let is_held = |path: &TipPath| path.release.is_none_or(|release| release > path.waypoints[0].time);
        let (paths, instants) = if all_exact && paths.iter().all(is_held) {
            (paths.to_vec(), instants)
        } else {
            let paths: Vec<TipPath> = paths.iter().map(snapped).filter(is_held).collect();
            let (instants, _) = instants_of(&paths, scenario.control_period);
            (paths, instants)
        };
        let after = vec![0; paths.len()];
        Self { paths, after, instants, next: 0, targets: vec![Vec2::zeros(); scenario.system.springs.len()] }
    }

    /// Number of the first instant after `time` (s).
    fn first_after(&self, time: f64) -> usize {
        let is_it = |at: usize| is_first_after(at, self.instants.len(), time, |at| self.instants[at]);
        let near = [self.next, self.next + 1].into_iter().find(|at| is_it(*at));
        near.unwrap_or_else(|| self.instants.partition_point(|instant| *instant <= time))
    }
}

/// Times of a path's waypoints, and of its release (s).
fn times_of(path: &TipPath) -> impl Iterator<Item = f64> + '_ {
    path.waypoints.iter().map(|at| at.time).chain(path.release)
}

/// All times of waypoints and releases in order (s), ticks in place of what is within rounding of them, and one of each group within rounding; and whether that
/// leaves each time as it is.
fn instants_of(paths: &[TipPath], control_period: f64) -> (Vec<f64>, bool) {
    let same = SAME_INSTANT * control_period;
    let mut all_exact = true;
    let mut at_tick = |time: f64| {
        // Half away from zero, as times are not negative; what is too large for a whole number is no tick.
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

/// Number of the first of a path's waypoints after `time` (s), looked for near `guess` first.
fn first_after(path: &TipPath, time: f64, guess: usize) -> usize {
    let is_it = |at: usize| is_first_after(at, path.waypoints.len(), time, |at| path.waypoints[at].time);
    let near = [guess, guess + 1].into_iter().find(|at| is_it(*at));
    near.unwrap_or_else(|| path.waypoints.partition_point(|at| at.time <= time))
}

/// Where a path is at `time` (s), with the first waypoint `after` it; at its ends before the first and after the last one.
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

impl Driver for Tips {
    fn decide(&mut self, view: &View, orders: &mut Orders) {
        let mut event = |path: &TipPath, kind| {
            let tip = position_at(path, view.time, first_after(path, view.time, 0));
            orders.events.push(Event { time: view.time, spring: path.spring, ant: None, tip, kind });
        };
        for path in self.paths.iter().filter(|path| path.release == Some(view.time)) {
            event(path, EventKind::Release);
        }
        for path in self.paths.iter().filter(|path| path.waypoints[0].time == view.time) {
            event(path, EventKind::Grasp);
        }
    }

    fn targets(&mut self, _: &View, until: f64) -> &[Vec2] {
        for (path, after) in self.paths.iter().zip(&mut self.after) {
            *after = first_after(path, until, *after);
            self.targets[path.spring] = position_at(path, until, *after);
        }
        self.next = self.first_after(until);
        &self.targets
    }

    fn next_instant(&self, time: f64) -> Option<f64> {
        self.instants.get(self.first_after(time)).copied()
    }

    fn arrived(&self, _: &Motion) -> Option<bool> {
        None
    }

    fn save(&self) -> serde_json::Value {
        serde_json::Value::Null
    }

    fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
        if state.is_null() { Ok(()) } else { Err(RestoreError("a driver's state for a run with prescribed tips".into())) }
    }
}
