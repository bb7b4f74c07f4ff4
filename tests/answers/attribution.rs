//! Attribution of inertia effects on scenes whose cause is known by construction, by `compare` and
//! by the estimate of `run`.

use std::path::Path;

use cohaul::analysis::compare::{Pathwise, Settings, ThreeWay};
use cohaul::analysis::estimate::InertiaEstimate;
use cohaul::analysis::{ByTrigger, TriggerKind};
use cohaul::scenario::Scenario;
use rayon::prelude::*;
use serde_json::{Value, json};

fn compared(scenario: &Scenario) -> Pathwise {
    ThreeWay::new(scenario, &Settings::default()).prescribed(|_| true).unwrap()
}

fn stored(name: &str) -> Scenario {
    Scenario::read(Path::new(&format!("scenarios/{name}.json"))).unwrap()
}

/// The paper's load on springs through its centre along x, with a tip path for each.
fn on_springs(damping_ratio: f64, speed: f64, paths: &[Value], walls: &[f64]) -> Scenario {
    let spring = json!({
        "root_m": [0.0, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.0, "radial_stiffness_n_per_m": 0.664,
        "torsional_stiffness_nm_per_rad": 0.0, "damping_ratio": damping_ratio
    });
    let wall = |x: &f64| json!({ "name": "wall", "restitution": 0.8, "outline": { "polyline": { "points_m": [[x, -0.1], [x, 0.1]] } } });
    let file = json!({
        "name": "springs", "duration_s": 2.0, "control_period_s": 0.0025,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122, "velocity_m_per_s": [0.0, speed] },
        "ground": { "friction_coefficient": 1.4, "gravity_m_per_s2": 9.81, "supports": { "tripod": { "radius_m": 0.0081333 } } },
        "springs": paths.iter().map(|_| &spring).collect::<Vec<_>>(), "obstacles": walls.iter().map(wall).collect::<Vec<_>>(),
        "drive": { "kind": "tips", "paths": paths }
    });
    Scenario::parse(&file.to_string(), "springs").unwrap()
}

fn tip(spring: usize, waypoints: &[[f64; 2]]) -> Value {
    json!({ "spring": spring, "waypoints": waypoints.iter().map(|[time, x]| [*time, *x, 0.0]).collect::<Vec<_>>() })
}

/// Part of the largest effect, by name.
fn largest(by_trigger: &ByTrigger) -> &'static str {
    by_trigger.named().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0
}

/// Each scene has one large disturbance, by construction; both ways of finding the effect name it,
/// and the first divergence does as well.
#[test]
fn the_cause_that_is_built_in_is_named() {
    let moving = |speed: f64| tip(0, &[[0.0, 0.0], [2.0, 2.0 * speed]]);
    let scenes = [
        // A load without springs coasts.
        (stored("analytic/slide"), "start", TriggerKind::Start, None),
        // A pull aside, below the slip limit, leaves it so.
        (on_springs(0.0, 0.2, &[tip(0, &[[0.0, 0.01]])], &[]), "start", TriggerKind::Start, None),
        (stored("analytic/release-jump"), "release", TriggerKind::Release, Some(1)),
        // A tip grasps at 2.4 times the stretch of the slip limit, and moves no more.
        (on_springs(0.0, 0.0, &[tip(0, &[[0.5, 0.08]])], &[]), "grasp", TriggerKind::Grasp, Some(0)),
        (on_springs(0.7, 0.0, &[tip(0, &[[0.5, 0.08]])], &[]), "grasp", TriggerKind::Grasp, Some(0)),
        // One constant speed.
        (stored("analytic/centre-pull"), "slip onset", TriggerKind::SlipOnset, None),
        (on_springs(0.0, 0.0, &[moving(0.05)], &[]), "slip onset", TriggerKind::SlipOnset, None),
        // A load that follows calmly, and whose tip becomes ten times as fast, at a tick and
        // between two ticks.
        (on_springs(0.7, 0.0, &[tip(0, &[[0.0, 0.03], [1.5, 0.06], [2.0, 0.16]])], &[]), "driving", TriggerKind::Driving, None),
        (on_springs(0.7, 0.0, &[tip(0, &[[0.0, 0.03], [1.5012, 0.06], [2.0, 0.16]])], &[]), "driving", TriggerKind::Driving, None),
        // The stop of a tip after most of a half swing counts more than the onset.
        (stored("analytic/ramp-and-hold"), "driving", TriggerKind::Driving, None),
    ];
    scenes.par_iter().enumerate().for_each(|(at, (scenario, name, kind, spring))| {
        let found = compared(scenario);
        let (measured, estimated) = (found.edge_displacement.by_trigger, InertiaEstimate::of(scenario, &found.solutions[0].trace));
        assert_eq!(largest(&measured), *name, "{at}: {measured:?}");
        assert_eq!(largest(&estimated.by_trigger), *name, "{at}: {estimated:?}");
        let trigger = estimated.largest.unwrap().trigger;
        assert_eq!((trigger.kind, trigger.spring), (*kind, *spring), "{at}: {estimated:?}");
        // Where only one disturbance exceeds the tolerance, the paths diverge after it.
        let n_beyond = measured.named().filter(|(_, part)| *part > found.tolerance_m).count();
        if let Some(first) = found.first_divergence.inertia_effect.filter(|_| n_beyond == 1) {
            let trigger = first.trigger.unwrap();
            assert_eq!((trigger.kind, trigger.spring), (*kind, *spring), "{at}: {first:?}");
        }
    });
}

/// A damped load that is towed into a wall and rebounds: from the impact on, the effect belongs to
/// the contact. Without the wall, none does.
#[test]
fn an_impact_is_a_contact() {
    // Spring and dashpot pull with less than the slip limit at first.
    let scene = |walls: &[f64]| on_springs(0.7, 0.0, &[tip(0, &[[0.0, 0.029], [1.5, 0.1]])], walls);
    let [with, without] = [&[0.04][..], &[]].map(|walls| compared(&scene(walls)).edge_displacement.by_trigger);
    // It comes back at 0.8 of the speed. Friction and the spring, which pulls with the slip limit,
    // stop it within (e v)^2 / (4 mu g), and the dashpot sooner.
    let free = (0.8 * 0.071f64 / 1.5).powi(2) / (4.0 * 1.4 * 9.81);
    assert!((0.5..1.0).contains(&(with.contact_m / free)) && without.contact_m == 0.0, "{free} {with:?} {without:?}");
    assert_eq!((with.start_m, with.jumps_m), (0.0, 0.0));
}

/// A load that coasts before a release makes it overshoot: each has its own part.
#[test]
fn two_causes_have_a_part_each() {
    let mut scenario = stored("analytic/release-jump");
    scenario.control_period = 0.02;
    scenario.start.twist.angular = 30.0;
    let found = compared(&scenario);
    let by_trigger = found.edge_displacement.by_trigger;
    assert!(by_trigger.start_m > found.tolerance_m && by_trigger.release_m > found.tolerance_m, "{by_trigger:?}");
    assert_eq!((by_trigger.grasp_m, by_trigger.contact_m), (0.0, 0.0), "{by_trigger:?}");
    assert_eq!(found.first_divergence.inertia_effect.unwrap().trigger.unwrap().kind, TriggerKind::Start);
}
