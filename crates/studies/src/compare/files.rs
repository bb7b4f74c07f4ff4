//! The files of a comparison in an output folder.

use std::path::Path;

use crate::compare::comparison::Comparison;
use crate::compare::page::{comparison_page, scene_of};
use cohaul::scenario::Scenario;
use cohaul_report::chart::{self, Labelled, Scene};
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::REPORT;
use cohaul_report::trace_csv::{self, TraceColumns};
use cohaul_report::traces::{TraceFormat, write_trace};

/// Writes `report.html`, `summary.json`, `overview-TIER.svg` and `manifest.json` to the folder
/// `target`, or nothing. With a format of `traces`, also `trace-TIER-BACKEND` in that format and
/// `events-TIER-BACKEND.csv`.
///
/// # Errors
/// If the folder may not be written, a number is not finite, or the disk fails.
pub fn write_comparison(
    target: &Path,
    comparison: &Comparison,
    scenario: &Scenario,
    traces: Option<TraceFormat>,
    manifest: &Manifest,
) -> Result<(), FolderError> {
    let with = traces.map(|format| (format, manifest));
    let mut folder = OutputFolder::create(target)?;
    folder.write(REPORT, |out| out.write_all(comparison_page(comparison, scenario, manifest).to_html().as_bytes()))?;
    folder.write_json("summary.json", comparison)?;
    let tiers = &comparison.tiers;
    for (tier, found) in [("prescribed", &tiers.prescribed), ("replayed", &tiers.replayed), ("controlled", &tiers.controlled)] {
        let Some(found) = found else { continue };
        write_tier(&mut folder, tier, &comparison.runs(found), (scenario, &scene_of(found, scenario)), with)?;
    }
    if let Some(found) = &tiers.closed_loop {
        write_tier(
            &mut folder,
            "closed-loop",
            &Labelled::compared(found.engine.after_exact(), &found.traces),
            (scenario, &Scene::of(scenario)),
            with,
        )?;
    }
    folder.finish(manifest)
}

fn write_tier(
    folder: &mut OutputFolder,
    tier: &str,
    runs: &[Labelled],
    (scenario, scene): (&Scenario, &Scene),
    with: Option<(TraceFormat, &Manifest)>,
) -> Result<(), FolderError> {
    let columns = TraceColumns::Full { n_springs: scenario.system.springs.len() };
    for (Labelled { label, trace }, (format, manifest)) in runs.iter().filter_map(|run| Some((run, with?))) {
        write_trace(folder, &format!("trace-{tier}-{label}"), (trace, columns), format, manifest)?;
        folder.write(&format!("events-{tier}-{label}.csv"), |out| trace_csv::write_events(trace, out))?;
    }
    folder.write(&format!("overview-{tier}.svg"), |out| out.write_all(chart::overview(runs, scene).as_bytes()))
}
