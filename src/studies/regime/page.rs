//! The page that stands beside the files of a regime map: what was done, and where theory and
//! measurement part.

use std::fmt::Write;
use std::path::Path;

use crate::output::quantity::{number, quantity};
use crate::studies::regime::report::{CellLine, Regime};
use crate::studies::regime::tables;
use crate::studies::regime::{Cause, Cell, Law};
use crate::studies::verify::scenes::{SLIP_STRETCH, natural_rate};

pub(crate) fn page(found: &Regime, target: &Path) -> String {
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
    page
}

fn method() -> String {
    format!(
        "Every cell is one scene run twice, with inertia and without, both under error control to 1e-4 of the way of a tip between two events (in the haul 1e-3). **Distance** is the largest \
         distance of the load's rim (shift plus radius times turn) over the length of the way without inertia; below 1 % paths count as the same. **Displacement** is the \
         shift along x with inertia over that without. Load, friction and stiffness are the paper's: f / k = {}, omega_n = {} rad/s; epsilon is set by the speed of the \
         tips and Phi by the time between events. Other masses at the same friction give the same cells (a test). epsilon Phi is the way of a tip between two events over \
         f / k, all that a load without inertia can see; a change of mass or pace moves a scene along a line on which it stays the same.\n\n\
         - **excursion**: a spring through the centre, as theory has it. Phi counts from the onset of slip without inertia; what goes before, 1 / epsilon from the rest shape, moves \
         nothing unless a dashpot helps. Exact theory exists.\n\
         - **tug-of-war**: two ants on springs through the centre, one of which holds f / k more than the other would need; they pull apart for T_e, the one astern lets go, and the \
         load jumps by what the tips have gone; the one ahead pulls on for T_e and lets go. Jump and drive are equally long, and the jump is epsilon Phi f / k.\n\
         - **haul**: the paper's load on its own four springs. Every T_e one ant grasps a tip at rest shape, where its load is, and one lets go after three T_e, two rounds in all; they pull to \
         +x, but no further than pi/3 from their spring, so that the one astern pulls back and aside. Theory has a law for continuous driving only. Where epsilon Phi exceeds about one, tips go several rest lengths between events and springs swing about their \
         roots: some steps do not converge there, and such cells say `no path found`.\n\n",
        quantity(SLIP_STRETCH, "m"),
        number(natural_rate())
    )
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
    let what = "The reference error is the largest of all cells, over the path length. Cells are unresolved where the distance is smaller than it.";
    format!("## Cells\n\n{what}\n\n{}\n", tables::panels(found).markdown())
}

fn laws(found: &Regime) -> String {
    let what =
        "Measured over theory, in cells whose reference error is below a tenth of the measured number. A law holds from 0.8 to 1.25.";
    format!("## Where theory and measurement disagree\n\n{what}\n\n{}\n", tables::laws(found).markdown())
}

/// What is behind each cause, with its worst cell.
fn causes(found: &Regime) -> String {
    let mut text = "| why | cells | the furthest off | |\n|---|---|---|---|\n".to_owned();
    for cause in Cause::ALL {
        let off: Vec<(f64, Law, &Cell)> = Law::ALL
            .iter()
            .flat_map(|law| found.cells.iter().filter(|cell| cell.scene == law.scene()).map(move |cell| (law, cell)))
            .filter_map(|(law, cell)| Some((law.ratio(cell)?, *law, cell)))
            .filter(|(ratio, law, cell)| !Law::holds(*ratio) && law.cause(cell) == cause)
            .collect();
        let Some((ratio, law, cell)) = off.iter().max_by(|a, b| a.0.ln().abs().total_cmp(&b.0.ln().abs())) else { continue };
        let Cell { phi, epsilon, zeta, .. } = cell;
        let at = format!("{} times ({}, Phi {phi:.3}, epsilon {epsilon:.4}, zeta {zeta})", number(*ratio), law.scene().name());
        writeln!(text, "| {} | {} | {at} | {} |", cause.name(), off.len(), cause.what()).expect("a string takes all");
    }
    text.push('\n');
    text
}

fn rule(found: &Regime) -> String {
    let what = "The rule says that quasi-static is valid where epsilon <= 0.05, Phi >= 2 pi and zeta >= 0.5. Measured, a path agrees within 1 % of its length. \
                The table counts cells that move.";
    format!("## The rule of thumb\n\n{what}\n\n{}\n", tables::rule(found).markdown())
}

fn paper(found: &Regime) -> String {
    let mut text = "## Where the paper's ants work\n\nUndamped; displacement by theory in brackets.\n\n\
                    | scene | Phi | epsilon | distance | displacement |\n|---|---|---|---|---|\n"
        .to_owned();
    let percent = |share: Option<f64>| share.map_or("nothing moves".to_owned(), |share| format!("{:.1} %", 100.0 * share));
    let plain = |ratio: Option<f64>| ratio.map_or_else(String::new, |ratio| format!("{ratio:.3}"));
    for CellLine { scene, phi, epsilon, share, displacement_ratio, predicted_displacement_ratio, .. } in &found.paper {
        let expected = predicted_displacement_ratio.map_or_else(String::new, |ratio| format!(" ({ratio:.3})"));
        let expected = if share.is_some() { expected } else { String::new() };
        writeln!(text, "| {} | {phi} | {epsilon:.4} | {} | {}{expected} |", scene.name(), percent(*share), plain(*displacement_ratio))
            .expect("a string takes all");
    }
    text
}
