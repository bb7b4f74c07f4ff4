//! What must not matter: place and heading of the scene, its mirror image, the units, the names of
//! springs and supports, and, without inertia and dashpots, time.
//!
//! The paths compared are those of the reference scene with dashpots and uneven supports, which no
//! symmetry of the tips hides.

use super::case::{Bound, Case, Family, Plan};
use super::measured::{Measured, Value};
use super::scenes::{SUPPORT_RADIUS, Tips, at_rest, distance, n_pieces, paper_springs, paper_system, path, reference_tips};
use crate::methods::Method;
use crate::subject::Runs;
use cohaul::backend::{Backend, BackendOptions, Motion, StepReport, build};
use cohaul::math::{Pose, Twist, Vec2, rotation};
use cohaul::model::{PolarSpring, System};

pub fn cases() -> Vec<Case> {
    let mut cases = vec![
        case("symmetry-moved", "the scene elsewhere and turned", moved),
        case("symmetry-mirror", "the mirror image of the scene", image),
        case("symmetry-names", "the scene with its springs and supports in another order", renamed),
    ];
    for (force, length) in [(3.7, 1.0), (1e3, 1e3), (1e-3, 0.37)] {
        let name = format!("symmetry-units-{force}-{length}");
        let what = format!("the scene with forces times {force} and lengths times {length}");
        cases.push(case(&name, &what, move || scaled(force, length)));
    }
    cases.extend([same_nodes(), other_nodes()]);
    cases
}

/// A transformed scene, and what takes its poses back.
struct Other {
    system: System,
    start: Pose,
    tips: Box<Tips>,
    undo: Box<dyn Fn(&Pose) -> Pose>,
}

fn case(name: &str, what: &str, other: impl Fn() -> Other + Send + Sync + 'static) -> Case {
    let rounding = Bound::metres(1e-14, "rounding of places of 0.1 m, magnified near changes of regime");
    let sweeps = Bound::metres(1e-11, "the engine linearises in world axes and ends its sweeps at a residual");
    let plan = |method: Method| {
        let bound = if !method.kind.is_exact() { sweeps.clone() } else { rounding.clone() };
        Plan::exact(method, 1.0 / 300.0, 1, bound)
    };
    Case {
        name: name.to_owned(),
        family: Family::Symmetry,
        what: format!("largest distance of the path from that of {what}"),
        source: "the laws know no place, side, unit or name".to_owned(),
        run: Box::new(move |runs| same_path(runs, other())),
        plans: Method::all_judged().map(plan).collect(),
    }
}

/// Distance over 300 steps between the path of the scene and that of `other`, taken back.
fn same_path(runs: &Runs, other: Other) -> Measured {
    let (poses, mut report) = path(&system(), at_rest(), runs, &reference_tips, 1.0);
    let (others, report_of_other) = path(&other.system, Motion { pose: other.start, twist: Twist::ZERO }, runs, &other.tips, 1.0);
    report.add(&report_of_other);
    let values = poses.iter().zip(&others).map(|(one, two)| Value::metres(distance(one, &(other.undo)(two)), 0.0));
    Measured { values: values.collect(), arm: SUPPORT_RADIUS, report }
}

fn system() -> System {
    let springs = paper_springs(4).into_iter().map(|spring| PolarSpring { damping_ratio: 0.2, ..spring });
    let mut system = paper_system(springs.collect());
    system.ground.supports[0].offset *= 1.2;
    system.ground.supports[1].normal_load *= 0.8;
    system
}

fn moved() -> Other {
    let by = Pose::new(0.3, -0.2, 1.1);
    let undo = move |pose: &Pose| Pose {
        position: rotation(by.heading).tr_mul(&(pose.position - by.position)),
        heading: pose.heading - by.heading,
    };
    Other {
        system: system(),
        start: by,
        tips: Box::new(move |s| reference_tips(s).into_iter().map(|(spring, tip)| (spring, by.to_world(&tip))).collect()),
        undo: Box::new(undo),
    }
}

fn image() -> Other {
    let mirrored = |point: Vec2| Vec2::new(point.x, -point.y);
    let mut system = system();
    for spring in &mut system.springs {
        (spring.root, spring.bearing) = (mirrored(spring.root), -spring.bearing);
    }
    system.ground.supports.iter_mut().for_each(|support| support.offset = mirrored(support.offset));
    // Left is right from another place, so that signs alone do not make the bits equal.
    let away = Vec2::new(0.07, 0.013);
    Other {
        system,
        start: Pose { position: away, heading: 0.0 },
        tips: Box::new(move |s| reference_tips(s).into_iter().map(|(spring, tip)| (spring, mirrored(tip) + away)).collect()),
        undo: Box::new(move |pose| Pose { position: mirrored(pose.position - away), heading: -pose.heading }),
    }
}

fn renamed() -> Other {
    let order = [2, 0, 3, 1];
    let mut renamed = system();
    renamed.springs = order.map(|spring| system().springs[spring]).to_vec();
    renamed.ground.supports.rotate_left(1);
    let name_of = move |spring: usize| order.iter().position(|old| *old == spring).expect("all springs have a place in the order");
    Other {
        system: renamed,
        start: Pose::new(0.0, 0.0, 0.0),
        tips: Box::new(move |s| reference_tips(s).into_iter().map(|(spring, tip)| (name_of(spring), tip)).collect()),
        undo: Box::new(|pose| *pose),
    }
}

