//! Equations of a step in given contact modes: three of balance and up to three of contact. Further
//! ones of contact depend on those; their forces are held.

use smallvec::SmallVec;

use super::solve::{MOST, System};
use crate::backend::increment::positive_definite;
use crate::math::{Mat3, PositiveDefinite, Vec3};

/// Linear equations for the change of an increment and of contact forces, in scaled units.
pub struct Linear {
    length: f64,
    force: f64,
    displacement: f64,
    gradient: Vec3,
    hessian: Mat3,
    /// Derivative of each constraint, direction of its force, and its violation (m).
    rows: SmallVec<[(Vec3, Vec3, f64); 3]>,
    /// Constraints whose forces are held.
    held: Rows,
    /// The same, with the next constraint that is added as the first one.
    held_from_next: Rows,
    /// Largest violation of those that are held (m).
    violation_of_held: f64,
}

/// Constraints by their numbers, as bits.
pub type Rows = u32;

impl Linear {
    /// For a load of this `length` (m).
    pub fn new(length: f64) -> Self {
        let (gradient, hessian) = (Vec3::zeros(), Mat3::zeros());
        Self {
            length,
            force: 1.0,
            displacement: 1.0,
            gradient,
            hessian,
            rows: SmallVec::new(),
            held: 0,
            held_from_next: 0,
            violation_of_held: 0.0,
        }
    }

    /// Leaves out all constraints, for a load under forces of the size `force` (N) that moves by
    /// about `displacement` (m).
    pub fn begin(&mut self, force: f64, displacement: f64) {
        (self.force, self.displacement) = (force, displacement);
        self.rows.clear();
        (self.held_from_next, self.violation_of_held) = (self.held, 0.0);
    }

    /// Holds the forces of these constraints, which hold only if the others see to it.
    pub fn hold(&mut self, rows: Rows) {
        self.held = rows;
    }

    /// Whether the forces of any constraints are held.
    pub fn holds_any(&self) -> bool {
        self.held != 0
    }

    /// Adds a constraint with the derivative `row` (1, 1, m), a force along `along`, and the
    /// violation (m).
    pub fn push(&mut self, row: Vec3, along: Vec3, violation: f64) {
        if self.held_from_next & 1 == 0 {
            self.rows.push((row, along, violation));
        } else {
            self.violation_of_held = self.violation_of_held.max(violation.abs());
        }
        self.held_from_next >>= 1;
    }

    /// Sets the forces out of balance (N, N, N m) and their derivative.
    pub fn set_balance(&mut self, gradient: Vec3, hessian: Mat3) {
        (self.gradient, self.hessian) = (gradient, hessian);
    }

    /// Largest violation over the scales (1).
    pub fn residual(&self) -> f64 {
        let torque = self.gradient.z / self.length;
        let balance = (self.gradient.xy().amax().max(torque.abs()) / self.force).max(self.violation_of_held / self.displacement);
        self.rows.iter().map(|(_, _, violation)| violation.abs() / self.displacement).fold(balance, f64::max)
    }

    /// Change of the increment (m, m, rad), then of the force of each constraint (N), which is zero
    /// where it is held. `None` where there is none.
    pub fn solve(&self) -> Option<SmallVec<[f64; MOST]>> {
        let n = 3 + self.rows.len();
        let units = Vec3::new(1.0, 1.0, 1.0 / self.length);
        let stiffness = self.force / self.length;
        let hessian = Mat3::from_fn(|i, j| self.hessian[(i, j)] * units[i] * units[j] / stiffness);
        let scaled = |row: &Vec3| row.component_mul(&units);
        let mut system = System::bordered(&hessian, self.rows.iter().map(|(row, along, _)| (scaled(row), scaled(along))));
        (0..3).for_each(|i| system.set_right(i, -self.gradient[i] * units[i] / self.force));
        for (k, (.., violation)) in self.rows.iter().enumerate() {
            system.set_right(3 + k, -violation / self.length);
        }
        // Not scaled: in these units the entries are alike.
        let x = system.solve()?;
        let scale = |i: usize| if i < 3 { self.length * units[i] } else { self.force };
        let mut change: SmallVec<[f64; MOST]> = (0..n).map(|i| x[i] * scale(i)).collect();
        if self.holds_any() {
            (0..Rows::BITS as usize).filter(|row| self.held >> row & 1 == 1).for_each(|row| change.insert(3 + row, 0.0));
        }
        Some(change)
    }

