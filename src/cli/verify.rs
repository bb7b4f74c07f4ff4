//! `cohaul verify`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::{CliError, check_out, command_line, print, resumable};
use crate::backend::BackendKind;
use crate::output::json;
use crate::output::manifest::{Manifest, sha256_hex};
use crate::studies::verify::report::{Verification, list_text, verify_text, write_verification};
use crate::studies::verify::{self, Case, Effort, Plan};

#[derive(Args)]
pub struct VerifyArgs {
    /// Cases or families of them; without any, all
    #[arg(value_name = "CASE")]
    cases: Vec<String>,
    /// Only this backend
    #[arg(long, value_name = "BACKEND")]
    backend: Option<BackendKind>,
    /// Leave out the shortest step of each case and every second tolerance
    #[arg(long)]
    quick: bool,
    /// Say which cases there are
    #[arg(long, conflicts_with_all = ["json", "out", "backend", "quick"])]
    list: bool,
    /// Folder for table, figure, summary and manifest; what an interrupted run has done is kept beside it, as DIR.journal
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

pub fn verify(args: &VerifyArgs) -> Result<ExitCode, CliError> {
    let cases = chosen(&args.cases)?;
    if args.list {
        print(&list_text(&cases))?;
        return Ok(ExitCode::SUCCESS);
    }
    if let Some(out) = &args.out {
        check_out(out)?;
    }
    let effort = if args.quick { Effort::Quick } else { Effort::Full };
    let wanted = |plan: &Plan| args.backend.is_none_or(|kind| kind == plan.method.kind);
    if let Some(kind) = args.backend.filter(|_| !cases.iter().flat_map(|case| &case.plans).any(wanted)) {
        return Err(CliError::Usage(format!("--backend: none of these cases has a known answer for {}", kind.name())));
    }
    let started = SystemTime::now();
    let names: Vec<&str> = cases.iter().map(|case| case.name.as_str()).collect();
    let asked = json!({ "cases": names, "backend": args.backend, "quick": args.quick });
    let finished = resumable::run("verify", &asked, &verify::tasks(&cases, wanted, effort), args.out.as_deref())?;
    let rows = finished.records.concat();
    let found = Verification::new(&cases, &rows, effort, finished.wall_s);
    if let Some(out) = &args.out {
        write_verification(out, &found, &rows, &manifest(args, &found, started))?;
    }
    finished.remove_journal()?;
    print(&if args.json { json::pretty(&found)? } else { verify_text(&found) })?;
    Ok(if found.holds { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The cases of these names and families, or all.
fn chosen(names: &[String]) -> Result<Vec<Case>, CliError> {
    let all = verify::all();
    let is_named = |case: &Case, name: &String| case.name == *name || case.family.name() == name;
    if let Some(name) = names.iter().find(|name| !all.iter().any(|case| is_named(case, name))) {
        return Err(CliError::Usage(format!("CASE: must be a case or a family that `cohaul verify --list` names, found {name}")));
    }
    Ok(all.into_iter().filter(|case| names.is_empty() || names.iter().any(|name| is_named(case, name))).collect())
}

/// In place of a scenario stand the questions asked.
fn manifest(args: &VerifyArgs, found: &Verification, started: SystemTime) -> Manifest {
    let asked = json!({ "name": "verify", "cases": found.cases });
    let options = json!({ "backend": args.backend, "quick": args.quick });
    let hash = sha256_hex(asked.to_string().as_bytes());
    Manifest::new(&asked, hash, 0, &options, command_line(), started)
}
