//! Options of the rapier backend, and warnings of options that change nothing.

use clap::Args;

use super::choice::choice;
use super::console;
use crate::backend::rapier::{EngineSettings, FrictionModel, Precision, SpringModel};
use crate::backend::{BackendKind, Integrator, RapierOptions};
use crate::scenario::{Drive, Scenario};

#[derive(Args)]
#[command(next_help_heading = "Options of rapier")]
pub struct EngineArgs {
    /// Friction model [default: aligned; box with the engine defaults]
    #[arg(long, value_name = "MODEL", value_parser = choice::<FrictionModel>())]
    friction: Option<FrictionModel>,
    /// Spring model [default: joint]
    #[arg(long, value_name = "MODEL", value_parser = choice::<SpringModel>())]
    springs: Option<SpringModel>,
    /// Floating-point width [default: f64]
    #[arg(long, value_name = "WIDTH", value_parser = choice::<Precision>())]
    precision: Option<Precision>,
    /// Solver iterations and substeps [default: recommended]
    #[arg(long, value_name = "SET", value_parser = choice::<EngineSettings>())]
    settings: Option<EngineSettings>,
}

impl EngineArgs {
    pub fn options(&self) -> RapierOptions {
        let usual = match self.settings {
            None | Some(EngineSettings::Recommended) => RapierOptions::default(),
            Some(EngineSettings::EngineDefaults) => RapierOptions::engine_defaults(),
        };
        RapierOptions {
            friction: self.friction.unwrap_or(usual.friction),
            springs: self.springs.unwrap_or(usual.springs),
            precision: self.precision.unwrap_or(usual.precision),
            ..usual
        }
    }
}

/// Warns of options for a backend that does not run.
pub fn warn_of_idle(backends: &[BackendKind], integrator: Option<Integrator>, engine: &EngineArgs) {
    let options = [
        ("--integrator", BackendKind::Inertial, integrator.is_some()),
        ("--friction", BackendKind::Rapier, engine.friction.is_some()),
        ("--springs", BackendKind::Rapier, engine.springs.is_some()),
        ("--precision", BackendKind::Rapier, engine.precision.is_some()),
        ("--settings", BackendKind::Rapier, engine.settings.is_some()),
    ];
    for (name, of, _) in options.iter().filter(|(_, of, is_given)| *is_given && !backends.contains(of)) {
        let names: Vec<&str> = backends.iter().map(|backend| backend.name()).collect();
        warn_idle(name, of.name(), &names.join(", "));
    }
}

/// Warns of options of a sweep that its drive or backends do not have: only ants are random, and
/// quasi-static runs have no inertia.
pub fn warn_of_idle_points(scenario: &Scenario, backends: &[BackendKind], n_seeds: u64, scales_inertia: bool) {
    if n_seeds > 1 && matches!(scenario.drive, Drive::Tips(_)) {
        warn_idle("--seeds", "ants", "tips");
    }
    if scales_inertia && backends.iter().all(|backend| *backend == BackendKind::QuasiStatic) {
        warn_idle("--scale-inertia", "inertial and rapier", "quasi-static");
    }
}

/// Warns of an option that applies to one thing only, where another was found.
pub fn warn_idle(option: &str, applies_to: &str, found: &str) {
    console::warn(format_args!("{option}: changes nothing; it applies to {applies_to} only, found {found}"));
}
