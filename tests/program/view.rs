//! The live testbed: what is dragged is the scenario that is saved, to the bit, and only the page
//! of the link gets in.

#[path = "../common/root.rs"]
mod root;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStdout, Stdio};
use std::time::{Duration, Instant};

use cohaul::backend::BackendKind;
use cohaul::math::Vec2;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Keep, Simulation};
use cohaul_app::live::{Edit, Handle, Lanes, LiveScene, Pull, Reach, Span};
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

fn scene(name: &str) -> LiveScene {
    let scenario = Scenario::read(&root::root().join("scenarios").join(format!("{name}.json"))).unwrap();
    LiveScene::new(scenario)
}

/// Poses of all backends at the end of `scene`, by its own saved scenario, read anew.
fn poses_of_saved(scene: &LiveScene, until: f64) -> Vec<[f64; 3]> {
    let text = serde_json::to_value(scene.scenario.expanded()).unwrap().to_string();
    let scenario = Scenario { duration: until, ..Scenario::parse(&text, "saved").unwrap() };
    let pose = |kind: BackendKind| {
        let mut run = Simulation::new(&scenario, &scene.settings.options(kind, &scenario), Keep::Outcome);
        run.run(|_| true);
        let pose = run.motion().pose;
        [pose.position.x, pose.position.y, pose.heading]
    };
    BackendKind::ALL.map(pose).to_vec()
}

fn poses(lanes: &Lanes) -> Vec<[f64; 3]> {
    lanes.motions().map(|motion| [motion.pose.position.x, motion.pose.position.y, motion.pose.heading]).collect()
}

/// How fast what is dragged follows the hand at a pace of 1 (1/s).
const RATE: f64 = 12.0;

/// Drags a handle along a circle from the time `from` (s) on, as a page does: runs of some ticks,
/// with a new aim before each. Returns the scene and the poses that were shown last.
fn dragged(mut scene: LiveScene, handle: Handle, from: f64, centre: Vec2, radius: f64) -> (LiveScene, Vec<[f64; 3]>, f64) {
    let period = scene.scenario.control_period;
    let rest_tip = |lanes: &Lanes| match handle {
        Handle::Spring(spring) => lanes.rest_tip(spring).unwrap(),
        Handle::Pusher(_) => Vec2::zeros(),
    };
    let mut lanes = Lanes::new(&scene);
    while lanes.time() < from - 0.5 * period {
        lanes.advance();
    }
    let (mut saved, mut tip, mut tick) = (lanes.save().unwrap(), rest_tip(&lanes), lanes.tick());
    let mut last = (Vec::new(), 0.0);
    for step in 0..480 {
        // Now one tick, now three, as frames come.
        let n = 1 + 2 * u64::from(step % 3 == 0);
        let span = Span { from: tick as f64 * period, to: (tick + n) as f64 * period };
        let angle = 0.01 * f64::from(step);
        let pull = Pull { to: centre + radius * Vec2::new(angle.cos(), angle.sin()), rate: RATE };
        let now = span.from;
        let reach = scene.apply(&Edit::Drag { handle, pull, span, rest_tip: tip }, now).unwrap();
        let mut lanes = match reach {
            Reach::Future => Lanes::resume(&scene, &saved).unwrap(),
            Reach::Whole => Lanes::new(&scene),
        };
        while lanes.time() < span.to - 0.5 * period {
            lanes.advance();
        }
        (saved, tip, tick) = (lanes.save().unwrap(), rest_tip(&lanes), tick + n);
        last = (poses(&lanes), lanes.time());
    }
    (scene, last.0, last.1)
}

