//! Engines whose error is known: the inertial backend behind the protocol, and lies about it.

use std::sync::Arc;

use cohaul::analysis::compare::{Cause, EngineAnswer, Pathwise, Settings, ThreeWay};
use cohaul::backend::{Backend, BackendKind, BackendOptions};
use cohaul::math::Vec2;
use cohaul::scenario::Scenario;
use cohaul::simulation::backend_of;
use cohaul_engines::engine::Open;
use cohaul_engines::{Channel, Engine, Springs};
use serde_json::{Value, json};

/// The inertial backend at fixed steps, as an engine that answers lines.
struct Exact {
    scenario: Scenario,
    backend: Option<Box<dyn Backend>>,
    /// What it states beside the pose.
    states: &'static [&'static str],
    lie: Lie,
    /// Longest step (s).
    step: f64,
}

/// By how much the x of an engine is wrong once it has moved: by a model error (m), and by a
/// time-step error that is this large at a step of 1 ms (m) and falls with this power of the step.
#[derive(Clone, Copy, Default)]
struct Lie {
    model: f64,
    time_step: f64,
    order: f64,
}

impl Lie {
    fn at(self, step: f64) -> f64 {
        self.model + self.time_step * (step / 1e-3).powf(self.order)
    }
}

fn vector(value: &Value) -> Vec2 {
    Vec2::new(value[0].as_f64().unwrap(), value[1].as_f64().unwrap())
}

impl Channel for Exact {
    fn exchange(&mut self, line: &str, _: &Arc<Springs>) -> Result<String, String> {
        let request: Value = serde_json::from_str(line).unwrap();
        if request["call"] == "start" {
            let step = request["longest_step_s"].as_f64().unwrap();
            self.step = step;
            self.backend = Some(backend_of(&self.scenario, &BackendOptions::new(BackendKind::Inertial, step)));
            return Ok(json!({ "name": "exact" }).to_string());
        }
        let backend = self.backend.as_mut().unwrap();
        let spring = request["spring"].as_u64().unwrap_or_default() as usize;
        let answer = match request["call"].as_str().unwrap() {
            "attach" => {
                backend.attach(spring, vector(&request["tip_m"]));
                json!({})
            }
            "release" => {
                backend.release(spring);
                json!({})
            }
            _ => {
                let tips = request["tips_m"].as_array().unwrap().iter();
                let tips: Vec<Vec2> = tips.map(|tip| if tip.is_null() { Vec2::zeros() } else { vector(tip) }).collect();
                backend.advance(&tips, request["duration_s"].as_f64().unwrap());
                let (pose, twist) = (backend.motion().pose, backend.motion().twist);
                let contacts = backend.side_contacts().into_iter();
                let contacts: Vec<Value> = contacts
                    .map(|it| json!({ "obstacle": it.obstacle, "point_m": [it.point.x, it.point.y], "force_n": [it.force.x, it.force.y] }))
                    .collect();
                let pulls: Vec<Value> = (0..tips.len())
                    .map(|at| backend.tip(at).map_or(Value::Null, |_| json!([backend.pull(at).x, backend.pull(at).y])))
                    .collect();
                let mut answer = json!({
                    "pose": [pose.position.x + self.lie.at(self.step), pose.position.y, pose.heading],
                    "twist": [twist.linear.x, twist.linear.y, twist.angular],
                    "pulls_n": pulls,
                    "dissipated_j": backend.energy().dissipated() - backend.energy().released,
                    "contacts": contacts,
                });
                let states = self.states;
                answer.as_object_mut().unwrap().retain(|key, _| key == "pose" || states.contains(&key.as_str()));
                answer
            }
        };
        Ok(answer.to_string())
    }
}

const ALL: &[&str] = &["twist", "pulls_n", "dissipated_j", "contacts"];

fn read(name: &str) -> Scenario {
    let path = format!("{}/../../scenarios/{name}.json", env!("CARGO_MANIFEST_DIR"));
    Scenario::read(path.as_ref()).unwrap()
}

fn settings() -> Settings {
    Settings { step_s: Some(1e-3), check_suggestions: false, ..Settings::default() }
}

/// The comparison with this engine behind the protocol.
fn compared(scenario: &Scenario, states: &'static [&'static str], lie: Lie) -> Pathwise {
    compared_with(scenario, &settings(), states, lie)
}

fn compared_with(scenario: &Scenario, settings: &Settings, states: &'static [&'static str], lie: Lie) -> Pathwise {
    let open = || Ok(Box::new(Exact { scenario: scenario.clone(), backend: None, states, lie, step: 0.0 }) as Box<dyn Channel>);
    let open: &Open = &open;
    let engine = Engine::meet(open, scenario, &settings.at_fixed_step(scenario, BackendKind::Rapier)).unwrap();
    let make = |scenario: &Scenario, options: &BackendOptions| engine.backend(scenario, options);
    let found = ThreeWay::new(scenario, settings).engine(&make).named(engine.name()).prescribed(|_| true).unwrap();
    assert_eq!(engine.complaint(), None);
    found
}

