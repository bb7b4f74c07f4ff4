//! `cohaul compare`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Instant, SystemTime};

use clap::Args;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::choice::{choice, positive, seconds};
use super::console::{self, Tone};
use super::cost::warn_of_cost;
use super::engine::{EngineArgs, warn_idle};
use super::error::CliError;
use super::foreign::ForeignArgs;
use super::input::{check_step, name_of, read_scenario, read_text};
use super::output::{OutputArgs, StrictArgs, manifest_of};
use super::resumable::{self, Finished};
use super::threshold::threshold;
use super::vary::{VaryArgs, vary};
use super::watch::{watched_by, watched_to_end};
use cohaul::analysis::compare::{
    ClosedLoop, InertiaAnswer, MeasureVerdict, Pathwise, QuantityVerdict, SeedRuns, Settings, ThreeWay, Tier, Verdict,
};
use cohaul::analysis::{DEFAULT_SEEDS, ExpectedCost};
use cohaul::backend::{BackendKind, Skip, Skips};
use cohaul::scenario::{Drive, Scenario};
use cohaul_engines::Engine;
use cohaul_report::json;
use cohaul_report::progress::Progress;
use cohaul_report::traces::TraceFormat;
use cohaul_studies::compare::answer::verdict_text;
use cohaul_studies::compare::beside::recorded_path;
use cohaul_studies::compare::closed_loop::{First, judged, tasks};
use cohaul_studies::compare::comparison::{Comparison, Refusal, Tiers};
use cohaul_studies::compare::files::write_comparison;
use cohaul_studies::compare::text::{account_warnings, text, tolerance_warning};
use cohaul_studies::variants::names;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul compare scenarios/analytic/release-jump.json
  cohaul compare scene.json --tier replayed --verbose
  cohaul compare ants.json --seeds 32
  cohaul compare scene.json --beside camera.csv
  cohaul compare scene.json --vary load.mass_kg=log:0.1:10:12 --out out/map
  cohaul compare scene.json --threshold speed
  cohaul compare scene.json --engine ./my_engine --fail-on engine

