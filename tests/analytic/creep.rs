//! Below the limit nothing creeps.

use cohaul::backend::{BackendKind, Motion, Status};
use cohaul::math::{Pose, Twist, Vec2};

use crate::common::*;

/// Way (m) of the load in a minute, turned and away from the origin, pulled across its first
/// support at `arm` by 0.9 of the critical force.
fn way_in_a_minute(kind: BackendKind, arm: f64) -> f64 {
    let start = Motion { pose: Pose::new(0.11, -0.07, 0.83), twist: Twist::ZERO };
    let (a, b) = (SUPPORT_RADIUS, arm);
    let critical = SLIP_LIMIT * a * (b + a) / (b * b + a * b + a * a);
    // Support 0 lies along y.
    let root = Vec2::new(0.0, arm);
    let tip = start.pose.to_world(&(root + Vec2::new(0.9 * critical / RADIAL, 0.0)));
    let mut run = backend(kind, &paper_system(vec![isotropic(root, 0.0)]), start, 1e-3);
    run.attach(0, start.pose.to_world(&root));
    assert_eq!(run.advance(&[tip], 0.05).status, Status::Converged);
    assert_eq!(run.advance(&[tip], 60.0).status, Status::Converged);
    distance(&start.pose, &run.motion().pose)
}

#[test]
fn a_load_below_its_limit_stays_for_a_minute() {
    for kind in BackendKind::ALL {
        for arm in [0.0, SUPPORT_RADIUS, LOAD_RADIUS + REST_LENGTH] {
            // Asked for is 1 nm. Rest is exact in the exact methods; in the engine some steps may
            // leave rounding, which does not add up.
            let way = way_in_a_minute(kind, arm);
            assert!(way < if kind == BackendKind::Rapier { 1e-14 } else { f64::MIN_POSITIVE }, "{kind:?} {arm}: {way:e}");
        }
    }
}
