//! The engine that a command is about: one of the program's own, or a program of the user.

use std::time::Duration;

use clap::Args;

use super::choice::{parse, seconds};
use super::engine::EngineArgs;
use super::error::CliError;
use cohaul::analysis::compare::EngineName;
use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::scenario::Scenario;
use cohaul_engines::engine::Open;
use cohaul_engines::{Channel, Engine, Pipe};
use cohaul_report::manifest::Libraries;
use cohaul_studies::subject::{Meet, built_in, of_user};

#[derive(Args)]
pub struct SubjectArgs {
    /// Engine: rapier, inertial, quasi-static, or a program as a shell command
    ///
    /// A program answers one line of JSON a request on its standard input and output; the book's
    /// page on engines has the protocol.
    #[arg(long, value_name = "CMD", default_value = "rapier")]
    engine: String,
    /// Longest time that a program may take to answer (s) [default: 60]
    #[arg(long, value_name = "S", value_parser = seconds, hide_short_help = true)]
    engine_timeout_s: Option<f64>,
    #[command(flatten)]
    rapier: EngineArgs,
}

/// Longest time that can be waited for (s): a year.
const LONGEST_S: f64 = 3.2e7;

/// Time that is waited for an answer.
pub fn timeout(asked_s: Option<f64>) -> Duration {
    asked_s.map_or(Pipe::PATIENCE, |asked| Duration::from_secs_f64(asked.min(LONGEST_S)))
}

impl SubjectArgs {
    /// Runs `work` with the engine, its name, and whether it has inertia. A program has named
    /// itself on this scenario, which it need not take.
    ///
    /// # Errors
    /// When a program does not start, or when options of rapier are given for another engine.
    pub fn with<T>(
        &self,
        scenario: &Scenario,
        step_s: f64,
        work: impl FnOnce(&EngineName, &Meet, bool) -> Result<T, CliError>,
    ) -> Result<T, CliError> {
        let kind = parse::<BackendKind>(&self.engine);
        if let Some((option, _)) = self.rapier.given().into_iter().find(|(_, is_given)| *is_given && kind != Some(BackendKind::Rapier)) {
            return Err(CliError::Usage(format!("{option}: applies to --engine rapier, found {}", self.engine)));
        }
        if let Some(kind) = kind {
            if self.engine_timeout_s.is_some() {
                return Err(CliError::Usage(format!("--engine-timeout-s: applies to programs, found --engine {}", self.engine)));
            }
            return work(&Libraries::engine(kind), &built_in(kind, self.rapier.options()), kind.has_inertia());
        }
        let timeout = timeout(self.engine_timeout_s);
        let open = || Ok(Box::new(Pipe::start(&self.engine, timeout)?) as Box<dyn Channel>);
        let open: &Open = &open;
        let options = BackendOptions::new(BackendKind::Rapier, step_s);
        let met = Engine::meet(open, scenario, &options).map_err(|what| CliError::Engine(format!("--engine: {what}")))?;
        work(met.name(), &of_user(&met), true)
    }
}
