//! The laws that are fitted: a function of the displacement times a number.

use super::case::Case;
use super::measurements::Trial;
use super::trials::{Point, TrialSlope, Weighting};
use cohaul::model::SpringDesign;

/// A law of the force that is linear in the fitted number.
pub struct Law {
    pub case: Case,
    /// The spring with a Young's modulus of 1 Pa.
    pub unit: SpringDesign,
    pub is_linear: bool,
    pub weighting: Weighting,
}

impl Law {
    pub fn points<'a>(&'a self, trial: &'a Trial) -> impl Iterator<Item = Point> + Clone + 'a {
        trial.points.iter().map(move |point| Point {
            basis: if self.is_linear { self.case.linear(&self.unit, point.at) } else { self.case.force(&self.unit, point.at) },
            force: point.force,
            weight: match (self.weighting, point.sd) {
                (Weighting::Stated, Some(sd)) => 1.0 / (sd * sd),
                _ => 1.0,
            },
        })
    }

    pub fn slopes(&self, trials: &[Trial]) -> Vec<TrialSlope> {
        trials.iter().filter_map(|trial| TrialSlope::of(self.points(trial))).collect()
    }
}
