//! The same cone problem posed for clarabel, an interior-point solver: the independent check of the exact one.
//!
//! Variables are the twist x and one bound t_i a support; the objective is `1/2 x'Hx - w'x + sum_i c_i t_i`, and (t_i, B_i x) lies in a
//! second-order cone. Lengths and forces are scaled to order one: in plain SI clarabel calls answers solved that are a third off.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

use crate::math::{Mat3, Vec2, Vec3};
use crate::model::Ground;
use crate::model::support::slip_velocity;

/// What clarabel answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConicSolution {
    /// Body-twist increment (m, m, rad).
    pub increment: Vec3,
    /// Whether clarabel claims full accuracy (1e-8 by its own measure).
    pub solved: bool,
}

/// Minimises `1/2 x'Hx - w'x + sum_i c_i |B_i x|` over body-twist increments x for `hessian` H (N/m, N, N m/rad) and `drive` w (N, N, N m) with clarabel.
///
/// `length_scale` (m) is the unit of length inside; the unit of force is the sum of the slip limits.
///
/// # Panics
/// When clarabel refuses the problem's shape, which does not depend on its numbers.
pub fn solve(ground: &Ground, length_scale: f64, hessian: &Mat3, drive: &Vec3) -> ConicSolution {
    let total: f64 = ground.slip_limits().sum();
    let force = if total > 0.0 { total } else { 1.0 };
    let units = Vec3::new(length_scale, length_scale, 1.0);
    let h = Mat3::from_fn(|i, j| hessian[(i, j)] * units[i] * units[j] / (force * length_scale));
    let w = drive.component_mul(&units) / (force * length_scale);
    let offsets: Vec<Vec2> = ground.supports.iter().map(|support| support.offset / length_scale).collect();
    let limits: Vec<f64> = ground.slip_limits().map(|limit| limit / force).collect();

    let settings = DefaultSettingsBuilder::default().verbose(false).build().expect("default settings are valid");
    let n = offsets.len();
    let costs: Vec<f64> = w.iter().map(|v| -v).chain(limits).collect();
    let cones = vec![SupportedConeT::SecondOrderConeT(3); n];
    let mut solver = DefaultSolver::new(&quadratic_part(&h, n), &costs, &cone_rows(&offsets), &vec![0.0; 3 * n], &cones, settings)
        .expect("the problem's shape is consistent");
    solver.solve();
    let x = &solver.solution.x;
    ConicSolution { increment: Vec3::new(x[0], x[1], x[2]).component_mul(&units), solved: solver.solution.status == SolverStatus::Solved }
}

/// The upper triangle of diag(H, 0).
fn quadratic_part(h: &Mat3, n: usize) -> CscMatrix<f64> {
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for j in 0..3 {
        for i in 0..=j {
            rows.push(i);
            columns.push(j);
            values.push(h[(i, j)]);
        }
    }
    CscMatrix::new_from_triplets(3 + n, 3 + n, rows, columns, values)
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
