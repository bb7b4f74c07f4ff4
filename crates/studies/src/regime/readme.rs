//! The README in the folder of a regime map: the method, the figures, and where theory and
//! measurement disagree.

use std::fmt::Write;
use std::path::Path;

use crate::regime::report::Regime;
use crate::regime::tables;
use crate::regime::{Cause, Cell, Law};
use crate::variants;
use crate::verify::scenes::{SLIP_STRETCH, natural_rate};
use cohaul_report::quantity::{number, quantity};
use cohaul_report::table::Table;
use cohaul_report::text::wrapped_markdown;

/// The page in Markdown, for the output folder `target`.
pub(crate) fn readme(found: &Regime, target: &Path) -> String {
    let folder = target.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let quick = if found.quick { " --quick" } else { "" };
    let mut page = format!(
        "# Where inertia matters\n\n`cohaul regime{quick} --out {folder}` made all that is in this folder, in {}.\n\n",
        quantity(found.wall_s, "s")
    );
    page.push_str(&method());
    page.push_str(&figures(found));
    page.push_str(&maps(found));
    page.push_str(&laws(found));
    page.push_str(&causes(found));
    page.push_str(&rule(found));
    page.push_str(&paper(found));
    wrapped_markdown(&page)
}

/// What a cell is, and the scenes.
const METHOD: &str = "\
Every cell is one scene run twice, with inertia and without. Both runs are under error control, to 1e-4 of the path \
length of a tip between two events (1e-3 in the haul).

- **Distance** is the largest edge displacement between the two paths, over the path length without inertia. Below 1 % \
the paths count as the same.
- **Displacement** is the displacement along x with inertia, over that without.

Load, friction and stiffness are the paper's: f / k = {f / k} and omega_n = {omega_n} rad/s. The speed of the tips sets \
epsilon, and the time between events sets Phi. Other masses at the same friction give the same cells, which a test \
shows. The product epsilon Phi is the path length of a tip between two events over f / k. A load without inertia \
depends on this product alone. A change of mass or speed moves a scene along a line on which the product stays the same.

- **excursion**: a spring through the centre, for which exact theory exists. Phi counts from the slip onset without \
inertia. The time before it, 1 / epsilon from the rest shape, moves nothing unless a dashpot helps.
- **tug-of-war**: two ants on springs through the centre, one of which pulls with f / k more than the other would need. \
They pull apart for T_e. Then the rear ant releases, and the load jumps by the displacement of the tips. The front ant \
pulls on for T_e and releases. Jump and drive are equally long, and the jump is epsilon Phi f / k.
- **haul**: the paper's load on its own four springs. Every T_e one ant grasps a tip at rest shape, and one releases \
after three T_e, two rounds in all. They pull to +x, but at most pi / 3 from their spring, so that the rear ant pulls \
back and aside. Theory has a law for continuous driving only. Where epsilon Phi exceeds about one, tips move several \
rest lengths between events and springs swing about their roots. Some steps do not converge there, and such cells say \
`no path found`.

";

fn method() -> String {
    METHOD.replace("{f / k}", &quantity(SLIP_STRETCH, "m")).replace("{omega_n}", &number(natural_rate()))
}

fn figures(found: &Regime) -> String {
    let mut text = String::new();
    for grid in &found.grids {
        let name = grid.scene.name();
        writeln!(text, "![{name}: {}]({name}.svg)\n", grid.scene.what()).expect("a string takes all");
    }
    text.push_str("![measured over theory](disagreement.svg)\n\n");
    text
}

fn maps(found: &Regime) -> String {
    let what = "The reference error is the largest of all cells, over the path length. A cell is inconclusive where the distance is below its reference error.";
    format!("## Cells\n\n{what}\n\n{}\n", tables::panels(found).markdown())
}

fn laws(found: &Regime) -> String {
    let what =
        "Measured over theory, in cells whose reference error is below a tenth of the measured number. A law holds from 0.8 to 1.25.";
    format!("## Where theory and measurement disagree\n\n{what}\n\n{}\n", tables::laws(found).markdown())
}

/// Each cause of a difference, with the cell that differs most.
fn causes(found: &Regime) -> String {
    let mut table = Table::new("", ["cause", "cells", "largest difference", "explanation"]);
    for cause in variants::all::<Cause>() {
        let off: Vec<(f64, Law, &Cell)> = Law::ALL
            .iter()
            .flat_map(|law| found.cells.iter().filter(|cell| cell.scene == law.scene()).map(move |cell| (law, cell)))
            .filter_map(|(law, cell)| Some((law.ratio(cell)?, *law, cell)))
            .filter(|(ratio, law, cell)| !Law::holds(*ratio) && law.cause(cell) == cause)
            .collect();
        let Some((ratio, law, cell)) = off.iter().max_by(|a, b| a.0.ln().abs().total_cmp(&b.0.ln().abs())) else { continue };
        let Cell { phi, epsilon, zeta, .. } = cell;
        let at = format!("{} times ({}, Phi {phi:.3}, epsilon {epsilon:.4}, zeta {zeta})", number(*ratio), law.scene().name());
        table.push([&cause.name(), &off.len().to_string(), &at, cause.what()]);
    }
    table.markdown() + "\n"
}

fn rule(found: &Regime) -> String {
    let what = "The rule says that quasi-static is valid where epsilon <= 0.05, Phi >= 2 pi and zeta >= 0.5. Measured, a path agrees within 1 % of its length. \
                The table counts cells that move.";
    format!("## The rule of thumb\n\n{what}\n\n{}\n", tables::rule(found).markdown())
}

fn paper(found: &Regime) -> String {
    let percent = |ratio: Option<f64>| ratio.map_or("nothing moves".to_owned(), |ratio| format!("{:.1} %", 100.0 * ratio));
    let plain = |ratio: Option<f64>| ratio.map_or_else(String::new, |ratio| format!("{ratio:.3}"));
    let expected = |ratio: Option<f64>| ratio.map_or_else(String::new, |ratio| format!(" ({ratio:.3})"));
    let mut table = Table::new("", ["scene", "Phi", "epsilon", "distance", "displacement"]);
    for cell in &found.paper {
        let (phi, epsilon, distance) = (cell.phi, cell.epsilon, cell.distance_ratio());
        let predicted = cell.predicted_displacement_ratio().filter(|_| distance.is_some());
        let displacement = plain(cell.displacement_ratio()) + &expected(predicted);
        table.push([cell.scene.name().to_owned(), phi.to_string(), format!("{epsilon:.4}"), percent(distance), displacement]);
    }
    format!(
        "## Short pulls at the speeds of the paper's ants\n\nThe springs are undamped. The displacement by theory stands in brackets.\n\n{}",
        table.markdown()
    )
}
