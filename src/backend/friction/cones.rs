//! The supports as cones in scaled units: distinct points with positive limits.
//!
//! H and w know the load's size, friction the supports' arms. Where the arms are far shorter than the load, lengths are in units of the load: in those of
//! the arms the moments would outgrow the forces beside them, and their rounding hide them. There, and where the supports are far closer to each other than
//! to the origin, twists are taken about a point among them: the slips would otherwise be small differences of large numbers.

use smallvec::SmallVec;

use crate::math::{Mat3, PositiveDefinite, Vec2, Vec3};
use crate::model::Ground;
use crate::model::support::{slip_velocity, wrench_of};

/// Supports on the same point act as one with the sum of their limits; those without a limit do not act at all.
#[derive(Clone, Debug)]
pub(super) struct Cones {
    /// Positions from `centre` over `length`.
    pub offsets: Vec<Vec2>,
    /// Limits over `force`; they add up to one.
    pub limits: Vec<f64>,
    /// Cone of each support and the share of its limit there; `None` for a support without a limit.
    shares: Vec<Option<(usize, f64)>>,
    /// Largest distance of a support from `centre` over `length` where they are close together by the measure of the load.
    pub cluster: Option<f64>,
    /// Point that twists are about (m, load axes), if it is not the load's origin.
    centre: Option<Vec2>,
    /// Unit of length (m): the largest distance of a support from there, or the size of the load.
    length: f64,
    /// Unit of force (N): the sum of the limits.
    force: f64,
    /// What scales each entry of a gradient, and of a Hessian.
    per_gradient: Vec3,
    per_hessian: Mat3,
    /// (sum_i c_i^2 B_i' B_i)^-1, if there is one: least-norm forces for a wrench, each in units of its limit.
    balance: Option<Mat3>,
    /// Largest change of each cone's force, as the certificate of rest makes it, by a change of the wrench; empty where there is none.
    sways: Vec<f64>,
}

/// So often forces are taken back: nearly all that can come to rest does by then.
const MOST_ROUNDS: u32 = 16;
/// Share of its limit that a force is taken back to (1).
const WITHIN: f64 = 0.98;
/// By how much more than the way there it is taken (1): the rest of it comes back.
const OVER: f64 = 1.6;
/// So often limits are weighed to find room: that does but within a percent or so of slipping.
const MOST_WEIGHINGS: u32 = 16;
/// Parabolas in place of the cones' losses: after so many, Newton's method takes over.
const N_TOUCHES: u32 = 2;
/// Room that is not worth the search, of each limit (1).
const NARROW: f64 = 0.01;
/// Share of the room that there can be which is enough (1).
const ENOUGH: f64 = 0.5;
/// Least weight (1).
const LIGHTEST: f64 = 1e-4;
/// Left for rounding of what surely sticks, of each limit (1).
const MARGIN: f64 = 1e-9;
/// Supports nearer to each other than this share of their extent are one: no solver could tell them apart.
const SAME_POINT: f64 = 1e-12;
/// Largest distance of a support from their middle below which they are close together, over the size of the load (1).
const SHORT: f64 = 0.1;
/// The same over the distance of the middle from the origin (1).
const CLOSE: f64 = 1e-2;

/// What is known of a load after the search for forces that hold it close to the edge of slipping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pressed {
    /// They were found.
    Held,
    /// There are none, as this twist proves.
    Slips(Vec3),
    /// Neither.
    Unsure,
}

impl Cones {
    pub fn new(ground: &Ground, length_scale: f64) -> Self {
        let force: f64 = ground.slip_limits().sum();
        let carrying: Vec<Vec2> =
            ground.supports.iter().zip(ground.slip_limits()).filter(|(_, c)| *c > 0.0).map(|(s, _)| s.offset).collect();
        let Frame { centre, length, cluster, point } = Frame::of(&carrying, length_scale);
        let force = if force > 0.0 { force } else { 1.0 };
        let units = Vec3::new(length, length, 1.0);
        let mut cones = Cones {
            offsets: Vec::new(),
            limits: Vec::new(),
            shares: Vec::new(),
            cluster,
            centre,
            length,
            force,
            per_gradient: units / (length * force),
            per_hessian: units * units.transpose() / (length * force),
            balance: None,
            sways: Vec::new(),
        };
        for (support, limit) in ground.supports.iter().zip(ground.slip_limits()) {
            let share = (limit > 0.0).then(|| {
                let arm = point.unwrap_or_else(|| centre.map_or(support.offset, |centre| support.offset - centre));
                cones.merge(arm / length, limit / cones.force)
            });
            cones.shares.push(share);
        }
        for (cone, share) in cones.shares.iter_mut().flatten() {
            *share /= cones.limits[*cone];
        }
        cones.balance = cones.balance_matrix();
        cones.sways = cones.sways_of(cones.balance.as_ref());
        cones
    }

