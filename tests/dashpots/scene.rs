//! Damped scenes with the paper's load, as scenario files hold them.

use std::f64::consts::{FRAC_PI_2, TAU};

use cohaul::backend::{BackendKind, BackendOptions, Tolerance};
use cohaul::math::{Vec2, direction};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Outcome, Row, Simulation};
use serde_json::{Value, json};

/// Mass (kg), coefficient of friction (1), gravity (m/s^2) and radius (m) of the load.
pub const MASS: f64 = 1.6e-3;
pub const MU: f64 = 1.4;
pub const GRAVITY: f64 = 9.81;
pub const RADIUS: f64 = 0.0122;
/// Stiffness (N/m) and rest length (m) of a spring.
pub const STIFFNESS: f64 = 0.664;
pub const REST_LENGTH: f64 = 0.0263;
/// Slip limit f (N).
pub const LIMIT: f64 = MU * MASS * GRAVITY;

/// An isotropic spring at the centre.
pub fn isotropic(stiffness: f64, damping_ratio: f64) -> Value {
    json!({
        "root_m": [0.0, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.0, "radial_stiffness_n_per_m": stiffness,
        "torsional_stiffness_nm_per_rad": 0.0, "damping_ratio": damping_ratio,
    })
}

/// Dashpot of an isotropic spring on the load (N s/m).
pub fn dashpot(stiffness: f64, damping_ratio: f64) -> f64 {
    2.0 * damping_ratio * (stiffness * MASS).sqrt()
}

/// A path of the tip of a spring through these points (s, m, m).
pub fn path(spring: usize, waypoints: &[[f64; 3]]) -> Value {
    json!({ "spring": spring, "waypoints": waypoints })
}

/// A path that ends with a release (s).
pub fn released(spring: usize, waypoints: &[[f64; 3]], release: f64) -> Value {
    json!({ "spring": spring, "waypoints": waypoints, "release_s": release })
}

/// The load on springs whose tips go along paths.
pub fn scene(duration: f64, springs: &[Value], paths: &[Value]) -> Value {
    let support = |k: u32| {
        let offset: Vec2 = 2.0 * RADIUS / 3.0 * direction(FRAC_PI_2 + f64::from(k) * TAU / 3.0);
        json!({ "offset_m": [offset.x, offset.y], "normal_load_n": MASS * GRAVITY / 3.0 })
    };
    json!({
        "name": "damped springs", "duration_s": duration, "control_period_s": 0.01, "seed": 1,
        "load": { "mass_kg": MASS, "radius_m": RADIUS },
        "ground": { "friction_coefficient": MU, "gravity_m_per_s2": GRAVITY, "supports": [support(0), support(1), support(2)] },
        "springs": springs,
        "drive": { "kind": "tips", "paths": paths },
    })
}

pub fn parsed(scene: &Value) -> Scenario {
    Scenario::parse(&scene.to_string(), "damped").expect("the scene obeys the rules of the format")
}

/// Options of a run whose pose is right to this distance (m).
pub fn within(scenario: &Scenario, kind: BackendKind, tolerance: f64) -> BackendOptions {
    BackendOptions::within(kind, Tolerance::at_edge(tolerance, &scenario.system.load))
}

/// Rows at the control ticks and at the corners of paths, and the outcome.
pub fn run(scenario: &Scenario, options: &BackendOptions) -> (Vec<Row>, Outcome) {
    let mut run = Simulation::new(scenario, options, Keep::Trace);
    run.run(|_| true);
    let (trace, outcome) = run.into_results();
    (trace.rows, outcome)
}

/// Rows of the quasi-static run to a hundred-millionth of the load's radius.
pub fn quasi_static(scene: &Value) -> Vec<Row> {
    let scenario = parsed(scene);
    run(&scenario, &within(&scenario, BackendKind::QuasiStatic, 1e-8 * RADIUS)).0
}

/// Pull on a tip (N, world).
pub fn pull(row: &Row, spring: usize) -> Vec2 {
    row.tips.iter().find(|tip| tip.spring == spring).expect("the spring is attached").pull
}
