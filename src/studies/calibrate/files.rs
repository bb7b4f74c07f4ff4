//! Output folders of `calibrate`.

use std::path::Path;

use super::figure;
use super::fit::Calibration;
use super::forces::{Force, TipForces};
use super::measurements::Measurements;
use super::report::{DesignReport, ForcesReport};
use super::text::fit_text;
use crate::output::folder::{FolderError, OutputFolder};
use crate::output::json;
use crate::output::lines::TableError;
use crate::output::manifest::Manifest;

/// Columns of `forces.csv`. The model column is empty beyond the range of Eq. (1), the last two for
/// tips in the frame of their root.
pub const FORCE_COLUMNS: [&str; 12] = [
    "time_s",
    "spring",
    "length_m",
    "swing_rad",
    "radial_n",
    "tangential_n",
    "force_n",
    "force_sd_n",
    "force_sd_of_tip_n",
    "radial_by_model_n",
    "force_x_n",
    "force_y_n",
];

fn write_forces(forces: &[Force], out: impl std::io::Write) -> Result<(), TableError> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
    writer.write_record(FORCE_COLUMNS)?;
    for force in forces {
        let numbers = [force.shape.length, force.shape.swing, force.radial, force.tangential, force.size, force.size_sd, force.tip_part];
        let world = [force.in_world.map(|force| force.x), force.in_world.map(|force| force.y)];
        let row = (force.time, force.spring, numbers, force.radial_by_model, world);
        json::check(&row)?;
        writer.serialize(row)?;
    }
    writer.flush()?;
    Ok(())
}

/// Readings beside both laws.
fn write_residuals(found: &Calibration, measurements: &Measurements, out: impl std::io::Write) -> Result<(), csv::Error> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
    let columns = ["case", "trial", "displacement_m", "swing_rad", "force_n", "force_sd_n", "model_n", "linear_n", "is_in_range"];
    writer.write_record(columns)?;
    let unit = found.dimensions.of_material(1.0);
    for trial in &measurements.trials {
        let linear = found.linear.iter().find(|fit| fit.case == trial.case);
        for point in &trial.points {
            let (stretch, swing) = if trial.case.is_radial() { (Some(point.at), None) } else { (None, Some(point.at)) };
            let model = found.youngs_modulus_pa.value * trial.case.force(&unit, point.at);
            let by_line = linear.map(|fit| fit.stiffness.value * trial.case.linear(&unit, point.at));
            let is_in_range = linear.is_some_and(|fit| (fit.range[0]..=fit.range[1]).contains(&point.at.abs()));
            writer.serialize((trial.case.name(), &trial.name, stretch, swing, point.force, point.sd, model, by_line, is_in_range))?;
        }
    }
    Ok(writer.flush()?)
}

/// Writes `calibration.json`, `calibration.txt`, `residuals.csv`, `calibration.svg` and
/// `manifest.json` to the folder `target`, all or nothing.
///
/// # Errors
///
/// When the folder may not be written, a number is not finite, or the disk fails.
pub fn write_calibration(target: &Path, found: &Calibration, measurements: &Measurements, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write_json("calibration.json", found)?;
    folder.write("calibration.txt", |out| out.write_all(fit_text(found).as_bytes()))?;
    folder.write("residuals.csv", |out| write_residuals(found, measurements, out))?;
    folder.write("calibration.svg", |out| out.write_all(figure::calibration(found, measurements).as_bytes()))?;
    folder.finish(manifest)
}

/// Writes `design.json` and `manifest.json` to the folder `target`, all or nothing.
///
/// # Errors
/// As [`write_calibration`].
pub fn write_design(target: &Path, found: &DesignReport, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write_json("design.json", found)?;
    folder.finish(manifest)
}

/// Writes `forces.csv`, `forces.json`, `forces.svg` and `manifest.json` to the folder `target`, all
/// or nothing.
///
/// # Errors
///
/// As [`write_calibration`].
pub fn write_tip_forces(target: &Path, found: &ForcesReport, forces: &TipForces, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write("forces.csv", |out| write_forces(&forces.forces, out))?;
    folder.write_json("forces.json", found)?;
    folder.write("forces.svg", |out| out.write_all(figure::tip_forces(forces).as_bytes()))?;
    folder.finish(manifest)
}