    pub fn len(&self) -> usize {
        self.limits.len()
    }

    pub fn is_empty(&self) -> bool {
        self.limits.is_empty()
    }

    /// The cone that a support joins, and its limit there.
    fn merge(&mut self, offset: Vec2, limit: f64) -> (usize, f64) {
        if let Some(k) = self.offsets.iter().position(|known| (known - offset).norm() <= SAME_POINT * self.cluster.unwrap_or(1.0)) {
            self.limits[k] += limit;
            return (k, limit);
        }
        self.offsets.push(offset);
        self.limits.push(limit);
        (self.len() - 1, limit)
    }

    fn balance_matrix(&self) -> Option<Mat3> {
        if self.len() < 2 {
            return None;
        }
        let mut gram = Mat3::zeros();
        for (offset, limit) in self.offsets.iter().zip(&self.limits) {
            gram += limit * limit * slip_gram(offset);
        }
        gram.try_inverse()
    }

    /// c_i^2 |B_i M|, by Frobenius' norm.
    fn sways_of(&self, balance: Option<&Mat3>) -> Vec<f64> {
        let sway = |balance: &Mat3, offset: &Vec2, limit: f64| {
            let columns = balance.column_iter().map(|column| slip_velocity(offset, &column.into_owned()).norm_squared());
            limit * limit * columns.sum::<f64>().sqrt()
        };
        let of = |balance: &Mat3| self.offsets.iter().zip(&self.limits).map(|(offset, limit)| sway(balance, offset, *limit)).collect();
        balance.map(of).unwrap_or_default()
    }

    /// The balance matrix times a wrench; `None` where there is no such matrix.
    pub fn balanced(&self, wrench: &Vec3) -> Option<Vec3> {
        self.balance.map(|balance| balance * wrench)
    }

    /// Forces that balance w and leave room to all limits, if any do, in place of `forces`; `false` where nothing is known. From the least ones on, those near to their
    /// limits weigh more and more (Lawson 1961), which leads to those of which the largest share of its limit is least. The twist n that belongs to them tells how
    /// small that can be: nothing balances w with less than `n'w / sum_i c_i |B_i n|`.
    pub fn roomy_forces(&self, w: &Vec3, forces: &mut Vec<Vec2>) -> bool {
        forces.clear();
        let Some(balance) = &self.balance else { return false };
        forces.resize(self.len(), Vec2::zeros());
        let [mut weights, mut shares]: [SmallVec<[f64; 8]>; 2] = [1.0, 0.0].map(|value| SmallVec::from_elem(value, self.len()));
        let (mut twist, mut best) = (balance * w, f64::INFINITY);
        for _ in 0..MOST_WEIGHINGS {
            let (mut largest, mut loss) = (0.0f64, 0.0);
            for (k, weight) in weights.iter().enumerate() {
                let slip = self.slip(k, &twist).norm();
                shares[k] = self.limits[k] / weight * slip;
                (largest, loss) = (largest.max(shares[k]), loss + self.limits[k] * slip);
            }
            if largest < best {
                let weighted = |k: usize| self.least_force(k, &twist) / weights[k];
                forces.iter_mut().enumerate().for_each(|(k, force)| *force = weighted(k));
                best = largest;
            }
            let least = twist.dot(w) / loss;
            let is_worth_more = 1.0 - least > NARROW && 1.0 - best < ENOUGH * (1.0 - least);
            if !is_worth_more {
                break;
            }
            let mut gram = Mat3::zeros();
            for (k, weight) in weights.iter_mut().enumerate() {
                // A common factor of all weights means nothing.
                *weight = (*weight * shares[k] / largest).max(LIGHTEST);
                gram += self.limits[k] * self.limits[k] / *weight * slip_gram(&self.offsets[k]);
            }
            let Some(factor) = PositiveDefinite::new(&gram) else { break };
            twist = factor.solve(w);
        }
        // What rounding has left of it.
        let change = balance * (w - self.wrench(forces));
        forces.iter_mut().enumerate().for_each(|(k, force)| *force += self.least_force(k, &change));
        true
    }

