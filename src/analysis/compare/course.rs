//! Pulls, speed and energy of a run at its control ticks.

use super::difference::Jumps;
use crate::backend::{BackendKind, EnergyLedger};
use crate::math::Vec2;
use crate::model::System;
use crate::simulation::{Row, SAME_INSTANT};

/// What a run shows at its control ticks and at its end, beside the pose of the load.
pub(super) struct Course {
    /// Times of the ticks (s).
    pub times: Vec<f64>,
    /// Magnitude of the pull on the tip of each spring, by spring and tick (N); `None` while the
    /// spring is free. The pull contains the force of the dashpot.
    pub pulls: Vec<Vec<Option<f64>>>,
    /// Magnitude of the vector sum of all pulls (N).
    pub net_pull: Vec<Option<f64>>,
    /// Edge speed of the load, |v| + R |omega| (m/s).
    pub speed: Vec<Option<f64>>,
    /// The same; `None` where a quasi-static load has jumped, which takes no time.
    pub speed_between_jumps: Vec<Option<f64>>,
    /// Energy dissipated so far (J).
    pub dissipated: Vec<Option<f64>>,
}

impl Course {
    /// Course of a run from its rows, of which those between ticks are left out.
    pub fn of(kind: BackendKind, rows: &[Row], system: &System, jumps: &Jumps, control_period: f64) -> Self {
        let end = rows.last().map_or(0.0, |row| row.time);
        let is_tick = |time: f64| ((time / control_period).round() * control_period - time).abs() <= SAME_INSTANT * control_period;
        let ticks: Vec<&Row> = rows.iter().filter(|row| is_tick(row.time) || row.time >= end).collect();
        let pull_of = |row: &Row, spring| row.tips.iter().find(|tip| tip.spring == spring).map(|tip| tip.pull.norm());
        let speed = speeds(kind, &ticks, system.load.radius);
        let has_jumped = |row: &Row| !kind.has_inertia() && jumps.since_tick(row.time).is_some();
        Self {
            times: ticks.iter().map(|row| row.time).collect(),
            pulls: (0..system.springs.len()).map(|spring| ticks.iter().map(|row| pull_of(row, spring)).collect()).collect(),
            net_pull: ticks.iter().map(|row| Some(row.tips.iter().map(|tip| tip.pull).sum::<Vec2>().norm())).collect(),
            speed_between_jumps: ticks.iter().zip(&speed).map(|(row, speed)| speed.filter(|_| !has_jumped(row))).collect(),
            speed,
            dissipated: ticks.iter().map(|row| Some(dissipated(&row.energy))).collect(),
        }
    }
}

/// Edge speed at each tick (m/s). That of a load without inertia is its last displacement over the
/// time since the last tick.
fn speeds(kind: BackendKind, ticks: &[&Row], radius: f64) -> Vec<Option<f64>> {
    if kind.has_inertia() {
        return ticks.iter().map(|row| Some(row.motion.twist.edge_speed(radius))).collect();
    }
    let mean = |pair: &[&Row]| pair[1].motion.pose.edge_displacement(&pair[0].motion.pose, radius) / (pair[1].time - pair[0].time);
    ticks.first().map(|_| 0.0).into_iter().chain(ticks.windows(2).map(mean)).map(Some).collect()
}

/// Energy lost to friction, impacts, damping and with released springs, and in the jumps of a load
/// without inertia (J). With inertia, the energy of a jump becomes motion, which friction and
/// dashpots end.
fn dissipated(energy: &EnergyLedger) -> f64 {
    energy.dissipated() + energy.jumps
}
