//! The figures of the regime map: a page a scene, with the largest distance above and the displacement below, a panel a damping; and a page of measurement over theory.

use std::f64::consts::FRAC_PI_2;

use crate::studies::regime::plane::{
    BOTTOM, Fill, GAP, HEAD, HEIGHT, LEFT, MEASURED, MEASURED_ABOVE, PREDICTED, PREDICTED_ABOVE, Pen, Plane, RULE, SHARES, TOP, WIDTH,
    head, paint, ratio_color, share_color, stroke,
};
use crate::studies::regime::report::SOUND;
use crate::studies::regime::{AGREEMENT, Cell, Grid, Law, PAPER_PHIS, PAPER_SPEEDS, Scene, contour, epsilon_of, lines, theory};
use crate::studies::stress::heat_map::{Anchor, text};

/// Displacements off by a tenth, and laws that are off by a quarter (1).
const OFF: [f64; 2] = [0.9, 1.1];
const LAW_OFF: [f64; 2] = [0.8, 1.25];
/// Points of a formula's grid an axis.
const FINE: usize = 121;
/// For legends below the panels (px).
const LEGEND: f64 = 92.0;

/// The largest distance over the way, and the displacement over that without inertia.
pub fn scene_map(grid: &Grid, cells: &[Cell]) -> String {
    let (width, height) = page_size(grid.zetas.len(), 2);
    let mut svg = head(width, height, &format!("{}: {}", grid.scene.name(), grid.scene.what()));
    // Of theory, at 1 % and 0.9 and at 1.1: lines outside the plane need no legend.
    let mut is_expected = [false; 2];
    for (column, zeta) in grid.zetas.iter().enumerate() {
        let cells = of_panel(grid, *zeta, cells);
        let mut distance = Plane::at(grid, column, 0);
        distance.cells(&mut svg, &cells.iter().map(|cell| share_fill(cell)).collect::<Vec<Fill>>());
        rules(&mut svg, &distance, *zeta);
        let above: Vec<f64> = cells.iter().map(|cell| cell.share().map_or(f64::NAN, |share| (share / AGREEMENT).log10())).collect();
        let expected = predicted_share(grid, *zeta, &cells);
        level(&mut svg, &mut distance, &Field::of_grid(grid, above), 0.0, &MEASURED, Some("1 %"));
        is_expected[0] |= level(&mut svg, &mut distance, &expected, 0.0, &PREDICTED, None);
        paper_points(&mut svg, &distance);
        distance.frame(&mut svg, &format!("zeta = {zeta}: largest distance"), (column == 0).then_some("epsilon = v √(k m) / f"));

        let mut displacement = Plane::at(grid, column, 1);
        displacement.cells(&mut svg, &cells.iter().map(|cell| displacement_fill(cell)).collect::<Vec<Fill>>());
        rules(&mut svg, &displacement, *zeta);
        let ratios: Vec<f64> = cells.iter().map(|cell| cell.displacement_ratio().unwrap_or(f64::NAN)).collect();
        let measured = Field::of_grid(grid, ratios);
        level(&mut svg, &mut displacement, &measured, OFF[0], &MEASURED, Some("0.9"));
        level(&mut svg, &mut displacement, &measured, OFF[1], &MEASURED_ABOVE, Some("1.1"));
        if let Some(expected) = predicted_ratio(grid, *zeta) {
            is_expected[0] |= level(&mut svg, &mut displacement, &expected, OFF[0], &PREDICTED, None);
            is_expected[1] |= level(&mut svg, &mut displacement, &expected, OFF[1], &PREDICTED_ABOVE, None);
        }
        paper_points(&mut svg, &displacement);
        // A haul has no such halves.
        if *zeta < SOUND.2 && grid.scene != Scene::Haul {
            regions(&mut svg, &mut displacement);
        }
        displacement.frame(&mut svg, &format!("zeta = {zeta}: displacement"), (column == 0).then_some("epsilon = v √(k m) / f"));
    }
    legend(&mut svg, height - LEGEND, grid.scene, is_expected);
    svg.push_str("</svg>\n");
    svg
}

