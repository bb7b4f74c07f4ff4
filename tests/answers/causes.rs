//! Differences whose causes are known by construction, alone and in pairs.
//!
//! The engine is an exact backend at a fixed step, of which a part is made wrong on purpose: a
//! coarse step is an error of the time step, another friction or no inertia one of the engine
//! model. A load whose inertia is scaled down at the same normal loads and dashpots has no inertia
//! to speak of.

use std::f64::consts::{FRAC_PI_2, TAU};

use cohaul::analysis::compare::{Cause, EngineAnswer, InertiaAnswer, Pathwise, QuantityVerdict, Settings, ThreeWay};
use cohaul::backend::{Backend, BackendKind, BackendOptions, build};
use cohaul::math::{Vec2, direction};
use cohaul::scenario::Scenario;
use cohaul::simulation::backend_of;
use rayon::prelude::*;
use serde_json::{Value, json};

const MASS: f64 = 1.6e-3;
const MU: f64 = 1.4;
const GRAVITY: f64 = 9.81;
const RADIUS: f64 = 0.0122;
const STIFFNESS: f64 = 0.664;
/// Slip limit f (N).
const LIMIT: f64 = MU * MASS * GRAVITY;
/// Stretch of a spring at which the load slips (m).
const STRETCH: f64 = LIMIT / STIFFNESS;
/// Inertia of a load without inertia to speak of, over that of the paper's (1).
const LIGHT: f64 = 1e-6;
/// Steps of a right engine and of one whose step is too long (s).
const FINE: f64 = 1e-4;
const COARSE: f64 = 5e-3;

/// What is wrong with the engine.
#[derive(Clone, Copy, Debug, Default)]
struct Wrong {
    /// Its step is `COARSE`.
    step: bool,
    /// Its friction is larger by a quarter.
    friction: bool,
    /// It is quasi-static.
    inertia: bool,
}

const RIGHT: Wrong = Wrong { step: false, friction: false, inertia: false };
const STEP: Wrong = Wrong { step: true, ..RIGHT };
const FRICTION: Wrong = Wrong { friction: true, ..RIGHT };
const INERTIA: Wrong = Wrong { inertia: true, ..RIGHT };

struct Case {
    name: String,
    scene: Value,
    wrong: Wrong,
    /// Tolerance of the path over its length (1).
    tolerance_share: f64,
    /// Quantity in which the causes are known.
    quantity: &'static str,
    causes: Vec<Cause>,
    /// Whether leaving the dashpots out would change it by more than the tolerance.
    is_damped: bool,
}

