//! The law of a spring: derivatives of its energy, and its limits.

use cohaul::math::{Pose, Vec2, Vec3, direction};
use cohaul::model::{PolarSpring, SpringLaw, SpringShape, paper};

const PAPER: PolarSpring = PolarSpring {
    root: Vec2::new(paper::LOAD_RADIUS_M, 0.0),
    bearing: 0.0,
    rest_length: paper::REST_LENGTH_M,
    radial_stiffness: paper::RADIAL_STIFFNESS_N_PER_M,
    torsional_stiffness: paper::TORSIONAL_STIFFNESS_NM_PER_RAD,
    damping_ratio: 0.0,
    law: SpringLaw::Polar,
};

fn energy_at(spring: &PolarSpring, q: Vec3, tip: &Vec2, near: f64) -> f64 {
    spring.energy(&spring.shape(&Pose::new(q.x, q.y, q.z), tip, near))
}

#[test]
fn gradient_and_hessian_are_the_derivatives_of_the_energy() {
    let spring = PolarSpring { root: Vec2::new(0.003, 0.0116), bearing: 1.4, ..PAPER };
    let rope = PolarSpring { torsional_stiffness: 0.0, law: SpringLaw::Rope, ..spring };
    // It is 33 mm long.
    for spring in [spring, rope, PolarSpring { rest_length: 0.04, ..rope }] {
        check_derivatives(&spring);
    }
}

/// The Hessian is symmetric by construction, so differences of the energy check all of it.
fn check_derivatives(spring: &PolarSpring) {
    let at = Vec3::new(0.004, -0.003, 0.35);
    let tip = Vec2::new(0.02, 0.047);
    let pose = Pose::new(at.x, at.y, at.z);
    let shape = spring.shape(&pose, &tip, 0.0);
    let reaction = spring.reaction(&pose, &shape);
    let scale = Vec3::new(0.0263, 0.0263, 1.0);
    let step = 1e-3;
    for i in 0..3 {
        let e = Vec3::ith(i, scale[i] * step);
        let along = |t: f64| energy_at(spring, at + t * e, &tip, shape.swing);
        // Fourth-order differences; energy 1e-4 J: truncation 1e-12 of it, rounding 1e-16 /
        // step relative.
        let slope = (8.0 * (along(1.0) - along(-1.0)) - along(2.0) + along(-2.0)) / 12.0;
        assert!((slope - reaction.gradient.dot(&e)).abs() < 1e-9 * 1e-4 * step.sqrt(), "{i}: {slope}");
        for j in 0..3 {
            let f = Vec3::ith(j, scale[j] * step);
            let gradient = |t: f64| {
                let q = at + t * f;
                let pose = Pose::new(q.x, q.y, q.z);
                spring.reaction(&pose, &spring.shape(&pose, &tip, shape.swing)).gradient[i] * scale[i]
            };
            let slope = (8.0 * (gradient(1.0) - gradient(-1.0)) - gradient(2.0) + gradient(-2.0)) / 12.0;
            let exact = reaction.hessian[(i, j)] * scale[i] * scale[j] * step;
            assert!((slope - exact).abs() < 1e-13, "{i},{j}: {slope} {exact}");
        }
    }
}

#[test]
fn an_undeformed_spring_carries_nothing_at_any_bearing() {
    for bearing in [0.0, 1.0, 2.5, -3.0] {
        let spring = PolarSpring { root: 0.0122 * direction(bearing), bearing, ..PAPER };
        let pose = Pose::new(0.2, 0.1, 0.8);
        let shape = spring.shape(&pose, &pose.to_world(&spring.rest_tip()), 0.0);
        // Rounding of positions of order 0.2 m times 0.66 N/m.
        assert!(spring.pull_in_root(&shape).norm() < 1e-16);
    }
}

/// At rest the rotational stiffness is (k_t / l_0^2) (R_L + l_0)^2 = 9.69e-4 N m/rad.
#[test]
fn rest_stiffness_in_rotation() {
    let pose = Pose::new(0.0, 0.0, 0.0);
    let shape = PAPER.shape(&pose, &PAPER.rest_tip(), 0.0);
    let stiffness = PAPER.reaction(&pose, &shape).hessian.m33;
    assert!((stiffness - 4.52e-4 / 0.0263f64.powi(2) * 0.0385f64.powi(2)).abs() < 1e-18 * 1e3);
    // Three digits are known.
    assert!((stiffness - 9.69e-4).abs() < 5e-7);
}

/// At l = l_0 the tip Hessian loses definiteness at a swing of 1.00802 rad.
#[test]
fn convexity_is_lost_at_the_critical_swing() {
    let determinant = |swing: f64| {
        let shape = SpringShape { tip_in_root: 0.0263 * direction(swing), length: 0.0263, swing };
        PAPER.stiffness_in_root(&shape).determinant()
    };
    assert!(determinant(1.00801) > 0.0);
    assert!(determinant(1.00803) < 0.0);
}

#[test]
fn the_swing_follows_its_branch_over_a_whole_turn() {
    let pose = Pose::new(0.0, 0.0, 0.0);
    let mut swing = 0.0;
    for step in 0..=100 {
        let tip = PAPER.root + 0.0263 * direction(0.1 * f64::from(step));
        swing = PAPER.shape(&pose, &tip, swing).swing;
    }
    assert!((swing - 10.0).abs() < 1e-13);
}

#[test]
fn a_tip_on_its_root_gives_finite_answers() {
    let pose = Pose::new(0.0, 0.0, 0.0);
    let reaction = PAPER.reaction(&pose, &PAPER.shape(&pose, &PAPER.root, 0.3));
    assert!(reaction.energy.is_finite() && reaction.gradient.norm().is_finite() && reaction.hessian.norm().is_finite());
}
