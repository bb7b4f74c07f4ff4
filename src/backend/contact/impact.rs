//! Impacts of a load with inertia on obstacles: the contacts in an impact, and the velocity that
//! the law (`impact_law`) and the limit of bounces leave.

use nalgebra::{DMatrix, DVector};
use smallvec::SmallVec;

use super::displacement::Displacement;
use super::impact_law::{Rebound, Struck, WITHOUT_FRICTION, rebound, speed};
use super::obstacles::{Obstacles, mobility};
use super::solve::{ContactRow, ContactSystem, PerContact, SideForce, SideMode, solve_contacts};
use super::surroundings::{Pair, PairKey, Surroundings};
use super::touching::Touching;
use crate::backend::friction::FrictionSolver;
use crate::backend::numerics::{CLOSED_SPEED, CREEPING, SINGULAR_GAIN};
use crate::backend::report::{ImpactLaw, Motion};
use crate::backend::springs::Place;
use crate::math::{Mat3, Pose, Twist, Vec2, Vec3, perpendicular};
use crate::model::{Reaction, System};

/// A pair of features that the load is about to touch by.
pub type Strike = Pair;

/// An instant at obstacles: they are where their paths have them then, and have the velocities
/// that they have at another time, of which the paths are straight up to the instant or from it.
#[derive(Clone, Copy, Debug)]
pub struct Instant {
    /// (s)
    pub time: f64,
    /// Time at which obstacles have the same velocity (s). A waypoint that lies at the instant
    /// itself does not say which of its two velocities is meant.
    pub within: f64,
}

/// Speeds that are regarded as none at an impact.
#[derive(Clone, Copy, Debug)]
pub struct SpeedLimits {
    /// An approach that would rebound at less than this does not, nor does a contact part that
    /// slowly (m/s).
    pub softest: f64,
    /// An approach up to this speed comes from the rounding of a gap, and is no impact (m/s).
    pub rounding: f64,
    /// What all forces but those of the obstacles give the load within a step (N s, N s, N m s;
    /// load axes). Contacts that it does not close again part, however slowly: those that a load
    /// leaves behind as it rolls.
    pub momentum: Vec3,
}

/// From the velocity along the path of a load to that along the chord of a step (s), which begins
/// there, or back from that of a step which ends there.
///
/// A step of implicit Euler moves the load along its chord. Where a contact is curved, the chord
/// leaves it by half of what the curvature adds to the rates of its gap and its slip within the
/// step. Along the chords of one step after another, contacts see the whole force that keeps the
/// load on them, and from a velocity along the path only half of that of the curvature: the load
/// would part or stick at any length of the step.
#[derive(Clone, Copy, Debug)]
pub enum Turn {
    ToChord(f64),
    ToPath(f64),
}

/// Velocity after an impact.
pub struct Reflection {
    pub twist: Twist,
    /// Energy lost (J).
    pub loss: f64,
    /// Work of moving obstacles on the load (J).
    pub of_obstacles: f64,
    /// Obstacle that the load hit, one of them.
    pub obstacle: usize,
    /// The law that the velocity follows; `None` for a touch without an approach above rounding.
    pub law: Option<ImpactLaw>,
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
    pub fn distance_and_rate(&self, system: &System, pair: &Strike, motion: &Motion, instant: Instant) -> (f64, f64) {
        let place = Place::of(&motion.pose);
        let at = Surroundings::relative(&place, &system.world.obstacles[pair.key.obstacle].path.pose_at(instant.time));
        let gap = pair.features.gap_with_derivatives(&at, pair.features.gap(&at));
        let beside = self.beside(pair, &at);
        if beside > gap.energy.max(0.0) {
            return (beside, f64::NAN);
        }
        (gap.energy, gap.gradient.dot(&relative_twist(system, pair.key.obstacle, motion, &place, instant)))
    }

    /// Rate at which the slip of a contact grows (m/s).
    pub fn slip_rate(&self, system: &System, key: &PairKey, motion: &Motion, instant: Instant) -> f64 {
        let place = Place::of(&motion.pose);
        let seen = Surroundings::relative(&place, &system.world.obstacles[key.obstacle].path.pose_at(instant.time));
        let slip = self.surroundings.features(key).slip_with_derivatives(&seen, 0.0).gradient;
        slip.dot(&relative_twist(system, key.obstacle, motion, &place, instant))
    }

