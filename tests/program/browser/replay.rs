//! What a reader does with a replay and its curves: zoom, pan, magnified differences, the cursor,
//! and files, in comparisons of scenes of all sizes.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::tempdir;

use crate::driver::Browser;
use crate::{END, HOME, PICTURE, last_pose, time_shown, written};

const BACKENDS: [&str; 3] = ["quasi-static", "inertial", "rapier"];

/// A load of 4 kg, which slips above 20 N, towed over 2 m.
fn two_metres() -> Value {
    json!({
        "name": "two metres",
        "duration_s": 5.0,
        "control_period_s": 0.01,
        "load": { "mass_kg": 4.0, "radius_m": 0.25 },
        "ground": { "friction_coefficient": 0.5, "gravity_m_per_s2": 9.81, "supports": { "tripod": { "radius_m": 0.15 } } },
        "springs": [{
            "root_m": [0.25, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.3,
            "radial_stiffness_n_per_m": 80.0, "torsional_stiffness_nm_per_rad": 2.0, "damping_ratio": 0.1
        }],
        "drive": { "kind": "tips", "paths": [{ "spring": 0, "waypoints": [[0.0, 0.55, 0.0], [4.0, 2.85, 0.6]], "release_s": 4.5 }] }
    })
}

/// A report in a browser, and where its tier wrote its traces.
struct Report<'a> {
    browser: &'a Browser,
    out: PathBuf,
    radius: f64,
}

/// Compares a scene and explores its report. `units` are those of differences, pulls and speeds;
/// `length` is that of the path.
fn compared(scene: &Value, tier: &str, units: [&str; 3], length: &str) {
    let room = tempdir().unwrap();
    let file = room.path().join("scene.json");
    fs::write(&file, scene.to_string()).unwrap();
    let out = written(&room, &["compare", file.to_str().unwrap(), "--tier", tier, "--traces", "csv"]);
    let browser = Browser::start();
    browser.size(1280, 900);
    browser.save_in(room.path());
    browser.open(&out.join("report.html"));
    browser.wait_until("return document.querySelector('.plot canvas')?.dataset.values");
    let radius = scene["load"]["radius_m"].as_f64().unwrap_or_else(|| {
        // Half the diagonal of a rectangle.
        let size = &scene["load"]["outline"]["rectangle"]["size_m"];
        0.5 * size[0].as_f64().unwrap().hypot(size[1].as_f64().unwrap())
    });
    let report = Report { browser: &browser, out, radius };
    report.zooms_and_pans();
    report.magnifies_differences();
    report.follows_its_time(tier, units);
    let path = browser.run("return document.querySelector('.drawing svg').textContent");
    assert!(path.as_str().unwrap().contains(&format!("x ({length})")), "{path}");
    report.is_dark_when_asked();
    report.saves_files(room.path());
    browser.picture(&scene["name"].as_str().unwrap().replace([' ', '/', ':'], "-"));
    assert_eq!(browser.console(), [""; 0]);
}

