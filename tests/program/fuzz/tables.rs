//! Tables of tips, paths, readings and pulls, and values of the axes of a sweep.

use cohaul::backend::{BackendKind, Integrator, RapierOptions, Skips};
use cohaul::math::{Pose, Vec2};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Row};
use cohaul_paper::calibrate::behaviour::{attachments, exposures, fit_holds, fit_steering};
use cohaul_paper::calibrate::{Dimensions, Measurements, PullSeries, Ranges, Recording, Sensor, compare_pulls, fit, summaries, tip_forces};
use cohaul_paper::colony::{Measures, recorded};
use cohaul_paper::from_tips::scenario_from_tips;
use cohaul_report::json;
use cohaul_studies::compare::beside::recorded_path;
use cohaul_studies::sweep::{Ask, Axis, Design, Method, Plan, Sample, Variant};

use crate::corpus;
use crate::survey::{Format, survey};

fn told(error: impl ToString) -> String {
    error.to_string()
}

fn finite(what: &str, data: &impl serde::Serialize) {
    json::check(data).unwrap_or_else(|error| panic!("{what}: {error}"));
}

/// The table as a scenario, as forces on the tips, and as behaviour of ants.
fn read_tips(input: &[u8]) -> Result<(), String> {
    let text = String::from_utf8_lossy(input);
    let like = corpus::scene(corpus::ANTS);
    let from_tips = scenario_from_tips(&text, "tips.csv", &like).map_err(told);
    let sensor = Sensor { tip_error: 1e-4, ..Sensor::exact(like.system.springs.clone()) };
    let (recording, releases) = Recording::with_releases(&text, "tips.csv", None, 0.0263).map_err(told)?;
    let forces = tip_forces(&recording, &sensor);
    finite("forces", &summaries(&forces, &sensor));
    let found = attachments(&recording, releases.as_deref(), &sensor).all;
    finite("holds", &fit_holds(&exposures(&found), Some(0.1), 0.95));
    finite("steering", &fit_steering(&found, Vec2::new(1.0, 0.0), 1e-4, 0.95, &|_| {}));
    if let Some(seen) = recorded(&recording, &forces) {
        finite("colony", &Measures::of(&seen.rows, seen.period, None, 1));
    }
    if recording.is_in_world() { from_tips.map(drop) } else { Ok(()) }
}

fn read_path(input: &[u8]) -> Result<(), String> {
    let trace = recorded_path(&String::from_utf8_lossy(input), "camera.csv").map_err(told)?;
    assert!(trace.rows.iter().all(|row| row.motion.pose.is_finite() && row.time.is_finite()));
    Ok(())
}

fn read_readings(input: &[u8]) -> Result<(), String> {
    let dimensions = Dimensions::default();
    let measurements = Measurements::parse(&String::from_utf8_lossy(input), "readings.csv", &dimensions).map_err(told)?;
    let ranges = Ranges { stretch: Some([0.0, 0.008]), swing: None };
    for ranges in [Ranges { stretch: None, swing: None }, ranges] {
        finite("fit", &fit(&measurements, &dimensions, &ranges, 0.95)?);
    }
    Ok(())
}

fn read_pulls(input: &[u8]) -> Result<(), String> {
    let series = PullSeries::parse(&String::from_utf8_lossy(input), "forces.csv").map_err(told)?;
    let whole = series.blocks(None)?;
    let blocks = series.blocks(Some(0.3))?;
    finite("blocks", &whole);
    let blocks = [blocks];
    finite("pulls", &compare_pulls([&blocks, &blocks], 99, 1)?);
    Ok(())
}

fn read_dimensions(input: &[u8]) -> Result<(), String> {
    // The program cuts this message.
    let dimensions: Dimensions = serde_json::from_slice(input).map_err(|_| "no dimensions".to_owned())?;
    let faults = dimensions.faults();
    if let Some(fault) = faults.first() {
        return Err(fault.to_string());
    }
    let readings = String::from_utf8(std::fs::read(crate::root::root().join("data/spring-calibration.csv")).unwrap()).unwrap();
    let measurements = Measurements::parse(&readings, "readings.csv", &dimensions).map_err(told)?;
    finite("fit", &fit(&measurements, &dimensions, &Ranges { stretch: None, swing: None }, 0.95)?);
    Ok(())
}

