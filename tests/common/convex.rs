//! A linear step with contacts and without side friction as a convex problem of clarabel's.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use cohaul::backend::contact::ContactRow;
use cohaul::math::{Mat3, Vec3};
use cohaul::model::Ground;

/// Tolerance in scaled units (1): about where rounding ends the iterations.
const TOLERANCE: f64 = 1e-13;

/// Minimum of `1/2 x'Hx - w'x + sum_i c_i |B_i x|` over body-twist increments x (m, m, rad) that
/// overlap with no side contact, `gap + normal x >= 0`, and whether clarabel claims full accuracy.
///
/// `length` is the unit of length (m), and the largest of the slip limits and of the `drive` w that
/// of force: in SI units clarabel reports answers as solved that are wrong.
pub fn step_with_contacts(ground: &Ground, length: f64, hessian: &Mat3, drive: &Vec3, rows: &[ContactRow]) -> (Vec3, bool) {
    let units = Vec3::new(length, length, 1.0);
    let force = drive.component_mul(&units).amax() / length + ground.slip_limits().sum::<f64>();
    let energy = length * if force > 0.0 { force } else { 1.0 };
    let n = ground.supports.len();
    // Variables are x and one bound t_i of the slip of each support.
    let mut quadratic = Vec::new();
    for (i, j) in (0..3).flat_map(|j| (0..=j).map(move |i| (i, j))) {
        quadratic.push((i, j, hessian[(i, j)] * units[i] * units[j] / energy));
    }
    let costs = drive
        .component_mul(&units)
        .iter()
        .map(|w| -w / energy)
        .chain(ground.slip_limits().map(|c| c * length / energy))
        .collect::<Vec<_>>();
    // The cones hold b - A (x, t): (t_i, B_i x) for each support, then gap + normal x.
    let mut constraints = Vec::new();
    for (i, support) in ground.supports.iter().enumerate() {
        let arm = support.offset / length;
        constraints.extend([
            (3 * i, 3 + i, -1.0),
            (3 * i + 1, 0, -1.0),
            (3 * i + 1, 2, arm.y),
            (3 * i + 2, 1, -1.0),
            (3 * i + 2, 2, -arm.x),
        ]);
    }
    for (k, row) in rows.iter().enumerate() {
        constraints.extend((0..3).map(|column| (3 * n + k, column, -row.normal[column] * units[column] / length)));
    }
    let bounds: Vec<f64> = std::iter::repeat_n(0.0, 3 * n).chain(rows.iter().map(|row| row.gap / length)).collect();
    let mut cones = vec![SupportedConeT::SecondOrderConeT(3); n];
    cones.push(SupportedConeT::NonnegativeConeT(rows.len()));
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .presolve_enable(false)
        .tol_gap_abs(TOLERANCE)
        .tol_gap_rel(TOLERANCE)
        .tol_feas(TOLERANCE)
        .build()
        .unwrap();
    let (p, a) = (sparse(3 + n, 3 + n, &quadratic), sparse(bounds.len(), 3 + n, &constraints));
    let mut solver = DefaultSolver::new(&p, &costs, &a, &bounds, &cones, settings).unwrap();
    solver.solve();
    (Vec3::from_fn(|i, _| solver.solution.x[i] * units[i]), solver.solution.status == SolverStatus::Solved)
}

fn sparse(n_rows: usize, n_columns: usize, entries: &[(usize, usize, f64)]) -> CscMatrix<f64> {
    let rows = entries.iter().map(|entry| entry.0).collect();
    let columns = entries.iter().map(|entry| entry.1).collect();
    CscMatrix::new_from_triplets(n_rows, n_columns, rows, columns, entries.iter().map(|entry| entry.2).collect())
}
