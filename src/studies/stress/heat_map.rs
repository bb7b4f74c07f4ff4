//! A stress map as a figure: a panel a backend with the outcome of every cell, and one below with
//! the error where an answer is known.

use crate::output::chart::axis::power_label;
use crate::output::chart::cells::{CellAxis, CellMap, Key, Size, cell_maps, viridis};
use crate::studies::methods::Method;
use crate::studies::stress::{Axis, Map, Outcome, Row};

/// Panels side by side.
const COLUMNS: usize = 3;
/// Decades of the error's colours: from rounding to a hundred path lengths.
const LOWEST: i32 = -16;
const HIGHEST: i32 = 2;
const NO_ANSWER: &str = "#eeeeee";

/// The map as SVG.
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
        all = panels(&|row| error_color(row.numbers.error_share), ", error");
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
    let mut legend = vec![Outcome::ALL.into_iter().filter_map(outcome).collect()];
    if has_errors {
        let shade = |decade: i32| {
            let label = if decade % 3 == 0 { power_label(f64::from(decade)) } else { String::new() };
            (error_color(Some(10f64.powi(decade))), label)
        };
        let colors = (LOWEST..=HIGHEST).map(shade).collect();
        let no_answer = Key::Swatch(NO_ANSWER.to_owned(), "no known answer".to_owned());
        legend.push(vec![Key::Scale { name: "error / path length".to_owned(), colors }, no_answer]);
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

/// From dark blue (rounding) to yellow (a hundred path lengths), in whole decades, so that
/// neighbours of one colour are one rectangle.
fn error_color(error: Option<f64>) -> String {
    let Some(error) = error else { return NO_ANSWER.to_owned() };
    let (low, high) = (f64::from(LOWEST), f64::from(HIGHEST));
    viridis((error.max(1e-300).log10().clamp(low, high).round() - low) / (high - low))
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
        assert_eq!(error_color(Some(0.0)), error_color(Some(1e-16)));
        assert_eq!(error_color(Some(1e9)), error_color(Some(1e2)));
        assert_eq!(error_color(None), NO_ANSWER);
    }
}
