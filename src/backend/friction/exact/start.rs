//! Starts of the iterative methods.

use super::single;
use crate::backend::friction::cones::Cones;
use crate::math::{Mat3, Vec2, Vec3};

/// A start from which no answer should be far, and how far supports move at it (scaled). Where the
/// supports are close together it is the answer with all limits at one point, which leaves only
/// their turn about that point open; elsewhere it is the answer without friction.
pub fn far_answer(cones: &Cones, h: &Mat3, w: &Vec3, n_iterations: &mut u32) -> (Vec3, f64) {
    if let Some(extent) = cones.cluster {
        let (found, _) = single::about(&Vec2::zeros(), 1.0, h, w, n_iterations);
        // Even without a moment about that point, the friction there may turn the load.
        let turned = Some(extent / h.m33).filter(|turn| turn.is_finite()).unwrap_or(0.0);
        return (found.twist, found.twist.xy().norm() + extent * (found.twist.z.abs() + turned));
    }
    let free = linear_answer(h, w);
    (free, free.xy().norm() + free.z.abs())
}

/// Minimiser without friction, with a ridge of 1e-12 of the largest diagonal entry where H is
/// singular.
pub fn linear_answer(h: &Mat3, w: &Vec3) -> Vec3 {
    let ridge = 1e-12 * h.diagonal().amax();
    h.cholesky()
        .or_else(|| (h + Mat3::from_diagonal_element(ridge)).cholesky())
        .map(|factor| factor.solve(w))
        .filter(|twist| twist.iter().all(|v| v.is_finite()))
        .unwrap_or(*w)
}
