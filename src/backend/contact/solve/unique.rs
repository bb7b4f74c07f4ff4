//! Whether a load at rest could slide as well.
//!
//! Obstacles on several sides can wedge a load by forces that need no drive, and the ground may
//! press a load at rest against an obstacle. Both raise the limit of the side friction, and neither
//! is left once the load slides. A load at rest with the forces g_i of the ground, p across a
//! straight wall and tau along it starts to slide by x, with the forces c_i u_i of the ground along
//! its slips v_i, and P across the wall, only where both balance the same drive:
//!
//! ```text
//! across the wall    P - p = sum_i (c_i u_i - g_i) n
//! work by x          sum_i (c_i |v_i| - g_i v_i) + sum_k p_k n_k x + tau s + mu P |s| = 0
//! ```
//!
//! Here s is the slip along the wall, the same for all contacts with it. The first two terms of the
//! work are never negative, so that s is against tau. Over |s|, all slides in which the load keeps
//! touching are one family for each sense of rotation: slip along the wall and lambda times a
//! rotation about the outermost contact of that sense. Along it the work of the ground is convex,
//! and the angle of each u_i changes one way only, so that both have a lower bound over any part of
//! the family. Rest is the only answer where the work is positive over all parts.
//!
//! A load that parts from the wall also moves by some alpha n, and has P = 0. The work of the
//! ground and of p has its least value in alpha where P is zero. If P is positive at alpha = 0, it
//! grows with alpha, and nothing parts. If it is negative there, forces of the ground between g_i
//! and c_i u_i show that the work of the ground is at least p / (p - P) of that at alpha = 0.
//!
//! Springs and inertia have no part in this: a slide begins with a short one.

use smallvec::{SmallVec, smallvec};

use super::problem::{Candidate, PerCone, Problem};
use crate::backend::numerics::{LEAST_WORK, MOST_PARTS, PARALLEL_NORMALS};
use crate::math::{Vec2, Vec3};
use crate::stop;

/// Whether no slide balances the drive as the forces of this `rest` do. `false` proves nothing.
pub fn is_only_answer(problem: &Problem, rest: &Candidate) -> bool {
    let has_friction = problem.touching_rows().any(|k| problem.rows[k].friction_coefficient > 0.0);
    !has_friction || [1.0, -1.0].into_iter().all(|turn| Slides::new(problem, rest, turn).is_some_and(|slides| slides.take_work()))
}

/// Slides with a rotation in one sense, by their rotation over the slip along the wall.
struct Slides {
    supports: PerCone<Support>,
    /// Normal force at rest, what the ground adds to it, and least coefficient of friction.
    pressing: f64,
    by_ground: f64,
    friction_coefficient: f64,
    /// Work along the wall by a unit of slip, and across it by a unit of rotation.
    along: f64,
    across: f64,
}

/// A support: its limit, the force at rest, and what it slips by a unit of rotation (along the slip
/// of the wall, and away from the wall).
struct Support {
    limit: f64,
    force: Vec2,
    turning: Vec2,
}