    /// Whether these forces stay within all limits when the least ones for a wrench are added, of which `balanced` is the balance matrix times that, and for a
    /// further one of the norm `further`.
    pub fn bears(&self, forces: &[Vec2], balanced: &Vec3, further: f64) -> bool {
        let bears = |k: usize| {
            let room = (1.0 - MARGIN) * self.limits[k] - self.sways[k] * further;
            room >= 0.0 && (forces[k] + self.least_force(k, balanced)).norm_squared() <= room * room
        };
        (0..self.len()).all(bears)
    }

    /// Largest norm of a wrench (scaled) with such a force (N) and such a torque about the load's origin (N m).
    pub fn scaled_wrench(&self, force: f64, torque: f64) -> f64 {
        let about_centre = torque + self.centre.map_or(0.0, |centre| centre.norm()) * force;
        Vec2::new(force, about_centre / self.length).norm() / self.force
    }

    /// H and w in scaled units: energies over length times force.
    pub fn scaled(&self, hessian: &Mat3, drive: &Vec3) -> (Mat3, Vec3) {
        (self.scaled_hessian(hessian), self.scaled_gradient(drive))
    }

    /// H alone.
    pub fn scaled_hessian(&self, hessian: &Mat3) -> Mat3 {
        let Some(centre) = self.centre else { return hessian.component_mul(&self.per_hessian) };
        let map = Mat3::new(1.0, 0.0, centre.y, 0.0, 1.0, -centre.x, 0.0, 0.0, 1.0);
        (map.transpose() * hessian * map).component_mul(&self.per_hessian)
    }

    /// w alone.
    pub fn scaled_gradient(&self, gradient: &Vec3) -> Vec3 {
        let at_centre = |centre: Vec2| Vec3::new(gradient.x, gradient.y, gradient.z + centre.y * gradient.x - centre.x * gradient.y);
        self.centre.map_or(*gradient, at_centre).component_mul(&self.per_gradient)
    }

    pub fn unscaled_twist(&self, twist: &Vec3) -> Vec3 {
        let twist = Vec3::new(self.length * twist.x, self.length * twist.y, twist.z);
        self.centre.map_or(twist, |centre| slip_velocity(&-centre, &twist).push(twist.z))
    }

    pub fn scaled_twist(&self, twist: &Vec3) -> Vec3 {
        let at_centre = self.centre.map_or(twist.xy(), |centre| slip_velocity(&centre, twist));
        Vec3::new(at_centre.x / self.length, at_centre.y / self.length, twist.z)
    }

    pub fn first_support_of(&self, cone: usize) -> usize {
        self.shares.iter().position(|share| share.is_some_and(|(k, _)| k == cone)).expect("a cone comes from a support")
    }

    /// Forces on the supports (N) from the cones' f_i.
    pub fn share_forces(&self, cone_forces: &[Vec2], support_forces: &mut [Vec2]) {
        for (force, share) in support_forces.iter_mut().zip(&self.shares) {
            *force = share.map_or(Vec2::zeros(), |(cone, share)| -cone_forces[cone] * (share * self.force));
        }
    }

    /// Slip of cone k.
    pub fn slip(&self, k: usize, twist: &Vec3) -> Vec2 {
        slip_velocity(&self.offsets[k], twist)
    }

    /// sum_i B_i' f_i.
    pub fn wrench(&self, forces: &[Vec2]) -> Vec3 {
        self.offsets.iter().zip(forces).map(|(offset, force)| wrench_of(offset, force)).sum()
    }

