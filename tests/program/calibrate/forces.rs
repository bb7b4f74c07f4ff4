use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::math::{Pose, RandomStreams, Stream, Summary, Vec2, direction, rotation};
use cohaul::model::PolarSpring;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation, Trace};
use cohaul_paper::calibrate::{Case, MOST_TURN, Recording, Sample, Sensor, Tip, summaries, tip_forces};
use cohaul_paper::colony;
use cohaul_paper::paper::Transport;

use super::generated::Plan;
use super::{TRUTH, of};

fn run(name: &str, duration: f64) -> (Scenario, Trace) {
    let file = crate::root::root().join("scenarios").join(name);
    let scenario = Scenario { duration, ..Scenario::read(&file).unwrap() };
    let options = BackendOptions::new(BackendKind::QuasiStatic, scenario.control_period);
    let mut run = Simulation::new(&scenario, &options, Keep::Trace);
    run.run(|_| true);
    let (trace, _) = run.into_results();
    (scenario, trace)
}

fn recorded(trace: &Trace) -> Recording {
    let of_row = |row: &cohaul::simulation::Row| {
        let (time, load) = (row.time, row.motion.pose);
        row.tips
            .iter()
            .map(move |tip| Sample { time, spring: tip.spring, tip: Tip::InWorld { load, tip: tip.position } })
            .collect::<Vec<_>>()
    };
    Recording { samples: trace.rows.iter().flat_map(of_row).collect() }
}

/// From where the tips were to what the backend says its holders did.
#[test]
fn forces_of_recorded_tips_are_those_that_the_run_recorded() {
    for (name, duration) in [("paper/four-ants-four-springs.json", 12.0), ("analytic/qs-ref-1.json", 1.0)] {
        let (scenario, trace) = run(name, duration);
        let sensor = Sensor::exact(scenario.system.springs.clone());
        let found = tip_forces(&recorded(&trace), &sensor);
        let pulls: Vec<_> = trace.rows.iter().flat_map(|row| &row.tips).collect();
        assert_eq!(found.len(), pulls.len());
        assert!(pulls.len() > 1000, "{name}: {}", pulls.len());
        for (force, held) in found.iter().zip(&pulls) {
            // Rounding of positions of order 0.1 m times 0.7 N/m.
            assert!((force.in_world.unwrap() - held.pull).norm() < 1e-15, "{name} at {}: {force:?}", force.time);
            assert!((force.size - held.pull.norm()).abs() < 1e-15);
        }
        let all = *summaries(&found, &sensor).last().unwrap();
        let largest = pulls.iter().map(|held| held.pull.norm()).fold(0.0, f64::max);
        assert!((all.max_n - largest).abs() < 1e-15 && all.spring.is_none() && all.n == pulls.len() as u64);
        assert!(largest > 1e-3, "{name}: {largest}");
    }
}

/// The same tip seen from the root and in the world, with the load anywhere.
#[test]
fn the_frame_of_a_recording_does_not_matter() {
    let spring = PolarSpring { root: Vec2::new(0.003, 0.0116), bearing: 1.4, ..Sensor::paper().springs[0] };
    let load = Pose::new(0.4, -0.3, 2.5);
    let tips = [Vec2::new(0.031, 0.004), Vec2::new(0.02, -0.015), Vec2::new(-0.01, 0.02)];
    let in_world = |tip: &Vec2| load.to_world(&(spring.root + rotation(spring.bearing) * tip));
    let recording = |of: &dyn Fn(&Vec2) -> Tip| Recording {
        samples: tips.iter().enumerate().map(|(i, tip)| Sample { time: i as f64, spring: 0, tip: of(tip) }).collect(),
    };
    let sensor = Sensor { tip_error: 1e-4, radial_error: 0.01, torsional_error: 1e-5, ..Sensor::exact(vec![spring]) };
    let near = tip_forces(&recording(&|tip| Tip::InRoot(*tip)), &sensor);
    let far = tip_forces(&recording(&|tip| Tip::InWorld { load, tip: in_world(tip) }), &sensor);
    for (a, b) in near.iter().zip(&far) {
        // Positions of order 0.5 m carry 1e-16, stiffnesses of order 1 N/m and an lever of 1/l make
        // it 1e-14 of the swing.
        assert!((a.radial - b.radial).abs() < 1e-14 && (a.tangential - b.tangential).abs() < 1e-14, "{a:?} {b:?}");
        assert!((a.size_sd / b.size_sd - 1.0).abs() < 1e-10, "{a:?} {b:?}");
        assert!(a.in_world.is_none() && b.in_world.is_some());
    }
}

