//! Verdicts on scenes whose truth is known: inertia scaled at fixed friction, a worse engine, both,
//! and neither.
//!
//! A tip pulls the load by one spring through its centre at a constant speed and stops. The paths
//! with and without inertia are known in closed form, and the engine runs alone beside them. The
//! expected verdict therefore needs no run of the comparison.

use std::path::Path;
use std::sync::Mutex;

use cohaul::analysis::TriggerKind;
use cohaul::analysis::compare::{Cause, Pathwise, Settings, SuggestedChange, ThreeWay, Verdict};
use cohaul::analysis::estimate::InertiaEstimate;
use cohaul::backend::{BackendKind, BackendOptions, RapierOptions, build, default_step};
use cohaul::math::Vec2;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Keep, Simulation, backend_of};

#[path = "common/causes.rs"]
mod causes;

use causes::sides;

/// Speed of the tip (m/s), and the time at which it stops (s).
const SPEED: f64 = 0.08;
const HOLD: f64 = 0.5;

/// The scene with mass and moment of inertia times a factor, and the same normal loads.
fn scene(mass_factor: f64) -> Scenario {
    let mut scenario = Scenario::read(Path::new("scenarios/analytic/ramp-and-hold.json")).unwrap();
    scenario.system.load.mass *= mass_factor;
    scenario.system.load.inertia *= mass_factor;
    scenario
}

/// Positions with and without inertia at `time` (s), in closed form. The load starts from rest when
/// the spring force reaches f, oscillates about the quasi-static path, and sticks where its speed
/// first becomes zero after the tip has stopped.
fn positions(scenario: &Scenario, time: f64) -> [f64; 2] {
    let stiffness = scenario.system.springs[0].radial_stiffness;
    let rate = (stiffness / scenario.system.load.mass).sqrt();
    let stretch = scenario.system.total_slip_limit() / stiffness;
    let onset = stretch / SPEED;
    if time <= onset {
        return [0.0, 0.0];
    }
    let driven = |time: f64| SPEED * (time - onset) - SPEED / rate * (rate * (time - onset)).sin();
    if time <= HOLD {
        return [driven(time), SPEED * time - stretch];
    }
    let still = SPEED * HOLD - stretch;
    let (offset, drift) = (driven(HOLD) - still, SPEED / rate * (1.0 - (rate * (HOLD - onset)).cos()));
    let phase = offset.atan2(drift) + rate * (time - HOLD);
    [still + offset.hypot(drift) * phase.min(std::f64::consts::FRAC_PI_2).sin(), still]
}

/// Largest edge displacements (m) by inertia and by an engine, over all ticks.
fn truth(scenario: &Scenario, rapier: RapierOptions) -> [f64; 2] {
    let step = default_step(BackendKind::Rapier, &scenario.system, scenario.control_period);
    let mut run = Simulation::new(scenario, &BackendOptions { rapier, ..BackendOptions::new(BackendKind::Rapier, step) }, Keep::Trace);
    run.run(|_| true);
    run.trace().rows.iter().fold([0.0f64; 2], |[inertia, engine], row| {
        let [with, without] = positions(scenario, row.time);
        let pose = row.motion.pose;
        let shift = (pose.position.x - with).hypot(pose.position.y);
        [inertia.max((with - without).abs()), engine.max(shift + scenario.system.load.radius * pose.heading.abs())]
    })
}

fn settings(rapier: RapierOptions) -> Settings {
    Settings { rapier, tolerance_share: 0.05, ..Settings::default() }
}

fn compared(scenario: &Scenario, settings: &Settings) -> Pathwise {
    ThreeWay::new(scenario, settings).prescribed(|_| true).unwrap()
}