Files in DIR: report.html, figures, summary.json, manifest.json; map.csv or
points.csv and figures for print (88 and 180 mm, SVG and PDF) of maps and
thresholds. What was interrupted is kept in DIR.journal.")]
pub struct CompareArgs {
    /// Scenario file; - for standard input
    scenario: PathBuf,
    /// Level of comparison; may be repeated
    ///
    /// By default all levels of the scenario are compared.
    /// Scenarios of tips have prescribed; scenarios of ants have replayed and closed-loop.
    #[arg(long, value_parser = choice::<Tier>())]
    tier: Vec<Tier>,
    /// First time step of the engine, which is halved; closed loop: longest step of all (s)
    #[arg(long, value_name = "H", value_parser = seconds, hide_short_help = true)]
    step_s: Option<f64>,
    /// Halvings of the engine's step, which tell time step from model [default: 2]
    ///
    /// The last three runs show the limit of small steps. The step that is judged stays the first.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10), hide_short_help = true)]
    halvings: Option<u32>,
    /// Largest error of the quasi-static and inertial paths (m) [default: as the verdict needs]
    #[arg(long, value_name = "M", value_parser = positive, hide_short_help = true)]
    tolerance: Option<f64>,
    /// First seed [default: the scenario's]
    ///
    /// Seed of all random streams; the closed loop counts on from it.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Number of seeds of the closed loop [default: 8]
    #[arg(long, value_name = "N")]
    seeds: Option<usize>,
    /// Backend whose run is replayed on the others [default: quasi-static]
    #[arg(long, value_name = "BACKEND", value_parser = choice::<BackendKind>(), hide_short_help = true)]
    recorded_from: Option<BackendKind>,
    /// Leave the dashpots out of the quasi-static model, which are then part of the inertia effect
    #[arg(long, hide_short_help = true)]
    rate_independent: bool,
    /// Tolerance of the path (1) [default: 0.01]
    ///
    /// Largest edge displacement that counts as agreement, over the path length.
    #[arg(long, aliases = ["tolerance-share", "agreement"], value_name = "SHARE", value_parser = positive)]
    tolerance_path: Option<f64>,
    /// Tolerance of the heading (rad) [default: 0.01, or 1 % of the turn if that is more]
    #[arg(long, value_name = "RAD", value_parser = positive, hide_short_help = true)]
    tolerance_heading: Option<f64>,
    /// Tolerance of peak and mean pulls, over the largest of them (1) [default: 0.05]
    #[arg(long, value_name = "SHARE", value_parser = positive, hide_short_help = true)]
    tolerance_pull: Option<f64>,
    /// Tolerance of peak and mean speed, over the larger value (1) [default: 0.05]
    #[arg(long, value_name = "SHARE", value_parser = positive, hide_short_help = true)]
    tolerance_speed: Option<f64>,
    /// Tolerance of the energy dissipated, over the larger value (1) [default: 0.05]
    #[arg(long, value_name = "SHARE", value_parser = positive, hide_short_help = true)]
    tolerance_energy: Option<f64>,
    /// Exit with code 1 on this verdict; may be repeated
    ///
    /// It counts whether it is the verdict on a quantity of the paths or on a measure of the closed
    /// loop.
    ///
    /// The kind inconclusive stands for all that is left open: the verdicts inconclusive,
    /// decorrelated and nothing moved, and an open inertia effect or engine error beside another
    /// verdict.
    #[arg(long, value_name = "KIND", value_parser = choice::<FailOn>())]
    fail_on: Vec<FailOn>,
    /// Print suggested changes without trying them
    ///
    /// By default up to three trials run quasi-static and inertial again on the changed scene, for
    /// at most 50 times its duration.
    #[arg(long, hide_short_help = true)]
    no_check_suggestions: bool,
    /// Do work whose result is already known; see `cohaul explain skipped`. May be repeated
    #[arg(long, value_name = "KIND", value_parser = choice::<Skip>(), hide_short_help = true)]
    no_skip: Vec<Skip>,
    /// Path recorded elsewhere, to be compared too (CSV)
    ///
    /// Columns of the table: time_s, x_m, y_m and heading_rad.
    /// The path is compared with those of the first tier of paths.
    #[arg(long, value_name = "FILE", hide_short_help = true)]
    beside: Option<PathBuf>,
    #[command(flatten)]
    vary: VaryArgs,
    #[command(flatten)]
    engine: EngineArgs,
    #[command(flatten)]
    foreign: ForeignArgs,
    #[command(flatten)]
    strict: StrictArgs,
    #[command(flatten)]
    output: OutputArgs,
    /// Write the traces and events of all runs too, trace-TIER-BACKEND and events-TIER-BACKEND.csv
    #[arg(long, value_name = "FORMAT", value_parser = choice::<TraceFormat>(), requires = "out", help_heading = "Output", hide_short_help = true)]
    traces: Option<TraceFormat>,
}

