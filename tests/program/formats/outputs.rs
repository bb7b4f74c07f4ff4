//! Real outputs of small scenes: the keys of each format that the program writes.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::process::Stdio;

use cohaul::formats;
use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};
use tungstenite::Message;
use tungstenite::client::IntoClientRequest;

use crate::keys::{Keys, Parts, add};

/// Parts of formats that are not compared key by key.
fn parts_of(name: &str) -> Parts {
    let (opaque, maps): (&[&str], &[&str]) = match name {
        "cohaul manifest" => (&["options", "scenario"], &["files"]),
        "cohaul baseline" => (&["scenario"], &["build"]),
        "cohaul gate record" => (&["scenes[].scenario"], &[]),
        "cohaul state" => (&["backend", "controller"], &[]),
        "cohaul sweep rows" => (&["identity.scenario"], &[]),
        "cohaul live" => (&["saved.scenario"], &[]),
        "cohaul sweep" => (&[], &["statuses"]),
        "cohaul check" => (&["baselines[].scenario_changes[].stored", "baselines[].scenario_changes[].now"], &["build"]),
        "cohaul stress" => (&[], &["accounts", "outcomes", "outcomes.*", "maps[].outcomes", "maps[].outcomes.*"]),
        // Warnings depend on how the program was built.
        "cohaul bench" => (&["warnings"], &[]),
        "cohaul regime" => (&[], &["laws[].causes"]),
        _ => (&[], &[]),
    };
    Parts { opaque, maps }
}

/// Keys of all formats but the scenario, by the names of the formats.
pub fn all() -> BTreeMap<&'static str, Keys> {
    let mut outputs = Outputs { room: tempdir().expect("a folder"), found: BTreeMap::new() };
    outputs.runs();
    outputs.comparisons();
    outputs.sweeps();
    outputs.checks();
    outputs.studies();
    outputs.calibrations();
    outputs.files();
    outputs.page();
    outputs.found
}

struct Outputs {
    room: TempDir,
    found: BTreeMap<&'static str, Keys>,
}

const JUMP: &str = "scenarios/analytic/release-jump.json";
const ROLL: &str = "scenarios/contact/disc-roll.json";