/// A tip in the middle of a prescribed way, one that rests, and pushers: the load moves on all
/// backends, and the saved scenario leads each of them to the same place. With tips it does so to
/// the bit.
#[test]
fn the_saved_scenario_of_a_drag_gives_the_same_path() {
    let free = scene("paper/four-tips-held");
    let centre = Vec2::new(0.08, 0.03);
    let cases = [
        ("a tip on its way", dragged(scene("analytic/ramp-and-hold"), Handle::Spring(0), 0.2505, Vec2::new(0.03, 0.02), 0.03)),
        ("a held tip", dragged(free, Handle::Spring(1), 0.1, centre, 0.04)),
        ("a pusher", dragged(scene("contact/pusher"), Handle::Pusher(0), 0.3, Vec2::new(0.02, 0.004), 0.01)),
        ("two fingers", dragged(scene("robots/two-fingers"), Handle::Pusher(0), 1.0, Vec2::new(0.4, 0.05), 0.05)),
    ];
    for (what, (scene, shown, until)) in cases {
        let again = poses_of_saved(&scene, until);
        // The time in an inertial step is a sum, by whose rounding it may lie behind a turn of the
        // pusher that a page does not know yet: a last digit of a place of 0.4 m at each of 480
        // turns.
        let rounding = if scene.pushers().is_empty() { 0.0 } else { 480.0 * 1e-16 };
        for (again, shown) in again.iter().flatten().zip(shown.iter().flatten()) {
            assert!((again - shown).abs() <= rounding, "{what}: {again} {shown}");
        }
        let start = scene.scenario.start.pose.position;
        for [x, y, _] in shown {
            assert!((Vec2::new(x, y) - start).norm() > 1e-4, "{what}: the load moves");
        }
    }
}

/// Times and places of what a handle moves (s, m).
fn path_of(scenario: &Scenario, handle: Handle) -> Vec<(f64, Vec2)> {
    match (handle, &scenario.drive) {
        (Handle::Spring(spring), Drive::Tips(paths)) => {
            let path = paths.iter().find(|path| path.spring == spring).unwrap();
            path.waypoints.iter().map(|at| (at.time, at.position)).collect()
        }
        (Handle::Pusher(number), _) => {
            let path = &scenario.system.world.obstacles[number].path;
            path.waypoints.iter().map(|(time, pose)| (*time, pose.position)).collect()
        }
        _ => panic!("ants move the tips"),
    }
}

/// A hand moves steadily, and its place comes to the page now after one frame, now after five. What
/// it drags has the speed of the hand within a tenth, once it follows, and is behind it by
/// 2 v / rate, the steady solution of a critically damped spring.
#[test]
fn a_steady_hand_gives_a_steady_tip() {
    let (speed, frame) = (0.28, 1.0 / 60.0);
    for (name, handle) in [("robots/tow-past-corner", Handle::Spring(0)), ("robots/two-fingers", Handle::Pusher(0))] {
        let mut scene = scene(name);
        let period = scene.scenario.control_period;
        let start = path_of(&scene.scenario, handle)[0].1;
        let hand = |time: f64| start + speed * time * Vec2::new(0.6, -0.8);
        let (mut tick, mut to) = (0, start);
        let mut next_report = 0;
        for n in 0..180 {
            if n == next_report {
                to = hand(f64::from(n) * frame);
                next_report += if n % 2 == 0 { 1 } else { 5 };
            }
            let until = (f64::from(n + 1) * frame / period) as u32;
            let span = Span { from: f64::from(tick) * period, to: f64::from(until) * period };
            if until > tick {
                scene.apply(&Edit::Drag { handle, pull: Pull { to, rate: RATE }, span, rest_tip: start }, span.from).unwrap();
            }
            tick = until;
        }
        let path = path_of(&scene.scenario, handle);
        let speeds = path.windows(2).filter(|pair| pair[0].0 > 1.0).map(|pair| (pair[1].1 - pair[0].1).norm() / (pair[1].0 - pair[0].0));
        let speeds: Vec<f64> = speeds.collect();
        assert!(speeds.len() > 50, "{name}");
        assert!(speeds.iter().all(|found| (found / speed - 1.0).abs() < 0.1), "{name}: {speeds:?}");
        let (time, place) = path[path.len() - 1];
        // A hand that was heard of five frames ago is further on by up to 5 / 60 s.
        let behind = (hand(time) - place).norm() / speed - 2.0 / RATE;
        assert!((-0.02..0.1).contains(&behind), "{name}: {behind} s");
    }
}

