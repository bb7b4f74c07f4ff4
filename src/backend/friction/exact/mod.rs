//! Exact methods for the friction problem in scaled units. The order of the attempts is one of cost
//! only.
//!
//! - One (`single`): all supports stand on one point. This is a problem of its own, solved in
//!   closed form but for one scalar.
//!
//! 0. Gliding (`gliding`): as in the last answer all supports slip, none of them slowly.
//! 1. Rest (`super::rest`): forces within all limits balance w, and nothing moves. Close to the
//!    edge of slipping rest is tried once more after 2, where forces take some rounds to find.
//!    Where that shows that there are none, parabolas that touch the losses of the cones lead to a
//!    slip that gliding completes.
//! 2. Pinned (`pinned`): rotation about one support that sticks. If two distinct ones stick, all
//!    do.
//! 3. Slipping (`slipping`): all supports slip, or stick close to it. Newton's method in
//!    coordinates in which the kink at a slow support is smooth.
//! 4. Smoothed (`smoothed`): continuation over rounded cones, which gives the other methods a start
//!    where they have none.

pub(super) mod gliding;
pub(super) mod pinned;
mod single;
mod slipping;
mod smoothed;
mod start;

use super::cones::Cones;
use super::problem::{Candidate, ContactMode, WarmStart};
use super::rest::Pressed;
use crate::backend::numerics::FEW_SUPPORTS;
use crate::math::{Mat3, Vec3};
use start::{far_answer, linear_answer};

/// Answer for H and w, searched from the `last` one; its forces are written to `last`.
pub fn search(cones: &Cones, h: &Mat3, w: &Vec3, last: &mut WarmStart, n_iterations: &mut u32) -> Candidate {
    if cones.is_empty() {
        return Candidate { twist: linear_answer(h, w), mode: ContactMode::Slip };
    }
    if cones.len() == 1 {
        return single::solve(cones, h, w, &mut last.forces, n_iterations);
    }
    let near = last.twist.filter(|_| last.slipped);
    if let Some((twist, _)) = near.and_then(|near| gliding::slip(cones, h, w, &near, n_iterations)) {
        cones.write_slip_forces(&twist, &mut last.forces);
        return Candidate { twist, mode: ContactMode::Slip };
    }
    let far = cones.cluster.map(|_| far_answer(cones, h, w, n_iterations).0);
    if let Some((twist, _)) = far.and_then(|far| gliding::slip(cones, h, w, &far, n_iterations)) {
        cones.write_slip_forces(&twist, &mut last.forces);
        return Candidate { twist, mode: ContactMode::Slip };
    }
    if cones.stick_forces(w, &mut last.forces) {
        return Candidate { twist: Vec3::zeros(), mode: ContactMode::Stick };
    }
    pin(cones, h, w, last).unwrap_or_else(|| search_near_the_edge(cones, h, w, last, far, n_iterations))
}

/// Answer by a turn about one support. The last pin is tried first. With many supports only that
/// one is tried here, since the continuation finds the others at less cost.
fn pin(cones: &Cones, h: &Mat3, w: &Vec3, last: &mut WarmStart) -> Option<Candidate> {
    let others = if cones.len() <= FEW_SUPPORTS { cones.len() } else { 0 };
    let order = last.pin.into_iter().chain((0..others).filter(|k| Some(*k) != last.pin));
    for k in order {
        let found = pinned::about(cones, k, h, w, &mut last.forces);
        if found.is_some() {
            return found;
        }
    }
    None
}

/// Answer for a load that neither slips fast, nor rests with a margin, nor turns about one support.
fn search_near_the_edge(cones: &Cones, h: &Mat3, w: &Vec3, last: &mut WarmStart, far: Option<Vec3>, n_iterations: &mut u32) -> Candidate {
    let forces = &mut last.forces;
    let near = match cones.pressed_forces(w, forces) {
        Pressed::Rests => return Candidate { twist: Vec3::zeros(), mode: ContactMode::Stick },
        Pressed::Slips(n) => cones.slip_along(&n, h, w).filter(|_| cones.cluster.is_none()),
        Pressed::Unsure => None,
    };
    if let Some((twist, _)) = near.and_then(|near| gliding::slip(cones, h, w, &near, n_iterations)) {
        cones.write_slip_forces(&twist, forces);
        return Candidate { twist, mode: ContactMode::Slip };
    }
    let start = near.or(last.twist).or(far).unwrap_or_else(|| linear_answer(h, w));
    slipping::slip(cones, h, w, &start, forces, n_iterations)
        .or_else(|| slipping::stick(cones, w, &start, forces, n_iterations))
        .unwrap_or_else(|| smoothed::search(cones, h, w, forces, n_iterations))
}
