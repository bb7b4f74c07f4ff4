//! Which wrenches three supports hold, and about which point the load turns just above the limit.
//!
//! Each critical wrench is found by bisection between a share of it that leaves the load at rest
//! and one that moves it: a load that moves slightly too early, or holds a hair too long, shows by
//! as much. Supports lie at a from the centre, the sum of their slip limits is f.

use std::f64::consts::TAU;

use super::case::{Bound, Case, Family, Plan};
use super::measured::{Measured, Value};
use super::scenes::{LOAD_RADIUS, RADIAL, REST_LENGTH, SLIP_LIMIT, SUPPORT_RADIUS, distance, isotropic, paper_system};
use crate::methods::Method;
use crate::subject::Runs;
use cohaul::backend::{Backend, Motion, StepReport};
use cohaul::math::{Pose, Twist, Vec2, bisected, direction, rotation};
use cohaul::model::PolarSpring;

/// Arm b / a of a spring of the paper at its tip.
pub const TIP_ARM: f64 = (LOAD_RADIUS + REST_LENGTH) / SUPPORT_RADIUS;

/// A support toward the pull: b / a, F* / f = a (b + a) / (b^2 + a b + a^2), h / a = a (2 b + a) /
/// (b (b + 2 a)). Found by search and proved on paper.
pub const TOWARD: [(f64, f64, f64); 4] =
    [(0.5, 6.0 / 7.0, 1.6), (1.0, 2.0 / 3.0, 1.0), (2.0, 3.0 / 7.0, 0.625), (TIP_ARM, 0.203748281734, 0.328390943607)];

/// Beyond the arms at which a support on the far side is the centre of rotation: b / a, F* / f and
/// h / a, found by search.
pub const AWAY: (f64, f64, f64) = (TIP_ARM, 0.199942252731, 0.65435334281);

/// A wrench on the load, in its axes: force over f, torque over f a.
#[derive(Clone, Copy)]
struct Wrench {
    force: Vec2,
    torque: f64,
}

pub fn cases() -> Vec<Case> {
    vec![
        critical("limit-force", "force through the centre that moves the load, in 12 directions", "f in any direction", forces()),
        critical(
            "limit-torque",
            "torque that turns the load, in both senses",
            "f a",
            [1.0, -1.0].map(|torque| Wrench { force: Vec2::zeros(), torque }).to_vec(),
        ),
        critical("limit-facets", "wrenches that turn it about one support, on six facets", "F.t + torque / a = 2 f / sqrt 3", facets()),
        critical(
            "limit-off-centre",
            "force across an arm toward and away from a support",
            "a (b + a) / (b^2 + a b + a^2), 2 / sqrt 3 / (1 + b / a)",
            arms(),
        ),
        centre(),
    ]
}

/// Critical wrenches, whose found shares should all be one.
fn critical(name: &str, what: &str, source: &str, wrenches: Vec<Wrench>) -> Case {
    let bound = Bound::ratio(2e-9, "the bisection ends at 5e-10, and a picometre must be moved in 20 ms to count");
    Case {
        name: name.to_owned(),
        family: Family::LimitSurface,
        what: what.to_owned(),
        source: source.to_owned(),
        run: Box::new(move |runs| {
            let mut report = StepReport::default();
            let values = wrenches.iter().map(|wrench| Value::ratio(critical_share(wrench, runs, &mut report), 1.0)).collect();
            Measured { values, arm: SUPPORT_RADIUS, report }
        }),
        plans: Method::all_judged().map(|method| Plan::exact(method, 1e-3, 1, bound.clone())).collect(),
    }
}

fn forces() -> Vec<Wrench> {
    (0..12).map(|i| Wrench { force: direction(TAU * f64::from(i) / 12.0 + 0.01), torque: 0.0 }).collect()
}

/// Each support is the centre of rotation for a disc of wrenches: its own force is free up to f /
/// 3, the others' is tangential. Six flat discs, for three supports and two senses.
fn facets() -> Vec<Wrench> {
    let third = 1.0 / 3f64.sqrt();
    let in_disc = [(0.0, 0.0), (0.5, 1.0), (0.99, 2.5), (0.99, 4.0), (0.999, 5.5)];
    let on_facet = move |support: i32, sense: f64| {
        in_disc.map(|(share, angle)| {
            let own: Vec2 = share / 3.0 * direction(angle);
            // Support 0 on the y axis, counter-clockwise; the mirror at x = 0 turns the sense, a
            // third of a turn names the next support.
            let force = rotation(TAU * f64::from(support) / 3.0) * Vec2::new(sense * (third + own.x), own.y);
            Wrench { force, torque: sense * (third - own.x) }
        })
    };
    (0..3).flat_map(|support| [1.0, -1.0].map(|sense| on_facet(support, sense))).flatten().collect()
}

