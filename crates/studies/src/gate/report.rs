//! What a gate found, for programs, people, pull requests and continuous integration.

use std::path::Path;

use serde::Serialize;

use super::change::{Change, QuantityChange, SceneChange};
use super::record::Record;
use cohaul::analysis::compare::EngineName;
use cohaul::formats::{self, Format, Versioned};
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::junit;
use cohaul_report::manifest::Manifest;
use cohaul_report::quantity::short_quantity;
use cohaul_report::table::{Table, wrapped};
use cohaul_report::text::{WIDTH, wrapped_markdown};

/// What `gate --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gate {
    pub answer: String,
    /// The build whose errors are stored.
    pub stored: Build,
    /// The build that was run.
    pub now: Build,
    /// Least change that counts, over the stored error (1).
    pub margin: f64,
    pub n_better: usize,
    pub n_same: usize,
    pub n_worse: usize,
    /// Scenes on which the new build failed, which are worse too.
    pub n_failed: usize,
    pub scenes: Vec<SceneChange>,
}

/// A build of an engine, and of the program that found its errors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Build {
    pub engine: EngineName,
    pub cohaul: String,
    /// Longest step (s); `null` for the default of each scene.
    pub step_s: Option<f64>,
}

impl Versioned for Gate {
    const FORMAT: Format = formats::GATE;
}

impl Build {
    fn of(record: &Record) -> Self {
        Self { engine: record.engine.clone(), cohaul: record.cohaul.clone(), step_s: record.step_s }
    }

    fn text(&self) -> String {
        let step = self.step_s.map_or(String::new(), |step| format!(", step {}", short_quantity(step, "s")));
        format!("{} (cohaul {}{step})", self.engine.text(), self.cohaul)
    }
}

impl Gate {
    /// The change from stored errors to new ones on the same scenes, in their order.
    pub fn new(stored: &Record, now: &Record, margin: f64) -> Self {
        let change = |(stored, now)| SceneChange::of(stored, now, margin);
        let scenes: Vec<SceneChange> = stored.scenes.iter().zip(&now.scenes).map(change).collect();
        let n = |change| scenes.iter().filter(|scene| scene.change == change).count();
        let [n_better, n_same, n_worse] = Change::ALL.map(n);
        let n_failed = scenes.iter().filter(|scene| scene.failed).count();
        let verdict = match (n_worse, n_better) {
            (0, 0) => "nothing changed".to_owned(),
            (0, _) => format!("better on {n_better} of {} scenes, worse on none", scenes.len()),
            _ => format!("worse on {n_worse} of {} scenes, better on {n_better}", scenes.len()),
        };
        let (stored, now) = (Build::of(stored), Build::of(now));
        let answer = format!("{}, compared with {}: {verdict}.", now.engine.text(), stored.engine.text());
        Self { answer, stored, now, margin, n_better, n_same, n_worse, n_failed, scenes }
    }

    /// Whether nothing is worse.
    pub fn passes(&self) -> bool {
        self.n_worse == 0
    }

    /// A row a scene: what became of each quantity.
    fn overview(&self) -> Table {
        let mut names: Vec<&str> = Vec::new();
        for of in self.scenes.iter().flat_map(|scene| &scene.quantities) {
            if !names.contains(&&*of.quantity) {
                names.push(&of.quantity);
            }
        }
        let cells = |scene: &SceneChange| {
            let word = |name: &&str| scene.quantities.iter().find(|of| of.quantity == **name).map_or("", |of| of.change.name()).to_owned();
            let whole = scene.why.clone().unwrap_or_else(|| scene.change.name().to_owned());
            [scene.scene.clone()].into_iter().chain(names.iter().map(word)).chain([whole]).collect::<Vec<_>>()
        };
        let head = ["scene"].into_iter().chain(names.iter().copied()).chain(["in all"]);
        Table::new("Scenes", head).with_rows(self.scenes.iter().map(cells))
    }

