//! Four ants before a wall with a gap. Again and again the load leans on the end of a wall at the
//! limit of what holds it, and finds a new balance where an ant lets go.

use cohaul::backend::{BackendKind, BackendOptions, StepReport, default_step};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation};

/// Steps of the run with a seed up to this time (s).
fn steps(kind: BackendKind, seed: u64, end: f64) -> StepReport {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/paper/wall-with-gap.json");
    let scenario = Scenario { seed, duration: end, ..Scenario::read(file.as_ref()).unwrap() };
    let step = default_step(kind, &scenario.system, scenario.control_period);
    let mut run = Simulation::new(&scenario, &BackendOptions::new(kind, step), Keep::Outcome);
    run.run(|_| true);
    run.outcome().steps
}

/// Shortly before these ends the load turns about a corner by a millionth of what it would without
/// the wall, so that roundings of its pose matter.
#[test]
fn a_load_that_leans_on_a_corner_finds_its_balance() {
    for (seed, end) in [(21, 71.0), (71, 89.5), (78, 61.0)] {
        let steps = steps(BackendKind::QuasiStatic, seed, end);
        assert_eq!(steps.n_not_converged, 0, "seed {seed}: {:e}", steps.residual);
        assert!(steps.contact_residual < 1e-11, "seed {seed}: {:e}", steps.contact_residual);
    }
}

/// Near its end the load slides on along a corner by some 1e-9 m in a step, after it has almost
/// stopped. Gaps are rounded to a millionth of that, and are closed all the same.
#[test]
fn a_load_that_almost_stops_at_a_corner_slides_on() {
    let steps = steps(BackendKind::Inertial, 47, 90.0);
    assert_eq!(steps.n_not_converged, 0, "{:e}", steps.residual);
}

/// From 50 s to 60 s the load stays at the wall, where it sticks and slides in turn.
#[test]
fn a_load_that_stays_at_a_wall_takes_few_solves_a_step() {
    let steps = steps(BackendKind::Inertial, 30, 60.0);
    assert_eq!(steps.n_not_converged, 0, "{:e}", steps.residual);
    let per_step = |n: u64| n as f64 / steps.n_steps as f64;
    assert!(per_step(steps.n_solves) < 1.5 && per_step(steps.n_iterations) < 4.0, "{steps:?}");
}
