//! Friction with the ground as joints.
//!
//! An axis motor of rapier with a largest force is Coulomb's law along one line. Three ways to make a plane of it:
//!
//! - **aligned**: the exact cone problem is solved for the very step that the engine will make, and each support gets one axis along its friction
//!   force with that force as its limit: a support that slips has the exact force. The one that the load turns about is held along both axes
//!   without a limit: with the solved force as its limit it would stick by a hair and creep with every rounding. Where all stick, one joint
//!   without limits holds the load's origin and its turn. Its three axes do not couple, so each sweep ends at rest exactly, which three
//!   holds that share the load reach only in the end. The forces under a held load are statically indeterminate; those of the cone problem,
//!   within all limits and in balance with the same springs, stand for them.
//! - **polygon**: eight axes, 22.5 degrees apart in the world, span a polygon of sixteen sides in place of the disc.
//! - **box**: two axes of the world with the whole limit each, so that a slip at 45 degrees meets sqrt(2) times the friction.

use std::f64::consts::PI;

use super::FrictionModel;
use super::joints::FrictionJoint;
use super::springs::{SpringSum, seen_from, turned};
use crate::backend::friction::{ContactMode, FrictionSolution, FrictionSolver, WarmStart};
use crate::backend::{Motion, RestoreError, StepReport};
use crate::math::{Mat3, Vec2, Vec3, direction};
use crate::model::System;

/// The supports with a slip limit, and how they are posed.
pub struct Footing {
    feet: Vec<Foot>,
    how: How,
    /// Of the last step.
    joints: Vec<FrictionJoint>,
}

#[derive(Clone, Copy)]
struct Foot {
    support: usize,
    offset: Vec2,
    limit: f64,
}

enum How {
    /// Solver, and contact mode in the last step.
    Aligned(Box<FrictionSolver>, ContactMode),
    /// The same joints in every step.
    Fixed,
}

/// Axes of the polygon in a half turn.
const N_POLYGON_AXES: usize = 8;

impl Footing {
    pub fn new(system: &System, model: FrictionModel) -> Self {
        let limits = system.ground.slip_limits().enumerate();
        let feet: Vec<Foot> = limits
            .filter(|(_, limit)| *limit > 0.0)
            .map(|(support, limit)| Foot { support, offset: system.ground.supports[support].offset, limit })
            .collect();
        let solver = || Box::new(FrictionSolver::new(&system.ground, system.load.radius));
        let (how, joints) = match model {
            FrictionModel::Aligned => (How::Aligned(solver(), ContactMode::Slip), Vec::with_capacity(feet.len())),
            FrictionModel::Polygon => (How::Fixed, polygon(&feet)),
            FrictionModel::Box => (How::Fixed, feet.iter().map(|foot| foot.joint(Vec2::x(), [foot.limit; 2])).collect()),
        };
        Self { feet, how, joints }
    }

    /// Whether the joints of the last step let the load move by no more than the engine's rounding, or know nothing of it.
    pub fn may_hold(&self) -> bool {
        !matches!(self.how, How::Aligned(_, ContactMode::Slip | ContactMode::Pinned(_)))
    }

    /// The joints of the last step.
    pub fn joints(&self) -> &[FrictionJoint] {
        &self.joints
    }

    /// Poses the joints of a step of `duration` (s) from `motion`, with the load's x axis along `facing`, under the springs of `sum`; what it took goes to
    /// `report`.
    pub fn pose(&mut self, system: &System, motion: &Motion, facing: &Vec2, sum: &SpringSum, duration: f64, report: &mut StepReport) {
        let How::Aligned(solver, mode) = &mut self.how else { return };
        if self.feet.is_empty() {
            return;
        }
        let solution = solve(solver, system, motion, facing, sum, duration);
        *mode = solution.mode;
        report.n_solves += 1;
        report.n_iterations += u64::from(solution.n_iterations);
        report.residual = report.residual.max(solution.residual);
        self.joints.clear();
        for (at, foot) in self.feet.iter().enumerate() {
            let force = turned(facing, &solver.forces()[foot.support]);
            self.joints.push(match solution.mode {
                ContactMode::Stick => foot.held(at == 0, force),
                ContactMode::Pinned(support) => foot.aligned(&force, support == foot.support),
                ContactMode::Slip => foot.aligned(&force, false),
            });
        }
    }