/// Stiffness, friction and mass times one number: the same path. Lengths times another, with the
/// torsion to match: the path times it.
fn scaled(force: f64, length: f64) -> Other {
    let mut scaled = system();
    scaled.load.mass *= force / length;
    scaled.load.inertia *= force * length;
    scaled.load.radius *= length;
    for support in &mut scaled.ground.supports {
        support.offset *= length;
        support.normal_load *= force;
    }
    for spring in &mut scaled.springs {
        spring.root *= length;
        spring.rest_length *= length;
        spring.radial_stiffness *= force / length;
        spring.torsional_stiffness *= force * length;
    }
    Other {
        system: scaled,
        start: Pose::new(0.0, 0.0, 0.0),
        tips: Box::new(move |s| reference_tips(s).into_iter().map(|(spring, tip)| (spring, length * tip)).collect()),
        undo: Box::new(move |pose| Pose { position: pose.position / length, heading: pose.heading }),
    }
}

/// Poses at the nodes s_i of the reference scene without dashpots, passed at the times that `clock`
/// says.
fn at_nodes(options: &BackendOptions, nodes: &[f64], clock: impl Fn(f64) -> f64) -> (Vec<Pose>, StepReport) {
    // One step from node to node, however long that lasts.
    let options = BackendOptions { step_s: f64::INFINITY, ..*options };
    let mut undamped = system();
    undamped.springs.iter_mut().for_each(|spring| spring.damping_ratio = 0.0);
    let mut run: Box<dyn Backend> = build(&undamped, at_rest(), &options);
    let mut report = StepReport::default();
    for (spring, tip) in reference_tips(0.0) {
        run.attach(spring, tip);
    }
    let poses = nodes.windows(2).map(|pair| {
        let mut targets = vec![Vec2::zeros(); 4];
        reference_tips(pair[1]).into_iter().for_each(|(spring, tip)| targets[spring] = tip);
        report.add(&run.advance(&targets, clock(pair[1]) - clock(pair[0])));
        run.motion().pose
    });
    (poses.collect(), report)
}

fn nodes(options: &BackendOptions, warp: impl Fn(f64) -> f64) -> Vec<f64> {
    let n = n_pieces(1.0, options);
    (0..=n).map(|i| warp(i as f64 / n as f64)).collect()
}

/// Nodes of a path at other times give the same bits.
fn same_nodes() -> Case {
    let run = |runs: &Runs| {
        let nodes = nodes(runs, |s| s);
        let (even, mut report) = at_nodes(runs, &nodes, |s| s);
        let (slow, of_slow) = at_nodes(runs, &nodes, |s| 1e4 * s);
        let (warped, of_warped) = at_nodes(runs, &nodes, |s| s * s + 1e-3 * s);
        report.add(&of_slow);
        report.add(&of_warped);
        let values = even.iter().cycle().zip(slow.iter().chain(&warped)).map(|(one, two)| Value::metres(distance(one, two), 0.0));
        Measured { values: values.collect(), arm: SUPPORT_RADIUS, report }
    };
    Case {
        name: "rate-same-nodes".to_owned(),
        family: Family::Symmetry,
        what: "largest distance of the path from those with the same nodes at other times".to_owned(),
        source: "rate independence".to_owned(),
        run: Box::new(run),
        plans: vec![Plan::exact(Method::QUASI_STATIC, 1.0 / 300.0, 1, Bound::metres(0.0, "time enters nowhere: the same bits"))],
    }
}

/// Other nodes on the same tip paths lead to the same end in the limit of small steps.
fn other_nodes() -> Case {
    let run = |runs: &Runs| {
        let (even, mut report) = at_nodes(runs, &nodes(runs, |s| s), |s| s);
        let (warped, of_warped) = at_nodes(runs, &nodes(runs, |s| 0.3 * s + 0.7 * s * s), |s| s);
        report.add(&of_warped);
        let [found, known] =
            [warped, even].map(|poses| poses.last().map_or([f64::NAN; 3], |pose| [pose.position.x, pose.position.y, pose.heading]));
        // The difference is the answer, so that its limit is extrapolated from both.
        let gap = [0, 1, 2].map(|i| found[i] - known[i]);
        Measured { values: Value::pose(gap, [0.0; 3]).to_vec(), arm: SUPPORT_RADIUS, report }
    };
    let first =
        Bound::pose(6e-5, 1e-3, "the difference of two errors of first order: one step's share of the path of 31 mm and of its turn");
    let limit = Bound::pose(1e-11, 1e-10, "changes of regime within steps leave a part of h^2");
    Case {
        name: "rate-other-nodes".to_owned(),
        family: Family::Symmetry,
        what: "distance of the end from that on the same tip paths with a warped clock".to_owned(),
        source: "rate independence".to_owned(),
        run: Box::new(run),
        plans: vec![Plan::first_order(Method::QUASI_STATIC, 1.0 / 500.0, 5, first, limit)],
    }
}
