//! Energy that every step must and must not take.

use std::f64::consts::TAU;
use std::path::Path;

use cohaul::backend::{Backend, BackendKind, BackendOptions, EnergyLedger, Integrator, Status, Tolerance, TransitionKind, build};
use cohaul::math::{RandomStreams, Stream, Vec2, direction};
use cohaul::model::PolarSpring;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation, controller_of};

use crate::bounded::{Findings, audited};
use crate::common::*;

fn check(name: &str, found: &Findings) {
    assert!(found.n_steps > 0, "{name}");
    // The cone problem is solved to 1e-13 of the forces, and the energies are sums that cancel:
    // some tens of roundings.
    assert!(found.above < 1e-13 && found.below < 1e-13, "{name}: {found:?}");
    // The loss worked back from two poses has the digits that their distance from the origin
    // leaves.
    assert!(found.misbooked < 1e-11 && found.least_loss >= 0.0, "{name}: {found:?}");
}

#[test]
fn each_step_of_the_reference_scene_keeps_within_the_two_bounds() {
    for n in [20, 100, 2000] {
        let (mut run, found) = audited(&paper_system(paper_springs(4)), at_rest());
        drive(&mut run, reference_tips, 1.0, n, |_, _| ());
        check("reference", &found.borrow());
        assert!(found.borrow().n_moving > n * 9 / 10);
    }
}

/// Where the energy of one spring is no longer convex, the old pose may be a local minimum only,
/// and a snap from it breaks the lower bound. At 0.8 and 1.0 of the rest length that begins at
/// swings of 0.74 and 1.01 rad.
fn is_near_buckling(spring: &PolarSpring, run: &dyn Backend, tip: &Vec2) -> bool {
    let shape = spring.shape(&run.motion().pose, tip, 0.0);
    !(0.8..2.5).contains(&(shape.length / spring.rest_length)) || shape.swing.abs() > 0.7
}

/// Tips of `n` springs that walk at random: straight for some steps of `stride` (m), now and then
/// let go and grasped elsewhere.
fn walk(run: &mut dyn Backend, n: usize, stride: f64, seed: u64, n_steps: u64, mut watch: impl FnMut(&dyn Backend)) {
    let streams = RandomStreams::new(seed);
    let springs = paper_springs(n);
    let mut tips = vec![Vec2::new(f64::NAN, f64::NAN); n];
    for tick in 0..n_steps {
        for spring in 0..n {
            let [toss, turn] = streams.uniform_pair(Stream::Grasp, spring as u32, tick);
            let rest = run.motion().pose.to_world(&springs[spring].rest_tip());
            match run.tip(spring) {
                None if toss < 0.05 => {
                    tips[spring] = rest + 0.005 * direction(TAU * turn);
                    run.attach(spring, tips[spring]);
                }
                Some(tip) if toss < 0.004 || is_near_buckling(&springs[spring], run, &tip) => run.release(spring),
                _ => (),
            }
            let course = streams.uniform(Stream::Target, spring as u32, tick / 40);
            tips[spring] += stride * direction(TAU * course);
        }
        assert_eq!(run.advance(&tips, 1e-3).status, Status::Converged, "seed {seed}, tick {tick}");
        watch(run);
    }
}

#[test]
fn each_step_of_random_walks_keeps_within_the_two_bounds() {
    for seed in 0..6 {
        for (n, stride) in [(1, 3e-5), (4, 1e-4), (4, 4e-4), (10, 2e-4)] {
            let (mut run, found) = audited(&paper_system(paper_springs(n)), at_rest());
            walk(&mut run, n, stride, seed, 1500, |_| ());
            check(&format!("walk of {n} by {stride}, seed {seed}"), &found.borrow());
        }
    }
}

#[test]
fn each_step_of_the_scenarios_keeps_within_the_two_bounds() {
    let mut n_files = 0;
    for folder in ["analytic", "paper", "stress"] {
        for entry in Path::new("scenarios").join(folder).read_dir().unwrap() {
            let path = entry.unwrap().path();
            let scenario = Scenario::read(&path).unwrap();
            // The bounds are those of a load that touches nothing.
            if !scenario.system.world.is_empty() {
                continue;
            }
            let (run, found) = audited(&scenario.system, scenario.start);
            let options = BackendOptions::new(BackendKind::QuasiStatic, scenario.control_period);
            let mut simulation = Simulation::from_parts(&scenario, &options, Keep::Outcome, controller_of(&scenario), Box::new(run));
            simulation.run(|_| true);
            check(&path.display().to_string(), &found.borrow());
            n_files += 1;
        }
    }
    assert!(n_files >= 20, "{n_files}");
}

