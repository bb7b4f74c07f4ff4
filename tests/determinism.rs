//! A run is a function of its scenario and seed: twice the same is bit-identical, a saved run goes
//! on as if it had never stopped, and neither backend nor step touches any draw.

use cohaul::backend::rapier::{Precision, SpringModel};
use cohaul::backend::{BackendKind, BackendOptions, Integrator, RapierOptions, Tolerance, default_step};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{EventKind, Keep, SavedRun, Simulation, Trace};
use serde_json::{Value, json};

/// The paper's four ants for `duration_s`: long enough for several grasps and releases.
fn four_ants(duration_s: f64, seed: u64) -> Scenario {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/paper/four-ants-four-springs.json");
    let scenario = Scenario::read(file.as_ref()).unwrap();
    Scenario { duration: duration_s, seed, ..scenario }
}

/// Three tips that are grasped, turn and are let go at ticks and between them, on a load that
/// slides and spins at the start.
fn busy_tips() -> Scenario {
    let file = json!({
        "name": "busy tips", "duration_s": 0.4033, "control_period_s": 0.005,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122, "velocity_m_per_s": [0.05, 0.02], "turn_rate_rad_per_s": 1.0 },
        "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.008 } } },
        "springs": [{ "ring": { "n": 4, "radius_m": 0.0122, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
            "torsional_stiffness_nm_per_rad": 4.52e-4, "damping_ratio": 0.1 } }],
        "drive": { "kind": "tips", "paths": [
            { "spring": 0, "waypoints": [[0.0, 0.0385, 0.0], [0.1234, 0.07, 0.01], [0.4, 0.06, 0.03]], "release_s": 0.25 },
            { "spring": 1, "waypoints": [[0.0512, 0.0, 0.04], [0.3, 0.02, 0.09]], "release_s": 0.2789 },
            { "spring": 3, "waypoints": [[0.1, 0.0, -0.04], [0.4, 0.05, -0.06]] } ] }
    });
    Scenario::parse(&file.to_string(), "busy tips").unwrap()
}

fn scenes() -> [Scenario; 2] {
    [four_ants(4.0, 1), busy_tips()]
}

/// Every backend, quasi-static in both orders, inertial with both integrators, both exact ones
/// under error control, and rapier also with aggregated springs and in single precision.
fn all_options(scenario: &Scenario) -> Vec<BackendOptions> {
    let usual = RapierOptions::default();
    let aggregate = RapierOptions { springs: SpringModel::Aggregate, ..usual };
    let single = RapierOptions { precision: Precision::F32, ..usual };
    let of = |(kind, rapier)| BackendOptions {
        rapier,
        ..BackendOptions::new(kind, default_step(kind, &scenario.system, scenario.control_period))
    };
    let engines = [usual, aggregate, single].map(|rapier| of((BackendKind::Rapier, rapier)));
    let exact = [BackendKind::QuasiStatic, BackendKind::Inertial];
    let [quasi_static, midpoint] = exact.map(|kind| of((kind, usual)));
    let euler = BackendOptions { integrator: Integrator::Euler, ..midpoint };
    let second_order = BackendOptions { second_order: true, ..quasi_static };
    let controlled = exact.map(|kind| BackendOptions::within(kind, Tolerance::at_edge(1e-6, &scenario.system.load)));
    [quasi_static, second_order, euler, midpoint].into_iter().chain(controlled).chain(engines).collect()
}

/// All digits of a run's rows, events and outcome: the text of a float in JSON is exact, and tells
/// -0 from 0.
fn digits(run: Simulation) -> String {
    let text = serde_json::to_string(&run.into_results()).unwrap();
    // A number that is not finite would be a null like any other and hide a difference.
    assert!(!text.replace("\"ant\":null", "").replace("\"arrived\":null", "").contains("null"));
    text
}

fn whole<'a>(scenario: &'a Scenario, options: &BackendOptions) -> Simulation<'a> {
    let mut run = Simulation::new(scenario, options, Keep::Trace);
    run.run(|_| true);
    run
}

