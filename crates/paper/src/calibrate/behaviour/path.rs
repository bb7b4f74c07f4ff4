//! Path of a tip that an ant pulls, Eq. (21) to (23), and its derivatives.
//!
//! An ant steers its pull towards the nest, within the half angle of its spring. The path follows
//! from where and in which direction the ant begins, and from the steering gain, the half angle and
//! the speed. Camera noise is on the positions of the tip, so that whole paths are compared with
//! them: their differences would be mostly noise.
//!
//! An ant turns the shorter way. A path whose ant begins nearly opposite to its desired direction
//! would jump as soon as a parameter brings it to the other side, and with it the sum of squares.
//! Here the side is that of the beginning: an ant may turn a little more than half a turn, and
//! paths depend smoothly on all parameters.

use std::f64::consts::{PI, TAU};

use nalgebra::{SMatrix, SVector};

use super::attachments::Attachment;
use cohaul::math::{Mat3, Vec2, Vec3, unwrap_near};

/// Largest step (s): the control period of the paper's scenes.
const STEP: f64 = 0.0025;

/// Angle to the direction opposite to the spring below which a nest counts as behind the spring
/// (rad). There the side to which the ant turns hangs on less than the noise of a tip.
const BEHIND: f64 = 0.1;

/// Recorded tips and roots (m, world) of one attachment.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    pub times: Vec<f64>,
    pub tips: Vec<Vec2>,
    pub roots: Vec<Vec2>,
}

/// Sum of squares of a path about its track, half of it, with its derivatives by the place and
/// direction at the beginning (first three) and by ln k, beta and v.
#[derive(Clone, Copy, Debug)]
pub struct Residuals {
    pub cost: f64,
    pub gradient: SVector<f64, 6>,
    pub curvature: SMatrix<f64, 6, 6>,
}

/// Derivatives of x, y and the direction by the six parameters.
type Rows = [SVector<f64, 6>; 3];

impl Track {
    /// The longest part of an attachment in world axes without a nest behind the spring, if it has
    /// at least `n` samples.
    pub fn of(own: &Attachment, nest: &Vec2, n: usize) -> Option<Self> {
        let places: Vec<[Vec2; 2]> = own.held.iter().map(|held| held.places).collect::<Option<_>>()?;
        let is_clear = |[tip, root]: &[Vec2; 2]| off(tip, root, nest).abs() < PI - BEHIND;
        let mut parts: Vec<std::ops::Range<usize>> = Vec::new();
        for (i, place) in places.iter().enumerate() {
            match parts.last_mut() {
                Some(part) if is_clear(place) && part.end == i => part.end = i + 1,
                _ if is_clear(place) => parts.push(i..i + 1),
                _ => {}
            }
        }
        let longest = parts.into_iter().max_by_key(std::ops::Range::len).filter(|part| part.len() >= n)?;
        Some(Self {
            times: own.held[longest.clone()].iter().map(|held| held.time).collect(),
            tips: places[longest.clone()].iter().map(|place| place[0]).collect(),
            roots: places[longest].iter().map(|place| place[1]).collect(),
        })
    }

    /// Speed of the tip between its ends (m/s).
    pub fn mean_speed(&self) -> f64 {
        let last = self.times.len() - 1;
        (self.tips[last] - self.tips[0]).norm() / (self.times[last] - self.times[0])
    }

    /// Residuals of the path that begins at `start` (m, m, rad), for ln k, beta and v (`steering`).
    pub fn residuals(&self, nest: &Vec2, start: &Vec3, steering: &Vec3) -> Residuals {
        let [gain, half_angle, speed] = [steering[0].exp(), steering[1], steering[2]];
        let (mut tip, mut direction) = (Vec2::new(start.x, start.y), start.z);
        let mut rows: Rows = std::array::from_fn(|i| SVector::from_fn(|j, _| if i == j { 1.0 } else { 0.0 }));
        let mut found = Residuals { cost: 0.0, gradient: SVector::zeros(), curvature: SMatrix::zeros() };
        let mut wanted = self.first_desired(nest);
        for i in 0..self.times.len() {
            found.add(&(tip - self.tips[i]), &rows);
            let Some(next) = self.times.get(i + 1) else { break };
            let time = next - self.times[i];
            // The margin is for rounding of times.
            let n = (time / STEP - 1e-6).ceil().max(1.0);
            let (step, turned) = (time / n, gain * time / n);
            let share = -(-turned).exp_m1();
            for k in 0..n as usize {
                let root = self.roots[i] + k as f64 / n * (self.roots[i + 1] - self.roots[i]);
                let (desired, by_tip, by_half_angle) = desired(&tip, &root, nest, half_angle);
                wanted = unwrap_near(desired, wanted);
                let error = wanted - direction;
                let (sin, cos) = direction.sin_cos();
                let [x, y, turn] = rows;
                let mut towards = x * by_tip.x + y * by_tip.y;
                towards[4] += by_half_angle;
                rows = [x - turn * (speed * step * sin), y + turn * (speed * step * cos), turn + (towards - turn) * share];
                rows[0][5] += step * cos;
                rows[1][5] += step * sin;
                rows[2][3] += error * turned * (1.0 - share);
                tip += speed * step * Vec2::new(cos, sin);
                direction += share * error;
            }
        }
        found
    }

