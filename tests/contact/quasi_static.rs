//! Known answers without inertia. Under a tolerance they hold to 1e-8 of the load's size; at fixed
//! steps with the order of the method.

use std::f64::consts::{PI, TAU};

use cohaul::backend::BackendKind::{Inertial, QuasiStatic};
use cohaul::backend::{Backend, BackendOptions, Status, StepReport, Tolerance, Transition, TransitionKind, build};
use cohaul::math::{Pose, Vec2, direction, rotation};
use cohaul::model::{Outline, OutlinePart, System};
use cohaul::scenario::{Drive, Scenario};

use crate::scenes::*;

/// 1e-8 of the load's size (m), and the same as a turn (rad).
const EXACT: f64 = 1e-8 * RADIUS;
const EXACT_TURN: f64 = 1e-8;
/// Rounding of a few hundred steps (m).
const ROUNDING: f64 = 1e-14 * RADIUS * 100.0;

fn floor(friction_coefficient: f64) -> cohaul::model::Obstacle {
    wall(Vec2::new(0.0, -RADIUS), Vec2::new(1.0, 0.0), friction_coefficient)
}

/// The load after a run in `n` fixed steps, all of which converge.
fn after(system: &System, from: Vec2, n: u32, path: impl Fn(f64) -> Vec2) -> Box<dyn Backend> {
    let (load, report) = drive(system, at_rest(from.x, from.y), &fixed(QuasiStatic, n), n, path);
    assert_eq!((report.status, report.n_not_converged), (Status::Converged, 0), "{report:?}");
    load
}

/// The pose after a run under a tolerance of 1e-9 m, all of whose steps converge.
fn within_tolerance(system: &System, from: Vec2, n: u32, path: impl Fn(f64) -> Vec2) -> Pose {
    within(1e-9, system, from, n, path)
}

fn within(tolerance: f64, system: &System, from: Vec2, n: u32, path: impl Fn(f64) -> Vec2) -> Pose {
    let (load, report) = drive(system, at_rest(from.x, from.y), &exact(QuasiStatic, system, tolerance), n, path);
    assert_eq!((report.status, report.n_not_converged), (Status::Converged, 0), "{report:?}");
    load.motion().pose
}

/// Normal forces of horizontal walls on the load (N), from left to right.
fn pressures(load: &dyn Backend) -> Vec<f64> {
    let mut contacts = load.side_contacts();
    contacts.sort_by(|a, b| a.point.x.total_cmp(&b.point.x));
    contacts.iter().map(|contact| contact.force.y).collect()
}

/// Asserts that halving the step divides the error by `ratio`, up to a tenth.
fn assert_order(ratio: f64, errors: &[f64]) {
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] / ratio - 1.0).abs() < 0.1, "{errors:?}");
    }
}

/// K1: a disc slides along a frictionless wall. The wall bears what the spring presses, and
/// friction takes the rest.
#[test]
fn a_disc_slides_along_a_wall() {
    let load = after(&disc(vec![floor(0.0)]), Vec2::zeros(), 40, |s| Vec2::new(0.06 * s, -0.02 * s));
    assert!((load.motion().pose.position - Vec2::new(0.06 - BEHIND, 0.0)).norm() < ROUNDING);
    assert!((load.energy().friction - 5.91243736e-4).abs() < 1e-12, "as many digits as are known");
    assert!((pressures(load.as_ref())[0] - 13.28e-3).abs() < 1e-12);
}

/// K2: a box slides on a wall with friction: the pose is exact at any step, and the work of the
/// wall of first order.
#[test]
fn a_box_rubs_along_a_wall() {
    let path = |s: f64| Vec2::new(0.06 * s, -0.02 * s);
    let mut errors = Vec::new();
    for n in [40, 80, 160] {
        let system = boxed(vec![wall(Vec2::new(0.0, -BOX[1]), Vec2::new(1.0, 0.0), 0.3)], Vec2::zeros());
        let load = after(&system, Vec2::zeros(), n, path);
        let pose = load.motion().pose;
        assert!((pose.position - Vec2::new(0.06 - BEHIND - 0.3 * 0.02, 0.0)).norm() < ROUNDING);
        assert!(pose.heading.abs() < 1e-14);
        assert!((load.energy().friction - LIMIT * pose.position.x).abs() < 1e-15);
        let [rear, front] = pressures(load.as_ref())[..] else { panic!("two corners") };
        assert!((rear - 5.333770492e-3).abs() < 1e-12 && (front - 7.946229508e-3).abs() < 1e-12, "{rear:e} {front:e}");
        errors.push(load.energy().side_friction - 6.716687422e-5);
    }
    assert_order(2.0, &errors);
}

