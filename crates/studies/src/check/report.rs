//! A check against baselines as JSON, as text and as files.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use serde::Serialize;

use super::{
    Build, BuildChange, COLUMNS, Check, Decision, Deviation, Difference, Divergence, Event, MEASURES, Quantity, Row, ScenarioChange, Side,
    Verdict,
};
use crate::variants::names;
use cohaul::backend::Status;
use cohaul::formats::{self, Format, Versioned};
use cohaul::simulation::run_facts::split_unit;
use cohaul_report::chart::{self, Labelled, Scene};
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::junit::{Case, Outcome, Suite};
use cohaul_report::lines::TableError;
use cohaul_report::manifest::{Libraries, Machine, Manifest, build_of_program};
use cohaul_report::quantity::quantity;
use cohaul_report::table::Table;
use cohaul_report::text::Lines;

/// Object that `check --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckReport {
    pub n_agree: usize,
    pub n_differ: usize,
    pub n_not_computed: usize,
    /// Whether tolerances were zero.
    pub exact: bool,
    /// Build of the new runs.
    pub build: Build,
    /// Baselines that were replaced by the new runs.
    pub accepted: Vec<String>,
    pub wall_s: f64,
    pub baselines: Vec<Check>,
}

impl Versioned for CheckReport {
    const FORMAT: Format = formats::CHECK;
}

