use cohaul_paper::calibrate::{Case, Dimensions, Measurement, Measurements, Ranges, Sensor, fit, least_squares_stiffness};

use super::generated::{EXAMPLE_COMMENT, Plan, measurements, to_csv};
use super::{EXACT, TRUTH, fitted, of};

#[test]
fn exact_readings_give_the_modulus_to_the_last_digits_in_every_case() {
    let found = of(&EXACT);
    for estimate in found.cases.iter().map(|fit| fit.youngs_modulus_pa).chain([found.youngs_modulus_pa]) {
        // Sums of some tens of products.
        assert!((estimate.value / 1.66e6 - 1.0).abs() < 1e-14, "{estimate:?}");
    }
    assert!(found.cases.iter().all(|fit| fit.goodness.residual_rms_n < 1e-17), "{:?}", found.cases);
    // The cases have one modulus; that they differ in the last bit is no finding.
    assert!(found.cases_agree_p_value.unwrap() > 0.9);
}

/// The paper: kappa_rho = 0.664 N/m and kappa_tau = 4.52e-4 N m/rad beside E = 1.66 MPa.
#[test]
fn the_printed_numbers_come_out_of_the_printed_spring() {
    let plan = Plan { n_points: 2000, reach: [10.274e-3, 0.8, -0.5], n_trials: 2, ..EXACT };
    let found = of(&plan);
    let radial = found.radial_stiffness_n_per_m.unwrap().value;
    // Half of the last printed digit; 2000 points leave 2e-4 of it.
    assert!((radial - 0.664).abs() < 5e-4 && radial != 0.664, "{radial}");
    assert!((found.swing_equivalents.sum_of_pivots_nm_per_rad - 4.52e-4).abs() < 5e-7);
    let secant = found.radial_equivalents.unwrap();
    assert!((secant.secant_at_8_mm_n_per_m.unwrap() - 0.664).abs() < 5e-4);
    assert!((secant.stretch_of_secant_m.unwrap() - 8e-3).abs() < 5e-5, "{secant:?}");
    // No swing has the printed kappa_tau: the mean of both is far below it.
    assert!(found.torsional_stiffness_nm_per_rad.unwrap().value < 0.5 * 4.52e-4);
}

#[test]
fn a_linear_stiffness_is_that_of_its_range_and_says_how_wrong_it_is() {
    let plan = Plan { n_points: 1000, n_trials: 2, ..EXACT };
    let data = measurements(&TRUTH, &plan);
    let mut last = 0.0;
    for range in [[0.0, 2e-3], [0.0, 6e-3], [0.0, 1e-2], [5e-3, 1e-2]] {
        let found = fitted(&data, &Ranges { stretch: Some(range), swing: None });
        let linear = found.linear.iter().find(|fit| fit.case == Case::Radial).unwrap();
        let expected = least_squares_stiffness(&TRUTH, range);
        // Points stand at the ends of cells, the integral has their middles: half a cell of 10 um,
        // times a slope of the stiffness of below 15 N/m^2.
        assert!((linear.stiffness.value - expected).abs() < 2e-4, "{range:?}: {} {expected}", linear.stiffness.value);
        assert!(linear.stiffness.value > last, "the spring stiffens");
        last = linear.stiffness.value;
        let at_end = last * range[1] - TRUTH.radial_force(range[1]);
        assert!((linear.misfit.force_at_end_n - at_end).abs() < 1e-15);
        assert!(linear.misfit.force_n.abs() >= at_end.abs() - 1e-15);
        assert!(linear.misfit.at >= range[0] && linear.misfit.at <= range[1]);
    }
    // E goes by all readings, whatever the range.
    let found = fitted(&data, &Ranges { stretch: Some([0.0, 2e-3]), swing: None });
    assert_eq!(found.youngs_modulus_pa.n_points, 6000);
    assert_eq!(found.radial_stiffness_n_per_m.unwrap().n_points, 400);
}

/// The last reading stands at 8 mm, where the range ends: a rounding of it changes nothing, a ten
/// thousandth leaves it out.
#[test]
fn readings_at_the_end_of_a_range_are_in_it_however_they_are_rounded() {
    let data = measurements(&TRUTH, &Plan::EXAMPLE);
    let radial = |factor: f64| {
        let mut moved = Measurements::default();
        for trial in &data.trials {
            trial
                .points
                .iter()
                .for_each(|point| moved.add(trial.case, trial.name.clone(), Measurement { at: factor * point.at, ..*point }));
        }
        fitted(&moved, &Ranges { stretch: Some([1e-3, 8e-3]), swing: None }).radial_stiffness_n_per_m.unwrap()
    };
    let (found, beyond) = (radial(1.0), radial(1.0 + 1e-4));
    for rounding in [-1e-12, 1e-12] {
        let rounded = radial(1.0 + rounding);
        // The weights of trials are found by bisection.
        assert!(rounded.n_points == found.n_points && (rounded.value / found.value - 1.0).abs() < 1e-8, "{rounded:?}");
    }
    assert!(beyond.n_points < found.n_points && radial(1.0 - 1e-4).n_points < found.n_points);
}

