//! Loads on few springs at random: steps converge, jumps are there at every step, and they end
//! where damped springs lead, or say under error control that their end depends on the dissipation.

#[path = "../common/random_pulls.rs"]
mod random_pulls;

use std::ops::Range;

use cohaul::backend::{BackendKind, BackendOptions, Integrator, Status, StepReport, Tolerance, TransitionKind, build};
use cohaul::math::Vec2;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Keep, Simulation};
use cohaul_studies::verify::scenes::{SLIP_STRETCH, at_rest, isotropic, paper_system};
use random_pulls::{PERIOD, Pull};

/// Shortest spring over its rest length below which a load is near a root (1).
const NEAR_ROOT: f64 = 0.05;
/// Periods by which coarse steps may begin a jump early or late.
const EARLY: u32 = 4;

/// What a quasi-static run of a pull found.
struct Found {
    cost: StepReport,
    /// Control period and edge displacement over the load's radius of each jump.
    jumps: Vec<(u32, f64)>,
    /// Length of the shortest spring over its rest length.
    shortest: f64,
}

fn run(pull: &Pull, options: &BackendOptions) -> Found {
    let mut load = build(&pull.system, pull.start, options);
    let mut found = Found { cost: StepReport::default(), jumps: Vec::new(), shortest: f64::INFINITY };
    pull.run(load.as_mut(), |period, report, load| {
        found.cost.add(report);
        found.shortest = found.shortest.min(pull.shortest(load));
        for transition in load.transitions() {
            if let TransitionKind::Jump { shift, turn, .. } = transition.kind {
                found.jumps.push((period, shift / pull.system.load.radius + turn.abs()));
            }
        }
    });
    found
}

fn fixed(step: f64) -> BackendOptions {
    BackendOptions::new(BackendKind::QuasiStatic, step)
}

/// Runs pulls at two steps and, `n_controlled` of them, under error control. Returns how many did
/// not converge.
fn check_pulls(seeds: Range<u64>, n_controlled: u64) -> usize {
    let mut n_refused = 0;
    for seed in seeds.clone() {
        let pull = Pull::random(seed);
        let [coarse, fine] = [PERIOD, 0.1 * PERIOD].map(|step| run(&pull, &fixed(step)));
        let mut found = vec![&coarse, &fine];
        let tolerance = Tolerance::at_edge(1e-4 * pull.system.load.radius, &pull.system.load);
        let controlled =
            (seed < seeds.start + n_controlled).then(|| run(&pull, &BackendOptions::within(BackendKind::QuasiStatic, tolerance)));
        found.extend(&controlled);
        let is_near_root = found.iter().any(|found| found.shortest < NEAR_ROOT);
        let is_refused = found.iter().any(|found| found.cost.status != Status::Converged);
        assert!(!is_refused || is_near_root, "{seed}: a step did not converge");
        n_refused += usize::from(is_refused);
        if is_near_root {
            continue;
        }
        // A fast motion shrinks with the step. A jump stays, but for where it begins. A coarse step
        // may begin it some periods early, or add fast motion to it: then the run under error
        // control, if there is one, must jump about there.
        let is_there =
            |period: u32| controlled.as_ref().is_some_and(|run| run.jumps.iter().any(|(other, _)| other.abs_diff(period) <= EARLY));
        for (period, size) in &coarse.jumps {
            let there: f64 = fine.jumps.iter().filter(|(other, _)| other.abs_diff(*period) <= 1).map(|(_, size)| size).sum();
            assert!(
                there > 0.5 * size || is_there(*period),
                "{seed}: a jump by {size} radii in period {period} has {there} at finer steps"
            );
        }
    }
    n_refused
}

#[test]
fn random_pulls_converge_and_their_jumps_stay() {
    assert!(check_pulls(0..60, 4) <= 1);
}

/// In the jump of this pull a spring swings by half a turn. The path of the jump halts there, but
/// the load does not stay where it is out of balance.
#[test]
fn a_spring_swings_by_half_a_turn_in_a_jump() {
    assert_eq!(check_pulls(801..802, 1), 0);
}

/// `cargo test --release --test analytic a_thousand_pulls -- --ignored`, some minutes.
#[test]
#[ignore = "a thousand pulls in place of the 60 of random_pulls_converge_and_their_jumps_stay, which runs always"]
fn a_thousand_pulls_converge_and_their_jumps_stay() {
    let n_refused = check_pulls(0..1000, 1000);
    assert!(n_refused <= 5, "{n_refused}");
}

/// A spring at three quarters of its rest length pushes a load that only friction keeps from
/// turning. Its slip is smooth from the edge of sticking on, at any step.
#[test]
fn a_load_held_by_friction_slips_smoothly() {
    let text = include_str!("../common/compressed-spring.json");
    let Scenario { system, start, drive, .. } = Scenario::parse(text, "compressed spring").unwrap();
    let Drive::Tips(paths) = drive else { panic!("tips are prescribed") };
    let [from, to] = [0, 1].map(|at| paths[0].waypoints[at]);
    let tip = |time: f64| -> Vec2 { from.position + time / (to.time - from.time) * (to.position - from.position) };
    let controlled = BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(1e-6, &system.load));
    let ends = [fixed(1e-3), fixed(1e-4), controlled].map(|options| {
        let mut load = build(&system, start, &options);
        load.attach(0, tip(0.0));
        let mut report = StepReport::default();
        for tick in 1..=60 {
            report.add(&load.advance(&[tip(1e-3 * f64::from(tick))], 1e-3));
            let jumps = |kind| matches!(kind, TransitionKind::Jump { .. });
            assert!(!load.transitions().iter().any(|transition| jumps(transition.kind)), "{tick}: {:?}", load.transitions());
        }
        assert_eq!((report.status, report.n_not_converged), (Status::Converged, 0));
        load.motion().pose
    });
    // Steps are of first order: a tenth of the step, a tenth of the error.
    let errors = [0, 1].map(|at| ends[at].edge_displacement(&ends[2], system.load.radius));
    assert!(errors[0] < 2e-6 && errors[1] < 0.15 * errors[0], "{errors:?}");
}

