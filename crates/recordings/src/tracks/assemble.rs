//! Points of all files as tracks in SI units, with a note of everything that was changed.

use std::f64::consts::PI;

use cohaul::math::Vec2;
use cohaul::scenario::{Findings, ScenarioError};
use cohaul::stop;
use serde::Deserialize;

use super::cells::Cells;
use super::format::TrackFormat;
use super::points::{AngleUnit, Clock, LengthUnit, Point, Points};
use super::track::{LOAD, Sample, Track, Tracks};
use super::{deeplabcut, table};
use crate::account::{Account, Kind, Note};

/// Units of a recording, where the files do not state them or are wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Units {
    /// Frames per second of the camera (1/s).
    pub fps: Option<f64>,
    /// Length of a pixel, or of the unit of a file that names none (m).
    pub scale: Option<f64>,
    /// Whether the y axis points down; the default is that of the format.
    pub y_down: Option<bool>,
    /// Whether angles are in degrees; the default is what the file says.
    pub degrees: Option<bool>,
    /// Smallest confidence of a place that counts (1).
    pub min_confidence: Option<f64>,
    /// Time of the file that becomes zero (s).
    pub start: Option<f64>,
    /// Place of the recording, with the y axis up, that becomes the origin (m).
    pub origin: Option<[f64; 2]>,
}

/// A file that is to be read.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    /// Name of the file in errors.
    pub file: &'a str,
    /// Content of the file.
    pub bytes: &'a [u8],
}

/// Share of the frame interval within which two times are one frame (1): times that were computed
/// from a number of frames differ by rounding only.
const SAME_FRAME: f64 = 1e-6;

/// The tracks of all files, as the tracker saw them but in SI units: swaps, jumps and gaps are
/// still there. Without a format each file has that which its first lines tell.
///
/// # Errors
/// When a file is of no known format, breaks a rule of it, or does not say its units.
pub fn read(files: &[Reading], format: Option<TrackFormat>, units: &Units, account: &mut Account) -> Result<Tracks, ScenarioError> {
    let mut all: Vec<Points> = Vec::new();
    for reading in files {
        let of_file = |rule: &str, found: &str| fault(reading.file, "", rule, found);
        let format = match format {
            Some(format) => format,
            None => TrackFormat::of(reading.bytes).map_err(|found| of_file("must be a table of text", &found))?,
        };
        let cells = Cells::parse(reading.bytes, reading.file)?;
        let points = match format {
            TrackFormat::DeepLabCut => deeplabcut::read(cells)?,
            _ => table::read(cells, format, &stem(reading.file))?,
        };
        if points.n_rows == 0 {
            return Err(of_file("must have a row of numbers", "headers only"));
        }
        if let Some(both) = all.iter().flat_map(|other| &other.names).find(|name| points.names.contains(name)) {
            return Err(of_file("must have names of tracks that no other file has", both));
        }
        account.files.push(reading.file.to_owned());
        let title = format.title();
        account.source = if account.source.is_empty() || account.source == title { title.to_owned() } else { "several formats".to_owned() };
        all.push(points);
    }
    let mut tracks = Tracks::default();
    for points in &all {
        of_file(points, units, account, &mut tracks)?;
    }
    finish(&mut tracks, units, account);
    Ok(tracks)
}

fn fault(file: &str, path: &str, rule: &str, found: impl std::fmt::Display) -> ScenarioError {
    let mut findings = Findings::default();
    findings.report(path, rule, found);
    ScenarioError::Invalid { file: file.to_owned(), findings: findings.0 }
}

/// Name of a file without folder and extension. Of `video_fish3.csv` it is `fish3`, as TRex names
/// its files.
fn stem(file: &str) -> String {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    let name = name.split_once('.').map_or(name, |(name, _)| name);
    let tail = name.rsplit('_').next().unwrap_or(name);
    if ["fish", "id"].iter().any(|word| tail.strip_prefix(word).is_some_and(|rest| rest.parse::<u32>().is_ok())) { tail } else { name }
        .to_owned()
}

/// Factors from the units of a file to SI.
struct Factors {
    /// Units of time in a second (1/s).
    rate: f64,
    length: f64,
    /// Of the y axis and of angles: -1 where the axis points down.
    y: f64,
    angle: f64,
    /// Place that becomes the origin (m).
    origin: Vec2,
}

