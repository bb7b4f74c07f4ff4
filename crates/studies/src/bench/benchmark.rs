//! All measurements in turn: errors of a scene's settings, then rounds of times over them; solvers;
//! growth. Every measurement is a record, so that a benchmark that was stopped continues where it
//! was.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::growth::{Growth, GrowthPoint};
use super::problems::problems_of;
use super::scene::{Level, References, Scene, SceneFacts};
use super::solvers::{Sequence, Solver, SolverRow, sequences};
use super::work::Row;
use crate::journal::JournalError;
use crate::methods::{METHODS, Method};
use crate::runner::Records;
use crate::subject::{Meet, own};
use cohaul::scenario::{Drive, Scenario};

pub struct Plan<'a> {
    pub scenes: Vec<Scene>,
    /// Engines of the user, and what makes their runs.
    pub engines: Vec<(Method, &'a Meet<'a>)>,
    pub effort: Effort,
    /// The scene of ants whose friction problems both solvers get.
    pub solvers: Option<Scenario>,
    pub growth: Option<Growth>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effort {
    /// Rounds of times.
    pub repeats: usize,
    /// CPU time of one run (s).
    pub budget_s: f64,
    /// Every second setting, and fewer problems and sizes.
    pub quick: bool,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    pub scenes: Vec<SceneFacts>,
    pub rows: Vec<Row>,
    pub solvers: Vec<SolverRow>,
    pub growth: Vec<GrowthPoint>,
}

#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The watch ended it.
    #[error("stopped")]
    Stopped,
    #[error("{0}")]
    NoReference(String),
    #[error(transparent)]
    Journal(#[from] JournalError),
}

/// Receives the fraction of the work done (1) and returns whether to continue.
pub type Watch<'a> = dyn FnMut(f64) -> bool + 'a;

/// CPU time that all rounds of a setting may take, over that of one run (1).
const ROUNDS: f64 = 2.0;
/// Friction problems in a sequence.
const N_PROBLEMS: usize = 4000;
const N_PROBLEMS_QUICK: usize = 800;
/// Fraction of a scene's time that goes into its references and errors (1), about.
const FIRST: f64 = 0.4;
/// Fraction of that which goes into the references (1), about.
const REFERENCES: f64 = 0.2;

/// Measures what the `records` of a `plan` lack, one measurement after the other.
///
/// # Errors
/// When `watch` ended it, a scene has no reference, or a record cannot be kept.
pub fn bench<'a>(plan: &'a Plan<'a>, records: &mut Records<Value>, watch: &mut Watch) -> Result<Measured, BenchError> {
    let n_parts = (plan.scenes.len() + usize::from(plan.solvers.is_some()) + usize::from(plan.growth.is_some())).max(1) as f64;
    let mut parts = (0..).map(|part| Span(f64::from(part) / n_parts, f64::from(part + 1) / n_parts));
    let mut next_part = || parts.next().expect("numbers do not end");
    let mut session = Session { plan, effort: &plan.effort, records, next: 0, watch };
    let mut found = Measured::default();
    for scene in &plan.scenes {
        let part = next_part();
        let (facts, mut rows) = session.errors(scene, part.inner(0.0, FIRST))?;
        found.scenes.push(facts);
        let time = |row: &Row| row.may_be_timed(ROUNDS * plan.effort.budget_s).then(|| row.time(scene, plan.meet_of(&row.method)));
        session.rounds(part.inner(FIRST, 1.0), &mut rows, |row| &mut row.seconds, time)?;
        found.rows.append(&mut rows);
    }
    if let Some(scenario) = &plan.solvers {
        found.solvers = session.solvers(scenario, next_part())?;
    }
    if let Some(growth) = &plan.growth {
        found.growth = growth.points();
        let time = |point: &GrowthPoint| Some(growth.time(point));
        session.rounds(next_part(), &mut found.growth, |point| &mut point.seconds, time)?;
    }
    Ok(found)
}

/// Part of the whole work, by the fractions at its begin and end (1).
#[derive(Clone, Copy)]
struct Span(f64, f64);

impl Span {
    fn at(self, share: f64) -> f64 {
        self.0 + share * (self.1 - self.0)
    }

    fn inner(self, begin: f64, end: f64) -> Self {
        Self(self.at(begin), self.at(end))
    }

    /// The part of item `i` of `n`.
    fn item(self, i: usize, n: usize) -> Self {
        self.inner(i as f64 / n as f64, (i + 1) as f64 / n as f64)
    }
}

/// Measurements in their order, each a record by its number. What a measurement is depends on
/// nothing but the plan and the measurements before it.
struct Session<'a, 'b> {
    plan: &'a Plan<'a>,
    effort: &'a Effort,
    records: &'a mut Records<Value>,
    next: usize,
    watch: &'a mut Watch<'b>,
}

