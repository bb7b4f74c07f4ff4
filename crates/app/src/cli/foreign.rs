//! Programs of the user as the engines under the verdict.

use std::time::Duration;

use clap::Args;

use super::choice::{parse, seconds};
use super::error::CliError;
use super::subject::timeout;
use cohaul::analysis::compare::{EngineName, Settings};
use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::scenario::Scenario;
use cohaul_engines::{Channel, Engine, Pipe};
use cohaul_report::manifest::Libraries;
use cohaul_studies::methods::Method;

#[derive(Args)]
pub struct ForeignArgs {
    /// Program that is compared in the place of rapier, as a shell command; may be repeated
    ///
    /// It answers one line of JSON a request on its standard input and output; the book's page on
    /// engines has the protocol. Paths are compared, but no closed loop. The word rapier stands for
    /// rapier itself. Several engines are compared side by side, with the same exact paths.
    #[arg(long, value_name = "CMD")]
    engine: Vec<String>,
    /// Longest time that the program may take to answer (s) [default: 60]
    #[arg(long, value_name = "S", value_parser = seconds, requires = "engine", hide_short_help = true)]
    engine_timeout_s: Option<f64>,
}

/// Engine that needs no program.
const RAPIER: &str = "rapier";

impl ForeignArgs {
    /// Whether there is an engine, or several, beside rapier.
    pub fn is_given(&self) -> bool {
        self.engine.iter().any(|command| command != RAPIER)
    }

    /// Whether rapier is compared.
    pub fn has_rapier(&self) -> bool {
        self.engine.is_empty() || self.engine.iter().any(|command| command == RAPIER)
    }

    /// Runs `work` with the engines, as [`met`]: with rapier if none is given.
    ///
    /// # Errors
    /// When something is wrong with an engine, before the work or in it.
    pub fn with<T>(
        &self,
        scenario: &Scenario,
        settings: &Settings,
        work: impl FnOnce(&[Engine]) -> Result<T, CliError>,
    ) -> Result<T, CliError> {
        let commands = if self.engine.is_empty() { &[RAPIER.to_owned()][..] } else { &self.engine };
        let options = settings.at_fixed_step(scenario, BackendKind::Rapier);
        met(commands, timeout(self.engine_timeout_s), scenario, &options, work)
    }
}

/// Runs `work` with the engines of these commands, which have named themselves on a scenario.
///
/// # Errors
/// When something is wrong with an engine, before the work or in it.
pub fn met<T>(
    commands: &[String],
    timeout: Duration,
    scenario: &Scenario,
    options: &BackendOptions,
    work: impl FnOnce(&[Engine]) -> Result<T, CliError>,
) -> Result<T, CliError> {
    let wrong = |what: String| CliError::Engine(format!("--engine: {what}"));
    let open = |command: &str| Ok(Box::new(Pipe::start(command, timeout)?) as Box<dyn Channel>);
    if commands.iter().any(|command| command.trim().is_empty()) {
        return Err(CliError::Usage("--engine: must be a command, found nothing".into()));
    }
    if let Some(backend) = commands.iter().find(|command| *command != RAPIER && parse::<BackendKind>(command).is_some()) {
        return Err(CliError::Usage(format!("--engine: must be a program, found the backend {backend}")));
    }
    let opens: Vec<_> = commands.iter().map(|command| move || open(command)).collect();
    let meet = |(command, open): (&String, _)| match command.as_str() {
        RAPIER => Ok(Engine::rapier(Libraries::USED.rapier2d)),
        _ => Engine::meet(open, scenario, options).map_err(wrong),
    };
    let engines = commands.iter().zip(&opens).map(|(command, open)| meet((command, open))).collect::<Result<Vec<_>, _>>()?;
    Engine::check_names(&engines).map_err(|what| CliError::Usage(format!("--engine: {what}")))?;
    let done = work(&engines);
    match engines.iter().find_map(Engine::complaint) {
        Some(what) => Err(wrong(what)),
        None => done,
    }
}

/// The method of a study that an engine is.
///
/// # Errors
/// When it has the name of another one.
pub fn method_of(engine: &EngineName) -> Result<Method, CliError> {
    Method::of_user(&engine.name).map_err(|what| CliError::Usage(format!("--engine: {what}")))
}
