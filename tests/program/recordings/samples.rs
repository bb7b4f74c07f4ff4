//! A recording in the form of every tracker, made from the formats' documentation and from a run of
//! `examples/recordings/ants.json`. The files stand beside that scene; `COHAUL_REWRITE=1` writes
//! them anew. Pixels are 0.1 mm, and the image has its origin 400 and 700 of them off.

use std::collections::BTreeMap;
use std::fmt::Write;

use cohaul_recordings::account::Account;
use cohaul_recordings::tracks::export::write_tracks;
use cohaul_recordings::tracks::{Reading, TrackFormat, Tracks, Units, read};

use crate::{root, scene, tips_of, tracks_of};

const FOLDER: &str = "examples/recordings";
const FPS: f64 = 50.0;
const PIXEL: f64 = 1e-4;

/// Pose of the load and both tips in each frame (m, rad).
struct Frame {
    time: f64,
    load: [f64; 3],
    tips: [[f64; 2]; 2],
}

fn frames() -> Vec<Frame> {
    let mut found: BTreeMap<u64, Frame> = BTreeMap::new();
    for line in tips_of(&scene("examples/recordings/ants.json")).lines().skip(1) {
        let cells: Vec<f64> = line.split(',').take(7).map(|cell| cell.parse().unwrap()).collect();
        let number = cells[0] * FPS;
        // Tips that turn between two frames have rows of their own.
        if (number - number.round()).abs() > 1e-6 {
            continue;
        }
        let load = [cells[2], cells[3], cells[4]];
        let frame = found.entry(number.round() as u64).or_insert(Frame { time: number.round() / FPS, load, tips: [[0.0; 2]; 2] });
        frame.tips[cells[1] as usize] = [cells[5], cells[6]];
    }
    found.into_values().collect()
}

/// A place in pixels of the image, to a thousandth, as trackers write it.
fn pixels([x, y]: [f64; 2]) -> String {
    format!("{:.3},{:.3}", 400.0 + x / PIXEL, 700.0 - y / PIXEL)
}

/// Marks on the load: 15 mm before and behind its origin.
fn marks([x, y, heading]: [f64; 3]) -> [[f64; 2]; 2] {
    [-0.015, 0.015].map(|along| [x + along * heading.cos(), y + along * heading.sin()])
}