    /// Desired direction at the first sample for a half angle of one (rad): the turn from which all
    /// directions of the track are counted.
    fn first_desired(&self, nest: &Vec2) -> f64 {
        desired(&self.tips[0], &self.roots[0], nest, 1.0).0
    }

    /// The direction at the beginning, of equally spaced ones within half a turn of the desired
    /// one, with the smallest residuals.
    pub fn start(&self, nest: &Vec2, steering: &Vec3) -> Vec3 {
        const N: usize = 12;
        let opposite = unwrap_near(desired(&self.tips[0], &self.roots[0], nest, steering[1]).0, self.first_desired(nest)) - PI;
        let start = |k: usize| Vec3::new(self.tips[0].x, self.tips[0].y, opposite + TAU * (k as f64 + 0.5) / N as f64);
        let cost = |start: &Vec3| self.residuals(nest, start, steering).cost;
        (0..N).map(start).min_by(|a, b| cost(a).total_cmp(&cost(b))).expect("there are directions")
    }
}

/// Angle from the spring to the nest, from -pi to pi (rad).
fn off(tip: &Vec2, root: &Vec2, nest: &Vec2) -> f64 {
    let (to_nest, spring) = (nest - tip, tip - root);
    spring.perp(&to_nest).atan2(spring.dot(&to_nest))
}

/// Direction in which an ant wants to pull, Eq. (22) (rad), with its derivatives by the tip (rad/m)
/// and by the half angle.
fn desired(tip: &Vec2, root: &Vec2, nest: &Vec2, half_angle: f64) -> (f64, Vec2, f64) {
    let (to_nest, spring) = (nest - tip, tip - root);
    let off = off(tip, root, nest);
    if off.abs() <= half_angle {
        return (to_nest.y.atan2(to_nest.x), Vec2::new(to_nest.y, -to_nest.x) / to_nest.norm_squared(), 0.0);
    }
    let side = off.signum();
    (spring.y.atan2(spring.x) + side * half_angle, Vec2::new(-spring.y, spring.x) / spring.norm_squared(), side)
}

impl Residuals {
    fn add(&mut self, residual: &Vec2, [x, y, _]: &Rows) {
        self.cost += 0.5 * residual.norm_squared();
        self.gradient += x * residual.x + y * residual.y;
        self.curvature += x * x.transpose() + y * y.transpose();
    }

    /// Step of the beginning to its best value for the same steering; `None` where the track does
    /// not determine it.
    pub fn step(&self) -> Option<Vec3> {
        let own: Mat3 = self.curvature.fixed_view::<3, 3>(0, 0).into();
        let gradient: Vec3 = self.gradient.fixed_rows::<3>(0).into();
        own.cholesky().map(|factor| -factor.solve(&gradient))
    }

    /// Gradient and curvature by the steering alone, with the beginning eliminated.
    pub fn reduced(&self) -> Option<(Vec3, Mat3)> {
        let part = |i: usize, j: usize| -> Mat3 { self.curvature.fixed_view::<3, 3>(i, j).into() };
        let [own, common]: [Vec3; 2] = [0, 3].map(|i| self.gradient.fixed_rows::<3>(i).into());
        let factor = part(0, 0).cholesky()?;
        let across = part(3, 0);
        Some((common - across * factor.solve(&own), part(3, 3) - across * factor.solve(&part(0, 3))))
    }
}
