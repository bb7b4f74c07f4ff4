//! Runs that end without an error and are wrong all the same have not converged.

use cohaul::backend::Status;
use cohaul::backend::rapier::RapierOptions;
use cohaul::math::{Pose, Vec2};
use cohaul::model::{Obstacle, ObstaclePath, Outline, System};

use crate::obstacle_scenes::{RADIUS, let_go, run, standing, wall, without_springs};
use crate::scenes::{at_rest, moving, paper_body, polar};

/// A tip that passes the root of its spring reverses the force within a step.
#[test]
fn energy_from_nowhere_is_no_success() {
    let system = System { springs: vec![polar(0.0)], ..paper_body() };
    let root = system.springs[0].root;
    let past_root = |share: f64| root + Vec2::new(0.03 * (1.0 - 2.0 * share), 1e-5);
    let end = run(&system, Pose::new(0.0, 0.0, 0.0), RapierOptions::default(), 1.0, 2.5e-3, past_root);
    let energy = end.load.energy();
    assert!(energy.defect() > 0.01 * energy.tip_work, "{energy:?}");
    assert_eq!(end.report.status, Status::NotConverged);
    assert!(end.report.gained_share > 0.01 && end.report.n_not_converged > 0, "{:?}", end.report);
}

/// Two walls that close on a load leave it no place.
#[test]
fn a_squeeze_between_obstacles_is_no_success() {
    let closing = |side: f64| {
        let at = |gap: f64| Pose::new(side * (RADIUS + gap), 0.0, 0.0);
        let path = ObstaclePath { waypoints: vec![(0.0, at(1e-3)), (0.1, at(-2e-3))] };
        Obstacle { path, ..standing(wall([0.0, -0.1], [0.0, 0.1])) }
    };
    let system = without_springs(Outline::disc(RADIUS), vec![closing(1.0), closing(-1.0)]);
    let end = let_go(&system, at_rest(Pose::new(0.0, 0.0, 0.0)), RapierOptions::default(), 0.1, 1e-3);
    assert!(end.report.status >= Status::NotConverged, "{:?}", end.report);
}

/// Bounces, slides and stops lose energy at most.
#[test]
fn a_sound_run_gains_nothing() {
    for restitution in [0.0, 0.5, 1.0] {
        let obstacle = Obstacle { restitution, friction_coefficient: 0.4, ..standing(wall([0.03, -1.0], [0.03, 1.0])) };
        let system = without_springs(Outline::disc(RADIUS), vec![obstacle]);
        let end = let_go(&system, moving(Vec2::new(0.8, 0.3), 5.0), RapierOptions::default(), 0.2, 1e-3);
        assert_eq!((end.report.status, end.report.gained_share), (Status::Converged, 0.0), "{restitution} {:?}", end.report);
    }
}
