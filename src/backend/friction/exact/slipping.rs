//! All supports slip: Newton's method in polar coordinates about the slowest one.
//!
//! The twist is written by the velocity of the slowest support k and the turn rate, (v_k, omega),
//! and that triple in polar form, `v_k = s sin(psi) (cos phi, sin phi)`, `omega = s cos(psi) / L`
//! with L the largest distance of a support from k. The friction of k then has the direction (cos
//! phi, sin phi) whatever its speed, and that of the others depends on psi and phi alone: the
//! residual is smooth through v_k = 0 and linear in s, and neither slow slip nor the edge of
//! sticking spoils convergence.
//!
//! The same coordinates tell sticking from slipping near that edge: with f_i the full friction
//! forces of a direction (psi, phi), the share g for which `g sum_i B_i' f_i = w` is the gauge of
//! the limit surface. With g <= 1, the forces g f_i balance w and nothing moves.

use crate::backend::friction::cones::Cones;
use crate::backend::friction::problem::{Candidate, ContactMode};
use crate::backend::numerics::{EXACT, SLIPPING_ITERATIONS, SLIPPING_PATIENCE, SLIPPING_TURN};
use crate::math::{Mat2, Mat3, Vec2, Vec3, direction};
use crate::model::support::{slip_velocity, wrench_of};

/// The problem with twists about the slowest support.
struct Rebased<'a> {
    cones: &'a Cones,
    k: usize,
    /// Largest distance of a support from k; one where there is no other.
    reach: f64,
    /// T'HT and T'w, where T maps (v_k, omega) to the twist at the origin.
    h: Mat3,
    w: Vec3,
}

/// Polar coordinates (s, psi, phi).
#[derive(Clone, Copy)]
struct Polar {
    speed: f64,
    tilt: f64,
    course: f64,
}

/// The angles of [`Polar`] as directions: sine and cosine of the tilt, and the unit vector of the
/// course.
#[derive(Clone, Copy)]
struct Aim {
    sin: f64,
    cos: f64,
    course: Vec2,
}

impl Polar {
    fn aim(&self) -> Aim {
        let (sin, cos) = self.tilt.sin_cos();
        Aim { sin, cos, course: direction(self.course) }
    }
}

/// Slip found from `start`; writes the forces of the cones. `None`, with the forces as they were,
/// when Newton's method ends elsewhere.
pub fn slip(cones: &Cones, h: &Mat3, w: &Vec3, start: &Vec3, forces: &mut [Vec2], n_iterations: &mut u32) -> Option<Candidate> {
    let problem = Rebased::new(cones, cones.slowest(start), h, w);
    let at = problem.newton(|speed, aim| problem.balance(speed, aim), problem.polar_of(start)?, n_iterations)?;
    problem.write_forces(&at, 1.0, forces);
    Some(Candidate { twist: problem.twist_at(&at), mode: ContactMode::Slip })
}

/// Rest, when the gauge found from the direction of `start` is at most one; writes the forces of
/// the cones. `None`, with the forces as they were, when the gauge is larger or was not found.
pub fn stick(cones: &Cones, w: &Vec3, start: &Vec3, forces: &mut [Vec2], n_iterations: &mut u32) -> Option<Candidate> {
    let problem = Rebased::new(cones, cones.slowest(start), &Mat3::zeros(), w);
    let start = Polar { speed: 1.0, ..problem.polar_of(start)? };
    let at = problem.newton(|speed, aim| problem.gauge(speed, aim), start, n_iterations).filter(|at| at.speed <= 1.0)?;
    problem.write_forces(&at, at.speed, forces);
    Some(Candidate { twist: Vec3::zeros(), mode: ContactMode::Stick })
}

impl<'a> Rebased<'a> {
    fn new(cones: &'a Cones, k: usize, h: &Mat3, w: &Vec3) -> Self {
        let pivot = cones.offsets[k];
        let map = Mat3::new(1.0, 0.0, pivot.y, 0.0, 1.0, -pivot.x, 0.0, 0.0, 1.0);
        let reach = cones.offsets.iter().map(|offset| (offset - pivot).norm()).fold(0.0, f64::max);
        Self { cones, k, reach: if reach > 0.0 { reach } else { 1.0 }, h: map.transpose() * h * map, w: map.tr_mul(w) }
    }

    fn pivot(&self) -> Vec2 {
        self.cones.offsets[self.k]
    }

    fn polar_of(&self, twist: &Vec3) -> Option<Polar> {
        let slip = slip_velocity(&self.pivot(), twist);
        let turn = self.reach * twist.z;
        let speed = slip.norm().hypot(turn);
        (speed > 0.0 && speed.is_finite()).then(|| Polar { speed, tilt: slip.norm().atan2(turn), course: slip.y.atan2(slip.x) })
    }

    fn twist_at(&self, at: &Polar) -> Vec3 {
        let slip_and_turn = at.speed * self.unit_twist(&at.aim());
        let at_origin = slip_and_turn.xy() + slip_and_turn.z * Vec2::new(self.pivot().y, -self.pivot().x);
        Vec3::new(at_origin.x, at_origin.y, slip_and_turn.z)
    }