fn factors(points: &Points, units: &Units, account: &mut Account) -> Result<Factors, ScenarioError> {
    let fault = |rule: &str, found: &str| fault(&points.file, "header", rule, found);
    let rate = match points.clock {
        Clock::Seconds => 1.0,
        Clock::Frames => units.fps.ok_or_else(|| fault("must have times, or need --fps", "frames only"))?,
    };
    let length = match (points.length, units.scale) {
        (LengthUnit::Metres(metres), _) => metres,
        (_, Some(scale)) => scale,
        (LengthUnit::Pixels, None) => return Err(fault("must have places in metres, or need --scale-m, the metres of a pixel", "pixels")),
        (LengthUnit::Unknown, None) => {
            return Err(fault("must say the unit of places, as x_m, x_mm or x_px, or need --scale-m", "no unit"));
        }
    };
    let y_down = units.y_down.unwrap_or(points.y_down);
    let headings: Vec<f64> = points.points.iter().chain(&points.load).filter_map(|point| point.heading).collect();
    let largest = headings.iter().fold(0.0, |most: f64, heading| most.max(heading.abs()));
    let degrees = units.degrees.unwrap_or(match points.angle {
        AngleUnit::Degrees => true,
        AngleUnit::Radians => false,
        // Angles that nobody names and that exceed a turn of radians are degrees.
        AngleUnit::Unknown => largest > 2.0 * PI + 0.01,
    });
    if length != 1.0 {
        account.add(Note::new(Kind::Units, points.points.len(), format!("places in units of {length} m")));
    }
    if y_down {
        account.add(Note::new(Kind::Units, points.points.len(), "places of which the y axis was turned from down to up"));
    }
    if degrees && !headings.is_empty() {
        account.add(Note::new(Kind::Units, headings.len(), "headings in degrees"));
    } else if largest > 4.0 * PI && largest <= 720.0 {
        let text = "headings beyond two turns were taken as radians, as the file says: are they in degrees?";
        account.add(Note::new(Kind::Units, headings.len(), text).sized(Some(largest), None, "rad").warning());
    }
    let origin = units.origin.map_or(Vec2::zeros(), Vec2::from);
    if let Some([x, y]) = units.origin {
        account.add(Note::new(Kind::Moved, 1, format!("origin, moved to [{x}, {y}] m of the recording")));
    }
    Ok(Factors { rate, length, y: if y_down { -1.0 } else { 1.0 }, angle: if degrees { PI / 180.0 } else { 1.0 }, origin })
}

/// Adds the tracks of one file.
fn of_file(points: &Points, units: &Units, account: &mut Account, tracks: &mut Tracks) -> Result<(), ScenarioError> {
    let factors = factors(points, units, account)?;
    account.add(Note::new(Kind::Read, points.n_rows, format!("rows with {} tracks", points.names.len())));
    let left_out = &points.left_out;
    account.add(Note::new(Kind::LeftOut, left_out.len(), format!("columns without a part in the scenario: {}", listed(left_out))));
    account.add(Note::new(Kind::Units, points.n_decimal_commas, "numbers with a decimal comma"));
    let mut findings = Findings::default();
    let mut of_names: Vec<Track> = points.names.iter().map(|id| Track { id: id.clone(), ..Track::default() }).collect();
    let mut lines: Vec<Vec<u64>> = vec![Vec::new(); of_names.len()];
    let (mut not_seen, mut doubtful) = (Vec::new(), Vec::new());
    for point in &points.points {
        stop::point();
        let id = &points.names[point.name];
        let time = point.clock / factors.rate;
        tracks.frames.push(time);
        let Some(sample) = sample(point, &factors) else {
            not_seen.push((id.clone(), time));
            continue;
        };
        if units.min_confidence.is_some_and(|least| sample.confidence.is_some_and(|found| found < least)) {
            doubtful.push((id.clone(), time));
            continue;
        }
        let track = &mut of_names[point.name];
        if point.is_release {
            track.releases.push(sample);
        } else {
            track.samples.push(sample);
            lines[point.name].push(point.line);
        }
    }
    account.add(Note::new(Kind::NotSeen, not_seen.len(), "places that the tracker did not give").at(not_seen));
    let limit = units.min_confidence;
    account.add(
        Note::new(Kind::LowConfidence, doubtful.len(), "places of low confidence, taken as not seen").sized(None, limit, "").at(doubtful),
    );
    let mut repeated = 0;
    for (track, lines) in of_names.iter_mut().zip(&lines) {
        repeated += sorted(track, lines, &mut findings);
    }
    account.add(Note::new(Kind::Repeated, repeated, "places that stand twice in a frame"));
    if !findings.0.is_empty() {
        return Err(ScenarioError::Invalid { file: points.file.clone(), findings: findings.0 });
    }
    tracks.tracks.extend(of_names);
    tracks.are_springs |= points.are_springs;
    add_load(points, &factors, account, tracks);
    Ok(())
}

fn listed(names: &[String]) -> String {
    let more = if names.len() > 8 { format!(" and {} more", names.len() - 8) } else { String::new() };
    names[..names.len().min(8)].join(", ") + &more
}

fn sample(point: &Point, factors: &Factors) -> Option<Sample> {
    let [x, y] = point.position?;
    let position = Vec2::new(factors.length * x, factors.y * factors.length * y) - factors.origin;
    let heading = point.heading.map(|heading| factors.y * factors.angle * heading);
    Some(Sample { time: point.clock / factors.rate, position, heading, confidence: point.confidence })
}

