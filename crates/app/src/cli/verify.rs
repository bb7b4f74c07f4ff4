//! `cohaul verify`.

use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::choice::{choice, did_you_mean, seconds};
use super::console::{Tone, detail, print};
use super::error::CliError;
use super::foreign::{met, method_of};
use super::output::{JunitArgs, OutputArgs, study_manifest};
use super::resumable;
use super::subject::timeout;
use cohaul::analysis::compare::EngineName;
use cohaul::backend::{BackendKind, BackendOptions};
use cohaul_studies::conformance::{STEP_S, first_scene};
use cohaul_studies::subject::{Meet, of_user, own};
use cohaul_studies::verify::report::{Verification, list_text, verify_suite, verify_text, write_verification};
use cohaul_studies::verify::{self, Case, Effort, Plan};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul verify --quick
  cohaul verify slide --backend rapier --verbose
  cohaul verify --quick --junit out/verify.xml
  cohaul verify --engine ./my_engine
  cohaul verify --list

Files in DIR: table of all cases (CSV), figure, summary and manifest. The
state of an interrupted run is kept in DIR.journal.")]
pub struct VerifyArgs {
    /// Cases or families of cases; without any, all
    #[arg(value_name = "CASE")]
    cases: Vec<String>,
    /// Only this backend
    #[arg(long, value_parser = choice::<BackendKind>())]
    backend: Option<BackendKind>,
    /// Only this engine, a program as a shell command, in the place of rapier
    ///
    /// It is asked at the same steps, and judged by the same bounds: those of a method of first
    /// order without any other error. `cohaul conformance` grades errors instead.
    #[arg(long, value_name = "CMD", conflicts_with = "backend")]
    engine: Option<String>,
    /// Longest time that a program may take to answer (s) [default: 60]
    #[arg(long, value_name = "S", value_parser = seconds, requires = "engine", hide_short_help = true)]
    engine_timeout_s: Option<f64>,
    /// Leave out the shortest step of each case and every second tolerance
    #[arg(long)]
    quick: bool,
    /// List the cases
    #[arg(long, conflicts_with_all = ["json", "out", "junit", "backend", "engine", "quick"])]
    list: bool,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    junit: JunitArgs,
}

pub fn verify(args: &VerifyArgs) -> Result<ExitCode, CliError> {
    let cases = chosen(&args.cases)?;
    if args.list {
        print(&list_text(&cases))?;
        return Ok(ExitCode::SUCCESS);
    }
    let Some(command) = &args.engine else { return verified(args, &cases, &own, None) };
    let options = BackendOptions::new(BackendKind::Rapier, STEP_S);
    met(std::slice::from_ref(command), timeout(args.engine_timeout_s), &first_scene(STEP_S), &options, |engines| {
        let engine = &engines[0];
        let cases = verify::put_to(method_of(engine.name())?, cases);
        verified(args, &cases, &of_user(engine), Some(engine.name()))
    })
}

fn verified(args: &VerifyArgs, cases: &[Case], meet: &Meet, engine: Option<&EngineName>) -> Result<ExitCode, CliError> {
    let wanted = |plan: &Plan| args.backend.is_none_or(|kind| kind == plan.method.kind);
    if !cases.iter().flat_map(|case| &case.plans).any(wanted) {
        let asked = args.backend.map_or("engines with inertia", BackendKind::name);
        return Err(CliError::Usage(format!("CASE: none of these cases has a known answer for {asked}")));
    }
    args.output.check()?;
    args.junit.check()?;
    let effort = Effort::of(args.quick);
    let started = SystemTime::now();
    let names: Vec<&str> = cases.iter().map(|case| case.name.as_str()).collect();
    let asked = json!({ "cases": names, "backend": args.backend, "engine": engine, "quick": args.quick });
    let finished = resumable::run("verify", &asked, &verify::tasks(cases, meet, wanted, effort), args.output.out.as_deref())?;
    let rows = finished.records.concat();
    let found = Verification { engine: engine.cloned(), ..Verification::new(cases, &rows, effort, finished.wall_s) };
    if let Some(out) = &args.output.out {
        let question = json!({ "name": "verify", "cases": found.cases });
        let options = json!({ "backend": args.backend, "engine": engine, "quick": args.quick });
        write_verification(out, &found, &study_manifest(&question, &options, started))?;
    }
    args.junit.write(|| verify_suite(&found))?;
    finished.remove_journal()?;
    let tone = if found.holds { Tone::Good } else { Tone::Bad };
    args.output.print(&found, || verify_text(&found, detail()), tone)?;
    Ok(if found.holds { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The cases of these names and families, or all.
fn chosen(names: &[String]) -> Result<Vec<Case>, CliError> {
    let all = verify::all();
    let is_named = |case: &Case, name: &String| case.name == *name || case.family.name() == name;
    if let Some(name) = names.iter().find(|name| !all.iter().any(|case| is_named(case, name))) {
        let known = all.iter().flat_map(|case| [case.family.name(), case.name.as_str()]);
        let rule = "must be a case or a family that `cohaul verify --list` names";
        return Err(CliError::Usage(format!("CASE: {rule}, found {name}{}", did_you_mean(name, known))));
    }
    Ok(all.into_iter().filter(|case| names.is_empty() || names.iter().any(|name| is_named(case, name))).collect())
}