impl Report<'_> {
    /// What the drawing says of itself.
    fn drawing(&self, what: &str) -> Value {
        self.browser.run(&format!("return JSON.parse(document.querySelector('.replay canvas').dataset.{what})"))
    }

    fn press_button(&self, name: &str) {
        let find = format!("[...document.querySelectorAll('.replay button')].find((it) => it.textContent === '{name}')");
        self.browser.run(&format!("{find}.click()"));
    }

    fn choose(&self, name: &str, value: &str) {
        let find = format!("document.querySelector('.replay select[aria-label=\"{name}\"]')");
        self.browser.run(&format!("const it = {find}; it.value = '{value}'; it.dispatchEvent(new Event('change'))"));
    }

    /// Middle of an element on the screen, with its size (px).
    fn place(&self, what: &str) -> [f64; 4] {
        let found = self.browser.run(&format!(
            "const it = document.querySelector('{what}'); it.scrollIntoView({{ block: 'center' }}); const box = it.getBoundingClientRect(); \
             return [box.left + box.width / 2, box.top + box.height / 2, box.width, box.height]"
        ));
        serde_json::from_value(found).unwrap()
    }

    fn zooms_and_pans(&self) {
        let [x, y, width, _] = self.place(".replay canvas");
        let as_opened = self.browser.run(PICTURE);
        let zoom = || self.drawing("zoom").as_f64().unwrap();
        let middle = || -> [f64; 2] { serde_json::from_value(self.drawing("middle")).unwrap() };
        self.press_button("+");
        assert_eq!((zoom(), middle()), (1.5, [0.0, 0.0]));
        assert_ne!(self.browser.run(PICTURE)[0], as_opened[0]);
        self.press_button("−");
        assert_eq!(zoom(), 1.0);

        // A page that is scrolled leaves the drawing alone, until it is clicked.
        self.browser.run("document.activeElement.blur()");
        let aside = [x + 0.2 * width / 3.0, y - 40.0];
        self.browser.wheel(aside, -100);
        assert_eq!(zoom(), 1.0);
        let [x, y, width, _] = self.place(".replay canvas");
        self.browser.mouse([x, y], [x, y], true);
        let aside = [x + 0.2 * width / 3.0, y - 40.0];
        self.browser.wheel(aside, -200);
        // The place under the mouse stays: it lies right of the middle and above it.
        let [right, up] = middle();
        assert!((zoom() - 2.25).abs() < 1e-12 && right > 0.0 && up > 0.0, "{} {right} {up}", zoom());
        self.browser.wheel(aside, 200);
        let size = right.hypot(up);
        let [right, up] = middle();
        // Rounding of the way there and back.
        assert!((zoom() - 1.0).abs() < 1e-12 && right.hypot(up) < 1e-9 * size, "{right} {up}");

        // Dragged to the right and down, the middle of what is seen goes to the left and up.
        self.browser.mouse([x, y], [x + 40.0, y + 25.0], true);
        let [right, up] = middle();
        assert!(right < 0.0 && up > 0.0 && (right / up + 40.0 / 25.0).abs() < 1e-9, "{right} {up}");
        assert_ne!(self.browser.run(PICTURE)[0], as_opened[0]);
        self.browser.press("+");
        assert_eq!(zoom(), 1.5);
        self.press_button("Reset view");
        assert_eq!((zoom(), middle()), (1.0, [0.0, 0.0]));
    }

    /// Other poses are drawn away from the one chosen by a multiple of their difference.
    fn magnifies_differences(&self) {
        self.browser.run("document.querySelector('.replay canvas').focus()");
        self.browser.press(END);
        let as_computed = self.browser.run(PICTURE);
        let poses = self.drawing("poses");
        assert_eq!(self.drawing("drawn"), poses);
        for (base, factor) in [(0, 10.0), (0, 100.0), (1, 100.0), (1, 1.0), (0, 1.0)] {
            self.choose("differences from", &base.to_string());
            self.choose("drawn", &factor.to_string());
            let drawn = self.drawing("drawn");
            assert_eq!(self.drawing("poses"), poses, "they stay what they are");
            for backend in BACKENDS {
                for at in 0..3 {
                    let [pose, base, drawn] = [&poses[backend], &poses[BACKENDS[base]], &drawn[backend]].map(|it| it[at].as_f64().unwrap());
                    let expected = base + factor * (pose - base);
                    assert!((drawn - expected).abs() <= 1e-12 * (1.0 + expected.abs()), "{backend} x{factor}: {drawn} {expected}");
                }
            }
            assert_eq!(self.browser.run(PICTURE)[0] == as_computed[0], base == 0 && factor == 1.0, "x{factor}");
        }
    }

    /// Each plot has a cursor at the replay's time and the values there; a click on it moves both.
    fn follows_its_time(&self, tier: &str, units: [&str; 3]) {
        let plots = self.browser.run(
            "return [...document.querySelectorAll('.plot canvas')].slice(0, 6).map((it) => [it.ariaLabel ?? it.getAttribute('aria-label'), it.dataset.cursor, \
             it.dataset.values, it.parentElement.textContent])",
        );
        let plots: Vec<[String; 4]> = serde_json::from_value(plots).unwrap();
        let end = time_shown(self.browser);
        assert!(plots.len() == 6 && plots.iter().all(|[_, cursor, ..]| cursor.parse::<f64>().unwrap() == end), "{plots:?}");
        let labels = [(0, "edge displacement apart"), (2, "net pull"), (3, "speed")];
        for ((at, label), unit) in labels.into_iter().zip(units) {
            assert!(plots[at][0].starts_with(&format!("{label} ({unit})")), "{}: {unit}", plots[at][0]);
        }
        assert!(plots[..2].iter().all(|[.., text]| text.contains("tolerance")), "{plots:?}");
        // The differences at the end are those of the traces.
        let values: Value = serde_json::from_str(&plots[0][2]).unwrap();
        let [quasi_static, inertial, rapier] = BACKENDS.map(|backend| last_pose(&self.out, tier, backend));
        let factor = match units[0] {
            "µm" => 1e6,
            "mm" => 1e3,
            _ => 1.0,
        };
        for (pair, a, b) in [("inertial − quasi-static", quasi_static, inertial), ("rapier − inertial", inertial, rapier)] {
            let apart = factor * ((a[0] - b[0]).hypot(a[1] - b[1]) + self.radius * (a[2] - b[2]).abs());
            let shown = values[pair].as_f64().unwrap_or_else(|| panic!("{pair}: {values}"));
            // 32 bits over the decades of the plot.
            assert!((shown / apart - 1.0).abs() < 1e-6, "{pair}: {shown} {apart}");
        }

        // The plot area begins 66 px from the left and ends 12 px before the right.
        let [x, y, width, _] = self.place(".plot:nth-child(4) canvas");
        let (left, right) = (x - 0.5 * width + 66.0, x + 0.5 * width - 12.0);
        let at = [(left + 0.25 * (right - left)).round(), y.round()];
        self.browser.mouse(at, at, false);
        let pointed = "document.querySelector('.plot:nth-child(4) canvas').dataset";
        let under = self.browser.run(&format!("return [Number({pointed}.time), Number({pointed}.cursor)]"));
        let time = end * (at[0] - left) / (right - left);
        // Whole pixels.
        assert!((under[0].as_f64().unwrap() - time).abs() < 2.0 * end / width && under[1] == end, "{under}: {time}");
        self.browser.mouse(at, at, true);
        assert!((time_shown(self.browser) - time).abs() < 2.0 * end / width, "{}: {time}", time_shown(self.browser));
        // Keys go on from there.
        self.browser.press(HOME);
        assert_eq!(time_shown(self.browser), 0.0);
    }

    fn is_dark_when_asked(&self) {
        let is_dark = "const pixel = (it) => { const copy = new OffscreenCanvas(it.width, it.height).getContext('2d'); copy.drawImage(it, 0, 0); \
                       return copy.getImageData(3, 60, 1, 1).data[0]; }; \
                       const canvases = ['.replay canvas', '.plot canvas'].map((it) => pixel(document.querySelector(it)) < 60); \
                       return [...canvases, getComputedStyle(document.querySelector('.drawing svg')).filter !== 'none', \
                               getComputedStyle(document.body).backgroundColor === 'rgb(22, 24, 27)']";
        for expected in [true, false] {
            self.browser.run("document.querySelector('button.scheme').click()");
            assert_eq!(self.browser.run(is_dark), json!(vec![expected; 4]));
        }
    }

    /// Curves as CSV, figures as PNG, the replay as PNG and as a video.
    fn saves_files(&self, folder: &Path) {
        self.browser.run("[...document.querySelectorAll('.plot button')].find((it) => it.textContent === 'CSV').click()");
        let mut table = csv::Reader::from_path(saved(folder, "1-edge-displacement-apart.csv")).unwrap();
        let header: Vec<String> = table.headers().unwrap().iter().map(str::to_owned).collect();
        assert_eq!(header[..2], ["curve", "time (s)"]);
        let rows: Vec<(String, f64, f64)> = table.deserialize().map(Result::unwrap).collect();
        assert!(rows.len() > 100 && rows.iter().all(|(curve, time, value)| !curve.is_empty() && *time >= 0.0 && *value > 0.0));
        for (what, name) in [(".plot", "2-heading-apart.png"), (".drawing", ".png"), (".replay", "replay.png")] {
            let nth = if what == ".plot" { 1 } else { 0 };
            self.browser
                .run(&format!("[...document.querySelectorAll('{what} button')].filter((it) => it.textContent === 'PNG')[{nth}].click()"));
            let bytes = fs::read(saved(folder, name)).unwrap();
            assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 5000, "{what}: {} bytes", bytes.len());
            fs::remove_file(saved(folder, name)).unwrap();
        }
        // About a second of film.
        let end = self.browser.run("return Number(document.querySelector('.replay input').max)").as_f64().unwrap();
        let speed = [0.1, 1.0, 2.0, 5.0, 10.0].into_iter().rfind(|speed| *speed <= end).unwrap_or(0.1);
        self.choose("speed", &speed.to_string());
        self.press_button("Video");
        let film = fs::read(saved(folder, "replay.webm")).unwrap();
        assert!(film.starts_with(b"\x1a\x45\xdf\xa3") && film.len() > 5000, "{} bytes", film.len());
        assert_eq!(time_shown(self.browser), end, "it ends with the replay");
    }
}

