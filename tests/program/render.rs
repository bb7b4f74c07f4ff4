//! `cohaul render`: what is drawn stands where the load is, films have the frames that were asked
//! for, and what fails leaves nothing behind.

#[path = "../common/root.rs"]
mod root;

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::tempdir;

fn cohaul(arguments: &[&str]) -> Command {
    let mut command = Command::from_std(root::cohaul());
    command.args(arguments);
    command
}

/// Width, height and pixels of a PNG.
fn picture(path: &Path) -> (usize, usize, Vec<u8>) {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgba);
    (info.width as usize, info.height as usize, pixels)
}

/// Columns of a picture in which the outline of the quasi-static load is: the first and the last
/// (px). The name of the backend stands above, and has the same colour.
fn outline_columns(path: &Path) -> [f64; 2] {
    let (width, height, pixels) = picture(path);
    let is_outline = |x: usize, y: usize| pixels[4 * (y * width + x)..][..3] == [0x00, 0x72, 0xb2];
    let columns: Vec<usize> = (0..width).filter(|x| (40..height).any(|y| is_outline(*x, y))).collect();
    [columns[0] as f64, columns[columns.len() - 1] as f64]
}

/// The way of the load over its diameter is the same on the picture as in the run.
#[test]
fn the_load_is_drawn_where_it_is() {
    let room = tempdir().unwrap();
    let scene = "scenarios/analytic/centre-pull.json";
    let columns = [0.0, 6.0, 20.0].map(|time: f64| {
        let out = room.path().join(format!("at-{time}.png"));
        cohaul(&["render", scene, "--size", "1200x400", "--at-s", &time.to_string(), "--out", out.to_str().unwrap()]).assert().success();
        outline_columns(&out)
    });
    let run = cohaul(&["run", scene, "--json"]).output().unwrap();
    let run: Value = serde_json::from_slice(&run.stdout).unwrap();
    let way = run["final"]["position_m"][0].as_f64().unwrap();
    let read: Value = serde_json::from_str(&fs::read_to_string(root::root().join(scene)).unwrap()).unwrap();
    let radius = read["load"]["radius_m"].as_f64().unwrap();
    let diameter = columns[0][1] - columns[0][0];
    let shift = columns[2][0] - columns[0][0];
    // Lines are 1.8 px wide, and each of the two ends may be off by one pixel.
    assert!((shift / diameter - way / (2.0 * radius)).abs() < 4.0 / diameter, "{shift} px, {diameter} px, {way} m");
    // Before the pull reaches the slip limit, after 6.7 s, it rests.
    assert_eq!(columns[1], columns[0]);
}

#[test]
fn a_film_has_its_frames() {
    let room = tempdir().unwrap();
    let out = room.path().join("film.gif");
    let arguments = ["render", "scenarios/analytic/release-jump.json", "--from-s", "1", "--to-s", "2", "--rate", "10", "--pace", "0.5"];
    cohaul(&arguments).args(["--size", "200x120", "--backend", "all", "--out"]).arg(&out).assert().success();
    let mut decoder = gif::DecodeOptions::new().read_info(File::open(&out).unwrap()).unwrap();
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!((frame.width, frame.height, frame.delay), (200, 120, 10));
        frames.push(frame.buffer.to_vec());
    }
    // One second of the scene takes two of the film, and both ends are in it.
    assert_eq!(frames.len(), 21);
    // The load waits until the release at 1.5 s and moves then.
    assert!(frames[10] != frames[11] && frames[0] != frames[20]);
}

/// A run that was written is computed again from its manifest.
#[test]
fn a_folder_of_a_run_is_drawn_as_the_run_was() {
    let room = tempdir().unwrap();
    let [run, of_run, of_scene] = ["run", "run.png", "scene.png"].map(|name| room.path().join(name));
    let options = ["--backend", "inertial", "--step-s", "5e-4"];
    let scene = "scenarios/contact/push-aside.json";
    cohaul(&["run", scene, "--out", run.to_str().unwrap()]).args(options).assert().success();
    cohaul(&["render", run.to_str().unwrap(), "--out", of_run.to_str().unwrap()]).assert().success();
    cohaul(&["render", scene, "--out", of_scene.to_str().unwrap()]).args(options).assert().success();
    assert_eq!(picture(&of_run), picture(&of_scene));
    let refused = cohaul(&["render", run.to_str().unwrap(), "--seed", "3", "--out", "x.png"]).assert().code(2);
    assert!(String::from_utf8_lossy(&refused.get_output().stderr).contains("must be left out with a folder"));
}

#[test]
fn what_fails_says_why_and_leaves_nothing() {
    let room = tempdir().unwrap();
    let scene = "scenarios/contact/rebound.json";
    let (gif, mp4) = (room.path().join("a.gif"), room.path().join("a.mp4"));
    let of_gif = gif.to_str().unwrap();
    let cases: [(&[&str], &str); 10] = [
        (&["--out", "a.webp"], "must end in .gif, .png or .mp4"),
        (&["--out", of_gif, "--at-s", "0"], "applies to a .png only"),
        (&["--out", of_gif, "--to-s", "7"], "up to the end at 0.05 s"),
        (&["--out", of_gif, "--from-s", "0.04", "--to-s", "0.01"], "must be in order"),
        (&["--out", of_gif, "--size", "9x9"], "each side from 64 to 4096 px"),
        (&["--out", of_gif, "--rate", "0"], "0"),
        (&["--out", of_gif, "--backend", "bullet"], "bullet"),
        (&["--out", of_gif, "--pace", "1e-9"], "--pace, --rate: must make at most 100000 pictures, found 10000000"),
        (&["--out", of_gif, "--pace", "1e-40"], "must make at most 100000 pictures"),
        (&["--out", of_gif, "--pace", "1e-300"], "must be from 1e-50 to 1e50"),
    ];
    for (arguments, why) in cases {
        let refused = cohaul(&["render", scene]).args(arguments).assert().code(2);
        let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(said.contains(why), "{arguments:?}: {said}");
    }
    // No ffmpeg, and one that fails.
    let refused = cohaul(&["render", scene, "--out", mp4.to_str().unwrap()]).env("PATH", room.path()).assert().code(2);
    assert!(String::from_utf8_lossy(&refused.get_output().stderr).contains("needs ffmpeg on the path"));
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let fake = room.path().join("ffmpeg");
        fs::write(&fake, "#!/bin/sh\necho broken codec >&2\nexit 1\n").unwrap();
        fs::set_permissions(&fake, fs::Permissions::from_mode(0o755)).unwrap();
        let refused = cohaul(&["render", scene, "--out", mp4.to_str().unwrap()]).env("PATH", room.path()).assert().code(5);
        assert!(String::from_utf8_lossy(&refused.get_output().stderr).contains("ffmpeg failed: broken codec"));
        fs::remove_file(&fake).unwrap();
    }
    assert_eq!(fs::read_dir(room.path()).unwrap().count(), 0);
}
