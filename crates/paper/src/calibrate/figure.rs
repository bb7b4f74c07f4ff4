//! Figures: measured points with the fitted laws, and forces on tips over time.

use super::case::Case;
use super::fit::{Calibration, CaseFit};
use super::forces::Force;
use super::measurements::{Measurements, Trial};
use super::text::percent;
use super::trials::Estimate;
use cohaul_report::chart::MILLI;
use cohaul_report::chart::canvas::{Cell, Sheet};
use cohaul_report::chart::panel::{Entry, Panel, Scale, Shape, Style};
use cohaul_report::chart::{ROW_HEIGHT, TIME_HEIGHT, WIDTH, WORK_HEIGHT, grid};

const MODEL: Style = Style { color: "#0072B2", dash: "", width: 1.8 };
const LINEAR: Style = Style { color: "#D55E00", dash: "7 3", width: 1.8 };
/// Style in the legend; in a panel the interval has the colour of its law.
const INTERVAL: Style = Style { color: "#d8d8d8", dash: "", width: 9.0 };
/// Colours of trials; further trials repeat them.
const TRIALS: [&str; 6] = ["#000000", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#777777"];
/// Width of a panel of a case.
const CALIBRATION_WIDTH: f64 = 380.0;
/// Largest number of springs with a panel each; more springs share one panel.
const MOST_PANELS: usize = 6;
/// Colours of springs in one panel.
const SPRINGS: [&str; 6] = ["#0072B2", "#D55E00", "#000000", "#CC79A7", "#009E73", "#E69F00"];

/// Measured force over displacement with both fitted laws and their intervals, one panel for each
/// case.
pub fn calibration(found: &Calibration, measurements: &Measurements) -> String {
    let panels: Vec<Panel> = found.cases.iter().map(|case| panel(found, case, measurements)).collect();
    let shaded = Entry::line(format!("shaded: {} % intervals of both", percent(found.confidence)), INTERVAL);
    let laws = vec![Entry::line("pseudo-rigid-body model, one E", MODEL), Entry::line("linear law over its range", LINEAR), shaded];
    let most = Case::ALL.iter().map(|case| measurements.of_case(*case).count()).max().unwrap_or(0);
    let name = |index: usize| {
        let mut names: Vec<&str> = Case::ALL.iter().filter_map(|case| Some(&*measurements.of_case(*case).nth(index)?.name)).collect();
        names.dedup();
        names.join("/")
    };
    let trials = (0..most.min(TRIALS.len())).map(|index| Entry::line(format!("trial {}", name(index)), bar(index))).collect();
    grid(&panels, &[laws, trials], panels.len(), CALIBRATION_WIDTH, WORK_HEIGHT)
}

fn panel(found: &Calibration, fit: &CaseFit, measurements: &Measurements) -> Panel {
    let case = fit.case;
    let (x_label, y_label) =
        if case.is_radial() { ("stretch (mm)", "force along the spring (mN)") } else { ("swing (rad)", "force across the spring (mN)") };
    let mut panel = Panel::new(x_label, y_label, Scale::FromZero);
    panel.note = Some(case.name().to_owned());
    let unit = if case.is_radial() { MILLI } else { 1.0 };
    let trials: Vec<&Trial> = measurements.of_case(case).collect();
    let far = trials
        .iter()
        .flat_map(|trial| &trial.points)
        .map(|point| point.at)
        .fold(0.0, |far: f64, at| if at.abs() > far.abs() { at } else { far });
    let design = found.dimensions.of_material(1.0);
    let model = |at: f64| case.force(&design, at);
    // Space around the outermost points.
    panel.add(vec![[-0.02 * unit * far, 0.0], [1.04 * unit * far, 0.0]], LINEAR, Shape::Unseen);
    law(&mut panel, &model, &found.youngs_modulus_pa, [0.0, far], unit, MODEL);
    if let Some(linear) = found.linear.iter().find(|linear| linear.case == case) {
        let range = linear.range.map(|at| at.copysign(far));
        law(&mut panel, &|at| case.linear(&design, at), &linear.stiffness, range, unit, LINEAR);
    }
    for (index, trial) in trials.iter().enumerate() {
        points(&mut panel, trial, index, unit);
    }
    panel
}

/// A law over a range and, around it, its interval.
fn law(panel: &mut Panel, basis: &dyn Fn(f64) -> f64, slope: &Estimate, [from, to]: [f64; 2], unit: f64, style: Style) {
    const N: usize = 120;
    let places = || (0..=N).map(|i| from + (to - from) * i as f64 / N as f64);
    if let Some(interval) = slope.interval.or(slope.interval_within_trials) {
        let ends = |at: f64| {
            let (a, b) = (MILLI * interval.low * basis(at), MILLI * interval.high * basis(at));
            [[unit * at, a.min(b)], [unit * at, a.max(b)]]
        };
        panel.add(places().flat_map(ends).collect(), style, Shape::Area);
    }
    panel.add(places().map(|at| [unit * at, MILLI * slope.value * basis(at)]).collect(), style, Shape::Graph);
}

/// Dots, and bars of one standard deviation to either side where it is known.
fn points(panel: &mut Panel, trial: &Trial, index: usize, unit: f64) {
    let style = bar(index);
    let bars = trial.points.iter().filter_map(|point| {
        let (at, sd) = (unit * point.at, point.sd?);
        Some([[at, MILLI * (point.force - sd)], [at, MILLI * (point.force + sd)], [f64::NAN; 2]])
    });
    panel.add(bars.flatten().collect(), style, Shape::Path);
    panel.add(trial.points.iter().map(|point| [unit * point.at, MILLI * point.force]).collect(), style, Shape::Dots);
}

fn bar(index: usize) -> Style {
    Style { color: TRIALS[index % TRIALS.len()], dash: "", width: 1.0 }
}

/// Force on tips over time, with gaps where no ant is attached: one panel for each spring, or one
/// for many springs with its legend.
pub fn tip_forces(found: &[Force]) -> String {
    let mut springs: Vec<usize> = found.iter().map(|force| force.spring).collect();
    springs.sort_unstable();
    springs.dedup();
    let mut frames: Vec<f64> = found.iter().map(|force| force.time).collect();
    frames.dedup();
    let ends = frames.first().zip(frames.last()).map_or(vec![], |(first, last)| vec![[*first, 0.0], [*last, 0.0]]);
    let panel = |springs: &[usize]| {
        let mut panel = Panel::new("time (s)", "force on tip (mN)", Scale::FromZero);
        panel.add(ends.clone(), of_spring(0), Shape::Unseen);
        for (index, spring) in springs.iter().enumerate() {
            panel.add(over_time(found, *spring, &frames), of_spring(index), Shape::Graph);
        }
        panel
    };
    let (panels, legend) = if springs.len() > MOST_PANELS {
        let shown = springs.iter().enumerate().take(2 * SPRINGS.len());
        (vec![panel(&springs)], shown.map(|(index, spring)| Entry::line(format!("spring {spring}"), of_spring(index))).collect())
    } else {
        let named = |spring: &usize| Panel { note: Some(format!("spring {spring}")), ..panel(&[*spring]) };
        (springs.iter().map(named).collect(), Vec::new())
    };
    let height = if panels.len() == 1 { TIME_HEIGHT } else { ROW_HEIGHT };
    let mut sheet = Sheet::new(WIDTH, panels.len() as f64 * height);
    for (i, panel) in panels.iter().enumerate() {
        sheet.add(&Cell { panel, left: 0.0, top: i as f64 * height, width: WIDTH, height });
    }
    sheet.into_svg(&[legend])
}

/// Force on one tip over time, with a gap where a frame has none (s, mN).
fn over_time(found: &[Force], spring: usize, frames: &[f64]) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    let mut frame = 0;
    for force in found.iter().filter(|force| force.spring == spring) {
        let before = frame;
        while frames[frame] < force.time {
            frame += 1;
        }
        if frame > before + 1 {
            points.push([f64::NAN; 2]);
        }
        points.push([force.time, MILLI * force.size]);
    }
    points
}

fn of_spring(index: usize) -> Style {
    let dash = if (index / SPRINGS.len()).is_multiple_of(2) { "" } else { "5 2.5" };
    Style { color: SPRINGS[index % SPRINGS.len()], dash, width: 1.4 }
}
