//! Two samples of pulls are compared by a test that knows runs.

use cohaul::math::{RandomStreams, Stream};
use cohaul_paper::calibrate::{PullSeries, compare_pulls};

use super::observed::Truth;

type Runs = Vec<Vec<Vec<f64>>>;

/// Runs of 20 pulls with a level of their own, as the pose of the load gives it to them.
fn dependent(seed: u64, n_runs: usize, shift: f64) -> Runs {
    let streams = RandomStreams::new(seed);
    let run = |run: u32| {
        let level = 5.0 + shift + streams.normal_pair(Stream::Scene, run, 1_000).x;
        (0..20).map(|i| level + 0.5 * streams.normal_pair(Stream::Scene, run, i).x).collect()
    };
    (0..n_runs as u32).map(|index| vec![run(index)]).collect()
}

/// The same pulls as if each was a run.
fn single(runs: &Runs) -> Runs {
    runs.iter().flatten().flatten().map(|pull| vec![vec![*pull]]).collect()
}

/// Share of 100 comparisons with a p-value of at most 5 %.
fn rejected(mut p_value: impl FnMut(u64) -> f64) -> f64 {
    (0..100).filter(|case| p_value(*case) <= 0.05).count() as f64 / 100.0
}

fn p_value(one: &Runs, other: &Runs) -> f64 {
    compare_pulls([one, other], 199, 1).unwrap().p_value
}

/// A test at 5 % rejects equal distributions in 5 % of the cases; 11 % is 2.8 standard deviations
/// more. Single pulls reject most of them.
#[test]
fn blocks_hold_the_level_that_single_pulls_do_not() {
    let pair = |case: u64| (dependent(2 * case, 8, 0.0), dependent(2 * case + 1, 8, 0.0));
    let blocks = rejected(|case| {
        let (one, other) = pair(case);
        p_value(&one, &other)
    });
    assert!(blocks <= 0.11, "{blocks}");
    let singles = rejected(|case| {
        let (one, other) = pair(case);
        p_value(&single(&one), &single(&other))
    });
    assert!(singles > 0.5, "{singles}");
}

#[test]
fn another_level_of_pulls_is_found() {
    let found = rejected(|case| p_value(&dependent(2 * case, 8, 0.0), &dependent(2 * case + 1, 8, 2.5)));
    assert!(found > 0.9, "{found}");
}

/// Runs of the program: the same ants are alike, ants with another steepness are not.
#[test]
fn another_steepness_shows_in_the_pulls_of_ants() {
    let runs = |first: u64, steepness: f64| -> Runs {
        let pulls = |seed: u64| {
            let run = Truth { seed, duration: 12.0, steepness, ..Truth::random(3) }.run("hazard");
            let found = run.attachments(&run.exact());
            found.all.iter().flat_map(|own| own.held.iter().map(|held| held.pull)).collect()
        };
        (first..first + 8).map(|seed| vec![pulls(seed)]).collect()
    };
    let (one, same, other) = (runs(100, 100.0), runs(200, 100.0), runs(300, 800.0));
    assert!(p_value(&one, &same) > 0.05);
    assert!(p_value(&one, &other) <= 0.01);
}

/// Of six pulls the distance is known: at each pull the functions differ by 1/3, 2/3, 1, 2/3, 1/3
/// and 0.
#[test]
fn the_distance_is_the_mean_square_of_the_difference() {
    let runs = |pulls: [f64; 3]| -> Runs { pulls.iter().map(|pull| vec![vec![*pull]]).collect() };
    let error = compare_pulls([&runs([1.0, 2.0, 3.0]), &runs([4.0, 5.0, 6.0])], 99, 1).unwrap_err();
    assert!(error.contains("assignments") && error.contains("found 3 and 3"), "{error}");
    let repeated = |pulls: [f64; 3]| -> Runs { (0..2).flat_map(|_| runs(pulls)).collect() };
    let found = compare_pulls([&repeated([1.0, 2.0, 3.0]), &repeated([4.0, 5.0, 6.0])], 99, 1).unwrap();
    // Each pull stands twice; equal pulls are one place each.
    let squares = [1.0, 4.0, 9.0, 4.0, 1.0, 0.0].iter().sum::<f64>() / 9.0;
    assert!((found.distance - squares / 6.0).abs() < 1e-12, "{found:?}");
    assert!(found.p_value <= 0.05, "{found:?}");
}

#[test]
fn series_are_cut_into_blocks_of_equal_duration() {
    let text = "time_s,spring,force_n\n0,0,1\n1,0,2\n2,0,3\n3,0,4\n4,0,5\n";
    let series = PullSeries::parse(text, "pulls").unwrap();
    assert_eq!(series.blocks(None).unwrap(), [vec![1.0, 2.0, 3.0, 4.0, 5.0]]);
    assert_eq!(series.blocks(Some(2.1)).unwrap(), [vec![1.0, 2.0], vec![3.0, 4.0, 5.0]]);
    // A hair to both sides of the largest number of blocks, 10,000 of 0.4 ms.
    assert_eq!(series.blocks(Some(4e-4)).unwrap().len(), 5);
    for short in [3.9e-4, 1e-9, 1e-300] {
        let error = series.blocks(Some(short)).unwrap_err();
        assert!(error.contains("must make at most 10000 blocks") && error.contains("at least 400 µs"), "{error}");
    }
    // One time in seconds since 1970 among those of a clock that began with the recording.
    let mixed = PullSeries::parse(&format!("{text}1700000000,0,6\n"), "pulls").unwrap();
    let error = mixed.blocks(Some(20.0)).unwrap_err();
    assert!(error.contains("to the last, 1700000000 s"), "{error}");
    let error = PullSeries::parse("time_s,force_n\n0,-1\n", "pulls").unwrap_err().to_string();
    assert!(error.contains("line 2, force_n") && error.contains("must not be negative"), "{error}");
}
