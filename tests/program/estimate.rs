//! The inertia estimate of quasi-static runs: known answers of one spring, scaling, invariance, and
//! no effect on the run itself.

#[path = "../common/random_scenes.rs"]
mod random_scenes;
#[path = "../common/root.rs"]
mod root;

use std::f64::consts::PI;

use cohaul::analysis::TriggerKind;
use cohaul::analysis::estimate::{CLEAR, InertiaEstimate, TOLERANCE_SHARE, with_estimate};
use cohaul::backend::{Backend, BackendKind, BackendOptions, Tolerance, TransitionKind, build};
use cohaul::math::{Twist, Vec2, rotation};
use cohaul::scenario::{Drive, Scenario, Waypoint};
use cohaul::simulation::{Keep, SavedRun, Simulation, controller_of};

use random_scenes::random_scenario;

fn scene(name: &str) -> Scenario {
    Scenario::read(&root::root().join(format!("scenarios/{name}.json"))).unwrap()
}

fn options(scenario: &Scenario) -> BackendOptions {
    BackendOptions::new(BackendKind::QuasiStatic, scenario.control_period)
}

/// Estimate of a run without a trace, as in `cohaul run`.
fn estimate(scenario: &Scenario) -> InertiaEstimate {
    estimate_by(scenario, &options(scenario))
}

/// The same of a run that is exact to 1e-8 of the load's radius.
fn exact_estimate(scenario: &Scenario) -> InertiaEstimate {
    let load = &scenario.system.load;
    estimate_by(scenario, &BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(1e-8 * load.radius, load)))
}

fn estimate_by(scenario: &Scenario, options: &BackendOptions) -> InertiaEstimate {
    let (backend, estimator) = with_estimate(&scenario.system, scenario.start, options);
    let mut run = Simulation::from_parts(scenario, options, Keep::Outcome, controller_of(scenario), backend);
    run.run(|_| true);
    estimator.borrow().estimate()
}

/// Natural frequency of the load on one spring (rad/s).
fn omega(scenario: &Scenario) -> f64 {
    (scenario.system.springs[0].radial_stiffness / scenario.system.load.mass).sqrt()
}

fn with_mass(scenario: &Scenario, factor: f64) -> Scenario {
    let mut scenario = scenario.clone();
    scenario.system.load.mass *= factor;
    scenario.system.load.inertia *= factor;
    scenario
}

/// Time from the release of `analytic/release-jump` to its end (s).
const RELEASED: f64 = 1.0;

fn assert_near(found: f64, expected: f64, relative: f64) {
    assert!((found / expected - 1.0).abs() < relative, "{found} is not {expected}");
}

/// A slip onset at the speed v gives x - x_qs = -(v / omega) sin(omega t).
#[test]
fn an_onset_swings_by_speed_over_omega() {
    let scenario = scene("analytic/centre-pull");
    let found = estimate(&scenario);
    // Rows meet the crest to omega h / 2 = 0.01 rad, which makes 5e-5 of the amplitude.
    assert_near(found.edge_displacement_max_m, 0.005 / omega(&scenario), 1e-4);
    assert_eq!(
        (found.largest.unwrap().trigger.kind, found.by_trigger.jumps_m, found.by_trigger.start_m),
        (TriggerKind::SlipOnset, 0.0, 0.0)
    );
    // It is 0.37 % of the path, too near to 1 %.
    assert_eq!(found.is_negligible, None);
}