impl Slides {
    /// `None` where not everything that touches is one straight wall.
    fn new(problem: &Problem, rest: &Candidate, turn: f64) -> Option<Self> {
        let first = &problem.rows[problem.touching_rows().next()?];
        let (size, normal, tangent) = (first.normal.xy().norm(), first.normal.xy().normalize(), first.tangent.xy().normalize());
        let (mut pressing, mut along, mut friction_coefficient) = (0.0, 0.0, f64::INFINITY);
        // Arms of the contacts and the depth of the wall.
        let mut arms: SmallVec<[(f64, f64); 4]> = SmallVec::new();
        let depth = first.tangent.z / size;
        for k in problem.touching_rows() {
            let (row, force) = (&problem.rows[k], &rest.forces[k]);
            let same = |vector: Vec3, of: Vec2, z: f64| (vector / size - of.push(z)).amax() <= PARALLEL_NORMALS;
            let arm = row.normal.z / size;
            if row.slip != 0.0 || !same(row.normal, normal, arm) || !same(row.tangent, tangent, depth) {
                return None;
            }
            pressing += force.normal * size;
            along += force.tangential * size;
            friction_coefficient = row.friction_coefficient.min(friction_coefficient);
            arms.push((arm, force.normal * size));
        }
        // The dangerous slip is against the friction force.
        let sense = if along > 0.0 { -1.0 } else { 1.0 };
        let pivot = arms.iter().map(|(arm, _)| -turn * arm).fold(f64::NEG_INFINITY, f64::max);
        let rotation = (pivot * normal - turn * depth * tangent).push(turn);
        let support = |k: usize| {
            let (by_rotation, force) = (problem.cones.slip(k, &rotation), rest.ground_forces[k]);
            let in_wall = |vector: Vec2| Vec2::new(sense * vector.dot(&tangent), vector.dot(&normal));
            Support { limit: problem.cones.limits[k], force: in_wall(force), turning: in_wall(by_rotation) }
        };
        let supports: PerCone<Support> = (0..problem.cones.len()).map(support).collect();
        let by_ground = supports.iter().map(|support| support.force.y).sum();
        let across = arms.iter().map(|(arm, force)| force * (pivot + turn * arm)).sum();
        Some(Self { supports, pressing, by_ground, friction_coefficient, along: -along.abs(), across })
    }

    /// Whether every slide takes more work than the drive can do.
    fn take_work(&self) -> bool {
        let takes_work = |rotation: f64| self.least_work(rotation, rotation) > LEAST_WORK;
        let mut parts: SmallVec<[(f64, f64); 16]> = smallvec![(0.0, f64::INFINITY)];
        let mut n_parts = 0;
        while let Some((from, to)) = parts.pop() {
            stop::point();
            if self.least_work(from, to) > LEAST_WORK {
                continue;
            }
            let middle = if to.is_finite() { 0.5 * (from + to) } else { 2.0 * from + 1.0 };
            n_parts += 1;
            if n_parts > MOST_PARTS || !takes_work(from) || !takes_work(middle) {
                return false;
            }
            parts.extend([(middle, to), (from, middle)]);
        }
        true
    }