pub fn compare(args: &CompareArgs) -> Result<ExitCode, CliError> {
    if let Some(asked) = &args.vary.threshold {
        check_threshold(args)?;
        return threshold(asked, &args.vary, &args.scenario, args.seed, &settings(args), &args.output);
    }
    if !args.vary.vary.is_empty() {
        check_map(args, "--vary")?;
        return vary(&args.vary, &args.scenario, args.seed, &settings(args), &args.output);
    }
    let scenario = read_scenario(&args.scenario, args.seed)?;
    check_step(args.step_s, &scenario)?;
    let asked = tiers_of(&scenario, args)?;
    let n_seeds = seeds(args, scenario.seed)?;
    warn_of_idle_tiers(args, &asked);
    args.output.check()?;
    let recorded =
        args.beside.as_deref().map(|path| recorded_path(&read_text(path)?, &name_of(path)).map_err(CliError::from)).transpose()?;
    if recorded.is_some() && asked == [Tier::ClosedLoop] {
        return Err(CliError::Usage("--beside: applies to comparisons of paths, found closed-loop only".into()));
    }
    let settings = settings(args);
    let cost_of = |tier: &Tier| match tier {
        Tier::ClosedLoop => ExpectedCost::of_closed_loop(&scenario, &settings, n_seeds),
        _ => ExpectedCost::of_comparison(&scenario, &settings),
    };
    let whole = asked.iter().map(cost_of).reduce(ExpectedCost::and).expect("there is a tier");
    warn_of_cost("compare", &scenario, &whole);
    let (started, clock) = (SystemTime::now(), Instant::now());
    let (mut found, mut others, mut refused_by, mut seeds) = (Tiers::default(), Vec::new(), Vec::new(), None);
    let runs = ThreeWay::new(&scenario, &settings);
    args.foreign.with(&scenario, &settings, |engines| {
        let (engines, refused) = Engine::willing(engines).map_err(|what| CliError::Engine(format!("--engine: {what}")))?;
        refused_by = Refusal::of(&refused);
        for tier in asked {
            let times = [cost_of(&tier), whole].map(|cost| cost.time_s);
            match tier {
                Tier::ClosedLoop => {
                    let asked = json!({ "scenario_sha256": scenario.hash(), "n_seeds": n_seeds, "settings": settings });
                    let (compared, finished) = closed_loop(runs, n_seeds, &asked, args.output.out.as_deref())?;
                    (found.closed_loop, seeds) = (Some(compared), Some(finished));
                }
                Tier::Prescribed => found.prescribed = Some(paths(tier, runs, &engines, &mut others, times)?),
                Tier::Replayed => found.replayed = Some(paths(tier, runs, &engines, &mut others, times)?),
                Tier::Controlled => unreachable!("the command line has no own controllers"),
            }
        }
        Ok(())
    })?;
    let comparison = Comparison::new(&scenario, &settings, found, clock.elapsed().as_secs_f64());
    let mut comparison = comparison.with_other_engines(others, refused_by);
    if let (Some(path), Some(trace)) = (&args.beside, recorded) {
        comparison.lay_beside(&name_of(path), trace).map_err(|rule| CliError::Usage(format!("--beside: {rule}")))?;
    }
    json::check(&comparison)?;
    let written = args.output.out.as_ref().map_or(Ok(()), |out| {
        write_comparison(out, &comparison, &scenario, args.traces, &manifest_of(&scenario, &settings, started))?;
        Ok(seeds.map_or(Ok(()), Finished::remove_journal)?)
    });
    told(args, &comparison, &scenario, written)
}

/// Prints what was found, even where it could not be `written`.
fn told(args: &CompareArgs, comparison: &Comparison, scenario: &Scenario, written: Result<(), CliError>) -> Result<ExitCode, CliError> {
    args.output.print(comparison, || text(comparison, console::detail()), tone(comparison))?;
    tolerance_warning(comparison, scenario).into_iter().chain(account_warnings(comparison)).for_each(console::warn);
    written?;
    args.output.print_report()?;
    let failed = verdicts_of(comparison).find(|of| args.fail_on.iter().any(|kind| kind.has(of)));
    if let Some(Judged { name, text, .. }) = &failed {
        console::warn(format_args!("--fail-on: the verdict on {name} is \"{text}\""));
    }
    Ok(if failed.is_some() { ExitCode::from(1) } else { args.strict.code(comparison.worst()) })
}

/// Largest number of seeds of the closed loop (1). The results of all are in memory at the end.
const MOST_SEEDS: usize = 100_000;

/// Number of seeds of the closed loop.
///
/// # Errors
/// When there are no seeds, too many, or when they end beyond the largest whole number.
fn seeds(args: &CompareArgs, first: u64) -> Result<usize, CliError> {
    let n = args.seeds.unwrap_or(DEFAULT_SEEDS);
    let fault = match n {
        0 => "must be at least 1, found 0".to_owned(),
        n if n > MOST_SEEDS => format!("must be at most {MOST_SEEDS}, found {n}; `cohaul sweep` takes more"),
        n if first.checked_add(n as u64 - 1).is_none() => format!("the last seed must be below 2^64, found {n} from {first}"),
        _ => return Ok(n),
    };
    Err(CliError::Usage(format!("--seeds: {fault}")))
}

