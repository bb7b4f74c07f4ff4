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
    targets: Vec<Vec2>,
}

impl Tips {
    /// Times within rounding of a tick are that tick, and times within rounding of each other are one, so that no step of no length arises. A tip
    /// that would be let go at the instant of its grasp is never held.
    pub fn new(scenario: &Scenario, paths: &[TipPath]) -> Self {
        let same = SAME_INSTANT * scenario.control_period;
        let instants = instants_of(paths, scenario.control_period);
        let snap = |time: f64| instants[instants.partition_point(|instant| *instant < time - same)];
        let snapped = |path: &TipPath| TipPath {
            spring: path.spring,
            waypoints: path.waypoints.iter().map(|at| Waypoint { time: snap(at.time), ..*at }).collect(),
            release: path.release.map(snap),
        };
        let is_held = |path: &TipPath| path.release.is_none_or(|release| release > path.waypoints[0].time);
        let is_snapped = |path: &TipPath| times_of(path).all(|time| snap(time) == time);
        let (paths, instants) = if paths.iter().all(|path| is_snapped(path) && is_held(path)) {
            (paths.to_vec(), instants)
        } else {
            let paths: Vec<TipPath> = paths.iter().map(snapped).filter(is_held).collect();
            let instants = instants_of(&paths, scenario.control_period);
            (paths, instants)
        };
        let after = vec![0; paths.len()];
        Self { paths, after, instants, targets: vec![Vec2::zeros(); scenario.system.springs.len()] }
    }
}

/// Times of a path's waypoints, and of its release (s).
fn times_of(path: &TipPath) -> impl Iterator<Item = f64> + '_ {
    path.waypoints.iter().map(|at| at.time).chain(path.release)
}

/// All times of waypoints and releases in order (s), ticks in place of what is within rounding of them, and one of each group within rounding.
fn instants_of(paths: &[TipPath], control_period: f64) -> Vec<f64> {
    let same = SAME_INSTANT * control_period;
    let at_tick = |time: f64| {
        let tick = (time / control_period).round() * control_period;
        if (time - tick).abs() <= same { tick } else { time }
    };
    let mut instants = Vec::with_capacity(paths.iter().map(|path| path.waypoints.len() + 1).sum());
    paths.iter().for_each(|path| instants.extend(times_of(path).map(at_tick)));
    instants.sort_by(f64::total_cmp);
    instants.dedup_by(|later, kept| *later - *kept <= same);
    instants
}

/// Number of the first of a path's waypoints after `time` (s), looked for near `guess` first.
fn first_after(path: &TipPath, time: f64, guess: usize) -> usize {
    let is_it = |at: usize| {
        let is_after = |at: usize| path.waypoints.get(at).is_none_or(|waypoint| waypoint.time > time);
        at <= path.waypoints.len() && is_after(at) && (at == 0 || !is_after(at - 1))
    };
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
        &self.targets
    }

    fn next_instant(&self, time: f64) -> Option<f64> {
        self.instants.get(self.instants.partition_point(|instant| *instant <= time)).copied()
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
