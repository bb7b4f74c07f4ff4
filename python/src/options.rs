//! Options of a backend and settings of a comparison, as JSON from Python.

use std::fmt::Display;

use cohaul::analysis::compare::Settings;
use cohaul::backend::{BackendKind, BackendOptions, Integrator, RapierOptions, Setting, Skip, Skips, Tolerance};
use cohaul::scenario::Scenario;
use cohaul_studies::sweep::Variant;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// Most steps in a control period (1), as of the program: a run is interrupted between periods.
const MOST_STEPS: f64 = 1e6;

/// Options of a run. All are optional.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Asked {
    backend: Option<String>,
    step_s: Option<f64>,
    tolerance_m: Option<f64>,
    tolerance_rad: Option<f64>,
    integrator: Option<String>,
    second_order: bool,
    rate_independent: bool,
    no_skip: Vec<String>,
    rapier: AskedEngine,
}

/// Options of rapier.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct AskedEngine {
    friction: Option<String>,
    springs: Option<String>,
    precision: Option<String>,
    settings: Option<String>,
}

/// Settings of a comparison. All are optional.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AskedComparison {
    step_s: Option<f64>,
    halvings: Option<u32>,
    reference_tolerance_m: Option<f64>,
    recorded_from: Option<String>,
    rate_independent: bool,
    tolerance_share: Option<f64>,
    tolerance_heading_rad: Option<f64>,
    tolerance_pull_share: Option<f64>,
    tolerance_speed_share: Option<f64>,
    tolerance_energy_share: Option<f64>,
    no_skip: Vec<String>,
    rapier: AskedEngine,
}

/// An error that names the option, its rule, and what was found.
pub fn refused(path: &str, rule: &str, found: impl Display) -> PyErr {
    PyValueError::new_err(format!("{path}: {rule}, found {found}"))
}

/// # Errors
/// When the text has unknown keys, or values of the wrong type.
pub fn read<T: DeserializeOwned>(text: &str) -> PyResult<T> {
    serde_json::from_str(text).map_err(|error| PyValueError::new_err(format!("options: {error}")))
}

/// The value of a name, with hyphens or underscores.
///
/// # Errors
/// When there is no such name.
pub fn named<T: DeserializeOwned>(path: &str, name: &str) -> PyResult<T> {
    let of = |name: String| serde_json::from_value(serde_json::Value::String(name));
    let found = of(name.to_owned()).or_else(|error| of(name.replace('-', "_")).map_err(|_| error));
    found.map_err(|error| PyValueError::new_err(format!("{path}: {error}")))
}

fn named_if<T: DeserializeOwned>(path: &str, name: Option<&String>) -> PyResult<Option<T>> {
    name.map(|name| named(path, name)).transpose()
}

fn skips(names: &[String]) -> PyResult<Skips> {
    let skips: Vec<Skip> = names.iter().map(|name| named("no_skip", name)).collect::<PyResult<_>>()?;
    Ok(Skips::ALL.without_all(&skips))
}

/// # Errors
/// When a control period would have more steps than [`MOST_STEPS`].
pub fn check_step(step_s: Option<f64>, period: f64) -> PyResult<()> {
    let least = period / MOST_STEPS;
    match step_s.filter(|step| *step < least) {
        Some(step) => Err(refused("step_s", &format!("must be at least {least:e} s, 1e-6 of the control period"), step)),
        None => Ok(()),
    }
}

impl Asked {
    pub fn kind(&self) -> PyResult<BackendKind> {
        self.backend.as_ref().map_or(Ok(BackendKind::QuasiStatic), |name| named("backend", name))
    }