/// # Errors
/// When an option asks for what a map of comparisons, of the option `by`, has not.
fn check_map(args: &CompareArgs, by: &str) -> Result<(), CliError> {
    let options = [
        ("--tier", !args.tier.is_empty()),
        ("--seeds", args.seeds.is_some()),
        ("--fail-on", !args.fail_on.is_empty()),
        ("--beside", args.beside.is_some()),
        ("--traces", args.traces.is_some()),
        ("--engine", args.foreign.is_given()),
    ];
    check_left_out(&options, by)?;
    args.output.check()
}

/// # Errors
/// When an option asks for what a search for thresholds has not, as an engine.
fn check_threshold(args: &CompareArgs) -> Result<(), CliError> {
    check_left_out(&[("--step-s", args.step_s.is_some()), ("--everywhere", args.vary.everywhere)], "--threshold")?;
    check_left_out(&args.engine.given(), "--threshold")?;
    check_map(args, "--threshold")
}

/// # Errors
/// When one of these options is given beside the option `by`.
fn check_left_out(options: &[(&str, bool)], by: &str) -> Result<(), CliError> {
    match options.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(CliError::Usage(format!("{option}: must be left out with {by}, found both"))),
        None => Ok(()),
    }
}

/// Settings of the comparison, defaults where the command line has none.
fn settings(args: &CompareArgs) -> Settings {
    let usual = Settings::default();
    Settings {
        step_s: args.step_s,
        halvings: args.halvings.unwrap_or(usual.halvings),
        reference_tolerance_m: args.tolerance,
        rapier: args.engine.options(),
        recorded_from: args.recorded_from.unwrap_or(usual.recorded_from),
        rate_independent: args.rate_independent,
        tolerance_share: args.tolerance_path.unwrap_or(usual.tolerance_share),
        tolerance_heading_rad: args.tolerance_heading,
        tolerance_pull_share: args.tolerance_pull.unwrap_or(usual.tolerance_pull_share),
        tolerance_speed_share: args.tolerance_speed.unwrap_or(usual.tolerance_speed_share),
        tolerance_energy_share: args.tolerance_energy.unwrap_or(usual.tolerance_energy_share),
        skips: Skips::ALL.without_all(&args.no_skip),
        check_suggestions: !args.no_check_suggestions && args.vary.is_one_scene(),
    }
}

/// Verdict that makes the command fail.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum FailOn {
    Inertia,
    Engine,
    Inconclusive,
}

impl FailOn {
    fn has(self, of: &Judged) -> bool {
        match self {
            FailOn::Inertia => of.verdict.has_inertia(),
            FailOn::Engine => of.verdict.has_engine(),
            FailOn::Inconclusive => of.is_open,
        }
    }
}

/// The verdict on a quantity of the paths or a measure of the closed loop.
struct Judged {
    name: String,
    verdict: Verdict,
    text: String,
    /// Whether the inertia effect or the engine error is left open.
    is_open: bool,
}

/// The verdict on each quantity of the paths, then on each measure of the closed loop.
fn verdicts_of(comparison: &Comparison) -> impl Iterator<Item = Judged> {
    let of_quantity = |(name, of): (&str, &QuantityVerdict)| Judged {
        name: name.to_owned(),
        verdict: of.verdict,
        text: verdict_text(of),
        is_open: of.answers().is_open() || of.inertia == InertiaAnswer::NothingMoved,
    };
    let of_measure = |(name, of): (&str, &MeasureVerdict)| Judged {
        name: name.to_owned(),
        verdict: of.verdict,
        text: of.verdict.text().to_owned(),
        is_open: of.answers.is_open() && of.verdict != Verdict::NotComputed,
    };
    let quantities = comparison.all_paths().flat_map(|found| found.verdicts.named()).map(of_quantity);
    let measures = comparison.tiers.closed_loop.iter().flat_map(|found| found.measures.iter().zip(&found.verdicts));
    quantities.chain(measures.map(|(measure, of)| (measure.name, of)).map(of_measure))
}

fn tone(comparison: &Comparison) -> Tone {
    let paths = comparison.all_paths().flat_map(|found| found.verdicts.named().map(|(_, of)| of.verdict));
    let verdicts: Vec<Verdict> = paths.chain(comparison.tiers.closed_loop.iter().map(|found| found.verdict)).collect();
    match () {
        () if !comparison.are_computed() => Tone::Bad,
        () if verdicts.iter().all(|verdict| *verdict == Verdict::Agree) => Tone::Good,
        () => Tone::Caution,
    }
}