/// The list of scenes holds all files of `scenarios/`, and each can be opened.
#[test]
fn all_scenes_are_in_the_list() {
    let mut scene = scene("analytic/slide");
    let folders = std::fs::read_dir(root::root().join("scenarios")).unwrap().map(|entry| entry.unwrap().path());
    let files = folders.filter(|path| path.is_dir()).flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let name = |path: std::path::PathBuf| {
        let folder = path.parent().unwrap().file_name().unwrap().to_str().unwrap().to_owned();
        format!("{folder}/{}", path.file_stem().unwrap().to_str().unwrap())
    };
    let mut names: Vec<String> = files.map(|entry| name(entry.unwrap().path())).collect();
    let mut listed = scene.now().shipped;
    names.sort_unstable();
    listed.sort_unstable();
    assert_eq!(listed, names);
    for name in &names {
        assert_eq!(scene.apply(&Edit::Shipped { name: name.clone() }, 0.0), Ok(Reach::Whole), "{name}");
    }
}

/// A saved state holds the scene as it was opened too: sliders reach as far as before, and ants
/// that were off can be switched on.
#[test]
fn a_saved_state_opens_with_its_sliders_and_its_ants() {
    let mut first = scene("paper/four-ants-four-springs");
    first.apply(&Edit::Set { what: "inertia".to_owned(), value: 10.0 }, 0.0).unwrap();
    first.apply(&Edit::Ants { on: false }, 0.0).unwrap();
    let text = serde_json::to_string(&first.saved(0.5)).unwrap();
    let mut second = scene("analytic/slide");
    second.apply(&Edit::Open(Box::new(serde_json::from_str(&text).unwrap())), 0.0).unwrap();
    assert_eq!(second.now().parameters, first.now().parameters);
    assert_eq!(second.saved(0.5), first.saved(0.5));
    for scene in [&mut first, &mut second] {
        scene.apply(&Edit::Ants { on: true }, 0.0).unwrap();
    }
    assert_eq!(second.scenario, first.scenario);
    let mut saved: Value = serde_json::from_str(&text).unwrap();
    saved["speed"] = json!(0);
    let refused = second.apply(&Edit::Open(Box::new(serde_json::from_value(saved).unwrap())), 0.0).unwrap_err();
    assert!(refused.contains("saved.speed: must be finite and above 0, found 0"), "{refused}");
}

/// Ants that are switched off leave their tips as they were: the quasi-static load is where it was.
#[test]
fn ants_that_are_switched_off_become_prescribed_tips() {
    let mut scene = scene("paper/four-ants-four-springs");
    let until = 4.0;
    let mut with_ants = Lanes::new(&scene);
    while with_ants.time() < until - 1e-6 {
        with_ants.advance();
    }
    let (shown, now) = (poses(&with_ants)[0], with_ants.time());
    drop(with_ants);
    assert_eq!(scene.apply(&Edit::Ants { on: false }, now), Ok(Reach::Whole));
    let mut prescribed = Lanes::new(&scene);
    while prescribed.time() < until - 1e-6 {
        prescribed.advance();
    }
    let place = poses(&prescribed)[0];
    // Tips go straight from tick to tick either way; positions of 0.1 m are rounded.
    assert!(shown.iter().zip(place).all(|(a, b)| (a - b).abs() < 1e-12), "{shown:?} {place:?}");
    drop(prescribed);
    assert!(scene.apply(&Edit::Release { spring: 0 }, now).is_err(), "all were let go");
    assert_eq!(scene.apply(&Edit::Ants { on: true }, now), Ok(Reach::Whole));
    assert_eq!(scene.scenario, self::scene("paper/four-ants-four-springs").scenario);
}

