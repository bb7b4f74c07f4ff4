//! When a run under error control begins again with a smaller error of each macro-step.

use super::doubt_times::DoubtTimes;
use crate::backend::{BackendOptions, PoseError, StepReport, WORK_PER_SECOND};
use crate::scenario::Scenario;

/// Error bound at obstacles after a repetition over that before, up to which another one may help
/// (1): each divides the errors of smooth macro-steps by ten, and leaves the distance of two places
/// where a load lands as it is.
const HELPS: f64 = 0.5;

/// Repetitions of a run so far.
#[derive(Default)]
pub struct Repeats {
    /// Time (s) and error bound at which the last one began.
    last: Option<(f64, PoseError)>,
    /// Work of the runs before.
    work: u64,
    /// Whether no repetition helps any more.
    is_over: bool,
}

impl Repeats {
    /// Options of a run that begins again, after one that has reached `time` (s) with this error
    /// bound, these steps and doubts.
    pub fn next(
        &mut self,
        (scenario, options): (&Scenario, &BackendOptions),
        time: f64,
        error: Option<PoseError>,
        (steps, doubtful): (&StepReport, &DoubtTimes),
    ) -> Option<BackendOptions> {
        let (tolerance, error) = options.tolerance.zip(error).filter(|(tolerance, error)| !tolerance.allows(error) && !self.is_over)?;
        let work = self.work + steps.n_iterations + steps.n_solves;
        let helps = |(last_time, last): (f64, PoseError)| time > last_time || is_smaller(&error, &last);
        let may_reach = doubtful.not_converged_s.is_none() && tolerance.may_reach(&error);
        let may_help = may_reach && self.last.is_none_or(helps) && work as f64 <= WORK_PER_SECOND * scenario.duration;
        let next = tolerance.tightened().filter(|_| may_help || scenario.system.world.is_empty());
        self.is_over = next.is_none();
        (self.last, self.work) = (Some((time, error)), work);
        next.map(|tolerance| BackendOptions { tolerance: Some(tolerance), ..*options })
    }
}

fn is_smaller(error: &PoseError, last: &PoseError) -> bool {
    error.position <= HELPS * last.position && error.heading <= HELPS * last.heading
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::{BackendKind, Tolerance};

    /// Landings that stay apart end the repetitions, and so does work that is spent.
    #[test]
    fn a_run_is_repeated_as_long_as_that_helps() {
        let text = include_str!("../../scenarios/contact/post-jump.json");
        let scenario = Scenario::parse(text, "post").unwrap();
        let options = BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(1e-6, &scenario.system.load));
        let bound = |times: f64| Some(PoseError { position: times * 1e-6, heading: 0.0 });
        let next = |repeats: &mut Repeats, time: f64, times: f64, n_iterations: u64| {
            let steps = StepReport { n_iterations, ..StepReport::default() };
            repeats.next((&scenario, &options), time, bound(times), (&steps, &DoubtTimes::default())).is_some()
        };
        let mut repeats = Repeats::default();
        assert!(!next(&mut repeats, 0.1, 0.9, 0), "it is within the tolerance");
        assert!(next(&mut repeats, 0.1, 90.0, 0) && next(&mut repeats, 0.1, 30.0, 0) && next(&mut repeats, 0.2, 30.0, 0));
        assert!(!next(&mut repeats, 0.2, 29.0, 0) && !next(&mut repeats, 0.3, 1.1, 0), "it has not helped");
        let most = (WORK_PER_SECOND * scenario.duration) as u64;
        assert!(next(&mut Repeats::default(), 0.1, 2.0, most) && !next(&mut Repeats::default(), 0.1, 2.0, most + 1));
    }
}