/// A tip that moves twice as fast from t_1 on starts a second oscillation beside that of the onset
/// at t_0: together up to 2 (v / omega) |cos(omega (t_1 - t_0) / 2)|.
#[test]
fn a_tip_that_changes_its_speed_starts_an_oscillation() {
    let scenario = scene("analytic/centre-pull");
    let (speed, omega) = (0.005, omega(&scenario));
    let onset = scenario.system.total_slip_limit() / scenario.system.springs[0].radial_stiffness / speed;
    for phase in [0.8, 1.0, 5.5] {
        let (mut scenario, corner) = (scenario.clone(), onset + (6.0 * PI + phase) / omega);
        let Drive::Tips(paths) = &mut scenario.drive else { panic!("a scene with prescribed tips") };
        let last = paths[0].waypoints.last_mut().unwrap();
        let (end, middle) = (last.time, Vec2::new(speed * corner, 0.0));
        last.position = middle + Vec2::new(2.0 * speed * (end - corner), 0.0);
        let turn = Waypoint { time: corner, position: middle };
        paths[0].waypoints.insert(1, turn);
        // Crests are found to 0.33^4 / 384 = 3e-5, as for the onset alone.
        assert_near(estimate(&scenario).edge_displacement_max_m, 2.0 * speed / omega * (0.5 * phase).cos().abs(), 1e-4);
    }
}

/// A tip that stops after the load slipped for tau leaves it 2 (v / omega) |sin(omega tau / 2)|
/// further than without inertia.
#[test]
fn a_stop_after_a_ramp_lets_the_load_coast() {
    let scenario = scene("analytic/ramp-and-hold");
    let (speed, limit) = (0.08, scenario.system.total_slip_limit());
    let slipping = 0.5 - limit / scenario.system.springs[0].radial_stiffness / speed;
    let found = estimate(&scenario);
    // The oscillator is exact; quasi-static rows round to 1e-12 m in 5 mm.
    assert_near(found.edge_displacement_final_m, 2.0 * speed / omega(&scenario) * (0.5 * omega(&scenario) * slipping).sin().abs(), 1e-6);
    assert_eq!(found.is_negligible, Some(false));
}

/// A release at 2.5 times the slip limit moves the load by 1.5 f / k without inertia, and twice as
/// far with any mass. With damping the factor is 1 + exp(-pi zeta / sqrt(1 - zeta^2)), and the load
/// without inertia relaxes as 1 - exp(-omega t / (2 zeta)).
#[test]
fn a_jump_overshoots_by_its_own_length_and_less_with_damping() {
    let mut scenario = scene("analytic/release-jump");
    let jump = 1.5 * scenario.system.total_slip_limit() / scenario.system.springs[0].radial_stiffness;
    let found = estimate(&scenario);
    assert_near(found.edge_displacement_final_m, jump, 1e-6);
    assert_eq!((found.largest.unwrap().trigger.kind, found.largest.unwrap().trigger.spring), (TriggerKind::Release, Some(1)));
    assert_near(estimate(&with_mass(&scenario, 0.1)).edge_displacement_final_m, jump, 1e-6);
    for zeta in [0.2, 0.6] {
        scenario.system.springs.iter_mut().for_each(|spring| spring.damping_ratio = zeta);
        let rate = (1.0f64 - zeta * zeta).sqrt();
        let overshoot = (-PI * zeta / rate).exp();
        let relaxing = |angle: f64| (-angle / (2.0 * zeta)).exp();
        let (end, found) = (omega(&scenario) * RELEASED, exact_estimate(&scenario));
        assert_near(found.edge_displacement_final_m, (overshoot + relaxing(end)) * jump, 1e-6);
        // At first the load with inertia is behind.
        let swinging = |angle: f64| (-zeta * angle).exp() * ((rate * angle).cos() + zeta / rate * (rate * angle).sin());
        let behind = |at: u32| swinging(1e-3 * f64::from(at)) - relaxing(1e-3 * f64::from(at));
        let most = (0..3000).map(behind).fold(0.0, f64::max).max(overshoot);
        // Crests are looked for in intervals of a third of a radian.
        assert_near(found.edge_displacement_max_m, most * jump, 1e-2);
    }
    // An overdamped load approaches the balance; after a second only the slow mode is left.
    scenario.system.springs.iter_mut().for_each(|spring| spring.damping_ratio = 2.0);
    let slow = 2.0 - 3f64.sqrt();
    let end = omega(&scenario) * RELEASED;
    let left = (-end * slow).exp() * (2.0 + 3f64.sqrt()) / (2.0 * 3f64.sqrt());
    assert_near(exact_estimate(&scenario).edge_displacement_final_m, (left - (-end / 4.0).exp()).abs() * jump, 1e-6);
}

