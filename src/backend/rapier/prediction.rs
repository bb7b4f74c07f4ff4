//! Friction with the ground in a step with contacts: the friction problem with obstacles as stiff
//! springs.
//!
//! The direction of ground friction follows from the motion of the load, which obstacles limit.
//! Without them in the problem, friction would point away from a wall that the load is pressed on.
//! The engine finds the contact forces only after the axes of friction are set, and those of the
//! last step belong to another motion; so the problem gets contacts of its own. A closed contact is
//! a spring along its normal, [`STIFFNESS`] times stiffer than the load. Its friction is a spring
//! along the tangent, or mu times the last normal force once the load slides. Which contacts are
//! closed and which slide is found by iteration.
//!
//! Only directions and limits of ground friction are taken from the answer. The engine finds the
//! motion and the contact forces on its own. An exact solver of the step with contacts can take the
//! place of [`solve`].

use super::contacts::ContactPoint;
use super::springs::seen_from;
use crate::backend::friction::{ContactMode, FrictionSolution, FrictionSolver};
use crate::math::{Mat3, Vec2, Vec3};
use crate::model::support::wrench_of;

/// Stiffness of a contact over that of the load in its direction (1). It leaves a penetration of
/// p h^2 / m times 1e-8, and eight digits of the forces.
const STIFFNESS: f64 = 1e8;

/// Displacement over that of the contact springs below which the load is at rest (1). A contact
/// spring yields where a load against a rigid wall would not move. The friction that this calls
/// up against the wall leaves the load short of its slip limit by a thousandth at most.
const REST: f64 = 30.0;

/// Most passes over the contacts for given limits of side friction. A few are enough; where passes
/// go round in circles, the last one is as good as any other.
const N_PASSES: usize = 20;

/// Most changes of the limits of side friction.
const N_LIMITS: usize = 40;

/// Difference of a limit of side friction from mu times the normal force, over all normal forces,
/// below which the limits stay (1).
const SETTLED: f64 = 1e-9;

/// A contact in the friction problem.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Wrench of a unit force along the normal and along the tangent (load axes).
    normal: Vec3,
    tangent: Vec3,
    /// Distance by which the contact may close, and slip, under a load that does not move (m).
    gap: f64,
    slip: f64,
    friction: f64,
    /// Stiffness along normal and tangent (N/m).
    stiffness: [f64; 2],
    /// Whether the contact pushes.
    is_closed: bool,
    side: Side,
    /// Largest friction force (N).
    limit: f64,
    push: f64,
    rub: f64,
}

/// State of the friction at a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Stick,
    /// Sliding, with the sign of the slip.
    Slide(f64),
}

/// Friction problem with the linear part `hessian`, `drive`, in load axes.
pub struct Problem<'a> {
    pub hessian: &'a Mat3,
    pub drive: &'a Vec3,
    /// Last increment, near which the search starts (m, m, rad).
    pub near: &'a Vec3,
    /// Unit vector of the load's x axis.
    pub facing: &'a Vec2,
    /// Duration of the step (s).
    pub duration: f64,
    /// Size of the load (m).
    pub radius: f64,
}

/// Solves the friction problem of a step with `contacts`, and writes their forces to `forces`
/// (normal and tangent, N).
///
/// With side friction limited by a fixed force, the problem is convex. The limits start at zero,
/// so that a load that can slide does, and follow the normal forces by shorter and shorter steps.
pub fn solve(solver: &mut FrictionSolver, problem: &Problem, contacts: &[ContactPoint], forces: &mut Vec<[f64; 2]>) -> FrictionSolution {
    let flexibility = problem.hessian.try_inverse().unwrap_or_else(Mat3::zeros);
    let mut rows: Vec<Row> = contacts.iter().map(|contact| Row::new(contact, problem, &flexibility)).collect();
    let mut n_iterations = 0;
    let (mut share, mut last_miss) = (1.0, f64::INFINITY);
    let mut solution = solve_with_limits(solver, problem, &mut rows, &mut n_iterations);
    for _ in 0..N_LIMITS {
        let miss = rows.iter().map(Row::miss).fold(0.0, |most: f64, miss| most.max(miss.abs()));
        let force = rows.iter().fold(0.0, |sum, row| sum + row.push);
        if miss <= SETTLED * force {
            break;
        }
        if miss > 0.5 * last_miss {
            share *= 0.5;
        }
        last_miss = miss;
        rows.iter_mut().for_each(|row| row.limit += share * row.miss());
        solution = solve_with_limits(solver, problem, &mut rows, &mut n_iterations);
    }
    if rests(&rows, &solution.increment, problem.radius) {
        solution.mode = ContactMode::Stick;
    }
    forces.clear();
    forces.extend(rows.iter().map(|row| [row.push, row.rub]));
    // The residual is that of a problem with springs in place of contacts.
    FrictionSolution { n_iterations, residual: 0.0, ..solution }
}