/// Forces across an arm along the line of support 0, toward it and away from it.
fn arms() -> Vec<Wrench> {
    let across = |arm: f64, force: f64| Wrench { force: Vec2::new(-force, 0.0), torque: arm * force };
    let edge = 3f64.sqrt();
    let about_support = [2.0 - edge + 1e-3, 0.5, 1.0, 2.0, 3.0, 2.0 + edge - 1e-3].map(|b| across(-b, 2.0 / edge / (1.0 + b)));
    let toward = TOWARD.map(|(b, force, _)| across(b, force));
    toward.into_iter().chain(about_support).chain([across(-AWAY.0, AWAY.1)]).collect()
}

/// The share of `wrench` at which the load begins to move.
fn critical_share(wrench: &Wrench, runs: &Runs, report: &mut StepReport) -> f64 {
    const LEAST_WAY: f64 = 1e-12;
    let start = Pose::new(0.05, -0.02, 0.7);
    let [holds, moves] = bisected([0.5, 1.5], 31, |share| {
        let mut of_probe = StepReport::default();
        let moves = distance(&start, &pulled(wrench, share, start, runs, &mut of_probe)) > LEAST_WAY;
        // Where the jump above the limit ends is not asked, nor how well it was found.
        if !moves {
            report.add(&of_probe);
        }
        !moves
    });
    0.5 * (holds + moves)
}

/// Where the load is after 20 ms under a share of `wrench`.
fn pulled(wrench: &Wrench, share: f64, start: Pose, runs: &Runs, report: &mut StepReport) -> Pose {
    let pulls = pulls(wrench);
    let springs: Vec<PolarSpring> = pulls.iter().map(|(root, _)| isotropic(*root, 0.0)).collect();
    let tips: Vec<Vec2> = pulls.iter().map(|(root, force)| start.to_world(&(root + share / RADIAL * force))).collect();
    let mut run: Box<dyn Backend> = runs.start(&paper_system(springs), Motion { pose: start, twist: Twist::ZERO });
    tips.iter().enumerate().for_each(|(spring, tip)| run.attach(spring, *tip));
    report.add(&run.advance(&tips, 0.02));
    run.motion().pose
}

/// Where on the load (m, load axes) springs pull with which forces (N) to make up `wrench`: one on
/// its line of action, or two that are a couple.
fn pulls(wrench: &Wrench) -> Vec<(Vec2, Vec2)> {
    let force = SLIP_LIMIT * wrench.force;
    if wrench.force == Vec2::zeros() {
        let arm = Vec2::new(0.01, 0.0);
        let force = Vec2::new(0.0, wrench.torque * SLIP_LIMIT * SUPPORT_RADIUS / 0.02);
        return vec![(arm, force), (-arm, -force)];
    }
    let lever = SUPPORT_RADIUS * wrench.torque / wrench.force.norm_squared();
    vec![(lever * Vec2::new(wrench.force.y, -wrench.force.x), force)]
}

/// Distance of the centre of rotation from the load's, just above the critical force.
fn centre() -> Case {
    // A millionth above the limit the direction of the motion is off by about as much; rounding of
    // places over it by less.
    let bound = Bound::metres(3e-5 * SUPPORT_RADIUS, "a force a millionth above the limit turns the motion by some millionths");
    let known = TOWARD.into_iter().chain([(-1.0, 1.0 / 3f64.sqrt(), 1.0), (-AWAY.0, AWAY.1, AWAY.2)]);
    let known: Vec<(f64, f64, f64)> = known.collect();
    Case {
        name: "limit-centre".to_owned(),
        family: Family::LimitSurface,
        what: "distance of the centre of rotation at the onset, under a force across an arm".to_owned(),
        source: "a^2 (2 b + a) / (b (b + 2 a)) toward a support, a away from it".to_owned(),
        run: Box::new(move |runs| {
            let mut report = StepReport::default();
            let at_onset = |&(arm, force, h): &(f64, f64, f64)| {
                let wrench = Wrench { force: Vec2::new(-force, 0.0), torque: arm * force };
                let end = pulled(&wrench, 1.0 + 1e-6, Pose::new(0.0, 0.0, 0.0), runs, &mut report);
                // A small turn about (0, -h) shifts the centre by -h along x for each radian.
                let sign = if arm < 0.0 { -1.0 } else { 1.0 };
                Value::metres(-sign * end.position.x / end.heading, h * SUPPORT_RADIUS)
            };
            let values = known.iter().map(at_onset).collect();
            Measured { values, arm: SUPPORT_RADIUS, report }
        }),
        plans: Method::all_judged().map(|method| Plan::exact(method, 1e-3, 1, bound.clone())).collect(),
    }
}
