//! Changes of a scene on the live page: they are compared, kept, taken back and saved.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::tempdir;

use crate::driver::Browser;
use crate::live::{Served, click, handle, poses, saved_scenario, shown, slide, time};

/// A page of a scene of `scenarios/`, once it is drawn.
fn opened(scene: &str) -> (Served, Browser) {
    let served = Served::start(&crate::root::root().join("scenarios").join(scene));
    let browser = Browser::start();
    browser.size(1400, 1000);
    open(&browser, &served);
    (served, browser)
}

fn open(browser: &Browser, served: &Served) {
    browser.open_link(&served.link);
    browser.wait_until("return document.querySelector('.replay canvas')?.dataset.frame > 0 && location.hash.startsWith('#s=')");
}

/// Moves the bar of time.
fn scrub(browser: &Browser, to: f64) {
    browser.run(&format!("const bar = document.querySelector('.track input'); bar.value = {to}; bar.dispatchEvent(new Event('input'))"));
}

/// Waits until the page has computed up to a time (s).
fn wait_for_end(browser: &Browser, end: f64) {
    browser.wait_until(&format!("return document.querySelector('.replay canvas').dataset.end >= {end}"));
}

fn slider(browser: &Browser) -> Value {
    browser.run("return Number(document.querySelector('.panel input[name=inertia]').value)")
}

/// The run before a change stays beside the one after it, at every time; Undo and a reload bring
/// back what was, and a page that comes later is offered the last change.
#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn runs_before_and_after_a_change_are_compared_and_kept() {
    let (served, browser) = opened("analytic/release-jump.json");
    assert_eq!(browser.run("return document.querySelector('select[aria-label=pace]').value"), "0.5", "2.5 s last 5 s");
    scrub(&browser, 2.5);
    wait_for_end(&browser, 2.4999);
    scrub(&browser, 1.6);
    assert!((time(&browser) - 1.6).abs() < 1e-9 && shown(&browser, "end").as_f64().unwrap() > 2.4999);
    let before = poses(&browser);
    browser.picture("live-scrubbed");

    slide(&browser, "inertia", 700);
    browser.wait_until("return document.querySelector('.replay canvas').dataset.before >= 2.4999");
    wait_for_end(&browser, 2.4999);
    assert!((time(&browser) - 1.6).abs() < 1e-9);
    let after = poses(&browser);
    assert_ne!(after, before);
    // The values of a curve at the time that is shown, and those before.
    let values = browser.run("return document.querySelector('.plot .values').textContent");
    assert_eq!(values.as_str().unwrap().matches("(before ").count(), 3, "{values}");
    browser.picture("live-before-and-after");

    browser.wait_until("return history.state?.at === 1");
    browser.run("location.reload()");
    browser.wait_until("return document.querySelector('.panel input[name=inertia]')?.value == 700 && document.querySelector('.replay canvas').dataset.end > 0");
    click(&browser, "Undo");
    browser.wait_until("return document.querySelector('.panel input[name=inertia]').value == 500");
    wait_for_end(&browser, 2.4999);
    scrub(&browser, 1.6);
    browser.wait_until("return Math.abs(document.querySelector('.replay canvas').dataset.time - 1.6) < 1e-9");
    let undone = poses(&browser);
    assert!(
        undone.iter().flatten().zip(before.iter().flatten()).all(|(found, expected)| (found - expected).abs() < 1e-9),
        "{undone:?} {before:?}"
    );
    // What is pale now is what was undone, not what was before the change.
    browser.wait_until("return document.querySelector('.share').textContent.includes('pale: before Undo or Redo')");
    click(&browser, "Redo");
    browser.wait_until("return document.querySelector('.panel input[name=inertia]').value == 700");

    browser.open_link("about:blank");
    open(&browser, &served);
    assert_eq!(slider(&browser), 500);
    click(&browser, "Open it again");
    browser.wait_until("return document.querySelector('.panel input[name=inertia]').value == 700");
    assert_eq!(browser.console(), [""; 0]);
}

