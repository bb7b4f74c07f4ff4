//! Distance of two traces over time.

use cohaul::simulation::{Row, Trace};

/// Difference of two traces at one instant: distance and absolute difference of heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// (s)
    pub time: f64,
    /// (m)
    pub position: f64,
    /// (rad), whole turns counted.
    pub heading: f64,
}

impl Difference {
    /// Edge displacement between the poses of a load of that `radius` (m).
    pub fn edge_displacement(&self, radius: f64) -> f64 {
        self.position + radius * self.heading
    }
}

/// Differences at the times of the rows of `from`, until the shorter trace ends. `to` is
/// interpolated linearly between its rows. Runs with the same control period have coincident rows,
/// which need no interpolation.
pub fn over_time(from: &Trace, to: &Trace) -> Vec<Difference> {
    let mut after = 0;
    let mut differences = Vec::with_capacity(from.rows.len());
    for row in &from.rows {
        while after < to.rows.len() && to.rows[after].time < row.time {
            after += 1;
        }
        let Some(next) = to.rows.get(after) else { break };
        if next.time == row.time {
            differences.push(between(row, next, next, 0.0));
        } else if after > 0 {
            let last = &to.rows[after - 1];
            differences.push(between(row, last, next, (row.time - last.time) / (next.time - last.time)));
        }
    }
    differences
}

/// Difference of `row` from the linear interpolation between `last` (`share` 0) and `next` (1).
fn between(row: &Row, last: &Row, next: &Row, share: f64) -> Difference {
    let (here, there) = (&row.motion.pose, last.motion.pose.towards(&next.motion.pose, share));
    Difference { time: row.time, position: (there.position - here.position).norm(), heading: (there.heading - here.heading).abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use cohaul::math::Pose;

    #[test]
    fn a_trace_has_no_distance_from_itself_and_a_constant_one_from_its_copy_aside() {
        let trace = synthetic::trace(200, 1.0);
        assert!(over_time(&trace, &trace).iter().all(|d| d.position == 0.0 && d.heading == 0.0));
        let mut aside = trace.clone();
        for row in &mut aside.rows {
            let pose = row.motion.pose;
            row.motion.pose = Pose::new(pose.position.x + 3e-3, pose.position.y - 4e-3, pose.heading - 0.5);
        }
        for d in over_time(&trace, &aside) {
            // Rounding of positions of order 0.1 m and headings of order 1.
            assert!((d.position - 5e-3).abs() < 1e-16 && (d.heading - 0.5).abs() < 1e-15, "{d:?}");
        }
    }

    #[test]
    fn times_between_rows_are_interpolated_and_the_shorter_trace_ends_it() {
        let trace = synthetic::trace(101, 1.0);
        let mut coarse = trace.clone();
        // Straight motion, so that interpolation is exact up to rounding.
        let line = |row: &mut Row| row.motion.pose = Pose::new(row.time, -2.0 * row.time, 3.0 * row.time);
        let mut fine = trace.clone();
        fine.rows.iter_mut().for_each(line);
        coarse.rows.iter_mut().for_each(line);
        coarse.rows = coarse.rows.into_iter().step_by(7).collect();
        let differences = over_time(&fine, &coarse);
        assert_eq!(differences.len(), 99, "rows 0 to 98 of 101");
        assert!(differences.iter().all(|d| d.position < 1e-14 && d.heading < 1e-14));
    }
}
