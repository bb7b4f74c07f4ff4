//! The exact cone problem in three variables, used by all backends.
//!
//! For a symmetric H and a wrench w, both in load axes, the body-twist increment x of the load minimises
//!
//! ```text
//! 1/2 x'Hx - w'x + sum_i c_i |B_i x|        B_i x: slip of support i, Eq. (12);  c_i = mu N_i: its slip limit, Eq. (13)
//! ```
//!
//! At the minimum `H x - w + sum_i B_i' f_i = 0`, with `f_i = c_i B_i x / |B_i x|` where support i slips and `|f_i| <= c_i` where it sticks. The
//! problem is convex, so whatever satisfies these conditions is the answer, and the order of the attempts below is one of cost only:
//!
//! One (`single.rs`): all supports stand on one point; a problem of its own, solved in closed form but for one scalar.
//!
//! 0. Gliding (`gliding.rs`): as in the last answer all supports slip, none of them slowly.
//! 1. Rest (`cones.rs`): forces within all limits that balance w. Nothing moves. Close to the edge of slipping once more after 2, where they take some rounds to find, or
//!    where it shows that there are none: then parabolas that touch the cones' losses lead to a slip that gliding ends.
//! 2. Pinned (`pinned.rs`): rotation about one support that sticks. With two distinct ones sticking, all do.
//! 3. Slipping (`slipping.rs`): all supports slip, or stick close to it. Newton's method in coordinates in which the kink at a slow support is smooth.
//! 4. Smoothed (`smoothed.rs`): continuation over rounded cones, which gives the others a start where they have none.
//!
//! All of it happens in units of the supports' extent and of the sum of the limits, so that no tolerance has a dimension, and about a point among the
//! supports where they stand close together off the origin (`cones.rs`).

mod cones;
mod gliding;
mod pinned;
mod single;
mod slipping;
mod smoothed;

use serde::{Deserialize, Serialize};

use super::quasi_static::conic::{self, ConicSolver};
use super::{ConeSolver, RestoreError};
use crate::math::{Mat3, Vec2, Vec3, rotation};
use crate::model::Ground;

use cones::{Cones, Pressed};
pub use gliding::Tangent;

/// Solves the cone problem for one set of supports, starting from its last answer.
#[derive(Clone, Debug)]
pub struct FrictionSolver {
    cones: Cones,
    last: WarmStart,
    support_forces: Vec<Vec2>,
    /// Answers in place of the exact solver, if it is there.
    conic: Option<ConicSolver>,
}

/// The last answer (scaled). Where the next one starts decides its last bits, so this belongs to the state of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WarmStart {
    /// Twist of the last slipping answer: the next one is likely to be near.
    twist: Option<Vec3>,
    /// Cone that the load turned about, if it did.
    pin: Option<usize>,
    /// Whether the last answer was that twist.
    #[serde(default)]
    slipped: bool,
    /// Forces f_i, one a cone.
    pub(super) forces: Vec<Vec2>,
}

/// The minimiser and what it means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionSolution {
    /// Body-twist increment (m, m, rad).
    pub increment: Vec3,
    pub regime: Regime,
    /// Largest violation of the optimality conditions, relative to the forces in them (1).
    pub residual: f64,
    /// Newton iterations.
    pub n_iterations: u32,
}

/// Which supports stick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Regime {
    /// All of them: nothing moves.
    Stick,
    /// One: the load turns about the support of this index (of those that stand on the same point, the first).
    Pinned(usize),
    /// None.
    Slip,
}

/// A candidate in scaled units; its forces stand in the solver's warm start.
struct Candidate {
    twist: Vec3,
    regime: Regime,
}

/// Residual up to which an answer counts as exact: some tens of roundings of the sums in it.
pub const EXACT: f64 = 1e-13;

impl FrictionSolver {
    /// `length_scale` (m) is the size of the load, which stands in where the supports have next to no extent of their own.
    pub fn new(ground: &Ground, length_scale: f64) -> Self {
        let cones = Cones::new(ground, length_scale);
        Self {
            last: WarmStart { twist: None, pin: None, slipped: false, forces: vec![Vec2::zeros(); cones.len()] },
            support_forces: vec![Vec2::zeros(); ground.supports.len()],
            cones,
            conic: None,
        }
    }

    /// The same with its problems handed to `solver`.
    pub fn through(self, solver: ConeSolver, ground: &Ground, length_scale: f64) -> Self {
        Self { conic: (solver == ConeSolver::Clarabel).then(|| ConicSolver::new(ground, length_scale)), ..self }
    }

    /// Error that an increment may have through the solver, over its size (1); the exact one has none but rounding.
    pub fn accuracy(&self) -> f64 {
        if self.conic.is_some() { conic::ACCURACY } else { 0.0 }
    }