impl Outputs {
    fn path(&self, name: &str) -> String {
        self.room.path().join(name).to_str().expect("a folder with a plain name").to_owned()
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// A short scene with ants.
    fn ants(&self) -> String {
        let mut scene: Value =
            serde_json::from_str(&fs::read_to_string(crate::root::root().join("scenarios/paper/four-ants-four-springs.json")).unwrap())
                .unwrap();
        scene["duration_s"] = json!(4.0);
        fs::write(self.path("ants.json"), scene.to_string()).unwrap();
        self.path("ants.json")
    }

    /// The release on damped springs.
    fn damped(&self) -> String {
        let mut scene: Value = serde_json::from_str(&fs::read_to_string(crate::root::root().join(JUMP)).unwrap()).unwrap();
        for spring in scene["springs"].as_array_mut().unwrap() {
            spring["damping_ratio"] = json!(0.5);
        }
        fs::write(self.path("damped.json"), scene.to_string()).unwrap();
        self.path("damped.json")
    }

    /// Standard output of the program, which ends with one of the codes 0 and 1, or 130 after an
    /// interruption.
    fn call(&self, arguments: &[&str]) -> Vec<u8> {
        let output = crate::root::cohaul().args(arguments).output().expect("the program runs");
        let code = output.status.code();
        assert!(matches!(code, Some(0 | 1 | 2 | 130)), "{arguments:?}: {code:?}: {}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    }

    /// Takes the keys of what the program prints with `--json`. Its format is its first key.
    fn take(&mut self, arguments: &[&str]) {
        let printed = self.call(&[arguments, &["--json"]].concat());
        let text = String::from_utf8(printed).expect("the program prints UTF-8");
        assert!(text.starts_with("{\n  \"format\": {\n    \"name\": \"cohaul "), "{arguments:?}: {text}");
        let value: Value = serde_json::from_str(&text).expect("one JSON object");
        let name = value["format"]["name"].as_str().expect("a name").to_owned();
        let format = formats::ALL.iter().find(|format| format.name == name).unwrap_or_else(|| panic!("{name} is a format"));
        assert_eq!(value["format"], json!(format));
        self.add(format.name, &value);
    }

    fn add(&mut self, name: &'static str, value: &Value) {
        add(self.found.entry(name).or_default(), "", value, parts_of(name));
    }

    fn runs(&mut self) {
        for backend in ["quasi-static", "inertial", "rapier"] {
            self.take(&["run", JUMP, "--backend", backend]);
            self.take(&["run", ROLL, "--backend", backend]);
            self.take(&["run", &self.ants(), "--backend", backend]);
        }
        self.take(&["run", JUMP, "--backend", "inertial", "--tolerance", "1e-6"]);
        self.take(&["run", JUMP, "--rate-independent"]);
        self.take(&["run", "scenarios/contact/rebound.json", "--backend", "inertial"]);
        // The account of these runs has findings.
        self.take(&["run", "tests/common/tip-past-root.json"]);
        self.take(&["run", "tests/common/stiff-spring.json", "--backend", "inertial", "--step-s", "0.005"]);
    }

    fn comparisons(&mut self) {
        let recorded = self.path("recorded");
        self.call(&["run", JUMP, "--out", &recorded]);
        self.take(&["compare", JUMP, "--beside", &format!("{recorded}/trace.csv")]);
        self.take(&["compare", ROLL]);
        self.take(&["compare", &self.damped()]);
        self.take(&["compare", &self.damped(), "--rate-independent", "--no-check-suggestions"]);
        self.take(&["compare", &self.ants(), "--seeds", "2"]);
        self.take(&["compare", JUMP, "--vary", "load.mass_kg=log:1e-4:1:3"]);
        self.take(&["compare", JUMP, "--threshold", "speed=0.5:2:3"]);
        self.take(&["compare", "scenarios/contact/pusher.json", "--threshold", "inertia=0.5:2:3"]);
        let pushes = "data/measured/pushes.csv";
        self.take(&["measured", pushes, "data/measured/block.json", "--fit", "side-friction,ground-friction"]);
        self.take(&["measured", pushes, "data/measured/block.json", "--no-engine", "--start", "recorded"]);
    }

    fn sweeps(&mut self) {
        let (ants, whole, parts) = (self.ants(), self.path("sweep"), self.path("parts"));
        let backends = ["--backend", "quasi-static", "--backend", "inertial"];
        self.take(&[&["sweep", &ants, "--seeds", "2", "--out", &whole, "--vary", "load.mass_kg=0.001,0.002"][..], &backends].concat());
        self.take(&["sweep", &ants, "--seeds", "2", "--backend", "quasi-static", "--shard", "1/1", "--out", &parts]);
        self.take(&["merge", &parts, "--out", &self.path("merged")]);
        let failing = "tests/common/nan-squeeze-damped.json";
        self.take(&["sweep", failing, "--backend", "inertial", "--out", &self.path("failing")]);
        let header = header_of(&self.read("parts/shards/1-of-1.rows"));
        self.add(formats::SHARD.name, &header);
    }

    fn checks(&mut self) {
        let baselines = self.path("baselines");
        for backend in ["quasi-static", "rapier"] {
            self.call(&["check", "store", JUMP, "--baselines", &baselines, "--backend", backend]);
        }
        self.call(&["check", "store", &self.ants(), "--baselines", &baselines]);
        self.take(&["check", &baselines]);
        self.take(&["check", &baselines, "release-jump-rapier", "--scenario", "scenarios/analytic/slide.json"]);
        for name in ["release-jump-quasi-static", "release-jump-rapier", "ants-quasi-static"] {
            let baseline = serde_json::from_str(&self.read(&format!("baselines/{name}.json"))).expect("JSON");
            self.add(formats::BASELINE.name, &baseline);
        }
    }

    fn studies(&mut self) {
        self.take(&["verify", "slide", "towing", "--quick"]);
        self.take(&["conformance", "--engine", "quasi-static"]);
        self.take(&["conformance", "--engine", "rapier", "--step-s", "0.01"]);
        self.gates();
        self.take(&["stress", "--map", "wind", "--map", "step-stiffness", "--quick"]);
        self.take(&["bench", "scenarios/analytic/slide.json", "--solvers", "--quick", "--repeats", "1", "--budget-s", "0.01"]);
        self.take(&["regime", "--quick", "--scene", "haul"]);
        self.take(&["paper", "--backend", "quasi-static", "--seeds", "2", "--quick"]);
        self.take(&["paper", "search", "--rows", "1", "--within", "0", "--seeds", "1", "--more-seeds", "2", "--most", "1"]);
        self.take(&["paper", "readings", "--seeds", "2"]);
        self.take(&["paper", "deadlocks", &self.ants(), "--seeds", "2"]);
        fs::write(self.path("bad.json"), "{}").unwrap();
        self.take(&["scenario", "check", JUMP, ROLL, &self.ants(), &self.path("bad.json")]);
        let like = ["--like", "examples/recordings/ants.json", "--fps", "50", "--bridge-s", "0.001"];
        self.take(&[&["scenario", "import", "examples/recordings/table.csv"][..], &like].concat());
    }

    /// Errors of rapier on two scenes at a step, and at a longer one.
    fn gates(&mut self) {
        let folder = self.path("gate");
        let scenes = ["scenarios/analytic/slide-spin.json", "scenarios/contact/oblique-impact.json"];
        self.take(&[&["gate", &folder, "--record", "--step-s", "5e-4"][..], &scenes].concat());
        self.take(&["gate", &folder, "--step-s", "1e-3"]);
    }

    fn calibrations(&mut self) {
        let (run, forces, fit) = (self.path("tips"), self.path("forces"), self.path("fit"));
        self.call(&["run", &self.ants(), "--tips", "--out", &run]);
        self.take(&["calibrate", "grid", "data/load-cell.csv"]);
        self.take(&["calibrate", "fit", "data/spring-calibration.csv", "--out", &fit]);
        self.take(&["calibrate", "forces", &run, "--calibration", &format!("{fit}/calibration.json"), "--out", &forces]);
        self.take(&["calibrate", "behaviour", &run, "--tip-noise-m", "1e-6"]);
        self.take(&["calibrate", "pulls", &forces, "--against", &forces, "--block-s", "0.5", "--permutations", "99"]);
        self.take(&["colony", &run, "--like", &self.ants(), "--seeds", "2", "--backend", "quasi-static"]);
        let stiffness = ["--radial-stiffness-n-per-m", "0.664", "--torsional-stiffness-nm-per-rad", "4.52e-4"];
        self.take(&[&["calibrate", "design", "--grid-m", "1e-5"][..], &stiffness].concat());
    }

    /// Manifests, states and journals.
    fn files(&mut self) {
        for folder in ["recorded", "sweep", "fit"] {
            let manifest = serde_json::from_str(&self.read(&format!("{folder}/manifest.json"))).expect("JSON");
            self.add(formats::MANIFEST.name, &manifest);
        }
        for (backend, scene) in [("quasi-static", JUMP.to_owned()), ("inertial", ROLL.to_owned()), ("rapier", self.ants())] {
            let file = format!("{backend}.state");
            let arguments = ["run", &scene, "--backend", backend, "--stop-s", "0.1", "--tips", "--out", &self.path("stopped"), "--state"];
            self.call(&[&arguments[..], &[&self.path(&file)]].concat());
            let text = self.read(&file);
            self.add(formats::JOURNAL.name, &header_of(&text));
            // The second line is a mark, the number of the task, and the state.
            let (_, state) = text.lines().nth(1).and_then(|line| line.split_once(" 0,")).expect("a record");
            self.add(formats::STATE.name, &serde_json::from_str(state).expect("JSON"));
        }
    }

    /// Messages of the live page, each under the name of its kind.
    fn page(&mut self) {
        let mut command = crate::root::cohaul();
        let mut child = command.args(["view", ROLL]).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("the program runs");
        let mut link = String::new();
        BufReader::new(child.stdout.take().expect("a pipe")).read_line(&mut link).expect("a link");
        let messages = messages(&link);
        child.kill().and_then(|()| child.wait()).expect("the program ends");
        for mut message in messages {
            let kind = message["tell"].as_str().expect("a kind").to_owned();
            message.as_object_mut().expect("an object").remove("tell");
            self.add(formats::LIVE.name, &json!({ kind: message }));
        }
    }
}

/// The header in the first line of a journal, after its mark.
fn header_of(text: &str) -> Value {
    let (_, header) = text.lines().next().and_then(|line| line.split_once(' ')).expect("a header");
    serde_json::from_str(header).expect("JSON")
}

/// What the server of this link tells a page, until each kind was there.
fn messages(link: &str) -> Vec<Value> {
    let (host, token) = link.trim().strip_prefix("http://").and_then(|rest| rest.split_once("/?token=")).expect("a link");
    let mut request = format!("ws://{host}/socket?token={token}").into_client_request().expect("a request");
    request.headers_mut().insert("Origin", format!("http://{host}").parse().expect("a host"));
    let (mut page, _) = tungstenite::client(request, TcpStream::connect(host).expect("a server")).expect("a page");
    for ask in [json!({ "do": "go-to", "time_s": 0.5 }), json!({ "do": "save" }), json!({ "do": "nonsense" })] {
        page.send(Message::text(ask.to_string())).expect("the page is heard");
    }
    let mut messages: Vec<Value> = Vec::new();
    let is_there = |messages: &[Value], kind: &str| messages.iter().any(|message| message["tell"] == kind);
    // The load is touched at the time that the page goes to.
    let has_gone = |messages: &[Value]| messages.iter().any(|message| message["time_s"].as_f64().is_some_and(|time| time > 0.49));
    while !has_gone(&messages)
        || !["scene", "frame", "estimate", "comparing", "verdict", "saved", "refused"].iter().all(|kind| is_there(&messages, kind))
    {
        let Message::Text(text) = page.read().expect("the server answers") else { continue };
        let message: Value = serde_json::from_str(&text).expect("JSON");
        if message["tell"] == "frame" {
            let drawn = json!({ "do": "drawn", "frame": message["frame"] });
            page.send(Message::text(drawn.to_string())).expect("the page is heard");
        }
        messages.push(message);
    }
    messages
}
