//! Springs as explicit forces: symplectic Euler, right below its limit and lost above.

use std::f64::consts::TAU;

use cohaul::backend::rapier::{EngineSettings, FrictionModel, Precision, RapierOptions, SpringModel};
use cohaul::backend::{Motion, Status};
use cohaul::math::{Pose, Vec2};
use cohaul::model::{PolarSpring, System};

use crate::scenes::{MASS, SLIP_LIMIT, at_rest, backend, busy_system, busy_tips, isotropic, moving, peers_body};

const STIFFNESS: f64 = 0.664;
const FORCE: RapierOptions = RapierOptions {
    friction: FrictionModel::Aligned,
    springs: SpringModel::Force,
    precision: Precision::F64,
    settings: EngineSettings::Recommended,
};

/// A load without friction on a spring through its centre.
fn swing(damping_ratio: f64) -> System {
    let mut system = peers_body();
    system.ground.friction_coefficient = 0.0;
    system.springs = vec![PolarSpring { damping_ratio, ..isotropic(Vec2::zeros()) }];
    system
}

/// Places of the load over the amplitude, step by step, for steps of omega h.
fn places(system: &System, rate: f64, n_steps: usize, options: RapierOptions) -> Vec<f64> {
    let step = rate / (STIFFNESS / MASS).sqrt();
    let amplitude = 1e-3;
    let mut run = backend(system, at_rest(Pose::new(amplitude, 0.0, 0.0)), step, options);
    run.attach(0, Vec2::zeros());
    let place = |_| {
        assert_ne!(run.advance(&[Vec2::zeros()], step).status, Status::Failed);
        run.motion().pose.position.x / amplitude
    };
    (0..n_steps).map(place).collect()
}

/// x_n+1 = (2 - (omega h)^2) x_n - x_n-1: what symplectic Euler does to a spring.
#[test]
fn a_swing_is_that_of_symplectic_euler() {
    for rate in [0.1, 0.5, 1.9] {
        let (mut before, mut now) = (1.0, 1.0 - rate * rate);
        for (n, place) in places(&swing(0.0), rate, 40, FORCE).into_iter().enumerate() {
            // Forty roundings of one, which near the limit grow as n.
            assert!((place - now).abs() < 1e-12, "{rate} {n}: {place} {now}");
            (before, now) = (now, (2.0 - rate * rate) * now - before);
        }
    }
}

/// The explicit force is lost from omega h = 2 on, with dashpots from 2 (sqrt(1 + zeta^2) - zeta);
/// an implicit spring never.
#[test]
fn a_hair_below_its_limit_it_swings_and_a_hair_above_it_is_lost() {
    for damping_ratio in [0.0f64, 0.3] {
        let limit = 2.0 * ((1.0 + damping_ratio * damping_ratio).sqrt() - damping_ratio);
        let system = swing(damping_ratio);
        let largest = |rate: f64, options| places(&system, rate, 400, options).iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        // Swings are bounded by 1 / sqrt(1 - (omega h / 2)^2) = 10 at 0.995 of the limit; dashpots
        // only take from that.
        assert!(largest(0.995 * limit, FORCE) < 10.1, "{damping_ratio}");
        // At 1.005 of it each step multiplies by 1.22 without dashpots, by 1.03 with these.
        assert!(largest(1.005 * limit, FORCE) > 20.0, "{damping_ratio}");
        assert!(largest(1.005 * limit, RapierOptions { springs: SpringModel::Joint, ..FORCE }) <= 1.0);
    }
}

/// In single precision and with the engine's own substeps, which hold the force, too.
#[test]
fn it_sticks_below_the_limit_of_friction_and_slides_above() {
    for precision in [Precision::F64, Precision::F32] {
        for (share, moves) in [(0.99, false), (1.05, true)] {
            let mut system = peers_body();
            system.springs = vec![isotropic(Vec2::zeros())];
            let mut run = backend(&system, at_rest(Pose::new(0.0, 0.0, 0.0)), 1e-3, RapierOptions { precision, ..FORCE });
            let tip = Vec2::new(share * SLIP_LIMIT / STIFFNESS, 0.0);
            run.attach(0, tip);
            run.advance(&[tip], 1.0);
            // Let go at F it moves by (F - f) / k to twice that, 1.65 mm to 3.3 mm; in f32 a hold
            // is good to 1e-7 of the force.
            let way = run.motion().pose.position.x;
            assert_eq!(way > 1.6e-3 && way < 3.4e-3, moves, "{precision:?} {share}: {way}");
            assert!(moves || way.abs() < 1e-9, "{precision:?} {way}");
        }
    }
}

/// Both converge to the same motion, so their difference is first order in the step.
#[test]
fn with_shorter_steps_forces_and_joints_become_one() {
    let end = |step: f64, springs| -> Motion {
        let mut run = backend(&busy_system(0.1), moving(Vec2::new(0.05, 0.02), 1.0), step, RapierOptions { springs, ..FORCE });
        (0..3).for_each(|spring| run.attach(spring, busy_tips(0.0)[spring]));
        for tick in 1..=40 {
            run.advance(&busy_tips(5e-3 * f64::from(tick)), 5e-3);
        }
        run.motion()
    };
    let gap = |step| {
        let [force, joint] = [SpringModel::Force, SpringModel::Joint].map(|springs| end(step, springs).pose);
        (force.position - joint.position).norm()
    };
    let (coarse, fine) = (gap(5e-4), gap(2.5e-4));
    assert!(fine > 0.0 && (coarse / fine - 2.0).abs() < 0.2, "{coarse} {fine}");
}

/// A dashpot takes energy from a swing whichever way it is posed, and the ledger knows.
#[test]
fn the_ledger_of_an_explicit_dashpot_closes_with_the_step() {
    let worst_defect = |step: f64| {
        let mut run = backend(&swing(0.1), at_rest(Pose::new(1e-3, 0.0, 0.0)), step, FORCE);
        run.attach(0, Vec2::zeros());
        let mut worst: f64 = 0.0;
        let n_steps = (TAU / (STIFFNESS / MASS).sqrt() / step).round() as usize;
        for _ in 0..n_steps {
            run.advance(&[Vec2::zeros()], step);
            worst = worst.max(run.energy().defect().abs() / run.energy().tip_work);
        }
        // A period at zeta = 0.1 leaves exp(-4 pi zeta) = 0.28 of the energy.
        assert!((run.energy().damping / run.energy().tip_work - 0.72).abs() < 0.03, "{:?}", run.energy());
        worst
    };
    let [coarse, fine] = [2e-3, 1e-3].map(worst_defect);
    // Symplectic Euler keeps an energy that differs from the true one by omega h / 2 of it at most.
    assert!((coarse / fine - 2.0).abs() < 0.2 && fine < 0.5 * 1e-3 * (STIFFNESS / MASS).sqrt(), "{coarse} {fine}");
}
