//! Ants among obstacles: they reach what can be reached, overlap nothing, and sense nothing through
//! walls.

use std::f64::consts::{PI, TAU};

use cohaul::backend::{BackendKind, BackendOptions, default_step};
use cohaul::math::{Pose, RandomStreams, Stream, Vec2, direction};
use cohaul::model::ant::{Ant, Mode, Steering};
use cohaul::model::avoidance::{Avoidance, Side, Walker};
use cohaul::model::behaviour::turn_towards;
use cohaul::model::geometry::{Barrier, Barriers, PlacedBarrier};
use cohaul::model::{Outline, OutlinePart};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Ants, Controller, Keep, Outcome, Simulation, Trace, follow_ants};
use serde_json::{Value, json};

const WALKER: Walker = Walker { radius: 0.002, look_ahead: 0.03 };
/// Walking speed (m/s) and control period (s).
const SPEED: f64 = 0.08;
const PERIOD: f64 = 0.0025;

fn disc(x: f64, y: f64, radius: f64) -> PlacedBarrier {
    PlacedBarrier::new(Barrier::of(&Outline::disc(radius)), &Pose::new(x, y, 0.0))
}

fn wall(list: &[[f64; 2]]) -> PlacedBarrier {
    let outline = Outline { parts: vec![OutlinePart::Polyline { points: list.iter().copied().map(Vec2::from).collect() }] };
    PlacedBarrier::new(Barrier::of(&outline), &Pose::new(0.0, 0.0, 0.0))
}

fn still(barriers: &[PlacedBarrier]) -> Barriers {
    Barriers::new(barriers.to_vec(), Vec::new(), WALKER.radius)
}

/// A walk of at most ten seconds to within 5 mm of a target: the path, and whether it arrived. No
/// step overlaps a barrier.
fn walk(
    barriers: &[PlacedBarrier],
    (x, y, heading): (f64, f64, f64),
    target: [f64; 2],
    avoidance: Avoidance,
    draw: impl Fn() -> Side,
) -> (Vec<Vec2>, bool) {
    let barriers = still(barriers);
    let (target, steering) = (Vec2::from(target), Steering::new(10.0, PERIOD));
    let (mut ant, mut side) = (Ant::new(Vec2::new(x, y), heading), None);
    let mut path = vec![ant.position];
    for _ in 0..4000 {
        let from = ant.position;
        if (target - from).norm() < 0.005 {
            return (path, true);
        }
        let desired = WALKER.desired(barriers.alone(), &from, &ant.ahead, &target, &mut side, &draw);
        ant.walk(SPEED * PERIOD, steering.turn(turn_towards(&desired, &ant.ahead)), 0.0);
        ant.position = WALKER.stepped(barriers.alone(), &from, &ant.position, avoidance).expect("there is room");
        assert!(WALKER.is_clear(barriers.alone(), &ant.position), "{}", ant.position);
        path.push(ant.position);
    }
    (path, false)
}

fn length(path: &[Vec2]) -> f64 {
    path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}

fn never() -> Side {
    panic!("no side is drawn here")
}

/// Three posts between start and target, and any heading at the start.
#[test]
fn ants_and_robots_walk_round_posts() {
    let posts = [disc(0.0, 0.0, 0.03), disc(0.045, 0.02, 0.012), disc(0.045, -0.03, 0.012)];
    let streams = RandomStreams::new(1);
    for avoidance in [Avoidance::Sidestep, Avoidance::Turn] {
        let mut detours: Vec<f64> = (0..300)
            .map(|case| {
                let [u, v] = streams.uniform_pair(Stream::Scene, case, 0);
                let start = (-0.1 + 0.05 * u, -0.05 + 0.1 * v, PI * (2.0 * streams.uniform(Stream::Scene, case, 1) - 1.0));
                let (path, arrived) = walk(&posts, start, [0.09, 0.0], avoidance, || Side::Left);
                assert!(arrived, "{avoidance:?} from {start:?}");
                length(&path) / (Vec2::new(0.09, 0.0) - path[0]).norm()
            })
            .collect();
        detours.sort_by(f64::total_cmp);
        // The prototype of this rule in Python walks 1.10 times the straight way in the median.
        assert!((1.02..1.2).contains(&detours[150]), "{avoidance:?}: {}", detours[150]);
    }
}

