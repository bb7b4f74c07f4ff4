//! Runs of a plan become rows that hold or miss.

use serde::{Deserialize, Serialize};

use super::case::{Bound, Case, Expected, Family, Levels, Plan};
use super::measured::{Errors, Measured, limit_of};
use crate::methods::Method;
use crate::subject::Ended;
use cohaul::backend::{BackendOptions, Status};

/// What came out at one step or tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    pub case: String,
    pub family: Family,
    pub method: Method,
    pub kind: RowKind,
    /// The step (s); of an extrapolated answer the shortest of those it was made from. `None` under
    /// error control.
    pub step_s: Option<f64>,
    /// What is asked for under error control (m).
    pub tolerance_m: Option<f64>,
    pub errors: Errors,
    /// The errors as one: what a point of the load may be off by (m), or the ratio's where there
    /// are no others.
    pub size: Option<f64>,
    /// Power of the step with which the error fell from the row before; `None` at the longest step,
    /// and where it is zero or but rounding.
    pub order: Option<f64>,
    pub expected: Expected,
    pub bounds: Errors,
    pub reason: String,
    pub source: String,
    pub outcome: Outcome,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RowKind {
    AtStep,
    /// In the limit of small steps, by Romberg's table over all of them.
    Extrapolated,
    WithinTolerance,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Outcome {
    Holds,
    Misses(String),
    /// Information: not judged.
    Shown,
    /// The engine does not take the scene.
    Refused(String),
}

/// What came of the runs at one step or tolerance.
pub struct Answer {
    pub options: BackendOptions,
    pub measured: Measured,
    /// Why there is no answer, if there is none.
    pub ended: Option<Ended>,
}

impl Outcome {
    pub fn is_judged(&self) -> bool {
        matches!(self, Outcome::Holds | Outcome::Misses(_))
    }

    /// Why the engine does not take the scene.
    pub fn refused(&self) -> Option<&str> {
        if let Outcome::Refused(why) = self { Some(why) } else { None }
    }

    /// What is wrong with a row that misses.
    pub fn missed(&self) -> Option<&str> {
        if let Outcome::Misses(why) = self { Some(why) } else { None }
    }
}

impl Row {
    /// A row without an answer.
    fn unanswered(self, outcome: Outcome) -> Self {
        Self { errors: Errors::NONE, size: None, order: None, outcome, ..self }
    }
}

/// How far a measured order may lie from the expected one: at these steps the next term of the
/// error's series is a few hundredths of the first, or an event falls elsewhere within its step.
const ORDER_TOLERANCE: f64 = 0.15;

/// Power of the step with which an extrapolated answer's bound grows with longer steps: a table
/// over three steps leaves the third order, one over more the second order of changes of contact
/// mode within a step.
const LIMIT_POWER: f64 = 3.0;

/// Rows of the answers at successively halved steps of `plan`, and of their limit, or at its
/// tolerances.
pub fn rows(case: &Case, plan: &Plan, answers: &[Answer]) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::with_capacity(answers.len() + 1);
    let kind = match plan.levels {
        Levels::Steps(_) => RowKind::AtStep,
        Levels::Tolerances(_) => RowKind::WithinTolerance,
    };
    for Answer { options, measured, ended } in answers {
        let mut row = row(case, plan, kind, measured, options);
        if kind == RowKind::AtStep && plan.expected != Expected::Exact {
            row.order = rows.last().and_then(|coarse| order(coarse.size?, row.size?));
        }
        match ended {
            None | Some(Ended::Stopped) => judge(&mut row, plan, measured),
            Some(Ended::Refused(why)) => row = row.unanswered(Outcome::Refused(why.clone())),
            Some(Ended::Failed(why)) => row = row.unanswered(Outcome::Misses(why.clone())),
        }
        rows.push(row);
    }
    if let (Some(limit), [_, .., shortest], true) = (&plan.limit, answers, answers.iter().all(|answer| answer.ended.is_none())) {
        let found: Vec<Measured> = answers.iter().map(|answer| answer.measured.clone()).collect();
        let answer = limit_of(&found);
        let mut row = row(case, plan, RowKind::Extrapolated, &answer, &shortest.options);
        row.bounds = limit.at(2f64.powi((plan.n_levels - answers.len()) as i32), LIMIT_POWER);
        row.reason.clone_from(&limit.reason);
        judge(&mut row, plan, &answer);
        rows.push(row);
    }
    rows
}

fn row(case: &Case, plan: &Plan, kind: RowKind, answer: &Measured, options: &BackendOptions) -> Row {
    let errors = answer.errors();
    let Bound { reason, .. } = &plan.bound;
    Row {
        case: case.name.clone(),
        family: case.family,
        method: plan.method,
        kind,
        step_s: (kind != RowKind::WithinTolerance).then_some(options.step_s),
        tolerance_m: options.tolerance.map(|tolerance| tolerance.position_m),
        errors,
        size: errors.size(answer.arm),
        order: None,
        expected: plan.expected,
        bounds: plan.bound.at(plan.share(options), plan.expected.power()),
        reason: reason.clone(),
        source: case.source.clone(),
        outcome: Outcome::Shown,
    }
}

/// Power of the step when an error falls from `coarse` to `fine` at half of it.
fn order(coarse: f64, fine: f64) -> Option<f64> {
    let order = (coarse / fine).log2();
    order.is_finite().then_some(order)
}

fn judge(row: &mut Row, plan: &Plan, answer: &Measured) {
    if plan.method.has_engine_defaults() {
        return;
    }
    let missed = if !row.errors.is_finite() {
        Some("the answer is not finite".to_owned())
    } else if answer.report.status != Status::Converged {
        Some(format!("{} of {} steps did not converge", answer.report.n_not_converged, answer.report.n_steps))
    } else if !row.errors.within(&row.bounds) {
        Some("the error is above its bound".to_owned())
    } else {
        misses_order(row)
    };
    row.outcome = missed.map_or(Outcome::Holds, Outcome::Misses);
}

fn misses_order(row: &Row) -> Option<String> {
    let (Expected::Order(expected), Some(order)) = (row.expected, row.order) else { return None };
    ((order - expected).abs() > ORDER_TOLERANCE).then(|| format!("the order is {order:.2} in place of {expected}"))
}