    /// Full friction forces f_i of a twist that leaves no support at rest.
    pub fn write_slip_forces(&self, twist: &Vec3, forces: &mut [Vec2]) {
        for (k, force) in forces.iter_mut().enumerate() {
            let slip = self.slip(k, twist);
            *force = (self.limits[k] / slip.norm()) * slip;
        }
    }

    /// Index of the cone that slips least.
    pub fn slowest(&self, twist: &Vec3) -> usize {
        let speed = |k: usize| self.slip(k, twist).norm_squared();
        (0..self.len()).min_by(|a, b| speed(*a).total_cmp(&speed(*b))).expect("there is a cone")
    }

    /// Whether forces within all limits balance w, found from the ones given by the least change in units of the limits, or else as the least ones. The answer
    /// no proves nothing: the forces are then left as they were.
    pub fn stick_forces(&self, w: &Vec3, forces: &mut [Vec2]) -> bool {
        let Some(balance) = &self.balance else { return false };
        let change = balance * (w - self.wrench(forces));
        if self.fit(|k| forces[k] + self.least_force(k, &change)) {
            forces.iter_mut().enumerate().for_each(|(k, force)| *force += self.least_force(k, &change));
            return true;
        }
        let least = balance * w;
        let fits = self.fit(|k| self.least_force(k, &least));
        if fits {
            forces.iter_mut().enumerate().for_each(|(k, force)| *force = self.least_force(k, &least));
        }
        fits
    }

    /// The same close to the edge of slipping: forces that the least change takes beyond their limits are taken back to a little within, and what that leaves is
    /// balanced again, over and over. The change is along the slip of some twist n; one with `n'w > sum_i c_i |B_i n|` proves that nothing can hold the load.
    pub fn pressed_forces(&self, w: &Vec3, forces: &mut [Vec2]) -> Pressed {
        let Some(balance) = &self.balance else { return Pressed::Unsure };
        let mut trial: SmallVec<[Vec2; 8]> = SmallVec::from_slice(forces);
        for round in 0..MOST_ROUNDS {
            let change = balance * (w - self.wrench(&trial));
            if round % 4 == 3 && change.dot(w) > self.loss(&change) {
                return Pressed::Slips(change);
            }
            trial.iter_mut().enumerate().for_each(|(k, force)| *force += self.least_force(k, &change));
            if self.fit(|k| trial[k]) {
                forces.copy_from_slice(&trial);
                return Pressed::Held;
            }
            for (force, limit) in trial.iter_mut().zip(&self.limits) {
                let (size, within) = (force.norm(), WITHIN * limit);
                if size > within {
                    *force *= 1.0 + OVER * (within / size - 1.0);
                }
            }
        }
        Pressed::Unsure
    }

    /// `sum_i c_i |B_i n|`.
    fn loss(&self, n: &Vec3) -> f64 {
        (0..self.len()).map(|k| self.limits[k] * self.slip(k, n).norm()).sum()
    }

    /// A twist near the slip that balances w, from a direction `n` with `n'w > sum_i c_i |B_i n|`. Along it the objective is least at a twist x, and the parabolas
    /// that touch the cones' losses there, `c_i |B_i x|^2 / 2 |B_i x|`, are least together at another one where the objective is less than at x; and so on (Weiszfeld 1937).
    /// `None` where that does not end in a slip of all cones.
    pub fn slip_along(&self, n: &Vec3, h: &Mat3, w: &Vec3) -> Option<Vec3> {
        let mut twist = (n.dot(w) - self.loss(n)) / n.dot(&(h * n)) * n;
        for _ in 0..N_TOUCHES {
            let mut sum = *h;
            for (k, offset) in self.offsets.iter().enumerate() {
                sum += self.limits[k] / self.slip(k, &twist).norm() * slip_gram(offset);
            }
            twist = PositiveDefinite::new(&sum)?.solve(w);
        }
        twist.iter().all(|v| v.is_finite()).then_some(twist)
    }

    /// On cone k, of the least forces for a wrench, each in units of its limit; `balanced` is the balance matrix times that.
    fn least_force(&self, k: usize, balanced: &Vec3) -> Vec2 {
        self.limits[k] * self.limits[k] * self.slip(k, balanced)
    }

