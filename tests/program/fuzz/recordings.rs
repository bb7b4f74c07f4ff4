//! Recordings of trackers and drawings.

use cohaul_recordings::account::{Account, Kind};
use cohaul_recordings::drawings::{DrawingFormat, DrawingOptions, into_scenario};
use cohaul_recordings::repair::Bounds;
use cohaul_recordings::scene::{Roles, scenario};
use cohaul_recordings::tracks::export::write_tracks;
use cohaul_recordings::tracks::{Reading, TrackFormat, Units, read};
use cohaul_report::json;

use crate::survey::{Format, survey};

const FOLDER: &str = "examples/recordings";

fn shipped(name: &str) -> Vec<u8> {
    std::fs::read(crate::root::root().join(FOLDER).join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A few rows of a shipped recording: what is changed is then seen.
fn beginning(name: &str) -> Vec<u8> {
    let text = String::from_utf8(shipped(name)).unwrap();
    text.lines().take(30).map(|line| format!("{line}\n")).collect::<String>().into_bytes()
}

/// Reads a recording as the program does. What is accepted is equal after its export, and what was
/// dropped is counted.
fn read_recording(input: &[u8]) -> Result<(), String> {
    let format = TrackFormat::of(input)?;
    let units = Units { fps: Some(50.0), scale: Some(1e-4), min_confidence: Some(0.5), ..Units::default() };
    let mut account = Account::default();
    let tracks = read(&[Reading { file: "tracks.csv", bytes: input }], Some(format), &units, &mut account).map_err(told)?;
    let n_places: usize = tracks.tracks.iter().chain(&tracks.load).map(|track| track.samples.len() + track.releases.len()).sum();
    assert!(account.count(Kind::Read) > 0 && !account.text().contains("NaN"), "{}", account.text());
    let n_dropped = account.count(Kind::NotSeen) + account.count(Kind::LowConfidence) + account.count(Kind::Repeated);
    let n_left_out = account.notes.iter().filter(|note| note.kind == Kind::Moved).count();
    assert!(n_places + n_dropped + n_left_out > 0, "no place, and nothing says why: {}", account.text());
    let mut table = Vec::new();
    write_tracks(&tracks, &mut table).unwrap();
    let again = read(&[Reading { file: "again.csv", bytes: &table }], None, &Units::default(), &mut Account::default());
    assert_eq!(again.map_err(told)?, tracks, "it is equal after its export");
    let like = crate::corpus::scene(&String::from_utf8(shipped("ants.json")).unwrap());
    let ids: Vec<String> = tracks.tracks.iter().take(2).map(|track| track.id.clone()).collect();
    let roles = Roles { springs: ids.into_iter().zip(0..).collect(), ..Roles::default() };
    let bounds = Bounds { smooth: Some(1e-4), ..Bounds::default() };
    let made = scenario(tracks, &roles, &bounds, &like, "tracks.csv", &mut account).map_err(told)?;
    json::check(&account).unwrap_or_else(|error| panic!("{error}"));
    assert!(made.scenario.expanded().checked("again").is_ok());
    Ok(())
}

fn told(error: impl ToString) -> String {
    let told = error.to_string();
    assert!(!told.is_empty(), "a fault has words");
    told
}

fn read_drawing(format: DrawingFormat, input: &[u8]) -> Result<(), String> {
    let like = serde_json::from_slice(&shipped("ants.json")).unwrap();
    let options = DrawingOptions { scale: Some(1e-3), ..DrawingOptions::default() };
    let mut account = Account::default();
    let made = into_scenario("drawing", input, format, &options, (like, None), &mut account).map_err(told)?;
    json::check(&account).unwrap_or_else(|error| panic!("{error}"));
    made.checked("drawing").map_err(told)?;
    assert!(account.count(Kind::Read) > 0, "{}", account.text());
    Ok(())
}

#[test]
fn changed_recordings_are_answered() {
    for (name, files) in [
        ("table", &["table.csv"][..]),
        ("deeplabcut", &["deeplabcut.csv", "deeplabcut-animals.csv"]),
        ("sleap", &["sleap.csv"]),
        ("idtracker", &["idtracker.csv", "idtracker-tidy.csv"]),
        ("trex", &["trex_fish0.csv"]),
        ("tracktor", &["tracktor.csv"]),
        ("swistrack", &["swistrack-0.txt"]),
    ] {
        let texts = files.iter().map(|file| beginning(file)).collect();
        survey(&Format { name, texts, files: Vec::new(), read: read_recording }, 300);
    }
}

#[test]
fn changed_drawings_are_answered() {
    let of = |name: &str| vec![shipped(name)];
    let json = vec![serde_json::from_slice(&shipped("t-block.geojson")).unwrap()];
    let stadium = "0\nLWPOLYLINE\n70\n1\n10\n0\n20\n0\n10\n40\n20\n0\n42\n1\n10\n40\n20\n20\n10\n0\n20\n20\n42\n1\n0\nCIRCLE\n10\n20\n20\n10\n40\n5\n0\nEOF\n";
    let curves = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"80mm\"><g transform=\"rotate(20)\">\
                  <path d=\"M20 20C40 0 60 0 80 20Q90 60 50 70A20 20 0 0 1 20 20Z\"/><circle cx=\"90\" cy=\"60\" r=\"9\" fill=\"none\" stroke=\"red\"/></g></svg>";
    let svg = vec![shipped("t-block.svg"), curves.as_bytes().to_vec()];
    survey(&Format { name: "svg", texts: svg, files: Vec::new(), read: |input| read_drawing(DrawingFormat::Svg, input) }, 300);
    let dxf = vec![shipped("t-block.dxf"), stadium.as_bytes().to_vec()];
    survey(&Format { name: "dxf", texts: dxf, files: Vec::new(), read: |input| read_drawing(DrawingFormat::Dxf, input) }, 300);
    let read = |input: &[u8]| read_drawing(DrawingFormat::GeoJson, input);
    survey(&Format { name: "geojson", texts: of("t-block.geojson"), files: json, read }, 300);
    survey(
        &Format { name: "obj", texts: of("t-block.obj"), files: Vec::new(), read: |input| read_drawing(DrawingFormat::Obj, input) },
        300,
    );
    survey(
        &Format { name: "mjcf", texts: of("t-block.xml"), files: Vec::new(), read: |input| read_drawing(DrawingFormat::Mjcf, input) },
        300,
    );
}
