//! All supports slip, none of them slowly: Newton's method on the twist itself.
//!
//! Away from the kinks of |B_i x| the conditions of the minimum,
//!
//! ```text
//! H x - w + sum_i c_i B_i' u_i = 0        u_i = B_i x / |B_i x|
//! ```
//!
//! have the symmetric positive definite derivative `H + sum_i (c_i / |B_i x|) b_i b_i'` with `b_i =
//! B_i' J u_i`, J a quarter turn. From the twist of the step before, two or three iterations reach
//! rounding, at a fraction of the cost of the polar coordinates, which take over wherever this
//! method does not converge.

use crate::backend::friction::cones::Cones;
use crate::backend::numerics::{EXACT, GLIDING_ITERATIONS, NOTHING_LEFT, SLOWEST_GLIDING};
use crate::math::{Mat3, PositiveDefinite, Vec2, Vec3};

/// Derivative of the imbalance by the twist, factored (scaled).
pub struct Tangent {
    pub(in crate::backend::friction) factor: PositiveDefinite,
    /// Size of the forces in the balance.
    pub(in crate::backend::friction) scale: f64,
}

/// Slip found from `start`, and its residual (1); `None` when there is no slip near it.
pub fn slip(cones: &Cones, h: &Mat3, w: &Vec3, start: &Vec3, n_iterations: &mut u32) -> Option<(Vec3, f64)> {
    let (mut twist, mut last) = (*start, f64::INFINITY);
    for _ in 0..GLIDING_ITERATIONS {
        let mut derivative = *h;
        let residual = balance(cones, &(h * twist - w), Some(&mut derivative), &twist)?;
        let (size, scale) = (residual.amax(), cones.force_scale(h, w, &twist));
        if size <= NOTHING_LEFT * scale || size <= EXACT * scale && size >= 0.25 * last {
            return Some((twist, size / scale));
        }
        // Newton's method near an answer more than halves the residual. The first step, which also
        // corrects the size of the twist, need not.
        if size > 0.5 * last {
            return None;
        }
        last = if last == f64::INFINITY { f64::MAX } else { size };
        *n_iterations += 1;
        twist -= PositiveDefinite::new(&derivative)?.solve(&residual);
    }
    None
}

/// Imbalance at `twist` under friction and the `gradient` of the other forces (scaled). The lower
/// half of `derivative`, which is that of the other forces, becomes that of all. `None` where a
/// support slips too slowly.
// Inlined, because callers need the returned vector at once.
#[inline(always)]
pub fn balance(cones: &Cones, gradient: &Vec3, mut derivative: Option<&mut Mat3>, twist: &Vec3) -> Option<Vec3> {
    let mut residual = *gradient;
    let reach = cones.cluster.unwrap_or(1.0);
    let slowest = SLOWEST_GLIDING * SLOWEST_GLIDING * Vec3::new(twist.x, twist.y, reach * twist.z).norm_squared();
    for (offset, limit) in cones.offsets.iter().zip(&cones.limits) {
        let slip = Vec2::new(twist.x - twist.z * offset.y, twist.y + twist.z * offset.x);
        let squared = slip.norm_squared();
        // A slip that is not a number counts as too slow.
        let is_fast = squared > slowest;
        if !is_fast {
            return None;
        }
        let inverse = 1.0 / squared.sqrt();
        let unit = inverse * slip;
        residual.x += limit * unit.x;
        residual.y += limit * unit.y;
        residual.z += limit * offset.perp(&unit);
        if let Some(derivative) = &mut derivative {
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
    }
    Some(residual)
}
