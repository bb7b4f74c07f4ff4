//! A program of the user as the engine under the verdict.

use std::time::Duration;

use clap::Args;

use super::choice::seconds;
use super::error::CliError;
use cohaul::analysis::compare::Settings;
use cohaul::backend::BackendKind;
use cohaul::scenario::Scenario;
use cohaul_engines::engine::Open;
use cohaul_engines::{Channel, Engine, Pipe};

#[derive(Args)]
pub struct ForeignArgs {
    /// Program that is compared in the place of rapier, as a shell command
    ///
    /// It answers one line of JSON a request on its standard input and output; the book's page on
    /// engines has the protocol. Paths are compared, but no closed loop.
    #[arg(long, value_name = "CMD")]
    engine: Option<String>,
    /// Longest time that the program may take to answer (s) [default: 60]
    #[arg(long, value_name = "S", value_parser = seconds, requires = "engine", hide_short_help = true)]
    engine_timeout_s: Option<f64>,
}

const TIMEOUT_S: f64 = 60.0;
/// Longest time that can be waited for (s): a year.
const LONGEST_S: f64 = 3.2e7;

impl ForeignArgs {
    pub fn is_given(&self) -> bool {
        self.engine.is_some()
    }

    /// Runs `work` with the engine, if there is one, which has named itself on this scenario.
    ///
    /// # Errors
    /// When something is wrong with the engine, before the work or in it.
    pub fn with<T>(
        &self,
        scenario: &Scenario,
        settings: &Settings,
        work: impl FnOnce(Option<&Engine>) -> Result<T, CliError>,
    ) -> Result<T, CliError> {
        let Some(command) = &self.engine else { return work(None) };
        let timeout = Duration::from_secs_f64(self.engine_timeout_s.unwrap_or(TIMEOUT_S).min(LONGEST_S));
        let open = || Ok(Box::new(Pipe::start(command, timeout)?) as Box<dyn Channel>);
        let open: &Open = &open;
        let options = settings.at_fixed_step(scenario, BackendKind::Rapier);
        let engine = Engine::meet(open, scenario, &options).map_err(|what| CliError::Engine(format!("--engine: {what}")))?;
        let done = work(Some(&engine));
        match engine.complaint() {
            Some(what) => Err(CliError::Engine(format!("--engine: {what}"))),
            None => done,
        }
    }
}
