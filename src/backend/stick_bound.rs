//! How far the held tips may go before a load at rest can begin to slip.
//!
//! As long as the load stands, its wrench w depends on nothing but where the tips are: a spring pulls with F(p) at its tip p, and turns with the moment of that. What
//! was balanced where the certificate was made by forces f_i with room to their limits is balanced by them and the least forces for what w has changed by. At the end
//! of one step w is simply evaluated. Over many, it is known to first order in the ways d of the tips, and what the second order adds is bounded: with
//! a = k_r (l - l_0), b = k_t psi / l, e along the spring and t across,
//!
//! ```text
//! K = dF/dp = k_r ee' + (a / l + k_t / l^2) tt' - (b / l) (et' + te')
//! d^2 F/dp^2 (u, u) = (A sin^2 + B sin 2) e + (B cos 2 + A sin 2) t  of the angle from e to u,    A = (k_r l_0 - 2 k_t / l) / l^2,   B = 2 b / l^2
//! |F - F_0 - K d| <= L |d|^2 / 2,   L = (2 / sqrt 3) |A| + |B|           |tau - tau_0 - d x F_0 - p x K d| <= (|K| + |p| L / 2) |d|^2
//! ```
//!
//! A, B and p at their largest in a ball about the tip. A change of w that is no more than that changes each f_i by at most `c_i^2 |B_i M|` times as much, M as in the
//! certificate of rest. Ways for which forces stay within their limits by this bound are a convex set: a straight way of the tips that begins and ends in it lies in it.

use serde::{Deserialize, Serialize};

use super::friction::FrictionSolver;
use super::springs::Place;
use super::springs::{Attachment, Attachments};
use crate::math::{Mat2, Mat3x2, Vec2, Vec3, perpendicular};
use crate::model::PolarSpring;
use crate::model::spring::SHORTEST_LENGTH;

/// Radius of the ball over the length of the spring (1): the law changes little in it.
const BALL: f64 = 0.125;
/// What the direction of a spring can change by in it (rad): arcsin(1/8), rounded up.
const LARGEST_TURN: f64 = 0.1254;

/// A certificate of rest for tips near the ones that it was made for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StickBound {
    is_made: bool,
    /// Of the springs on the load at the time (N, N, N m; load axes).
    wrench: Vec3,
    /// What that was balanced by (see [`FrictionSolver::roomy_forces`]).
    forces: Vec<Vec2>,
    /// Where the load was.
    at: Option<Place>,
    /// One a attachment, in their order.
    balls: Vec<Ball>,
    /// Of the same; none before many steps are asked for.
    growths: Vec<Growth>,
}

/// Where a tip is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Ball {
    /// As it was when the certificate was made.
    attachment: Attachment,
    /// (m)
    radius: f64,
}

/// How the wrench of a spring changes with the way of its tip from there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Growth {
    /// What balances the wrench of a small way of the tip, by that way (1/m).
    response: Mat3x2,
    /// Largest wrench of the second order by the squared way (scaled, 1/m^2).
    bend: f64,
}

impl StickBound {
    /// Takes the rest of a load at a place that `solver` has just found for the tips of `held`, whose swings are those there.
    pub fn renew(&mut self, springs: &[PolarSpring], held: &Attachments, at: &Place, solver: &FrictionSolver) {
        self.forget();
        self.balls.clear();
        self.growths.clear();
        let mut wrench = Vec3::zeros();
        for attachment in held.iter() {
            let Some((ball, pull)) = Ball::about(attachment, &springs[attachment.spring], at) else { return };
            wrench += pull;
            self.balls.push(ball);
        }
        (self.wrench, self.at) = (wrench, Some(*at));
        self.is_made = solver.roomy_forces(&wrench, &mut self.forces) && solver.bears(&self.forces, &Vec3::zeros(), 0.0);
    }

    pub fn is_made(&self) -> bool {
        self.is_made
    }