fn trace(scenario: &Scenario, options: &BackendOptions) -> Trace {
    whole(scenario, options).into_results().0
}

#[test]
fn two_runs_of_one_seed_are_one_bit_for_bit() {
    for scenario in scenes() {
        let mut paths = Vec::new();
        for options in all_options(&scenario) {
            let one = whole(&scenario, &options);
            assert!(one.trace().events.iter().filter(|event| event.kind == EventKind::Release).count() >= 2);
            paths.push(serde_json::to_string(&one.trace().rows).unwrap());
            assert_eq!(digits(one), digits(whole(&scenario, &options)), "{} {options:?}", scenario.name);
        }
        // No two of them are the same code under another name.
        paths.sort();
        paths.dedup();
        assert_eq!(paths.len(), all_options(&scenario).len(), "{}", scenario.name);
    }
}

#[test]
fn another_seed_is_another_run_of_ants_and_the_same_run_of_tips() {
    for kind in BackendKind::ALL {
        let of = |scenario: &Scenario| trace(scenario, &BackendOptions::new(kind, 1e-3));
        assert_ne!(of(&four_ants(3.0, 1)).events, of(&four_ants(3.0, 2)).events);
        assert_eq!(of(&busy_tips()), of(&Scenario { seed: 2, ..busy_tips() }));
    }
}

/// States on the way: at the start, right after the first grasp and the first release, in the
/// middle of a hold, and at the end.
fn saved_on_the_way(scenario: &Scenario, options: &BackendOptions) -> Vec<String> {
    let mut run = Simulation::new(scenario, options, Keep::Trace);
    let mut texts = vec![serde_json::to_string(&run.save().unwrap()).unwrap()];
    let (mut wanted, mut steps_into_hold) = (vec![EventKind::Grasp, EventKind::Release], 0);
    while !run.is_finished() {
        let n_events = run.trace().events.len();
        run.step();
        let happened: Vec<_> = run.trace().events[n_events..].iter().map(|event| event.kind).collect();
        let n_wanted = wanted.len();
        wanted.retain(|kind| !happened.contains(kind));
        let is_holding = n_events > 0 && happened.is_empty() && run.trace().rows.last().is_some_and(|row| !row.tips.is_empty());
        steps_into_hold += usize::from(is_holding);
        if wanted.len() < n_wanted || (is_holding && steps_into_hold == 7) || run.is_finished() {
            texts.push(serde_json::to_string(&run.save().unwrap()).unwrap());
        }
    }
    assert_eq!(texts.len(), 5);
    texts
}

#[test]
fn a_saved_run_goes_on_bit_for_bit() {
    for scenario in scenes() {
        for options in all_options(&scenario) {
            let uninterrupted = digits(whole(&scenario, &options));
            for text in saved_on_the_way(&scenario, &options) {
                let saved: SavedRun = serde_json::from_str(&text).unwrap();
                let mut resumed = Simulation::resume(&scenario, &saved, Keep::Trace).unwrap();
                assert_eq!(serde_json::to_string(&resumed.save().unwrap()).unwrap(), text);
                resumed.run(|_| true);
                assert!(digits(resumed) == uninterrupted, "{} {options:?} saved at {} s", scenario.name, saved_time(&text));
            }
        }
    }
}

fn saved_time(text: &str) -> Value {
    serde_json::from_str::<Value>(text).unwrap()["time"].clone()
}

/// Saving is looking: the run that was saved goes on as if nobody had.
#[test]
fn a_run_that_is_saved_at_every_step_is_the_same_run() {
    let scenario = busy_tips();
    for options in all_options(&scenario) {
        let mut watched = Simulation::new(&scenario, &options, Keep::Trace);
        while !watched.is_finished() {
            watched.step();
            let _ = watched.save().unwrap();
        }
        assert_eq!(digits(watched), digits(whole(&scenario, &options)));
    }
}

