//! Friction forces of a load at rest: forces within all limits that balance a wrench.

use smallvec::SmallVec;

use super::cones::{Cones, slip_gram};
use crate::backend::numerics::{
    ENOUGH_ROOM, LEAST_ROOM_SOUGHT, LEAST_WEIGHT, MOST_WEIGHTINGS, MOVED_BACK_TO, N_PARABOLAS, OVER_RELAXATION, REST_MARGIN, REST_ROUNDS,
};
use crate::math::{Mat3, PositiveDefinite, Vec2, Vec3};

/// Outcome of the search for forces at rest close to the edge of slipping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::backend) enum Pressed {
    /// Forces were found: the load rests.
    Rests,
    /// No forces exist, as this twist proves.
    Slips(Vec3),
    /// The search ended without an answer.
    Unsure,
}

/// Moves a force beyond its limit back, to a little within it, with over-relaxation.
pub fn move_back_within(force: &mut Vec2, limit: f64) {
    let (size, within) = (force.norm(), MOVED_BACK_TO * limit);
    if size > within {
        *force *= 1.0 + OVER_RELAXATION * (within / size - 1.0);
    }
}

impl Cones {
    /// Balance matrix times a wrench; `None` where there is no such matrix.
    pub fn balanced(&self, wrench: &Vec3) -> Option<Vec3> {
        self.balance.map(|balance| balance * wrench)
    }

    /// Writes forces that balance w and leave room to all limits, if any do; returns `false` where
    /// nothing is known. From the least-norm forces on, those near their limits are given more and
    /// more weight (Lawson 1961), which leads to the forces whose largest share of a limit is
    /// least. The twist n that belongs to them bounds that share from below: nothing balances w
    /// with less than `n'w / sum_i c_i |B_i n|`.
    pub fn forces_with_margin(&self, w: &Vec3, forces: &mut Vec<Vec2>) -> bool {
        forces.clear();
        let Some(balance) = &self.balance else { return false };
        forces.resize(self.len(), Vec2::zeros());
        let [mut weights, mut shares]: [SmallVec<[f64; 8]>; 2] = [1.0, 0.0].map(|value| SmallVec::from_elem(value, self.len()));
        let (mut twist, mut best) = (balance * w, f64::INFINITY);
        for _ in 0..MOST_WEIGHTINGS {
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
            let is_worth_more = 1.0 - least > LEAST_ROOM_SOUGHT && 1.0 - best < ENOUGH_ROOM * (1.0 - least);
            if !is_worth_more {
                break;
            }
            let mut gram = Mat3::zeros();
            for (k, weight) in weights.iter_mut().enumerate() {
                // A common factor of all weights has no effect.
                *weight = (*weight * shares[k] / largest).max(LEAST_WEIGHT);
                gram += self.limits[k] * self.limits[k] / *weight * slip_gram(&self.offsets[k]);
            }
            let Some(factor) = PositiveDefinite::new(&gram) else { break };
            twist = factor.solve(w);
        }
        // Balance again what rounding has left.
        let change = balance * (w - self.wrench(forces));
        forces.iter_mut().enumerate().for_each(|(k, force)| *force += self.least_force(k, &change));
        true
    }

    /// Whether these forces stay within all limits when two more are added: the least-norm forces
    /// for a wrench, of which `balanced` is the balance matrix times the wrench, and those for any
    /// wrench of the norm `further`.
    pub fn are_within_limits(&self, forces: &[Vec2], balanced: &Vec3, further: f64) -> bool {
        let is_within = |k: usize| {
            let room = (1.0 - REST_MARGIN) * self.limits[k] - self.sways[k] * further;
            room >= 0.0 && (forces[k] + self.least_force(k, balanced)).norm_squared() <= room * room
        };
        (0..self.len()).all(is_within)
    }

    /// Whether forces within all limits balance w. They are found from the given forces by the
    /// least change in units of the limits, or else as the least-norm forces. The answer `false`
    /// proves nothing, and leaves the forces as they were.
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

    /// Searches forces that balance w, for a load close to the edge of slipping. Forces that the
    /// least change takes beyond their limits are moved back to a little within, and what that
    /// leaves out of balance is balanced again, over and over. The change is along the slip of some
    /// twist n; a twist with `n'w > sum_i c_i |B_i n|` proves that the load slips.
    pub fn pressed_forces(&self, w: &Vec3, forces: &mut [Vec2]) -> Pressed {
        let Some(balance) = &self.balance else { return Pressed::Unsure };
        let mut trial: SmallVec<[Vec2; 8]> = SmallVec::from_slice(forces);
        for round in 0..REST_ROUNDS {
            let change = balance * (w - self.wrench(&trial));
            if round % 4 == 3 && change.dot(w) > self.loss(&change) {
                return Pressed::Slips(change);
            }
            trial.iter_mut().enumerate().for_each(|(k, force)| *force += self.least_force(k, &change));
            if self.fit(|k| trial[k]) {
                forces.copy_from_slice(&trial);
                return Pressed::Rests;
            }
            trial.iter_mut().zip(&self.limits).for_each(|(force, limit)| move_back_within(force, *limit));
        }
        Pressed::Unsure
    }

    /// Loss of friction by the twist n, `sum_i c_i |B_i n|` (scaled).
    pub fn loss(&self, n: &Vec3) -> f64 {
        (0..self.len()).map(|k| self.limits[k] * self.slip(k, n).norm()).sum()
    }

    /// A twist near the slip that balances w, from a direction `n` with `n'w > sum_i c_i |B_i n|`.
    /// Along `n` the objective is least at a twist x. The parabolas that touch the cones' losses
    /// there, `c_i |B_i x|^2 / 2 |B_i x|`, are together least at another twist, where the objective
    /// is less than at x, and so on (Weiszfeld 1937). `None` where that does not end in a slip of
    /// all cones.
    pub fn slip_along(&self, n: &Vec3, h: &Mat3, w: &Vec3) -> Option<Vec3> {
        let mut twist = (n.dot(w) - self.loss(n)) / n.dot(&(h * n)) * n;
        for _ in 0..N_PARABOLAS {
            let mut sum = *h;
            for (k, offset) in self.offsets.iter().enumerate() {
                sum += self.limits[k] / self.slip(k, &twist).norm() * slip_gram(offset);
            }
            twist = PositiveDefinite::new(&sum)?.solve(w);
        }
        twist.iter().all(|v| v.is_finite()).then_some(twist)
    }

    /// Least-norm force on cone k for a wrench, of which `balanced` is the balance matrix times the
    /// wrench.
    pub fn least_force(&self, k: usize, balanced: &Vec3) -> Vec2 {
        self.limits[k] * self.limits[k] * self.slip(k, balanced)
    }

    fn fit(&self, force: impl Fn(usize) -> Vec2) -> bool {
        (0..self.len()).all(|k| force(k).norm_squared() <= self.limits[k] * self.limits[k])
    }
}
