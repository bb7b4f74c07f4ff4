//! `cohaul scenario import`.

use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;

use super::choice::{choice, not_negative, positive, seconds};
use super::console::{self, print};
use super::error::{CliError, at_file, at_output};
use super::input::{name_of, warn_of_scenario};
use super::output::scenario_json;
use cohaul::formats::stamped;
use cohaul::scenario::{Scenario, bounded, is_in_range};
use cohaul_recordings::account::Account;
use cohaul_recordings::import::Asked;
use cohaul_recordings::repair::Bounds;
use cohaul_recordings::scene::Roles;
use cohaul_recordings::tracks::export::{write_tips, write_tracks};
use cohaul_recordings::tracks::{Reading, TrackFormat, Tracks, Units};
use cohaul_report::json;
use cohaul_report::lines::TableError;
use cohaul_report::sibling::write_whole;

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul scenario import DLC.csv --like colony.json --fps 50 --scale-m 2e-5
  cohaul scenario import robots.csv --like doorway.json --out recorded.json
  cohaul scenario import load.svg --like colony.json --out drawn.json")]
pub struct ImportArgs {
    /// Files of tracks, or one drawing; - for standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Scenario with the load, the ground, the springs and the obstacles
    #[arg(long, value_name = "SCENARIO")]
    like: Option<PathBuf>,
    /// Format of the files [default: told by their first lines]
    #[arg(long, value_name = "FORMAT", value_parser = choice::<TrackFormat>())]
    format: Option<TrackFormat>,
    /// Name of the new scenario [default: the name of the other one, and "recorded"]
    #[arg(long)]
    name: Option<String>,
    /// Duration (s) [default: that of the recording]
    #[arg(long, value_name = "T", value_parser = seconds, hide_short_help = true)]
    duration_s: Option<f64>,
    /// Write the scenario here, and what was done as JSON beside it, in NAME.import.json
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write all tracks in SI units as CSV, which can be imported again
    #[arg(long, value_name = "FILE")]
    tracks: Option<PathBuf>,
    /// Write tips and load as CSV, which calibrate reads
    #[arg(long, value_name = "FILE")]
    tips: Option<PathBuf>,
    /// Print what was done as one JSON object in place of scenario and table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    units: UnitArgs,
    #[command(flatten)]
    bounds: BoundArgs,
    #[command(flatten)]
    roles: RoleArgs,
    #[command(flatten)]
    drawing: DrawingArgs,
}

#[derive(Args)]
#[command(next_help_heading = "Units")]
struct UnitArgs {
    /// Frames per second, where the files count frames
    #[arg(long, value_name = "N", value_parser = positive)]
    fps: Option<f64>,
    /// Length of a pixel, or of a unit without a name (m)
    #[arg(long, alias = "scale", value_name = "M", value_parser = positive)]
    scale_m: Option<f64>,
    /// Direction of the y axis: up or down [default: down in images]
    #[arg(long, value_name = "WHERE", value_parser = ["up", "down"], hide_possible_values = true, hide_short_help = true)]
    y: Option<String>,
    /// Unit of headings: radians or degrees [default: as the file says]
    #[arg(long, value_name = "UNIT", value_parser = ["radians", "degrees"], hide_possible_values = true, hide_short_help = true)]
    headings: Option<String>,
    /// Smallest confidence of a place that counts, from 0 to 1
    #[arg(long, value_name = "C", value_parser = not_negative)]
    min_confidence: Option<f64>,
    /// Time of the files that becomes 0 (s) [default: 0, or the first frame of another clock]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = finite, hide_short_help = true)]
    start_s: Option<f64>,
    /// Place of the recording that becomes the origin (m, y up) [default: its own origin]
    #[arg(long, num_args = 2, value_names = ["X", "Y"], allow_negative_numbers = true, value_parser = finite, hide_short_help = true)]
    origin_m: Option<Vec<f64>>,
}

#[derive(Args)]
#[command(next_help_heading = "Bounds of what is put right")]
struct BoundArgs {
    /// Longest gap in which a tip stays attached (s) [default: five lost frames, fewer if fast]
    #[arg(long, alias = "bridge", value_name = "T", value_parser = not_negative)]
    bridge_s: Option<f64>,
    /// Longest step from frame to frame (m) [default: eight times the usual steps]
    #[arg(long, alias = "max-jump", value_name = "M", value_parser = positive)]
    max_jump_m: Option<f64>,
    /// Smooth tips by at most this distance (m)
    #[arg(long, alias = "smooth", value_name = "M", value_parser = positive)]
    smooth_m: Option<f64>,
}

#[derive(Args)]
#[command(next_help_heading = "What the tracks are")]
struct RoleArgs {
    /// Spring on whose tip a track is; may be repeated
    #[arg(long, value_name = "TRACK=INDEX", value_parser = pair::<usize>)]
    spring: Vec<(String, usize)>,
    /// Track of the load, or two marks, rear and front
    #[arg(long, value_name = "TRACK", num_args = 1..=2)]
    load: Vec<String>,
    /// Obstacle that a track moves; may be repeated
    #[arg(long, value_name = "TRACK=NAME", value_parser = pair::<String>)]
    obstacle: Vec<(String, String)>,
}

