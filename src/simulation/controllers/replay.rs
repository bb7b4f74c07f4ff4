//! Grasps, releases and tip motions of a recorded run. They give another backend the same input
//! although the ants would have decided otherwise after the first difference.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::controller::{Commands, Controller, View, check_attached};
use crate::backend::{AttachedTip, RestoreError, SaveError};
use crate::math::Vec2;
use crate::model::ObstaclePose;
use crate::simulation::trace::{EventKind, Trace};

/// Moves the tips as a recorded run did. All follows from the time, so there is no state.
pub struct Replay {
    recorded: Arc<Trace>,
    targets: Vec<Vec2>,
    pushers: Vec<ObstaclePose>,
}

impl Replay {
    pub fn new(recorded: Arc<Trace>, n_springs: usize) -> Self {
        Self { recorded, targets: vec![Vec2::zeros(); n_springs], pushers: Vec::new() }
    }
}

impl Controller for Replay {
    fn decide(&mut self, view: &View, commands: &mut Commands) {
        let events = &self.recorded.events;
        let first = events.partition_point(|event| event.time < view.time);
        commands.events.extend(events[first..].iter().take_while(|event| event.time == view.time));
    }

    /// Tips of the recorded run at `until`, those it let go there included; straight between its
    /// rows. The end of the recorded run is the end, wherever the load is by then.
    fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
        let recorded = Arc::clone(&self.recorded);
        let Some(row) = recorded.rows.get(recorded.rows.partition_point(|row| row.time < until)) else {
            return &self.targets;
        };
        row.tips.iter().for_each(|tip| self.targets[tip.spring] = tip.position);
        let first = recorded.events.partition_point(|event| event.time < row.time);
        for event in recorded.events[first..].iter().take_while(|event| event.time == row.time) {
            if event.kind == EventKind::Release {
                self.targets[event.spring] = event.tip;
            }
        }
        if until < row.time {
            let share = (until - view.time) / (row.time - view.time);
            for (spring, target) in self.targets.iter_mut().enumerate() {
                if let Some(now) = view.backend.tip(spring) {
                    *target = now + share * (*target - now);
                }
            }
        }
        &self.targets
    }

    /// Obstacles that were steered, straight between the rows.
    fn pushers(&mut self, view: &View, until: f64) -> &[ObstaclePose] {
        self.pushers.clear();
        let rows = &self.recorded.rows;
        if let Some(row) = rows.get(rows.partition_point(|row| row.time < until)) {
            let share = (until - view.time) / (row.time - view.time);
            let part = |target: &ObstaclePose| match view.obstacle(target.obstacle) {
                Some(now) if until < row.time => ObstaclePose { pose: now.towards(&target.pose, share), ..*target },
                _ => *target,
            };
            self.pushers.extend(row.steered.iter().map(part));
        }
        &self.pushers
    }

    fn next_instant(&self, time: f64) -> Option<f64> {
        let rows = &self.recorded.rows;
        rows.get(rows.partition_point(|row| row.time <= time)).map(|row| row.time)
    }

    fn save(&self) -> Result<serde_json::Value, SaveError> {
        Ok(serde_json::Value::Null)
    }

    fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
        if state.is_null() { Ok(()) } else { Err(RestoreError("the state is that of another controller, and a replay has none".into())) }
    }

    fn check(&self, _tick: u64, time: f64, tips: &[AttachedTip]) -> Result<(), RestoreError> {
        let mut attached = BTreeSet::new();
        for event in self.recorded.events.iter().take_while(|event| event.time < time) {
            match event.kind {
                EventKind::Grasp => attached.insert(event.spring),
                EventKind::Release => attached.remove(&event.spring),
            };
        }
        check_attached(attached, time, tips)
    }
}
