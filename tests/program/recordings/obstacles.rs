//! Recorded obstacles: what is put right of their paths, and what is told of them.

use cohaul::math::Pose;
use cohaul_recordings::account::{Account, Kind};
use cohaul_recordings::import::{Asked, Import, import};
use cohaul_recordings::repair::Bounds;
use cohaul_recordings::scene::Roles;
use cohaul_recordings::tracks::Reading;

use crate::root;

const SPEED: f64 = 0.05;
const LAST: usize = 200;

/// A place that a camera of 25 frames a second sees of the pusher: x (m) and heading (rad).
type Seen = Option<(f64, Option<f64>)>;

/// The robots at rest, and a pusher that drives to the load.
fn recording(pusher: impl Fn(usize, f64) -> Seen) -> String {
    let mut text = "frame,robot,x_m,y_m,angle_rad\n".to_owned();
    for frame in 0..=LAST {
        let x = -0.5 + SPEED * frame as f64 / 25.0;
        text += &format!("{frame},red,0.32,0.16,0\n{frame},green,0.32,-0.04,0\n");
        if let Some((x, heading)) = pusher(frame, x) {
            text += &format!("{frame},blue,{x},0,{}\n", heading.map_or_else(String::new, |heading| heading.to_string()));
        }
    }
    text
}

fn read(text: &str, bounds: Bounds, roles: &[(&str, &str)]) -> Result<(Vec<(f64, Pose)>, Account), String> {
    let like = std::fs::read(root::root().join("examples/recordings/doorway.json")).unwrap();
    let own = |(track, obstacle): &(&str, &str)| ((*track).to_owned(), (*obstacle).to_owned());
    let springs = vec![("red".to_owned(), 0), ("green".to_owned(), 1)];
    let mut asked = Asked { bounds, ..Asked::default() };
    asked.roles = Roles { springs, load: Vec::new(), obstacles: roles.iter().map(own).collect() };
    asked.units.fps = Some(25.0);
    let files = [Reading { file: "robots.csv", bytes: text.as_bytes() }];
    let found = import(&files, Some(Reading { file: "doorway.json", bytes: &like }), &asked);
    let Import { scenario, account, .. } = found.map_err(|error| error.to_string())?;
    Ok((scenario.system.world.obstacles[2].path.waypoints.clone(), account))
}

fn pushed(pusher: impl Fn(usize, f64) -> Seen) -> (Vec<(f64, Pose)>, Account) {
    read(&recording(pusher), Bounds::default(), &[("blue", "pusher")]).unwrap_or_else(|error| panic!("{error}"))
}

/// Largest distance of a path from the true one (m).
fn off(path: &[(f64, Pose)]) -> f64 {
    path.iter().map(|(time, pose)| (pose.position.x - (-0.5 + SPEED * time)).abs()).fold(0.0, f64::max)
}

fn warns(account: &Account, words: &str) -> bool {
    account.notes.iter().any(|note| note.is_warning && note.text.contains(words))
}

#[test]
fn headings_that_were_not_seen_lie_between_their_neighbours() {
    let (path, account) = pushed(|frame, x| Some((x, (frame % 2 == 0).then_some(0.01 * frame as f64))));
    for (time, pose) in &path {
        assert!((pose.heading - 0.25 * time).abs() < 1e-9, "{time}: {}", pose.heading);
    }
    assert!(account.notes.iter().any(|note| note.count == LAST / 2 && note.text.contains("headings of an obstacle that were not seen")));
    // Before the first and after the last one it stays.
    let (path, _) = pushed(|frame, x| Some((x, (50..=100).contains(&frame).then_some(1.0 + 0.001 * frame as f64))));
    assert!((path[0].1.heading - 1.05).abs() < 1e-12 && (path[LAST].1.heading - 1.1).abs() < 1e-12);
    // Without any, the obstacle keeps that of its scene.
    let (path, account) = pushed(|_, x| Some((x, None)));
    assert!(path.iter().all(|(_, pose)| pose.heading == 0.0) && account.count(Kind::NotSeen) == 0, "{}", account.text());
}

