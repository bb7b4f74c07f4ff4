//! Young's modulus E, linear kappa_rho and linear kappa_tau of measurements.
//!
//! Eq. (1) to (3) are E times a known function of the displacement. Weighted least squares
//! therefore has a closed form with a single minimum. One E holds for all cases. The model gives
//! the two directions of swinging different stiffnesses. kappa_tau is a compromise between them, in
//! which each case has the same weight.

use serde::{Deserialize, Serialize};

use super::case::Case;
use super::dimensions::Dimensions;
use super::equivalents::{RadialEquivalents, SwingEquivalents};
use super::law::Law;
use super::measurements::{Measurements, Trial};
use super::quality::{Goodness, Misfit};
use super::trials::{Estimate, TrialSlope, Weighting, agreement, mean_of_cases, pool};
use cohaul::formats::{self, Format, Versioned};
use cohaul::model::SpringDesign;

/// Ranges of the displacement, without sign, over which the linear laws are fitted. Without a
/// range, all readings count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ranges {
    /// (m)
    pub stretch: Option<[f64; 2]>,
    /// (rad)
    pub swing: Option<[f64; 2]>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    pub confidence: f64,
    pub dimensions: Dimensions,
    /// Young's modulus over all trials of all cases.
    pub youngs_modulus_pa: Estimate,
    pub cases: Vec<CaseFit>,
    /// Probability of moduli that differ as much, if all cases had the same one; `null` if fewer
    /// than two cases have an interval.
    pub cases_agree_p_value: Option<f64>,
    /// `null` without radial readings.
    pub radial_stiffness_n_per_m: Option<Estimate>,
    /// Mean of the tangential cases; `null` without any.
    pub torsional_stiffness_nm_per_rad: Option<Estimate>,
    pub swings_agree_p_value: Option<f64>,
    pub linear: Vec<LinearFit>,
    pub radial_equivalents: Option<RadialEquivalents>,
    pub swing_equivalents: SwingEquivalents,
    pub warnings: Vec<String>,
}

impl Versioned for Calibration {
    const FORMAT: Format = formats::CALIBRATE_FIT;
}

/// The pseudo-rigid-body model in one case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseFit {
    pub case: Case,
    /// Young's modulus of this case alone.
    pub youngs_modulus_pa: Estimate,
    /// Goodness of fit with the modulus of all cases.
    pub goodness: Goodness,
}

/// The linear law in one case: kappa_rho (N/m), or kappa_tau (N m/rad).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinearFit {
    pub case: Case,
    /// Range of the displacement, without sign (m or rad).
    pub range: [f64; 2],
    /// The largest displacement of a reading in the range, with its sign (m or rad).
    #[serde(default)]
    pub farthest: Option<f64>,
    pub stiffness: Estimate,
    pub goodness: Goodness,
    pub misfit: Misfit,
}

/// Fits measurements of a spring with these dimensions; intervals have the confidence `level`.
///
/// # Errors
///
/// When a range contains fewer than two readings, or the readings have no positive stiffness.
pub fn fit(measurements: &Measurements, dimensions: &Dimensions, ranges: &Ranges, level: f64) -> Result<Calibration, String> {
    let weighting = if measurements.has_sds() { Weighting::Stated } else { Weighting::FromScatter };
    let by_case: Vec<(Case, Vec<Trial>)> = Case::ALL
        .into_iter()
        .map(|case| (case, measurements.of_case(case).cloned().collect::<Vec<_>>()))
        .filter(|(_, trials)| !trials.is_empty())
        .collect();
    let law = |case: Case, is_linear| Law { case, unit: dimensions.of_material(1.0), is_linear, weighting };

    let slopes: Vec<TrialSlope> = by_case.iter().flat_map(|(case, trials)| law(*case, false).slopes(trials)).collect();
    let modulus = positive("Young's modulus", pool(&slopes, weighting, level))?;
    let design = dimensions.of_material(modulus.value);
    let mut cases = Vec::new();
    for (case, trials) in &by_case {
        let law = law(*case, false);
        let own = positive(&format!("Young's modulus of case {}", case.name()), pool(&law.slopes(trials), weighting, level))?;
        cases.push(CaseFit { case: *case, youngs_modulus_pa: own, goodness: Goodness::of(trials, modulus.value, &law, weighting, level) });
    }
    let mut linear = Vec::new();
    for (case, trials) in &by_case {
        linear.push(linear_fit(&law(*case, true), trials, &design, ranges, level)?);
    }

    let radial = linear.iter().find(|fit| fit.case.is_radial());
    let swings: Vec<Estimate> = linear.iter().filter(|fit| !fit.case.is_radial()).map(|fit| fit.stiffness).collect();
    let moduli: Vec<Estimate> = cases.iter().map(|fit| fit.youngs_modulus_pa).collect();
    let mut found = Calibration {
        confidence: level,
        dimensions: *dimensions,
        youngs_modulus_pa: modulus,
        cases_agree_p_value: agreement(&moduli),
        cases,
        radial_stiffness_n_per_m: radial.map(|fit| fit.stiffness),
        torsional_stiffness_nm_per_rad: mean_of_cases(&swings, level),
        swings_agree_p_value: agreement(&swings),
        radial_equivalents: radial.map(|fit| RadialEquivalents::of(&design, fit.range, fit.stiffness.value)),
        swing_equivalents: SwingEquivalents::of(&design),
        linear,
        warnings: Vec::new(),
    };
    found.warnings = warnings(&found);
    Ok(found)
}