/// Ants that notice every tip from anywhere and let go regardless of forces. Which spring is the
/// nearest still follows from where the load is, but who grasps and who lets go when is then chance
/// alone: an ant grasps whenever any spring is free and its draw says so.
fn careless_ants() -> Scenario {
    let mut scenario = four_ants(8.0, 5);
    let Drive::Ants(drive) = &mut scenario.drive else { panic!("ants expected") };
    drive.n_ants = 6;
    drive.sensing_range = 10.0;
    drive.release.steepness = 0.0;
    // Slow enough that many ticks pass between decisions; a nest out of reach, lest one backend
    // arrive earlier.
    drive.grasp_decision_period = 0.1;
    drive.release.period = 0.175;
    drive.nest_position *= 10.0;
    scenario
}

/// Each backend at its own step or tolerance and at a third of it, which no power of two would turn
/// into the same nodes.
fn backends_and_steps(scenario: &Scenario) -> Vec<BackendOptions> {
    let within = |tolerance: Tolerance, share: f64| Tolerance {
        position_m: share * tolerance.position_m,
        heading_rad: share * tolerance.heading_rad,
        ..tolerance
    };
    let at = |options: BackendOptions, share: f64| BackendOptions {
        step_s: options.step_s * share,
        tolerance: options.tolerance.map(|tolerance| within(tolerance, share)),
        ..options
    };
    all_options(scenario).into_iter().flat_map(|options| [at(options, 1.0), at(options, 1.0 / 3.0)]).collect()
}

#[test]
fn neither_backend_nor_step_changes_a_draw() {
    let scenario = careless_ants();
    let decisions = |trace: &Trace| -> Vec<_> { trace.events.iter().map(|event| (event.time, event.ant, event.kind)).collect() };
    let traces: Vec<Trace> = backends_and_steps(&scenario).iter().map(|options| trace(&scenario, options)).collect();
    let first = decisions(&traces[0]);
    // Both kinds, by all ants, several times.
    assert!(first.len() > 100, "{}", first.len());
    assert!((0..6).all(|ant| first.iter().filter(|(_, by, kind)| *by == Some(ant) && *kind == EventKind::Release).count() > 3));
    let mut ends = Vec::new();
    for trace in &traces {
        assert_eq!(decisions(trace), first);
        let end = trace.rows.last().unwrap().motion.pose.position;
        assert!(end.norm() > 1e-3, "the load moved");
        ends.push([end.x.to_bits(), end.y.to_bits()]);
    }
    ends.sort_unstable();
    ends.dedup();
    assert_eq!(ends.len(), traces.len(), "paths are those of different backends and steps");
}

/// With forces in the decisions again the careful ants part: the check above can fail.
#[test]
fn forces_make_decisions_part() {
    let scenario = four_ants(12.0, 1);
    let options = all_options(&scenario);
    let [quasi_static, inertial] = [0, 3].map(|at| trace(&scenario, &options[at]).events);
    assert_ne!(
        quasi_static.iter().map(|event| event.time).collect::<Vec<_>>(),
        inertial.iter().map(|event| event.time).collect::<Vec<_>>()
    );
    assert_eq!(quasi_static[0], inertial[0], "until the first grasp there is no force");
}

/// Start places, headings, walks and beliefs of all ants, tick by tick, up to the first grasp: the
/// load rests, so that all of it is chance.
#[test]
fn ants_walk_and_believe_the_same_on_every_backend_until_the_first_grasp() {
    let scenario = four_ants(3.0, 1);
    let walks: Vec<Vec<Value>> = backends_and_steps(&scenario).iter().map(|options| ants_until_first_grasp(&scenario, options)).collect();
    assert!(walks[0].len() > 200);
    assert_ne!(walks[0].first(), walks[0].last());
    assert!(walks.iter().all(|walk| *walk == walks[0]));
    let other = Scenario { seed: 2, ..scenario };
    let others = ants_until_first_grasp(&other, &all_options(&other)[0]);
    assert_ne!(others[0], walks[0][0], "another seed starts elsewhere");
}

