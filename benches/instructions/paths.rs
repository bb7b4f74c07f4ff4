//! The hot paths: what runs once a step, a tick or a row. Each is a function of the library's
//! public interface, so that whatever stands behind it may be rewritten.

use std::hint::black_box;

use cohaul::backend::friction::{ContactMode, FrictionSolver};
use cohaul::backend::{Backend, BackendKind, BackendOptions, Motion, Status, build};
use cohaul::math::{Mat3, Pose, Vec2, Vec3, direction};
use cohaul::model::paper::LOAD_RADIUS_M;
use cohaul::model::{Obstacle, ObstaclePath, Outline, OutlinePart, System, World};
use cohaul::scenario::{Drive, Scenario, TipPath, Waypoint};
use cohaul::simulation::{Keep, Simulation};
use cohaul_report::trace_csv::{TraceColumns, write_trace};

/// One hot path.
pub struct HotPath {
    pub name: &'static str,
    /// Calls that are counted: enough to be typical, few enough to take a second or two.
    pub n_calls: u32,
    /// Sets up and warms up what is called.
    pub prepare: fn() -> Box<dyn FnMut()>,
}

/// All of them, in the order of the table.
pub const HOT_PATHS: [HotPath; 13] = [
    HotPath { name: "quasi-static-4-springs", n_calls: 4, prepare: || dragging(4, &quasi_static()) },
    HotPath { name: "quasi-static-10-springs", n_calls: 3, prepare: || dragging(10, &quasi_static()) },
    HotPath { name: "quasi-static-100-springs", n_calls: 1, prepare: || dragging(100, &quasi_static()) },
    HotPath { name: "inertial-4-springs", n_calls: 6, prepare: || dragging(4, &dynamic(BackendKind::Inertial)) },
    HotPath { name: "rapier-4-springs", n_calls: 3, prepare: || dragging(4, &dynamic(BackendKind::Rapier)) },
    HotPath { name: "quasi-static-1-contact", n_calls: 4, prepare: || along_a_wall(disc(), 1, &quasi_static()) },
    HotPath { name: "quasi-static-2-contacts", n_calls: 4, prepare: || along_a_wall(square(), 2, &quasi_static()) },
    HotPath { name: "inertial-1-contact", n_calls: 6, prepare: || along_a_wall(disc(), 1, &dynamic(BackendKind::Inertial)) },
    HotPath { name: "cone-solve-warm", n_calls: 20, prepare: cone_solve },
    HotPath { name: "tick-4-ants", n_calls: 10, prepare: tick_of_four_ants },
    HotPath { name: "tick-200-far-ants", n_calls: 4, prepare: tick_of_far_ants },
    HotPath { name: "trace-row", n_calls: 40, prepare: trace_row },
    HotPath { name: "csv-20-rows", n_calls: 1, prepare: csv_rows },
];

/// What is named by `name`.
pub fn find(name: &str) -> Option<&'static HotPath> {
    HOT_PATHS.iter().find(|path| path.name == name)
}

/// Clock of the paper's scene (s).
const CONTROL_PERIOD: f64 = 2.5e-3;
/// Longest step with inertia (s).
const DYNAMIC_STEP: f64 = 1e-3;
/// Of pulling ants (m/s).
const PULL_SPEED: f64 = 0.03;
/// Simulated time after which a load slides steadily (s): the springs are stretched in a third of
/// it.
const UNTIL_SLIDING: f64 = 1.5;

fn quasi_static() -> BackendOptions {
    BackendOptions::new(BackendKind::QuasiStatic, CONTROL_PERIOD)
}

fn dynamic(kind: BackendKind) -> BackendOptions {
    BackendOptions::new(kind, DYNAMIC_STEP)
}

/// One step of the paper's load, dragged by the tips of `n` springs in directions up to 0.3 rad
/// apart.
fn dragging(n: usize, options: &BackendOptions) -> Box<dyn FnMut()> {
    dragged(&paper_system(n), |j| 0.3 * j as f64 / n as f64, 0, options)
}

/// One step of a load of this outline that is dragged by four springs along a wall with friction
/// and at it, with so many contacts.
fn along_a_wall(outline: Outline, n_contacts: usize, options: &BackendOptions) -> Box<dyn FnMut()> {
    let mut system = paper_system(4);
    let points = vec![Vec2::new(-1.0, 0.0), Vec2::new(1.0, 0.0)];
    let wall = Obstacle {
        name: "wall".to_owned(),
        outline: Outline { parts: vec![OutlinePart::Polyline { points }] },
        friction_coefficient: 0.3,
        restitution: 0.0,
        path: ObstaclePath::fixed(Pose::new(0.0, -LOAD_RADIUS_M, 0.0)),
    };
    system.world = World { outline, obstacles: vec![wall] };
    dragged(&system, |_| -0.1, n_contacts, options)
}

fn disc() -> Outline {
    Outline::disc(LOAD_RADIUS_M)
}

fn square() -> Outline {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| LOAD_RADIUS_M * Vec2::new(x, y));
    Outline { parts: vec![OutlinePart::Polygon { corners: corners.to_vec() }] }
}