    /// Minimises for `hessian` (N/m, N, N m/rad; positive semidefinite) and `drive` w (N, N, N m), both over a body-twist increment
    /// (m, m, rad). Where no support has a slip limit the answer is the linear one.
    pub fn solve(&mut self, hessian: &Mat3, drive: &Vec3) -> FrictionSolution {
        if let Some(conic) = &mut self.conic {
            let solution = conic.friction_solution(hessian, drive);
            self.support_forces.iter_mut().zip(conic.forces()).for_each(|(force, along)| *force = -along);
            return solution;
        }
        let (h, w) = self.cones.scaled(hessian, drive);
        // What has no value passes every comparison on the way.
        if !(h.sum() + w.sum()).is_finite() {
            return FrictionSolution { increment: Vec3::zeros(), regime: Regime::Stick, residual: f64::INFINITY, n_iterations: 0 };
        }
        let mut n_iterations = 0;
        let candidate = self.search(&h, &w, &mut n_iterations);
        let residual = self.cones.residual(&h, &w, &candidate.twist, &self.last.forces);
        self.keep(&candidate);
        FrictionSolution {
            increment: self.cones.unscaled_twist(&candidate.twist),
            regime: match candidate.regime {
                Regime::Pinned(cone) => Regime::Pinned(self.cones.first_support_of(cone)),
                other => other,
            },
            residual,
            n_iterations,
        }
    }

    /// Whether nothing moved in the last answer of the exact solver.
    pub fn was_at_rest(&self) -> bool {
        self.conic.is_none() && !self.last.slipped && self.last.pin.is_none()
    }

    /// Whether a load that was at rest in the last answer stays there under this `gradient` (N, N, N m) of what acts besides friction: the residual (1) of
    /// that, which is then the last answer; `None`, with nothing changed, where it was not, or that is not sure at once.
    pub fn rest(&mut self, gradient: &Vec3) -> Option<f64> {
        if !self.was_at_rest() {
            return None;
        }
        let w = -self.cones.scaled_gradient(gradient);
        self.cones.stick_forces(&w, &mut self.last.forces).then(|| {
            let residual = self.cones.residual(&Mat3::zeros(), &w, &Vec3::zeros(), &self.last.forces);
            self.keep(&Candidate { twist: Vec3::zeros(), regime: Regime::Stick });
            residual
        })
    }

    /// What stands for the least friction forces that balance a wrench on a load at rest (N, N, N m), linear in that; `None` where that is not known.
    pub fn balanced(&self, wrench: &Vec3) -> Option<Vec3> {
        if self.conic.is_some() { None } else { self.cones.balanced(&self.cones.scaled_gradient(wrench)) }
    }

    /// Friction forces (scaled, one a cone) that balance a wrench on a load at rest (N, N, N m) and leave room to their limits, if any do, in place of `forces`;
    /// `false` where that is not known.
    pub fn roomy_forces(&self, wrench: &Vec3, forces: &mut Vec<Vec2>) -> bool {
        self.conic.is_none() && self.cones.roomy_forces(&self.cones.scaled_gradient(wrench), forces)
    }

    /// Whether these forces and what stands for the least ones are surely within their limits together, whatever a further wrench of this norm (scaled) adds to them.
    pub fn bears(&self, forces: &[Vec2], balanced: &Vec3, further: f64) -> bool {
        self.cones.bears(forces, balanced, further)
    }

    /// Largest scaled norm of a wrench with a force (N) and a torque (N m) of these sizes.
    pub fn scaled_wrench(&self, force: f64, torque: f64) -> f64 {
        self.cones.scaled_wrench(force, torque)
    }

    /// This solver with the forces by which a load at rest bears `drive` (N, N, N m): those `from` which a certificate of rest goes on (scaled, one a cone), and the
    /// least ones for what `drive` has changed by since.
    pub fn bearing(&self, drive: &Vec3, from: &[Vec2]) -> Self {
        let mut bearing = self.clone();
        let w = self.cones.scaled_gradient(drive);
        bearing.last.forces.copy_from_slice(from);
        if bearing.cones.stick_forces(&w, &mut bearing.last.forces) {
            bearing.cones.share_forces(&bearing.last.forces, &mut bearing.support_forces);
        }
        bearing
    }

    /// Friction force on each support of the ground in the last solution (N, load axes): opposite to its slip.
    pub fn forces(&self) -> &[Vec2] {
        &self.support_forces
    }

    /// The same in world axes, for a load with this heading (rad).
    pub fn forces_in_world(&self, heading: f64) -> Vec<Vec2> {
        let turn = rotation(heading);
        self.support_forces.iter().map(|force| turn * force).collect()
    }

    /// Whether no support has a slip limit.
    pub fn is_frictionless(&self) -> bool {
        self.cones.is_empty()
    }

    pub fn warm_start(&self) -> &WarmStart {
        &self.last
    }

