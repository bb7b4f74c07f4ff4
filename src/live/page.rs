//! The page, which draws with the script of a replay.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, PreEscaped, html};
use sha2::{Digest, Sha256};

const STYLE: &str = concat!(include_str!("../output/page/page.css"), include_str!("live.css"));
const SCRIPT: &str = concat!(
    "\n",
    include_str!("../output/page/script/base.js"),
    include_str!("../output/page/script/parts.js"),
    include_str!("../output/page/script/view.js"),
    include_str!("../output/page/script/stage.js"),
    include_str!("../output/page/script/curves.js"),
    include_str!("panel.js"),
    include_str!("live.js"),
);

/// The page, and the policy under which it runs: only this script, and only this server.
pub fn html() -> (String, String) {
    let hash = STANDARD.encode(Sha256::digest(SCRIPT));
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
                style { (PreEscaped(STYLE)) }
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
                script type="module" { (PreEscaped(SCRIPT)) }
            }
        }
    };
    (page.into_string(), policy)
}