/// K2: where the wall's friction exceeds what the ground leaves, the box starts later, or never:
/// the pull stays within the friction cone of the wall.
#[test]
fn a_box_sticks_to_a_wall() {
    let system = boxed(vec![wall(Vec2::new(0.0, -BOX[1]), Vec2::new(1.0, 0.0), 1.2)], Vec2::zeros());
    let (load, report) = drive(&system, at_rest(0.0, 0.0), &fixed(QuasiStatic, 100), 100, |s| Vec2::new(0.1 * s, -0.05 * s));
    assert_eq!(report.status, Status::Converged);
    assert!((load.motion().pose.position - Vec2::new(6.906024096386e-3, 0.0)).norm() < EXACT);
    // Ground and wall together hold it by 95 % of their limits up to 0.73 s, and by all up to
    // 0.83 s. Each of the ten steps in between is a search of four solutions.
    assert!(report.n_solves < 150, "{report:?}");
    for kind in [QuasiStatic, Inertial] {
        let (load, report) = drive(&system, at_rest(0.0, 0.0), &fixed(kind, 100), 100, |s| Vec2::new(0.3 * s, -0.27 * s));
        assert_eq!((load.motion().pose, report.status), (Pose::new(0.0, 0.0, 0.0), Status::Converged));
        // It goes on resting without a search, but for some steps at the limit of the ground alone.
        assert!(report.n_solves < 130, "{report:?}");
    }
}

/// A disc that was pressed into a notch of rough walls comes out as soon as the ground alone lets
/// it: forces that wedge it need no drive, and do not stay.
#[test]
fn a_disc_comes_out_of_a_rough_notch() {
    let sides = [1.0, -1.0].map(|side| {
        let normal = Vec2::new(side, 1.0).normalize();
        wall(-RADIUS * normal, Vec2::new(normal.y, -normal.x), 2.0)
    });
    for kind in [QuasiStatic, Inertial] {
        let path = |s: f64| Vec2::new(0.0, if s < 0.5 { -0.2 * s } else { -0.1 + 0.36 * (s - 0.5) });
        let (load, report) = drive(&disc(sides.to_vec()), at_rest(0.0, 0.0), &fixed(kind, 2000), 2000, path);
        assert_eq!(report.status, Status::Converged);
        let lag = 0.08 - load.motion().pose.position.y;
        // With inertia the load goes on at the speed of the tip behind a spring that swings: its
        // amplitude is that of a start from rest, v sqrt(m / k).
        let swing = if kind == Inertial { 0.36 * (MASS / STIFFNESS).sqrt() } else { EXACT };
        assert!((lag - BEHIND).abs() <= swing, "{lag}");
    }
}

/// K3: a tip draws a disc round a post.
#[test]
fn a_disc_goes_round_a_post() {
    let (system, from) = (disc(vec![post(Vec2::zeros(), 0.005)]), Vec2::new(0.0, 0.0172));
    // From where the load starts to slide.
    let start = (BEHIND / 0.035f64).asin() / 2.5;
    let path = |s: f64| {
        let angle = std::f64::consts::FRAC_PI_2 - 2.5 * (start + (1.0 - start) * s);
        0.035 * Vec2::new(angle.cos(), angle.sin())
    };
    let end = Vec2::new(0.016379861540, 0.005247869655);
    let errors = [40, 80, 160].map(|n| (after(&system, from, n, path).motion().pose.position - end).norm());
    assert_order(4.0, &errors);
    assert!((within_tolerance(&system, from, 40, path).position - end).norm() < EXACT);
}

