//! Stick certificate: how far attached tips may move before a load at rest can begin to slip.
//!
//! While the load stands, the wrench w of the springs on it depends only on the tips. A spring
//! pulls with F(p) at its tip p, and turns the load with the moment of that. The certificate is
//! made where friction forces f_i with room to their limits balance w. Those forces and the least
//! forces for the change of w balance it elsewhere. At the end of one step w is simply evaluated.
//! Over many steps it is known to first order in the displacements d of the tips, and the second
//! order is bounded. With the derivative K of F, and a bound L of its second derivative,
//!
//! ```text
//! |F - F_0 - K d| <= L |d|^2 / 2           |tau - tau_0 - d x F_0 - p x K d| <= (|K| + |p| L / 2) |d|^2
//! ```
//!
//! L and p are taken at their largest in a ball about the tip. A change of w by no more than
//! that changes each f_i by at most `c_i^2 |B_i M|` times as much, with M of the friction solver.
//! The displacements for which all forces stay within their limits by this bound are a convex set:
//! a straight path of the tips that begins and ends in it lies in it.

use serde::{Deserialize, Serialize};

use crate::backend::friction::FrictionSolver;
use crate::backend::numerics::{CERTIFICATE_BALL, CERTIFICATE_TURN};
use crate::backend::report::RestoreError;
use crate::backend::springs::{AttachedSprings, Attachment, Place, SpringBlocks, TipPaths};
use crate::math::{Mat3x2, Vec2, Vec3};
use crate::model::spring::SHORTEST_LENGTH;
use crate::model::{PolarSpring, SpringShape};

/// Proof that the load sticks for tips near those that it was made for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StickCertificate {
    is_made: bool,
    /// Wrench of the springs on the load when it was made (N, N, N m; load axes).
    wrench: Vec3,
    /// Friction forces that balanced it (see [`FrictionSolver::forces_with_margin`]).
    forces: Vec<Vec2>,
    /// Place of the load.
    at: Option<Place>,
    /// One for each attachment, in their order.
    balls: Vec<Ball>,
    /// One for each ball; none before many steps are asked for.
    growths: Vec<Growth>,
}

/// Region of a tip in which the bounds hold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Ball {
    /// Attachment when the certificate was made.
    attachment: Attachment,
    /// (m)
    radius: f64,
}

/// Growth of the wrench of a spring with the displacement of its tip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Growth {
    /// Friction forces that balance a small displacement of the tip, over the displacement (1/m).
    response: Mat3x2,
    /// Largest wrench of the second order over the squared displacement (scaled, 1/m^2).
    bend: f64,
}

impl StickCertificate {
    /// Makes the certificate for a load that `solver` has just found at rest, with these springs at
    /// their accepted place.
    pub fn renew(&mut self, springs: &[PolarSpring], attached: &AttachedSprings, solver: &FrictionSolver) {
        self.forget();
        self.balls.clear();
        self.growths.clear();
        let at = attached.place();
        let mut wrench = Vec3::zeros();
        for attachment in attached.iter() {
            let Some((ball, pull)) = Ball::about(attachment, &springs[attachment.spring], at) else { return };
            wrench += pull;
            self.balls.push(ball);
        }
        (self.wrench, self.at) = (wrench, Some(*at));
        self.is_made = solver.forces_with_margin(&wrench, &mut self.forces) && solver.are_within_limits(&self.forces, &Vec3::zeros(), 0.0);
    }

    pub fn forget(&mut self) {
        self.is_made = false;
    }

    /// Friction forces that balanced the load when it was made (scaled, one a cone).
    pub fn forces(&self) -> &[Vec2] {
        &self.forces
    }

    /// # Errors
    /// When a restored certificate is one for another number of supports, or for springs that are
    /// not there.
    pub fn check(&self, solver: &FrictionSolver, n_springs: usize) -> Result<(), RestoreError> {
        if let Some(ball) = self.balls.iter().find(|ball| ball.attachment.spring >= n_springs) {
            return Err(RestoreError(format!("a stick certificate for spring {} of {n_springs}", ball.attachment.spring)));
        }
        let (n_forces, n_supports) = (self.forces.len(), solver.warm_start().forces.len());
        if n_forces == n_supports || n_forces == 0 && !self.is_made {
            return Ok(());
        }
        Err(RestoreError(format!("a stick certificate with forces on {n_forces} supports, not on {n_supports}")))
    }

    /// Whether there is a certificate since the load was last found at rest.
    pub fn is_made(&self) -> bool {
        self.is_made
    }

