//! The paper's results: the default ants meet the printed numbers, the literal ones do what they
//! say, and the command is whole.

#[path = "../common/root.rs"]
mod root;

use std::fs;
use std::process::Output;

use cohaul::backend::BackendKind;
use cohaul::model::paper as printed;
use cohaul::scenario::presets::Preset;
use cohaul::simulation::{Keep, Simulation};
use cohaul_paper::paper::{BLOCK, Case, Measure, Null, RunFacts, Trial, change, claims, facts_of, run, series_in_window, series_of, units};
use serde_json::Value;
use tempfile::tempdir;

fn runs(trials: &[Trial], case: &Case, seeds: std::ops::Range<u64>) -> Vec<(Trial, u64, RunFacts)> {
    let run = |trial: Trial, seed| (trial, seed, run(trial, case, seed, |_| true).unwrap());
    seeds.flat_map(|seed| trials.iter().map(move |trial| run(*trial, seed))).collect()
}

fn value(measure: Measure, runs: &[(Trial, u64, RunFacts)]) -> f64 {
    measure.of(&units(runs)).unwrap()
}

/// On seeds that nothing was fitted to. Over four seeds the mean and standard deviation of the
/// pulls scatter by 0.08 mN, which leaves the limit of 10 % four standard errors away; the mean
/// group scatters by 0.08.
#[test]
fn default_ants_pull_as_printed() {
    let case = Case::new(Preset::default(), BackendKind::QuasiStatic);
    let runs = runs(&[Trial::FourFour, Trial::FIVE_TEN, Trial::TEN_TEN], &case, 501..505);
    let (mean, sd) = (value(Measure::PULL_MEAN, &runs), value(Measure::PULL_SD, &runs));
    assert!((mean / printed::PULL_MEAN_N - 1.0).abs() < 0.1, "{mean}");
    assert!((sd / printed::PULL_SD_N - 1.0).abs() < 0.1, "{sd}");
    let mean_size = |share: &dyn Fn(usize) -> f64| (6..=10).map(|size| size as f64 * share(size)).sum::<f64>();
    let ours = mean_size(&|size| value(Measure::SizeShare(size), &runs));
    assert!((ours - mean_size(&printed::share_of_size)).abs() < 0.3, "{ours}");
    // Five ants on ten springs need about a third of the time of four on four, and ten hardly less.
    assert!(value(Measure::FiveOverFour, &runs) < 0.6);
    assert!(value(Measure::TenOverFive, &runs) > 0.6);
}

#[test]
fn four_ants_bring_the_load_home_on_every_backend() {
    for backend in BackendKind::ALL {
        let facts = run(Trial::FourFour, &Case::new(Preset::default(), backend), 1, |_| true).unwrap();
        // Of the order of 80 s: a factor of two.
        assert!(facts.arrived && (40.0..160.0).contains(&facts.time_s), "{backend:?}: {}", facts.time_s);
    }
}

/// In millinewtons the printed odds are a wall at 10 mN, above which nobody is met but on the one
/// step that led there: 0.08 m/s for 0.08 s on 0.664 N/m is 4.25 mN. In newtons larger pulls are
/// met.
#[test]
fn the_reading_of_the_unit_decides_the_largest_pull() {
    let largest = |preset| {
        let runs = runs(&[Trial::FourFour], &Case::new(preset, BackendKind::QuasiStatic), 1..4);
        runs.iter().map(|(.., facts)| facts.pulls.max()).fold(0.0, f64::max)
    };
    let wall = largest(Preset::LiteralMillinewtons);
    // At 60 degrees off the spring a step shortens it, and a shorter one is stiffer across.
    assert!((0.010..0.020).contains(&wall), "{wall}");
    assert!(largest(Preset::LiteralNewtons) > 0.022);
}

/// A claim needs all its trials: without the other numbers of ants on ten springs nothing is told
/// of them.
#[test]
fn claims_without_their_trials_are_not_told() {
    let runs = runs(&[Trial::FourFour], &Case::new(Preset::LiteralNewtons, BackendKind::QuasiStatic), 1..3);
    let claims = claims(&units(&runs));
    let of_speed: Vec<_> = claims.iter().filter(|claim| claim.contradicts == Null::Proportional).collect();
    assert!(of_speed.len() == 5 && of_speed.iter().all(|claim| claim.holds.is_none() && claim.found.is_none()));
}