#[derive(Args)]
#[command(next_help_heading = "Drawings")]
struct DrawingArgs {
    /// Largest distance of straight lines from a curve (m) [default: 1/2000 of the size]
    #[arg(long, value_name = "M", value_parser = positive, hide_short_help = true)]
    tolerance_m: Option<f64>,
    /// Body of an MJCF model
    #[arg(long, value_name = "NAME", hide_short_help = true)]
    body: Option<String>,
    /// Take the y axis of an OBJ mesh for up, not z
    #[arg(long, hide_short_help = true)]
    y_up: bool,
    /// Obstacle that gets the outline, in place of the load
    #[arg(long, value_name = "NAME", hide_short_help = true)]
    onto: Option<String>,
}

fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|value| is_in_range(*value)).ok_or_else(|| format!("must be a number of at most 1e50 in size, found {text}"))
}

/// A name and a value with `=` between them.
fn pair<T: std::str::FromStr>(text: &str) -> Result<(String, T), String> {
    let (name, value) = text.rsplit_once('=').ok_or_else(|| format!("must have the form TRACK=VALUE, found {text}"))?;
    let value = value.parse().map_err(|_| format!("must have a whole number from 0 after =, found {value}"))?;
    Ok((name.to_owned(), value))
}

pub fn import(args: &ImportArgs) -> Result<ExitCode, CliError> {
    let contents = args.files.iter().map(|path| read_bytes(path)).collect::<Result<Vec<_>, _>>()?;
    let names: Vec<String> = args.files.iter().map(|path| name_of(path)).collect();
    let files: Vec<Reading> = names.iter().zip(&contents).map(|(file, bytes)| Reading { file, bytes }).collect();
    let like = args.like.as_deref().map(|path| Ok::<_, CliError>((name_of(path), read_bytes(path)?))).transpose()?;
    let like = like.as_ref().map(|(file, bytes)| Reading { file, bytes });
    let found = cohaul_recordings::import::import(&files, like, &args.asked())?;
    if let (Some(path), Some(tracks)) = (&args.tracks, &found.tracks) {
        write(path, |file| write_tracks(tracks, file))?;
    }
    if let (Some(path), Some(tips)) = (&args.tips, &found.tips) {
        export_tips(path, tips)?;
    }
    finish(args, &found.scenario, &found.account)
}

/// Writes or prints the scenario and what was done.
fn finish(args: &ImportArgs, made: &Scenario, account: &Account) -> Result<ExitCode, CliError> {
    let text = scenario_json(made)?;
    if text.len() as u64 > bounded::MOST_BYTES {
        let rule = "must make a scenario of at most 64 MiB: import a part of it, or fewer frames";
        return Err(CliError::Usage(format!("{}: {rule}, found {} MiB", account.files.join(", "), text.len() >> 20)));
    }
    let notes = json::pretty(&stamped(account))?;
    if let Some(path) = &args.out {
        write(path, |file| Ok(file.write_all(text.as_bytes())?))?;
        write(&path.with_extension("import.json"), |file| Ok(file.write_all(notes.as_bytes())?))?;
        warn_of_scenario(path, made);
    }
    match (&args.out, args.json) {
        (_, true) => print(&notes)?,
        (Some(_), false) => print(&account.text())?,
        (None, false) => {
            if !console::is_quiet() {
                anstream::eprint!("{}", account.text());
            }
            print(&text)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn export_tips(path: &Path, tips: &Tracks) -> Result<(), CliError> {
    let mut left_out = 0;
    write(path, |file| {
        left_out = write_tips(tips, file)?;
        Ok(())
    })?;
    if left_out > 0 {
        console::warn(format_args!("{}: {left_out} tips at times without a pose of the load are left out", path.display()));
    }
    Ok(())
}

/// Writes a file as a whole or not at all.
fn write(path: &Path, content: impl FnOnce(&mut File) -> Result<(), TableError>) -> Result<(), CliError> {
    write_whole(path, content).map_err(|error| match error {
        TableError::NotFinite(error) => CliError::NotFinite(error),
        TableError::Io(error) => at_output(path)(error),
        TableError::Csv(error) => at_output(path)(std::io::Error::other(error)),
    })
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, CliError> {
    let most = bounded::MOST_BYTES_OF_TABLE;
    let source: Box<dyn Read> =
        if path.as_os_str() == "-" { Box::new(std::io::stdin().lock()) } else { Box::new(File::open(path).map_err(at_file(path))?) };
    let mut bytes = Vec::new();
    source.take(most + 1).read_to_end(&mut bytes).map_err(at_file(path))?;
    if bytes.len() as u64 > most {
        return Err(CliError::Usage(format!("{}: must have at most {} MiB, found more", name_of(path), most >> 20)));
    }
    Ok(bytes)
}

impl ImportArgs {
    fn asked(&self) -> Asked {
        let (units, drawing) = (&self.units, &self.drawing);
        Asked {
            format: self.format,
            name: self.name.clone(),
            duration_s: self.duration_s,
            units: Units {
                fps: units.fps,
                scale: units.scale_m,
                y_down: units.y.as_ref().map(|y| y == "down"),
                degrees: units.headings.as_ref().map(|unit| unit == "degrees"),
                min_confidence: units.min_confidence,
                start: units.start_s,
                origin: units.origin_m.as_ref().map(|origin| [origin[0], origin[1]]),
            },
            bounds: Bounds { bridge: self.bounds.bridge_s, jump: self.bounds.max_jump_m, smooth: self.bounds.smooth_m },
            roles: Roles { springs: self.roles.spring.clone(), load: self.roles.load.clone(), obstacles: self.roles.obstacle.clone() },
            tolerance_m: drawing.tolerance_m,
            body: drawing.body.clone(),
            y_up: drawing.y_up,
            onto: drawing.onto.clone(),
        }
    }
}
