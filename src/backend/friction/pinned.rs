//! Rotation about one support that sticks, or rest under a moment about it.
//!
//! With p the twist of a unit turn about support k, b = w.p the moment about it and T = sum_{i != k} c_i |S_i - S_k| the friction moment of the
//! others, the turn is `(b - sign(b) T) / (p'Hp)` when |b| > T. When |b| <= T the others hold the moment with the share |b| / T of their friction.
//! Either is the answer when the force that is left for support k is within its limit.
//!
//! A load that goes on turning about the same support has but one unknown, and Newton's method on springs and friction together finds it from a forecast.

use super::cones::Cones;
use super::{Candidate, FrictionSolver, Regime};
use crate::math::{Mat3, Vec2, Vec3, perpendicular};

impl FrictionSolver {
    /// Body twist (m, m, rad) of a unit turn about the support that the load turned about in the last answer, and that support.
    pub fn unit_turn(&self) -> Option<(Vec3, usize)> {
        let cone = self.last.pin?;
        Some((self.cones.unscaled_twist(&unit_turn(&self.cones.offsets[cone])), self.cones.first_support_of(cone)))
    }

    /// Newton's step (rad) from a `turn` (rad) about that support, and what is out of balance there, relative to the forces in it (1); `gradient` and
    /// `hessian` are those of what acts besides friction (N, N, N m; N/m, N, N m/rad). `None` where the energy does not grow with the turn.
    pub fn pivoting_step(&self, turn: f64, gradient: &Vec3, hessian: &Mat3) -> Option<(f64, f64)> {
        let pivot = self.cones.offsets[self.last.pin?];
        let (h, g) = self.cones.scaled(hessian, gradient);
        let unit_turn = unit_turn(&pivot);
        let out_of_balance = g.dot(&unit_turn) + turn.signum() * resistance(&self.cones, &pivot);
        let stiffness = unit_turn.dot(&(h * unit_turn));
        let scale = self.cones.force_scale(&h, &g, &(turn * unit_turn));
        (stiffness > 0.0).then(|| (-out_of_balance / stiffness, out_of_balance.abs() / scale))
    }

    /// Takes a `turn` (rad) about that support, at which this `gradient` (N, N, N m) of the rest is balanced, as the last solution if the support
    /// can bear what is left for it.
    pub fn keep_pivoting(&mut self, turn: f64, gradient: &Vec3) -> bool {
        let Some(k) = self.last.pin else { return false };
        let pulls = -self.cones.scaled_gradient(gradient);
        let fits = write_forces(&self.cones, k, turn.signum(), &pulls.xy(), &mut self.last.forces);
        if fits {
            self.keep(&Candidate { twist: turn * unit_turn(&self.cones.offsets[k]), regime: Regime::Pinned(k) });
        }
        fits
    }
}

fn unit_turn(pivot: &Vec2) -> Vec3 {
    Vec3::new(pivot.y, -pivot.x, 1.0)
}

/// The largest moment about `pivot` that friction at the other supports has.
fn resistance(cones: &Cones, pivot: &Vec2) -> f64 {
    cones.offsets.iter().zip(&cones.limits).map(|(s, c)| c * (s - pivot).norm()).sum()
}

/// Forces of a turn about cone `k` in which the others take this share of their limits, and `k` what is left of `pulls`; no, with the forces as they
/// were, when that is more than its limit.
fn write_forces(cones: &Cones, k: usize, share: f64, pulls: &Vec2, forces: &mut [Vec2]) -> bool {
    let pivot = cones.offsets[k];
    let force_at = |i: usize| {
        let arm = cones.offsets[i] - pivot;
        (cones.limits[i] * share / arm.norm()) * perpendicular(&arm)
    };
    let others: Vec2 = (0..cones.len()).filter(|i| *i != k).map(force_at).sum();
    let pin_force = pulls - others;
    let fits = pin_force.norm_squared() <= cones.limits[k] * cones.limits[k];
    if fits {
        for (i, force) in forces.iter_mut().enumerate() {
            *force = if i == k { pin_force } else { force_at(i) };
        }
    }
    fits
}

/// The answer about cone `k`, with the cones' forces written; `None`, with the forces as they were, when there is none.
pub(super) fn about(cones: &Cones, k: usize, h: &Mat3, w: &Vec3, forces: &mut [Vec2]) -> Option<Candidate> {
    let pivot = cones.offsets[k];
    let unit_turn = unit_turn(&pivot);
    let moment = w.dot(&unit_turn);
    let resistance = resistance(cones, &pivot);
    let (turn, share) = if moment.abs() > resistance {
        let stiffness = unit_turn.dot(&(h * unit_turn));
        ((moment - moment.signum() * resistance) / stiffness, moment.signum())
    } else {
        (0.0, if resistance > 0.0 { moment / resistance } else { 0.0 })
    };
    let twist = turn * unit_turn;
    if !turn.is_finite() || !write_forces(cones, k, share, &(w - h * twist).xy(), forces) {
        return None;
    }
    let regime = if turn == 0.0 { Regime::Stick } else { Regime::Pinned(k) };
    Some(Candidate { twist, regime })
}