    /// What the wrench was balanced by when the certificate was made (scaled, one a cone).
    pub fn forces(&self) -> &[Vec2] {
        &self.forces
    }

    pub fn forget(&mut self) {
        self.is_made = false;
    }

    /// Puts the tips of attachments where the certificate was made for them.
    pub fn put_back(&self, attachments: &mut [Attachment]) {
        attachments.iter_mut().zip(&self.balls).for_each(|(attachment, ball)| attachment.tip = ball.attachment.tip);
    }

    /// Whether the load surely sticks under this wrench of the springs (N, N, N m; load axes), with their tips here (m, world, in the order of the attachments).
    pub fn holds(&self, wrench: &Vec3, tips: impl Iterator<Item = Vec2>, solver: &FrictionSolver) -> bool {
        let is_near = |(ball, tip): (&Ball, Vec2)| ball.contains(&(tip - ball.attachment.tip));
        let change = solver.balanced(&(wrench - self.wrench));
        self.is_made && change.is_some_and(|change| solver.bears(&self.forces, &change, 0.0)) && self.balls.iter().zip(tips).all(is_near)
    }

    /// On how many of `n_steps` equal steps of the tips' straight way from where they are to their entries of `targets` (m, world), from the first one on, the load
    /// surely sticks.
    pub fn n_sure(&mut self, springs: &[PolarSpring], held: &Attachments, targets: &[Vec2], n_steps: u64, solver: &FrictionSolver) -> u64 {
        let Some(at) = self.at.filter(|_| self.is_made) else { return 0 };
        if self.growths.is_empty() {
            let growth = |ball: &Ball| Growth::in_ball(ball, &springs[ball.attachment.spring], &at, solver);
            self.growths = self.balls.iter().map_while(growth).collect();
        }
        if self.growths.len() < self.balls.len() {
            return 0;
        }
        let is_sure = |n: u64| {
            let share = n as f64 / n_steps as f64;
            let (mut change, mut bend) = (Vec3::zeros(), 0.0);
            self.balls.iter().zip(&self.growths).zip(held.iter()).all(|((ball, growth), attachment)| {
                let way = attachment.tip + share * (targets[attachment.spring] - attachment.tip) - ball.attachment.tip;
                change += growth.response * way;
                bend += growth.bend * way.norm_squared();
                ball.contains(&way)
            }) && solver.bears(&self.forces, &change, bend)
        };
        // A load balanced by other forces than those of the certificate sticks here, and by this bound is not known to.
        if n_steps > 1 && !is_sure(0) {
            return 0;
        }
        if is_sure(n_steps) {
            return n_steps;
        }
        let (mut sure, mut unsure) = (0, n_steps);
        while unsure - sure > 1 {
            let middle = sure + (unsure - sure) / 2;
            *(if is_sure(middle) { &mut sure } else { &mut unsure }) = middle;
        }
        sure
    }
}

impl Ball {
    /// With the pull of the spring on the load (N, N, N m; load axes). `None` for a spring too short to have a direction.
    fn about(attachment: &Attachment, spring: &PolarSpring, at: &Place) -> Option<(Self, Vec3)> {
        let Reach { arm, length, pull, .. } = Reach::of(attachment, spring, at)?;
        let radius = if spring.is_isotropic() { f64::MAX } else { BALL * length };
        Some((Self { attachment: *attachment, radius }, pull.push(arm.perp(&pull))))
    }

    /// Whether it reaches as far as this way (m) from its centre.
    fn contains(&self, way: &Vec2) -> bool {
        way.norm_squared() <= self.radius * self.radius
    }
}

/// A tip from the origin of the load and from the root of its spring (m, load axes), and how it is pulled on.
struct Reach {
    arm: Vec2,
    along: Vec2,
    length: f64,
    /// Of the spring on the load (N, load axes).
    pull: Vec2,
}

