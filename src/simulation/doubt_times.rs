//! When a run was first doubtful.

use serde::{Deserialize, Serialize};

use crate::backend::{Status, StepReport};

/// Starts of the first advances in which a backend reported a doubt (s); `None` for a doubt that it
/// never reported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DoubtTimes {
    /// The load lay inside an obstacle at the end of an accepted step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overlap_s: Option<f64>,
    /// A step ended inside an obstacle and was cut at the touch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gate_cut_s: Option<f64>,
    /// Another motion was admissible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_unique_s: Option<f64>,
    /// A step did not converge.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_converged_s: Option<f64>,
}

impl DoubtTimes {
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Notes the doubts of an advance that began at `time` (s).
    pub(super) fn note(&mut self, report: &StepReport, time: f64) {
        let doubts = &report.doubts;
        if doubts.is_empty() && report.status == Status::Converged {
            return;
        }
        let note = |first: &mut Option<f64>, is_doubtful: bool| {
            if is_doubtful {
                first.get_or_insert(time);
            }
        };
        note(&mut self.overlap_s, doubts.overlap_m != 0.0);
        note(&mut self.gate_cut_s, doubts.n_gate_cuts > 0);
        note(&mut self.not_unique_s, doubts.n_not_unique > 0);
        note(&mut self.not_converged_s, report.status != Status::Converged);
    }
}
