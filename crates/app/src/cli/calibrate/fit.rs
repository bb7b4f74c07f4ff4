//! `cohaul calibrate fit`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::super::choice::not_negative;
use super::super::console::Tone;
use super::super::error::CliError;
use super::super::input::{name_of, read_text};
use super::super::output::{OutputArgs, measured_manifest};
use super::dimensions::DimensionArgs;
use cohaul_paper::calibrate::files::write_calibration;
use cohaul_paper::calibrate::text::fit_text;
use cohaul_paper::calibrate::{Measurements, Ranges, fit as fit_to};
use cohaul_report::json;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul calibrate fit data/spring-calibration.csv
  cohaul calibrate fit readings.csv --range-m 0 0.008 --out out/spring

Columns of the table: case (radial, tangential-2 or tangential-3), trial,
displacement_m (radial) or swing_rad (tangential), force_n and, where known,
force_sd_n. Files in DIR: calibration.json, residuals.csv, figure and manifest.")]
pub struct FitArgs {
    /// Table of measurements (CSV); - for standard input
    measurements: PathBuf,
    /// Stretches over which kappa_rho is fitted (m) [default: all]
    #[arg(long, num_args = 2, value_names = ["LOW", "HIGH"], value_parser = not_negative)]
    range_m: Option<Vec<f64>>,
    /// Swings, without sign, over which kappa_tau is fitted (rad) [default: all]
    #[arg(long, num_args = 2, value_names = ["LOW", "HIGH"], value_parser = not_negative)]
    range_rad: Option<Vec<f64>>,
    /// Confidence of the intervals
    #[arg(long, value_name = "SHARE", default_value = "0.95")]
    confidence: f64,
    #[command(flatten)]
    dimensions: DimensionArgs,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn fit(args: &FitArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    if !(args.confidence > 0.0 && args.confidence < 1.0) {
        return Err(CliError::Usage(format!("--confidence: must be between 0 and 1, found {}", args.confidence)));
    }
    let ranges = Ranges { stretch: range("--range-m", &args.range_m)?, swing: range("--range-rad", &args.range_rad)? };
    let dimensions = args.dimensions.read()?;
    args.output.check()?;
    let (table, name) = (read_text(&args.measurements)?, name_of(&args.measurements));
    let measurements = Measurements::parse(&table, &name, &dimensions)?;
    let found =
        fit_to(&measurements, &dimensions, &ranges, args.confidence).map_err(|error| CliError::Usage(format!("{name}: {error}")))?;
    json::check(&found)?;
    if let Some(out) = &args.output.out {
        let options =
            json!({ "dimensions": dimensions, "range_m": ranges.stretch, "range_rad": ranges.swing, "confidence": args.confidence });
        write_calibration(out, &found, &measurements, &measured_manifest("calibrate fit", (&name, &table), &options, started))?;
    }
    args.output.print(&found, || fit_text(&found), Tone::Good)?;
    Ok(ExitCode::SUCCESS)
}

fn range(name: &str, ends: &Option<Vec<f64>>) -> Result<Option<[f64; 2]>, CliError> {
    match ends.as_deref() {
        None => Ok(None),
        Some([low, high]) if low < high => Ok(Some([*low, *high])),
        Some(ends) => Err(CliError::Usage(format!("{name}: LOW must be below HIGH, found {ends:?}"))),
    }
}
