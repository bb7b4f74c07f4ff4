//! The live testbed in a real browser.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};

use serde_json::Value;
use tempfile::tempdir;

use crate::driver::Browser;

/// `cohaul view` as a child; it ends with this.
pub struct Served {
    child: Child,
    pub link: String,
}

impl Served {
    pub fn start(scenario: &Path) -> Self {
        let mut command = crate::root::cohaul();
        let mut child = command.arg("view").arg(scenario).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut link = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut link).unwrap();
        Self { child, link: link.trim().to_owned() }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

const BACKENDS: [&str; 3] = ["quasi-static", "inertial", "rapier"];

/// What the drawing says of itself.
pub fn shown(browser: &Browser, what: &str) -> Value {
    let text = browser.run(&format!("return document.querySelector('.replay canvas')?.dataset.{what} ?? ''"));
    serde_json::from_str(text.as_str().unwrap()).unwrap_or(text)
}

pub fn time(browser: &Browser) -> f64 {
    shown(browser, "time").as_f64().unwrap()
}

pub fn click(browser: &Browser, name: &str) {
    browser.run(&format!("[...document.querySelectorAll('button')].find((it) => it.textContent === '{name}').click()"));
}

/// Moves a slider to a share of its way (1/1000).
pub fn slide(browser: &Browser, key: &str, to: u32) {
    browser.run(&format!(
        "const slider = document.querySelector('.panel input[name={key}]'); slider.value = {to}; slider.dispatchEvent(new Event('input')); slider.dispatchEvent(new Event('change'))"
    ));
}

pub fn wait_for_verdict(browser: &Browser, valid: &str) {
    browser.wait_until(&format!("return document.querySelector('#verdict').dataset.valid === '{valid}'"));
}

/// Place of a tip or a pusher in the first view, on the page (px).
pub fn handle(browser: &Browser, kind: &str, number: usize) -> [f64; 2] {
    let corner = browser.run("const box = document.querySelector('.replay canvas').getBoundingClientRect(); return [box.left, box.top]");
    let place = &shown(browser, "handles")[kind][number];
    [0, 1].map(|axis| corner[axis].as_f64().unwrap() + place[axis].as_f64().unwrap())
}

pub fn poses(browser: &Browser) -> Vec<[f64; 3]> {
    let poses = shown(browser, "poses");
    BACKENDS.map(|name| [0, 1, 2].map(|at| poses[name][at].as_f64().unwrap())).to_vec()
}

#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn a_scene_is_played_changed_dragged_and_saved() {
    let room = tempdir().unwrap();
    // A load that is towed slowly: quasi-static is valid.
    let scene = crate::root::root().join("scenarios/analytic/centre-pull.json");
    let served = Served::start(&scene);
    let browser = Browser::start();
    browser.size(1400, 1000);
    browser.save_in(room.path());
    browser.open_link(&served.link);
    browser.wait_until("return document.querySelector('.replay canvas')?.dataset.frame > 0");
    let verdict = "return document.querySelector('#verdict').dataset.valid";
    browser.wait_until(&format!("return Boolean((() => {{ {verdict} }})())"));
    let first = browser.run(verdict);
    browser.picture("live");

    // One control period, then on its own.
    click(&browser, "▸");
    browser.wait_until("return document.querySelector('.replay canvas').dataset.time == 0.001");
    click(&browser, "Play");
    browser.wait_until("return Number(document.querySelector('.replay canvas').dataset.time) > 0.1");
    click(&browser, "Pause");
    browser.wait_until("return document.querySelector('.replay canvas').dataset.playing === 'false'");
    let stopped = time(&browser);

    // A load a hundred times as heavy in inertia is another matter, and it is seen at the same
    // time.
    slide(&browser, "inertia", 1000);
    browser.wait_until(&format!("const now = (() => {{ {verdict} }})(); return now !== '' && now !== '{}'", first.as_str().unwrap()));
    let stands_there = format!("return Math.abs(document.querySelector('.replay canvas').dataset.time - {stopped}) < 1e-6");
    browser.wait_until(&stands_there);
    slide(&browser, "inertia", 500);
    wait_for_verdict(&browser, first.as_str().unwrap());
    browser.wait_until(&stands_there);

