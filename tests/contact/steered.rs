//! Obstacles that a controller steers.

use cohaul::analysis::compare::{OwnMeasure, Settings, ThreeWay, Verdict};
use cohaul::backend::{Backend, BackendKind, BackendOptions, Motion, Tolerance, Unmoved, build};
use cohaul::math::{Pose, Vec2};
use cohaul::model::{ObstaclePath, ObstaclePose};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Commands, Controller, Keep, Outcome, Row, Simulation, Trace, View};

#[expect(dead_code, reason = "it is a program")]
#[path = "../../examples/push_to_goal.rs"]
mod push_to_goal;

fn scene(name: &str) -> Scenario {
    Scenario::read(format!("scenarios/{name}.json").as_ref()).unwrap()
}

/// Sends all obstacles along these paths, tick by tick.
struct Along {
    paths: Vec<ObstaclePath>,
    targets: Vec<ObstaclePose>,
}

impl Along {
    fn paths_of(scenario: &Scenario) -> Box<dyn Controller> {
        let paths = scenario.system.world.obstacles.iter().map(|obstacle| obstacle.path.clone()).collect();
        Box::new(Self { paths, targets: Vec::new() })
    }
}

impl Controller for Along {
    fn decide(&mut self, _: &View, _: &mut Commands) {}

    fn targets(&mut self, _: &View, _: f64) -> &[Vec2] {
        &[]
    }

    fn pushers(&mut self, _: &View, until: f64) -> &[ObstaclePose] {
        let at = |(obstacle, path): (usize, &ObstaclePath)| ObstaclePose { obstacle, pose: path.pose_at(until) };
        self.targets = self.paths.iter().enumerate().map(at).collect();
        &self.targets
    }
}

fn run(scenario: &Scenario, options: &BackendOptions, controller: Option<Box<dyn Controller>>) -> (Trace, Outcome) {
    let mut run = match controller {
        Some(controller) => Simulation::with_controller(scenario, options, Keep::Trace, controller),
        None => Simulation::new(scenario, options, Keep::Trace),
    };
    run.run(|_time| true);
    run.into_results()
}

/// The paths of a scene, and the same motion as commands to obstacles that would otherwise stand
/// where they are.
#[test]
fn an_obstacle_that_is_steered_along_a_path_pushes_as_one_that_has_the_path() {
    for name in ["contact/pusher", "contact/push-aside", "robots/fence"] {
        let scenario = scene(name);
        let mut standing = scenario.clone();
        for obstacle in &mut standing.system.world.obstacles {
            obstacle.path = ObstaclePath::fixed(obstacle.path.pose_at(0.0));
        }
        for kind in BackendKind::ALL {
            let at_step = BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period);
            let within = Tolerance::at_edge(1e-6, &scenario.system.load);
            let exact = kind.is_exact().then(|| BackendOptions::within(kind, within));
            for options in [Some(at_step), exact].into_iter().flatten() {
                let (along, _) = run(&scenario, &options, None);
                let (steered, outcome) = run(&standing, &options, Some(Along::paths_of(&scenario)));
                assert_eq!((along.rows.len(), outcome.failed_at), (steered.rows.len(), None), "{name} {kind:?}");
                // A step with inertia after a command is of first order, and the engine rounds.
                let allowed = if options.tolerance.is_some() || kind.has_inertia() { 5e-6 } else { 1e-9 };
                for (a, b) in along.rows.iter().zip(&steered.rows) {
                    let apart = a.motion.pose.edge_displacement(&b.motion.pose, scenario.system.load.radius);
                    assert!(apart <= allowed, "{name} {kind:?} at {} s: {apart:e} m", a.time);
                }
                let moved = steered.rows.last().unwrap().motion.pose.edge_displacement(&scenario.start.pose, scenario.system.load.radius);
                assert!(moved > 0.01, "{name} {kind:?}: {moved} m");
                // Rows have the poses that were commanded.
                let (last, path) = (steered.rows.last().unwrap(), &scenario.system.world.obstacles[0].path);
                assert_eq!(last.steered[0].pose, path.pose_at(last.time));
                assert!(along.rows.iter().all(|row| row.steered.is_empty()));
                assert_eq!(steered.world(&standing.system.world).obstacles[0].path.pose_at(last.time), path.pose_at(last.time));
            }
        }
    }
}