/// What is refused leaves the scene as it is, and says why.
#[test]
fn changes_that_break_a_rule_change_nothing() {
    let mut scene = scene("analytic/release-jump");
    let before = scene.clone();
    let span = Span { from: 0.0, to: 0.01 };
    let [pull, far] = [Vec2::zeros(), Vec2::new(f64::INFINITY, 0.0)].map(|to| Pull { to, rate: RATE });
    let edits = [
        (Edit::Set { what: "mass".into(), value: f64::NAN }, "mass: must be from"),
        (Edit::Set { what: "mass".into(), value: 1e9 }, "mass: must be from"),
        (Edit::Set { what: "colour".into(), value: 1.0 }, "no parameter \"colour\""),
        (Edit::Drag { handle: Handle::Spring(9), pull, span, rest_tip: Vec2::zeros() }, "spring: must be below 2, found 9"),
        (Edit::Drag { handle: Handle::Pusher(0), pull, span, rest_tip: Vec2::zeros() }, "must be an obstacle that moves"),
        (Edit::Drag { handle: Handle::Spring(0), pull: far, span, rest_tip: Vec2::zeros() }, "a finite place"),
        (Edit::Shipped { name: "../secret".into() }, "no scene"),
        (Edit::Ants { on: true }, "this scene has none"),
    ];
    for (edit, why) in edits {
        let refused = scene.apply(&edit, 0.0).unwrap_err();
        assert!(refused.contains(why), "{edit:?}: {refused}");
        assert_eq!(scene, before);
    }
}

/// Sliders do what they say, within rounding of products: the weight goes with the mass and not
/// with the inertia.
#[test]
fn sliders_change_what_they_name() {
    let mut scene = scene("analytic/release-jump");
    let limit = scene.scenario.system.total_slip_limit();
    let mut set = |what: &str, value: f64| {
        scene.apply(&Edit::Set { what: what.to_owned(), value }, 0.0).unwrap();
        let system = scene.scenario.system.clone();
        (system.load.mass, system.total_slip_limit() / limit, system.springs[0].radial_stiffness, scene.scenario.duration)
    };
    let is = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-12;
    let (mass, slip, ..) = set("mass", 0.0032);
    assert!(is(mass, 0.0032) && is(slip, 2.0));
    let (mass, slip, ..) = set("inertia", 10.0);
    assert!(is(mass, 0.032) && is(slip, 2.0));
    assert!(is(set("friction", 0.7).1, 1.0));
    assert!(is(set("stiffness", 6.64).2, 6.64));
    assert!(is(set("speed", 2.0).3, 1.25));
    assert!(is(set("speed", 1.0).3, 2.5));
}

/// `cohaul view` as a child; it ends with this.
struct Served {
    child: Child,
    printed: BufReader<ChildStdout>,
    host: String,
    token: String,
}

impl Served {
    fn start(scenario: &str) -> Self {
        Self::with(&[scenario])
    }

    fn with(options: &[&str]) -> Self {
        let mut command = root::cohaul();
        let mut child = command.arg("view").args(options).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut link = String::new();
        let mut printed = BufReader::new(child.stdout.take().unwrap());
        printed.read_line(&mut link).unwrap();
        let (host, token) = link.trim().strip_prefix("http://").unwrap().split_once("/?token=").unwrap();
        Self { host: host.to_owned(), token: token.to_owned(), child, printed }
    }

