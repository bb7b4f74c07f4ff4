//! Reports in a real browser: what is seen first, that nothing is asked of a network, that the
//! replay draws what the traces hold, and keys; and the live testbed.
//!
//! `cargo test --test browser -- --ignored`, with Chromium and ChromeDriver on the path.

mod changes;
mod driver;
mod live;
mod replay;
#[path = "../../common/root.rs"]
mod root;

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use driver::Browser;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

const HOSTILE: &str = "</script><b id=hostile>four ants</b>";
const END: &str = "\u{e010}";
const HOME: &str = "\u{e011}";
const RIGHT: &str = "\u{e014}";

/// Some seconds of the paper's four ants, in which they grasp, pull and let go.
fn scene(room: &TempDir) -> PathBuf {
    let paper = root::root().join("scenarios/paper/four-ants-four-springs.json");
    let mut scenario: Value = serde_json::from_str(&fs::read_to_string(paper).unwrap()).unwrap();
    scenario["name"] = HOSTILE.into();
    scenario["duration_s"] = json!(8.0);
    let file = room.path().join("scene.json");
    fs::write(&file, scenario.to_string()).unwrap();
    file
}

/// Runs the program and gives the folder that it wrote to.
fn written(room: &TempDir, args: &[&str]) -> PathBuf {
    let out = room.path().join("out");
    let mut command = Command::from_std(root::cohaul());
    command.args(args).arg("--out").arg(&out).assert().code(0);
    out
}

/// x, y and heading in the last row of a trace.
fn last_pose(out: &Path, tier: &str, backend: &str) -> [f64; 3] {
    let mut table = csv::Reader::from_path(out.join(format!("trace-{tier}-{backend}.csv"))).unwrap();
    let row = table.records().last().unwrap().unwrap();
    [1, 2, 3].map(|column| row[column].parse().unwrap())
}

/// A number that changes with the picture on the first canvas, how many colours are on it, and red
/// near a corner of it. Read from a copy: the browser remarks on canvases that are read again and
/// again.
const PICTURE: &str = "const canvas = document.querySelector('.replay canvas'); \
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true }); copy.drawImage(canvas, 0, 0); \
    const pixels = new Uint32Array(copy.getImageData(0, 0, canvas.width, canvas.height).data.buffer); \
    let sum = 0; for (const pixel of pixels) sum = (Math.imul(sum, 31) + pixel) | 0; \
    return [sum, new Set(pixels).size, copy.getImageData(3, 60, 1, 1).data[0]];";

fn time_shown(browser: &Browser) -> f64 {
    browser.run("return Number(document.querySelector('.replay canvas').dataset.time)").as_f64().unwrap()
}

