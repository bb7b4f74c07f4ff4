//! Places far off their track for a short time.

use super::limits::{Limits, distance};
use crate::account::{Account, Kind, Note};
use crate::tracks::{Sample, Tracks};

/// Leaves out places from which the track returns within the bridge: the tracker has taken another
/// thing for this one. A step after which the track stays there is kept, and counted.
pub fn leave_out_jumps(tracks: &mut Tracks, limits: &Limits, account: &mut Account) {
    let (mut left_out, mut steps) = (Vec::new(), Vec::new());
    let mut largest: f64 = 0.0;
    for track in tracks.tracks.iter_mut().chain(&mut tracks.load) {
        let mut kept: Vec<Sample> = Vec::with_capacity(track.samples.len());
        let mut at = 0;
        while at < track.samples.len() {
            let sample = track.samples[at];
            let Some(last) = kept.last().filter(|last| distance(last, &sample) > limits.step(sample.time - last.time)) else {
                kept.push(sample);
                at += 1;
                continue;
            };
            let later = &track.samples[at + 1..];
            let mut within = later.iter().take_while(|later| limits.is_bridged(last.time, later.time));
            let back = within.position(|later| distance(last, later) <= limits.step(later.time - last.time));
            match back {
                Some(n) => {
                    left_out.extend(track.samples[at..=at + n].iter().map(|sample| (track.id.clone(), sample.time)));
                    at += n + 1;
                }
                None => {
                    largest = largest.max(distance(last, &sample));
                    steps.push((track.id.clone(), sample.time));
                    kept.push(sample);
                    at += 1;
                }
            }
        }
        track.samples = kept;
    }
    let limit = Some(limits.jump);
    let text = "places off their track for a short time, taken as not seen";
    account.add(Note::new(Kind::Jumps, left_out.len(), text).sized(None, limit, "m").at(left_out));
    let text = "steps beyond the bound, after which the track goes on from there: kept";
    account.add(Note::new(Kind::Steps, steps.len(), text).sized(Some(largest), limit, "m").at(steps).warning());
}
