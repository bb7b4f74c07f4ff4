//! The report on measured runs as text.

use super::fit::{Fit, Fitted};
use super::report::{LimitSource, Mean, Measured, OverRuns, Quartiles};
use cohaul_report::quantity::{short, short_quantity};
use cohaul_report::table::Table;
use cohaul_report::text::{Detail, Lines};

/// The answer, the differences over the runs, and what was done to the recording.
pub fn text(found: &Measured, detail: Detail) -> String {
    let mut lines = Lines::default();
    lines.answer(&found.answer);
    if let Some(over) = &found.over_runs {
        lines.text += &table(over).text();
    }
    let left_out = if found.n_left_out > 0 { format!(", {} without a result", found.n_left_out) } else { String::new() };
    let doubtful = if found.n_doubtful > 0 { format!(", {} doubtful", found.n_doubtful) } else { String::new() };
    lines.row("runs", &format!("{}{left_out}{doubtful}", found.n_runs));
    for (label, value) in rows(found) {
        lines.row(&label, &value);
    }
    if detail == Detail::Full {
        lines.section("\nruns");
        lines.text += &runs(found).text();
    }
    lines.text
}

/// Differences over the runs.
pub fn table(over: &OverRuns) -> Table {
    let row = |name: &str, of: &Quartiles, unit: &str| {
        let cell = |value: f64| short_quantity(value, unit);
        [name.to_owned(), cell(of.median), format!("{} to {}", cell(of.lower_quartile), cell(of.upper_quartile)), cell(of.max)]
    };
    let mut rows = vec![
        row("measured displacement", &over.displacement_m, "m"),
        row("model error", &over.model_error_m, "m"),
        row("… of the position", &over.model_error_position_m, "m"),
        row("… of the heading", &over.model_error_heading_rad, "rad"),
    ];
    rows.extend(over.model_error_force_n.map(|of| row("… of the mean force", &of, "N")));
    rows.push(row("inertia effect", &over.inertia_effect_m, "m"));
    rows.extend(over.engine_error_m.map(|of| row("engine error", &of, "m")));
    rows.push(row("reference error", &over.reference_error_m, "m"));
    rows.push(row("… of smoothing", &over.smoothing_m, "m"));
    Table::new("Differences over all runs", ["difference", "median", "quartiles", "largest"]).with_rows(rows)
}

/// Labels and values beside the table.
pub fn rows(found: &Measured) -> Vec<(String, String)> {
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut row = |label: &str, value: String| rows.push((label.to_owned(), value));
    if let Some(bias) = &found.bias {
        let of = |mean: &Mean, unit: &str| format!("{} ± {}", short_quantity(mean.mean, unit), short_quantity(mean.standard_error, unit));
        let [along, across, heading] = [of(&bias.along_m, "m"), of(&bias.across_m, "m"), of(&bias.heading_rad, "rad")];
        row("bias", format!("{along} along the measured displacement, {across} to its left, {heading} of the heading"));
        let deviation = |mean: &Mean, unit: &str| short_quantity(mean.standard_deviation, unit);
        let spread = [deviation(&bias.along_m, "m"), deviation(&bias.across_m, "m"), deviation(&bias.heading_rad, "rad")].join(", ");
        row("spread", format!("{spread}: standard deviations over the runs"));
    }
    row(
        "own limit",
        match found.own_limit {
            None => "not known: give --uncertainty-m and --uncertainty-rad".to_owned(),
            Some(limit) => {
                let source = match limit.source {
                    LimitSource::Uncertainty => "two poses of the stated uncertainty",
                    LimitSource::Registration => "median gap or overlap where load and obstacle touch",
                };
                format!("{}, {source}", short_quantity(limit.edge_displacement_m, "m"))
            }
        },
    );
    if let Some(over) = &found.over_runs {
        let (n, of) = (over.n_shifted, &over.shift_m);
        let shift = |value: f64| short_quantity(value, "m");
        let shifted = if n == 0 { String::new() } else { format!(", by {} at most", shift(of.max)) };
        row("start", format!("{n} runs with an obstacle moved out until it touches the load{shifted}"));
        let bounds = || found.found().map(|(_, of)| of);
        let [bound, deviation] = [bounds().map(|of| of.bound_m).fold(0.0, f64::max), bounds().map(|of| of.deviation_m).fold(0.0, f64::max)];
        let n_waypoints: usize = bounds().map(|of| of.n_waypoints).sum();
        let mean = n_waypoints as f64 / bounds().count() as f64;
        let gap = bounds().map(|of| of.longest_gap_s).fold(0.0, f64::max);
        let [bound, deviation] = [bound, deviation].map(|value| short_quantity(value, "m"));
        row("smoothing", format!("at most {deviation} from a recorded place (bound {bound}), {} waypoints a run", short(mean)));
        row("gaps", format!("bridged, at most {}", short_quantity(gap, "s")));
    }
    row("worst runs", found.worst.join(", "));
    for (label, value) in found.fit.iter().flat_map(fit_rows) {
        row(&label, value);
    }
    for record in found.runs.iter().filter(|record| record.left_out.is_some()).take(5) {
        row(&format!("left out: {}", record.run), record.left_out.clone().unwrap_or_default());
    }
    found.notes.iter().for_each(|note| row("note", note.clone()));
    rows
}

fn fit_rows(fit: &Fit) -> Vec<(String, String)> {
    let number = |of: &Fitted| {
        let interval = match of.interval_95 {
            Some([low, high]) => format!("{} to {} with 95 % confidence", short(low), short(high)),
            None => "not determined: the motion does not depend on it".to_owned(),
        };
        (of.name.clone(), format!("{}, {interval} (before {})", short(of.value), short(of.before)))
    };
    let change = |[before, after]: [f64; 2]| format!("{} before, {} after", short_quantity(before, "m"), short_quantity(after, "m"));
    let mut rows: Vec<(String, String)> = fit.numbers.iter().map(number).collect();
    rows.push(("fit".to_owned(), format!("{} runs: median model error {}", fit.n_fit, change(fit.on_fit_m))));
    if let Some(check) = fit.on_check_m {
        rows.push(("check".to_owned(), format!("{} other runs: {}", fit.n_check, change(check))));
    }
    rows
}

/// A row for each run with a result.
pub fn runs(found: &Measured) -> Table {
    let rows: Vec<_> = found.found().collect();
    Table::of(
        &rows,
        &[
            ("run", "", &|(run, _)| (*run).into()),
            ("displacement", "m", &|(_, of)| of.displacement_m.into()),
            ("model error", "m", &|(_, of)| of.model_error.edge_displacement_m.into()),
            ("along", "m", &|(_, of)| of.model_error.along_m.into()),
            ("across", "m", &|(_, of)| of.model_error.across_m.into()),
            ("heading", "rad", &|(_, of)| of.model_error.heading_rad.into()),
            ("inertia effect", "m", &|(_, of)| of.inertia_effect_m.into()),
            ("engine error", "m", &|(_, of)| of.engine_error_m.into()),
            ("reference error", "m", &|(_, of)| of.reference_error_m.into()),
            ("shift", "m", &|(_, of)| of.shift_m.into()),
        ],
    )
    .titled("Runs")
}
