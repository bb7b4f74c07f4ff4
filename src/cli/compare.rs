//! `cohaul compare`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::time::{Instant, SystemTime};

use clap::{Args, ValueEnum};

use super::{
    CliError, EngineArgs, check_out, check_step, command_line, interrupt, positive, print, print_report, read_scenario, step, warn_idle,
};
use crate::analysis::compare::{Settings, ThreeWay, Tier};
use crate::backend::{BackendKind, Skip, Skips};
use crate::output::json;
use crate::output::manifest::Manifest;
use crate::output::progress::Progress;
use crate::output::text::Detail;
use crate::scenario::{Drive, Scenario};
use crate::studies::compare::report::{Comparison, Tiers, write_comparison};
use crate::studies::compare::text::text;

#[derive(Args)]
pub struct CompareArgs {
    /// Scenario file
    scenario: PathBuf,
    /// Tiers to compare in; without it all that the scenario has: prescribed for tips, replayed and closed-loop for ants
    #[arg(long, value_name = "TIER")]
    tier: Vec<Tier>,
    /// Longest step of rapier, the first of those that are halved, and of all backends in the closed loop (s); without it each backend's default
    #[arg(long, value_name = "H", value_parser = step)]
    step_s: Option<f64>,
    /// Error of the quasi-static and inertial paths (m); without it as small as the verdict needs
    #[arg(long, value_name = "M", value_parser = positive)]
    tolerance: Option<f64>,
    /// Seed of all chance, in place of the scenario's; the first of those of the closed loop
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Number of seeds of the closed loop; without it 8
    #[arg(long, value_name = "N")]
    seeds: Option<usize>,
    /// Backend whose run is replayed into the others; without it quasi-static
    #[arg(long, value_name = "BACKEND")]
    recorded_from: Option<BackendKind>,
    /// Largest edge displacement that counts as agreement, divided by the path length (1); without it 0.01
    #[arg(long, alias = "agreement", value_name = "SHARE", value_parser = positive)]
    tolerance_share: Option<f64>,
    /// Folder for the report, traces, figures, summary and manifest
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
    /// Kind of work that is done although its outcome is known; may be repeated
    #[arg(long, value_name = "KIND")]
    no_skip: Vec<Skip>,
    #[command(flatten)]
    engine: EngineArgs,
}

pub fn compare(args: &CompareArgs) -> Result<ExitCode, CliError> {
    let scenario = read_scenario(&args.scenario, args.seed)?;
    check_step(args.step_s, &scenario)?;
    let tiers = tiers_of(&scenario, &args.tier)?;
    let n_seeds = args.seeds.unwrap_or(8);
    if n_seeds == 0 {
        return Err(CliError::Usage("--seeds: must be at least 1, found 0".into()));
    }
    if scenario.seed.checked_add(n_seeds as u64 - 1).is_none() {
        return Err(CliError::Usage(format!("--seeds: the last seed must be below 2^64, found {n_seeds} from {}", scenario.seed)));
    }
    warn_of_idle_tiers(args, &tiers);
    if let Some(out) = &args.out {
        check_out(out)?;
    }
    let unasked = Settings::default();
    let settings = Settings {
        step_s: args.step_s,
        reference_tolerance_m: args.tolerance,
        rapier: args.engine.options(),
        recorded_from: args.recorded_from.unwrap_or(unasked.recorded_from),
        tolerance_share: args.tolerance_share.unwrap_or(unasked.tolerance_share),
        skips: Skips::ALL.without_all(&args.no_skip),
    };
    let (started, clock) = (SystemTime::now(), Instant::now());
    let mut found = Tiers::default();
    for tier in tiers {
        add(&mut found, tier, &scenario, &settings, n_seeds)?;
    }
    let comparison = Comparison::new(&scenario, &settings, found, clock.elapsed().as_secs_f64());
    json::check(&comparison)?;
    if let Some(out) = &args.out {
        let manifest = Manifest::new(&scenario.expanded(), scenario.hash(), scenario.seed, &settings, command_line(), started);
        write_comparison(out, &comparison, &scenario, &manifest)?;
    }
    print(&if args.json { json::pretty(&comparison)? } else { text(&comparison, Detail::Brief) })?;
    if let Some(out) = args.out.as_deref().filter(|_| !args.json) {
        print_report(out)?;
    }
    Ok(if comparison.tiers.are_computed() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// Warns of options of tiers that are not compared in.
fn warn_of_idle_tiers(args: &CompareArgs, tiers: &[Tier]) {
    let pathwise: &[Tier] = &[Tier::Prescribed, Tier::Replayed];
    let options = [
        ("--seeds", &[Tier::ClosedLoop][..], args.seeds.is_some()),
        ("--recorded-from", &[Tier::Replayed][..], args.recorded_from.is_some()),
        ("--tolerance", pathwise, args.tolerance.is_some()),
        ("--tolerance-share", pathwise, args.tolerance_share.is_some()),
    ];
    for (option, of, _) in options.iter().filter(|(_, of, is_given)| *is_given && !tiers.iter().any(|tier| of.contains(tier))) {
        warn_idle(option, &names(of), &names(tiers));
    }
}

fn names(tiers: &[Tier]) -> String {
    let name = |tier: &Tier| tier.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned());
    tiers.iter().map(name).collect::<Vec<_>>().join(", ")
}

/// The tiers asked for, or all that the scenario has.
fn tiers_of(scenario: &Scenario, asked: &[Tier]) -> Result<Vec<Tier>, CliError> {
    let possible: &[Tier] = match scenario.drive {
        Drive::Tips(_) => &[Tier::Prescribed],
        Drive::Ants(_) => &[Tier::Replayed, Tier::ClosedLoop],
    };
    if let Some(tier) = asked.iter().find(|tier| !possible.contains(tier)) {
        let text = format!("--tier: must be one of {} for a scenario with this drive, found {}", names(possible), names(&[*tier]));
        return Err(CliError::Usage(text));
    }
    Ok(if asked.is_empty() { possible.to_vec() } else { asked.to_vec() })
}

fn add(found: &mut Tiers, tier: Tier, scenario: &Scenario, settings: &Settings, n_seeds: usize) -> Result<(), CliError> {
    let label = match tier {
        Tier::Prescribed => "prescribed",
        Tier::Replayed => "replayed",
        Tier::ClosedLoop => "closed loop",
    };
    let progress = Mutex::new(Progress::of_share(label));
    let watch = |share: f64| {
        // Only one thread draws; the others need not wait for it.
        if let Ok(mut progress) = progress.try_lock() {
            progress.at(share);
        }
        !interrupt::asked()
    };
    let runs = ThreeWay::new(scenario, settings);
    match tier {
        Tier::Prescribed => found.prescribed = Some(runs.prescribed(watch).ok_or(CliError::Interrupted)?),
        Tier::Replayed => found.replayed = Some(runs.replayed(watch).ok_or(CliError::Interrupted)?),
        Tier::ClosedLoop => {
            found.closed_loop = Some(runs.closed_loop(n_seeds, watch).ok_or(CliError::Interrupted)?);
        }
    }
    progress.into_inner().expect("no thread panicked while it drew").finish();
    Ok(())
}
