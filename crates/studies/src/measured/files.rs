//! The files of measured runs in an output folder.

use std::path::Path;

use super::figure::{figure, figure_for_print};
use super::recording::MeasuredRun;
use super::report::Measured;
use super::run::{Question, simulated};
use super::scene::{Prepared, SceneTemplate};
use super::smoothing::pose_at;
use super::text::{rows, runs, table};
use cohaul::backend::{BackendKind, EnergyLedger, Motion};
use cohaul::math::Twist;
use cohaul::simulation::{AttachedTips, Row, Trace};
use cohaul_report::chart::Labelled;
use cohaul_report::chart::bars::{Bar, bars};
use cohaul_report::chart::print::write_for_print;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::{Answer, Block, Headline, Page, REPORT, Replay};
use cohaul_report::quantity::{quantity, short_quantity};
use cohaul_report::table::Table;

/// The scene, its runs, and what was asked of them.
pub type Scenes<'a> = (&'a SceneTemplate, &'a [MeasuredRun], &'a Question);

/// Writes `report.html`, `runs.csv`, `runs.svg`, figures for print, `summary.json` and
/// `manifest.json` to the folder `target`, or nothing. The report replays the worst runs.
///
/// # Errors
/// If the folder may not be written, a number is not finite, or the disk fails.
pub fn write_measured(target: &Path, found: &Measured, scenes: Scenes, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write(REPORT, |out| out.write_all(measured_page(found, scenes, manifest).to_html().as_bytes()))?;
    folder.write("runs.csv", |out| runs(found).write_csv(out))?;
    folder.write("runs.svg", |out| out.write_all(figure(found).as_bytes()))?;
    write_for_print(&mut folder, "runs", |width| figure_for_print(found, width))?;
    folder.write_json("summary.json", found)?;
    folder.finish(manifest)
}

/// The report: the answer, the differences over the runs and of each, and replays of the worst.
pub fn measured_page(found: &Measured, scenes: Scenes, manifest: &Manifest) -> Page {
    let answer = if found.over_runs.is_some() { Answer::None } else { Answer::Open };
    let mut headline = Headline::new(answer, found.answer.clone());
    let mut numbers = Vec::new();
    if let Some(over) = &found.over_runs {
        let bar = |name: &str, value: f64| Bar { name: name.to_owned(), value, text: quantity(value, "m") };
        let mut all = vec![bar("model error", over.model_error_m.median), bar("inertia effect", over.inertia_effect_m.median)];
        all.extend(over.engine_error_m.map(|of| bar("engine error", of.median)));
        all.push(bar("reference error", over.reference_error_m.median));
        let limit = found.own_limit.map_or(0.0, |limit| limit.edge_displacement_m);
        let caption = "Medians over the runs of the largest edge displacements, that of the model error at the last pose (m).".to_owned();
        let svg = bars(&all, limit, &format!("the measurement's own limit: {}", short_quantity(limit, "m")));
        headline = headline.with(Block::Chart { svg, caption });
        numbers.push(Block::Table(table(over)));
    }
    let details = rows(found)
        .into_iter()
        .fold(Table::new("The recording and its runs", ["", "value"]), |table, row| table.row(<[String; 2]>::from(row)));
    numbers.push(Block::Table(details));
    let caption = "Differences of each run, and measured minus simulated position of each run at its last pose.";
    Page::new(format!("{}: measured and simulated", found.scenario), headline)
        .from(manifest)
        .section("Differences over the runs", numbers)
        .section(
            "Run by run",
            vec![
                Block::figure(figure(found), caption),
                Block::Folded { heading: "All runs".into(), blocks: vec![Block::Table(runs(found))] },
            ],
        )
        .section("The runs with the largest model errors", replays(found, scenes))
        .section("Terms", vec![Block::Terms])
}

/// The measured load beside the simulated one in each of the worst runs.
fn replays(found: &Measured, (template, runs, question): Scenes) -> Vec<Block> {
    let replay = |(at, name): (usize, &String)| {
        let run = runs.iter().find(|run| run.name == *name)?;
        let prepared = template.of_run(run, &question.preparation, 1.0).ok()?;
        let (trace, _) = simulated(&prepared, BackendKind::Inertial, &question.settings);
        let measured = measured_trace(run, &prepared, &trace);
        let labelled = [Labelled { label: "measured", trace: &measured }, Labelled { label: "inertial", trace: &trace }];
        let title = format!("Run {name}: measured (dashed) over simulated");
        let block = Block::Replay(Box::new(Replay::new(title, &prepared.scenario, &labelled, prepared.scenario.duration)));
        Some(if at == 0 { block } else { Block::Folded { heading: format!("Run {name}"), blocks: vec![block] } })
    };
    let mut blocks = vec![Block::text("Between two poses at which the load was seen, the measured load is drawn in a straight line.")];
    blocks.extend(found.worst.iter().enumerate().filter_map(replay));
    blocks
}

/// The measured poses at the times of a simulated run.
fn measured_trace(run: &MeasuredRun, prepared: &Prepared, simulated: &Trace) -> Trace {
    let row = |row: &Row| {
        let motion = Motion { pose: pose_at(&run.load.samples, row.time + prepared.begins_at), twist: Twist::ZERO };
        Row {
            time: row.time,
            motion,
            energy: EnergyLedger::default(),
            tips: AttachedTips::new(),
            contacts: Vec::new(),
            steered: Vec::new(),
            error: None,
        }
    };
    Trace { rows: simulated.rows.iter().map(row).collect(), ..Trace::default() }
}
