//! Work that the exact backends leave out: nobody would have noticed it, and the counts say how
//! often it was.

#[path = "common/random_scenes.rs"]
mod random_scenes;

use cohaul::backend::{BackendKind, BackendOptions, Motion, Skip, Skips, StepReport, build, default_step};
use cohaul::math::{Pose, Twist, Vec2, direction};
use cohaul::model::System;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Outcome, Simulation, Trace};
use cohaul_studies::verify::scenes::{paper_springs, paper_system};
use serde_json::json;

use random_scenes::random_scenario;

const EXACT: [BackendKind; 2] = [BackendKind::QuasiStatic, BackendKind::Inertial];

fn run(scenario: &Scenario, kind: BackendKind, skips: Skips) -> (Trace, Outcome) {
    let step = default_step(kind, &scenario.system, scenario.control_period);
    let mut run = Simulation::new(scenario, &BackendOptions { skips, ..BackendOptions::new(kind, step) }, Keep::Trace);
    run.run(|_| true);
    run.into_results()
}

fn shipped(name: &str) -> Scenario {
    Scenario::read(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").join(name).as_path()).unwrap()
}

/// Largest distance of two traces over the load's radius, in pose and in the books over the energy
/// turned over.
fn distance(a: &(Trace, Outcome), b: &(Trace, Outcome), radius: f64) -> f64 {
    assert_eq!(a.0.rows.len(), b.0.rows.len());
    let turnover = (a.1.energy.tip_work.abs() + a.1.energy.initial + a.1.energy.released).max(f64::MIN_POSITIVE);
    let rows = a.0.rows.iter().zip(&b.0.rows).map(|(a, b)| {
        let (p, q) = (a.motion.pose, b.motion.pose);
        let pose = (p.position - q.position).norm() / radius + (p.heading - q.heading).abs();
        let (e, f) = (a.energy, b.energy);
        let energy = (e.elastic - f.elastic).abs() + (e.tip_work - f.tip_work).abs() + (e.friction - f.friction).abs();
        let pulls = a.tips.iter().zip(b.tips.iter()).map(|(a, b)| (a.pull - b.pull).norm()).fold(0.0, f64::max);
        // Pulls are of the order of the total friction, 22 mN.
        pose.max(energy / turnover).max(pulls / 0.022)
    });
    rows.fold(0.0, f64::max)
}

/// Where it is certain that the load sticks nothing moves either way; friction forces found in one
/// step or in many differ by rounding, and with them the start of the next solution, which is exact
/// to 1e-13 and adds up over some thousand steps.
#[test]
fn a_load_that_surely_sticks_is_where_it_would_have_been() {
    let mut scenes =
        vec![shipped("paper/four-ants-four-springs.json"), shipped("analytic/qs-ref-1.json"), shipped("analytic/release-jump.json")];
    scenes[0].duration = 10.0;
    scenes.extend((0..12).map(random_scenario));
    let mut n_skipped = 0;
    for scenario in &scenes {
        let quick = run(scenario, BackendKind::QuasiStatic, Skips::ALL);
        let slow = run(scenario, BackendKind::QuasiStatic, Skips::ALL.without(Skip::StickCertificate));
        assert_eq!(slow.1.steps.skipped.stick_certificate, 0);
        let events =
            |(trace, _): &(Trace, Outcome)| trace.events.iter().map(|at| (at.time, at.spring, at.ant, at.kind)).collect::<Vec<_>>();
        assert_eq!(events(&quick), events(&slow), "{}", scenario.name);
        let transitions = |(trace, _): &(Trace, Outcome)| trace.transitions.iter().map(|at| (at.time, at.kind.name())).collect::<Vec<_>>();
        assert_eq!(transitions(&quick), transitions(&slow), "{}", scenario.name);
        let distance = distance(&quick, &slow, scenario.system.load.radius);
        assert!(distance < 1e-10, "{}: {distance}", scenario.name);
        n_skipped += quick.1.steps.skipped.stick_certificate;
    }
    assert!(n_skipped > 1000, "{n_skipped}");
}

/// One spring of the paper's load whose tip slowly goes a `way` (m, world) from where it rests, in
/// `n` advances of so many steps each: what each took, and whether the load has moved by then.
fn slow_pull(way: Vec2, skips: Skips, n: u64, n_each: u64) -> (Vec<(StepReport, bool)>, System) {
    let system = paper_system(paper_springs(1));
    let start = Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist::ZERO };
    let options = BackendOptions::new(BackendKind::QuasiStatic, 1.0 / n_each as f64);
    let mut run = build(&system, start, &BackendOptions { skips, ..options });
    let tip = system.springs[0].rest_tip();
    run.attach(0, tip);
    let reports = (1..=n)
        .map(|i| {
            let target = tip + way * (i as f64 / n as f64);
            let report = run.advance(&[target], 1.0);
            assert_eq!(report.n_steps, n_each);
            // A spring on a load that stands keeps all the work; whoever asks gets the books and
            // the forces of this instant.
            let (energy, friction) = (run.energy(), run.friction_forces().iter().sum::<Vec2>());
            let stands = run.motion().pose == start.pose;
            if stands {
                assert!((energy.elastic - energy.tip_work).abs() <= 1e-15 * energy.tip_work, "{i}: {energy:?}");
                // Rounding of sums of 22 mN.
                assert!((friction + run.pull(0)).norm() < 1e-16, "{i}: {friction} {}", run.pull(0));
                let mut forces = run.friction_forces().into_iter().zip(system.ground.slip_limits());
                assert!(forces.all(|(force, limit)| force.norm() <= limit * (1.0 + 1e-12)), "{i}: {:?}", run.friction_forces());
            }
            (report, !stands)
        })
        .collect();
    (reports, system)
}

