//! Verdicts on loads among obstacles whose truth is known: by runs under a much tighter tolerance,
//! and over three decades of speed by closed formulas.

use std::path::Path;

use cohaul::analysis::compare::{Cause, Pathwise, Settings, ThreeWay, Verdict};
use cohaul::backend::{BackendKind, BackendOptions, RapierOptions, Tolerance, TransitionKind};
use cohaul::math::{Pose, Vec2};
use cohaul::model::{Obstacle, ObstaclePath, Outline};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Keep, Simulation, Trace, backend_of, controller_of};
use rayon::prelude::*;

#[path = "common/causes.rs"]
mod causes;

use causes::sides;

/// Tolerance of the verdict over the path length (1).
const SHARE: f64 = 0.05;
/// Tolerance of the tight runs over that of the verdict (1). Those of a comparison have 0.025.
const TIGHT: f64 = 1e-4;
/// Error that the reference error may leave out, over the tolerance of the verdict (1).
const NEGLECTED: f64 = 2e-3;

fn read(name: &str) -> Scenario {
    Scenario::read(Path::new(&format!("scenarios/{name}.json"))).unwrap()
}

/// Mass and moment of inertia times a factor, under the same normal loads.
fn with_mass(mut scenario: Scenario, factor: f64) -> Scenario {
    scenario.system.load.mass *= factor;
    scenario.system.load.inertia *= factor;
    scenario
}

fn settings(rapier: RapierOptions) -> Settings {
    Settings { rapier, tolerance_share: SHARE, ..Settings::default() }
}

/// Trace of one backend with rows at the instants of a comparison.
fn trace(scenario: &Scenario, options: &BackendOptions, n_parts: u64) -> Trace {
    let start = |options: &BackendOptions| {
        Simulation::from_parts(scenario, options, Keep::Trace, controller_of(scenario), backend_of(scenario, options))
            .with_rows_per_period(n_parts)
    };
    let mut run = start(options);
    if options.tolerance.is_some() {
        run.run_to_tolerance(start, |_| true)
    } else {
        run.run(|_| true)
    }
    run.into_results().0
}

/// Largest edge displacement (m) between two traces, outside the instants that `is_left_out`.
fn apart(a: &Trace, b: &Trace, radius: f64, is_left_out: impl Fn(f64) -> bool) -> f64 {
    assert_eq!(a.rows.len(), b.rows.len());
    let pairs = a.rows.iter().zip(&b.rows).filter(|(a, _)| !is_left_out(a.time));
    pairs.map(|(a, b)| a.motion.pose.edge_displacement(&b.motion.pose, radius)).fold(0.0, f64::max)
}

/// Inertia effect and engine error (m) by runs of their own, at the instants of the comparison and
/// at its step of the engine. The instants within a control period after a jump do not count.
fn truth(scenario: &Scenario, found: &Pathwise, rapier: RapierOptions) -> [f64; 2] {
    let n_parts = (scenario.control_period / found.sampled_every_s).round() as u64;
    let tolerance = Tolerance::at_edge(TIGHT * found.tolerance_m, &scenario.system.load);
    let exact = |kind| trace(scenario, &BackendOptions::within(kind, tolerance), n_parts);
    let (quasi_static, inertial) = (exact(BackendKind::QuasiStatic), exact(BackendKind::Inertial));
    let step = found.solutions[2].step_s.unwrap();
    let engine = trace(scenario, &BackendOptions { rapier, ..BackendOptions::new(BackendKind::Rapier, step) }, n_parts);
    let radius = scenario.system.load.radius;
    let jumps: Vec<f64> = quasi_static
        .transitions
        .iter()
        .filter(|transition| matches!(transition.kind, TransitionKind::Jump { .. }))
        .map(|jump| jump.time)
        .collect();
    let follows_a_jump = |time: f64| jumps.iter().any(|jump| (0.0..0.999 * scenario.control_period).contains(&(time - jump)));
    [apart(&inertial, &quasi_static, radius, follows_a_jump), apart(&engine, &inertial, radius, |_| false)]
}

fn expected([inertia, engine]: [f64; 2], tolerance: f64) -> (Verdict, Vec<Cause>) {
    let causes = [(Cause::Inertia, inertia), (Cause::Engine, engine)].into_iter().filter(|part| part.1 > tolerance).map(|part| part.0);
    let verdict = match (inertia > tolerance, engine > tolerance) {
        (false, false) => Verdict::Agree,
        (true, false) => Verdict::Inertia,
        (false, true) => Verdict::Engine,
        (true, true) => Verdict::InertiaAndEngine,
    };
    (verdict, causes.collect())
}

