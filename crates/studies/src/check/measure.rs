//! Columns that a baseline stores of each row of a trace, and the measures that are compared in
//! them.

use serde::Serialize;

use cohaul::backend::{EnergyLedger, Motion};
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::simulation;

/// Columns of a row, in world axes. `net_pull` is the sum of the pulls on all tips, `total_pull`
/// the sum of their magnitudes.
pub const COLUMNS: [&str; 14] = [
    "time_s",
    "x_m",
    "y_m",
    "heading_rad",
    "vx_m_per_s",
    "vy_m_per_s",
    "turn_rate_rad_per_s",
    "elastic_j",
    "kinetic_j",
    "dissipated_j",
    "tip_work_j",
    "net_pull_x_n",
    "net_pull_y_n",
    "total_pull_n",
];

/// Values of [`COLUMNS`] at one instant.
pub type Row = [f64; COLUMNS.len()];

/// Quantity that is compared. Each has its own tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    Position,
    Heading,
    Velocity,
    TurnRate,
    Energy,
    Pull,
    Time,
    Count,
}

impl Quantity {
    /// The quantity that has this unit in print.
    pub fn of_unit(unit: &str) -> Self {
        match unit {
            "m" => Self::Position,
            "rad" => Self::Heading,
            "m/s" => Self::Velocity,
            "rad/s" => Self::TurnRate,
            "J" => Self::Energy,
            "N" => Self::Pull,
            "s" => Self::Time,
            _ => Self::Count,
        }
    }
}

/// Scalar or vector in a row that is compared as one: one column, or two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measure {
    pub name: &'static str,
    pub quantity: Quantity,
    columns: &'static [usize],
}

pub const MEASURES: [Measure; 10] = [
    Measure { name: "position_m", quantity: Quantity::Position, columns: &[1, 2] },
    Measure { name: "heading_rad", quantity: Quantity::Heading, columns: &[3] },
    Measure { name: "velocity_m_per_s", quantity: Quantity::Velocity, columns: &[4, 5] },
    Measure { name: "turn_rate_rad_per_s", quantity: Quantity::TurnRate, columns: &[6] },
    Measure { name: "elastic_j", quantity: Quantity::Energy, columns: &[7] },
    Measure { name: "kinetic_j", quantity: Quantity::Energy, columns: &[8] },
    Measure { name: "dissipated_j", quantity: Quantity::Energy, columns: &[9] },
    Measure { name: "tip_work_j", quantity: Quantity::Energy, columns: &[10] },
    Measure { name: "net_pull_n", quantity: Quantity::Pull, columns: &[11, 12] },
    Measure { name: "total_pull_n", quantity: Quantity::Pull, columns: &[13] },
];

impl Measure {
    pub fn values(&self, row: &Row) -> Vec<f64> {
        self.columns.iter().map(|&column| row[column]).collect()
    }

    pub fn size(&self, row: &Row) -> f64 {
        self.columns.iter().fold(0.0, |size: f64, &column| size.hypot(row[column]))
    }

    /// Distance of two rows in this measure.
    pub fn apart(&self, a: &Row, b: &Row) -> f64 {
        self.columns.iter().fold(0.0, |size: f64, &column| size.hypot(a[column] - b[column]))
    }
}

pub fn row_of(row: &simulation::Row) -> Row {
    let (pose, twist, energy) = (&row.motion.pose, &row.motion.twist, &row.energy);
    let net: Vec2 = row.tips.iter().map(|tip| tip.pull).sum();
    let total = row.tips.iter().fold(0.0, |sum, tip| sum + tip.pull.norm());
    [
        row.time,
        pose.position.x,
        pose.position.y,
        pose.heading,
        twist.linear.x,
        twist.linear.y,
        twist.angular,
        energy.elastic,
        energy.kinetic,
        energy.dissipated(),
        energy.tip_work,
        net.x,
        net.y,
        total,
    ]
}

/// Row of a trace that holds only the motion of these columns.
pub fn moving_row(row: &Row) -> simulation::Row {
    let [time, x, y, heading, vx, vy, angular, ..] = *row;
    let motion = Motion { pose: Pose::new(x, y, heading), twist: Twist { linear: Vec2::new(vx, vy), angular } };
    simulation::Row {
        time,
        motion,
        energy: EnergyLedger::default(),
        tips: simulation::AttachedTips::new(),
        contacts: Vec::new(),
        steered: Vec::new(),
        error: None,
    }
}

/// Row of a trace at `time` (s), interpolated where there is none at that time; `None` after the
/// end.
pub fn row_at(rows: &[simulation::Row], time: f64) -> Option<Row> {
    let after = rows.partition_point(|row| row.time < time);
    let next = row_of(rows.get(after)?);
    if next[0] == time || after == 0 {
        return Some(next);
    }
    let last = row_of(&rows[after - 1]);
    let share = (time - last[0]) / (next[0] - last[0]);
    let mut between: Row = std::array::from_fn(|column| last[column] + share * (next[column] - last[column]));
    between[0] = time;
    Some(between)
}
