//! Friction with the ground in a step with contacts: the exact friction problem with the contacts
//! in it.
//!
//! The direction of ground friction follows from the motion of the load, which obstacles limit.
//! Without them in the problem, friction would point away from a wall that the load is pressed on.
//! The engine finds the contact forces only after the axes of friction are set, and those of the
//! last step belong to another motion; so the problem gets the contacts of this step, with the laws
//! that the engine has for them: each keeps its room, and has Coulomb friction.
//!
//! Only directions and limits of ground friction are taken from the answer, and the contact forces
//! under a load at rest. The engine finds the motion and all other contact forces on its own.

use super::contacts::ContactPoint;
use super::springs::seen_from;
use super::walls;
use crate::backend::contact::{
    ContactRow, ContactSolution, ContactSystem, Ending, PerContact, SideForce, SideMode, go_on_resting, solve_contacts,
};
use crate::backend::friction::{ContactMode, FrictionSolution, FrictionSolver};
use crate::backend::numerics::{CONTACT_STIFFNESS, ENGINE_UNCHANGED, FEW_CONTACTS, MOST_EXCHANGES, YIELDING};
use crate::math::{Mat3, Vec2, Vec3};
use crate::model::support::wrench_of;

/// Friction problem with the linear part `hessian`, `drive`, in load axes.
pub struct Problem<'a> {
    pub hessian: &'a Mat3,
    pub drive: &'a Vec3,
    /// Unit vector of the load's x axis.
    pub facing: &'a Vec2,
    /// Duration of the step (s).
    pub duration: f64,
    /// Rounding of the gaps (m).
    pub rounding: f64,
}

/// Solves the friction problem of a step with `contacts`, and writes their forces to `forces`
/// (normal and tangent, N). There, `forces` holds those of the last step if the load was at rest.
pub fn solve(solver: &mut FrictionSolver, problem: &Problem, contacts: &[ContactPoint], forces: &mut Vec<[f64; 2]>) -> FrictionSolution {
    let rows: Vec<ContactRow> = contacts.iter().map(|contact| row(contact, problem)).collect();
    let that_matter = walls::that_matter(&rows, problem.rounding);
    let last = last_forces(forces, rows.len(), &that_matter).filter(|_| solver.was_at_rest());
    forces.clear();
    forces.resize(rows.len(), [0.0; 2]);
    let rows: PerContact<ContactRow> = that_matter.iter().map(|k| rows[*k]).collect();
    let system = ContactSystem { hessian: problem.hessian, drive: problem.drive, rows: &rows };
    let goes_on = last.and_then(|last| rest(&system, solver, &last));
    let found = goes_on.unwrap_or_else(|| {
        let found = search(&system, solver, problem.rounding);
        stopped(&system, solver, found)
    });
    for (k, force) in that_matter.into_iter().zip(&found.forces) {
        forces[k] = [force.normal, force.tangential];
    }
    found.ground
}

/// The answer `found`, with other forces if the load has just stopped. They are not unique: those
/// of stiff contacts are taken, where these satisfy Coulomb's law. The ground then bears as much as
/// it can, as under the load that still moved, and the obstacles the rest.
fn stopped(system: &ContactSystem, solver: &mut FrictionSolver, found: Found) -> Found {
    let is_pushed = found.forces.iter().any(|force| force.normal > 0.0);
    if found.ground.mode != ContactMode::Stick || !is_pushed || system.rows.iter().any(|row| row.slip != 0.0) {
        return found;
    }
    let Some(flexibility) = system.hessian.try_inverse() else { return found };
    let stiffness = |row: &Vec3| CONTACT_STIFFNESS / row.dot(&(flexibility * row));
    let closed = || system.rows.iter().zip(&found.forces).filter(|(_, force)| force.normal > 0.0).map(|(row, _)| row);
    let mut hessian = *system.hessian;
    for row in closed() {
        hessian += stiffness(&row.normal) * row.normal * row.normal.transpose();
        if row.friction_coefficient > 0.0 {
            hessian += stiffness(&row.tangent) * row.tangent * row.tangent.transpose();
        }
    }
    let before = solver.warm_start().clone();
    let increment = solver.solve(&hessian, system.drive).increment;
    let force = |(row, last): (&ContactRow, &SideForce)| {
        let along = |row: &Vec3| -stiffness(row) * row.dot(&increment);
        let is_rough = row.friction_coefficient > 0.0;
        let borne = SideForce { normal: along(&row.normal), tangential: if is_rough { along(&row.tangent) } else { 0.0 } };
        if last.normal > 0.0 { borne } else { SideForce::default() }
    };
    let forces: PerContact<SideForce> = system.rows.iter().zip(&found.forces).map(force).collect();
    let keeps_law = |(row, f): (&ContactRow, &SideForce)| f.normal >= 0.0 && f.tangential.abs() <= row.friction_coefficient * f.normal;
    let residual = solver.hold(&-(system.drive + wrench(system.rows, &forces)), YIELDING);
    match residual.filter(|_| system.rows.iter().zip(&forces).all(keeps_law)) {
        Some(residual) => Found { ground: FrictionSolution { residual, ..found.ground }, forces },
        None => {
            solver.set_warm_start(before).expect("the answer is one of this solver");
            found
        }
    }
}

/// Wrench of the obstacles on the load.
fn wrench(rows: &[ContactRow], forces: &[SideForce]) -> Vec3 {
    rows.iter().zip(forces).map(|(row, force)| force.normal * row.normal + force.tangential * row.tangent).sum()
}