/// A post exactly ahead: projection alone would stop the ant for good. Both sides are as long.
#[test]
fn an_ant_straight_before_a_post_takes_the_side_that_is_drawn() {
    let post = [disc(0.0, 0.0, 0.03)];
    let lengths = [Side::Left, Side::Right].map(|drawn| {
        let (path, arrived) = walk(&post, (-0.08, 0.0, 0.0), [0.08, 0.0], Avoidance::Sidestep, || drawn);
        let left = path.iter().all(|at| at.y >= 0.0);
        assert!(arrived && left == (drawn == Side::Left));
        length(&path)
    });
    // One path is the mirror image of the other, up to rounding.
    assert!((lengths[0] - lengths[1]).abs() < 1e-9, "{lengths:?}");
}

#[test]
fn an_ant_passes_a_wall_by_its_gap() {
    let gap = [wall(&[[0.0, -0.3], [0.0, -0.01]]), wall(&[[0.0, 0.01], [0.0, 0.3]])];
    for (k, heading) in [0.3, 1.5, -2.0].into_iter().enumerate() {
        let start = (-0.05, 0.04, heading);
        let (path, arrived) = walk(&gap, start, [0.05, 0.04], Avoidance::Sidestep, never);
        let crossing = path.windows(2).find(|pair| pair[0].x < 0.0 && pair[1].x >= 0.0).expect("it crosses the wall");
        // Up to the overlap that is allowed, and one step of 0.2 mm.
        assert!(arrived && crossing[0].y.abs() < 0.01 - 0.002 + 3e-4, "case {k}: {}", crossing[0]);
    }
}

/// A pocket 80 mm wide and 60 mm deep, open towards the start: the ant leaves it along the wall and
/// walks round. The target lies 50 mm behind the bottom. Out of a closed room there is no way.
#[test]
fn an_ant_leaves_a_pocket_and_stays_in_a_closed_room() {
    let bends = [[-0.06, 0.04], [0.0, 0.04], [0.0, -0.04], [-0.06, -0.04]];
    let (path, arrived) = walk(&[wall(&bends)], (-0.05, 0.01, 0.1), [0.05, 0.0], Avoidance::Sidestep, never);
    let deepest = path.iter().map(|at| at.x).take_while(|x| *x < 0.0).fold(f64::NEG_INFINITY, f64::max);
    let farthest_back = path.iter().map(|at| at.x).fold(f64::INFINITY, f64::min);
    assert!(arrived && deepest > -0.03 && farthest_back < -0.06, "deepest {deepest}, back to {farthest_back}");
    let room: Vec<[f64; 2]> = bends.into_iter().chain([bends[0]]).collect();
    let (path, arrived) = walk(&[wall(&room)], (-0.05, 0.01, 0.1), [0.05, 0.0], Avoidance::Sidestep, never);
    assert!(!arrived && path.iter().all(|at| at.x < 0.0 && at.x > -0.06 && at.y.abs() < 0.04));
}

/// The mirror image of a scene gives the mirror image of the path, since no side is drawn.
#[test]
fn a_mirrored_scene_has_a_mirrored_path() {
    let scene = |sign: f64| {
        let bends = [[-0.01, -0.03], [0.02, -0.03], [0.02, 0.015]].map(|[x, y]: [f64; 2]| [x, sign * y]);
        [disc(-0.03, 0.005 * sign, 0.008), wall(&bends)]
    };
    for avoidance in [Avoidance::Sidestep, Avoidance::Turn] {
        let (path, arrived) = walk(&scene(1.0), (-0.08, 0.0, 0.4), [0.08, 0.01], avoidance, never);
        let (mirrored, _) = walk(&scene(-1.0), (-0.08, 0.0, -0.4), [0.08, -0.01], avoidance, never);
        assert!(arrived && path.len() == mirrored.len());
        // Rounding grows over some thousand steps.
        assert!(path.iter().zip(&mirrored).all(|(a, b)| (a.x - b.x).hypot(a.y + b.y) < 1e-9), "{avoidance:?}");
    }
}

