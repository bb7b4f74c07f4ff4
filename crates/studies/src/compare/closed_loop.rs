//! The closed loop of a comparison as tasks, one for each seed, so that it can be stopped and
//! continued.

use std::sync::Mutex;

use crate::runner::Tasks;
use cohaul::analysis::compare::{ClosedLoop, SeedRuns, ThreeWay};
use cohaul::simulation::Trace;

/// Traces of the first seed, if this process ran it.
#[derive(Default)]
pub struct First(Mutex<Option<[Trace; 3]>>);

/// The runs of `n_seeds` consecutive seeds.
pub fn tasks<'a>(runs: ThreeWay<'a>, n_seeds: usize, first: &'a First) -> Tasks<'a, SeedRuns> {
    Tasks::equal(n_seeds, move |at, go_on| {
        let (found, traces) = runs.seed_runs(at, |_| go_on())?;
        if at == 0 {
            *first.0.lock().expect("nothing panics here") = Some(traces);
        }
        Some(found)
    })
}

/// The comparison of all seeds. The first seed runs again if another process ran it, since its
/// traces are not kept; `None` if `watch` ended that.
pub fn judged(runs: ThreeWay, seeds: &[SeedRuns], first: First, watch: &(dyn Fn(f64) -> bool + Sync)) -> Option<ClosedLoop> {
    let traces = match first.0.into_inner().expect("nothing panics here") {
        Some(traces) => traces,
        None => runs.seed_runs(0, watch)?.1,
    };
    Some(runs.judged(seeds, traces))
}
