//! All supports slip, none of them slowly: Newton's method on the twist itself.
//!
//! Away from the kinks of |B_i x| the conditions of the minimum,
//!
//! ```text
//! H x - w + sum_i c_i B_i' u_i = 0        u_i = B_i x / |B_i x|
//! ```
//!
//! have the symmetric positive definite derivative `H + sum_i (c_i / |B_i x|) b_i b_i'` with `b_i = B_i' J u_i`, J a quarter turn. From the twist of the step
//! before two or three iterations reach rounding, at a fraction of the cost of the polar ones, which take over wherever this one hesitates.

use super::cones::Cones;
use super::{Candidate, EXACT, Regime};
use crate::math::{Mat3, PositiveDefinite, Vec2, Vec3};

/// Slip of a support over the size of the twist (1) below which its direction is left to the polar coordinates.
const SLOWEST: f64 = 1e-3;
/// Where these do not do, the start was not near.
const MOST_ITERATIONS: u32 = 8;
/// Residual at which nothing is left to gain (1).
const ROUNDED: f64 = 1e-15;

/// The slip found from `start`, with the cones' forces written; `None`, with the forces as they were, when there is none near it.
pub(super) fn slip(cones: &Cones, h: &Mat3, w: &Vec3, start: &Vec3, forces: &mut [Vec2], n_iterations: &mut u32) -> Option<Candidate> {
    let (mut twist, mut last) = (*start, f64::INFINITY);
    for _ in 0..MOST_ITERATIONS {
        let Balance { residual, derivative } = balance(cones, &(h * twist - w), h, &twist)?;
        let (size, scale) = (residual.amax(), cones.force_scale(h, w, &twist));
        if size <= ROUNDED * scale || size <= EXACT * scale && size >= 0.25 * last {
            cones.write_slip_forces(&twist, forces);
            return Some(Candidate { twist, regime: Regime::Slip });
        }
        // Newton's method near an answer more than halves the residual; the first step, which also corrects the size of the twist, need not.
        if size > 0.5 * last {
            return None;
        }
        last = if last == f64::INFINITY { f64::MAX } else { size };
        *n_iterations += 1;
        twist -= PositiveDefinite::new(&derivative)?.solve(&residual);
    }
    None
}

/// What is out of balance at a twist, and the derivative of that (only its lower half).
pub(super) struct Balance {
    pub residual: Vec3,
    pub derivative: Mat3,
}

/// Adds friction to the `gradient` and the `hessian` of what else acts at `twist`; `None` where a support slips too slowly.
pub(super) fn balance(cones: &Cones, gradient: &Vec3, hessian: &Mat3, twist: &Vec3) -> Option<Balance> {
    let (mut residual, mut derivative) = (*gradient, *hessian);
    let slowest = SLOWEST * SLOWEST * twist.norm_squared();
    for (offset, limit) in cones.offsets.iter().zip(&cones.limits) {
        let slip = Vec2::new(twist.x - twist.z * offset.y, twist.y + twist.z * offset.x);
        let squared = slip.norm_squared();
        // Not a number is too slow as well.
        let is_fast = squared > slowest;
        if !is_fast {
            return None;
        }
        let inverse = 1.0 / squared.sqrt();
        let unit = inverse * slip;
        residual.x += limit * unit.x;
        residual.y += limit * unit.y;
        residual.z += limit * offset.perp(&unit);
        // B' J u: its torque is S x J u = S . u.
        let across = Vec3::new(-unit.y, unit.x, offset.dot(&unit));
        let curvature = limit * inverse * across;
        derivative.m11 += curvature.x * across.x;
        derivative.m21 += curvature.y * across.x;
        derivative.m22 += curvature.y * across.y;
        derivative.m31 += curvature.z * across.x;
        derivative.m32 += curvature.z * across.y;
        derivative.m33 += curvature.z * across.z;
    }
    Some(Balance { residual, derivative })
}
