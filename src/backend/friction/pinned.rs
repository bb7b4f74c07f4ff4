//! Rotation about one support that sticks, or rest under a moment about it.
//!
//! With p the twist of a unit turn about support k, b = w.p the moment about it and T = sum_{i != k} c_i |S_i - S_k| the friction moment of the
//! others, the turn is `(b - sign(b) T) / (p'Hp)` when |b| > T. When |b| <= T the others hold the moment with the share |b| / T of their friction.
//! Either is the answer when the force that is left for support k is within its limit.

use super::cones::Cones;
use super::{Candidate, Regime};
use crate::math::{Mat3, Vec2, Vec3, perpendicular};

/// The answer about cone `k`, with the cones' forces written; `None`, with the forces as they were, when there is none.
pub(super) fn about(cones: &Cones, k: usize, h: &Mat3, w: &Vec3, forces: &mut [Vec2]) -> Option<Candidate> {
    let pivot = cones.offsets[k];
    let unit_turn = Vec3::new(pivot.y, -pivot.x, 1.0);
    let moment = w.dot(&unit_turn);
    let resistance: f64 = cones.offsets.iter().zip(&cones.limits).map(|(s, c)| c * (s - pivot).norm()).sum();
    let (turn, share) = if moment.abs() > resistance {
        let stiffness = unit_turn.dot(&(h * unit_turn));
        ((moment - moment.signum() * resistance) / stiffness, moment.signum())
    } else {
        (0.0, if resistance > 0.0 { moment / resistance } else { 0.0 })
    };
    let force_at = |i: usize| {
        let arm = cones.offsets[i] - pivot;
        (cones.limits[i] * share / arm.norm()) * perpendicular(&arm)
    };
    let twist = turn * unit_turn;
    let others: Vec2 = (0..cones.len()).filter(|i| *i != k).map(force_at).sum();
    let pin_force = (w - h * twist).xy() - others;
    let fits = pin_force.norm_squared() <= cones.limits[k] * cones.limits[k];
    if !fits || !turn.is_finite() {
        return None;
    }
    for (i, force) in forces.iter_mut().enumerate() {
        *force = if i == k { pin_force } else { force_at(i) };
    }
    let regime = if turn == 0.0 { Regime::Stick } else { Regime::Pinned(k) };
    Some(Candidate { twist, regime })
}