    /// Moves the tips through as many of the remaining ones of `n_steps` equal steps, of which some
    /// are `done`, as the load certainly sticks for. Returns their number. The certificate must be
    /// made.
    pub fn advance_tips(
        &mut self,
        springs: &[PolarSpring],
        attached: &mut AttachedSprings,
        (paths, [done, n_steps]): (&TipPaths, [u64; 2]),
        solver: &FrictionSolver,
    ) -> u64 {
        // One step is known from its end, which costs less than a bound for all of it and reaches
        // farther.
        let n_left = n_steps - done;
        let n_bound = if n_left > 1 { self.n_certain(springs, attached, paths.targets, n_left, solver) } else { 0 };
        let n_certain = n_bound.max(1);
        let share = (done + n_certain) as f64 / n_steps as f64;
        let sticks = |gradient: Vec3, blocks: &SpringBlocks| n_bound > 0 || self.holds(&-gradient, blocks.tips(), solver);
        if attached.move_ahead(paths, share, sticks) { n_certain } else { 0 }
    }

    /// Whether the load certainly sticks under this wrench of the springs (N, N, N m; load axes),
    /// with these tips (m, world, in the order of the attachments).
    fn holds(&self, wrench: &Vec3, tips: impl Iterator<Item = Vec2>, solver: &FrictionSolver) -> bool {
        let is_near = |(ball, tip): (&Ball, Vec2)| ball.contains(&(tip - ball.attachment.tip));
        let change = solver.balanced(&(wrench - self.wrench));
        change.is_some_and(|change| solver.are_within_limits(&self.forces, &change, 0.0)) && self.balls.iter().zip(tips).all(is_near)
    }

    /// Number of equal steps of the straight paths of the tips to their entries of `targets` (m,
    /// world), from the first of `n_steps` on, for which the load certainly sticks.
    fn n_certain(
        &mut self,
        springs: &[PolarSpring],
        attached: &AttachedSprings,
        targets: &[Vec2],
        n_steps: u64,
        solver: &FrictionSolver,
    ) -> u64 {
        let Some(at) = self.at else { return 0 };
        if self.growths.is_empty() {
            let growth = |ball: &Ball| Growth::in_ball(ball, &springs[ball.attachment.spring], &at, solver);
            self.growths = self.balls.iter().map_while(growth).collect();
        }
        if self.growths.len() < self.balls.len() {
            return 0;
        }
        let is_certain = |n: u64| {
            let share = n as f64 / n_steps as f64;
            let (mut change, mut bend) = (Vec3::zeros(), 0.0);
            self.balls.iter().zip(&self.growths).zip(attached.iter()).all(|((ball, growth), attachment)| {
                let shift = attachment.tip + share * (targets[attachment.spring] - attachment.tip) - ball.attachment.tip;
                change += growth.response * shift;
                bend += growth.bend * shift.norm_squared();
                ball.contains(&shift)
            }) && solver.are_within_limits(&self.forces, &change, bend)
        };
        // A load may stick here by other forces than those of the certificate, which the bound does
        // not cover.
        if n_steps > 1 && !is_certain(0) {
            return 0;
        }
        if is_certain(n_steps) {
            return n_steps;
        }
        let (mut certain, mut uncertain) = (0, n_steps);
        while uncertain - certain > 1 {
            let middle = certain + (uncertain - certain) / 2;
            *(if is_certain(middle) { &mut certain } else { &mut uncertain }) = middle;
        }
        certain
    }
}

impl Ball {
    /// Ball about the tip of an attachment, and the wrench of its spring on the load (N, N, N m;
    /// load axes). `None` for a spring too short to have a direction.
    fn about(attachment: &Attachment, spring: &PolarSpring, at: &Place) -> Option<(Self, Vec3)> {
        let Reach { arm, shape, pull } = Reach::of(attachment, spring, at)?;
        let radius = if spring.is_isotropic() { f64::MAX } else { CERTIFICATE_BALL * shape.length };
        Some((Self { attachment: *attachment, radius }, pull.push(arm.perp(&pull))))
    }

    /// Whether the ball contains the point at this `shift` (m) from its centre.
    fn contains(&self, shift: &Vec2) -> bool {
        shift.norm_squared() <= self.radius * self.radius
    }
}

/// Tip from the origin of the load (m, load axes), shape of its spring in load axes, and its pull.
struct Reach {
    arm: Vec2,
    shape: SpringShape,
    /// Pull on the tip, which is the force of the spring on the load (N, load axes).
    pull: Vec2,
}

impl Reach {
    /// Reach of an attachment; `None` for a spring that needs a direction and is too short for one.
    fn of(attachment: &Attachment, spring: &PolarSpring, at: &Place) -> Option<Self> {
        let arm = at.turn.tr_mul(&(attachment.tip - at.pose.position));
        let along = arm - spring.root;
        let shape = SpringShape { tip_in_root: along, length: along.norm(), swing: attachment.swing };
        let has_direction = spring.is_isotropic() || shape.length > SHORTEST_LENGTH * spring.rest_length;
        has_direction.then(|| Self { arm, shape, pull: spring.pull_in_root(&shape) })
    }
}