/// Friction dissipates the initial energy over v^2 / (2 mu g), or omega^2 I / (2 f a) for a spin.
#[test]
fn a_start_with_speed_coasts() {
    let slide = scene("analytic/slide");
    let speed = slide.start.twist.linear.norm();
    assert_near(estimate(&slide).edge_displacement_final_m, speed * speed / (2.0 * 1.4 * 9.81), 1e-9);
    assert_eq!(estimate(&slide).largest.unwrap().trigger.kind, TriggerKind::Start);
    let spin = scene("analytic/spin");
    let support = spin.system.ground.supports[0].offset.norm();
    let turn = spin.system.load.inertia * spin.start.twist.angular.powi(2) / (2.0 * spin.system.total_slip_limit() * support);
    assert_near(estimate(&spin).edge_displacement_final_m, spin.system.load.radius * turn, 1e-9);
}

/// A load that starts across a pull just above the slip limit jumps by a micrometre without
/// inertia. The jump does not change the speed of the load with inertia. That load moves further
/// than without a spring, because the pull turns its slip.
#[test]
fn a_short_jump_leaves_a_load_its_speed() {
    let text = r#"{ "name": "across", "duration_s": 0.5, "control_period_s": 0.0025,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122, "velocity_m_per_s": [0.1, 0] },
        "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.0081333 } } },
        "springs": [{ "root_m": [0, 0], "bearing_rad": 0, "rest_length_m": 0, "radial_stiffness_n_per_m": 0.664, "torsional_stiffness_nm_per_rad": 0 }],
        "drive": { "kind": "tips", "paths": [{ "spring": 0, "waypoints": [[0, 0, 0]] }] } }"#;
    let scenario = Scenario::parse(text, "across").unwrap();
    let stretch = scenario.system.total_slip_limit() / scenario.system.springs[0].radial_stiffness;
    let coasting = 0.1f64.powi(2) / (2.0 * 1.4 * 9.81);
    for beyond in [-1e-6, 1e-6, 1e-4] {
        let mut scenario = scenario.clone();
        let Drive::Tips(paths) = &mut scenario.drive else { panic!("a scene with prescribed tips") };
        paths[0].waypoints[0].position.y = stretch + beyond;
        let found = estimate(&scenario);
        // The inertial backend gives 2.48 mm each.
        assert!(found.edge_displacement_max_m > coasting && found.edge_displacement_max_m < 2.5e-3, "{beyond}: {found:?}");
    }
}

/// At fixed friction the oscillation after a slip onset grows with the square root of the mass.
#[test]
fn onsets_scale_with_the_root_of_the_mass_at_fixed_friction() {
    let scenario = scene("analytic/centre-pull");
    let ratio = estimate(&with_mass(&scenario, 4.0)).edge_displacement_max_m / estimate(&scenario).edge_displacement_max_m;
    // Crests between rows: 5e-5 each.
    assert!((ratio - 2.0).abs() < 2e-4, "{ratio}");
}

#[test]
fn a_load_that_never_moves_is_estimated_to_stay() {
    let found = estimate(&scene("stress/hold-below-limit"));
    assert_eq!((found.edge_displacement_max_m, found.path_length_m, found.share), (0.0, 0.0, 0.0));
    assert!(found.is_negligible == Some(true) && found.largest.is_none());
}