fn ants_until_first_grasp(scenario: &Scenario, options: &BackendOptions) -> Vec<Value> {
    let ants = |run: &Simulation| serde_json::to_value(run.save().unwrap()).unwrap()["controller"]["ants"].clone();
    let mut run = Simulation::new(scenario, options, Keep::Trace);
    let mut walk = vec![ants(&run)];
    assert!(walk[0].as_array().is_some_and(|ants| ants.len() == 4));
    while run.trace().events.is_empty() && !run.is_finished() {
        run.step();
        walk.push(ants(&run));
    }
    // The last one has walked already after the grasp.
    walk.pop();
    walk
}

/// Beliefs go on to be the same when the loads are elsewhere: whoever decides alike has the same
/// error in mind at the end.
#[test]
fn beliefs_are_the_same_wherever_the_load_is() {
    let scenario = careless_ants();
    let beliefs = |options: &BackendOptions| {
        let saved = serde_json::to_value(whole(&scenario, options).save().unwrap()).unwrap();
        saved["controller"]["ants"].as_array().unwrap().iter().map(|ant| ant["belief_error"].clone()).collect::<Vec<_>>()
    };
    let all: Vec<_> = all_options(&scenario).iter().map(beliefs).collect();
    assert!(all[0].iter().all(|belief| belief[0].as_f64().is_some_and(|error| error != 0.0)));
    assert!(all.iter().all(|beliefs| *beliefs == all[0]));
}

/// Both instants are one to the clock: nothing is held, nothing panics, and the other tips go their
/// ways.
#[test]
fn a_tip_let_go_at_its_grasp_is_never_held() {
    let mut scenario = busy_tips();
    let mut without = busy_tips();
    let (Drive::Tips(paths), Drive::Tips(fewer)) = (&mut scenario.drive, &mut without.drive) else { panic!("tips expected") };
    // Instants within 1e-9 of a control period are one: 5e-12 s.
    paths[0].release = Some(1e-12);
    fewer.remove(0);
    for options in all_options(&scenario) {
        assert_eq!(trace(&scenario, &options), trace(&without, &options));
    }
    let Drive::Tips(paths) = &mut scenario.drive else { panic!("tips expected") };
    paths[0].release = Some(1.1e-9 * scenario.control_period);
    for options in all_options(&scenario) {
        let events = trace(&scenario, &options).events;
        assert_eq!(events[..2].iter().map(|event| event.kind).collect::<Vec<_>>(), [EventKind::Grasp, EventKind::Release]);
    }
}

/// The first part of the trace would be missing.
#[test]
fn a_run_that_kept_no_trace_cannot_go_on_with_one() {
    let scenario = busy_tips();
    let options = all_options(&scenario)[0];
    let saved = Simulation::new(&scenario, &options, Keep::Outcome).save().unwrap();
    assert!(Simulation::resume(&scenario, &saved, Keep::Trace).err().is_some_and(|error| error.to_string().contains("kept no trace")));
    assert!(Simulation::resume(&scenario, &saved, Keep::Outcome).is_ok());
}

#[test]
fn a_state_of_another_run_is_refused_and_says_why() {
    let scenario = four_ants(0.5, 1);
    for options in all_options(&scenario) {
        let saved = Simulation::new(&scenario, &options, Keep::Trace).save().unwrap();
        let refusal = |scenario: &Scenario, saved: &SavedRun| match Simulation::resume(scenario, saved, Keep::Trace) {
            Ok(_) => panic!("resumed"),
            Err(error) => error.to_string(),
        };
        for other in [four_ants(0.5, 2), four_ants(0.6, 1), busy_tips()] {
            let text = refusal(&other, &saved);
            assert!(text.contains("saved from the scenario") && text.contains(&other.hash()), "{text}");
        }
        // A state whose parts are of different runs.
        for (part, value) in [
            ("/options/kind", json!(if options.kind == BackendKind::QuasiStatic { "inertial" } else { "quasi-static" })),
            ("/controller", Value::Null),
            ("/controller/ants", json!([])),
            ("/backend", json!({})),
        ] {
            let mut torn = serde_json::to_value(&saved).unwrap();
            *torn.pointer_mut(part).unwrap() = value;
            let text = refusal(&scenario, &serde_json::from_value(torn).unwrap());
            assert!(text.starts_with("saved state does not fit this run: "), "{part}: {text}");
        }
    }
}

