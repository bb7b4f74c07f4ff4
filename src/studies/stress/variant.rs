//! The ways to move a load that are put under stress.

use serde::{Deserialize, Serialize};

use crate::backend::rapier::Precision;
use crate::backend::{BackendKind, BackendOptions, Integrator, RapierOptions};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Variant {
    QuasiStatic,
    InertialMidpoint,
    InertialEuler,
    Rapier,
    RapierAsShipped,
    RapierF32,
}

impl Variant {
    pub const ALL: [Variant; 6] = [
        Variant::QuasiStatic,
        Variant::InertialMidpoint,
        Variant::InertialEuler,
        Variant::Rapier,
        Variant::RapierAsShipped,
        Variant::RapierF32,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Variant::QuasiStatic => "quasi-static",
            Variant::InertialMidpoint => "inertial-midpoint",
            Variant::InertialEuler => "inertial-euler",
            Variant::Rapier => "rapier",
            Variant::RapierAsShipped => "rapier-as-shipped",
            Variant::RapierF32 => "rapier-f32",
        }
    }

    pub fn kind(self) -> BackendKind {
        match self {
            Variant::QuasiStatic => BackendKind::QuasiStatic,
            Variant::InertialMidpoint | Variant::InertialEuler => BackendKind::Inertial,
            Variant::Rapier | Variant::RapierAsShipped | Variant::RapierF32 => BackendKind::Rapier,
        }
    }

    /// With steps of at most `step_s` (s).
    pub fn options(self, step_s: f64) -> BackendOptions {
        let usual = BackendOptions::new(self.kind(), step_s);
        match self {
            Variant::InertialEuler => BackendOptions { integrator: Integrator::Euler, ..usual },
            Variant::RapierAsShipped => BackendOptions { rapier: RapierOptions::as_shipped(), ..usual },
            Variant::RapierF32 => {
                BackendOptions { rapier: RapierOptions { precision: Precision::F32, ..RapierOptions::default() }, ..usual }
            }
            _ => usual,
        }
    }

    /// The exact backend that knows its answer better.
    pub fn exact(self) -> Variant {
        if self == Variant::QuasiStatic { Variant::QuasiStatic } else { Variant::InertialMidpoint }
    }
}
