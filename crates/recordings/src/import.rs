//! From files to a checked scenario, with an account of what was done.

use cohaul::scenario::format::ScenarioFile;
use cohaul::scenario::{Findings, Scenario, ScenarioError, cut};
use serde::Deserialize;

use crate::account::Account;
use crate::drawings::{DrawingFormat, DrawingOptions, into_scenario, repaired};
use crate::repair::Bounds;
use crate::scene::{Imported, Roles, scenario};
use crate::tracks::{Reading, TrackFormat, Tracks, Units, read};

/// What is asked of an import. All of it may be left out.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Asked {
    /// Format of tracks; the default is what their first lines tell.
    pub format: Option<TrackFormat>,
    /// Name of the new scenario.
    pub name: Option<String>,
    /// Duration of the new scenario (s); the default is that of the recording.
    pub duration_s: Option<f64>,
    pub units: Units,
    pub bounds: Bounds,
    pub roles: Roles,
    /// Largest distance of straight lines from a curve of a drawing (m).
    pub tolerance_m: Option<f64>,
    /// Body of an MJCF model.
    pub body: Option<String>,
    /// Whether the y axis of a mesh points up, and not the z axis.
    pub y_up: bool,
    /// Obstacle that gets the outline of a drawing, in place of the load.
    pub onto: Option<String>,
}

/// A scenario that was imported.
#[derive(Clone, Debug)]
pub struct Import {
    pub scenario: Scenario,
    /// What was done.
    pub account: Account,
    /// All tracks as they were read, in SI units; `None` for a drawing.
    pub tracks: Option<Tracks>,
    /// Tracks of the load and of the tips; `None` for a drawing.
    pub tips: Option<Tracks>,
}

/// Makes a scenario of tracks or of a drawing on the scenario `like`, or of a scenario whose
/// outlines break rules, without `like`.
///
/// # Errors
/// When a file or `like` breaks a rule of its format, when roles cannot be told, or when the result
/// breaks a rule. Paths that begin with `--` are options of the program.
pub fn import(files: &[Reading], like: Option<Reading>, asked: &Asked) -> Result<Import, ScenarioError> {
    let Some(first) = files.first() else { return Err(fault("", "FILE", "must be at least one file", "none")) };
    let drawing = DrawingFormat::of(first.file, first.bytes).filter(|_| asked.format.is_none());
    check(asked, first.file, drawing.is_some())?;
    let mut account = Account::default();
    let (made, tracks, tips) = match (like, drawing) {
        (None, None) if first.bytes.trim_ascii_start().starts_with(b"{") => {
            let own = repaired(first.file, scenario_file(one(files)?)?, &mut account)?.checked(first.file)?;
            (own, None, None)
        }
        (None, _) => {
            return Err(fault(first.file, "--like", "is required, the scenario with the ground and the springs", "none"));
        }
        (Some(like), Some(format)) => {
            let Reading { file, bytes } = one(files)?;
            let options =
                DrawingOptions { scale: asked.units.scale, tolerance: asked.tolerance_m, body: asked.body.as_deref(), y_up: asked.y_up };
            let target = (scenario_file(like)?, asked.onto.as_deref());
            (into_scenario(file, bytes, format, &options, target, &mut account)?.checked(file)?, None, None)
        }
        (Some(like), None) => {
            let like = Scenario::parse(utf8(like)?, like.file)?;
            let tracks = read(files, asked.format, &asked.units, &mut account)?;
            let Imported { scenario, tips } = scenario(tracks.clone(), &asked.roles, &asked.bounds, &like, first.file, &mut account)?;
            (scenario, Some(tracks), Some(tips))
        }
    };
    let name = asked.name.clone().unwrap_or(made.name.clone());
    let made = Scenario { name, duration: asked.duration_s.unwrap_or(made.duration), ..made };
    Ok(Import { scenario: made.expanded().checked(first.file)?, account, tracks, tips })
}

/// Checks what no reader checks: a confidence, and options of the other kind of file.
fn check(asked: &Asked, file: &str, is_drawing: bool) -> Result<(), ScenarioError> {
    let mut findings = Findings::default();
    if let Some(confidence) = asked.units.min_confidence.filter(|confidence| !(0.0..=1.0).contains(confidence)) {
        findings.report("--min-confidence", "must be from 0 to 1", confidence);
    }
    let Asked { units, bounds, roles, .. } = asked;
    let of_drawings = [
        ("--tolerance-m", asked.tolerance_m.is_some()),
        ("--body", asked.body.is_some()),
        ("--y-up", asked.y_up),
        ("--onto", asked.onto.is_some()),
    ];
    let of_tracks = [
        ("--fps", units.fps.is_some()),
        ("--y", units.y_down.is_some()),
        ("--headings", units.degrees.is_some()),
        ("--start-s", units.start.is_some()),
        ("--origin-m", units.origin.is_some()),
        ("--bridge-s", bounds.bridge.is_some()),
        ("--max-jump-m", bounds.jump.is_some()),
        ("--smooth-m", bounds.smooth.is_some()),
        ("--spring", !roles.springs.is_empty()),
        ("--load", !roles.load.is_empty()),
        ("--obstacle", !roles.obstacles.is_empty()),
    ];
    let (others, rule, found) = match is_drawing {
        true => (&of_tracks[..], "is for recordings", "a drawing"),
        false => (&of_drawings[..], "is for drawings", "a recording"),
    };
    others.iter().filter(|(_, is_given)| *is_given).for_each(|(option, _)| findings.report(option, rule, found));
    if findings.0.is_empty() { Ok(()) } else { Err(ScenarioError::Invalid { file: file.to_owned(), findings: findings.0 }) }
}

fn fault(file: &str, path: &str, rule: &str, found: impl std::fmt::Display) -> ScenarioError {
    let mut findings = Findings::default();
    findings.report(path, rule, found);
    ScenarioError::Invalid { file: file.to_owned(), findings: findings.0 }
}

fn one<'a>(files: &[Reading<'a>]) -> Result<Reading<'a>, ScenarioError> {
    match files {
        [one] => Ok(*one),
        _ => Err(fault(files[0].file, "FILE", "must be one drawing or scenario", format_args!("{} files", files.len()))),
    }
}

fn utf8<'a>(Reading { file, bytes }: Reading<'a>) -> Result<&'a str, ScenarioError> {
    std::str::from_utf8(bytes).map_err(|error| fault(file, "", "must be text in UTF-8", error))
}

/// A scenario as it stands in its file, which may break rules.
fn scenario_file(from: Reading) -> Result<ScenarioFile, ScenarioError> {
    serde_json::from_str(utf8(from)?).map_err(|error| fault(from.file, "", "must be a scenario", cut(error.to_string(), 500)))
}
