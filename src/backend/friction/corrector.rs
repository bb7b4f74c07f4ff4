//! Newton steps on springs and friction together, in a contact mode that does not change.

use super::exact::gliding::{Tangent, balance, slip};
use super::exact::pinned::{resistance, unit_turn, write_forces};
use super::problem::{Candidate, ContactMode, FrictionSolution};
use super::solver::FrictionSolver;
use crate::math::{Mat3, PositiveDefinite, Vec3};

impl FrictionSolver {
    /// Solution of [`FrictionSolver::solve`] where all supports slip and `near` (m, m, rad) is
    /// close to it; `None`, with nothing changed, where there is no such solution.
    pub fn slide(&mut self, hessian: &Mat3, drive: &Vec3, near: &Vec3) -> Option<FrictionSolution> {
        let (h, w) = self.cones.scaled(hessian, drive);
        let mut n_iterations = 0;
        let (twist, residual) = slip(&self.cones, &h, &w, &self.cones.scaled_twist(near), &mut n_iterations)?;
        self.cones.write_slip_forces(&twist, &mut self.last.forces);
        self.keep(&Candidate { twist, mode: ContactMode::Slip });
        Some(FrictionSolution { increment: self.cones.unscaled_twist(&twist), mode: ContactMode::Slip, residual, n_iterations })
    }

    /// Newton step (m, m, rad) from a body-twist increment at which all supports slip, and the
    /// imbalance there over the forces in it (1). `gradient` and `hessian` are those of all forces
    /// but friction (N, N, N m; N/m, N, N m/rad). Without a Hessian the `tangent` of the last step
    /// is used; else `tangent` becomes the one here. `None` where a support slips too slowly.
    // Inlined, because the caller needs the returned vector at once.
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

    /// Takes an increment (m, m, rad) at which all supports slip as the last solution.
    pub fn keep_gliding(&mut self, increment: &Vec3) -> ContactMode {
        let twist = self.cones.scaled_twist(increment);
        self.cones.write_slip_forces(&twist, &mut self.last.forces);
        self.keep(&Candidate { twist, mode: ContactMode::Slip });
        ContactMode::Slip
    }

    /// Support that the load turned about in the last answer, and the body twist (m, m, rad) of a
    /// unit turn about it.
    pub fn unit_turn(&self) -> Option<(Vec3, usize)> {
        let cone = self.last.pin?;
        Some((self.cones.unscaled_twist(&unit_turn(&self.cones.offsets[cone])), self.cones.first_support_of(cone)))
    }

    /// Newton step (rad) from a `turn` (rad) about the support of [`FrictionSolver::unit_turn`],
    /// and the imbalance there over the forces in it (1). `gradient` and `hessian` are those of all
    /// forces but friction (N, N, N m; N/m, N, N m/rad). `None` where the energy does not grow with
    /// the turn.
    pub fn pivoting_step(&self, turn: f64, gradient: &Vec3, hessian: &Mat3) -> Option<(f64, f64)> {
        let pivot = self.cones.offsets[self.last.pin?];
        let (h, g) = self.cones.scaled(hessian, gradient);
        let unit_turn = unit_turn(&pivot);
        let out_of_balance = g.dot(&unit_turn) + turn.signum() * resistance(&self.cones, &pivot);
        let stiffness = unit_turn.dot(&(h * unit_turn));
        let scale = self.cones.force_scale(&h, &g, &(turn * unit_turn));
        (stiffness > 0.0).then(|| (-out_of_balance / stiffness, out_of_balance.abs() / scale))
    }

    /// Takes a `turn` (rad) about the support of [`FrictionSolver::unit_turn`] as the last
    /// solution, if that support can bear the force that is left for it. The turn balances the
    /// `gradient` (N, N, N m) of all forces but friction.
    pub fn keep_pivoting(&mut self, turn: f64, gradient: &Vec3) -> bool {
        let Some(k) = self.last.pin else { return false };
        let pulls = -self.cones.scaled_gradient(gradient);
        let fits = write_forces(&self.cones, k, turn.signum(), &pulls.xy(), &mut self.last.forces);
        if fits {
            self.keep(&Candidate { twist: turn * unit_turn(&self.cones.offsets[k]), mode: ContactMode::Pinned(k) });
        }
        fits
    }
}
