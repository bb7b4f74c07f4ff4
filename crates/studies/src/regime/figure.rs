//! The figures of the regime map: a page a scene, with the largest distance above and the
//! displacement below, a panel a damping ratio; and a page of measurement over theory.

use std::f64::consts::FRAC_PI_2;

use crate::regime::theory::{EPSILON_MAX, PHI_MIN, ZETA_MIN};
use crate::regime::{Cell, Grid, Law, PAPER_SPEEDS, RELATIVE_TOLERANCE, SHORT_PHIS, Scene, epsilon_of, theory};
use crate::verify::scenes::natural_rate;
use cohaul_report::chart::cells::{CROSSED, CellAxis, CellMap, DOTTED, HATCHED, Key, Level, Size, cell_maps, place, viridis};
use cohaul_report::chart::panel::Style;

const SIZE: Size = Size { width: 226.0, height: 196.0, left: 66.0, least_columns: 4 };

const MEASURED: Style = Style { color: "#000000", dash: "", width: 2.2 };
const MEASURED_ABOVE: Style = Style { width: 1.1, ..MEASURED };
const PREDICTED: Style = Style { color: "#d0006f", dash: "7 4", width: 2.0 };
const PREDICTED_ABOVE: Style = Style { dash: "2 3", ..PREDICTED };
const RULE: Style = Style { color: "#333333", dash: "1.5 3", width: 1.6 };

/// Displacements that are a tenth off, and laws that are a quarter off (1).
const OFF: [f64; 2] = [0.9, 1.1];
const LAW_OFF: [f64; 2] = [0.8, 1.25];
/// Nodes of a formula's grid along an axis.
const FINE: usize = 121;

/// The largest distance over the path length, and the displacement over that without inertia.
pub fn scene_map(grid: &Grid, cells: &[Cell]) -> String {
    let panels = |panel: &dyn Fn(f64, &[&Cell]) -> CellMap| {
        grid.zetas.iter().map(|zeta| panel(*zeta, &of_panel(grid, *zeta, cells))).collect::<Vec<CellMap>>()
    };
    let lowest = lowest_decade(cells.iter().filter(|cell| cell.scene == grid.scene));
    let rows = [panels(&|zeta, cells| distance(grid, zeta, cells, lowest)), panels(&|zeta, cells| displacement(grid, zeta, cells))];
    let is_expected = |style: &Style| {
        let levels = || rows.iter().flatten().flat_map(|map| &map.levels).filter(|level| level.style == *style);
        levels().any(|level| {
            let above = |is: bool| level.field.iter().flatten().any(|value| (*value >= level.at) == is && value.is_finite());
            above(true) && above(false)
        })
    };
    let shares = (0..=20).map(|i| lowest * (1.0 - 0.05 * f64::from(i)));
    let label = |decade: f64| if (decade.round() - decade).abs() < 1e-9 { format!("{:.0e}", 10f64.powf(decade)) } else { String::new() };
    let shares = shares.map(|decade| (share_color(10f64.powf(decade), lowest), label(decade))).collect();
    let line = |style, name: &str| Key::Line(style, name.to_owned());
    let theory = if grid.scene == Scene::Haul { "theory: 2 epsilon f / k is 1 %" } else { "theory: 1 %, 0.9" };
    let mut lines = vec![line(MEASURED, "measured: 1 % above, 0.9 below"), line(MEASURED_ABOVE, "measured: 1.1")];
    lines.extend(is_expected(&PREDICTED).then(|| line(PREDICTED, theory)));
    lines.extend(is_expected(&PREDICTED_ABOVE).then(|| line(PREDICTED_ABOVE, "theory: 1.1")));
    lines.push(line(RULE, RULE_NAME));
    let scales = vec![
        Key::Scale { name: "largest distance / path length".to_owned(), colors: shares },
        ratio_scale("displacement / that without inertia"),
    ];
    cell_maps(&format!("{}: {}", grid.scene.name(), grid.scene.what()), &rows, &[scales, lines, without_number()], SIZE)
}

/// Measured over theory, a row a law.
pub fn disagreement(grids: &[Grid], cells: &[Cell]) -> String {
    const LAWS: [Law; 4] = [Law::Ramp, Law::UndampedExcursion, Law::Release, Law::Driving];
    let row = |law: &Law| {
        let grid = grids.iter().find(|grid| grid.scene == law.scene())?;
        let panel = |zeta: &f64| {
            let cells = of_panel(grid, *zeta, cells);
            let ratio = |cell: &Cell| law.ratio(cell);
            let field = field(grid, &cells, &ratio);
            let levels = [(LAW_OFF[0], MEASURED, "0.8"), (LAW_OFF[1], MEASURED_ABOVE, "1.25")];
            CellMap {
                title: if *zeta == grid.zetas[0] {
                    format!("{}, {}, zeta = {zeta}", grid.scene.name(), law.short_name())
                } else {
                    format!("zeta = {zeta}")
                },
                fills: cells.iter().map(|cell| ratio(cell).map_or_else(|| blank(cell), ratio_color)).collect(),
                levels: levels.into_iter().map(|(at, style, word)| Level { field: field.clone(), at, style, word }).collect(),
                ..plane(grid, *zeta)
            }
        };
        Some(grid.zetas.iter().map(panel).collect())
    };
    let rows: Vec<Vec<CellMap>> = LAWS.iter().filter_map(row).collect();
    let lines = vec![
        ratio_scale("measured / theory"),
        Key::Line(MEASURED, "measured 0.8 of theory".to_owned()),
        Key::Line(MEASURED_ABOVE, "1.25 of theory".to_owned()),
        Key::Line(RULE, RULE_NAME.to_owned()),
    ];
    cell_maps("Where theory and measurement disagree: measured / theory", &rows, &[lines, without_number()], SIZE)
}

