//! `cohaul calibrate design`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::SystemTime;

use clap::Args;
use serde_json::json;

use super::super::{CliError, check_out, positive, print};
use super::{manifest, not_negative};
use crate::model::paper;
use crate::output::json;
use crate::studies::calibrate::report::{DesignReport, write_design};
use crate::studies::calibrate::{Held, Limits, Made, Target, Wanted, design as spring, on_grid};

#[derive(Args)]
pub struct DesignArgs {
    /// Wanted kappa_rho (N/m)
    #[arg(long, value_name = "K", value_parser = positive)]
    radial_stiffness_n_per_m: f64,
    /// Wanted kappa_tau, the sum of all pivots (N m/rad)
    #[arg(long, value_name = "T", value_parser = positive)]
    torsional_stiffness_nm_per_rad: f64,
    /// Stretch at which kappa_rho is the secant (m); 0 for the slope at rest
    #[arg(long, value_name = "M", default_value = "0.008", value_parser = not_negative)]
    at_stretch_m: f64,
    /// Hold l_1 at this (m); what is held without any of these three, at the paper's 9.8e-3
    #[arg(long, value_name = "M", value_parser = positive, group = "held")]
    short_member_length_m: Option<f64>,
    /// Hold l_2 = l_4 at this (m)
    #[arg(long, value_name = "M", value_parser = positive, group = "held")]
    folded_member_length_m: Option<f64>,
    /// Hold the width h at this (m)
    #[arg(long, value_name = "M", value_parser = positive, group = "held")]
    member_width_m: Option<f64>,
    /// Young's modulus (Pa)
    #[arg(long, value_name = "PA", default_value = "1.66e6", value_parser = positive)]
    youngs_modulus_pa: f64,
    /// Depth b of the sheet (m)
    #[arg(long, value_name = "M", default_value = "3.2e-3", value_parser = positive)]
    member_depth_m: f64,
    /// Root to tip without force (m)
    #[arg(long, value_name = "M", default_value = "2.63e-2", value_parser = positive)]
    rest_length_m: f64,
    /// Thinnest member that can be cut (m)
    #[arg(long, value_name = "M", default_value = "1e-4", value_parser = positive)]
    least_width_m: f64,
    /// Also round lengths and width to multiples of this (m), and say what that costs
    #[arg(long, value_name = "M", value_parser = positive)]
    grid_m: Option<f64>,
    /// Folder for design and manifest
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

pub fn design(args: &DesignArgs) -> Result<ExitCode, CliError> {
    let started = SystemTime::now();
    if let Some(out) = &args.out {
        check_out(out)?;
    }
    let (wanted, limits) = (wanted(args), Limits { least_width_m: args.least_width_m, ..Limits::default() });
    let made = spring(&wanted, &limits).map_err(|error| CliError::Usage(format!("cannot be built: {error}")))?;
    let rounded = |grid: f64| {
        on_grid(&made, grid, args.at_stretch_m)
            .ok_or_else(|| CliError::Usage(format!("--grid-m: must leave members of some length and width, found {grid}")))
    };
    let rounded = args.grid_m.map(rounded).transpose()?;
    let found = DesignReport {
        wanted,
        limits,
        exact: Made::of(&made, &wanted.target),
        on_grid: rounded.map(|made| Made::of(&made, &wanted.target)),
    };
    if let Some(out) = &args.out {
        write_design(out, &found, &manifest("calibrate design", None, json!({ "wanted": wanted, "limits": limits }), started)?)?;
    }
    print(&if args.json { json::pretty(&found)? } else { found.to_text() })?;
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