    fn fit(&self, force: impl Fn(usize) -> Vec2) -> bool {
        (0..self.len()).all(|k| force(k).norm_squared() <= self.limits[k] * self.limits[k])
    }

    /// Largest violation of the optimality conditions by (twist, forces), over the forces in them.
    pub fn residual(&self, h: &Mat3, w: &Vec3, twist: &Vec3, forces: &[Vec2]) -> f64 {
        let elastic = h * twist;
        let balance = (elastic - w + self.wrench(forces)).amax();
        let cones = (0..self.len()).map(|k| {
            let (slip, force, limit) = (self.slip(k, twist), forces[k], self.limits[k]);
            let above = (force.norm() - limit).max(0.0);
            let speed = slip.norm();
            // A slipping support's force is its limit along the slip; speeds within rounding of the twist have no direction, and those not far above
            // it have one within an angle.
            let angle = 1e-15 * twist.amax() / speed;
            let aligned = speed == 0.0 || angle >= 1.0;
            let misaligned = if aligned { 0.0 } else { limit - force.dot(&slip) / speed - 0.5 * angle * angle * limit };
            above.max(misaligned)
        });
        cones.fold(balance, f64::max) / self.force_scale(h, w, twist)
    }

    /// Size of the terms of the balance, from which rounding is counted: |w|, the limits and the largest product in H x.
    pub fn force_scale(&self, h: &Mat3, w: &Vec3, twist: &Vec3) -> f64 {
        let products = (0..3).map(|j| h.column(j).amax() * twist[j].abs()).fold(0.0, f64::max);
        w.amax() + 1.0 + products
    }
}

/// What the cones are measured by.
struct Frame {
    centre: Option<Vec2>,
    length: f64,
    cluster: Option<f64>,
    /// Where all supports stand (m), if that is one point.
    point: Option<Vec2>,
}

impl Frame {
    /// For supports at `offsets` (m) under a load of size `length_scale` (m).
    fn of(offsets: &[Vec2], length_scale: f64) -> Self {
        let extent_about = |centre: Vec2| offsets.iter().map(|offset| (offset - centre).norm()).fold(0.0, f64::max);
        let reach = extent_about(Vec2::zeros());
        let middle = offsets.iter().sum::<Vec2>() / offsets.len().max(1) as f64;
        let extent = extent_about(middle);
        if extent <= SAME_POINT * reach.max(length_scale) {
            // One point: it has a method of its own, about the origin.
            Self {
                centre: None,
                length: if reach > SHORT * length_scale { reach } else { length_scale },
                cluster: None,
                point: Some(middle),
            }
        } else if extent <= SHORT * length_scale {
            Self { centre: Some(middle), length: length_scale, cluster: Some(extent / length_scale), point: None }
        } else if extent <= CLOSE * middle.norm() {
            Self { centre: Some(middle), length: extent, cluster: None, point: None }
        } else {
            Self { centre: None, length: reach, cluster: None, point: None }
        }
    }
}

