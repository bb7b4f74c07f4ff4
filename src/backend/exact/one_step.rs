//! One step with inertia: the problem, its solution and the friction that a step leaves behind.

use serde::{Deserialize, Serialize};

use super::bdf2::Past;
use crate::backend::contact::{Obstacles, Scope, SideWork, Touching};
use crate::backend::friction::ContactMode;
use crate::backend::report::{Motion, StepReport};
use crate::backend::shortcuts::Forecast;
use crate::backend::springs::SpringBlocks;
use crate::math::{Pose, Twist, Vec2, Vec3};
use crate::model::System;

/// How a step discretises the equation of motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// First order. Without mass this is the quasi-static step.
    Euler,
    /// Second order, in turning slips as in straight ones.
    #[default]
    Midpoint,
}

/// A step to take.
pub struct Problem<'a> {
    pub system: &'a System,
    pub start: Motion,
    pub past: Option<PastFriction>,
    /// Springs with their tips where the step evaluates them.
    pub springs: &'a mut SpringBlocks,
    /// Dashpots as springs of this step.
    pub dashpots: Option<&'a mut SpringBlocks>,
    pub forecast: &'a mut Forecast,
    /// The obstacles, where the step has to regard them.
    pub among: Option<Among<'a>>,
    /// (s)
    pub step: f64,
    /// Longest step that takes an undamped load through one radian of its fastest oscillation (s);
    /// zero with damping.
    pub resolving_step: f64,
}

/// The obstacles of a step.
pub struct Among<'a> {
    pub obstacles: &'a mut Obstacles,
    /// Closed contacts.
    pub touching: &'a mut Vec<Touching>,
    /// Time at the end of the step (s).
    pub end: f64,
    pub scope: Scope,
}

/// A step taken.
pub struct Stepped {
    pub motion: Motion,
    /// Pose at which the springs and dashpots acted.
    pub stage: Pose,
    /// Energy lost to friction (J).
    pub friction: f64,
    pub mode: ContactMode,
    /// Friction for the next step.
    pub past: Option<PastFriction>,
    /// Work at the obstacles; `None` of a step that regards none.
    pub side: Option<SideWork>,
    pub report: StepReport,
}

/// Friction of the last midpoint steps, all in one contact mode (N, N, N m; forces in world axes,
/// torques about the load's origin).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PastFriction {
    pub mode: ContactMode,
    pub last: Vec3,
    pub before: Option<Vec3>,
    /// Length of the last step (s).
    pub step: f64,
}

/// A step in which the load touched in the same modes all along.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touched {
    pub step: Past,
    /// Velocity before it (m/s, rad/s).
    pub before: Twist,
    /// Attached tips before it, where springs are damped (m, world).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tips: Vec<Vec2>,
}
