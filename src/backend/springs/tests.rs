//! Tests of springs in blocks against the same springs one by one, and of the work on their tips.

use super::{Attachments, Place, SpringBlocks};
use crate::math::{Mat3, Pose, RandomStreams, Stream, Vec2, Vec3, direction, rotation};
use crate::model::{PolarSpring, Reaction, SpringLaw};

const STIFFNESS: f64 = 0.664;

/// Springs of all kinds: those of the paper, stiff and soft ones, isotropic ones and ropes, none of
/// them at rest, some attached after turns about their roots.
fn attached(n: u32, seed: u64) -> (Vec<PolarSpring>, Attachments) {
    let streams = RandomStreams::new(seed);
    let draw = |i: u32, k: u64| 2.0 * streams.uniform(Stream::Start, i, k) - 1.0;
    let spring = |i: u32| PolarSpring {
        root: 0.0122 * Vec2::new(draw(i, 0), draw(i, 1)),
        bearing: 4.0 * draw(i, 2),
        rest_length: if i % 3 == 2 { 0.0 } else { 0.0263 },
        radial_stiffness: STIFFNESS * 4f64.powf(draw(i, 3)),
        torsional_stiffness: if i % 3 == 2 || i % 4 == 1 { 0.0 } else { 4.52e-4 },
        law: if i % 4 == 1 { SpringLaw::Rope } else { SpringLaw::Polar },
        ..PolarSpring::default()
    };
    let springs: Vec<PolarSpring> = (0..n).map(spring).collect();
    let mut held = Attachments::default();
    for (i, spring) in springs.iter().enumerate() {
        let at = i as u32;
        let tip = spring.rest_tip() + 0.01 * Vec2::new(draw(at, 4), draw(at, 5));
        held.attach(&springs, i, tip, &Pose::new(0.0, 0.0, 0.0));
    }
    (springs, held)
}

fn in_load(blocks: &mut SpringBlocks, pose: &Pose) -> Reaction {
    blocks.reaction(&Place::of(pose))
}

fn assert_equal(blocks: &Reaction, springs: &Reaction, n: u32) {
    // Some ten roundings of each of n terms, of the size that springs of 2 cm give them. Turns
    // count over the extent of load and spring, 4 cm.
    let tolerance = 4e-15 * f64::from(n);
    let units = Vec3::new(1.0, 1.0, 0.04);
    assert!((blocks.energy - springs.energy).abs() < tolerance * springs.energy.max(1e-4), "{} {}", blocks.energy, springs.energy);
    assert!(
        (blocks.gradient - springs.gradient).component_div(&units).amax() < tolerance * (0.03 + springs.energy / 0.02),
        "{blocks:?} {springs:?}"
    );
    let difference = blocks.hessian - springs.hessian;
    assert!(
        Mat3::from_fn(|i, j| difference[(i, j)] / units[i] / units[j]).amax() < tolerance * (3.0 + springs.energy / 0.02f64.powi(2)),
        "{blocks:?} {springs:?}"
    );
}

/// Any number of lanes, through small motions, which the series follows, and large ones, which
/// it does not.
#[test]
fn blocks_react_as_the_springs_one_by_one() {
    for n in [1, 2, 3, 4, 5, 11] {
        let (springs, mut held) = attached(n, 7 + u64::from(n));
        let mut blocks = SpringBlocks::default();
        blocks.fill(&springs, &held);
        blocks.start(&Place::of(&Pose::new(0.0, 0.0, 0.0)));
        for step in 1..40 {
            let t = f64::from(step);
            let turn = if step % 5 == 0 { 0.3 } else { 2e-3 };
            let pose = Pose::new(3e-3 * (0.7 * t).sin(), 2e-3 * t.cos(), turn * t.sin());
            let gradient = blocks.gradient(&Place::of(&pose));
            assert!((gradient - in_load(&mut blocks, &pose).gradient).amax() <= 1e-17, "{n} {step}");
            assert_equal(&in_load(&mut blocks, &pose), &held.reaction(&springs, &pose).in_axes(&rotation(pose.heading)), n);
            blocks.accept(&pose);
            held.accept(&springs, &pose);
            let mut attachments = held.to_vec();
            blocks.write_accepted(&mut attachments);
            for (attachment, own) in attachments.iter().zip(held.iter()) {
                // A walk of roundings of one.
                assert!((attachment.swing - own.swing).abs() < 4e-15 && attachment.tip == own.tip, "{n} {step}: {attachment:?} {own:?}");
                let pull = held.pull(&springs, own.spring, &pose);
                assert!((blocks.pull(own.spring) - pull).norm() < 1e-15, "{n} {step}");
            }
        }
    }
}

/// Swings of several turns, and a tip on its root, which has no direction, beside one that has.
#[test]
fn turns_are_counted_and_roots_are_passed() {
    let (springs, mut held) = attached(5, 3);
    let mut blocks = SpringBlocks::default();
    let still = Pose::new(0.0, 0.0, 0.0);
    blocks.fill(&springs, &held);
    blocks.start(&Place::of(&still));
    let from = held.to_vec();
    for step in 0..=60 {
        let angle = 0.4 * f64::from(step);
        let targets: Vec<Vec2> = springs.iter().map(|spring| spring.root + 0.02 * direction(spring.bearing + angle)).collect();
        blocks.place_tips(&from, &targets, 1.0);
        held.place_tips(&from, &targets, 1.0);
        assert_equal(&in_load(&mut blocks, &still), &held.reaction(&springs, &still), 10);
        blocks.accept(&still);
        held.accept(&springs, &still);
    }
    assert!(held[0].swing > 20.0);
    let mut on_root: Vec<Vec2> = held.iter().map(|attachment| attachment.tip).collect();
    on_root[1] = springs[1].root;
    blocks.place_tips(&from, &on_root, 1.0);
    held.place_tips(&from, &on_root, 1.0);
    let (block, apart) = (in_load(&mut blocks, &still), held.reaction(&springs, &still));
    assert!((block.energy - apart.energy).abs() <= 1e-14 * apart.energy && block.gradient.iter().all(|v| v.is_finite()));
    // A root has the stiffness k_t / l^2 of the shortest length, 7e11 N/m.
    assert!((block.hessian - apart.hessian).amax() <= 1e-12 * apart.hessian.amax());
}

/// The work of tips on a load that stands is the energy that the springs gain. By trapezoids it
/// is that to second order.
#[test]
fn accepted_work_is_that_of_the_pulls() {
    let (springs, held) = attached(6, 9);
    let mut blocks = SpringBlocks::default();
    let still = Pose::new(0.0, 0.0, 0.0);
    blocks.fill(&springs, &held);
    blocks.start(&Place::of(&still));
    let before = blocks.energy(&still);
    let targets: Vec<Vec2> = held.iter().map(|attachment| attachment.tip + Vec2::new(1e-3, -2e-3)).collect();
    blocks.place_tips(&held, &targets, 1.0);
    let stood = blocks.accept(&still);
    assert_eq!(stood.of_tips, stood.elastic - before);
    assert!(!stood.tips_stood && stood.on_load == 0.0);
    let moved = Pose::new(1e-5, 2e-5, 1e-4);
    let went = blocks.accept(&moved);
    assert!(went.tips_stood && went.of_tips == 0.0);
    // Tips stand and the load moves: the springs lose the work that they do, up to the cube of
    // the displacement over a length, 1e-3, by the trapezoid rule.
    assert!((went.on_load + went.elastic - stood.elastic).abs() < 1e-5 * went.on_load.abs(), "{went:?} {stood:?}");
}