/// A hand that leaps is followed softly: the speed of what it drags changes in a frame by less than
/// three quarters of the largest speed. A critically damped spring of 12 /s comes to the largest
/// speed after a leap in 1/12 s, and to 0.65 of it in the two control periods of a frame.
#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn a_hand_drags_softly_and_its_force_is_shown() {
    let room = tempdir().unwrap();
    let (_served, browser) = opened("robots/tow-past-corner.json");
    browser.save_in(room.path());
    let from = handle(&browser, "tips", 0);
    browser.drag_slowly(from, [from[0] + 60.0, from[1] - 60.0]);
    assert!(shown(&browser, "force").as_f64().unwrap() > 0.0, "the spring pulls at the hand");
    let scenario = read(&saved_scenario(&browser, room.path()));
    let path: Vec<[f64; 3]> = serde_json::from_value(scenario["drive"]["paths"][0]["waypoints"].clone()).unwrap();
    let speeds: Vec<f64> =
        path.windows(2).map(|pair| (pair[1][1] - pair[0][1]).hypot(pair[1][2] - pair[0][2]) / (pair[1][0] - pair[0][0])).collect();
    let most = speeds.iter().copied().fold(0.0, f64::max);
    let leap = speeds.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    assert!(speeds.len() > 20 && most > 0.0 && leap < 0.75 * most, "{speeds:?}");
    assert_eq!(browser.console(), [""; 0]);
}

fn read(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// Where a grip is on the page (px).
fn grip(browser: &Browser, name: &str) -> [f64; 2] {
    browser.wait_until(&format!("return document.querySelector('.replay canvas').dataset.grips?.includes('{name}')"));
    let found = browser.run(&format!(
        "const canvas = document.querySelector('.replay canvas'), box = canvas.getBoundingClientRect(); \
         const [, x, y] = JSON.parse(canvas.dataset.grips).find(([name]) => name === '{name}'); return [box.left + x, box.top + y]"
    ));
    [0, 1].map(|axis| found[axis].as_f64().unwrap())
}

/// A scene is edited by mouse, by finger and by keys. The saved file has what was edited, and the
/// program gives it the verdict of the page.
#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn a_scene_is_edited_and_the_program_gives_it_the_same_verdict() {
    let room = tempdir().unwrap();
    let (_served, browser) = opened("contact/rebound.json");
    browser.save_in(room.path());
    click(&browser, "Edit");
    // A disc is added and drawn to another place with the mouse, the wall is moved by a finger.
    grip(&browser, "wall: place");
    click(&browser, "Disc");
    let disc = grip(&browser, "disc: place");
    browser.drag_slowly(disc, [disc[0] + 40.0, disc[1] - 30.0]);
    let moved = grip(&browser, "disc: place");
    assert!((moved[0] - disc[0] - 40.0).hypot(moved[1] - disc[1] + 30.0) < 3.0, "{disc:?} {moved:?}");
    browser.finger();
    let wall = grip(&browser, "wall: place");
    browser.swipe(wall, [wall[0] + 25.0, wall[1]]);
    let after = grip(&browser, "wall: place");
    assert!((after[0] - wall[0] - 25.0).abs() < 3.0, "{wall:?} {after:?}");
    // A number is typed.
    browser.run(
        "const field = document.querySelector('.fields input[name=\"obstacles.0.restitution\"]'); \
         field.value = 0.25; field.dispatchEvent(new Event('change'))",
    );
    // What breaks a rule is refused in view, and changes nothing.
    browser.run(
        "const field = document.querySelector('.fields input[name=\"obstacles.0.restitution\"]'); \
         field.value = -1; field.dispatchEvent(new Event('change'))",
    );
    browser.wait_until("return document.querySelector('.told').textContent.includes('restitution')");
    let told = browser
        .run("const box = document.querySelector('.told').getBoundingClientRect(); return box.top >= 0 && box.bottom <= innerHeight");
    assert_eq!(told, true);
    browser.picture("live-edit");
    browser.wait_until("return document.querySelector('#verdict').dataset.valid !== ''");
    let (valid, answer) = (
        browser.run("return document.querySelector('#verdict').dataset.valid"),
        browser.run("return document.querySelector('.sentence').textContent"),
    );
    let file = saved_scenario(&browser, room.path());
    let scenario = read(&file);
    assert_eq!(scenario["obstacles"][0]["restitution"], 0.25);
    assert_eq!(scenario["obstacles"][1]["name"], "disc");
    assert!(scenario["obstacles"][0]["position_m"][0].as_f64().unwrap() > 0.0);
    let output = crate::root::cohaul().args(["compare", "--json"]).arg(&file).output().unwrap();
    let compared: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(compared["answer"], answer, "{valid}");
    assert_eq!(browser.console(), [""; 0]);
}

