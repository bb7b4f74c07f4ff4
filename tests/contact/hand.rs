//! Obstacles that are held by a spring, against closed forms.
//!
//! A box of mass m slides on the ground with the resistance F. A hand touches the middle of its
//! side. Over a period T the hand moves straight, so that motions with inertia are of first order.

use cohaul::backend::{BackendKind, BackendOptions, Tolerance};
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Commands, Controller, Hand, HandError, Keep, Outcome, Simulation, Trace, View};
use serde_json::{Value, json};

/// (kg, N)
const MASS: f64 = 1.0;
const RESISTANCE: f64 = 0.3 * MASS * 9.81;
/// Where the hand touches the box (m).
const TOUCH: f64 = -0.12;

fn rotated(vector: &Vec2, angle: f64) -> Vec2 {
    Pose::new(0.0, 0.0, angle).to_world(vector)
}

/// A box of 0.2 m by 0.1 m, a hand that is a disc at `x` (m), and further obstacles.
fn scenario(x: f64, others: &[Value], period: f64, duration: f64) -> Scenario {
    let hand = json!({
        "name": "hand", "outline": { "disc": { "radius_m": 0.02 } }, "friction_coefficient": 0.2,
        "path": { "waypoints": [[0.0, x, 0.0, 0.0]] },
    });
    let obstacles: Vec<Value> = std::iter::once(hand).chain(others.iter().cloned()).collect();
    let text = json!({
        "name": "hand", "duration_s": duration, "control_period_s": period,
        "load": {
            "mass_kg": MASS, "outline": { "rectangle": { "size_m": [0.2, 0.1] } }, "side_friction_coefficient": 0.2,
        },
        "ground": { "friction_coefficient": 0.3, "supports": { "uniform": { "n": 4 } } },
        "springs": [],
        "obstacles": obstacles,
        "drive": { "kind": "tips", "paths": [] },
    });
    Scenario::parse(&text.to_string(), "hand").expect("a scenario")
}

/// Holds obstacle 0 toward what `target` says of the end of each period (m, along the axis).
#[derive(Clone, Copy)]
struct Holding {
    target: fn(f64) -> f64,
    heading: f64,
    stiffness: f64,
    force_limit: f64,
}

impl Holding {
    const fn new(target: fn(f64) -> f64, stiffness: f64, force_limit: f64) -> Self {
        Self { target, heading: 0.0, stiffness, force_limit }
    }

    fn at(&self, time: f64) -> Hand {
        let axis = rotated(&Vec2::x(), self.heading);
        let (stiffness, force_limit) = (self.stiffness, self.force_limit);
        Hand { obstacle: 0, target: (self.target)(time) * axis, axis, stiffness, force_limit }
    }
}

impl Controller for Holding {
    fn decide(&mut self, _: &View, _: &mut Commands) {}

    fn targets(&mut self, _: &View, _: f64) -> &[Vec2] {
        &[]
    }

    fn hand(&mut self, _: &View, until: f64) -> Option<Hand> {
        Some(self.at(until))
    }
}

fn run(scenario: &Scenario, options: &BackendOptions, holding: Holding) -> (Trace, Outcome) {
    let mut run = Simulation::with_controller(scenario, options, Keep::Trace, Box::new(holding));
    run.run(|_time| true);
    run.into_results()
}

/// Coordinate of the load and of the hand along the axis at the end (m).
fn ends(trace: &Trace, heading: f64) -> [f64; 2] {
    let (last, axis) = (trace.rows.last().unwrap(), rotated(&Vec2::x(), heading));
    [last.motion.pose.position, last.steered[0].pose.position].map(|at| at.dot(&axis))
}

fn steadily(time: f64) -> f64 {
    TOUCH - 0.005 + 0.05 * time
}

fn far_ahead(_: f64) -> f64 {
    1.0
}

fn at_step(kind: BackendKind, scenario: &Scenario) -> BackendOptions {
    BackendOptions::at_step(None, kind, &scenario.system, scenario.control_period)
}

/// The hand goes 5 mm to the box, and stands while its spring is drawn to F / k. From then on the
/// box stays F / k behind.
#[test]
fn without_inertia_the_box_stays_behind_by_its_resistance_over_the_stiffness() {
    for heading in [0.0, 0.7, -2.4] {
        let mut scenario = scenario(TOUCH - 0.005, &[], 0.01, 1.2);
        scenario.start.pose = Pose::new(0.0, 0.0, heading);
        let path = &mut scenario.system.world.obstacles[0].path.waypoints[0].1;
        *path = Pose { position: rotated(&path.position, heading), ..*path };
        let holding = Holding { heading, ..Holding::new(steadily, 100.0, 50.0) };
        let within = BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(1e-6, &scenario.system.load));
        for options in [at_step(BackendKind::QuasiStatic, &scenario), within] {
            let (trace, outcome) = run(&scenario, &options, holding);
            assert_eq!(outcome.failed_at, None);
            for row in &trace.rows {
                let [load, hand] = [row.motion.pose.position, row.steered.first().map_or(Vec2::zeros(), |it| it.pose.position)]
                    .map(|at| at.dot(&rotated(&Vec2::x(), heading)));
                let behind = steadily(row.time) - TOUCH - RESISTANCE / 100.0;
                // A spring of 100 N/m moves the hand by 1e-8 m a 1e-6 N.
                assert!((load - behind.max(0.0)).abs() < 1e-8, "{heading} {options:?} at {}: {load} {behind}", row.time);
                let expected = if row.time == 0.0 { 0.0 } else { TOUCH + (steadily(row.time) - TOUCH).min(behind.max(0.0)) };
                assert!((hand - expected).abs() < 1e-8, "{heading} at {}: {hand} {expected}", row.time);
            }
            let now = trace.rows.last().unwrap();
            let force = holding.at(now.time).force(&now.steered[0].pose.position);
            assert!((force - RESISTANCE).abs() < 1e-6, "{force}");
        }
    }
}

