//! A check against baselines for programs, for people and as files.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use super::pairs::write_pairs;
use crate::output::chart::{self, Labelled, Scene};
use crate::output::folder::{FolderError, OutputFolder};
use crate::output::manifest::{Libraries, Machine, Manifest};
use crate::output::quantity::quantity;
use crate::output::text::Lines;
use crate::simulation::EventKind;
use crate::studies::check::{
    Build, BuildChange, Check, Decision, Deviation, Difference, Divergence, Event, Quantity, ScenarioChange, Told, Verdict,
};

/// What `check --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckReport {
    pub n_agree: usize,
    pub n_differ: usize,
    pub n_not_computed: usize,
    /// Whether tolerances were zero.
    pub exact: bool,
    /// What ran now.
    pub build: Build,
    /// Baselines that now hold what was found.
    pub accepted: Vec<String>,
    pub wall_s: f64,
    pub baselines: Vec<Check>,
}

/// This program, its libraries and this machine, as a baseline keeps them.
pub fn this_build() -> Build {
    let (libraries, machine) = (Libraries::USED, Machine::here());
    let facts = [
        ("cohaul", Some(env!("CARGO_PKG_VERSION"))),
        (Build::COMMIT, option_env!("COHAUL_COMMIT")),
        ("rapier2d", Some(libraries.rapier2d)),
        ("parry2d", Some(libraries.parry2d)),
        ("nalgebra", Some(libraries.nalgebra)),
        ("architecture", Some(machine.architecture)),
        ("system", Some(machine.system)),
        ("environment", Some(machine.environment)),
    ];
    Build(facts.into_iter().filter_map(|(what, is)| Some((what.to_owned(), is?.to_owned()))).collect())
}

impl CheckReport {
    pub fn new(baselines: Vec<Check>, exact: bool, wall_s: f64) -> Self {
        let n = |verdict: Verdict| baselines.iter().filter(|check| check.verdict == verdict).count();
        let (n_agree, n_differ, n_not_computed) = (n(Verdict::Agrees), n(Verdict::Differs), n(Verdict::NotComputed));
        Self { n_agree, n_differ, n_not_computed, exact, build: this_build(), accepted: Vec::new(), wall_s, baselines }
    }

    /// Whether nothing is left that does not agree.
    pub fn is_good(&self) -> bool {
        self.baselines.iter().all(|check| check.verdict == Verdict::Agrees || self.accepted.contains(&check.name))
    }
}

/// Writes `summary.json`, `difference-NAME.csv` of every baseline, `difference-NAME.svg` of those that differ, and `manifest.json` to the folder
/// `target`, all or nothing.
///
/// # Errors
/// When the folder may not be written, a number is not finite, or the disk fails.
pub fn write_check(target: &Path, report: &CheckReport, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write_json("summary.json", report)?;
    for check in &report.baselines {
        folder.write(&format!("difference-{}.csv", check.name), |out| write_pairs(&check.difference.pairs, out))?;
        if check.verdict != Verdict::Differs {
            continue;
        }
        let [expected, found] = check.traces();
        let labelled = [Labelled { label: "expected", trace: &expected }, Labelled { label: "found", trace: &found }];
        let svg = chart::expected_and_found(&labelled, &Scene::of(&check.found.scenario));
        folder.write(&format!("difference-{}.svg", check.name), |out| out.write_all(svg.as_bytes()))?;
    }
    folder.finish(manifest)
}

/// One line a baseline, then what is to be said of those that do not agree or were not made alike.
pub fn check_text(report: &CheckReport) -> String {
    let mut lines = Lines::default();
    let agree = match report.n_agree {
        n if n == report.baselines.len() => "all agree".to_owned(),
        n => format!("{n} agree, {} differ, {} not computed", report.n_differ, report.n_not_computed),
    };
    lines.section(&format!("check: {agree}"));
    let width = report.baselines.iter().map(|check| check.name.chars().count()).max().unwrap_or(0);
    for check in &report.baselines {
        lines.row(verdict(check.verdict), &format!("{:<width$}  {}", check.name, remark(check)));
    }
    builds(report, &mut lines);
    for check in &report.baselines {
        details(check, report.accepted.contains(&check.name), &mut lines);
    }
    lines.text
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Agrees => "agrees",
        Verdict::Differs => "differs",
        Verdict::NotComputed => "not computed",
    }
}