/// Each part of an outline has a place that can be dragged and typed, and can be taken out alone.
#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn a_part_of_an_outline_is_moved_and_removed() {
    let room = tempdir().unwrap();
    let (_served, browser) = opened("robots/two-fingers.json");
    browser.save_in(room.path());
    click(&browser, "Edit");
    let part = grip(&browser, "fingers: part 1: place");
    browser.drag_slowly(part, [part[0] - 20.0, part[1] + 15.0]);
    let moved = grip(&browser, "fingers: part 1: place");
    assert!((moved[0] - part[0] + 20.0).hypot(moved[1] - part[1] - 15.0) < 3.0, "{part:?} {moved:?}");
    let parts = |room: &Path| read(&saved_scenario(&browser, room))["obstacles"][0]["outline"]["compound"]["parts"].take();
    let found = parts(room.path());
    let place: [f64; 2] = serde_json::from_value(found[1]["position_m"].clone()).unwrap();
    assert!(place[0] < -0.12 && place[1] < -0.1 && found[0]["position_m"] == serde_json::json!([-0.12, 0.1]), "{found}");
    click(&browser, "Remove");
    browser.wait_until("return !document.querySelector('.replay canvas').dataset.grips.includes('part 1')");
    let room = tempdir().unwrap();
    browser.save_in(room.path());
    assert_eq!(parts(room.path()).as_array().unwrap().len(), 1);
    assert_eq!(browser.console(), [""; 0]);
}

/// On a phone the whole page is used by a finger: it scrolls past the drawing, and drags what it
/// takes.
#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn a_phone_scrolls_past_the_drawing_and_drags_in_it() {
    let served = Served::start(&crate::root::root().join("scenarios/analytic/release-jump.json"));
    let browser = Browser::start();
    browser.phone(390, 844);
    open(&browser, &served);
    browser.picture("live-phone");
    let seen = browser.run(
        "const box = document.querySelector('.replay canvas').getBoundingClientRect(); \
         return [document.documentElement.scrollWidth, box.height, box.left + 0.15 * box.width, box.top + 0.85 * box.height]",
    );
    let at = |i: usize| seen[i].as_f64().unwrap();
    assert!(at(0) <= 390.0 && at(1) <= 0.61 * 844.0, "{seen}");
    let (before, from) = (poses(&browser), handle(&browser, "tips", 0));
    browser.swipe(from, [from[0] + 60.0, from[1] - 60.0]);
    browser.wait_until("return document.querySelector('.replay canvas').dataset.playing === 'false'");
    assert_eq!(browser.run("return window.scrollY"), 0);
    assert!(time(&browser) > 0.0 && poses(&browser) != before, "the finger drags a tip");
    browser.swipe([at(2), at(3)], [at(2), at(3) - 200.0]);
    browser.wait_until("return window.scrollY > 50");
    assert_eq!(browser.console(), [""; 0]);
}
