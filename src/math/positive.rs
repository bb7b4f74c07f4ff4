//! Symmetric positive definite systems in three unknowns, without a square root.

use super::{Mat3, Vec3};

/// The factors A = L D L' of a matrix, with ones on the diagonal of L. Only the lower half of A is
/// read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositiveDefinite {
    pivots: Vec3,
    /// Entries (2, 1), (3, 1) and (3, 2) of L.
    lower: Vec3,
}

impl PositiveDefinite {
    /// Factors of `a`; `None` where a pivot is not positive.
    pub fn new(a: &Mat3) -> Option<Self> {
        let first = a.m11;
        let (l21, l31) = (a.m21 / first, a.m31 / first);
        let second = a.m22 - l21 * a.m21;
        let l32 = (a.m32 - l21 * a.m31) / second;
        let third = a.m33 - l31 * a.m31 - l32 * l32 * second;
        let is_positive = first > 0.0 && second > 0.0 && third > 0.0;
        is_positive.then_some(Self { pivots: Vec3::new(first, second, third), lower: Vec3::new(l21, l31, l32) })
    }

    /// A^-1 b.
    pub fn solve(&self, b: &Vec3) -> Vec3 {
        let (l21, l31, l32) = (self.lower.x, self.lower.y, self.lower.z);
        let y = b.y - l21 * b.x;
        let z = (b.z - l31 * b.x - l32 * y) / self.pivots.z;
        let y = y / self.pivots.y - l32 * z;
        Vec3::new(b.x / self.pivots.x - l21 * y - l31 * z, y, z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_what_is_positive_definite_and_nothing_else() {
        let a = Mat3::new(4.0, 1.0, -2.0, 1.0, 3.0, 0.5, -2.0, 0.5, 5.0);
        let x = Vec3::new(0.3, -1.7, 2.2);
        // Rounding of sums of order ten times a condition number of three.
        assert!((PositiveDefinite::new(&a).unwrap().solve(&(a * x)) - x).amax() < 1e-14);
        let determinant = PositiveDefinite::new(&a).unwrap().pivots.product();
        assert!((determinant - a.determinant()).abs() < 1e-13);
        // Raising one off-diagonal entry to just below and above sqrt(4 * 3), with the third
        // unknown apart, decides definiteness.
        let pair = |b: f64| Mat3::new(4.0, b, 0.0, b, 3.0, 0.0, 0.0, 0.0, 1.0);
        assert!(PositiveDefinite::new(&pair(12f64.sqrt() - 1e-12)).is_some());
        assert!(PositiveDefinite::new(&pair(12f64.sqrt() + 1e-12)).is_none());
        assert!(PositiveDefinite::new(&Mat3::zeros()).is_none());
    }
}