#[test]
fn the_verdict_is_right_over_four_decades_of_inertia_with_a_good_and_a_bad_engine() {
    let mut seen = Vec::new();
    for mass_factor in [1e-3, 3e-3, 1e-2, 1e-1, 1.0, 10.0] {
        for rapier in [RapierOptions::default(), RapierOptions::engine_defaults()] {
            let scenario = scene(mass_factor);
            let [inertia, engine] = truth(&scenario, rapier);
            let found = compared(&scenario, &settings(rapier));
            let name = format!("mass times {mass_factor}, {rapier:?}: {inertia:e} {engine:e} {:?}", found.edge_displacement);
            // Up to the reference error.
            assert!(
                (found.edge_displacement.inertia_effect_m - inertia).abs() <= found.edge_displacement.reference_error_m + 1e-12,
                "{name}"
            );
            assert!((found.edge_displacement.engine_error_m - engine).abs() <= found.edge_displacement.reference_error_m + 1e-12, "{name}");
            assert!(found.edge_displacement.reference_error_m < 0.05 * found.tolerance_m, "{name}");
            let parts = |apart: f64| apart > found.tolerance_m;
            let causes: Vec<Cause> =
                [(Cause::Inertia, inertia), (Cause::Engine, engine)].into_iter().filter(|part| parts(part.1)).map(|part| part.0).collect();
            let verdict = match (parts(inertia), parts(engine)) {
                (false, false) => Verdict::Agree,
                (true, false) => Verdict::Inertia,
                (false, true) => Verdict::Engine,
                (true, true) => Verdict::InertiaAndEngine,
            };
            assert_eq!((found.verdict, sides(&found.causes)), (verdict, causes.clone()), "{name}");
            seen.push(causes);
        }
    }
    for causes in [vec![], vec![Cause::Inertia], vec![Cause::Engine], vec![Cause::Inertia, Cause::Engine]] {
        assert!(seen.contains(&causes), "{causes:?} occurs: {seen:?}");
    }
}

/// The path of an engine whose mass is wrong by a factor is that of the heavier load, in closed
/// form.
#[test]
fn the_error_of_an_own_engine_is_found() {
    const FACTOR: f64 = 1.5;
    let scenario = scene(0.1);
    let asked = Mutex::new(Vec::new());
    let wrong = |given: &Scenario, options: &BackendOptions| {
        asked.lock().unwrap().push(options.step_s);
        let mut system = given.system.clone();
        system.load.mass *= FACTOR;
        build(&system, given.start, &BackendOptions::new(BackendKind::Inertial, options.step_s))
    };
    let step = 2e-4;
    let found =
        ThreeWay::new(&scenario, &Settings { step_s: Some(step), ..Settings::default() }).engine(&wrong).prescribed(|_| true).unwrap();
    let mut asked = asked.into_inner().unwrap();
    asked.sort_by(f64::total_cmp);
    assert_eq!(asked, [step / 4.0, step / 2.0, step]);
    let heavier = scene(0.1 * FACTOR);
    let apart =
        found.solutions[1].points.iter().map(|point| (positions(&heavier, point.time)[0] - positions(&scenario, point.time)[0]).abs());
    let truth = apart.fold(0.0, f64::max);
    // The midpoint step of 0.2 ms is 0.03 rad of the oscillation. Its phase error is up to 0.03^2 /
    // 12 of the phase, which makes 1e-3 of the amplitude.
    assert!(
        (found.edge_displacement.engine_error_m - truth).abs() < 2e-3 * truth + found.edge_displacement.reference_error_m,
        "{:e} {truth:e}",
        found.edge_displacement.engine_error_m
    );
    assert!(found.causes.contains(&Cause::EngineModel), "{:?} {:?}", found.causes, found.edge_displacement);

    // Under replayed tips, a quasi-static engine has the inertia effect as its error, jumps
    // included.
    let ants = Scenario { duration: 3.0, ..Scenario::read(Path::new("scenarios/paper/four-ants-four-springs.json")).unwrap() };
    let without =
        |given: &Scenario, options: &BackendOptions| backend_of(given, &BackendOptions { kind: BackendKind::QuasiStatic, ..*options });
    let found = ThreeWay::new(&ants, &Settings::default()).engine(&without).replayed(|_| true).unwrap();
    assert!(
        found.edge_displacement.engine_error_m > 0.9 * found.edge_displacement.inertia_effect_m
            && found.edge_displacement.inertia_effect_m > 20.0 * found.edge_displacement.reference_error_m,
        "{:?}",
        found.edge_displacement
    );

    // In the closed loop, it repeats the quasi-static runs, seed by seed.
    let found =
        ThreeWay::new(&ants, &Settings { step_s: Some(1e-3), ..Settings::default() }).engine(&without).closed_loop(2, |_| true).unwrap();
    let [quasi_static, inertial, engine] = &found.traces[..] else { panic!("three backends") };
    assert_eq!(engine.rows, quasi_static.rows);
    assert_ne!(engine.rows, inertial.rows);
    assert!(found.measures.iter().flat_map(|measure| &measure.values).all(|[without, _, engine]| without == engine));
}