/// Ants and springs that do not go together, or a rotation that is none, would otherwise go on as
/// if nothing were wrong, or end in the middle.
#[test]
fn a_damaged_state_is_refused_and_says_why() {
    let scenario = four_ants(12.0, 1);
    let mut run = Simulation::new(&scenario, &BackendOptions::new(BackendKind::QuasiStatic, 2.5e-3), Keep::Outcome);
    run.run(|time| time < 10.0);
    let saved = serde_json::to_value(run.save().unwrap()).unwrap();
    let ants = saved["controller"]["ants"].as_array().unwrap();
    let holding: Vec<usize> = (0..ants.len()).filter(|ant| ants[*ant]["mode"]["mode"] == "transport").collect();
    let [one, other] = holding[..2] else { panic!("{holding:?}") };
    let at = |ant: usize, key: &str| format!("/controller/ants/{ant}/mode/{key}");
    let spring_of = |ant: usize| ants[ant]["mode"]["spring"].clone();
    for (part, value, why) in [
        (at(one, "spring"), spring_of(other), "two ants at spring"),
        (at(one, "grasp_tick"), json!(1_000_000), "an ant that grasped at tick 1000000"),
        (format!("/controller/ants/{one}/mode"), json!({ "mode": "search" }), "attached springs"),
        ("/backend/springs/attachments".to_owned(), json!([]), "which is free"),
        ("/backend/springs/turn".to_owned(), json!([0.0, 0.0, 0.0, 0.0]), "a rotation that is not by the heading"),
    ] {
        let mut damaged = saved.clone();
        *damaged.pointer_mut(&part).unwrap_or_else(|| panic!("{part} in {saved}")) = value;
        let damaged: SavedRun = serde_json::from_value(damaged).unwrap();
        let error = Simulation::resume(&scenario, &damaged, Keep::Outcome).err().unwrap_or_else(|| panic!("{part}: resumed")).to_string();
        assert!(error.contains(why), "{part}: {error}");
    }
}

/// Steps carry the rotation by the heading on, in either order: through some thousands of them,
/// three turns of a load that four tips take around, its columns stay unit vectors to rounding.
/// Their angle is that of the heading but for the roundings of headings up to 20 rad, 2e-15 each.
#[test]
fn a_rotation_that_is_carried_on_stays_one() {
    let n = 900;
    let path = |spring: u32| {
        let at = |k: i32| (f64::from(spring) * 0.5 + f64::from(k) / 150.0) * std::f64::consts::PI;
        let waypoint = |k: i32| json!([f64::from(k) * 0.02, 0.0585 * at(k).cos(), 0.0585 * at(k).sin()]);
        json!({ "spring": spring, "waypoints": (0..=n).map(waypoint).collect::<Vec<_>>() })
    };
    let mut file = serde_json::to_value(four_ants(1.0, 1).expanded()).unwrap();
    file["drive"] = json!({ "kind": "tips", "paths": (0..4).map(path).collect::<Vec<_>>() });
    file["duration_s"] = json!(0.02 * f64::from(n));
    let scenario = Scenario::parse(&file.to_string(), "around").unwrap();
    for second_order in [false, true] {
        let options = BackendOptions { second_order, ..BackendOptions::new(BackendKind::QuasiStatic, 2.5e-3) };
        let mut run = Simulation::new(&scenario, &options, Keep::Outcome);
        run.run(|_| true);
        let saved = serde_json::to_value(run.save().unwrap()).unwrap();
        let turn: Vec<f64> = serde_json::from_value(saved["backend"]["springs"]["turn"].clone()).unwrap();
        let heading = run.motion().pose.heading;
        assert!(heading > 15.0 && run.outcome().steps.n_solves > 5000, "{heading}");
        assert!((turn[0].hypot(turn[1]) - 1.0).abs() <= 2.0 * f64::EPSILON, "{second_order}: {:e}", turn[0].hypot(turn[1]) - 1.0);
        let apart = (turn[0] - heading.cos()).hypot(turn[1] - heading.sin());
        assert!(apart < 1e-11, "{second_order}: {apart:e}");
    }
}
