//! A comparison for programs and as files.

use std::path::Path;

use serde::Serialize;

use crate::analysis::compare::{ClosedLoop, Pathwise, Settings, Verdict};
use crate::backend::BackendKind;
use crate::output::chart::{self, Labelled, Scene};
use crate::output::folder::{FolderError, OutputFolder};
use crate::output::manifest::Manifest;
use crate::output::page::{Answer, REPORT};
use crate::output::trace_csv;
use crate::output::trace_csv::TraceColumns;
use crate::scenario::Scenario;
use crate::simulation::Trace;
use crate::studies::compare::answer::{of_ensemble, of_paths, sentence_of_ensemble, sentence_of_paths};
use crate::studies::compare::page::comparison_page;

/// Result of `cohaul compare`, as `--json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Whether the quasi-static backend is valid, and the engine error, in words.
    pub answer: String,
    pub scenario: String,
    pub seed: u64,
    pub settings: Settings,
    pub tiers: Tiers,
    /// Real time that the comparison took (s).
    pub wall_s: f64,
}

/// Results by tier; a tier that was not asked for is left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tiers {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prescribed: Option<Pathwise>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub replayed: Option<Pathwise>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed_loop: Option<ClosedLoop>,
}

impl Comparison {
    /// `tiers` after `wall_s` (s) of real time. The answer is that of paths, if there are any.
    pub fn new(scenario: &Scenario, settings: &Settings, tiers: Tiers, wall_s: f64) -> Self {
        let answer = match (tiers.pathwise().next(), &tiers.closed_loop) {
            (Some(found), _) => sentence_of_paths(found),
            (None, Some(found)) => sentence_of_ensemble(found),
            (None, None) => "Nothing was compared.".to_owned(),
        };
        Self { answer, scenario: scenario.name.clone(), seed: scenario.seed, settings: *settings, tiers, wall_s }
    }

    /// Whether the answer is that quasi-static is valid.
    pub fn is_valid(&self) -> Answer {
        match (self.tiers.pathwise().next(), &self.tiers.closed_loop) {
            (Some(found), _) => of_paths(found),
            (None, Some(found)) => of_ensemble(found),
            (None, None) => Answer::Open,
        }
    }
}

impl Tiers {
    /// Comparisons of paths: prescribed, then replayed.
    pub fn pathwise(&self) -> impl Iterator<Item = &Pathwise> {
        [&self.prescribed, &self.replayed].into_iter().flatten()
    }

    /// Whether all runs succeeded.
    pub fn are_computed(&self) -> bool {
        let verdicts = self.pathwise().map(|found| found.verdict);
        verdicts.chain(self.closed_loop.iter().map(|found| found.verdict)).all(|verdict| verdict != Verdict::NotComputed)
    }
}

/// Writes `report.html`, `summary.json`, `overview-TIER.svg`, `trace-TIER-BACKEND.csv`,
/// `events-TIER-BACKEND.csv` and `manifest.json` to the folder `target`, or nothing.
///
/// # Errors
/// When the folder may not be written, a number is not finite, or the disk fails.
pub fn write_comparison(target: &Path, comparison: &Comparison, scenario: &Scenario, manifest: &Manifest) -> Result<(), FolderError> {
    let (scene, n_springs) = (&Scene::of(scenario), scenario.system.springs.len());
    let mut folder = OutputFolder::create(target)?;
    folder.write(REPORT, |out| out.write_all(comparison_page(comparison, scenario, manifest).to_html().as_bytes()))?;
    folder.write_json("summary.json", comparison)?;
    for (tier, pathwise) in [("prescribed", &comparison.tiers.prescribed), ("replayed", &comparison.tiers.replayed)] {
        if let Some(pathwise) = pathwise {
            let traces: Vec<_> = pathwise.solutions.iter().map(|solution| (solution.kind, &solution.trace)).collect();
            write_tier(&mut folder, tier, &traces, scene, n_springs)?;
        }
    }
    if let Some(closed_loop) = &comparison.tiers.closed_loop {
        let traces: Vec<_> = BackendKind::ALL.into_iter().zip(&closed_loop.traces).collect();
        write_tier(&mut folder, "closed-loop", &traces, scene, n_springs)?;
    }
    folder.finish(manifest)
}

fn write_tier(
    folder: &mut OutputFolder,
    tier: &str,
    traces: &[(BackendKind, &Trace)],
    scene: &Scene,
    n_springs: usize,
) -> Result<(), FolderError> {
    for (kind, trace) in traces {
        folder.write(&format!("trace-{tier}-{}.csv", kind.name()), |out| {
            trace_csv::write_trace(trace, TraceColumns::Full { n_springs }, out)
        })?;
        folder.write(&format!("events-{tier}-{}.csv", kind.name()), |out| trace_csv::write_events(trace, out))?;
    }
    let labelled: Vec<_> = traces.iter().map(|(kind, trace)| Labelled { label: kind.name(), trace }).collect();
    folder.write(&format!("overview-{tier}.svg"), |out| out.write_all(chart::overview(&labelled, scene).as_bytes()))
}
