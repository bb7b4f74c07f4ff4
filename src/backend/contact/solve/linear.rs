//! Small dense linear systems.

use smallvec::SmallVec;

use crate::backend::numerics::DEPENDENT_ROW;
use crate::math::{Mat3, Vec3};

/// Unknowns at most: a twist and three forces.
pub const MOST: usize = 6;

/// A system with its right-hand side in the column after the last unknown.
pub struct System {
    entries: [[f64; MOST + 1]; MOST],
    n: usize,
}

impl System {
    /// The system of a load and of up to three constraints: the Hessian, with the derivative of
    /// each constraint below and the direction of its force, with the sign changed, beside. The
    /// right side is zero.
    pub fn bordered(hessian: &Mat3, rows: impl ExactSizeIterator<Item = (Vec3, Vec3)>) -> Self {
        let (mut entries, n) = ([[0.0; MOST + 1]; MOST], 3 + rows.len());
        for i in 0..3 {
            (0..3).for_each(|j| entries[i][j] = hessian[(i, j)]);
        }
        for (k, (row, direction)) in rows.enumerate() {
            for i in 0..3 {
                entries[i][3 + k] = -direction[i];
                entries[3 + k][i] = row[i];
            }
        }
        Self { entries, n }
    }

    pub fn set_right(&mut self, i: usize, value: f64) {
        self.entries[i][self.n] = value;
    }

    /// Divides each row by its largest entry. Pivots need it unless the units make entries alike.
    pub fn scale(&mut self) {
        let n = self.n;
        for row in &mut self.entries[..n] {
            let size = row[..n].iter().fold(0.0f64, |size, v| size.max(v.abs()));
            if size > 0.0 {
                row[..=n].iter_mut().for_each(|v| *v /= size);
            }
        }
    }

    /// Solution by elimination with partial pivoting, in place; `None` where it is not finite.
    pub fn solve(&mut self) -> Option<[f64; MOST]> {
        let n = self.n;
        self.eliminate();
        let mut x = [0.0; MOST];
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|j| self.entries[i][j] * x[j]).sum();
            x[i] = (self.entries[i][n] - known) / self.entries[i][i];
        }
        x[..n].iter().all(|v| v.is_finite()).then_some(x)
    }

    /// Sign of the determinant.
    pub fn sign(&mut self) -> f64 {
        let sign = self.eliminate();
        (0..self.n).map(|i| self.entries[i][i]).fold(sign, |sign, pivot| if pivot == 0.0 { 0.0 } else { sign * pivot.signum() })
    }

    /// Makes the matrix upper triangular; returns the sign of the exchanges of rows.
    fn eliminate(&mut self) -> f64 {
        let (n, mut sign) = (self.n, 1.0);
        for j in 0..n {
            let larger = |a: usize, b: usize| if self.entries[b][j].abs() > self.entries[a][j].abs() { b } else { a };
            let pivot = (j..n).fold(j, larger);
            if pivot != j {
                self.entries.swap(j, pivot);
                sign = -sign;
            }
            let leading = self.entries[j];
            if leading[j] == 0.0 {
                continue;
            }
            for i in j + 1..n {
                let share = self.entries[i][j] / leading[j];
                for (entry, above) in self.entries[i][j..=n].iter_mut().zip(&leading[j..=n]) {
                    *entry -= share * above;
                }
            }
        }
        sign
    }
}

/// Up to three orthonormal rows, which span those that were taken.
#[derive(Default)]
pub struct Basis(SmallVec<[Vec3; 3]>);

impl Basis {
    /// Takes a row unless it depends on those before; returns whether it did.
    pub fn takes(&mut self, row: &Vec3) -> bool {
        let rest = across(row, &self.0);
        let is_independent = self.0.len() < 3 && rest.norm() > DEPENDENT_ROW * row.norm();
        if is_independent {
            self.0.push(rest.normalize());
        }
        is_independent
    }
}

/// Part of a row across all of these orthonormal ones.
pub fn across(row: &Vec3, basis: &[Vec3]) -> Vec3 {
    let mut rest = *row;
    // Twice, because once leaves roundings of what was taken off.
    for _ in 0..2 {
        for unit in basis {
            rest -= unit.dot(&rest) * unit;
        }
    }
    rest
}

#[cfg(test)]
mod tests {
    use nalgebra::{SMatrix, SVector};

    use super::*;

    /// A system in which pivots have to be exchanged, against nalgebra's elimination and
    /// determinant; its entries are of the size 1, so that 1e-14 is rounding.
    #[test]
    fn a_bordered_system_is_solved_as_by_nalgebra() {
        let hessian = Mat3::new(0.0, 0.3, 0.1, 0.3, 2.0, -0.4, 0.1, -0.4, 1.0);
        let rows = [(Vec3::new(0.0, 1.0, 0.5), Vec3::new(0.3, 1.0, 0.4)), (Vec3::new(1.0, 0.0, -0.2), Vec3::new(1.0, 0.0, -0.2))];
        let right = SVector::<f64, 5>::new(0.7, -0.2, 0.4, 0.1, -0.3);
        let mut matrix = SMatrix::<f64, 5, 5>::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&hessian);
        for (k, (row, direction)) in rows.iter().enumerate() {
            matrix.fixed_view_mut::<1, 3>(3 + k, 0).copy_from(&row.transpose());
            matrix.fixed_view_mut::<3, 1>(0, 3 + k).copy_from(&-direction);
        }
        let known = matrix.lu().solve(&right).unwrap();
        let system = || {
            let mut system = System::bordered(&hessian, rows.into_iter());
            (0..5).for_each(|i| system.set_right(i, right[i]));
            system
        };
        let mut scaled = system();
        scaled.scale();
        for mut system in [system(), scaled] {
            let x = system.solve().unwrap();
            assert!((0..5).all(|i| (x[i] - known[i]).abs() < 1e-14), "{x:?} {known}");
        }
        assert_eq!(system().sign(), matrix.determinant().signum());
    }

    /// A constraint that is there twice leaves its forces open.
    #[test]
    fn a_singular_system_has_no_solution() {
        let rows = [(Vec3::x(), Vec3::x()); 2];
        let mut system = System::bordered(&Mat3::identity(), rows.into_iter());
        (0..5).for_each(|i| system.set_right(i, 1.0));
        assert!(system.solve().is_none());
        assert_eq!(System::bordered(&Mat3::identity(), rows.into_iter()).sign(), 0.0);
    }
}
