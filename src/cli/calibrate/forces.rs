//! `cohaul calibrate forces`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde::Deserialize;
use serde_json::{Value, json};

use super::super::{CliError, check_out, positive, print};
use super::{manifest, not_negative, read};
use crate::backend::BackendKind;
use crate::model::paper;
use crate::output::folder::MANIFEST;
use crate::output::json;
use crate::output::quantity::quantity;
use crate::scenario::Scenario;
use crate::studies::calibrate::report::{ForcesReport, write_tip_forces};
use crate::studies::calibrate::{Calibration, Recording, Sensor, TipForces, summaries, tip_forces};

#[derive(Args)]
pub struct ForcesArgs {
    /// CSV of time_s, spring and the tip: tip_in_root_x_m, tip_in_root_y_m, or x_m, y_m, heading_rad of the load with tip_x_m, tip_y_m. Or a folder that
    /// `cohaul run --tips --out` wrote
    recording: PathBuf,
    /// Scenario with the roots, bearings and stiffnesses of the springs: needed for tips in world axes
    #[arg(long, value_name = "FILE")]
    scenario: Option<PathBuf>,
    /// calibration.json that `cohaul calibrate fit` wrote, in place of the scenario's or the paper's stiffnesses
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// kappa_rho in place of all others (N/m)
    #[arg(long, value_name = "K", value_parser = positive)]
    radial_stiffness_n_per_m: Option<f64>,
    /// kappa_tau in place of all others (N m/rad)
    #[arg(long, value_name = "T", value_parser = positive)]
    torsional_stiffness_nm_per_rad: Option<f64>,
    /// Standard deviation of a tip from its root along either axis (m)
    #[arg(long, value_name = "M", default_value = "0", value_parser = not_negative)]
    tip_noise_m: f64,
    /// Folder for forces, figure, summary and manifest
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

/// What is read of a run's manifest.
#[derive(Deserialize)]
struct Ran {
    scenario: Value,
    options: Value,
}

pub fn forces(args: &ForcesArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    if let Some(out) = &args.out {
        check_out(out)?;
    }
    let file = if args.recording.is_dir() { args.recording.join("tips.csv") } else { args.recording.clone() };
    if args.recording.is_dir() && !file.exists() {
        let rule = "must hold tips.csv, which `cohaul run --tips --out` writes";
        return Err(CliError::Usage(format!("{}: {rule}, found none", args.recording.display())));
    }
    let scenario = scenario(args)?;
    let sensor = sensor(args, scenario.as_ref())?;
    let rest_length = sensor.springs.iter().map(|spring| spring.rest_length).fold(0.0, f64::max);
    // Isotropic springs have no length of their own.
    let rest_length = if rest_length > 0.0 { rest_length } else { paper::SPRING.rest_length() };
    let recording = Recording::read(&file, scenario.as_ref().map(|scenario| scenario.system.springs.len()), rest_length)?;
    if scenario.is_none() && recording.is_in_world() {
        let rule = "tips in world axes need the springs' roots: name them by --scenario";
        return Err(CliError::Usage(format!("{}: {rule}", file.display())));
    }
    let found = tip_forces(&recording, &sensor);
    let report = ForcesReport {
        n_frames: recording.n_frames(),
        springs: summaries(&found, &sensor),
        tip_noise_m: args.tip_noise_m,
        warnings: warnings(&sensor, &found, has_dashpots(args)?),
    };
    let json = json::pretty(&report)?;
    if let Some(out) = &args.out {
        let first = sensor.spring(0);
        let options = json!({
            "scenario": scenario.as_ref().map(Scenario::expanded),
            "calibration": args.calibration,
            "radial_stiffness_n_per_m": first.radial_stiffness,
            "torsional_stiffness_nm_per_rad": first.torsional_stiffness,
            "tip_noise_m": args.tip_noise_m
        });
        write_tip_forces(out, &report, &found, &manifest("calibrate forces", Some(&file), options, started)?)?;
    }
    print(&if args.json { json } else { report.to_text() })?;
    report.warnings.iter().for_each(|warning| say!("warning: {warning}"));
    Ok(ExitCode::SUCCESS)
}

/// Of the option, or of the run whose folder was recorded.
fn scenario(args: &ForcesArgs) -> Result<Option<Scenario>, CliError> {
    if let Some(path) = &args.scenario {
        return Ok(Some(Scenario::read(path)?));
    }
    if !args.recording.is_dir() {
        return Ok(None);
    }
    let (path, ran) = ran(&args.recording)?;
    Ok(Some(Scenario::parse(&ran.scenario.to_string(), &path.display().to_string())?))
}

fn ran(folder: &Path) -> Result<(PathBuf, Ran), CliError> {
    let path = folder.join(MANIFEST);
    let ran = parsed(&path, "must be the manifest of a run")?;
    Ok((path, ran))
}

/// Whether dashpots had a part in the pulls: a quasi-static run leaves them out.
fn has_dashpots(args: &ForcesArgs) -> Result<bool, CliError> {
    if !args.recording.is_dir() {
        return Ok(true);
    }
    let (_, ran) = ran(&args.recording)?;
    Ok(ran.options["kind"] != BackendKind::QuasiStatic.name())
}

fn parsed<T: for<'de> Deserialize<'de>>(path: &Path, rule: &str) -> Result<T, CliError> {
    serde_json::from_str(&read(path)?).map_err(|error| CliError::Usage(format!("{}: {rule}: {error}", path.display())))
}

/// Springs with the stiffnesses that count: options, then the calibration, then the scenario, then the paper.
fn sensor(args: &ForcesArgs, scenario: Option<&Scenario>) -> Result<Sensor, CliError> {
    let rule = "must be what `cohaul calibrate fit --json` prints";
    let calibration: Option<Calibration> = args.calibration.as_deref().map(|path| parsed(path, rule)).transpose()?;
    let mut sensor = match scenario {
        Some(scenario) if scenario.system.springs.is_empty() => {
            return Err(CliError::Usage("the scenario must have springs, found none".into()));
        }
        Some(scenario) => Sensor::exact(scenario.system.springs.clone()),
        None => Sensor::paper(),
    };
    if let Some(found) = &calibration {
        sensor = sensor.calibrated(found);
        // Without a scenario the calibration is all that is known of the spring.
        if let (None, Some(model)) = (scenario, sensor.model) {
            sensor.springs.iter_mut().for_each(|spring| spring.rest_length = model.rest_length());
        }
    }
    Ok(Sensor { tip_error: args.tip_noise_m, ..sensor.with_given(args.radial_stiffness_n_per_m, args.torsional_stiffness_nm_per_rad) })
}

/// `has_dashpots` says whether those of the springs pulled while tips were recorded.
fn warnings(sensor: &Sensor, found: &TipForces, has_dashpots: bool) -> Vec<String> {
    let foreign = |length: f64| format!("springs {length} m long are read with the calibration of others");
    let n = found.n_near_root(sensor);
    let near =
        || format!("tips within a tenth of the rest length of their root, where Eq. (10) grows without limit: {n}; were they seen there?");
    let n_beyond = found.n_beyond_fit(sensor);
    let beyond = || {
        let stretch = sensor.fitted_to.stretch.map(|stretch| quantity(stretch, "m"));
        let swing =
            sensor.fitted_to.swing.map(|[clockwise, counter]| format!("-{} to {}", quantity(clockwise, "rad"), quantity(counter, "rad")));
        let far = stretch.into_iter().chain(swing).collect::<Vec<_>>().join(" or ");
        format!(
            "tips farther than the calibration was fitted to, {far}: {n_beyond} of {}; their forces are the linear law carried on",
            found.forces.len()
        )
    };
    let has_dashpots = has_dashpots && sensor.springs.iter().any(|spring| spring.damping_ratio > 0.0);
    let dashpots = || "the springs' dashpots pull too, by speeds that tips alone do not tell: forces are those of the springs".to_owned();
    let foreign = sensor.foreign_length().map(foreign);
    foreign.into_iter().chain((n_beyond > 0).then(beyond)).chain((n > 0).then(near)).chain(has_dashpots.then(dashpots)).collect()
}
