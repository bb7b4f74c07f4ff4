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
use super::springs::SpringSum;
use crate::backend::friction::{FrictionSolution, FrictionSolver, Regime, WarmStart};
use crate::backend::{Motion, RestoreError, StepReport};
use crate::math::{Mat3, Vec2, direction, rotation};
use crate::model::System;

/// The supports with a slip limit, and how they are posed.
pub struct Footing {
    feet: Vec<Foot>,
    how: How,
}

#[derive(Clone, Copy)]
struct Foot {
    support: usize,
    offset: Vec2,
    limit: f64,
}

enum How {
    Aligned(Box<FrictionSolver>),
    /// Directions of the first of two axes each (rad), and the share of the slip limit that one axis has.
    Fixed {
        directions: Vec<f64>,
        share: f64,
    },
}

/// Axes of the polygon in a half turn.
const N_POLYGON_AXES: usize = 8;

impl Footing {
    pub fn new(system: &System, model: FrictionModel) -> Self {
        let limits = system.ground.slip_limits().enumerate();
        let feet = limits
            .filter(|(_, limit)| *limit > 0.0)
            .map(|(support, limit)| Foot { support, offset: system.ground.supports[support].offset, limit })
            .collect();
        let how = match model {
            FrictionModel::Aligned => How::Aligned(Box::new(FrictionSolver::new(&system.ground, system.load.radius))),
            FrictionModel::Polygon => polygon(),
            FrictionModel::Box => How::Fixed { directions: vec![0.0], share: 1.0 },
        };
        Self { feet, how }
    }

    /// The joints of a step of `duration` (s) from `motion` under the springs of `sum`; what it took goes to `report`.
    pub fn joints(
        &mut self,
        system: &System,
        motion: &Motion,
        sum: &SpringSum,
        duration: f64,
        report: &mut StepReport,
    ) -> Vec<FrictionJoint> {
        let feet = &self.feet;
        match &mut self.how {
            How::Fixed { directions, share } => feet
                .iter()
                .flat_map(|foot| directions.iter().map(move |angle| (foot, *angle)))
                .map(|(foot, angle)| foot.joint(direction(angle), [*share * foot.limit; 2]))
                .collect(),
            How::Aligned(_) if feet.is_empty() => Vec::new(),
            How::Aligned(solver) => {
                let solution = solve(solver, system, motion, sum, duration);
                report.n_solves += 1;
                report.n_iterations += u64::from(solution.n_iterations);
                report.residual = report.residual.max(solution.residual);
                let turn = rotation(motion.pose.heading);
                let forces = solver.forces().iter().map(|force| turn * force).collect::<Vec<_>>();
                match solution.regime {
                    Regime::Stick => feet.iter().enumerate().map(|(at, foot)| foot.held(at == 0, forces[foot.support])).collect(),
                    Regime::Pinned(support) => {
                        feet.iter().map(|foot| foot.aligned(&forces[foot.support], support == foot.support)).collect()
                    }
                    Regime::Slip => feet.iter().map(|foot| foot.aligned(&forces[foot.support], false)).collect(),
                }
            }
        }
    }

    pub fn warm_start(&self) -> Option<&WarmStart> {
        match &self.how {
            How::Aligned(solver) => Some(solver.warm_start()),
            How::Fixed { .. } => None,
        }
    }

    /// # Errors
    /// When the start belongs to another footing.
    pub fn set_warm_start(&mut self, start: Option<WarmStart>) -> Result<(), RestoreError> {
        match (&mut self.how, start) {
            (How::Aligned(solver), Some(start)) => solver.set_warm_start(start),
            (How::Fixed { .. }, None) => Ok(()),
            _ => Err(RestoreError("friction of another kind".to_owned())),
        }
    }
}

/// Limits that are right in the mean over all directions: the width of the polygon varies by +0.6 % and -1.3 % about that of the disc.
fn polygon() -> How {
    let mean_of_cosine = 2.0 / PI;
    How::Fixed {
        directions: (0..N_POLYGON_AXES / 2).map(|i| i as f64 * PI / N_POLYGON_AXES as f64).collect(),
        share: 1.0 / (N_POLYGON_AXES as f64 * mean_of_cosine),
    }
}

/// The engine's step as a cone problem for the body-twist increment `h v`: (M / h^2 + K + D / h) x - (M v_n / h + W) + friction = 0.
fn solve(solver: &mut FrictionSolver, system: &System, motion: &Motion, sum: &SpringSum, duration: f64) -> FrictionSolution {
    let mass = system.load.mass_matrix();
    let hessian = mass / (duration * duration) + sum.stiffness + sum.damping / duration;
    let drive = mass * motion.twist.linear.push(motion.twist.angular) / duration + sum.wrench;
    let to_world = twist_rotation(motion.pose.heading);
    solver.solve(&(to_world.transpose() * hessian * to_world), &to_world.tr_mul(&drive))
}

/// Turns the linear part of a twist from load axes to world axes.
fn twist_rotation(heading: f64) -> Mat3 {
    let mut turn = Mat3::identity();
    turn.fixed_view_mut::<2, 2>(0, 0).copy_from(&rotation(heading));
    turn
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
