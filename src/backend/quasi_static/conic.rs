//! The same cone problem posed for clarabel, an interior-point solver: the independent check of the exact one.
//!
//! Variables are the twist x and one bound t_i a support; the objective is `1/2 x'Hx - w'x + sum_i c_i t_i`, and (t_i, B_i x) lies in a
//! second-order cone, whose dual holds the friction forces. Lengths and forces are scaled to order one: in plain SI clarabel calls answers solved that
//! are a third off. Supports stay, so that one solver answers all problems of a run: only H and w are handed over anew.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

use crate::backend::friction::{FrictionSolution, Regime};
use crate::math::{Mat3, Vec2, Vec3};
use crate::model::Ground;
use crate::model::support::slip_velocity;

/// What clarabel answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConicSolution {
    /// Body-twist increment (m, m, rad).
    pub increment: Vec3,
    /// Whether clarabel claims full accuracy by its own measure.
    pub solved: bool,
}

/// Accuracy asked of clarabel in scaled units: about where rounding ends its iterations on problems of this kind. By default it stops at 1e-8 of the
/// objective, which is 1e-4 of the twist.
const TOLERANCE: f64 = 1e-13;
/// What a step may count on of the increment (1): the root of the tolerance, since an objective is flat at its minimum.
pub const ACCURACY: f64 = 1e-6;
/// A force that is less than its limit by this share belongs to a support that sticks (1).
const STICKS: f64 = 1e-6;

/// Clarabel for one set of supports.
pub struct ConicSolver {
    solver: DefaultSolver<f64>,
    ground: Ground,
    /// Unit of length (m) and of force (N).
    length: f64,
    force: f64,
    /// Scaled.
    limits: Vec<f64>,
}

impl ConicSolver {
    /// `length_scale` (m) is the unit of length inside; the unit of force is the sum of the slip limits.
    ///
    /// # Panics
    /// When clarabel refuses the problem's shape, which does not depend on its numbers.
    pub fn new(ground: &Ground, length_scale: f64) -> Self {
        let total: f64 = ground.slip_limits().sum();
        let force = if total > 0.0 { total } else { 1.0 };
        let offsets: Vec<Vec2> = ground.supports.iter().map(|support| support.offset / length_scale).collect();
        let limits: Vec<f64> = ground.slip_limits().map(|limit| limit / force).collect();
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .presolve_enable(false)
            .tol_gap_abs(TOLERANCE)
            .tol_gap_rel(TOLERANCE)
            .tol_feas(TOLERANCE)
            .build()
            .expect("the settings are valid");
        let n = offsets.len();
        let costs: Vec<f64> = [0.0; 3].into_iter().chain(limits.iter().copied()).collect();
        let cones = vec![SupportedConeT::SecondOrderConeT(3); n];
        // The identity has the shape of every H that will come.
        let solver =
            DefaultSolver::new(&quadratic_part(&Mat3::identity(), n), &costs, &cone_rows(&offsets), &vec![0.0; 3 * n], &cones, settings)
                .expect("the problem's shape is consistent");
        Self { solver, ground: ground.clone(), length: length_scale, force, limits }
    }

    /// Minimises `1/2 x'Hx - w'x + sum_i c_i |B_i x|` over body-twist increments x for `hessian` H (N/m, N, N m/rad) and `drive` w (N, N, N m).
    ///
    /// # Panics
    /// When clarabel refuses new numbers in the shape that it has.
    pub fn solve(&mut self, hessian: &Mat3, drive: &Vec3) -> ConicSolution {
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
        ConicSolution { increment, solved: solution.status == SolverStatus::Solved }
    }

    /// Friction resistance of each support in the last solution (N, load axes), along its slip.
    pub fn forces(&self) -> Vec<Vec2> {
        // The dual of (t, B x) is (c, -f).
        self.solver.solution.z.chunks_exact(3).map(|dual| -self.force * Vec2::new(dual[1], dual[2])).collect()
    }

    /// The answer as the exact solver gives it. Supports with forces inside their limits stick; where all do nothing moves, although an interior point is never
    /// quite there. The residual is clarabel's own.
    pub fn friction_solution(&mut self, hessian: &Mat3, drive: &Vec3) -> FrictionSolution {
        let found = self.solve(hessian, drive);
        let forces = self.forces();
        let sticks = |(force, limit): (&Vec2, &f64)| force.norm() < (1.0 - STICKS) * limit * self.force;
        let sticking: Vec<usize> = forces.iter().zip(&self.limits).enumerate().filter_map(|(i, pair)| sticks(pair).then_some(i)).collect();
        let regime = match sticking[..] {
            [] => Regime::Slip,
            [one] if self.limits.len() > 1 => Regime::Pinned(one),
            _ => Regime::Stick,
        };
        let increment = if regime == Regime::Stick { Vec3::zeros() } else { found.increment };
        let solution = &self.solver.solution;
        FrictionSolution { increment, regime, residual: solution.r_prim.max(solution.r_dual), n_iterations: solution.iterations }
    }

    fn units(&self) -> Vec3 {
        Vec3::new(self.length, self.length, 1.0)
    }
}

/// A solver of the same supports: it keeps nothing of the problems that it has solved.
impl Clone for ConicSolver {
    fn clone(&self) -> Self {
        Self::new(&self.ground, self.length)
    }
}

impl std::fmt::Debug for ConicSolver {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("ConicSolver").field("ground", &self.ground).field("length", &self.length).finish_non_exhaustive()
    }
}

/// One problem by a solver of its own: see [`ConicSolver::solve`].
pub fn solve(ground: &Ground, length_scale: f64, hessian: &Mat3, drive: &Vec3) -> ConicSolution {
    ConicSolver::new(ground, length_scale).solve(hessian, drive)
}

/// Entries of the upper triangle, column by column.
fn upper_triangle(h: &Mat3) -> Vec<f64> {
    (0..3).flat_map(|j| (0..=j).map(move |i| (i, j))).map(|at| h[at]).collect()
}

/// The upper triangle of diag(H, 0), with all entries of H, zeros too.
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