/// Paths are compared between ticks as well. The load oscillates about the quasi-static path while
/// the tip moves. Half a radian at most passes from one instant to the next, so that 1 - cos of
/// half of that, 3.1 % of an amplitude, can be missed.
#[test]
fn differences_between_ticks_are_found() {
    let scenario = Scenario { duration: HOLD, ..scene(0.1) };
    let apart: Vec<(f64, f64)> = (0..=50_000)
        .map(|at| {
            let [with, without] = positions(&scenario, 1e-5 * f64::from(at));
            (1e-5 * f64::from(at), (with - without).abs())
        })
        .collect();
    let largest = apart.iter().fold(0.0, |largest: f64, (_, apart)| largest.max(*apart));
    assert!(largest > 1.3 * apart.last().unwrap().1, "the end says too little");
    for control_period in [1e-3, 0.03, 0.1, 1.0] {
        let found = compared(&Scenario { control_period, ..scenario.clone() }, &settings(RapierOptions::default()));
        let (seen, own, between) =
            (found.edge_displacement.inertia_effect_m, found.edge_displacement.reference_error_m, found.sampled_every_s);
        let name = format!("{control_period}: {seen:e} of {largest:e}, every {between} s");
        assert!(seen <= largest + own && seen >= 0.969 * largest - own && between * scenario.system.fastest_rate() <= 0.5, "{name}");
        let parted = apart.iter().find(|(_, apart)| *apart > found.tolerance_m).unwrap().0;
        let late = found.first_divergence.inertia_effect.unwrap().time_s - parted;
        // Up to the time step of the closed form.
        assert!((-1e-5..=between + 1e-5).contains(&late), "{name}: {late} s after it");
    }
}

/// With aligned friction, the limit of rapier is the inertial path. Slip onsets, stops and pinnings
/// between nodes disturb the extrapolation, by 44 times the distance of two extrapolations in the
/// first scene and 37 times in the second.
#[test]
fn the_limit_of_an_engine_is_within_its_error() {
    for file in ["analytic/qs-ref-1", "analytic/release-jump", "analytic/ramp-and-hold", "paper/four-tips-held"] {
        let scenario = Scenario::read(Path::new(&format!("scenarios/{file}.json"))).unwrap();
        let [_, inertial, rapier] = compared(&scenario, &settings(RapierOptions::default())).solutions;
        for (exact, limit) in inertial.limit.iter().zip(&rapier.limit) {
            let (shift, turn) = ((limit.pose.position - exact.pose.position).norm(), (limit.pose.heading - exact.pose.heading).abs());
            let (shift_own, turn_own) = (limit.error.position + exact.error.position, limit.error.heading + exact.error.heading);
            let name = format!("{file} at {} s: {shift:e} {shift_own:e} {turn:e} {turn_own:e}", limit.time);
            // The error is an estimate, and a factor of two covers what it neglects. Rapier keeps a
            // load at rest to 1e-12 m.
            assert!(shift <= 2.0 * shift_own + 1e-11 && turn <= 2.0 * turn_own + 1e-9, "{name}");
        }
    }
}

