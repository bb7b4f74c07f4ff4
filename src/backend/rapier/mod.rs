//! rapier2d as a backend.

use serde::{Deserialize, Serialize};

use super::{Backend, Motion};
use crate::model::System;

/// How rapier is set up.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RapierOptions {
    pub friction: FrictionModel,
    pub springs: SpringModel,
    pub precision: Precision,
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
}

/// Floating point of the engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    F64,
    F32,
}

impl Default for RapierOptions {
    fn default() -> Self {
        Self { friction: FrictionModel::Aligned, springs: SpringModel::Joint, precision: Precision::F64 }
    }
}

pub fn build(_system: System, _start: Motion, _step: f64, _options: &RapierOptions) -> Box<dyn Backend> {
    unimplemented!("written next")
}
