//! A force along y at (b, 0): the force at which the load slips, and about which point (-h, 0).
//! Supports at distance one, sum of limits one.

use cohaul::backend::friction::{ContactMode, FrictionSolution, FrictionSolver};
use cohaul::math::{Mat3, Vec3, direction};
use cohaul::model::{Ground, SupportPoint};

use crate::common::*;

/// Three supports, the first of them at `bearing` (rad).
fn supports(bearing: f64) -> Ground {
    let at = |i: i32| SupportPoint {
        offset: direction(bearing + f64::from(i) * std::f64::consts::TAU / 3.0),
        normal_load: 1.0 / 3.0,
        friction_coefficient: None,
    };
    Ground { friction_coefficient: 1.0, supports: (0..3).map(at).collect() }
}

fn pulled(ground: &Ground, arm: f64, force: f64) -> FrictionSolution {
    FrictionSolver::new(ground, 1.0).solve(&Mat3::identity(), &Vec3::new(0.0, force, arm * force))
}

/// h at the onset above `force`, which must be the critical one to a billionth.
fn centre_at_onset(ground: &Ground, arm: f64, force: f64) -> (f64, ContactMode) {
    assert_eq!(pulled(ground, arm, (1.0 - 1e-9) * force).mode, ContactMode::Stick, "{arm}");
    let slip = pulled(ground, arm, (1.0 + 1e-9) * force);
    assert!(slip.mode != ContactMode::Stick && slip.increment.z > 0.0, "{arm}: {slip:?}");
    // A force along y and mirrored supports: no motion along x, to rounding over the hair.
    assert!(slip.increment.x.abs() < 1e-5 * slip.increment.norm(), "{arm}: {slip:?}");
    (slip.increment.y / slip.increment.z, slip.mode)
}

/// The excess of a billionth turns the direction by about as much; rounding over it by 1e-6.
const CENTRE_TOLERANCE: f64 = 1e-6;

/// A support toward the pull. F* / f = a (b + a) / (b^2 + a b + a^2), h = a^2 (2 b + a) / (b (b + 2
/// a)), found by search and proved on paper.
#[test]
fn toward_a_support() {
    let ground = supports(0.0);
    for (b, force, h) in [
        (0.5, 6.0 / 7.0, 1.6),
        (1.0, 2.0 / 3.0, 1.0),
        (2.0, 3.0 / 7.0, 0.625),
        ((LOAD_RADIUS + REST_LENGTH) / SUPPORT_RADIUS, 0.203748281734, 0.328390943607),
    ] {
        assert!(((b + 1.0) / (b * b + b + 1.0) - force).abs() < 1e-12 && ((2.0 * b + 1.0) / (b * (b + 2.0)) - h).abs() < 1e-12);
        let (centre, _) = centre_at_onset(&ground, b, force);
        assert!((centre - h).abs() < CENTRE_TOLERANCE, "{b}: {centre} {h}");
    }
}

/// A support on the far side is itself the centre while b / a lies between 2 - sqrt 3 and 2 + sqrt
/// 3: F* / f = (2 / sqrt 3) / (1 + b / a).
#[test]
fn away_from_a_support() {
    let ground = supports(std::f64::consts::PI);
    let edge = 3f64.sqrt();
    for b in [2.0 - edge + 1e-3, 0.5, 1.0, 2.0, 3.0, 2.0 + edge - 1e-3] {
        let force = 2.0 / 3f64.sqrt() / (1.0 + b);
        let (centre, mode) = centre_at_onset(&ground, b, force);
        assert_eq!(mode, ContactMode::Pinned(0), "{b}");
        // The pivot is exact.
        assert!((centre - 1.0).abs() < 1e-13, "{b}: {centre}");
    }
    assert!((2.0 / 3f64.sqrt() / 2.0 - 0.577350269190f64).abs() < 1e-12);
    for b in [2.0 - edge - 1e-2, 2.0 + edge + 1e-2] {
        let force = 2.0 / 3f64.sqrt() / (1.0 + b);
        assert_eq!(pulled(&ground, b, 1.01 * force).mode, ContactMode::Slip, "{b}");
    }
    // At the tip of a spring of the paper, which is beyond.
    let (centre, mode) = centre_at_onset(&ground, (LOAD_RADIUS + REST_LENGTH) / SUPPORT_RADIUS, 0.199942252731);
    assert_eq!(mode, ContactMode::Slip);
    assert!((centre - 0.65435334281).abs() < CENTRE_TOLERANCE, "{centre}");
}
