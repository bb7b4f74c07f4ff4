//! Many cases on all processors.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use rayon::prelude::*;

use super::case::{Case, Plan};
use super::measured::Measured;
use super::row::{Row, rows};
use crate::backend::BackendOptions;

/// How far steps are halved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    Full,
    /// Without the shortest step of each plan, which is half of the work, and with every second tolerance.
    Quick,
}

/// Rows of all plans of `cases` that `wanted` lets through, in their order. `watch` is told the share done (1) now and then; `None` when it said to stop.
pub fn verify(
    cases: &[Case],
    wanted: impl Fn(&Plan) -> bool + Sync,
    effort: Effort,
    watch: impl Fn(f64) -> bool + Sync,
) -> Option<Vec<Row>> {
    let tasks: Vec<(&Case, &Plan)> =
        cases.iter().flat_map(|case| case.plans.iter().map(move |plan| (case, plan))).filter(|(_, plan)| wanted(plan)).collect();
    let n_done = AtomicUsize::new(0);
    let answered = |(case, plan): &(&Case, &Plan)| {
        let go_on = || watch(n_done.load(Relaxed) as f64 / tasks.len() as f64);
        let answers = answers(case, plan, effort, go_on)?;
        n_done.fetch_add(1, Relaxed);
        Some(rows(case, plan, &answers))
    };
    // One by one: the dearest are a hundred times the cheapest and stand side by side.
    let found: Option<Vec<Vec<Row>>> = tasks.par_iter().with_max_len(1).map(answered).collect();
    found.map(|rows| rows.concat())
}

/// The answers at the levels of `plan`.
fn answers(case: &Case, plan: &Plan, effort: Effort, go_on: impl Fn() -> bool + Sync) -> Option<Vec<(BackendOptions, Measured)>> {
    let options = plan.options(effort == Effort::Quick);
    options.into_par_iter().map(|options| go_on().then(|| (options, case.run(&options)))).collect()
}
