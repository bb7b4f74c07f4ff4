//! The scenes of the laws, and the search in them.

use cohaul::analysis::compare::Settings;
use cohaul::backend::{BackendKind, Integrator};
use cohaul_studies::runner::Records;
use cohaul_studies::sweep::{Ask, Axis, Design, Plan, Variant, present_value};
use cohaul_studies::threshold::report::Thresholds;
use cohaul_studies::threshold::{Asked, Band, Class, Point, search};
use serde_json::{Value, json};

#[allow(dead_code, reason = "each test uses its own part")]
#[path = "../../dashpots/scene.rs"]
mod damped;

pub use damped::{GRAVITY, LIMIT, MASS, STIFFNESS, isotropic, path, released, scene};

/// Natural frequency of the load on its spring (rad/s).
pub fn rate() -> f64 {
    (STIFFNESS / MASS).sqrt()
}

/// Stretch of the spring at the slip limit (m).
pub const STRETCH: f64 = LIMIT / STIFFNESS;

/// A tip tows the load from rest at a constant speed (m/s) over a way (m), and does not stop.
pub fn tow(damping_ratio: f64, speed: f64, way: f64) -> Value {
    let time = way / speed;
    scene(time, &[isotropic(STIFFNESS, damping_ratio)], &[path(0, &[[0.0; 3], [time, way, 0.0]])])
}

/// The same, and stops there for another second.
pub fn tow_and_stop(speed: f64, way: f64) -> Value {
    let time = way / speed;
    scene(time + 1.0, &[isotropic(STIFFNESS, 0.0)], &[path(0, &[[0.0; 3], [time, way, 0.0]])])
}

/// Two springs stretch by the same length (m) in half a second, the second one is released, and the
/// first tip goes on from a second later over a way (m) at 20 mm/s.
pub fn release(damping_ratio: f64, stretch: f64, way: f64) -> Value {
    let spring = isotropic(STIFFNESS, damping_ratio);
    let mut first = vec![[0.0; 3], [0.5, stretch, 0.0]];
    let end = 2.0 + way / 0.02;
    if way > 0.0 {
        first.extend([[2.0, stretch, 0.0], [end, stretch + way, 0.0]]);
    }
    let second = released(1, &[[0.0; 3], [0.5, -stretch, 0.0]], 1.0);
    scene(end, &[spring.clone(), spring], &[path(0, &first), second])
}

/// A post pushes a disc at a speed (m/s) over a way (m), and stops there for half a second.
pub fn pusher(speed: f64, way: f64, friction_coefficient: f64) -> Value {
    let (radius, of_post) = (0.0122, 0.005);
    let (start, time) = (-radius - of_post, way / speed);
    json!({
        "name": "pushed", "duration_s": time + 0.5, "control_period_s": 0.01, "seed": 1,
        "load": { "mass_kg": MASS, "radius_m": radius },
        "ground": {
            "friction_coefficient": friction_coefficient, "gravity_m_per_s2": GRAVITY,
            "supports": { "tripod": { "radius_m": 2.0 * radius / 3.0 } },
        },
        "springs": [],
        "obstacles": [{
            "name": "pusher", "outline": { "disc": { "radius_m": of_post } },
            "path": { "waypoints": [[0.0, start, 0.0, 0.0], [time, start + way, 0.0, 0.0]] },
        }],
        "drive": { "kind": "tips", "paths": [] },
    })
}

/// Plan of the grid that `asked` describes, such as `speed=0.1:10`.
pub fn plan(scene: &Value, asked: &str) -> Plan {
    let (text, asked): (String, Asked) = (scene.to_string(), asked.parse().unwrap());
    let axis: Axis = asked.axis(present_value(&text, "scene", &asked.path).unwrap()).unwrap();
    let settings = Settings::default();
    let (integrator, backend) = (Integrator::default(), BackendKind::QuasiStatic);
    let variant = Variant { backend, step_s: None, tolerance_m: None, integrator, rapier: settings.rapier, skips: settings.skips };
    let design = Design::new(vec![axis], None).unwrap();
    Plan::new(Ask { file: "scene".into(), text, design, variants: vec![variant], first_seed: None, n_seeds: 1 }).unwrap()
}

pub fn searched_with(scene: &Value, asked: &str, settings: &Settings) -> Thresholds {
    let (plan, mut records) = (plan(scene, asked), Records::<Point>::in_memory());
    let n = search(&plan, settings, &mut records, &|_| true).unwrap();
    let Ok((points, _)) = records.complete(n) else { panic!("all points have records") };
    Thresholds::new(&plan, settings, &points, 1.0)
}

pub fn searched(scene: &Value, asked: &str) -> Thresholds {
    searched_with(scene, asked, &Settings::default())
}

/// The ranges of one answer on a quantity.
pub fn bands<'a>(found: &'a Thresholds, quantity: &str) -> &'a [Band] {
    &found.quantities.iter().find(|of| of.quantity == quantity).expect("the quantity is shown").bands
}

/// Values at which the answer on a quantity changes, and the answers from the first one on.
pub fn boundaries(found: &Thresholds, quantity: &str) -> (Vec<Class>, Vec<f64>) {
    let bands = bands(found, quantity);
    (bands.iter().map(|band| band.class).collect(), bands[1..].iter().map(|band| band.from.value).collect())
}
