//! The error that the answer of an exact backend may have, and what makes it doubtful: poses inside
//! an obstacle, steps that had to be cut, and motions that are not unique.

use serde::{Deserialize, Serialize};

/// Bound of the error of a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseError {
    /// Error of the position (m).
    pub position: f64,
    /// Error of the heading (rad).
    pub heading: f64,
}

impl PoseError {
    /// Larger position error and larger heading error of both.
    pub fn max(&self, other: &Self) -> Self {
        Self { position: self.position.max(other.position), heading: self.heading.max(other.heading) }
    }
}

/// Findings of a backend in its own accepted steps that make its answer doubtful.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Doubts {
    /// Largest depth by which the load lay inside an obstacle at the end of an accepted step (m);
    /// zero where it lay inside none by more than rounding.
    #[serde(default)]
    pub overlap_m: f64,
    /// Steps that ended inside an obstacle and were cut at the touch.
    #[serde(default)]
    pub n_gate_cuts: u64,
    /// Steps in which another motion was admissible.
    #[serde(default)]
    pub n_not_unique: u64,
}

impl Doubts {
    /// Whether nothing is doubtful. A depth that is no number is doubtful.
    pub fn is_empty(&self) -> bool {
        // In one comparison: every step of every run is asked.
        (self.overlap_m.to_bits() | self.n_gate_cuts | self.n_not_unique) == 0
    }

    pub fn add(&mut self, other: &Self) {
        self.overlap_m = larger(self.overlap_m, other.overlap_m);
        self.n_gate_cuts += other.n_gate_cuts;
        self.n_not_unique += other.n_not_unique;
    }
}

/// The larger depth (m). A depth that is no number stays, where `f64::max` would drop it.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubts_add_up_and_the_deepest_overlap_stays() {
        let mut doubts = Doubts::default();
        assert!(doubts.is_empty());
        doubts.add(&Doubts { overlap_m: 1e-6, n_gate_cuts: 1, n_not_unique: 0 });
        doubts.add(&Doubts { overlap_m: 1e-9, n_gate_cuts: 2, n_not_unique: 3 });
        assert_eq!(doubts, Doubts { overlap_m: 1e-6, n_gate_cuts: 3, n_not_unique: 3 });
        doubts.add(&Doubts { overlap_m: f64::NAN, ..Doubts::default() });
        doubts.add(&Doubts::default());
        assert!(doubts.overlap_m.is_nan() && !doubts.is_empty());
    }
}