    /// Velocity of a load that touches by the features `strikes`, and by those that were closed
    /// before.
    pub fn reflect(
        &mut self,
        system: &System,
        touching: &mut Vec<Touching>,
        strikes: &[Strike],
        motion: &Motion,
        (instant, limits): (Instant, SpeedLimits),
    ) -> Reflection {
        let place = Place::of(&motion.pose);
        let pairs: Vec<Pair> = self.closed_pairs(system, &place, instant.time, strikes, touching);
        let reference = strikes.first().or(pairs.first()).map_or(0, |pair| pair.key.obstacle);
        let mass = Mat3::from_diagonal(&Vec3::new(system.load.mass, system.load.mass, system.load.inertia));
        let before = relative_twist(system, reference, motion, &place, instant);
        let struck: PerContact<Struck> =
            pairs.iter().map(|pair| self.struck(system, pair, reference, motion, &place, (instant, limits.softest))).collect();
        let Rebound { after, work, law } = rebound(&mass, system.load.radius, &struck, &before);
        let after = without_hops(&mass, &struck, after, &limits, system.load.radius);
        *touching = self.closed_after(system, &pairs, &struck, &after, &place, instant.time);
        let energy = |twist: &Vec3| 0.5 * twist.dot(&(mass * twist));
        let loss = (energy(&before) - energy(&after) + work).max(0.0);
        let change = after - before;
        let linear = motion.twist.linear + place.turn * change.xy();
        let twist = Twist { linear, angular: motion.twist.angular + change.z };
        let of_obstacles = system.load.kinetic_energy(&twist) - system.load.kinetic_energy(&motion.twist) + loss;
        let is_moved = pairs.iter().any(|pair| system.world.obstacles[pair.key.obstacle].path.moves());
        let hardest = pairs.iter().zip(&struck).map(|(pair, struck)| (pair.key.obstacle, struck.rate(&before)));
        let (obstacle, rate) = hardest.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((reference, 0.0));
        let largest = speed(&before, system.load.radius).max(speed(&in_world(&motion.twist), system.load.radius));
        let is_impact = -rate > limits.rounding.max(CLOSED_SPEED * largest);
        Reflection { twist, loss, of_obstacles: if is_moved { of_obstacles } else { 0.0 }, obstacle, law: is_impact.then_some(law) }
    }

    /// The twist of a load at an instant at which these contacts are closed, turned from its path
    /// to a chord, or back; `None` where it stays. The impulses of the contacts turn it, with their
    /// friction. The slips of the `creeping` contacts are those that a chord could stop, or that
    /// have been stuck. They are found for a chord, and are to be the same on the way back from it.
    pub fn turned(
        &self,
        system: &System,
        motion: &Motion,
        touching: &[Touching],
        (instant, turn): (Instant, Turn),
        creeping: &mut SmallVec<[PairKey; 2]>,
    ) -> Option<Twist> {
        let place = Place::of(&motion.pose);
        let (mut rates, mut slips): (SmallVec<[Rate; 4]>, SmallVec<[Rate; 2]>) = (SmallVec::new(), SmallVec::new());
        let (step, is_back) = match turn {
            Turn::ToChord(step) => (step, false),
            Turn::ToPath(step) => (step, true),
        };
        for Touching { key, mode, force, .. } in touching {
            let (pair, path) = (self.surroundings.pair(system, *key), &system.world.obstacles[key.obstacle].path);
            let obstacle = path.pose_at(instant.time);
            let seen = Surroundings::relative(&place, &obstacle);
            let own = relative_twist(system, key.obstacle, motion, &place, instant);
            let drift = drift_of(&place, motion, (&obstacle, &path.twist_after(instant.within)));
            // Half of what the curvature adds to a rate within the step.
            let bent = |it: &Reaction| 0.5 * step * (own.dot(&(it.hessian * own)) + it.gradient.xy().dot(&drift));
            let kept = |it: &Reaction| if is_back { 0.0 } else { bent(it) } - it.gradient.dot(&own);
            let passed = |it: &Reaction| if is_back { -bent(it) } else { bent(it) };
            let rate = |it: &Reaction, along: Vec3, change: f64| Rate { row: it.gradient, along, change };
            let gap = pair.features.gap_with_derivatives(&seen, 0.0);
            let slip = pair.features.slip_with_derivatives(&seen, 0.0);
            match mode {
                SideMode::Stick => {
                    rates.extend([&gap, &slip].map(|it| rate(it, it.gradient, kept(it))));
                    creeping.extend((!is_back).then_some(*key));
                }
                SideMode::Slide { forward } => {
                    let sign = if *forward { -1.0 } else { 1.0 };
                    let friction = if force.normal > 0.0 { force.tangential / force.normal } else { sign * pair.friction_coefficient };
                    let along = gap.gradient + friction * slip.gradient;
                    rates.push(rate(&gap, along, kept(&gap)));
                    let by_friction = || {
                        let moved = along.component_mul(&mobility(system));
                        kept(&gap) * slip.gradient.dot(&moved) / gap.gradient.dot(&moved)
                    };
                    if !is_back && slip.gradient.dot(&own).abs() <= CREEPING * (bent(&slip).abs() + by_friction().abs()) {
                        creeping.push(*key);
                    }
                    slips.extend(creeping.contains(key).then(|| rate(&slip, slip.gradient, passed(&slip))));
                }
                // One that the load has left by its end is taken over by another.
                SideMode::Open if self.beside(&pair, &seen) > 0.0 => (),
                SideMode::Open => rates.push(rate(&gap, gap.gradient, passed(&gap))),
            }
        }
        // A twist has three parts, and closed gaps come first.
        slips.truncate(3usize.saturating_sub(rates.len()));
        rates.extend(slips);
        let none = CLOSED_SPEED * CLOSED_SPEED * speed(&in_world(&motion.twist), system.load.radius);
        let change = if rates.iter().all(|rate| rate.change.abs() <= none) { None } else { change_by_impulses(&mobility(system), &rates) }?;
        Some(Twist { linear: motion.twist.linear + place.turn * change.xy(), angular: motion.twist.angular + change.z })
    }

