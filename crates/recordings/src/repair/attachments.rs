//! Tracks of tips as attachments: gaps that are bridged, releases and grasps.

use super::limits::Limits;
use crate::account::{Account, Kind, Note};
use crate::tracks::{Sample, Track};

/// An ant or a robot on the tip of a spring, from its grasp to its release.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attachment {
    /// Places of the tip, in the order of time, one at least.
    pub places: Vec<Sample>,
    /// Where and when the tip is let go; `None` for never.
    pub release: Option<Sample>,
}

/// What was done to all tracks, for the notes.
#[derive(Default)]
struct Done {
    bridged: Vec<(String, f64)>,
    longest: f64,
    inferred: Vec<(String, f64)>,
    shortest: Option<f64>,
    grasps: Vec<(String, f64)>,
    stated: Vec<(String, f64)>,
}

/// The attachments of each track, one after another. A tip that is not seen for at most the bridge
/// stays attached, on a straight line between its places. One that is not seen for longer is let go
/// in the first frame without it, where it was last.
///
/// A tip that is first seen within the bridge after the first of `frames` was attached from there
/// on, and in the same way at the end; there it goes on along its first or last step.
pub fn attachments(tracks: &[Track], frames: &[f64], limits: &Limits, account: &mut Account) -> Vec<Vec<Attachment>> {
    let mut done = Done::default();
    let found = tracks.iter().map(|track| of_track(track, frames, limits, &mut done)).collect();
    let Done { bridged, longest, inferred, shortest, grasps, stated } = done;
    account.add(Note::new(Kind::Releases, stated.len(), "releases that the recording states").at(stated));
    let text = "gaps bridged by a straight line: the tips stay attached";
    account.add(Note::new(Kind::Bridged, bridged.len(), text).sized(Some(longest), Some(limits.bridge), "s").at(bridged));
    let text = "releases inferred from longer gaps, in the first frame without the tip";
    let text = shortest.map_or_else(String::new, |gap| format!("{text}; the shortest gap is {gap:.3} s"));
    account.add(Note::new(Kind::ReleasesInferred, inferred.len(), text).sized(None, Some(limits.bridge), "s").at(inferred));
    account.add(Note::new(Kind::Grasps, grasps.len(), "grasps after the start, in the first frame with the tip").at(grasps));
    found
}

fn of_track(track: &Track, frames: &[f64], limits: &Limits, done: &mut Done) -> Vec<Attachment> {
    let (Some(start), Some(end)) = (frames.first(), frames.last()) else { return Vec::new() };
    let mut found: Vec<Attachment> = Vec::new();
    let mut open = Attachment::default();
    let mut releases = track.releases.iter().peekable();
    for sample in &track.samples {
        while let Some(release) = releases.next_if(|release| release.time <= sample.time) {
            close(&mut open, *release, &mut found);
            done.stated.push((track.id.clone(), release.time));
        }
        if let Some(last) = open.places.last().copied().filter(|last| limits.is_gap(last.time, sample.time)) {
            let gap = sample.time - last.time;
            if limits.is_bridged(last.time, sample.time) {
                done.bridged.push((track.id.clone(), last.time));
                done.longest = done.longest.max(gap);
            } else {
                infer(&mut open, &last, gap, frames, limits, &mut found);
                done.inferred.push((track.id.clone(), found.last().and_then(|found| found.release).map_or(last.time, |at| at.time)));
                done.shortest = Some(done.shortest.map_or(gap, |shortest: f64| shortest.min(gap)));
            }
        }
        open.places.push(*sample);
    }
    for release in releases {
        close(&mut open, *release, &mut found);
        done.stated.push((track.id.clone(), release.time));
    }
    let last = open.places.last().copied();
    match last {
        Some(last) if limits.is_bridged(last.time, *end) => {
            if limits.is_gap(last.time, *end) || last.time < *end {
                extend(&mut open.places, *end, false);
                done.bridged.push((track.id.clone(), last.time));
                done.longest = done.longest.max(end - last.time);
            }
            found.push(open);
        }
        Some(last) => {
            infer(&mut open, &last, end - last.time, frames, limits, &mut found);
            done.inferred.push((track.id.clone(), last.time));
            done.shortest = Some(done.shortest.map_or(end - last.time, |shortest| shortest.min(end - last.time)));
        }
        None => {}
    }
    attach_at_the_start(track, &mut found, *start, limits, done);
    found
}

/// Attaches the first tip from the start, if it is seen soon after, and notes all other grasps.
fn attach_at_the_start(track: &Track, found: &mut [Attachment], start: f64, limits: &Limits, done: &mut Done) {
    let is_stated = !track.releases.is_empty();
    if let Some(first) = found.first_mut() {
        let time = first.places[0].time;
        if time > start && !is_stated && limits.is_bridged(start, time) {
            extend(&mut first.places, start, true);
            done.bridged.push((track.id.clone(), start));
            done.longest = done.longest.max(time - start);
        }
    }
    let later = found.iter().map(|attachment| attachment.places[0].time).filter(|time| *time > start);
    done.grasps.extend(later.map(|time| (track.id.clone(), time)));
}

/// Adds a place at `time` (s), before the first or after the last one, on the line through the two
/// places that are nearest.
fn extend(places: &mut Vec<Sample>, time: f64, is_before: bool) {
    let (near, next) = match (&places[..], is_before) {
        ([near, next, ..], true) | ([.., next, near], false) => (*near, *next),
        ([only], _) => (*only, *only),
        ([], _) => return,
    };
    let share = if next.time == near.time { 0.0 } else { (time - near.time) / (next.time - near.time) };
    let sample = Sample { time, position: near.position + share * (next.position - near.position), ..near };
    places.insert(if is_before { 0 } else { places.len() }, sample);
}

/// Ends an attachment by a release that the recording states. Without an attachment it means
/// nothing.
fn close(open: &mut Attachment, release: Sample, found: &mut Vec<Attachment>) {
    let is_later = open.places.first().is_some_and(|first| release.time > first.time);
    let mut ended = std::mem::take(open);
    if is_later {
        ended.places.retain(|place| place.time < release.time);
        ended.release = Some(release);
        found.push(ended);
    }
}

/// Ends an attachment in the first frame after its last place, or after a frame interval.
fn infer(open: &mut Attachment, last: &Sample, gap: f64, frames: &[f64], limits: &Limits, found: &mut Vec<Attachment>) {
    let next = frames.get(frames.partition_point(|frame| *frame <= last.time)).copied();
    let after = last.time + limits.frame.min(gap);
    let time = next.filter(|next| !limits.is_gap(last.time, *next)).unwrap_or(after);
    let mut ended = std::mem::take(open);
    ended.release = Some(Sample { time, ..*last });
    found.push(ended);
}
