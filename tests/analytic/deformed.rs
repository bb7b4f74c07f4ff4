//! Springs that are deformed far: the default step with inertia is that of the springs as they are
//! attached, or the run reports that it is too long.

use std::path::Path;

use cohaul::backend::{BackendKind, BackendOptions, Status, StepReport, Tolerance};
use cohaul::math::{Pose, Vec2};
use cohaul::scenario::{Drive, Scenario, TipPath, Waypoint};
use cohaul::simulation::{Keep, Simulation};

use crate::common::*;

/// The paper's load on one of its springs, with a tip on this path for `duration` (s).
fn scene(waypoints: &[[f64; 3]], duration: f64) -> Scenario {
    let path = TipPath {
        spring: 0,
        waypoints: waypoints.iter().map(|[time, x, y]| Waypoint { time: *time, position: Vec2::new(*x, *y) }).collect(),
        release: None,
    };
    Scenario {
        name: "deformed".to_owned(),
        duration,
        control_period: 2.5e-3,
        seed: 1,
        system: paper_system(paper_springs(1)),
        start: at_rest(),
        drive: Drive::Tips(vec![path]),
    }
}

fn run(scenario: &Scenario, options: &BackendOptions) -> (Pose, StepReport) {
    let mut run = Simulation::new(scenario, options, Keep::Outcome);
    run.run(|_| true);
    let outcome = run.outcome();
    (outcome.motion.pose, outcome.steps)
}

fn default_options(scenario: &Scenario) -> BackendOptions {
    BackendOptions::at_step(None, BackendKind::Inertial, &scenario.system, scenario.control_period)
}

fn exact(scenario: &Scenario) -> Pose {
    let (pose, steps) = run(scenario, &BackendOptions::within(BackendKind::Inertial, Tolerance::at_edge(1e-6, &scenario.system.load)));
    assert_eq!(steps.status, Status::Converged);
    pose
}

/// Largest edge displacement between two poses (m).
fn apart(scenario: &Scenario, one: &Pose, other: &Pose) -> f64 {
    one.edge_displacement(other, scenario.system.load.radius)
}

/// A tip jumps by a metre: the tension of the spring turns the load at once. The default step
/// follows, and is nearer to the answer than the step for a spring at rest.
#[test]
fn a_tip_that_jumps_by_a_metre_is_followed() {
    let rest_tip = paper_springs(1)[0].rest_tip();
    let jump = [0.0, rest_tip.x, rest_tip.y];
    let scenario = scene(&[jump, [1e-4, rest_tip.x + 0.6, rest_tip.y + 0.8]], 0.05);
    let (known, options) = (exact(&scenario), default_options(&scenario));
    let way = apart(&scenario, &known, &scenario.start.pose);
    let (adapted, steps) = run(&scenario, &options);
    let (plain, _) = run(&scenario, &BackendOptions { adapts_step: false, ..options });
    let errors = [&adapted, &plain].map(|pose| apart(&scenario, pose, &known) / way);
    assert!(errors[0] < 1e-3 && errors[0] < errors[1], "{errors:?}");
    assert_eq!(steps.unresolved_rad, 0.0);
}

/// A tip that is attached a nanometre from the root resists a motion across the spring with
/// kappa_tau / l^2: no step that is taken by default resolves that, and the run reports it.
#[test]
fn a_grasp_at_the_root_is_followed_or_reported() {
    let root = paper_springs(1)[0].root;
    for (gap, is_resolved) in [(1e-9, false), (5e-3, true)] {
        let tip = [root.x + gap, root.y];
        let scenario = scene(&[[0.0, tip[0], tip[1]], [0.05, tip[0], tip[1] + 2e-3]], 0.05);
        let (found, steps) = run(&scenario, &default_options(&scenario));
        let is_clean = steps.unresolved_rad == 0.0 && steps.status == Status::Converged;
        assert_eq!(is_clean, is_resolved, "{gap:e}: {steps:?}");
        if is_resolved {
            let error = apart(&scenario, &found, &exact(&scenario));
            assert!(error < 1e-5, "{gap:e}: {error:e}");
        }
    }
}

/// Springs near their rest shapes leave the default step as it is, to the last bit.
#[test]
fn moderate_deformations_change_nothing() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/paper/four-tips-prescribed.json");
    let scenario = Scenario::read(&path).unwrap();
    let options = default_options(&scenario);
    assert!(options.adapts_step);
    assert_eq!(run(&scenario, &options), run(&scenario, &BackendOptions { adapts_step: false, ..options }));
}
