//! A verification for programs, for people and as files.

use std::fmt::Write;
use std::path::Path;

use serde::{Serialize, Serializer};

use crate::verify::figure;
use crate::verify::{Case, Effort, Errors, Expected, Outcome, Row, RowKind};
use cohaul::analysis::compare::EngineName;
use cohaul::formats::{self, Format, Versioned};
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::junit;
use cohaul_report::manifest::Manifest;
use cohaul_report::quantity::quantity;
use cohaul_report::table::Table;
use cohaul_report::text::Detail;

/// What `verify --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verification {
    pub holds: bool,
    /// The engine of the user that was asked, if one was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engine: Option<EngineName>,
    /// Rows that hold, and rows that could have missed.
    pub n_held: usize,
    pub n_judged: usize,
    /// Rows for information only, and of scenes that the engine refuses.
    pub n_shown: usize,
    pub quick: bool,
    pub wall_s: f64,
    pub cases: Table,
    #[serde(serialize_with = "as_table")]
    pub rows: Vec<Row>,
}

impl Versioned for Verification {
    const FORMAT: Format = formats::VERIFY;
}

impl Verification {
    /// Summary of the `rows` of `cases`; cases without any row are left out.
    pub fn new(cases: &[Case], rows: &[Row], effort: Effort, wall_s: f64) -> Self {
        let n_judged = rows.iter().filter(|row| row.outcome.is_judged()).count();
        let n_held = rows.iter().filter(|row| row.outcome == Outcome::Holds).count();
        let asked = |case: &&Case| rows.iter().any(|row| row.case == case.name);
        Self {
            holds: n_held == n_judged && n_judged > 0,
            engine: None,
            n_held,
            n_judged,
            n_shown: rows.len() - n_judged,
            quick: effort == Effort::Quick,
            wall_s,
            cases: questions(&cases.iter().filter(asked).collect::<Vec<_>>()),
            rows: rows.to_vec(),
        }
    }
}

/// What the cases ask.
fn questions(cases: &[&Case]) -> Table {
    Table::of(
        cases,
        &[
            ("name", "", &|case| case.name.as_str().into()),
            ("family", "", &|case| case.family.name().into()),
            ("what", "", &|case| case.what.as_str().into()),
            ("source", "", &|case| case.source.as_str().into()),
        ],
    )
}

fn as_table<S: Serializer>(rows: &[Row], serializer: S) -> Result<S::Ok, S::Error> {
    table(rows).serialize(serializer)
}

/// Columns of `verify.csv`; an empty field, in JSON `null`, where there is no number.
fn table(rows: &[Row]) -> Table {
    let error = |at: usize| move |row: &Row| finite(&row.errors)[at].into();
    let [metres, radians, ratio] = [0, 1, 2].map(error);
    Table::of(
        rows,
        &[
            ("case", "", &|row| row.case.as_str().into()),
            ("family", "", &|row| row.family.name().into()),
            ("backend", "", &|row| row.method.short_name.into()),
            ("extrapolated", "", &|row| (row.kind == RowKind::Extrapolated).into()),
            ("step", "s", &|row| row.step_s.into()),
            ("error", "m", &metres),
            ("error", "rad", &radians),
            ("error ratio", "", &ratio),
            ("bound", "m", &|row| row.bounds.metres.into()),
            ("bound", "rad", &|row| row.bounds.radians.into()),
            ("bound ratio", "", &|row| row.bounds.ratio.into()),
            ("tolerance", "m", &|row| row.tolerance_m.into()),
            ("order", "", &|row| row.order.into()),
            ("expected", "", &|row| row.expected.name().into()),
            ("expected order", "", &|row| Some(row.expected.power()).filter(|power| *power > 0.0).into()),
            ("holds", "", &|row| row.outcome.is_judged().then_some(row.outcome == Outcome::Holds).into()),
            ("missed", "", &|row| row.outcome.missed().into()),
            ("refused", "", &|row| row.outcome.refused().into()),
            ("reason", "", &|row| row.reason.as_str().into()),
            ("source", "", &|row| row.source.as_str().into()),
        ],
    )
}

/// A number that is not finite is in no file; the row says so in words.
fn finite(errors: &Errors) -> [Option<f64>; 3] {
    errors.entries().map(|error| error.filter(|error| error.is_finite()))
}

/// The step, or the tolerance in its place.
fn level(row: &Row) -> String {
    let tolerance = row.tolerance_m.map(|tolerance| quantity(tolerance, "m"));
    tolerance.or(row.step_s.map(|step| quantity(step, "s"))).unwrap_or_default()
}

/// Largest error over its bound (1); `None` where no bound is above zero.
fn share_of_bound(row: &Row) -> Option<f64> {
    let pairs = finite(&row.errors).into_iter().zip(row.bounds.entries());
    pairs.filter_map(|(error, bound)| Some(error? / bound.filter(|bound| *bound > 0.0)?)).reduce(f64::max)
}