    /// (v_k, omega) at s = 1.
    fn unit_twist(&self, aim: &Aim) -> Vec3 {
        Vec3::new(aim.sin * aim.course.x, aim.sin * aim.course.y, aim.cos / self.reach)
    }

    /// Zero of `residual`, which also returns the derivative by (s, psi, phi).
    fn newton(&self, residual: impl Fn(f64, &Aim) -> (Vec3, Mat3), mut at: Polar, n_iterations: &mut u32) -> Option<Polar> {
        let (mut best, mut best_residual, mut waited) = (at, f64::INFINITY, 0);
        for _ in 0..SLIPPING_ITERATIONS {
            let aim = at.aim();
            let (value, jacobian) = residual(at.speed, &aim);
            let size = value.amax();
            let scale = self.cones.force_scale(&self.h, &self.w, &(at.speed * self.unit_twist(&aim)));
            waited = if size < best_residual { 0 } else { waited + 1 };
            if size < best_residual {
                (best, best_residual) = (at, size);
            }
            // One step beyond the tolerance costs little and gains the last digits.
            if size <= 1e-16 * scale || waited > 0 && best_residual <= EXACT * scale {
                break;
            }
            if waited >= SLIPPING_PATIENCE {
                return None;
            }
            *n_iterations += 1;
            let step = jacobian.lu().solve(&value)?;
            if !(step.y.abs() <= SLIPPING_TURN && step.z.abs() <= SLIPPING_TURN && step.x.is_finite()) {
                return None;
            }
            at = Polar { speed: at.speed - step.x, tilt: at.tilt - step.y, course: at.course - step.z };
        }
        let scale = self.cones.force_scale(&self.h, &self.w, &(best.speed * self.unit_twist(&best.aim())));
        (best_residual <= EXACT * scale && best.speed >= 0.0 && best.tilt.sin() >= 0.0).then_some(best)
    }

    /// `s H' d - w' + friction`: the balance about support k of a slip.
    fn balance(&self, speed: f64, aim: &Aim) -> (Vec3, Mat3) {
        let (unit_twist, by_tilt, by_course) = self.unit_twist_derivatives(aim);
        let (friction, friction_by_tilt, friction_by_course) = self.friction(aim);
        let residual = speed * (self.h * unit_twist) - self.w + friction;
        let tilt_column = speed * (self.h * by_tilt) + friction_by_tilt;
        let course_column = speed * (self.h * by_course) + friction_by_course;
        (residual, Mat3::from_columns(&[self.h * unit_twist, tilt_column, course_column]))
    }

    /// `g friction - w'`, with g in the place of s.
    fn gauge(&self, share: f64, aim: &Aim) -> (Vec3, Mat3) {
        let (friction, by_tilt, by_course) = self.friction(aim);
        (share * friction - self.w, Mat3::from_columns(&[friction, share * by_tilt, share * by_course]))
    }

    fn unit_twist_derivatives(&self, aim: &Aim) -> (Vec3, Vec3, Vec3) {
        let Aim { sin, cos, course } = aim;
        let by_tilt = Vec3::new(cos * course.x, cos * course.y, -sin / self.reach);
        let by_course = Vec3::new(-sin * course.y, sin * course.x, 0.0);
        (self.unit_twist(aim), by_tilt, by_course)
    }

    /// Wrench of the full friction forces about support k, and its derivatives by psi and phi.
    fn friction(&self, aim: &Aim) -> (Vec3, Vec3, Vec3) {
        let (unit_twist, by_tilt, by_course) = self.unit_twist_derivatives(aim);
        let (course, limit) = (aim.course, self.cones.limits[self.k]);
        let mut wrench = limit * Vec3::new(course.x, course.y, 0.0);
        let mut wrench_by_tilt = Vec3::zeros();
        let mut wrench_by_course = limit * Vec3::new(-course.y, course.x, 0.0);
        for (arm, limit) in self.others() {
            let slip = slip_velocity(&arm, &unit_twist);
            let speed = slip.norm().max(f64::MIN_POSITIVE);
            let unit = slip / speed;
            let turning = (limit / speed) * (Mat2::identity() - unit * unit.transpose());
            wrench += wrench_of(&arm, &(limit * unit));
            wrench_by_tilt += wrench_of(&arm, &(turning * slip_velocity(&arm, &by_tilt)));
            wrench_by_course += wrench_of(&arm, &(turning * slip_velocity(&arm, &by_course)));
        }
        (wrench, wrench_by_tilt, wrench_by_course)
    }

    /// Arms from support k and limits of the other supports.
    fn others(&self) -> impl Iterator<Item = (Vec2, f64)> + '_ {
        let pivot = self.pivot();
        (0..self.cones.len()).filter(|i| *i != self.k).map(move |i| (self.cones.offsets[i] - pivot, self.cones.limits[i]))
    }

    fn write_forces(&self, at: &Polar, share: f64, forces: &mut [Vec2]) {
        let aim = at.aim();
        let unit_twist = self.unit_twist(&aim);
        for (i, force) in forces.iter_mut().enumerate() {
            let arm = self.cones.offsets[i] - self.pivot();
            let course = if i == self.k { aim.course } else { slip_velocity(&arm, &unit_twist).normalize() };
            *force = share * self.cones.limits[i] * course;
        }
    }
}