/// All files with their content.
fn files() -> Vec<(&'static str, String)> {
    let frames = frames();
    let lost = |at: usize, tip: usize| (at + 7 * tip) % 40 == 11;
    let mut deeplabcut = String::new();
    let parts = ["ant0", "ant1", "rear", "front"];
    for (name, cell) in [("scorer", None), ("bodyparts", Some(parts)), ("coords", None)] {
        let cells = parts.iter().enumerate().flat_map(|(at, _)| match (name, cell) {
            ("scorer", _) => ["generated"; 3],
            (_, Some(parts)) => [parts[at]; 3],
            _ => ["x", "y", "likelihood"],
        });
        writeln!(deeplabcut, "{name},{}", cells.collect::<Vec<_>>().join(",")).unwrap();
    }
    let mut several = deeplabcut.replace(
        "bodyparts,ant0,ant0,ant0,ant1,ant1,ant1,rear,rear,rear,front,front,front",
        concat!(
            "individuals,ant0,ant0,ant0,ant1,ant1,ant1,box,box,box,box,box,box\n",
            "bodyparts,jaw,jaw,jaw,jaw,jaw,jaw,rear,rear,rear,front,front,front"
        ),
    );
    let mut sleap = "track,frame_idx,instance.score,jaw.x,jaw.y,jaw.score\n".to_owned();
    let mut wide = "time,x1,y1,x2,y2\n".to_owned();
    let mut tidy = "frame,time,individual,x,y,probability\n".to_owned();
    let mut tracktor = ",frame,pos_x,pos_y,id\n".to_owned();
    let mut trex = ["frame,missing,time,X (cm),Y (cm),X#wcentroid (cm),Y#wcentroid (cm),ANGLE\n"; 2].map(str::to_owned);
    let mut swistrack = ["%Frame Number\tImage Center x\tImage Center y\tWorld Center x\tWorld Center y\tArea\tOrientation\tCompactness\n";
        2]
        .map(str::to_owned);
    let mut table = "frame;ant;x [mm];y [mm];confidence\n".to_owned();
    for (at, frame) in frames.iter().enumerate() {
        let [rear, front] = marks(frame.load);
        let places = [frame.tips[0], frame.tips[1], rear, front];
        let cells = places.map(|place| format!("{},0.97", pixels(place))).join(",");
        // A lost tip has a place of little worth.
        let doubtful = if lost(at, 0) { format!("55.000,66.000,0.03,{}", cells.splitn(4, ',').last().unwrap()) } else { cells };
        writeln!(deeplabcut, "{at},{doubtful}").unwrap();
        writeln!(several, "{at},{doubtful}").unwrap();
        write!(wide, "{:.4}", frame.time).unwrap();
        for (tip, place) in frame.tips.iter().enumerate() {
            let text = pixels(*place);
            let lost = lost(at, tip);
            write!(wide, ",{}", if lost { "nan,nan" } else { &text }).unwrap();
            let empty = if lost { "," } else { &text };
            writeln!(tidy, "{at},{:.4},{},{empty},0.98", frame.time, tip + 1).unwrap();
            let [x, y] = [0.04 + place[0], 0.07 - place[1]].map(|metres| 100.0 * metres);
            let centimetres = if lost { "inf,inf,inf,inf".to_owned() } else { format!("{x:.5},{y:.5},{x:.5},{y:.5}") };
            writeln!(trex[tip], "{at},{},{:.4},{centimetres},0.5", u8::from(lost), frame.time).unwrap();
            if !lost {
                writeln!(sleap, "ant_{tip},{at},0.95,{text},0.9").unwrap();
                writeln!(tracktor, "{},{at}.0,{text},{tip}.0", 2 * at + tip).unwrap();
                writeln!(swistrack[tip], "{at}\t{}\t0\t0\t934\t-0.694655\t0.354844", text.replace(',', "\t")).unwrap();
                let [x, y] = place.map(|metres| format!("{:.4}", 1e3 * metres).replace('.', ","));
                writeln!(table, "{at};{tip};{x};{y};0,9").unwrap();
            }
        }
        wide.push('\n');
    }
    let [trex0, trex1] = trex;
    let [swistrack0, swistrack1] = swistrack;
    vec![
        ("deeplabcut.csv", deeplabcut),
        ("deeplabcut-animals.csv", several),
        ("sleap.csv", sleap),
        ("idtracker.csv", wide),
        ("idtracker-tidy.csv", tidy),
        ("tracktor.csv", tracktor),
        ("trex_fish0.csv", trex0),
        ("trex_fish1.csv", trex1),
        ("swistrack-0.txt", swistrack0),
        ("swistrack-1.txt", swistrack1),
        ("table.csv", table),
    ]
}

/// Each recording: its files, its format and the names of both tips.
const RECORDINGS: [(&[&str], TrackFormat, [&str; 2]); 9] = [
    (&["deeplabcut.csv"], TrackFormat::DeepLabCut, ["ant0", "ant1"]),
    (&["deeplabcut-animals.csv"], TrackFormat::DeepLabCut, ["ant0.jaw", "ant1.jaw"]),
    (&["sleap.csv"], TrackFormat::Sleap, ["ant_0.jaw", "ant_1.jaw"]),
    (&["idtracker.csv"], TrackFormat::IdTracker, ["1", "2"]),
    (&["idtracker-tidy.csv"], TrackFormat::IdTracker, ["1", "2"]),
    (&["tracktor.csv"], TrackFormat::Tracktor, ["0", "1"]),
    (&["trex_fish0.csv", "trex_fish1.csv"], TrackFormat::TRex, ["fish0", "fish1"]),
    (&["swistrack-0.txt", "swistrack-1.txt"], TrackFormat::SwisTrack, ["swistrack-0", "swistrack-1"]),
    (&["table.csv"], TrackFormat::Table, ["0", "1"]),
];