#[test]
fn a_swing_is_followed_over_half_a_turn_and_begins_anew_after_a_gap() {
    let sensor = Sensor::paper();
    let at = |time: f64, swing: f64| Sample { time, spring: 3, tip: Tip::InRoot(0.03 * direction(swing)) };
    let turning: Vec<Sample> = (0..=40).map(|i| at(0.1 * f64::from(i), 0.1 * f64::from(i))).collect();
    let found = tip_forces(&Recording { samples: turning.clone() }, &sensor);
    assert!((found[40].shape.swing - 4.0).abs() < 1e-13);
    // Nobody holds it for a frame, in which another spring's tip is seen.
    let mut samples = turning;
    samples.push(Sample { spring: 0, ..at(4.1, 0.0) });
    samples.push(at(4.2, 4.0));
    let found = tip_forces(&Recording { samples }, &sensor);
    assert!((found[42].shape.swing - (4.0 - std::f64::consts::TAU)).abs() < 1e-13);
}

#[test]
fn eq_1_stands_beside_the_linear_law_as_far_as_it_reaches() {
    let sensor = Sensor::paper();
    let force = |stretch: f64| {
        let samples = vec![Sample { time: 0.0, spring: 0, tip: Tip::InRoot(Vec2::new(TRUTH.rest_length() + stretch, 0.0)) }];
        tip_forces(&Recording { samples }, &sensor)[0]
    };
    let reach = MOST_TURN.sin() * Case::Radial.limit(&TRUTH);
    for stretch in [-5e-3, 8e-3, reach - 1e-9] {
        let found = force(stretch);
        assert!((found.radial - 0.664 * stretch).abs() < 1e-16 && found.tangential == 0.0);
        // Rounding of the rest length is 3e-18 m, of slopes of up to 4 N/m there.
        assert!((found.radial_by_model.unwrap() - TRUTH.radial_force(stretch)).abs() < 1e-15);
    }
    // 0.664 N/m is the secant at 8 mm, to its last printed digit.
    assert!((force(8e-3).radial / force(8e-3).radial_by_model.unwrap() - 1.0).abs() < 1e-3);
    assert_eq!(force(reach + 1e-9).radial_by_model, None);
}

#[test]
fn tips_near_their_root_are_counted() {
    let sensor = Sensor::paper();
    let at = |share: f64| Sample { time: share, spring: 0, tip: Tip::InRoot(Vec2::new(share * TRUTH.rest_length(), 0.0)) };
    let found = tip_forces(&Recording { samples: [0.0, 0.0999, 0.1001, 1.0].map(at).to_vec() }, &sensor);
    assert_eq!(sensor.n_near_root(&found), 2);
    assert!(found.iter().all(|force| force.size.is_finite() && force.size_sd.is_finite()));
}

/// Many noisy tips and springs against the spread that is said of one.
#[test]
fn errors_of_tips_and_stiffnesses_spread_forces_as_said() {
    let exact = Sensor::paper();
    let (noise, radial_error, torsional_error) = (2e-4, 0.02, 1e-5);
    let sensor = Sensor { tip_error: noise, radial_error, torsional_error, ..exact.clone() };
    let tip = Vec2::new(0.034, 0.012);
    let one = |tip: Vec2, sensor: &Sensor| {
        tip_forces(&Recording { samples: vec![Sample { time: 0.0, spring: 0, tip: Tip::InRoot(tip) }] }, sensor)[0]
    };
    let streams = RandomStreams::new(11);
    let (mut by_tip, mut by_all) = (Summary::default(), Summary::default());
    for k in 0..20_000 {
        let moved = tip + noise * streams.normal_pair(Stream::Scene, 0, k);
        let stiffer = streams.normal_pair(Stream::Scene, 1, k);
        let spring = &exact.springs[0];
        let (radial, torsional) =
            (spring.radial_stiffness + radial_error * stiffer.x, spring.torsional_stiffness + torsional_error * stiffer.y);
        by_tip.add(one(moved, &exact).size);
        by_all.add(one(moved, &exact.clone().with_given(Some(radial), Some(torsional))).size);
    }
    let found = one(tip, &sensor);
    // A standard deviation of 20,000 draws is off by 0.5 %, and curvature over the noise is a
    // fraction of that; five of them.
    assert!((by_tip.sd() / found.tip_part - 1.0).abs() < 0.025, "{} {found:?}", by_tip.sd());
    assert!((by_all.sd() / found.size_sd - 1.0).abs() < 0.025, "{} {found:?}", by_all.sd());
    assert!(found.size_sd > 1.2 * found.tip_part);
}