#[test]
fn scales_of_force_and_order_of_rows_do_not_matter() {
    let data = measurements(&TRUTH, &Plan::EXAMPLE);
    let mut other = Measurements::default();
    for trial in data.trials.iter().rev() {
        for point in trial.points.iter().rev() {
            let scaled = Measurement { force: 4.0 * point.force, sd: point.sd.map(|sd| 4.0 * sd), ..*point };
            other.add(trial.case, trial.name.clone(), scaled);
        }
    }
    let (found, scaled) = (fitted(&data, &Ranges::default()), fitted(&other, &Ranges::default()));
    let (a, b) = (found.youngs_modulus_pa, scaled.youngs_modulus_pa);
    let ends =
        |estimate: cohaul_paper::calibrate::Estimate| [estimate.value, estimate.interval.unwrap().low, estimate.interval.unwrap().high];
    for (a, b) in ends(a).into_iter().zip(ends(b)) {
        // tau^2 is found to the last bits by bisection, whose square root moves the weights by 1e-8
        // at most.
        assert!((4.0 * a / b - 1.0).abs() < 1e-8, "{a} {b}");
    }
    for (a, b) in found.cases.iter().zip(scaled.cases.iter().map(|fit| fit.goodness)) {
        assert!((a.goodness.reduced_chi_squared.unwrap() / b.reduced_chi_squared.unwrap() - 1.0).abs() < 1e-8);
    }
}

/// The linear law leaves a cubic term, the model none.
#[test]
fn a_bend_is_found_where_there_is_one() {
    let found = of(&Plan { n_trials: 6, ..Plan::EXAMPLE });
    let linear = found.linear.iter().find(|fit| fit.case == Case::Radial).unwrap();
    let bend = linear.goodness.bend.unwrap();
    assert!(bend.p_value < 0.01 && bend.force_n > 0.0 && bend.at == 1e-2, "{bend:?}");
    let model = found.cases.iter().find(|fit| fit.case == Case::Radial).unwrap();
    assert!(model.goodness.bend.unwrap().p_value > 0.05, "{model:?}");
}

#[test]
fn one_trial_has_no_interval_between_trials() {
    let found = of(&Plan { n_trials: 1, reach: [1e-2, 0.0, 0.0], ..Plan::EXAMPLE });
    let modulus = found.youngs_modulus_pa;
    assert_eq!((modulus.interval, modulus.between_trials_sd), (None, None));
    assert!(modulus.interval_within_trials.unwrap().low < modulus.value);
    assert!(found.warnings.iter().any(|warning| warning.contains("one trial")), "{:?}", found.warnings);
    assert_eq!(found.torsional_stiffness_nm_per_rad, None);
}

#[test]
fn forces_in_millinewtons_are_suspected() {
    let mut data = measurements(&TRUTH, &Plan::EXAMPLE);
    let points = data.trials.iter_mut().flat_map(|trial| &mut trial.points);
    points.for_each(|point| (point.force, point.sd) = (1e3 * point.force, point.sd.map(|sd| 1e3 * sd)));
    let found = fitted(&data, &Ranges::default());
    assert!(found.warnings.iter().any(|warning| warning.contains("are forces in N?")), "{:?}", found.warnings);
    assert!(!of(&Plan::EXAMPLE).warnings.iter().any(|warning| warning.contains("forces in N")));
}

#[test]
fn readings_that_no_spring_has_are_refused() {
    let refused = |force: f64, range: Option<[f64; 2]>| {
        let mut data = Measurements::default();
        for i in 1..5 {
            let at = 1e-3 * f64::from(i);
            data.add(Case::Radial, "1".to_owned(), Measurement { at, force: force * at, sd: None });
        }
        fit(&data, &Dimensions::default(), &Ranges { stretch: range, swing: None }, 0.95).unwrap_err()
    };
    assert!(refused(-0.6, None).contains("opposite signs"));
    assert!(refused(0.6, Some([5e-3, 6e-3])).contains("two points or more from 0.005 to 0.006 m, found 0"));
    assert!(refused(0.6, Some([0.0, 0.03])).contains("must end below 0.0238 m, found 0.03"));
    assert!(refused(1e306, None).contains("too large"));
    assert!(refused(0.0, None).contains("must be positive, found 0"));
}

#[test]
fn a_file_reads_back_as_it_was_written() {
    let data = measurements(&TRUTH, &Plan::EXAMPLE);
    let text = to_csv(&data, "one\ntwo");
    let again = Measurements::parse(&text, "text", &Dimensions::default()).unwrap();
    assert_eq!(to_csv(&again, "one\ntwo"), text);
    let with_mark = format!("\u{feff}{}", text.replace('\n', "\r\n"));
    assert_eq!(Measurements::parse(&with_mark, "text", &Dimensions::default()).unwrap(), again);
}

