//! Whether the end of a jump depends on what dissipates besides friction.
//!
//! Friction alone does not say where a jump leads: whatever else dissipates decides its path. Take
//! the limit without mass of a load on damped springs whose dashpots are in proportion to the
//! springs, radial and torsional: all springs relax in the same time. Springs that have dashpots
//! keep their shapes in a jump instead. Its path obeys
//!
//! ```text
//! M(q) v + sum_i B_i' f_i = w(q)        M: dashpots, w: wrench of the springs
//! ```
//!
//! One minimisation along a constant twist is the same as one implicit step of this flow, of
//! infinite length. It leads to the same place as long as the path is straight: as long as what the
//! springs pull more than friction resists is in line with the drag of the dashpots. Runs under
//! error control look whether it is.

use super::dashpots::Dashpots;
use super::load::{Exact, SnapStart};
use super::quasi_static::QuasiStatic;
use crate::backend::numerics::{CERTAIN_END, JUMP_SHARES, STICKING_SLIP};
use crate::backend::springs::Place;
use crate::backend::stepping::Stepping;
use crate::math::{Arc, Mat3, Pose, PositiveDefinite, Vec2, Vec3, increment_of, rotation};
use crate::model::support::{slip_velocity, wrench_of};
use crate::model::{Ground, PolarSpring};

impl Exact<QuasiStatic> {
    /// Share of the forces that would lead the load from `start` elsewhere than to where it is
    /// (1). Infinite where that is not on the way of any flow.
    fn departure_from_flow(&self, start: &Pose) -> f64 {
        if self.springs.is_empty() || self.solver.accuracy() > 0.0 || !self.is_far_from(start) {
            return 0.0;
        }
        let end = self.state.motion.pose;
        let twist = increment_of(&rotation(start.heading), &(end.position - start.position), end.heading - start.heading);
        self.out_of_line(start, &twist)
    }

    /// Whether the end of a jump from `start` depends on the dissipation, as it may where obstacles
    /// hold the load. Only runs under error control look; at fixed steps the answer is no.
    pub(super) fn is_uncertain_from(&self, start: &SnapStart) -> bool {
        let touches = || start.touches || !self.state.side.touching.is_empty();
        matches!(self.stepping, Stepping::Controlled(_)) && (touches() || self.departure_from_flow(&start.pose) > CERTAIN_END)
    }

    /// Largest share of the forces that is out of line with a path of constant twist from `start`
    /// (1). Infinite where a support that sticks on the path would slip.
    fn out_of_line(&self, start: &Pose, twist: &Vec3) -> f64 {
        let Self { system, springs, .. } = self;
        let radius = system.load.radius;
        let units = Vec3::new(radius, radius, 1.0);
        let (friction, pin) = full_friction(&system.ground, twist);
        let at = |share: f64| {
            let arc = Arc::of(share * twist.z);
            let place = Place::of(start).moved(&(share * twist.xy()), &arc);
            let pull = -springs.reaction(&system.springs, &place.pose).gradient;
            let pull = rotation(place.pose.heading).tr_mul(&pull.xy()).push(pull.z);
            let mut dashpots = Dashpots::default();
            let stiffness = |spring: &PolarSpring| self.stiffness_in_jump(spring);
            dashpots.renew_as(system, springs, &place.pose, stiffness, |_, last| last.shape(&system.springs, &place.pose));
            let Some(blocks) = dashpots.blocks() else { return 0.0 };
            blocks.start(&place);
            let hessian = blocks.reaction(&place).hessian;
            let drag = (hessian * twist).component_mul(&units);
            let left = (pull - friction).component_mul(&units);
            let Some((offset, limit)) = pin else {
                if self.is_damped() {
                    return out_of_course(&hessian, &(pull - friction), &units, twist);
                }
                let across = left - left.dot(&drag) / drag.norm_squared() * drag;
                return across.norm() / (left.norm() + system.total_slip_limit() * radius);
            };
            // The moment about the support sets the speed, and the support bears what is left.
            let about = Vec3::new(offset.y, -offset.x, 1.0).component_div(&units);
            let on_support = left - left.dot(&about) / drag.dot(&about) * drag;
            if on_support.xy().norm() <= limit * radius { 0.0 } else { f64::INFINITY }
        };
        // Not a number is not certain.
        JUMP_SHARES.into_iter().map(at).map(|share| if share.is_nan() { f64::INFINITY } else { share }).fold(0.0, f64::max)
    }
}

/// Share of the velocity of a flow that is out of line with a `twist` (1), where dashpots with this
/// `hessian` resist a `wrench`. Those of damped springs bear forces without a motion to speak of.
fn out_of_course(hessian: &Mat3, wrench: &Vec3, units: &Vec3, twist: &Vec3) -> f64 {
    let Some(factor) = PositiveDefinite::new(hessian) else { return f64::INFINITY };
    let [course, twist] = [factor.solve(wrench), *twist].map(|course| course.component_div(units));
    (course - course.dot(&twist) / twist.norm_squared() * twist).norm() / course.norm()
}

/// Friction on all supports that slip with this twist, at its limits (N, N, N m; load axes), and
/// offset (m) and limit (N) of the one that does not.
fn full_friction(ground: &Ground, twist: &Vec3) -> (Vec3, Option<(Vec2, f64)>) {
    let of = |offset: &Vec2| slip_velocity(offset, twist);
    let fastest = ground.supports.iter().map(|support| of(&support.offset).norm()).fold(0.0, f64::max);
    let (mut sum, mut pin) = (Vec3::zeros(), None);
    for (support, limit) in ground.supports.iter().zip(ground.slip_limits()).filter(|(_, limit)| *limit > 0.0) {
        let slip = of(&support.offset);
        if slip.norm() <= STICKING_SLIP * fastest {
            pin = Some((support.offset, limit));
        } else {
            sum += wrench_of(&support.offset, &(limit * slip.normalize()));
        }
    }
    (sum, pin)
}
