//! All supports on one point: that support sticks while the load turns freely about it, or it
//! slips.
//!
//! The twist is written by the slip v of the support S and by y, the part of the turn about it, in
//! an orthonormal basis: `p = (S_y, -S_x, 1) / g` with `g = sqrt(1 + |S|^2)` turns about S, and the
//! two directions across p move S along itself and g times as fast across. That mixes turns and
//! shifts only as far as S is off the origin, so nothing cancels, whether S is near or far.
//! Friction depends on v alone; y follows as the minimum for each v, which leaves, with the Schur
//! complement H~ of p and w~ likewise,
//!
//! ```text
//! 1/2 v'H~v - w~'v + c|v|
//! ```
//!
//! With |w~| <= c the support sticks, and w~ is the force on it. Otherwise v = s u with |u| = 1 and
//! `(s H~ + c) u = w~`: the speed s solves `1 / |(s H~ + c)^-1 w~| = 1`. Its left side is concave
//! and grows with s (the power mean, of exponent -2, of linear functions), so Newton's method
//! climbs from s = 0 to the root without ever passing it.

use crate::backend::friction::cones::Cones;
use crate::backend::friction::problem::{Candidate, ContactMode};
use crate::backend::numerics::{LEAST_TURN_STIFFNESS, SINGLE_ITERATIONS};
use crate::math::{Mat2, Mat3, Vec2, Vec3, perpendicular};

/// Answer for the only cone; writes its force.
pub fn solve(cones: &Cones, h: &Mat3, w: &Vec3, forces: &mut [Vec2], n_iterations: &mut u32) -> Candidate {
    let (found, force) = about(&cones.offsets[0], cones.limits[0], h, w, n_iterations);
    forces[0] = force;
    found
}

/// Answer for one cone at `offset`, and the force f there.
pub fn about(offset: &Vec2, limit: f64, h: &Mat3, w: &Vec3, n_iterations: &mut u32) -> (Candidate, Vec2) {
    let problem = Split::new(offset, h, w);
    if problem.force.norm() <= limit {
        let rate = problem.turn(&Vec2::zeros()) / problem.gain / problem.lever;
        let twist = rate * Vec3::new(offset.y, -offset.x, 1.0);
        let mode = if rate == 0.0 { ContactMode::Stick } else { ContactMode::Pinned(0) };
        return (Candidate { twist, mode }, (w - h * twist).xy());
    }
    let slip = problem.slip(limit, n_iterations);
    let force = limit * (problem.frame * slip.normalize());
    (Candidate { twist: problem.twist_of(&slip), mode: ContactMode::Slip }, force)
}

/// The problem in three coordinates: slip of the support along its offset and across it, and turn
/// about it.
struct Split {
    /// Unit of length that makes turns about the origin as hard as shifts.
    lever: f64,
    /// Slip across the offset of a unit twist that has no turn about the support.
    gain: f64,
    /// Directions along the offset and across, as columns.
    frame: Mat2,
    /// The basis: along, across, turn.
    basis: Mat3,
    /// H and w in it; the last diagonal entry of H is the resistance to the turn.
    h: Mat3,
    w: Vec3,
    /// H~ and w~.
    stiffness: Mat2,
    force: Vec2,
}

impl Split {
    fn new(offset: &Vec2, h: &Mat3, w: &Vec3) -> Self {
        let lever = Some((h.m33 / h.m11.max(h.m22)).sqrt()).filter(|lever| lever.is_normal()).unwrap_or(1.0);
        let distance = offset.norm() / lever;
        let gain = distance.hypot(1.0);
        let along = if distance > 0.0 { offset.normalize() } else { Vec2::x() };
        let across = perpendicular(&along);
        let turning = Vec3::new(-across.x * distance, -across.y * distance, 1.0) / gain;
        let basis = Mat3::from_columns(&[along.push(0.0), across.push(distance) / gain, turning]);

        let units = Vec3::new(1.0, 1.0, 1.0 / lever);
        let mut h = basis.tr_mul(&Mat3::from_fn(|i, j| h[(i, j)] * units[i] * units[j])) * basis;
        // The moment about the support from its own terms: none stays none.
        let moment = w.dot(&Vec3::new(offset.y, -offset.x, 1.0)) / (gain * lever);
        let w = basis.tr_mul(&w.component_mul(&units)).xy().push(moment);
        h.m33 = h.m33.max(LEAST_TURN_STIFFNESS * h.diagonal().amax());

        let share = if h.m33 > 0.0 { Vec2::new(h.m13, h.m23) / h.m33 } else { Vec2::zeros() };
        let mixed = h.m12 - share.x * h.m23;
        let slips = Vec2::new(1.0, 1.0 / gain);
        let stiffness = Mat2::new(h.m11 - share.x * h.m13, mixed, mixed, h.m22 - share.y * h.m23);
        Self {
            lever,
            gain,
            frame: Mat2::from_columns(&[along, across]),
            stiffness: Mat2::from_fn(|i, j| stiffness[(i, j)] * slips[i] * slips[j]),
            force: (w.xy() - share * w.z).component_mul(&slips),
            basis,
            h,
            w,
        }
    }

    /// Turn that minimises the objective at a slip.
    fn turn(&self, slip: &Vec2) -> f64 {
        let rest = self.w.z - self.h.m13 * slip.x - self.h.m23 * (slip.y / self.gain);
        if self.h.m33 > 0.0 { rest / self.h.m33 } else { 0.0 }
    }

    /// Slip v of a support that does not stick.
    fn slip(&self, limit: f64, n_iterations: &mut u32) -> Vec2 {
        let mut speed = 0.0;
        let mut unit = self.force / limit;
        for _ in 0..SINGLE_ITERATIONS {
            *n_iterations += 1;
            let system = Symmetric::new(&(speed * self.stiffness + Mat2::from_diagonal_element(limit)));
            unit = system.solve(&self.force);
            // u' = -(s H~ + c)^-1 H~ u, and Newton's step of 1/|u| = 1.
            let decrease = unit.dot(&system.solve(&(self.stiffness * unit)));
            let squared = unit.norm_squared();
            let next = speed + (unit.norm() - 1.0) * squared / decrease;
            let climbs = next > speed && next.is_finite();
            if !climbs {
                break;
            }
            speed = next;
        }
        speed * unit
    }

    fn twist_of(&self, slip: &Vec2) -> Vec3 {
        let twist = self.basis * Vec3::new(slip.x, slip.y / self.gain, self.turn(slip));
        Vec3::new(twist.x, twist.y, twist.z / self.lever)
    }
}

/// A positive definite 2x2 matrix whose entries may be of very different size.
struct Symmetric {
    first: f64,
    ratio: f64,
    second: f64,
}

impl Symmetric {
    fn new(a: &Mat2) -> Self {
        let ratio = a.m21 / a.m11;
        Self { first: a.m11, ratio, second: a.m22 - ratio * a.m21 }
    }

    fn solve(&self, b: &Vec2) -> Vec2 {
        let y = (b.y - self.ratio * b.x) / self.second;
        Vec2::new(b.x / self.first - self.ratio * y, y)
    }
}
