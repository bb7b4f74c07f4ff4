//! Springs that are attached again and again, tips that were recorded, and controllers of one's
//! own.

use cohaul::analysis::compare::{Settings, ThreeWay};
use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::math::Vec2;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Commands, Controller, Event, EventKind, Keep, Simulation, Trace, View, controller_of};
use cohaul_paper::from_tips::scenario_from_tips;
use cohaul_report::tips_csv::write_tips;

fn shipped(name: &str) -> String {
    std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").join(name)).unwrap()
}

fn run(scenario: &Scenario, kind: BackendKind) -> Trace {
    let mut run = Simulation::new(scenario, &BackendOptions::new(kind, scenario.control_period), Keep::Trace);
    run.run(|_| true);
    run.into_results().0
}

/// Largest edge displacement between rows at the same times, the last of which is at `until` (s).
fn farthest(a: &Trace, b: &Trace, radius: f64) -> (f64, f64) {
    let pairs: Vec<_> = a.rows.iter().zip(&b.rows).filter(|(a, b)| a.time == b.time).collect();
    let distance = pairs.iter().map(|(a, b)| a.motion.pose.edge_displacement(&b.motion.pose, radius)).fold(0.0, f64::max);
    (distance, pairs.last().unwrap().0.time)
}

/// Grasps and releases between ticks, a corner between ticks, a second attachment.
fn busy() -> String {
    shipped("analytic/ramp-and-hold.json").replace(
        "[0.5, 0.04, 0.0]] }",
        "[0.30047, 0.045, 0.001]], \"release_s\": 0.40033 }, {\"spring\": 0, \"waypoints\": [[0.5521, 0.03, 0.0], [0.8, -0.04, 0.02]] }",
    )
}

/// The tips of a run, written and read again, lead every backend along the same path.
#[test]
fn recorded_tips_of_any_run_give_the_same_path() {
    let scenes = [
        ("busy", busy(), 1.0),
        ("reference", shipped("analytic/qs-ref-1.json"), 0.5),
        ("release", shipped("analytic/release-jump.json"), 2.5),
        ("four ants", shipped("paper/four-ants-four-springs.json"), 12.0),
        ("ants before a wall", shipped("paper/wall-with-gap.json"), 6.0),
        ("past a corner", shipped("robots/tow-past-corner.json"), 1.5),
        ("tips that jump", shipped("stress/tip-jump.json"), 0.5),
    ];
    for (name, text, duration) in scenes {
        let scenario = Scenario { duration, ..Scenario::parse(&text, name).unwrap() };
        for kind in [BackendKind::QuasiStatic, BackendKind::Inertial] {
            let trace = run(&scenario, kind);
            let mut table = Vec::new();
            write_tips(&trace, &mut table).unwrap();
            let made = scenario_from_tips(&String::from_utf8(table).unwrap(), "tips.csv", &scenario).unwrap();
            let Drive::Tips(paths) = &made.drive else { panic!("tips") };
            let n_grasps = trace.events.iter().filter(|event| event.kind == EventKind::Grasp).count();
            assert_eq!(paths.len(), n_grasps, "{name}: a path for each attachment");
            let again = run(&Scenario { duration: made.duration.min(duration), ..made.clone() }, kind);
            let (distance, until) = farthest(&trace, &again, scenario.system.load.radius);
            assert!(distance <= 1e-9, "{name}, {kind:?}: {distance:e} m");
            assert!(until > 0.9 * duration, "{name}: {until} s of {duration} s");
            let start = trace.rows[0].motion.pose;
            let moved = trace.rows.iter().map(|row| row.motion.pose.edge_displacement(&start, 1.0)).fold(0.0, f64::max);
            assert!(moved > 1e-4, "{name}: the load moves, {moved} m");
        }
    }
}

/// Without a column of events a spring is released where it is missing, and faults name the place.
#[test]
fn a_camera_needs_no_events() {
    let like = Scenario::parse(&shipped("analytic/ramp-and-hold.json"), "ramp").unwrap();
    let header = "time_s,spring,x_m,y_m,heading_rad,tip_x_m,tip_y_m\n";
    // Another spring would show frames without this one; with one spring a frame is a row.
    let two = Scenario::parse(
        &{
            let mut file = serde_json::to_value(like.expanded()).unwrap();
            let spring = file["springs"][0].clone();
            file["springs"].as_array_mut().unwrap().push(spring);
            file.to_string()
        },
        "two",
    )
    .unwrap();
    let rows = "0,0,0.5,0.1,0.2,0.5,0.1\n0.1,0,0,0,0,0.51,0.1\n0.1,1,0,0,0,0.5,0.1\n0.2,1,0,0,0,0.5,0.1\n0.3,0,0,0,0,0.52,0.1\n";
    let made = scenario_from_tips(&format!("{header}{rows}"), "camera.csv", &two).unwrap();
    let Drive::Tips(paths) = &made.drive else { panic!("tips") };
    let found: Vec<_> = paths.iter().map(|path| (path.spring, path.waypoints.len(), path.waypoints[0].time, path.release)).collect();
    assert_eq!(found, [(0, 3, 0.0, Some(0.2)), (0, 1, 0.3, None), (1, 2, 0.1, Some(0.3))]);
    assert_eq!((made.start.pose.position, made.start.pose.heading, made.duration), (Vec2::new(0.5, 0.1), 0.2, 1.0));
    for (table, why) in [
        (format!("{header}0,2,0,0,0,0,0\n"), "line 2, spring: must be below 2"),
        (format!("{header}0,0,0,0,0,51,1\n"), "line 2, tip_x_m: must lie within 100 rest lengths"),
        ("time_s,spring,tip_in_root_x_m,tip_in_root_y_m\n0,0,0.01,0\n".to_owned(), "must have tips in world axes"),
        (
            format!("{}0,0,0,0,0,0,0,let go\n", header.replace("y_m\n", "y_m,event\n")),
            "line 2, event: must be release or empty, found let go",
        ),
    ] {
        let error = scenario_from_tips(&table, "camera.csv", &two).unwrap_err().to_string();
        assert!(error.starts_with("camera.csv: ") && error.contains(why), "{error}");
    }
}

