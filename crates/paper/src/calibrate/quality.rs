//! Goodness of fit of a law.

use serde::{Deserialize, Serialize};

use super::case::Case;
use super::law::Law;
use super::measurements::{Measurement, Trial};
use super::trials::{Estimate, Point, TrialSlope, Weighting, chance_of_none, pool};
use cohaul::model::SpringDesign;

/// Residuals of a law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Goodness {
    /// About the law of all trials.
    pub residual_rms_n: f64,
    /// Residuals with a separate slope for each trial.
    pub residual_rms_within_trials_n: f64,
    /// Chi squared over degrees of freedom of the law for all trials; `null` without error bars,
    /// and for a single point. Differences between trials increase it.
    pub reduced_chi_squared: Option<f64>,
    /// `null` for one trial, and for trials with fewer than three points.
    pub bend: Option<Bend>,
}

/// A cubic term fitted beside the law. It is zero if the law holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bend {
    /// Largest effect of the term at a reading.
    pub force_n: f64,
    /// Displacement of that reading (m or rad).
    pub at: f64,
    /// Probability of a term as large between trials, if the law held.
    pub p_value: f64,
}

/// Difference between the linear law and the pseudo-rigid-body model with the fitted E, over a
/// range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Misfit {
    /// Linear law minus model, at the largest difference.
    pub force_n: f64,
    /// Displacement at the largest difference (m or rad).
    pub at: f64,
    /// Largest difference over the force of the model there.
    pub share: f64,
    /// Linear law minus model at the end of the range.
    pub force_at_end_n: f64,
}

impl Goodness {
    /// Goodness of a slope in the trials of one case.
    pub fn of(trials: &[Trial], slope: f64, law: &Law, weighting: Weighting, level: f64) -> Self {
        let points: Vec<Point> = trials.iter().flat_map(|trial| law.points(trial)).collect();
        let residuals = points.iter().map(|point| point.force - slope * point.basis);
        let own = trials.iter().flat_map(|trial| {
            let own = TrialSlope::of(law.points(trial)).map_or(0.0, |trial| trial.slope);
            law.points(trial).map(move |point| point.force - own * point.basis)
        });
        let chi_squared: f64 = points.iter().zip(residuals.clone()).map(|(point, residual)| point.weight * residual * residual).sum();
        let free = points.len() as f64 - 1.0;
        Self {
            residual_rms_n: rms(residuals),
            residual_rms_within_trials_n: rms(own),
            reduced_chi_squared: (weighting == Weighting::Stated && free > 0.0).then(|| chi_squared / free),
            bend: bend(trials, law, weighting, level),
        }
    }
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0usize), |(sum, n), value| (sum + value * value, n + 1));
    if n == 0 { 0.0 } else { (sum / n as f64).sqrt() }
}

/// Fits F = s g + c h in each trial and pools c as any other slope. h is the cube of the
/// displacement without its component along g.
fn bend(trials: &[Trial], law: &Law, weighting: Weighting, level: f64) -> Option<Bend> {
    let largest = trials.iter().flat_map(|trial| &trial.points).map(|point| point.at.abs()).fold(0.0, f64::max);
    let cubes = |trial: &Trial| -> Vec<(Point, f64)> {
        law.points(trial)
            .zip(&trial.points)
            .map(|(point, measured): (Point, &Measurement)| (point, (measured.at / largest).powi(3)))
            .collect()
    };
    let mut terms = Vec::new();
    for trial in trials.iter().filter(|trial| trial.points.len() >= 3) {
        let points = cubes(trial);
        let own = TrialSlope::of(points.iter().map(|(point, _)| *point))?;
        let along = TrialSlope::of(points.iter().map(|(point, cube)| Point { force: *cube, ..*point }))?;
        let rest = points.iter().map(|(point, cube)| Point {
            basis: cube - along.slope * point.basis,
            force: point.force - own.slope * point.basis,
            weight: point.weight,
        });
        // Some displacements cannot separate the cubic term from the law.
        terms.extend(TrialSlope::of(rest).filter(|rest| rest.information > 1e-12 * own.information.min(1.0)));
    }
    let term: Estimate = pool(&terms, weighting, level)?;
    let all: Vec<(Point, f64)> = trials.iter().flat_map(cubes).collect();
    let along = TrialSlope::of(all.iter().map(|(point, cube)| Point { force: *cube, ..*point }))?;
    let made = all.iter().map(|(point, cube)| term.value * (cube - along.slope * point.basis));
    let at = trials.iter().flat_map(|trial| &trial.points).map(|point| point.at);
    let (force_n, at) = made.zip(at).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
    Some(Bend { force_n, at, p_value: chance_of_none(&term)? })
}

impl Misfit {
    /// Misfit of a linear law over [low, high] of its displacement.
    pub fn of(case: Case, design: &SpringDesign, stiffness: f64, [low, high]: [f64; 2]) -> Self {
        const N: usize = 400;
        let apart = |at: f64| stiffness * case.linear(design, at) - case.force(design, at);
        let places = (0..=N).map(|i| low + (high - low) * i as f64 / N as f64);
        let at = places.max_by(|a, b| apart(*a).abs().total_cmp(&apart(*b).abs())).unwrap_or(high);
        let force = case.force(design, at);
        Self { force_n: apart(at), at, share: if force == 0.0 { 0.0 } else { apart(at) / force }, force_at_end_n: apart(high) }
    }
}
