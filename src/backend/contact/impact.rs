//! Impacts of a load with inertia on obstacles.
//!
//! ```text
//! minimise over v    1/2 |v - v_before|^2_M    with    n.(v - v_o) >= -e n.(v_before - v_o)
//! ```
//!
//! with Coulomb's law for the impulses along the surface. v_o is the velocity of the obstacle at
//! the load, e the coefficient of restitution. The ground's friction is bounded and gives no
//! impulse. With side friction and a restitution near one this law (Newton's, in Moreau's form) may
//! gain energy. Where it would, the impulses of a plastic impact are scaled by 1 + e instead
//! (Poisson's law), which never gains any: the kinetic energy along that line is least at 1 or
//! beyond.

use nalgebra::{DMatrix, DVector};
use smallvec::SmallVec;

use super::displacement::Displacement;
use super::obstacles::{Obstacles, mobility};
use super::solve::{ContactRow, ContactSolution, ContactSystem, Ending, PerContact, SideForce, SideMode, solve_contacts};
use super::surroundings::{Pair, Surroundings};
use super::touching::Touching;
use crate::backend::Motion;
use crate::backend::friction::FrictionSolver;
use crate::backend::springs::Place;
use crate::math::{Mat3, Pose, Twist, Vec2, Vec3};
use crate::model::{Ground, System};

/// A pair of features that the load is about to touch by.
pub type Strike = Pair;

/// Velocity after an impact.
pub struct Reflection {
    pub twist: Twist,
    /// Energy lost (J).
    pub loss: f64,
    /// Work of moving obstacles on the load (J).
    pub of_obstacles: f64,
    /// Obstacle that the load hit, one of them.
    pub obstacle: usize,
}

/// Relative gain of energy that is rounding (1).
const GAINED: f64 = 1e-12;

/// Speed of separation over the largest speed at which a contact counts as closed (1).
const STAYS: f64 = 1e-9;
/// Singular value over the largest one that is rounding (1).
const SINGULAR: f64 = 1e-10;

/// Answer of the impact law, seen by the obstacle that was hit.
struct Hit {
    /// Twist after the impact (m/s, m/s, rad/s; load axes).
    after: Vec3,
    /// Work of the other obstacles (J).
    work: f64,
}

impl Obstacles {
    /// Features that a load passes through between two poses within two times (s), besides the
    /// `known` ones and those that are `kept` closed, and the share of the motion by whose end it
    /// has; `None` for a free one.
    pub fn strikes(
        &mut self,
        system: &System,
        (start, end): (&Place, &Pose),
        times: [f64; 2],
        known: &[Strike],
        kept: &[Touching],
    ) -> Option<(Vec<Strike>, f64)> {
        let twist = increment_between(start, end);
        let keys = || known.iter().map(|strike| &strike.key).chain(kept.iter().map(|touching| &touching.key));
        let is_known = |pair: &Pair, _| keys().any(|key| *key == pair.key);
        self.hits(system, &Displacement { start, twist: &twist, times, kept, has_chords: false }, is_known)
            .map(|(pairs, [_, share])| (pairs, share))
    }

    /// Distance of two features (m), negative for an overlap, and the rate at which it grows (m/s).
    /// Where they lie beside each other, it is at least the distance by which they do, and the rate
    /// is not a number.
    pub fn distance_and_rate(&self, system: &System, pair: &Strike, motion: &Motion, time: f64) -> (f64, f64) {
        let place = Place::of(&motion.pose);
        let at = Surroundings::relative(&place, &system.world.obstacles[pair.key.obstacle].path.pose_at(time));
        let gap = pair.features.gap_with_derivatives(&at, pair.features.gap(&at));
        let beside = self.beside(pair, &at);
        if beside > gap.energy.max(0.0) {
            return (beside, f64::NAN);
        }
        (gap.energy, gap.gradient.dot(&relative_twist(system, pair.key.obstacle, motion, &place, time)))
    }

