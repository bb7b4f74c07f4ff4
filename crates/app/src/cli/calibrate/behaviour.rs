//! `cohaul calibrate behaviour`.

use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::super::choice::{choice_of, positive};
use super::super::console::{self, Tone};
use super::super::error::CliError;
use super::super::output::OutputArgs;
use super::super::watch::Watch;
use super::sensor::{SensorArgs, SensorInput};
use cohaul::math::Vec2;
use cohaul::model::behaviour::ReleasePace;
use cohaul::scenario::Drive;
use cohaul_paper::calibrate::behaviour::{Asked, BehaviourReport, attachments, write_behaviour};
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
frame, or that has sprung back to its place at rest, was released. Files in DIR: behaviour.json, behaviour.txt, releases.csv,
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

/// Largest distance of a nest from the origin (m): ants of a camera's field drag no load farther.
const FARTHEST_NEST: f64 = 100.0;
/// Confidence of the intervals.
const LEVEL: f64 = 0.95;

pub fn behaviour(args: &BehaviourArgs, watch: Watch) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    args.output.check()?;
    let input = args.sensor.read()?;
    let nest = nest(args, &input)?;
    let found = attachments(&input.recording, input.releases.as_deref(), &input.sensor);
    let asked = Asked {
        pace: args.pace,
        decision_period: args.decision_period_s,
        nest,
        tip_error: input.sensor.tip_error,
        stiffness_error: input.stiffness_error(),
        level: LEVEL,
    };
    let done = |share: f64| {
        watch(share);
    };
    let Some(mut report) = BehaviourReport::fitted(&found, &asked, &done) else {
        return Err(CliError::Usage("--pace: must come with --decision-period-s unless it is hazard, found none".into()));
    };
    report.warnings.splice(0..0, input.warnings(&tip_forces(&input.recording, &input.sensor)));
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
        Some([x, y]) if x.hypot(*y) > FARTHEST_NEST => {
            let rule = format!("must be within {FARTHEST_NEST} m of the origin (is it in millimetres? divide by 1000)");
            Err(CliError::Usage(format!("--nest-m: {rule}, found {x} {y}")))
        }
        Some([x, y]) if x.is_finite() && y.is_finite() => Ok(Some(Vec2::new(*x, *y))),
        Some(found) => Err(CliError::Usage(format!("--nest-m: must be two finite numbers, found {found:?}"))),
        None => Ok(input.scenario.as_ref().and_then(|scenario| match &scenario.drive {
            Drive::Ants(drive) => Some(drive.nest_position),
            _ => None,
        })),
    }
}
