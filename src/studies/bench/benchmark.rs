//! All of it in turn: errors of a scene's settings, then rounds of times over them; solvers; growth. What is measured is kept as it comes, so that a
//! benchmark that was stopped goes on where it was.

use serde::{Deserialize, Serialize};

use super::growth::{Growth, GrowthPoint};
use super::method::METHODS;
use super::problems::problems_of;
use super::scene::{Level, Scene, SceneFacts};
use super::solvers::{Sequence, Solver, SolverRow, sequences};
use super::work::{Ending, Row};
use crate::scenario::{Drive, Scenario};

/// What to measure.
pub struct Plan {
    pub scenes: Vec<Scene>,
    pub effort: Effort,
    /// The scene of ants whose friction problems both solvers get.
    pub solvers: Option<Scenario>,
    pub growth: Option<Growth>,
}

/// How hard to try.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effort {
    /// Rounds of times.
    pub repeats: usize,
    /// CPU time of one run (s).
    pub budget_s: f64,
    /// Every second setting, and fewer problems and sizes.
    pub quick: bool,
}

/// All that was found so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    pub scenes: Vec<SceneFacts>,
    pub rows: Vec<Row>,
    pub solvers: Vec<SolverRow>,
    pub growth: Vec<GrowthPoint>,
}

/// Sees the share done (1) and says whether to go on.
pub type Watch<'a> = dyn FnMut(f64) -> bool + 'a;

/// CPU time that all rounds of a setting may take, over that of one run (1).
const ROUNDS: f64 = 2.0;
/// Friction problems in a sequence.
const N_PROBLEMS: usize = 4000;
const N_PROBLEMS_QUICK: usize = 800;

/// Measures what `found` lacks of the `plan`; false when `watch` said to stop.
///
/// # Errors
/// When a scene has no reference.
pub fn bench(plan: &Plan, found: &mut Measured, watch: &mut Watch) -> Result<bool, String> {
    let n_parts = (plan.scenes.len() + usize::from(plan.solvers.is_some()) + usize::from(plan.growth.is_some())).max(1) as f64;
    let mut n_done = 0.0;
    for scene in &plan.scenes {
        if bench_scene(scene, &plan.effort, found, &mut |share| watch((n_done + share) / n_parts))?.is_none() {
            return Ok(false);
        }
        n_done += 1.0;
    }
    if let Some(scenario) = &plan.solvers {
        if bench_solvers(scenario, &plan.effort, found, &mut |share| watch((n_done + share) / n_parts)).is_none() {
            return Ok(false);
        }
        n_done += 1.0;
    }
    let Some(growth) = &plan.growth else { return Ok(true) };
    Ok(bench_growth(growth, &plan.effort, found, &mut |share| watch((n_done + share) / n_parts)).is_some())
}

/// Share of a scene's time that goes into its references and errors (1), about.
const FIRST: f64 = 0.4;

fn bench_scene(scene: &Scene, effort: &Effort, found: &mut Measured, watch: &mut Watch) -> Result<Option<()>, String> {
    let is_whole = found.scenes.iter().any(|facts| facts.scene == scene.name) && has_all_rows(scene, effort, found);
    if !is_whole && find_errors(scene, effort, found, &mut |share| watch(FIRST * share))?.is_none() {
        return Ok(None);
    }
    Ok(time_rounds(scene, effort, found, &mut |share| watch(FIRST + (1.0 - FIRST) * share)))
}

fn settings(scene: &Scene, effort: &Effort, path_length: f64) -> Vec<(&'static super::Method, Level)> {
    let asked = METHODS.iter().filter(|method| scene.asks(method));
    asked.flat_map(|method| scene.levels(method, path_length, effort.quick).into_iter().map(move |level| (method, level))).collect()
}

fn has_all_rows(scene: &Scene, effort: &Effort, found: &Measured) -> bool {
    let n_rows = found.rows.iter().filter(|row| row.scene == scene.name).count();
    found
        .scenes
        .iter()
        .find(|facts| facts.scene == scene.name)
        .is_some_and(|facts| n_rows == settings(scene, effort, facts.path_length_m).len())
}

