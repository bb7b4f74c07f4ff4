//! The page, which draws with the script of a replay.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use cohaul_report::glossary::entry;
use cohaul_report::page::{SCRIPT_OF_CURVES, SCRIPT_OF_SCENES, STYLE};
use maud::{DOCTYPE, PreEscaped, html};
use sha2::{Digest, Sha256};

/// Parts of the script of this page, in the order in which they use each other.
const PARTS: [&str; 8] = [
    include_str!("course.js"),
    include_str!("keep.js"),
    include_str!("handles.js"),
    include_str!("editor.js"),
    include_str!("timeline.js"),
    include_str!("hand.js"),
    include_str!("panel.js"),
    include_str!("connect.js"),
];

static SCRIPT: LazyLock<String> = LazyLock::new(|| [SCRIPT_OF_SCENES, SCRIPT_OF_CURVES, &terms(), &PARTS.concat()].concat());

/// Terms that the page explains where they stand.
const TERMS: [&str; 9] = ["inertia effect", "engine error", "tolerance", "epsilon", "Phi", "zeta", "quasi-static", "inertial", "rapier"];

/// Their meanings, as `cohaul explain` prints them, for the script.
fn terms() -> String {
    let meaning = |term: &&'static str| Some((*term, entry(term)?.meaning.as_str()));
    let meanings: BTreeMap<&str, &str> = TERMS.iter().filter_map(meaning).collect();
    format!("const TERMS = {};\n", serde_json::to_string(&meanings).expect("texts are JSON").replace("</", "<\\/"))
}

/// The page, which `hands_back` its scene or does not, and the policy under which it runs: only
/// this script, and only this server.
pub fn html(hands_back: bool) -> (String, String) {
    let hash = STANDARD.encode(Sha256::digest(SCRIPT.as_bytes()));
    let policy = format!(
        "default-src 'none'; script-src 'sha256-{hash}'; style-src 'unsafe-inline'; img-src data: blob:; connect-src 'self'; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    );
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { "cohaul: live" }
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) (PreEscaped(include_str!("live.css"))) }
            }
            body data-hands-back[hands_back] {
                header { p.kicker { "cohaul, live" } h1 { "…" } }
                main.live {
                    section.headline.none #verdict aria-live="polite" {
                        p.verdict { span.sign aria-hidden="true" { "…" } span.sentence { "Connecting" } }
                        progress max="1" hidden {}
                        div.quantities {}
                        p.numbers {}
                    }
                    div.testbed {
                        div.shown {
                            figure.replay { div.stage {} }
                            figure.curves { div.plots {} }
                        }
                        div.side { aside.panel aria-label="Scene" {} }
                    }
                }
                div.told role="status" {}
                div #meaning popover="auto" {}
                script type="module" { (PreEscaped(SCRIPT.as_str())) }
            }
        }
    };
    (page.into_string(), policy)
}
