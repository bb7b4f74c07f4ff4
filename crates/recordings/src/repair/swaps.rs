//! Two tracks whose names were swapped.

use cohaul::stop;

use super::limits::{Limits, distance};
use crate::account::{Account, Kind, Note};
use crate::tracks::{Sample, Track, Tracks};

/// Gives places back to the track on which they lie. A name jumps to another track while that one
/// jumps to it, or is not seen; both steps are short once the names are exchanged. A track that
/// jumps elsewhere stays as it is.
pub fn undo_swaps(tracks: &mut Tracks, limits: &Limits, account: &mut Account) {
    let n = tracks.tracks.len();
    let mut queue: Vec<(usize, Sample)> = Vec::new();
    for (name, track) in tracks.tracks.iter().enumerate() {
        queue.extend(track.samples.iter().map(|sample| (name, *sample)));
    }
    queue.sort_by(|a, b| a.1.time.total_cmp(&b.1.time));
    // The track to which the places of each name belong, and what was last seen of each track.
    let mut owner: Vec<usize> = (0..n).collect();
    let mut last: Vec<Option<Sample>> = vec![None; n];
    let mut sorted: Vec<Vec<Sample>> = vec![Vec::new(); n];
    let mut found = Vec::new();
    for frame in queue.chunk_by(|a, b| a.1.time == b.1.time) {
        stop::point();
        exchange(frame, &mut owner, &last, limits, |one, other| {
            let [one, other] = [one, other].map(|track| tracks.tracks[track].id.as_str());
            found.push((format!("{one} and {other}"), frame[0].1.time));
        });
        for (name, sample) in frame {
            last[owner[*name]] = Some(*sample);
            sorted[owner[*name]].push(*sample);
        }
    }
    if !found.is_empty() {
        tracks.tracks.iter_mut().zip(sorted).for_each(|(track, samples): (&mut Track, _)| track.samples = samples);
    }
    let text = "exchanges of the names of two tracks, put right";
    account.add(Note::new(Kind::Swaps, found.len(), text).sized(None, Some(limits.jump), "m").at(found));
}

/// Exchanges the owners of names in one frame, where both steps become short by it.
fn exchange(
    frame: &[(usize, Sample)],
    owner: &mut [usize],
    last: &[Option<Sample>],
    limits: &Limits,
    mut exchanged: impl FnMut(usize, usize),
) {
    let is_near =
        |sample: &Sample, track: usize| last[track].is_some_and(|last| distance(&last, sample) <= limits.step(sample.time - last.time));
    // Beyond the bridge nothing is known about where a track has gone.
    let is_known = |sample: &Sample, track: usize| last[track].is_some_and(|last| limits.is_bridged(last.time, sample.time));
    let jumps: Vec<usize> = (0..frame.len())
        .filter(|at| is_known(&frame[*at].1, owner[frame[*at].0]) && !is_near(&frame[*at].1, owner[frame[*at].0]))
        .collect();
    for at in jumps {
        let (name, sample) = &frame[at];
        if is_near(sample, owner[*name]) {
            continue;
        }
        let other = (0..owner.len()).find(|other| {
            let track = owner[*other];
            let seen = frame.iter().find(|(seen, _)| seen == other);
            let fits = is_known(sample, track) && is_near(sample, track);
            let other_fits = seen.is_none_or(|(_, seen)| !is_near(seen, track) && is_near(seen, owner[*name]));
            other != name && fits && other_fits
        });
        if let Some(other) = other {
            exchanged(owner[*name].min(owner[other]), owner[*name].max(owner[other]));
            owner.swap(*name, other);
        }
    }
}