fn call(args: &[&str]) -> Output {
    root::cohaul().arg("paper").args(args).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// On seeds that nothing was fitted to, in whole runs the interaction forces rise more often than
/// they fall, because a team gathers. From the first instant at which all four pull, they fall more
/// often: a fifth less of the series at its beginning turns the sign.
#[test]
fn the_sign_of_the_interaction_change_hangs_on_the_gathering() {
    let case = Case::new(Preset::default(), BackendKind::QuasiStatic);
    let (mut whole, mut late, mut fair) = (0, 0, 0);
    for seed in 7001..7061 {
        let scenario = Trial::FourFour.scenario(&case, seed);
        let mut run = Simulation::new(&scenario, &case.options(&scenario), Keep::Trace);
        run.run(|_| true);
        let (trace, _) = run.into_results();
        let series = series_of(&trace, &scenario);
        let sign = |values: &[f64]| {
            // A team that gathers late leaves too few blocks.
            let Some(change) = change::change_of_mean(values, BLOCK, seed).filter(change::Change::is_significant) else { return 0 };
            (change.mean_after - change.mean_before).signum() as i32
        };
        whole += sign(&series.interaction);
        late += sign(&series.interaction[series.interaction.len() / 5..]);
        fair += sign(&series_in_window(&trace, &scenario).interaction);
    }
    assert!(whole > 0 && late < 0 && fair < 0, "{whole} {late} {fair}");
}

/// A search of one row has twelve sets and as many repetitions as rows, and a box around the
/// closest ones.
#[test]
fn a_search_lists_every_set_with_its_distance() {
    let room = tempdir().unwrap();
    let out = room.path().join("out");
    let sizes = ["--rows", "1", "--within", "2", "--seeds", "1", "--more-seeds", "2", "--most", "1"];
    let output = call(&[&["search"][..], &sizes, &["--quiet", "--json", "--out", out.to_str().unwrap()]].concat());
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
    let found: Value = serde_json::from_str(text(&output.stdout)).unwrap();
    assert_eq!(found["n_sets"], 14);
    assert!(found["n_accepted"].as_u64() <= found["n_judged"].as_u64() && found["n_judged"].as_u64() <= found["n_close"].as_u64());
    let mut table = csv::Reader::from_path(out.join("sets.csv")).unwrap();
    let at = |name: &str, headers: &csv::StringRecord| headers.iter().position(|header| header == name).unwrap();
    let headers = table.headers().unwrap().clone();
    let (distance, within) = (at("distance", &headers), at("is_within_the_box", &headers));
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!((rows.len(), rows.iter().filter(|row| &row[within] == "true").count()), (14, 2));
    assert!(rows.iter().all(|row| row[distance].is_empty() || row[distance].parse::<f64>().unwrap() > 0.0));
    for name in ["README.md", "region.svg", "choices.csv", "manifest.json", "summary.json"] {
        let content = fs::read_to_string(out.join(name)).unwrap();
        assert!(!content.contains("NaN"), "{name}");
    }
    assert!(out.join("report.html").is_file());
    assert_eq!(fs::read_dir(room.path()).unwrap().count(), 1, "no state is left beside");
}

#[test]
fn the_command_writes_tables_and_figures_whole() {
    let room = tempdir().unwrap();
    let out = room.path().join("out");
    let args = [
        "--backend",
        "quasi-static",
        "--seeds",
        "2",
        "--preset",
        "literal-newtons",
        "--quick",
        "--quiet",
        "--json",
        "--out",
        out.to_str().unwrap(),
    ];
    let output = call(&args);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
    let found: Value = serde_json::from_str(text(&output.stdout)).unwrap();
    assert_eq!((&found["preset"], &found["sets"][0]["n_runs"]), (&"literal-newtons".into(), &24.into()));
    assert_eq!(found["table"][0]["printed"], 5.0e-3);
    // The literal preset does not reproduce the paper, and the report begins with that.
    let missed = found["not_reproduced"].as_array().unwrap();
    assert!(!missed.is_empty());
    let page = fs::read_to_string(out.join("README.md")).unwrap();
    let place = |title: &str| page.find(title).unwrap_or_else(|| panic!("{title}"));
    assert!(place("## What is not reproduced") < place("## Sets of runs") && place("## Sets of runs") < place("## Beside what is printed"));
    let mut names: Vec<_> = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    // A table without rows, such as that of a fit that was not asked for, is left out.
    let tables = [
        "README.md",
        "claims.csv",
        "conclusions.csv",
        "experiment.csv",
        "group-size.csv",
        "group-size.svg",
        "manifest.json",
        "not-reproduced.csv",
        "path.svg",
        "pulls.svg",
        "report.html",
        "runs.csv",
        "samples.csv",
    ];
    assert_eq!(
        names,
        [&tables[..], &["snapshots.svg", "summary.json", "table.csv", "table.txt", "transition.svg", "transitions.csv"]].concat()
    );
    assert_eq!(fs::read_dir(room.path()).unwrap().count(), 1, "no state is left beside");
    for name in names {
        let content = fs::read_to_string(out.join(&name)).unwrap();
        // The script of a page knows the word.
        let is_finite = name == "report.html" || !content.contains("NaN") && !content.contains("inf,");
        assert!(is_finite && (!name.ends_with("svg") || content.starts_with("<svg")), "{name}");
    }
    let mut table = csv::Reader::from_path(out.join("runs.csv")).unwrap();
    assert_eq!(table.records().map(Result::unwrap).count(), 24);
    // Made again it is the same, the time it took aside.
    let again = text(&call(&args).stdout).to_owned();
    let bare = |text: &str| text.lines().filter(|line| !line.contains("wall_s")).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(bare(&again), bare(text(&output.stdout)));
}

/// A set value is in every run and in the report, and readings are graded by the same list.
#[test]
fn a_reading_of_ones_own_is_graded() {
    let set = |value: &str| {
        let pair = format!("drive.pull_speed_m_per_s={value}");
        let output = call(&["--backend", "quasi-static", "--seeds", "2", "--quick", "--json", "--set", &pair]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    let time = |found: &Value| {
        let row = found["table"].as_array().unwrap().iter().find(|row| row["quantity"] == "time to nest, 4/4").unwrap();
        row["ours"]["value"].as_f64().unwrap()
    };
    let [slow, fast] = ["0.02", "0.06"].map(set);
    assert_eq!(slow["set"], serde_json::json!([["drive.pull_speed_m_per_s", 0.02]]));
    // Three times the speed over the same way, and two seeds that scatter by a fifth.
    assert!(time(&slow) > 1.5 * time(&fast), "{} {}", time(&slow), time(&fast));
}

/// Each column of the table of readings is what its runs give, and the default is the default.
#[test]
fn readings_stand_beside_each_other() {
    let room = tempdir().unwrap();
    let out = room.path().join("out");
    let output = call(&["readings", "--seeds", "2", "--seed", "11", "--quiet", "--json", "--out", out.to_str().unwrap()]);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), ""));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let readings = found["readings"].as_array().unwrap();
    assert_eq!(readings.len(), 4);
    let runs = runs(&Trial::ALL, &Case::new(Preset::default(), BackendKind::QuasiStatic), 11..13);
    let facts = facts_of(&units(&runs));
    for (at, fact) in facts.iter().enumerate().take(8) {
        assert_eq!(readings[0]["facts"][at]["value"].as_f64(), fact.value, "{}", fact.fact);
    }
    // In one step of 5 ms per millinewton a pull stays within one step of the wall at 10 mN, and
    // one ant alone never moves the load.
    let largest = readings[3]["facts"][2]["value"].as_f64().unwrap();
    assert!(largest < 0.013, "{largest}");
    assert!(readings[3]["time_of_one_s"].is_null() && readings[3]["chance_to_move"].as_f64().unwrap() < 1e-9);
    let rows = csv::Reader::from_path(out.join("readings.csv")).unwrap().records().count();
    assert_eq!(rows, 4 * facts.len());
    let page = fs::read_to_string(out.join("README.md")).unwrap().replace("\n  ", " ");
    assert!(page.contains("cohaul paper --preset literal-millinewtons --set control_period_s=0.005"), "{page}");
}