    /// # Errors
    /// When an option is unknown, or belongs to another backend.
    pub fn options(&self, scenario: &Scenario) -> PyResult<BackendOptions> {
        let variant = self.variant()?;
        check_step(self.step_s, scenario.control_period)?;
        if let Some(position_m) = self.tolerance_m {
            let tolerance = Tolerance::at_edge(position_m, &scenario.system.load);
            let heading_rad = self.tolerance_rad.unwrap_or(tolerance.heading_rad);
            let tolerance = Tolerance { heading_rad, ..tolerance };
            let options = BackendOptions::within(variant.backend, tolerance);
            return Ok(BackendOptions { skips: variant.skips, rate_independent: self.rate_independent, ..options });
        }
        if self.tolerance_rad.is_some() {
            return Err(refused("tolerance_rad", "must come with tolerance_m", "it alone"));
        }
        Ok(BackendOptions {
            integrator: variant.integrator,
            rapier: variant.rapier,
            skips: variant.skips,
            second_order: self.second_order,
            rate_independent: self.rate_independent,
            ..BackendOptions::at_step(self.step_s, variant.backend, &scenario.system, scenario.control_period)
        })
    }

    /// The options without those that depend on the scenario.
    ///
    /// # Errors
    /// As [`Asked::options`].
    pub fn variant(&self) -> PyResult<Variant> {
        let backend = self.kind()?;
        let of_others = [
            ("integrator", Setting::Integrator, self.integrator.is_some()),
            ("second_order", Setting::SecondOrder, self.second_order),
            ("rate_independent", Setting::RateIndependent, self.rate_independent),
            ("rapier", Setting::Engine, self.rapier.is_given()),
        ];
        if let Some((name, ..)) = of_others.iter().find(|(_, setting, is_given)| *is_given && !backend.reads(*setting)) {
            return Err(refused(name, "must come with a backend that reads it", backend.name()));
        }
        if self.tolerance_m.is_some() && !backend.is_exact() {
            return Err(refused("tolerance_m", &backend.tolerance_rule(), backend.name()));
        }
        let of_steps = [("step_s", self.step_s.is_some()), ("integrator", self.integrator.is_some()), ("second_order", self.second_order)];
        if let Some((name, _)) = of_steps.iter().find(|(_, is_given)| self.tolerance_m.is_some() && *is_given) {
            return Err(refused(name, "must not come with tolerance_m, which replaces fixed steps", "both"));
        }
        Ok(Variant {
            backend,
            step_s: self.step_s,
            tolerance_m: self.tolerance_m,
            integrator: named_if::<Integrator>("integrator", self.integrator.as_ref())?.unwrap_or_default(),
            rapier: self.rapier.options()?,
            skips: skips(&self.no_skip)?,
        })
    }
}

impl AskedEngine {
    fn is_given(&self) -> bool {
        [&self.friction, &self.springs, &self.precision, &self.settings].iter().any(|option| option.is_some())
    }

    fn options(&self) -> PyResult<RapierOptions> {
        Ok(RapierOptions::asked(
            named_if("rapier.settings", self.settings.as_ref())?,
            named_if("rapier.friction", self.friction.as_ref())?,
            named_if("rapier.springs", self.springs.as_ref())?,
            named_if("rapier.precision", self.precision.as_ref())?,
        ))
    }
}

impl AskedComparison {
    /// # Errors
    /// When a name is unknown, or the step too short.
    pub fn settings(&self, scenario: &Scenario) -> PyResult<Settings> {
        check_step(self.step_s, scenario.control_period)?;
        let usual = Settings::default();
        Ok(Settings {
            step_s: self.step_s,
            halvings: self.halvings.unwrap_or(usual.halvings),
            reference_tolerance_m: self.reference_tolerance_m,
            rapier: self.rapier.options()?,
            recorded_from: named_if("recorded_from", self.recorded_from.as_ref())?.unwrap_or(usual.recorded_from),
            rate_independent: self.rate_independent,
            tolerance_share: self.tolerance_share.unwrap_or(usual.tolerance_share),
            tolerance_heading_rad: self.tolerance_heading_rad,
            tolerance_pull_share: self.tolerance_pull_share.unwrap_or(usual.tolerance_pull_share),
            tolerance_speed_share: self.tolerance_speed_share.unwrap_or(usual.tolerance_speed_share),
            tolerance_energy_share: self.tolerance_energy_share.unwrap_or(usual.tolerance_energy_share),
            skips: skips(&self.no_skip)?,
            ..usual
        })
    }
}