    /// Whether the branch is stable: all principal minors of N C A' are positive, with C the
    /// inverse of the Hessian, N the constraints and A the directions of their forces.
    ///
    /// The Hessian need not be positive definite: a pushed load without springs resists no motion
    /// along its slip, and its contact may turn with it. It then has to be where the constraints
    /// let the load move, and is made so elsewhere.
    pub fn is_stable(&self) -> bool {
        if self.rows.is_empty() {
            return true;
        }
        let units = Vec3::new(self.length, self.length, 1.0);
        let mut hessian = Mat3::from_fn(|i, j| self.hessian[(i, j)] * units[i] * units[j]);
        // More than what rounding leaves of a stiffness that cancels.
        let least = 1e-9 * hessian.amax();
        (0..3).for_each(|i| hessian[(i, i)] += least);
        let scaled = |row: &Vec3| row.component_mul(&units);
        let definite = PositiveDefinite::new(&hessian).or_else(|| {
            let rows: SmallVec<[[Vec3; 2]; 3]> = self.rows.iter().map(|(row, along, _)| [scaled(row), scaled(along)]).collect();
            resists(&hessian, &rows).then(|| PositiveDefinite::new(&positive_definite(&hessian, 1.0)))?
        });
        let Some(definite) = definite else { return false };
        let n = self.rows.len();
        let mut w = [[0.0; 3]; 3];
        for (entries, (row, ..)) in w.iter_mut().zip(&self.rows) {
            for (entry, (_, along, ..)) in entries.iter_mut().zip(&self.rows) {
                *entry = scaled(row).dot(&definite.solve(&scaled(along)));
            }
        }
        let pair = |i: usize, j: usize| w[i][i] * w[j][j] - w[i][j] * w[j][i];
        let single = (0..n).all(|i| w[i][i] > 0.0);
        let double = (0..n).all(|i| (0..i).all(|j| pair(i, j) > 0.0));
        let whole = n < 3
            || w[0][0] * pair(1, 2) - w[0][1] * (w[1][0] * w[2][2] - w[1][2] * w[2][0]) + w[0][2] * (w[1][0] * w[2][1] - w[1][1] * w[2][0])
                > 0.0;
        single && double && whole
    }
}

/// Whether the Hessian is positive definite for motions that these constraints allow, each with the
/// direction of its force: its part there, along the forces, has a positive determinant and, for a
/// single constraint, a positive trace.
fn resists(hessian: &Mat3, rows: &[[Vec3; 2]]) -> bool {
    let mut bordered = System::bordered(hessian, rows.iter().map(|[row, along]| (*row, *along)));
    bordered.scale();
    let trace = || rows.iter().all(|[row, along]| hessian.trace() * row.dot(along) > row.dot(&(hessian * along)));
    bordered.sign() > 0.0 && (rows.len() > 1 || rows.iter().all(|[row, along]| row.dot(along) > 0.0) && trace())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A contact holds the load against a negative stiffness along its normal, and against none
    /// that is negative along the contact: neither one of the shift nor one of both motions there,
    /// whose product is positive. Two contacts leave one motion.
    #[test]
    fn a_contact_holds_what_it_does_not_let_move() {
        let is_stable = |stiffness: [f64; 3], rows: &[Vec3]| {
            let mut system = Linear::new(1.0);
            rows.iter().for_each(|row| system.push(*row, *row, 0.0));
            system.set_balance(Vec3::zeros(), Mat3::from_diagonal(&stiffness.into()));
            system.is_stable()
        };
        let [x, y] = [Vec3::x(), Vec3::y()];
        assert!(is_stable([1.0, 1.0, 1.0], &[x]) && is_stable([-1.0, 1.0, 1.0], &[x]));
        assert!(!is_stable([1.0, -1.0, 1.0], &[x]) && !is_stable([1.0, -1.0, -1.0], &[x]) && !is_stable([-1.0, -1.0, -1.0], &[x]));
        assert!(is_stable([-1.0, -1.0, 1.0], &[x, y]) && !is_stable([1.0, 1.0, -1.0], &[x, y]));
    }
}