/// A bad model, a heavy load, and neither: each cause has its own suggested change.
#[test]
fn each_cause_has_its_suggested_change() {
    let slow = compared(&scene(1e-3), &settings(RapierOptions::default()));
    assert_eq!((slow.verdict, &slow.suggested_changes[..]), (Verdict::Agree, &[][..]));

    let shipped = compared(&scene(1e-3), &settings(RapierOptions::engine_defaults()));
    assert_eq!((shipped.verdict, &shipped.suggested_changes[..]), (Verdict::Engine, &[SuggestedChange::OtherModel][..]));

    let heavy_scene = scene(10.0);
    let heavy = compared(&heavy_scene, &settings(RapierOptions::default()));
    let [SuggestedChange::SlowerTips { factor }] = heavy.suggested_changes[..] else { panic!("{:?}", heavy.suggested_changes) };
    // The lag is the speed over omega_n, and up to twice that where a tip stops. The slower tip
    // reaches two thirds of the tolerance from the quasi-static path length.
    let (largest, way) = (heavy.predicted.where_tips_stop_m.unwrap(), heavy.solutions[0].path_length(heavy_scene.system.load.radius));
    assert!(largest > heavy.edge_displacement.inertia_effect_m && (factor - 0.05 * way / largest / 1.5).abs() < 1e-12, "{factor}");
    let divergence = heavy.first_divergence.inertia_effect.unwrap();
    assert_eq!(divergence.trigger.unwrap().kind, TriggerKind::SlipOnset);
    // f / (k v).
    assert!((divergence.trigger.unwrap().time_s - 0.41367469880).abs() < 1e-3, "{divergence:?}");
}

/// Paths agree after the suggested changes: slower tips, more damping and less inertia, less
/// inertia with damped springs, and smaller steps of the engine.
#[test]
fn suggested_changes_help() {
    let release = |control_period: f64, damping_ratio: f64| {
        let mut scenario = Scenario::read(Path::new("scenarios/analytic/release-jump.json")).unwrap();
        scenario.control_period = control_period;
        scenario.system.springs.iter_mut().for_each(|spring| spring.damping_ratio = damping_ratio);
        scenario
    };
    let scenes = [(scene(10.0), 1), (scene(1.0), 2), (release(0.02, 0.0), 2), (release(0.02, 1.0), 1), (release(0.1, 1.0), 1)];
    for (scenario, n_suggested_changes) in scenes {
        let settings = Settings { tolerance_share: 0.01, ..settings(RapierOptions::default()) };
        let before = compared(&scenario, &settings);
        assert_eq!(before.suggested_changes.len(), n_suggested_changes, "{:?}", before.suggested_changes);
        for cause in &before.causes {
            let (mut scenario, mut settings) = (scenario.clone(), settings);
            let of_cause = |change: &&SuggestedChange| matches!(change, SuggestedChange::SmallerStep { .. }) == cause.is_of_engine();
            for change in before.suggested_changes.iter().filter(of_cause) {
                follow(change, &mut scenario, &mut settings);
            }
            let after = compared(&scenario, &settings);
            assert!(
                !after.causes.contains(cause),
                "{:?}: {cause:?} in {:?}, then {:?}",
                before.suggested_changes,
                before.edge_displacement,
                after.edge_displacement
            );
        }
    }
}

fn follow(change: &SuggestedChange, scenario: &mut Scenario, settings: &mut Settings) {
    match *change {
        SuggestedChange::SlowerTips { factor } => {
            let Drive::Tips(paths) = &mut scenario.drive else { panic!("tips drive it") };
            paths.iter_mut().flat_map(|path| &mut path.waypoints).for_each(|at| at.time /= factor);
            scenario.duration /= factor;
        }
        SuggestedChange::SpringDamping { damping_ratio } => {
            scenario.system.springs.iter_mut().for_each(|spring| spring.damping_ratio = damping_ratio)
        }
        SuggestedChange::SmallerStep { step_s } => settings.step_s = Some(step_s),
        _ => panic!("{change:?}"),
    }
}

/// Tolerances just below and just above the known effect: with a larger reference error the verdict
/// is inconclusive, and the suggestion is a smaller one.
#[test]
fn close_to_the_tolerance_the_verdict_needs_a_small_reference_error() {
    let scenario = scene(1.0);
    let [inertia, _] = truth(&scenario, RapierOptions::default());
    let way = compared(&scenario, &settings(RapierOptions::default())).path_length_m;
    let verdict = |hair: f64, tolerance: f64| {
        let tolerance_share = inertia / way * (1.0 + hair);
        compared(&scenario, &Settings { tolerance_share, reference_tolerance_m: Some(tolerance), ..settings(RapierOptions::default()) })
    };
    for (hair, expected) in [(1e-5, Verdict::Agree), (-1e-5, Verdict::Inertia)] {
        let open = verdict(hair, 1e-3);
        assert_eq!(open.verdict, Verdict::Inconclusive, "{:?}", open.edge_displacement);
        assert!(matches!(open.suggested_changes[..], [SuggestedChange::TighterTolerance { .. }]));
        assert_eq!(verdict(hair, 1e-8).verdict, expected);
    }
}

