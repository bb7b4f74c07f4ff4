//! The report of a regime map: its figures, and the tables below them.

use crate::regime::report::Regime;
use crate::regime::tables;
use cohaul_report::manifest::Manifest;
use cohaul_report::page::{Answer, Block, Headline, Page};

pub(crate) fn regime_page(found: &Regime, figures: &[(String, String)], manifest: &Manifest) -> Page {
    let answer = if found.holds { Answer::None } else { Answer::No };
    let page = Page::new("Where inertia matters", Headline::new(answer, sentence(found))).from(manifest);
    let drawn = figures.iter().map(|(name, svg)| {
        let scene = found.grids.iter().find(|grid| grid.scene.name() == name).map(|grid| grid.scene.what());
        Block::figure(svg.as_str(), format!("{name}: {}", scene.unwrap_or("measured over theory")))
    });
    page.section("Maps", drawn.collect())
        .section("Cells", vec![Block::Table(tables::panels(found))])
        .section("Measurement over theory", vec![Block::Table(tables::laws(found))])
        .section("The rule of thumb: epsilon at most 0.05, Phi at least 2 pi, zeta at least 0.5", vec![Block::Table(tables::rule(found))])
}

fn sentence(found: &Regime) -> String {
    let sums = found.maps.iter().fold([0, 0], |sums, map| [sums[0] + map.n_agree, sums[1] + map.n_moving]);
    let laws = if found.holds { "The exact laws hold wherever they apply." } else { "An exact law does not hold in some cell." };
    format!(
        "In {} of {} cells that move, inertia changes the path by at most {} % of its length. {laws}",
        sums[0],
        sums[1],
        100.0 * found.relative_tolerance
    )
}
