//! What the program and the Python package share: tables as one recording, usual questions, and a
//! fit on the first runs.

use super::fit::{Fit, Problem};
use super::parameter::Parameter;
use super::recording::{MeasuredRun, Reading, Recording};
use super::run::Question;
use super::scene::{Preparation, SceneTemplate, Start, USUAL_SHIFT};
use cohaul::analysis::compare::Settings;
use cohaul::scenario::{ScenarioError, sha256_hex};

/// A file of a recording.
pub struct TableText {
    /// Name in errors.
    pub name: String,
    /// Name of the run in a table without runs, and before those of several tables.
    pub stem: String,
    pub text: String,
}

/// The runs of all tables in their order, and the hash of what these contain.
///
/// # Errors
/// When a table is no recording for the scene.
pub fn joined(tables: &[TableText], template: &SceneTemplate, reading: &Reading) -> Result<(Recording, String), ScenarioError> {
    let obstacles = template.obstacles();
    let scene = (&obstacles[..], template.base.system.springs.len());
    let (mut all, mut hashes) = (Recording::default(), String::new());
    for TableText { name, stem, text } in tables {
        let mut found = Recording::parse(text, name, stem, scene, reading)?;
        if tables.len() > 1 {
            found.runs.iter_mut().filter(|run| run.name != *stem).for_each(|run| run.name = format!("{stem}/{}", run.name));
        }
        all.add(found);
        hashes += &sha256_hex(text.as_bytes());
    }
    Ok((all, sha256_hex(hashes.as_bytes())))
}

/// Error of the exact paths over the load's radius (1): well below what any camera sees.
const USUAL_TOLERANCE: f64 = 1e-5;

impl Question {
    /// The usual question about runs of a scene.
    pub fn usual(template: &SceneTemplate) -> Self {
        let radius = template.base.system.load.radius;
        Self {
            preparation: Preparation { start: Start::Touching, bound_m: None, largest_shift_m: USUAL_SHIFT * radius, longest_gap_s: None },
            has_engine: true,
            settings: Settings { reference_tolerance_m: Some(USUAL_TOLERANCE * radius), check_suggestions: false, ..Settings::default() },
        }
    }
}

/// A scene with fitted numbers.
pub struct FittedScene {
    pub fit: Fit,
    pub template: SceneTemplate,
    /// Runs of the fit, which are the first (1).
    pub n_fit: usize,
}

impl FittedScene {
    /// Runs on which the scene is checked: those after the runs of the fit, or all where there are
    /// no others.
    pub fn checked<'a>(&self, runs: &'a [MeasuredRun]) -> &'a [MeasuredRun] {
        if self.n_fit < runs.len() { &runs[self.n_fit..] } else { runs }
    }
}

/// Fits the numbers of these names to the first `n_fit` runs, or to the first half; `None` when
/// `watch`, which gets the share done (1), ended the work.
///
/// # Errors
/// Why there is no fit, in words.
pub fn fitted(
    names: &[String],
    n_fit: Option<usize>,
    (template, runs): (&SceneTemplate, &[MeasuredRun]),
    question: &Question,
    uncertainty: Option<[f64; 2]>,
    watch: &(dyn Fn(f64) -> bool + Sync),
) -> Result<Option<FittedScene>, String> {
    let n_fit = n_fit.unwrap_or(runs.len().div_ceil(2));
    if n_fit > runs.len() {
        return Err(format!("must be on at most {} runs, as many as there are, found {n_fit}", runs.len()));
    }
    let parameters = names.iter().map(|name| Parameter::named(name, template)).collect::<Result<Vec<_>, _>>()?;
    let problem = Problem {
        template,
        runs: &runs[..n_fit],
        parameters: &parameters,
        preparation: &question.preparation,
        settings: &question.settings,
        uncertainty,
    };
    let most = problem.most_evaluations() as f64;
    let Some(solution) = problem.solve(&|n_evaluations| watch(n_evaluations as f64 / most))? else { return Ok(None) };
    let fit = problem.report(&solution, &runs[n_fit..])?;
    let changes: Vec<_> = parameters.iter().zip(&solution.values).map(|(parameter, value)| parameter.at(*value)).collect();
    Ok(Some(FittedScene { fit, template: template.changed(&changes)?, n_fit }))
}
