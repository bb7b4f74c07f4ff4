//! Output folders of `calibrate`.

use std::path::Path;

use super::figure;
use super::fit::Calibration;
use super::forces::{Force, ForcesReport};
use super::load_cell::{GridReport, LoadCell, measurement_table};
use super::measurements::{Measurements, Trial};
use super::text::fit_text;
use cohaul::formats::Versioned;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::table::Table;

/// Columns of `forces.csv`. The model column is empty beyond the range of Eq. (1), the last two for
/// tips in the frame of their root.
pub(crate) fn force_table(forces: &[Force]) -> Table {
    Table::of(
        forces,
        &[
            ("time", "s", &|force| force.time.into()),
            ("spring", "", &|force| force.spring.into()),
            ("length", "m", &|force| force.shape.length.into()),
            ("swing", "rad", &|force| force.shape.swing.into()),
            ("radial", "N", &|force| force.radial.into()),
            ("tangential", "N", &|force| force.tangential.into()),
            ("force", "N", &|force| force.size.into()),
            ("force sd", "N", &|force| force.size_sd.into()),
            ("force sd of tip", "N", &|force| force.tip_part.into()),
            ("radial by model", "N", &|force| force.radial_by_model.into()),
            ("force x", "N", &|force| force.in_world.map(|world| world.x).into()),
            ("force y", "N", &|force| force.in_world.map(|world| world.y).into()),
        ],
    )
}

/// Readings beside both laws.
fn residuals(found: &Calibration, measurements: &Measurements) -> Table {
    let unit = found.dimensions.of_material(1.0);
    let line = |trial: &Trial| found.linear.iter().find(|fit| fit.case == trial.case);
    let readings = measurements.trials.iter().flat_map(|trial| trial.points.iter().map(move |point| (trial, point)));
    Table::of(
        &readings.collect::<Vec<_>>(),
        &[
            ("case", "", &|(trial, _)| trial.case.name().into()),
            ("trial", "", &|(trial, _)| trial.name.as_str().into()),
            ("displacement", "m", &|(trial, point)| trial.case.is_radial().then_some(point.at).into()),
            ("swing", "rad", &|(trial, point)| (!trial.case.is_radial()).then_some(point.at).into()),
            ("force", "N", &|(_, point)| point.force.into()),
            ("force sd", "N", &|(_, point)| point.sd.into()),
            ("model", "N", &|(trial, point)| (found.youngs_modulus_pa.value * trial.case.force(&unit, point.at)).into()),
            ("linear", "N", &|(trial, point)| line(trial).map(|fit| fit.stiffness.value * trial.case.linear(&unit, point.at)).into()),
            ("is in range", "", &|(trial, point)| {
                line(trial).is_some_and(|fit| (fit.range[0]..=fit.range[1]).contains(&point.at.abs())).into()
            }),
        ],
    )
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
    folder.write("residuals.csv", |out| residuals(found, measurements).write_csv(out))?;
    folder.write("calibration.svg", |out| out.write_all(figure::calibration(found, measurements).as_bytes()))?;
    folder.finish(manifest)
}

/// Writes `forces.csv`, `forces.json`, `forces.svg` and `manifest.json` to the folder `target`, all
/// or nothing; and `series.csv` of a recording that has the pose of the load.
///
/// # Errors
///
/// As [`write_calibration`].
pub fn write_tip_forces(target: &Path, found: &ForcesReport, forces: &[Force], manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write("forces.csv", |out| force_table(forces).write_csv(out))?;
    if let Some(transport) = &found.transport {
        folder.write("series.csv", |out| transport.series_table().write_csv(out))?;
    }
    folder.write_json("forces.json", found)?;
    folder.write("forces.svg", |out| out.write_all(figure::tip_forces(forces).as_bytes()))?;
    folder.finish(manifest)
}

/// Writes `measurements.csv`, which `calibrate fit` reads, the table `lookup.csv`, `grid.json` and
/// `manifest.json` to the folder `target`, all or nothing.
///
/// # Errors
/// As [`write_calibration`].
pub fn write_grid(
    target: &Path,
    found: &GridReport,
    readings: &LoadCell,
    measurements: &Measurements,
    manifest: &Manifest,
) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write("measurements.csv", |out| measurement_table(measurements).write_csv(out))?;
    folder.write("lookup.csv", |out| readings.lookup().write_csv(out))?;
    folder.write_json("grid.json", found)?;
    folder.finish(manifest)
}

/// Writes a result as the file `name` and `manifest.json` to the folder `target`, all or nothing.
///
/// # Errors
/// As [`write_calibration`].
pub fn write_result(target: &Path, name: &str, found: &impl Versioned, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    folder.write_json(name, found)?;
    folder.finish(manifest)
}
