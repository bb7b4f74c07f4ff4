//! Solver for one set of supports, which starts from its last answer.

use super::clarabel::ClarabelSolver;
use super::cones::Cones;
use super::exact;
use super::problem::{Candidate, ConeSolver, ContactMode, FrictionSolution, WarmStart};
use crate::backend::numerics::CLARABEL_ACCURACY;
use crate::backend::report::RestoreError;
use crate::math::{Mat3, Vec2, Vec3, rotation};
use crate::model::Ground;

/// Solver of the friction problem for one set of supports. It starts from its last answer.
#[derive(Clone, Debug)]
pub struct FrictionSolver {
    pub(super) cones: Cones,
    pub(super) last: WarmStart,
    support_forces: Vec<Vec2>,
    /// The solver that replaces the exact methods, if it was chosen.
    clarabel: Option<ClarabelSolver>,
}

impl FrictionSolver {
    /// Exact solver for the supports of `ground`. `length_scale` (m) is the size of the load, which
    /// replaces the extent of the supports where that is next to nothing.
    pub fn new(ground: &Ground, length_scale: f64) -> Self {
        Self::by(ConeSolver::Exact, ground, length_scale)
    }

    /// [`FrictionSolver::new`] with a choice of the method.
    pub fn by(solver: ConeSolver, ground: &Ground, length_scale: f64) -> Self {
        let cones = Cones::new(ground, length_scale);
        Self {
            last: WarmStart { twist: None, pin: None, slipped: false, forces: vec![Vec2::zeros(); cones.len()] },
            support_forces: vec![Vec2::zeros(); ground.supports.len()],
            cones,
            clarabel: (solver == ConeSolver::Clarabel).then(|| ClarabelSolver::new(ground, length_scale)),
        }
    }

    /// Error of an increment by the solver, over its size (1). It is zero for the exact methods,
    /// whose error is rounding.
    pub fn accuracy(&self) -> f64 {
        if self.clarabel.is_some() { CLARABEL_ACCURACY } else { 0.0 }
    }

    /// Minimises for `hessian` (N/m, N, N m/rad; positive semidefinite) and `drive` w (N, N, N m),
    /// both over a body-twist increment (m, m, rad). Without slip limits the answer is the linear
    /// one.
    pub fn solve(&mut self, hessian: &Mat3, drive: &Vec3) -> FrictionSolution {
        if let Some(clarabel) = &mut self.clarabel {
            let solution = clarabel.friction_solution(hessian, drive);
            self.support_forces.iter_mut().zip(clarabel.forces()).for_each(|(force, along)| *force = -along);
            return solution;
        }
        let (h, w) = self.cones.scaled(hessian, drive);
        // Numbers that are not finite would pass every comparison in the search.
        if !(h.sum() + w.sum()).is_finite() {
            return FrictionSolution { increment: Vec3::zeros(), mode: ContactMode::Stick, residual: f64::INFINITY, n_iterations: 0 };
        }
        let mut n_iterations = 0;
        let candidate = exact::search(&self.cones, &h, &w, &mut self.last, &mut n_iterations);
        let residual = self.cones.residual(&h, &w, &candidate.twist, &self.last.forces);
        self.keep(&candidate);
        FrictionSolution {
            increment: self.cones.unscaled_twist(&candidate.twist),
            mode: match candidate.mode {
                ContactMode::Pinned(cone) => ContactMode::Pinned(self.cones.first_support_of(cone)),
                other => other,
            },
            residual,
            n_iterations,
        }
    }

    /// Whether nothing moved in the last answer of the exact methods.
    pub fn was_at_rest(&self) -> bool {
        self.clarabel.is_none() && !self.last.slipped && self.last.pin.is_none()
    }

    /// Residual (1) of a load that was at rest in the last answer and stays there under this
    /// `gradient` (N, N, N m) of all forces but friction; rest is then the last answer. `None`,
    /// with nothing changed, where the load was not at rest, or where that is not certain at once.
    pub fn rest(&mut self, gradient: &Vec3) -> Option<f64> {
        if !self.was_at_rest() {
            return None;
        }
        let w = -self.cones.scaled_gradient(gradient);
        self.cones.stick_forces(&w, &mut self.last.forces).then(|| {
            let residual = self.cones.residual(&Mat3::zeros(), &w, &Vec3::zeros(), &self.last.forces);
            self.keep(&Candidate { twist: Vec3::zeros(), mode: ContactMode::Stick });
            residual
        })
    }