fn remark(check: &Check) -> String {
    match check.verdict {
        Verdict::Agrees if check.is_exact => "to the last digit".to_owned(),
        Verdict::Agrees => format!("within {} of its tolerances", share(check.difference.largest_share())),
        Verdict::NotComputed => "a step had no finite answer".to_owned(),
        Verdict::Differs => match &check.difference.first_divergence {
            Some(first) if is_decision(Some(first)) => format!("first in a decision at {}", seconds(first.time_s)),
            Some(first) => format!("first in {} at {}", name_of(first.measure).0, seconds(first.time_s)),
            None => {
                let names: Vec<_> = check.difference.beyond().map(|deviation| name_of(deviation.measure).0).collect();
                if names.is_empty() { "in how it ended".to_owned() } else { format!("in {}, not on its path", names.join(", ")) }
            }
        },
    }
}

fn share(share: f64) -> String {
    if share < 1e-4 { "less than 0.01 %".to_owned() } else { format!("{:.2} %", 100.0 * share) }
}

/// What of the build is not as it was when baselines were stored.
fn builds(report: &CheckReport, lines: &mut Lines) {
    let mut n_with: BTreeMap<String, usize> = BTreeMap::new();
    for change in report.baselines.iter().flat_map(|check| &check.build_changes) {
        *n_with.entry(build_change(change)).or_default() += 1;
    }
    if n_with.is_empty() {
        return;
    }
    lines.section("another build");
    for (change, n) in n_with {
        lines.row("", &format!("{change} in {n} of {}", report.baselines.len()));
    }
}

fn details(check: &Check, is_accepted: bool, lines: &mut Lines) {
    let Check { scenario_changes, difference, .. } = check;
    if check.verdict == Verdict::Agrees && scenario_changes.is_empty() {
        return;
    }
    lines.section(&check.name);
    if is_accepted {
        lines.row("accepted", "the baseline now holds what was found");
    }
    few("scenario", scenario_changes, scenario_change, lines);
    if check.verdict == Verdict::Agrees {
        return;
    }
    if let Some(first) = &difference.first_divergence {
        parts_first(first, difference, lines);
    }
    // A decision that parts first has been told.
    if let Some(part) = difference.decisions_part.as_ref().filter(|_| !is_decision(difference.first_divergence.as_ref())) {
        lines.row("decisions part", &decisions_part(part));
    }
    if let Some(change) = &difference.arrival_change {
        let said = |arrived: Option<bool>| match arrived {
            Some(true) => "arrived",
            Some(false) => "not arrived",
            None => "no nest",
        };
        lines.row("nest", &format!("expected {}, found {}", said(change.expected), said(change.found)));
    }
    if let Some(change) = &difference.status_change {
        let word = |status| serde_json::to_value(status).map_or(String::new(), |word| word.as_str().unwrap_or_default().replace('_', " "));
        lines.row("status", &format!("expected {}, found {}", word(change.expected), word(change.found)));
    }
    for deviation in difference.beyond() {
        lines.row(&name_of(deviation.measure).0, &apart(deviation));
    }
}

fn is_decision(first: Option<&Divergence>) -> bool {
    first.is_some_and(|first| matches!(first.expected, Told::Event(_)))
}

/// Up to ten lines under one label.
fn few<T>(label: &str, items: &[T], said: impl Fn(&T) -> String, lines: &mut Lines) {
    const MOST: usize = 10;
    for (at, item) in items.iter().take(MOST).enumerate() {
        lines.row(if at == 0 { label } else { "" }, &said(item));
    }
    if items.len() > MOST {
        lines.row("", &format!("and {} more", items.len() - MOST));
    }
}

fn build_change(change: &BuildChange) -> String {
    let said = |is: &Option<String>| is.clone().unwrap_or("none".to_owned());
    format!("{} {}, stored with {}", change.what, said(&change.now), said(&change.stored))
}

fn scenario_change(change: &ScenarioChange) -> String {
    let said = |value: &serde_json::Value| match value {
        serde_json::Value::Null => "nothing".to_owned(),
        other => other.to_string().chars().take(60).collect(),
    };
    format!("{} is {}, stored with {}", change.path, said(&change.now), said(&change.stored))
}