    pub fn warm_start(&self) -> Option<&WarmStart> {
        match &self.how {
            How::Aligned(solver, _) => Some(solver.warm_start()),
            How::Fixed => None,
        }
    }

    /// # Errors
    /// When the start belongs to another footing.
    pub fn set_warm_start(&mut self, start: Option<WarmStart>) -> Result<(), RestoreError> {
        match (&mut self.how, start) {
            (How::Aligned(solver, _), Some(start)) => solver.set_warm_start(start),
            (How::Fixed, None) => Ok(()),
            _ => Err(RestoreError("friction of another kind".to_owned())),
        }
    }
}

/// Limits that are right in the mean over all directions: the width of the polygon varies by +0.6 % and -1.3 % about that of the disc.
fn polygon(feet: &[Foot]) -> Vec<FrictionJoint> {
    let mean_of_cosine = 2.0 / PI;
    let share = 1.0 / (N_POLYGON_AXES as f64 * mean_of_cosine);
    let directions = (0..N_POLYGON_AXES / 2).map(|i| direction(i as f64 * PI / N_POLYGON_AXES as f64));
    feet.iter().flat_map(|foot| directions.clone().map(|axis| foot.joint(axis, [share * foot.limit; 2]))).collect()
}

/// The engine's step as a cone problem for the body-twist increment `h v`: (M / h^2 + K + D / h) x - (M v_n / h + W) + friction = 0. A load that slips
/// goes on nearly as it went.
fn solve(solver: &mut FrictionSolver, system: &System, motion: &Motion, facing: &Vec2, sum: &SpringSum, duration: f64) -> FrictionSolution {
    let mass = Vec3::new(system.load.mass, system.load.mass, system.load.inertia);
    let mut slope = sum.stiffness + sum.damping / duration;
    for i in 0..3 {
        slope[(i, i)] += mass[i] / (duration * duration);
    }
    let Motion { twist, .. } = motion;
    let drive = mass.component_mul(&twist.linear.push(twist.angular)) / duration + sum.wrench;
    let in_load = |v: &Vec3| seen_from(facing, &v.xy()).push(v.z);
    let (hessian, drive) = (in_load_axes(&slope, facing), in_load(&drive));
    let near = duration * in_load(&twist.linear.push(twist.angular));
    solver.slide(&hessian, &drive, &near).unwrap_or_else(|| solver.solve(&hessian, &drive))
}

/// A symmetric matrix over (x, y, heading) in axes turned by the angle of the unit vector `facing`.
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

impl Foot {
    fn joint(&self, direction: Vec2, limits: [f64; 2]) -> FrictionJoint {
        FrictionJoint { support: self.support, offset: self.offset, direction, limits, turning_limit: 0.0, stuck_force: None }
    }

    /// One axis along `force` (N, world), or two without a limit where the load turns about this support.
    fn aligned(&self, force: &Vec2, is_pivot: bool) -> FrictionJoint {
        let size = force.norm();
        let along = if size > 0.0 { force / size } else { Vec2::x() };
        self.joint(along, if is_pivot { [f64::INFINITY; 2] } else { [size, 0.0] })
    }

    /// The joint that holds the whole load, or one that does nothing.
    fn held(&self, holds: bool, force: Vec2) -> FrictionJoint {
        let limit = if holds { f64::INFINITY } else { 0.0 };
        FrictionJoint { offset: Vec2::zeros(), turning_limit: limit, stuck_force: Some(force), ..self.joint(Vec2::x(), [limit; 2]) }
    }
}
