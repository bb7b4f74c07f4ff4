//! Tracks as the tips, the load and the obstacles of a scenario.

use std::fmt::Display;

use cohaul::math::{Pose, Vec2};
use cohaul::model::Motion;
use cohaul::scenario::{Drive, Findings, Scenario, ScenarioError, TipPath, Waypoint, nearest};
use serde::Deserialize;

use crate::account::{Account, Kind, Note};
use crate::obstacles::{self, with_headings};
use crate::repair::{Attachment, Bounds, Limits, attachments, leave_out_jumps, note_noise, smooth, smooth_headings, undo_swaps};
use crate::tracks::{Sample, Track, Tracks};

/// What the tracks are in the scenario.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Roles {
    /// Names of tracks, with the index of the spring on whose tip each is. Without any, tables with
    /// a column `spring` have them, and otherwise as many tracks as springs in their order.
    pub springs: Vec<(String, usize)>,
    /// Names of the marks on the load: one at its origin, or two with its origin in the middle and
    /// its x axis from the first to the second one.
    pub load: Vec<String>,
    /// Names of tracks, with the name of the obstacle that each moves.
    pub obstacles: Vec<(String, String)>,
}

/// A scenario from a recording.
#[derive(Clone, Debug)]
pub struct Imported {
    pub scenario: Scenario,
    /// Tracks of the load, and of the tips by their springs, with swaps and jumps put right. Gaps
    /// and noise are still there.
    pub tips: Tracks,
}

/// Makes a scenario of tracks, on the load, the ground, the springs and the obstacles of `like`.
///
/// The load starts at its first recorded pose, if that is within the bridge after time 0, and else
/// as in `like`. The duration is that of the recording; that of `like` counts if `like` has
/// prescribed tips and the two differ by less than the bridge.
///
/// # Errors
/// When a role names what is not there, when roles cannot be told, or the result breaks a rule.
pub fn scenario(
    mut tracks: Tracks,
    roles: &Roles,
    bounds: &Bounds,
    like: &Scenario,
    file: &str,
    account: &mut Account,
) -> Result<Imported, ScenarioError> {
    let mut faults = Faults { file, findings: Findings::default() };
    take_load(&mut tracks, &roles.load, &mut faults);
    let moved = take_obstacles(&mut tracks, &roles.obstacles, like, &mut faults);
    let springs = springs_of(&tracks, roles, like, &mut faults);
    faults.check()?;
    let mut left_out = Vec::new();
    let mut tips: Vec<(usize, Track)> = Vec::new();
    for track in std::mem::take(&mut tracks.tracks) {
        match springs.iter().find(|(id, _)| *id == track.id) {
            Some((_, spring)) => tips.push((*spring, track)),
            None => left_out.push(track.id),
        }
    }
    account.add(Note::new(Kind::LeftOut, left_out.len(), format!("tracks without a part in the scenario: {}", left_out.join(", "))));
    tips.sort_by_key(|(spring, _)| *spring);
    let indices: Vec<usize> = tips.iter().map(|(spring, _)| *spring).collect();
    tracks.tracks = tips.into_iter().map(|(spring, track)| Track { id: spring.to_string(), ..track }).collect();
    tracks.are_springs = true;

    // What moves obstacles is put right as tips are.
    let n_tips = tracks.tracks.len();
    let (indices_of_obstacles, paths): (Vec<usize>, Vec<Track>) = moved.into_iter().unzip();
    let named = |(obstacle, track): (&usize, Track)| Track { id: like.system.world.obstacles[*obstacle].name.clone(), ..track };
    tracks.tracks.extend(indices_of_obstacles.iter().zip(paths).map(named));
    let limits = Limits::of(&tracks, like.system.load.radius, bounds);
    undo_swaps(&mut tracks, &limits, account);
    leave_out_jumps(&mut tracks, &limits, account);
    let paths = tracks.tracks.split_off(n_tips);
    let mut found = attachments(&tracks.tracks, &tracks.frames, &limits, account);
    note_unseen(&found, &tracks, account);
    // Noise of a path that pushes the load matters as that of a tip does.
    found.extend(paths.into_iter().map(|track| vec![Attachment { places: track.samples, release: None }]));
    note_noise(&found, account);
    if let Some(bound) = bounds.smooth {
        smooth(&mut found, bound, account);
    }
    let paths_of_obstacles = found.split_off(n_tips);
    let mut made = Scenario { name: format!("{}, recorded", like.name), ..like.clone() };
    let end = tracks.end();
    let is_same = matches!(like.drive, Drive::Tips(_)) && (end - like.duration).abs() <= limits.bridge;
    made.duration = if is_same { like.duration } else { end };
    made.start = start(tracks.load.as_ref(), like, &limits, account);
    made.drive = Drive::Tips(indices.iter().zip(&found).flat_map(|(spring, found)| found.iter().map(|one| path(*spring, one))).collect());
    for (index, mut path) in indices_of_obstacles.into_iter().zip(paths_of_obstacles) {
        let (samples, obstacle) = (&mut path[0].places, &mut made.system.world.obstacles[index]);
        with_headings(&obstacle.name, samples, obstacle.path.pose_at(0.0).heading, account);
        if let Some(bound) = bounds.smooth {
            smooth_headings(samples, obstacle.outline.extent(), bound);
        }
        obstacle.path = obstacles::path(&obstacle.name, samples, &tracks.frames, &limits, account);
    }
    let scenario = made.expanded().checked(file)?;
    Ok(Imported { scenario, tips: tracks })
}

