//! Tasks of a stress test: every cell of the maps on every backend.

use serde::{Deserialize, Serialize};

use super::cause::Facts;
use super::guard::guarded;
use super::judge::{Judged, Outcome, judge, judged};
use super::map::{Answer, Cell, Map};
use super::run::{self, Numbers, Run};
use crate::methods::Method;
use crate::runner::Tasks;
use cohaul::scenario::Scenario;
use cohaul::simulation::{MakeBackend, backend_of};

/// One cell on one backend.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub map: String,
    pub x: f64,
    pub y: f64,
    pub method: Method,
    pub outcome: Outcome,
    /// Empty for a cell that finished.
    pub cause: String,
    /// What the run said of itself, beside its error; `None` where no error is known.
    pub account: Option<Judged>,
    pub numbers: Numbers,
}

/// One task a cell of `maps`, in their order: the rows of the cell on each of `methods`.
///
/// Backends under stress are made by `make`; reference runs use the normal backends.
pub fn tasks<'a>(maps: &'a [Map], methods: &'a [Method], make: &'a MakeBackend) -> Tasks<'a, Vec<Row>> {
    let cells: Vec<(&Map, usize)> = maps.iter().flat_map(|map| (0..map.n_cells()).map(move |index| (map, index))).collect();
    Tasks::equal(cells.len(), move |task, _| Some(rows(cells[task].0, cells[task].1, methods, make)))
}

fn rows(map: &Map, index: usize, methods: &[Method], make: &MakeBackend) -> Vec<Row> {
    let [x, y] = map.parameters(index);
    let row = |method: Method, Ended { outcome, cause, account, numbers }| Row {
        map: map.name.to_owned(),
        x,
        y,
        method,
        outcome,
        cause,
        account,
        numbers,
    };
    let all =
        |outcome: Outcome, cause: &str| methods.iter().map(|method| row(*method, Ended::unjudged(outcome, cause.to_owned()))).collect();
    let cell = match guarded(|| (map.cell)(x, y)) {
        Ok(cell) => cell,
        Err(message) => return all(Outcome::Panicked, &message),
    };
    let scenario = match &cell.scenario {
        Ok(scenario) => scenario,
        Err(error) => return all(Outcome::Refused, &error.findings().iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")),
    };
    if let Some(why) = run::too_long(scenario) {
        return all(Outcome::TooLong, &why);
    }
    let mut references: Vec<(Method, Option<Run>)> = Vec::new();
    let found = methods.iter().map(|method| {
        let of = if matches!(cell.asked.answer, Answer::Scaled { .. }) { *method } else { method.exact() };
        if !references.iter().any(|(known, _)| *known == of) {
            references.push((of, run::reference(scenario, &cell.asked.answer, of, &backend_of)));
        }
        let reference = references.iter().find(|(known, _)| *known == of).and_then(|(_, run)| run.as_ref());
        row(*method, ended(&cell, scenario, *method, reference, make))
    });
    found.collect()
}

/// How one cell ended on one backend.
struct Ended {
    outcome: Outcome,
    cause: String,
    account: Option<Judged>,
    numbers: Numbers,
}

impl Ended {
    fn unjudged(outcome: Outcome, cause: String) -> Self {
        Self { outcome, cause, account: None, numbers: Numbers::default() }
    }
}

/// One cell on one backend.
fn ended(cell: &Cell, scenario: &Scenario, method: Method, reference: Option<&Run>, make: &MakeBackend) -> Ended {
    let run = match run::run(scenario, method, make) {
        Ok(run) => run,
        Err(message) => return Ended::unjudged(Outcome::Panicked, message),
    };
    let error_of = |run: &Run| run::error(scenario, &cell.asked.answer, method, run, reference);
    let error = error_of(&run);
    let (outcome, numbers) = judge(scenario, &cell.asked, &run, error);
    let finer_error = || error_of(&run::finer(scenario, method, make)?);
    let finishes_in_double = || {
        let judged = |run: Run| judge(scenario, &cell.asked, &run, error_of(&run)).0;
        run::run(scenario, Method::RAPIER, make).is_ok_and(|run| judged(run) == Outcome::Finished)
    };
    let facts = Facts {
        scenario,
        asked: &cell.asked,
        method,
        run: &run,
        error,
        finer_error: &finer_error,
        finishes_in_double: &finishes_in_double,
    };
    let (outcome, cause) = match outcome {
        Outcome::Finished => (outcome, String::new()),
        Outcome::NotFinite => (outcome, run.seen.not_finite.clone().unwrap_or_default()),
        Outcome::Unexplained => (outcome, run.lost.clone().unwrap_or_default()),
        Outcome::TooLong => (outcome, format!("{} solutions and iterations are more than the budget", run.seen.report.n_iterations)),
        _ => facts
            .explain(outcome)
            .map_or_else(|| (Outcome::Unexplained, format!("{} without a known cause", outcome.name())), |cause| (outcome, cause)),
    };
    Ended { outcome, cause, account: error.map(|error| judged(scenario, &run, error)), numbers }
}