/// The verdict and the causes are those of runs under a tolerance that is 250 times tighter, for
/// loads of full and of little inertia, and for both settings of the engine.
#[test]
fn verdicts_at_obstacles_are_those_of_much_tighter_runs() {
    let (recommended, defaults) = (RapierOptions::default(), RapierOptions::engine_defaults());
    let scenes = [
        ("wall-slide", 1.0, recommended),
        ("box-wall-friction", 1e-2, recommended),
        ("box-wall-friction", 1.0, defaults),
        ("post-arc", 1e-2, recommended),
        ("post-arc", 1e-2, defaults),
        ("notch-jam", 1.0, recommended),
        ("box-lift", 1e-2, recommended),
        ("box-lift", 1.0, recommended),
        ("disc-roll-slip", 1.0, recommended),
        ("posts-gap", 1.0, recommended),
        ("rebound", 1.0, recommended),
        ("oblique-impact", 1.0, recommended),
        ("oblique-rebound", 1.0, defaults),
        ("jump-to-wall", 1.0, recommended),
        ("jump-and-rebound", 1.0, recommended),
        ("pusher", 1.0, recommended),
    ];
    let seen: Vec<Vec<Cause>> = scenes
        .into_par_iter()
        .map(|(name, mass_factor, rapier)| {
            let scenario = with_mass(read(&format!("contact/{name}")), mass_factor);
            let found = ThreeWay::new(&scenario, &settings(rapier)).prescribed(|_| true).unwrap();
            let truth = truth(&scenario, &found, rapier);
            let edge = &found.edge_displacement;
            let what = format!("{name}, mass times {mass_factor}, {:?}: {truth:?} {edge:?}", rapier.settings);
            // The reference error is an estimate. What it neglects is far below the tolerance.
            let allowed = edge.reference_error_m.max(NEGLECTED * found.tolerance_m);
            assert!(edge.reference_error_m < 0.05 * found.tolerance_m, "{what}");
            assert!((edge.inertia_effect_m - truth[0]).abs() <= allowed && (edge.engine_error_m - truth[1]).abs() <= allowed, "{what}");
            let (verdict, causes) = expected(truth, found.tolerance_m);
            assert_eq!((found.verdict, sides(&found.causes)), (verdict, causes.clone()), "{what}");
            causes
        })
        .collect();
    for causes in [vec![], vec![Cause::Inertia], vec![Cause::Engine], vec![Cause::Inertia, Cause::Engine]] {
        assert!(seen.contains(&causes), "{causes:?} occurs: {seen:?}");
    }
}

/// Comparison with the inertial backend at a fixed step as the engine: the question is whether the
/// quasi-static model is valid.
fn compared(scenario: &Scenario, step_s: f64) -> Pathwise {
    let engine =
        |scenario: &Scenario, options: &BackendOptions| backend_of(scenario, &BackendOptions::new(BackendKind::Inertial, options.step_s));
    let settings = Settings { step_s: Some(step_s), ..settings(RapierOptions::default()) };
    ThreeWay::new(scenario, &settings).engine(&engine).prescribed(|_| true).unwrap()
}

/// Speeds over three decades about the one up to which the quasi-static model is valid, and a pair
/// close to it (1).
const SPEEDS: [f64; 8] = [0.0316, 0.1, 0.316, 0.98, 1.02, 3.16, 10.0, 31.6];

fn assert_valid_up_to(ratio: f64, found: &Pathwise) {
    let verdict = if ratio < 1.0 { Verdict::Agree } else { Verdict::Inertia };
    assert_eq!(found.verdict, verdict, "{ratio} {:?}", found.edge_displacement);
}

/// A pusher takes the load along at the speed v, with inertia and without, and stops. With inertia
/// the load goes on by v^2 / (2 mu g).
#[test]
fn a_pusher_that_stops_is_quasi_static_up_to_the_speed_of_theory() {
    let scenario = read("contact/pusher");
    let length = 0.05;
    let braking = scenario.system.braking();
    // The tolerance is a share of the whole path, coast included.
    let critical = (2.0 * braking * SHARE * length / (1.0 - SHARE)).sqrt();
    for ratio in SPEEDS {
        let speed = ratio * critical;
        let (push, coast) = (length / speed, speed * speed / (2.0 * braking));
        let mut scenario = scenario.clone();
        scenario.system.world.obstacles[0].path.waypoints[1].0 = push;
        scenario.control_period = push / 20.0;
        scenario.duration = push + (speed / braking / scenario.control_period).ceil() * scenario.control_period;
        let found = compared(&scenario, push / 100.0);
        let error = (found.edge_displacement.inertia_effect_m - coast).abs();
        assert!(error <= found.edge_displacement.reference_error_m + 1e-8, "{ratio} {error:e} {:?}", found.edge_displacement);
        assert_valid_up_to(ratio, &found);
    }
}

