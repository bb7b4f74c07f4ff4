//! A load at rest between two springs, of which one is let go: the net force is suddenly above the
//! slip limit.

use std::f64::consts::{PI, TAU};

use cohaul::backend::{Backend, BackendKind, EnergyLedger, Status, TransitionKind};
use cohaul::math::{Vec2, direction};
use cohaul_studies::verify::release::JUMPS;

use crate::common::*;

/// Way of the load (f / k) after the release, and its energy.
fn jump(kind: BackendKind, ratio: f64, mass_factor: f64, damping_ratio: f64, n_per_period: u32) -> (f64, EnergyLedger) {
    let (way, energy, _) = logged_jump(kind, ratio, mass_factor, damping_ratio, n_per_period);
    (way, energy)
}

/// The same with shift (m) and energy (J) of the jumps that the backend logged.
fn logged_jump(
    kind: BackendKind,
    ratio: f64,
    mass_factor: f64,
    damping_ratio: f64,
    n_per_period: u32,
) -> (f64, EnergyLedger, Vec<(f64, f64)>) {
    let stretch = ratio * SLIP_LIMIT / RADIAL;
    let mut system = paper_system(vec![isotropic(Vec2::zeros(), damping_ratio); 2]);
    system.load.mass *= mass_factor;
    system.load.inertia *= mass_factor;
    let period = TAU * (system.load.mass / RADIAL).sqrt();
    let tips = [Vec2::new(stretch, 0.0), Vec2::new(-stretch, 0.0)];
    let mut run = backend(kind, &system, at_rest(), period / f64::from(n_per_period));
    run.attach(0, tips[0]);
    run.attach(1, tips[1]);
    run.advance(&tips, period / 8.0);
    // Two pulls that cancel: rest, in the engine up to rounding of rounding.
    assert!(run.motion().pose.position.norm() < 1e-20);
    run.release(1);
    // Three half swings at most; what a dashpot of twice the critical one leaves falls as exp(-0.27
    // omega t): 1e-9 after 12 periods.
    let n_periods = if damping_ratio >= 1.0 { 16.0 } else { 3.0 };
    assert_eq!(run.advance(&tips, n_periods * period).status, Status::Converged);
    let jump = |kind: &TransitionKind| match *kind {
        TransitionKind::Jump { shift, energy, .. } => Some((shift, energy)),
        _ => None,
    };
    let jumps = run.transitions().iter().filter_map(|transition| jump(&transition.kind)).collect();
    (run.motion().pose.position.x * RADIAL / SLIP_LIMIT, run.energy(), jumps)
}

#[test]
fn without_inertia_it_stops_at_the_first_balance_and_the_defect_says_what_is_missing() {
    for (ratio, still, _) in JUMPS {
        for n_per_period in [1, 100] {
            let (way, energy, logged) = logged_jump(BackendKind::QuasiStatic, ratio, 1.0, 0.0, n_per_period);
            // Rounding of stretches of up to 6 f / k in some Newton steps.
            assert!((way - still).abs() < 1e-14, "{ratio}: {way}");
            let missing = (still * SLIP_LIMIT).powi(2) / (2.0 * RADIAL);
            assert!((energy.defect() + missing).abs() < 1e-14 * energy.tip_work, "{ratio}: {} {missing}", energy.defect());
            // One jump of that size, by which the ledger explains all of the defect.
            assert_eq!(logged.len(), 1, "{logged:?}");
            let (shift, lost) = logged[0];
            assert!((shift * RADIAL / SLIP_LIMIT - still).abs() < 1e-14 && (lost - missing).abs() < 1e-14 * energy.tip_work, "{logged:?}");
            let parts = energy.defect_parts();
            assert_eq!((parts.jumps, parts.numerical_damping), (-lost, 0.0));
            assert!(parts.quadrature.abs() < 1e-14 * energy.tip_work, "{parts:?}");
        }
    }
}