/// A disc that moves over a walker that stands still pushes it ahead.
#[test]
fn what_moves_pushes_walkers() {
    let mut at = Vec2::new(0.02, 0.0);
    for tick in 0..400 {
        let pusher = disc(1e-4 * f64::from(tick), 0.0, 0.01);
        at = WALKER.stepped(still(&[pusher]).alone(), &at, &at, Avoidance::Turn).unwrap();
    }
    assert!((at - Vec2::new(0.0399 + 0.012, 0.0)).norm() < 1e-12, "{at}");
}

/// The paper's load with ants, and other keys of the scenario and the drive.
fn scenario(keys: Value, drive: Value) -> Scenario {
    let mut file = json!({
        "name": "ants among obstacles", "duration_s": 4.0, "control_period_s": PERIOD,
        "load": { "mass_kg": 0.0016, "radius_m": 0.0122 },
        "ground": { "friction_coefficient": 1.4, "supports": { "tripod": { "radius_m": 0.008 } } },
        "springs": [{ "ring": { "n": 4, "radius_m": 0.0122, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
            "torsional_stiffness_nm_per_rad": 4.52e-4 } }],
        "drive": { "kind": "ants", "n_ants": 6, "nest_position_m": [0.2, -0.17] }
    });
    file.as_object_mut().unwrap().extend(keys.as_object().unwrap().clone());
    file["drive"].as_object_mut().unwrap().extend(drive.as_object().unwrap().clone());
    Scenario::parse(&file.to_string(), "ants").unwrap_or_else(|error| panic!("{error}"))
}

fn run(scenario: &Scenario) -> (Trace, Outcome) {
    let step = default_step(BackendKind::QuasiStatic, &scenario.system, scenario.control_period);
    let mut run = Simulation::new(scenario, &BackendOptions::new(BackendKind::QuasiStatic, step), Keep::Trace);
    run.run(|_| true);
    run.into_results()
}

/// Obstacles of all kinds about the load, one of which moves slowly.
fn random_obstacles(seed: u32) -> Value {
    let streams = RandomStreams::new(9);
    let draw = |k: u64| streams.uniform(Stream::Scene, seed, k);
    let outline = |k: u64| match k % 3 {
        0 => json!({ "disc": { "radius_m": 0.005 + 0.01 * draw(10 + k) } }),
        1 => json!({ "rectangle": { "size_m": [0.03, 0.003 + 0.02 * draw(10 + k)] } }),
        _ => json!({ "polyline": { "points_m": [[-0.02, 0.0], [0.0, 0.02 * draw(10 + k)], [0.015, -0.01]] } }),
    };
    let obstacle = |k: u64| {
        let at = (0.045 + 0.06 * draw(20 + k)) * direction(TAU * (k as f64 + 0.4 * draw(30 + k)) / 7.0);
        let mut obstacle = json!({ "name": format!("obstacle {k}"), "outline": outline(k) });
        if k == 6 {
            obstacle["path"] = json!({ "waypoints": [[0.5, 2.0 * at.x, 2.0 * at.y, 0.0], [3.0, 1.5 * at.x, 1.5 * at.y, 1.0]] });
        } else {
            (obstacle["position_m"], obstacle["heading_rad"]) = (json!([at.x, at.y]), json!(TAU * draw(40 + k)));
        }
        obstacle
    };
    (0..7).map(obstacle).collect()
}

/// Ants that search, pull and are let go, in random scenes. The disc about each of them overlaps no
/// obstacle at any tick.
#[test]
fn no_ant_is_ever_inside_an_obstacle() {
    let (mut n_events, mut n_close) = (0, 0);
    for seed in 0..8 {
        let avoidance = if seed % 4 == 3 { "turn" } else { "sidestep" };
        let keys = json!({ "obstacles": random_obstacles(seed), "seed": seed });
        let scenario = scenario(keys, json!({ "avoidance": avoidance, "start_half_width_m": 0.12 }));
        let (trace, _) = run(&scenario);
        n_events += trace.events.len();
        follow_ants(&scenario, &trace, |row, ants| {
            for (obstacle, ant) in scenario.system.world.obstacles.iter().flat_map(|obstacle| ants.iter().map(move |ant| (obstacle, ant))) {
                let barrier = PlacedBarrier::new(Barrier::of(&obstacle.outline), &obstacle.path.pose_at(trace.rows[row].time));
                let distance = barrier.gap(&ant.position).unwrap().distance;
                // The overlap that is allowed, which is a millionth of the radius.
                assert!(distance > 0.002 * (1.0 - 2e-6), "seed {seed}, row {row}: {distance} from {}", obstacle.name);
                n_close += u32::from(distance < 0.002 * (1.0 + 1e-6));
            }
        });
    }
    assert!(n_events > 30 && n_close > 1000, "{n_events} events, {n_close} contacts");
}