fn parts_first(first: &Divergence, difference: &Difference, lines: &mut Lines) {
    let (name, unit) = name_of(first.measure);
    let name = if is_decision(Some(first)) { "a decision".to_owned() } else { name };
    let after = first.agreed_until_s.map_or(String::new(), |time| format!(", agreed up to {}", seconds(time)));
    lines.row("parts first", &format!("in {name} at {}{after}", seconds(first.time_s)));
    lines.row("  expected", &told(&first.expected, unit));
    lines.row("  found", &told(&first.found, unit));
    if let (Told::Numbers(a), Told::Numbers(b)) = (&first.expected, &first.found) {
        let apart = a.iter().zip(b).fold(0.0, |size: f64, (a, b)| size.hypot(a - b));
        let tolerance =
            difference.deviations.iter().find(|deviation| deviation.measure == first.measure).map(|deviation| deviation.tolerance);
        let tolerance = tolerance.map_or(String::new(), |tolerance| format!(", tolerance {}", quantity(tolerance, unit)));
        lines.row("  apart", &format!("{}{tolerance}", quantity(apart, unit)));
    }
    let n_alike = difference.decisions_part.filter(|_| is_decision(Some(first))).map(|part| part.n_alike);
    let alike = n_alike.map_or(String::new(), |n| format!(", the last of {n} alike"));
    let last = first.last_event.as_ref().map_or("no grasp or release".to_owned(), |last| event(last) + &alike);
    lines.row("  after", &last);
}

fn decisions_part(part: &Decision) -> String {
    let said = |side: &Option<Event>| side.as_ref().map_or("no more".to_owned(), event);
    format!("after {} alike: expected {}, found {}", part.n_alike, said(&part.expected), said(&part.found))
}

fn event(event: &Event) -> String {
    let kind = match event.event {
        EventKind::Grasp => "grasp",
        EventKind::Release => "release",
    };
    let ant = event.ant.map_or(String::new(), |ant| format!(" by ant {ant}"));
    format!("{kind} of spring {}{ant} at {}", event.spring, seconds(event.time_s))
}

/// All digits: two runs may part in the last.
fn told(told: &Told, unit: &str) -> String {
    match told {
        Told::Numbers(values) => format!("{} {unit}", digits(values)).trim_end().to_owned(),
        Told::Event(side) => side.as_ref().map_or("no more decisions".to_owned(), event),
    }
}

fn digits(values: &[f64]) -> String {
    let digits: Vec<_> = values.iter().map(|value| format!("{value:?}")).collect();
    if let [one] = digits.as_slice() { one.clone() } else { format!("({})", digits.join(", ")) }
}

/// All digits, rounding of a product of a tick and its period aside.
fn seconds(time: f64) -> String {
    format!("{} s", (time * 1e9).round() / 1e9)
}

fn apart(deviation: &Deviation) -> String {
    let (_, unit) = name_of(deviation.measure);
    let [difference, tolerance] = [deviation.difference, deviation.tolerance].map(|value| quantity(value, unit));
    match deviation.time_s {
        Some(time) => format!("{difference} apart at {}, tolerance {tolerance}", seconds(time)),
        None => {
            let said = |values: &[f64]| match deviation.quantity {
                Quantity::Count => format!("{:.0}", values[0]),
                _ => format!("{} {unit}", digits(values)),
            };
            format!("{}, expected {}, tolerance {tolerance}", said(&deviation.found), said(&deviation.expected))
        }
    }
}

/// A measure's name without its unit, and the unit.
fn name_of(measure: &str) -> (String, &'static str) {
    let units = [("_rad_per_s", "rad/s"), ("_m_per_s", "m/s"), ("_rad", "rad"), ("_m", "m"), ("_j", "J"), ("_n", "N"), ("_s", "s")];
    let found = units.iter().find_map(|(ending, unit)| Some((measure.strip_suffix(ending)?, *unit)));
    let (name, unit) = found.unwrap_or((measure, ""));
    (name.strip_prefix("n_").unwrap_or(name).replace('_', " "), unit)
}
