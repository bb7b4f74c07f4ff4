//! Options of the rapier backend.

use serde::{Deserialize, Serialize};

/// Options of the rapier backend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RapierOptions {
    /// Representation of friction with the ground.
    pub friction: FrictionModel,
    /// Representation of the springs.
    pub springs: SpringModel,
    /// Floating-point precision of the engine.
    pub precision: Precision,
    /// Solver iterations and substeps of the engine.
    pub settings: EngineSettings,
}

/// Representation of friction with the ground by joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FrictionModel {
    /// One axis per support along the force of the exact friction problem.
    Aligned,
    /// Eight fixed axes per support: a polygon in place of the cone.
    Polygon,
    /// Two fixed axes per support: a box in place of the cone.
    Box,
}

/// Representation of the springs by joints or forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpringModel {
    /// One joint per attached spring.
    Joint,
    /// One joint at the centre of stiffness for all attached springs.
    Aggregate,
    /// No joint: the forces of the attached springs at the start of a step act through the step, as
    /// in the simplest program. This is symplectic Euler, which gains energy where omega h >= 2.
    Force,
}

/// Floating-point precision of the engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// Double precision.
    F64,
    /// Single precision.
    #[cfg(feature = "rapier-f32")]
    F32,
}

/// Solver iterations and substeps of the engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EngineSettings {
    /// One substep per step, with enough solver iterations to converge. Contacts with obstacles are
    /// rigid and found anew in every step.
    Recommended,
    /// The defaults of rapier: four substeps with one solver iteration each. With box friction this
    /// is what most users would write. Contacts with obstacles are springs of 60 Hz, and are frozen
    /// until the load has moved by 50 mm.
    #[serde(alias = "as-shipped")]
    EngineDefaults,
}

impl Precision {
    /// Last digit of a number near one (1).
    pub(super) fn digit(self) -> f64 {
        match self {
            Self::F64 => f64::EPSILON,
            #[cfg(feature = "rapier-f32")]
            Self::F32 => f64::from(f32::EPSILON),
        }
    }
}

impl EngineSettings {
    /// Number of substeps of a step (1).
    pub(super) fn n_substeps(self) -> usize {
        match self {
            Self::Recommended => 1,
            Self::EngineDefaults => 4,
        }
    }
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
    /// The engine's own defaults with the simplest friction joints.
    pub fn engine_defaults() -> Self {
        Self { friction: FrictionModel::Box, settings: EngineSettings::EngineDefaults, ..Self::default() }
    }

    /// A set of settings, by default the recommended one, with the models and the precision that
    /// are asked for.
    pub fn asked(
        settings: Option<EngineSettings>,
        friction: Option<FrictionModel>,
        springs: Option<SpringModel>,
        precision: Option<Precision>,
    ) -> Self {
        let usual = match settings {
            None | Some(EngineSettings::Recommended) => Self::default(),
            Some(EngineSettings::EngineDefaults) => Self::engine_defaults(),
        };
        Self {
            friction: friction.unwrap_or(usual.friction),
            springs: springs.unwrap_or(usual.springs),
            precision: precision.unwrap_or(usual.precision),
            ..usual
        }
    }
}
