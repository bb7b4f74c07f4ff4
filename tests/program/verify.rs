//! Code verification by known answers: the cases hold, and what is wrong is reported as a miss.

#[path = "../common/root.rs"]
mod root;

use std::fs;
use std::process::Output;

use cohaul::backend::{BackendKind, RapierOptions, Status};
use cohaul_report::json;
use cohaul_report::text::Detail;
use cohaul_studies::methods::Method;
use cohaul_studies::subject::{Runs, built_in, own};
use cohaul_studies::variants;
use cohaul_studies::verify::report::{Verification, verify_text};
use cohaul_studies::verify::{Case, Effort, Errors, Expected, Family, Outcome, Plan, Row, RowKind, all, put_to, tasks};
use serde_json::Value;
use tempfile::tempdir;

fn named(name: &str) -> Case {
    all().into_iter().find(|case| case.name == name).unwrap_or_else(|| panic!("{name}"))
}

fn verify(cases: &[Case], wanted: impl Fn(&Plan) -> bool, effort: Effort) -> Vec<Row> {
    tasks(cases, &own, wanted, effort).finished(&|_| true).unwrap().concat()
}

fn rows(case: Case, method: Method) -> Vec<Row> {
    verify(&[case], |plan| plan.method == method, Effort::Full)
}

