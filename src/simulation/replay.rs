//! Grasps, releases and tip motions of one run, driven into another: both backends then answer the same question although behaviour would have
//! decided otherwise after the first difference.

use std::sync::Arc;

use super::{Driver, Orders, Trace, View};
use crate::backend::{Motion, RestoreError};
use crate::math::Vec2;

/// Drives tips as a recorded run did. It has no state of its own.
pub struct Replay {
    recorded: Arc<Trace>,
    targets: Vec<Vec2>,
}

impl Replay {
    pub fn new(recorded: Arc<Trace>, n_springs: usize) -> Self {
        Self { recorded, targets: vec![Vec2::zeros(); n_springs] }
    }
}

impl Driver for Replay {
    fn decide(&mut self, view: &View, orders: &mut Orders) {
        let events = &self.recorded.events;
        let first = events.partition_point(|event| event.time < view.time);
        orders.events.extend(events[first..].iter().take_while(|event| event.time == view.time));
    }

    /// Where the recorded run had its tips at `until`, those included that it let go there; straight between its rows.
    fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
        let recorded = Arc::clone(&self.recorded);
        let Some(row) = recorded.rows.get(recorded.rows.partition_point(|row| row.time < until)) else {
            return &self.targets;
        };
        row.tips.iter().for_each(|tip| self.targets[tip.spring] = tip.position);
        let first = recorded.events.partition_point(|event| event.time < row.time);
        for event in recorded.events[first..].iter().take_while(|event| event.time == row.time) {
            if event.kind == super::EventKind::Release {
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

    fn next_instant(&self, time: f64) -> Option<f64> {
        let rows = &self.recorded.rows;
        rows.get(rows.partition_point(|row| row.time <= time)).map(|row| row.time)
    }

    /// The recorded run's end is the end, wherever the load is by then.
    fn arrived(&self, _: &Motion) -> Option<bool> {
        None
    }

    fn save(&self) -> serde_json::Value {
        serde_json::Value::Null
    }

    fn restore(&mut self, state: &serde_json::Value) -> Result<(), RestoreError> {
        if state.is_null() { Ok(()) } else { Err(RestoreError("a driver's state for a replayed run".into())) }
    }
}