/// Notes springs without a place of their tip.
fn note_unseen(found: &[Vec<Attachment>], tracks: &Tracks, account: &mut Account) {
    let pairs = found.iter().zip(&tracks.tracks);
    let never: Vec<&str> = pairs.filter(|(found, _)| found.is_empty()).map(|(_, track)| track.id.as_str()).collect();
    let text = format!("springs whose tip is never seen: {}", never.join(", "));
    account.add(Note::new(Kind::LeftOut, never.len(), text).warning());
}

/// Broken rules about roles.
struct Faults<'a> {
    file: &'a str,
    findings: Findings,
}

impl Faults<'_> {
    fn report(&mut self, path: &str, rule: impl Into<String>, found: impl Display) {
        self.findings.report(path, rule, found);
    }

    fn check(self) -> Result<(), ScenarioError> {
        if self.findings.0.is_empty() {
            return Ok(());
        }
        Err(ScenarioError::Invalid { file: self.file.to_owned(), findings: self.findings.0 })
    }

    /// Takes the track of this name out of the recording.
    fn take(&mut self, tracks: &mut Tracks, option: &str, id: &str) -> Option<Track> {
        let at = tracks.tracks.iter().position(|track| track.id == id);
        if at.is_none() {
            self.unknown(tracks, option, id);
        }
        at.map(|at| tracks.tracks.remove(at))
    }

    fn unknown(&mut self, tracks: &Tracks, option: &str, id: &str) {
        let hint = nearest(id, tracks.ids()).map_or_else(String::new, |near| format!(" (did you mean {near}?)"));
        let ids = tracks.ids();
        let known = ids[..ids.len().min(20)].join(", ");
        self.report(option, format!("must name a track of the recording, {known}{hint}"), id);
    }
}

/// The pose of the load from its marks.
fn take_load(tracks: &mut Tracks, marks: &[String], faults: &mut Faults) {
    let found: Vec<Option<Track>> = marks.iter().map(|mark| faults.take(tracks, "--load", mark)).collect();
    let Some(found) = found.into_iter().collect::<Option<Vec<_>>>() else { return };
    match &found[..] {
        [] => {}
        [one] => tracks.load = Some(one.clone()),
        [one, other] => {
            let both = one.samples.iter().filter_map(|a| {
                let at = other.samples.binary_search_by(|b| b.time.total_cmp(&a.time)).ok()?;
                let along: Vec2 = other.samples[at].position - a.position;
                let position = 0.5 * (a.position + other.samples[at].position);
                Some(Sample { position, heading: Some(along.y.atan2(along.x)), ..*a })
            });
            tracks.load = Some(Track { id: "load".to_owned(), samples: both.collect(), releases: Vec::new() });
        }
        _ => faults.report("--load", "must name one or two marks", marks.len()),
    }
}

