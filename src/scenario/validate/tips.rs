//! Rules of prescribed tip paths.

use std::collections::HashMap;

use crate::scenario::error::{Findings, number};
use crate::scenario::format::{PathEntry, TipsEntry};
use crate::scenario::{SAME_INSTANT, TipPath, Waypoint};

/// Shortest time between two waypoints of a path, over the control period (1). A run moves an
/// instant to another one that is nearer than [`SAME_INSTANT`], and may do so from both sides.
/// Between two waypoints that become one the tip would jump, and a path has no jumps.
const SHORTEST_PART: f64 = 2.0 * SAME_INSTANT;

/// Paths on `n_springs` springs under a control period (s), where these are known.
pub fn paths(entry: &TipsEntry, n_springs: Option<usize>, control_period: Option<f64>, findings: &mut Findings) -> Vec<TipPath> {
    let shortest = SHORTEST_PART * control_period.filter(|period| *period > 0.0).unwrap_or_default();
    let mut first_path_of = HashMap::new();
    for (index, path) in entry.paths.iter().enumerate() {
        let place = format!("drive.paths[{index}]");
        if let Some(n) = n_springs.filter(|n| path.spring >= *n) {
            findings.report(format_args!("{place}.spring"), format!("must be an index below the number of springs, {n}"), path.spring);
        }
        if let Some(first) = first_path_of.insert(path.spring, index) {
            let rule = format!("must not be the spring of another path, drive.paths[{first}]");
            findings.report(format_args!("{place}.spring"), rule, path.spring);
        }
        check_times(&place, path, shortest, findings);
    }
    entry.paths.iter().map(path).collect()
}

/// Checks the times of a path, with at least `shortest` (s) from one waypoint to the next.
fn check_times(place: &str, path: &PathEntry, shortest: f64, findings: &mut Findings) {
    let Some(first) = path.waypoints.first() else {
        return findings.report(format_args!("{place}.waypoints"), "must have at least one waypoint", "none");
    };
    if first[0] < 0.0 {
        findings.report(format_args!("{place}.waypoints[0][0]"), "must not be negative", number(first[0]));
    }
    for (index, waypoint) in path.waypoints.iter().enumerate() {
        findings.finite_vector(format_args!("{place}.waypoints[{index}]"), waypoint);
    }
    for (index, pair) in path.waypoints.windows(2).enumerate() {
        let found = || number(pair[1][0]);
        if pair[1][0] <= pair[0][0] {
            let rule = format!("must be later than the previous waypoint, {}", number(pair[0][0]));
            findings.report(format_args!("{place}.waypoints[{}][0]", index + 1), rule, found());
        } else if pair[1][0] - pair[0][0] < shortest {
            let rule = format!("must be later than the previous waypoint by at least {shortest:.1e} s, {SHORTEST_PART:e} control periods");
            findings.report(format_args!("{place}.waypoints[{}][0]", index + 1), rule, found());
        }
    }
    if let Some(release) = path.release_s {
        let rule = format!("must be later than the first waypoint, {}", number(first[0]));
        findings.require(release > first[0], format_args!("{place}.release_s"), &rule, release);
    }
}

fn path(entry: &PathEntry) -> TipPath {
    let waypoints = entry.waypoints.iter().map(|[time, x, y]| Waypoint { time: *time, position: [*x, *y].into() });
    TipPath { spring: entry.spring, waypoints: waypoints.collect(), release: entry.release_s }
}
