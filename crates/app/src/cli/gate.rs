//! `cohaul gate`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Instant, SystemTime};

use clap::Args;
use serde_json::json;

use super::choice::{not_negative, seconds};
use super::console::{self, Tone, print};
use super::error::{CliError, at_output};
use super::input::{check_step, read_json, read_scenario, stem_of};
use super::output::{JunitArgs, OutputArgs, study_manifest};
use super::subject::SubjectArgs;
use super::watch::watched_to_end;
use cohaul::analysis::compare::EngineName;
use cohaul::formats::{GATE_RECORD, stamped};
use cohaul::scenario::Scenario;
use cohaul_report::json;
use cohaul_report::sibling::write_whole;
use cohaul_studies::gate::report::{Gate, gate_markdown, gate_suite, gate_text, write_gate};
use cohaul_studies::gate::{self, MARGIN, Record, file_name};
use cohaul_studies::subject::Meet;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul gate baselines --engine ./my_engine --record
  cohaul gate baselines --engine ./my_engine --markdown out/gate.md
  cohaul gate baselines scene.json --engine ./my_engine --record

The exit code is 1 if an error on any scene is worse than the stored one, or
if the engine fails. `--record` stores the errors of this build in place of
those of an earlier one, in DIR/ENGINE.json. --out writes summary.json, gate.md
and manifest.json to another folder.")]
pub struct GateArgs {
    /// Folder of stored errors, one file an engine
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Scenario files to record [default: ten scenes of the program]
    #[arg(value_name = "SCENARIO", requires = "record")]
    scenarios: Vec<PathBuf>,
    /// Store the errors of this build
    #[arg(long, conflicts_with_all = ["junit", "markdown", "margin", "out"])]
    record: bool,
    #[command(flatten)]
    subject: SubjectArgs,
    /// Longest step of the engine (s) [default: as stored; of each scene with --record]
    #[arg(long, value_name = "H", value_parser = seconds)]
    step_s: Option<f64>,
    /// Least change that counts, over the stored error (1) [default: 0.01]
    #[arg(long, value_name = "SHARE", value_parser = not_negative)]
    margin: Option<f64>,
    /// Write the result as Markdown too, for a pull request
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    junit: JunitArgs,
}

pub fn gate(args: &GateArgs) -> Result<ExitCode, CliError> {
    args.output.check()?;
    args.junit.check()?;
    if let Some(path) = args.markdown.as_deref().filter(|path| path.is_dir()) {
        return Err(CliError::Usage(format!("--markdown: must be a file, found the folder {}", path.display())));
    }
    let scenes = match args.scenarios.as_slice() {
        [] => gate::usual(),
        files => files.iter().map(|file| Ok((stem_of(file), read_scenario(file, None)?))).collect::<Result<Vec<_>, CliError>>()?,
    };
    if let Some(at) = (1..scenes.len()).find(|at| scenes[..*at].iter().any(|(name, _)| *name == scenes[*at].0)) {
        return Err(CliError::Usage(format!("SCENARIO: must have names of their own, found {} again", scenes[at].0)));
    }
    scenes.iter().try_for_each(|(_, scenario)| check_step(args.step_s, scenario))?;
    // The engine names itself on the first scene, and so says which file is its own.
    let step_s = args.step_s.unwrap_or(scenes[0].1.control_period);
    args.subject.with(&scenes[0].1, step_s, |engine, meet, _| match args.record {
        true => store(args, engine, meet, &scenes),
        false => compare(args, engine, meet),
    })
}

fn measured(engine: &EngineName, meet: &Meet, scenes: &[(String, Scenario)], step_s: Option<f64>) -> Result<Record, CliError> {
    let found = watched_to_end("gate", |watch| gate::record(engine, meet, scenes, step_s, watch))?;
    json::check(&found)?;
    Ok(found)
}

fn store(args: &GateArgs, engine: &EngineName, meet: &Meet, scenes: &[(String, Scenario)]) -> Result<ExitCode, CliError> {
    let path = args.folder.join(file_name(&engine.name));
    let found = measured(engine, meet, scenes, args.step_s)?;
    let failed = || found.scenes.iter().filter_map(|scene| Some((&scene.name, scene.failed.as_ref()?)));
    if failed().next().is_some() {
        failed().for_each(|(name, why)| console::error(format_args!("{name}: {why}")));
        console::error(format_args!("{}: not stored: the engine must not fail on a scene", path.display()));
        return Ok(ExitCode::from(1));
    }
    found.write(&path).map_err(at_output(&path))?;
    if args.output.json {
        print(&json::pretty(&stamped(&found))?)?;
        return Ok(ExitCode::SUCCESS);
    }
    let n_refused = found.scenes.iter().filter(|scene| scene.refused.is_some()).count();
    let refused = if n_refused > 0 { format!(", {n_refused} of them refused") } else { String::new() };
    print(&format!("{}: stored, {} on {} scenes{refused}\n", path.display(), found.engine.text(), found.scenes.len()))?;
    Ok(ExitCode::SUCCESS)
}

fn compare(args: &GateArgs, engine: &EngineName, meet: &Meet) -> Result<ExitCode, CliError> {
    let (started, clock) = (SystemTime::now(), Instant::now());
    let stored = stored(&args.folder, &engine.name)?;
    let scenes: Result<Vec<_>, String> = stored.scenes.iter().map(|scene| Ok((scene.name.clone(), scene.scenario()?))).collect();
    let scenes = scenes.map_err(CliError::Usage)?;
    scenes.iter().try_for_each(|(_, scenario)| check_step(args.step_s, scenario))?;
    let now = measured(engine, meet, &scenes, args.step_s.or(stored.step_s))?;
    let found = Gate::new(&stored, &now, args.margin.unwrap_or(MARGIN));
    json::check(&found)?;
    args.junit.write(|| gate_suite(&found, clock.elapsed().as_secs_f64()))?;
    if let Some(path) = &args.markdown {
        write_whole(path, |out| out.write_all(gate_markdown(&found).as_bytes())).map_err(at_output(path))?;
    }
    if let Some(out) = &args.output.out {
        let question = json!({ "name": "gate", "stored": found.stored, "scenes": stored.scenes });
        write_gate(out, &found, &study_manifest(&question, &json!({ "engine": found.now, "margin": found.margin }), started))?;
    }
    let passes = found.passes();
    args.output.print(&found, || gate_text(&found), if passes { Tone::Good } else { Tone::Bad })?;
    Ok(if passes { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The stored errors of an engine.
fn stored(folder: &Path, engine: &str) -> Result<Record, CliError> {
    let path = folder.join(file_name(engine));
    if !path.is_file() {
        return Err(CliError::Usage(format!(
            "{}: must hold stored errors of {engine}, found no file; --record stores them",
            path.display()
        )));
    }
    let record: Record = read_json(&path, &GATE_RECORD, "must be a file of `cohaul gate --record`")?;
    if record.engine.name != engine {
        let rule = "must be errors of the same engine";
        return Err(CliError::Usage(format!("{}: engine.name: {rule}, {engine}, found {}", path.display(), record.engine.name)));
    }
    Ok(record)
}
