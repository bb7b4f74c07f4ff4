//! A stress map as a figure: a panel a backend with the outcome of every cell, and one below with
//! the error where an answer is known.

use crate::methods::Method;
use crate::stress::{Axis, Map, Outcome, Row};
use crate::variants;
use cohaul_report::chart::axis::power_label;
use cohaul_report::chart::cells::{CellAxis, CellMap, Key, Size, cell_maps, viridis};

/// Panels side by side.
const COLUMNS: usize = 3;
/// Decades that the colours of errors may span: from rounding to a hundred path lengths.
const LOWEST: i32 = -16;
const HIGHEST: i32 = 2;
/// Decades that they span at least, so that errors that hardly differ look alike.
const LEAST_SPAN: i32 = 3;
const NO_ANSWER: &str = "#eeeeee";

pub fn heat_map(map: &Map, rows: &[&Row]) -> String {
    let methods: Vec<Method> = Method::all_stressed().filter(|method| rows.iter().any(|row| row.method == *method)).collect();
    let has_errors = rows.iter().any(|row| row.numbers.error_share.is_some());
    let panels = |fill: &dyn Fn(&Row) -> String, suffix: &str| -> Vec<CellMap> {
        let panel = |method: &Method| {
            let fills = rows.iter().filter(|row| row.method == *method).map(|row| fill(row)).collect();
            CellMap { title: format!("{}{suffix}", method.key), x: axis(&map.x), y: axis(&map.y), fills, ..CellMap::default() }
        };
        methods.iter().map(panel).collect()
    };
    let mut all = panels(&|row| outcome_color(row.outcome).to_owned(), "");
    let mut rows_of_panels: Vec<Vec<CellMap>> = all.chunks(COLUMNS).map(<[CellMap]>::to_vec).collect();
    if has_errors {
        let decades = decades(rows);
        all = panels(&|row| error_color(row.numbers.error_share, decades), ", error");
        rows_of_panels.extend(all.chunks(COLUMNS).map(<[CellMap]>::to_vec));
    }
    let is_named = !map.y.names.is_empty();
    let (height, left) = if is_named { (330.0, 210.0) } else { (210.0, 62.0) };
    let size = Size { width: 260.0, height, left, least_columns: if has_errors { 2 } else { 1 } };
    cell_maps(&format!("{}: {}", map.name, map.what), &rows_of_panels, &legend(rows, has_errors), size)
}

fn axis(axis: &Axis) -> CellAxis {
    if axis.names.is_empty() { CellAxis::of(title(axis.name), &axis.values, 7) } else { CellAxis::of_names(&axis.names) }
}

/// Outcomes that occur with their numbers, and the colours of errors.
fn legend(rows: &[&Row], has_errors: bool) -> Vec<Vec<Key>> {
    let outcome = |outcome: Outcome| {
        let n = rows.iter().filter(|row| row.outcome == outcome).count();
        (n > 0).then(|| Key::Swatch(outcome_color(outcome).to_owned(), format!("{} ({n})", outcome.name())))
    };
    let mut legend = vec![variants::all().filter_map(outcome).collect()];
    if has_errors {
        let [low, high] = decades(rows);
        // Labels have room for about seven.
        let every = (high - low) / 7 + 1;
        let shade = |decade: i32| {
            let label = if decade % every == 0 { power_label(f64::from(decade)) } else { String::new() };
            (error_color(Some(10f64.powi(decade)), [low, high]), label)
        };
        let colors = (low..=high).map(shade).collect();
        let no_answer = Key::Swatch(NO_ANSWER.to_owned(), "no known answer".to_owned());
        legend.push(vec![Key::Scale { name: "final error / path length".to_owned(), colors }, no_answer]);
    }
    legend
}

/// Okabe and Ito's colours for a finding, black and red for a defect.
fn outcome_color(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Finished => "#dcebf5",
        Outcome::Refused => "#c8c8c8",
        Outcome::Error => "#f0e442",
        Outcome::Drift => "#cc79a7",
        Outcome::Creep => "#009e73",
        Outcome::NotConverged => "#e69f00",
        Outcome::EnergyFromNowhere => "#d55e00",
        Outcome::TooLong => "#8c8c8c",
        Outcome::Failed => "#0072b2",
        Outcome::Unexplained => "#ff00ff",
        Outcome::NotFinite => "#000000",
        Outcome::Panicked => "#b00000",
    }
}

fn decade(error: f64) -> i32 {
    error.max(1e-300).log10().round().clamp(f64::from(LOWEST), f64::from(HIGHEST)) as i32
}

/// The lowest and the highest decade of the errors of a map, which its colours span.
fn decades(rows: &[&Row]) -> [i32; 2] {
    let found = rows.iter().filter_map(|row| row.numbers.error_share).map(decade);
    span(found.fold([HIGHEST, LOWEST], |[low, high], decade| [low.min(decade), high.max(decade)]))
}

/// Wide enough, within the limits.
fn span([low, high]: [i32; 2]) -> [i32; 2] {
    let low = low.min(high - LEAST_SPAN).max(LOWEST);
    [low, high.max(low + LEAST_SPAN)]
}

/// From dark blue to yellow over a range of decades, in whole ones, so that neighbours of one
/// colour are one rectangle.
fn error_color(error: Option<f64>, [low, high]: [i32; 2]) -> String {
    let Some(error) = error else { return NO_ANSWER.to_owned() };
    viridis(f64::from(decade(error).clamp(low, high) - low) / f64::from(high - low))
}

/// `step_s` as `step (s)`.
fn title(name: &str) -> String {
    const UNITS: [(&str, &str); 8] = [
        ("_n_per_m", "N/m"),
        ("_m_per_s", "m/s"),
        ("_kg", "kg"),
        ("_rad", "rad"),
        ("_s", "s"),
        ("_h", "h"),
        ("_m", "m"),
        ("_rest_lengths", "rest lengths"),
    ];
    let plain = |name: &str| name.replace('_', " ");
    let unit = UNITS.iter().find(|(ending, _)| name.ends_with(ending));
    unit.map_or_else(|| plain(name), |(ending, unit)| format!("{} ({unit})", plain(name.strip_suffix(ending).unwrap_or(name))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_titles_with_units() {
        for (name, expected) in [("step_s", "step (s)"), ("stiffness_n_per_m", "stiffness (N/m)"), ("margin_share", "margin share")] {
            assert_eq!(title(name), expected);
        }
    }

    #[test]
    fn colours_of_errors_end_at_their_range() {
        let all = [LOWEST, HIGHEST];
        assert_eq!(error_color(Some(0.0), all), error_color(Some(1e-16), all));
        assert_eq!(error_color(Some(1e9), all), error_color(Some(1e2), all));
        assert_eq!(error_color(None, all), NO_ANSWER);
    }

    /// Errors that lie within a few decades use all colours, and equal ones are no range.
    #[test]
    fn colours_span_the_errors_of_the_map() {
        let few = span([-7, -4]);
        assert_eq!((few, span([-5, -5]), span([-16, -16])), ([-7, -4], [-8, -5], [-16, -13]));
        assert_eq!(error_color(Some(1e-7), few), viridis(0.0));
        assert_eq!(error_color(Some(1e-4), few), viridis(1.0));
    }
}
