//! A scenario of prescribed tips from a recording of tips, by a camera or by `cohaul run --tips`.

use crate::calibrate::{Recording, Sample, Tip};
use cohaul::math::Vec2;
use cohaul::model::Motion;
use cohaul::scenario::{Drive, Scenario, ScenarioError, TipPath, Waypoint};

/// Reason why a recording makes no scenario.
#[derive(Debug, thiserror::Error)]
pub enum FromTipsError {
    /// The tips are in the frames of their roots.
    #[error("{0}: must have tips in world axes, columns tip_x_m and tip_y_m, found tips in the frames of their roots")]
    InRoot(String),
    /// The table or the scenario breaks rules.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
}

/// The tips in the table `text` of the file `name`, on the load, ground, springs and obstacles of
/// the scenario `like`.
///
/// Each spring is attached from its first row until its row with the event `release`. In a table
/// without such a column it is released, where it was last, at the first frame without it. The load
/// starts as in `like`, at the recorded pose if there is one of time 0. The duration is that of
/// `like` if it has prescribed tips, and otherwise the end of the recording.
///
/// # Errors
/// When the table is no recording in world axes of springs of `like`, or the result breaks a rule.
pub fn scenario_from_tips(text: &str, name: &str, like: &Scenario) -> Result<Scenario, FromTipsError> {
    let n_springs = like.system.springs.len();
    // Springs without rest length are as long as they are stretched.
    let scale = like.system.springs.iter().map(|spring| spring.rest_length).fold(like.system.load.radius, f64::max);
    let (Recording { samples }, releases) = Recording::with_releases(text, name, Some(n_springs), scale)?;
    if samples.iter().any(|sample| matches!(sample.tip, Tip::InRoot(_))) {
        return Err(FromTipsError::InRoot(name.to_owned()));
    }
    let start = samples.iter().find_map(|sample| match sample.tip {
        Tip::InWorld { load, .. } if sample.time == 0.0 => Some(Motion { pose: load, ..like.start }),
        _ => None,
    });
    let last = samples.iter().chain(releases.iter().flatten()).map(|sample| sample.time).fold(0.0, f64::max);
    let made = Scenario {
        name: format!("{}, recorded tips", like.name),
        duration: if matches!(like.drive, Drive::Tips(_)) { like.duration } else { last },
        start: start.unwrap_or(like.start),
        drive: Drive::Tips(paths(n_springs, &samples, releases.as_deref())),
        ..like.clone()
    };
    Ok(made.expanded().checked(name)?)
}

/// The attachments of all springs, one after another.
fn paths(n_springs: usize, samples: &[Sample], releases: Option<&[Sample]>) -> Vec<TipPath> {
    let mut frames: Vec<f64> = samples.iter().map(|sample| sample.time).collect();
    frames.dedup();
    let of_spring = |spring: usize| {
        let own = |samples: &[Sample]| samples.iter().filter(|sample| sample.spring == spring).map(waypoint).collect::<Vec<_>>();
        let releases = releases.map_or_else(|| missing(&own(samples), &frames), own);
        split(spring, &own(samples), &releases)
    };
    (0..n_springs).flat_map(of_spring).collect()
}

fn waypoint(sample: &Sample) -> Waypoint {
    let (Tip::InWorld { tip: position, .. } | Tip::InRoot(position)) = sample.tip;
    Waypoint { time: sample.time, position }
}

/// Releases at the first frames without the spring, where it was last.
fn missing(seen: &[Waypoint], frames: &[f64]) -> Vec<Waypoint> {
    let next_frame = |time: f64| frames.get(frames.partition_point(|frame| *frame <= time)).copied();
    let released = |(at, last): (usize, &Waypoint)| {
        let time = next_frame(last.time)?;
        (seen.get(at + 1).is_none_or(|next| next.time > time)).then_some(Waypoint { time, ..*last })
    };
    seen.iter().enumerate().filter_map(released).collect()
}

/// Paths of one spring: each ends at a release, and the next begins at that instant or later.
fn split(spring: usize, seen: &[Waypoint], releases: &[Waypoint]) -> Vec<TipPath> {
    let (mut paths, mut rest) = (Vec::new(), seen);
    for release in releases {
        let (before, after) = rest.split_at(rest.partition_point(|point| point.time < release.time));
        rest = after;
        if !before.is_empty() {
            paths.push(path(spring, before.iter().chain([release]), Some(release.time)));
        }
    }
    if !rest.is_empty() {
        paths.push(path(spring, rest.iter(), None));
    }
    paths
}

/// A path through these points. Of a tip at rest only the first and the last point are kept.
fn path<'a>(spring: usize, points: impl Iterator<Item = &'a Waypoint>, release: Option<f64>) -> TipPath {
    let mut waypoints: Vec<Waypoint> = Vec::new();
    for point in points {
        let rests = |at: &Waypoint| Vec2::eq(&at.position, &point.position);
        match waypoints.as_mut_slice() {
            [.., before, last] if rests(before) && rests(last) => last.time = point.time,
            _ => waypoints.push(*point),
        }
    }
    TipPath { spring, waypoints, release }
}
