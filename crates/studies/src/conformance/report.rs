//! A conformance table for programs and for people.

use serde::Serialize;

use super::grade::{Grade, MEANING};
use super::test::{Answer, Measure, Outcome, Test};
use cohaul::analysis::compare::EngineName;
use cohaul::formats::{self, Format, Versioned};
use cohaul_report::junit;
use cohaul_report::quantity::{number, quantity, short, short_quantity};
use cohaul_report::table::{Table, wrapped};
use cohaul_report::text::{Detail, WIDTH, wrapped_markdown};

/// What `conformance --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Conformance {
    pub answer: String,
    /// The answer in one line, for the page of an engine.
    pub line: String,
    pub engine: EngineName,
    /// Longest step of the engine (s).
    pub step_s: f64,
    pub counts: Counts,
    pub tests: Vec<Row>,
}

/// Number of tests by what came of them. A test counts by its worst number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    pub all: usize,
    pub exact: usize,
    pub to_1_percent: usize,
    pub to_10_percent: usize,
    pub beyond: usize,
    pub refused: usize,
    pub failed: usize,
}

/// A test and its answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    pub key: &'static str,
    pub name: &'static str,
    pub what: &'static str,
    pub source: &'static str,
    pub meaning: &'static str,
    pub outcome: Outcome,
    /// The worst grade of the numbers; `null` where there are none.
    pub grade: Option<Grade>,
    /// Why there are no numbers; else `null`.
    pub why: Option<String>,
    /// What to know beside the numbers; `null` if nothing.
    pub note: Option<String>,
    pub measures: Vec<Measure>,
}

impl Versioned for Conformance {
    const FORMAT: Format = formats::CONFORMANCE;
}

impl Counts {
    fn of(rows: &[Row]) -> Self {
        let graded = |grade| rows.iter().filter(|row| row.grade == Some(grade)).count();
        let ended = |outcome| rows.iter().filter(|row| row.outcome == outcome).count();
        let [exact, to_1_percent, to_10_percent, beyond] = Grade::ALL.map(graded);
        let [refused, failed] = [Outcome::Refused, Outcome::Failed].map(ended);
        Self { all: rows.len(), exact, to_1_percent, to_10_percent, beyond, refused, failed }
    }
}

impl Conformance {
    /// The `answers` of an engine to `tests`, in their order.
    pub fn new(engine: EngineName, step_s: f64, tests: &[Test], answers: Vec<Answer>) -> Self {
        let row = |(test, answer): (&Test, Answer)| {
            let Test { key, name, what, source, meaning, .. } = *test;
            let Answer { outcome, why, note, grade, measures, .. } = answer;
            Row { key, name, what, source, meaning, outcome, grade, why, note, measures }
        };
        let tests: Vec<Row> = tests.iter().zip(answers).map(row).collect();
        let counts = Counts::of(&tests);
        let named = engine.text();
        let line = format!("cohaul conformance: {}; {named} at {}", in_words(&counts), short_quantity(step_s, "s"));
        let answer = format!("{named} at {}: {}.", short_quantity(step_s, "s"), in_words(&counts));
        Self { answer, line, engine, step_s, counts, tests }
    }

    /// Whether nothing failed. Refusals and large errors are no failures.
    pub fn is_computed(&self) -> bool {
        self.counts.failed == 0
    }

    /// A row a number, as people read it.
    pub fn table(&self) -> Table {
        let head = ["test", "quantity", "known", "found", "error", "grade"];
        Table::new("Known answers", head).with_rows(self.tests.iter().flat_map(lines))
    }

    /// What each test asks, and what its answer means to a user.
    pub fn questions(&self) -> Table {
        let row = |row: &Row| [row.key.to_owned(), upper(row.what), row.source.to_owned(), row.meaning.to_owned()];
        Table::new("Questions", ["test", "question", "known answer", "it tells"]).with_rows(self.tests.iter().map(row))
    }
}

