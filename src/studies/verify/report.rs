//! A verification for programs, for people and as files.

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;

use crate::output::folder::{FolderError, OutputFolder};
use crate::output::junit;
use crate::output::manifest::Manifest;
use crate::output::quantity::quantity;
use crate::output::table::{Table, write_rows};
use crate::output::text::Detail;
use crate::studies::verify::figure;
use crate::studies::verify::{Case, Effort, Errors, Expected, Outcome, Row, RowKind};

/// What `verify --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verification {
    pub holds: bool,
    /// Rows that hold, and rows that could have missed.
    pub n_held: usize,
    pub n_judged: usize,
    /// Rows for information only.
    pub n_shown: usize,
    pub quick: bool,
    pub wall_s: f64,
    pub cases: Vec<Question>,
    pub rows: Vec<Line>,
}

/// What a case asks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Question {
    pub name: String,
    pub family: &'static str,
    pub what: String,
    pub source: String,
}

/// A row with its numbers in SI units; `null`, in a table an empty field, where there is none. A
/// column of `verify.csv` each, in this order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    pub case: String,
    pub family: &'static str,
    pub backend: &'static str,
    /// Whether the answer was extrapolated over all steps down to this one.
    pub extrapolated: bool,
    /// `null` under error control.
    pub step_s: Option<f64>,
    pub error_m: Option<f64>,
    pub error_rad: Option<f64>,
    pub error_ratio: Option<f64>,
    pub bound_m: Option<f64>,
    pub bound_rad: Option<f64>,
    pub bound_ratio: Option<f64>,
    /// What is asked for under error control; `null` at a step.
    pub tolerance_m: Option<f64>,
    /// Measured between this step and the one before.
    pub order: Option<f64>,
    pub expected: &'static str,
    pub expected_order: Option<f64>,
    /// `null` for information only.
    pub holds: Option<bool>,
    pub missed: Option<String>,
    pub reason: String,
    pub source: String,
}

impl Verification {
    /// Summary of the `rows` of `cases`; cases without any row are left out.
    pub fn new(cases: &[Case], rows: &[Row], effort: Effort, wall_s: f64) -> Self {
        let lines: Vec<Line> = rows.iter().map(Line::of).collect();
        let n_judged = lines.iter().filter(|line| line.holds.is_some()).count();
        let n_held = lines.iter().filter(|line| line.holds == Some(true)).count();
        let asked = |case: &&Case| rows.iter().any(|row| row.case == case.name);
        Self {
            holds: n_held == n_judged,
            n_held,
            n_judged,
            n_shown: lines.len() - n_judged,
            quick: effort == Effort::Quick,
            wall_s,
            cases: cases.iter().filter(asked).map(Question::of).collect(),
            rows: lines,
        }
    }
}

impl Question {
    pub fn of(case: &Case) -> Self {
        Self { name: case.name.clone(), family: case.family.name(), what: case.what.clone(), source: case.source.clone() }
    }
}

impl Line {
    fn of(row: &Row) -> Self {
        // A number that is not finite is in no file; the row says so in words.
        let [error_m, error_rad, error_ratio] = row.errors.entries().map(|error| error.filter(|error| error.is_finite()));
        let [bound_m, bound_rad, bound_ratio] = row.bounds.entries();
        let (expected, expected_order) = match row.expected {
            Expected::Order(order) => ("order", Some(order)),
            Expected::Within(power) => ("within", (power > 0.0).then_some(power)),
            Expected::Exact => ("exact", None),
        };
        let (holds, missed) = match &row.outcome {
            Outcome::Holds => (Some(true), None),
            Outcome::Misses(why) => (Some(false), Some(why.clone())),
            Outcome::Shown => (None, None),
        };
        Self {
            case: row.case.clone(),
            family: row.family.name(),
            backend: row.method.short_name,
            extrapolated: row.kind == RowKind::Extrapolated,
            step_s: row.step_s,
            error_m,
            error_rad,
            error_ratio,
            bound_m,
            bound_rad,
            bound_ratio,
            tolerance_m: row.tolerance_m,
            order: row.order,
            expected,
            expected_order,
            holds,
            missed,
            reason: row.reason.clone(),
            source: row.source.clone(),
        }
    }

    /// The step, or the tolerance in its place.
    fn level(&self) -> String {
        let tolerance = self.tolerance_m.map(|tolerance| quantity(tolerance, "m"));
        tolerance.or(self.step_s.map(|step| quantity(step, "s"))).unwrap_or_default()
    }

    /// Largest error over its bound (1); `None` where no bound is above zero.
    fn share_of_bound(&self) -> Option<f64> {
        let pairs = [(self.error_m, self.bound_m), (self.error_rad, self.bound_rad), (self.error_ratio, self.bound_ratio)];
        let shares = pairs.into_iter().filter_map(|(error, bound)| Some(error? / bound.filter(|bound| *bound > 0.0)?));
        shares.reduce(f64::max)
    }

