//! Ten scenes whose tips are lost in 0.5 to 5 % of the rows, jitter, and swap their names.

use cohaul::analysis::compare::{Settings, ThreeWay};
use cohaul::scenario::Scenario;
use cohaul_recordings::account::Kind;
use cohaul_recordings::repair::Bounds;

use crate::draws::Draws;
use crate::{imported, n_releases, paths, scene, tips_of};

/// What a tracker does to a recording.
#[derive(Clone, Copy)]
struct Loss {
    scene: &'static str,
    /// Shorter runs of long scenes (s).
    duration: f64,
    /// Share of rows that are lost (1).
    share: f64,
    /// Standard deviation of the places (m).
    jitter: f64,
    /// Swaps of two names that last for some frames (1).
    n_swaps: usize,
}

/// Largest move by smoothing of a place with jitter, over its standard deviation (1): one of 2000
/// places is off by more.
const SMOOTHED: f64 = 3.5;

const SCENES: [Loss; 10] = [
    Loss { scene: "scenarios/analytic/ramp-and-hold.json", duration: 1.0, share: 0.005, jitter: 0.0, n_swaps: 0 },
    Loss { scene: "scenarios/analytic/ramp-and-hold.json", duration: 1.0, share: 0.05, jitter: 1e-5, n_swaps: 0 },
    Loss { scene: "scenarios/paper/four-tips-prescribed.json", duration: 2.0, share: 0.03, jitter: 0.0, n_swaps: 3 },
    Loss { scene: "scenarios/paper/four-tips-prescribed.json", duration: 2.0, share: 0.01, jitter: 2e-5, n_swaps: 2 },
    Loss { scene: "scenarios/paper/four-tips-held.json", duration: 1.0, share: 0.05, jitter: 0.0, n_swaps: 2 },
    Loss { scene: "examples/recordings/ants.json", duration: 3.0, share: 0.005, jitter: 0.0, n_swaps: 4 },
    Loss { scene: "examples/recordings/ants.json", duration: 3.0, share: 0.02, jitter: 5e-5, n_swaps: 1 },
    Loss { scene: "examples/recordings/ants.json", duration: 3.0, share: 0.05, jitter: 1e-4, n_swaps: 2 },
    Loss { scene: "scenarios/analytic/release-jump.json", duration: 2.5, share: 0.03, jitter: 0.0, n_swaps: 0 },
    Loss { scene: "scenarios/robots/tow-past-corner.json", duration: 1.5, share: 0.04, jitter: 0.0, n_swaps: 0 },
];

/// Rows of a table of tips as a camera of 100 frames a second gives them, without events.
fn camera(scene: &Scenario, draws: &mut Draws, loss: &Loss) -> (String, String) {
    let table = tips_of(scene);
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for line in table.lines().skip(1).filter(|line| !line.ends_with("release")) {
        let cells: Vec<f64> = line.split(',').take(7).map(|cell| cell.parse().unwrap()).collect();
        let number = cells[0] / 0.01;
        if (number - number.round()).abs() < 1e-6 {
            rows.push(cells);
        }
    }
    let text = |rows: &[Vec<f64>]| {
        let line = |row: &Vec<f64>| row.iter().map(f64::to_string).collect::<Vec<_>>().join(",") + "\n";
        "time_s,spring,x_m,y_m,heading_rad,tip_x_m,tip_y_m\n".to_owned() + &rows.iter().map(line).collect::<String>()
    };
    let complete = text(&rows);
    let end = rows.last().unwrap()[0];
    for _ in 0..loss.n_swaps {
        let (one, from) = (draws.below(2) as f64, draws.between(0.2, 0.8) * end);
        let until = from + draws.between(0.02, 0.15) * end;
        for row in rows.iter_mut().filter(|row| (from..until).contains(&row[0]) && row[1] < 2.0) {
            row[1] = if row[1] == one { 1.0 - one } else { one };
        }
    }
    let mut normal = || (-2.0 * draws.unit().ln()).sqrt() * (std::f64::consts::TAU * draws.unit()).cos();
    for row in &mut rows {
        row[5] += loss.jitter * normal();
        row[6] += loss.jitter * normal();
    }
    rows.retain(|_| !draws.is(loss.share));
    (complete, text(&rows))
}

#[test]
fn lost_rows_jitter_and_swaps_invent_no_release_and_keep_the_verdict() {
    let (mut n_bridged, mut n_same) = (0, 0);
    for (seed, loss) in SCENES.iter().enumerate() {
        let scene = scene(loss.scene);
        let like = Scenario { duration: loss.duration, ..scene };
        let (complete, lossy) = camera(&like, &mut Draws::new(1 + seed as u64), loss);
        let bounds = Bounds { smooth: (loss.jitter > 0.0).then_some(SMOOTHED * loss.jitter), ..Bounds::default() };
        let (whole, _) = imported(&complete, &like, &Bounds::default());
        let (made, account) = imported(&lossy, &like, &bounds);
        assert_eq!(n_releases(&made), n_releases(&whole), "{}: {}", loss.scene, account.text());
        assert_eq!(paths(&made).len(), paths(&whole).len(), "{}: {}", loss.scene, account.text());
        n_bridged += account.count(Kind::Bridged);
        let verdict = |scenario: &Scenario| {
            let settings = Settings { step_s: Some(2e-3), ..Settings::default() };
            let found = ThreeWay::new(scenario, &settings).prescribed(|_| true).unwrap();
            let path = found.verdicts.path;
            println!("{}: {:?} of {}", loss.scene, path.verdict, found.tolerance_m);
            path.verdict
        };
        let (wanted, found) = (verdict(&whole), verdict(&made));
        println!("{}", account.text());
        // The account says that a verdict is open where the noise is large beside the steps.
        let is_open = account.notes.iter().any(|note| note.kind == Kind::Noise && note.is_warning);
        let is_same = found.has_inertia() == wanted.has_inertia();
        assert!(is_same || is_open, "{}: {wanted:?}, {found:?}\n{}", loss.scene, account.text());
        n_same += usize::from(is_same);
    }
    println!("{n_same} of {} verdicts are the same", SCENES.len());
    assert!(n_same >= 8, "{n_same}");
    assert!(n_bridged > 50, "rows were lost: {n_bridged} gaps");
}