    /// Residual (1) of a load at rest that the last friction forces hold under this `gradient` (N,
    /// N, N m) of all other forces; rest is then the last answer. `None`, with nothing changed,
    /// where it exceeds the `largest` one (1).
    pub fn hold(&mut self, gradient: &Vec3, largest: f64) -> Option<f64> {
        let w = -self.cones.scaled_gradient(gradient);
        let residual = self.cones.residual(&Mat3::zeros(), &w, &Vec3::zeros(), &self.last.forces);
        (residual <= largest).then(|| {
            self.keep(&Candidate { twist: Vec3::zeros(), mode: ContactMode::Stick });
            residual
        })
    }

    /// Scaled vector that stands for the least friction forces that balance a wrench (N, N, N m) on
    /// a load at rest. It is linear in the wrench; `None` where it is not known.
    pub fn balanced(&self, wrench: &Vec3) -> Option<Vec3> {
        if self.clarabel.is_some() { None } else { self.cones.balanced(&self.cones.scaled_gradient(wrench)) }
    }

    /// Writes friction forces (scaled, one per cone) that balance a wrench (N, N, N m) on a load at
    /// rest and leave room to their limits, if any do; returns `false` where that is not known.
    pub fn forces_with_margin(&self, wrench: &Vec3, forces: &mut Vec<Vec2>) -> bool {
        self.clarabel.is_none() && self.cones.forces_with_margin(&self.cones.scaled_gradient(wrench), forces)
    }

    /// Whether these forces and the least ones that `balanced` stands for are together within their
    /// limits, for any further wrench of this scaled norm.
    pub fn are_within_limits(&self, forces: &[Vec2], balanced: &Vec3, further: f64) -> bool {
        self.cones.are_within_limits(forces, balanced, further)
    }

    /// Largest scaled norm of a wrench with this force (N) and this torque (N m).
    pub fn scaled_wrench(&self, force: f64, torque: f64) -> f64 {
        self.cones.scaled_wrench(force, torque)
    }

    /// A copy of this solver with the forces by which a load at rest bears `drive` (N, N, N m): the
    /// forces `from` of a certificate of rest (scaled, one per cone), and the least forces for the
    /// change of `drive` since then.
    pub fn at_rest_under(&self, drive: &Vec3, from: &[Vec2]) -> Self {
        let mut copy = self.clone();
        let w = self.cones.scaled_gradient(drive);
        copy.last.forces.copy_from_slice(from);
        if copy.cones.stick_forces(&w, &mut copy.last.forces) {
            copy.cones.share_forces(&copy.last.forces, &mut copy.support_forces);
        }
        copy
    }

    /// Friction force on each support of the ground in the last solution (N, load axes), opposite
    /// to its slip.
    pub fn forces(&self) -> &[Vec2] {
        &self.support_forces
    }

    /// Friction force on each support in the last solution (N, world), for a load with this heading
    /// (rad).
    pub fn forces_in_world(&self, heading: f64) -> Vec<Vec2> {
        let turn = rotation(heading);
        self.support_forces.iter().map(|force| turn * force).collect()
    }

    /// The supports as cones.
    pub(in crate::backend) fn cones(&self) -> &Cones {
        &self.cones
    }

    /// Takes an answer that was found with forces besides the drive as the last one: a twist, a
    /// mode that names a cone, and the forces of the cones (all scaled).
    pub(in crate::backend) fn keep_scaled(&mut self, twist: Vec3, mode: ContactMode, forces: &[Vec2]) {
        self.last.forces.copy_from_slice(forces);
        self.keep(&Candidate { twist, mode });
    }

    /// Whether no support has a slip limit.
    pub fn is_frictionless(&self) -> bool {
        self.cones.is_empty()
    }

    /// Last answer, from which the next search starts.
    pub fn warm_start(&self) -> &WarmStart {
        &self.last
    }

    /// Takes the last answer of another solver, so that this one continues as the other would.
    ///
    /// # Errors
    /// When the answer belongs to other supports.
    pub fn set_warm_start(&mut self, start: WarmStart) -> Result<(), RestoreError> {
        if start.forces.len() != self.cones.len() || start.pin.is_some_and(|k| k >= self.cones.len()) {
            return Err(RestoreError(format!("friction of {} supports, not of {}", start.forces.len(), self.cones.len())));
        }
        self.cones.share_forces(&start.forces, &mut self.support_forces);
        self.last = start;
        Ok(())
    }

    /// Takes a candidate as the last answer.
    pub(super) fn keep(&mut self, candidate: &Candidate) {
        self.last.pin = match candidate.mode {
            ContactMode::Pinned(k) => Some(k),
            _ => None,
        };
        self.last.slipped = candidate.mode == ContactMode::Slip;
        if self.last.slipped {
            self.last.twist = Some(candidate.twist);
        }
        self.cones.share_forces(&self.last.forces, &mut self.support_forces);
    }
}