/// Energy that the books miss (J) after the reference scene in n steps.
fn defect(kind: BackendKind, n: u32) -> f64 {
    let mut run = backend(kind, &paper_system(paper_springs(4)), at_rest(), 1.0);
    drive(run.as_mut(), reference_tips, 1.0, n, |_, _| ());
    run.energy().defect()
}

/// The work at the tips is a trapezoid sum, of second order; an independent program missed as much.
#[test]
fn without_inertia_the_books_close_with_the_square_of_the_step() {
    for (n, known) in [(80, 1.5e-7), (160, 3.75e-8), (320, 1.0e-8), (640, 2.2e-9)] {
        let found = defect(BackendKind::QuasiStatic, n).abs();
        // Printed with two digits, and the onset lies anywhere in a step.
        assert!((found / known - 1.0).abs() < 0.15, "{n}: {found:e}");
    }
}

/// The implicit step takes energy from every swing: numerical damping, of first order.
#[test]
fn with_inertia_the_step_takes_energy_in_first_order() {
    for kind in WITH_INERTIA {
        let defects = [8_000, 16_000].map(|n| defect(kind, n));
        assert!(defects[1] < 0.0 && (defects[0] / defects[1] - 2.0).abs() < 0.1, "{kind:?} {defects:?}");
    }
}

#[test]
fn friction_and_dashpots_never_give_energy_back() {
    for kind in BackendKind::ALL {
        for damping_ratio in [0.0, 0.3] {
            let springs = paper_springs(4).into_iter().map(|spring| PolarSpring { damping_ratio, ..spring });
            let mut run = backend(kind, &paper_system(springs.collect()), at_rest(), 1e-3);
            let (mut last, mut least) = (run.energy(), 0.0f64);
            walk(run.as_mut(), 4, 3e-5, 11, 3000, |run| {
                let energy = run.energy();
                least = least.min(energy.friction - last.friction).min(energy.damping - last.damping);
                last = energy;
            });
            // A load that stands in the engine has speeds of rounding, of any sign: 22 mN over less
            // than a femtometre.
            assert!(least >= if kind == BackendKind::Rapier { -1e-17 } else { 0.0 }, "{kind:?}: {least:e}");
            assert!(last.friction > 1e-5 && last.released > 0.0, "{kind:?} {last:?}");
            assert_eq!(last.damping > 0.0, damping_ratio > 0.0);
        }
    }
}

/// A load that ripples behind a tip at speed v loses k v^2 h / 2 a second to implicit Euler: half
/// of it by inertia, 1/2 m (a h)^2 a step, half by the spring, 1/2 k (x' h) (x' - v) h, with x' = v
/// (1 - cos omega t).
#[test]
fn the_damping_of_the_implicit_step_is_what_the_ripple_loses() {
    let (speed, rate) = (0.02, (RADIAL / MASS).sqrt());
    let (onset, period) = (SLIP_LIMIT / (RADIAL * speed), TAU / rate);
    for kind in WITH_INERTIA {
        for n in [1_000, 4_000] {
            let step = period / f64::from(n);
            let mut run = backend(kind, &paper_system(vec![isotropic(Vec2::zeros(), 0.0)]), at_rest(), step);
            run.attach(0, Vec2::zeros());
            run.advance(&[Vec2::new(speed * onset, 0.0)], onset);
            run.advance(&[Vec2::new(speed * (onset + period), 0.0)], period);
            let (ledger, parts) = (run.energy(), run.energy().defect_parts());
            let expected = -0.5 * RADIAL * speed * speed * step * period;
            // The ripple itself is damped by omega h / 2 a radian: 2 pi omega h of it at the end,
            // half of that on the way.
            assert!((parts.numerical_damping / expected - 1.0).abs() < TAU * rate * step, "{kind:?} {n}: {parts:?} {expected:e}");
            // Forces are linear, and trapezoids of them exact.
            assert!((parts.quadrature / ledger.defect()).abs() < 1e-6, "{kind:?} {n}: {parts:?}");
        }
    }
}

fn check_sum(ledger: &EnergyLedger) {
    let parts = ledger.defect_parts();
    let scale = ledger.tip_work.abs() + ledger.initial + ledger.dissipated() + ledger.elastic;
    assert!((parts.jumps + parts.numerical_damping + parts.quadrature - ledger.defect()).abs() < 1e-15 * scale, "{ledger:?}");
}