/// Measured over theory, a row a law.
pub fn disagreement(grids: &[Grid], cells: &[Cell]) -> String {
    const LAWS: [Law; 4] = [Law::Ramp, Law::UndampedExcursion, Law::Release, Law::Hold];
    let rows: Vec<(Law, &Grid)> =
        LAWS.iter().filter_map(|law| Some((*law, grids.iter().find(|grid| grid.scene == law.scene())?))).collect();
    let n_columns = rows.iter().map(|(_, grid)| grid.zetas.len()).max().unwrap_or(1);
    let (width, height) = page_size(n_columns, rows.len());
    let mut svg = head(width, height, "Where theory and measurement disagree: measured over theory");
    for (row, (law, grid)) in rows.iter().enumerate() {
        for (column, zeta) in grid.zetas.iter().enumerate() {
            let mut plane = Plane::at(grid, column, row);
            let cells = of_panel(grid, *zeta, cells);
            let fill = |cell: &Cell| law.ratio(cell).map_or_else(|| blank(cell), |ratio| Fill::Color(ratio_color(ratio)));
            plane.cells(&mut svg, &cells.iter().map(|cell| fill(cell)).collect::<Vec<Fill>>());
            rules(&mut svg, &plane, *zeta);
            let ratios = Field::of_grid(grid, cells.iter().map(|cell| law.ratio(cell).unwrap_or(f64::NAN)).collect());
            level(&mut svg, &mut plane, &ratios, LAW_OFF[0], &MEASURED, Some("0.8"));
            level(&mut svg, &mut plane, &ratios, LAW_OFF[1], &MEASURED_ABOVE, Some("1.25"));
            paper_points(&mut svg, &plane);
            let title =
                if column == 0 { format!("{}, {}, zeta = {zeta}", grid.scene.name(), law.short_name()) } else { format!("zeta = {zeta}") };
            plane.frame(&mut svg, &title, (column == 0).then_some("epsilon = v √(k m) / f"));
        }
    }
    let y = height - LEGEND + 22.0;
    ratio_legend(&mut svg, [LEFT, y], "measured over theory");
    let at = [sample(&mut svg, [LEFT + 420.0, y], &MEASURED, "measured 0.8 of theory"), y];
    sample(&mut svg, at, &MEASURED_ABOVE, "1.25 of theory");
    sample(&mut svg, [LEFT + 420.0, y + 22.0], &RULE, RULE_NAME);
    let x = patterns(&mut svg, [LEFT, y + 44.0]);
    paper_legend(&mut svg, [x, y + 44.0]);
    svg.push_str("</svg>\n");
    svg
}

fn page_size(n_columns: usize, n_rows: usize) -> (f64, f64) {
    // Legends need the width of four panels.
    (LEFT + n_columns.max(4) as f64 * (WIDTH + GAP) + 4.0, HEAD + n_rows as f64 * (TOP + HEIGHT + BOTTOM) + LEGEND)
}

/// Cells of one panel in the order of its grid.
fn of_panel<'a>(grid: &Grid, zeta: f64, cells: &'a [Cell]) -> Vec<&'a Cell> {
    cells.iter().filter(|cell| cell.scene == grid.scene && cell.zeta == zeta).collect()
}

/// Values at points of the plane, in rows of equal epsilon.
struct Field {
    phis: Vec<f64>,
    epsilons: Vec<f64>,
    values: Vec<f64>,
}

impl Field {
    fn of_grid(grid: &Grid, values: Vec<f64>) -> Self {
        Self { phis: grid.phis.clone(), epsilons: grid.epsilons.clone(), values }
    }

    /// Of a formula, finer than the cells.
    fn of_formula(grid: &Grid, formula: impl Fn(f64, f64) -> f64) -> Self {
        let fine = |values: &[f64]| {
            let (low, high) = (values[0], values[values.len() - 1]);
            (0..FINE).map(|i| low * (high / low).powf(i as f64 / (FINE - 1) as f64)).collect::<Vec<f64>>()
        };
        let (phis, epsilons) = (fine(&grid.phis), fine(&grid.epsilons));
        let values = epsilons.iter().flat_map(|epsilon| phis.iter().map(|phi| formula(*phi, *epsilon))).collect();
        Self { phis, epsilons, values }
    }
}