#[test]
fn the_samples_are_those_that_are_generated() {
    for (name, text) in files() {
        let path = root::root().join(FOLDER).join(name);
        if std::env::var_os("COHAUL_REWRITE").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        let stored = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(stored == text, "{name}: run this test with COHAUL_REWRITE=1");
    }
}

/// Each format is known by itself, and gives both tips to the rounding of its numbers.
#[test]
fn every_format_gives_the_same_tips_and_is_equal_after_export() {
    let (frames, all) = (frames(), files());
    for (names, format, ids) in RECORDINGS {
        let texts: Vec<&String> = names.iter().map(|name| &all.iter().find(|(other, _)| other == name).unwrap().1).collect();
        for text in &texts {
            assert_eq!(TrackFormat::of(text.as_bytes()), Ok(format), "{names:?}");
        }
        let units = Units {
            fps: Some(FPS),
            scale: Some(PIXEL),
            min_confidence: Some(0.5),
            origin: format.is_of_images().then_some([400.0 * PIXEL, -700.0 * PIXEL]),
            ..Units::default()
        };
        let readings: Vec<Reading> = names.iter().zip(&texts).map(|(file, text)| Reading { file, bytes: text.as_bytes() }).collect();
        let mut account = Account::default();
        let tracks = read(&readings, None, &units, &mut account).unwrap_or_else(|error| panic!("{names:?}: {error}"));
        for (tip, id) in ids.iter().enumerate() {
            let track = tracks.tracks.iter().find(|track| track.id == *id).unwrap_or_else(|| panic!("{names:?}: {:?}", tracks.ids()));
            assert!((frames.len() - 8..=frames.len()).contains(&track.samples.len()), "{names:?}: {}", track.samples.len());
            for sample in &track.samples {
                let frame = &frames[(sample.time * FPS).round() as usize];
                let distance = (sample.position - cohaul::math::Vec2::from(frame.tips[tip])).norm();
                // Half a thousandth of a pixel on each axis.
                assert!(distance < 0.8e-3 * PIXEL && (sample.time - frame.time).abs() < 1e-12, "{names:?} {id}: {distance}");
            }
        }
        let mut table = Vec::new();
        write_tracks(&tracks, &mut table).unwrap();
        let (again, _) = tracks_of(std::str::from_utf8(&table).unwrap(), &Units::default()).unwrap_or_else(|error| panic!("{error}"));
        assert_equal(&tracks, &again, names[0]);
    }
}

fn assert_equal(one: &Tracks, other: &Tracks, name: &str) {
    assert_eq!(one.frames, other.frames, "{name}");
    assert_eq!(one.ids(), other.ids(), "{name}");
    for (one, other) in one.tracks.iter().zip(&other.tracks) {
        assert_eq!(one, other, "{name}");
    }
    assert_eq!(one, other, "{name}");
}

/// Tips as the project writes them, and as a calibration reads them, stay the same.
#[test]
fn own_tables_of_tips_are_equal_after_export() {
    let text = tips_of(&scene("scenarios/analytic/release-jump.json"));
    let (tracks, _) = tracks_of(&text, &Units::default()).unwrap_or_else(|error| panic!("{error}"));
    assert!(tracks.load.is_some() && tracks.are_springs && tracks.tracks.iter().any(|track| !track.releases.is_empty()));
    let mut table = Vec::new();
    write_tracks(&tracks, &mut table).unwrap();
    let (again, _) = tracks_of(std::str::from_utf8(&table).unwrap(), &Units::default()).unwrap_or_else(|error| panic!("{error}"));
    assert_equal(&tracks, &again, "tracks");
    let mut tips = Vec::new();
    assert_eq!(cohaul_recordings::tracks::export::write_tips(&tracks, &mut tips).unwrap(), 0);
    let (tips, _) = tracks_of(std::str::from_utf8(&tips).unwrap(), &Units::default()).unwrap_or_else(|error| panic!("{error}"));
    assert_equal(&tracks, &tips, "tips");
}
