//! Programs as engines under the verdict: what is wrong with one is named, and nothing stays
//! behind. Engines are scripts of the shell here.
#![cfg(unix)]

use std::process::Output;
use std::time::{Duration, Instant};

#[path = "../common/root.rs"]
mod root;

fn compare(script: &str, more: &[&str]) -> (Output, Duration) {
    let clock = Instant::now();
    let scene = root::root().join("scenarios/analytic/ramp-and-hold.json");
    let mut command = root::cohaul();
    command.arg("compare").arg(scene).args(["--engine", script]).args(more);
    (command.output().unwrap(), clock.elapsed())
}

/// An engine that answers this to each advance.
fn answering(answer: &str) -> String {
    format!(
        r#"while read -r line; do case "$line" in *'"call":"start"'*) echo '{{"name":"still","version":"7"}}';; *'"call":"advance"'*) echo '{answer}';; *) echo '{{}}';; esac; done"#
    )
}

#[test]
fn a_program_gets_the_verdict_under_its_own_name() {
    let (output, _) = compare(&answering(r#"{"pose":[0,0,0]}"#), &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let tier = &found["tiers"]["prescribed"];
    assert_eq!(tier["engine"], serde_json::json!({ "name": "still", "version": "7" }));
    assert_eq!(tier["verdicts"]["path"]["engine"], "not within");
    let answer = found["answer"].as_str().unwrap();
    assert!(answer.contains("The engine error of still exceeds the tolerance") && !answer.contains("rapier"), "{answer}");
    let (output, _) = compare(&answering(r#"{"pose":[0,0,0]}"#), &["--verbose"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("still") && !text.contains("rapier"), "{text}");
}

#[test]
fn engines_side_by_side_share_the_exact_paths() {
    let room = tempfile::tempdir().unwrap();
    let out = room.path().join("out");
    let still = answering(r#"{"pose":[0,0,0]}"#);
    let more = ["--engine", "rapier", "--halvings", "3", "--json", "--out", out.to_str().unwrap()];
    let (output, _) = compare(&still, &more);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let [first, other] = [&found["tiers"]["prescribed"], &found["other_engines"][0]];
    assert_eq!([&first["engine"]["name"], &other["engine"]["name"]], ["still", "rapier"]);
    for key in ["inertia_effect", "numbers", "tolerance_m"] {
        assert_eq!(first[key], other[key], "{key}");
    }
    // A load that never moves has no time-step error; rapier's is of first order.
    assert_eq!(first["time_step_order"], serde_json::Value::Null);
    assert!((other["time_step_order"].as_f64().unwrap() - 1.0).abs() < 0.05, "{}", other["time_step_order"]);
    let answer = found["answer"].as_str().unwrap();
    let at = |words: &str| answer.find(words).unwrap_or_else(|| panic!("{words}: {answer}"));
    assert!(at("The engine error of still") < at("The engine error of rapier"));
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.contains("engines side by side"));
    let overview = std::fs::read_to_string(out.join("overview-prescribed.svg")).unwrap();
    assert!(overview.contains("still") && overview.contains("rapier"));
    let long = still.replace("still", "an engine whose name is a long one");
    let (output, _) = compare(&still, &["--engine", "rapier", "--engine", &long]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("\n  an engine whose name is a long one\n"), "{text}");
    assert!(text.contains("Engine error") && text.lines().all(|line| line.chars().count() <= 80), "{text}");
    // One that refuses the scene is a row, and no comparison by itself.
    let shy = r#"read -r line; echo '{"name":"shy","refused":"no springs"}'"#;
    let (output, _) = compare(shy, &["--engine", &still, "--json"]);
    let of_two: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(of_two["tiers"]["prescribed"]["verdicts"], found["tiers"]["prescribed"]["verdicts"]);
    assert_eq!(of_two["refused_by"], serde_json::json!([{ "engine": { "name": "shy" }, "why": "no springs" }]));
    let (output, _) = compare(shy, &["--out", out.to_str().unwrap()]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && error.contains("--engine: shy refuses the scene: no springs"), "{error}");
    // Two of one name cannot be told apart.
    let (output, _) = compare(&still, &["--engine", &still]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && error.contains("must be engines of different names, found still twice"), "{error}");
}

#[test]
fn what_is_wrong_with_an_engine_is_named() {
    let names = r#"while read -r line; do echo '{"name":""}'; done"#;
    let stops = r#"read -r line; echo '{"name":"short"}'; read -r line; exit 7"#;
    let hangs = r#"read -r line; echo '{"name":"slow"}'; sleep 600"#;
    for (script, expected) in [
        ("/nowhere/at/all".to_owned(), "must answer each request, found its end (exit status: 127)"),
        ("true".to_owned(), "start: must answer each request, found its end (exit status: 0)"),
        ("echo no".to_owned(), "start: expected ident at line 1 column 2, found no"),
        (names.to_owned(), "name: must have 1 to 40 bytes, found 0"),
        (r#"printf '%s\n' '{"name":"\u001b[31mred"}'"#.to_owned(), r#"name: must have no control characters, found "\u{1b}[31mred""#),
        (r#"echo '{"name":"inertial"}'"#.to_owned(), "name: must differ from the other runs, found inertial"),
        (stops.to_owned(), "short, at 0 s: attach: must answer each request, found its end (exit status: 7)"),
        (hangs.to_owned(), "slow, at 0 s: attach: must answer within 0.5 s, found nothing"),
        (answering(r#"{"pose":[NaN,0,0]}"#), "still, at 0 s: advance: expected value"),
        (answering(r#"{"pose":[1e999,0,0]}"#), "still, at 0 s: advance: number out of range"),
        (answering(r#"{"pose":[1e300,0,0]}"#), "still, at 0 s: advance: must answer numbers up to 1e60, found 1e300"),
        (answering(r#"{"pose":[0,0]}"#), "still, at 0 s: advance: invalid length 2, expected an array of length 3"),
        (answering(r#"{"pose":[0,0,0],"speed":1}"#), "still, at 0 s: advance: unknown field `speed`"),
        (answering(r#"{"pose":[0,0,0],"pulls_n":[]}"#), "pulls_n: must have one entry a spring, 1, found 0"),
        (
            answering(r#"{"pose":[0,0,0],"contacts":[{"obstacle":3,"point_m":[0,0],"force_n":[0,0]}]}"#),
            "contacts: must be none without obstacles, found one",
        ),
        (answering(r#"{"pose":[0,0,6.28]}"#), "pose: must have a heading that is not wrapped, found a turn by 6.280 rad in one advance"),
    ] {
        let room = tempfile::tempdir().unwrap();
        let out = room.path().join("out");
        let (output, took) = compare(&script, &["--engine-timeout-s", "0.5", "--out", out.to_str().unwrap()]);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(error.contains("error: --engine: ") && error.contains(expected), "{script}\n{error}\nexpected {expected}");
        assert_eq!(output.status.code(), Some(1), "{script}\n{error}");
        assert!(output.stdout.is_empty() && std::fs::read_dir(room.path()).unwrap().next().is_none(), "{script}");
        // A hang ends at its timeout; three runs wait side by side.
        assert!(took < Duration::from_secs(30), "{script} {took:?}");
    }
}

/// What an engine has not is refused before it starts.
#[test]
fn options_that_an_engine_has_not_are_refused() {
    for (more, expected) in [
        (&["--friction", "box"][..], "--friction: must be left out with --engine, found both"),
        (&["--threshold", "speed"], "--engine: must be left out with --threshold, found both"),
        (&["--vary", "load.mass_kg=1:2:2"], "--engine: must be left out with --vary, found both"),
        (&["--engine-timeout-s", "-1"], "--engine-timeout-s"),
        (&["--engine", " "], "--engine: must be a command, found nothing"),
    ] {
        let (output, _) = compare("exit 9", more);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains(expected), "{error}");
    }
    let ants = root::root().join("scenarios/paper/four-ants-four-springs.json");
    let asked = ["--engine", "exit 9", "--tier", "closed-loop"];
    let output = root::cohaul().arg("compare").arg(ants).args(asked).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(error.contains("--tier: must be one of replayed for ants with --engine, found closed-loop"), "{error}");
}
