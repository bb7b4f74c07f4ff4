//! `cohaul calibrate forces`.

use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;

use super::super::console::{self, Tone};
use super::super::error::CliError;
use super::super::output::OutputArgs;
use super::sensor::SensorArgs;
use cohaul::math::Vec2;
use cohaul::scenario::{Drive, Scenario};
use cohaul_paper::calibrate::files::write_tip_forces;
use cohaul_paper::calibrate::text::forces_text;
use cohaul_paper::calibrate::{ForcesReport, summaries, tip_forces};
use cohaul_paper::colony::recorded;
use cohaul_paper::paper::Transport;
use cohaul_report::json;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul run ants.json --tips --out out/run
  cohaul calibrate forces out/run --calibration out/spring/calibration.json
  cohaul calibrate forces camera.csv --scenario ants.json --tip-noise-m 1e-4

Columns of the table: time_s, spring and the tip, either tip_in_root_x_m and
tip_in_root_y_m, or x_m, y_m, heading_rad of the load with tip_x_m and tip_y_m.
Files in DIR: forces.csv, series.csv, figure, summary and manifest.")]
pub struct ForcesArgs {
    #[command(flatten)]
    sensor: SensorArgs,
    /// Place of the nest, 60 mm before which the test for a phase change ends [default: that of
    /// the scenario's ants]
    #[arg(long, value_names = ["X", "Y"], num_args = 2, allow_negative_numbers = true, value_parser = coordinate)]
    nest_m: Option<Vec<f64>>,
    #[command(flatten)]
    output: OutputArgs,
}

fn coordinate(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("must be a number, found {text}"))?;
    if value.abs() <= 1e6 { Ok(value) } else { Err(format!("must be from -1e6 to 1e6, found {text}")) }
}

impl ForcesArgs {
    fn nest(&self, scenario: Option<&Scenario>) -> Option<Vec2> {
        let given = self.nest_m.as_deref().map(|at| Vec2::new(at[0], at[1]));
        given.or_else(|| match &scenario?.drive {
            Drive::Ants(ants) => Some(ants.nest_position),
            Drive::Tips(_) => None,
        })
    }
}

pub fn forces(args: &ForcesArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    args.output.check()?;
    let input = args.sensor.read()?;
    let (recording, sensor) = (&input.recording, &input.sensor);
    let found = tip_forces(recording, sensor);
    let transport = recorded(recording, &found)
        .and_then(|recorded| Transport::of(&recorded.rows, recorded.period, args.nest(input.scenario.as_ref()), 1));
    let report = ForcesReport {
        n_frames: recording.n_frames(),
        springs: summaries(&found, sensor),
        tip_noise_m: sensor.tip_error,
        transport,
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
