//! The friction problem posed for clarabel, an interior-point solver: an independent check of the
//! exact methods.
//!
//! Variables are the twist x and one bound t_i per support. The objective is `1/2 x'Hx - w'x +
//! sum_i c_i t_i`, and (t_i, B_i x) lies in a second-order cone, whose dual holds the friction
//! forces. Lengths and forces are scaled to order one: in SI units clarabel reports answers as
//! solved that are wrong by a third. The supports do not change, so that one solver answers all
//! problems of a run: only H and w are handed over anew.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

use super::problem::{ContactMode, FrictionSolution};
use crate::backend::numerics::{CLARABEL_STICKS, CLARABEL_TOLERANCE};
use crate::math::{Mat3, Vec2, Vec3};
use crate::model::Ground;
use crate::model::support::slip_velocity;

/// Answer of clarabel to one friction problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClarabelSolution {
    /// Body-twist increment (m, m, rad).
    pub increment: Vec3,
    /// Whether clarabel claims full accuracy by its own measure.
    pub solved: bool,
}

/// Clarabel set up for one set of supports.
pub struct ClarabelSolver {
    solver: DefaultSolver<f64>,
    ground: Ground,
    /// Unit of length (m).
    length: f64,
    /// Unit of force (N).
    force: f64,
    /// Slip limits of the supports (scaled).
    limits: Vec<f64>,
}

impl ClarabelSolver {
    /// Solver for the supports of `ground`, with `length_scale` as unit of length (m) and the sum
    /// of the slip limits as unit of force.
    ///
    /// # Panics
    /// When clarabel refuses the problem's shape, which does not depend on its numbers.
    pub fn new(ground: &Ground, length_scale: f64) -> Self {
        let total: f64 = ground.slip_limits().sum();
        let force = if total > 0.0 { total } else { 1.0 };
        let offsets: Vec<Vec2> = ground.supports.iter().map(|support| support.offset / length_scale).collect();
        let limits: Vec<f64> = ground.slip_limits().map(|limit| limit / force).collect();
        let n = offsets.len();
        let costs: Vec<f64> = [0.0; 3].into_iter().chain(limits.iter().copied()).collect();
        let cones = vec![SupportedConeT::SecondOrderConeT(3); n];
        // The identity has the shape of every H that will come.
        let solver =
            DefaultSolver::new(&quadratic_part(&Mat3::identity(), n), &costs, &cone_rows(&offsets), &vec![0.0; 3 * n], &cones, settings())
                .expect("the problem's shape is consistent");
        Self { solver, ground: ground.clone(), length: length_scale, force, limits }
    }

    /// Minimises `1/2 x'Hx - w'x + sum_i c_i |B_i x|` over body-twist increments x for `hessian` H
    /// (N/m, N, N m/rad) and `drive` w (N, N, N m).
    ///
    /// # Panics
    /// When clarabel refuses new numbers for the same shape of problem.
    pub fn solve(&mut self, hessian: &Mat3, drive: &Vec3) -> ClarabelSolution {
        let units = self.units();
        let energy = self.force * self.length;
        let h = Mat3::from_fn(|i, j| hessian[(i, j)] * units[i] * units[j] / energy);
        let w = drive.component_mul(&units) / energy;
        let costs: Vec<f64> = w.iter().map(|v| -v).chain(self.limits.iter().copied()).collect();
        self.solver.update_P(&upper_triangle(&h)).expect("H keeps its shape");
        self.solver.update_q(&costs).expect("w keeps its shape");
        self.solver.solve();
        let solution = &self.solver.solution;
        let increment = Vec3::from_fn(|i, _| solution.x[i]).component_mul(&units);
        ClarabelSolution { increment, solved: solution.status == SolverStatus::Solved }
    }

    /// Friction resistance of each support in the last solution (N, load axes), along its slip.
    pub fn forces(&self) -> Vec<Vec2> {
        // The dual of (t, B x) is (c, -f).
        self.solver.solution.z.chunks_exact(3).map(|dual| -self.force * Vec2::new(dual[1], dual[2])).collect()
    }

    /// Answer in the form of the exact methods. Supports with forces inside their limits stick.
    /// Where more than one does, nothing moves, although an interior point never quite reaches
    /// rest. The residual is clarabel's own.
    pub fn friction_solution(&mut self, hessian: &Mat3, drive: &Vec3) -> FrictionSolution {
        let found = self.solve(hessian, drive);
        let forces = self.forces();
        let sticks = |(force, limit): (&Vec2, &f64)| force.norm() < (1.0 - CLARABEL_STICKS) * limit * self.force;
        let sticking: Vec<usize> = forces.iter().zip(&self.limits).enumerate().filter_map(|(i, pair)| sticks(pair).then_some(i)).collect();
        let mode = match sticking[..] {
            [] => ContactMode::Slip,
            [one] if self.limits.len() > 1 => ContactMode::Pinned(one),
            _ => ContactMode::Stick,
        };
        let increment = if mode == ContactMode::Stick { Vec3::zeros() } else { found.increment };
        let solution = &self.solver.solution;
        FrictionSolution { increment, mode, residual: solution.r_prim.max(solution.r_dual), n_iterations: solution.iterations }
    }

    fn units(&self) -> Vec3 {
        Vec3::new(self.length, self.length, 1.0)
    }
}

fn settings() -> DefaultSettings<f64> {
    DefaultSettingsBuilder::default()
        .verbose(false)
        .presolve_enable(false)
        .tol_gap_abs(CLARABEL_TOLERANCE)
        .tol_gap_rel(CLARABEL_TOLERANCE)
        .tol_feas(CLARABEL_TOLERANCE)
        .build()
        .expect("the settings are valid")
}

/// The copy has the same supports, and nothing of the problems that were solved.
impl Clone for ClarabelSolver {
    fn clone(&self) -> Self {
        Self::new(&self.ground, self.length)
    }
}

impl std::fmt::Debug for ClarabelSolver {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("ClarabelSolver").field("ground", &self.ground).field("length", &self.length).finish_non_exhaustive()
    }
}

/// Entries of the upper triangle, column by column.
fn upper_triangle(h: &Mat3) -> Vec<f64> {
    (0..3).flat_map(|j| (0..=j).map(move |i| (i, j))).map(|at| h[at]).collect()
}

/// The upper triangle of diag(H, 0), with all entries of H, also those that are zero.
fn quadratic_part(h: &Mat3, n: usize) -> CscMatrix<f64> {
    let column_starts: Vec<usize> = [0, 1, 3].into_iter().chain(std::iter::repeat_n(6, n + 1)).collect();
    CscMatrix::new(3 + n, 3 + n, column_starts, vec![0, 0, 1, 0, 1, 2], upper_triangle(h))
}

/// A with -A (x, t) = (t_i, B_i x) for each support in turn.
fn cone_rows(offsets: &[Vec2]) -> CscMatrix<f64> {
    let n = offsets.len();
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut put = |row, column, value: f64| {
        rows.push(row);
        columns.push(column);
        values.push(-value);
    };
    for (i, offset) in offsets.iter().enumerate() {
        put(3 * i, 3 + i, 1.0);
        for column in 0..3 {
            let slip = slip_velocity(offset, &Vec3::ith(column, 1.0));
            put(3 * i + 1, column, slip.x);
            put(3 * i + 2, column, slip.y);
        }
    }
    CscMatrix::new_from_triplets(3 * n, 3 + n, rows, columns, values)
}
