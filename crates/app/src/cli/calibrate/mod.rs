//! `cohaul calibrate grid|fit|design|forces|behaviour|pulls`.

mod behaviour;
mod design;
mod dimensions;
mod fit;
mod forces;
mod grid;
mod pulls;
mod sensor;

use std::process::ExitCode;

use clap::Subcommand;

use super::error::CliError;
use super::watch::{catch_interrupts, watched_by};
use cohaul_report::progress::Progress;
pub use sensor::{SensorArgs, SensorInput, SpringArgs, table_of};

#[derive(Subcommand)]
pub enum CalibrateCommand {
    /// Turn readings of a load cell on a grid into a lookup table and a table for `fit`
    Grid(grid::GridArgs),
    /// Fit Young's modulus and linear stiffnesses to measured forces
    Fit(fit::FitArgs),
    /// Find the dimensions of a spring for wanted stiffnesses
    Design(design::DesignArgs),
    /// Turn recorded tip positions into forces
    Forces(forces::ForcesArgs),
    /// Fit release law, steering and speed of ants to recorded tips
    Behaviour(behaviour::BehaviourArgs),
    /// Compare two samples of pulls by a test that knows runs
    Pulls(pulls::PullsArgs),
}

pub fn calibrate(command: &CalibrateCommand) -> Result<ExitCode, CliError> {
    // An interrupt leaves no file half written.
    catch_interrupts();
    let progress = match command {
        CalibrateCommand::Behaviour(_) => Progress::of_share("calibrate behaviour"),
        _ => Progress::of_unknown("calibrate"),
    };
    watched_by(progress, |watch| match command {
        CalibrateCommand::Grid(args) => grid::grid(args),
        CalibrateCommand::Fit(args) => fit::fit(args),
        CalibrateCommand::Design(args) => design::design(args),
        CalibrateCommand::Forces(args) => forces::forces(args),
        CalibrateCommand::Behaviour(args) => behaviour::behaviour(args, watch),
        CalibrateCommand::Pulls(args) => pulls::pulls(args),
    })
}