    /// Status, head and body of the reply to a request for this host.
    fn get(&self, path: &str, host: &str) -> (u16, String, String) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
        let mut reply = String::new();
        stream.read_to_string(&mut reply).unwrap();
        let (head, body) = reply.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().parse().unwrap(), head.to_lowercase(), body.to_owned())
    }

    /// A page, or the status with which it is refused.
    fn socket(&self, origin: Option<&str>, token: &str) -> Result<WebSocket<TcpStream>, u16> {
        let mut request = format!("ws://{}/socket?token={token}", self.host).into_client_request().unwrap();
        if let Some(origin) = origin {
            request.headers_mut().insert("Origin", origin.parse().unwrap());
        }
        let stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        match tungstenite::client(request, stream) {
            Ok((socket, _)) => Ok(socket),
            Err(tungstenite::HandshakeError::Failure(tungstenite::Error::Http(reply))) => Err(reply.status().as_u16()),
            Err(error) => panic!("{error}"),
        }
    }

    fn page(&self) -> WebSocket<TcpStream> {
        self.socket(Some(&format!("http://{}", self.host)), &self.token).expect("this is the page of the link")
    }

    /// Processor time of the server so far (s).
    #[cfg(target_os = "linux")]
    fn processor_s(&self) -> f64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap();
        let fields: Vec<&str> = stat.rsplit_once(") ").unwrap().1.split(' ').collect();
        // User and system time, in the hundredths of a second that every Linux counts in.
        (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn ask(page: &mut WebSocket<TcpStream>, what: &Value) {
    page.send(Message::text(what.to_string())).unwrap();
}

/// The next message of a kind; others are passed over, and each frame is said to be drawn.
fn told(page: &mut WebSocket<TcpStream>, kind: &str) -> Value {
    let end = Instant::now() + Duration::from_secs(60);
    while Instant::now() < end {
        let Message::Text(text) = page.read().unwrap() else { continue };
        let message: Value = serde_json::from_str(&text).unwrap();
        if message["tell"] == "frame" {
            ask(page, &json!({ "do": "drawn", "frame": message["frame"] }));
        }
        if message["tell"] == kind {
            return message;
        }
    }
    panic!("never told {kind}");
}

#[test]
fn only_the_page_of_the_link_gets_in() {
    let served = Served::start("scenarios/analytic/release-jump.json");
    let (status, head, body) = served.get(&format!("/?token={}", served.token), &served.host);
    assert_eq!(status, 200);
    assert!(head.contains("content-security-policy: default-src 'none'") && head.contains("referrer-policy: no-referrer"), "{head}");
    assert!(!body.contains(&served.token), "the page knows the token from its own address only");
    for path in ["/", "/?token=", "/?token=0123456789abcdef0123456789abcdef", &format!("/?token={}0", served.token)] {
        assert_eq!(served.get(path, &served.host).0, 403, "{path}");
    }
    // Another name for this machine, as a page that rebinds its name would use.
    for host in ["evil.example", "evil.example:80", "127.0.0.1", "localhost:1"] {
        assert_eq!(served.get(&format!("/?token={}", served.token), host).0, 403, "{host}");
    }
    assert_eq!(served.get(&format!("/other?token={}", served.token), &served.host).0, 404);

    for origin in [None, Some("null"), Some("http://evil.example"), Some("https://127.0.0.1"), Some("http://127.0.0.1")] {
        assert_eq!(served.socket(origin, &served.token).err(), Some(403), "{origin:?}");
    }
    let own = format!("http://{}", served.host);
    assert_eq!(served.socket(Some(&own), "0123456789abcdef0123456789abcdef").err(), Some(403));
    assert!(served.socket(Some(&own), &served.token).is_ok());
    let local = own.replace("127.0.0.1", "localhost");
    assert!(served.socket(Some(&local), &served.token).is_ok());
}

/// Pages that talk nonsense are sent away, those beside them notice nothing.
#[test]
fn ten_thousand_malformed_messages_are_refused() {
    let served = Served::start("scenarios/analytic/release-jump.json");
    let mut good = served.page();
    assert_eq!(told(&mut good, "scene")["name"].as_str().unwrap().split(' ').next(), Some("two"));
    let nonsense = [
        "",
        "{",
        "null",
        "[]",
        "{\"do\":\"fly\"}",
        "{\"do\":\"set\"}",
        "{\"do\":\"set\",\"what\":1,\"value\":2}",
        "{\"do\":\"go-to\",\"time_s\":\"now\"}",
        "{\"do\":\"drag\",\"handle\":{\"spring\":-1},\"to\":[0,0]}",
        "{\"do\":\"drag\",\"handle\":{\"spring\":0},\"to\":[0]}",
        "{\"do\":\"settings\",\"settings\":{\"backends\":[\"bullet\"]}}",
        "\u{0}\u{1}",
        "{\"do\":\"pace\",\"factor\":1e999}",
    ];
    let (mut n_sent, mut n_pages, mut n_told) = (0, 0, 0);
    while n_sent < 10_000 {
        let mut page = served.page();
        n_pages += 1;
        let is_sent = |page: &mut WebSocket<TcpStream>, at: usize| match at % 17 {
            16 => page.send(Message::binary(vec![0xff; 100])),
            at => page.send(Message::text(nonsense[at % nonsense.len()])),
        };
        // More than a page may send; what comes after its end counts too.
        n_sent += (0..150).take_while(|at| is_sent(&mut page, n_sent + at).is_ok()).count();
        // What it is told before it is sent away.
        loop {
            match page.read() {
                Ok(Message::Text(text)) => n_told += usize::from(text.contains("\"refused\"")),
                Ok(Message::Close(why)) => {
                    assert!(why.is_none_or(|why| u16::from(why.code) == 1008));
                }
                Ok(_) => {}
                Err(_) => break,
            }
        }
    }
    assert!(n_pages >= 10_000 / 150 && n_told > n_pages, "{n_pages} pages were sent away, told {n_told} times");
    // What makes sense and breaks a rule is refused too, and the page stays.
    for (what, why) in [
        (json!({ "do": "set", "what": "mass", "value": -1 }), "mass: must be from"),
        (json!({ "do": "pace", "factor": 0 }), "pace: must be from"),
        (json!({ "do": "settings", "settings": { "backends": [] } }), "settings.backends: must be"),
        (json!({ "do": "open", "saved": { "scenario": { "name": "x" } } }), "scenario"),
        (json!({ "do": "shipped", "name": "nothing" }), "no scene"),
    ] {
        ask(&mut good, &what);
        let refused = told(&mut good, "refused");
        assert!(refused["why"].as_str().unwrap().contains(why), "{what}: {refused}");
    }
    ask(&mut good, &json!({ "do": "step" }));
    while told(&mut good, "frame")["time_s"] != json!(0.001) {}
    // Longer than any message may be.
    let long = "x".repeat(5 << 20);
    let _ = good.send(Message::text(long));
    assert!((0..200).any(|_| good.read().is_err()), "too long");
    told(&mut served.page(), "scene");
}

/// Pages that say goodbye and pages that are torn away while they play: nothing goes on computing.
#[cfg(target_os = "linux")]
#[test]
fn pages_that_are_gone_leave_no_running_computation() {
    let served = Served::start("scenarios/paper/ten-ants-ten-springs.json");
    let mut pages: Vec<WebSocket<TcpStream>> = (0..3).map(|_| served.page()).collect();
    for page in &mut pages {
        ask(page, &json!({ "do": "pace", "factor": 50 }));
        ask(page, &json!({ "do": "play" }));
        while told(page, "frame")["time_s"].as_f64().unwrap() < 1.0 {}
    }
    assert!(served.processor_s() > 0.02);
    let _ = pages[0].close(None);
    drop(pages);
    let is_quiet = || {
        let before = served.processor_s();
        std::thread::sleep(Duration::from_millis(500));
        served.processor_s() - before < 0.05
    };
    assert!((0..60).any(|_| is_quiet()), "computing goes on");
}

/// A period of a day is half a minute's work and more: it ends with the page, and its messages do
/// not keep it from being heard.
#[cfg(target_os = "linux")]
#[test]
fn a_page_that_is_closed_in_the_midst_of_a_control_period_ends_it() {
    let room = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(root::root().join("scenarios/analytic/centre-pull.json")).unwrap();
    let mut scene: Value = serde_json::from_str(&text).unwrap();
    (scene["duration_s"], scene["control_period_s"]) = (json!(864_000.0), json!(86_400.0));
    scene["drive"]["paths"][0]["waypoints"] = json!([[0.0, 0.0, 0.0], [864_000.0, 50.0, 3.0]]);
    let path = room.path().join("slow.json");
    std::fs::write(&path, scene.to_string()).unwrap();
    let served = Served::start(path.to_str().unwrap());
    let mut page = served.page();
    told(&mut page, "scene");
    ask(&mut page, &json!({ "do": "go-to", "time_s": 86_400.0 }));
    // More than the runs are handed at once.
    (0..200).for_each(|_| ask(&mut page, &json!({ "do": "pace", "factor": 2.0 })));
    let used = |time: Duration| {
        let before = served.processor_s();
        std::thread::sleep(time);
        served.processor_s() - before
    };
    assert!((0..60).any(|_| used(Duration::from_millis(200)) > 0.05), "it computes");
    let _ = page.close(None);
    drop(page);
    std::thread::sleep(Duration::from_millis(200));
    assert!((0..10).any(|_| used(Duration::from_millis(500)) < 0.05), "computing goes on");
}

/// The estimate comes first, then how far the comparison is, then the verdict.
#[test]
fn the_estimate_comes_before_the_verdict() {
    let served = Served::start("scenarios/analytic/release-jump.json");
    let mut page = served.page();
    let estimate = told(&mut page, "estimate");
    assert_eq!(estimate["negligible"], "no", "{estimate}");
    let mut shares = Vec::new();
    let verdict = loop {
        let Message::Text(text) = page.read().unwrap() else { continue };
        let message: Value = serde_json::from_str(&text).unwrap();
        match message["tell"].as_str() {
            Some("comparing") => shares.push(message["share"].as_f64().unwrap()),
            Some("verdict") => break message,
            _ => {}
        }
    };
    assert_eq!(verdict["valid"], "no", "{verdict}");
    assert!(!shares.is_empty() && shares.is_sorted() && shares.iter().all(|share| (0.0..=1.0).contains(share)), "{shares:?}");
}

/// A server that ends says so to its pages.
#[cfg(unix)]
#[test]
fn a_page_hears_why_it_is_closed() {
    let mut served = Served::start("scenarios/analytic/release-jump.json");
    let mut page = served.page();
    told(&mut page, "scene");
    assert!(std::process::Command::new("kill").args(["-INT", &served.child.id().to_string()]).status().unwrap().success());
    let why = loop {
        if let Message::Close(why) = page.read().unwrap() {
            break why.expect("a reason");
        }
    };
    assert_eq!((u16::from(why.code), why.reason.as_str()), (1001, "the server has ended"));
    assert!(served.child.wait().is_ok());
}

/// A page hands its scene back: the program prints it as a scenario that it reads again, and ends.
#[test]
fn a_changed_scene_is_handed_back() {
    let mut served = Served::with(&["--hand-back", "scenarios/analytic/release-jump.json"]);
    let (_, _, body) = served.get(&format!("/?token={}", served.token), &served.host);
    assert!(body.contains("data-hands-back"));
    let mut page = served.page();
    ask(&mut page, &json!({ "do": "set", "what": "mass", "value": 0.0032 }));
    ask(&mut page, &json!({ "do": "hand-back" }));
    told(&mut page, "handed");
    let mut text = String::new();
    served.printed.read_line(&mut text).unwrap();
    let mass = Scenario::parse(&text, "handed").unwrap().system.load.mass;
    assert!((mass / 0.0032 - 1.0).abs() < 1e-12, "{mass}");
    assert!(served.child.wait().unwrap().success());
}

/// A request whose head does not end is not waited for.
#[test]
fn half_a_request_is_closed() {
    let served = Served::start("scenarios/analytic/release-jump.json");
    let mut stream = TcpStream::connect(&served.host).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    write!(stream, "GET / HTTP/1.1\r\nHost: {}\r\nX-", served.host).unwrap();
    let mut reply = Vec::new();
    stream.read_to_end(&mut reply).expect("the server closes the connection");
    assert!(!reply.starts_with(b"HTTP/1.1 200"), "{reply:?}");
}

/// A page that draws no more, as one that is hidden, is sent a few frames and no others.
#[test]
fn a_page_that_draws_no_more_stops_its_runs() {
    let served = Served::start("scenarios/paper/four-ants-four-springs.json");
    let mut page = served.page();
    ask(&mut page, &json!({ "do": "play" }));
    page.get_ref().set_read_timeout(Some(Duration::from_secs(2))).unwrap();
    let (mut n_frames, mut last) = (0, Value::Null);
    // The message before two seconds of silence is the last.
    while let Ok(Message::Text(text)) = page.read() {
        let message: Value = serde_json::from_str(&text).unwrap();
        if message["tell"] == "frame" {
            (n_frames, last) = (n_frames + 1, message);
        }
        assert!(n_frames < 30, "frames go on");
    }
    assert!(n_frames > 5 && last["time_s"].as_f64().unwrap() < 0.3, "{n_frames} frames, {last}");
}