/// Scenes whose rate-independent steps once did not converge. On collinear supports, the jump of
/// the last one ends elsewhere with each kind of dissipation. With their dashpots all of them
/// converge, and none of them jumps.
#[test]
fn random_scenes_that_did_not_converge_do() {
    let scenes = [
        (include_str!("../common/five-springs.json"), false),
        (include_str!("../common/concave-springs.json"), false),
        (include_str!("../common/collinear-jump.json"), true),
    ];
    for (text, has_uncertain_jump) in scenes {
        let scenario = Scenario::parse(text, "scene").unwrap();
        let options = BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(1e-6, &scenario.system.load));
        let is_damped = scenario.system.springs.iter().any(|spring| spring.damping_ratio > 0.0);
        for rate_independent in [true, false] {
            let options = BackendOptions { rate_independent, ..options };
            let mut simulation = Simulation::new(&scenario, &options, Keep::Outcome);
            simulation.run(|_| true);
            let outcome = simulation.outcome();
            assert_eq!((outcome.steps.status, outcome.steps.n_not_converged), (Status::Converged, 0), "{}", scenario.name);
            let may_jump = rate_independent || !is_damped;
            assert_eq!(outcome.transitions.n_uncertain_jumps > 0, has_uncertain_jump && may_jump, "{}", scenario.name);
            assert!(may_jump || outcome.transitions.n_jumps == 0, "{}", scenario.name);
        }
    }
}

/// Compares ends of jumps with those of damped dynamics, with `steps` of this length (s) for
/// relaxation times of a second. Each is within 1 % or says that its end is uncertain.
fn check_jumps(n: u64, step: f64) {
    for seed in 0..n {
        let pull = Pull::random(seed);
        let radius = pull.system.load.radius;
        let controlled = BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(1e-6, &pull.system.load));
        let (end, is_uncertain) = pull.jump(build(&pull.system, pull.start, &controlled).as_mut(), 1);
        let length = end.edge_displacement(&pull.start.pose, radius);
        if length < 1e-6 * radius {
            continue;
        }
        let options = BackendOptions { integrator: Integrator::Euler, ..BackendOptions::new(BackendKind::Inertial, step) };
        let (damped, _) = pull.jump(build(&pull.damped(1e-3), pull.start, &options).as_mut(), 20);
        let far = damped.edge_displacement(&end, radius) / length;
        println!("{seed},{length:.4e},{far:.2e},{}", u8::from(is_uncertain));
        // First order in the step: a share of it for each of the first seconds.
        let allowed = 0.01 + 0.5 * step;
        assert!(far <= allowed || is_uncertain, "{seed}: {far} of {length} m, unflagged");
    }
}

#[test]
fn jumps_end_where_damped_springs_lead_or_are_flagged() {
    check_jumps(24, 1e-2);
}

/// A spring through the centre leads straight ahead, whatever dissipates.
#[test]
fn a_straight_jump_is_certain() {
    let system = paper_system(vec![isotropic(Vec2::zeros(), 0.0)]);
    let controlled = BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(1e-6, &system.load));
    let mut load = build(&system, at_rest(), &controlled);
    let tip = Vec2::new(3.0 * SLIP_STRETCH, 0.0);
    load.attach(0, tip);
    load.advance(&[tip], PERIOD);
    let jumps: Vec<_> = load.transitions().iter().filter(|seen| matches!(seen.kind, TransitionKind::Jump { .. })).collect();
    assert!(matches!(jumps[..], [seen] if matches!(seen.kind, TransitionKind::Jump { is_uncertain: false, .. })), "{jumps:?}");
}

/// `cargo test --release --test analytic two_hundred_jumps -- --ignored`, about a minute.
#[test]
#[ignore = "210 jumps in place of the 24 of jumps_end_where_damped_springs_lead_or_are_flagged, which runs always"]
fn two_hundred_jumps_end_where_damped_springs_lead_or_are_flagged() {
    check_jumps(210, 1e-3);
}

/// The fastest oscillation on this spring turns by 2.8 rad in a step of 5 ms, in which the midpoint
/// rule gains a tenth of the work of the tip. Steps of the default length resolve it.
#[test]
fn a_run_that_gains_energy_has_not_converged() {
    let scenario = Scenario::parse(include_str!("../common/stiff-spring.json"), "stiff spring").unwrap();
    let steps = |step_s: Option<f64>| {
        let options = BackendOptions::at_step(step_s, BackendKind::Inertial, &scenario.system, scenario.control_period);
        let mut simulation = Simulation::new(&scenario, &options, Keep::Outcome);
        simulation.run(|_| true);
        simulation.outcome().steps
    };
    let long = steps(Some(5e-3));
    assert!(long.status == Status::NotConverged && long.gained_share > 0.05, "{long:?}");
    let default = steps(None);
    assert_eq!((default.status, default.gained_share), (Status::Converged, 0.0));
}
