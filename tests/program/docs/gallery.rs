//! The gallery: each scene with its picture, its answer, and how to run it. Pictures and answers
//! stand in `results/`, from where the ignored test brings them up to date.

use std::fs;

use serde_json::{Value, json};

use crate::{cohaul, read, root};

const FOLDER: &str = "results/2026-11-25-gallery";

const TITLE: &str = "# Gallery

Scenes that come with `cohaul`. The answer below each is that of `cohaul compare`, on paths; the
pictures are of the inertial backend, by `cohaul render`. Every scene can be opened in the [live
testbed](live.md). To bring the page up to date, call

```sh
cargo test --release --test docs gallery -- --ignored
COHAUL_REWRITE=1 cargo test --test docs
```
";

/// A scene, what it shows, and the time of its picture (s); the end without one.
const SCENES: [(&str, &str, Option<f64>); 17] = [
    ("paper/four-ants-four-springs", "Four ants of the paper take the load on springs to the nest.", Some(20.0)),
    ("paper/ten-ants-ten-springs", "Ten ants on ten springs.", Some(5.0)),
    ("paper/wall-with-gap", "Ants bring the load through a gap in a wall before the nest.", None),
    ("paper/post", "A post stands on the way to the nest.", None),
    ("paper/four-tips-prescribed", "Four tips on given ways, in place of ants.", None),
    ("analytic/release-jump", "Of two springs that balance each other one is let go, and the load jumps.", Some(1.5)),
    ("analytic/ramp-and-hold", "A tip pulls the load along and stops.", None),
    ("analytic/slide-spin", "A load slides and spins until friction stops it.", None),
    ("contact/pusher", "A post pushes a disc straight ahead.", None),
    ("contact/rebound", "A disc hits a wall and rebounds.", None),
    ("contact/disc-roll", "A disc rolls along a rough wall.", None),
    ("contact/notch-jam", "A load jams in a notch.", None),
    ("robots/tow-past-corner", "A crate is towed past the corner of a shelf.", None),
    ("robots/two-fingers", "Two fingers push a box round a bend.", Some(4.0)),
    ("robots/fence", "A moving fence aligns a part.", None),
    ("robots/caging", "Four pushers cage a disc and take it along.", None),
    ("robots/sorting", "A slanted wall diverts a parcel to the next lane.", None),
];

fn name_of(scene: &str) -> &str {
    scene.rsplit_once('/').map_or(scene, |(_, name)| name)
}

fn command(scene: &str) -> String {
    format!("compare scenarios/{scene}.json")
}

/// The page as it should be.
pub fn page() -> String {
    let answers = answers();
    let part = |(scene, about, _): &(&str, &str, Option<f64>)| {
        let answer = text_of(&answers, scene);
        let name = name_of(scene);
        format!(
            "\n## {}\n\n{about}\n\n![{about}]({FOLDER}/{name}.png)\n\n```text\n{}\n```\n\n```sh\ncohaul {}\n```\n\n\
             ```python\ncohaul.compare(\"scenarios/{scene}.json\").answer\n```\n",
            name.replace('-', " "),
            wrapped(answer),
            command(scene),
        )
    };
    TITLE.to_owned() + &SCENES.iter().map(part).collect::<String>()
}

/// Words of an answer, and the list of a scenario that must not be empty where they stand.
const QUANTITIES: [(&str, &str); 5] =
    [("pull", "springs"), ("spring", "springs"), ("contact force", "obstacles"), ("obstacle", "obstacles"), ("wall", "obstacles")];
/// Scenes that are compared again in each test, because they take a moment: with a spring, without
/// one, and with an obstacle.
const QUICK: [&str; 3] = ["analytic/release-jump", "analytic/slide-spin", "contact/rebound"];

fn answers() -> Value {
    serde_json::from_str(&read(&format!("{FOLDER}/answers.json"))).expect("the answers are JSON")
}

fn scenario(scene: &str) -> Value {
    serde_json::from_str(&read(&format!("scenarios/{scene}.json"))).expect("a scene is JSON")
}

/// Quantities that an answer or the words on a scene name, and that the scene has not.
fn without_a_scene(scene: &str, text: &str) -> Vec<String> {
    let scenario = scenario(scene);
    let is_empty = |key: &str| scenario[key].as_array().is_some_and(Vec::is_empty) || scenario[key].is_null();
    let wrong = QUANTITIES.iter().filter(|(word, key)| text.to_lowercase().contains(word) && is_empty(key));
    wrong.map(|(word, key)| format!("{scene} has no {key}: `{word}` in: {text}")).collect()
}

/// Quantities that the page names under scenes without them.
pub fn quantities_without_a_scene() -> Vec<String> {
    let answers = answers();
    let texts = SCENES.iter().flat_map(|(scene, about, _)| [(scene, *about), (scene, text_of(&answers, scene))]);
    texts.flat_map(|(scene, text)| without_a_scene(scene, text)).collect()
}

fn text_of<'a>(answers: &'a Value, scene: &str) -> &'a str {
    answers[scene]["answer"].as_str().unwrap_or_else(|| panic!("{scene} has no answer in {FOLDER}"))
}

/// Lines of at most 80 columns, as on a terminal.
fn wrapped(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("there is a line");
        if line.chars().count() + word.chars().count() + 1 > 80 {
            lines.push(word.to_owned());
        } else {
            line.push_str(if line.is_empty() { "" } else { " " });
            line.push_str(word);
        }
    }
    lines.join("\n")
}

/// What `cohaul compare` says of a scene. Scenes of ants have a second tier, which takes longer and
/// is no part of the answer.
fn compared(scene: &str) -> Value {
    let asked = command(scene) + " --json --no-check-suggestions --quiet";
    let has_ants = scenario(scene)["drive"]["kind"] == "ants";
    let asked = if has_ants { asked + " --tier replayed" } else { asked };
    let arguments: Vec<String> = asked.split(' ').map(str::to_owned).collect();
    let output = cohaul(&arguments, &root()).output().unwrap();
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{scene}: {error}"))
}

#[test]
fn stored_answers_are_those_of_the_program() {
    let stored = answers();
    for scene in QUICK {
        assert_eq!(text_of(&stored, scene), compared(scene)["answer"], "{scene}: renew the gallery");
    }
    assert_eq!(without_a_scene("contact/rebound", "Valid for pulls.").len(), 1);
    assert_eq!(without_a_scene("analytic/slide-spin", "The peak contact force.").len(), 1);
}

#[test]
#[ignore = "brings the results of the gallery up to date, which takes minutes"]
fn gallery_is_renewed() {
    fs::create_dir_all(root().join(FOLDER)).unwrap();
    let mut answers = serde_json::Map::new();
    for (scene, _, time) in SCENES {
        let found = compared(scene);
        answers.insert(scene.to_owned(), json!({ "answer": found["answer"], "seed": found["seed"], "settings": found["settings"] }));
        let out = format!("{FOLDER}/{}.png", name_of(scene));
        let mut drawn: Vec<String> =
            ["render", &format!("scenarios/{scene}.json"), "--backend", "inertial", "--out", &out].map(str::to_owned).to_vec();
        drawn.extend(time.iter().flat_map(|time| ["--at-s".to_owned(), time.to_string()]));
        let output = cohaul(&drawn, &root()).output().unwrap();
        assert!(output.status.success(), "{scene}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let text = serde_json::to_string_pretty(&answers).unwrap() + "\n";
    fs::write(root().join(FOLDER).join("answers.json"), text).unwrap();
}