#[test]
fn with_inertia_it_overshoots_as_far_again() {
    for kind in WITH_INERTIA {
        for (ratio, _, swung) in JUMPS {
            let ways = [1_000, 2_000, 4_000].map(|n| jump(kind, ratio, 1.0, 0.0, n).0);
            let order = error_ratio(ways[1], ways[2], swung);
            assert!(order > 1.9 && order < 2.1, "{kind:?} {ratio}: {order}");
            // Stops between two steps leave some (omega h)^2 / 8 of six f / k: 1e-6 to 3e-5 over
            // the table.
            assert!((extrapolated(&ways) - swung).abs() < 1e-5 * swung, "{kind:?} {ratio}: {ways:?}");
        }
    }
}

/// Up to three times the limit the overshoot is the same for every mass: mass to zero alone does
/// not lead to the method without inertia.
#[test]
fn the_overshoot_does_not_depend_on_the_mass() {
    for kind in WITH_INERTIA {
        for (ratio, _, swung) in JUMPS.into_iter().filter(|(ratio, ..)| *ratio <= 3.0) {
            for mass_factor in [1e-6, 1e-2, 30.0] {
                let ways = [500, 1_000].map(|n| jump(kind, ratio, mass_factor, 0.0, n).0);
                // Some (omega h)^2 at the coarser step, 1.6e-4.
                assert!((extrapolated(&ways) - swung).abs() < 2e-4, "{kind:?} {ratio} {mass_factor}: {ways:?}");
            }
        }
    }
}

/// One swing of a damped load overshoots by exp(-pi zeta / sqrt(1 - zeta^2)), and a load damped
/// critically or more does not.
#[test]
fn a_dashpot_takes_the_overshoot() {
    for kind in WITH_INERTIA {
        for damping_ratio in [0.1f64, 0.3, 0.6, 1.0, 2.0] {
            let overshoot =
                if damping_ratio < 1.0 { (-PI * damping_ratio / (1.0 - damping_ratio * damping_ratio).sqrt()).exp() } else { 0.0 };
            for (ratio, still, _) in JUMPS.into_iter().filter(|(ratio, ..)| *ratio <= 3.0) {
                let ways = [500, 1_000].map(|n| jump(kind, ratio, 1.0, damping_ratio, n).0);
                let exact = still * (1.0 + overshoot);
                // As above.
                assert!((extrapolated(&ways) - exact).abs() < 2e-4, "{kind:?} {damping_ratio} {ratio}: {ways:?} {exact}");
            }
        }
    }
}

/// While a load slips and turns, a second spring is grasped: where its tip rests, or off it by a
/// micrometre. Whether it jumps, and how many friction problems the next step takes.
fn grasp_on_the_way(off: f64) -> (usize, u64) {
    let system = paper_system(paper_springs(2));
    let mut run = backend(BackendKind::QuasiStatic, &system, at_rest(), 0.0025);
    let tip = |k: usize, run: &dyn Backend| run.motion().pose.to_world(&system.springs[k].rest_tip());
    let mut targets = vec![tip(0, run.as_ref()); 2];
    run.attach(0, targets[0]);
    for _ in 0..400 {
        targets[0] += 1.25e-4 * direction(1.2);
        run.advance(&targets, 0.0025);
    }
    assert!(run.motion().twist.linear.norm() > 0.003 && run.motion().twist.angular.abs() > 0.1, "it slips and turns: {:?}", run.motion());
    targets[1] = tip(1, run.as_ref()) + Vec2::new(off, 0.0);
    run.attach(1, targets[1]);
    targets[0] += 1.25e-4 * direction(1.2);
    let report = run.advance(&targets, 0.0025);
    assert_eq!(report.status, Status::Converged);
    let n_jumps = run.transitions().iter().filter(|transition| matches!(transition.kind, TransitionKind::Jump { .. })).count();
    (n_jumps, report.n_steps)
}

/// A spring that does not pull leaves the load in its balance, and the balance of a step is not
/// sought again for tips that stand.
#[test]
fn a_grasp_of_a_tip_at_rest_is_no_jump() {
    assert_eq!(grasp_on_the_way(0.0), (0, 1));
    let (n_jumps, n_steps) = grasp_on_the_way(1e-6);
    assert!(n_jumps == 1 && n_steps > 1, "{n_jumps} {n_steps}");
}