/// Solves the friction problem with the limits of side friction in `rows`, whose modes and forces
/// become those of the answer.
fn solve_with_limits(solver: &mut FrictionSolver, problem: &Problem, rows: &mut [Row], n_iterations: &mut u32) -> FrictionSolution {
    let mut pass = |rows: &[Row]| {
        let (mut hessian, mut drive) = (*problem.hessian, *problem.drive);
        rows.iter().for_each(|row| row.add(&mut hessian, &mut drive));
        let solution = solver.slide(&hessian, &drive, problem.near).unwrap_or_else(|| solver.solve(&hessian, &drive));
        *n_iterations += solution.n_iterations;
        solution
    };
    let mut solution = pass(rows);
    for _ in 1..N_PASSES {
        let has_changed = rows.iter_mut().fold(false, |changed, row| row.update(&solution.increment) | changed);
        if !has_changed {
            break;
        }
        solution = pass(rows);
    }
    solution
}

/// Whether nothing but the contact springs moves.
fn rests(rows: &[Row], increment: &Vec3, radius: f64) -> bool {
    let given_way = |row: &Row| (row.push / row.stiffness[0]).max(row.rub.abs() / row.stiffness[1]);
    let most = rows.iter().map(given_way).fold(0.0, f64::max);
    most > 0.0 && increment.xy().norm() + radius * increment.z.abs() <= REST * most
}

impl Row {
    fn new(contact: &ContactPoint, problem: &Problem, flexibility: &Mat3) -> Self {
        let row = |direction: &Vec2| {
            let wrench = wrench_of(&contact.arm, direction);
            seen_from(problem.facing, &wrench.xy()).push(wrench.z)
        };
        let (normal, tangent) = (row(&contact.normal), row(&contact.tangent()));
        let shift = problem.duration * contact.velocity;
        let gap = contact.room - shift.dot(&contact.normal);
        Self {
            normal,
            tangent,
            gap,
            slip: -shift.dot(&contact.tangent()),
            friction: contact.friction,
            stiffness: [normal, tangent].map(|row| STIFFNESS / row.dot(&(flexibility * row))),
            is_closed: gap <= 0.0,
            side: Side::Slide(1.0),
            limit: 0.0,
            push: 0.0,
            rub: 0.0,
        }
    }

    /// What the limit of side friction lacks (N).
    fn miss(&self) -> f64 {
        self.friction * self.push - self.limit
    }

    /// Adds the contact to the linear part of the problem.
    fn add(&self, hessian: &mut Mat3, drive: &mut Vec3) {
        let mut spring = |direction: &Vec3, stiffness: f64, rest: f64| {
            *hessian += stiffness * direction * direction.transpose();
            *drive -= stiffness * rest * direction;
        };
        if self.is_closed {
            spring(&self.normal, self.stiffness[0], self.gap);
        }
        match self.side {
            _ if self.limit == 0.0 => {}
            Side::Stick => spring(&self.tangent, self.stiffness[1], self.slip),
            Side::Slide(sign) => *drive -= sign * self.limit * self.tangent,
        }
    }

    /// Takes modes and forces from the answer of a pass; returns whether a mode has changed.
    fn update(&mut self, increment: &Vec3) -> bool {
        let before = (self.is_closed, self.side);
        let push = -self.stiffness[0] * (self.gap + self.normal.dot(increment));
        self.is_closed = push > 0.0;
        self.push = if before.0 { push.max(0.0) } else { 0.0 };
        let slip = self.slip + self.tangent.dot(increment);
        let rub = -self.stiffness[1] * slip;
        self.side = if self.limit > 0.0 && rub.abs() <= self.limit { Side::Stick } else { Side::Slide(slip.signum()) };
        self.rub = rub.clamp(-self.limit, self.limit);
        before.0 != self.is_closed || (self.limit > 0.0 && before.1 != self.side)
    }
}