/// A spring at fifty times the slip limit pulls alone after the other one is released. Without
/// inertia the load jumps by 49 f / k and rests. With inertia and no damping it oscillates about
/// that point, by 4 f / k less each time: 98 + 94 + ... + 2 = 1250 f / k in all. The difference of
/// 49 f / k is 4 % of that path length, and half of the reach of 98 f / k.
#[test]
fn a_long_oscillation_does_not_enlarge_the_tolerance() {
    let mut scenario = Scenario::read(Path::new("scenarios/analytic/release-jump.json")).unwrap();
    let Drive::Tips(paths) = &mut scenario.drive else { panic!("tips") };
    paths.iter_mut().for_each(|path| path.waypoints.last_mut().unwrap().position *= 20.0);
    scenario.system.load.mass *= 1e-3;
    scenario.system.load.inertia *= 1e-3;
    let found = compared(&scenario, &settings(RapierOptions::default()));
    let stretch = scenario.system.total_slip_limit() / scenario.system.springs[0].radial_stiffness;
    let jump = 49.0 * stretch;
    let [without, with] = [&found.solutions[0], &found.solutions[1]].map(|solution| solution.path_length(scenario.system.load.radius));
    // Turning points between two instants are missed by up to 3 % of an amplitude.
    assert!((without / jump - 1.0).abs() < 1e-3 && (with / (1250.0 * stretch) - 1.0).abs() < 0.03, "{without} {with} {stretch}");
    assert!(
        (found.path_length_m / (2.0 * jump) - 1.0).abs() < 0.03 && found.verdict.has_inertia(),
        "{} {:?}",
        found.path_length_m,
        found.verdict
    );
    let estimated = InertiaEstimate::of(&scenario, &found.solutions[0].trace);
    assert!((estimated.path_length_m / found.path_length_m - 1.0).abs() < 0.05 && estimated.is_negligible == Some(false), "{estimated:?}");
}

/// Four ants cannot move a load of forty times the friction. Only rounding differs between the
/// backends, and rapier's speed has rounding of one sign only. With 56 seeds or more, the fraction
/// arrived is known to 5 %: z / (n + 2) with z = 2.865.
#[test]
fn backends_agree_on_a_load_that_does_not_move() {
    let mut scenario = Scenario::read(Path::new("scenarios/paper/four-ants-four-springs.json")).unwrap();
    scenario.system.ground.friction_coefficient *= 40.0;
    scenario.duration = 2.0;
    let over = |n_seeds| ThreeWay::new(&scenario, &settings(RapierOptions::default())).closed_loop(n_seeds, |_| true).unwrap();
    assert_eq!(over(55).verdict, Verdict::Inconclusive);
    let found = over(56);
    assert_eq!(found.verdict, Verdict::Agree, "{:?}", found.measures);
    assert_eq!((found.first_different_decision.quasi_static_s, found.first_different_decision.engine_s), (None, None));
    let speed = found.measures.iter().find(|measure| measure.name == "mean_speed_m_per_s").unwrap();
    assert!(speed.engine_error.is_equal && !speed.engine_error.excludes_zero && speed.engine.mean < 1e-18, "{speed:?}");
    assert!(found.measures.iter().any(|measure| measure.name == "pull_mean_n" && measure.inertial.mean > 1e-3), "they pull");
}

/// With 1e5 times the inertia at the same friction, no inertial run arrives in the time of the
/// quasi-static runs. No pair of runs has two times to compare, and the verdict still finds the
/// difference.
#[test]
fn a_backend_on_which_no_run_arrives_differs() {
    let mut scenario = Scenario::read(Path::new("scenarios/paper/four-ants-four-springs.json")).unwrap();
    scenario.system.load.mass *= 1e5;
    scenario.system.load.inertia *= 1e5;
    scenario.duration = 20.0;
    let Drive::Ants(drive) = &mut scenario.drive else { panic!("ants drive it") };
    (drive.nest_position, drive.arrival_radius) = (Vec2::new(0.02, -0.017), 0.02);
    let found = ThreeWay::new(&scenario, &settings(RapierOptions::default())).closed_loop(6, |_| true).unwrap();
    let arrived = found.measures.iter().find(|measure| measure.name == "fraction_arrived").unwrap();
    assert_eq!((arrived.quasi_static.mean, arrived.inertial.mean, arrived.engine.mean), (1.0, 0.0, 0.0));
    let engine = &arrived.engine_error;
    assert!(arrived.inertia_effect.excludes_zero && found.verdict == Verdict::Inertia, "{found:?}");
    assert!((engine.mean, engine.excludes_zero, engine.is_equal) == (0.0, false, false), "six seeds do not show that shares are equal");
}

