//! The files of one run in an output folder.

use std::path::Path;

use super::figure::{self, Labelled, Scene};
use super::html::{REPORT, run_page};
use super::{FolderError, Manifest, OutputFolder, RunSummary, table, write_tips};
use crate::scenario::Scenario;
use crate::simulation::Trace;

/// What is written of a run.
#[derive(Clone, Copy, Debug)]
pub struct RunFiles<'a> {
    pub summary: &'a RunSummary,
    pub trace: &'a Trace,
    pub n_springs: usize,
    /// Whether `tips.csv` is written too.
    pub with_tips: bool,
    pub scene: &'a Scene,
    pub manifest: &'a Manifest,
    /// Scenario of the report; `None` for no report, which takes longer to write than all else.
    pub report: Option<&'a Scenario>,
}

/// Real time of a run (s) from which its files are brought to the disk before they take their name.
const WORTH_WAITING: f64 = 1.0;

/// Writes `summary.json`, `trace.csv`, `events.csv`, `transitions.csv`, `overview.svg`, `manifest.json` and, if asked for, `report.html` to the folder `target`, all or
/// nothing.
///
/// A run of less than a second is not waited for until it is on the disk: see [`OutputFolder::unsynced`].
///
/// # Errors
/// When the folder may not be written (see [`super::check_target`]), a number of the trace is not finite, or the disk fails.
pub fn write_run(target: &Path, files: &RunFiles) -> Result<(), FolderError> {
    let folder = OutputFolder::create(target)?;
    let mut folder = if files.summary.wall_s < WORTH_WAITING { folder.unsynced() } else { folder };
    folder.write("summary.json", |out| out.write_all(files.summary.to_json().as_bytes()))?;
    folder.write("trace.csv", |out| table::write_trace(files.trace, files.n_springs, out))?;
    if files.with_tips {
        folder.write("tips.csv", |out| write_tips(files.trace, out))?;
    }
    folder.write("events.csv", |out| table::write_events(files.trace, out))?;
    folder.write("transitions.csv", |out| table::write_transitions(files.trace, out))?;
    let labelled = [Labelled { label: files.summary.backend.name(), trace: files.trace }];
    folder.write("overview.svg", |out| out.write_all(figure::overview(&labelled, files.scene).as_bytes()))?;
    if let Some(scenario) = files.report {
        let page = run_page(files.summary, files.trace, scenario, files.manifest);
        folder.write(REPORT, |out| out.write_all(page.to_html().as_bytes()))?;
    }
    folder.finish(files.manifest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::BackendKind;
    use crate::report::manifest::tests::manifest;
    use crate::report::synthetic;

    #[test]
    fn a_broken_trace_leaves_no_folder_and_names_file_and_column() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out");
        let options = synthetic::options(BackendKind::Rapier);
        let summary = RunSummary::new("four ants", &options, 7, &synthetic::outcome(None), 0.1).unwrap();
        let (mut trace, scene, manifest) = (synthetic::trace(200, 1.0), Scene::default(), manifest());
        trace.rows[150].motion.twist.angular = f64::INFINITY;
        let write = |trace: &Trace| {
            let (summary, manifest) = (&summary, &manifest);
            let files = RunFiles { summary, trace, n_springs: 4, with_tips: false, scene: &scene, manifest, report: None };
            write_run(&target, &files)
        };
        let error = write(&trace).unwrap_err().to_string();
        assert!(error.contains("out/trace.csv: turn_rate_rad_per_s is inf"), "{error}");
        assert_eq!(std::fs::read_dir(room.path()).unwrap().count(), 0);

        trace.rows[150].motion.twist.angular = 0.0;
        write(&trace).unwrap();
        assert_eq!(std::fs::read_dir(&target).unwrap().count(), 6);
    }
}
