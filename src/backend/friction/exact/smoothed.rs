//! Continuation over rounded cones: |v| becomes sqrt(v^2 + eps^2), and eps falls tenfold from stage
//! to stage.
//!
//! Each stage is a smooth convex problem for a damped Newton method. Its forces lie strictly inside
//! the cones and its twist is near the answer's, so each stage offers the exact methods a start. A
//! problem without an exact answer after the last stage moves by less than the last eps, or lies on
//! the edge between two contact modes within rounding.

use super::start::far_answer;
use super::{gliding, pinned, slipping};
use crate::backend::friction::cones::Cones;
use crate::backend::friction::problem::{Candidate, ContactMode};
use crate::backend::numerics::{COARSE_ACCURACY, COARSE_STAGES, EXACT, SMOOTHED_ITERATIONS, SMOOTHED_STAGES, STAGE_ITERATIONS};
use crate::math::{Mat2, Mat3, Vec2, Vec3};
use crate::model::support::wrench_of;
use crate::stop;

/// Answer of an exact method from one of the stages, or else the best one after the last stage;
/// writes the forces of the cones.
pub fn search(cones: &Cones, h: &Mat3, w: &Vec3, forces: &mut [Vec2], n_iterations: &mut u32) -> Candidate {
    let (start, motion) = far_answer(cones, h, w, n_iterations);
    let mut twist = if cones.cluster.is_some() { start } else { Vec3::zeros() };
    let scale = if cones.cluster.is_some() { motion } else { motion.min(extent_of_motion(h, w)) };
    let mut rounding = scale;
    let most = *n_iterations + SMOOTHED_ITERATIONS;
    for stage in 0..SMOOTHED_STAGES {
        stop::point();
        if *n_iterations >= most {
            break;
        }
        rounding = scale * 10f64.powi(-stage);
        let accuracy = if stage < COARSE_STAGES { COARSE_ACCURACY } else { EXACT };
        twist = minimise(&Rounded { cones, h, w, rounding }, twist, accuracy, n_iterations);
        if let Some(found) = exact_from(cones, h, w, &twist, rounding, forces, n_iterations) {
            return found;
        }
    }
    best_of_both(cones, h, w, &twist, rounding, forces)
}

/// Largest displacement by a twist of supports at distance one.
fn extent(twist: &Vec3) -> f64 {
    twist.xy().norm() + twist.z.abs()
}

/// Displacement of the load along w itself without friction. It replaces the linear answer, which
/// is huge where H is nearly singular.
fn extent_of_motion(h: &Mat3, w: &Vec3) -> f64 {
    let stiffness = w.dot(&(h * w));
    if stiffness > 0.0 { extent(w) * w.norm_squared() / stiffness } else { f64::INFINITY }
}

/// Answer of the exact methods, started from that of a stage.
fn exact_from(
    cones: &Cones,
    h: &Mat3,
    w: &Vec3,
    twist: &Vec3,
    rounding: f64,
    forces: &mut [Vec2],
    n_iterations: &mut u32,
) -> Option<Candidate> {
    let rounded = Rounded { cones, h, w, rounding };
    (0..cones.len()).for_each(|k| forces[k] = rounded.force(k, twist));
    if cones.stick_forces(w, forces) {
        return Some(Candidate { twist: Vec3::zeros(), mode: ContactMode::Stick });
    }
    let slowest = cones.slowest(twist);
    let started = pinned::about(cones, slowest, h, w, forces);
    if started.is_some() || cones.slip(slowest, twist).norm() <= rounding {
        return started;
    }
    // Among supports close together the polar coordinates would lose the turn beside a fast slip,
    // since they are scaled by the arms.
    let glides = cones.cluster.and_then(|_| gliding::slip(cones, h, w, twist, n_iterations));
    if let Some((twist, _)) = glides {
        cones.write_slip_forces(&twist, forces);
        return Some(Candidate { twist, mode: ContactMode::Slip });
    }
    slipping::slip(cones, h, w, twist, forces, n_iterations).or_else(|| slipping::stick(cones, w, twist, forces, n_iterations))
}