/// A spring draws the load along a wall, and the load oscillates by v / omega about the path
/// without inertia, or by less if the slide ends before.
#[test]
fn a_slide_along_a_wall_is_quasi_static_up_to_the_speed_of_theory() {
    let scenario = read("contact/wall-slide");
    let system = &scenario.system;
    let (stiffness, travel) = (system.springs[0].radial_stiffness, 0.06);
    let stretch = system.total_slip_limit() / stiffness;
    let omega = (stiffness / system.load.mass).sqrt();
    let critical = omega * SHARE * (travel - stretch);
    for ratio in SPEEDS {
        let speed = ratio * critical;
        let duration = travel / speed;
        let mut scenario = Scenario { duration, control_period: duration / 100.0, ..scenario.clone() };
        let Drive::Tips(paths) = &mut scenario.drive else { panic!("a scene with prescribed tips") };
        paths[0].waypoints[1].time = duration;
        assert_eq!(paths[0].waypoints[1].position, Vec2::new(travel, -0.02));
        let effect = speed / omega * (omega * (travel - stretch) / speed).min(0.5 * std::f64::consts::PI).sin();
        let found = compared(&scenario, 0.1 / omega);
        let share = found.edge_displacement.inertia_effect_m / effect;
        // Paths are compared every half a radian, which may miss 3 % of an amplitude.
        assert!((0.969..1.001).contains(&share), "{ratio} {share}");
        assert_valid_up_to(ratio, &found);
    }
}

/// A disc of 1 kg that one spring pulls against a wall at 0.1 m, where a tip at `tip` (m) stretches
/// it to `tip` less 0.1 m.
fn pressed_against_a_wall(waypoints: &str, damping_ratio: f64, duration: f64) -> Scenario {
    let text = format!(
        r#"{{"name": "pressed", "duration_s": {duration}, "control_period_s": 0.005, "load": {{"mass_kg": 1, "radius_m": 0.1}},
        "ground": {{"friction_coefficient": 0.5, "supports": {{"tripod": {{"radius_m": 0.07}}}}}},
        "springs": [{{"root_m": [0, 0], "bearing_rad": 0, "rest_length_m": 0, "radial_stiffness_n_per_m": 100,
            "torsional_stiffness_nm_per_rad": 0, "damping_ratio": {damping_ratio}}}],
        "obstacles": [{{"name": "wall", "outline": {{"polyline": {{"points_m": [[0.2, -0.5], [0.2, 0.5]]}}}}}}],
        "drive": {{"kind": "tips", "paths": [{{"spring": 0, "waypoints": {waypoints}}}]}}}}"#
    );
    Scenario::parse(&text, "pressed").unwrap()
}

/// At rest, the wall and the ground bear the pull together, in no share that the laws determine:
/// the wall at least the pull less the slip limit, and at most the pull plus the slip limit.
#[test]
fn a_wall_that_bears_a_load_at_rest_has_a_force_with_the_range_of_the_slip_limit() {
    let pull = 100.0 * (0.4 - 0.1);
    for (waypoints, damping_ratio, duration) in [("[[0, 0, 0], [8, 0.4, 0]]", 1.0, 8.0), ("[[0, 0.4, 0]]", 0.1, 2.0)] {
        let scenario = pressed_against_a_wall(waypoints, damping_ratio, duration);
        let limit = scenario.system.total_slip_limit();
        let found = compared(&scenario, 0.005);
        let peak = found.verdicts.contacts.measures.iter().find(|measure| measure.label() == "peak contact force of obstacle 0").unwrap();
        // The engine's position is off by micrometres, against a spring of 100 N/m.
        let admissible = pull - limit - 1e-3..pull + limit + 1e-3;
        assert!([peak.quasi_static, peak.inertial, peak.engine].iter().all(|force| admissible.contains(force)), "{peak:?}");
        assert!((peak.undetermined - 2.0 * limit).abs() <= 2e-3, "{peak:?}");
        // What no law determines is no effect of inertia, and no error.
        assert_eq!([peak.inertia_effect, peak.engine_error, peak.reference_error], [0.0; 3], "{peak:?}");
    }
}