/// The lines of a field at this level, straight in logarithms, with a word on the longest; whether there are any.
fn level(svg: &mut String, plane: &mut Plane, field: &Field, level: f64, pen: &Pen, word: Option<&str>) -> bool {
    let logarithms = |values: &[f64]| values.iter().map(|value| value.ln()).collect::<Vec<f64>>();
    let found = lines(contour(&logarithms(&field.phis), &logarithms(&field.epsilons), &field.values, level));
    let back = |line: &[[f64; 2]]| line.iter().map(|[x, y]| [x.exp(), y.exp()]).collect::<Vec<[f64; 2]>>();
    found.iter().for_each(|line| plane.line(svg, &back(line), pen));
    if let Some((word, longest)) = word.zip(found.iter().max_by_key(|line| line.len())) {
        let longest = back(longest);
        let (before, after) = longest.split_at(longest.len() / 5);
        plane.label(svg, after.iter().chain(before).copied(), 10.0, word);
    }
    !found.is_empty()
}

fn predicted_share(grid: &Grid, zeta: f64, cells: &[&Cell]) -> Field {
    let over = |share: f64| (share / AGREEMENT).log10();
    match grid.scene {
        Scene::Excursion => Field::of_formula(grid, |phi, epsilon| over(theory::excursion_share(phi, epsilon, zeta))),
        _ => Field::of_grid(grid, cells.iter().map(|cell| cell.predicted_share().map_or(f64::NAN, over)).collect()),
    }
}

fn predicted_ratio(grid: &Grid, zeta: f64) -> Option<Field> {
    match grid.scene {
        Scene::Excursion => Some(Field::of_formula(grid, |phi, epsilon| theory::excursion(phi, epsilon, zeta))),
        Scene::TugOfWar => Some(Field::of_formula(grid, |phi, epsilon| theory::release(phi, epsilon, zeta))),
        Scene::Haul => None,
    }
}

fn share_fill(cell: &Cell) -> Fill {
    match cell.share() {
        Some(_) if !cell.is_resolved() => Fill::Unresolved,
        Some(share) => Fill::Color(share_color(share)),
        None => blank(cell),
    }
}

fn displacement_fill(cell: &Cell) -> Fill {
    cell.displacement_ratio().map_or_else(|| blank(cell), |ratio| Fill::Color(ratio_color(ratio)))
}

/// Of a cell without the number asked for.
fn blank(cell: &Cell) -> Fill {
    match () {
        _ if !cell.is_converged => Fill::NotFound,
        _ if !cell.moves() => Fill::Rests,
        _ => Fill::Nothing,
    }
}

/// A quarter of a period, and the corner in which the rule of thumb takes a load without inertia for sound.
fn rules(svg: &mut String, plane: &Plane, zeta: f64) {
    let (epsilons, phis) = (&plane.grid.epsilons, &plane.grid.phis);
    let (lowest, highest, last) = (epsilons[0], epsilons[epsilons.len() - 1], phis[phis.len() - 1]);
    plane.inside(svg, |svg| {
        plane.line(svg, &[[FRAC_PI_2, lowest], [FRAC_PI_2, highest]], &RULE);
        if zeta >= SOUND.2 {
            plane.line(svg, &[[SOUND.1, lowest], [SOUND.1, SOUND.0], [last, SOUND.0]], &RULE);
        }
    });
}

fn regions(svg: &mut String, plane: &mut Plane) {
    let lowest = 1.35 * plane.grid.epsilons[0];
    plane.label(svg, [[0.72, 2.0 * lowest]], 9.0, "inertia");
    plane.label(svg, [[0.72, 1.25 * lowest]], 9.0, "suppresses");
    plane.label(svg, [1.25, 2.0, 3.2].map(|above| [5.2, above * lowest]), 9.0, "overshoot");
}

/// Bars from the shortest to the longest hold of the paper's ants, one a speed.
fn paper_points(svg: &mut String, plane: &Plane) {
    plane.inside(svg, |svg| {
        for speed in PAPER_SPEEDS {
            let epsilon = epsilon_of(speed);
            let [from, to] = [PAPER_PHIS[0], PAPER_PHIS[PAPER_PHIS.len() - 1]].map(|phi| plane.place(phi, epsilon));
            paper_bar(svg, from, to);
        }
    });
}

fn paper_bar(svg: &mut String, from: [f64; 2], to: [f64; 2]) {
    let pen = Pen { color: "#000000", dash: "", width: 1.2 };
    stroke(svg, &format!("{:.1},{:.1} {:.1},{:.1}", from[0], from[1], to[0], to[1]), &pen);
    for [x, y] in [from, to] {
        svg.push_str(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\" fill=\"white\" stroke=\"black\" stroke-width=\"1.2\"/>\n"));
    }
}