/// One run of every setting for its error; what is finer than a setting that took too long is left out.
fn find_errors(scene: &Scene, effort: &Effort, found: &mut Measured, watch: &mut Watch) -> Result<Option<()>, String> {
    let references = match scene.references(|share| watch(0.2 * share)) {
        None => return Ok(None),
        Some(references) => references.map_err(|cause| format!("{}: {cause}", scene.name))?,
    };
    let facts = scene.facts(&references);
    let path_length = facts.path_length_m;
    if !found.scenes.contains(&facts) {
        found.scenes.push(facts);
    }
    let settings = settings(scene, effort, path_length);
    for (i, (method, level)) in settings.iter().enumerate() {
        let at = |inner: f64| 0.2 + 0.8 * (i as f64 + inner) / settings.len() as f64;
        if !watch(at(0.0)) {
            return Ok(None);
        }
        if found.rows.iter().any(|row| row.scene == scene.name && row.method == method.name && row.level == *level) {
            continue;
        }
        let last = found.rows.last().filter(|row| row.scene == scene.name && row.method == method.name);
        let row = if last.is_some_and(|row| !row.is_answered()) {
            Row::left_out(scene, method, *level, effort.budget_s)
        } else {
            let reference = (references.of(method.kind()), path_length);
            match Row::measure(scene, method, *level, reference, effort.budget_s, |inner| watch(at(inner))) {
                Some(row) => row,
                None => return Ok(None),
            }
        };
        found.rows.push(row);
    }
    Ok(Some(()))
}

/// Times of all settings in turn, so often; expensive ones have fewer rounds.
fn time_rounds(scene: &Scene, effort: &Effort, found: &mut Measured, watch: &mut Watch) -> Option<()> {
    let n_rows = found.rows.iter().filter(|row| row.scene == scene.name).count();
    for round in 0..effort.repeats {
        for (i, row) in found.rows.iter_mut().filter(|row| row.scene == scene.name).enumerate() {
            let spent: f64 = row.seconds.iter().sum();
            let is_spent = !row.seconds.is_empty() && spent + spent / row.seconds.len() as f64 > ROUNDS * effort.budget_s;
            if row.seconds.len() > round || is_spent || !row.is_answered() || row.ending == Ending::Failed {
                continue;
            }
            if !watch((round as f64 + i as f64 / n_rows as f64) / effort.repeats as f64) {
                return None;
            }
            row.time(scene);
        }
    }
    Some(())
}

fn bench_solvers(scenario: &Scenario, effort: &Effort, found: &mut Measured, watch: &mut Watch) -> Option<()> {
    let problems = problems_of(scenario, if effort.quick { N_PROBLEMS_QUICK } else { N_PROBLEMS });
    let sequences = sequences(scenario, &problems);
    let n = (sequences.len() * Solver::ALL.len()) as f64;
    if found.solvers.is_empty() {
        let all = sequences.iter().flat_map(|sequence| Solver::ALL.map(|solver| (sequence, solver)));
        found.solvers = all.map(|((name, problems), solver)| SolverRow::of(scenario, *name, solver, problems)).collect();
    }
    let of = |name: Sequence| sequences.iter().find(|(sequence, _)| *sequence == name).map_or(&[][..], |(_, problems)| problems.as_slice());
    for round in 0..effort.repeats {
        for (i, row) in found.solvers.iter_mut().enumerate() {
            if !watch((round as f64 + i as f64 / n) / effort.repeats as f64) {
                return None;
            }
            if row.seconds.len() <= round {
                row.time(scenario, of(row.sequence));
            }
        }
    }
    Some(())
}

fn bench_growth(growth: &Growth, effort: &Effort, found: &mut Measured, watch: &mut Watch) -> Option<()> {
    if found.growth.is_empty() {
        found.growth = growth.points();
    }
    let n = found.growth.len() as f64;
    for round in 0..effort.repeats {
        for (i, point) in found.growth.iter_mut().enumerate() {
            if !watch((round as f64 + i as f64 / n) / effort.repeats as f64) {
                return None;
            }
            if point.seconds.len() <= round {
                growth.time(point);
            }
        }
    }
    Some(())
}

impl Plan {
    /// Whether the scenes can be benchmarked: their tips are prescribed.
    ///
    /// # Errors
    /// When ants drive the load of one: after the first decision that falls differently, a path says nothing of a method.
    pub fn check(&self) -> Result<(), String> {
        match self.scenes.iter().find(|scene| matches!(scene.scenario.drive, Drive::Ants(_))) {
            Some(scene) => Err(format!(
                "{}: drive: must be prescribed tips, found ants, whose decisions part the paths of any two methods",
                scene.name
            )),
            None => Ok(()),
        }
    }
}