/// Two backends of which one was saved and restored between two commands.
#[test]
fn a_steered_backend_goes_on_from_a_saved_state_to_the_bit() {
    let scenario = scene("contact/pusher");
    for kind in BackendKind::ALL {
        let options = BackendOptions::new(kind, 1e-3);
        let new = || build(&scenario.system, scenario.start, &options);
        let push = |backend: &mut dyn Backend, tick: u32| {
            let pose = Pose::new(-0.0172 + 1e-4 * f64::from(tick), 1e-5 * f64::from(tick), 0.0);
            assert!(backend.steer(0, &[(1e-3, pose)]));
            backend.advance(&[], 1e-3);
            backend.motion()
        };
        let mut whole = new();
        let before: Vec<Motion> = (1..=50).map(|tick| push(whole.as_mut(), tick)).collect();
        // What was steered before counts no more, nor what comes after the command.
        let mut resumed = new();
        resumed.steer(0, &[(1.0, Pose::new(9.0, 9.0, 0.0))]);
        resumed.restore(&whole.save().unwrap()).unwrap();
        assert_eq!(resumed.steered(), whole.steered());
        let both = [whole.as_mut(), resumed.as_mut()].map(|backend| (51..=100).map(|tick| push(backend, tick)).collect::<Vec<_>>());
        assert_eq!(both[0], both[1], "{kind:?}");
        assert!(both[0][49].pose.position.x > before[49].pose.position.x + 1e-3);
        // A state that was not steered goes back to the path of the scenario.
        resumed.restore(&new().save().unwrap()).unwrap();
        assert!(resumed.steered().is_empty());
        resumed.advance(&[], 0.5);
        let mut on_path = new();
        on_path.advance(&[], 0.5);
        assert_eq!(resumed.motion(), on_path.motion(), "{kind:?}");
    }
}

#[test]
fn what_is_no_course_is_refused_and_changes_nothing() {
    let scenario = scene("contact/pusher");
    let at = |x: f64| Pose::new(x, 0.0, 0.0);
    for kind in BackendKind::ALL {
        let mut backend = build(&scenario.system, scenario.start, &BackendOptions::new(kind, 1e-3));
        let courses: [&[(f64, Pose)]; 6] = [
            &[],
            &[(-1.0, at(0.0))],
            &[(f64::NAN, at(0.0))],
            &[(1.0, at(f64::NAN))],
            &[(1.0, at(1e61))],
            &[(1.0, at(0.0)), (1.0, at(1.0))],
        ];
        for course in courses {
            assert!(!backend.steer(0, course), "{kind:?} {course:?}");
        }
        assert!(!backend.steer(1, &[(1.0, at(0.0))]) && backend.steered().is_empty());
    }
    let mut run = Simulation::from_parts(
        &scenario,
        &BackendOptions::new(BackendKind::QuasiStatic, 1e-3),
        Keep::Outcome,
        Along::paths_of(&scenario),
        Box::new(Unmoved(scenario.start)),
    );
    run.run(|_time| true);
    assert_eq!(run.outcome().failed_at, Some(0.0));
}

/// The disc ends within 1 mm of the goal on every backend, by its own commands, and so it does when
/// the recorded commands are replayed. The number of the measure is that of the traces.
#[test]
fn a_pushing_controller_closes_the_loop_on_every_backend() {
    let scenario = scene("contact/pusher");
    let goal = Vec2::new(0.03, 0.01);
    let missed = |rows: &[Row]| rows.last().map_or(f64::NAN, |row| (goal - row.motion.pose.position).norm());
    let own = OwnMeasure { name: "distance to the goal", unit: "m", of: &missed, tolerance: Some(1e-3) };
    let make = |_: &Scenario| -> Box<dyn Controller> { Box::<push_to_goal::Push>::default() };
    let settings = Settings::default();
    let runs = ThreeWay::new(&scenario, &settings).controller(&make).measure(&own);
    let controlled = runs.controlled(|_share| true).unwrap();
    let measure = controlled.verdicts.measure.clone().unwrap();
    assert_eq!((measure.verdict, measure.unit), (Verdict::Agree, "m"));
    for (solution, value) in controlled.solutions.iter().zip([0, 1, 2].map(|run| {
        let of = &measure.measures[0];
        [of.quasi_static, of.inertial, of.engine][run]
    })) {
        let last = solution.trace.rows.last().unwrap();
        assert_eq!(value, (goal - last.motion.pose.position).norm());
        assert!(value < 1.1e-3, "{:?}: {value} m", solution.kind);
        assert!(solution.trace.rows.iter().any(|row| !row.contacts.is_empty()));
    }
    // Each pusher answers to its own load.
    let [a, b, _] = controlled.solutions.each_ref().map(|solution| &solution.trace.rows.last().unwrap().steered);
    assert!(a[0].pose != b[0].pose);
    let replayed = runs.replayed(|_share| true).unwrap();
    assert_eq!(replayed.verdicts.measure.as_ref().map(|of| of.verdict), Some(Verdict::Agree));
    let [a, b, _] = replayed.solutions.each_ref().map(|solution| &solution.trace.rows.last().unwrap().steered);
    assert_eq!(a, b);
    assert!(!replayed.solutions[1].trace.rows.is_empty() && replayed.verdicts.path.verdict != Verdict::NotComputed);
}
