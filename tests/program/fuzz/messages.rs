//! Messages of the live page, as the server hands them to a session.

use std::sync::mpsc::sync_channel;

use cohaul_app::live::{Ask, Gone, Judge, LiveScene, Session, Tell};
use cohaul_report::json;
use serde_json::{Value, json};

use crate::corpus;
use crate::survey::{Format, survey};

/// Messages of a session at most.
const MOST: usize = 40;

/// A list of messages, or one message a line, to a session of a small scene. The session ends when
/// all are answered.
fn read(input: &[u8]) -> Result<(), String> {
    let text = String::from_utf8_lossy(input);
    let parsed: Vec<Result<Ask, String>> = match serde_json::from_str(&text) {
        Ok(Value::Array(list)) => list.into_iter().take(MOST).map(|one| serde_json::from_value(one).map_err(told)).collect(),
        _ => text.lines().take(MOST).map(|line| serde_json::from_str(line).map_err(told)).collect(),
    };
    let (ask, asks) = sync_channel(MOST);
    let mut refused = None;
    for one in parsed {
        match one {
            Ok(asked) => ask.send(asked).map_err(told)?,
            Err(why) => refused = Some(Tell::refused(why)),
        }
    }
    drop(ask);
    let scene = LiveScene::new(corpus::scene(&corpus::small()));
    let tell = |what: Tell| -> Result<(), Gone> {
        let line = json::line(&what).unwrap_or_else(|error| panic!("told: {error}"));
        let is_short = !matches!(what, Tell::Refused { .. }) || line.chars().count() < 12_000;
        assert!(is_short, "a refusal of {} characters", line.chars().count());
        Ok(())
    };
    let judge = Judge::new(std::sync::Arc::default());
    // It ends when the messages do.
    let _: Result<(), Gone> = Session::new(&scene, judge, tell).run(scene, &asks);
    match refused {
        Some(Tell::Refused { why }) => Err(why),
        _ => Ok(()),
    }
}

fn told(error: impl ToString) -> String {
    error.to_string()
}

/// Every message, in sessions that make sense.
fn sessions() -> Vec<Value> {
    let step = json!({ "do": "step" });
    let settings = json!({ "backends": ["inertial", "rapier"], "steps_s": [null, 0.001, null] });
    let scene: Value = serde_json::from_str(&corpus::small()).unwrap();
    let ants: Value = serde_json::from_str(corpus::ANTS).unwrap();
    vec![
        json!([{ "do": "play" }, step, { "do": "pause" }, { "do": "go-to", "time_s": 0.05 }, { "do": "pace", "factor": 2 },
            { "do": "drawn", "frame": 3 }, { "do": "restart" }, { "do": "save" }]),
        json!([{ "do": "set", "what": "mass", "value": 0.002 }, step, { "do": "set", "what": "speed", "value": 2 },
            { "do": "set", "what": "stiffness", "value": 1.0 }, { "do": "settings", "settings": settings }, step]),
        json!([{ "do": "drag", "handle": { "spring": 1 }, "to": [0.1, 0.1] }, step, step, { "do": "drop" }, { "do": "release", "spring": 1 },
            { "do": "drag", "handle": { "pusher": 1 }, "to": [-0.03, 0.0] }, step, { "do": "drop" }, step, { "do": "restart" }, step]),
        json!([{ "do": "open", "saved": { "scenario": scene, "settings": settings, "time_s": 0.02 } }, step]),
        json!([{ "do": "open", "saved": { "scenario": ants } }, step, { "do": "ants", "on": false }, step, { "do": "ants", "on": true }, step]),
        json!([{ "do": "shipped", "name": "pusher" }, step, { "do": "drag", "handle": { "pusher": 0 }, "to": [0.0, 0.0] }, step]),
    ]
}

#[test]
fn hostile_messages_are_refused_or_done() {
    let files = sessions();
    let lines = |list: &Value| list.as_array().unwrap().iter().map(|one| format!("{one}\n")).collect::<String>().into_bytes();
    let texts = files.iter().map(lines).collect();
    survey(&Format { name: "messages", texts, files, read }, 300);
}