/// A spring that is attached a second time pulls as another one at the same place would.
#[test]
fn a_spring_attached_again_pulls_as_another_one_would() {
    let again = Scenario::parse(&busy(), "again").unwrap();
    let mut file = serde_json::to_value(again.expanded()).unwrap();
    let spring = file["springs"][0].clone();
    file["springs"].as_array_mut().unwrap().push(spring);
    file["drive"]["paths"][1]["spring"] = 1.into();
    let other = Scenario::parse(&file.to_string(), "other").unwrap();
    for kind in BackendKind::ALL {
        let (again, other) = (run(&again, kind), run(&other, kind));
        assert_eq!(again.events.len(), 3);
        // Roundings of positions of 0.04 m; rapier's joints differ in order.
        let (distance, _) = farthest(&again, &other, 0.0122);
        assert!(distance < 1e-9, "{kind:?}: {distance:e} m");
        let end = again.rows.last().unwrap();
        assert!(end.tips.len() == 1 && end.motion.pose.position.x < 0.0, "{kind:?}: it is pulled back at last");
    }
}

/// A robot whose speed falls as the load comes near to its goal.
struct Approach {
    tip: Vec2,
}

impl Controller for Approach {
    fn decide(&mut self, view: &View, commands: &mut Commands) {
        if view.time == 0.0 {
            commands.events.push(Event { time: 0.0, kind: EventKind::Grasp, spring: 0, ant: None, tip: self.tip });
        }
    }

    fn targets(&mut self, view: &View, until: f64) -> &[Vec2] {
        let left = 0.02 - view.motion.pose.position.x;
        self.tip.x += (3.0 * left).clamp(-0.1, 0.1) * (until - view.time);
        std::slice::from_ref(&self.tip)
    }
}

/// A controller that follows the load gets a verdict on each quantity. Its reference error is
/// larger than that of the same commands, since it answers to errors; without feedback the verdict
/// is that of prescribed tips.
#[test]
fn controllers_of_ones_own_get_a_verdict_on_each_quantity() {
    let scenario = Scenario { duration: 0.7, ..Scenario::parse(&shipped("analytic/ramp-and-hold.json"), "ramp").unwrap() };
    let settings = Settings { step_s: Some(1e-3), ..Settings::default() };
    let approach = |_: &Scenario| -> Box<dyn Controller> { Box::new(Approach { tip: Vec2::zeros() }) };
    let found = ThreeWay::new(&scenario, &settings).controller(&approach).controlled(|_| true).unwrap();
    assert!(found.references_converged());
    let [quasi_static, inertial, _] = &found.solutions;
    assert!(quasi_static.trace.rows.last().unwrap().tips[0].position != inertial.trace.rows.last().unwrap().tips[0].position);
    // A load of 1.6 g overshoots where it starts to slip.
    assert!(found.verdicts.path.verdict.has_inertia(), "{:?}", found.verdicts.path);
    assert!(found.edge_displacement.reference_error_m < 0.05 * found.tolerance_m, "{:?}", found.edge_displacement);
    assert_eq!(serde_json::to_value(found.tier).unwrap(), "controlled");

    let of_tips = |scenario: &Scenario| controller_of(scenario);
    let own = ThreeWay::new(&scenario, &settings).controller(&of_tips).controlled(|_| true).unwrap();
    let prescribed = ThreeWay::new(&scenario, &settings).prescribed(|_| true).unwrap();
    for ((name, own), (_, prescribed)) in own.verdicts.named().into_iter().zip(prescribed.verdicts.named()) {
        assert_eq!(own.verdict, prescribed.verdict, "{name}");
    }
    let difference = own.edge_displacement.inertia_effect_m - prescribed.edge_displacement.inertia_effect_m;
    assert!(difference.abs() < 0.02 * prescribed.edge_displacement.inertia_effect_m, "{difference}");
}