/// Number of the advance in which the load begins to slip, and how many of the steps before it were
/// left out (1).
fn onset(reports: &[(StepReport, bool)]) -> (usize, f64) {
    let first = reports.iter().position(|(_, slips)| *slips).unwrap();
    let sum = |count: fn(&StepReport) -> u64| reports[..first].iter().map(|(report, _)| count(report)).sum::<u64>() as f64;
    (first, sum(|report| report.skipped.stick_certificate) / sum(|report| report.n_steps))
}

/// Hardly a step before the slip is solved, and the slip begins in the very step where it does when
/// all are, one by one or many in an advance. Outward, 22 mN at 0.664 N/m are reached after 33 mm.
/// Across, the spring turns the load while it pulls: the least forces that hold that reach the
/// limit of one support long before the load slips, and others share the load out.
#[test]
fn a_load_waits_until_just_before_it_slips() {
    for (way, n, n_each) in [([36e-3, 0.0], 3000, 1), ([12e-3, 36e-3], 3000, 1), ([36e-3, 0.0], 120, 25), ([12e-3, 36e-3], 120, 25)] {
        let way = Vec2::from(way);
        let (quick, system) = slow_pull(way, Skips::ALL, n, n_each);
        let (slow, _) = slow_pull(way, Skips::ALL.without(Skip::StickCertificate), n, n_each);
        let ((slips, share), (slips_slow, share_slow)) = (onset(&quick), onset(&slow));
        assert_eq!((slips, share_slow), (slips_slow, 0.0), "{way} {n_each}");
        if way.y == 0.0 {
            assert_eq!(slips + 1, (system.total_slip_limit() / 0.664 / way.x * n as f64).ceil() as usize);
        }
        assert!(share > 0.98, "{way} {n_each}: {share}");
    }
}

/// A tip that goes around its root one and a half times, on a spring too weak to move the load: a
/// certificate ends before the swing could be taken for one on another branch.
#[test]
fn a_load_that_waits_knows_how_often_a_spring_was_swung_around() {
    let mut system = paper_system(paper_springs(1));
    system.springs[0].radial_stiffness *= 1e-3;
    system.springs[0].torsional_stiffness *= 1e-3;
    let (start, spring) = (Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist::ZERO }, system.springs[0]);
    let mut run = build(&system, start, &BackendOptions::new(BackendKind::QuasiStatic, 1.0));
    run.attach(0, spring.rest_tip());
    let (n, mut n_skipped) = (600, 0);
    for i in 1..=n {
        let swing = 3.0 * std::f64::consts::PI * f64::from(i) / f64::from(n);
        let tip = spring.root + spring.rest_length * direction(spring.bearing + swing);
        n_skipped += run.advance(&[tip], 1.0).skipped.stick_certificate;
        let energy = 0.5 * spring.torsional_stiffness * swing * swing;
        // Roundings of the swing from step to step, 1e-16 each, and of the length.
        assert!((run.energy().elastic - energy).abs() <= 1e-12 * energy, "{i}: {} {energy}", run.energy().elastic);
    }
    assert_eq!(run.motion().pose, start.pose);
    assert!((500..600).contains(&n_skipped), "{n_skipped}");
}