/// B'B of one support.
fn slip_gram(offset: &Vec2) -> Mat3 {
    Mat3::new(1.0, 0.0, -offset.y, 0.0, 1.0, offset.x, -offset.y, offset.x, offset.norm_squared())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::friction::{FrictionSolver, Regime};
    use crate::math::{Chance, Stream};
    use crate::model::SupportPoint;

    /// Of wrenches up to 95 % of what slips, which the exact solver tells: forces that balance them to rounding, and leave most of the room that there can be. Half
    /// of it ends the search, of a bound that is itself within a tenth or so.
    #[test]
    fn roomy_forces_balance_a_wrench_and_leave_most_of_the_room_there_is() {
        let mut n_crowded = 0;
        for case in 0..200 {
            let chance = Chance::new(case);
            let draw = |k: u64| 2.0 * chance.uniform(Stream::Start, 0, k) - 1.0;
            let support = |k: u64| SupportPoint {
                offset: 0.01 * Vec2::new(draw(2 * k), draw(2 * k + 1)),
                normal_load: 0.005 * 3f64.powf(draw(60 + k)),
            };
            let ground = Ground { friction_coefficient: 1.4, supports: (0..3 + case % 4).map(support).collect() };
            let cones = Cones::new(&ground, 0.0122);
            let course = Vec3::new(draw(100), draw(101), draw(102));
            let slips = |size: f64| {
                let mut solver = FrictionSolver::new(&ground, 0.0122);
                let drive = Vec3::new(size * course.x, size * course.y, 0.01 * size * course.z);
                solver.solve(&Mat3::from_diagonal(&Vec3::new(3.0, 3.0, 4e-4)), &drive).regime != Regime::Stick
            };
            let (mut rests, mut moves) = (0.0, 10.0);
            for _ in 0..50 {
                let middle = 0.5 * (rests + moves);
                *(if slips(middle) { &mut moves } else { &mut rests }) = middle;
            }
            for share in [0.3, 0.6, 0.9, 0.95] {
                let size = share * rests;
                let w = cones.scaled_gradient(&Vec3::new(size * course.x, size * course.y, 0.01 * size * course.z));
                let mut forces = Vec::new();
                assert!(cones.roomy_forces(&w, &mut forces));
                // Scaled: sums of numbers up to one.
                assert!((cones.wrench(&forces) - w).amax() < 1e-14, "{case} {share}");
                let used =
                    |forces: &[Vec2]| forces.iter().zip(&cones.limits).map(|(force, limit)| force.norm() / limit).fold(0.0, f64::max);
                let room = (1.0 - used(&forces)) / (1.0 - share);
                assert!(room > 0.5 && room < 1.0 + 1e-6, "{case} {share}: {room}");
                let least: Vec<Vec2> = (0..cones.len()).map(|k| cones.least_force(k, &(cones.balance.unwrap() * w))).collect();
                n_crowded += u32::from(used(&least) > 1.0);
            }
        }
        // The least forces alone would not have done.
        assert!(n_crowded > 100, "{n_crowded}");
    }

    /// Wrenches from just beyond what holds to far beyond: the objective at the twist found is at most what it is along the direction that proves the slip, and of what
    /// that misses of the least value the touching parabolas leave, in the median, a tenth at most.
    #[test]
    fn a_slip_is_near_where_parabolas_touch_its_losses() {
        let mut left = Vec::new();
        for case in 0..600 {
            let chance = Chance::new(case);
            let draw = |k: u64| 2.0 * chance.uniform(Stream::Start, 0, k) - 1.0;
            let support = |k: u64| SupportPoint { offset: 0.01 * Vec2::new(draw(2 * k), draw(2 * k + 1)), normal_load: 0.005 };
            let ground = Ground { friction_coefficient: 1.4, supports: (0..3 + case % 3).map(support).collect() };
            let (cones, mut solver) = (Cones::new(&ground, 0.0122), FrictionSolver::new(&ground, 0.0122));
            let hessian = Mat3::from_diagonal(&Vec3::new(3.0, 3.0, 4e-4));
            let size = 0.03 * 10f64.powf(1.0 + draw(103));
            let drive = size * Vec3::new(draw(100), draw(101), 0.01 * draw(102));
            let (h, w) = cones.scaled(&hessian, &drive);
            let Pressed::Slips(n) = cones.pressed_forces(&w, &mut vec![Vec2::zeros(); cones.len()]) else { continue };
            let found = solver.solve(&hessian, &drive);
            let Some(near) = cones.slip_along(&n, &h, &w).filter(|_| found.regime == Regime::Slip) else { continue };
            let objective = |twist: &Vec3| 0.5 * twist.dot(&(h * twist)) - w.dot(twist) + cones.loss(twist);
            let along = (n.dot(&w) - cones.loss(&n)) / n.dot(&(h * n)) * n;
            let [least, there, before] = [cones.scaled_twist(&found.increment), near, along].map(|twist| objective(&twist));
            // Roundings of the terms of the objective at the twist without friction, w^2 / h.
            let rounding = 1e-14 * w.norm_squared() / h.m11.min(h.m33);
            assert!(least <= there + rounding && there <= before + rounding, "{case}: {least} {there} {before}");
            left.push((there - least) / (before - least));
        }
        left.sort_by(f64::total_cmp);
        assert!(left.len() > 200 && left[left.len() / 2] < 0.1, "{} {}", left.len(), left[left.len() / 2]);
    }
}
