//! `cohaul calibrate fit`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::super::{CliError, check_out, print};
use super::{DimensionArgs, manifest, not_negative};
use crate::output::json;
use crate::studies::calibrate::report::write_calibration;
use crate::studies::calibrate::text::fit_text;
use crate::studies::calibrate::{Measurements, Ranges, fit as fit_to};

#[derive(Args)]
pub struct FitArgs {
    /// CSV of case (radial, tangential-2, tangential-3), trial, displacement_m (radial) or swing_rad (tangential), force_n and, where known, force_sd_n
    measurements: PathBuf,
    #[command(flatten)]
    dimensions: DimensionArgs,
    /// Stretches over which kappa_rho is fitted (m); without it all that were measured
    #[arg(long, num_args = 2, value_names = ["LOW", "HIGH"], value_parser = not_negative)]
    range_m: Option<Vec<f64>>,
    /// Sizes of the swing over which kappa_tau is fitted (rad); without it all that were measured
    #[arg(long, num_args = 2, value_names = ["LOW", "HIGH"], value_parser = not_negative)]
    range_rad: Option<Vec<f64>>,
    /// Confidence of the intervals
    #[arg(long, value_name = "SHARE", default_value = "0.95")]
    confidence: f64,
    /// Folder for summary, residuals, figure and manifest
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

pub fn fit(args: &FitArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    if !(args.confidence > 0.0 && args.confidence < 1.0) {
        return Err(CliError::Usage(format!("--confidence: must be between 0 and 1, found {}", args.confidence)));
    }
    let ranges = Ranges { stretch: range("--range-m", &args.range_m)?, swing: range("--range-rad", &args.range_rad)? };
    let dimensions = args.dimensions.read()?;
    if let Some(out) = &args.out {
        check_out(out)?;
    }
    let measurements = Measurements::read(&args.measurements, &dimensions)?;
    let found = fit_to(&measurements, &dimensions, &ranges, args.confidence)
        .map_err(|error| CliError::Usage(format!("{}: {error}", args.measurements.display())))?;
    let text = if args.json { json::pretty(&found)? } else { fit_text(&found) };
    if let Some(out) = &args.out {
        let options =
            json!({ "dimensions": dimensions, "range_m": ranges.stretch, "range_rad": ranges.swing, "confidence": args.confidence });
        write_calibration(out, &found, &measurements, &manifest("calibrate fit", Some(&args.measurements), options, started)?)?;
    }
    print(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn range(name: &str, ends: &Option<Vec<f64>>) -> Result<Option<[f64; 2]>, CliError> {
    match ends.as_deref() {
        None => Ok(None),
        Some([low, high]) if low < high => Ok(Some([*low, *high])),
        Some(ends) => Err(CliError::Usage(format!("{name}: must go up, found {ends:?}"))),
    }
}