/// K4: a disc slides down one wall of a notch and jams at the other.
#[test]
fn a_disc_jams_in_a_notch() {
    let s = 0.5f64.sqrt();
    let walls = [Vec2::new(s, s), Vec2::new(-s, s)].map(|n| wall(Vec2::zeros(), 0.2 * Vec2::new(-n.y, n.x), 0.0));
    let system = disc(walls.to_vec());
    let from = Vec2::new(0.02, 0.02 + RADIUS / s);
    let path = |share: f64| from + share * (Vec2::new(-0.02, -0.03) - from);
    let bottom = Vec2::new(0.0, RADIUS / s);
    assert!((after(&system, from, 50, path).motion().pose.position - bottom).norm() < ROUNDING);
    // Just before it arrives it is still under way.
    let early = after(&system, from, 50, |share| path(0.809 * share)).motion().pose.position;
    let late = after(&system, from, 50, |share| path(0.8094 * share)).motion().pose.position;
    assert!((early - bottom).norm() > 1e-6 && (late - bottom).norm() < 1e-9, "{early} {late}");
}

/// K5: the rear of a box lifts off a wall.
#[test]
fn the_rear_of_a_box_lifts_off() {
    let system = boxed(vec![wall(Vec2::new(0.0, -BOX[1]), Vec2::new(1.0, 0.0), 0.0)], Vec2::new(0.0, 0.004));
    let path = |s: f64| Vec2::new(0.06 * s, 0.004 - 0.03 + 0.03 * s);
    let end = Pose::new(0.0271223171, 0.0027108354, -0.24404545);
    let errors = [60, 120, 240].map(|n| (after(&system, Vec2::zeros(), n, path).motion().pose.position - end.position).norm());
    assert_order(2.0, &errors);
    let found = within_tolerance(&system, Vec2::zeros(), 60, path);
    assert!((found.position - end.position).norm() < EXACT && (found.heading - end.heading).abs() < EXACT_TURN, "{found:?}");
}

/// A polygon that is drawn into a smooth wall tips over its corner until a face lies on it. The
/// path from corner to corner leads through the wall, so that the step has to see both.
#[test]
fn a_heptagon_tips_onto_a_face() {
    let corners: Vec<Vec2> = (0..7).map(|k| RADIUS * direction(TAU * f64::from(k) / 7.0)).collect();
    let mut system = disc(vec![wall(Vec2::new(0.0, -1.05 * RADIUS), Vec2::new(1.0, 0.0), 0.0)]);
    system.world.outline = Outline { parts: vec![OutlinePart::Polygon { corners }] };
    for turn in [0.0, 0.5 * PI, PI] {
        system.ground.supports.iter_mut().for_each(|support| support.offset = rotation(turn) * support.offset);
        let path = |s: f64| 3.0 * BEHIND * (s / 0.75).min(1.0) * direction(-0.7);
        let (load, report) = drive(&system, at_rest(0.0, 0.0), &fixed(QuasiStatic, 40), 40, path);
        assert_eq!(report.status, Status::Converged);
        // Shorter paths along a resistance, each stopped where it meets the next corner, take 500.
        assert!(report.n_solves < 200, "{report:?}");
        let Pose { position, heading } = load.motion().pose;
        let on_its_face = RADIUS * (PI / 7.0).cos() - 1.05 * RADIUS;
        assert!((position.y - on_its_face).abs() < EXACT && (heading + PI / 14.0).abs() < EXACT_TURN, "{position} {heading}");
    }
}

/// A disc sticks to the corner of a square until it jumps past it by more than its radius, along
/// faces and corners that the path meets one after the other. It then follows the tip.
#[test]
fn a_disc_jumps_past_a_square() {
    let size = 0.5 * RADIUS;
    let nearest = RADIUS * Vec2::new(2.0, -1.2);
    let corners = (0..4).map(|k| nearest + size * (Vec2::x() + direction(0.5 * PI * f64::from(k)))).collect();
    let system = disc(vec![obstacle(OutlinePart::Polygon { corners }, 0.1)]);
    let tip = Vec2::new(6.0 * RADIUS, 0.0);
    let (load, report) = drive(&system, at_rest(0.0, 0.0), &fixed(QuasiStatic, 60), 60, |s| s * tip);
    assert_eq!(report.status, Status::Converged);
    assert!(((load.motion().pose.position - tip).norm() - BEHIND).abs() < EXACT);
    assert!(load.side_contacts().is_empty());
}