/// One step of a load whose tips go on in these directions (rad), and that slides with so many
/// contacts.
fn dragged(system: &System, bearing: impl Fn(usize) -> f64, n_contacts: usize, options: &BackendOptions) -> Box<dyn FnMut()> {
    let step = options.step_s;
    let mut tips: Vec<Vec2> = system.springs.iter().map(|spring| spring.rest_tip()).collect();
    let ways: Vec<Vec2> = (0..tips.len()).map(|j| step * PULL_SPEED * direction(bearing(j))).collect();
    let mut backend = build(system, Motion::of_entries(&[0.0; 6]), options);
    tips.iter().enumerate().for_each(|(spring, tip)| backend.attach(spring, *tip));
    let mut advance = move |backend: &mut dyn Backend| {
        tips.iter_mut().zip(&ways).for_each(|(tip, way)| *tip += way);
        (backend.advance(&tips, step), backend.motion().twist.linear.norm())
    };
    let n_until_sliding = (UNTIL_SLIDING / step) as u32;
    for _ in 1..n_until_sliding {
        advance(backend.as_mut());
    }
    let (report, speed) = advance(backend.as_mut());
    assert_eq!((report.status, report.n_steps, report.n_skipped), (Status::Converged, 1, 0), "every step is solved: {report:?}");
    assert_eq!(backend.side_contacts().len(), n_contacts);
    assert!(speed > 0.5 * PULL_SPEED, "the load slides along, at {speed} m/s");
    Box::new(move || {
        black_box(advance(backend.as_mut()));
    })
}

/// The cone problem of a load on the paper's tripod whose drive turns a little from call to call,
/// as from step to step.
fn cone_solve() -> Box<dyn FnMut()> {
    let system = paper_system(4);
    let mut solver = FrictionSolver::new(&system.ground, system.load.radius);
    let support_radius = 2.0 * LOAD_RADIUS_M / 3.0;
    let slip_limit = system.ground.friction_coefficient * system.ground.supports.iter().map(|support| support.normal_load).sum::<f64>();
    let across = support_radius * support_radius;
    let hessian = slip_limit / support_radius * Mat3::new(1.0, 0.1, 0.0, 0.1, 1.5, 0.2 * support_radius, 0.0, 0.2 * support_radius, across);
    let mut angle = 0.0;
    let mut solve = move || {
        angle += 1e-3;
        let pull = 1.1 * slip_limit * direction(angle);
        let solution = solver.solve(&hessian, &Vec3::new(pull.x, pull.y, 0.1 * slip_limit * support_radius));
        assert_eq!(solution.mode, ContactMode::Slip);
        solution.increment
    };
    for _ in 0..10 {
        solve();
    }
    Box::new(move || {
        black_box(solve());
    })
}

/// A control period of the paper's scene while its ants pull, load and all.
fn tick_of_four_ants() -> Box<dyn FnMut()> {
    let mut run = simulation(paper_scene(), Keep::Outcome);
    while run.time() < 20.0 {
        run.step();
    }
    assert!(run.outcome().pulls.n() > 4 && !run.is_finished(), "ants have pulled and go on");
    Box::new(move || run.step())
}

/// A control period of 200 ants that are nowhere near the load; four of them are the period of
/// their beliefs.
fn tick_of_far_ants() -> Box<dyn FnMut()> {
    let mut scene = paper_scene();
    let Drive::Ants(drive) = &mut scene.drive else { panic!("the paper's scene is driven by ants") };
    (drive.n_ants, drive.start_half_width) = (200, 100.0);
    let mut run = simulation(scene, Keep::Outcome);
    (0..40).for_each(|_| run.step());
    assert_eq!(run.outcome().steps.n_solves, 0, "nobody holds the load");
    Box::new(move || run.step())
}

/// A control period of a load that rests between four held tips, which leaves little to do but
/// keeping the row.
fn trace_row() -> Box<dyn FnMut()> {
    let mut run = simulation(resting_scene(), Keep::Trace);
    // Between 256 and 512 rows the vector does not grow.
    (0..300).for_each(|_| run.step());
    assert!(run.trace().rows.len() == 300 && run.trace().rows[299].tips.len() == 4, "a row a step, with all tips");
    Box::new(move || run.step())
}

/// The table of 20 rows with four pulls each, head included.
fn csv_rows() -> Box<dyn FnMut()> {
    let mut run = simulation(paper_scene(), Keep::Trace);
    while run.time() < 20.0 {
        run.step();
    }
    let (mut trace, _) = run.into_results();
    trace.rows.drain(..trace.rows.len() - 20);
    let mut bytes = Vec::with_capacity(1 << 20);
    let mut write = move || {
        bytes.clear();
        write_trace(&trace, TraceColumns::Full { n_springs: 4 }, &mut bytes).expect("a run's numbers are finite and memory takes them");
        bytes.len()
    };
    assert!(write() > 4000, "20 rows of 21 numbers");
    Box::new(move || {
        black_box(write());
    })
}

fn simulation(scene: Scenario, keep: Keep) -> Simulation<'static> {
    Simulation::new(Box::leak(Box::new(scene)), &quasi_static(), keep)
}

/// The paper's load on so many of its springs, evenly spaced from bearing zero.
fn paper_system(n_springs: usize) -> System {
    scene(n_springs).system
}

fn paper_scene() -> Scenario {
    scene(4)
}

/// The paper's scene with so many springs, and with the ants of the stored counts, whatever the
/// default preset is.
fn scene(n_springs: usize) -> Scenario {
    let text = include_str!("../../scenarios/paper/four-ants-four-springs.json");
    let text = text.replace("\"n_ants\": 4", "\"n_ants\": 4, \"preset\": \"fitted\"");
    let text = text.replace("\"n\": 4", &format!("\"n\": {n_springs}"));
    Scenario::parse(&text, "the paper's scene").expect("it is a valid scenario")
}

/// The paper's load with all tips held where they rest, for good.
fn resting_scene() -> Scenario {
    let scene = paper_scene();
    let held = |(spring, rest): (usize, &cohaul::model::PolarSpring)| TipPath {
        spring,
        waypoints: vec![Waypoint { time: 0.0, position: rest.rest_tip() }],
        release: None,
    };
    let paths = scene.system.springs.iter().enumerate().map(held).collect();
    Scenario { drive: Drive::Tips(paths), ..scene }
}