/// Decade below the smallest conclusive distance over the path length, from -6 to -1.
fn lowest_decade<'a>(cells: impl Iterator<Item = &'a Cell>) -> f64 {
    let shares = cells.filter(|cell| cell.is_conclusive()).filter_map(Cell::distance_ratio).filter(|share| *share > 0.0);
    shares.map(|share| share.log10().floor()).fold(-1.0, f64::min).max(-6.0)
}

fn distance(grid: &Grid, zeta: f64, cells: &[&Cell], lowest: f64) -> CellMap {
    let over = |share: f64| (share / RELATIVE_TOLERANCE).log10();
    let measured = field(grid, cells, &|cell| cell.distance_ratio().map(over));
    let expected = match grid.scene {
        Scene::Excursion => formula(grid, |phi, epsilon| over(theory::excursion_distance_ratio(phi, epsilon, zeta))),
        _ => field(grid, cells, &|cell| cell.predicted_distance_ratio().map(over)),
    };
    let fill = |cell: &&Cell| match cell.distance_ratio() {
        Some(_) if !cell.is_conclusive() => HATCHED.to_owned(),
        Some(share) => share_color(share, lowest),
        None => blank(cell),
    };
    CellMap {
        title: format!("zeta = {zeta}: largest distance"),
        fills: cells.iter().map(fill).collect(),
        levels: vec![
            Level { field: measured, at: 0.0, style: MEASURED, word: "1 %" },
            Level { field: expected, at: 0.0, style: PREDICTED, word: "" },
        ],
        ..plane(grid, zeta)
    }
}

fn displacement(grid: &Grid, zeta: f64, cells: &[&Cell]) -> CellMap {
    let measured = field(grid, cells, &Cell::displacement_ratio);
    let level = |field: &Vec<Vec<f64>>, at, style, word| Level { field: field.clone(), at, style, word };
    let mut levels = vec![level(&measured, OFF[0], MEASURED, "0.9"), level(&measured, OFF[1], MEASURED_ABOVE, "1.1")];
    let expected = match grid.scene {
        Scene::Excursion => Some(formula(grid, |phi, epsilon| theory::excursion(phi, epsilon, zeta))),
        Scene::TugOfWar => Some(formula(grid, |phi, epsilon| theory::release(phi, epsilon, zeta))),
        Scene::Haul => None,
    };
    if let Some(expected) = expected {
        levels.extend([level(&expected, OFF[0], PREDICTED, ""), level(&expected, OFF[1], PREDICTED_ABOVE, "")]);
    }
    let at = |phi: f64, above: f64| at(grid, phi, 1.35 * above * grid.epsilons[0]);
    // A haul has no such halves.
    let words = if zeta < ZETA_MIN && grid.scene != Scene::Haul {
        vec![
            ("inertia".to_owned(), vec![at(0.72, 2.0)]),
            ("suppresses".to_owned(), vec![at(0.72, 1.25)]),
            ("overshoot".to_owned(), [1.25, 2.0, 3.2].map(|above| at(5.2, above)).to_vec()),
        ]
    } else {
        Vec::new()
    };
    CellMap {
        title: format!("zeta = {zeta}: displacement"),
        fills: cells.iter().map(|cell| cell.displacement_ratio().map_or_else(|| blank(cell), ratio_color)).collect(),
        levels,
        words,
        ..plane(grid, zeta)
    }
}

/// The axes of a panel, its rules and the place of short pulls at the speeds of the paper's ants, a
/// bar a speed.
fn plane(grid: &Grid, zeta: f64) -> CellMap {
    let last = grid.phis[grid.phis.len() - 1] * 2.0;
    let (lowest, highest) = (0.5 * grid.epsilons[0], 2.0 * grid.epsilons[grid.epsilons.len() - 1]);
    let at = |phi: f64, epsilon: f64| at(grid, phi, epsilon);
    let mut lines = vec![(vec![at(FRAC_PI_2, lowest), at(FRAC_PI_2, highest)], RULE)];
    if zeta >= ZETA_MIN {
        lines.push((vec![at(PHI_MIN, lowest), at(PHI_MIN, EPSILON_MAX), at(last, EPSILON_MAX)], RULE));
    }
    let bar = |speed| ends_of_short_pulls().map(|phi| at(phi, epsilon_of(speed)));
    CellMap {
        x: CellAxis::decades("Phi = omega_n T_e", &grid.phis, 7),
        y: CellAxis::decades("epsilon = v √(k m) / f", &grid.epsilons, 8),
        lines,
        bars: PAPER_SPEEDS.map(bar).to_vec(),
        ..CellMap::default()
    }
}