/// Whether an ant that stands at `at` grasps the one tip, at (38.5 mm, 0), in the first tick.
fn grasps(obstacle: Value, at: [f64; 2], avoidance: &str) -> bool {
    let one = json!([{ "root_m": [0.0122, 0.0], "bearing_rad": 0.0, "rest_length_m": 0.0263, "radial_stiffness_n_per_m": 0.664,
        "torsional_stiffness_nm_per_rad": 4.52e-4 }]);
    let keys = json!({ "springs": one, "obstacles": [{ "name": "wall", "outline": obstacle }], "duration_s": PERIOD });
    let drive = json!({ "n_ants": 1, "search_speed_m_per_s": 0.0, "grasp_pace": "per-tick", "grasp_probability": 1.0,
        "avoidance": avoidance });
    let scenario = scenario(keys, drive);
    let Drive::Ants(drive) = &scenario.drive else { panic!("ants") };
    let mut ants = Ants::new(&scenario, drive);
    let mut state = ants.save().unwrap();
    state["ants"][0]["position"] = json!(at);
    ants.restore(&state).unwrap();
    let options = BackendOptions::new(BackendKind::QuasiStatic, PERIOD);
    let mut run = Simulation::with_controller(&scenario, &options, Keep::Trace, Box::new(ants));
    run.run(|_| true);
    !run.into_results().0.events.is_empty()
}

/// A hair on both sides of what an ant of radius 2 mm can pass.
#[test]
fn no_tip_is_sensed_through_a_wall() {
    let beside = |end: f64| json!({ "polyline": { "points_m": [[0.0435, -0.1], [0.0435, end]] } });
    let ant = [0.0485, 0.0];
    assert!(grasps(beside(-0.00201), ant, "sidestep"));
    assert!(!grasps(beside(-0.00199), ant, "sidestep"));
    assert!(!grasps(beside(0.1), ant, "turn"));
    // Ants that avoid nothing sense through walls.
    assert!(grasps(beside(0.1), ant, "none"));
    // A tip beside a wall is no place for an ant unless it fits.
    let behind = |gap: f64| json!({ "polyline": { "points_m": [[0.0385 - gap, -0.1], [0.0385 - gap, 0.1]] } });
    assert!(grasps(behind(0.00201), ant, "sidestep"));
    assert!(!grasps(behind(0.00199), ant, "sidestep"));
}

/// A wall 15 mm in front of the tip, across the way to the nest: the ant drags the tip along it.
#[test]
fn a_tip_is_not_dragged_through_a_wall() {
    let wall = |avoidance: &str| {
        let outline = json!({ "polyline": { "points_m": [[0.06, -0.5], [0.06, 0.5]] } });
        let keys = json!({ "obstacles": [{ "name": "wall", "outline": outline }], "duration_s": 20.0, "seed": 3 });
        scenario(keys, json!({ "avoidance": avoidance, "nest_position_m": [0.3, 0.0] }))
    };
    let farthest = |scenario: &Scenario| {
        let (trace, _) = run(scenario);
        trace.rows.iter().flat_map(|row| row.tips.iter().map(|tip| tip.position.x)).fold(f64::NEG_INFINITY, f64::max)
    };
    let (kept, free) = (farthest(&wall("sidestep")), farthest(&wall("none")));
    assert!(kept > 0.0575 && kept <= 0.058 + 2e-9, "{kept}");
    assert!(free > 0.07, "{free}");
}