/// A load with this part of the paper's inertia, on isotropic springs of damping ratios that are
/// those of the paper's mass, whose tips go along paths.
fn scene(inertia: f64, damping_ratios: &[f64], paths: &[Value]) -> Value {
    let support = |k: u32| {
        let offset: Vec2 = 2.0 * RADIUS / 3.0 * direction(FRAC_PI_2 + f64::from(k) * TAU / 3.0);
        json!({ "offset_m": [offset.x, offset.y], "normal_load_n": MASS * GRAVITY / 3.0 })
    };
    let spring = |ratio: &f64| {
        json!({
            "root_m": [0.0, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.0, "radial_stiffness_n_per_m": STIFFNESS,
            "torsional_stiffness_nm_per_rad": 0.0, "damping_ratio": ratio / inertia.sqrt(),
        })
    };
    json!({
        "name": "known cause", "duration_s": 1.0, "control_period_s": 0.01, "seed": 1,
        "load": { "mass_kg": inertia * MASS, "radius_m": RADIUS },
        "ground": { "friction_coefficient": MU, "gravity_m_per_s2": GRAVITY, "supports": [support(0), support(1), support(2)] },
        "springs": damping_ratios.iter().map(spring).collect::<Vec<_>>(),
        "drive": { "kind": "tips", "paths": paths },
    })
}

/// A tow that starts and goes on at this speed (m/s).
fn tow(inertia: f64, damping_ratio: f64, speed: f64) -> Value {
    scene(inertia, &[damping_ratio], &[json!({ "spring": 0, "waypoints": [[0.0, 0.0, 0.0], [1.0, speed, 0.0]] })])
}

/// A load that is let go at this force over the slip limit.
fn release(inertia: f64, damping_ratio: f64, force: f64) -> Value {
    scene(inertia, &[damping_ratio], &[json!({ "spring": 0, "waypoints": [[0.0, force * STRETCH, 0.0]] })])
}

/// A tow straight ahead by twice the stretch and then round a circle, with a way a second.
fn circle(inertia: f64) -> Value {
    let at = |k: u32| {
        let (ahead, angle) = (f64::from(k.min(20)) / 20.0, TAU * f64::from(k.saturating_sub(20)) / 80.0);
        json!([f64::from(k) / 100.0, 2.0 * STRETCH * ahead * angle.cos(), 2.0 * STRETCH * angle.sin()])
    };
    scene(inertia, &[0.0], &[json!({ "spring": 0, "waypoints": (0..=100).map(at).collect::<Vec<_>>() })])
}

/// A post that pushes the load at this speed (m/s), from 10 mm before it, for 0.8 s.
fn push(inertia: f64, speed: f64, restitution: f64) -> Value {
    let mut scene = scene(inertia, &[], &[]);
    // Impacts are over soon.
    scene["control_period_s"] = json!(1e-3);
    let start = -RADIUS - 0.005 - 0.01;
    scene["obstacles"] = json!([{
        "name": "pusher", "outline": { "disc": { "radius_m": 0.005 } }, "restitution": restitution,
        "path": { "waypoints": [[0.0, start, 0.0, 0.0], [0.8, start + 0.8 * speed, 0.0, 0.0]] },
    }]);
    scene
}

/// A load that starts at this speed (m/s).
fn slide(inertia: f64, speed: f64) -> Value {
    let mut scene = scene(inertia, &[], &[]);
    scene["load"]["velocity_m_per_s"] = json!([speed, 0.0]);
    scene
}

fn cases() -> Vec<Case> {
    use Cause::{EngineModel, Impact, Inertia, TimeStep};
    let case = |name: &str, scene: Value, wrong: Wrong, quantity: &'static str, causes: &[Cause]| Case {
        name: name.to_owned(),
        scene,
        wrong,
        tolerance_share: 0.01,
        quantity,
        causes: causes.to_vec(),
        is_damped: false,
    };
    let strictly = |tolerance_share: f64, case: Case| Case { tolerance_share, ..case };
    let damped = |case: Case| Case { is_damped: true, ..case };
    vec![
        // Dashpots alone.
        damped(case("start, 0.5", tow(LIGHT, 0.5, 0.08), RIGHT, "pulls", &[])),
        damped(case("start, 2", tow(LIGHT, 2.0, 0.08), RIGHT, "path", &[])),
        damped(case("start, 5", tow(LIGHT, 5.0, 0.08), RIGHT, "path", &[])),
        damped(case("held", tow(LIGHT, 1.0, 0.02), RIGHT, "pulls", &[])),
        damped(case("held by more", tow(LIGHT, 3.0, 0.02), RIGHT, "pulls", &[])),
        damped(case("release, 1", release(LIGHT, 1.0, 2.5), RIGHT, "path", &[])),
        damped(case("release, 4", release(LIGHT, 4.0, 1.8), RIGHT, "path", &[])),
        damped(case("release, with full inertia", release(1.0, 10.0, 2.5), RIGHT, "path", &[])),
        // Inertia alone.
        case("release, undamped", release(1.0, 0.0, 1.5), RIGHT, "path", &[Inertia]),
        case("release from more", release(1.0, 0.0, 2.5), RIGHT, "path", &[Inertia]),
        case("fast tow", tow(1.0, 0.0, 0.2), RIGHT, "path", &[Inertia]),
        case("fast tow, pull", tow(1.0, 0.0, 0.2), RIGHT, "pulls", &[Inertia]),
        case("faster tow", tow(1.0, 0.0, 0.5), RIGHT, "speed", &[Inertia]),
        case("slide", slide(1.0, 0.3), RIGHT, "path", &[Inertia]),
        case("slide, energy", slide(1.0, 0.1), RIGHT, "energy", &[Inertia]),
        case("push that stops", push(1.0, 0.3, 0.0), RIGHT, "path", &[Inertia]),
        // Impact alone.
        case("rebound, 0.3", push(1.0, 0.1, 0.3), RIGHT, "speed", &[Impact]),
        case("rebound, 0.5", push(1.0, 0.05, 0.5), RIGHT, "speed", &[Impact]),
        case("rebound, 0.8", push(1.0, 0.05, 0.8), RIGHT, "speed", &[Impact]),
        case("fast rebound, 0.5", push(1.0, 0.2, 0.5), RIGHT, "speed", &[Impact]),
        case("rebound of half", push(0.5, 0.1, 0.6), RIGHT, "speed", &[Impact]),
        case("nearly elastic", push(1.0, 0.1, 0.9), RIGHT, "speed", &[Impact]),
        // The engine's step alone.
        strictly(1e-3, case("circle", circle(LIGHT), Wrong { step: true, ..INERTIA }, "path", &[TimeStep])),
        strictly(1e-3, case("heavier circle", circle(10.0 * LIGHT), Wrong { step: true, ..INERTIA }, "path", &[TimeStep])),
        // The engine's model alone.
        case("tow, friction", tow(LIGHT, 0.0, 0.08), FRICTION, "path", &[EngineModel]),
        case("tow, friction, pull", tow(LIGHT, 0.0, 0.2), FRICTION, "pulls", &[EngineModel]),
        damped(case("release, friction", release(LIGHT, 2.0, 2.5), FRICTION, "path", &[EngineModel])),
        case("circle, friction", circle(LIGHT), FRICTION, "path", &[EngineModel]),
        case("push, friction", push(LIGHT, 0.05, 0.0), FRICTION, "energy", &[EngineModel]),
        // Pairs.
        case("release, both", release(1.0, 0.0, 2.5), FRICTION, "path", &[Inertia, EngineModel]),
        case("tow, both", tow(1.0, 0.0, 0.5), FRICTION, "path", &[Inertia, EngineModel]),
        strictly(4e-4, case("circle, coarse", circle(1.0), STEP, "path", &[Inertia, TimeStep])),
        strictly(4e-4, case("light circle, coarse", circle(0.5), STEP, "path", &[Inertia, TimeStep])),
        case("rebound that coasts", push(1.0, 0.3, 0.9), RIGHT, "path", &[Inertia, Impact]),
        case("rebound, friction", push(1.0, 0.05, 0.5), FRICTION, "speed", &[Impact]),
        damped(case("start, friction", tow(LIGHT, 2.0, 0.08), FRICTION, "path", &[EngineModel])),
        damped(case("release, inertia and dashpots", release(1.0, 0.5, 2.5), RIGHT, "path", &[Inertia])),
        damped(case("tow, inertia and dashpots", tow(1.0, 0.5, 0.5), RIGHT, "path", &[Inertia])),
        strictly(
            1e-3,
            case(
                "circle, coarse and friction",
                circle(LIGHT),
                Wrong { step: true, friction: true, inertia: true },
                "path",
                &[TimeStep, EngineModel],
            ),
        ),
        case("release without inertia", release(1.0, 0.0, 2.5), INERTIA, "path", &[Inertia, EngineModel]),
        case("slide, friction", slide(1.0, 0.3), FRICTION, "path", &[Inertia, EngineModel]),
    ]
}

