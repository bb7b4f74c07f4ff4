//! The inertia estimate among obstacles against the inertia effect between runs at short steps, for
//! random scenes over three decades of inertia and two of speed.

use cohaul::analysis::estimate::{CLEAR, InertiaEstimate, TOLERANCE_SHARE};
use cohaul::backend::BackendKind::{Inertial, QuasiStatic};
use cohaul::backend::{BackendKind, BackendOptions, Status};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Outcome, Simulation, Trace};
use rayon::prelude::*;

use crate::draws::Draws;
use crate::random_scene::Random;

/// Step of the run with inertia over its default (1).
const FINER: f64 = 0.25;
/// Effect that counts as none, over the radius of the load (1).
const NONE: f64 = 1e-4;

/// Estimated and measured inertia effect (m), and the tolerance (m).
struct Found {
    seed: u64,
    estimated: f64,
    measured: f64,
    tolerance: f64,
    is_negligible: Option<bool>,
}

/// A scene of pushing or pulling with its inertia scaled at the same normal loads.
fn scenario(seed: u64) -> Scenario {
    let mut draws = Draws::new(seed ^ 0x5eed);
    let mut scene = Random::new(seed, false).scene;
    let (inertia, speed) = (draws.log_between(1e-2, 10.0), draws.log_between(0.1, 10.0));
    (scene.mass, scene.inertia) = (inertia * scene.mass, inertia * scene.inertia);
    (scene.duration, scene.control_period) = (scene.duration / speed, scene.control_period / speed);
    scene.springs.iter_mut().flat_map(|spring| &mut spring.path).for_each(|at| at[0] /= speed);
    scene.obstacles.iter_mut().flat_map(|obstacle| &mut obstacle.path).for_each(|at| at[0] /= speed);
    scene.scenario()
}

fn run(scenario: &Scenario, kind: BackendKind, finer: f64) -> (Trace, Outcome) {
    let options = BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
    let mut run = Simulation::new(scenario, &BackendOptions { step_s: finer * options.step_s, ..options }, Keep::Trace);
    run.run(|_| true);
    run.into_results()
}

/// `None` where a run is doubtful, or no load touches the obstacle.
fn found(seed: u64) -> Option<Found> {
    let scenario = scenario(seed);
    let ((quasi_static, without), (inertial, with)) = (run(&scenario, QuasiStatic, 1.0), run(&scenario, Inertial, FINER));
    let is_doubtful = |outcome: &Outcome| outcome.steps.status != Status::Converged || !outcome.doubtful.is_empty();
    let estimate = InertiaEstimate::of(&scenario, &quasi_static);
    if is_doubtful(&without) || is_doubtful(&with) || !estimate.touches_obstacle {
        return None;
    }
    let radius = scenario.system.load.radius;
    let apart = quasi_static.rows.iter().zip(&inertial.rows).map(|(a, b)| a.motion.pose.edge_displacement(&b.motion.pose, radius));
    let none = NONE * radius;
    Some(Found {
        seed,
        estimated: estimate.edge_displacement_max_m.max(none),
        measured: apart.fold(none, f64::max),
        tolerance: TOLERANCE_SHARE * estimate.path_length_m,
        is_negligible: estimate.is_negligible,
    })
}

/// Ranks of values, the mean rank of equal ones.
fn ranks(values: &[f64]) -> Vec<f64> {
    let below = |value: f64| values.iter().filter(|other| **other < value).count() as f64;
    let equal = |value: f64| values.iter().filter(|other| **other == value).count() as f64;
    values.iter().map(|value| below(*value) + 0.5 * (equal(*value) - 1.0)).collect()
}

/// Rank correlation after Spearman.
fn spearman(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (ranks(a), ranks(b));
    let mean = 0.5 * (a.len() as f64 - 1.0);
    let sum = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (x - mean) * (y - mean)).sum::<f64>();
    sum(&a, &b) / (sum(&a, &a) * sum(&b, &b)).sqrt()
}

/// What the survey of so many scenes from a seed on found: rank correlation, share within a factor
/// of two, and scenes that are called negligible or not negligible on the wrong side.
fn survey(first: u64, n: usize) -> (usize, f64, f64, Vec<u64>) {
    let found: Vec<Found> = (first..first + n as u64).into_par_iter().filter_map(found).collect();
    let values = |of: fn(&Found) -> f64| found.iter().map(of).collect::<Vec<_>>();
    let correlation = spearman(&values(|of| of.estimated), &values(|of| of.measured));
    let is_near = |of: &&Found| (of.estimated / of.measured).ln().abs() <= 2.0f64.ln();
    let within = found.iter().filter(is_near).count() as f64 / found.len() as f64;
    let is_wrong = |of: &&Found| of.is_negligible.is_some_and(|negligible| negligible != (of.measured <= of.tolerance));
    for of in found.iter().filter(|of| !is_near(of)) {
        println!("{}: estimated {:.3e}, measured {:.3e}, tolerance {:.3e}", of.seed, of.estimated, of.measured, of.tolerance);
    }
    (found.len(), correlation, within, found.iter().filter(is_wrong).map(|of| of.seed).collect())
}

#[test]
fn the_estimate_among_obstacles_is_within_a_factor_of_two() {
    let (n, correlation, within, wrong) = survey(40_000, 60);
    println!("{n} scenes: rank correlation {correlation:.3}, {:.1} % within a factor of 2, wrong at {CLEAR}: {wrong:?}", 100.0 * within);
    // Of 567 scenes all are within a factor of two.
    assert!(n >= 30 && correlation >= 0.99 && within >= 0.98 && wrong.is_empty(), "{n} {correlation} {within} {wrong:?}");
}

#[test]
#[ignore = "600 scenes in place of 60"]
fn survey_of_estimates_among_obstacles() {
    let (n, correlation, within, wrong) = survey(50_000, 600);
    println!("{n} scenes: rank correlation {correlation:.4}, {:.1} % within a factor of 2, wrong at {CLEAR}: {wrong:?}", 100.0 * within);
    assert!(n >= 300 && correlation >= 0.99 && within >= 0.98 && wrong.is_empty());
}
