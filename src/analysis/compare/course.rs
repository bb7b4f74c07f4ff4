//! Pulls, contact forces, speed and energy of a run at its control ticks.

use super::difference::Jumps;
use super::settings::LEAST_MOTION;
use crate::backend::{BackendKind, EnergyLedger};
use crate::math::Vec2;
use crate::scenario::Scenario;
use crate::simulation::{Row, SAME_INSTANT};

/// A speed at each tick (m/s).
pub(super) struct Speed {
    pub at_ticks: Vec<Option<f64>>,
    /// The same; `None` where a quasi-static load has jumped, which takes no time.
    pub between_jumps: Vec<Option<f64>>,
}

/// What a run shows at its control ticks and at its end, beside the pose of the load.
pub(super) struct Course {
    /// Times of the ticks (s).
    pub times: Vec<f64>,
    /// Magnitude of the pull on the tip of each spring, by spring and tick (N); `None` while the
    /// spring is free. The pull contains the force of the dashpot.
    pub pulls: Vec<Vec<Option<f64>>>,
    /// Magnitude of the vector sum of all pulls (N).
    pub net_pull: Vec<Option<f64>>,
    /// Magnitude of the force of each obstacle on the load, by obstacle and tick (N). `None` within
    /// a control period of an impact in any run, whose impulse takes no time, and where the load
    /// rests: then the ground bears as much as it happens to.
    pub contact_forces: Vec<Vec<Option<f64>>>,
    /// Speed of the load's centre of mass, |v| (m/s).
    pub speed: Speed,
    /// Edge speed of the load, |v| + R |omega| (m/s).
    pub edge_speed: Speed,
    /// Energy dissipated so far (J).
    pub dissipated: Vec<Option<f64>>,
}

impl Course {
    /// Course of a run from its `rows`, of which those between ticks are left out. There are
    /// `impacts` at these times (s), in this run or in another one.
    pub fn of(kind: BackendKind, rows: &[Row], impacts: &[f64], scenario: &Scenario, jumps: &Jumps) -> Self {
        let (system, control_period) = (&scenario.system, scenario.control_period);
        let end = rows.last().map_or(0.0, |row| row.time);
        let is_tick = |time: f64| ((time / control_period).round() * control_period - time).abs() <= SAME_INSTANT * control_period;
        let ticks: Vec<&Row> = rows.iter().filter(|row| is_tick(row.time) || row.time >= end).collect();
        let pull_of = |row: &Row, spring| row.tips.iter().find(|tip| tip.spring == spring).map(|tip| tip.pull.norm());
        let speed = |radius: f64| {
            let at_ticks = speeds(kind, &ticks, radius);
            let has_jumped = |row: &Row| !kind.has_inertia() && jumps.since_tick(row.time).is_some();
            let between_jumps = ticks.iter().zip(&at_ticks).map(|(row, speed)| speed.filter(|_| !has_jumped(row))).collect();
            Speed { at_ticks, between_jumps }
        };
        let (is_hit, rests) = (hits(impacts, &ticks), rests(&ticks, system.load.radius));
        let force_of = |(at, row): (usize, &&Row), obstacle: usize| {
            let forces = row.contacts.iter().filter(|contact| contact.obstacle == obstacle).map(|contact| contact.force);
            (!is_hit[at] && !rests[at]).then(|| forces.sum::<Vec2>().norm())
        };
        let obstacles = 0..system.world.obstacles.len();
        Self {
            times: ticks.iter().map(|row| row.time).collect(),
            pulls: (0..system.springs.len()).map(|spring| ticks.iter().map(|row| pull_of(row, spring)).collect()).collect(),
            net_pull: ticks.iter().map(|row| Some(row.tips.iter().map(|tip| tip.pull).sum::<Vec2>().norm())).collect(),
            contact_forces: obstacles.map(|obstacle| ticks.iter().enumerate().map(|at| force_of(at, obstacle)).collect()).collect(),
            speed: speed(0.0),
            edge_speed: speed(system.load.radius),
            dissipated: ticks.iter().map(|row| Some(dissipated(&row.energy))).collect(),
        }
    }
}

/// Whether there was an impact within a control period, for each tick.
fn hits(impacts: &[f64], ticks: &[&Row]) -> Vec<bool> {
    let mut is_hit = vec![false; ticks.len()];
    for impact in impacts {
        let next = ticks.partition_point(|row| row.time < *impact);
        is_hit.iter_mut().take(next + 2).skip(next.saturating_sub(1)).for_each(|is_hit| *is_hit = true);
    }
    is_hit
}

/// Whether the load rests since the tick before, for each tick.
fn rests(ticks: &[&Row], radius: f64) -> Vec<bool> {
    let moved = |pair: &[&Row]| pair[1].motion.pose.edge_displacement(&pair[0].motion.pose, radius);
    let rests = ticks.windows(2).map(|pair| moved(pair) <= LEAST_MOTION * radius);
    std::iter::once(true).chain(rests).take(ticks.len()).collect()
}

/// Speed of a point at this `radius` (m) at each tick (m/s). That of a load without inertia is its
/// last displacement over the time since the last tick.
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