/// Numbers go through text and come back to the bit.
#[test]
fn an_engine_behind_the_protocol_is_the_engine_itself() {
    for name in ["analytic/release-jump", "contact/wall-slide", "contact/pusher", "analytic/tripod-slide-spin-free"] {
        let scenario = read(name);
        let direct = |scenario: &Scenario, options: &BackendOptions| -> Box<dyn Backend> {
            backend_of(scenario, &BackendOptions::new(BackendKind::Inertial, options.step_s))
        };
        let expected = ThreeWay::new(&scenario, &settings()).engine(&direct).prescribed(|_| true).unwrap();
        let found = compared(&scenario, ALL, Lie::default());
        assert_eq!((&*found.engine.name, &*expected.engine.name), ("exact", "engine"));
        assert_eq!(found.engine_error, expected.engine_error, "{name}");
        assert_eq!(found.verdicts.pulls, expected.verdicts.pulls, "{name}");
        assert_eq!(found.verdicts.contacts, expected.verdicts.contacts, "{name}");
        assert_eq!(found.verdicts.speed, expected.verdicts.speed, "{name}");
        let (a, b) = (&found.verdicts.energy, &expected.verdicts.energy);
        // Sums of parts in another order.
        assert!((a.engine_error - b.engine_error).abs() <= 1e-12 * b.tolerance, "{name} {a:?} {b:?}");
    }
}

/// What an engine does not compute has no row, and what it computes keeps its own.
#[test]
fn what_an_engine_leaves_out_is_not_judged() {
    let scenario = read("contact/wall-slide");
    let shown = |states| compared(&scenario, states, Lie::default()).verdicts.shown().map(|(name, _)| name).collect::<Vec<_>>();
    assert_eq!(shown(ALL), ["path", "heading", "pulls", "contacts", "speed", "energy"]);
    assert_eq!(shown(&[]), ["path", "heading", "pulls"]);
    assert_eq!(shown(&["twist"]), ["path", "heading", "pulls", "speed"]);
    assert_eq!(shown(&["contacts", "dissipated_j"]), ["path", "heading", "pulls", "contacts", "energy"]);
    // Without pulls of its own they follow from the spring law.
    let [own, law] = [ALL, &["twist"][..]].map(|states| compared(&scenario, states, Lie::default()).verdicts.pulls);
    for (own, law) in own.measures.iter().zip(&law.measures) {
        assert!((own.engine - law.engine).abs() < 1e-9 * own.engine.abs(), "{own:?} {law:?}");
    }
}

/// A load that turns by almost a whole turn in a control period is not taken for one whose heading
/// is wrapped; that is one which its turn rate does not explain.
#[test]
fn a_load_that_spins_fast_is_no_wrapped_heading() {
    let mut scenario = read("analytic/spin");
    (scenario.duration, scenario.control_period) = (0.64, 0.16);
    scenario.system.ground.friction_coefficient *= 1e-3;
    scenario.start.twist.angular = 40.0;
    assert!(compared(&scenario, ALL, Lie::default()).verdicts.heading.engine_error < 0.01);
}

/// Pulls that an engine states are those of the springs that are attached.
#[test]
fn a_released_spring_pulls_nothing() {
    let scenario = read("analytic/ramp-and-hold");
    let open = || {
        Ok(Box::new(Exact { scenario: scenario.clone(), backend: None, states: ALL, lie: Lie::default(), step: 0.0 }) as Box<dyn Channel>)
    };
    let open: &Open = &open;
    let options = BackendOptions::new(BackendKind::Rapier, 1e-3);
    let mut load = Engine::meet(open, &scenario, &options).unwrap().backend(&scenario, &options);
    load.attach(0, Vec2::zeros());
    load.advance(&[Vec2::new(0.01, 0.0)], 0.01);
    assert!(load.pull(0).norm() > 0.0);
    load.release(0);
    assert_eq!(load.pull(0), Vec2::zeros());
}

/// The inertial run plus 1 mm: all of the error is the model's, and none the step's.
#[test]
fn a_lie_of_a_millimetre_is_a_model_error_of_a_millimetre() {
    let scenario = read("analytic/ramp-and-hold");
    // At steps of a tenth, the backend of second order errs by less than a thousandth of the tolerance.
    let settings = Settings { step_s: Some(1e-4), ..settings() };
    let honest = compared_with(&scenario, &settings, ALL, Lie::default());
    let found = compared_with(&scenario, &settings, ALL, Lie { model: 1e-3, ..Lie::default() });
    let [model, step] = [found.model_error, found.time_step_error].map(|error| error.edge_displacement_max_m);
    let [honest_model, honest_step] = [honest.model_error, honest.time_step_error].map(|error| error.edge_displacement_max_m);
    assert!((model - 1e-3).abs() <= honest_model + 1e-12, "{model:e}");
    assert!((step - honest_step).abs() <= 1e-12, "{step:e} {honest_step:e}");
    assert_eq!(found.verdicts.path.engine, EngineAnswer::NotWithin);
    assert!(found.causes.contains(&Cause::EngineModel), "{:?}", found.causes);
    // The step changes too little to tell how it converges.
    assert_eq!(found.time_step_order, None);
}