/// Swaps are put right: the tips are where they were, to the bridge.
#[test]
fn swapped_names_are_put_right() {
    let like = scene("examples/recordings/ants.json");
    let loss = Loss { scene: "", duration: 3.0, share: 0.02, jitter: 0.0, n_swaps: 3 };
    for seed in 0..20 {
        let (complete, lossy) = camera(&like, &mut Draws::new(100 + seed), &loss);
        let (whole, _) = imported(&complete, &like, &Bounds::default());
        let (made, account) = imported(&lossy, &like, &Bounds::default());
        assert!(account.count(Kind::Swaps) > 0, "{seed}: {}", account.text());
        for (path, wanted) in paths(&made).iter().zip(paths(&whole)) {
            for point in &path.waypoints {
                let at = wanted.waypoints.iter().find(|other| (other.time - point.time).abs() < 1e-9).unwrap();
                assert!(
                    (at.position - point.position).norm() < 1e-9,
                    "{seed}: spring {} at {} s\n{}",
                    path.spring,
                    point.time,
                    account.text()
                );
            }
        }
    }
}

/// A hair below and a hair above the bridge, and a place far off the track for a frame.
#[test]
fn gaps_are_bridged_up_to_the_bound_and_released_beyond_it() {
    let like = scene("examples/recordings/ants.json");
    let table = |gap: usize, off: bool| {
        let mut text = "time_s,spring,tip_x_m,tip_y_m\n".to_owned();
        for k in 0..=300_usize {
            let time = 0.01 * k as f64;
            if !(100..100 + gap).contains(&k) {
                let x = if off && k == 50 { 0.3 } else { 0.05 + 0.02 * time };
                text += &format!("{time},0,{x},0.001\n");
            }
            text += &format!("{time},1,0,{}\n", 0.05 + 0.001 * time);
        }
        text
    };
    for (gap, bridge, n) in [(5, None, 0), (6, None, 1), (1, Some(0.0), 1), (20, Some(0.21), 0), (20, Some(0.2099), 1)] {
        let (made, account) = imported(&table(gap, false), &like, &Bounds { bridge, ..Bounds::default() });
        assert_eq!(n_releases(&made), n, "{gap} frames, {bridge:?}: {}", account.text());
        assert_eq!((account.count(Kind::Bridged), account.count(Kind::ReleasesInferred)), (1 - n, n), "{gap}, {bridge:?}");
        if n == 1 {
            let release = paths(&made)[0].release.unwrap();
            assert!((release - 1.0).abs() < 1e-12, "the first frame without it: {release}");
        }
    }
    let (made, account) = imported(&table(0, true), &like, &Bounds::default());
    assert_eq!((account.count(Kind::Jumps), n_releases(&made)), (1, 0), "{}", account.text());
    assert!(paths(&made)[0].waypoints.iter().all(|point| point.position.x < 0.12));
}

/// Smoothing stays within its bound, and finds a straight path again.
#[test]
fn smoothing_stays_within_its_bound() {
    let like = scene("examples/recordings/ants.json");
    let mut draws = Draws::new(5);
    let (mut text, bound) = ("time_s,spring,tip_x_m,tip_y_m\n".to_owned(), 1e-4);
    for k in 0..=300 {
        let time = f64::from(k) * 0.01;
        // A staircase of the places of a camera.
        let x = ((0.05 + 0.02 * time) / bound).round() * bound;
        text += &format!("{time},0,{x},{}\n{time},1,0,0.05\n", draws.between(-0.5, 0.5) * bound);
    }
    let (rough, _) = imported(&text, &like, &Bounds::default());
    let (smooth, account) = imported(&text, &like, &Bounds { smooth: Some(bound), ..Bounds::default() });
    let mut farthest: f64 = 0.0;
    for (one, other) in paths(&rough)[0].waypoints.iter().zip(&paths(&smooth)[0].waypoints) {
        farthest = farthest.max((one.position - other.position).norm());
        let truth = cohaul::math::Vec2::new(0.05 + 0.02 * one.time, 0.0);
        // The mean of 300 places with an error of 0.03 mm is far nearer than this to the line.
        assert!((other.position - truth).norm() < 3e-5, "{} s: {}", one.time, other.position);
    }
    assert!(farthest <= bound && farthest > 0.4 * bound, "{farthest}");
    assert_eq!(account.count(Kind::Smoothed), 602, "{}", account.text());
}
