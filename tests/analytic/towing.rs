//! A load towed at the end of an arm turns into line with the pull.

use cohaul::backend::{BackendKind, Motion};
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::model::PolarSpring;
use cohaul_studies::verify::towing::ARMS;

use crate::common::*;

/// Arm from the load's centre to the point of towing (m).
const ARM: f64 = 0.071594;

/// Heading left of a small one when the end of the arm went `way` (m) along x, over that at `from`
/// (m).
fn heading_left(from: f64, way: f64, n_per_mm: f64) -> f64 {
    let start = Motion { pose: Pose::new(0.0, 0.0, 1e-3), twist: Twist::ZERO };
    // So stiff that it lengthens the arm by 33 nm.
    let spring = PolarSpring { radial_stiffness: 1e6 * RADIAL, ..isotropic(Vec2::new(ARM, 0.0), 0.0) };
    let tip = start.pose.to_world(&spring.root);
    let mut run = backend(BackendKind::QuasiStatic, &paper_system(vec![spring]), start, 1e-3 / n_per_mm);
    run.attach(0, tip);
    run.advance(&[tip + Vec2::new(from, 0.0)], from);
    let before = run.motion().pose.heading;
    run.advance(&[tip + Vec2::new(from + way, 0.0)], way);
    run.motion().pose.heading / before
}

/// Least power: heading' = -b heading / (b^2 + a^2 / 2), a decay over 72.056 mm.
#[test]
fn the_heading_decays_over_its_length() {
    let exact = (ARM * ARM + 0.5 * SUPPORT_RADIUS * SUPPORT_RADIUS) / ARM;
    // Printed with five digits, and for another arm with nine.
    assert_eq!(ARMS[0].0, ARM);
    assert!((exact - ARMS[0].1).abs() < 5e-7);
    let (arm, printed) = ARMS[1];
    assert!(((arm.powi(2) + 0.5 * SUPPORT_RADIUS.powi(2)) / arm - printed).abs() < 1e-10);
    let (from, way) = (0.01, 0.1);
    let lengths = [5.0, 10.0, 20.0].map(|n_per_mm| -way / heading_left(from, way, n_per_mm).ln());
    // First order in the step of 0.05 mm: 72.067 mm was measured elsewhere at some step and
    // heading.
    assert!((lengths[2] - exact).abs() < 1.1e-5 * 5.0);
    // What is left is of second order in the heading, 1e-6, and the spring's stretch, 5e-7.
    assert!((extrapolated(&lengths) / exact - 1.0).abs() < 1e-5);
}
