//! `cohaul render`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use serde_json::Value;

use super::choice::{not_negative, positive, seconds};
use super::console::print;
use super::engine::EngineArgs;
use super::error::{CliError, at_output};
use super::input::{check_step, name_of, read_json, read_scenario, warn_of_scenario};
use super::watch::{watched, watched_to_end};
use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::formats;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation, Trace};
use cohaul_report::chart::Labelled;
use cohaul_report::folder::MANIFEST;
use cohaul_report::picture::{Drawing, Film, FilmError, Format, Size};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul render scenarios/paper/four-ants-four-springs.json --out ants.gif
  cohaul render scene.json --backend all --out scene.mp4 --pace 0.5
  cohaul render out/run --at-s 3.5 --out figure.png

A DIR that `cohaul run --out` wrote is computed again as its manifest says. An
MP4 needs ffmpeg on the path; GIF and PNG need nothing.")]
pub struct RenderArgs {
    /// Scenario file, - for standard input, or the output folder of a run
    source: PathBuf,
    /// File to write: .gif, .png or .mp4
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Backend to show, may be repeated; all for all of them [default: quasi-static]
    #[arg(long, value_parser = backends())]
    backend: Vec<String>,
    /// Longest time step of the backends (s) [default: see cohaul run --help]
    #[arg(long, value_name = "H", value_parser = seconds, hide_short_help = true)]
    step_s: Option<f64>,
    /// Seed of all random streams [default: the scenario's]
    #[arg(long, value_name = "N", hide_short_help = true)]
    seed: Option<u64>,
    /// Time that a picture shows (s) [default: the end]
    #[arg(long, value_name = "T", value_parser = not_negative, conflicts_with_all = ["from_s", "to_s", "pace", "rate"])]
    at_s: Option<f64>,
    /// First time of a film (s) [default: the start]
    #[arg(long, value_name = "T", value_parser = not_negative)]
    from_s: Option<f64>,
    /// Last time of a film (s) [default: the end]
    #[arg(long, value_name = "T", value_parser = not_negative)]
    to_s: Option<f64>,
    /// Simulated time over the time of the film (1)
    ///
    /// By default it is 1, or such that the film lasts 3 to 20 s.
    #[arg(long, value_name = "FACTOR", value_parser = positive)]
    pace: Option<f64>,
    /// Pictures a second [default: 20]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100), hide_short_help = true)]
    rate: Option<u32>,
    /// Width and height (px), such as 800x450
    ///
    /// By default a picture is 640 px wide, or 480 px for each of several backends.
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<Size>,
    /// Go along with the load, in place of the whole path
    #[arg(long)]
    follow: bool,
    #[command(flatten)]
    engine: EngineArgs,
}

/// Names of backends, and `all`.
fn backends() -> clap::builder::PossibleValuesParser {
    clap::builder::PossibleValuesParser::new(BackendKind::ALL.iter().map(|kind| kind.name()).chain(["all"]))
}

/// Sides of a picture at most (px).
const MOST_PIXELS: u32 = 4096;
const LEAST_PIXELS: u32 = 64;
/// Time of a film without a pace at least and at most (s).
const SHORTEST: f64 = 3.0;
const LONGEST: f64 = 20.0;
const HEIGHT: u32 = 480;
/// Largest number of pictures of a film (1): more than an hour of them.
const MOST_FRAMES: u64 = 100_000;

fn size(text: &str) -> Result<Size, String> {
    let fault = || format!("must be like 800x450, each side from {LEAST_PIXELS} to {MOST_PIXELS} px, found {text}");
    let (width, height) = text.split_once('x').ok_or_else(fault)?;
    let side = |text: &str| text.parse().ok().filter(|side| (LEAST_PIXELS..=MOST_PIXELS).contains(side)).ok_or_else(fault);
    Ok(Size { width: side(width)?, height: side(height)? })
}

