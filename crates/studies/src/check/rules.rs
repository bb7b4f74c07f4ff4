//! Rules for the values in a baseline's file: numbers in their ranges, times in order, and sections
//! that do not contradict each other.

use super::format::PathEntry;
use super::measure::COLUMNS;
use super::record::{CONTACT_ENERGIES, Ending, Event, MOST_EVENTS, stored_facts};
use super::tolerance::Tolerances;
use cohaul::backend::{BackendOptions, Status};
use cohaul::scenario::{Drive, Findings, Scenario};

/// Reports a number unless its rule holds.
fn require(findings: &mut Findings, holds: bool, path: &str, rule: &str, found: f64) {
    if !holds {
        findings.report(path, rule, format_args!("{found:?}"));
    }
}

pub fn options(options: &BackendOptions, findings: &mut Findings) {
    require(findings, options.step_s > 0.0, "options.step_s", "must be positive", options.step_s);
}

pub fn tolerances(tolerances: &Tolerances, findings: &mut Findings) {
    for (key, value) in tolerances.entries() {
        require(findings, value >= 0.0, &format!("tolerances.{key}"), "must not be negative", value);
    }
}

pub fn path(path: &PathEntry, ending: Option<&Ending>, findings: &mut Findings) {
    if path.columns != COLUMNS {
        findings.report("path.columns", format!("must be {}", COLUMNS.join(", ")), path.columns.join(", "));
    }
    let times: Vec<f64> = path.rows.iter().map(|row| row[0]).collect();
    let (Some(first), Some(last)) = (times.first(), times.last()) else {
        return findings.report("path.rows", "must hold a row", "none");
    };
    require(findings, *first == 0.0, "path.rows[0][0]", "must be the start, 0", *first);
    for (at, pair) in times.windows(2).enumerate() {
        let rule = format!("must be later than the row before, {:?} s", pair[0]);
        require(findings, pair[1] > pair[0], &format!("path.rows[{}][0]", at + 1), &rule, pair[1]);
    }
    if let Some(ending) = ending {
        let rule = format!("must be the end, ending.time_s = {:?}", ending.time_s);
        require(findings, *last == ending.time_s, &format!("path.rows[{}][0]", times.len() - 1), &rule, *last);
    }
}

pub fn events(events: &[Event], ending: Option<&Ending>, scenario: Option<&Scenario>, findings: &mut Findings) {
    let mut before = 0.0;
    for (at, event) in events.iter().enumerate() {
        let path = format!("events[{at}].time_s");
        require(findings, event.time_s >= before, &path, &format!("must not be before {before:?} s"), event.time_s);
        before = event.time_s;
        if let Some(end) = ending.map(|ending| ending.time_s) {
            require(findings, event.time_s <= end, &path, &format!("must not be after the end, {end:?} s"), event.time_s);
        }
        if let Some(scenario) = scenario {
            numbers(at, event, scenario, findings);
        }
    }
    if let Some(n_events) = ending.map(|ending| ending.n_events) {
        let kept = n_events.min(MOST_EVENTS as u64);
        if events.len() as u64 != kept {
            let rule = format!("must be a list of {kept}, of {n_events} that ending.n_events counts");
            findings.report("events", rule, format_args!("a list of {}", events.len()));
        }
    }
}

/// Checks that the scenario has the spring and the ant of an event.
fn numbers(at: usize, event: &Event, scenario: &Scenario, findings: &mut Findings) {
    let n_springs = scenario.system.springs.len();
    if event.spring >= n_springs {
        let rule = format!("must be below the number of springs, {n_springs}");
        findings.report(format!("events[{at}].spring"), rule, event.spring);
    }
    let found = event.ant.map_or("null".to_owned(), |ant| ant.to_string());
    let path = format!("events[{at}].ant");
    match (&scenario.drive, event.ant) {
        (Drive::Tips(_), Some(_)) => findings.report(path, "must be null without ants", found),
        (Drive::Ants(drive), ant) if ant.is_none_or(|ant| ant >= drive.n_ants) => {
            findings.report(path, format!("must be below the number of ants, {}", drive.n_ants), found);
        }
        _ => {}
    }
}

pub fn ending(ending: &Ending, scenario: Option<&Scenario>, findings: &mut Findings) {
    let is_known = |key: &str| stored_facts().any(|fact| fact.column == key) || CONTACT_ENERGIES.iter().any(|(column, _)| *column == key);
    for (place, numbers) in [("ending", &ending.numbers), ("ending.steps", &ending.steps.numbers)] {
        for (key, value) in numbers.iter().filter(|(key, _)| !is_known(key)) {
            findings.report(format!("{place}.{key}"), "is an unknown key", value.as_f64());
        }
    }
    if ending.steps.status == Status::Failed {
        findings.report("ending.steps.status", "must not be that of a failed run", "\"failed\"");
    }
    let found = ending.arrived.map_or("null".to_owned(), |arrived| arrived.to_string());
    match (scenario.map(|scenario| &scenario.drive), ending.arrived) {
        (Some(Drive::Ants(_)), None) => findings.report("ending.arrived", "must be true or false with ants", found),
        (Some(Drive::Tips(_)), Some(_)) => findings.report("ending.arrived", "must be null without ants", found),
        _ => {}
    }
}
