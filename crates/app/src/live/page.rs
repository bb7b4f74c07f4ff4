//! The page, which draws with the script of a replay.

use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use cohaul_report::page::{SCRIPT_OF_CURVES, SCRIPT_OF_SCENES, STYLE};
use maud::{DOCTYPE, PreEscaped, html};
use sha2::{Digest, Sha256};

static SCRIPT: LazyLock<String> =
    LazyLock::new(|| [SCRIPT_OF_SCENES, SCRIPT_OF_CURVES, include_str!("panel.js"), include_str!("live.js")].concat());

/// The page, and the policy under which it runs: only this script, and only this server.
pub fn html() -> (String, String) {
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
            body {
                header { p.kicker { "cohaul, live" } h1 { "…" } }
                main.live {
                    section.headline.none #verdict aria-live="polite" {
                        p.verdict { span.sign aria-hidden="true" { "…" } span.sentence { "Connecting" } }
                        div.quantities {}
                        p.numbers {}
                    }
                    div.testbed {
                        figure.replay { div.stage {} }
                        aside.panel aria-label="Scene" {}
                    }
                    p.told role="status" {}
                    figure.curves { div.plots {} }
                }
                script type="module" { (PreEscaped(SCRIPT.as_str())) }
            }
        }
    };
    (page.into_string(), policy)
}