impl Session<'_, '_> {
    /// The record of the next measurement, or what `measure` finds; `None` from it means stopped.
    fn measured<T>(&mut self, span: Span, measure: impl FnOnce(&mut Watch) -> Result<Option<T>, BenchError>) -> Result<T, BenchError>
    where
        T: Serialize + DeserializeOwned,
    {
        let number = self.next;
        self.next += 1;
        if let Some(record) = self.records.get(number) {
            return Ok(T::deserialize(record).map_err(|error| self.records.unfit(number, &error))?);
        }
        let mut watch = |share: f64| (self.watch)(span.at(share));
        let found = if watch(0.0) { measure(&mut watch)? } else { None };
        let found = found.ok_or(BenchError::Stopped)?;
        self.records.keep(number, serde_json::to_value(&found).expect("a measurement is plain data"))?;
        Ok(found)
    }

    /// One run of every setting for its error. Settings finer than one that took too long are left
    /// out.
    fn errors(&mut self, scene: &Scene, span: Span) -> Result<(SceneFacts, Vec<Row>), BenchError> {
        // Found when the first measurement needs them: a benchmark that is resumed may need none.
        let mut references: Option<References> = None;
        let find = |watch: &mut Watch| -> Result<Option<References>, BenchError> {
            let Some(found) = scene.references(watch) else { return Ok(None) };
            found.map(Some).map_err(|cause| BenchError::NoReference(format!("{}: {cause}", scene.name)))
        };
        let facts = self.measured(span.inner(0.0, REFERENCES), |watch| {
            references = find(watch)?;
            Ok(references.as_ref().map(|references| scene.facts(references)))
        })?;
        let settings = settings(scene, self.plan, facts.path_length_m);
        let (mut rows, budget): (Vec<Row>, f64) = (Vec::new(), self.effort.budget_s);
        for (i, (method, level)) in settings.iter().enumerate() {
            let unanswered = rows.last().filter(|row| row.method == method.name && !row.is_answered());
            let row = self.measured(span.inner(REFERENCES, 1.0).item(i, settings.len()), |watch| {
                if let Some(coarser) = unanswered {
                    return Ok(Some(coarser.left_out(scene, method, *level, budget)));
                }
                if references.is_none() {
                    references = find(watch)?;
                }
                let Some(references) = &references else { return Ok(None) };
                let reference = (references.of(method.kind), facts.path_length_m);
                Ok(Row::measure(scene, (method, self.plan.meet_of(method.name)), *level, reference, budget, watch))
            })?;
            rows.push(row);
        }
        Ok((facts, rows))
    }

    /// Times of all rows in turn, as often as asked for; `time` returns `None` for rows without
    /// one.
    fn rounds<T>(
        &mut self,
        span: Span,
        rows: &mut [T],
        seconds: impl Fn(&mut T) -> &mut Vec<f64>,
        time: impl Fn(&T) -> Option<f64>,
    ) -> Result<(), BenchError> {
        let (n, repeats) = (rows.len(), self.effort.repeats);
        for round in 0..repeats {
            for (i, row) in rows.iter_mut().enumerate() {
                let time_s = self.measured(span.item(round, repeats).item(i, n), |_| Ok(Some(time(row))))?;
                seconds(row).extend(time_s);
            }
        }
        Ok(())
    }

    fn solvers(&mut self, scenario: &Scenario, span: Span) -> Result<Vec<SolverRow>, BenchError> {
        let problems = problems_of(scenario, if self.effort.quick { N_PROBLEMS_QUICK } else { N_PROBLEMS });
        let sequences = sequences(scenario, &problems);
        let of = |name: Sequence| sequences.iter().find(|(sequence, _)| *sequence == name).map_or(&[][..], |(_, problems)| problems);
        let mut rows = Vec::new();
        for (name, problems) in &sequences {
            for solver in Solver::ALL {
                rows.push(self.measured(span.inner(0.0, 0.0), |_| Ok(Some(SolverRow::of(scenario, *name, solver, problems))))?);
            }
        }
        self.rounds(span, &mut rows, |row| &mut row.seconds, |row| Some(row.time(scenario, of(row.sequence))))?;
        Ok(rows)
    }
}

fn settings(scene: &Scene, plan: &Plan, path_length: f64) -> Vec<(Method, Level)> {
    let of_user = plan.engines.iter().map(|(method, _)| *method);
    let asked = METHODS.iter().copied().chain(of_user).filter(|method| scene.asks(method));
    asked.flat_map(|method| scene.levels(&method, path_length, plan.effort.quick).into_iter().map(move |level| (method, level))).collect()
}

impl Plan<'_> {
    /// What makes the runs of a method.
    fn meet_of(&self, method: &str) -> &Meet<'_> {
        self.engines.iter().find(|(engine, _)| engine.name == method).map_or(&own, |(_, meet)| *meet)
    }

    /// Whether the scenes can be benchmarked: their tips are prescribed.
    ///
    /// # Errors
    /// When ants drive the load of one: after the first different decision, a path says nothing of
    /// a method.
    pub fn check(&self) -> Result<(), String> {
        match self.scenes.iter().find(|scene| matches!(scene.scenario.drive, Drive::Ants(_))) {
            Some(scene) => Err(format!(
                "{}: drive: must be prescribed tips, found ants: after the first different decision two paths say nothing of the methods",
                scene.name
            )),
            None => Ok(()),
        }
    }
}