/// A rotated and translated scene gives the same estimate.
#[test]
fn a_rigid_motion_of_the_scene_changes_nothing() {
    for seed in [8, 28, 82] {
        let scenario = random_scenario(seed);
        let (turn, shift) = (rotation(0.7), Vec2::new(0.11, -0.23));
        let mut moved = scenario.clone();
        moved.start.pose.position = turn * scenario.start.pose.position + shift;
        moved.start.pose.heading += 0.7;
        moved.start.twist = Twist { linear: turn * scenario.start.twist.linear, ..scenario.start.twist };
        let Drive::Tips(paths) = &mut moved.drive else { panic!("a scene with prescribed tips") };
        paths.iter_mut().flat_map(|path| &mut path.waypoints).for_each(|at| at.position = turn * at.position + shift);
        let (here, there) = (estimate(&scenario), estimate(&moved));
        // Rounding of positions, 1e-17 m, may grow over thousands of stick and slip events.
        assert!((there.edge_displacement_max_m / here.edge_displacement_max_m - 1.0).abs() < 1e-6, "{seed}: {here:?} {there:?}");
        assert_ne!(here.edge_displacement_max_m, 0.0);
    }
}

/// The measured inertia effect is 1.492 mm in the reference scene and 5.843 mm in the heavy one.
#[test]
fn scenes_without_a_closed_form_are_estimated_within_a_quarter() {
    assert_near(estimate(&scene("analytic/qs-ref-1")).edge_displacement_max_m, 1.492e-3, 0.25);
    assert_near(estimate(&scene("stress/heavy")).edge_displacement_max_m, 5.843e-3, 0.25);
}

#[test]
fn an_estimate_does_not_change_the_run_and_agrees_with_that_from_the_trace() {
    for seed in [8, 17, 28] {
        let scenario = random_scenario(seed);
        let (watched, estimator) = with_estimate(&scenario.system, scenario.start, &options(&scenario));
        let run = |backend: Box<dyn Backend>| {
            let mut run = Simulation::from_parts(&scenario, &options(&scenario), Keep::Trace, controller_of(&scenario), backend);
            run.run(|_| true);
            run.into_results()
        };
        let (trace, outcome) = run(watched);
        let (plain, plain_outcome) = run(build(&scenario.system, scenario.start, &options(&scenario)));
        assert_eq!((&trace, &outcome), (&plain, &plain_outcome));
        let (as_run, of_trace) = (estimator.borrow().estimate(), InertiaEstimate::of(&scenario, &trace));
        // A trace shows grasps, releases and turns at its rows only, which is a small part of a
        // period later.
        let apart = (as_run.edge_displacement_max_m - of_trace.edge_displacement_max_m).abs();
        assert!(apart <= 0.1 * as_run.edge_displacement_max_m, "{seed}: {apart} {as_run:?} {of_trace:?}");
    }
}

#[test]
fn an_estimate_goes_on_from_a_saved_run_bit_for_bit() {
    let scenario = random_scenario(28);
    let whole = estimate(&scenario);
    let (backend, _) = with_estimate(&scenario.system, scenario.start, &options(&scenario));
    let mut run = Simulation::from_parts(&scenario, &options(&scenario), Keep::Outcome, controller_of(&scenario), backend);
    run.run(|time| time < 0.5 * scenario.duration);
    let saved: SavedRun = serde_json::from_str(&serde_json::to_string(&run.save().unwrap()).unwrap()).unwrap();
    let (backend, estimator) = with_estimate(&scenario.system, scenario.start, &options(&scenario));
    let mut resumed = Simulation::resume_from_parts(&scenario, &saved, Keep::Outcome, controller_of(&scenario), backend).unwrap();
    resumed.run(|_| true);
    assert_eq!(estimator.borrow().estimate(), whole);
    // A state without an estimate cannot be resumed with one; a plain run resumes from either
    // state.
    let mut plain = Simulation::new(&scenario, &options(&scenario), Keep::Outcome);
    plain.run(|time| time < 0.5 * scenario.duration);
    let (backend, _) = with_estimate(&scenario.system, scenario.start, &options(&scenario));
    let error = Simulation::resume_from_parts(&scenario, &plain.save().unwrap(), Keep::Outcome, controller_of(&scenario), backend)
        .err()
        .unwrap()
        .to_string();
    assert!(error.contains("without an inertia estimate"), "{error}");
    assert!(Simulation::resume(&scenario, &saved, Keep::Outcome).is_ok());
}

