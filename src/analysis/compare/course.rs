//! Pulls, contact forces, speed and energy of a run at its control ticks.

use super::difference::Jumps;
use super::settings::LEAST_MOTION;
use crate::backend::{BackendKind, Computes, EnergyLedger, TransitionKind};
use crate::math::Vec2;
use crate::scenario::Scenario;
use crate::simulation::{Row, SAME_INSTANT, Trace};

/// Numbers at each tick, where there are any.
pub(super) type Signal = Vec<Option<Ranged>>;

/// A number of a run, and the range of the numbers that are as right.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Ranged {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// A speed at each tick (m/s).
pub(super) struct Speed {
    pub at_ticks: Signal,
    /// The same; `None` where a quasi-static load has jumped, which takes no time.
    pub between_jumps: Signal,
}

/// What a run shows at its control ticks and at its end, beside the pose of the load.
pub(super) struct Course {
    /// Times of the ticks (s).
    pub times: Vec<f64>,
    /// Magnitude of the pull on the tip of each spring, by spring and tick (N); `None` while the
    /// spring is free. The pull contains the force of the dashpot.
    pub pulls: Vec<Signal>,
    /// Magnitude of the vector sum of all pulls (N).
    pub net_pull: Signal,
    /// Magnitude of the force of each obstacle on the load, by obstacle and tick (N); `None` at the
    /// ticks that are left out, and behind a jump between two obstacles. The pulls on a load that
    /// rests are borne by obstacle and ground, in any share that the slip limit admits: the force
    /// has that range.
    pub contact_forces: Vec<Signal>,
    /// Speed of the load's centre of mass, |v| (m/s).
    pub speed: Speed,
    /// Edge speed of the load, |v| + R |omega| (m/s).
    pub edge_speed: Speed,
    /// Energy dissipated so far (J).
    pub dissipated: Signal,
    /// Measure of one's own at the end; empty without one.
    pub own: Signal,
}

impl From<f64> for Ranged {
    fn from(value: f64) -> Self {
        Self { value, low: value, high: value }
    }
}

impl Ranged {
    pub fn map(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        Self { value: of(self.value, other.value), low: of(self.low, other.low), high: of(self.high, other.high) }
    }

    /// By how much this is more than `other`, for sure; negative if less or possibly less.
    pub fn excess(&self, other: &Self) -> f64 {
        self.low - other.high
    }

    /// Distance between the two ranges; zero if they have a number in common.
    pub fn gap(&self, other: &Self) -> f64 {
        self.excess(other).max(other.excess(self)).max(0.0)
    }
}

impl Course {
    /// Course of a run from its `rows`, of which those between ticks are left out. Contact forces
    /// are left out within a control period of the `blanks` (s).
    pub fn of((kind, computes): (BackendKind, Computes), rows: &[Row], blanks: &[f64], scenario: &Scenario, jumps: &Jumps) -> Self {
        let system = &scenario.system;
        let ticks = ticks(rows, scenario.control_period);
        let pull_of = |row: &Row, spring| row.tips.iter().find(|tip| tip.spring == spring).map(|tip| tip.pull.norm().into());
        let has_jumped = |row: &Row| !kind.has_inertia() && jumps.since_tick(row.time).is_some();
        let speed = |radius: f64| {
            let at_ticks = if computes.twist { speeds(kind, &ticks, radius) } else { vec![None; ticks.len()] };
            let between_jumps = ticks.iter().zip(&at_ticks).map(|(row, speed)| speed.filter(|_| !has_jumped(row))).collect();
            Speed { at_ticks, between_jumps }
        };
        let (is_blank, rests) = (blank_ticks(blanks, &ticks), rests(&ticks, system.load.radius));
        let force_of = |(at, row): (usize, &&Row), obstacle: usize| {
            let forces = row.contacts.iter().filter(|contact| contact.obstacle == obstacle);
            let is_static = forces.clone().next().is_some() && (rests[at] || has_jumped(row));
            let force = forces.map(|contact| contact.force).sum::<Vec2>().norm();
            let bounds = || static_force(force, net_pull(row), system.total_slip_limit());
            let is_left_out = is_blank[at] || !computes.contacts || has_jumped(row) && row.touches_two();
            (!is_left_out).then(|| if is_static { bounds() } else { force.into() })
        };
        let obstacles = 0..system.world.obstacles.len();
        Self {
            times: ticks.iter().map(|row| row.time).collect(),
            pulls: (0..system.springs.len()).map(|spring| ticks.iter().map(|row| pull_of(row, spring)).collect()).collect(),
            net_pull: ticks.iter().map(|row| Some(net_pull(row).into())).collect(),
            contact_forces: obstacles.map(|obstacle| ticks.iter().enumerate().map(|at| force_of(at, obstacle)).collect()).collect(),
            speed: speed(0.0),
            edge_speed: speed(system.load.radius),
            dissipated: ticks.iter().map(|row| computes.energy.then(|| dissipated(&row.energy).into())).collect(),
            own: Signal::new(),
        }
    }