/// Springs' energies depend on poses alone, so what the load's balance leaves is a trapezoid's
/// error: second order beside a damping of first order. Jumps are of a load without inertia and
/// dashpots only.
#[test]
fn on_random_walks_the_parts_are_the_defect_and_quadrature_is_of_second_order() {
    for kind in BackendKind::ALL {
        for damping_ratio in [0.0, 0.3] {
            let springs: Vec<_> = paper_springs(4).into_iter().map(|spring| PolarSpring { damping_ratio, ..spring }).collect();
            let ledgers = [1e-3, 2.5e-4].map(|step| {
                let mut run = backend(kind, &paper_system(springs.clone()), at_rest(), step);
                walk(run.as_mut(), 4, 3e-5, 11, 1500, |run| check_sum(&run.energy()));
                run.energy()
            });
            let [coarse, fine] = ledgers.map(|ledger| ledger.defect_parts());
            if kind == BackendKind::QuasiStatic && damping_ratio > 0.0 {
                // The load relaxes, and a step of a relaxation loses energy in first order.
                assert_eq!((fine.jumps, fine.numerical_damping), (0.0, 0.0));
                assert!(fine.quadrature < 0.0 && coarse.quadrature < 2.0 * fine.quadrature, "{coarse:?} {fine:?}");
            } else if kind == BackendKind::QuasiStatic {
                assert!(fine.jumps < -1e-7 && fine.numerical_damping == 0.0);
            } else {
                assert_eq!(fine.jumps, 0.0);
                // A quarter of the step: a sixteenth of the second order, and events that fall
                // elsewhere in their steps.
                assert!(coarse.quadrature.abs() > 8.0 * fine.quadrature.abs(), "{kind:?} {coarse:?} {fine:?}");
                assert!(fine.numerical_damping < 0.0 && fine.quadrature.abs() < 0.02 * fine.numerical_damping.abs(), "{kind:?} {fine:?}");
            }
        }
    }
}

/// The midpoint step damps nothing: what its load loses beside friction is of second order.
#[test]
fn the_midpoint_step_damps_far_less() {
    let damping = [Integrator::Euler, Integrator::Midpoint].map(|integrator| {
        let options = BackendOptions { integrator, ..BackendOptions::new(BackendKind::Inertial, 1.0) };
        let mut run = build(&paper_system(paper_springs(4)), at_rest(), &options);
        drive(run.as_mut(), reference_tips, 1.0, 2_000, |_, _| ());
        check_sum(&run.energy());
        run.energy().defect_parts().numerical_damping
    });
    assert!(damping[1].abs() < 0.05 * damping[0].abs(), "{damping:?}");
}

/// Tips between nodes go straight, so a controlled run knows no error but its own; at rest and
/// about a captured support, too, where poses alone are exact at any stride.
#[test]
fn under_error_control_the_books_close_to_the_tolerance() {
    for kind in [BackendKind::QuasiStatic, BackendKind::Inertial] {
        for tolerance in [1e-6, 1e-8] {
            let system = paper_system(paper_springs(4));
            let options = BackendOptions::within(kind, Tolerance::at_edge(tolerance, &system.load));
            let mut run = build(&system, at_rest(), &options);
            let mut n_jumps = 0;
            drive(run.as_mut(), reference_tips, 1.0, 500, |_, run| {
                n_jumps += run.transitions().iter().filter(|transition| matches!(transition.kind, TransitionKind::Jump { .. })).count();
            });
            check_sum(&run.energy());
            let parts = run.energy().defect_parts();
            // Strides err by a ten thousandth each, and thousands of them add up; a part is left of
            // errors of one sign.
            assert!(run.energy().defect().abs() < 1e-2 * tolerance * SLIP_LIMIT, "{kind:?} {tolerance}: {parts:?}");
            assert_eq!((n_jumps, parts.jumps), (0, 0.0), "the reference scene is smooth");
        }
    }
}

#[test]
fn no_step_of_the_reference_scene_is_taken_for_a_jump() {
    for n in [20, 80, 640, 5_000] {
        let mut run = backend(BackendKind::QuasiStatic, &paper_system(paper_springs(4)), at_rest(), 1.0);
        let mut n_onsets = 0;
        drive(run.as_mut(), reference_tips, 1.0, n, |_, run| {
            for transition in run.transitions() {
                assert!(!matches!(transition.kind, TransitionKind::Jump { .. }), "{n}: {transition:?}");
                n_onsets += u32::from(transition.kind == TransitionKind::SlipOnset);
            }
        });
        assert_eq!((n_onsets, run.energy().jumps), (1, 0.0), "{n}");
    }
}
