//! Rotation about one support that sticks, or rest under a moment about it.
//!
//! With p the twist of a unit turn about support k, b = w.p the moment about it and T = sum_{i !=
//! k} c_i |S_i - S_k| the friction moment of the others, the turn is `(b - sign(b) T) / (p'Hp)`
//! when |b| > T. When |b| <= T the others balance the moment with the share
//! |b| / T of their friction. Either is the answer when the force that is left for support k is
//! within its limit.

use crate::backend::friction::cones::Cones;
use crate::backend::friction::problem::{Candidate, ContactMode};
use crate::math::{Mat3, Vec2, Vec3, perpendicular};

/// Twist of a unit turn about `pivot`.
pub fn unit_turn(pivot: &Vec2) -> Vec3 {
    Vec3::new(pivot.y, -pivot.x, 1.0)
}

/// Largest moment about `pivot` that the friction of the other supports can have.
pub fn resistance(cones: &Cones, pivot: &Vec2) -> f64 {
    cones.offsets.iter().zip(&cones.limits).map(|(s, c)| c * (s - pivot).norm()).sum()
}

/// Writes the forces of a turn about cone `k`: the others take this share of their limits, and `k`
/// takes what is left of `pulls`. Returns `false`, with the forces as they were, when that is more
/// than the limit of `k`.
pub fn write_forces(cones: &Cones, k: usize, share: f64, pulls: &Vec2, forces: &mut [Vec2]) -> bool {
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

/// Answer by a turn about cone `k`; writes the forces of the cones. `None`, with the forces as they
/// were, when there is no such answer.
pub fn about(cones: &Cones, k: usize, h: &Mat3, w: &Vec3, forces: &mut [Vec2]) -> Option<Candidate> {
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
    let mode = if turn == 0.0 { ContactMode::Stick } else { ContactMode::Pinned(k) };
    Some(Candidate { twist, mode })
}
