//! `cohaul calibrate forces`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde::Deserialize;
use serde_json::{Value, json};

use super::super::choice::{not_negative, positive};
use super::super::console::{self, Tone};
use super::super::error::CliError;
use super::super::input::{name_of, read_json, read_scenario, read_text};
use super::super::output::{OutputArgs, measured_manifest};
use crate::backend::BackendKind;
use crate::model::paper;
use crate::output::folder::MANIFEST;
use crate::output::json;
use crate::output::quantity::quantity;
use crate::scenario::Scenario;
use crate::studies::calibrate::files::write_tip_forces;
use crate::studies::calibrate::report::ForcesReport;
use crate::studies::calibrate::text::forces_text;
use crate::studies::calibrate::{Calibration, Recording, Sensor, TipForces, summaries, tip_forces};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul run ants.json --tips --out out/run
  cohaul calibrate forces out/run --calibration out/spring/calibration.json
  cohaul calibrate forces camera.csv --scenario ants.json --tip-noise-m 1e-4

Columns of the table: time_s, spring and the tip, either tip_in_root_x_m and
tip_in_root_y_m, or x_m, y_m, heading_rad of the load with tip_x_m and tip_y_m.
Files in DIR: forces.csv, figure, summary and manifest.")]
pub struct ForcesArgs {
    /// Table of tip positions (CSV), - for standard input, or the output folder of a run
    recording: PathBuf,
    /// Scenario of the springs; needed for tips in world axes
    #[arg(long, value_name = "FILE")]
    scenario: Option<PathBuf>,
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
    #[command(flatten)]
    output: OutputArgs,
}

/// The parts of a run's manifest that are needed here.
#[derive(Deserialize)]
struct Ran {
    scenario: Value,
    options: Value,
}

pub fn forces(args: &ForcesArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    args.output.check()?;
    let file = table_of(&args.recording)?;
    let scenario = scenario(args)?;
    let sensor = sensor(args, scenario.as_ref())?;
    let rest_length = sensor.springs.iter().map(|spring| spring.rest_length).fold(0.0, f64::max);
    // Isotropic springs have no rest length.
    let rest_length = if rest_length > 0.0 { rest_length } else { paper::SPRING.rest_length() };
    let (table, name) = (read_text(&file)?, name_of(&file));
    let recording = Recording::parse(&table, &name, scenario.as_ref().map(|scenario| scenario.system.springs.len()), rest_length)?;
    if scenario.is_none() && recording.is_in_world() {
        let rule = "tips in world axes need --scenario, which has the roots of the springs";
        return Err(CliError::Usage(format!("{name}: {rule}")));
    }
    let found = tip_forces(&recording, &sensor);
    let report = ForcesReport {
        n_frames: recording.n_frames(),
        springs: summaries(&found, &sensor),
        tip_noise_m: args.tip_noise_m,
        warnings: warnings(&sensor, &found, has_dashpots(args)?),
    };
    json::check(&report)?;
    if let Some(out) = &args.output.out {
        let first = sensor.spring(0);
        let options = json!({
            "scenario": scenario.as_ref().map(Scenario::expanded),
            "calibration": args.calibration,
            "radial_stiffness_n_per_m": first.radial_stiffness,
            "torsional_stiffness_nm_per_rad": first.torsional_stiffness,
            "tip_noise_m": args.tip_noise_m
        });
        write_tip_forces(out, &report, &found, &measured_manifest("calibrate forces", (&name, &table), &options, started))?;
    }
    args.output.print(&report, || forces_text(&report), Tone::Good)?;
    console::warn_all(&report.warnings);
    Ok(ExitCode::SUCCESS)
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

/// The scenario of the option, or of the run in the folder.
fn scenario(args: &ForcesArgs) -> Result<Option<Scenario>, CliError> {
    if let Some(path) = &args.scenario {
        return read_scenario(path, None).map(Some);
    }
    if !args.recording.is_dir() {
        return Ok(None);
    }
    let (path, ran) = ran(&args.recording)?;
    Ok(Some(Scenario::parse(&ran.scenario.to_string(), &path.display().to_string())?))
}

fn ran(folder: &Path) -> Result<(PathBuf, Ran), CliError> {
    let path = folder.join(MANIFEST);
    let ran = read_json(&path, "must be the manifest of a run")?;
    Ok((path, ran))
}

/// Whether dashpots contributed to the forces; a quasi-static run leaves them out.
fn has_dashpots(args: &ForcesArgs) -> Result<bool, CliError> {
    if !args.recording.is_dir() {
        return Ok(true);
    }
    let (_, ran) = ran(&args.recording)?;
    Ok(ran.options["kind"] != BackendKind::QuasiStatic.name())
}

/// The springs. Stiffnesses come from the options, else the calibration, else the scenario, else
/// the paper.
fn sensor(args: &ForcesArgs, scenario: Option<&Scenario>) -> Result<Sensor, CliError> {
    let rule = "must be what `cohaul calibrate fit --json` prints";
    let calibration: Option<Calibration> = args.calibration.as_deref().map(|path| read_json(path, rule)).transpose()?;
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
    Ok(Sensor { tip_error: args.tip_noise_m, ..sensor.with_given(args.radial_stiffness_n_per_m, args.torsional_stiffness_nm_per_rad) })
}

/// `has_dashpots` says whether the springs had dashpots while the tips were recorded.
fn warnings(sensor: &Sensor, found: &TipForces, has_dashpots: bool) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(length) = sensor.foreign_length() {
        warnings.push(format!("springs of {length} m rest length are read with the calibration of other springs"));
    }
    let n_beyond = found.n_beyond_fit(sensor);
    if n_beyond > 0 {
        let stretch = sensor.fitted_to.stretch.map(|stretch| quantity(stretch, "m"));
        let swing =
            sensor.fitted_to.swing.map(|[clockwise, counter]| format!("-{} to {}", quantity(clockwise, "rad"), quantity(counter, "rad")));
        let range = stretch.into_iter().chain(swing).collect::<Vec<_>>().join(" or ");
        let n = found.forces.len();
        warnings.push(format!("{n_beyond} of {n} tips are beyond the range of the fit, {range}: the linear law is extrapolated"));
    }
    let n_near = found.n_near_root(sensor);
    if n_near > 0 {
        let place = "nearer to their root than a tenth of the rest length, where Eq. (10) diverges";
        warnings.push(format!("{n_near} tips are {place}; is the recording correct?"));
    }
    if has_dashpots && sensor.springs.iter().any(|spring| spring.damping_ratio > 0.0) {
        warnings.push("the forces of the springs' dashpots are missing: they depend on speeds, which tip positions do not give".to_owned());
    }
    warnings
}