impl Growth {
    /// Growth within a ball about the tip of a spring. `None` for a spring too short to have a
    /// direction or that may become slack, and where nothing is known of the supports.
    fn in_ball(Ball { attachment, radius }: &Ball, spring: &PolarSpring, at: &Place, solver: &FrictionSolver) -> Option<Self> {
        let Reach { arm, shape, pull } = Reach::of(attachment, spring, at)?;
        let stiffness = spring.stiffness_in_root(&shape);
        let bend = if spring.is_isotropic() {
            0.0
        } else {
            let [along, across, between] = spring.polar_stiffness(shape.length, shape.swing);
            let largest = along.max(across.abs()) + between.abs();
            let curvature = spring.largest_curvature(shape.length - radius, shape.swing.abs() + CERTIFICATE_TURN);
            if curvature == f64::INFINITY {
                return None;
            }
            solver.scaled_wrench(0.5 * curvature, largest + 0.5 * (arm.norm() + radius) * curvature)
        };
        let column = |shift: Vec2| {
            let force = stiffness * shift;
            solver.balanced(&force.push(shift.perp(&pull) + arm.perp(&force)))
        };
        let to_load = at.turn.transpose();
        let response = Mat3x2::from_columns(&[column(to_load.column(0).into_owned())?, column(to_load.column(1).into_owned())?]);
        Some(Self { response, bend })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Pose, RandomStreams, Stream, direction};
    use crate::model::{Ground, SupportPoint};

    /// The second order of a spring stays within its bound wherever the tip goes in its ball, and
    /// comes close to it somewhere: the bound is not loose.
    #[test]
    fn the_second_order_of_a_spring_is_bounded() {
        let supports =
            [0.3, 2.1, 4.0].map(|angle| SupportPoint { offset: 0.008 * direction(angle), normal_load: 0.005, friction_coefficient: None });
        let solver = FrictionSolver::new(&Ground { friction_coefficient: 1.4, supports: supports.to_vec() }, 0.0122);
        let mut closest: f64 = 0.0;
        for case in 0..300 {
            let streams = RandomStreams::new(case);
            let draw = |k: u64| 2.0 * streams.uniform(Stream::Start, 0, k) - 1.0;
            let spring = PolarSpring {
                root: 0.0122 * direction(3.0 * draw(0)),
                bearing: 3.0 * draw(1),
                rest_length: if case % 5 == 0 { 0.0 } else { 0.0263 },
                radial_stiffness: 0.664 * 8f64.powf(draw(2)),
                torsional_stiffness: if case % 3 == 0 { 0.0 } else { 4.52e-4 * 8f64.powf(draw(3)) },
                ..PolarSpring::default()
            };
            let place = Place::of(&Pose::new(0.1, -0.2, 2.0 * draw(4)));
            let swing = 2.5 * draw(5);
            let reach = 0.0263 * 3f64.powf(draw(6)) * direction(spring.bearing + swing);
            let tip = place.pose.to_world(&(spring.root + reach));
            let wrench = |tip: &Vec2| {
                let shape = spring.shape(&place.pose, tip, swing);
                let pull = place.turn.tr_mul(&spring.pull(&place.pose, &shape));
                let arm = place.turn.tr_mul(&(tip - place.pose.position));
                pull.push(arm.perp(&pull))
            };
            let attachment = Attachment { spring: 0, tip, swing };
            let (ball, pull) = Ball::about(&attachment, &spring, &place).unwrap();
            let growth = Growth::in_ball(&ball, &spring, &place, &solver).unwrap();
            // Rounding of forces of 0.1 N.
            assert!((pull - wrench(&tip)).norm() < 1e-15, "{case}: {pull} {}", wrench(&tip));
            let radius = ball.radius.min(0.003);
            for k in 0..24 {
                let shift = radius * direction(f64::from(k)) * (1.0 - 0.3 * f64::from(k % 3));
                // The error of central differences, some 1e-9 of it all, is far below the second
                // order at millimetres.
                let h = 1e-4;
                let slope = (wrench(&(tip + h * shift)) - wrench(&(tip - h * shift))) / (2.0 * h);
                let rest = wrench(&(tip + shift)) - wrench(&tip) - slope;
                let size = solver.scaled_wrench(rest.xy().norm(), rest.z.abs());
                let bound = growth.bend * shift.norm_squared();
                assert!(size <= bound * (1.0 + 1e-6) + 1e-9 * solver.scaled_wrench(0.1, 0.004), "{case} {k}: {size} {bound}");
                closest = closest.max(size / bound.max(1e-300));
                let first = growth.response * shift - solver.balanced(&slope).unwrap();
                assert!(first.norm() < 1e-6 * (growth.response * shift).norm() + 1e-9, "{case} {k}: {first}");
            }
        }
        assert!(closest > 0.5, "{closest}");
    }
}