/// One axis a line, on a scene of ants.
fn read_axes(input: &[u8]) -> Result<(), String> {
    let text = String::from_utf8_lossy(input);
    let axes = text.lines().map(str::parse::<Axis>).collect::<Result<Vec<_>, _>>().map_err(told)?;
    let sample = axes.iter().any(|axis| axis.n_values().is_none()).then_some(Sample { method: Method::Sobol, n: 8, seed: Some(1) });
    let design = Design::new(axes, sample).map_err(told)?;
    let ask = Ask {
        file: "four.json".to_owned(),
        text: corpus::ANTS.to_owned(),
        design,
        variants: vec![variant()],
        first_seed: None,
        n_seeds: 2,
    };
    let plan = Plan::new(ask).map_err(told)?;
    let n_points = plan.identity.design.n_points();
    for point in [0, n_points / 2, n_points.saturating_sub(1)] {
        let scenario: Scenario = plan.scenario(&plan.values(point)).map_err(told)?;
        assert!(scenario.expanded().checked("again").is_ok());
    }
    Ok(())
}

fn variant() -> Variant {
    let (backend, integrator, rapier) = (BackendKind::QuasiStatic, Integrator::default(), RapierOptions::default());
    Variant { backend, step_s: None, tolerance_m: None, integrator, rapier, skips: Skips::ALL }
}

const AXES: [&str; 6] = [
    "load.mass_kg=0.001,0.002",
    "load.mass_kg=log:1e-4:1e-2:7\ndrive.n_ants=2:6:3",
    "/load/mass_kg=1e-4..1e-2\nsprings.*.damping_ratio=0..1",
    "inertia_scale=0.1,1,10\nground.friction_coefficient=log:0.1..1",
    "ground.friction_coefficient=0.5,1.4",
    "load.position_m[0]=-1:1:5\nduration_s=10\nload.heading_rad=-1..1",
];

fn bytes(texts: &[&str]) -> Vec<Vec<u8>> {
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

#[test]
fn changed_tables_of_tips_are_answered() {
    survey(&Format { name: "tips", texts: corpus::tips(), files: Vec::new(), read: read_tips }, 600);
}

#[test]
fn changed_paths_of_cameras_are_answered() {
    let scenario = corpus::scene(&corpus::small());
    let run = corpus::run_until(&scenario, BackendKind::Inertial, Keep::Trace, 0.5);
    let line = |row: &Row| {
        let Pose { position, heading } = row.motion.pose;
        format!("{},{},{},{heading}\n", row.time, position.x, position.y)
    };
    let rows: String = run.trace().rows.iter().map(line).collect();
    let few = "time_s,x_m,y_m,heading_rad\n0,0,0,0\n0.1,0.01,0,0.2\n0.25,0.02,-1e-3,0.3\n";
    let texts = bytes(&[few, &format!("time_s,x_m,y_m,heading_rad\n{rows}")]);
    survey(&Format { name: "camera", texts, files: Vec::new(), read: read_path }, 3000);
}

#[test]
fn changed_readings_and_pulls_are_answered() {
    let readings = std::fs::read(crate::root::root().join("data/spring-calibration.csv")).unwrap();
    survey(&Format { name: "readings", texts: vec![readings], files: Vec::new(), read: read_readings }, 1000);
    let rows: String = (0..120).map(|k| format!("{},{}\n", 0.05 * f64::from(k), 0.01 + 0.001 * f64::from(k % 7))).collect();
    let texts = bytes(&[&format!("time_s,force_n\n{rows}")]);
    survey(&Format { name: "pulls", texts, files: Vec::new(), read: read_pulls }, 1000);
}

#[test]
fn changed_dimensions_and_axes_are_answered() {
    let texts = vec![serde_json::to_vec(&Dimensions::default()).unwrap()];
    let files = corpus::values(&texts);
    survey(&Format { name: "dimensions", texts, files, read: read_dimensions }, 500);
    survey(&Format { name: "axes", texts: bytes(&AXES), files: Vec::new(), read: read_axes }, 3000);
}
