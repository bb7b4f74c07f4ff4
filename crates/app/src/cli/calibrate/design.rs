//! `cohaul calibrate design`.

use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::super::choice::{not_negative, positive};
use super::super::console::Tone;
use super::super::error::CliError;
use super::super::output::{OutputArgs, study_manifest};
use cohaul::model::paper;
use cohaul_paper::calibrate::files::write_result;
use cohaul_paper::calibrate::text::design_text;
use cohaul_paper::calibrate::{DesignReport, Held, Limits, Made, Target, Wanted, design as spring, on_grid};

#[derive(Args)]
#[command(
    override_usage = "cohaul calibrate design [OPTIONS] --radial-stiffness-n-per-m <K>\n       --torsional-stiffness-nm-per-rad <T>",
    after_help = "\
Example:
  cohaul calibrate design --radial-stiffness-n-per-m 0.664 \\
    --torsional-stiffness-nm-per-rad 4.52e-4 --grid-m 1e-4

Files in DIR: design.json and manifest.json."
)]
pub struct DesignArgs {
    /// Wanted radial stiffness kappa_rho (N/m)
    #[arg(long, value_name = "K", value_parser = positive)]
    radial_stiffness_n_per_m: f64,
    /// Wanted torsional stiffness kappa_tau, the sum of all pivots (N m/rad)
    #[arg(long, value_name = "T", value_parser = positive)]
    torsional_stiffness_nm_per_rad: f64,
    /// Stretch at which kappa_rho is the secant stiffness (m); 0 for the slope at rest
    #[arg(long, value_name = "M", default_value = "0.008", value_parser = not_negative)]
    at_stretch_m: f64,
    /// Fix the length l_1 (m); the default, at the paper's 9.8e-3
    #[arg(long, value_name = "M", value_parser = positive, group = "held")]
    short_member_length_m: Option<f64>,
    /// Fix the length l_2 = l_4 instead (m)
    #[arg(long, value_name = "M", value_parser = positive, group = "held")]
    folded_member_length_m: Option<f64>,
    /// Fix the width h instead (m)
    #[arg(long, value_name = "M", value_parser = positive, group = "held")]
    member_width_m: Option<f64>,
    /// Young's modulus (Pa)
    #[arg(long, value_name = "PA", default_value = "1.66e6", value_parser = positive)]
    youngs_modulus_pa: f64,
    /// Depth b of the sheet (m)
    #[arg(long, value_name = "M", default_value = "3.2e-3", value_parser = positive)]
    member_depth_m: f64,
    /// Distance from root to tip without force (m)
    #[arg(long, value_name = "M", default_value = "2.63e-2", value_parser = positive)]
    rest_length_m: f64,
    /// Thinnest member that can be cut (m)
    #[arg(long, value_name = "M", default_value = "1e-4", value_parser = positive)]
    least_width_m: f64,
    /// Also round lengths and width to multiples of this, and print the effect (m)
    #[arg(long, value_name = "M", value_parser = positive)]
    grid_m: Option<f64>,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn design(args: &DesignArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    args.output.check()?;
    let (wanted, limits) = (wanted(args), Limits { least_width_m: args.least_width_m, ..Limits::default() });
    let made = spring(&wanted, &limits).map_err(|error| CliError::Usage(format!("cannot be built: {error}")))?;
    let rounded = |grid: f64| {
        on_grid(&made, grid, args.at_stretch_m)
            .ok_or_else(|| CliError::Usage(format!("--grid-m: every length and width must round to more than zero, found {grid}")))
    };
    let rounded = args.grid_m.map(rounded).transpose()?;
    let found = DesignReport {
        wanted,
        limits,
        exact: Made::of(&made, &wanted.target),
        on_grid: rounded.map(|made| Made::of(&made, &wanted.target)),
    };
    if let Some(out) = &args.output.out {
        let question = json!({ "name": "calibrate design" });
        let manifest = study_manifest(&question, &json!({ "wanted": wanted, "limits": limits }), started);
        write_result(out, "design.json", &found, &manifest)?;
    }
    args.output.print(&found, || design_text(&found), Tone::Good)?;
    Ok(ExitCode::SUCCESS)
}

fn wanted(args: &DesignArgs) -> Wanted {
    let paper = paper::SPRING;
    let held = match (args.short_member_length_m, args.folded_member_length_m, args.member_width_m) {
        (_, Some(folded), _) => Held::FoldedMemberLengthM(folded),
        (_, _, Some(width)) => Held::MemberWidthM(width),
        (short, ..) => Held::ShortMemberLengthM(short.unwrap_or(paper.short_member_length)),
    };
    Wanted {
        target: Target {
            radial_stiffness_n_per_m: args.radial_stiffness_n_per_m,
            at_stretch_m: args.at_stretch_m,
            torsional_stiffness_nm_per_rad: args.torsional_stiffness_nm_per_rad,
        },
        held,
        youngs_modulus_pa: args.youngs_modulus_pa,
        member_depth_m: args.member_depth_m,
        rest_length_m: args.rest_length_m,
        characteristic_radius_factor: paper.characteristic_radius_factor,
        stiffness_coefficient: paper.stiffness_coefficient,
    }
}
