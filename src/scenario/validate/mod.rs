//! From the entries of a file to a scenario: defaults are added, short forms are replaced, every
//! rule is checked, and every finding is kept. Each section is checked even when another one cannot
//! be read, so that one list of findings is enough to correct a file.

mod ants;
mod ground;
mod load;
mod outline;
mod shared;
mod springs;
mod tips;
mod world;

use serde::Deserialize;
use serde_json::Value;

use super::error::{Finding, Findings, ScenarioError};
use super::format::{DriveEntry, GroundEntry, LoadEntry, ObstacleEntry, ScenarioFile, SpringsEntry};
use super::{Drive, Scenario};
use crate::formats::SCENARIO;
use crate::model::{SideFrictionRule, System};
use shared::is_control;

/// Largest number of ticks (1): more would neither end nor fit into memory.
const MOST_TICKS: f64 = 1e9;

/// A scenario file in which some sections may be missing or unreadable.
#[derive(Default, Deserialize)]
#[serde(default)]
pub struct Draft {
    format: Option<u32>,
    name: Option<String>,
    duration_s: Option<f64>,
    control_period_s: Option<f64>,
    seed: Option<u64>,
    load: Option<LoadEntry>,
    ground: Option<GroundEntry>,
    springs: Option<Vec<SpringsEntry>>,
    obstacles: Option<Vec<ObstacleEntry>>,
    side_friction_rule: Option<SideFrictionRule>,
    drive: Option<DriveEntry>,
}

impl Draft {
    /// Sections of `value` that contain none of the unreadable paths in `misfits`.
    pub fn read(mut value: Value, misfits: &[String], findings: &mut Findings) -> Self {
        let Value::Object(sections) = &mut value else { return Self::default() };
        let is_in = |key: &str, path: &String| path.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
        sections.retain(|key, _| !misfits.iter().any(|path| is_in(key, path)));
        // The shape was compared before: what goes wrong here is a difference between the schema
        // and the types.
        serde_path_to_error::deserialize(value).unwrap_or_else(|error| {
            findings.report(error.path().to_string(), error.inner().to_string(), "another shape");
            Self::default()
        })
    }
}

impl From<ScenarioFile> for Draft {
    fn from(file: ScenarioFile) -> Self {
        Self {
            format: file.format,
            name: Some(file.name),
            duration_s: Some(file.duration_s),
            control_period_s: Some(file.control_period_s),
            seed: Some(file.seed),
            load: Some(file.load),
            ground: Some(file.ground),
            springs: Some(file.springs),
            obstacles: Some(file.obstacles),
            side_friction_rule: Some(file.side_friction_rule),
            drive: Some(file.drive),
        }
    }
}

impl ScenarioFile {
    /// The scenario of a file that was built in code. Errors name the file `name_for_errors`.
    ///
    /// # Errors
    /// When the file breaks rules. The error lists every broken rule.
    pub fn checked(self, name_for_errors: &str) -> Result<Scenario, ScenarioError> {
        scenario(self.into(), Findings::default())
            .map_err(|findings| ScenarioError::Invalid { file: name_for_errors.to_string(), findings })
    }
}

/// The scenario of a draft, with the findings that were made while it was read.
///
/// # Errors
/// When there is at least one finding.
pub fn scenario(draft: Draft, mut findings: Findings) -> Result<Scenario, Vec<Finding>> {
    let built = build(draft, &mut findings);
    match built {
        Some(scenario) if findings.0.is_empty() => Ok(scenario),
        _ => {
            assert!(!findings.0.is_empty(), "a section is missing without a finding");
            Err(findings.0)
        }
    }
}

/// The scenario; `None` when a section is missing.
fn build(draft: Draft, findings: &mut Findings) -> Option<Scenario> {
    if let Some(version) = draft.format.filter(|version| !(1..=SCENARIO.version).contains(version)) {
        findings.report("format", SCENARIO.version_rule(), version);
    }
    if let Some(name) = draft.name.as_deref().filter(|name| name.chars().any(is_control)) {
        findings.report("name", "must not contain control characters", format_args!("{name:?}"));
    }
    check_clock(draft.duration_s, draft.control_period_s, findings);
    let load = draft.load.map(|entry| load::load(&entry, findings));
    let ground = draft.ground.map(|entry| ground::ground(&entry, load.as_ref(), findings));
    let (obstacles, rule) = (draft.obstacles.unwrap_or_default(), draft.side_friction_rule.unwrap_or_default());
    let world = world::world(&obstacles, rule, load.as_ref(), draft.control_period_s, findings);
    let n_springs = draft.springs.as_deref().map(springs::n_springs);
    let springs = draft.springs.map(|entries| springs::springs(&entries, findings));
    let drive = draft.drive.map(|entry| match entry {
        DriveEntry::Tips(entry) => Drive::Tips(tips::paths(&entry, n_springs, draft.control_period_s, findings)),
        DriveEntry::Ants(entry) => Drive::Ants(ants::ants(&entry, n_springs, draft.control_period_s, !obstacles.is_empty(), findings)),
    });
    let load = load?;
    Some(Scenario {
        name: draft.name?,
        duration: draft.duration_s?,
        control_period: draft.control_period_s?,
        seed: draft.seed.unwrap_or(1),
        system: System { load: load.load, ground: ground?, springs: springs?, world },
        start: load.start,
        drive: drive?,
    })
}

fn check_clock(duration: Option<f64>, control_period: Option<f64>, findings: &mut Findings) {
    let n_before = findings.0.len();
    if let Some(duration) = duration {
        findings.positive_size("duration_s", duration);
    }
    if let Some(period) = control_period {
        findings.positive_size("control_period_s", period);
    }
    let (Some(duration), Some(period)) = (duration, control_period) else { return };
    if findings.0.len() > n_before {
        return;
    }
    findings.require(period <= duration, "control_period_s", "must not be longer than the duration", period);
    findings.require(duration <= MOST_TICKS * period, "duration_s", &format!("must be at most {MOST_TICKS:e} control periods"), duration);
}
