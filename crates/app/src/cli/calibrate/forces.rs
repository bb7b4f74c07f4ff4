//! `cohaul calibrate forces`.

use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;

use super::super::console::{self, Tone};
use super::super::error::CliError;
use super::super::output::OutputArgs;
use super::sensor::SensorArgs;
use cohaul_paper::calibrate::files::write_tip_forces;
use cohaul_paper::calibrate::text::forces_text;
use cohaul_paper::calibrate::{ForcesReport, summaries, tip_forces};
use cohaul_report::json;

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
    #[command(flatten)]
    sensor: SensorArgs,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn forces(args: &ForcesArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    args.output.check()?;
    let input = args.sensor.read()?;
    let (recording, sensor) = (&input.recording, &input.sensor);
    let found = tip_forces(recording, sensor);
    let report = ForcesReport {
        n_frames: recording.n_frames(),
        springs: summaries(&found, sensor),
        tip_noise_m: sensor.tip_error,
        warnings: input.warnings(&found),
    };
    json::check(&report)?;
    if let Some(out) = &args.output.out {
        write_tip_forces(out, &report, &found, &input.manifest("calibrate forces", &input.options(), started))?;
    }
    args.output.print(&report, || forces_text(&report), Tone::Good)?;
    console::warn_all(&report.warnings);
    Ok(ExitCode::SUCCESS)
}