/// All that a run shows of this wall is one impact: there is no force to be compared.
#[test]
fn an_impact_alone_gives_no_contact_force() {
    let mut scenario = pressed_against_a_wall("[[0, 0, 0]]", 0.0, 0.1);
    scenario.system.springs.clear();
    scenario.drive = Drive::Tips(Vec::new());
    scenario.start.twist.linear = Vec2::new(4.0, 0.0);
    scenario.control_period = 0.05;
    let found = compared(&scenario, 0.005);
    assert!(found.verdicts.contacts.measures.is_empty(), "{:?}", found.verdicts.contacts.measures);
}

/// A pusher accelerates along waypoints every millisecond. Their times are ticks but for rounding,
/// as in a file with six digits, and no step fits between the two.
#[test]
fn waypoints_on_ticks_but_for_rounding_are_on_ticks() {
    let mut scenario = read("contact/pusher");
    (scenario.duration, scenario.control_period) = (0.5, 1e-3);
    let path = &mut scenario.system.world.obstacles[0].path;
    let start = path.waypoints[0].1;
    let at = |time: f64| (time, Pose { position: start.position + Vec2::new(time * time, 0.0), ..start });
    path.waypoints = (0..=500).map(|i| at(f64::from(i) * 1e-3 * (1.0 + f64::EPSILON))).collect();
    let inertial = trace(&scenario, &BackendOptions::new(BackendKind::Inertial, 1e-3), 1);
    let energy = inertial.rows.last().unwrap().energy;
    // Sums of 500 roundings; with steps between, 1e-5 of the energy is missing.
    assert!(energy.defect().abs() <= 1e-12 * energy.largest_entry(), "{energy:?}");
    // Nothing stores energy, from which a load without inertia could jump.
    let options = BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(1e-5, &scenario.system.load));
    let jumps = trace(&scenario, &options, 1).transitions;
    assert!(!jumps.iter().any(|it| matches!(it.kind, TransitionKind::Jump { .. })), "{jumps:?}");
}

/// A finger pushes a disc without springs to a wall, and stops where the two touch. Finger and wall
/// may then press against each other through it, and yet both have the same forces in all runs:
/// there is no difference that this could leave open.
#[test]
fn equal_forces_between_two_obstacles_are_no_open_question() {
    let mut scenario = pressed_against_a_wall("[[0, 0, 0]]", 0.0, 1.0);
    scenario.system.springs.clear();
    scenario.drive = Drive::Tips(Vec::new());
    scenario.control_period = 1e-3;
    let finger = along(&scenario.system.world.obstacles[0], Vec2::new(-0.12, 0.0), 0.1);
    scenario.system.world.obstacles.insert(0, finger);
    let found = compared(&scenario, 1e-3);
    assert!(found.solutions.iter().any(|solution| solution.steps.is_indeterminate), "all steps show that the forces are unique");
    let peak = found.verdicts.contacts.measures.iter().find(|measure| measure.label() == "peak contact force of obstacle 0").unwrap();
    let expected = scenario.system.total_slip_limit();
    // Rounding of a balance of forces.
    assert!([peak.quasi_static, peak.inertial].iter().all(|force| (force / expected - 1.0).abs() < 1e-9), "{peak:?} {expected}");
    assert_eq!(found.verdicts.contacts.verdict, Verdict::Agree);
}

/// A disc of 20 mm in the place of an obstacle, which moves by `shift` (m) along x in 0.5 s.
fn along(obstacle: &Obstacle, start: Vec2, shift: f64) -> Obstacle {
    let pose = |x: f64| Pose { position: start + Vec2::new(x, 0.0), heading: 0.0 };
    Obstacle {
        outline: Outline::disc(0.02),
        path: ObstaclePath { waypoints: vec![(0.0, pose(0.0)), (0.5, pose(shift))] },
        ..obstacle.clone()
    }
}

/// A load on ice that bounces without loss dissipates nothing but roundings, of which no verdict
/// is made.
#[test]
fn roundings_of_the_energy_are_no_loss() {
    let mut scenario = pressed_against_a_wall("[[0, 0, 0], [0.5, 0.2, 0]]", 0.0, 1.0);
    scenario.system.ground.friction_coefficient = 0.0;
    scenario.system.world.obstacles[0].restitution = 1.0;
    let found = ThreeWay::new(&scenario, &Settings::default()).prescribed(|_| true).unwrap();
    let energy = &found.verdicts.energy;
    assert!(energy.engine_error < 1e-12 && energy.tolerance > 1e-12, "{energy:?}");
    assert_eq!(energy.verdict, Verdict::Agree);
}