/// Every digit of a run follows from the scenario. Avoidance is "sidestep" among obstacles and
/// "none" elsewhere, where it changes nothing.
#[test]
fn runs_with_avoidance_are_repeated_to_the_bit() {
    let text = |scenario: &Scenario| serde_json::to_string(&run(scenario)).unwrap();
    let among = |drive: Value| scenario(json!({ "obstacles": random_obstacles(2), "duration_s": 4.0 }), drive);
    let first = text(&among(json!({})));
    assert_eq!(first, text(&among(json!({ "avoidance": "sidestep", "body_radius_m": 0.002 }))));
    assert_ne!(first, text(&among(json!({ "avoidance": "turn" }))));
    let (plain, none) = (scenario(json!({}), json!({})), scenario(json!({}), json!({ "avoidance": "none" })));
    assert_eq!((plain.hash(), &plain), (none.hash(), &none));
    assert_ne!(plain.hash(), scenario(json!({}), json!({ "avoidance": "sidestep" })).hash());
    assert_eq!(serde_json::to_value(plain.expanded()).unwrap()["drive"].get("body_radius_m"), None);
}

/// Ants that start in a crowded square stand beside obstacles and load; where the first draw of a
/// position is free it is kept.
#[test]
fn ants_start_where_they_fit() {
    let obstacles = json!([{ "name": "block", "outline": { "rectangle": { "size_m": [0.1, 0.25] } }, "position_m": [-0.08, 0.0] }]);
    let starts = |avoidance: &str| {
        let scenario = scenario(json!({ "obstacles": obstacles }), json!({ "avoidance": avoidance, "n_ants": 200 }));
        let Drive::Ants(drive) = &scenario.drive else { panic!("ants") };
        let ants: Vec<Vec2> =
            Ants::new(&scenario, drive).ants().iter().filter(|ant| ant.mode == Mode::Search).map(|ant| ant.position).collect();
        ants
    };
    let block = Outline {
        parts: vec![OutlinePart::Polygon {
            corners: [[-0.13, -0.125], [-0.03, -0.125], [-0.03, 0.125], [-0.13, 0.125]].map(Vec2::from).to_vec(),
        }],
    };
    let barriers = still(&[PlacedBarrier::new(Barrier::of(&block), &Pose::new(0.0, 0.0, 0.0)), disc(0.0, 0.0, 0.0122)]);
    let (free, any) = (starts("sidestep"), starts("none"));
    assert!(free.iter().all(|at| WALKER.is_clear(barriers.alone(), at)));
    let n_moved = free.iter().zip(&any).filter(|(a, b)| a != b).count();
    assert_eq!(n_moved, any.iter().filter(|at| !WALKER.is_clear(barriers.alone(), at)).count());
    // The block fills 28 % of the square of 0.3 m.
    assert!((40..80).contains(&n_moved), "{n_moved}");
}

/// Obstacles turn at any time; ants decide at ticks and walk on in between.
#[test]
fn obstacles_may_turn_between_the_decisions_of_ants() {
    let mut file: Value = serde_json::from_str(&std::fs::read_to_string("scenarios/paper/four-ants-four-springs.json").unwrap()).unwrap();
    let waypoints = json!([[0.0, 0.3, 0.3, 0.0], [1.2345, 0.31, 0.3, 0.0], [4.0, 0.3, 0.3, 0.0]]);
    file["obstacles"] = json!([{ "name": "pusher", "outline": { "disc": { "radius_m": 0.01 } }, "path": { "waypoints": waypoints } }]);
    file["duration_s"] = json!(4.0);
    let scenario = Scenario::parse(&file.to_string(), "turning").unwrap();
    for kind in BackendKind::ALL {
        let options = BackendOptions::new(kind, default_step(kind, &scenario.system, scenario.control_period));
        let mut run = Simulation::new(&scenario, &options, Keep::Trace);
        run.run(|_| true);
        let (trace, outcome) = run.into_results();
        assert!(outcome.time == 4.0 && trace.between.iter().any(|row| row.time == 1.2345), "{kind:?}");
        let at_tick = |time: f64| time == (time / scenario.control_period).round() * scenario.control_period;
        assert!(!trace.events.is_empty() && trace.events.iter().all(|event| at_tick(event.time)), "{kind:?}");
    }
}
