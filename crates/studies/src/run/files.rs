//! The files of one run in an output folder.

use std::path::Path;

use crate::run::page::run_page;
use crate::run::summary::RunSummary;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Row, Trace};
use cohaul_report::chart::shown::SeenRows;
use cohaul_report::chart::{self, Labelled, Scene};
use cohaul_report::folder::{FolderError, OutputFile, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::REPORT;
use cohaul_report::tips_csv::write_tips;
use cohaul_report::trace_csv;
use cohaul_report::trace_csv::{TraceColumns, TraceTable};
use cohaul_report::traces::{TraceFormat, write_trace};

/// What is written of a run, besides its rows.
#[derive(Clone, Copy, Debug)]
pub struct RunFiles<'a> {
    pub summary: &'a RunSummary<'a>,
    /// With its rows only where tips, a report or the format of the trace need them.
    pub trace: &'a Trace,
    pub with_tips: bool,
    pub scene: &'a Scene,
    pub manifest: &'a Manifest,
    /// Scenario of the report; `None` for no report, which takes longer to write than all else.
    pub report: Option<&'a Scenario>,
}

/// Real time of a run (s) from which its files are brought to the disk before they take their name.
const WORTH_WAITING: f64 = 1.0;

const TRACE: &str = "trace";
const TRACE_CSV: &str = "trace.csv";

/// The output folder of a run that goes on: rows are written as they come, and need not be kept.
pub struct RunWriter {
    folder: OutputFolder,
    /// `trace.csv`; `None` if the trace is written as a whole in another format.
    table: Option<TraceTable<OutputFile>>,
    columns: TraceColumns,
    format: TraceFormat,
    seen: SeenRows,
}

impl RunWriter {
    /// Begins the folder `target` and its trace. Dropped before [`RunWriter::finish`] it leaves
    /// nothing.
    ///
    /// # Errors
    /// When the folder may not be written (see [`cohaul_report::folder::check_target`]), or the
    /// disk fails.
    pub fn create(target: &Path, columns: TraceColumns, format: TraceFormat) -> Result<Self, FolderError> {
        let folder = OutputFolder::create(target)?;
        let table = if format == TraceFormat::Csv {
            Some(TraceTable::new(columns, folder.open(TRACE_CSV)?).map_err(|error| folder.in_content(TRACE_CSV, error))?)
        } else {
            None
        };
        Ok(Self { folder, table, columns, format, seen: SeenRows::default() })
    }

    /// Whether rows that were added may be forgotten.
    pub fn streams(&self) -> bool {
        self.table.is_some()
    }

    /// Writes the next rows.
    ///
    /// # Errors
    /// When a number in them is not finite, or the disk fails.
    pub fn add(&mut self, rows: &[Row]) -> Result<(), FolderError> {
        self.seen.add(rows);
        match &mut self.table {
            Some(table) => table.add(rows).map_err(|error| self.folder.in_content(TRACE_CSV, error)),
            None => Ok(()),
        }
    }

    /// Writes `summary.json`, `events.csv`, `transitions.csv`, `overview.svg`, `manifest.json` and,
    /// if asked for, `tips.csv` and `report.html`, and puts the folder in its place.
    ///
    /// A run of less than a second is not waited for until it is on the disk: see
    /// [`OutputFolder::unsynced`].
    ///
    /// # Errors
    /// When a number is not finite, or the disk fails.
    pub fn finish(self, files: &RunFiles) -> Result<(), FolderError> {
        let Self { folder, table, columns, format, seen } = self;
        let mut folder = if files.summary.run.wall_time.is_some_and(|time| time < WORTH_WAITING) { folder.unsynced() } else { folder };
        match table {
            Some(table) => {
                let table = table.finish().map_err(|error| folder.in_content(TRACE_CSV, error))?;
                folder.close(table)?;
            }
            None => write_trace(&mut folder, TRACE, (files.trace, columns), format, files.manifest)?,
        }
        folder.write_json("summary.json", files.summary)?;
        if files.with_tips {
            folder.write("tips.csv", |out| write_tips(files.trace, out))?;
        }
        folder.write("events.csv", |out| trace_csv::write_events(files.trace, out))?;
        folder.write("transitions.csv", |out| trace_csv::write_transitions(files.trace, out))?;
        let labelled = Labelled { label: files.summary.run.options.kind.name(), trace: files.trace };
        folder.write("overview.svg", |out| out.write_all(chart::overview_of_rows(&labelled, &seen, files.scene).as_bytes()))?;
        if let Some(scenario) = files.report {
            let page = run_page(files.summary, files.trace, scenario, files.manifest);
            folder.write(REPORT, |out| out.write_all(page.to_html().as_bytes()))?;
        }
        folder.finish(files.manifest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::backend::BackendKind;
    use cohaul::simulation::run_facts::Run;
    use cohaul_report::synthetic::{self, manifest};

    #[test]
    fn a_broken_trace_leaves_no_folder_and_names_file_and_column() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        let options = synthetic::options(BackendKind::Rapier);
        let scenario = Scenario::parse(include_str!("../../../../scenarios/paper/four-ants-four-springs.json"), "four ants").unwrap();
        let outcome = synthetic::outcome(None);
        let run = Run { scenario: &scenario, options: &options, outcome: &outcome, path_length: None, wall_time: Some(0.1) };
        let summary = RunSummary { run, inertia_estimate: None };
        let (mut trace, scene, manifest) = (synthetic::trace(200, 1.0), Scene::default(), manifest());
        trace.rows[150].motion.twist.angular = f64::INFINITY;
        let write = |trace: &Trace| {
            let (summary, manifest) = (&summary, &manifest);
            let mut writer = RunWriter::create(&target, TraceColumns::Motion, TraceFormat::Csv)?;
            trace.rows.chunks(7).try_for_each(|rows| writer.add(rows))?;
            writer.finish(&RunFiles { summary, trace, with_tips: false, scene: &scene, manifest, report: None })
        };
        let error = write(&trace).unwrap_err().to_string();
        assert!(error.contains("out/trace.csv: turn_rate_rad_per_s is inf"), "{error}");
        assert_eq!(std::fs::read_dir(room.path()).unwrap().count(), 0);

        trace.rows[150].motion.twist.angular = 0.0;
        write(&trace).unwrap();
        assert_eq!(std::fs::read_dir(&target).unwrap().count(), 6);
    }
}