    /// Pairs that are closed at an impact.
    fn closed_pairs(&mut self, system: &System, place: &Place, time: f64, strikes: &[Strike], touching: &[Touching]) -> Vec<Pair> {
        let mut pairs = self.pairs_within(system, place, time, 0.0);
        pairs.retain(|pair| touching.iter().any(|touching| touching.key == pair.key));
        pairs.extend(strikes.iter().filter(|pair| self.is_closed(system, pair, place, time)));
        pairs
    }

    /// A pair in an impact, for velocities relative to that of one obstacle.
    fn struck(
        &self,
        system: &System,
        pair: &Pair,
        reference: usize,
        motion: &Motion,
        place: &Place,
        (instant, softest): (Instant, f64),
    ) -> Struck {
        let obstacle = &system.world.obstacles[pair.key.obstacle];
        let at = Surroundings::relative(place, &obstacle.path.pose_at(instant.time));
        let (gap, slip) = (pair.features.gap_with_derivatives(&at, 0.0), pair.features.slip_with_derivatives(&at, 0.0));
        let own = relative_twist(system, pair.key.obstacle, motion, place, instant);
        let seen = relative_twist(system, reference, motion, place, instant);
        let rebounds = -pair.restitution * gap.gradient.dot(&own) > softest;
        let row = ContactRow {
            normal: gap.gradient,
            tangent: slip.gradient,
            gap: gap.gradient.dot(&(own - seen)),
            slip: slip.gradient.dot(&(own - seen)),
            friction_coefficient: pair.friction_coefficient,
        };
        Struck { row, restitution: if rebounds { pair.restitution } else { 0.0 } }
    }

    /// Contacts that stay closed at this relative twist.
    fn closed_after(&self, system: &System, pairs: &[Pair], struck: &[Struck], after: &Vec3, place: &Place, time: f64) -> Vec<Touching> {
        let speed = speed(after, system.load.radius);
        let stays = |(_, struck): &(&Pair, &Struck)| struck.rate(after) <= CLOSED_SPEED * speed;
        let touching = |(pair, Struck { row, .. }): (&Pair, &Struck)| {
            let slip = row.slip + row.tangent.dot(after);
            let mode = if slip.abs() <= CLOSED_SPEED * speed { SideMode::Stick } else { SideMode::Slide { forward: slip > 0.0 } };
            let obstacle = system.world.obstacles[pair.key.obstacle].path.pose_at(time);
            let at = Surroundings::relative(place, &obstacle);
            Touching::new(pair, (pair.mode(mode), SideForce::default(), pair.features.slip(&at, 0.0)), &at, &obstacle)
        };
        pairs.iter().zip(struck).filter(stays).map(touching).collect()
    }
}

/// The nearest twist at which all contacts stay closed that would part at no more than the softest
/// speed, and close again within the step. A load that is pressed against two obstacles would rock
/// between them infinitely often.
fn without_hops(mass: &Mat3, struck: &[Struck], after: Vec3, limits: &SpeedLimits, radius: f64) -> Vec3 {
    let slow: PerContact<&Struck> = struck.iter().filter(|struck| struck.rate(&after) <= limits.softest).collect();
    let rounding = CLOSED_SPEED * limits.softest;
    if slow.iter().all(|struck| struck.rate(&after).abs() <= rounding) {
        return after;
    }
    let rows: PerContact<ContactRow> = slow.iter().map(|struck| ContactRow { friction_coefficient: 0.0, ..struck.row }).collect();
    let system = ContactSystem { hessian: mass, drive: &(mass * after + limits.momentum), rows: &rows };
    let at_end = solve_contacts(&system, &mut FrictionSolver::new(&WITHOUT_FRICTION, radius), None);
    let closes = |(struck, force): &(&Struck, &SideForce)| force.normal > 0.0 || struck.rate(&after).abs() <= rounding;
    let slow: PerContact<&Struck> = slow.into_iter().zip(&at_end.forces).filter(closes).map(|(struck, _)| struck).collect();
    let close = |struck: &&Struck| Rate { row: struck.row.normal, along: struck.row.normal, change: -struck.rate(&after) };
    let rates: PerContact<Rate> = slow.iter().map(close).collect();
    let change = if rates.is_empty() { None } else { change_by_impulses(&mass.diagonal().map(f64::recip), &rates) };
    let Some(change) = change else { return after };
    let closed = after + change;
    if struck.iter().all(|struck| struck.rate(&closed) >= -rounding) { closed } else { after }
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
    let cutoff = SINGULAR_GAIN * gains.amax();
    let change = moved * (gains.pseudo_inverse(cutoff).ok()? * wanted);
    Some(Vec3::new(change[0], change[1], change[2]))
}

