//! Generated readings of a load cell with a known truth: a linear polar spring, trials with
//! different stiffness, and noise.

use std::fmt::Write;

use cohaul::math::{RandomStreams, Stream};

/// Comment at the top of `data/load-cell.csv`.
pub const GRID_COMMENT: &str =
    "Generated, not measured: seven trials of a spring with kappa_rho = 0.664 N/m and kappa_tau = 4.52e-4 N m/rad,
trials 3 % apart, 0.05 mN of noise, seed 2010.
cargo run --example generate_load_cell prints this file.";

/// Stiffnesses and rest length of the truth (N/m, N m/rad, m).
pub const TRUE_SPRING: [f64; 3] = [0.664, 4.52e-4, 26.3e-3];
/// Lines of the grid (mm).
pub const XS: std::ops::RangeInclusive<i32> = 10..=36;
pub const YS: std::ops::RangeInclusive<i32> = -16..=16;

/// Forces along and across the spring on a tip at this place (m) (N).
pub fn true_force(x: f64, y: f64) -> [f64; 2] {
    let [radial, torsional, rest] = TRUE_SPRING;
    let length = (x * x + y * y).sqrt();
    [radial * (length - rest), torsional * (y / x).atan() / length]
}

/// Readings of `n_trials` on a grid of 2 mm, in which stiffnesses differ by `between` and forces
/// scatter by `noise` (N).
pub fn load_cell(n_trials: u32, between: f64, noise: f64, comment: &str) -> String {
    let streams = RandomStreams::new(2010);
    let mut text: String = comment.lines().map(|line| format!("# {line}\n")).collect();
    text.push_str("trial,x_m,y_m,force_x_n,force_y_n\n");
    for trial in 1..=n_trials {
        let stiffer = 1.0 + between * streams.normal_pair(Stream::Scene, trial, 0).x;
        for (at, [x, y]) in YS.step_by(2).flat_map(|y| XS.step_by(2).map(move |x| [x, y])).enumerate() {
            let [x, y] = [x, y].map(|line| 1e-3 * f64::from(line));
            let [along, across] = true_force(x, y).map(|force| stiffer * force);
            let (sin, cos) = ((y / x).atan().sin(), (y / x).atan().cos());
            let noise = noise * streams.normal_pair(Stream::Scene, trial, 1 + at as u64);
            let force = [along * cos - across * sin + noise.x, along * sin + across * cos + noise.y];
            writeln!(text, "{trial},{x:.3},{y:.3},{:.7},{:.7}", force[0], force[1]).expect("a string takes all");
        }
    }
    text
}
