//! The program, a short scene, and tables as they lie in a folder.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};

/// Four ants for three seconds with a nest so near that some of them arrive: a few milliseconds of
/// work without optimisation.
pub fn scene(room: &Path) -> PathBuf {
    let text = fs::read_to_string(crate::root::root().join("scenarios/paper/four-ants-four-springs.json")).unwrap();
    let mut scene: Value = serde_json::from_str(&text).unwrap();
    scene["duration_s"] = json!(3.0);
    scene["drive"]["preset"] = json!("fitted");
    scene["drive"]["nest_position_m"] = json!([0.012, -0.005]);
    scene["drive"]["start_half_width_m"] = json!(0.04);
    let path = room.join("short.json");
    fs::write(&path, scene.to_string()).unwrap();
    path
}

/// `cohaul sweep SCENE args --out out`, ready to be started.
pub fn command(scene: &Path, args: &[&str], out: &Path) -> Command {
    let mut command = crate::root::cohaul();
    command.arg("sweep").arg(scene).args(args).arg("--out").arg(out);
    command
}

pub fn sweep(scene: &Path, args: &[&str], out: &Path) -> Output {
    command(scene, args, out).output().unwrap()
}

pub fn merge(sources: &[&Path], out: &Path) -> Output {
    let mut command = crate::root::cohaul();
    command.arg("merge").args(sources).arg("--out").arg(out).output().unwrap()
}

/// The sweep, which must end well.
pub fn done(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Standard error of a command that must be refused.
pub fn refused(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stdout.is_empty());
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Bytes of all tables in a folder.
pub fn tables(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let names = ["runs.csv", "groups.csv", "runs.parquet", "figure.svg"];
    let tables: BTreeMap<_, _> = names.iter().filter_map(|name| Some((name.to_string(), fs::read(out.join(name)).ok()?))).collect();
    let expected = if cfg!(feature = "parquet") { 4 } else { 3 };
    assert_eq!(tables.len(), expected, "{}", out.display());
    tables
}

/// Rows of a CSV file, by the names of its columns.
pub fn rows(path: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
