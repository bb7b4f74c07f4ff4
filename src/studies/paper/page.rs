//! The page of the paper's results: what is not reproduced, then every table, and the figures.

use super::figure::Figures;
use super::readme::{Part, made_by, parts};
use super::report::Paper;
use crate::output::manifest::Manifest;
use crate::output::page::{Answer, Block, Headline, Page};

/// The page with its `figures`.
pub fn paper_page(found: &Paper, figures: &Figures, manifest: &Manifest) -> Page {
    let answer = if found.not_reproduced.is_empty() { Answer::Yes } else { Answer::Partly };
    let page =
        Page::new("The paper's results", Headline::new(answer, found.answer.clone()).with(Block::text(made_by(found).replace('`', ""))))
            .from(manifest);
    let page = parts(found).into_iter().fold(page, |page, Part { title, table, note }| {
        let note = (!note.is_empty()).then(|| Block::text(note.replace('`', "")));
        page.section(title, [Block::Table(table)].into_iter().chain(note).collect())
    });
    page.section("Figures", figures.iter().map(|(name, svg)| Block::figure(svg.as_str(), caption(name))).collect())
}

fn caption(figure: &str) -> &'static str {
    match figure {
        "pulls" => "Pulls by trial, and the largest one against the size of the sample",
        "group-size" => "Speed by the number of pulling ants, and time by that number beside the printed samples",
        "backends" => "What inertia and the engine move",
        "inertial-force" => "Inertial force of the load by smoothing time",
        "transition" => "Speed, turn rate and interaction forces of one run of four ants, with their changes of mean",
        "snapshots" => "The same run, in moments",
        "path" => "Its path",
        _ => "",
    }
}