    /// Goes on as the solver would whose [`FrictionSolver::warm_start`] this is.
    ///
    /// # Errors
    /// When it belongs to other supports.
    pub fn set_warm_start(&mut self, start: WarmStart) -> Result<(), RestoreError> {
        if start.forces.len() != self.cones.len() || start.pin.is_some_and(|k| k >= self.cones.len()) {
            return Err(RestoreError(format!("friction of {} supports, not of {}", start.forces.len(), self.cones.len())));
        }
        self.cones.share_forces(&start.forces, &mut self.support_forces);
        self.last = start;
        Ok(())
    }

    fn search(&mut self, h: &Mat3, w: &Vec3, n_iterations: &mut u32) -> Candidate {
        if self.cones.is_empty() {
            return Candidate { twist: linear_answer(h, w), regime: Regime::Slip };
        }
        if self.cones.len() == 1 {
            return single::solve(&self.cones, h, w, &mut self.last.forces, n_iterations);
        }
        let near = self.last.twist.filter(|_| self.last.slipped);
        if let Some((twist, _)) = near.and_then(|near| gliding::slip(&self.cones, h, w, &near, n_iterations)) {
            self.cones.write_slip_forces(&twist, &mut self.last.forces);
            return Candidate { twist, regime: Regime::Slip };
        }
        let far = self.cones.cluster.map(|_| far_answer(&self.cones, h, w, n_iterations).0);
        if let Some((twist, _)) = far.and_then(|far| gliding::slip(&self.cones, h, w, &far, n_iterations)) {
            self.cones.write_slip_forces(&twist, &mut self.last.forces);
            return Candidate { twist, regime: Regime::Slip };
        }
        if self.cones.stick_forces(w, &mut self.last.forces) {
            return Candidate { twist: Vec3::zeros(), regime: Regime::Stick };
        }
        if let Some(found) = self.pin(h, w) {
            return found;
        }
        let forces = &mut self.last.forces;
        let near = match self.cones.pressed_forces(w, forces) {
            Pressed::Held => return Candidate { twist: Vec3::zeros(), regime: Regime::Stick },
            Pressed::Slips(n) => self.cones.slip_along(&n, h, w).filter(|_| self.cones.cluster.is_none()),
            Pressed::Unsure => None,
        };
        if let Some((twist, _)) = near.and_then(|near| gliding::slip(&self.cones, h, w, &near, n_iterations)) {
            self.cones.write_slip_forces(&twist, forces);
            return Candidate { twist, regime: Regime::Slip };
        }
        let start = near.or(self.last.twist).or(far).unwrap_or_else(|| linear_answer(h, w));
        slipping::slip(&self.cones, h, w, &start, forces, n_iterations)
            .or_else(|| slipping::stick(&self.cones, w, &start, forces, n_iterations))
            .unwrap_or_else(|| smoothed::search(&self.cones, h, w, forces, n_iterations))
    }

    /// Tries the last pin first. With many supports only that one is tried here, since the continuation finds the others at less cost.
    fn pin(&mut self, h: &Mat3, w: &Vec3) -> Option<Candidate> {
        const FEW: usize = 8;
        let others = if self.cones.len() <= FEW { self.cones.len() } else { 0 };
        let order = self.last.pin.into_iter().chain((0..others).filter(|k| Some(*k) != self.last.pin));
        for k in order {
            let found = pinned::about(&self.cones, k, h, w, &mut self.last.forces);
            if found.is_some() {
                return found;
            }
        }
        None
    }

    fn keep(&mut self, candidate: &Candidate) {
        self.last.pin = match candidate.regime {
            Regime::Pinned(k) => Some(k),
            _ => None,
        };
        self.last.slipped = candidate.regime == Regime::Slip;
        if self.last.slipped {
            self.last.twist = Some(candidate.twist);
        }
        self.cones.share_forces(&self.last.forces, &mut self.support_forces);
    }
}

/// A start far from which no answer should be, and how far supports move at it: the one for all limits at one point where the supports are
/// close together, which leaves only their turn about a point among them open, and else the one without friction.
fn far_answer(cones: &Cones, h: &Mat3, w: &Vec3, n_iterations: &mut u32) -> (Vec3, f64) {
    if let Some(extent) = cones.cluster {
        let (found, _) = single::about(&Vec2::zeros(), 1.0, h, w, n_iterations);
        // Even with no moment about that point, as much as friction there can hold may turn it.
        let held = Some(extent / h.m33).filter(|turn| turn.is_finite()).unwrap_or(0.0);
        return (found.twist, found.twist.xy().norm() + extent * (found.twist.z.abs() + held));
    }
    let free = linear_answer(h, w);
    (free, free.xy().norm() + free.z.abs())
}

/// The minimiser without friction, with a ridge of 1e-12 of the largest diagonal entry where H is singular.
fn linear_answer(h: &Mat3, w: &Vec3) -> Vec3 {
    let ridge = 1e-12 * h.diagonal().amax();
    h.cholesky()
        .or_else(|| (h + Mat3::from_diagonal_element(ridge)).cholesky())
        .map(|factor| factor.solve(w))
        .filter(|twist| twist.iter().all(|v| v.is_finite()))
        .unwrap_or(*w)
}