    /// Velocity of a load that touches by the features `strikes`, and by those that were closed
    /// before. An approach that would rebound at less than `softest` (m/s) does not, nor does a
    /// contact part that slowly.
    pub fn reflect(
        &mut self,
        system: &System,
        touching: &mut Vec<Touching>,
        strikes: &[Strike],
        motion: &Motion,
        (time, softest): (f64, f64),
    ) -> Reflection {
        let place = Place::of(&motion.pose);
        let pairs: Vec<Pair> = self.closed_pairs(system, &place, time, strikes, touching);
        let obstacle = strikes.first().map_or(0, |pair| pair.key.obstacle);
        let mass = Mat3::from_diagonal(&Vec3::new(system.load.mass, system.load.mass, system.load.inertia));
        let before = relative_twist(system, obstacle, motion, &place, time);
        let rows: PerContact<(ContactRow, f64)> =
            pairs.iter().map(|pair| self.row(system, pair, obstacle, motion, &place, (time, softest))).collect();
        let ground = Ground { friction_coefficient: 0.0, supports: Vec::new() };
        let mut solver = FrictionSolver::new(&ground, system.load.radius);
        let mut solved = |restitution: f64| {
            let rows: PerContact<ContactRow> =
                rows.iter().map(|(row, rebound)| ContactRow { gap: row.gap + restitution * rebound, ..*row }).collect();
            let drive = mass * before;
            let answer = solve_contacts(&ContactSystem { hessian: &mass, drive: &drive, rows: &rows }, &mut solver, None);
            (answer.ending == Ending::Converged).then_some(answer)
        };
        let energy = |twist: &Vec3| 0.5 * twist.dot(&(mass * twist));
        let lost = |Hit { after, work }: &Hit| energy(&before) - energy(after) + work;
        let hit = |answer: ContactSolution, scale: f64| {
            let work = scale * self.work_of_others(system, &pairs, &rows, &answer.forces, (motion, &place, time, obstacle));
            Hit { after: before + scale * (answer.increment - before), work }
        };
        let gains = |hit: &Hit| energy(&hit.after) > energy(&before) * (1.0 + GAINED);
        let mut found = solved(1.0).map(|answer| hit(answer, 1.0)).filter(|hit| !gains(hit));
        if found.is_none() {
            let restitution = pairs.iter().map(|pair| pair.restitution).fold(0.0, f64::max);
            found = solved(0.0).map(|plastic| hit(plastic, 1.0 + restitution));
        }
        let mut found = found.unwrap_or(Hit { after: before, work: 0.0 });
        found.after = without_hops(&mass, &rows, found.after, softest);
        *touching = self.closed_after(system, &pairs, &rows, &found.after, &place, time);
        let loss = lost(&found).max(0.0);
        let change = found.after - before;
        let linear = motion.twist.linear + place.turn * change.xy();
        let twist = Twist { linear, angular: motion.twist.angular + change.z };
        let of_obstacles = system.load.kinetic_energy(&twist) - system.load.kinetic_energy(&motion.twist) + loss;
        let is_moved = pairs.iter().any(|pair| system.world.obstacles[pair.key.obstacle].path.moves());
        Reflection { twist, loss, of_obstacles: if is_moved { of_obstacles } else { 0.0 }, obstacle }
    }

    /// Work of the impulses of an impact (J), seen by the obstacle `reference`: each obstacle that
    /// moves relative to it does some.
    fn work_of_others(
        &self,
        system: &System,
        pairs: &[Pair],
        rows: &[(ContactRow, f64)],
        impulses: &[SideForce],
        (motion, place, time, reference): (&Motion, &Place, f64, usize),
    ) -> f64 {
        let twist_to = |obstacle: usize| relative_twist(system, obstacle, motion, place, time);
        let work = |((pair, (row, _)), impulse): ((&Pair, &(ContactRow, f64)), &SideForce)| {
            let on_load = impulse.normal * row.normal + impulse.tangential * row.tangent;
            on_load.dot(&(twist_to(reference) - twist_to(pair.key.obstacle)))
        };
        pairs.iter().zip(rows).zip(impulses).map(work).sum()
    }

    /// The twist along which contacts stay closed at the end of a step from `before` to `time` (s),
    /// and those that stick go on to do so, after the impulses of these contacts that lead there,
    /// with their friction.
    ///
    /// The velocity of a step is the one along its chord, which leaves the obstacle: contacts have
    /// made it by impulses with their friction, and take it back by such.
    pub fn along(&self, system: &System, motion: &Motion, touching: &[Touching], [before, time]: [f64; 2]) -> Twist {
        let place = Place::of(&motion.pose);
        let mut rates: SmallVec<[Rate; 4]> = SmallVec::new();
        for Touching { key, mode, force, .. } in touching.iter().filter(|touching| touching.mode != SideMode::Open) {
            let (features, path) = (self.surroundings.features(key), &system.world.obstacles[key.obstacle].path);
            let obstacle = path.pose_at(time);
            let seen = Surroundings::relative(&place, &obstacle);
            // An obstacle may change its velocity at the end.
            let own = relative_to(&obstacle, &path.twist_after(0.5 * (before + time)), motion, &place);
            let [gap, slip] = [features.gap_with_derivatives(&seen, 0.0), features.slip_with_derivatives(&seen, 0.0)].map(|it| it.gradient);
            let mut stop = |row: Vec3, along: Vec3| rates.push(Rate { row, along, change: -row.dot(&own) });
            if *mode == SideMode::Stick {
                stop(gap, gap);
                stop(slip, slip);
            } else {
                let friction = if force.normal > 0.0 { force.tangential / force.normal } else { 0.0 };
                stop(gap, gap + friction * slip);
            }
        }
        let change = if rates.is_empty() { None } else { change_by_impulses(&mobility(system), &rates) };
        let change = change.unwrap_or_default();
        Twist { linear: motion.twist.linear + place.turn * change.xy(), angular: motion.twist.angular + change.z }
    }

