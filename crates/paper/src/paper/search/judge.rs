//! Second look at a set that came close: more seeds, with and without inertia, and every quantity
//! and claim of the study.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::screen::{Set, distance, runs};
use super::space::TRIALS;
use crate::paper::{Estimate, Grade, Measure, Sampling, Unit, claims, largest, measures, units};
use cohaul::backend::BackendKind;

/// What is known of one set. Lists have the order of [`reported`] and of the claims.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// Distance to the targets (1), without inertia and on the seeds of this look.
    pub distance: Option<f64>,
    pub measures: Vec<OnBoth>,
    pub largest_pull: Option<Largest>,
    /// Each without and with inertia.
    pub claims: Vec<[Standing; 2]>,
}

/// A quantity without and with inertia.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OnBoth {
    pub quasi_static: Option<Estimate>,
    pub inertial: Option<Estimate>,
    /// Inertial minus quasi-static, in pairs of seeds.
    pub minus: Option<Estimate>,
    /// Without inertia, beside the printed number.
    pub grade: Option<Grade>,
}

/// The largest pull of a sample of the printed size (N), and its grade.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Largest {
    pub expected_n: f64,
    pub grade: Grade,
}

/// How a claim stands on a set.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    pub value: Option<f64>,
    /// `null` when these seeds do not tell.
    pub holds: Option<bool>,
}

/// All quantities of the second look: those of the study's table, and the load speed by the number
/// of pulling ants.
pub fn reported() -> Vec<Measure> {
    let speeds = (1..=10).map(Measure::LoadSpeed);
    measures().into_iter().chain(speeds).chain([2, 5, 10].map(Measure::Headway)).collect()
}

/// The second look at a set; `None` when `watch` said no.
pub fn judged(set: Set, seeds: Range<u64>, watch: &dyn Fn() -> bool) -> Option<Judged> {
    let on = |backend| runs(set, backend, &TRIALS, seeds.clone(), watch);
    let (without, with) = (on(BackendKind::QuasiStatic)?, on(BackendKind::Inertial)?);
    Some(Judged::of(&units(&without), &units(&with)))
}

impl Judged {
    fn of(without: &[Unit], with: &[Unit]) -> Self {
        let on_both = |measure: Measure| {
            let (quasi_static, grade) = measure.graded(without);
            OnBoth { quasi_static, inertial: measure.estimate(with), minus: measure.difference(with, without), grade }
        };
        let standings = |units: &[Unit]| {
            let of = |claim: crate::paper::Claim| Standing { value: claim.found.map(|found| found.value), holds: claim.holds };
            claims(units).into_iter().map(of).collect::<Vec<_>>()
        };
        let largest = largest(without, Sampling::AtDecisions);
        Self {
            distance: distance(without),
            measures: reported().into_iter().map(on_both).collect(),
            largest_pull: largest.map(|found| Largest { expected_n: found.expected, grade: found.grade() }),
            claims: standings(without).into_iter().zip(standings(with)).map(|(a, b)| [a, b]).collect(),
        }
    }
}