impl Reach {
    /// `None` for a spring too short to have a direction, which it needs.
    fn of(attachment: &Attachment, spring: &PolarSpring, at: &Place) -> Option<Self> {
        let arm = at.turn.tr_mul(&(attachment.tip - at.pose.position));
        let along = arm - spring.root;
        let (length, radial) = (along.norm(), spring.radial_stiffness);
        if spring.is_isotropic() {
            return Some(Self { arm, along, length, pull: radial * along });
        }
        let e = along / length;
        let (stretch, swing) = (radial * (length - spring.rest_length), spring.torsional_stiffness * attachment.swing / length);
        (length > SHORTEST_LENGTH * spring.rest_length).then(|| Self { arm, along, length, pull: stretch * e + swing * perpendicular(&e) })
    }
}

impl Growth {
    /// Within a ball about the tip of a spring. `None` for one too short to have a direction, and where nothing is known of the supports.
    fn in_ball(Ball { attachment, radius }: &Ball, spring: &PolarSpring, at: &Place, solver: &FrictionSolver) -> Option<Self> {
        let Reach { arm, along, length, pull } = Reach::of(attachment, spring, at)?;
        let (radial, torsional) = (spring.radial_stiffness, spring.torsional_stiffness);
        let (bend, stiffness) = if spring.is_isotropic() {
            (0.0, radial * Mat2::identity())
        } else {
            let e = along / length;
            let t = perpendicular(&e);
            let across = (radial * (length - spring.rest_length) + torsional / length) / length;
            let coupling = torsional * attachment.swing / (length * length);
            let mixed = e * t.transpose();
            let stiffness = radial * e * e.transpose() + across * t * t.transpose() - coupling * (mixed + mixed.transpose());
            let shortest = length - radius;
            let largest_a = (radial * spring.rest_length).max(2.0 * torsional / shortest) / (shortest * shortest);
            let largest_b = 2.0 * torsional * (attachment.swing.abs() + LARGEST_TURN) / (shortest * shortest * shortest);
            let curvature = 1.155 * largest_a + largest_b;
            let largest = radial.max(across.abs()) + coupling.abs();
            let bend = solver.scaled_wrench(0.5 * curvature, largest + 0.5 * (arm.norm() + radius) * curvature);
            (bend, stiffness)
        };
        let column = |way: Vec2| {
            let force = stiffness * way;
            solver.balanced(&force.push(way.perp(&pull) + arm.perp(&force)))
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

    /// What a spring does beyond first order stays within the bound wherever the tip goes in its ball, and comes close to it somewhere: otherwise it would be loose.
    #[test]
    fn the_second_order_of_a_spring_is_bounded() {
        let supports = [0.3, 2.1, 4.0].map(|angle| SupportPoint { offset: 0.008 * direction(angle), normal_load: 0.005 });
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
                damping_ratio: 0.0,
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
                let way = radius * direction(f64::from(k)) * (1.0 - 0.3 * f64::from(k % 3));
                // Central differences: their error, some 1e-9 of it all, is far below what is of second order at millimetres.
                let h = 1e-4;
                let slope = (wrench(&(tip + h * way)) - wrench(&(tip - h * way))) / (2.0 * h);
                let rest = wrench(&(tip + way)) - wrench(&tip) - slope;
                let size = solver.scaled_wrench(rest.xy().norm(), rest.z.abs());
                let bound = growth.bend * way.norm_squared();
                assert!(size <= bound * (1.0 + 1e-6) + 1e-9 * solver.scaled_wrench(0.1, 0.004), "{case} {k}: {size} {bound}");
                closest = closest.max(size / bound.max(1e-300));
                let first = growth.response * way - solver.balanced(&slope).unwrap();
                assert!(first.norm() < 1e-6 * (growth.response * way).norm() + 1e-9, "{case} {k}: {first}");
            }
        }
        assert!(closest > 0.5, "{closest}");
    }
}