#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn a_comparison_answers_on_its_first_screen_and_replays_its_traces() {
    let room = tempdir().unwrap();
    let out = written(&room, &["compare", scene(&room).to_str().unwrap(), "--seeds", "2", "--traces", "csv"]);
    let browser = Browser::start();
    browser.size(1280, 800);
    browser.open(&out.join("report.html"));
    browser.picture("comparison");

    // First screen: title, verdict and all that it rests on, with the replay in sight.
    let seen = browser.run(
        "const box = (what) => document.querySelector(what).getBoundingClientRect(); const verdict = box('#verdict'); \
         return [document.querySelector('h1').textContent, document.querySelector('.verdict').textContent, verdict.top, verdict.bottom, \
                 box('.replay').top, document.querySelectorAll('#hostile').length, box('#verdict svg').bottom]",
    );
    assert_eq!(seen[0], format!("{HOSTILE}: is quasi-static valid?"));
    let found: Value = serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    let replayed = &found["tiers"]["replayed"];
    let has_inertia = |quantity: &str| replayed["verdicts"][quantity]["verdict"].as_str().unwrap().starts_with("inertia");
    // The headline is the answer of the terminal and the JSON, and it follows from the numbers.
    let answer = found["answer"].as_str().unwrap();
    // The page keeps numbers and units on one line by a space that does not break.
    assert!(seen[1].as_str().unwrap().replace('\u{a0}', " ").contains(answer), "{answer}: {seen}");
    assert_eq!(answer.contains("Quasi-static is not valid for the path ("), has_inertia("path"), "{answer}");
    assert_eq!(answer.contains("Quasi-static is valid for the path ("), replayed["verdicts"]["path"]["verdict"] == "agree", "{answer}");
    assert!(seen[2].as_f64().unwrap() >= 0.0 && seen[3].as_f64().unwrap() <= 800.0 && seen[4].as_f64().unwrap() < 800.0, "{seen}");
    assert_eq!(seen[5], 0, "a name is no markup");

    // Nothing from elsewhere, and nothing could be: the page's own policy stops a picture of
    // another host.
    assert_eq!(browser.run("return performance.getEntriesByType('resource').length"), 0);
    assert_eq!(browser.console(), [""; 0]);
    browser.run(
        "document.addEventListener('securitypolicyviolation', (event) => { window.stopped = event.blockedURI; }); \
         new Image().src = 'http://127.0.0.1:9/picture.png';",
    );
    browser.wait_until("return window.stopped === 'http://127.0.0.1:9/picture.png'");
    browser.console();

    // Drawings: charts, overviews of both tiers, and no name twice.
    assert!(browser.run("return document.querySelectorAll('main figure > div > svg').length").as_u64().unwrap() >= 4);
    assert_eq!(
        browser.run("const ids = [...document.querySelectorAll('[id]')].map((it) => it.id); return ids.length - new Set(ids).size"),
        0
    );

    // The picture is one, and another one at another time; the clock goes with it.
    let at_opening = browser.run(PICTURE);
    assert!(at_opening[1].as_u64().unwrap() > 50, "{at_opening}");
    browser.run("const scrub = document.querySelector('.replay input'); scrub.value = 5.5; scrub.dispatchEvent(new Event('input'))");
    assert_eq!(time_shown(&browser), 5.5);
    assert_ne!(browser.run(PICTURE)[0], at_opening[0]);
    let shown = browser.run("return [document.querySelector('.time').textContent, document.querySelector('.replay input').ariaValueText ?? document.querySelector('.replay input').getAttribute('aria-valuetext')]");
    assert_eq!(shown, json!(["5.500 s of 8.00 s", "5.500 s"]));

    keys(&browser);
    last_poses(&browser, &out);
    for (name, pressed) in [("Overlay", "true"), ("Follow the load", "false")] {
        let before = browser.run(PICTURE);
        let click = format!(
            "const button = [...document.querySelectorAll('.replay button')].find((it) => it.textContent === '{name}'); button.click(); return button.ariaPressed"
        );
        assert_eq!(browser.run(&click), pressed);
        assert_ne!(browser.run(PICTURE)[0], before[0], "{name}");
    }
    browser.picture("overlay");
    looks(&browser);
    assert_eq!(browser.console(), [""; 0]);
}

/// Space plays and stops, arrows go instant by instant, Home and End to the ends, brackets to
/// events.
fn keys(browser: &Browser) {
    browser.run("document.querySelector('.replay canvas').focus()");
    browser.press(HOME);
    assert_eq!(time_shown(browser), 0.0);
    browser.press(" ");
    browser.wait_until("return Number(document.querySelector('.replay canvas').dataset.time) > 0.2");
    browser.press(" ");
    let stopped = time_shown(browser);
    assert_eq!(browser.run("return document.querySelector('.play').textContent"), "Play");
    browser.press(RIGHT);
    let later = time_shown(browser);
    assert!(later > stopped && later < stopped + 0.2, "{stopped} {later}");
    browser.press(HOME);
    browser.press("]");
    let event = browser.run("return document.querySelector('.said').textContent");
    assert!(time_shown(browser) > 0.0 && event.as_str().unwrap().starts_with("Last event: "), "{event}");
}