/// A load at rest without springs, or with tips that stand, has nowhere to go: what is left out is
/// what would have been found.
#[test]
fn a_load_at_rest_stays_whether_or_not_it_is_computed() {
    for kind in EXACT {
        for (name, skip) in [("analytic/slide-spin.json", Skip::FreeLoad), ("analytic/ramp-and-hold.json", Skip::StillTips)] {
            let scenario = shipped(name);
            let quick = run(&scenario, kind, Skips::ALL.without(Skip::StickCertificate));
            let slow = run(&scenario, kind, Skips::NONE);
            let count = |steps: &StepReport| if skip == Skip::FreeLoad { steps.skipped.free_load } else { steps.skipped.still_tips };
            // Quasi-statically the load is at rest from the start; what the solution finds there is
            // rest to rounding.
            assert!(count(&quick.1.steps) >= 50, "{name} {kind:?}: {:?}", quick.1.steps);
            assert_eq!((count(&slow.1.steps), slow.1.steps.n_skipped), (0, 0), "{name} {kind:?}");
            let distance = distance(&quick, &slow, scenario.system.load.radius);
            assert!(distance < 1e-12, "{name} {kind:?}: {distance}");
        }
    }
}

/// A certificate belongs to the state: a run that goes on from a saved one leaves out the same
/// steps and finds the same bits.
#[test]
fn a_certificate_is_saved_with_the_run() {
    let system = paper_system(paper_springs(2));
    let start = Motion { pose: Pose::new(0.01, -0.02, 0.3), twist: Twist::ZERO };
    let options = BackendOptions::new(BackendKind::QuasiStatic, 0.01);
    let tips: Vec<Vec2> = system.springs.iter().map(|spring| start.pose.to_world(&spring.rest_tip())).collect();
    let at = |i: u32| tips.iter().map(|tip| tip + f64::from(i) * Vec2::new(2e-4, 1e-4)).collect::<Vec<_>>();
    let mut whole = build(&system, start, &options);
    tips.iter().enumerate().for_each(|(spring, tip)| whole.attach(spring, *tip));
    let mut n_skipped = 0;
    for i in 1..=200 {
        let saved = whole.save().unwrap();
        let mut part = build(&system, start, &options);
        part.restore(&saved).unwrap();
        let reports = [whole.advance(&at(i), 0.01), part.advance(&at(i), 0.01)];
        assert_eq!(reports[0], reports[1], "{i}");
        assert_eq!(whole.save().unwrap(), part.save().unwrap(), "{i}");
        assert_eq!((whole.energy(), whole.pull(1)), (part.energy(), part.pull(1)), "{i}");
        n_skipped += reports[0].skipped.stick_certificate;
    }
    assert!((20..180).contains(&n_skipped), "{n_skipped}");
}

/// A spring pushes almost as hard as friction holds; its tip goes round to where the push is as
/// hard, in one step, and back along the chord, on which the spring is shorter and pushes harder:
/// balanced at both ends of the chord and not between. That the tip ends where the certificate was
/// made for does not make the way there sure.
#[test]
fn a_way_is_sure_only_where_it_begins_so() {
    let (stiffness, rest_length, angle) = (4.0, 0.0263, 0.1225f64);
    let limit = 1.4 * 0.0016 * 9.81;
    let held = rest_length - limit / stiffness;
    let (sin, cos) = angle.sin_cos();
    let scenario = json!({
        "name": "chord", "duration_s": 1.2, "control_period_s": 1.2, "seed": 1,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122 },
        "ground": {
            "friction_coefficient": 1.4, "gravity_m_per_s2": 9.81, "supports": { "tripod": { "radius_m": 0.0244 / 3.0 } }
        },
        "springs": [{
            "root_m": [0.0, 0.0], "bearing_rad": 0.0, "rest_length_m": rest_length,
            "radial_stiffness_n_per_m": stiffness, "torsional_stiffness_nm_per_rad": 0.0
        }],
        "drive": { "kind": "tips", "paths": [{ "spring": 0, "waypoints": [
            [0.0, rest_length, 0.0], [0.1, held + 1e-7, 0.0], [0.2, (held + 1e-8) * cos, (held + 1e-8) * sin], [1.2, held + 1e-7, 0.0]
        ] }] }
    });
    let scenario = Scenario::parse(&scenario.to_string(), "chord").unwrap();
    let shift = |skips| {
        let options = BackendOptions { skips, ..BackendOptions::new(BackendKind::QuasiStatic, 0.1) };
        let mut run = Simulation::new(&scenario, &options, Keep::Outcome);
        run.run(|_| true);
        run.outcome().motion.pose.position
    };
    let computed = shift(Skips::ALL.without(Skip::StickCertificate));
    // 38.8 um, by which the chord is shorter.
    assert!(computed.norm() > 1e-5);
    assert_eq!(shift(Skips::ALL), computed);
}
