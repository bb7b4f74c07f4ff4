//! Loads that a pusher presses against what does not give way: the run ends there and names both.

use cohaul::backend::{BackendKind, BackendOptions, Status, Tolerance, TransitionKind};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Cause, Health, Keep, Outcome, Simulation};
use rayon::prelude::*;
use serde_json::{Value, json};

const EXACT: [BackendKind; 2] = [BackendKind::QuasiStatic, BackendKind::Inertial];
/// Speed of the pusher (m/s), and the way that it goes before the box is pressed (m).
const SPEED: f64 = 0.05;
const WAY: f64 = 0.02;
const CONTROL_PERIOD: f64 = 0.02;

/// A box of 0.2 m by 0.1 m that a disc of radius 0.02 m pushes from the left, `beside` (m) its
/// middle, toward an obstacle on its right.
fn scenario(obstacle: &Value, beside: f64) -> Scenario {
    let text = json!({
        "name": "squeezed", "duration_s": 2.0, "control_period_s": CONTROL_PERIOD,
        "load": {
            "mass_kg": 1.0, "outline": { "rectangle": { "size_m": [0.2, 0.1] } }, "side_friction_coefficient": 0.2,
        },
        "ground": { "friction_coefficient": 0.3, "supports": { "uniform": { "n": 4 } } },
        "springs": [],
        "obstacles": [
            obstacle,
            {
                "name": "robot", "outline": { "disc": { "radius_m": 0.02 } }, "friction_coefficient": 0.2,
                "path": { "waypoints": [[0.0, -0.125, beside, 0.0], [2.0, -0.125 + 2.0 * SPEED, beside, 0.0]] },
            },
        ],
        "drive": { "kind": "tips", "paths": [] },
    });
    Scenario::parse(&text.to_string(), "squeezed").expect("a scenario")
}

fn run(scenario: &Scenario, options: &BackendOptions) -> (Outcome, Vec<usize>) {
    let mut run = Simulation::new(scenario, options, Keep::Trace);
    run.run(|_| true);
    let (trace, outcome) = run.into_results();
    let squeezes = trace.transitions.iter().filter(|it| matches!(it.kind, TransitionKind::Squeeze { .. }));
    (outcome, squeezes.filter_map(|it| it.kind.obstacle()).collect())
}

/// The pusher goes 0.005 m to the box, and the box 0.015 m to the wall. From then on the pusher
/// goes into it, and a run ends before it is a fiftieth of the radius deep.
#[test]
fn a_box_between_a_wall_and_a_pusher_ends_the_run_when_it_is_pressed() {
    let wall =
        json!({ "name": "wall", "outline": { "polyline": { "points_m": [[0.115, -1.0], [0.115, 1.0]] } }, "friction_coefficient": 0.2 });
    let scenario = scenario(&wall, 0.0);
    let radius = scenario.system.load.radius;
    let pressed_at = WAY / SPEED;
    let latest = pressed_at + 0.02 * radius / SPEED + CONTROL_PERIOD;
    for kind in EXACT {
        let by_default = BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
        for options in [by_default, BackendOptions::within(kind, Tolerance::at_edge(1e-5, &scenario.system.load))] {
            let (outcome, squeezes) = run(&scenario, &options);
            let (name, failed_at) = (kind.name(), outcome.failed_at.expect("the run ends"));
            assert_eq!(outcome.steps.status, Status::Failed, "{name}");
            // A control period ends in it, or the load is pressed at its end.
            assert!(pressed_at - CONTROL_PERIOD <= failed_at && failed_at <= latest, "{name}: {failed_at} for {pressed_at}");
            let worst = outcome.account.worst().expect("it has failed");
            assert_eq!((worst.cause, worst.health, worst.since_s), (Cause::Squeezed, Health::Failed, Some(failed_at)), "{name}");
            assert!(!outcome.account.findings.iter().any(|finding| finding.cause == Cause::NoSolution), "{name}");
            assert_eq!(squeezes, [0, 1], "{name}");
        }
    }
}

/// The pusher beside the middle turns the box about a post until it has passed it, or is pressed
/// into it. No run goes on with a load that lies in an obstacle, and one that gains energy has
/// failed.
#[test]
fn no_run_goes_on_inside_an_obstacle() {
    let tasks: Vec<_> = EXACT.into_iter().flat_map(|kind| (0..10).map(move |at| (kind, 0.004 * f64::from(at)))).collect();
    tasks.into_par_iter().for_each(|(kind, beside)| {
        let post = json!({
            "name": "post", "outline": { "disc": { "radius_m": 0.01 } }, "position_m": [0.115, 0.01], "friction_coefficient": 0.2,
        });
        let scenario = scenario(&post, beside);
        let options = BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
        let (outcome, squeezes) = run(&scenario, &options);
        let depth = outcome.steps.doubts.overlap_m / scenario.system.load.radius;
        let name = format!("{} {beside}: {:?} {depth} {squeezes:?}", kind.name(), outcome.steps.status);
        assert_eq!(outcome.steps.status == Status::Failed, !squeezes.is_empty(), "{name}");
        assert_eq!(depth > 0.01, !squeezes.is_empty(), "{name}");
        // A finite step may lead out of a jam, and gains energy.
        assert!(!outcome.account.gained_energy() || outcome.account.health == Health::Failed, "{name}");
    });
}