/// The tracks that move obstacles, with their indices in `like`.
fn take_obstacles(tracks: &mut Tracks, roles: &[(String, String)], like: &Scenario, faults: &mut Faults) -> Vec<(usize, Track)> {
    let mut found = Vec::new();
    for (id, name) in roles {
        let obstacles = &like.system.world.obstacles;
        let index = obstacles.iter().position(|obstacle| obstacle.name == *name);
        if index.is_none() {
            let known: Vec<&str> = obstacles.iter().map(|obstacle| obstacle.name.as_str()).collect();
            faults.report("--obstacle", format!("must name an obstacle of the scenario, {}", known.join(", ")), name);
        }
        if found.iter().any(|(other, _)| Some(*other) == index) {
            faults.report("--obstacle", "must give each obstacle once", name);
        }
        let track = faults.take(tracks, "--obstacle", id);
        if track.as_ref().is_some_and(|track| track.samples.is_empty()) {
            faults.report("--obstacle", "must name a track that is seen at least once", id);
        }
        found.extend(index.zip(track));
    }
    found
}

/// The springs on whose tips the tracks are.
fn springs_of(tracks: &Tracks, roles: &Roles, like: &Scenario, faults: &mut Faults) -> Vec<(String, usize)> {
    let n = like.system.springs.len();
    let rule = format!("must be below {n}, the number of springs");
    let mut found = roles.springs.clone();
    if found.is_empty() && tracks.are_springs {
        found = tracks.tracks.iter().map(|track| (track.id.clone(), track.id.parse().unwrap_or(usize::MAX))).collect();
        for (id, _) in found.iter().filter(|(_, spring)| *spring >= n) {
            faults.report("spring", &rule, id);
        }
        return found;
    }
    if found.is_empty() && n > 0 {
        if tracks.tracks.len() == n {
            return tracks.tracks.iter().enumerate().map(|(spring, track)| (track.id.clone(), spring)).collect();
        }
        if !tracks.tracks.is_empty() {
            let ids = tracks.ids();
            let names = ids[..ids.len().min(20)].join(", ");
            let rule = format!("must have as many tracks as the scenario has springs, {n}, or --spring TRACK=INDEX for each tip");
            faults.report("tracks", rule, format_args!("{} tracks: {names}", tracks.tracks.len()));
        }
        return Vec::new();
    }
    for (at, (id, spring)) in found.iter().enumerate() {
        if !tracks.ids().contains(&id.as_str()) {
            faults.unknown(tracks, "--spring", id);
        }
        if *spring >= n {
            faults.report("--spring", &rule, spring);
        }
        if found[..at].iter().any(|(other_id, other)| other == spring || other_id == id) {
            faults.report("--spring", "must give each track and each spring once", format_args!("{id}={spring}"));
        }
    }
    found.retain(|(_, spring)| *spring < n);
    found
}

/// The motion of the load at the start.
fn start(load: Option<&Track>, like: &Scenario, limits: &Limits, account: &mut Account) -> Motion {
    let Some(first) = load.and_then(|load| load.samples.first()) else { return like.start };
    if first.time > limits.bridge.max(limits.frame) {
        account
            .add(Note::new(Kind::LeftOut, 1, "pose of the load, first seen too late for the start: that of the scenario counts").warning());
        return like.start;
    }
    let heading = first.heading.unwrap_or(like.start.pose.heading);
    Motion { pose: Pose { position: first.position, heading }, ..like.start }
}

/// The path of one attachment.
fn path(spring: usize, attachment: &Attachment) -> TipPath {
    let mut waypoints: Vec<Waypoint> = Vec::new();
    for place in attachment.places.iter().chain(&attachment.release) {
        add(&mut waypoints, Waypoint { time: place.time, position: place.position });
    }
    TipPath { spring, waypoints, release: attachment.release.map(|release| release.time) }
}

/// Adds a point to a path. Of a tip at rest only the first and the last point are kept.
fn add(waypoints: &mut Vec<Waypoint>, point: Waypoint) {
    match waypoints.as_mut_slice() {
        [.., before, last] if before.position == point.position && last.position == point.position => last.time = point.time,
        _ => waypoints.push(point),
    }
}
