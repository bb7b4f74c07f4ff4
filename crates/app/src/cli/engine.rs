//! Options of the rapier backend, and options that a backend does not read.

use clap::Args;

use super::choice::choice;
use super::console;
use super::error::CliError;
use cohaul::backend::rapier::{EngineSettings, FrictionModel, Precision, SpringModel};
use cohaul::backend::{BackendKind, Integrator, RapierOptions, Setting};
use cohaul::scenario::{Drive, Scenario};

#[derive(Args)]
#[command(next_help_heading = "Options of rapier")]
pub struct EngineArgs {
    /// Friction model [default: aligned; box with the engine defaults]
    #[arg(long, value_name = "MODEL", value_parser = choice::<FrictionModel>(), hide_short_help = true)]
    friction: Option<FrictionModel>,
    /// Spring model [default: joint]
    #[arg(long, value_name = "MODEL", value_parser = choice::<SpringModel>(), hide_short_help = true)]
    springs: Option<SpringModel>,
    /// Floating-point width [default: f64]
    #[arg(long, value_name = "WIDTH", value_parser = choice::<Precision>(), hide_short_help = true)]
    precision: Option<Precision>,
    /// Solver iterations and substeps [default: recommended]
    #[arg(long, value_name = "SET", value_parser = choice::<EngineSettings>(), hide_short_help = true)]
    settings: Option<EngineSettings>,
}

impl EngineArgs {
    pub fn options(&self) -> RapierOptions {
        RapierOptions::asked(self.settings, self.friction, self.springs, self.precision)
    }

    /// All options, and whether they are given.
    pub fn given(&self) -> [(&'static str, bool); 4] {
        [
            ("--friction", self.friction.is_some()),
            ("--springs", self.springs.is_some()),
            ("--precision", self.precision.is_some()),
            ("--settings", self.settings.is_some()),
        ]
    }
}

/// Refuses a tolerance for a backend without error control.
///
/// # Errors
/// When one of the backends is such a one.
pub fn check_error_control(backends: &[BackendKind]) -> Result<(), CliError> {
    match backends.iter().find(|backend| !backend.is_exact()) {
        Some(stepped) => Err(CliError::Usage(format!("--tolerance: {}, found {}", stepped.tolerance_rule(), stepped.name()))),
        None => Ok(()),
    }
}

/// Warns of options for a backend that does not run.
pub fn warn_of_idle(backends: &[BackendKind], integrator: Option<Integrator>, engine: &EngineArgs) {
    let of_engine = engine.given().map(|(name, is_given)| (name, Setting::Engine, is_given));
    let options = std::iter::once(("--integrator", Setting::Integrator, integrator.is_some())).chain(of_engine);
    let is_idle = |setting: Setting| backends.iter().all(|backend| !backend.reads(setting));
    for (name, setting, _) in options.filter(|(_, setting, is_given)| *is_given && is_idle(*setting)) {
        warn_idle(name, &BackendKind::names_of(|kind| kind.reads(setting)), &names(backends));
    }
}

fn names(backends: &[BackendKind]) -> String {
    backends.iter().map(|backend| backend.name()).collect::<Vec<_>>().join(", ")
}

/// Warns of options of a sweep that its drive or backends do not have: only ants are random, and
/// some backends have no inertia, which an option `scales`.
pub fn warn_of_idle_points(scenario: &Scenario, backends: &[BackendKind], n_seeds: u64, scales: Option<&str>) {
    if n_seeds > 1 && matches!(scenario.drive, Drive::Tips(_)) {
        warn_idle("--seeds", "ants", "tips");
    }
    if let Some(option) = scales.filter(|_| !backends.iter().any(|backend| backend.has_inertia())) {
        warn_idle(option, &BackendKind::names_of(BackendKind::has_inertia), &names(backends));
    }
}

/// Warns of an option that applies to one thing only, where another was found.
pub fn warn_idle(option: &str, applies_to: &str, found: &str) {
    console::warn(format_args!("{option}: changes nothing; it applies to {applies_to} only, found {found}"));
}
