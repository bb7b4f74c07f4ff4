//! Intervals over many generated data sets: a promise of 95 % has to be kept in about 95 % of them.

use cohaul_paper::calibrate::{Calibration, Case, Estimate};

use super::generated::{Plan, measurements};
use super::{TRUTH, of};

const N: u64 = 1500;
/// Five standard deviations of a share of 95 % in that many data sets: seeds are fixed, but any
/// would do.
const SLACK: f64 = 5.0 * 0.0056;

fn covers(estimate: &Estimate, truth: f64) -> bool {
    estimate.interval.is_some_and(|interval| interval.low <= truth && truth <= interval.high)
}

/// Share of the data sets whose interval covers the truth.
fn coverage(name: &str, plan: &Plan, covers: impl Fn(&Calibration) -> bool) -> f64 {
    let kept = (0..N).filter(|seed| covers(&of(&Plan { seed: *seed, ..*plan }))).count();
    let share = kept as f64 / N as f64;
    println!("{name}: {share}");
    share
}

/// The slope of the line through the origin nearest to exact forces at the plan's displacements.
fn linear_truth(plan: &Plan, case: Case, reach: f64) -> f64 {
    let at = |i: usize| reach * i as f64 / plan.n_points as f64;
    let sum = |of: &dyn Fn(f64) -> f64| (1..=plan.n_points).map(|i| of(at(i))).sum::<f64>();
    sum(&|at| case.force(&TRUTH, at) * case.linear(&TRUTH, at)) / sum(&|at| case.linear(&TRUTH, at).powi(2))
}

#[test]
fn intervals_of_the_modulus_cover_it_as_often_as_they_say() {
    let radial = Plan { reach: [1e-2, 0.0, 0.0], n_points: 6, ..Plan::EXAMPLE };
    for (name, plan) in [
        ("trials differ", Plan { between_trials: 0.05, ..radial }),
        ("trials differ, errors not stated", Plan { between_trials: 0.05, states_noise: false, ..radial }),
        ("noise only", Plan { between_trials: 0.0, noise: 3e-4, ..radial }),
        ("three trials", Plan { n_trials: 3, between_trials: 0.02, states_noise: false, ..radial }),
        ("three cases of different precision", Plan { reach: [1e-2, 0.8, -0.5], n_trials: 3, n_points: 4, ..radial }),
    ] {
        let share = coverage(name, &plan, |found| covers(&found.youngs_modulus_pa, 1.66e6));
        assert!((share - 0.95).abs() < SLACK, "{name}: {share}");
    }
}

/// What is promised is the interval of the best line over the range, not of the model.
#[test]
fn intervals_of_linear_stiffnesses_cover_them_as_often_as_they_say() {
    let plan = Plan { n_points: 6, between_trials: 0.05, states_noise: false, ..Plan::EXAMPLE };
    let [rho, two, three] = [0, 1, 2].map(|i| linear_truth(&plan, Case::ALL[i], plan.reach[i]));
    let share = coverage("kappa_rho", &plan, |found| covers(&found.radial_stiffness_n_per_m.unwrap(), rho));
    assert!((share - 0.95).abs() < SLACK, "kappa_rho: {share}");
    let share = coverage("kappa_tau", &plan, |found| covers(&found.torsional_stiffness_nm_per_rad.unwrap(), 0.5 * (two + three)));
    assert!((share - 0.95).abs() < SLACK, "kappa_tau: {share}");
}

#[test]
fn readings_counted_one_by_one_promise_far_too_much() {
    let plan = Plan { reach: [1e-2, 0.0, 0.0], n_points: 20, between_trials: 0.05, ..Plan::EXAMPLE };
    let share = coverage("one by one", &plan, |found| {
        let interval = found.youngs_modulus_pa.interval_within_trials.unwrap();
        interval.low <= 1.66e6 && 1.66e6 <= interval.high
    });
    assert!(share < 0.6, "{share}");
}

#[test]
fn the_spread_of_trials_is_found_and_the_model_is_not_said_to_bend() {
    let plan = Plan { reach: [1e-2, 0.0, 0.0], n_trials: 12, between_trials: 0.05, ..Plan::EXAMPLE };
    let (mut squares, mut n_bent) = (0.0, 0);
    for seed in 0..N {
        let found = of(&Plan { seed, ..plan });
        squares += (found.youngs_modulus_pa.between_trials_sd.unwrap() / 1.66e6).powi(2);
        n_bent += usize::from(found.cases[0].goodness.bend.unwrap().p_value < 0.05);
    }
    let sd = (squares / N as f64).sqrt();
    // A variance of 12 trials is off by sqrt(2 / 11), the mean of N by 1.5 % of itself and the root
    // by half of that; five of them.
    assert!((sd / 0.05 - 1.0).abs() < 0.04, "{sd}");
    let share = n_bent as f64 / N as f64;
    assert!((share - 0.05).abs() < SLACK, "{share}");
    let data = measurements(&TRUTH, &Plan { noise: 0.0, ..plan });
    assert_eq!(data.trials.len(), 12);
}