/// Versions of this program and its libraries, and this machine, as a baseline stores them.
pub fn this_build() -> Build {
    let (version, commit) = build_of_program();
    let (libraries, machine) = (Libraries::USED, Machine::here());
    let facts = [
        ("cohaul", Some(version)),
        (Build::COMMIT, commit),
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

    /// Whether every baseline agrees or was replaced.
    pub fn is_good(&self) -> bool {
        self.baselines.iter().all(|check| check.verdict == Verdict::Agrees || self.accepted.contains(&check.name))
    }
}

/// Writes `summary.json`, `difference-NAME.csv` of every baseline, `difference-NAME.svg` of those
/// that differ, and `manifest.json` to the folder `target`, all or nothing.
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

/// Writes rows of two runs at the same times: the time, every other column as expected and as
/// found, and the difference in every measure.
///
/// # Errors
/// When a number is not finite, or `out` fails.
fn write_pairs(pairs: &[(Row, Row)], out: impl Write) -> Result<(), TableError> {
    let sides = COLUMNS[1..].iter().flat_map(|name| [format!("expected_{name}"), format!("found_{name}")]);
    let apart = MEASURES.iter().map(|measure| format!("apart_{}", measure.name));
    let mut table = Table::new("", ["time_s".to_owned()].into_iter().chain(sides).chain(apart));
    for (expected, found) in pairs {
        let sides = expected[1..].iter().zip(&found[1..]).flat_map(|(expected, found)| [*expected, *found]);
        let apart = MEASURES.iter().map(|measure| measure.apart(expected, found));
        table.push([expected[0]].into_iter().chain(sides).chain(apart));
    }
    table.write_csv(out)
}

/// One line for each baseline, then the changes of the build and the differences.
pub fn check_text(report: &CheckReport) -> String {
    let mut lines = Lines::default();
    let agree = match report.n_agree {
        n if n == report.baselines.len() => "all agree".to_owned(),
        n => format!("{n} agree, {} differ, {} not computed", report.n_differ, report.n_not_computed),
    };
    lines.section(&format!("check: {agree}"));
    let width = report.baselines.iter().map(|check| check.name.chars().count()).max().unwrap_or(0);
    for check in &report.baselines {
        lines.row(names::<Verdict>()[check.verdict as usize], &format!("{:<width$}  {}", check.name, remark(check)));
    }
    builds(report, &mut lines);
    for check in &report.baselines {
        details(check, report.accepted.contains(&check.name), &mut lines);
    }
    lines.text
}

/// The check as a test suite, with a case for each baseline.
pub fn check_suite(report: &CheckReport) -> Suite {
    let outcome = |check: &Check| match check.verdict {
        _ if report.accepted.contains(&check.name) => Outcome::Skipped("the baseline was replaced by the new run".to_owned()),
        Verdict::Agrees => Outcome::Passed,
        Verdict::NotComputed => Outcome::Error(remark(check)),
        Verdict::Differs => {
            let mut lines = Lines::default();
            details(check, false, &mut lines);
            Outcome::Failed(format!("differs {}", remark(check)), lines.text)
        }
    };
    let case = |check: &Check| Case { class: "check".to_owned(), name: check.name.clone(), outcome: outcome(check) };
    Suite { name: "cohaul check".to_owned(), wall_s: report.wall_s, cases: report.baselines.iter().map(case).collect() }
}

fn remark(check: &Check) -> String {
    match check.verdict {
        Verdict::Agrees if check.is_exact => "to the last digit".to_owned(),
        Verdict::Agrees => format!("within {} of its tolerances", share(check.difference.largest_share())),
        Verdict::NotComputed => "a step had no finite solution".to_owned(),
        Verdict::Differs => match &check.difference.first_divergence {
            Some(first) if is_decision(Some(first)) => format!("first in a decision at {}", seconds(first.time_s)),
            Some(first) => format!("first in {} at {}", name_of(first.measure).0, seconds(first.time_s)),
            None => {
                let names: Vec<_> = check.difference.beyond().map(|deviation| name_of(deviation.measure).0).collect();
                if names.is_empty() { "in its end".to_owned() } else { format!("in {}, not on the path", names.join(", ")) }
            }
        },
    }
}

fn share(share: f64) -> String {
    if share < 1e-4 { "less than 0.01 %".to_owned() } else { format!("{:.2} %", 100.0 * share) }
}

/// Changes of the build since the baselines were stored.
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
        lines.row("accepted", "the baseline was replaced by the new run");
    }
    few("scenario", scenario_changes, scenario_change, lines);
    if check.verdict == Verdict::Agrees {
        return;
    }
    if let Some(first) = &difference.first_divergence {
        first_divergence(first, difference, lines);
    }
    // The first divergence may be this decision.
    if let Some(decision) = difference.first_different_decision.filter(|_| !is_decision(difference.first_divergence.as_ref())) {
        lines.row("decisions", &different_decision(&decision));
    }
    if let Some(change) = &difference.arrival_change {
        let text = |arrived: Option<bool>| match arrived {
            Some(true) => "arrived",
            Some(false) => "not arrived",
            None => "no nest",
        };
        lines.row("nest", &format!("expected {}, found {}", text(change.expected), text(change.found)));
    }
    if let Some(change) = &difference.status_change {
        let word = |status: Status| names::<Status>()[status as usize].replace('_', " ");
        lines.row("status", &format!("expected {}, found {}", word(change.expected), word(change.found)));
    }
    for deviation in difference.beyond() {
        lines.row(&name_of(deviation.measure).0, &deviation_text(deviation));
    }
}

fn is_decision(first: Option<&Divergence>) -> bool {
    first.is_some_and(|first| matches!(first.expected, Side::Event(_)))
}

/// At most ten lines under one label.
fn few<T>(label: &str, items: &[T], text: impl Fn(&T) -> String, lines: &mut Lines) {
    const MOST: usize = 10;
    for (at, item) in items.iter().take(MOST).enumerate() {
        lines.row(if at == 0 { label } else { "" }, &text(item));
    }
    if items.len() > MOST {
        lines.row("", &format!("and {} more", items.len() - MOST));
    }
}

fn build_change(change: &BuildChange) -> String {
    let text = |version: &Option<String>| version.clone().unwrap_or("none".to_owned());
    format!("{} {}, stored with {}", change.what, text(&change.now), text(&change.stored))
}