/// Noise of tips averages out over frames, an error of the stiffness does not.
#[test]
fn the_mean_force_is_as_uncertain_as_the_calibration() {
    let found = of(&Plan { between_trials: 0.05, ..Plan::EXAMPLE });
    let sensor = Sensor { tip_error: 1e-4, ..Sensor::paper().calibrated(&found) };
    let tips = |i: u32| Tip::InRoot(Vec2::new(TRUTH.rest_length() + 1e-5 * f64::from(i), 0.0));
    let samples = (0..1000).map(|i| Sample { time: f64::from(i), spring: 0, tip: tips(i) }).collect();
    let summary = summaries(&tip_forces(&Recording { samples }, &sensor), &sensor)[0];
    let radial = found.radial_stiffness_n_per_m.unwrap();
    // Pulls along the spring: all of the error is that of kappa_rho.
    assert!((summary.mean_error_n / summary.mean_n / (radial.standard_error / radial.value) - 1.0).abs() < 1e-9, "{summary:?}");
    assert!((summary.mean_n / (radial.value * 4.995e-3) - 1.0).abs() < 1e-9);
}

/// Eq. (4) by hand over the pulls that the run recorded, beside what the recording of its tips
/// shows: the same window, and the same mean.
#[test]
fn a_recording_shows_the_interaction_forces_of_its_run() {
    let (scenario, trace) = run("paper/four-ants-four-springs.json", 40.0);
    let recording = recorded(&trace);
    let found = tip_forces(&recording, &Sensor::exact(scenario.system.springs.clone()));
    let rows = colony::recorded(&recording, &found).unwrap();
    let shown = Transport::of(&rows.rows, rows.period, None, 1).unwrap();
    let mut sizes: Vec<usize> = trace.rows.iter().map(|row| row.tips.len()).filter(|n| *n > 0).collect();
    sizes.sort_unstable();
    assert_eq!(shown.n_gathered, sizes[sizes.len() / 2]);
    let first = trace.rows.iter().find(|row| row.tips.len() == shown.n_gathered).unwrap();
    let [from, to] = shown.window_s;
    assert!((from - first.time).abs() < 1e-9 && to > 39.0, "{from} {to}");
    // A look every 20 ms, which are eight ticks.
    let within = trace.rows.iter().filter(|row| row.time > from - 1e-9 && row.time < to - 1e-9);
    let sums = within.step_by(8).map(|row| {
        let mut sum = 0.0;
        for (at, one) in row.tips.iter().enumerate() {
            for other in row.tips.iter().skip(at + 1) {
                let apart = one.position - other.position;
                sum += ((one.pull - other.pull).dot(&apart) / apart.norm()).abs();
            }
        }
        sum
    });
    let sums = Summary::of(sums);
    // Rounding of positions of 0.1 m times 0.7 N/m, over hundreds of looks.
    assert!((shown.interaction_n - sums.mean()).abs() < 1e-12 && sums.mean() > 1e-3, "{} {}", shown.interaction_n, sums.mean());
    let n_windows = shown.by_group_size.iter().map(|of| of.time_s).sum::<f64>() / 0.5;
    assert!((n_windows - (rows.rows.len() / 200) as f64).abs() < 1.5, "{n_windows}");
    assert!(shown.text().contains("pull from") && shown.series_table().rows.len() as f64 == n_windows.round());
}
