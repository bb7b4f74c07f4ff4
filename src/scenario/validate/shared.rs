//! Limits and geometry that the rules of several sections share.

use std::f64::consts::TAU;

use crate::math::{Vec2, direction};
use crate::scenario::SAME_INSTANT;
use crate::scenario::error::{Findings, number, short};

/// Largest number of springs or supports, in one ring and in all (1).
pub const MOST_IN_RING: usize = 100_000;
/// Largest number of ants (1).
pub const MOST_ANTS: usize = 1_000_000;

/// Shortest time between two waypoints of a tip, over the control period (1). A run moves an
/// instant to another one that is nearer than [`SAME_INSTANT`], and may do so from both sides.
/// Between two waypoints that become one the tip would jump, and a path has no jumps.
pub const SHORTEST_PART: f64 = 2.0 * SAME_INSTANT;

/// Rules of the `waypoints` at `place`, each of which begins with its time (s): from one to the
/// next it grows, by at least `shortest` (s).
pub fn check_waypoints<const N: usize>(waypoints: &[[f64; N]], place: &str, shortest: f64, findings: &mut Findings) {
    let Some(first) = waypoints.first() else {
        return findings.report(place, "must have at least one waypoint", "none");
    };
    if first[0] < 0.0 {
        findings.report(format_args!("{place}[0][0]"), "must not be negative", number(first[0]));
    }
    for (index, waypoint) in waypoints.iter().enumerate() {
        findings.finite_vector(format_args!("{place}[{index}]"), waypoint);
    }
    for (index, pair) in waypoints.windows(2).enumerate() {
        let rule = if pair[1][0] <= pair[0][0] {
            format!("must be later than the previous waypoint, {}", number(pair[0][0]))
        } else if pair[1][0] - pair[0][0] < shortest {
            format!("must be later than the previous waypoint by at least {} s, {SHORTEST_PART:e} control periods", short(shortest))
        } else {
            continue;
        };
        findings.report(format_args!("{place}[{}][0]", index + 1), rule, number(pair[1][0]));
    }
}

/// Whether a letter controls a terminal or the direction of text.
pub fn is_control(letter: char) -> bool {
    letter.is_control() || matches!(letter, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Point at `bearing` (rad) and `radius` (m).
pub fn polar(radius: f64, bearing: f64) -> Vec2 {
    radius * direction(bearing)
}

/// Directions of `n` equal angles from `first` on (rad).
pub fn bearings(n: usize, first: f64) -> impl Iterator<Item = f64> {
    (0..n).map(move |index| first + TAU * index as f64 / n as f64)
}
