//! Rules of prescribed tip paths.

use super::shared::{SHORTEST_PART, check_waypoints};
use crate::scenario::error::{Findings, number};
use crate::scenario::format::{PathEntry, TipsEntry};
use crate::scenario::{TipPath, Waypoint};

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
    check_waypoints(&path.waypoints, &format!("{place}.waypoints"), shortest, findings);
    if let (Some(first), Some(release)) = (path.waypoints.first(), path.release_s) {
        let rule = format!("must be later than the first waypoint, {}", number(first[0]));
        findings.require(release > first[0], format_args!("{place}.release_s"), &rule, release);
    }
}

fn path(entry: &PathEntry) -> TipPath {
    let waypoints = entry.waypoints.iter().map(|[time, x, y]| Waypoint { time: *time, position: [*x, *y].into() });
    TipPath { spring: entry.spring, waypoints: waypoints.collect(), release: entry.release_s }
}
