//! Smooth paths from samples: piecewise linear, by least squares, within a bound of all samples.
//! No waypoint can be left out of it, and none is better a sample earlier or later.
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
    let fit = |knots: Vec<usize>| Fit::new(samples, knots, extent);
    settled(pruned(close(samples.len(), bound, &fit), bound, &fit), bound, &fit).path
}

/// A path by least squares with corners at some samples.
struct Fit {
    knots: Vec<usize>,
    path: Smoothed,
    /// Edge displacement of the path from each sample (m).
    deviations: Vec<f64>,
}

impl Fit {
    fn new(samples: &[(f64, Pose)], knots: Vec<usize>, extent: f64) -> Self {
        let waypoints = least_squares(samples, &knots);
        let deviations: Vec<f64> = deviations(samples, &waypoints, extent);
        let deviation = deviations.iter().copied().fold(0.0, f64::max);
        Self { knots, path: Smoothed { waypoints, deviation }, deviations }
    }

    fn sum_of_squares(&self) -> f64 {
        self.deviations.iter().map(|deviation| deviation * deviation).fold(0.0, |sum, square| sum + square)
    }
}

/// A path of `n` samples within the bound: each piece is cut where it is farthest from a sample,
/// for as long as it is beyond. With a corner at each sample what is left is rounding.
fn close(n: usize, bound: f64, fit: &impl Fn(Vec<usize>) -> Fit) -> Fit {
    assert!(n > 0, "a path has samples");
    let mut is_knot = vec![false; n];
    (is_knot[0], is_knot[n - 1]) = (true, true);
    loop {
        let found = fit((0..n).filter(|at| is_knot[*at]).collect());
        if found.path.deviation <= bound || found.knots.len() == n {
            return found;
        }
        let deviations = &found.deviations;
        for piece in found.knots.windows(2) {
            let inside = (piece[0] + 1..piece[1]).max_by(|a, b| deviations[*a].total_cmp(&deviations[*b]));
            let worst = (piece[0]..=piece[1]).map(|at| deviations[at]).fold(0.0, f64::max);
            if let Some(at) = inside.filter(|_| worst > bound) {
                is_knot[at] = true;
            }
        }
    }
}

/// The path without the corners that the bound does not need, each tried once.
fn pruned(mut found: Fit, bound: f64, fit: &impl Fn(Vec<usize>) -> Fit) -> Fit {
    let mut at = 1;
    while at + 1 < found.knots.len() {
        let mut others = found.knots.clone();
        others.remove(at);
        let without = fit(others);
        if without.path.deviation <= bound {
            found = without;
        } else {
            at += 1;
        }
    }
    found
}

/// The path with its corners where they have the least sum of squares: none is better a sample
/// earlier or later.
fn settled(mut found: Fit, bound: f64, fit: &impl Fn(Vec<usize>) -> Fit) -> Fit {
    loop {
        let before = found.sum_of_squares();
        for at in 1..found.knots.len().saturating_sub(1) {
            for way in [-1, 1] {
                while let Some(moved) = moved(&found.knots, at, way) {
                    let next = fit(moved);
                    if next.path.deviation > bound || next.sum_of_squares() >= found.sum_of_squares() {
                        break;
                    }
                    found = next;
                }
            }
        }
        // Each round lowers the sum, of which there are finitely many.
        if found.sum_of_squares() >= before {
            return found;
        }
    }
}

/// Corners of which one is a sample earlier or later; `None` where the next corner is.
fn moved(knots: &[usize], at: usize, way: isize) -> Option<Vec<usize>> {
    let to = knots[at].checked_add_signed(way).filter(|to| knots[at - 1] < *to && *to < knots[at + 1])?;
    let mut moved = knots.to_vec();
    moved[at] = to;
    Some(moved)
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

    /// A finger that rests, moves at 2.45 mm/s, and is read to 0.1 mm at 33 Hz.
    fn staircase() -> Vec<(f64, Pose)> {
        let place = |time: f64| 2.45e-3 * (time - 0.5).max(0.0);
        let read = |x: f64| (x / 1e-4).round() * 1e-4;
        (0..200).map(|at| 0.03 * f64::from(at)).map(|time| (time, Pose::new(read(place(time)), 0.0, 0.0))).collect()
    }

    #[test]
    fn a_staircase_becomes_the_straight_path() {
        let samples = staircase();
        let bound = usual_bound(&samples, 5e-4);
        // Twice its rounding: the steps of its noise are smaller.
        assert!((1.99e-4..2.6e-4).contains(&bound), "{bound}");
        for bound in [0.5 * bound, bound] {
            let path = smoothed(&samples, bound, 5e-4);
            assert!(path.deviation <= bound && path.waypoints.len() <= 4, "{path:?}");
            // A fit of 180 readings with an error of 29 um each: the ends of a line have twice the
            // error of its middle. A corner that is a sample too late adds a tenth of a reading.
            let error = samples.iter().map(|(time, _)| {
                let place = 2.45e-3 * (time - 0.5).max(0.0);
                (pose_at(&path.waypoints, *time).position.x - place).abs()
            });
            assert!(error.fold(0.0, f64::max) < 6e-5);
        }
        // Played literally it has a waypoint wherever three readings are on no line, and its ends.
        let bends = |three: &&[(f64, Pose)]| (three[0].1.position.x - 2.0 * three[1].1.position.x + three[2].1.position.x).abs() > 1e-9;
        assert_eq!(smoothed(&samples, 1e-6, 5e-4).waypoints.len(), samples.windows(3).filter(bends).count() + 2);
    }

    /// A path that is piecewise linear already is found exactly, however finely it is sampled.
    #[test]
    fn corners_are_found() {
        let corners = [(0.0, Pose::new(0.0, 0.0, 0.0)), (1.0, Pose::new(1.0, 2.0, 0.5)), (3.0, Pose::new(1.0, 0.0, -0.5))];
        let samples: Vec<(f64, Pose)> = (0..=60).map(|at| 0.05 * f64::from(at)).map(|time| (time, pose_at(&corners, time))).collect();
        let path = smoothed(&samples, 1e-9, 1.0);
        assert_eq!(path.waypoints.len(), 3, "{path:?}");
        for ((time, pose), (at, corner)) in path.waypoints.iter().zip(&corners) {
            // Rounding of the normal equations.
            assert!((time - at).abs() < 1e-12 && pose.edge_displacement(corner, 1.0) < 1e-12);
        }
        assert!(usual_bound(&samples, 1.0) < 0.1);
    }

    #[test]
    fn one_sample_and_two_are_themselves() {
        let pose = Pose::new(1.0, 2.0, 3.0);
        assert_eq!(smoothed(&[(0.5, pose)], 0.0, 1.0).waypoints, [(0.5, pose)]);
        let two = [(0.5, pose), (1.0, Pose::new(0.0, 0.0, 0.0))];
        assert_eq!(smoothed(&two, 0.0, 1.0).waypoints, two);
    }
}