fn compared(case: &Case) -> Pathwise {
    let scenario = Scenario::parse(&case.scene.to_string(), &case.name).unwrap();
    let wrong = case.wrong;
    let engine = move |scenario: &Scenario, options: &BackendOptions| -> Box<dyn Backend> {
        let kind = if wrong.inertia { BackendKind::QuasiStatic } else { BackendKind::Inertial };
        let options = BackendOptions::new(kind, options.step_s);
        if !wrong.friction {
            return backend_of(scenario, &options);
        }
        let mut system = scenario.system.clone();
        system.ground.friction_coefficient *= 1.25;
        build(&system, scenario.start, &options)
    };
    let step_s = Some(if wrong.step { COARSE } else { FINE });
    let settings = Settings { step_s, check_suggestions: false, tolerance_share: case.tolerance_share, ..Settings::default() };
    ThreeWay::new(&scenario, &settings).engine(&engine).prescribed(|_| true).unwrap()
}

fn of<'a>(found: &'a Pathwise, quantity: &str) -> &'a QuantityVerdict {
    found.verdicts.named().into_iter().find(|(name, _)| *name == quantity).unwrap().1
}

#[test]
fn known_causes_are_named() {
    let cases = cases();
    assert!(cases.len() >= 40);
    let faults: Vec<String> = cases
        .par_iter()
        .filter_map(|case| {
            let found = compared(case);
            let of = of(&found, case.quantity);
            let changes = |number: f64, tolerance: f64| number > tolerance;
            let is_damped = changes(of.parts.dashpots, of.tolerance) || of.measures.iter().any(|it| changes(it.parts.dashpots, it.tolerance));
            let inertia = case.causes.iter().any(|cause| !cause.is_of_engine());
            let engine = case.causes.iter().any(|cause| cause.is_of_engine());
            let answers = (of.inertia == InertiaAnswer::NotNegligible, of.engine == EngineAnswer::NotWithin);
            let is_right = of.causes == case.causes && is_damped == case.is_damped && answers == (inertia, engine) && !of.answers().is_open();
            (!is_right || std::env::var_os("COHAUL_SHOW").is_some()).then(|| {
                let others: Vec<_> = found.verdicts.named().map(|(name, of)| format!("{name}: {:?}", of.causes)).into();
                format!(
                    "{}: {:?} {:?} {:?} dashpots {is_damped}\n  inertia {:.3e} engine {:.3e} error {:.1e} tolerance {:.3e} {:?}\n  {:?}\n  {}\n",
                    case.name, of.inertia, of.engine, of.causes, of.inertia_effect, of.engine_error, of.reference_error, of.tolerance,
                    of.decided_by, of.parts, others.join(" ")
                )
            })
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
