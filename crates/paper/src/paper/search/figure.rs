//! Figures of a search: where the accepted sets lie, and what inertia does to one ant.

use super::ACCEPTED;
use super::accepted::number;
use super::report::{Search, SetRow};
use super::space::Searched;
use crate::paper::figure::Figures;
use crate::paper::style::{OTHER, OURS, PRINTED};
use cohaul::model::open_choices::Range;
use cohaul_report::chart::panel::{Across, Curve, Entry, Mark, Panel, Scale, Shape, Style};
use cohaul_report::chart::print::Width;
use cohaul_report::chart::{MILLI, PANEL_HEIGHT, grid};

const FAINT: Style = Style { color: "#bbbbbb", dash: "", width: 1.0 };
/// Sets farther from the targets are not drawn (1).
const MOST_SHOWN: f64 = 3.0;

/// All figures: name of the file, caption and SVG.
pub(super) fn figures(found: &Search) -> Figures {
    let mut figures = vec![("region", "Where the accepted sets lie", region(found))];
    if !found.one_ant.is_empty() {
        figures.push(("one-ant", "Effect of inertia on the time of one ant", one_ant(found)));
    }
    figures
}

fn is_shown(distance: &f64) -> bool {
    *distance <= MOST_SHOWN
}

/// Place, label, and factor to the unit of the label of each searched choice that is a number.
fn axes(found: &Search) -> Vec<(usize, String, f64)> {
    let of_number = |(at, choice): (usize, Searched)| {
        let Range::Between { high, .. } = choice.range else { return None };
        let (prefix, factor) = if choice.unit == "m" || high < 0.2 { ("m", MILLI) } else { ("", 1.0) };
        Some((at, format!("{} ({prefix}{})", choice.name, choice.unit), factor))
    };
    found.plan.design().searched.into_iter().enumerate().filter_map(of_number).collect()
}

/// Distance of every set against each choice, with the accepted ones, and pairs of the choices that
/// matter most.
fn region(found: &Search) -> String {
    let axes = axes(found);
    let mut panels = Vec::new();
    for (at, label, unit) in &axes {
        let mut panel = Panel::new(label, "distance to the targets (1)", Scale::FromZero);
        panel.marks.push(Mark { at: Across::Horizontal(ACCEPTED), style: PRINTED });
        let screened = |row: &SetRow| Some([unit * number(&row.values[*at]), row.screened.distance.filter(is_shown)?]);
        let judged = |row: &SetRow| Some([unit * number(&row.values[*at]), row.judged.as_ref()?.distance?]);
        panel.curves.extend(dots(found, |row| !row.is_accepted, screened, FAINT));
        panel.curves.extend(dots(found, |row| row.is_accepted, judged, OURS));
        panels.push(panel);
    }
    for (one, other) in [(0, 1), (1, 3), (0, 3)] {
        let ([x, y], [of_x, of_y]) = ([&axes[one], &axes[other]], [axes[one].2, axes[other].2]);
        let mut panel = Panel::new(&x.1, &y.1, Scale::Linear);
        let place = |row: &SetRow| {
            row.screened.distance.filter(is_shown)?;
            Some([of_x * number(&row.values[x.0]), of_y * number(&row.values[y.0])])
        };
        panel.curves.extend(dots(found, |row| !row.is_accepted, place, FAINT));
        panel.curves.extend(dots(found, |row| row.is_accepted, place, OURS));
        panels.push(panel);
    }
    let legend = vec![
        Entry::dot("accepted, on seeds of their own", OURS),
        Entry::dot("other sets of the first look, up to a distance of 3", FAINT),
        Entry::line("accepted below", PRINTED),
    ];
    grid(&panels, &[legend], 2, 0.5 * Width::TwoColumns.px(), PANEL_HEIGHT)
}

fn dots(found: &Search, is_shown: impl Fn(&SetRow) -> bool, of: impl Fn(&SetRow) -> Option<[f64; 2]>, style: Style) -> Option<Curve> {
    let points: Vec<[f64; 2]> = found.sets.iter().filter(|row| is_shown(row)).filter_map(of).collect();
    (!points.is_empty()).then(|| Curve::new(points, style, Shape::Dots))
}

/// Effect of inertia on one ant's time with its interval, set by set.
fn one_ant(found: &Search) -> String {
    let mut panels = Vec::new();
    for (at, label, unit) in axes(found) {
        let mut panel = Panel::new(&label, "inertial minus quasi-static (s)", Scale::Linear);
        panel.marks.push(Mark { at: Across::Horizontal(0.0), style: FAINT });
        for row in &found.one_ant {
            let x = unit * number(&found.sets[row.set].values[at]);
            if let Some(interval) = row.inertia_effect.interval_95 {
                panel.curves.push(Curve::new(vec![[x, interval.low], [x, interval.high]], FAINT, Shape::Path));
            }
        }
        for (certain, style) in [(false, OURS), (true, OTHER)] {
            let rows = found.one_ant.iter().filter(|row| row.inertia_effect.is_not_zero() == certain);
            let points: Vec<[f64; 2]> =
                rows.map(|row| [unit * number(&found.sets[row.set].values[at]), row.inertia_effect.value]).collect();
            if !points.is_empty() {
                panel.curves.push(Curve::new(points, style, Shape::Dots));
            }
        }
        panels.push(panel);
    }
    let legend = vec![Entry::dot("not certainly other than zero", OURS), Entry::dot("certainly", OTHER), Entry::line("95 %", FAINT)];
    grid(&panels, &[legend], 2, 0.5 * Width::TwoColumns.px(), PANEL_HEIGHT)
}
