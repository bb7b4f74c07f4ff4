//! Rules of prescribed tip paths.

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
    for (index, path) in entry.paths.iter().enumerate() {
        let place = format!("drive.paths[{index}]");
        if let Some(n) = n_springs.filter(|n| path.spring >= *n) {
            findings.report(format_args!("{place}.spring"), format!("must be an index below the number of springs, {n}"), path.spring);
        }
        check_times(&place, path, shortest, findings);
    }
    check_order(&entry.paths, findings);
    entry.paths.iter().map(path).collect()
}

/// Checks that the paths of each spring follow each other in time.
fn check_order(paths: &[PathEntry], findings: &mut Findings) {
    let start = |index: &usize| paths[*index].waypoints.first().map_or(f64::NAN, |first| first[0]);
    let mut order: Vec<usize> = (0..paths.len()).collect();
    order.sort_by(|a, b| paths[*a].spring.cmp(&paths[*b].spring).then(start(a).total_cmp(&start(b))));
    for pair in order.windows(2).filter(|pair| paths[pair[0]].spring == paths[pair[1]].spring) {
        let (before, after, next) = (pair[0], pair[1], start(&pair[1]));
        let place = format!("drive.paths[{before}].release_s");
        let rule = || format!("must not be later than {}, where drive.paths[{after}] attaches the same spring", number(next));
        match paths[before].release_s {
            Some(release) if release > next => findings.report(place, rule(), number(release)),
            None if next.is_finite() => findings.report(place, format!("is required and {}", rule()), "nothing"),
            _ => {}
        }
    }
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
