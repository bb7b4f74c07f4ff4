//! Rules of prescribed tip paths.

use std::collections::HashMap;

use crate::scenario::error::{Findings, number};
use crate::scenario::format::{PathEntry, TipsEntry};
use crate::scenario::{TipPath, Waypoint};

/// Paths on `n_springs` springs, where that number is known.
pub fn paths(entry: &TipsEntry, n_springs: Option<usize>, findings: &mut Findings) -> Vec<TipPath> {
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
        check_times(&place, path, findings);
    }
    entry.paths.iter().map(path).collect()
}

fn check_times(place: &str, path: &PathEntry, findings: &mut Findings) {
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
        if pair[1][0] <= pair[0][0] {
            let rule = format!("must be later than the previous waypoint, {}", number(pair[0][0]));
            findings.report(format_args!("{place}.waypoints[{}][0]", index + 1), rule, number(pair[1][0]));
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