/// Cells of the table for people.
fn cells(row: &Row) -> [String; 8] {
    let step = if row.kind == RowKind::Extrapolated { "-> 0".to_owned() } else { level(row) };
    let expected = match row.expected {
        _ if row.kind == RowKind::Extrapolated || row.outcome == Outcome::Shown => String::new(),
        _ if row.tolerance_m.is_some() => "within".to_owned(),
        Expected::Within(power) if power > 0.0 => format!("<= h^{power}"),
        Expected::Within(_) => "bound".to_owned(),
        Expected::Order(order) => format!("{order}"),
        Expected::Exact => "exact".to_owned(),
    };
    let outcome = match &row.outcome {
        Outcome::Holds => "holds".to_owned(),
        Outcome::Shown => "shown".to_owned(),
        Outcome::Misses(why) => format!("MISSES: {why}"),
        Outcome::Refused(why) => format!("refused: {why}"),
    };
    let order = row.order.map_or(String::new(), |order| format!("{order:.2}"));
    [row.case.clone(), row.method.short_name.to_owned(), step, in_print(&row.errors), in_print(&row.bounds), order, expected, outcome]
}

/// Errors with their units.
fn in_print(errors: &Errors) -> String {
    let parts = finite(errors).into_iter().zip(["m", "rad", ""]);
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
    for (row, why) in found.rows.iter().filter_map(|row| Some((row, row.outcome.missed()?))) {
        let (method, step) = (row.method.short_name, level(row));
        writeln!(text, "missed: {} by {method} at {step}: {why} (bound: {})", row.case, row.reason).expect("a string takes all");
    }
    text
}

/// The verification as a test suite, with a case for each row.
pub fn verify_suite(found: &Verification) -> junit::Suite {
    let case = |row: &Row| {
        let limit = if row.kind == RowKind::Extrapolated { ", extrapolated" } else { "" };
        let outcome = match &row.outcome {
            Outcome::Holds => junit::Outcome::Passed,
            Outcome::Misses(why) => {
                let (error, bound) = (in_print(&row.errors), in_print(&row.bounds));
                let details = format!("error {error}, bound {bound}: {} ({})", row.reason, row.source);
                junit::Outcome::Failed(why.clone(), details)
            }
            Outcome::Shown => junit::Outcome::Skipped("rapier with its engine defaults is not judged".to_owned()),
            Outcome::Refused(why) => junit::Outcome::Skipped(why.clone()),
        };
        let name = format!("{} by {} at {}{limit}", row.case, row.method.short_name, level(row));
        junit::Case { class: format!("verify.{}", row.family.name()), name, outcome }
    };
    junit::Suite { name: "cohaul verify".to_owned(), wall_s: found.wall_s, cases: found.rows.iter().map(case).collect() }
}

/// A line a family: rows that hold, and how close the largest error comes to its bound.
fn families(found: &Verification) -> String {
    let mut table = Table::new("", ["family", "cases", "rows that hold", "largest error / bound"]);
    for rows in found.rows.chunk_by(|one, next| one.family == next.family) {
        let n_cases = rows.chunk_by(|one, next| one.case == next.case).count();
        let judged = || rows.iter().filter(|row| row.outcome.is_judged());
        let n_held = judged().filter(|row| row.outcome == Outcome::Holds).count();
        let share = judged().filter_map(share_of_bound).fold(0.0, f64::max);
        let held = format!("{n_held} of {}", judged().count());
        table.push([rows[0].family.name().to_owned(), n_cases.to_string(), held, format!("{share:.2}")]);
    }
    table.text()
}

fn all_rows(found: &Verification) -> String {
    let head = ["case", "method", "step", "error", "bound", "order", "expected", "outcome"];
    Table::new("", head).with_rows(found.rows.iter().map(cells)).text()
}

fn summary(found: &Verification) -> String {
    let by = found.engine.as_ref().map_or(String::new(), |engine| format!(" by {}", engine.text()));
    let answer = match found.holds {
        true => format!("All known answers hold{by}"),
        false if found.n_judged == 0 => format!("No known answer was found{by}"),
        false => format!("Some known answers are missed{by}"),
    };
    let shown = match found.n_shown {
        0 => String::new(),
        n if found.engine.is_some() => format!("{n} rows are of scenes that the engine refuses.\n"),
        n => format!("{n} rows of rapier with its engine defaults are shown and not judged.\n"),
    };
    format!("{answer}: {} of {} rows.\n{shown}wall time {}\n", found.n_held, found.n_judged, quantity(found.wall_s, "s"))
}

pub fn list_text(cases: &[Case]) -> String {
    let cells = |case: &Case| [case.family.name().to_owned(), case.name.clone(), case.what.clone()];
    cases.iter().fold(Table::list(), |table, case| table.row(cells(case))).text()
}

/// Writes `verify.json`, `verify.csv`, `convergence.svg` and `manifest.json` to the folder
/// `target`, all or nothing.
///
/// # Errors
/// When the folder may not be written, or the disk fails.
pub fn write_verification(target: &Path, found: &Verification, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write_json("verify.json", found)?;
    folder.write("verify.csv", |out| table(&found.rows).write_csv(out))?;
    folder.write("convergence.svg", |out| out.write_all(figure::convergence(&found.rows).as_bytes()))?;
    folder.finish(manifest)
}