/// Rest or the motion of the last stage, whichever violates the conditions less: for problems in
/// which no contact mode holds exactly.
fn best_of_both(cones: &Cones, h: &Mat3, w: &Vec3, twist: &Vec3, rounding: f64, forces: &mut [Vec2]) -> Candidate {
    let rounded = Rounded { cones, h, w, rounding };
    (0..cones.len()).for_each(|k| forces[k] = rounded.force(k, twist));
    let rest = cones.residual(h, w, &Vec3::zeros(), forces);
    let moving = cones.residual(h, w, twist, forces);
    if rest <= moving.max(EXACT) {
        Candidate { twist: Vec3::zeros(), mode: ContactMode::Stick }
    } else {
        Candidate { twist: *twist, mode: ContactMode::Slip }
    }
}

/// The rounded problem.
struct Rounded<'a> {
    cones: &'a Cones,
    h: &'a Mat3,
    w: &'a Vec3,
    rounding: f64,
}

impl Rounded<'_> {
    fn speed(&self, slip: &Vec2) -> f64 {
        (slip.norm_squared() + self.rounding * self.rounding).sqrt()
    }

    fn force(&self, k: usize, twist: &Vec3) -> Vec2 {
        let slip = self.cones.slip(k, twist);
        self.cones.limits[k] / self.speed(&slip) * slip
    }

    fn objective(&self, twist: &Vec3) -> f64 {
        let friction: f64 = (0..self.cones.len()).map(|k| self.cones.limits[k] * self.speed(&self.cones.slip(k, twist))).sum();
        0.5 * twist.dot(&(self.h * twist)) - self.w.dot(twist) + friction
    }

    fn derivatives(&self, twist: &Vec3) -> (Vec3, Mat3) {
        let mut gradient = self.h * twist - self.w;
        let mut hessian = *self.h;
        for k in 0..self.cones.len() {
            let (offset, slip, limit) = (self.cones.offsets[k], self.cones.slip(k, twist), self.cones.limits[k]);
            let speed = self.speed(&slip);
            let unit = slip / speed;
            let curvature = (limit / speed) * (Mat2::identity() - unit * unit.transpose());
            gradient += wrench_of(&offset, &(limit * unit));
            let columns = [Vec2::x(), Vec2::y(), Vec2::new(-offset.y, offset.x)].map(|column| wrench_of(&offset, &(curvature * column)));
            hessian += Mat3::from_columns(&columns);
        }
        (gradient, hessian)
    }
}

/// Twist at which the gradient, over the forces in it, is down to the `accuracy` (1), by a damped
/// Newton method. A step counts when the objective falls by Armijo's rule, or when the objective
/// has reached its rounding and the gradient still falls.
fn minimise(problem: &Rounded, start: Vec3, accuracy: f64, n_iterations: &mut u32) -> Vec3 {
    let mut twist = start;
    let (mut gradient, mut hessian) = problem.derivatives(&twist);
    for _ in 0..STAGE_ITERATIONS {
        let scale = problem.cones.force_scale(problem.h, problem.w, &twist);
        if gradient.amax() <= accuracy * scale {
            break;
        }
        *n_iterations += 1;
        let ridge = 1e-15 * hessian.diagonal().amax();
        let Some(factor) = (hessian + Mat3::from_diagonal_element(ridge)).cholesky() else { break };
        let step = -factor.solve(&gradient);
        let Some(next) = descend(problem, &twist, &gradient, &step) else { break };
        twist = next;
        (gradient, hessian) = problem.derivatives(&twist);
    }
    twist
}

fn descend(problem: &Rounded, twist: &Vec3, gradient: &Vec3, step: &Vec3) -> Option<Vec3> {
    let before = problem.objective(twist);
    let slope = gradient.dot(step);
    let rounding = 1e-15 * (before.abs() + problem.w.dot(twist).abs());
    let mut share = 1.0;
    for _ in 0..40 {
        let next = twist + share * step;
        let after = problem.objective(&next);
        let falls = after <= before + 1e-4 * share * slope;
        if falls || after <= before + rounding && problem.derivatives(&next).0.amax() <= 0.7 * gradient.amax() {
            return Some(next);
        }
        share *= 0.5;
    }
    None
}