    /// Lower bound of the work of the slides between two rotations, over their slip.
    fn least_work(&self, from: f64, to: f64) -> f64 {
        let (mut works, mut slopes) = ([0.0; 2], [0.0; 2]);
        let mut pressed = self.pressing - self.by_ground;
        for Support { limit, force, turning } in &self.supports {
            let slip = |rotation: f64| Vec2::new(1.0 + rotation * turning.x, rotation * turning.y);
            // At last, the slip has the direction of the rotation, if that moves the support.
            let is_turned = to.is_infinite() && *turning != Vec2::zeros();
            let ends = [slip(from), if is_turned { *turning } else { slip(if to.is_finite() { to } else { from }) }];
            let mut least = 1.0f64;
            for (end, slip) in ends.iter().enumerate() {
                let size = slip.norm();
                let direction = if size > 0.0 { slip / size } else { Vec2::zeros() };
                works[end] += limit * size - force.dot(slip);
                slopes[end] += (*limit * direction - force).dot(turning);
                least = least.min(if size > 0.0 { direction.y } else { -1.0 });
            }
            let [a, b] = ends;
            let turns_through_wall = a.x * b.x < 0.0 && a.y * b.x.abs() + b.y * a.x.abs() < 0.0;
            pressed += limit * if turns_through_wall { -1.0 } else { least };
        }
        let ground = if slopes[0] >= 0.0 {
            works[0]
        } else if to.is_infinite() {
            0.0
        } else if slopes[1] <= 0.0 {
            works[1]
        } else {
            // Where the tangents at both ends meet.
            let beyond = (works[1] - works[0] - slopes[1] * (to - from)) / (slopes[0] - slopes[1]);
            works[0] + slopes[0] * beyond
        };
        let held = if pressed >= 0.0 {
            ground + self.friction_coefficient * pressed
        } else {
            ground.max(0.0) * self.pressing / (self.pressing - pressed)
        };
        held + self.along + from * self.across
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::types::{ContactRow, ContactSystem, SideForce, SideMode};
    use super::super::{go_on_resting, solve_contacts};
    use super::*;
    use crate::backend::friction::{ContactMode, FrictionSolver};
    use crate::math::{Mat3, RandomStreams, Stream, Vec3, direction, perpendicular, rotation};
    use crate::model::support::wrench_of;
    use crate::model::{Ground, SupportPoint};

    fn row(normal: Vec2, arm: Vec2, friction_coefficient: f64) -> ContactRow {
        let tangent = -perpendicular(&normal);
        let [normal, tangent] = [normal, tangent].map(|force| wrench_of(&arm, &force));
        ContactRow { normal, tangent, gap: 0.0, slip: 0.0, friction_coefficient }
    }

    /// A ground with slip limits (N) at these points (m), under a load of 1 m that rests by these
    /// forces.
    fn resting(supports: &[(Vec2, f64)], ground: &[Vec2]) -> FrictionSolver {
        let point = |(offset, limit): &(Vec2, f64)| SupportPoint { offset: *offset, normal_load: *limit, friction_coefficient: None };
        let mut solver = FrictionSolver::new(&Ground { friction_coefficient: 1.0, supports: supports.iter().map(point).collect() }, 1.0);
        let scaled: Vec<Vec2> = ground.iter().map(|force| force / solver.cones().unit_of_force()).collect();
        solver.keep_scaled(Vec3::zeros(), ContactMode::Stick, &scaled);
        solver
    }

    fn goes_on(drive: Vec3, solver: &mut FrictionSolver, rows: &[ContactRow], forces: &[SideForce]) -> bool {
        let system = ContactSystem { hessian: &Mat3::zeros(), drive: &drive, rows };
        go_on_resting(&system, solver, &vec![SideMode::Stick; rows.len()], forces).is_some()
    }

    /// What a wall and the ground can hold together, however the ground presses the load against
    /// the wall: 1 N and 1.5 times the force that the drive presses with. The load has one support
    /// under its centre, where its contacts are as well.
    #[test]
    fn a_load_that_may_slide_does_not_go_on_resting() {
        let goes_on = |drive: Vec2, ground: Vec2, sides: &[(Vec2, SideForce)]| {
            let (rows, forces): (Vec<_>, Vec<_>) = sides.iter().map(|(normal, force)| (row(*normal, Vec2::zeros(), 1.5), *force)).unzip();
            goes_on(drive.push(0.0), &mut resting(&[(Vec2::zeros(), 1.0)], &[ground]), &rows, &forces)
        };
        let force = |normal: f64, tangential: f64| SideForce { normal, tangential };
        let wall = Vec2::y();
        assert!(goes_on(Vec2::new(2.0, -1.0), Vec2::new(0.6, 0.0), &[(wall, force(1.0, -1.4))]));
        // Nor does it matter that the ground pressed it so far.
        assert!(goes_on(Vec2::new(1.75, -1.0), Vec2::new(0.0, 1.0), &[(wall, force(2.0, -1.75))]));
        assert!(goes_on(Vec2::new(2.499, -1.0), Vec2::new(1.0, 0.0), &[(wall, force(1.0, -1.499))]));
        assert!(!goes_on(Vec2::new(2.5, -1.0), Vec2::new(1.0, 0.0), &[(wall, force(1.0, -1.5))]));
        let pressed = |push: f64| goes_on(Vec2::new(push, 0.0), Vec2::new(0.2, 0.6), &[(wall, force(0.6, 0.2 - push))]);
        assert!(!pressed(1.0) && !pressed(1.05));
        // Two walls that hold the load against a pull away from both of them.
        let walls = [1.0, -1.0].map(|side| Vec2::new(side, 1.0).normalize());
        let tangential = 10.0 + 1.5 / 2f64.sqrt();
        let wedged = [(walls[0], force(10.0, tangential)), (walls[1], force(10.0, -tangential))];
        assert!(!goes_on(Vec2::new(0.0, 1.5), Vec2::zeros(), &wedged));
        assert!(goes_on(Vec2::new(0.0, -5.0), Vec2::zeros(), &[(wall, force(5.0, 0.0))]));
    }

    fn polar(length: f64, angle: f64) -> Vec2 {
        length * direction(angle)
    }

    /// Random loads at rest near their limits, by forces like those of a slide, on one to three
    /// contacts with one wall. Where one goes on resting, the whole search finds that it rests. Its
    /// springs do not press it against the wall, so that they have no part in whether it slides.
    #[test]
    fn a_load_that_goes_on_resting_does_not_slide() {
        let streams = RandomStreams::new(11);
        let (mut n_going_on, mut n_resting) = (0, 0);
        for case in 0..3000 {
            let mut n_drawn = 0;
            let mut unit = || {
                n_drawn += 1;
                streams.uniform(Stream::Start, case, n_drawn)
            };
            let mut between = |low: f64, high: f64| low + (high - low) * unit();
            let supports = [(); 3].map(|()| (polar(between(0.0, 1.0), between(0.0, TAU)), between(0.0, 1.0)));
            let (normal, friction, depth) = (polar(1.0, between(0.0, TAU)), between(0.1, 2.0), between(-0.5, 1.0));
            let arms: Vec<Vec2> = (0..=case % 3).map(|_| between(-1.0, 1.0) * perpendicular(&normal) - depth * normal).collect();
            // Forces near those of a slide with a rotation about one of the contacts.
            let (sense, turn, share) = (between(-1.0, 1.0).signum(), between(-2.0, 2.0), 1.0 - 10f64.powf(between(-5.0, -0.3)));
            let angle = 10f64.powf(between(-4.0, 0.0));
            let ground = supports.map(|(offset, limit)| {
                let slip = -sense * perpendicular(&normal) + turn * perpendicular(&(offset - arms[0]));
                rotation(between(-angle, angle)) * (share * limit * slip.normalize())
            });
            let side = |arm: &Vec2| {
                let force = between(0.0, 0.5);
                (row(normal, *arm, friction), SideForce { normal: force, tangential: -sense * share * friction * force })
            };
            let (rows, forces): (Vec<_>, Vec<_>) = arms.iter().map(side).unzip();
            let by_sides: Vec3 =
                rows.iter().zip(&forces).map(|(row, force)| force.normal * row.normal + force.tangential * row.tangent).sum();
            let by_ground: Vec3 = supports.iter().zip(&ground).map(|((offset, _), force)| wrench_of(offset, force)).sum();
            let drive = by_ground - by_sides;
            let mut solver = resting(&supports, &ground);
            let along = (-perpendicular(&normal)).push(0.0);
            let hessian = along * along.transpose() + Mat3::from_diagonal(&Vec3::new(1e-3, 1e-3, 1.0));
            let found = solve_contacts(&ContactSystem { hessian: &hessian, drive: &drive, rows: &rows }, &mut solver.clone(), None);
            // A slide is as long as what drives it beyond its limits (N) over 1 N/m, and the loads
            // are 1e-5 of their limits away from them, or farther.
            let is_rest = found.increment.amax() < 1e-9;
            n_resting += u64::from(is_rest);
            if goes_on(drive, &mut solver, &rows, &forces) {
                n_going_on += 1;
                assert!(is_rest, "case {case}: {} {:e}", found.increment, found.residual);
            }
        }
        // Others can slide near where they rest, and few cannot be told from those.
        assert!(2 * n_going_on > n_resting, "{n_going_on} of {n_resting}");
    }
}
