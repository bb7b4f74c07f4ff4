//! Tips and springs that `calibrate` reads: the same options for every command that needs pulls.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use clap::Args;
use serde::Deserialize;
use serde_json::{Value, json};

use super::super::choice::{not_negative, positive};
use super::super::error::CliError;
use super::super::input::{name_of, read_json, read_scenario, read_text};
use super::super::output::measured_manifest;
use cohaul::formats;
use cohaul::model::paper;
use cohaul::scenario::Scenario;
use cohaul_paper::calibrate::{Calibration, Force, Recording, Sample, Sensor, headings_in_degrees};
use cohaul_report::folder::MANIFEST;
use cohaul_report::manifest::Manifest;
use cohaul_report::quantity::quantity;

#[derive(Args)]
pub struct SensorArgs {
    /// Table of tip positions (CSV), - for standard input, or the output folder of a run
    pub recording: PathBuf,
    /// Scenario of the springs; needed for tips in world axes
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
    #[command(flatten)]
    pub springs: SpringArgs,
}

/// How springs measure forces.
#[derive(Args, Clone)]
pub struct SpringArgs {
    /// Calibration of `cohaul calibrate fit`, in place of the scenario's stiffnesses
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// Radial stiffness kappa_rho, in place of all others (N/m)
    #[arg(long, value_name = "K", value_parser = positive)]
    radial_stiffness_n_per_m: Option<f64>,
    /// Torsional stiffness kappa_tau, in place of all others (N m/rad)
    #[arg(long, value_name = "T", value_parser = positive)]
    torsional_stiffness_nm_per_rad: Option<f64>,
    /// Standard deviation of a tip position along either axis (m)
    #[arg(long, value_name = "M", default_value = "0", value_parser = not_negative)]
    tip_noise_m: f64,
}

/// Recorded tips with the springs that measure their pulls.
pub struct SensorInput {
    /// Name and text of the table.
    pub name: String,
    pub table: String,
    pub scenario: Option<Scenario>,
    pub sensor: Sensor,
    pub recording: Recording,
    /// Rows of releases; `None` for a table without a column of events.
    pub releases: Option<Vec<Sample>>,
    /// Whether dashpots contributed to the forces; a rate-independent run leaves them out.
    has_dashpots: bool,
    calibration: Option<PathBuf>,
}

/// The parts of a run's manifest that are needed here.
#[derive(Deserialize)]
struct Ran {
    scenario: Value,
    options: Value,
}

impl SensorArgs {
    /// Reads the table and the springs.
    pub fn read(&self) -> Result<SensorInput, CliError> {
        let file = table_of(&self.recording)?;
        let scenario = self.scenario()?;
        let sensor = self.sensor(scenario.as_ref())?;
        let rest_length = sensor.springs.iter().map(|spring| spring.rest_length).fold(0.0, f64::max);
        // Isotropic springs have no rest length.
        let rest_length = if rest_length > 0.0 { rest_length } else { paper::SPRING.rest_length() };
        let (table, name) = (read_text(&file)?, name_of(&file));
        let n_springs = scenario.as_ref().map(|scenario| scenario.system.springs.len());
        let (recording, releases) = Recording::with_releases(&table, &name, n_springs, rest_length)?;
        if scenario.is_none() && recording.is_in_world() {
            let rule = "tips in world axes need --scenario, which has the roots of the springs";
            return Err(CliError::Usage(format!("{name}: {rule}")));
        }
        self.check_units(&name, &recording, &sensor, rest_length)?;
        let (has_dashpots, calibration) = (self.has_dashpots()?, self.springs.calibration.clone());
        Ok(SensorInput { name, table, scenario, sensor, recording, releases, has_dashpots, calibration })
    }

    /// Refuses units that the numbers show to be wrong.
    fn check_units(&self, name: &str, recording: &Recording, sensor: &Sensor, rest_length: f64) -> Result<(), CliError> {
        if let Some((rule, found)) = headings_in_degrees(recording, sensor) {
            return Err(CliError::Usage(format!("{name}: heading_rad: {rule}, found headings up to {found:.3}")));
        }
        if self.springs.tip_noise_m > rest_length {
            let (rule, found) =
                (format!("must be below the rest length, {rest_length} m (is it in millimetres?)"), self.springs.tip_noise_m);
            return Err(CliError::Usage(format!("--tip-noise-m: {rule}, found {found}")));
        }
        Ok(())
    }

    /// The scenario of the option, or of the run in the folder.
    fn scenario(&self) -> Result<Option<Scenario>, CliError> {
        if let Some(path) = &self.scenario {
            return read_scenario(path, None).map(Some);
        }
        if !self.recording.is_dir() {
            return Ok(None);
        }
        let (path, ran) = ran(&self.recording)?;
        Ok(Some(Scenario::parse(&ran.scenario.to_string(), &path.display().to_string())?))
    }