/// Brings the samples of a track into the order of time. Returns how many stood there twice; two
/// places in one frame are a fault.
fn sorted(track: &mut Track, lines: &[u64], findings: &mut Findings) -> usize {
    let mut order: Vec<usize> = (0..track.samples.len()).collect();
    order.sort_by(|a, b| track.samples[*a].time.total_cmp(&track.samples[*b].time));
    let mut kept: Vec<Sample> = Vec::with_capacity(order.len());
    let mut last_line = 0;
    for at in &order {
        let sample = track.samples[*at];
        match kept.last() {
            Some(last) if last.time == sample.time && last.position != sample.position => {
                let rule = format!("must have track {} once in a frame, as on line {last_line}", track.id);
                findings.report(format_args!("line {}", lines[*at]), rule, "another place at the same time");
            }
            Some(last) if last.time == sample.time => {}
            _ => {
                kept.push(sample);
                last_line = lines[*at];
            }
        }
    }
    let n_repeated = track.samples.len() - kept.len();
    track.samples = kept;
    track.releases.sort_by(|a, b| a.time.total_cmp(&b.time));
    n_repeated
}

/// The pose of the load in columns of its own, once a frame.
fn add_load(points: &Points, factors: &Factors, account: &mut Account, tracks: &mut Tracks) {
    let mut load: Vec<Sample> = points.load.iter().filter_map(|point| sample(point, factors)).collect();
    if load.is_empty() {
        return;
    }
    load.sort_by(|a, b| a.time.total_cmp(&b.time));
    let differ = load.windows(2).filter(|pair| pair[0].time == pair[1].time && pair[0].position != pair[1].position).count();
    account.add(Note::new(Kind::Repeated, differ, "places of the load that differ within a frame; the first one counts").warning());
    load.dedup_by(|next, before| next.time == before.time);
    let track = tracks.load.get_or_insert_with(|| Track { id: LOAD.to_owned(), ..Track::default() });
    track.samples.extend(load);
    track.samples.sort_by(|a, b| a.time.total_cmp(&b.time));
}

/// Orders tracks and frames, moves the start to zero, and makes headings continuous.
fn finish(tracks: &mut Tracks, units: &Units, account: &mut Account) {
    tracks.tracks.sort_by_cached_key(|track| natural(&track.id));
    if tracks.load.is_none() {
        let load = tracks.tracks.iter().position(|track| track.id == LOAD);
        tracks.load = load.map(|at| tracks.tracks.remove(at));
    }
    tracks.frames.sort_by(f64::total_cmp);
    tracks.frames.dedup();
    let step = tracks.frame_interval();
    tracks.frames.dedup_by(|next, before| *next - *before <= SAME_FRAME * step);
    let (Some(first), Some(last)) = (tracks.frames.first().copied(), tracks.frames.last().copied()) else { return };
    // A recording that begins later than it is long runs on another clock.
    let start = units.start.unwrap_or(if first < 0.0 || first > last - first { first } else { 0.0 });
    if start != 0.0 {
        account.add(Note::new(Kind::Moved, 1, format!("start of the recording, {start} s of the file, is time 0")));
    }
    for time in account.notes.iter_mut().flat_map(|note| &mut note.places).filter_map(|place| place.time_s.as_mut()) {
        *time -= start;
    }
    tracks.frames.retain_mut(|time| moved(time, start));
    for track in tracks.tracks.iter_mut().chain(&mut tracks.load) {
        track.samples.retain_mut(|sample| moved(&mut sample.time, start));
        track.releases.retain_mut(|sample| moved(&mut sample.time, start));
        let mut last: Option<f64> = None;
        for heading in track.samples.iter_mut().filter_map(|sample| sample.heading.as_mut()) {
            if let Some(last) = last {
                *heading -= 2.0 * PI * ((*heading - last) / (2.0 * PI)).round();
            }
            last = Some(*heading);
        }
    }
}

/// Moves a time, and returns whether it is in the recording.
fn moved(time: &mut f64, start: f64) -> bool {
    *time -= start;
    *time >= 0.0
}

/// Order of names in which numbers count by size.
fn natural(name: &str) -> (Vec<(String, u64)>, String) {
    let (mut parts, mut word, mut number) = (Vec::new(), String::new(), String::new());
    for letter in name.chars().chain(['\0']) {
        if letter.is_ascii_digit() {
            number.push(letter);
            continue;
        }
        if !number.is_empty() {
            parts.push((std::mem::take(&mut word), number.parse().unwrap_or(u64::MAX)));
            number.clear();
        }
        word.push(letter);
    }
    parts.push((word, 0));
    (parts, name.to_owned())
}