/// Triggers are separated: a load that starts with speed coasts v^2 / (2 mu g) before a release
/// makes it overshoot. Each trigger has its suggested change. A spring at its rest shape moves
/// nothing when it is grasped, and is no trigger.
#[test]
fn coasting_and_overshooting_are_separated() {
    let mut scenario = Scenario::read(Path::new("scenarios/analytic/release-jump.json")).unwrap();
    scenario.control_period = 0.02;
    let settings = Settings { tolerance_share: 0.01, ..settings(RapierOptions::default()) };
    let still = compared(&scenario, &settings);
    assert!(
        still.edge_displacement.by_trigger.start_m == 0.0
            && still.edge_displacement.by_trigger.jumps_m == still.edge_displacement.inertia_effect_m,
        "{:?}",
        still.edge_displacement
    );

    let alone = Scenario::read(Path::new("scenarios/analytic/slide.json")).unwrap();
    let coasts = compared(&alone, &settings);
    let way = 0.5 * alone.system.load.mass * alone.start.twist.linear.norm_squared() / alone.system.total_slip_limit();
    let from = coasts.edge_displacement.by_trigger;
    // The reference error is at most a twentieth of the tolerance, which is 1 % of the path length.
    assert!((from.start_m - way).abs() <= 5e-4 * way && (from.jumps_m, from.driving_m) == (0.0, 0.0), "{from:?} {way}");
    assert_eq!(coasts.first_divergence.inertia_effect.unwrap().trigger.unwrap().kind, TriggerKind::Start);
    // Without inertia it does not move at all, which no start at less speed would do.
    assert!(!coasts.suggested_changes.iter().any(SuggestedChange::is_of_scene), "{:?}", coasts.suggested_changes);

    // A spring across the motion that pulls with a fiftieth of the slip limit from the beginning
    // does not change the coasting distance.
    let text = r#"{ "name": "held", "duration_s": 0.1, "control_period_s": 0.0025,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122, "velocity_m_per_s": [0.1, 0] },
        "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.0081333 } } },
        "springs": [{ "root_m": [0, 0], "bearing_rad": 0, "rest_length_m": 0, "radial_stiffness_n_per_m": 0.664, "torsional_stiffness_nm_per_rad": 0 }],
        "drive": { "kind": "tips", "paths": [{ "spring": 0, "waypoints": [[0, 0, 0.00066]] }] } }"#;
    let held = compared(&Scenario::parse(text, "held").unwrap(), &settings);
    let from = held.edge_displacement.by_trigger;
    // The spring changes the coasting distance by about k x / f, a hundredth.
    let way = 0.1f64.powi(2) / (2.0 * 1.4 * 9.81);
    assert!((from.start_m / way - 1.0).abs() < 0.01 && (from.jumps_m, from.driving_m) == (0.0, 0.0), "{from:?} {way}");
    assert_eq!(held.first_divergence.inertia_effect.unwrap().trigger.unwrap().kind, TriggerKind::Start);
    assert!(!held.suggested_changes.iter().any(SuggestedChange::is_of_scene), "{:?}", held.suggested_changes);

    scenario.start.twist.angular = 30.0;
    let both = compared(&scenario, &settings);
    let from = both.edge_displacement.by_trigger;
    assert!(from.start_m > both.tolerance_m && from.jumps_m > both.tolerance_m, "{from:?}");
    let is_there = |is: fn(&SuggestedChange) -> bool| both.suggested_changes.iter().any(is);
    assert!(
        is_there(|change| matches!(change, SuggestedChange::SlowerStart { .. }))
            && is_there(|change| matches!(change, SuggestedChange::SpringDamping { .. }))
    );
}