/// At the end every load is drawn where its trace ends.
fn last_poses(browser: &Browser, out: &Path) {
    browser.press(END);
    let poses = browser.run("return JSON.parse(document.querySelector('.replay canvas').dataset.poses)");
    for backend in ["quasi-static", "inertial", "rapier"] {
        for (shown, traced) in poses[backend].as_array().unwrap().iter().zip(last_pose(out, "replayed", backend)) {
            // 32 bits over less than 10 m or rad.
            assert!((shown.as_f64().unwrap() - traced).abs() < 3e-9, "{backend}: {poses}");
        }
    }
}

/// On a dark page and on a narrow one.
fn looks(browser: &Browser) {
    let light = browser.run(PICTURE);
    assert!(light[2].as_u64().unwrap() > 200, "{light}");
    browser.scheme("dark");
    // The script hears of it after the style does.
    browser.wait_until(&format!(
        "return getComputedStyle(document.body).backgroundColor === 'rgb(22, 24, 27)' && (() => {{ {PICTURE} }})()[2] < 60"
    ));
    browser.picture("dark");
    browser.scheme("light");
    browser.size(400, 800);
    let width = browser
        .run("return [document.documentElement.scrollWidth, document.querySelector('.replay canvas').getBoundingClientRect().width]");
    assert!(width[0].as_u64().unwrap() <= 400 && width[1].as_f64().unwrap() > 300.0, "{width}");
    browser.picture("narrow");
}

/// A jammed disc is drawn with the two points at which it touches the walls of the notch. They are
/// inclined by 45 degrees, so that the points lie R / sqrt(2) beside and below the centre.
#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn contacts_are_drawn_where_the_load_touches() {
    let browser = Browser::start();
    browser.size(1280, 800);
    let scene = root::root().join("scenarios/contact/notch-jam.json");
    let room = tempdir().unwrap();
    let out = written(&room, &["run", scene.to_str().unwrap(), "--report"]);
    browser.open(&out.join("report.html"));
    browser.run("document.querySelector('.replay canvas').focus()");
    browser.press(END);
    browser.picture("notch-jam");
    let drawn = browser.run("return JSON.parse(document.querySelector('.replay canvas').dataset.contacts)");
    let mut points: Vec<[f64; 2]> = serde_json::from_value(drawn["quasi-static"].clone()).unwrap();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let away = 0.0122 / 2_f64.sqrt();
    let expected = [[-away, 0.017253405461 - away], [away, 0.017253405461 - away]];
    // 16 bits over some 40 mm.
    let is_near = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-6;
    assert!(points.len() == 2 && points.iter().zip(&expected).all(is_near), "{points:?}");
    let table = browser.run("return document.body.textContent.includes('touches notch')");
    assert_eq!(table, true);
    assert_eq!(browser.console(), [""; 0]);
}

/// Reports of runs: with ants, without springs, and with more parts than are drawn.
#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn runs_of_all_kinds_are_replayed() {
    let browser = Browser::start();
    browser.size(1280, 800);
    let scenarios = root::root().join("scenarios");
    for name in ["analytic/slide", "analytic/release-jump", "stress/thousand-springs", "stress/tip-jump"] {
        let room = tempdir().unwrap();
        let out = written(&room, &["run", scenarios.join(format!("{name}.json")).to_str().unwrap(), "--report"]);
        browser.open(&out.join("report.html"));
        browser.picture(&name.replace('/', "-"));
        let picture = browser.run(PICTURE);
        assert!(picture[1].as_u64().unwrap() > 10, "{name}: {picture}");
        browser.run("document.querySelector('.replay canvas').focus()");
        browser.press(END);
        let summary: Value = serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
        let poses = browser.run("return JSON.parse(document.querySelector('.replay canvas').dataset.poses)");
        let shown = poses["quasi-static"][0].as_f64().unwrap();
        // As in a comparison.
        assert!((shown - summary["final"]["position_m"][0].as_f64().unwrap()).abs() < 3e-9, "{name}: {poses}");
        assert_eq!(browser.console(), [""; 0], "{name}");
    }
}