/// Model and time-step errors of known orders are found within what is said of them, as is the order.
#[test]
fn engines_of_known_order_are_split_within_what_is_stated() {
    let scenario = read("analytic/ramp-and-hold");
    for order in [0.5, 1.0, 2.0] {
        for (model, time_step) in [(4e-4, 2e-4), (-2e-4, 4e-4), (0.0, 3e-4)] {
            let found = compared(&scenario, ALL, Lie { model, time_step, order });
            let [step, of_model] = [found.time_step_error, found.model_error].map(|error| error.edge_displacement_max_m);
            // What the backend at fixed steps errs by itself.
            let within = found.reference_error.engine.edge_displacement_max_m + found.edge_displacement.reference_error_m + 1e-7;
            assert!((step - time_step).abs() <= within, "{order}: time step {step:e} of {time_step:e} within {within:e}");
            assert!((of_model - model.abs()).abs() <= within, "{order}: model {of_model:e} of {model:e} within {within:e}");
            // An uncertainty beyond the time-step error would say nothing: at order 0.5, with the order
            // known to 0.2, half a power more or less is left of it.
            assert!(within < 1.3 * time_step, "{order}: {within:e}");
            let measured = found.time_step_order.unwrap();
            assert!((measured - order).abs() < 0.05, "{measured} for {order}");
        }
    }
}

/// The limit of rapier is that of steps which are far smaller, within what is said of it.
#[test]
fn a_far_finer_run_lies_within_the_stated_error() {
    for name in ["analytic/ramp-and-hold", "analytic/slide-spin", "paper/four-tips-prescribed"] {
        let scenario = read(name);
        let compared = |halvings: u32| {
            let settings = Settings { halvings, ..settings() };
            ThreeWay::new(&scenario, &settings).prescribed(|_| true).unwrap()
        };
        let [coarse, fine] = [2, 6].map(compared);
        assert_eq!(coarse.engine_error, fine.engine_error, "{name}");
        let errors = |found: &Pathwise| [found.time_step_error, found.model_error].map(|error| error.edge_displacement_max_m);
        let within = |found: &Pathwise| found.reference_error.engine.edge_displacement_max_m + found.edge_displacement.reference_error_m;
        for (a, b) in errors(&coarse).into_iter().zip(errors(&fine)) {
            assert!((a - b).abs() <= within(&coarse) + within(&fine), "{name}: {a:e} {b:e} within {:e}", within(&coarse));
        }
        // Four more halvings make it as much more certain, if the order is 1.
        assert!(within(&fine) < 0.5 * within(&coarse), "{name}: {:e} {:e}", within(&fine), within(&coarse));
    }
}

/// A step of 1 ms divides a period of 2.5 ms into three, and its halves into six and twelve.
#[test]
fn steps_that_do_not_divide_a_period_are_halved_all_the_same() {
    let mut scenario = read("analytic/ramp-and-hold");
    scenario.control_period = 2.5e-3;
    let found = ThreeWay::new(&scenario, &settings()).prescribed(|_| true).unwrap();
    assert!((found.time_step_order.unwrap() - 1.0).abs() < 0.05, "{:?}", found.time_step_order);
}

/// Two engines beside the same exact paths are judged as each alone.
#[test]
fn an_engine_beside_another_is_judged_as_alone() {
    for name in ["analytic/ramp-and-hold", "contact/wall-slide", "contact/rebound"] {
        let scenario = read(name);
        let settings = settings();
        let coarse = |scenario: &Scenario, options: &BackendOptions| -> Box<dyn Backend> {
            backend_of(scenario, &BackendOptions::new(BackendKind::Inertial, 3.0 * options.step_s))
        };
        let rapier = ThreeWay::new(&scenario, &settings).prescribed(|_| true).unwrap();
        let alone = ThreeWay::new(&scenario, &settings).engine(&coarse).prescribed(|_| true).unwrap();
        let beside = ThreeWay::new(&scenario, &settings).engine(&coarse).beside(&rapier).prescribed(|_| true).unwrap();
        assert_eq!(beside.solutions[..2], rapier.solutions[..2]);
        let verdicts = |found: &Pathwise| found.verdicts.named().map(|(_, of)| (of.inertia, of.engine, of.causes.clone()));
        assert_eq!(verdicts(&beside), verdicts(&alone), "{name}");
    }
}
