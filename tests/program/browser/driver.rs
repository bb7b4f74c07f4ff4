//! A browser without a window, led through WebDriver: JSON over HTTP to a ChromeDriver of its own.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use serde_json::{Value, json};
use tempfile::TempDir;

/// One browser with a fresh profile. Both it and its driver end with this.
pub struct Browser {
    driver: Child,
    session: String,
    /// Kept until the end.
    _profile: TempDir,
}

const FLAGS: [&str; 9] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
];

impl Browser {
    /// With `CHROMEDRIVER` as the driver, or `chromedriver` of the path.
    pub fn start() -> Self {
        let program = std::env::var("CHROMEDRIVER").unwrap_or_else(|_| "chromedriver".to_owned());
        let mut command = Command::new(&program);
        command.arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null());
        let mut driver = command.spawn().unwrap_or_else(|error| panic!("{program}: {error}; install Chromium and ChromeDriver"));
        let lines = BufReader::new(driver.stdout.take().expect("it is piped")).lines().map_while(Result::ok);
        let port = lines.map(|line| line.trim_end_matches('.').to_owned()).find_map(|line| {
            let (before, port) = line.rsplit_once("on port ")?;
            before.contains("successfully").then(|| port.to_owned())
        });
        let root = format!("http://127.0.0.1:{}", port.expect("the driver names its port"));
        let profile = tempfile::tempdir().unwrap();
        let profile_flag = format!("--user-data-dir={}", profile.path().display());
        let flags: Vec<&str> = FLAGS.into_iter().chain([profile_flag.as_str()]).collect();
        let wish = json!({ "browserName": "chrome", "goog:chromeOptions": { "args": flags }, "goog:loggingPrefs": { "browser": "ALL" } });
        let made = call(&format!("{root}/session"), &json!({ "capabilities": { "alwaysMatch": wish } }));
        let session = format!("{root}/session/{}", made["sessionId"].as_str().expect("a session has a name"));
        Self { driver, session, _profile: profile }
    }

    pub fn open(&self, file: &Path) {
        self.post("url", &json!({ "url": format!("file://{}", file.display()) }));
    }

    pub fn open_link(&self, link: &str) {
        self.post("url", &json!({ "url": link }));
    }

    /// What the body of a function gives back.
    pub fn run(&self, script: &str) -> Value {
        self.post("execute/sync", &json!({ "script": script, "args": [] }))
    }

    /// The same, waited for until it is true.
    pub fn wait_until(&self, script: &str) {
        let script = format!(
            "const done = arguments[0], end = performance.now() + 20000; \
             const look = () => {{ const found = (() => {{ {script} }})(); found || performance.now() > end ? done(Boolean(found)) : setTimeout(look, 20); }}; look();"
        );
        // A driver ends a script after 30 s, and a busy machine may take longer.
        let looked = || self.post("execute/async", &json!({ "script": script, "args": [] })) == Value::Bool(true);
        assert!((0..3).any(|_| looked()), "never: {script}");
    }

    /// Presses and lets go of a key, `" "` or one by its WebDriver code.
    pub fn press(&self, key: &str) {
        let keys = json!([{ "type": "keyDown", "value": key }, { "type": "keyUp", "value": key }]);
        self.post("actions", &json!({ "actions": [{ "type": "key", "id": "keys", "actions": keys }] }));
    }

    /// Moves the mouse from one place of what is seen to another (px), with its button down on the
    /// way if it drags.
    pub fn mouse(&self, from: [f64; 2], to: [f64; 2], drags: bool) {
        let move_to = |[x, y]: [f64; 2]| json!({ "type": "pointerMove", "duration": 0, "x": x as i64, "y": y as i64 });
        let press = |what: &str| json!({ "type": what, "button": 0 });
        let steps = match drags {
            true => vec![move_to(from), press("pointerDown"), move_to(to), press("pointerUp")],
            false => vec![move_to(from), move_to(to)],
        };
        self.post("actions", &json!({ "actions": [{ "type": "pointer", "id": "mouse", "actions": steps }] }));
    }

    /// Drags from one place to another and holds still there before it lets go, as a hand does that
    /// pulls something along: a second and a half in all.
    pub fn drag_slowly(&self, from: [f64; 2], to: [f64; 2]) {
        let move_to = |[x, y]: [f64; 2], ms: u32| json!({ "type": "pointerMove", "duration": ms, "x": x as i64, "y": y as i64 });
        let press = |what: &str| json!({ "type": what, "button": 0 });
        let hold = json!({ "type": "pause", "duration": 700 });
        let steps = [move_to(from, 0), press("pointerDown"), move_to(to, 800), hold, press("pointerUp")];
        self.post("actions", &json!({ "actions": [{ "type": "pointer", "id": "mouse", "actions": steps }] }));
    }

    /// Moves a finger from one place to another on the glass.
    pub fn swipe(&self, from: [f64; 2], to: [f64; 2]) {
        let move_to = |[x, y]: [f64; 2], ms: u32| json!({ "type": "pointerMove", "duration": ms, "x": x as i64, "y": y as i64 });
        let touch = |what: &str| json!({ "type": what, "button": 0 });
        let steps = [move_to(from, 0), touch("pointerDown"), move_to(to, 300), touch("pointerUp")];
        let finger = json!({ "type": "pointer", "id": "finger", "parameters": { "pointerType": "touch" }, "actions": steps });
        self.post("actions", &json!({ "actions": [finger] }));
    }

    /// A phone of this size (px), with a finger.
    pub fn phone(&self, width: u32, height: u32) {
        self.devtools(
            "Emulation.setDeviceMetricsOverride",
            &json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": true }),
        );
        self.finger();
    }

    /// A screen that feels a finger.
    pub fn finger(&self) {
        self.devtools("Emulation.setTouchEmulationEnabled", &json!({ "enabled": true }));
    }

    /// Turns the wheel by so many px with the mouse at a place.
    pub fn wheel(&self, [x, y]: [f64; 2], by: i64) {
        let turn = json!({ "type": "scroll", "x": x as i64, "y": y as i64, "deltaX": 0, "deltaY": by });
        self.post("actions", &json!({ "actions": [{ "type": "wheel", "id": "wheel", "actions": [turn] }] }));
    }

    /// Lets pages save files in a folder.
    pub fn save_in(&self, folder: &Path) {
        self.devtools("Browser.setDownloadBehavior", &json!({ "behavior": "allow", "downloadPath": folder }));
    }

    /// Size of what is seen (px), as on a device of that width.
    pub fn size(&self, width: u32, height: u32) {
        self.devtools(
            "Emulation.setDeviceMetricsOverride",
            &json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false }),
        );
    }

    pub fn scheme(&self, scheme: &str) {
        self.devtools("Emulation.setEmulatedMedia", &json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] }));
    }

    /// What the console said since it was asked last.
    pub fn console(&self) -> Vec<String> {
        let entries = self.post("se/log", &json!({ "type": "browser" }));
        entries.as_array().unwrap().iter().map(|entry| entry["message"].as_str().unwrap_or_default().to_owned()).collect()
    }

    /// Keeps a picture of what is seen, if `COHAUL_SCREENSHOTS` names a folder for it.
    pub fn picture(&self, name: &str) {
        let Ok(folder) = std::env::var("COHAUL_SCREENSHOTS") else { return };
        let reply = minreq::get(format!("{}/screenshot", self.session)).send().unwrap();
        let reply: Value = serde_json::from_slice(reply.as_bytes()).unwrap();
        let bytes = base64::Engine::decode(&base64::engine::general_purpose::STANDARD, reply["value"].as_str().unwrap()).unwrap();
        std::fs::write(Path::new(&folder).join(format!("{name}.png")), bytes).unwrap();
    }

    fn devtools(&self, command: &str, parameters: &Value) {
        self.post("goog/cdp/execute", &json!({ "cmd": command, "params": parameters }));
    }

    fn post(&self, what: &str, body: &Value) -> Value {
        call(&format!("{}/{what}", self.session), body)
    }
}

/// # Panics
/// When the driver does not do it, with what it says.
fn call(url: &str, body: &Value) -> Value {
    let reply = minreq::post(url).with_timeout(120).with_json(body).unwrap().send().unwrap();
    let mut said: Value = serde_json::from_slice(reply.as_bytes()).unwrap();
    assert_eq!(reply.status_code, 200, "{url} {body}: {said:#}");
    said["value"].take()
}

impl Drop for Browser {
    fn drop(&mut self) {
        // The browser goes with its session, the driver by hand.
        let _ = minreq::delete(&self.session).with_timeout(20).send();
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
