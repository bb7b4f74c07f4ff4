//! `cohaul colony`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::calibrate::{SensorArgs, SensorInput, SpringArgs};
use super::choice::{choice, choice_of, positive};
use super::console::{self, Tone};
use super::error::CliError;
use super::input::name_of;
use super::output::{OutputArgs, study_manifest};
use super::resumable;
use super::watch::{is_interrupted, watched};
use cohaul::backend::BackendKind;
use cohaul::model::behaviour::ReleasePace;
use cohaul::scenario::{Drive, Scenario, sha256_hex};
use cohaul_paper::calibrate::behaviour::{Asked, BehaviourReport, attachments};
use cohaul_paper::calibrate::{Force, tip_forces};
use cohaul_paper::colony::files::{SCENARIO, Shown, scenario_text, write_colony};
use cohaul_paper::colony::report::Parts;
use cohaul_paper::colony::{Colony, FittedKey, NotFitted, Plan, Recorded, colony_text, fitted_ants, nest_of, recorded, tasks};
use cohaul_report::json;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul colony data/colony-tips.csv --seeds 4 \\
      --like scenarios/paper/four-ants-four-springs.json
  cohaul colony camera.csv --like ants.json --tip-noise-m 1e-4 --out out/colony
  cohaul compare out/colony/scenario.json

The recording is that of `calibrate behaviour`. Files in DIR: report.html,
scenario.json with the fitted ants, colony.json, tables (CSV), figures (SVG, and
for print 88 and 180 mm wide) and manifest.json. The state of an interrupted
call is kept in DIR.journal.")]
pub struct ColonyArgs {
    /// Table of tip positions (CSV), - for standard input, or the output folder of a run
    recording: PathBuf,
    /// Scenario with the load, ground, springs, nest and number of the ants
    #[arg(long, value_name = "SCENARIO")]
    like: PathBuf,
    #[command(flatten)]
    springs: SpringArgs,
    /// When ants decide to release
    #[arg(long, default_value = "hazard", value_parser = choice_of::<ReleasePace>("pace"))]
    pace: ReleasePace,
    /// Time between two release decisions, in place of a fitted one (s)
    #[arg(long, value_name = "S", value_parser = positive)]
    decision_period_s: Option<f64>,
    /// Number of runs of the fitted ants; rapier gets a fifth
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(2..=100_000))]
    seeds: u64,
    /// First seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Only these backends; the recording is compared with the first one
    #[arg(long, num_args = 1.., value_parser = choice::<BackendKind>())]
    backend: Vec<BackendKind>,
    #[command(flatten)]
    output: OutputArgs,
}

/// Confidence of the intervals.
const LEVEL: f64 = 0.95;

/// A recording and the ants that were fitted to it.
struct Fitted {
    input: SensorInput,
    forces: Vec<Force>,
    recorded: Recorded,
    behaviour: BehaviourReport,
    keys: Vec<FittedKey>,
    n_ants: usize,
    /// What is run is what the file says.
    scenario: Scenario,
}

pub fn colony(args: &ColonyArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    args.output.check()?;
    let fitted = fit(args)?;
    let (recorded, scenario) = (&fitted.recorded, &fitted.scenario);
    let plan = plan(args, recorded);
    let hash = sha256_hex(fitted.input.table.as_bytes());
    let question = json!({ "name": "colony", "plan": plan, "scenario": scenario.expanded(), "recording_sha256": hash });
    let mut finished = resumable::run("colony", &question, &tasks(&plan, scenario), args.output.out.as_deref())?;
    let found = Colony::new(Parts {
        scenario: &fitted.input.scenario.as_ref().expect("a scenario is given").name,
        n_ants: fitted.n_ants,
        nest: nest_of(scenario),
        recorded,
        behaviour: fitted.behaviour,
        keys: fitted.keys,
        plan: &plan,
        runs: &std::mem::take(&mut finished.records),
        wall_s: finished.wall_s,
    });
    json::check(&found)?;
    if let Some(out) = &args.output.out {
        let Some((run, ..)) = plan.frames(scenario, plan.sets[0].0, args.seed, || !is_interrupted()) else {
            return Err(CliError::Interrupted);
        };
        let shown = Shown { recorded, forces: &fitted.forces, fitted: scenario, run: &run, run_period: plan.seen_period(scenario) };
        let sensor = fitted.input.options();
        let options = json!({ "sensor": sensor, "pace": args.pace, "decision_period_s": args.decision_period_s, "plan": plan });
        write_colony(out, &found, &shown, &study_manifest(&question, &options, started))?;
    }
    finished.remove_journal()?;
    let has_failed = found.backends.iter().any(|of| of.n_failed > 0);
    args.output.print(&found, || colony_text(&found), if has_failed { Tone::Bad } else { Tone::Good })?;
    console::warn_all(&found.warnings);
    args.output.print_report()?;
    Ok(if has_failed { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

/// Reads the recording and fits its ants.
fn fit(args: &ColonyArgs) -> Result<Fitted, CliError> {
    let sensor = SensorArgs { recording: args.recording.clone(), scenario: Some(args.like.clone()), springs: args.springs.clone() };
    let input = sensor.read()?;
    let like = input.scenario.as_ref().expect("a scenario is given");
    let fault = |file: &str, rule: &str| CliError::Usage(format!("{file}: {rule}"));
    let Drive::Ants(drive) = &like.drive else { return Err(fault(&name_of(&args.like), &NotFitted::NoAnts.to_string())) };
    let forces = tip_forces(&input.recording, &input.sensor);
    let Some(recorded) = recorded(&input.recording, &forces) else {
        return Err(fault(&input.name, "must have tips in world axes, in two frames or more, at most a million"));
    };
    let asked = Asked {
        pace: args.pace,
        decision_period: args.decision_period_s,
        nest: Some(drive.nest_position),
        tip_error: input.sensor.tip_error,
        stiffness_error: input.stiffness_error(),
        level: LEVEL,
    };
    let seen = attachments(&input.recording, input.releases.as_deref(), &input.sensor);
    let found = watched("colony: fit", |watch| {
        let done = |share: f64| {
            watch(share);
        };
        BehaviourReport::fitted(&seen, &asked, &done)
    });
    let Some(mut behaviour) = found else {
        return Err(fault("--pace", "must come with --decision-period-s unless it is hazard, found none"));
    };
    behaviour.warnings.splice(0..0, input.warnings(&forces));
    let start = recorded.rows[0].motion.pose;
    let (made, keys) =
        fitted_ants(like, &behaviour, &input.sensor, start).map_err(|rule| fault(&name_of(&args.like), &rule.to_string()))?;
    let scenario = Scenario::parse(&scenario_text(&made)?, SCENARIO)?;
    let n_ants = drive.n_ants;
    Ok(Fitted { input, forces, recorded, behaviour, keys, n_ants, scenario })
}

fn plan(args: &ColonyArgs, recorded: &Recorded) -> Plan {
    let asked: &[BackendKind] = if args.backend.is_empty() { &BackendKind::COMPARED } else { &args.backend };
    let n_seeds = |kind: BackendKind| if kind.is_exact() { args.seeds } else { args.seeds.div_ceil(5) };
    Plan {
        sets: asked.iter().map(|kind| (*kind, n_seeds(*kind) as usize)).collect(),
        first_seed: args.seed,
        duration_s: recorded.rows[recorded.rows.len() - 1].time - recorded.rows[0].time,
        frame_period_s: recorded.period,
    }
}
