//! Ants that are too far from the load to sense a tip are passed over: nobody notices, and the
//! count says how often.

use cohaul::backend::{BackendKind, BackendOptions, Skip, Skips, default_step};
use cohaul::model::ant::Ant;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Ants, Keep, Simulation};
use serde_json::{Value, json};

fn ants(n_ants: usize, n_springs: usize, drive: Value) -> Scenario {
    let mut file = json!({
        "name": "ants", "duration_s": 3.0, "control_period_s": 0.0025, "seed": 5,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122, "position_m": [0.03, -0.02], "heading_rad": 0.4 },
        "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.008 } } },
        "springs": [{ "ring": { "n": n_springs, "radius_m": 0.0122, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
            "torsional_stiffness_nm_per_rad": 4.52e-4 } }],
        "drive": { "kind": "ants", "n_ants": n_ants, "nest_position_m": [0.2, -0.17] }
    });
    file["drive"].as_object_mut().unwrap().extend(drive.as_object().unwrap().clone());
    Scenario::parse(&file.to_string(), "ants").unwrap()
}

/// Every digit of a run, and how many ants were passed over; the former without the latter.
fn run(scenario: &Scenario, skips: Skips) -> (String, u64) {
    let step = default_step(BackendKind::QuasiStatic, &scenario.system, scenario.control_period);
    let mut run = Simulation::new(scenario, &BackendOptions { skips, ..BackendOptions::new(BackendKind::QuasiStatic, step) }, Keep::Trace);
    run.run(|_| true);
    let (trace, mut outcome) = run.into_results();
    assert!(trace.events.len() > 20, "{} events", trace.events.len());
    let n_distant = std::mem::take(&mut outcome.steps.skipped.distant_ants);
    (serde_json::to_string(&(trace, outcome)).unwrap(), n_distant)
}

#[test]
fn ants_that_are_passed_over_change_no_bit() {
    let scenes = [
        ants(6, 4, json!({})),
        // More springs than ants, so that tips in reach are many and mostly free.
        ants(30, 40, json!({ "preset": "aged" })),
        // Crowded, and a reach wider than the ring of tips.
        ants(60, 12, json!({ "sensing_range_m": 0.09, "grasp_probability": 0.05 })),
    ];
    for (at, scenario) in scenes.iter().enumerate() {
        let (quick, n_distant) = run(scenario, Skips::ALL);
        let (slow, none) = run(scenario, Skips::ALL.without(Skip::DistantAnts));
        assert!(quick == slow, "scene {at}");
        assert!(n_distant > 100, "scene {at}: {n_distant}");
        assert_eq!(none, 0);
    }
}

/// Ants that stand still: each that starts beyond the tips' reach is passed over once at every
/// tick.
#[test]
fn every_far_ant_is_counted_at_every_tick() {
    let scenario = ants(50, 4, json!({ "search_speed_m_per_s": 1e-9, "start_half_width_m": 0.1, "sensing_range_m": 1e-3 }));
    let Drive::Ants(drive) = &scenario.drive else { panic!("ants") };
    // Root and length of the springs, and the reach; what the ants walk in these 3 s is 3 nm.
    let far = 0.0122 + 0.0263 + 1e-3;
    let away = |ant: &Ant| (ant.position - scenario.start.pose.position).norm();
    let n_far = Ants::new(&scenario, drive).ants().iter().filter(|ant| away(ant) > far).count() as u64;
    assert!((30..50).contains(&n_far), "{n_far}");

    let mut run = Simulation::new(&scenario, &BackendOptions::new(BackendKind::QuasiStatic, scenario.control_period), Keep::Trace);
    run.run(|_| true);
    let (trace, outcome) = run.into_results();
    // By chance of the seed none starts at a tip. The last row is the end, at which nobody decides.
    assert_eq!(trace.events.len(), 0);
    assert_eq!(outcome.steps.skipped.distant_ants, n_far * (trace.rows.len() as u64 - 1));
}
