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
use super::{Candidate, EXACT, FrictionSolution, FrictionSolver, Regime};
use crate::math::{Mat3, PositiveDefinite, Vec2, Vec3};

/// Slip of a support over the size of the twist, by the reach of the supports (1), below which its direction is left to the polar coordinates.
const SLOWEST: f64 = 1e-3;
/// Where these do not do, the start was not near.
const MOST_ITERATIONS: u32 = 8;
/// Residual at which nothing is left to gain (1).
const ROUNDED: f64 = 1e-15;

/// How what is out of balance changes with a slip (scaled).
pub struct Tangent {
    factor: PositiveDefinite,
    /// Size of the forces in it.
    scale: f64,
}

impl FrictionSolver {
    /// The solution of [`FrictionSolver::solve`] where all supports slip and `near` (m, m, rad) is close to it; `None`, with nothing changed, where
    /// there is no such one.
    pub fn slide(&mut self, hessian: &Mat3, drive: &Vec3, near: &Vec3) -> Option<FrictionSolution> {
        let (h, w) = self.cones.scaled(hessian, drive);
        let mut n_iterations = 0;
        let (twist, residual) = slip(&self.cones, &h, &w, &self.cones.scaled_twist(near), &mut n_iterations)?;
        self.cones.write_slip_forces(&twist, &mut self.last.forces);
        self.keep(&Candidate { twist, regime: Regime::Slip });
        Some(FrictionSolution { increment: self.cones.unscaled_twist(&twist), regime: Regime::Slip, residual, n_iterations })
    }

    /// Newton's step (m, m, rad) from a body-twist increment at which all supports slip, and what is out of balance there, relative to the forces in it (1);
    /// `gradient` and `hessian` are those of what acts besides friction (N, N, N m; N/m, N, N m/rad). Without a Hessian the `tangent` of the last step serves, else it
    /// becomes the one here. `None` where a support slips too slowly.
    // In place: what it returns is needed at once.
    #[inline(always)]
    pub fn gliding_step(
        &self,
        increment: &Vec3,
        gradient: &Vec3,
        hessian: Option<&Mat3>,
        tangent: &mut Option<Tangent>,
    ) -> Option<(Vec3, f64)> {
        let (twist, g) = (self.cones.scaled_twist(increment), self.cones.scaled_gradient(gradient));
        let residual = match hessian {
            Some(hessian) => {
                let h = self.cones.scaled_hessian(hessian);
                let mut derivative = h;
                let residual = balance(&self.cones, &g, Some(&mut derivative), &twist)?;
                *tangent = Some(Tangent { factor: PositiveDefinite::new(&derivative)?, scale: self.cones.force_scale(&h, &g, &twist) });
                residual
            }
            None => balance(&self.cones, &g, None, &twist)?,
        };
        let Tangent { factor, scale } = tangent.as_ref()?;
        Some((-self.cones.unscaled_twist(&factor.solve(&residual)), residual.amax() / scale))
    }

    /// Takes an increment at which all supports slip as the last solution.
    pub fn keep_gliding(&mut self, increment: &Vec3) -> Regime {
        let twist = self.cones.scaled_twist(increment);
        self.cones.write_slip_forces(&twist, &mut self.last.forces);
        self.keep(&Candidate { twist, regime: Regime::Slip });
        Regime::Slip
    }
}

/// The slip found from `start` and its residual (1); `None` when there is none near it.
pub(super) fn slip(cones: &Cones, h: &Mat3, w: &Vec3, start: &Vec3, n_iterations: &mut u32) -> Option<(Vec3, f64)> {
    let (mut twist, mut last) = (*start, f64::INFINITY);
    for _ in 0..MOST_ITERATIONS {
        let mut derivative = *h;
        let residual = balance(cones, &(h * twist - w), Some(&mut derivative), &twist)?;
        let (size, scale) = (residual.amax(), cones.force_scale(h, w, &twist));
        if size <= ROUNDED * scale || size <= EXACT * scale && size >= 0.25 * last {
            return Some((twist, size / scale));
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

/// What is out of balance at `twist` under friction and the `gradient` of what else acts; `derivative`, that of the latter, becomes the one of both (only its
/// lower half). `None` where a support slips too slowly.
// In place: what it returns is needed at once.
#[inline(always)]
fn balance(cones: &Cones, gradient: &Vec3, mut derivative: Option<&mut Mat3>, twist: &Vec3) -> Option<Vec3> {
    let mut residual = *gradient;
    let reach = cones.cluster.unwrap_or(1.0);
    let slowest = SLOWEST * SLOWEST * Vec3::new(twist.x, twist.y, reach * twist.z).norm_squared();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Vec2, direction};
    use crate::model::{Ground, SupportPoint};

    fn tripod() -> Ground {
        let supports = [0.3, 2.1, 4.0].map(|angle| SupportPoint { offset: 0.008 * direction(angle), normal_load: 0.005 });
        Ground { friction_coefficient: 1.4, supports: supports.to_vec() }
    }

    /// Convex, so both find the one minimum: what differs is the way there, to a hundred roundings of the forces.
    #[test]
    fn a_slip_from_nearby_is_the_one_from_anywhere() {
        let ground = tripod();
        let hessian = Mat3::new(1600.0, 2.0, 0.3, 2.0, 1600.0, -0.2, 0.3, -0.2, 0.12);
        let mut n_found = 0;
        for i in 0..50 {
            let at = f64::from(i);
            let drive = (0.03 * direction(at)).push(1e-4 * (3.0 * at).sin());
            let [mut near, mut far] = [(); 2].map(|()| FrictionSolver::new(&ground, 0.01));
            let want = far.solve(&hessian, &drive);
            let start = want.increment.component_mul(&Vec3::new(1.05, 0.95, 1.1));
            let Some(found) = near.slide(&hessian, &drive, &start) else { continue };
            n_found += 1;
            assert_eq!(want.regime, Regime::Slip);
            assert!((found.increment - want.increment).norm() < 1e-13 * want.increment.norm() + 1e-20, "{i}");
            assert!(near.forces().iter().zip(far.forces()).all(|(a, b)| (a - b).norm() < 1e-14));
            assert_eq!(near.warm_start().pin, far.warm_start().pin);
        }
        assert!(n_found > 30, "{n_found}");
    }

    /// A start far off, none at all, and a load that stays: all leave the solver as it was.
    #[test]
    fn elsewhere_it_finds_nothing_and_says_so() {
        let mut solver = FrictionSolver::new(&tripod(), 0.01);
        let (hessian, before) = (Mat3::from_diagonal(&Vec3::new(1600.0, 1600.0, 0.12)), solver.warm_start().clone());
        let weak = Vec3::new(0.01, 0.0, 0.0);
        for near in [Vec3::zeros(), Vec3::new(1e-5, 0.0, 1e-3), Vec3::new(f64::NAN, 0.0, 0.0)] {
            assert_eq!(solver.slide(&hessian, &weak, &near), None);
        }
        // A turn about the first support.
        let pivot: Vec2 = tripod().supports[0].offset;
        assert_eq!(solver.slide(&hessian, &Vec3::new(0.03, 0.0, 0.0), &Vec3::new(pivot.y, -pivot.x, 1.0)), None);
        assert_eq!(*solver.warm_start(), before);
    }
}