/// The case with another known answer: `wrong` of the right one.
fn with_known(case: Case, wrong: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Case {
    let run = case.run;
    let wrongly = move |runs: &Runs| {
        let mut answer = run(runs);
        answer.values.iter_mut().for_each(|value| value.known = wrong(value.known));
        answer
    };
    Case { run: Box::new(wrongly), ..case }
}

fn misses(rows: &[Row]) -> Vec<(RowKind, String)> {
    let of = |row: &Row| if let Outcome::Misses(why) = &row.outcome { Some((row.kind, why.clone())) } else { None };
    rows.iter().filter_map(of).collect()
}

/// An engine of the user is asked what rapier is asked. One of second order is right too; one
/// without inertia is not.
#[test]
fn known_answers_are_put_to_engines_of_users() {
    let by = |name: &str, kind: BackendKind| {
        let meet = built_in(kind, RapierOptions::default());
        let families = [Family::Slide, Family::Pull, Family::Contact];
        let cases = all().into_iter().filter(|case| families.contains(&case.family)).collect();
        let cases = put_to(Method::of_user(name).unwrap(), cases);
        tasks(&cases, &meet, |_| true, Effort::Quick).finished(&|_| true).unwrap().concat()
    };
    for (name, kind) in [("engine of rapier", BackendKind::Rapier), ("engine of midpoint", BackendKind::Inertial)] {
        let rows = by(name, kind);
        assert!(rows.len() > 40 && rows.iter().all(|row| row.outcome == Outcome::Holds && row.method.name == name), "{rows:?}");
    }
    let still = by("engine without inertia", BackendKind::QuasiStatic);
    let slides: Vec<Row> = still.into_iter().filter(|row| row.family == Family::Slide).collect();
    assert!(slides.iter().all(|row| row.outcome.missed() == Some("the error is above its bound")), "{slides:?}");
}

/// A refusal is no miss, and what is wrong with an engine is one.
#[cfg(unix)]
#[test]
fn refusals_and_faults_of_engines_are_rows() {
    let shy =
        r#"read -r line; case "$line" in *'"springs":[]'*) echo '{"name":"shy"}';; *) echo '{"name":"shy","refused":"springs"}';; esac"#;
    let output = root::cohaul().args(["verify", "slide-1-m-s", "pull", "--quick", "--json", "--engine", shy]).output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((output.status.code(), &found["engine"]["name"]), (Some(1), &Value::from("shy")), "{found}");
    let judged = found["n_judged"].as_u64().unwrap();
    assert!(found["n_held"] == 0 && judged > 0 && found["n_shown"].as_u64().unwrap() > judged, "{found}");
    for row in found["rows"].as_array().unwrap() {
        let is_slide = row["case"] == "slide-1-m-s";
        assert!(row["error_m"].is_null() && row["order"].is_null() && row["holds"].is_null() != is_slide, "{row}");
        assert_eq!(row["missed"].as_str().is_some_and(|why| why.contains("must answer each request")), is_slide, "{row}");
    }
}

#[test]
fn every_known_answer_is_met() {
    let cases = all();
    let rows = verify(&cases, |_| true, Effort::Quick);
    for row in &rows {
        assert!(!matches!(row.outcome, Outcome::Misses(_)), "{row:?}");
        assert_eq!(row.outcome == Outcome::Shown, row.method == Method::RAPIER_ENGINE_DEFAULTS, "{row:?}");
    }
    for case in &cases {
        let n_plans = case.plans.len();
        assert!(n_plans > 0 && rows.iter().filter(|row| row.case == case.name).count() >= n_plans, "{}", case.name);
        assert_eq!(cases.iter().filter(|other| other.name == case.name).count(), 1, "{}", case.name);
    }
    assert!(variants::all::<Family>().all(|family| cases.iter().any(|case| case.family == family)));
    assert!(Method::all_verified().all(|method| rows.iter().any(|row| row.method == method)));
    let first_order = rows.iter().filter(|row| row.expected == Expected::Order(1.0) && row.order.is_some()).count();
    // Two orders for each plan with three steps: a plan that drops out would fail nothing else.
    assert!(first_order > 90, "{first_order}");
}

/// Extrapolation meets the ten digits that are known of the reference scenes.
#[test]
fn the_reference_scenes_are_met_to_a_nanometre() {
    for (name, method) in [("reference-quasi-static", Method::QUASI_STATIC), ("reference-inertial", Method::INERTIAL_EULER)] {
        let rows = rows(named(name), method);
        let limit = rows.last().unwrap();
        // Half a unit of the tenth digit is 5e-12 m without inertia and 5e-11 m with it; changes of
        // regime within steps leave more.
        assert_eq!(limit.kind, RowKind::Extrapolated);
        assert!(limit.errors.metres.unwrap() < 1e-9 && limit.errors.metres.unwrap() > 0.0, "{limit:?}");
    }
}

/// A ten-thousandth is a fiftieth of the error at the shortest step but far above what is left in
/// the limit: a floor under the error shows there.
#[test]
fn a_slightly_wrong_answer_is_a_miss() {
    let found = misses(&rows(with_known(named("peers-slide"), |known| 1.0001 * known), Method::RAPIER));
    assert!(found.iter().any(|(kind, why)| *kind == RowKind::Extrapolated && why.contains("above its bound")), "{found:?}");
    for (name, method) in
        [("limit-force", Method::QUASI_STATIC), ("mass-onset", Method::INERTIAL_EULER), ("towing-38.5-mm", Method::QUASI_STATIC)]
    {
        let found = misses(&rows(with_known(named(name), |known| 1.2 * known), method));
        assert!(!found.is_empty(), "{name}");
    }
    // Rest that is none: a picometre is above rounding, two nanometres above what may creep.
    for (name, way) in [("symmetry-moved", 1e-12), ("rate-same-nodes", 1e-300), ("peers-creep", 2e-9)] {
        assert!(!misses(&rows(with_known(named(name), move |known| known + way), Method::QUASI_STATIC)).is_empty(), "{name}");
    }
}

#[test]
fn another_order_than_the_expected_one_is_a_miss() {
    for (name, method, wrong) in [
        ("pull-and-hold", Method::INERTIAL_EULER, 2.0),
        ("pull-ripple-0.02-m-s", Method::INERTIAL_MIDPOINT, 1.0),
        ("towing-38.5-mm", Method::QUASI_STATIC, 0.8),
    ] {
        let mut case = named(name);
        for plan in &mut case.plans {
            // Bounds that any error keeps: the order alone is left to miss.
            plan.expected = Expected::Order(wrong);
            plan.bound.errors = plan.bound.errors.map(|bound| 1e3 * bound);
        }
        let found = misses(&rows(case, method));
        assert!(found.len() >= 3 && found.iter().all(|(_, why)| why.contains("the order is")), "{name}: {found:?}");
    }
}

#[test]
fn a_broken_answer_is_a_miss_and_no_number() {
    let broken = with_known(named("peers-slide"), |_| f64::NAN);
    let rows = verify(&[broken], |plan| plan.method != Method::INERTIAL_MIDPOINT, Effort::Quick);
    assert!(misses(&rows).iter().all(|(_, why)| why.contains("not finite")) && misses(&rows).len() == 13, "{rows:?}");
    let found = Verification::new(&[named("peers-slide")], &rows, Effort::Quick, 0.1);
    assert_eq!((found.holds, found.n_held, found.n_judged, found.n_shown), (false, 0, 13, 3));
    let text = verify_text(&found, Detail::Full) + &json::pretty(&found).unwrap();
    assert!(!text.contains("NaN") && text.contains("MISSES") && text.contains("missed: 0 of 13 rows"), "{text}");

    let case = named("slide-1-m-s");
    let run = case.run;
    let unconverged = move |runs: &Runs| {
        let mut answer = run(runs);
        answer.report.status = Status::NotConverged;
        answer
    };
    let rows = self::rows(Case { run: Box::new(unconverged), ..case }, Method::INERTIAL_EULER);
    assert!(misses(&rows).len() == rows.len() && misses(&rows)[0].1.contains("did not converge"), "{rows:?}");
}

#[test]
fn an_error_without_a_bound_is_a_miss_and_nothing_is_within_any() {
    let metres = |value| Errors { metres: Some(value), ..Errors::NONE };
    assert!(metres(1.0).within(&metres(1.0)) && Errors::NONE.within(&metres(0.0)));
    assert!(!metres(1.0).within(&Errors::NONE) && !metres(f64::NAN).within(&metres(1.0)) && !metres(1.1).within(&metres(1.0)));
}

/// A case answers to any options, whatever its plans are.
#[test]
fn a_case_measures_its_error_at_options_of_ones_own() {
    let case = named("tripod-free");
    let error = |step_s| case.run(&Method::INERTIAL_EULER.options(step_s)).errors();
    let (coarse, fine) = (error(1e-4), error(1e-5));
    // First order; where the stop falls within its step adds little.
    assert!((coarse.metres.unwrap() / fine.metres.unwrap() - 10.0).abs() < 0.5, "{coarse:?} {fine:?}");
    assert!((coarse.radians.unwrap() / fine.radians.unwrap() - 10.0).abs() < 0.5, "{coarse:?} {fine:?}");
    assert_eq!(coarse.ratio, None);
}

#[test]
fn it_stops_when_told_to() {
    assert_eq!(tasks(&all(), &own, |_| true, Effort::Quick).finished(&|_| false), None);
}

fn call(args: &[&str]) -> Output {
    root::cohaul().arg("verify").args(args).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

#[test]
fn the_program_prints_a_table_or_one_object_and_lists_its_cases() {
    let brief = call(&["slide", "towing", "--quick"]);
    assert_eq!(brief.status.code(), Some(0));
    assert_eq!(text(&brief.stderr), "");
    let lines: Vec<&str> = text(&brief.stdout).lines().collect();
    assert!(lines[0].starts_with("All known answers hold: "), "{}", text(&brief.stdout));
    assert!(lines.len() == 6 && lines[4].starts_with("  slide ") && lines[5].starts_with("  towing "), "{lines:?}");
    assert!(lines.iter().all(|line| line.chars().count() <= 80), "{lines:?}");

    let found = Verification::new(&[named("slide-1-m-s")], &rows(named("slide-1-m-s"), Method::RAPIER), Effort::Full, 0.1);
    let table = verify_text(&found, Detail::Full);
    let lines: Vec<&str> = table.lines().filter(|line| line.starts_with("  ")).collect();
    // Columns stand under their heads.
    let column = lines[0].find("bound").unwrap();
    assert!(lines.len() == 6 && lines[1..].iter().all(|line| line.chars().nth(column - 1) == Some(' ')), "{table}");

    let output = call(&["slide", "--backend", "rapier", "--quick", "--json"]);
    let found: Value = serde_json::from_str(text(&output.stdout)).unwrap();
    assert_eq!((&found["holds"], &found["n_held"]), (&true.into(), &found["n_judged"]));
    let rows = found["rows"].as_array().unwrap();
    assert!(rows.len() == 24 && rows.iter().all(|row| row["backend"] == "rapier" && row["family"] == "slide"));
    assert!((rows[1]["order"].as_f64().unwrap() - 1.0).abs() < 1e-6);

    let list = call(&["--list"]);
    assert_eq!((list.status.code(), text(&list.stdout).lines().filter(|line| !line.starts_with("   ")).count()), (Some(0), all().len()));
    assert_eq!(call(&["--help"]).status.code(), Some(0));
}

#[test]
fn the_program_writes_table_figure_and_manifest_whole() {
    let room = tempdir().unwrap();
    let out = room.path().join("out");
    let folder = out.to_str().unwrap();
    assert_eq!(call(&["pull", "--out", folder, "--quick"]).status.code(), Some(0));
    let mut names: Vec<_> = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["convergence.svg", "manifest.json", "verify.csv", "verify.json"]);
    let json: Value = serde_json::from_str(&fs::read_to_string(out.join("verify.json")).unwrap()).unwrap();
    let mut table = csv::Reader::from_path(out.join("verify.csv")).unwrap();
    assert!(table.headers().unwrap().iter().take(5).eq(["case", "family", "backend", "extrapolated", "step_s"]));
    let records: Vec<_> = table.records().map(Result::unwrap).collect();
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(records.len(), rows.len());
    for (record, row) in records.iter().zip(rows) {
        assert_eq!(record[4].parse().ok(), row["step_s"].as_f64());
        assert_eq!(record[5].parse().ok(), row["error_m"].as_f64());
    }
    let figure = fs::read_to_string(out.join("convergence.svg")).unwrap();
    assert!(figure.starts_with("<svg") && !figure.contains("NaN") && figure.contains("10⁻³"));
    let manifest: Value = serde_json::from_str(&fs::read_to_string(out.join("manifest.json")).unwrap()).unwrap();
    assert_eq!(manifest["files"].as_object().unwrap().len(), 3);
}

#[test]
fn nonsense_is_usage() {
    let room = tempdir().unwrap();
    fs::write(room.path().join("mine.txt"), "mine").unwrap();
    let taken = room.path().to_str().unwrap();
    for (args, word) in [
        (&["flying"][..], "flying"),
        (&["slide", "flying"], "flying"),
        (&["towing", "--backend", "rapier"], "rapier"),
        (&["--backend", "flying"], "flying"),
        (&["--list", "--json"], "--list"),
        (&["slide", "--out", taken], "not empty"),
    ] {
        let output = call(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert_eq!(text(&output.stdout), "", "{args:?}");
        assert!(text(&output.stderr).contains(word) && !text(&output.stderr).contains("panicked"), "{args:?}: {}", text(&output.stderr));
    }
}