    /// Cells of the table for people.
    fn cells(&self) -> [String; 7] {
        let step = if self.extrapolated { "-> 0".to_owned() } else { self.level() };
        let errors = Errors { metres: self.error_m, radians: self.error_rad, ratio: self.error_ratio };
        let bounds = Errors { metres: self.bound_m, radians: self.bound_rad, ratio: self.bound_ratio };
        let expected = match (self.expected, self.expected_order) {
            (_, _) if self.extrapolated || self.holds.is_none() => String::new(),
            _ if self.tolerance_m.is_some() => "within".to_owned(),
            ("within", Some(power)) => format!("<= h^{power}"),
            (_, Some(order)) => format!("{order}"),
            ("within", None) => "bound".to_owned(),
            (kind, None) => kind.to_owned(),
        };
        let outcome = match (self.holds, &self.missed) {
            (Some(true), _) => "holds".to_owned(),
            (None, _) => "shown".to_owned(),
            (_, why) => format!("MISSES: {}", why.as_deref().unwrap_or_default()),
        };
        let order = self.order.map_or(String::new(), |order| format!("{order:.2}"));
        [self.backend.to_owned(), step, in_print(&errors), in_print(&bounds), order, expected, outcome]
    }
}

/// Errors with their units.
fn in_print(errors: &Errors) -> String {
    let parts = errors.entries().into_iter().zip(["m", "rad", ""]);
    let parts: Vec<String> = parts.filter_map(|(error, unit)| Some(quantity(error?, unit))).collect();
    parts.join(", ")
}

/// Text for people: whether the answers hold, a line a family, and what missed. Full detail adds a
/// table of all rows.
pub fn verify_text(found: &Verification, detail: Detail) -> String {
    let mut text = summary(found) + "\n";
    match detail {
        Detail::Brief => text += &families(found),
        Detail::Full => text += &all_rows(found),
    }
    for row in found.rows.iter().filter(|row| row.holds == Some(false)) {
        let (step, why) = (row.level(), row.missed.as_deref().unwrap_or_default());
        writeln!(text, "missed: {} by {} at {step}: {why} (bound: {})", row.case, row.backend, row.reason).expect("a string takes all");
    }
    text
}

/// The verification as a test suite, with a case for each row.
pub fn verify_suite(found: &Verification) -> junit::Suite {
    let case = |row: &Line| {
        let limit = if row.extrapolated { ", extrapolated" } else { "" };
        let outcome = match row.holds {
            Some(true) => junit::Outcome::Passed,
            Some(false) => {
                let [_, _, error, bound, ..] = row.cells();
                let details = format!("error {error}, bound {bound}: {} ({})", row.reason, row.source);
                junit::Outcome::Failed(row.missed.clone().unwrap_or_default(), details)
            }
            None => junit::Outcome::Skipped("rapier with its engine defaults is not judged".to_owned()),
        };
        let name = format!("{} by {} at {}{limit}", row.case, row.backend, row.level());
        junit::Case { class: format!("verify.{}", row.family), name, outcome }
    };
    junit::Suite { name: "cohaul verify".to_owned(), wall_s: found.wall_s, cases: found.rows.iter().map(case).collect() }
}

/// A line a family: rows that hold, and how close the largest error comes to its bound.
fn families(found: &Verification) -> String {
    let mut table = Table::new("", ["family", "cases", "rows that hold", "largest error / bound"]);
    for family in found.cases.chunk_by(|one, next| one.family == next.family) {
        let name = family[0].family;
        let judged = || found.rows.iter().filter(|row| row.family == name && row.holds.is_some());
        let n_held = judged().filter(|row| row.holds == Some(true)).count();
        let share = judged().filter_map(Line::share_of_bound).fold(0.0, f64::max);
        table.push([name.to_owned(), family.len().to_string(), format!("{n_held} of {}", judged().count()), format!("{share:.2}")]);
    }
    table.text()
}

/// All rows, case by case.
fn all_rows(found: &Verification) -> String {
    let mut table = Table::new("", ["case", "method", "step", "error", "bound", "order", "expected", "outcome"]);
    found.rows.iter().for_each(|row| table.push([row.case.clone()].into_iter().chain(row.cells())));
    table.text()
}

fn summary(found: &Verification) -> String {
    let answer = if found.holds { "All known answers hold" } else { "Some known answers are missed" };
    let shown = match found.n_shown {
        0 => String::new(),
        n => format!("{n} rows of rapier with its engine defaults are shown and not judged.\n"),
    };
    format!("{answer}: {} of {} rows.\n{shown}wall time {}\n", found.n_held, found.n_judged, quantity(found.wall_s, "s"))
}

/// Names of the cases and what they ask.
pub fn list_text(cases: &[Case]) -> String {
    let cells = |case: &Case| [case.family.name().to_owned(), case.name.clone(), case.what.clone()];
    cases.iter().fold(Table::list(), |table, case| table.row(cells(case))).text()
}

/// Writes `verify.json`, `verify.csv`, `convergence.svg` and `manifest.json` to the folder
/// `target`, all or nothing.
///
/// # Errors
/// When the folder may not be written, or the disk fails.
pub fn write_verification(target: &Path, found: &Verification, rows: &[Row], manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write_json("verify.json", found)?;
    folder.write("verify.csv", |out| write_rows(&found.rows, out))?;
    folder.write("convergence.svg", |out| out.write_all(figure::convergence(rows).as_bytes()))?;
    folder.finish(manifest)
}
