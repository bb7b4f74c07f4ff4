//! Whether any increment satisfies all gaps.
//!
//! By Farkas' lemma, none does if and only if the rows have a combination with shares r >= 0, not
//! all zero, with `sum r_k n_k = 0` and `sum r_k g_k < 0`. In three dimensions at most four rows
//! take part in the smallest ones, so that all groups of up to four rows are tried, unless an
//! increment that satisfies all gaps is found before.

use smallvec::SmallVec;

use super::linear::across;
use super::problem::Problem;
use super::types::{ContactRow, PerContact};
use crate::backend::numerics::{MOST_REFLECTIONS, ROUNDED_OVERLAP, UNIT_IMBALANCE};
use crate::math::Vec3;

/// The smallest group of contacts whose gaps no increment satisfies together; empty if there is
/// none.
pub fn conflict(problem: &Problem) -> PerContact<usize> {
    let n = problem.rows.len();
    if are_met(problem) {
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

/// Whether an increment is found that satisfies all gaps. From none on, it is reflected in the gap
/// that it overlaps most (Motzkin and Schoenberg 1954), which ends where increments near each other
/// satisfy them.
fn are_met(problem: &Problem) -> bool {
    let mut increment = Vec3::zeros();
    for _ in 0..=MOST_REFLECTIONS {
        let depth = |row: &ContactRow| -(row.gap + row.normal.dot(&increment)) / row.normal.norm();
        let deepest = problem.rows.iter().map(|row| (row, depth(row))).max_by(|a, b| a.1.total_cmp(&b.1));
        match deepest {
            // A gap that no increment changes.
            Some((_, depth)) if !depth.is_finite() => return false,
            Some((row, depth)) if depth > 0.0 => increment += 2.0 * depth * row.normal.normalize(),
            _ => return true,
        }
    }
    false
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
    shares.iter().all(|share| *share > UNIT_IMBALANCE) && overlap < -ROUNDED_OVERLAP * problem.extent
}

/// Shares, the last of them one, with which the vectors add up to zero; `None` where they do not,
/// or where already fewer of them do.
fn dependence(units: &[Vec3]) -> Option<SmallVec<[f64; 4]>> {
    let (last, others) = units.split_last()?;
    let mut basis: SmallVec<[Vec3; 3]> = SmallVec::new();
    for unit in others {
        let rest = across(unit, &basis);
        if rest.norm() <= UNIT_IMBALANCE {
            return None;
        }
        basis.push(rest.normalize());
    }
    if across(last, &basis).norm() > UNIT_IMBALANCE {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::contact::solve::ContactSystem;
    use crate::backend::friction::FrictionSolver;
    use crate::math::Mat3;
    use crate::model::Ground;

    /// Gaps that no increment changes contradict others only by themselves.
    #[test]
    fn a_gap_that_nothing_changes_is_told_from_a_squeeze() {
        let solver = FrictionSolver::new(&Ground { friction_coefficient: 0.0, supports: Vec::new() }, 1.0);
        let row = |normal: f64, gap: f64| ContactRow {
            normal: Vec3::new(normal, 0.0, 0.0),
            tangent: Vec3::new(0.0, normal, 0.0),
            gap,
            slip: 0.0,
            friction_coefficient: 0.0,
        };
        let of = |rows: &[ContactRow]| {
            let system = ContactSystem { hessian: &Mat3::identity(), drive: &Vec3::zeros(), rows };
            conflict(&Problem::new(solver.cones(), &system, None)).to_vec()
        };
        assert_eq!(of(&[row(0.0, 0.0), row(1.0, -1.0), row(-1.0, -1.0)]), [1, 2]);
        assert_eq!(of(&[row(1.0, -1.0), row(0.0, -1.0)]), [1]);
        assert!(of(&[row(0.0, 0.0), row(1.0, -1.0), row(-1.0, 1.5)]).is_empty());
    }
}