/// Attachments of half a minute wind the load about its tips, and the paths with and without
/// inertia separate for good. The model stays within the size of the scene, as the inertial load
/// does.
#[test]
fn a_model_far_from_the_load_stays_within_the_scene() {
    let file = include_str!("../../scenarios/paper/four-ants-four-springs.json");
    let text = file.replace("\"kind\": \"ants\"", "\"kind\": \"ants\", \"release_decision_period_s\": 30");
    for seed in [0, 6] {
        let scenario = Scenario { duration: 60.0, seed, ..Scenario::parse(&text, "long holds").unwrap() };
        let found = estimate(&scenario);
        assert!(found.is_negligible == Some(false) && found.edge_displacement_max_m > 0.05, "{seed}: {found:?}");
        // Measured: 0.3 m each. The nest is 0.26 m away, and springs reach about 0.1 m.
        assert!(found.edge_displacement_max_m < 1.0, "{seed}: {found:?}");
    }
}

/// The share of a slip onset is (v / omega) over the path length: a larger mass crosses the
/// tolerance. Within a factor of [`CLEAR`] of it the estimate does not decide.
#[test]
fn inertia_is_negligible_well_below_the_tolerance_and_not_well_above() {
    let scenario = scene("analytic/centre-pull");
    let way = estimate(&scenario).path_length_m;
    let mass_at_threshold =
        (TOLERANCE_SHARE * way / 0.005).powi(2) * scenario.system.springs[0].radial_stiffness / scenario.system.load.mass;
    // Crests are found to 5e-5 of the amplitude, and the path length includes the end of the
    // oscillation.
    let at = |share: f64| estimate(&with_mass(&scenario, share.powi(2) * mass_at_threshold)).is_negligible;
    assert_eq!([0.9 / CLEAR, 1.1 / CLEAR, 0.9 * CLEAR, 1.1 * CLEAR].map(at), [Some(true), None, None, Some(false)]);
}