/// Compares the paths of the first engine, which is expected to take the first time of two on one
/// core, and the whole command the second (s). The `others` follow beside the same exact paths.
fn paths(
    tier: Tier,
    runs: ThreeWay,
    engines: &[&Engine],
    others: &mut Vec<Pathwise>,
    [time_s, whole_s]: [f64; 2],
) -> Result<Pathwise, CliError> {
    let compared = |engine: &Engine, beside: Option<&Pathwise>| {
        let label = if engines.len() > 1 { format!("{}, {}", list(&[tier]), engine.name().name) } else { list(&[tier]) };
        let progress = Progress::of_share(&label).expecting(time_s).as_part_of(whole_s);
        watched_by(progress, |watch| engine.paths(runs, tier, beside, watch)).ok_or(CliError::Interrupted)
    };
    let first = compared(engines[0], None)?;
    for engine in &engines[1..] {
        others.push(compared(engine, Some(&first))?);
    }
    Ok(first)
}

/// Runs all seeds that an earlier call has not, and compares them.
fn closed_loop(runs: ThreeWay, n_seeds: usize, asked: &Value, out: Option<&Path>) -> Result<(ClosedLoop, Finished<SeedRuns>), CliError> {
    let (label, first) = (list(&[Tier::ClosedLoop]), First::default());
    let finished = resumable::run(&label, asked, &tasks(runs, n_seeds, &first), out)?;
    let compared = watched_to_end(&label, |watch| judged(runs, &finished.records, first, watch))?;
    Ok((compared, finished))
}

fn warn_of_idle_tiers(args: &CompareArgs, tiers: &[Tier]) {
    let pathwise: &[Tier] = &[Tier::Prescribed, Tier::Replayed];
    let options = [
        ("--seeds", &[Tier::ClosedLoop][..], args.seeds.is_some()),
        ("--recorded-from", &[Tier::Replayed][..], args.recorded_from.is_some()),
        ("--tolerance", pathwise, args.tolerance.is_some()),
        ("--tolerance-path", pathwise, args.tolerance_path.is_some()),
        ("--tolerance-heading", pathwise, args.tolerance_heading.is_some()),
        ("--tolerance-pull", pathwise, args.tolerance_pull.is_some()),
        ("--tolerance-speed", pathwise, args.tolerance_speed.is_some()),
        ("--tolerance-energy", pathwise, args.tolerance_energy.is_some()),
    ];
    for (option, of, _) in options.iter().filter(|(_, of, is_given)| *is_given && !tiers.iter().any(|tier| of.contains(tier))) {
        warn_idle(option, &list(of), &list(tiers));
    }
}

/// Names of tiers as a user types them.
fn list(tiers: &[Tier]) -> String {
    tiers.iter().map(|tier| names::<Tier>()[*tier as usize].replace('_', "-")).collect::<Vec<_>>().join(", ")
}

/// The tiers asked for, or all that the scenario has. An engine of the user has no closed loop.
fn tiers_of(scenario: &Scenario, args: &CompareArgs) -> Result<Vec<Tier>, CliError> {
    let (asked, has_engine) = (&args.tier, args.foreign.is_given());
    let (possible, what): (&[Tier], _) = match scenario.drive {
        Drive::Tips(_) => (&[Tier::Prescribed], "a scenario with this drive"),
        Drive::Ants(_) if has_engine => (&[Tier::Replayed], "ants with --engine"),
        Drive::Ants(_) => (&[Tier::Replayed, Tier::ClosedLoop], "a scenario with this drive"),
    };
    if !args.foreign.has_rapier() {
        check_left_out(&args.engine.given(), "--engine")?;
    }
    if let Some(tier) = asked.iter().find(|tier| !possible.contains(tier)) {
        let text = format!("--tier: must be one of {} for {what}, found {}", list(possible), list(&[*tier]));
        return Err(CliError::Usage(text));
    }
    Ok(if asked.is_empty() { possible.to_vec() } else { asked.clone() })
}