/// A disc on a spring so soft that it slides in jumps of radii along a rough wall. Linear steps
/// that each take a share of the path would need thousands of solutions a step.
#[test]
fn a_disc_on_a_soft_spring_takes_few_solutions() {
    let mut system = disc(vec![floor(0.3)]);
    system.springs[0].radial_stiffness = 0.1;
    let behind = LIMIT / 0.1;
    let (load, report) = drive(&system, at_rest(0.0, 0.0), &fixed(QuasiStatic, 40), 40, |s| behind * Vec2::new(3.0 * s, -s));
    assert_eq!(report.status, Status::Converged);
    assert!(load.motion().pose.position.y.abs() < EXACT);
    // Some twenty a step, and 2,400 without lengthened steps.
    assert!(report.n_solves < 40 * 100, "{report:?}");
}

/// K6: a disc rolls along a wall.
#[test]
fn a_disc_rolls() {
    let system = disc(vec![floor(2.0)]);
    let path = |s: f64| Vec2::new(0.08 * s, -0.02);
    let (end, turn) = (Vec2::new(0.043364939119, 0.0), -3.55450320646);
    let errors = [60, 120, 240].map(|n| (after(&system, Vec2::zeros(), n, path).motion().pose.position - end).norm());
    assert_order(4.0, &errors);
    let found = within_tolerance(&system, Vec2::zeros(), 60, path);
    assert!((found.position - end).norm() < EXACT && (found.heading - turn).abs() < EXACT_TURN, "{found:?}");
    // Rolling is a constraint on poses: nothing creeps.
    assert!((found.position.x + RADIUS * found.heading).abs() < EXACT);
}

/// K9: a gap between two posts is too narrow for a disc.
#[test]
fn a_disc_stops_between_two_posts() {
    let system = disc([0.016, -0.016].map(|y| post(Vec2::new(0.05, y), 0.005)).to_vec());
    let load = after(&system, Vec2::zeros(), 60, |s| Vec2::new(0.12 * s, 0.0));
    assert!((load.motion().pose.position - Vec2::new(0.043688106465, 0.0)).norm() < 1e-12, "as many digits as are known");
}

/// K12: a disc slides and turns along a wall.
#[test]
fn a_disc_slides_and_turns_along_a_wall() {
    let system = disc(vec![floor(0.2)]);
    let [coarse, found] = [1e-7, 1e-8].map(|tolerance| within(tolerance, &system, Vec2::zeros(), 60, |s| Vec2::new(0.08 * s, -0.02)));
    assert!(
        (coarse.position - found.position).norm() < EXACT && (coarse.heading - found.heading).abs() < EXACT_TURN,
        "{coarse:?} {found:?}"
    );
    // The known answer has errors of 1e-9 m and 3e-8 rad.
    assert!((found.position - Vec2::new(0.0438441255, 0.0)).norm() < 1.1e-9, "{found:?}");
    assert!((found.heading + 2.0031856).abs() < 8e-8, "{found:?}");
}

/// K13 under a tolerance: where the post holds the disc, and where the tip is when it snaps round.
#[test]
fn a_snap_round_a_post_is_located() {
    let system = disc(vec![post(Vec2::new(0.04, 0.01), 0.003)]);
    let held = within_tolerance(&system, Vec2::zeros(), 40, |s| Vec2::new(0.0786 * s, 0.0));
    assert!((held.position - Vec2::new(0.028552729583, 0.0)).norm() < EXACT, "{held:?}");
    let mut load = build(&system, at_rest(0.0, 0.0), &exact(QuasiStatic, &system, 1e-9));
    load.attach(0, Vec2::zeros());
    let mut jumps = Vec::new();
    for tick in 1..=400 {
        let report = load.advance(&[Vec2::new(2e-4 * f64::from(tick), 0.0)], 2.5e-3);
        // At the very limit, a step may not converge. The load still jumps there, to where it
        // should.
        assert!(report.status == Status::Converged || tick == 395, "{tick} {report:?}");
        let is_jump = |it: &&Transition| matches!(it.kind, TransitionKind::Jump { .. });
        let start = 2.5e-3 * f64::from(tick - 1);
        jumps.extend(load.transitions().iter().filter(is_jump).map(|jump| start + jump.time));
    }
    let [time] = jumps[..] else { panic!("{jumps:?}") };
    assert!((0.08 * time - 0.078855572956).abs() < EXACT, "{time}");
}