    /// Pairs that are closed at an impact.
    fn closed_pairs(&mut self, system: &System, place: &Place, time: f64, strikes: &[Strike], touching: &[Touching]) -> Vec<Pair> {
        let mut pairs = self.pairs_within(system, place, time, 0.0);
        pairs.retain(|pair| touching.iter().any(|touching| touching.key == pair.key));
        pairs.extend(strikes.iter().filter(|pair| self.is_closed(system, pair, place, time)));
        pairs
    }

    /// Row of a pair for the velocity relative to that of one obstacle, and its rebound, the change
    /// of its gap by restitution.
    fn row(
        &self,
        system: &System,
        pair: &Pair,
        reference: usize,
        motion: &Motion,
        place: &Place,
        (time, softest): (f64, f64),
    ) -> (ContactRow, f64) {
        let obstacle = &system.world.obstacles[pair.key.obstacle];
        let at = Surroundings::relative(place, &obstacle.path.pose_at(time));
        let (gap, slip) = (pair.features.gap_with_derivatives(&at, 0.0), pair.features.slip_with_derivatives(&at, 0.0));
        let own = relative_twist(system, pair.key.obstacle, motion, place, time);
        let seen = relative_twist(system, reference, motion, place, time);
        let approach = gap.gradient.dot(&own);
        let rebounds = approach < 0.0 && -pair.restitution * approach > softest;
        let row = ContactRow {
            normal: gap.gradient,
            tangent: slip.gradient,
            gap: gap.gradient.dot(&(own - seen)),
            slip: slip.gradient.dot(&(own - seen)),
            friction_coefficient: pair.friction_coefficient,
        };
        (row, if rebounds { pair.restitution * approach } else { 0.0 })
    }

    /// Contacts that stay closed at this relative twist.
    fn closed_after(
        &self,
        system: &System,
        pairs: &[Pair],
        rows: &[(ContactRow, f64)],
        after: &Vec3,
        place: &Place,
        time: f64,
    ) -> Vec<Touching> {
        let speed = after.xy().norm() + system.load.radius * after.z.abs();
        let stays = |(_, (row, _)): &(&Pair, &(ContactRow, f64))| row.gap + row.normal.dot(after) <= STAYS * speed;
        let touching = |(pair, (row, _)): (&Pair, &(ContactRow, f64))| {
            let slip = row.slip + row.tangent.dot(after);
            let mode = if slip.abs() <= STAYS * speed { SideMode::Stick } else { SideMode::Slide { forward: slip > 0.0 } };
            let obstacle = system.world.obstacles[pair.key.obstacle].path.pose_at(time);
            let at = Surroundings::relative(place, &obstacle);
            Touching::new(pair, (pair.mode(mode), SideForce::default(), pair.features.slip(&at, 0.0)), &at, &obstacle)
        };
        pairs.iter().zip(rows).filter(stays).map(touching).collect()
    }
}

/// The nearest twist at which all contacts stay closed that would part at no more than `softest`
/// (m/s). A load that is pressed against two obstacles would rock between them infinitely often.
fn without_hops(mass: &Mat3, rows: &[(ContactRow, f64)], after: Vec3, softest: f64) -> Vec3 {
    let parting = |row: &ContactRow, twist: &Vec3| row.gap + row.normal.dot(twist);
    let slow: PerContact<&ContactRow> = rows.iter().map(|(row, _)| row).filter(|row| parting(row, &after) <= softest).collect();
    let rounding = STAYS * softest;
    if slow.iter().all(|row| parting(row, &after).abs() <= rounding) {
        return after;
    }
    let close = |row: &&ContactRow| Rate { row: row.normal, along: row.normal, change: -parting(row, &after) };
    let rates: PerContact<Rate> = slow.iter().map(close).collect();
    let Some(change) = change_by_impulses(&mass.diagonal().map(f64::recip), &rates) else { return after };
    let closed = after + change;
    if rows.iter().all(|(row, _)| parting(row, &closed) >= -rounding) { closed } else { after }
}