/// Place of a point (Phi, epsilon) on a panel.
fn at(grid: &Grid, phi: f64, epsilon: f64) -> [f64; 2] {
    let share = |values: &[f64], value| (place(values, value) + 0.5) / values.len() as f64;
    [share(&grid.phis, phi), share(&grid.epsilons, epsilon)]
}

/// Cells of one panel in the order of its grid.
fn of_panel<'a>(grid: &Grid, zeta: f64, cells: &'a [Cell]) -> Vec<&'a Cell> {
    cells.iter().filter(|cell| cell.scene == grid.scene && cell.zeta == zeta).collect()
}

/// A number of the cells, in rows of equal epsilon.
fn field(grid: &Grid, cells: &[&Cell], number: &dyn Fn(&Cell) -> Option<f64>) -> Vec<Vec<f64>> {
    cells.chunks(grid.phis.len()).map(|row| row.iter().map(|cell| number(cell).unwrap_or(f64::NAN)).collect()).collect()
}

/// A formula on nodes that are closer than the cells.
fn formula(grid: &Grid, formula: impl Fn(f64, f64) -> f64) -> Vec<Vec<f64>> {
    let fine = |values: &[f64]| {
        let (low, high) = (values[0], values[values.len() - 1]);
        (0..FINE).map(|i| low * (high / low).powf(i as f64 / (FINE - 1) as f64)).collect::<Vec<f64>>()
    };
    let phis = fine(&grid.phis);
    fine(&grid.epsilons).iter().map(|epsilon| phis.iter().map(|phi| formula(*phi, *epsilon)).collect()).collect()
}

/// Pattern of a cell without the number asked for.
fn blank(cell: &Cell) -> String {
    match () {
        _ if !cell.is_converged => CROSSED,
        _ if !cell.moves() => DOTTED,
        _ => "#ffffff",
    }
    .to_owned()
}

fn ends_of_short_pulls() -> [f64; 2] {
    [SHORT_PHIS[0], SHORT_PHIS[SHORT_PHIS.len() - 1]]
}

/// What stands for cells without a number, and for short pulls.
fn without_number() -> Vec<Key> {
    let patterns = [(HATCHED, "inconclusive"), (DOTTED, "nothing moves"), (CROSSED, "no path found")];
    let patterns = patterns.map(|(fill, name)| Key::Swatch(fill.to_owned(), name.to_owned()));
    let [shortest, longest] = ends_of_short_pulls().map(|phi| phi / natural_rate());
    let speeds = PAPER_SPEEDS.map(|speed| format!("{:.0}", 1e3 * speed)).join(", ");
    let pulls = Key::Bar(format!("pulls of {shortest:.1} to {longest:.1} s at {speeds} mm/s"));
    patterns.into_iter().chain([pulls]).collect()
}

const RULE_NAME: &str = "Phi = pi/2; rule of thumb: quasi-static is valid in the corner";

fn ratio_scale(name: &str) -> Key {
    let label = |power: f64| if power.fract() == 0.0 { format!("{}", power.exp2()) } else { String::new() };
    let colors = (0..=20).map(|i| 0.2 * f64::from(i) - 2.0).map(|power| (power * 10.0).round() / 10.0);
    Key::Scale { name: name.to_owned(), colors: colors.map(|power| (ratio_color(power.exp2()), label(power))).collect() }
}

/// From dark (the lowest decade of the path length and less) to bright (the whole path length and
/// more), in tenths of a decade.
fn share_color(share: f64, lowest: f64) -> String {
    let decade = (10.0 * share.max(1e-300).log10()).round() / 10.0;
    viridis(1.0 - decade.clamp(lowest, 0.0) / lowest)
}

/// From blue (a quarter and less) over white (one) to orange (four and more), in twentieths.
fn ratio_color(ratio: f64) -> String {
    let power = (10.0 * ratio.max(1e-300).log2()).round() / 10.0;
    let share = (0.5 * power.abs()).clamp(0.0, 1.0).powf(0.7);
    let end = if power < 0.0 { [8.0, 69.0, 148.0] } else { [191.0, 84.0, 0.0] };
    let [r, g, b] = end.map(|end: f64| (255.0 + share * (end - 255.0)).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_end_at_their_ranges_and_part_at_one() {
        assert_eq!((share_color(1e-9, -4.0), share_color(7.0, -4.0)), (share_color(1e-4, -4.0), share_color(1.0, -4.0)));
        assert_ne!(share_color(0.7, -1.0), share_color(0.9, -1.0));
        assert_eq!((ratio_color(1.0), ratio_color(9.0), ratio_color(0.0)), ("#ffffff".to_owned(), ratio_color(4.0), ratio_color(0.25)));
        assert_ne!(ratio_color(0.8), ratio_color(1.25));
    }
}