/// Answer of all contacts at once, or else of few of them after another.
fn search(system: &ContactSystem, solver: &mut FrictionSolver, rounding: f64) -> Found {
    let whole = solve_contacts(system, solver, None);
    if whole.ending != Ending::NotConverged || system.rows.len() <= FEW_CONTACTS {
        return Found::from(whole);
    }
    let forces = solver.warm_start().clone();
    by_few(system, solver, rounding).unwrap_or_else(|| {
        solver.set_warm_start(forces).expect("the answer is one of this solver");
        Found::from(whole)
    })
}

/// Answer for a few contacts that keeps all others open, and so is one for all of them. A contact
/// that the answer closes too far comes in, the worst one first; those without a force go out.
fn by_few(system: &ContactSystem, solver: &mut FrictionSolver, rounding: f64) -> Option<Found> {
    let mut few: PerContact<usize> = PerContact::new();
    for _ in 0..MOST_EXCHANGES {
        let rows: PerContact<ContactRow> = few.iter().map(|k| system.rows[*k]).collect();
        let solution = solve_contacts(&ContactSystem { rows: &rows, ..*system }, solver, None);
        if solution.ending != Ending::Converged {
            return None;
        }
        let gap = |k: usize| system.rows[k].gap + system.rows[k].normal.dot(&solution.increment);
        let others = (0..system.rows.len()).filter(|k| !few.contains(k));
        let closest = others.map(|k| (gap(k), k)).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, next)) = closest.filter(|(gap, _)| *gap < -rounding) else {
            let mut forces = PerContact::from_elem(SideForce::default(), system.rows.len());
            few.iter().zip(&solution.forces).for_each(|(k, force)| forces[*k] = *force);
            return Some(Found { forces, ..Found::from(solution) });
        };
        if few.len() == FEW_CONTACTS {
            few = few.into_iter().zip(&solution.forces).filter(|(_, force)| force.normal > 0.0).map(|(k, _)| k).collect();
        }
        few.push(next);
    }
    None
}

/// Answer to the friction problem of a step with contacts.
struct Found {
    ground: FrictionSolution,
    forces: PerContact<SideForce>,
}

impl From<ContactSolution> for Found {
    fn from(solution: ContactSolution) -> Self {
        let ContactSolution { increment, ground_mode: mode, n_iterations, forces, .. } = solution;
        // Gaps that contradict each other have no finite residual.
        Self { ground: FrictionSolution { increment, mode, residual: solution.residual.min(1.0), n_iterations }, forces }
    }
}

/// Forces of the last step at the contacts `that_matter` of `n`; `None` where others had a force.
fn last_forces(forces: &[[f64; 2]], n: usize, that_matter: &[usize]) -> Option<PerContact<SideForce>> {
    let is_lost = |k: usize| forces[k] != [0.0; 2] && !that_matter.contains(&k);
    if forces.len() != n || (0..n).any(is_lost) {
        return None;
    }
    Some(that_matter.iter().map(|k| SideForce { normal: forces[*k][0], tangential: forces[*k][1] }).collect())
}

/// Rest under forces near the `last` ones, of a load that rested under these and cannot slide.
/// Against an obstacle that slides by, friction is that of its slip: there a load rests where the
/// last forces balance it.
fn rest(system: &ContactSystem, solver: &mut FrictionSolver, last: &[SideForce]) -> Option<Found> {
    let pairs = || system.rows.iter().zip(last);
    if pairs().all(|(row, _)| row.slip == 0.0) {
        let mode = |force: &SideForce| if force.normal > 0.0 { SideMode::Stick } else { SideMode::Open };
        let modes: PerContact<SideMode> = last.iter().map(mode).collect();
        return go_on_resting(system, solver, &modes, last).map(Found::from);
    }
    if pairs().any(|(row, force)| row.gap < 0.0 || force.normal > 0.0 && row.gap > 0.0) {
        return None;
    }
    let slid_by = |(row, force): (&ContactRow, &SideForce)| SideForce {
        tangential: if row.slip == 0.0 { force.tangential } else { -(row.friction_coefficient * force.normal).copysign(row.slip) },
        ..*force
    };
    let forces: PerContact<SideForce> = pairs().map(slid_by).collect();
    let residual = solver.hold(&-(system.drive + wrench(system.rows, &forces)), ENGINE_UNCHANGED)?;
    Some(Found { ground: FrictionSolution { increment: Vec3::zeros(), mode: ContactMode::Stick, residual, n_iterations: 0 }, forces })
}

/// A contact as a row of the problem. What the obstacle moves in the step is part of its gap and of
/// its slip.
fn row(contact: &ContactPoint, problem: &Problem) -> ContactRow {
    let seen = |direction: &Vec2| {
        let wrench = wrench_of(&contact.arm, direction);
        seen_from(problem.facing, &wrench.xy()).push(wrench.z)
    };
    let shift = problem.duration * contact.velocity;
    let tangent = contact.tangent();
    let gap = contact.room - shift.dot(&contact.normal);
    ContactRow {
        normal: seen(&contact.normal),
        tangent: seen(&tangent),
        gap: if gap.abs() <= problem.rounding { 0.0 } else { gap },
        slip: -shift.dot(&tangent),
        friction_coefficient: contact.friction,
    }
}