fn in_words(counts: &Counts) -> String {
    let Counts { all, exact, to_1_percent, to_10_percent, beyond, refused, failed } = *counts;
    let parts = [(to_10_percent, "to 10 %"), (beyond, "beyond"), (refused, "refused"), (failed, "failed")];
    let parts: Vec<String> = parts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!(", {n} {what}")).collect();
    format!("{} of {all} answers within 1 % ({exact} exact){}", exact + to_1_percent, parts.concat())
}

fn upper(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Cells of a test: a line a number, or one that says why there is none.
fn lines(row: &Row) -> Vec<[String; 6]> {
    let title = format!("{} {}", row.key, row.name);
    if let Some(why) = &row.why {
        let word = if row.outcome == Outcome::Refused { "refused" } else { "failed" };
        return vec![[title, String::new(), String::new(), String::new(), String::new(), format!("{word}: {why}")]];
    }
    let cells = |(at, measure): (usize, &Measure)| {
        let Measure { known, found, relative_error, grade, unit, .. } = measure;
        let note = row.note.iter().filter(|_| at == 0).map(|note| format!("; {note}")).collect::<String>();
        let title = if at == 0 { title.clone() } else { String::new() };
        let grade = format!("{}{note}", grade.name());
        [title, measure.name.clone(), quantity(*known, unit), quantity(rounded(measure, *found), unit), percent(*relative_error), grade]
    };
    row.measures.iter().enumerate().map(cells).collect()
}

/// A number that should be zero, without its rounding.
fn rounded(measure: &Measure, found: f64) -> f64 {
    if measure.known == 0.0 && measure.grade == Grade::Exact { 0.0 } else { found }
}

/// A relative error for people.
fn percent(share: f64) -> String {
    match Grade::of(share) {
        Grade::Exact => "0".to_owned(),
        _ if share.abs() < 1e-5 => format!("{:+.0e}", share),
        _ if share.abs() > 10.0 => format!("{} times", number(share)),
        _ => format!("{}{} %", if share > 0.0 { "+" } else { "" }, short(100.0 * share)),
    }
}

/// Text for people: the answer and a line a number. Full detail adds what each test asks.
pub fn conformance_text(found: &Conformance, detail: Detail) -> String {
    let mut text = format!("{}\n\n{}", wrapped(&found.answer, 0, WIDTH), found.table().text_by(2));
    text += &format!("\n{}\n", wrapped(MEANING, 0, WIDTH));
    if detail == Detail::Full {
        for row in &found.tests {
            let asked = format!("{} {}: {}. Known: {}. It tells {}.", row.key, row.name, row.what, row.source, row.meaning);
            text += &format!("\n{}\n", wrapped(&asked, 2, WIDTH - 2));
        }
    }
    text + &format!("\nFor a README:\n{}\n", wrapped(&found.line, 2, WIDTH - 2))
}

/// The table as Markdown, to be kept beside an engine.
pub fn conformance_markdown(found: &Conformance) -> String {
    let title = format!("# Conformance of {}", found.engine.text());
    let [table, questions] = [found.table(), found.questions()].map(|table| table.markdown());
    wrapped_markdown(&format!("{title}\n\n{}\n\n{table}\n{MEANING}\n\n## Questions\n\n{questions}", found.answer))
}

/// The tests as a suite. A large error is a result and passes; only what fails fails.
pub fn conformance_suite(found: &Conformance, wall_s: f64) -> junit::Suite {
    let case = |row: &Row| {
        let why = row.why.clone().unwrap_or_default();
        let outcome = match row.outcome {
            Outcome::Answered => junit::Outcome::Passed,
            Outcome::Refused => junit::Outcome::Skipped(why),
            Outcome::Failed => junit::Outcome::Error(why),
        };
        junit::Case { class: "conformance".to_owned(), name: format!("{} {}", row.key, row.name), outcome }
    };
    junit::Suite { name: "cohaul conformance".to_owned(), wall_s, cases: found.tests.iter().map(case).collect() }
}