/// The file with that end of its name, once it is whole.
fn saved(folder: &Path, name: &str) -> PathBuf {
    let end = Instant::now() + Duration::from_secs(30);
    while Instant::now() < end {
        let files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        // An empty file holds the name while Chromium writes another one beside it.
        let is_whole = |file: &PathBuf| fs::metadata(file).is_ok_and(|data| data.len() > 0);
        let ends_with = |end: &str| files.iter().find(|file| file.to_str().unwrap().ends_with(end));
        if let (Some(file), None) = (ends_with(name).filter(|file| is_whole(file)), ends_with(".crdownload")) {
            return file.clone();
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("no file that ends with {name} in {}", folder.display());
}

fn shipped(name: &str) -> Value {
    let file = crate::root::root().join(format!("scenarios/{name}.json"));
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn a_comparison_of_a_release_is_explored() {
    // A jump without inertia takes one row.
    compared(&shipped("analytic/release-jump"), "prescribed", ["mm", "mN", "m/s"], "mm");
}

#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn a_comparison_with_obstacles_is_explored() {
    compared(&shipped("contact/post-jump"), "prescribed", ["mm", "mN", "mm/s"], "mm");
}

#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn a_comparison_of_robots_is_explored() {
    compared(&shipped("robots/two-fingers"), "prescribed", ["mm", "N", "mm/s"], "mm");
}

#[test]
#[ignore = "needs Chromium and ChromeDriver"]
fn a_comparison_of_two_metres_and_twenty_newtons_is_explored() {
    compared(&two_metres(), "prescribed", ["mm", "N", "mm/s"], "m");
}
