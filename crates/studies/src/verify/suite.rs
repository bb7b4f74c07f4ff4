//! Tasks of a verification: every plan of every case.

use rayon::prelude::*;

use super::case::{Case, Plan};
use super::row::{Answer, Row, rows};
use crate::runner::{Effort, Tasks};
use crate::subject::{Meet, Runs};
use cohaul::stop::Stop;

/// One task a plan of `cases` that is `wanted`, in their order: the rows of the plan. Backends are
/// made by `meet`.
pub fn tasks<'a>(cases: &'a [Case], meet: &'a Meet<'a>, wanted: impl Fn(&Plan) -> bool, effort: Effort) -> Tasks<'a, Vec<Row>> {
    let plans = cases.iter().flat_map(|case| case.plans.iter().map(move |plan| (case, plan)));
    let plans: Vec<(&Case, &Plan)> = plans.filter(|(_, plan)| wanted(plan)).collect();
    Tasks::equal(plans.len(), move |task, go_on| {
        let (case, plan) = plans[task];
        Some(rows(case, plan, &answers(case, plan, meet, effort, go_on)?))
    })
}

fn answers(case: &Case, plan: &Plan, meet: &Meet, effort: Effort, go_on: &(dyn Fn() -> bool + Sync)) -> Option<Vec<Answer>> {
    let stop = Stop::current();
    let answer = |options| {
        let runs = Runs::by(meet, options);
        let measured = (case.run)(&runs);
        Answer { options, measured, ended: runs.ended() }
    };
    let run = |options| stop.within(|| go_on().then(|| answer(options)));
    plan.options(effort).into_par_iter().map(run).collect()
}