    /// Whether dashpots contributed to the forces; a rate-independent run leaves them out.
    fn has_dashpots(&self) -> Result<bool, CliError> {
        if !self.recording.is_dir() {
            return Ok(true);
        }
        let (_, ran) = ran(&self.recording)?;
        Ok(!ran.options["rate_independent"].as_bool().unwrap_or(false))
    }

    /// The springs. Stiffnesses come from the options, else the calibration, else the scenario,
    /// else the paper.
    fn sensor(&self, scenario: Option<&Scenario>) -> Result<Sensor, CliError> {
        let rule = "must be what `cohaul calibrate fit --json` prints";
        let calibration: Option<Calibration> =
            self.springs.calibration.as_deref().map(|path| read_json(path, &formats::CALIBRATE_FIT, rule)).transpose()?;
        let mut sensor = match scenario {
            Some(scenario) if scenario.system.springs.is_empty() => {
                return Err(CliError::Usage("the scenario must have springs, found none".into()));
            }
            Some(scenario) => Sensor::exact(scenario.system.springs.clone()),
            None => Sensor::paper(),
        };
        if let Some(found) = &calibration {
            sensor = sensor.calibrated(found);
            // Without a scenario, only the calibration gives the rest length.
            if let (None, Some(model)) = (scenario, sensor.model) {
                sensor.springs.iter_mut().for_each(|spring| spring.rest_length = model.rest_length());
            }
        }
        Ok(Sensor {
            tip_error: self.springs.tip_noise_m,
            ..sensor.with_given(self.springs.radial_stiffness_n_per_m, self.springs.torsional_stiffness_nm_per_rad)
        })
    }
}

impl SensorInput {
    /// The options that were used, for a manifest.
    pub fn options(&self) -> Value {
        let first = self.sensor.spring(0);
        json!({
            "scenario": self.scenario.as_ref().map(Scenario::expanded),
            "calibration": self.calibration,
            "radial_stiffness_n_per_m": first.radial_stiffness,
            "torsional_stiffness_nm_per_rad": first.torsional_stiffness,
            "tip_noise_m": self.sensor.tip_error
        })
    }

    /// The manifest of a command that read the table.
    pub fn manifest(&self, command: &str, options: &Value, started: SystemTime) -> Manifest {
        measured_manifest(command, (&self.name, &self.table), options, started)
    }

    /// The larger relative standard error of the two stiffnesses (1).
    pub fn stiffness_error(&self) -> f64 {
        let (sensor, spring) = (&self.sensor, self.sensor.spring(0));
        let share = |error: f64, stiffness: f64| if stiffness > 0.0 { error / stiffness } else { 0.0 };
        share(sensor.radial_error, spring.radial_stiffness).max(share(sensor.torsional_error, spring.torsional_stiffness))
    }

    /// Where the forces on the tips should be read with care.
    pub fn warnings(&self, found: &[Force]) -> Vec<String> {
        let (sensor, mut warnings) = (&self.sensor, Vec::new());
        if let Some(length) = sensor.foreign_length() {
            warnings.push(format!("springs of {length} m rest length are read with the calibration of other springs"));
        }
        let n_beyond = sensor.n_beyond_fit(found);
        if n_beyond > 0 {
            let stretch = sensor.fitted_to.stretch.map(|stretch| quantity(stretch, "m"));
            let swing = sensor
                .fitted_to
                .swing
                .map(|[clockwise, counter]| format!("-{} to {}", quantity(clockwise, "rad"), quantity(counter, "rad")));
            let range = stretch.into_iter().chain(swing).collect::<Vec<_>>().join(" or ");
            let n = found.len();
            warnings.push(format!("{n_beyond} of {n} tips are beyond the range of the fit, {range}: the linear law is extrapolated"));
        }
        let n_near = sensor.n_near_root(found);
        if n_near > 0 {
            let place = "nearer to their root than a tenth of the rest length, where Eq. (10) diverges";
            warnings.push(format!("{n_near} tips are {place}; is the recording correct?"));
        }
        if self.has_dashpots && sensor.springs.iter().any(|spring| spring.damping_ratio > 0.0) {
            warnings
                .push("the forces of the springs' dashpots are missing: they depend on speeds, which tip positions do not give".to_owned());
        }
        warnings
    }
}

/// The table of tips in the folder of a run, or the file itself.
pub fn table_of(recording: &Path) -> Result<PathBuf, CliError> {
    let file = if recording.is_dir() { recording.join("tips.csv") } else { recording.to_owned() };
    if recording.is_dir() && !file.exists() {
        let rule = "must contain tips.csv, which `cohaul run --tips --out` writes";
        return Err(CliError::Usage(format!("{}: {rule}, found none", recording.display())));
    }
    Ok(file)
}

fn ran(folder: &Path) -> Result<(PathBuf, Ran), CliError> {
    let path = folder.join(MANIFEST);
    let ran = read_json(&path, &formats::MANIFEST, "must be the manifest of a run")?;
    Ok((path, ran))
}
