//! The energy balance of a run as a condition on its success.
//!
//! A step that does not resolve its springs or contacts can create energy while its equations are
//! solved to the last digit. The ledger shows it: elastic and kinetic energy and all losses then
//! exceed the work that went in. The opposite, energy that disappears, is the numerical damping of
//! an implicit method, and is no such sign at fixed steps. Under error control the ledger closes.

use serde::{Deserialize, Serialize};

use super::ledger::EnergyLedger;
use super::step_report::{Status, StepReport};
use crate::backend::numerics::{CLOSED_LEDGER, LARGEST_SHARE};

/// Energy that went into a run, against which its gain is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Balance {
    /// Sum of the sizes of all work on tips and of obstacles (J).
    worked: f64,
    /// Work on the tips and of obstacles at the last look (J).
    last: [f64; 2],
    /// Gain that the backend's way of keeping the ledger explains (J).
    explained: f64,
}

impl Balance {
    /// Takes the `ledger` after an advance. Rounding and the rules by which the backend keeps the
    /// ledger explain a gain of up to `explained` (J) in it. A run that has gained more than
    /// 1 % of what went in has not converged.
    pub fn judge(&mut self, ledger: &EnergyLedger, explained: f64, report: &mut StepReport) {
        self.explained += explained;
        let went_in = self.went_in(ledger);
        let gain = ledger.defect() - self.explained;
        if gain > LARGEST_SHARE * went_in {
            fail(gain / went_in, report);
        }
    }

    /// Energy that went into the run up to this ledger (J).
    fn went_in(&mut self, ledger: &EnergyLedger) -> f64 {
        let work = [ledger.tip_work, ledger.obstacle_work];
        self.worked += work.iter().zip(self.last).map(|(now, before)| (now - before).abs()).sum::<f64>();
        self.last = work;
        ledger.initial + self.worked
    }
}

/// Judges the `ledger` at the end of a run of an exact backend. Steps of fixed length may lose
/// energy, and their work is that of the trapezoid rule. A run of them has not converged if its
/// moving load has gained more than 1 % of the largest entry. A run under error control has not
/// converged if its ledger is open, outside of jumps, by more than [`CLOSED_LEDGER`] or the share
/// `tolerance` of its size (1) that it may be wrong by. Energies below `least` (J) are rounding: a
/// load that is held has dashpots whose shapes change by nothing else.
pub fn judge_exact(ledger: &EnergyLedger, tolerance: Option<f64>, least: f64, report: &mut StepReport) {
    let (gain, size) = (ledger.defect_parts().numerical_damping, ledger.largest_entry().max(least));
    let open = ledger.defect() + ledger.jumps;
    if tolerance.is_some_and(|tolerance| open.abs() > tolerance.max(CLOSED_LEDGER) * size) {
        fail(open / size, report);
    } else if gain > LARGEST_SHARE * size {
        fail(gain / size, report);
    }
}

/// Marks the steps of an advance after which the ledger is open by this share (1).
#[cold]
fn fail(share: f64, report: &mut StepReport) {
    report.gained_share = share.clamp(-f64::MAX, f64::MAX);
    report.status = report.status.max(Status::NotConverged);
    report.n_not_converged = report.n_not_converged.max(1);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report_after(ledgers: &[EnergyLedger], explained: f64) -> StepReport {
        let (mut balance, mut sum) = (Balance::default(), StepReport::default());
        for ledger in ledgers {
            let mut report = StepReport { n_steps: 1, ..StepReport::default() };
            balance.judge(ledger, explained, &mut report);
            sum.add(&report);
        }
        sum
    }

    fn kinetic(tip_work: f64, kinetic: f64) -> EnergyLedger {
        EnergyLedger { tip_work, kinetic, ..EnergyLedger::default() }
    }

    #[test]
    fn a_run_that_gains_energy_has_not_converged() {
        assert_eq!(report_after(&[kinetic(1.0, 1.0 + 0.99 * LARGEST_SHARE)], 0.0).status, Status::Converged);
        let gained = report_after(&[kinetic(1.0, 1.0), kinetic(1.0, 1.5), kinetic(1.0, 0.5)], 0.0);
        assert_eq!((gained.status, gained.n_not_converged, gained.gained_share), (Status::NotConverged, 1, 0.5));
    }

    /// A load that is thrown and loses energy that no entry has: at fixed steps that is numerical
    /// damping, under error control it is an error.
    #[test]
    fn under_error_control_the_ledger_closes() {
        let report = |share: f64, tolerance: Option<f64>| {
            let ledger = EnergyLedger { initial: 1.0, kinetic: 1.0 + share, numerical_damping: -share, ..EnergyLedger::default() };
            let mut report = StepReport::default();
            judge_exact(&ledger, tolerance, 0.0, &mut report);
            (report.status, (1e6 * report.gained_share).round())
        };
        let open = 2.0 * CLOSED_LEDGER;
        assert_eq!(report(-open, None), (Status::Converged, 0.0));
        assert_eq!(report(-open, Some(1e-6)), (Status::NotConverged, -2000.0));
        assert_eq!(report(0.5 * CLOSED_LEDGER, Some(1e-6)), (Status::Converged, 0.0));
        assert_eq!(report(-open, Some(2.5 * CLOSED_LEDGER)), (Status::Converged, 0.0));
        assert_eq!(report(2.0 * LARGEST_SHARE, None), (Status::NotConverged, 19_608.0));
    }

    #[test]
    fn energies_of_rounding_are_none() {
        let ledger = EnergyLedger { damping: 1e-30, ..EnergyLedger::default() };
        let status = |least| {
            let mut report = StepReport::default();
            judge_exact(&ledger, Some(1e-6), least, &mut report);
            report.status
        };
        assert_eq!([0.0, 1e-20].map(status), [Status::NotConverged, Status::Converged]);
    }

    #[test]
    fn a_loss_is_no_gain() {
        assert_eq!(report_after(&[kinetic(1.0, 0.0)], 0.0), StepReport { n_steps: 1, ..StepReport::default() });
    }

    /// Work that goes in and comes out again counts twice, so that rounding of an oscillation is
    /// compared with all of it.
    #[test]
    fn work_to_and_fro_adds_up() {
        let to_and_fro = [kinetic(1.0, 1.0), kinetic(0.0, 0.5 * LARGEST_SHARE)];
        assert_eq!(report_after(&to_and_fro, 0.0).status, Status::Converged);
    }

    #[test]
    fn energy_without_any_work_is_a_gain() {
        assert_eq!(report_after(&[kinetic(0.0, 1e-9)], 0.0).gained_share, f64::MAX);
        assert_eq!(report_after(&[kinetic(0.0, 1e-9)], 1e-9).status, Status::Converged);
        assert_eq!(report_after(&[kinetic(0.0, 0.0)], 0.0).status, Status::Converged);
    }
}
