//! Whether any increment satisfies all gaps.
//!
//! By Farkas' lemma, none does if and only if the rows have a combination with shares r >= 0, not
//! all zero, with `sum r_k n_k = 0` and `sum r_k g_k < 0`. In three dimensions at most four rows
//! take part in the smallest ones, so that all groups of up to four rows are tried.

use smallvec::SmallVec;

use super::linear::across;
use super::problem::Problem;
use super::types::{ContactRow, PerContact};
use crate::math::Vec3;

/// Imbalance of unit rows that is rounding (1).
const ROUNDED: f64 = 1e-12;
/// Overlap over the size of the increment that is rounding (1).
const OVERLAP: f64 = 1e-12;

/// The smallest group of contacts whose gaps no increment satisfies together; empty if there is
/// none.
pub fn conflict(problem: &Problem) -> PerContact<usize> {
    let n = problem.rows.len();
    if problem.rows.iter().all(|row| row.gap >= 0.0) {
        return PerContact::new();
    }
    for size in 1..=4.min(n) {
        let mut group: SmallVec<[usize; 4]> = (0..size).collect();
        loop {
            if conflicts(problem, &group) {
                return group;
            }
            // The next group in lexical order.
            let Some(i) = (0..size).rev().find(|i| group[*i] < n - size + i) else { break };
            group[i] += 1;
            for j in i + 1..size {
                group[j] = group[j - 1] + 1;
            }
        }
    }
    PerContact::new()
}

/// Whether the gaps of exactly these contacts contradict each other: their rows depend on each
/// other by positive shares, with which the gaps add up to an overlap.
fn conflicts(problem: &Problem, group: &[usize]) -> bool {
    let rows: SmallVec<[&ContactRow; 4]> = group.iter().map(|k| &problem.rows[*k]).collect();
    let sizes: SmallVec<[f64; 4]> = rows.iter().map(|row| row.normal.norm()).collect();
    if rows.len() == 1 {
        return sizes[0] == 0.0 && rows[0].gap < 0.0;
    }
    if sizes.contains(&0.0) {
        return false;
    }
    let units: SmallVec<[Vec3; 4]> = rows.iter().zip(&sizes).map(|(row, size)| row.normal / *size).collect();
    let Some(shares) = dependence(&units) else { return false };
    let overlap: f64 = shares.iter().zip(&rows).zip(&sizes).map(|((share, row), size)| share * row.gap / size).sum();
    shares.iter().all(|share| *share > ROUNDED) && overlap < -OVERLAP * problem.extent
}

/// Shares, the last of them one, with which the vectors add up to zero; `None` where they do not,
/// or where already fewer of them do.
fn dependence(units: &[Vec3]) -> Option<SmallVec<[f64; 4]>> {
    let (last, others) = units.split_last()?;
    let mut basis: SmallVec<[Vec3; 3]> = SmallVec::new();
    for unit in others {
        let rest = across(unit, &basis);
        if rest.norm() <= ROUNDED {
            return None;
        }
        basis.push(rest.normalize());
    }
    if across(last, &basis).norm() > ROUNDED {
        return None;
    }
    // Back substitution: the vectors are triangular in the basis.
    let mut shares: SmallVec<[f64; 4]> = SmallVec::from_elem(1.0, units.len());
    for i in (0..others.len()).rev() {
        let known: f64 = last.dot(&basis[i]) + (i + 1..others.len()).map(|j| shares[j] * others[j].dot(&basis[i])).sum::<f64>();
        shares[i] = -known / others[i].dot(&basis[i]);
    }
    Some(shares)
}
