//! The inertial force m a of the load, as a camera and a tracker would see it.
//!
//! The paper finds an inertial force of order 1e-4 mN, from the tracked motion of the structures. A
//! tracked acceleration depends on the time over which positions are averaged. Here positions are
//! those of video frames, averaged over a window of k frames; the acceleration is the second
//! difference of neighbouring averages:
//!
//! ```text
//! mean_i = (x_i + ... + x_(i+k-1)) / k
//! a_i    = (mean_(i+k) - 2 mean_i + mean_(i-k)) / (k dt)^2
//! ```
//!
//! Neighbouring windows do not overlap, so that the smoothing time k dt is the time between two
//! independent positions. The shortest one is the control period: the acceleration of the model.
//! The paper prints neither the frame rate nor the smoothing; 30 frames per second is the rate of
//! the cameras that it names.

use serde::{Deserialize, Serialize};

use cohaul::math::Vec2;
use cohaul::simulation::Trace;

/// Sums of the inertial force over a run at one smoothing time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ForceAt {
    /// Smoothing time k dt (s).
    pub smoothing_s: f64,
    /// Number of accelerations (1).
    pub n: u64,
    /// Sum of m |a| (N), and of its square (N^2).
    pub sum: f64,
    pub squares: f64,
    /// Largest m |a| (N).
    pub largest: f64,
}

/// Time between two video frames (s).
pub const FRAME_S: f64 = 1.0 / 30.0;
/// Smoothing times in frames; the first entry stands for the control period.
const FRAMES: [usize; 9] = [0, 1, 3, 10, 30, 100, 300, 600, 1200];
/// Number of smoothing times.
pub const N_TIMES: usize = FRAMES.len();

/// Inertial forces of a load of `mass` (kg) in a run, by smoothing time. Times for which the run is
/// too short have none.
pub fn inertial_forces(trace: &Trace, mass: f64) -> Vec<ForceAt> {
    let rows = &trace.rows;
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Vec::new() };
    let ticks: Vec<Vec2> = rows.iter().map(|row| row.motion.pose.position).collect();
    let tick = rows.get(1).map_or(0.0, |row| row.time - first.time);
    let n_frames = ((last.time - first.time) / FRAME_S) as usize;
    let frames: Vec<Vec2> = (0..=n_frames).map(|frame| at(trace, first.time + FRAME_S * frame as f64)).collect();
    let of = |n: usize| match n {
        0 => force_at(&ticks, tick, 1, mass),
        n => force_at(&frames, FRAME_S, n, mass),
    };
    FRAMES.into_iter().map(of).collect()
}

/// Position at a time, between two rows (m).
fn at(trace: &Trace, time: f64) -> Vec2 {
    let after = trace.rows.partition_point(|row| row.time < time).clamp(1, trace.rows.len() - 1);
    let [a, b] = [&trace.rows[after - 1], &trace.rows[after]];
    let share = if b.time > a.time { ((time - a.time) / (b.time - a.time)).clamp(0.0, 1.0) } else { 1.0 };
    a.motion.pose.position + share * (b.motion.pose.position - a.motion.pose.position)
}

/// Positions at equal times `step` (s), averaged over `n` of them.
fn force_at(positions: &[Vec2], step: f64, n: usize, mass: f64) -> ForceAt {
    let smoothing_s = n as f64 * step;
    let means: Vec<Vec2> = positions.chunks_exact(n).map(|chunk| chunk.iter().sum::<Vec2>() / n as f64).collect();
    let mut found = ForceAt { smoothing_s, ..ForceAt::default() };
    for three in means.windows(3) {
        let force = mass * (three[2] - 2.0 * three[1] + three[0]).norm() / (smoothing_s * smoothing_s);
        found.n += 1;
        found.sum += force;
        found.squares += force * force;
        found.largest = found.largest.max(force);
    }
    found
}

impl ForceAt {
    /// The same over several runs.
    pub fn pooled<'a>(all: impl IntoIterator<Item = &'a ForceAt>) -> Option<Self> {
        all.into_iter().copied().reduce(|a, b| Self {
            smoothing_s: a.smoothing_s,
            n: a.n + b.n,
            sum: a.sum + b.sum,
            squares: a.squares + b.squares,
            largest: a.largest.max(b.largest),
        })
    }

    /// Mean of m |a| (N); `None` without an acceleration.
    pub fn mean(&self) -> Option<f64> {
        (self.n > 0).then(|| self.sum / self.n as f64)
    }

    /// Root mean square of m |a| (N).
    pub fn rms(&self) -> Option<f64> {
        (self.n > 0).then(|| (self.squares / self.n as f64).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::math::direction;

    /// On a circle the acceleration is v^2 / r. Averages over half of a turn shrink the radius by 2
    /// / pi, and are a third of a circle's diameter apart.
    #[test]
    fn a_circle_has_its_centripetal_force_until_it_is_averaged_away() {
        let (radius, rate, step, mass) = (0.02, 3.0, 1e-3, 1.6e-3);
        let positions: Vec<Vec2> = (0..40_000).map(|i| radius * direction(rate * step * f64::from(i))).collect();
        let force = |n: usize| force_at(&positions, step, n, mass).mean().unwrap();
        let known = mass * radius * rate * rate;
        // Second differences err by (rate step)^2 / 12 at most.
        assert!((force(1) / known - 1.0).abs() < 1e-6);
        for n in [100, 500, 1000] {
            // A window of the angle w keeps sin(w / 2) / (w / 2) of the radius, and the second
            // difference of a circle is 2 - 2 cos w of it.
            let angle = rate * step * n as f64;
            let expected =
                mass * radius * (0.5 * angle).sin().abs() / (0.5 * angle) * (2.0 - 2.0 * angle.cos()) / (step * n as f64).powi(2);
            assert!((force(n) / expected - 1.0).abs() < 1e-5, "{n}: {} {expected}", force(n));
        }
        assert!(force_at(&positions[..5], step, 2, mass).mean().is_none(), "two averages have no acceleration");
    }
}
