//! `cohaul calibrate grid`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::super::console::Tone;
use super::super::error::CliError;
use super::super::input::{name_of, read_text};
use super::super::output::{OutputArgs, measured_manifest};
use super::dimensions::DimensionArgs;
use cohaul_paper::calibrate::LoadCell;
use cohaul_paper::calibrate::files::write_grid;
use cohaul_paper::calibrate::text::grid_text;
use cohaul_report::json;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul calibrate grid data/load-cell.csv --out out/grid
  cohaul calibrate fit out/grid/measurements.csv

Columns of the table: trial, the tip from the root x_m along the undeformed
spring and y_m across it, and the force on the tip, force_x_n and force_y_n.
Files in DIR: lookup.csv (force against tip position), measurements.csv (for
calibrate fit), grid.json and manifest.json.")]
pub struct GridArgs {
    /// Readings of a load cell on a grid of tip positions (CSV); - for standard input
    readings: PathBuf,
    #[command(flatten)]
    dimensions: DimensionArgs,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn grid(args: &GridArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    let dimensions = args.dimensions.read()?;
    args.output.check()?;
    let (table, name) = (read_text(&args.readings)?, name_of(&args.readings));
    let readings = LoadCell::parse(&table, &name)?;
    let measurements = readings.measurements(&dimensions);
    let found = readings.report(&measurements);
    json::check(&found)?;
    if let Some(out) = &args.output.out {
        let options = json!({ "dimensions": dimensions });
        write_grid(out, &found, &readings, &measurements, &measured_manifest("calibrate grid", (&name, &table), &options, started))?;
    }
    args.output.print(&found, || grid_text(&found), Tone::Good)?;
    Ok(ExitCode::SUCCESS)
}