    /// A row for each error that changed.
    fn changed(&self) -> Table {
        let mut table = Table::new("Errors that changed", ["scene", "quantity", "error of", "stored", "now", "same up to", "change"]);
        for (scene, of) in self.scenes.iter().flat_map(|scene| scene.quantities.iter().map(move |of| (scene, of))) {
            for error in of.errors.iter().filter(|error| error.change != Change::Same) {
                let [stored, now, allowed] = [error.stored, error.now, error.allowed].map(|value| short_quantity(value, &of.unit));
                let change = error.change.name().to_owned();
                table.push([scene.scene.clone(), of.quantity.clone(), error.name.clone(), stored, now, allowed, change]);
            }
        }
        table
    }

    fn builds(&self) -> String {
        format!("Stored: {}. Now: {}.", self.stored.text(), self.now.text())
    }

    fn rule(&self) -> String {
        format!(
            "An error is the same if it changes by no more than the reference errors of both builds, rounding, and {} % of itself.",
            100.0 * self.margin
        )
    }
}

/// Text for people.
pub fn gate_text(found: &Gate) -> String {
    let prose = |text: &str| wrapped(text, 0, WIDTH);
    let mut text = format!("{}\n\n{}\n\n{}", prose(&found.answer), prose(&found.builds()), found.overview().text_by(1));
    let changed = found.changed();
    if !changed.rows.is_empty() {
        text += &format!("\nErrors that changed\n{}", changed.text_by(3));
    }
    text + &format!("\n{}\n", prose(&found.rule()))
}

/// A comment for a pull request.
pub fn gate_markdown(found: &Gate) -> String {
    let changed = found.changed();
    let details = if changed.rows.is_empty() { String::new() } else { format!("\n### Errors that changed\n\n{}", changed.markdown()) };
    let head = format!("## cohaul gate\n\n**{}**\n\n{}\n", found.answer, found.builds());
    wrapped_markdown(&format!("{head}\n{}{details}\n{}\n", found.overview().markdown(), found.rule()))
}

/// Writes `summary.json`, `gate.md` and `manifest.json` to the folder `target`, or nothing.
///
/// # Errors
/// If the folder may not be written, a number is not finite, or the disk fails.
pub fn write_gate(target: &Path, found: &Gate, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write_json("summary.json", found)?;
    folder.write("gate.md", |out| out.write_all(gate_markdown(found).as_bytes()))?;
    folder.finish(manifest)
}

/// A case a scene and quantity.
pub fn gate_suite(found: &Gate, wall_s: f64) -> junit::Suite {
    let case = |scene: &SceneChange, name: &str, outcome| junit::Case {
        class: format!("gate.{}", found.now.engine.name),
        name: if name.is_empty() { scene.scene.clone() } else { format!("{}: {name}", scene.scene) },
        outcome,
    };
    let whole = |scene: &SceneChange| {
        let why = scene.why.clone().unwrap_or_default();
        let outcome = match scene.change {
            _ if scene.failed => junit::Outcome::Error(why),
            Change::Worse => junit::Outcome::Failed(why.clone(), why),
            Change::Same => junit::Outcome::Skipped(why),
            Change::Better => junit::Outcome::Passed,
        };
        case(scene, "", outcome)
    };
    let cases = found.scenes.iter().flat_map(|scene| match &scene.why {
        Some(_) => vec![whole(scene)],
        None => scene.quantities.iter().map(|of| case(scene, &of.quantity, outcome(of))).collect(),
    });
    junit::Suite { name: "cohaul gate".to_owned(), wall_s, cases: cases.collect() }
}

fn outcome(of: &QuantityChange) -> junit::Outcome {
    if of.change != Change::Worse {
        return junit::Outcome::Passed;
    }
    let line = |error: &super::change::MeasureChange| {
        let [stored, now, allowed] = [error.stored, error.now, error.allowed].map(|value| short_quantity(value, &of.unit));
        format!("{}: stored {stored}, now {now}, same up to {allowed}", error.name)
    };
    let lines: Vec<String> = of.errors.iter().filter(|error| error.change == Change::Worse).map(line).collect();
    let why = of.why.clone().unwrap_or_else(|| "the error is worse".to_owned());
    junit::Outcome::Failed(why, lines.join("\n"))
}