/// The rate of a gap or a slip that is to change.
struct Rate {
    /// Its derivative by the twist (1, 1, m; load axes).
    row: Vec3,
    /// Direction of the impulse that changes it (1, 1, m; load axes).
    along: Vec3,
    /// (m/s)
    change: f64,
}

/// Change of a twist by impulses that change these rates, for a load of this mobility:
///
/// ```text
/// C A x with N C A x = changes    N rows, A directions of the impulses x, C mobility
/// ```
///
/// Rates may depend on each other: of all such impulses these are the least. `None` where a
/// single one would not change its rate the way it points.
fn change_by_impulses(mobility: &Vec3, rates: &[Rate]) -> Option<Vec3> {
    if let [Rate { row, along, change }] = rates {
        let moved = along.component_mul(mobility);
        let gain = row.dot(&moved);
        return (gain > 0.0).then(|| *change / gain * moved);
    }
    let rows = DMatrix::from_fn(rates.len(), 3, |k, axis| rates[k].row[axis]);
    let moved = DMatrix::from_fn(3, rates.len(), |axis, k| rates[k].along[axis] * mobility[axis]);
    let wanted = DVector::from_fn(rates.len(), |k, _| rates[k].change);
    let gains = &rows * &moved;
    let cutoff = SINGULAR * gains.amax();
    let change = moved * (gains.pseudo_inverse(cutoff).ok()? * wanted);
    Some(Vec3::new(change[0], change[1], change[2]))
}

/// Twist of the load relative to an obstacle (m/s, m/s, rad/s; load axes).
fn relative_twist(system: &System, obstacle: usize, motion: &Motion, place: &Place, time: f64) -> Vec3 {
    let path = &system.world.obstacles[obstacle].path;
    relative_to(&path.pose_at(time), &path.twist_after(time), motion, place)
}

/// The same for an obstacle at this pose (world) with this twist.
fn relative_to(obstacle: &Pose, twist: &Twist, motion: &Motion, place: &Place) -> Vec3 {
    let arm: Vec2 = motion.pose.position - obstacle.position;
    let linear = place.turn.tr_mul(&(motion.twist.linear - twist.velocity_at(&arm)));
    linear.push(motion.twist.angular - twist.angular)
}

/// Pose `end` seen from `start` as a body-twist increment.
fn increment_between(start: &Place, end: &Pose) -> Vec3 {
    let turn = end.heading - start.pose.heading;
    let along = start.turn.tr_mul(&(end.position - start.pose.position));
    let mean = crate::math::Arc::of(turn).mean_rotation();
    mean.try_inverse().map_or(along, |inverse| inverse * along).push(turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of 2 kg that is hit 0.1 m beside its centre, and parts 0.1 m on the other side. Slower
    /// than the limit, both contacts stay closed: what is left is the motion along them, and it has
    /// less energy.
    #[test]
    fn contacts_that_part_slowly_stay_closed() {
        let mass = Mat3::from_diagonal(&Vec3::new(2.0, 2.0, 0.0217));
        let row = |arm: f64| {
            let [normal, tangent] = [Vec3::new(1.0, 0.0, -arm), Vec3::new(0.0, 1.0, -0.1)];
            (ContactRow { normal, tangent, gap: 0.0, slip: 0.0, friction_coefficient: 0.0 }, 0.0)
        };
        let rows = [row(0.1), row(-0.1)];
        let after = Vec3::new(1.5e-3, 0.2, 1.5e-2);
        let parting = rows.map(|(row, _)| row.normal.dot(&after));
        assert!(parting[0].abs() < 1e-18 && (parting[1] - 3e-3).abs() < 1e-18, "{parting:?}");
        assert_eq!(without_hops(&mass, &rows, after, 2.9e-3), after);
        let closed = without_hops(&mass, &rows, after, 3.1e-3);
        // Half of the last digit of 0.2 is 1.4e-17.
        assert!((closed - Vec3::new(0.0, 0.2, 0.0)).amax() < 1e-16, "{closed}");
        assert!(closed.dot(&(mass * closed)) < after.dot(&(mass * after)));
        // A third contact between them, which depends on both, changes nothing.
        let all = [row(0.1), row(-0.1), row(0.05)];
        assert!((without_hops(&mass, &all, after, 3.1e-3) - closed).amax() < 1e-16);
        // A wall on the other side, which moves as fast as the load, stays closed as well.
        let mut facing = row(0.0);
        (facing.0.normal, facing.0.gap) = (Vec3::new(-1.0, 0.0, 0.0), 1.5e-3);
        let held = without_hops(&mass, &[row(-0.1), facing], after, 3.1e-3);
        assert!((held - Vec3::new(1.5e-3, 0.2, -1.5e-2)).amax() < 1e-16, "{held}");
    }
}