/// x = v t - (v / w) sin(w t) since the slip onset, with w^2 = k / m.
#[test]
fn with_inertia_the_box_swings_about_that() {
    let onset = 0.1 + RESISTANCE / 100.0 / 0.05;
    let expected = |time: f64| 0.05 * (time - onset) - 0.005 * f64::sin(10.0 * (time - onset));
    for kind in [BackendKind::Inertial, BackendKind::Rapier] {
        let errors = [0.004, 0.002].map(|period| {
            let scenario = scenario(TOUCH - 0.005, &[], period, 1.2);
            let (trace, outcome) = run(&scenario, &at_step(kind, &scenario), Holding::new(steadily, 100.0, 50.0));
            assert_eq!(outcome.failed_at, None);
            let late = trace.rows.iter().filter(|row| row.time > onset);
            late.map(|row| (row.motion.pose.position.x - expected(row.time)).abs()).fold(0.0, f64::max)
        });
        // The period is 4 % of 1 / w: the swing of 5 mm is that much too small a time 1 / w.
        assert!(errors[0] < 5e-4 && errors[0] > 1.7 * errors[1] && errors[0] < 2.3 * errors[1], "{kind:?}: {errors:?}");
    }
}

/// The spring is drawn to its limit: the box goes on with the force that is left, and stands where
/// none is.
#[test]
fn a_force_limit_is_the_force_on_the_box() {
    for (limit, acceleration) in [(4.0, (4.0 - RESISTANCE) / MASS), (2.0, 0.0)] {
        for kind in [BackendKind::Inertial, BackendKind::Rapier] {
            let scenario = scenario(TOUCH, &[], 0.002, 0.5);
            let (trace, outcome) = run(&scenario, &at_step(kind, &scenario), Holding::new(far_ahead, 1e4, limit));
            assert_eq!(outcome.failed_at, None);
            // Each period has the velocity of its end.
            let expected = 0.5 * acceleration * 0.5 * (0.5 + 0.002);
            let [load, hand] = ends(&trace, 0.0);
            let allowed = if kind.is_exact() { 1e-8 } else { 2e-4 };
            assert!((load - expected).abs() < allowed, "{kind:?} {limit}: {load} {expected}");
            assert!((hand - load - TOUCH).abs() < allowed, "{kind:?} {limit}: {hand} {load}");
        }
    }
    let scenario = scenario(TOUCH, &[], 0.002, 0.5);
    let (trace, _) = run(&scenario, &at_step(BackendKind::QuasiStatic, &scenario), Holding::new(far_ahead, 1e4, 2.0));
    assert!(ends(&trace, 0.0)[0].abs() < 1e-8);
}

/// A hand at `beside` (m) the middle of the box.
fn beside(mut scenario: Scenario, beside: f64) -> Scenario {
    scenario.system.world.obstacles[0].path.waypoints[0].1.position.y = beside;
    scenario
}

/// Also where the hand begins away from the box, and where it touches beside the middle.
#[test]
fn a_hand_that_is_weaker_than_friction_moves_nothing() {
    for (gap, off) in [(0.005, 0.0), (1e-4, 0.02), (0.0, 0.02), (0.0, 0.0)] {
        for kind in BackendKind::ALL {
            for period in [0.01, 0.002] {
                let scenario = beside(scenario(TOUCH - gap, &[], period, 0.3), off);
                let holding = Holding::new(|time| TOUCH + 0.5 * time, 1e3, 0.85 * RESISTANCE);
                let (trace, outcome) = run(&scenario, &at_step(kind, &scenario), holding);
                let moved = trace.rows.last().unwrap().motion.pose.edge_displacement(&scenario.start.pose, 0.112);
                // With inertia the hand gives the load the impulse of the period in which it
                // touches. Friction less the force that goes on stops it. The load turns as well.
                let kicked = 2.0 * (0.85 * RESISTANCE * period).powi(2) / (2.0 * MASS * 0.15 * RESISTANCE);
                let allowed = match kind {
                    BackendKind::Inertial if gap > 0.0 => kicked,
                    // The engine creeps.
                    BackendKind::Rapier => 1e-3,
                    _ => 1e-6,
                };
                assert!(outcome.failed_at.is_none() && moved < allowed, "{kind:?} {gap} {off} {period}: {moved}");
            }
        }
    }
}

