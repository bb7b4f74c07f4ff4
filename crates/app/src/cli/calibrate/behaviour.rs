//! `cohaul calibrate behaviour`.

use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::super::choice::{choice_of, positive};
use super::super::console::{self, Tone};
use super::super::error::CliError;
use super::super::output::OutputArgs;
use super::sensor::{SensorArgs, SensorInput};
use cohaul::math::Vec2;
use cohaul::model::behaviour::ReleasePace;
use cohaul::scenario::Drive;
use cohaul_paper::calibrate::behaviour::{
    Attachment, BehaviourReport, aged_exposures, attachments, exposures, fit_holds, fit_steering, write_behaviour,
};
use cohaul_paper::calibrate::tip_forces;
use cohaul_report::json;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul run ants.json --tips --out out/run
  cohaul calibrate behaviour out/run --out out/behaviour
  cohaul calibrate behaviour camera.csv --scenario ants.json --tip-noise-m 1e-4

The table is that of `calibrate forces`, with a column event that says release
where a tip is let go. Without this column, a tip that is missing in the next
frame was released. Files in DIR: behaviour.json, behaviour.txt, releases.csv,
figure and manifest.")]
pub struct BehaviourArgs {
    #[command(flatten)]
    sensor: SensorArgs,
    /// Position of the nest (m) [default: that of the scenario]
    #[arg(long, num_args = 2, value_names = ["X", "Y"], allow_negative_numbers = true)]
    nest_m: Option<Vec<f64>>,
    /// When ants decide to release
    #[arg(long, default_value = "hazard", value_parser = choice_of::<ReleasePace>("pace"))]
    pace: ReleasePace,
    /// Time between two release decisions, in place of a fitted one; needed unless the pace is
    /// hazard (s)
    #[arg(long, value_name = "S", value_parser = positive)]
    decision_period_s: Option<f64>,
    #[command(flatten)]
    output: OutputArgs,
}

/// Confidence of the intervals.
const LEVEL: f64 = 0.95;

pub fn behaviour(args: &BehaviourArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    args.output.check()?;
    let input = args.sensor.read()?;
    let nest = nest(args, &input)?;
    let found = attachments(&input.recording, input.releases.as_deref(), &input.sensor);
    let exposures = match (args.pace, args.decision_period_s) {
        (ReleasePace::Hazard, _) => exposures(&found),
        (_, Some(period)) => aged_exposures(&found, period),
        (_, None) => return Err(CliError::Usage("--pace: must come with --decision-period-s unless it is hazard, found none".into())),
    };
    let total: f64 = found.iter().map(Attachment::duration).sum();
    let mut report = BehaviourReport {
        pace: args.pace,
        confidence: LEVEL,
        n_attachments: found.len(),
        n_releases: found.iter().filter(|own| own.release.is_some()).count(),
        mean_duration_s: if found.is_empty() { 0.0 } else { total / found.len() as f64 },
        release: fit_holds(&exposures, args.decision_period_s, LEVEL),
        steering: nest.and_then(|nest| fit_steering(&found, nest, input.sensor.tip_error, LEVEL)),
        tip_noise_m: input.sensor.tip_error,
        warnings: input.warnings(&tip_forces(&input.recording, &input.sensor)),
    };
    report.warn(pull_noise(&found), stiffness_error(&input));
    json::check(&report)?;
    if let Some(out) = &args.output.out {
        let options = json!({
            "sensor": input.options(),
            "nest_m": nest.map(|nest| [nest.x, nest.y]),
            "pace": args.pace,
            "decision_period_s": args.decision_period_s
        });
        write_behaviour(out, &report, &input.manifest("calibrate behaviour", &options, started))?;
    }
    args.output.print(&report, || report.text(), Tone::Good)?;
    console::warn_all(&report.warnings);
    Ok(ExitCode::SUCCESS)
}

/// The nest of the option, else that of the scenario's ants.
fn nest(args: &BehaviourArgs, input: &SensorInput) -> Result<Option<Vec2>, CliError> {
    match args.nest_m.as_deref() {
        Some([x, y]) if x.is_finite() && y.is_finite() => Ok(Some(Vec2::new(*x, *y))),
        Some(found) => Err(CliError::Usage(format!("--nest-m: must be two finite numbers, found {found:?}"))),
        None => Ok(input.scenario.as_ref().and_then(|scenario| match &scenario.drive {
            Drive::Ants(drive) => Some(drive.nest_position),
            _ => None,
        })),
    }
}

/// Root mean square of the noise of the pulls that comes from the tips (N).
fn pull_noise(found: &[Attachment]) -> f64 {
    let all = || found.iter().flat_map(|own| &own.held);
    let squares: f64 = all().map(|held| held.pull_sd * held.pull_sd).sum();
    (squares / all().count().max(1) as f64).sqrt()
}

/// The larger relative standard error of the two stiffnesses (1).
fn stiffness_error(input: &SensorInput) -> f64 {
    let (sensor, spring) = (&input.sensor, input.sensor.spring(0));
    let share = |error: f64, stiffness: f64| if stiffness > 0.0 { error / stiffness } else { 0.0 };
    share(sensor.radial_error, spring.radial_stiffness).max(share(sensor.torsional_error, spring.torsional_stiffness))
}
