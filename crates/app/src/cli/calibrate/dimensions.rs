//! Options for the dimensions of a spring.

use std::path::PathBuf;

use clap::Args;

use super::super::choice::positive;
use super::super::error::CliError;
use super::super::input::{name_of, read_plain_json};
use cohaul_paper::calibrate::Dimensions;

/// Dimensions of the spring [default: the paper's].
#[derive(Args)]
#[command(next_help_heading = "Dimensions of the spring")]
pub struct DimensionArgs {
    /// JSON file of dimensions; its keys are the options below with underscores
    #[arg(long, value_name = "FILE")]
    dimensions: Option<PathBuf>,
    /// Width h of the members, in the plane of bending (m) [default: 8e-4]
    #[arg(long, value_name = "M", value_parser = positive)]
    member_width_m: Option<f64>,
    /// Depth b of the sheet, across that plane (m) [default: 3.2e-3]
    #[arg(long, value_name = "M", value_parser = positive)]
    member_depth_m: Option<f64>,
    /// Length l_1 (m) [default: 9.8e-3]
    #[arg(long, value_name = "M", value_parser = positive)]
    short_member_length_m: Option<f64>,
    /// Length l_2 = l_4 (m) [default: 1.19e-2]
    #[arg(long, value_name = "M", value_parser = positive)]
    folded_member_length_m: Option<f64>,
    /// Length l_3 + l_5 (m) [default: 1.65e-2]
    #[arg(long, value_name = "M", value_parser = positive)]
    link_length_m: Option<f64>,
}

impl DimensionArgs {
    /// The dimensions of the file, with the options in place of its values.
    pub fn read(&self) -> Result<Dimensions, CliError> {
        let file: Dimensions =
            self.dimensions.as_ref().map(|path| read_plain_json(path, "must be JSON of dimensions")).transpose()?.unwrap_or_default();
        let found = Dimensions {
            member_width_m: self.member_width_m.unwrap_or(file.member_width_m),
            member_depth_m: self.member_depth_m.unwrap_or(file.member_depth_m),
            short_member_length_m: self.short_member_length_m.unwrap_or(file.short_member_length_m),
            folded_member_length_m: self.folded_member_length_m.unwrap_or(file.folded_member_length_m),
            link_length_m: self.link_length_m.unwrap_or(file.link_length_m),
            ..file
        };
        let from = self.dimensions.as_deref().map_or("dimensions".to_owned(), name_of);
        let faults: Vec<String> = found.faults().iter().map(|fault| format!("{from}: {fault}")).collect();
        if faults.is_empty() { Ok(found) } else { Err(CliError::Usage(faults.join("\n"))) }
    }
}