/// K13: a post holds a disc, which then snaps round it.
#[test]
fn a_disc_snaps_round_a_post() {
    let system = disc(vec![post(Vec2::new(0.04, 0.01), 0.003)]);
    let held = Vec2::new(0.028552729583, 0.0);
    let at = |x: f64, n| after(&system, Vec2::zeros(), n, |s| Vec2::new(x * s, 0.0)).motion().pose.position;
    assert!((at(0.0616, 400) - held).norm() > 1e-5);
    for x in [0.0618, 0.0786] {
        let errors = [400, 1600].map(|n| (at(x, n) - held).norm());
        assert!(errors[0] < 1e-3 * RADIUS && 3.0 * errors[1] < errors[0], "at least first order: {errors:?}");
    }
    let beyond = at(0.080, 400);
    assert!(beyond.x > 0.045 && (beyond - Vec2::new(0.04, 0.01)).norm() >= RADIUS + 0.003 - ROUNDING, "{beyond}");
}

/// A pentagon on two springs snaps twice past two posts. Each time its path comes out of balance
/// next to where it ends, and is followed against a resistance. Under any tolerance and in fixed
/// steps it comes to the same end, without a turn more. Fixed steps miss it by their first order.
#[test]
fn a_pentagon_snaps_past_two_posts() {
    let text = include_str!("../common/corners-past-posts.json");
    let Scenario { system, start, drive: Drive::Tips(paths), .. } = Scenario::parse(text, "corners past posts").unwrap() else {
        panic!("tips are prescribed")
    };
    let tips = |share: f64| -> [Vec2; 2] {
        [0, 1].map(|spring| {
            let [from, to] = [0, 1].map(|at| paths[spring].waypoints[at].position);
            from + share * (to - from)
        })
    };
    let within = |size: f64| BackendOptions::within(QuasiStatic, Tolerance::at_edge(size * system.load.radius, &system.load));
    let [coarse, fine, stepped] = [within(1e-3), within(1e-5), BackendOptions::new(QuasiStatic, 1e-4)].map(|options| {
        let mut load = build(&system, start, &options);
        (0..2).for_each(|spring| load.attach(spring, tips(0.0)[spring]));
        let mut report = StepReport::default();
        for tick in 1..=200 {
            report.add(&load.advance(&tips(0.005 * f64::from(tick)), 0.01));
        }
        assert_eq!((report.status, report.n_not_converged), (Status::Converged, 0), "{report:?}");
        assert!(report.n_iterations < 5_000_000, "{report:?}");
        load.motion().pose
    });
    let distance = |pose: &Pose| pose.edge_displacement(&fine, system.load.radius) / system.load.radius;
    assert!(distance(&coarse) < 1e-3 && distance(&stepped) < 1e-3, "{coarse:?} {stepped:?} {fine:?}");
}

/// A pull moves a load at once against a wall. What obstacles do on the way of such a jump depends
/// on the path, so that its end is uncertain. Without the wall the path is straight and the end is
/// certain. Only runs under error control look.
#[test]
fn a_jump_against_a_wall_is_uncertain() {
    let uncertain = |system: &System, options: &BackendOptions| {
        let mut load = build(system, at_rest(0.0, 0.0), options);
        let tip = Vec2::new(0.1, 0.0);
        load.attach(0, tip);
        assert_eq!(load.advance(&[tip], 0.01).status, Status::Converged);
        let of_jump = |it: &Transition| if let TransitionKind::Jump { is_uncertain, .. } = it.kind { Some(is_uncertain) } else { None };
        load.transitions().iter().find_map(of_jump).expect("the load jumps")
    };
    let at_wall = disc(vec![wall(Vec2::new(RADIUS + 1e-3, 0.0), Vec2::new(0.0, 1.0), 0.0)]);
    let far_away = disc(vec![wall(Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0), 0.0)]);
    assert!(uncertain(&at_wall, &exact(QuasiStatic, &at_wall, 1e-6)));
    assert!(!uncertain(&far_away, &exact(QuasiStatic, &far_away, 1e-6)));
    assert!(!uncertain(&at_wall, &fixed(QuasiStatic, 100)));
}