fn scenario_change(change: &ScenarioChange) -> String {
    let text = |value: &serde_json::Value| match value {
        serde_json::Value::Null => "nothing".to_owned(),
        other => other.to_string().chars().take(60).collect(),
    };
    format!("{} is {}, stored with {}", change.path, text(&change.now), text(&change.stored))
}

fn first_divergence(first: &Divergence, difference: &Difference, lines: &mut Lines) {
    let (name, unit) = name_of(first.measure);
    let name = if is_decision(Some(first)) { "a decision".to_owned() } else { name };
    let after = first.agreed_until_s.map_or(String::new(), |time| format!(", agreed up to {}", seconds(time)));
    lines.row("diverges", &format!("first in {name} at {}{after}", seconds(first.time_s)));
    lines.row("  expected", &side(&first.expected, unit));
    lines.row("  found", &side(&first.found, unit));
    if let (Side::Numbers(a), Side::Numbers(b)) = (&first.expected, &first.found) {
        let distance = a.iter().zip(b).fold(0.0, |size: f64, (a, b)| size.hypot(a - b));
        let tolerance =
            difference.deviations.iter().find(|deviation| deviation.measure == first.measure).map(|deviation| deviation.tolerance);
        let tolerance = tolerance.map_or(String::new(), |tolerance| format!(", tolerance {}", quantity(tolerance, unit)));
        lines.row("  difference", &format!("{}{tolerance}", quantity(distance, unit)));
    }
    let n_equal = difference.first_different_decision.filter(|_| is_decision(Some(first))).map(|decision| decision.n_equal);
    let equal = n_equal.map_or(String::new(), |n| format!(", the last of {n} equal decisions"));
    let last = first.last_event.as_ref().map_or("no grasp or release".to_owned(), |last| event(last) + &equal);
    lines.row("  after", &last);
}

fn different_decision(decision: &Decision) -> String {
    let text = |side: &Option<Event>| side.as_ref().map_or("no more".to_owned(), event);
    format!("after {} equal ones: expected {}, found {}", decision.n_equal, text(&decision.expected), text(&decision.found))
}

fn event(event: &Event) -> String {
    let ant = event.ant.map_or(String::new(), |ant| format!(" by ant {ant}"));
    format!("{} of spring {}{ant} at {}", event.event.name(), event.spring, seconds(event.time_s))
}

/// All digits, because two runs may differ in the last one.
fn side(side: &Side, unit: &str) -> String {
    match side {
        Side::Numbers(values) => format!("{} {unit}", digits(values)).trim_end().to_owned(),
        Side::Event(decision) => decision.as_ref().map_or("no more decisions".to_owned(), event),
    }
}

fn digits(values: &[f64]) -> String {
    let digits: Vec<_> = values.iter().map(|value| format!("{value:?}")).collect();
    if let [one] = digits.as_slice() { one.clone() } else { format!("({})", digits.join(", ")) }
}

/// All digits, up to the rounding of the product of a tick and its period.
fn seconds(time: f64) -> String {
    format!("{} s", (time * 1e9).round() / 1e9)
}

fn deviation_text(deviation: &Deviation) -> String {
    let (_, unit) = name_of(deviation.measure);
    let [difference, tolerance] = [deviation.difference, deviation.tolerance].map(|value| quantity(value, unit));
    match deviation.time_s {
        Some(time) => format!("difference {difference} at {}, tolerance {tolerance}", seconds(time)),
        None => {
            let text = |values: &[f64]| match deviation.quantity {
                Quantity::Count => format!("{:.0}", values[0]),
                _ => format!("{} {unit}", digits(values)),
            };
            format!("{}, expected {}, tolerance {tolerance}", text(&deviation.found), text(&deviation.expected))
        }
    }
}

/// Name of a measure without its unit, and the unit.
fn name_of(measure: &str) -> (String, &'static str) {
    let (name, unit) = split_unit(measure);
    (name.strip_prefix("n_").unwrap_or(name).replace('_', " "), unit)
}
