//! `cohaul conformance`.

use std::process::ExitCode;
use std::time::{Instant, SystemTime};

use clap::Args;
use serde_json::json;

use super::choice::seconds;
use super::console::{Tone, detail};
use super::error::CliError;
use super::output::{JunitArgs, OutputArgs, study_manifest};
use super::subject::SubjectArgs;
use super::watch::watched_to_end;
use cohaul_report::json;
use cohaul_studies::conformance::files::write_conformance;
use cohaul_studies::conformance::report::{Conformance, conformance_suite, conformance_text};
use cohaul_studies::conformance::{self, STEP_S, STEPS_S};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul conformance
  cohaul conformance --engine ./my_engine --out out/conformance
  cohaul conformance --engine rapier --friction box
  cohaul conformance --engine inertial --step-s 1e-4 --verbose

Files in DIR: report.html, conformance.md, summary.json, manifest.json. The
exit code is 1 if the engine fails in a test. A large error and a scene that
the engine refuses are results.")]
pub struct ConformanceArgs {
    #[command(flatten)]
    subject: SubjectArgs,
    /// Longest step of the engine (s) [default: 0.001]
    #[arg(long, value_name = "H", value_parser = seconds)]
    step_s: Option<f64>,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    junit: JunitArgs,
}

pub fn conformance(args: &ConformanceArgs) -> Result<ExitCode, CliError> {
    args.output.check()?;
    args.junit.check()?;
    let step_s = args.step_s.unwrap_or(STEP_S);
    if !STEPS_S.contains(&step_s) {
        return Err(CliError::Usage(format!("--step-s: must be from {:e} to {}, found {step_s}", STEPS_S.start(), STEPS_S.end())));
    }
    let (started, clock) = (SystemTime::now(), Instant::now());
    let tests = conformance::all();
    let found = args.subject.with(&conformance::first_scene(step_s), step_s, |engine, meet, has_inertia| {
        let tasks = conformance::tasks(&tests, meet, step_s, has_inertia);
        let answers = watched_to_end("conformance", |watch| tasks.finished(watch))?;
        Ok(Conformance::new(engine.clone(), step_s, &tests, answers))
    })?;
    json::check(&found)?;
    if let Some(out) = &args.output.out {
        let question = json!({ "name": "conformance", "tests": found.questions() });
        write_conformance(out, &found, &study_manifest(&question, &json!({ "engine": found.engine, "step_s": step_s }), started))?;
    }
    args.junit.write(|| conformance_suite(&found, clock.elapsed().as_secs_f64()))?;
    let tone = match () {
        () if !found.is_computed() => Tone::Bad,
        () if found.counts.beyond > 0 => Tone::Caution,
        () => Tone::Good,
    };
    args.output.print(&found, || conformance_text(&found, detail()), tone)?;
    args.output.print_report()?;
    Ok(if found.is_computed() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