/// Three lines below the panels: colours, lines, patterns.
fn legend(svg: &mut String, top: f64, scene: Scene, is_expected: [bool; 2]) {
    let y = top + 22.0;
    bar(svg, [LEFT, y], "largest distance over the way", SHARES, 40, share_color_of_decade, |decade| format!("{:.0e}", 10f64.powf(decade)));
    ratio_legend(svg, [LEFT + 490.0, y], "displacement over that without inertia");
    let y = y + 34.0;
    let mut x = sample(svg, [LEFT, y], &MEASURED, "measured: 1 % above, 0.9 below");
    x = sample(svg, [x, y], &MEASURED_ABOVE, "measured: 1.1");
    let expected = if scene == Scene::Haul { "theory: 2 epsilon f / k is 1 %" } else { "theory: 1 %, 0.9" };
    for (pen, name, _) in
        [(PREDICTED, expected, is_expected[0]), (PREDICTED_ABOVE, "theory: 1.1", is_expected[1])].iter().filter(|(.., is_there)| *is_there)
    {
        x = sample(svg, [x, y], pen, name);
    }
    sample(svg, [x, y], &RULE, RULE_NAME);
    let x = patterns(svg, [LEFT, y + 24.0]);
    paper_legend(svg, [x, y + 24.0]);
}

const RULE_NAME: &str = "Phi = pi/2; rule of thumb: sound in the corner";

/// The sign of the paper's ants with its name.
fn paper_legend(svg: &mut String, [x, y]: [f64; 2]) {
    paper_bar(svg, [x, y - 4.0], [x + 30.0, y - 4.0]);
    text(svg, [x + 38.0, y], Anchor::Start, 11.0, "the paper's ants: 30, 40, 80 mm/s");
}

fn share_color_of_decade(decade: f64) -> String {
    share_color(10f64.powf(decade))
}

fn ratio_legend(svg: &mut String, at: [f64; 2], name: &str) {
    bar(svg, at, name, [-2.0, 2.0], 40, |power| ratio_color(power.exp2()), |power| format!("{}", power.exp2()));
}

/// A row of `n` colours from the lowest to the highest value, with whole ones named below.
fn bar(
    svg: &mut String,
    [x, y]: [f64; 2],
    name: &str,
    [low, high]: [f64; 2],
    n: usize,
    color: impl Fn(f64) -> String,
    label: impl Fn(f64) -> String,
) {
    let (start, width) = (x + 7.0 * name.len() as f64, 5.0);
    text(svg, [x, y], Anchor::Start, 11.0, name);
    for i in 0..n {
        let value = low + (high - low) * (i as f64 + 0.5) / n as f64;
        let (x, y, wide) = (start + i as f64 * width, y - 10.0, width + 0.3);
        svg.push_str(&format!("<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{wide}\" height=\"12\" fill=\"{}\"/>\n", color(value)));
    }
    let mut value = low;
    while value <= high + 1e-9 {
        let at = start + (value - low) / (high - low) * n as f64 * width;
        text(svg, [at, y + 14.0], Anchor::Middle, 9.0, &label(value));
        value += 1.0;
    }
}

/// A line with its name; gives where the next one may stand (px).
fn sample(svg: &mut String, [x, y]: [f64; 2], pen: &Pen, name: &str) -> f64 {
    let line = y - 4.0;
    stroke(svg, &format!("{x:.1},{line:.1} {:.1},{line:.1}", x + 30.0), pen);
    text(svg, [x + 36.0, y], Anchor::Start, 11.0, name);
    x + 54.0 + 6.6 * name.chars().count() as f64
}

fn patterns(svg: &mut String, [x, y]: [f64; 2]) -> f64 {
    let mut x = x;
    for (fill, name) in [(Fill::Unresolved, "below own error"), (Fill::Rests, "nothing moves"), (Fill::NotFound, "no path found")] {
        let (top, paint) = (y - 11.0, paint(&fill));
        svg.push_str(&format!("<rect x=\"{x:.1}\" y=\"{top:.1}\" width=\"22\" height=\"14\" fill=\"{paint}\" stroke=\"#444444\"/>\n"));
        text(svg, [x + 28.0, y], Anchor::Start, 11.0, name);
        x += 52.0 + 6.6 * name.len() as f64;
    }
    x
}