    /// With a number of the whole run at its end; none that is not finite.
    pub fn with_own(self, value: f64) -> Self {
        let mut own: Signal = vec![None; self.times.len()];
        if let Some(last) = own.last_mut().filter(|_| value.is_finite()) {
            *last = Some(value.into());
        }
        Self { own, ..self }
    }
}

/// Times (s) at which a run does not show the forces of obstacles: those of impacts, whose impulses
/// take no time, and the ticks at which a load rests on two obstacles, which may press against each
/// other through it.
pub(super) fn blanks(trace: &Trace, scenario: &Scenario) -> impl Iterator<Item = f64> {
    let is_impact = |kind: &TransitionKind| matches!(kind, TransitionKind::Impact { .. });
    let impacts = trace.transitions.iter().filter(move |transition| is_impact(&transition.kind)).map(|impact| impact.time);
    let ticks = ticks(&trace.rows, scenario.control_period);
    let rests = rests(&ticks, scenario.system.load.radius);
    let squeezed = ticks.into_iter().zip(rests).filter(|(row, rests)| *rests && row.touches_two());
    impacts.chain(squeezed.map(|(row, _)| row.time))
}

/// Rows at ticks, and the last one.
fn ticks(rows: &[Row], control_period: f64) -> Vec<&Row> {
    let end = rows.last().map_or(0.0, |row| row.time);
    let is_tick = |time: f64| ((time / control_period).round() * control_period - time).abs() <= SAME_INSTANT * control_period;
    rows.iter().filter(|row| is_tick(row.time) || row.time >= end).collect()
}

/// Magnitude of the vector sum of all pulls (N).
fn net_pull(row: &Row) -> f64 {
    row.tips.iter().map(|tip| tip.pull).sum::<Vec2>().norm()
}

/// A `force` (N) of the only obstacle at a load at rest. The ground may bear up to `slip_limit` (N)
/// of the `net_pull` (N), or press as much against the obstacle.
fn static_force(force: f64, net_pull: f64, slip_limit: f64) -> Ranged {
    Ranged { value: force, low: force.min((net_pull - slip_limit).max(0.0)), high: force.max(net_pull + slip_limit) }
}

/// Whether there is one of the `blanks` (s) within a control period, for each tick.
fn blank_ticks(blanks: &[f64], ticks: &[&Row]) -> Vec<bool> {
    let mut is_blank = vec![false; ticks.len()];
    for blank in blanks {
        let next = ticks.partition_point(|row| row.time < *blank);
        is_blank.iter_mut().take(next + 2).skip(next.saturating_sub(1)).for_each(|is_blank| *is_blank = true);
    }
    is_blank
}

/// Whether the load rests since the tick before, for each tick.
fn rests(ticks: &[&Row], radius: f64) -> Vec<bool> {
    let moved = |pair: &[&Row]| pair[1].motion.pose.edge_displacement(&pair[0].motion.pose, radius);
    let rests = ticks.windows(2).map(|pair| moved(pair) <= LEAST_MOTION * radius);
    std::iter::once(true).chain(rests).take(ticks.len()).collect()
}

/// Speed of a point at this `radius` (m) at each tick (m/s). That of a load without inertia is its
/// last displacement over the time since the last tick.
fn speeds(kind: BackendKind, ticks: &[&Row], radius: f64) -> Signal {
    if kind.has_inertia() {
        return ticks.iter().map(|row| Some(row.motion.twist.edge_speed(radius).into())).collect();
    }
    let mean = |pair: &[&Row]| pair[1].motion.pose.edge_displacement(&pair[0].motion.pose, radius) / (pair[1].time - pair[0].time);
    ticks.first().map(|_| 0.0).into_iter().chain(ticks.windows(2).map(mean)).map(|speed| Some(speed.into())).collect()
}

/// Energy lost to friction, impacts, damping and with released springs, and in the jumps of a load
/// without inertia (J). With inertia, the energy of a jump becomes motion, which friction and
/// dashpots end.
fn dissipated(energy: &EnergyLedger) -> f64 {
    energy.dissipated() + energy.jumps
}