pub fn render(args: &RenderArgs) -> Result<ExitCode, CliError> {
    let Some(format) = Format::of(&args.out) else {
        return Err(CliError::Usage(format!("--out: must end in .gif, .png or .mp4, found {}", args.out.display())));
    };
    if args.out.is_dir() {
        return Err(CliError::Usage(format!("--out: must be a file, found the folder {}", args.out.display())));
    }
    let (scenario, options) = source(args)?;
    let traces = options.iter().map(|options| trace(&scenario, options)).collect::<Result<Vec<Trace>, _>>()?;
    let end = traces.iter().filter_map(|trace| trace.rows.last()).map(|row| row.time).fold(0.0, f64::max);
    let film = film(args, format, end)?;
    let runs: Vec<Labelled> = traces.iter().zip(&options).map(|(trace, of)| Labelled { label: of.kind.name(), trace }).collect();
    let size = args.size.unwrap_or(Size { width: if runs.len() > 1 { 480 * runs.len() as u32 } else { 640 }, height: HEIGHT });
    let drawing = Drawing::new(&scenario, &runs, size, args.follow);
    let written = watched("render", |watch| film.write(&drawing, &args.out, format, watch));
    written.map_err(|error| match error {
        FilmError::Interrupted => CliError::Interrupted,
        FilmError::File(source) => at_output(&args.out)(source),
        failed @ (FilmError::Gif(_) | FilmError::Png(_) | FilmError::Ffmpeg(_)) => at_output(&args.out)(std::io::Error::other(failed)),
        other => CliError::Usage(format!("--out: {}: {other}", args.out.display())),
    })?;
    print(&format!("{}\n", args.out.display()))?;
    Ok(ExitCode::SUCCESS)
}

/// The scene and how it is computed.
fn source(args: &RenderArgs) -> Result<(Scenario, Vec<BackendOptions>), CliError> {
    if args.source.is_dir() {
        return recorded(args, &args.source.join(MANIFEST));
    }
    let scenario = read_scenario(&args.source, args.seed)?;
    check_step(args.step_s, &scenario)?;
    warn_of_scenario(&args.source, &scenario);
    let is_asked = |kind: &BackendKind| match args.backend.as_slice() {
        [] => *kind == BackendKind::QuasiStatic,
        asked => asked.iter().any(|name| name == kind.name() || name == "all"),
    };
    let options = |kind: BackendKind| BackendOptions {
        rapier: args.engine.options(),
        ..BackendOptions::at_step(args.step_s, kind, &scenario.system, scenario.control_period)
    };
    let options = BackendKind::ALL.into_iter().filter(is_asked).map(options).collect();
    Ok((scenario, options))
}

/// A run as its manifest says.
fn recorded(args: &RenderArgs, manifest: &Path) -> Result<(Scenario, Vec<BackendOptions>), CliError> {
    if !args.backend.is_empty() || args.step_s.is_some() || args.seed.is_some() {
        return Err(CliError::Usage("--backend, --step-s, --seed: must be left out with a folder, which holds its own".into()));
    }
    let read: Value = read_json(manifest, &formats::MANIFEST, "must be the manifest of a run")?;
    let fault =
        |error: &dyn std::fmt::Display| CliError::Usage(format!("{}: must be the manifest of `cohaul run`: {error}", name_of(manifest)));
    let options: BackendOptions = serde_json::from_value(read["options"].clone()).map_err(|error| fault(&error))?;
    let scenario = Scenario::parse(&read["scenario"].to_string(), &name_of(manifest))?;
    Ok((scenario, vec![options]))
}

fn trace(scenario: &Scenario, options: &BackendOptions) -> Result<Trace, CliError> {
    watched_to_end(options.kind.name(), |watch| {
        let mut run = Simulation::new(scenario, options, Keep::Trace);
        run.run_to_tolerance(|options| Simulation::new(scenario, options, Keep::Trace), |time| watch(time / scenario.duration));
        run.is_finished().then(|| run.into_results().0)
    })
}

fn film(args: &RenderArgs, format: Format, end: f64) -> Result<Film, CliError> {
    let is_still = format == Format::Png;
    let (from, to) = match args.at_s {
        Some(_) if !is_still => return Err(CliError::Usage("--at-s: applies to a .png only".into())),
        Some(at) => (at, at),
        None => (args.from_s.unwrap_or(0.0), args.to_s.unwrap_or(end)),
    };
    if !(from <= to && to <= end * (1.0 + 1e-9)) {
        return Err(CliError::Usage(format!(
            "--at-s, --from-s, --to-s: must be in order and up to the end at {end} s, found {from} and {to}"
        )));
    }
    let span = (to - from).max(f64::MIN_POSITIVE);
    let pace = args.pace.unwrap_or_else(|| 1f64.max(span / LONGEST).min(span / SHORTEST));
    let film = Film { from, to, rate: f64::from(args.rate.unwrap_or(20)), pace };
    if !is_still && film.n_frames() > MOST_FRAMES {
        let n = film.n_frames();
        return Err(CliError::Usage(format!("--pace, --rate: must make at most {MOST_FRAMES} pictures, found {n}")));
    }
    Ok(film)
}
