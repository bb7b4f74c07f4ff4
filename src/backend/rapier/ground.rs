//! Friction with the ground as joints.
//!
//! An axis motor of rapier with a largest force is Coulomb's law along one line. There are three
//! ways to represent a plane:
//!
//! - **aligned**: the exact friction problem is solved for the very step of the engine, and each
//!   support gets one axis along its friction force with that force as its limit. A support that
//!   slips then has the exact force. The support that the load turns about is stopped along both
//!   axes without a limit: with the solved force as its limit it would stick only just, and creep
//!   by rounding. Where all supports stick, one joint without limits stops the load's origin and
//!   its turn. Its three axes are not coupled, so each iteration ends exactly at rest; three joints
//!   that share the load would reach rest only in the limit. The forces under a load at rest are
//!   statically indeterminate; those of the friction problem are reported, which are within all
//!   limits and in balance with the same springs.
//! - **polygon**: eight axes, 22.5 degrees apart in the world, span a polygon of sixteen sides in
//!   place of the disc.
//! - **box**: two axes of the world have the whole limit each, so that a slip at 45 degrees meets
//!   sqrt(2) times the friction.

use std::f64::consts::PI;

use super::FrictionModel;
use super::contacts::ContactPoint;
use super::joints::FrictionJoint;
use super::prediction::{self, Problem};
use super::springs::{SpringSum, seen_from, turned};
use crate::backend::friction::{ContactMode, FrictionSolution, FrictionSolver, WarmStart};
use crate::backend::numerics::N_POLYGON_AXES;
use crate::backend::report::{Motion, RestoreError, StepReport};
use crate::math::{Mat3, Vec2, Vec3, direction};
use crate::model::System;

/// Friction of all supports with a slip limit.
pub struct GroundFriction {
    supports: Vec<Support>,
    model: Model,
    joints: Vec<FrictionJoint>,
    /// Forces of the contacts under a load that all supports stop (normal and tangent, N).
    held: Vec<[f64; 2]>,
}

#[derive(Clone, Copy)]
struct Support {
    /// Index in the ground.
    index: usize,
    offset: Vec2,
    limit: f64,
}

enum Model {
    /// Solver, and contact mode in the last step.
    Aligned(Box<FrictionSolver>, ContactMode),
    /// Joints that are the same in every step.
    Fixed,
}

/// What drives the load in a step.
#[derive(Clone, Copy)]
pub struct Drive<'a> {
    /// Motion at the start.
    pub motion: &'a Motion,
    /// Unit vector of the load's x axis.
    pub facing: &'a Vec2,
    pub sum: &'a SpringSum,
    /// (s)
    pub duration: f64,
    pub contacts: &'a [ContactPoint],
    /// Rounding of the gaps of the contacts (m).
    pub rounding: f64,
}

impl GroundFriction {
    pub fn new(system: &System, model: FrictionModel) -> Self {
        let limits = system.ground.slip_limits().enumerate();
        let supports: Vec<Support> = limits
            .filter(|(_, limit)| *limit > 0.0)
            .map(|(index, limit)| Support { index, offset: system.ground.supports[index].offset, limit })
            .collect();
        let solver = || Box::new(FrictionSolver::new(&system.ground, system.load.radius));
        let (model, joints) = match model {
            FrictionModel::Aligned => (Model::Aligned(solver(), ContactMode::Slip), Vec::with_capacity(supports.len())),
            FrictionModel::Polygon => (Model::Fixed, polygon(&supports)),
            FrictionModel::Box => (Model::Fixed, supports.iter().map(|support| support.joint(Vec2::x(), [support.limit; 2])).collect()),
        };
        Self { supports, model, joints, held: Vec::new() }
    }

    /// Whether the load may have been at rest in the last step, up to the engine's rounding. For
    /// fixed joints this is unknown, and the answer is `true`.
    pub fn may_rest(&self) -> bool {
        !matches!(self.model, Model::Aligned(_, ContactMode::Slip | ContactMode::Pinned(_)))
    }

    /// Number of joints of a step.
    pub fn n_joints(&self) -> usize {
        match self.model {
            Model::Aligned(..) => self.supports.len(),
            Model::Fixed => self.joints.len(),
        }
    }

    /// Forces of the contacts in the last step (normal and tangent, N) under a load that all
    /// supports stop; empty under any other. The engine's joint then bears whatever the contacts
    /// would bear, and its contact forces are zero.
    pub fn held(&self) -> &[[f64; 2]] {
        &self.held
    }

    /// Takes such forces from another run.
    pub fn set_held(&mut self, held: Vec<[f64; 2]>) {
        self.held = held;
    }

    /// Joints of the last step.
    pub fn joints(&self) -> &[FrictionJoint] {
        &self.joints
    }