fn linear_fit(law: &Law, trials: &[Trial], design: &SpringDesign, ranges: &Ranges, level: f64) -> Result<LinearFit, String> {
    let case = law.case;
    let sizes = trials.iter().flat_map(|trial| &trial.points).map(|point| point.at.abs());
    let asked = if case.is_radial() { ranges.stretch } else { ranges.swing };
    let range = asked.unwrap_or([0.0, sizes.fold(0.0, f64::max)]);
    let within: Vec<Trial> = trials.iter().map(|trial| of_range(trial, range)).filter(|trial| !trial.points.is_empty()).collect();
    let [low, high] = range;
    let reach = case.limit(design);
    if high >= reach {
        return Err(format!("range of case {}: must end below {reach:.4} {}, found {high}", case.name(), case.unit()));
    }
    let n = within.iter().flat_map(|trial| &trial.points).filter(|point| point.at != 0.0).count();
    if n < 2 {
        let unit = case.unit();
        return Err(format!("case {}: must have two points or more from {low} to {high} {unit}, found {n}", case.name()));
    }
    let name = format!("stiffness of case {}", case.name());
    let stiffness = positive(&name, pool(&law.slopes(&within), law.weighting, level))?;
    let goodness = Goodness::of(&within, stiffness.value, law, law.weighting, level);
    let places = within.iter().flat_map(|trial| &trial.points).map(|point| point.at);
    let farthest = places.max_by(|a, b| a.abs().total_cmp(&b.abs()));
    Ok(LinearFit { case, range, farthest, stiffness, goodness, misfit: Misfit::of(case, design, stiffness.value, range) })
}

/// Margin at both ends of a range, as a share of its far end (1). A rounded reading at an end lies
/// within the range.
pub(super) const EDGE: f64 = 1e-9;

fn of_range(trial: &Trial, [low, high]: [f64; 2]) -> Trial {
    let edge = EDGE * high;
    let points = trial.points.iter().filter(|point| (low - edge..=high + edge).contains(&point.at.abs())).copied().collect();
    Trial { points, ..trial.clone() }
}

/// The estimate, if a spring can have it.
fn positive(name: &str, estimate: Option<Estimate>) -> Result<Estimate, String> {
    match estimate {
        Some(found) if found.value > 0.0 && found.is_finite() => Ok(found),
        Some(found) if found.value <= 0.0 => {
            Err(format!("{name}: must be positive, found {:.4e}: do force and displacement have opposite signs?", found.value))
        }
        _ => Err(format!("{name}: readings are too large or too small to be fitted")),
    }
}

/// Below this chance things that should be one are said to differ.
const UNLIKELY: f64 = 0.01;
/// Share of the force from which the linear law is said to miss.
const NOTABLE_MISFIT: f64 = 0.1;
/// Young's modulus (Pa) of elastomers, from which springs as soft as an ant's pull are cut.
const MODULI: [f64; 2] = [1e4, 1e9];

fn warnings(found: &Calibration) -> Vec<String> {
    let mut warnings = Vec::new();
    for fit in found.linear.iter().filter(|fit| fit.stiffness.n_trials == 1) {
        warnings.push(format!("case {}: one trial cannot tell how trials differ, so it has no interval", fit.case.name()));
    }
    let modulus = ("E".to_owned(), &found.youngs_modulus_pa);
    let stiffnesses = found.linear.iter().map(|fit| (format!("case {}", fit.case.name()), &fit.stiffness));
    for (what, estimate) in std::iter::once(modulus).chain(stiffnesses).filter(|(_, estimate)| estimate.is_of_one_trial()) {
        let percent = 100.0 * estimate.largest_weight.unwrap_or_default();
        warnings.push(format!("{what}: one trial has {percent:.0} % of the weight, so that its interval may be far too narrow"));
    }
    if found.cases_agree_p_value.is_some_and(|p| p < UNLIKELY) {
        warnings.push("the cases have different moduli: one E does not describe this spring".to_owned());
    }
    let (low, high) = (MODULI[0], MODULI[1]);
    if !(low..high).contains(&found.youngs_modulus_pa.value) {
        warnings
            .push(format!("a Young's modulus of {:.2e} Pa is not that of an elastomer: are forces in N?", found.youngs_modulus_pa.value));
    }
    if found.swings_agree_p_value.is_some_and(|p| p < UNLIKELY) {
        warnings.push("the spring swings more stiffly to one side: kappa_tau is a mean of both".to_owned());
    }
    for fit in &found.linear {
        let name = fit.case.name();
        if fit.misfit.share.abs() > NOTABLE_MISFIT {
            let (percent, unit) = (100.0 * fit.misfit.share, fit.case.unit());
            warnings.push(format!("case {name}: the linear law is {percent:+.0} % off the model at {:.4} {unit}", fit.misfit.at));
        }
    }
    for fit in found.cases.iter().filter(|fit| fit.goodness.bend.is_some_and(|bend| bend.p_value < UNLIKELY)) {
        warnings.push(format!("case {}: readings bend away from the pseudo-rigid-body model", fit.case.name()));
    }
    warnings
}
