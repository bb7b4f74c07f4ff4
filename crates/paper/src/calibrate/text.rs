//! A calibration, a design and forces on tips as text tables.

use std::fmt::Write;

use super::design::{DesignReport, Made};
use super::fit::{Calibration, LinearFit};
use super::forces::{ForceSummary, ForcesReport};
use super::load_cell::GridReport;
use super::pulls::PullComparison;
use super::quality::Goodness;
use super::trials::Estimate;
use cohaul::math::Interval;
use cohaul::model::paper::CASE_3_FACTOR;
use cohaul_report::quantity::{number, quantity};
use cohaul_report::table::{Field, Table, folded};
use cohaul_report::text::WIDTH;

/// A share in percent, without the digits that a binary share adds.
pub fn percent(share: f64) -> f64 {
    (1e6 * share).round() / 1e4
}

/// Columns before the values.
const INDENT: usize = 18;

/// A line of a table: a name, and what it is.
fn line(text: &mut String, name: &str, value: &str) {
    writeln!(text, "{name:<INDENT$}{}", folded(value, INDENT, WIDTH - INDENT)).expect("a string takes all");
}

/// E, stiffnesses, what each law leaves, what a linear stiffness stands for, then warnings.
pub fn fit_text(found: &Calibration) -> String {
    let mut text = String::new();
    line(&mut text, "intervals", &format!("{} %, between trials where there are several", percent(found.confidence)));
    line(&mut text, "E", &estimate(&found.youngs_modulus_pa, 1e-6, "MPa"));
    for fit in &found.cases {
        line(&mut text, &format!("  {}", fit.case.name()), &estimate(&fit.youngs_modulus_pa, 1e-6, "MPa"));
        line(&mut text, "", &goodness(&fit.goodness, fit.case.unit()));
    }
    if let Some(p) = found.cases_agree_p_value {
        line(&mut text, "  agreement", &format!("p = {} that all cases have one E", number(p)));
    }
    for fit in found.linear.iter().filter(|fit| fit.case.is_radial()) {
        linear(&mut text, "kappa_rho", fit);
    }
    if let Some(stiffness) = &found.torsional_stiffness_nm_per_rad {
        line(&mut text, "kappa_tau", &estimate(stiffness, 1e3, "mN m/rad"));
    }
    for fit in found.linear.iter().filter(|fit| !fit.case.is_radial()) {
        linear(&mut text, &format!("  {}", fit.case.name()), fit);
    }
    equivalents(&mut text, found);
    for warning in &found.warnings {
        line(&mut text, "warning", warning);
    }
    text
}

fn linear(text: &mut String, name: &str, fit: &LinearFit) {
    let unit = fit.case.unit();
    let (scale, stiffness) = if fit.case.is_radial() { (1.0, "N/m") } else { (1e3, "mN m/rad") };
    let [low, high] = fit.range.map(|at| quantity(at, unit));
    line(text, name, &format!("{} over {low} to {high}", estimate(&fit.stiffness, scale, stiffness)));
    line(text, "", &goodness(&fit.goodness, unit));
    let misfit = &fit.misfit;
    let (apart, at, end) = (quantity(misfit.force_n, "N"), quantity(misfit.at, unit), quantity(misfit.force_at_end_n, "N"));
    line(text, "", &format!("linear law less model: {apart} at {at} ({:+.1} %), {end} at the end", 100.0 * misfit.share));
}

fn equivalents(text: &mut String, found: &Calibration) {
    if let Some(radial) = &found.radial_equivalents {
        let secant = radial.secant_at_8_mm_n_per_m.map_or(String::new(), |secant| format!(", secant at 8 mm {}", number(secant)));
        line(
            text,
            "model's kappa_rho",
            &format!(
                "tangent at zero {}{secant}, at the end {}, through the origin {} N/m",
                number(radial.tangent_at_zero_n_per_m),
                number(radial.secant_at_end_n_per_m),
                number(radial.least_squares_n_per_m)
            ),
        );
        let at = radial.stretch_of_secant_m.map_or("at no stretch".to_owned(), |at| format!("at {}", quantity(at, "m")));
        line(text, "", &format!("the fitted kappa_rho is its secant {at}"));
    }
    let swing = &found.swing_equivalents;
    let milli = |value: f64| number(1e3 * value);
    let (two, three, sum) =
        (milli(swing.tangent_of_case_2_nm_per_rad), milli(swing.tangent_of_case_3_nm_per_rad), milli(swing.sum_of_pivots_nm_per_rad));
    line(text, "model's kappa_tau", &format!("case 2 at zero {two}, case 3 {three}, all pivots {sum} mN m/rad"));
    let corrected = milli(swing.corrected_case_3_nm_per_rad);
    line(text, "", &format!("case 3 with the paper's factor of {} on k_1: {corrected} mN m/rad", number(CASE_3_FACTOR)));
}

/// A value with its interval, and what that rests on.
fn estimate(found: &Estimate, scale: f64, unit: &str) -> String {
    let ends = |interval: &Interval| format!("{} to {}", number(scale * interval.low), number(scale * interval.high));
    let (n, points) = (found.n_trials, found.n_points);
    let basis = match (&found.interval, &found.interval_within_trials) {
        (Some(interval), _) => format!("{} ({n} trials, {points} points)", ends(interval)),
        (None, Some(interval)) => format!("{} within its one trial only ({points} points)", ends(interval)),
        (None, None) => format!("no interval ({n} trials, {points} points)"),
    };
    let spread =
        found.between_trials_sd.filter(|sd| *sd > 0.0).map_or(String::new(), |sd| format!(", sd between trials {}", number(scale * sd)));
    format!("{} {unit}; {basis}{spread}", number(scale * found.value))
}

