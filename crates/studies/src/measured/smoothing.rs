//! Smooth paths from samples: a piecewise linear path by least squares that gets waypoints until it
//! is within a bound of all samples. It may have more of them than it needs.
//!
//! The positions of a robot that are rounded to 0.1 mm are a staircase. Played as they are, each
//! step of it is a blow. A path by least squares passes between the steps, and the bound says how
//! far it may pass beside a sample.

use cohaul::math::Pose;

/// A path with waypoints at some of the times of its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothed {
    /// Time (s) and pose of each waypoint.
    pub waypoints: Vec<(f64, Pose)>,
    /// Largest edge displacement of the path from a sample (m).
    pub deviation: f64,
}

/// Bound over the rounding of the samples (1): half of the bound is then still twice as large as
/// what rounding can make of a straight path.
const OVER_ROUNDING: f64 = 2.0;
/// Bound over the standard deviation of noise (1). Of a thousand samples of a straight path, one or
/// two deviate by more than three times their standard deviation, which is half of the bound.
const OVER_NOISE: f64 = 6.0;

/// Pauses in a motion from which on its samples count as rounded (1): a robot rests a few times
/// where it turns, and a staircase after each of its steps.
const LEAST_PAUSES: usize = 5;

/// Bound of the deviation that the samples themselves suggest (m): a multiple of their rounding or
/// of their noise. `extent` is the largest distance of the body's outline from its origin (m).
pub fn usual_bound(samples: &[(f64, Pose)], extent: f64) -> f64 {
    (OVER_ROUNDING * rounding(samples, extent)).max(OVER_NOISE * noise(samples, extent))
}

/// Rounding of samples that are a staircase: the smallest step between two of them; else zero (m).
fn rounding(samples: &[(f64, Pose)], extent: f64) -> f64 {
    let steps: Vec<f64> = samples.windows(2).map(|pair| pair[1].1.edge_displacement(&pair[0].1, extent)).collect();
    let moving = &steps[steps.iter().position(|step| *step > 0.0).unwrap_or(steps.len())..];
    let n_pauses = moving.windows(2).filter(|pair| pair[0] == 0.0 && pair[1] > 0.0).count();
    let smallest = moving.iter().copied().filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
    if n_pauses < LEAST_PAUSES { 0.0 } else { smallest }
}

/// Standard deviation of the noise of samples, from their second differences (m).
fn noise(samples: &[(f64, Pose)], extent: f64) -> f64 {
    let second = |three: &[(f64, Pose)]| {
        let [a, b, c] = [0, 1, 2].map(|at| three[at].1);
        let turn = a.heading - 2.0 * b.heading + c.heading;
        (a.position - 2.0 * b.position + c.position).norm_squared() + (extent * turn).powi(2)
    };
    let mut squares: Vec<f64> = samples.windows(3).map(second).collect();
    squares.sort_by(f64::total_cmp);
    // Corners of the path may have made the largest tenth. A second difference of noise has six
    // times its variance.
    squares.truncate(squares.len() - squares.len() / 10);
    if squares.is_empty() { 0.0 } else { (squares.iter().sum::<f64>() / (6.0 * squares.len() as f64)).sqrt() }
}

/// Path of `samples` over increasing times that deviates by at most `bound` (m) from each.
///
/// # Panics
/// Without samples.
pub fn smoothed(samples: &[(f64, Pose)], bound: f64, extent: f64) -> Smoothed {
    let n = samples.len();
    assert!(n > 0, "a path has samples");
    let mut is_knot = vec![false; n];
    (is_knot[0], is_knot[n - 1]) = (true, true);
    loop {
        let knots: Vec<usize> = (0..n).filter(|at| is_knot[*at]).collect();
        let waypoints = least_squares(samples, &knots);
        let deviations: Vec<f64> = deviations(samples, &waypoints, extent);
        let deviation = deviations.iter().copied().fold(0.0, f64::max);
        // With a waypoint at each sample what is left is rounding.
        if deviation <= bound || knots.len() == n {
            return Smoothed { waypoints, deviation };
        }
        for piece in knots.windows(2) {
            let inside = (piece[0] + 1..piece[1]).max_by(|a, b| deviations[*a].total_cmp(&deviations[*b]));
            let worst = (piece[0]..=piece[1]).map(|at| deviations[at]).fold(0.0, f64::max);
            if let Some(at) = inside.filter(|_| worst > bound) {
                is_knot[at] = true;
            }
        }
    }
}

/// Pose on a path at a time (s). Before its first waypoint and after the last one the path rests.
pub fn pose_at(waypoints: &[(f64, Pose)], time: f64) -> Pose {
    let after = waypoints.partition_point(|(at, _)| *at <= time);
    match (after.checked_sub(1).map(|before| waypoints[before]), waypoints.get(after)) {
        (Some((from, a)), Some((to, b))) => a.towards(b, (time - from) / (to - from)),
        (Some((_, last)), None) => last,
        (None, first) => first.expect("a path has waypoints").1,
    }
}

fn deviations(samples: &[(f64, Pose)], waypoints: &[(f64, Pose)], extent: f64) -> Vec<f64> {
    samples.iter().map(|(time, pose)| pose_at(waypoints, *time).edge_displacement(pose, extent)).collect()
}

/// The piecewise linear function with corners at the times of the samples `knots` that has the
/// least sum of squares: the normal equations are tridiagonal, and regular because each knot is a
/// sample.
fn least_squares(samples: &[(f64, Pose)], knots: &[usize]) -> Vec<(f64, Pose)> {
    let (n, time) = (knots.len(), |knot: usize| samples[knots[knot]].0);
    let (mut diagonal, mut beside, mut right) = (vec![0.0; n], vec![0.0; n], vec![[0.0; 3]; n]);
    for (at, (instant, pose)) in samples.iter().enumerate() {
        let right_knot = knots.partition_point(|knot| *knot < at).min(n - 1);
        let left = right_knot.saturating_sub(1);
        let length = time(right_knot) - time(left);
        let share = if length > 0.0 { (instant - time(left)) / length } else { 0.0 };
        diagonal[left] += (1.0 - share).powi(2);
        for (entry, value) in [pose.position.x, pose.position.y, pose.heading].into_iter().enumerate() {
            right[left][entry] += (1.0 - share) * value;
            right[right_knot][entry] += share * value;
        }
        diagonal[right_knot] += share * share;
        beside[left] += share * (1.0 - share);
    }
    for knot in 1..n {
        let factor = beside[knot - 1] / diagonal[knot - 1];
        diagonal[knot] -= factor * beside[knot - 1];
        let before = right[knot - 1];
        right[knot].iter_mut().zip(before).for_each(|(entry, before)| *entry -= factor * before);
    }
    for knot in (0..n).rev() {
        let after = if knot + 1 < n { right[knot + 1].map(|entry| beside[knot] * entry) } else { [0.0; 3] };
        right[knot].iter_mut().zip(after).for_each(|(entry, after)| *entry = (*entry - after) / diagonal[knot]);
    }
    right.into_iter().enumerate().map(|(knot, [x, y, heading])| (time(knot), Pose::new(x, y, heading))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_and_two_are_themselves() {
        let pose = Pose::new(1.0, 2.0, 3.0);
        assert_eq!(smoothed(&[(0.5, pose)], 0.0, 1.0).waypoints, [(0.5, pose)]);
        let two = [(0.5, pose), (1.0, Pose::new(0.0, 0.0, 0.0))];
        assert_eq!(smoothed(&two, 0.0, 1.0).waypoints, two);
    }
}