    // A dragged tip takes the load along on all backends.
    let before = poses(&browser);
    let from = handle(&browser, "tips", 0);
    browser.drag_slowly(from, [from[0] - 60.0, from[1] - 90.0]);
    let after = poses(&browser);
    for ((before, after), name) in before.iter().zip(&after).zip(BACKENDS) {
        let way = (after[0] - before[0]).hypot(after[1] - before[1]);
        assert!(way > 1e-3, "{name} moved by {way} m");
    }
    browser.picture("live-dragged");
    saved_path_is_shown_again(&browser, room.path());
    link_shows_the_same(&browser);
    assert_eq!(browser.console(), [""; 0]);
}

/// The saved scenario is run by the program, on each backend: the poses at the time that is shown
/// are those of the page.
fn saved_path_is_shown_again(browser: &Browser, room: &Path) {
    browser.wait_until("return document.querySelector('.replay canvas').dataset.playing === 'false'");
    let (now, poses) = (time(browser), poses(browser));
    let mut scenario: Value = serde_json::from_str(&fs::read_to_string(saved_scenario(browser, room)).unwrap()).unwrap();
    assert!(scenario["drive"]["paths"][0]["waypoints"].as_array().unwrap().len() > 10);
    scenario["duration_s"] = now.into();
    let ended = room.join("ended.txt");
    fs::write(&ended, scenario.to_string()).unwrap();
    for (pose, backend) in poses.iter().zip(BACKENDS) {
        let output = crate::root::cohaul().args(["run", "--json", "--backend", backend]).arg(&ended).output().unwrap();
        let run: Value = serde_json::from_slice(&output.stdout).unwrap();
        let end = &run["final"];
        let found = [end["position_m"][0].as_f64().unwrap(), end["position_m"][1].as_f64().unwrap(), end["heading_rad"].as_f64().unwrap()];
        assert_eq!(found, *pose, "{backend}");
    }
}

/// The file of a scene that the page saves in this folder.
pub fn saved_scenario(browser: &Browser, room: &Path) -> PathBuf {
    click(browser, "Save scenario");
    browser.wait_until("return Boolean(document.querySelector('.replay canvas').dataset.saved)");
    let is_scenario = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "json");
    let file = (0..200).find_map(|_| {
        std::thread::sleep(std::time::Duration::from_millis(50));
        fs::read_dir(room).unwrap().map(|entry| entry.unwrap().path()).find(is_scenario)
    });
    file.expect("a file is saved")
}

/// The copied link opens the same scene at the same time.
fn link_shows_the_same(browser: &Browser) {
    let (now, before) = (time(browser), poses(browser));
    browser.run("window.address = location.href");
    click(browser, "Copy link");
    browser.wait_until("return document.querySelector('.told').textContent.includes('link')");
    browser.run("location.reload()");
    browser.wait_until("return window.address === undefined");
    browser.wait_until(&format!("return Math.abs(document.querySelector('.replay canvas')?.dataset.time - {now}) < 1e-9"));
    assert_eq!(poses(browser), before);
}

/// Four ants on three backends as fast as they live: the simulated time keeps up with the real one.
#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn four_ants_are_live_on_three_backends() {
    let served = Served::start(&crate::root::root().join("scenarios/paper/four-ants-four-springs.json"));
    let browser = Browser::start();
    browser.size(1400, 1000);
    browser.open_link(&served.link);
    browser.wait_until("return document.querySelector('.replay canvas')?.dataset.frame > 0");
    click(&browser, "Play");
    browser.wait_until("return Number(document.querySelector('.replay canvas').dataset.time) > 3");
    println!("computing over simulated time {}, frames drawn a second {}", shown(&browser, "share"), shown(&browser, "fps"));
    // The debug build is slower by far than a release, and still ahead of time.
    assert!(shown(&browser, "share").as_f64().unwrap() < 1.0);
    click(&browser, "Pause");
    // Ants off: their tips are free, and a hand takes one.
    click(&browser, "Ants");
    browser.wait_until("return document.querySelector('button.ants').ariaPressed === 'false' && Number(document.querySelector('.replay canvas').dataset.time) > 2.9");
    let before = poses(&browser);
    let from = handle(&browser, "tips", 0);
    browser.drag_slowly(from, [from[0] + 160.0, from[1]]);
    assert!(poses(&browser).iter().zip(&before).all(|(after, before)| (after[0] - before[0]).hypot(after[1] - before[1]) > 1e-4));
    browser.picture("live-hand");
    assert_eq!(browser.console(), [""; 0]);
}