fn goodness(found: &Goodness, unit: &str) -> String {
    let mut text = format!("residuals {} rms", quantity(found.residual_rms_n, "N"));
    write!(text, ", {} within trials", quantity(found.residual_rms_within_trials_n, "N")).expect("a string takes all");
    if let Some(chi) = found.reduced_chi_squared {
        write!(text, ", chi^2 over freedom {}", number(chi)).expect("a string takes all");
    }
    if let Some(bend) = &found.bend {
        let (force, at, p) = (quantity(bend.force_n, "N"), quantity(bend.at, unit), number(bend.p_value));
        write!(text, "; bend of {force} at {at}, p = {p}").expect("a string takes all");
    }
    text
}

pub fn design_text(found: &DesignReport) -> String {
    let mut text = made_text(&found.exact);
    if let Some(made) = &found.on_grid {
        text.push_str("on the grid\n");
        text.push_str(&made_text(made));
    }
    text
}

fn made_text(made: &Made) -> String {
    let mut text = String::new();
    let dimensions = &made.dimensions;
    for (name, length) in [
        ("short member", dimensions.short_member_length_m),
        ("folded members", dimensions.folded_member_length_m),
        ("links", dimensions.link_length_m),
        ("width", dimensions.member_width_m),
        ("depth", dimensions.member_depth_m),
        ("rest length", made.rest_length_m),
    ] {
        line(&mut text, &format!("  {name}"), &quantity(length, "m"));
    }
    let error = |share: f64| if share.abs() < 1e-9 { "as wanted".to_owned() } else { format!("{:+.2} % of what is wanted", 100.0 * share) };
    line(&mut text, "  kappa_rho", &format!("{}, {}", quantity(made.radial_stiffness_n_per_m, "N/m"), error(made.radial_error_share)));
    line(
        &mut text,
        "  kappa_tau",
        &format!("{}, {}", quantity(made.torsional_stiffness_nm_per_rad, "N m/rad"), error(made.torsional_error_share)),
    );
    line(
        &mut text,
        "  at rest",
        &format!("{} along the spring, straight at {}", quantity(made.tangent_at_zero_n_per_m, "N/m"), quantity(made.stretch_limit_m, "m")),
    );
    text
}

/// A row for each spring.
pub fn forces_text(found: &ForcesReport) -> String {
    let has_model = found.springs.iter().any(|summary| summary.linear_less_model_n.is_some());
    let columns = ["spring", "tips", "mean", "sd", "largest", "linear law less Eq. (1)"];
    let with_error = |value: f64, error: f64| {
        let error = if error > 0.0 { format!(" +- {}", quantity(error, "N")) } else { String::new() };
        format!("{}{error}", quantity(value, "N"))
    };
    let row = |summary: &ForceSummary| {
        let fields = [
            summary.spring.map_or("all".to_owned(), |spring| spring.to_string()).into(),
            Field::from(summary.n),
            with_error(summary.mean_n, summary.mean_error_n).into(),
            quantity(summary.sd_n, "N").into(),
            format!("{} at {}", with_error(summary.max_n, summary.max_sd_n), quantity(summary.time_of_max_s, "s")).into(),
        ];
        let apart = has_model.then(|| summary.linear_less_model_n.map(|apart| quantity(apart, "N")).into());
        fields.into_iter().chain(apart).collect::<Vec<_>>()
    };
    let n_columns = if has_model { 6 } else { 5 };
    let forces = Table::new("", columns.into_iter().take(n_columns)).with_rows(found.springs.iter().map(row)).text();
    let transport = found.transport.as_ref().map_or_else(String::new, |transport| format!("\n{}", transport.text()));
    forces + &transport
}

pub fn grid_text(found: &GridReport) -> String {
    let mut text = String::new();
    let size = format!("{} readings of {} trials at {} x {} places", found.n_readings, found.n_trials, found.n_x, found.n_y);
    line(&mut text, "grid", &size);
    for (case, n) in &found.n_of_case {
        line(&mut text, case.name(), &format!("{n} readings for calibrate fit"));
    }
    for (name, sd) in [("radial", found.radial_sd_n), ("tangential", found.tangential_sd_n)] {
        if let Some(sd) = sd {
            line(&mut text, &format!("sd, {name}"), &format!("{} between trials, mean over the places", quantity(sd, "N")));
        }
    }
    text
}

pub fn pulls_text(found: &PullComparison) -> String {
    let mut text = String::new();
    for (name, sample) in ["one sample", "other sample"].into_iter().zip(&found.samples) {
        let [mean, sd, max] = [sample.mean_n, sample.sd_n, sample.max_n].map(|pull| quantity(pull, "N"));
        line(&mut text, name, &format!("mean {mean}, sd {sd}, largest {max} ({} pulls in {} blocks)", sample.n_pulls, sample.n_blocks));
    }
    line(&mut text, "distance", &format!("{} (Cramer-von Mises)", number(found.distance)));
    let (p, n) = (number(found.p_value), found.n_permutations);
    line(&mut text, "p-value", &format!("{p} that equal distributions differ as much ({n} permutations of blocks)"));
    if let Some(correlation) = found.block_correlation {
        line(&mut text, "neighbours", &format!("correlation {} between the means of neighbouring blocks", number(correlation)));
    }
    text
}