fn call(args: &[&str]) -> (String, String) {
    let output = root::cohaul().args(args).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{args:?}");
    (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn the_program_prints_the_estimate_and_warns_where_it_matters() {
    let (jump, pull) = ("scenarios/analytic/release-jump.json", "scenarios/analytic/centre-pull.json");
    let (out, warning) = call(&["run", jump, "--json"]);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    let found = &value["inertia_estimate"];
    assert_eq!(found["is_negligible"], false);
    assert_eq!((&found["largest"]["trigger"]["kind"], &found["largest"]["trigger"]["spring"]), (&"release".into(), &1.into()));
    let expected = estimate(&scene("analytic/release-jump"));
    assert_eq!(found["edge_displacement_max_m"].as_f64(), Some(expected.edge_displacement_max_m));
    assert!(warning.starts_with("warning: inertia is not negligible here") && warning.lines().count() == 1, "{warning}");
    let (out, silence) = call(&["run", pull]);
    let (_, warning) = call(&["run", pull, "--json"]);
    assert!(
        out.replace('\n', " ").contains("Whether inertia is negligible is not known: by estimate it moves the load by up to ")
            && silence.is_empty(),
        "{out}{silence}"
    );
    assert!(warning.starts_with("warning: inertia may not be negligible here") && warning.lines().count() == 1, "{warning}");
    // Less than a third of the mass at the same friction has little more than half of the effect.
    let light = format!("{}/light-pull.json", env!("CARGO_TARGET_TMPDIR"));
    let text = std::fs::read_to_string(root::root().join(pull)).unwrap().replace("0.0016", "0.0005").replace("1.4,", "4.48,");
    std::fs::write(&light, text).unwrap();
    let (out, silence) = call(&["run", &light]);
    assert!(
        out.replace('\n', " ").contains("Inertia is negligible: by estimate it moves the load by up to ") && silence.is_empty(),
        "{out}{silence}"
    );
    for without in [&["run", jump, "--json", "--no-estimate"][..], &["run", jump, "--json", "--backend", "inertial"]] {
        let (out, silence) = call(without);
        assert!(!out.contains("inertia_estimate") && silence.is_empty(), "{without:?}");
    }
}

/// Among obstacles the estimate is the same from the run and from its trace, and the same whether a
/// wall that the load never touches is there or not, up to the long steps beside it.
#[test]
fn an_estimate_among_obstacles_knows_the_load_that_touches_them() {
    let near = scene("contact/wall-slide");
    let mut far = near.clone();
    far.system.world.obstacles[0].path.waypoints[0].1.position.y -= 1.0;
    let mut empty = near.clone();
    empty.system.world.obstacles.clear();
    let found = estimate(&near);
    let mut run =
        Simulation::from_parts(&near, &options(&near), Keep::Trace, controller_of(&near), build(&near.system, near.start, &options(&near)));
    run.run(|_| true);
    let of_trace = InertiaEstimate::of(&near, &run.into_results().0);
    assert!(found.touches_obstacle && of_trace.touches_obstacle);
    assert_near(found.edge_displacement_max_m, of_trace.edge_displacement_max_m, 1e-9);
    let [far, empty] = [&far, &empty].map(estimate);
    assert!(
        !far.touches_obstacle && (far.edge_displacement_max_m / empty.edge_displacement_max_m).ln().abs() < 2.0f64.ln(),
        "{far:?} {empty:?}"
    );
}

/// The overshoot after a jump of 1.5 f / k is as long again; a wall ends it where it stands.
#[test]
fn an_estimate_ends_where_the_load_with_inertia_meets_an_obstacle() {
    let system = scene("analytic/release-jump").system;
    let jump = 1.5 * system.total_slip_limit() / system.springs[0].radial_stiffness;
    let with_wall_at = |x: f64| {
        let mut text: serde_json::Value = serde_json::from_str(include_str!("../../scenarios/analytic/release-jump.json")).unwrap();
        text["obstacles"] = serde_json::json!([{ "name": "wall", "outline": { "polyline": { "points_m": [[x, -1.0], [x, 1.0]] } } }]);
        estimate(&Scenario::parse(&text.to_string(), "jump before a wall").unwrap())
    };
    let (stopped, free) = (with_wall_at(system.load.radius + 1.5 * jump), with_wall_at(system.load.radius + 2.5 * jump));
    assert!(stopped.touches_obstacle && !free.touches_obstacle);
    assert_near(stopped.edge_displacement_final_m / jump, 0.5, 1e-3);
    // Steps of 0.05 rad damp the overshoot by up to 8 %.
    assert_near(free.edge_displacement_final_m / jump, 1.0, 0.1);
}

/// A load that moves in one jump only, one that never jumps, and four ants: there the same share
/// from the rows and the transitions of a trace.
#[test]
fn jumps_have_their_share_of_the_path() {
    assert_near(estimate(&scene("analytic/release-jump")).jump_share, 1.0, 1e-12);
    assert_eq!(estimate(&scene("analytic/centre-pull")).jump_share, 0.0);
    let mut scenario = scene("paper/four-ants-four-springs");
    scenario.duration = 30.0;
    let mut run = Simulation::new(&scenario, &options(&scenario), Keep::Trace);
    run.run(|_| true);
    let (trace, radius) = (run.trace(), scenario.system.load.radius);
    let path: f64 = trace.rows.windows(2).map(|rows| rows[1].motion.pose.edge_displacement(&rows[0].motion.pose, radius)).sum();
    let jumps = trace.transitions.iter().filter_map(|transition| match transition.kind {
        TransitionKind::Jump { shift, turn, .. } => Some(shift + radius * turn.abs()),
        _ => None,
    });
    let share = estimate(&scenario).jump_share;
    // The estimate merges ticks, so that its path is shorter by the bends within them: 3e-5.
    assert_near(share, jumps.sum::<f64>() / path, 1e-3);
    assert!((0.1..0.9).contains(&share), "{share}");
}