/// Without friction at the hand the force of the hand is that of the contact in every period.
#[test]
fn a_hand_beside_the_middle_pushes_evenly() {
    let mut scenario = beside(scenario(TOUCH, &[], 0.005, 0.6), 0.02);
    scenario.system.world.obstacles[0].friction_coefficient = 0.0;
    let holding = Holding::new(|time| TOUCH + 0.1 * time, 200.0, f64::INFINITY);
    let (trace, outcome) = run(&scenario, &at_step(BackendKind::QuasiStatic, &scenario), holding);
    assert_eq!(outcome.failed_at, None);
    for row in trace.rows.iter().filter(|row| row.time > 0.3) {
        let force = holding.at(row.time).force(&row.steered[0].pose.position);
        let contact: f64 = row.contacts.iter().map(|contact| contact.force.x).sum();
        let is_slip = force > 0.9 * RESISTANCE && force < RESISTANCE;
        assert!((force - contact).abs() < 1e-6 && is_slip, "at {}: {force} {contact}", row.time);
    }
}

/// v^2 / (2 a), with the deceleration a by ground and hand.
#[test]
fn a_hand_gives_way_to_a_box_that_slides_into_it() {
    let way = 0.5 * 0.25 / (2.0 + RESISTANCE);
    for kind in [BackendKind::Inertial, BackendKind::Rapier] {
        let mut scenario = scenario(TOUCH, &[], 0.001, 0.3);
        scenario.start.twist = Twist { linear: Vec2::new(-0.5, 0.0), angular: 0.0 };
        let (trace, outcome) = run(&scenario, &at_step(kind, &scenario), Holding::new(|_| TOUCH + 1.0, 1e4, 2.0));
        assert_eq!(outcome.failed_at, None);
        let [load, hand] = ends(&trace, 0.0);
        // Half the way of a period at the first speed.
        assert!((load + way).abs() < 3e-4 && (hand - TOUCH + way).abs() < 3e-4, "{kind:?}: {load} {hand} {way}");
    }
}

/// The box comes to a wall, and the hand stands behind it.
#[test]
fn a_hand_stands_where_a_wall_does() {
    let wall = json!({
        "name": "wall", "outline": { "polyline": { "points_m": [[0.115, -1.0], [0.115, 1.0]] } }, "friction_coefficient": 0.2,
    });
    for kind in BackendKind::ALL {
        let scenario = scenario(TOUCH, std::slice::from_ref(&wall), 0.005, 1.0);
        let (trace, outcome) = run(&scenario, &at_step(kind, &scenario), Holding::new(|time| TOUCH + 0.1 * time, 500.0, 20.0));
        assert_eq!(outcome.failed_at, None, "{kind:?}");
        // The engine lets the hand into the box by a hundredth of its radius.
        let allowed = if kind.is_exact() { 1e-6 } else { 1.2e-3 };
        let [load, hand] = ends(&trace, 0.0);
        assert!((load - 0.015).abs() < allowed && (hand - TOUCH - 0.015).abs() < allowed, "{kind:?}: {load} {hand}");
    }
}

#[test]
fn a_hand_that_is_none_ends_the_run() {
    let conveyor = json!({
        "name": "conveyor", "outline": { "disc": { "radius_m": 0.02 } },
        "path": { "waypoints": [[0.0, 1.0, 1.0, 0.0], [1.0, 2.0, 1.0, 0.0]] },
    });
    let still = scenario(TOUCH, &[], 0.01, 0.1);
    let moving = scenario(TOUCH, &[conveyor], 0.01, 0.1);
    let options = BackendOptions::new(BackendKind::QuasiStatic, 0.01);
    let hand = Holding::new(steadily, 100.0, 5.0).at(0.5);
    let found = |scenario: &Scenario, hand: Hand| {
        let mut backend = cohaul::backend::build(&scenario.system, scenario.start, &options);
        hand.advance(backend.as_mut(), &scenario.system.world, [0.0, 0.01], &[], false).unwrap_err()
    };
    assert_eq!(found(&still, Hand { obstacle: 1, ..hand }), HandError::NotThere(1));
    assert_eq!(found(&moving, hand), HandError::OtherMoves(1));
    for wrong in [
        Hand { axis: Vec2::new(1.0, 1.0), ..hand },
        Hand { target: Vec2::new(f64::NAN, 0.0), ..hand },
        Hand { stiffness: 0.0, ..hand },
        Hand { force_limit: -1.0, ..hand },
    ] {
        assert!(matches!(found(&still, wrong), HandError::Numbers(_)));
    }
    let (_, outcome) = run(&moving, &options, Holding::new(steadily, 100.0, 5.0));
    assert_eq!(outcome.failed_at, Some(0.0));
}
