//! Springs as sensors: their stiffnesses and the errors of these.

use super::case::Case;
use super::equivalents::PAPER_STRETCH;
use super::fit::{Calibration, EDGE};
use super::trials::Estimate;
use cohaul::math::Vec2;
use cohaul::model::{PolarSpring, SpringDesign, paper};

/// Relative difference of rest lengths above which two springs have different designs (1).
const SAME_LENGTH: f64 = 0.01;

/// Springs, at least one, and the errors of what they measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Springs by index; the first one also stands for further indices.
    pub springs: Vec<PolarSpring>,
    /// Standard error of kappa_rho (N/m).
    pub radial_error: f64,
    /// Standard error of kappa_tau (N m/rad).
    pub torsional_error: f64,
    /// Standard deviation of a tip position along either axis (m).
    pub tip_error: f64,
    /// Model for Eq. (1).
    pub model: Option<SpringDesign>,
    /// Range of the fit of the stiffnesses, if they were fitted.
    pub fitted_to: FittedTo,
}

/// Largest displacements of the readings of a fit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FittedTo {
    /// Largest stretch or compression (m).
    pub stretch: Option<f64>,
    /// Largest swing clockwise and counter-clockwise (rad). A side without readings has the range
    /// of the other side.
    pub swing: Option<[f64; 2]>,
}

impl FittedTo {
    fn of(found: &Calibration) -> Self {
        let farthest = |is_radial| found.linear.iter().filter(move |fit| fit.case.is_radial() == is_radial).filter_map(|fit| fit.farthest);
        let [clockwise, counter] = [-1.0, 1.0].map(|side| farthest(false).map(|at| side * at).filter(|at| *at > 0.0).reduce(f64::max));
        let swing = clockwise.or(counter).zip(counter.or(clockwise)).map(|(clockwise, counter)| [clockwise, counter]);
        Self { stretch: farthest(true).map(f64::abs).reduce(f64::max), swing }
    }

    /// Whether this `stretch` (m) or `swing` (rad) is beyond all readings.
    pub fn ends_before(&self, stretch: f64, swing: f64) -> bool {
        let is_beyond = |at: f64, end: f64| at > end * (1.0 + EDGE);
        let end = self.swing.map(|[clockwise, counter]| if swing < 0.0 { clockwise } else { counter });
        self.stretch.is_some_and(|end| is_beyond(stretch.abs(), end)) || end.is_some_and(|end| is_beyond(swing.abs(), end))
    }
}

impl Sensor {
    /// The paper's spring, for tips in the frames of their roots.
    pub fn paper() -> Self {
        let spring = PolarSpring {
            root: Vec2::zeros(),
            bearing: 0.0,
            rest_length: paper::SPRING.rest_length(),
            radial_stiffness: paper::RADIAL_STIFFNESS_N_PER_M,
            torsional_stiffness: paper::TORSIONAL_STIFFNESS_NM_PER_RAD,
            ..PolarSpring::default()
        };
        Self { model: Some(paper::SPRING), ..Self::exact(vec![spring]) }
    }

    /// Springs with exactly known stiffnesses.
    pub fn exact(springs: Vec<PolarSpring>) -> Self {
        Self { springs, radial_error: 0.0, torsional_error: 0.0, tip_error: 0.0, model: None, fitted_to: FittedTo::default() }
    }

    /// These springs with the fitted stiffnesses and their errors. A stiffness that was not
    /// measured follows from E as in the paper: kappa_rho as the secant at 8 mm, kappa_tau as the
    /// sum of all pivots.
    pub fn calibrated(mut self, found: &Calibration) -> Self {
        let modulus = &found.youngs_modulus_pa;
        let design = found.dimensions.of_material(modulus.value);
        let of_modulus = |stiffness: f64| [stiffness, stiffness * modulus.standard_error / modulus.value];
        let stretch = PAPER_STRETCH.min(0.5 * Case::Radial.limit(&design));
        let measured = |estimate: Option<Estimate>| estimate.map(|found| [found.value, found.standard_error]);
        let radial = measured(found.radial_stiffness_n_per_m).unwrap_or_else(|| of_modulus(design.secant_radial_stiffness(stretch)));
        let torsional = measured(found.torsional_stiffness_nm_per_rad).unwrap_or_else(|| of_modulus(design.torsional_stiffness()));
        for spring in &mut self.springs {
            (spring.radial_stiffness, spring.torsional_stiffness) = (radial[0], torsional[0]);
        }
        Self { radial_error: radial[1], torsional_error: torsional[1], model: Some(design), fitted_to: FittedTo::of(found), ..self }
    }

    /// These springs with the given stiffnesses (N/m, N m/rad), which count as exact.
    pub fn with_given(mut self, radial: Option<f64>, torsional: Option<f64>) -> Self {
        for spring in &mut self.springs {
            spring.radial_stiffness = radial.unwrap_or(spring.radial_stiffness);
            spring.torsional_stiffness = torsional.unwrap_or(spring.torsional_stiffness);
        }
        let error = |given: Option<f64>, fitted: f64| if given.is_some() { 0.0 } else { fitted };
        let FittedTo { stretch, swing } = self.fitted_to;
        Self {
            radial_error: error(radial, self.radial_error),
            torsional_error: error(torsional, self.torsional_error),
            fitted_to: FittedTo { stretch: stretch.filter(|_| radial.is_none()), swing: swing.filter(|_| torsional.is_none()) },
            ..self
        }
    }

    pub fn spring(&self, index: usize) -> &PolarSpring {
        self.springs.get(index).unwrap_or(&self.springs[0])
    }

    /// Rest length of a spring with another design than the model, if there is one (m).
    pub fn foreign_length(&self) -> Option<f64> {
        let own = self.model?.rest_length();
        self.springs.iter().map(|spring| spring.rest_length).find(|length| (length / own - 1.0).abs() > SAME_LENGTH)
    }
}
