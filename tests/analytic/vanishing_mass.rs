//! As the mass goes to zero at fixed friction, the reference dynamics becomes the method without
//! inertia: as the square root of the mass where the load starts to slip, with the mass itself at
//! the end.

use cohaul::backend::BackendKind;
use cohaul::math::Pose;

use crate::common::*;

/// Poses at all n steps of the first `duration` (s) of the reference scene with this mass (kg) and
/// the paper's friction.
fn path(kind: BackendKind, mass: f64, duration: f64, n: u32) -> Vec<Pose> {
    let mut system = paper_system(paper_springs(4));
    system.load.mass = mass;
    system.load.inertia = 0.5 * mass * LOAD_RADIUS * LOAD_RADIUS;
    let mut poses = Vec::new();
    drive(backend(kind, &system, at_rest(), 1.0).as_mut(), reference_tips, duration, n, |_, run| poses.push(run.motion().pose));
    poses
}

/// Largest distance on the way and distance at the end between the two methods at the same step
/// (m).
fn gaps(mass: f64, duration: f64, n: u32) -> (f64, f64) {
    let still = path(BackendKind::QuasiStatic, MASS, duration, n);
    let moving = path(BackendKind::Inertial, mass, duration, n);
    let gaps: Vec<f64> = still.iter().zip(&moving).map(|(one, other)| (one.position - other.position).norm()).collect();
    (gaps.iter().copied().fold(0.0, f64::max), *gaps.last().unwrap())
}

#[test]
fn the_gap_closes_with_the_mass() {
    let n = 8_000;
    let found = [1.6e-3, 4e-4, 1e-4, 2.5e-5, 6.25e-6].map(|mass| gaps(mass, 1.0, n));
    // An independent program found 1.34, 0.474, 0.122, 0.0328 and 0.0076 mm at a step of its own;
    // the largest gap is where the step matters most.
    for ((largest, _), known) in found.into_iter().zip([1.34e-3, 4.74e-4, 1.22e-4, 3.28e-5, 7.6e-6]) {
        assert!((largest / known - 1.0).abs() < 0.2, "{largest:e} {known:e}");
    }
    for pair in found.windows(2) {
        assert!(pair[1].0 < 0.4 * pair[0].0 && pair[1].1 < 0.4 * pair[0].1, "{found:?}");
    }
    // Where the load only follows, inertia is a force of the mass times its acceleration: the first
    // power, reached to a tenth for the lightest.
    assert!((power(found[3].1, found[4].1) - 1.0).abs() < 0.1, "{found:?}");
}

/// At the onset the load is as fast as without inertia only after a swing, of amplitude v / omega:
/// the square root of the mass.
#[test]
fn the_gap_at_the_onset_closes_with_the_square_root_of_the_mass() {
    // From the onset at 58 ms some swings of the lightest; its step is a hundredth of a radian.
    let found = [1.6e-5, 4e-6, 1e-6].map(|mass| gaps(mass, 0.09, 20_000).0);
    for pair in found.windows(2) {
        // The tips' paths bend within a swing of the heaviest.
        assert!((power(pair[0], pair[1]) - 0.5).abs() < 0.05, "{found:?}");
    }
}

/// Power of the mass by which a gap shrinks when the mass is quartered.
fn power(heavy: f64, light: f64) -> f64 {
    (heavy / light).ln() / 4f64.ln()
}

/// Without mass to speak of one step of both is the same minimisation: the gap is what M / h^2
/// weighs beside the stiffness, and not zero.
#[test]
fn next_to_no_mass_is_no_mass() {
    for n in [200, 2_000] {
        let (largest, _) = gaps(1e-14, 1.0, n);
        assert!(largest < 1e-12 && largest > 0.0, "{n}: {largest:e}");
    }
}