/// Acceleration of a load that coasts, seen by an obstacle that turns as it moves (m/s^2; load
/// axes): `-2 w x v - w x (w x r)`, Coriolis's and the centrifugal one.
fn drift_of(place: &Place, motion: &Motion, (obstacle, twist): (&Pose, &Twist)) -> Vec2 {
    let arm: Vec2 = motion.pose.position - obstacle.position;
    let relative = motion.twist.linear - twist.velocity_at(&arm);
    place.turn.tr_mul(&(twist.angular * (twist.angular * arm - 2.0 * perpendicular(&relative))))
}

/// Twist of the load relative to an obstacle (m/s, m/s, rad/s; load axes).
fn relative_twist(system: &System, obstacle: usize, motion: &Motion, place: &Place, instant: Instant) -> Vec3 {
    let path = &system.world.obstacles[obstacle].path;
    let (obstacle, twist) = (path.pose_at(instant.time), path.twist_after(instant.within));
    let arm: Vec2 = motion.pose.position - obstacle.position;
    let linear = place.turn.tr_mul(&(motion.twist.linear - twist.velocity_at(&arm)));
    linear.push(motion.twist.angular - twist.angular)
}

fn in_world(twist: &Twist) -> Vec3 {
    twist.linear.push(twist.angular)
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
    /// than the limit, and pressed against the wall, both contacts stay closed: what is left is the
    /// motion along them, and it has less energy. Without a pressure it parts.
    #[test]
    fn contacts_that_part_slowly_stay_closed() {
        let mass = Mat3::from_diagonal(&Vec3::new(2.0, 2.0, 0.0217));
        let row = |arm: f64| {
            let [normal, tangent] = [Vec3::new(1.0, 0.0, -arm), Vec3::new(0.0, 1.0, -0.1)];
            Struck { row: ContactRow { normal, tangent, gap: 0.0, slip: 0.0, friction_coefficient: 0.0 }, restitution: 0.0 }
        };
        let hops = |rows: &[Struck], after: Vec3, softest: f64, pressure: f64| {
            let limits = SpeedLimits { softest, rounding: 0.0, momentum: Vec3::new(-pressure, 0.0, 0.0) };
            without_hops(&mass, rows, after, &limits, 0.1)
        };
        let rows = [row(0.1), row(-0.1)];
        let after = Vec3::new(1.5e-3, 0.2, 1.5e-2);
        let parting = rows.map(|struck| struck.rate(&after));
        assert!(parting[0].abs() < 1e-18 && (parting[1] - 3e-3).abs() < 1e-18, "{parting:?}");
        assert_eq!(hops(&rows, after, 2.9e-3, 0.1), after);
        assert_eq!(hops(&rows, after, 3.1e-3, 0.0), after);
        let closed = hops(&rows, after, 3.1e-3, 0.1);
        // Half of the last digit of 0.2 is 1.4e-17.
        assert!((closed - Vec3::new(0.0, 0.2, 0.0)).amax() < 1e-16, "{closed}");
        assert!(closed.dot(&(mass * closed)) < after.dot(&(mass * after)));
        // A third contact between them, which depends on both, changes nothing.
        let all = [row(0.1), row(-0.1), row(0.05)];
        assert!((hops(&all, after, 3.1e-3, 0.1) - closed).amax() < 1e-16);
        // A wall on the other side, which moves as fast as the load, stays closed as well.
        let mut facing = row(0.0);
        (facing.row.normal, facing.row.gap) = (Vec3::new(-1.0, 0.0, 0.0), 1.5e-3);
        let held = hops(&[row(-0.1), facing], after, 3.1e-3, 0.1);
        assert!((held - Vec3::new(1.5e-3, 0.2, -1.5e-2)).amax() < 1e-16, "{held}");
    }
}
