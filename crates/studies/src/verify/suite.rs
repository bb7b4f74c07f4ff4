//! Tasks of a verification: every plan of every case.

use rayon::prelude::*;

use super::case::{Case, Plan};
use super::measured::Measured;
use super::row::{Row, rows};
use crate::runner::{Effort, Tasks};
use cohaul::backend::BackendOptions;
use cohaul::stop::Stop;

/// One task a plan of `cases` that is `wanted`, in their order: the rows of the plan.
pub fn tasks(cases: &[Case], wanted: impl Fn(&Plan) -> bool, effort: Effort) -> Tasks<'_, Vec<Row>> {
    let plans = cases.iter().flat_map(|case| case.plans.iter().map(move |plan| (case, plan)));
    let plans: Vec<(&Case, &Plan)> = plans.filter(|(_, plan)| wanted(plan)).collect();
    Tasks::equal(plans.len(), move |task, go_on| {
        let (case, plan) = plans[task];
        Some(rows(case, plan, &answers(case, plan, effort, go_on)?))
    })
}

fn answers(case: &Case, plan: &Plan, effort: Effort, go_on: &(dyn Fn() -> bool + Sync)) -> Option<Vec<(BackendOptions, Measured)>> {
    let stop = Stop::current();
    let run = |options| stop.within(|| go_on().then(|| (options, case.run(&options))));
    plan.options(effort).into_par_iter().map(run).collect()
}
