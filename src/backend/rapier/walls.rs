//! Which contacts with straight walls matter.
//!
//! Contacts with the same normal are points of one straight wall. Over the lever arm of the normal
//! force, their gaps after an increment change by the same straight line. A contact on or above the
//! line through the gaps of two others therefore closes with these, and they can bear whatever it
//! would bear: flush blocks and points on one line are one wall. What is left is the lower convex
//! hull of the gaps, by the monotone chain of Andrew (1979).

use crate::backend::contact::ContactRow;
use crate::backend::numerics::PARALLEL_NORMALS;

/// Contacts without which no other one loses its meaning, in their order. Gaps, slips and lever
/// arms are known up to `rounding` (m).
pub fn that_matter(rows: &[ContactRow], rounding: f64) -> Vec<usize> {
    let mut walls: Vec<Vec<usize>> = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        match walls.iter_mut().find(|wall| are_one_wall(&rows[wall[0]], row, rounding)) {
            Some(wall) => wall.push(k),
            None => walls.push(vec![k]),
        }
    }
    let mut kept: Vec<usize> = walls.into_iter().flat_map(|wall| lower_hull(rows, wall, rounding)).collect();
    kept.sort_unstable();
    kept
}

fn are_one_wall(a: &ContactRow, b: &ContactRow, rounding: f64) -> bool {
    a.friction_coefficient == b.friction_coefficient
        && (a.normal.xy() - b.normal.xy()).amax() <= PARALLEL_NORMALS
        && (a.slip - b.slip).abs() <= rounding
}

fn lower_hull(rows: &[ContactRow], mut wall: Vec<usize>, rounding: f64) -> Vec<usize> {
    let point = |k: usize| (rows[k].normal.z, rows[k].gap);
    wall.sort_by(|a, b| point(*a).0.total_cmp(&point(*b).0));
    let mut hull: Vec<usize> = Vec::new();
    for k in wall {
        let (arm, gap) = point(k);
        // Of contacts at the same point, the closest one stays.
        if let Some(last) = hull.last().copied().filter(|last| arm - point(*last).0 <= rounding) {
            if gap >= point(last).1 {
                continue;
            }
            hull.pop();
        }
        while let [.., first, middle] = hull[..] {
            let ((from, low), (at, between)) = (point(first), point(middle));
            let line = low + (gap - low) * (at - from) / (arm - from);
            if between < line - rounding {
                break;
            }
            hull.pop();
        }
        hull.push(k);
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    fn kept(points: &[(f64, f64)]) -> Vec<usize> {
        let row = |(arm, gap): &(f64, f64)| ContactRow {
            normal: Vec3::new(0.0, 1.0, *arm),
            tangent: Vec3::new(-1.0, 0.0, 0.0),
            gap: *gap,
            slip: 0.0,
            friction_coefficient: 0.2,
        };
        // Far more than the rounding of the sums, and far less than the gaps.
        that_matter(&points.iter().map(row).collect::<Vec<_>>(), 1e-12)
    }

    /// Points on one line are a wall with two ends; a point below the line stays.
    #[test]
    fn points_between_others_do_not_matter() {
        assert_eq!(kept(&[(-1.0, 0.0), (0.3, 0.0), (1.0, 0.0), (0.3, 0.0)]), [0, 2]);
        assert_eq!(kept(&[(1.0, 2e-3), (0.0, 1e-3 + 1e-13), (-1.0, 0.0)]), [0, 2]);
        assert_eq!(kept(&[(1.0, 2e-3), (0.0, 1e-3 - 1e-6), (-1.0, 0.0)]), [0, 1, 2]);
        assert_eq!(kept(&[(0.5, 1e-3), (0.5, 0.0)]), [1]);
    }

    #[test]
    fn walls_with_other_friction_are_others() {
        let row = |friction_coefficient: f64, arm: f64| ContactRow {
            normal: Vec3::new(0.0, 1.0, arm),
            tangent: Vec3::new(-1.0, 0.0, 0.0),
            gap: 0.0,
            slip: 0.0,
            friction_coefficient,
        };
        assert_eq!(that_matter(&[row(0.2, -1.0), row(0.3, 0.0), row(0.2, 1.0)], 1e-12), [0, 1, 2]);
    }
}