/// A journal of another question is refused and stays.
#[test]
fn a_foreign_state_and_nonsense_are_usage() {
    let room = tempdir().unwrap();
    let out = room.path().join("out");
    let folder = out.to_str().unwrap();
    let state = room.path().join("out.journal");
    fs::write(&state, "{").unwrap();
    for (args, word) in [
        (&["--preset", "flying"][..], "flying"),
        (&["--backend", "flying"], "flying"),
        (&["--seeds", "1"], "--seeds"),
        (&["--seeds", "many"], "--seeds"),
        (&["--seed", "-3"], "-3"),
        (&["--set", "drive.pull_speed_m_per_s"], "KEY=VALUE"),
        (&["--set", "drive.pull_speed_m_per_s=fast"], "drive.pull_speed_m_per_s"),
        (&["--set", "drive.pull_speed=1"], "drive.pull_speed"),
        (&["flying"], "flying"),
        (&["--quick", "--out", folder], "not a journal"),
    ] {
        let output = call(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert_eq!(text(&output.stdout), "", "{args:?}");
        assert!(text(&output.stderr).contains(word) && !text(&output.stderr).contains("panicked"), "{args:?}: {}", text(&output.stderr));
    }
    assert_eq!(fs::read_to_string(&state).unwrap(), "{");
}
