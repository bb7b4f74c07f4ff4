//! Doubts: why the result of an exact run cannot be trusted, and from when on.
//!
//! A comparison measures an engine by the exact runs. Where an exact run is doubtful, a difference
//! from it says nothing of the engine: the verdict is inconclusive. Both exact backends share the
//! code for contacts, so that their agreement proves nothing about it.

use serde::{Deserialize, Serialize};

use super::solution::Solution;
use super::verdicts::least_sizes;
use crate::backend::{BackendKind, TransitionKind, closed_share};
use crate::scenario::Scenario;
use crate::simulation::{DoubtTimes, Row, Trace};

/// Reason to doubt the result of an exact run from a time on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Doubt {
    pub kind: DoubtKind,
    /// Run that is doubtful; left out if both exact runs are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub backend: Option<BackendKind>,
    /// Time from the start of the run at which it begins (s).
    pub time_s: f64,
    /// Obstacle at which it begins; left out if there is none, or more than one that may be it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DoubtKind {
    /// The load lay inside an obstacle at the end of an accepted step.
    Overlap,
    /// A step ended inside an obstacle and had to be cut.
    GateCut,
    /// Another motion was admissible.
    NotUnique,
    /// Energy appeared or vanished: the ledger does not close.
    OpenLedger,
    /// A step did not converge.
    NotConverged,
    /// Both exact loads are held at a place of an obstacle that the engine's load passes.
    SameStop,
}

/// How far the ledger of a run may be open.
#[derive(Clone, Copy)]
pub(super) struct LedgerBound {
    /// Largest defect outside of jumps over the largest entry (1).
    pub share: f64,
    /// Energy that stands in for entries that are all smaller (J).
    pub least: f64,
}

impl LedgerBound {
    /// Bound of a run in this scenario, under error control or at fixed steps. A difference of
    /// energies by `tolerance_share` (1) counts as agreement.
    pub fn new(scenario: &Scenario, has_error_control: bool, tolerance_share: f64) -> Self {
        let [.., least] = least_sizes(scenario);
        Self { share: closed_share(has_error_control, tolerance_share), least }
    }
}

/// Doubts of exact runs under error control, in the order of time.
pub(super) fn of_references(solutions: &[Solution], scenario: &Scenario) -> Vec<Doubt> {
    let bound = LedgerBound::new(scenario, true, 0.0);
    let of = |solution: &Solution| of_run(solution.kind, &solution.trace, &solution.doubtful, bound);
    in_order(solutions.iter().flat_map(of).collect())
}

/// Doubts of one exact run, in the order of time.
pub(super) fn of_run(kind: BackendKind, trace: &Trace, times: &DoubtTimes, bound: LedgerBound) -> Vec<Doubt> {
    let is_change = |kind: &TransitionKind| matches!(kind, TransitionKind::NotUnique { .. });
    let change = trace.transitions.iter().find(|transition| is_change(&transition.kind));
    let not_unique =
        change.map(|it| (it.time, it.kind.obstacle())).or(times.not_unique_s.map(|time| (time, obstacle_at(&trace.rows, time))));
    let at_obstacle = |time: Option<f64>| time.map(|time| (time, obstacle_at(&trace.rows, time)));
    let found = [
        (DoubtKind::Overlap, at_obstacle(times.overlap_s)),
        (DoubtKind::GateCut, at_obstacle(times.gate_cut_s)),
        (DoubtKind::NotUnique, not_unique),
        (DoubtKind::NotConverged, times.not_converged_s.map(|time| (time, None))),
        (DoubtKind::OpenLedger, closed_until(&trace.rows, bound).map(|time| (time, None))),
    ];
    let doubt = |(kind_of_doubt, found): (DoubtKind, Option<(f64, Option<usize>)>)| {
        found.map(|(time_s, obstacle)| Doubt { kind: kind_of_doubt, backend: Some(kind), time_s, obstacle })
    };
    in_order(found.into_iter().filter_map(doubt).collect())
}

pub(super) fn in_order(mut doubts: Vec<Doubt>) -> Vec<Doubt> {
    doubts.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    doubts
}

/// The only obstacle that the load touches in the first row after `time` (s).
fn obstacle_at(rows: &[Row], time: f64) -> Option<usize> {
    let row = rows.iter().find(|row| row.time > time)?;
    let first = row.contacts.first()?.obstacle;
    row.contacts.iter().all(|contact| contact.obstacle == first).then_some(first)
}

