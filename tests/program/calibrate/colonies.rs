//! Coverage of the intervals of `colony` on fifty generated colonies, cut at 15 to 90 s.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;

use cohaul::math::{RandomStreams, Stream, Vec2};
use cohaul::model::behaviour::ReleasePace;
use cohaul_paper::calibrate::behaviour::{Asked, BehaviourReport};

use super::observed::{NAMES, NEST, Truth};

const FOLDER: &str = "results/2026-11-30-colony";
const N: u64 = 50;
const FIRST: u64 = 3000;
/// Every fourth tick: 100 frames per second.
const FRAME: usize = 4;
const NOISE: f64 = 1e-4;
const HEAD: &str = "seed,duration_s,n_releases,parameter,truth,value,low,high,covers,collapsed";

/// Another colony and another time for each seed, uniform in the logarithm.
fn truth(seed: u64) -> Truth {
    let share = RandomStreams::new(seed).uniform(Stream::Scene, 8, 0);
    Truth { duration: (15f64.ln() + share * 6f64.ln()).exp(), ..Truth::random(seed) }
}

/// Lines of `coverage.csv` for one colony.
fn lines(seed: u64) -> String {
    let truth = truth(seed);
    let run = truth.run("hazard");
    let asked = Asked {
        pace: ReleasePace::Hazard,
        decision_period: None,
        nest: Some(Vec2::new(NEST[0], NEST[1])),
        tip_error: NOISE,
        stiffness_error: 0.0,
        level: 0.95,
    };
    let found = BehaviourReport::fitted(&run.attachments(&run.camera(FRAME, NOISE)), &asked, &|_| {}).unwrap();
    let mut lines = String::new();
    for ((name, truth), (_, own)) in NAMES.iter().zip(truth.values()).zip(found.parameters()) {
        let covers = own.low.is_none_or(|low| low <= truth) && own.high.is_none_or(|high| truth <= high);
        let [value, low, high] =
            [own.value, own.low, own.high].map(|number| number.map_or(String::new(), |number| format!("{number:.6e}")));
        let (duration, n, collapsed) = (self::truth(seed).duration, found.n_releases, own.is_collapsed());
        writeln!(lines, "{seed},{duration:.2},{n},{name},{truth:.6e},{value},{low},{high},{covers},{collapsed}").unwrap();
    }
    lines
}

/// Writes the lines of `COHAUL_COUNT` colonies from seed `COHAUL_SEED` on into the stored table.
#[test]
#[ignore = "takes two minutes"]
fn intervals_cover_the_truth_in_fifty_colonies() {
    let number = |name: &str, default: u64| std::env::var(name).ok().map_or(default, |text| text.parse().unwrap());
    let (first, n) = (number("COHAUL_SEED", FIRST), number("COHAUL_COUNT", N));
    let file = crate::root::root().join(FOLDER).join("coverage.csv");
    let stored = fs::read_to_string(&file).unwrap_or_default();
    let seed = |line: &str| line.split(',').next().and_then(|seed| seed.parse::<u64>().ok());
    let mut colonies: BTreeMap<u64, String> = BTreeMap::new();
    for (seed, line) in stored.lines().filter_map(|line| Some((seed(line)?, line))) {
        *colonies.entry(seed).or_default() += &format!("{line}\n");
    }
    colonies.extend((first..first + n).map(|seed| (seed, lines(seed))));
    fs::create_dir_all(file.parent().unwrap()).unwrap();
    fs::write(&file, format!("{HEAD}\n{}", colonies.into_values().collect::<String>())).unwrap();
}

/// The stored table keeps the promise: of all intervals 90 to 98 % hold the truth, and none is
/// without width. The shares stand in the page of the folder.
#[test]
fn the_stored_intervals_of_fifty_colonies_hold_the_truth() {
    let read = |name: &str| fs::read_to_string(crate::root::root().join(FOLDER).join(name)).unwrap();
    let (table, page) = (read("coverage.csv"), read("README.md"));
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len() as u64, 6 * N);
    assert_eq!(rows.iter().filter(|row| row[9] != "false").count(), 0, "intervals without width");
    let share = |of: &str| {
        let own: Vec<bool> = rows.iter().filter(|row| of == "all" || row[3] == of).map(|row| row[8] == "true").collect();
        own.iter().filter(|covers| **covers).count() as f64 / own.len() as f64
    };
    assert!((0.90..=0.98).contains(&share("all")), "{}", share("all"));
    for name in NAMES.into_iter().chain(["all"]) {
        let row = format!("| {name} | {:.1} % |", 100.0 * share(name));
        assert!(page.contains(&row), "{row}");
    }
    let durations = || rows.iter().map(|row| row[1].parse::<f64>().unwrap());
    assert!(
        durations().all(|duration| (15.0..=90.0).contains(&duration)) && durations().any(|at| at < 25.0) && durations().any(|at| at > 60.0)
    );
}

/// The short form: one colony that is not in the table is as good.
#[test]
fn the_intervals_of_a_colony_have_widths() {
    let found = lines(5);
    assert!(found.lines().count() == 6 && found.lines().all(|line| line.ends_with(",false")), "{found}");
}