    /// Sets the joints of a step under `drive`. Adds the work to `report`.
    pub fn set_joints(&mut self, system: &System, drive: &Drive, report: &mut StepReport) {
        let Model::Aligned(solver, mode) = &mut self.model else { return };
        if self.supports.is_empty() {
            return;
        }
        let facing = drive.facing;
        let solution = solve(solver, system, drive, &mut self.held);
        *mode = solution.mode;
        if solution.mode != ContactMode::Stick {
            self.held.clear();
        }
        report.n_solves += 1;
        report.n_iterations += u64::from(solution.n_iterations);
        report.residual = report.residual.max(solution.residual);
        self.joints.clear();
        for (at, support) in self.supports.iter().enumerate() {
            let force = turned(facing, &solver.forces()[support.index]);
            self.joints.push(match solution.mode {
                ContactMode::Stick => support.stuck(at == 0, force),
                ContactMode::Pinned(pivot) => support.aligned(&force, pivot == support.index),
                ContactMode::Slip => support.aligned(&force, false),
            });
        }
    }

    /// Last answer of the friction solver; `None` for fixed joints.
    pub fn warm_start(&self) -> Option<&WarmStart> {
        match &self.model {
            Model::Aligned(solver, _) => Some(solver.warm_start()),
            Model::Fixed => None,
        }
    }

    /// Takes the last answer of another friction solver.
    ///
    /// # Errors
    /// When it belongs to another friction model or to other supports.
    pub fn set_warm_start(&mut self, start: Option<WarmStart>) -> Result<(), RestoreError> {
        match (&mut self.model, start) {
            (Model::Aligned(solver, _), Some(start)) => solver.set_warm_start(start),
            (Model::Fixed, None) => Ok(()),
            _ => Err(RestoreError("friction of another kind".to_owned())),
        }
    }
}

/// Joints of the polygon. The limits are right in the mean over all directions; the width of the
/// polygon varies by +0.6 % and -1.3 % about that of the disc.
fn polygon(supports: &[Support]) -> Vec<FrictionJoint> {
    let mean_of_cosine = 2.0 / PI;
    let share = 1.0 / (N_POLYGON_AXES as f64 * mean_of_cosine);
    let directions = (0..N_POLYGON_AXES / 2).map(|i| direction(i as f64 * PI / N_POLYGON_AXES as f64));
    supports.iter().flat_map(|support| directions.clone().map(|axis| support.joint(axis, [share * support.limit; 2]))).collect()
}

/// Solution of the engine's step as a friction problem for the body-twist increment `x = h v`:
///
/// ```text
/// (M / h^2 + K + D / h) x - (M v_n / h + W) + friction = 0
/// ```
///
/// The search starts from the last twist, which is near for a load that keeps slipping.
fn solve(solver: &mut FrictionSolver, system: &System, step: &Drive, contact_forces: &mut Vec<[f64; 2]>) -> FrictionSolution {
    let Drive { motion, facing, sum, duration, contacts, rounding } = *step;
    let mass = Vec3::new(system.load.mass, system.load.mass, system.load.inertia);
    let mut slope = sum.stiffness + sum.damping / duration;
    for i in 0..3 {
        slope[(i, i)] += mass[i] / (duration * duration);
    }
    let Motion { twist, .. } = motion;
    let drive = mass.component_mul(&twist.linear.push(twist.angular)) / duration + sum.wrench;
    let in_load = |v: &Vec3| seen_from(facing, &v.xy()).push(v.z);
    let (hessian, drive) = (in_load_axes(&slope, facing), in_load(&drive));
    if !contacts.is_empty() {
        let problem = Problem { hessian: &hessian, drive: &drive, facing, duration, rounding };
        return prediction::solve(solver, &problem, contacts, contact_forces);
    }
    contact_forces.clear();
    let near = duration * in_load(&twist.linear.push(twist.angular));
    solver.slide(&hessian, &drive, &near).unwrap_or_else(|| solver.solve(&hessian, &drive))
}

/// Symmetric matrix over (x, y, heading) in axes turned by the angle of the unit vector `facing`.
fn in_load_axes(world: &Mat3, facing: &Vec2) -> Mat3 {
    let (c, s) = (facing.x, facing.y);
    let (a, b, d) = (world.m11, world.m12, world.m22);
    let twice = 2.0 * c * s * b;
    let (first, second) = (c * c * a + twice + s * s * d, s * s * a - twice + c * c * d);
    let mixed = (c * c - s * s) * b + c * s * (d - a);
    let turning = seen_from(facing, &Vec2::new(world.m13, world.m23));
    Mat3::new(
        first, mixed, turning.x, //
        mixed, second, turning.y, //
        turning.x, turning.y, world.m33,
    )
}

impl Support {
    fn joint(&self, direction: Vec2, limits: [f64; 2]) -> FrictionJoint {
        FrictionJoint { support: self.index, offset: self.offset, direction, limits, turning_limit: 0.0, stuck_force: None }
    }

    /// Joint with one axis along `force` (N, world), or two axes without a limit where the load
    /// turns about this support.
    fn aligned(&self, force: &Vec2, is_pivot: bool) -> FrictionJoint {
        let size = force.norm();
        let along = if size > 0.0 { force / size } else { Vec2::x() };
        self.joint(along, if is_pivot { [f64::INFINITY; 2] } else { [size, 0.0] })
    }

    /// Joint that stops the whole load under the first support, and does nothing under the others.
    fn stuck(&self, is_first: bool, force: Vec2) -> FrictionJoint {
        let limit = if is_first { f64::INFINITY } else { 0.0 };
        FrictionJoint { offset: Vec2::zeros(), turning_limit: limit, stuck_force: Some(force), ..self.joint(Vec2::x(), [limit; 2]) }
    }
}
