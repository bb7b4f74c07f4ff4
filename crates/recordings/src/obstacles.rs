//! Recorded obstacles: paths with headings, and notes on what was not seen.

use std::f64::consts::FRAC_PI_2;

use cohaul::math::Pose;
use cohaul::model::ObstaclePath;

use crate::account::{Account, Kind, Note};
use crate::repair::Limits;
use crate::tracks::Sample;

/// An obstacle of which each place has a heading: those that were not seen are straight between the
/// ones before and after them, and all are `otherwise` (rad) if none was seen.
pub fn with_headings(name: &str, samples: &mut [Sample], otherwise: f64, account: &mut Account) {
    let seen: Vec<(f64, f64)> = samples.iter().filter_map(|sample| Some((sample.time, sample.heading?))).collect();
    let mut missing = Vec::new();
    for sample in samples.iter_mut().filter(|sample| sample.heading.is_none()) {
        let after = seen.partition_point(|(time, _)| *time <= sample.time);
        sample.heading = Some(match (seen[..after].last(), seen.get(after)) {
            (Some((from, a)), Some((to, b))) => a + (b - a) * (sample.time - from) / (to - from),
            (Some((_, only)), None) | (None, Some((_, only))) => *only,
            (None, None) => otherwise,
        });
        missing.push((name.to_owned(), sample.time));
    }
    if !seen.is_empty() {
        let text = "headings of an obstacle that were not seen, straight between those before and after";
        account.add(Note::new(Kind::NotSeen, missing.len(), text).at(missing));
    }
}

/// The path of an obstacle along its places, of which each has a heading; `frames` are the times of
/// all frames (s).
pub fn path(name: &str, samples: &[Sample], frames: &[f64], limits: &Limits, account: &mut Account) -> ObstaclePath {
    let pairs = || samples.windows(2).map(|pair| (&pair[0], &pair[1]));
    let at = |time: f64| (name.to_owned(), time);
    let gaps: Vec<_> = pairs().filter(|(a, b)| limits.is_gap(a.time, b.time)).map(|(a, _)| at(a.time)).collect();
    let longest = pairs().map(|(a, b)| b.time - a.time).fold(0.0, f64::max);
    let text = "gaps in the path of an obstacle, bridged by a straight line";
    let note = Note::new(Kind::Bridged, gaps.len(), text).sized(Some(longest), None, "s").at(gaps);
    account.add(if longest > limits.bridge { note.warning() } else { note });
    for (seen, end, text) in [
        (samples.first(), frames.first(), "obstacle that is first seen after the start: it stands where it was seen first"),
        (samples.last(), frames.last(), "obstacle that is not seen up to the end: it stands where it was seen last"),
    ] {
        let unseen = seen.zip(end).map(|(seen, end)| (seen.time, (seen.time - end).abs()));
        if let Some((time, unseen)) = unseen.filter(|(_, unseen)| *unseen > limits.bridge.max(limits.frame)) {
            account.add(Note::new(Kind::Bridged, 1, text).sized(Some(unseen), Some(limits.bridge), "s").at([at(time)]).warning());
        }
    }
    let turn = |a: &Sample, b: &Sample| Some((b.heading? - a.heading?).abs());
    let turns: Vec<_> = pairs().filter(|(a, b)| turn(a, b).is_some_and(|turn| turn > FRAC_PI_2)).map(|(a, _)| at(a.time)).collect();
    let text = "turns of an obstacle by more than a quarter from place to place: are its headings right?";
    account.add(Note::new(Kind::Steps, turns.len(), text).at(turns).warning());
    let pose = |sample: &Sample| Pose { position: sample.position, heading: sample.heading.unwrap_or(0.0) };
    ObstaclePath { waypoints: samples.iter().map(|sample| (sample.time, pose(sample))).collect() }
}
