//! Tracks as a table of the project's own form: what is imported again is equal.

use std::io::Write;

use cohaul_report::lines::{Lines, TableError};

use super::track::{Sample, Tracks};

/// Columns of a table of tracks. Headings, confidences and events are empty where there are none,
/// and places in frames in which nothing was seen.
const COLUMNS: [&str; 7] = ["time_s", "track", "x_m", "y_m", "heading_rad", "confidence", "event"];

/// Writes a row for each place, in the order of tracks and times. The second column is `spring` in
/// place of `track` if names are indices of springs; the pose of the load has the name `load`.
///
/// # Errors
/// When `out` fails.
pub fn write_tracks(tracks: &Tracks, out: impl Write) -> Result<(), TableError> {
    let mut table = csv::Writer::from_writer(out);
    let header = COLUMNS.map(|name| if name == "track" && tracks.are_springs { "spring" } else { name });
    table.write_record(header)?;
    let all = || tracks.tracks.iter().chain(&tracks.load);
    for track in all() {
        for (sample, event) in
            track.samples.iter().map(|sample| (sample, "")).chain(track.releases.iter().map(|sample| (sample, "release")))
        {
            let optional = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
            let [time, x, y] = [sample.time, sample.position.x, sample.position.y].map(|value| value.to_string());
            let (heading, confidence) = (optional(sample.heading), optional(sample.confidence));
            let cells = [&time, &track.id, &x, &y, &heading, &confidence].map(String::as_str);
            table.write_record(cells.into_iter().chain([event]))?;
        }
    }
    let mut seen: Vec<f64> = all().flat_map(|track| track.samples.iter().chain(&track.releases)).map(|sample| sample.time).collect();
    seen.sort_by(f64::total_cmp);
    let (Some(first), Some(frame)) = (all().next(), tracks.frames.first()) else { return Ok(()) };
    let unseen = tracks.frames.iter().filter(|frame| seen.binary_search_by(|time| time.total_cmp(frame)).is_err());
    let never = all().filter(|track| track.samples.is_empty() && track.releases.is_empty());
    for (time, id) in unseen.map(|time| (time, &first.id)).chain(never.map(|track| (frame, &track.id))) {
        table.write_record([time.to_string().as_str(), id, "", "", "", "", ""])?;
    }
    table.flush()?;
    Ok(())
}

/// Columns of a table of tips, which `cohaul calibrate` reads too.
pub const TIP_COLUMNS: [&str; 8] = cohaul_report::tips_csv::TIP_COLUMNS;

/// Writes tips of springs with the pose of the load at the same time, as `cohaul run --tips` does.
/// Tips at times without a pose of the load are left out; their number is returned.
///
/// # Errors
/// As [`write_tracks`].
pub fn write_tips(tracks: &Tracks, out: impl Write) -> Result<usize, TableError> {
    let mut lines = Lines::new(out, &TIP_COLUMNS)?;
    let load = tracks.load.as_ref().map_or(&[][..], |load| &load.samples[..]);
    let mut rows: Vec<(usize, &Sample, bool)> = Vec::new();
    for (spring, track) in tracks.tracks.iter().enumerate() {
        rows.extend(track.samples.iter().map(|sample| (spring, sample, false)));
        rows.extend(track.releases.iter().map(|sample| (spring, sample, true)));
    }
    rows.sort_by(|a, b| a.1.time.total_cmp(&b.1.time).then(b.2.cmp(&a.2)).then(a.0.cmp(&b.0)));
    let mut left_out = 0;
    for (spring, sample, is_release) in rows {
        let Ok(at) = load.binary_search_by(|pose| pose.time.total_cmp(&sample.time)) else {
            left_out += 1;
            continue;
        };
        lines.begin()?;
        lines.numbers(&[sample.time])?;
        lines.count(spring);
        let pose = &load[at];
        let heading = pose.heading.unwrap_or(0.0);
        lines.numbers(&[pose.position.x, pose.position.y, heading, sample.position.x, sample.position.y])?;
        if is_release {
            lines.word("release")
        } else {
            lines.nothing(1)
        }
        lines.end();
    }
    lines.finish()?;
    Ok(left_out)
}