/// Last instant before the ledger is open (s); `None` if it closes in the whole run. A ledger is
/// measured by the largest entry of the whole run.
fn closed_until(rows: &[Row], bound: LedgerBound) -> Option<f64> {
    let size = rows.iter().map(|row| row.energy.largest_entry()).fold(bound.least, f64::max);
    let open = rows.iter().position(|row| !row.energy.is_closed(bound.share, size))?;
    Some(rows[open.saturating_sub(1)].time)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::{EnergyLedger, Motion, SideContact, Transition};
    use crate::math::{Pose, Twist, Vec2};
    use crate::simulation::AttachedTips;

    const BOUND: LedgerBound = LedgerBound { share: 1e-3, least: 1e-12 };

    fn row(time: f64, energy: EnergyLedger, obstacles: &[usize]) -> Row {
        let motion = Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist { linear: Vec2::zeros(), angular: 0.0 } };
        let contact = |obstacle: &usize| SideContact { obstacle: *obstacle, point: Vec2::zeros(), force: Vec2::x() };
        Row {
            time,
            motion,
            energy,
            tips: AttachedTips::new(),
            contacts: obstacles.iter().map(contact).collect(),
            error: None,
            steered: Vec::new(),
        }
    }

    /// Friction takes the work of the tips, and `from_nowhere` of it (J) appears after a second.
    fn trace(from_nowhere: f64, jumps: f64) -> Trace {
        let energy = |at: usize| {
            let (work, gain) = (at as f64, if at > 1 { from_nowhere } else { 0.0 });
            EnergyLedger { tip_work: work, friction: work + gain - jumps, jumps, ..EnergyLedger::default() }
        };
        Trace { rows: (0..11).map(|at| row(at as f64, energy(at), &[])).collect(), ..Trace::default() }
    }

    fn doubts(trace: &Trace, times: &DoubtTimes) -> Vec<Doubt> {
        of_run(BackendKind::Inertial, trace, times, BOUND)
    }

    /// The largest entry is 10 J, of which 10 mJ may be missing.
    #[test]
    fn a_ledger_that_is_open_by_more_than_a_thousandth_is_doubtful_from_when_it_opens() {
        let no_times = DoubtTimes::default();
        assert_eq!(doubts(&trace(9.9e-3, 0.0), &no_times), []);
        for gain in [10.1e-3, -10.1e-3, f64::NAN] {
            let found = doubts(&trace(gain, 0.0), &no_times);
            assert_eq!(found.iter().map(|doubt| (doubt.kind, doubt.time_s)).collect::<Vec<_>>(), [(DoubtKind::OpenLedger, 1.0)]);
        }
        // What a jump loses is known.
        assert_eq!(doubts(&trace(0.0, 2.0), &no_times), []);
        // A load that hardly stirs has no energy to speak of.
        let mut still = trace(0.0, 0.0);
        still.rows.iter_mut().for_each(|row| row.energy = EnergyLedger { friction: 0.9e-15, ..EnergyLedger::default() });
        assert_eq!(doubts(&still, &no_times), []);
    }

    #[test]
    fn doubts_of_a_run_are_in_the_order_of_time_with_the_obstacle_that_it_touches() {
        let mut trace = trace(0.0, 0.0);
        trace.rows[4] = Row { contacts: row(0.0, EnergyLedger::default(), &[2, 2]).contacts, ..trace.rows[4].clone() };
        trace.rows[6] = Row { contacts: row(0.0, EnergyLedger::default(), &[1, 2]).contacts, ..trace.rows[6].clone() };
        let times = DoubtTimes { overlap_s: Some(3.0), gate_cut_s: Some(5.0), not_converged_s: Some(1.0), ..DoubtTimes::default() };
        let found = doubts(&trace, &times).iter().map(|doubt| (doubt.kind, doubt.time_s, doubt.obstacle)).collect::<Vec<_>>();
        let expected = [(DoubtKind::NotConverged, 1.0, None), (DoubtKind::Overlap, 3.0, Some(2)), (DoubtKind::GateCut, 5.0, None)];
        assert_eq!(found, expected);
    }

    #[test]
    fn a_motion_that_is_not_unique_is_doubtful_at_its_transition() {
        let times = DoubtTimes { not_unique_s: Some(2.0), ..DoubtTimes::default() };
        assert_eq!(doubts(&trace(0.0, 0.0), &times)[0].time_s, 2.0);
        let kind = TransitionKind::NotUnique { obstacle: 3 };
        let with_transition = Trace { transitions: vec![Transition { time: 2.25, kind }], ..trace(0.0, 0.0) };
        let found = doubts(&with_transition, &times);
        assert_eq!((found[0].kind, found[0].time_s, found[0].obstacle), (DoubtKind::NotUnique, 2.25, Some(3)));
    }
}
