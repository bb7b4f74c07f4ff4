//! The output folder of a colony, with its page.

use std::path::Path;

use super::figure::{Figure, figures};
use super::recorded::Recorded;
use super::report::Colony;
use super::text::{backends, changes, colony_text, group_sizes, keys, quantities};
use crate::calibrate::Force;
use crate::calibrate::behaviour::{release_figure, release_table};
use crate::calibrate::files::force_table;
use cohaul::formats;
use cohaul::scenario::Scenario;
use cohaul::scenario::format::ScenarioFile;
use cohaul::simulation::Row;
use cohaul_report::chart::print::write_for_print;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::json;
use cohaul_report::manifest::Manifest;
use cohaul_report::page::{Answer, Block, Headline, Number, Page, REPORT};
use cohaul_report::quantity::quantity;
use cohaul_report::table::Table;

/// Name of the scenario of the fitted ants.
pub const SCENARIO: &str = "scenario.json";

/// What an output folder shows beside the results.
pub struct Shown<'a> {
    pub recorded: &'a Recorded,
    pub forces: &'a [Force],
    pub fitted: &'a Scenario,
    /// Frames of one run of the fitted ants, and the time between them (s).
    pub run: &'a [Row],
    pub run_period: f64,
}

/// The scenario as a file: every key written, under the names of the format.
///
/// # Errors
/// When a number is not finite.
pub fn scenario_text(fitted: &Scenario) -> Result<String, json::NotFinite> {
    json::pretty(&ScenarioFile { format: Some(formats::SCENARIO.version), ..fitted.expanded() })
}

/// Writes `report.html`, `scenario.json`, `colony.json`, `colony.txt`, `group-size.csv`,
/// `series.csv`, `forces.csv`, `releases.csv`, the figures as SVG and for print, and
/// `manifest.json` to the folder `target`, all or nothing.
///
/// # Errors
/// When the folder may not be written, a number is not finite, or the disk fails.
pub fn write_colony(target: &Path, found: &Colony, shown: &Shown, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    let figures = figures(found, shown.recorded, shown.run, shown.run_period, shown.fitted);
    let text = scenario_text(shown.fitted).map_err(|error| folder.in_content(SCENARIO, error))?;
    folder.write(SCENARIO, |out| out.write_all(text.as_bytes()))?;
    folder.write_json("colony.json", found)?;
    folder.write("colony.txt", |out| out.write_all(colony_text(found).as_bytes()))?;
    folder.write("group-size.csv", |out| group_size_table(found).write_csv(out))?;
    folder.write("series.csv", |out| series_table(shown.recorded).write_csv(out))?;
    folder.write("forces.csv", |out| force_table(shown.forces).write_csv(out))?;
    for figure in &figures {
        folder.write(&format!("{}.svg", figure.name), |out| out.write_all(figure.svg().as_bytes()))?;
        write_for_print(&mut folder, figure.name, |width| figure.for_print(width))?;
    }
    if let Some(release) = &found.behaviour.release {
        folder.write("releases.csv", |out| release_table(release).write_csv(out))?;
        folder.write("releases.svg", |out| out.write_all(release_figure(release, found.behaviour.pace).as_bytes()))?;
    }
    folder.write(REPORT, |out| out.write_all(page(found, &figures, manifest).to_html().as_bytes()))?;
    folder.finish(manifest)
}

fn page(found: &Colony, figures: &[Figure], manifest: &Manifest) -> Page {
    let facts = &found.recording;
    let numbers = vec![
        Number::new("recording", quantity(facts.duration_s, "s"), format!("{} frames", facts.n_frames)),
        Number::new("attachments", found.behaviour.n_attachments.to_string(), format!("{} releases", found.behaviour.n_releases)),
        Number::new("pulling ants", facts.most_held.to_string(), "at most, at once"),
    ];
    let is_like = found.quantities.iter().all(|of| of.is_within != Some(false));
    let answer = if is_like { Answer::Yes } else { Answer::Partly };
    let drawn = figures.iter().map(|figure| Block::figure(figure.svg(), figure.caption));
    let release = found.behaviour.release.as_ref().map(|release| {
        Block::figure(release_figure(release, found.behaviour.pace), "Release rate against the pull: counted in bins, and the fitted law")
    });
    let warnings = (!found.warnings.is_empty()).then(|| Block::List(found.warnings.clone()));
    Page::new(format!("A colony on {}", found.scenario), Headline::new(answer, &*found.answer).with(Block::Numbers(numbers)))
        .from(manifest)
        .section("What to mind", warnings.into_iter().collect())
        .section("The fitted ants", [Block::Table(keys(&found.keys))].into_iter().chain(release).collect())
        .section("Beside the runs of the fitted ants and the paper", vec![Block::Table(quantities(&found.quantities)), Block::text(MARKS)])
        .section("The paper's figures", drawn.collect())
        .section("Tables", [group_sizes(found), changes(found), backends(found)].map(Block::Table).to_vec())
}

/// What the marks in the table of quantities mean.
const MARKS: &str = "A star marks a number of the recording outside of the range in which 95 % of further runs are expected. The paper's \
numbers stand for its own ants and load: the first is measured on ants, the second simulated.";

/// One row for each number of pulling ants.
fn group_size_table(found: &Colony) -> Table {
    Table::of(
        &found.group_size,
        &[
            ("n pulling", "", &|of| of.n_pulling.into()),
            ("recorded speed", "m/s", &|of| of.recorded.map(|of| of.mean_m_per_s).into()),
            ("recorded sd", "m/s", &|of| of.recorded.map(|of| of.sd_m_per_s).into()),
            ("recorded windows", "", &|of| of.recorded.map_or(0, |of| of.n_windows).into()),
            ("fitted speed", "m/s", &|of| of.fitted.map(|of| of.mean_m_per_s).into()),
            ("fitted sd", "m/s", &|of| of.fitted.map(|of| of.sd_m_per_s).into()),
            ("fitted windows", "", &|of| of.fitted.map_or(0, |of| of.n_windows).into()),
        ],
    )
}

/// The three series of the recording.
fn series_table(recorded: &Recorded) -> Table {
    let series = super::measures::series(&recorded.rows, recorded.period);
    let rows: Vec<usize> = (0..series.speed.len()).collect();
    Table::of(
        &rows,
        &[
            ("time", "s", &|at| (series.start_s + series.window_s * *at as f64).into()),
            ("load speed", "m/s", &|at| series.speed[*at].into()),
            ("turn rate", "rad/s", &|at| series.turn_rate[*at].into()),
            ("interaction", "N", &|at| series.interaction[*at].into()),
        ],
    )
}
