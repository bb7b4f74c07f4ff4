//! The rigid-body engine rapier2d as a backend.
//!
//! Everything the engine is asked in a step is first written down as plain data in f64 (`joints`): friction joints from `ground`, springs from `springs`,
//! folded into one by `aggregate`. `world` hands that to rapier, and `transport` runs the steps and keeps the books. One step solves, for the twist v of the load,
//!
//! ```text
//! M (v - v_n) / h = W - (h K + D) v + sum_i B_i' lambda_i        W: wrench of the springs at q_n with the tips at p_n+1
//! ```
//!
//! with K the positive part of the springs' stiffness and D their dashpots: the implicit Euler step of the reference dynamics but for the geometric part of
//! the stiffness, which acts through W alone. At rest the law is exact; in motion it lags by that part times h v, first order as the step itself.
//! The engine finds the impulses by sweeps over the joints.

mod aggregate;
mod double;
mod ground;
mod joints;
mod ledger;
mod residual;
mod rest;
mod single;
mod springs;
mod step;
mod transport;

use serde::{Deserialize, Serialize};

use super::{Backend, BackendOptions, Motion};
use crate::model::System;

/// How rapier is set up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RapierOptions {
    pub friction: FrictionModel,
    pub springs: SpringModel,
    pub precision: Precision,
    pub settings: EngineSettings,
}

/// How friction with the ground is posed as joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum FrictionModel {
    /// One axis per support along the force that the exact cone problem finds.
    Aligned,
    /// Eight fixed axes per support: a polygon in place of the cone.
    Polygon,
    /// Two fixed axes per support: a box in place of the cone.
    Box,
}

/// How springs are posed as joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum SpringModel {
    /// A joint per held spring.
    Joint,
    /// One joint at the centre of stiffness for all held springs.
    Aggregate,
    /// No joint: the forces of all held springs at the start of the step push the load through it, as one would write it first. The load swings with
    /// symplectic Euler, which gives energy where omega h >= 2.
    Force,
}

/// Floating point of the engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    F64,
    F32,
}

/// How often the engine sweeps over the joints and how it cuts a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum EngineSettings {
    /// One engine step a step of ours, with enough sweeps to converge.
    Recommended,
    /// What rapier does when nobody tells it otherwise: four substeps of one sweep each. The baseline of a user who does not tune; with
    /// box friction it is what most of them would write.
    AsShipped,
}

impl Default for RapierOptions {
    fn default() -> Self {
        Self {
            friction: FrictionModel::Aligned,
            springs: SpringModel::Joint,
            precision: Precision::F64,
            settings: EngineSettings::Recommended,
        }
    }
}

impl RapierOptions {
    /// Rapier as one finds it: its own defaults and the simplest friction joints.
    pub fn as_shipped() -> Self {
        Self { friction: FrictionModel::Box, settings: EngineSettings::AsShipped, ..Self::default() }
    }
}

/// A load under rapier.
pub fn build(system: System, start: Motion, options: &BackendOptions) -> Box<dyn Backend> {
    let body = joints::BodyState::of(&start);
    let engine: Box<dyn joints::Engine> = match options.rapier.precision {
        Precision::F64 => Box::new(double::World::new(&system.load, &body, &options.rapier)),
        Precision::F32 => Box::new(single::World::new(&system.load, &body, &options.rapier)),
    };
    Box::new(transport::Transport::new(system, start, options, engine))
}
