//! What happens after the end of a run, and durations that do not fit what happens.

use crate::scenario::error::{Findings, short};
use crate::scenario::{Drive, SAME_INSTANT, Scenario, TipPath};

/// Fewest control periods of a run (1).
const FEWEST_PERIODS: f64 = 10.0;
/// Longest duration over the time of the last thing that is prescribed (1).
const LONGEST_REST: f64 = 100.0;

pub fn check(scenario: &Scenario, findings: &mut Findings) {
    let (duration, period) = (scenario.duration, scenario.control_period);
    if duration < FEWEST_PERIODS * period * (1.0 - SAME_INSTANT) {
        let rule = format!("should be at least {FEWEST_PERIODS} control periods, {} s", short(FEWEST_PERIODS * period));
        findings.report("duration_s", rule, format_args!("{} s", short(duration)));
    }
    let mut end = End { time: duration + SAME_INSTANT * period, last: 0.0, findings };
    for (index, obstacle) in scenario.system.world.obstacles.iter().enumerate().filter(|(_, obstacle)| obstacle.path.moves()) {
        let times: Vec<f64> = obstacle.path.waypoints.iter().map(|(time, _)| *time).collect();
        end.waypoints(&format!("obstacles[{index}].path"), &times);
    }
    if let Drive::Tips(paths) = &scenario.drive {
        paths.iter().enumerate().for_each(|(index, path)| tips(&format!("drive.paths[{index}]"), path, &mut end));
        rest(duration, end.last, findings);
    }
}

/// The end of a run, and what would happen after it.
struct End<'a> {
    /// End of the run (s).
    time: f64,
    /// Last time that is prescribed (s).
    last: f64,
    findings: &'a mut Findings,
}

impl End<'_> {
    /// Reports a time after the end, and returns whether it is.
    fn is_over(&mut self, path: String, what: &str, time: f64) -> bool {
        self.last = self.last.max(time);
        let is_over = time > self.time;
        if is_over {
            let rule = format!("{what} should not be after the end of the run, {} s", short(self.time));
            self.findings.report(path, rule, format_args!("{} s", short(time)));
        }
        is_over
    }

    /// Reports the first waypoint after the end, and returns whether there is one.
    fn waypoints(&mut self, path: &str, times: &[f64]) -> bool {
        self.last = self.last.max(times.last().copied().unwrap_or(0.0));
        let over = times.iter().position(|time| *time > self.time);
        over.is_some_and(|at| {
            let what = if at == 0 { "the start of the path" } else { "a waypoint" };
            self.is_over(format!("{path}.waypoints[{at}][0]"), what, times[at])
        })
    }
}

fn tips(place: &str, path: &TipPath, end: &mut End) {
    let times: Vec<f64> = path.waypoints.iter().map(|waypoint| waypoint.time).collect();
    end.waypoints(place, &times);
    if let Some(release) = path.release {
        end.is_over(format!("{place}.release_s"), "the release", release);
    }
}

/// A run that goes on long after everything is over.
fn rest(duration: f64, last: f64, findings: &mut Findings) {
    if last > 0.0 && duration > LONGEST_REST * last {
        let rule = format!("should be in seconds, and at most {LONGEST_REST} times as long as what happens, {} s", short(last));
        findings.report("duration_s", rule, format_args!("{} s", short(duration)));
    }
}