#[test]
fn an_obstacle_that_is_seen_late_or_lost_for_good_is_named() {
    let (path, account) = pushed(|frame, x| (frame >= 20).then_some((x, None)));
    assert!(warns(&account, "first seen after the start") && path[0].0 == 0.8, "{}", account.text());
    let (_, account) = pushed(|frame, x| (frame < 75).then_some((x, None)));
    assert!(warns(&account, "not seen up to the end"), "{}", account.text());
    let (_, account) = pushed(|frame, x| (frame != 40).then_some((x, None)));
    assert!(!warns(&account, "obstacle") && account.count(Kind::Bridged) == 1, "{}", account.text());
}

#[test]
fn obstacles_are_put_right_as_tips_are() {
    let (path, account) = pushed(|frame, x| Some((if frame == 100 { x + 0.45 } else { x }, None)));
    assert!(account.count(Kind::Jumps) == 1 && off(&path) < 1e-9, "{}: {}", off(&path), account.text());
    let (path, account) = pushed(|frame, x| Some((if frame >= 100 { x - 0.3 } else { x }, None)));
    assert!(account.count(Kind::Steps) == 1 && warns(&account, "beyond") && off(&path) > 0.29, "{}", account.text());
    // Red and blue swap their names for ten frames.
    let text = recording(|_, x| Some((x, None)));
    let swapped: Vec<String> = text
        .lines()
        .map(|line| match line.split_once(',').and_then(|(frame, rest)| Some((frame.parse::<usize>().ok()?, rest))) {
            Some((frame, rest)) if (100..110).contains(&frame) && rest.starts_with("red") => format!("{frame},blue{}", &rest[3..]),
            Some((frame, rest)) if (100..110).contains(&frame) && rest.starts_with("blue") => format!("{frame},red{}", &rest[4..]),
            _ => line.to_owned(),
        })
        .collect();
    let (path, account) = read(&(swapped.join("\n") + "\n"), Bounds::default(), &[("blue", "pusher")]).unwrap();
    assert!(account.count(Kind::Swaps) > 0 && off(&path) < 1e-9, "{}: {}", off(&path), account.text());
    let (_, account) = pushed(|frame, x| Some((x, Some(if frame == 60 { 3.0 } else { 0.0 }))));
    assert!(warns(&account, "by more than a quarter"), "{}", account.text());
}

/// The noise of one track is not hidden by quiet ones.
#[test]
fn the_loudest_track_decides_what_is_said_of_noise() {
    let mut draws = crate::draws::Draws::new(3);
    let noise: Vec<f64> =
        (0..=LAST).map(|_| 1e-3 * (-2.0 * draws.unit().ln()).sqrt() * (std::f64::consts::TAU * draws.unit()).cos()).collect();
    let (_, account) = pushed(|frame, x| Some((x + noise[frame], None)));
    let note = account.notes.iter().find(|note| note.kind == Kind::Noise).unwrap_or_else(|| panic!("{}", account.text()));
    // Of 200 values, to three standard errors of a median of overlapping differences.
    assert!(note.is_warning && note.largest.is_some_and(|largest| (0.6e-3..1.4e-3).contains(&largest)), "{}", account.text());
}

#[test]
fn an_obstacle_has_one_track_and_options_belong_to_their_files() {
    let text = recording(|_, x| Some((x, None))).replace("green", "pink");
    let refused = |roles: &[(&str, &str)]| read(&text, Bounds::default(), roles).unwrap_err();
    let error = refused(&[("blue", "pusher"), ("pink", "pusher")]);
    assert!(error.contains("--obstacle: must give each obstacle once, found pusher"), "{error}");
    let error = |asked: &Asked| import(&[Reading { file: "robots.csv", bytes: text.as_bytes() }], None, asked).unwrap_err().to_string();
    let mut asked = Asked { onto: Some("pusher".to_owned()), ..Asked::default() };
    asked.units.min_confidence = Some(25.0);
    let found = error(&asked);
    assert!(
        found.contains("--onto: is for drawings, found a recording") && found.contains("--min-confidence: must be from 0 to 1, found 25"),
        "{found}"
    );
}