#[test]
fn the_example_is_what_its_seed_generates() {
    let file = crate::root::root().join("data/spring-calibration.csv");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.starts_with("# Generated, not measured"));
    let stored = Measurements::parse(&std::fs::read_to_string(&file).unwrap(), "stored", &Dimensions::default()).unwrap();
    let again =
        Measurements::parse(&to_csv(&measurements(&TRUTH, &Plan::EXAMPLE), EXAMPLE_COMMENT), "again", &Dimensions::default()).unwrap();
    assert_eq!(stored.trials.len(), again.trials.len());
    for (a, b) in stored.trials.iter().zip(&again.trials) {
        for (a, b) in a.points.iter().zip(&b.points) {
            // Another machine's sines may turn the last printed digit.
            assert!((a.force - b.force).abs() < 1.5e-8 && a.at == b.at && a.sd == b.sd);
        }
    }
    // What the file says of itself.
    let interval = fitted(&stored, &Ranges::default()).youngs_modulus_pa.interval.unwrap();
    assert!(interval.low < 1.66e6 && 1.66e6 < interval.high, "{interval:?}");
}

/// One trial to 10 mm beside five to 1.5 mm: information goes by the square of the stretch, so that
/// it has some 90 % of the weight. Alike, none has more than its part. Readings by the linear law
/// have one kappa, those by the model one E: each is told of by itself.
#[test]
fn a_trial_that_decides_alone_is_told() {
    let share = |reaches: &[f64], is_linear: bool| {
        let mut data = Measurements::default();
        for (trial, reach) in reaches.iter().enumerate() {
            for point in 1..=10 {
                let at = reach * f64::from(point) / 10.0;
                // Trials differ by 0.1 %, readings err by 0.1 mN.
                let force = (1.0 + 1e-3 * trial as f64) * if is_linear { 0.664 * at } else { TRUTH.radial_force(at) };
                data.add(Case::Radial, trial.to_string(), Measurement { at, force, sd: Some(1e-4) });
            }
        }
        let found = fitted(&data, &Ranges::default());
        let what = if is_linear { "case radial: one trial has " } else { "E: one trial has " };
        let n_told = found.warnings.iter().filter(|warning| warning.starts_with(what)).count();
        let estimate = if is_linear { found.linear[0].stiffness } else { found.youngs_modulus_pa };
        (estimate.largest_weight.unwrap(), n_told)
    };
    for is_linear in [true, false] {
        let (weight, n_told) = share(&[1e-2, 1.5e-3, 1.5e-3, 1.5e-3, 1.5e-3, 1.5e-3], is_linear);
        // (10 / 1.5)^2 = 44 to 5, tau^2 being zero; the model's force rises a little faster than
        // the stretch.
        assert!((0.89..0.92).contains(&weight) && n_told == 1, "{weight} {n_told}");
        let (weight, n_told) = share(&[1e-2; 6], is_linear);
        assert!((weight - 1.0 / 6.0).abs() < 1e-12 && n_told == 0, "{weight} {n_told}");
        // Of two, half is even.
        assert_eq!([share(&[1e-2, 1e-2], is_linear).1, share(&[1e-2, 1e-3], is_linear).1], [0, 1]);
    }
}

/// The example goes to 10 mm along the spring, to 0.8 rad to one side and to 0.5 rad to the other,
/// whatever ranges are asked for beyond.
#[test]
fn springs_are_known_as_far_as_readings_go_on_either_side() {
    let data = measurements(&TRUTH, &Plan::EXAMPLE);
    let [counter, clockwise] = [Case::TangentialTwo, Case::TangentialThree].map(|case| {
        let places = data.trials.iter().filter(|trial| trial.case == case).flat_map(|trial| &trial.points).map(|point| point.at);
        places.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap()
    });
    assert!(counter > 0.0 && clockwise < 0.0 && counter > 1.1 * clockwise.abs(), "{counter} {clockwise}");
    let known = |ranges: &Ranges| Sensor::paper().calibrated(&fitted(&data, ranges)).fitted_to;
    let whole = known(&Ranges::default());
    let edge = whole.stretch.unwrap();
    for known in [whole, known(&Ranges { stretch: Some([0.0, 1.5 * edge]), swing: Some([0.0, 0.9]) })] {
        let is_beyond = |stretch: f64, swing: f64| known.ends_before(stretch, swing);
        assert!(!is_beyond(edge, counter) && !is_beyond(-edge, clockwise), "{known:?}");
        assert!(is_beyond(1.01 * edge, 0.0) && is_beyond(0.0, 1.01 * counter) && is_beyond(0.0, 1.01 * clockwise), "{known:?}");
    }
    let short = known(&Ranges { stretch: Some([0.0, 0.8 * edge]), swing: None });
    assert!(short.ends_before(0.9 * edge, 0.0) && !short.ends_before(0.7 * edge, 0.0), "{short:?}");
}
