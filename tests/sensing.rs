//! Searching ants: those too far from the load to sense a tip are passed over without effect on the
//! run, and the offset of Eq. (20) moves no other ants.

use cohaul::backend::{BackendKind, BackendOptions, Skip, Skips, build, default_step};
use cohaul::math::{Vec2, wrap_to_pi};
use cohaul::model::ant::Ant;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Ants, Controller, Keep, Simulation, View};
use serde_json::{Value, json};

fn ants(n_ants: usize, n_springs: usize, drive: Value) -> Scenario {
    let mut file = json!({
        "name": "ants", "duration_s": 6.0, "control_period_s": 0.0025, "seed": 5,
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
    // Root and length of the springs, and the reach; what the ants walk in these 6 s is 6 nm.
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

/// One tick of one ant with an offset r: a searching ant moves by Eq. (20), v (cos, sin) + r omega
/// (-sin, cos), and a pulling ant by Eq. (23), which has no r.
#[test]
fn the_offset_moves_searching_ants_and_no_pulling_ant() {
    let scenario = ants(1, 4, json!({ "preset": "paper", "target_variance_m2": 0.0 }));
    let Drive::Ants(drive) = &scenario.drive else { panic!("ants") };
    assert_eq!(drive.control_offset, 0.002);
    let backend = build(&scenario.system, scenario.start, &BackendOptions::new(BackendKind::QuasiStatic, scenario.control_period));
    let (position, heading, duration) = (Vec2::new(0.09, 0.05), 0.8, scenario.control_period);
    let after = |mode: Value| {
        let mut ants = Ants::new(&scenario, drive);
        let mut state = ants.save().unwrap();
        state["ants"][0] = serde_json::to_value(Ant::new(position, heading)).unwrap();
        state["ants"][0]["mode"] = mode;
        ants.restore(&state).unwrap();
        let motion = scenario.start;
        let view = View { scenario: &scenario, backend: backend.as_ref(), motion, tips: &[], time: 0.0, tick: Some(0), skips: Skips::ALL };
        ants.targets(&view, duration);
        ants.ants()[0]
    };
    let pulling = after(json!({ "mode": "transport", "spring": 0, "grasp_tick": 0 }));
    let ahead = Vec2::new(heading.cos(), heading.sin());
    // Rounding of positions of order 0.1 m.
    assert!((pulling.position - (position - drive.pull_speed * duration * ahead)).norm() < 1e-16, "{}", pulling.position);
    assert!(pulling.heading != heading, "it turns");

    let searching = after(json!({ "mode": "search" }));
    let turn_rate = (searching.heading - heading) / duration;
    let to_load = scenario.start.pose.position - position;
    let error = wrap_to_pi(to_load.y.atan2(to_load.x) - heading);
    assert!((turn_rate * duration - error * (1.0 - (-10.0 * duration).exp())).abs() < 1e-15);
    let velocity = |time: f64| {
        let (sin, cos) = (heading + turn_rate * time).sin_cos();
        0.08 * Vec2::new(cos, sin) + 0.002 * turn_rate * Vec2::new(-sin, cos)
    };
    // Simpson's rule over a turn of 0.05 rad errs by 1e-7 of 0.2 mm at most.
    let moved = duration / 6.0 * (velocity(0.0) + 4.0 * velocity(0.5 * duration) + velocity(duration));
    assert!((searching.position - position - moved).norm() < 1e-10, "{}", searching.position);
    assert!(0.002 * (turn_rate * duration).abs() > 1e-5, "the offset is seen");
}
