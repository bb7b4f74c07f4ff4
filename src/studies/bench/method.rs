//! The ways to move the load that are compared.

use crate::backend::rapier::{EngineSettings, FrictionModel, Precision, SpringModel};
use crate::backend::{BackendKind, BackendOptions, ConeSolver, Integrator, RapierOptions, Tolerance};
use crate::model::Load;

use super::scene::Level;

/// A way to move the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    pub name: &'static str,
    how: How,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum How {
    QuasiStatic(ConeSolver),
    QuasiStaticSecondOrder,
    Inertial(Integrator),
    /// An exact backend under error control.
    Controlled(BackendKind),
    Rapier(RapierOptions),
}

const RAPIER: RapierOptions = RapierOptions {
    friction: FrictionModel::Aligned,
    springs: SpringModel::Joint,
    precision: Precision::F64,
    settings: EngineSettings::Recommended,
};

/// All of them, a line each.
pub const METHODS: &[Method] = &[
    Method { name: "quasi-static", how: How::QuasiStatic(ConeSolver::Exact) },
    Method { name: "quasi-static second order", how: How::QuasiStaticSecondOrder },
    Method { name: "quasi-static clarabel", how: How::QuasiStatic(ConeSolver::Clarabel) },
    Method { name: "quasi-static controlled", how: How::Controlled(BackendKind::QuasiStatic) },
    Method { name: "inertial euler", how: How::Inertial(Integrator::Euler) },
    Method { name: "inertial midpoint", how: How::Inertial(Integrator::Midpoint) },
    Method { name: "inertial controlled", how: How::Controlled(BackendKind::Inertial) },
    Method { name: "rapier aligned", how: How::Rapier(RAPIER) },
    Method { name: "rapier polygon", how: How::Rapier(RapierOptions { friction: FrictionModel::Polygon, ..RAPIER }) },
    Method { name: "rapier box", how: How::Rapier(RapierOptions { friction: FrictionModel::Box, ..RAPIER }) },
    Method { name: "rapier aligned f32", how: How::Rapier(RapierOptions { precision: Precision::F32, ..RAPIER }) },
    Method { name: "rapier aligned aggregate", how: How::Rapier(RapierOptions { springs: SpringModel::Aggregate, ..RAPIER }) },
    Method { name: "rapier aligned force", how: How::Rapier(RapierOptions { springs: SpringModel::Force, ..RAPIER }) },
    Method {
        name: "rapier as shipped",
        how: How::Rapier(RapierOptions { friction: FrictionModel::Box, settings: EngineSettings::AsShipped, ..RAPIER }),
    },
    Method {
        name: "rapier as shipped f32",
        how: How::Rapier(RapierOptions {
            friction: FrictionModel::Box,
            settings: EngineSettings::AsShipped,
            precision: Precision::F32,
            ..RAPIER
        }),
    },
];

/// The method of this name.
pub fn named(name: &str) -> Option<&'static Method> {
    METHODS.iter().find(|method| method.name == name)
}

impl Method {
    pub fn kind(&self) -> BackendKind {
        match self.how {
            How::QuasiStatic(_) | How::QuasiStaticSecondOrder => BackendKind::QuasiStatic,
            How::Inertial(_) => BackendKind::Inertial,
            How::Controlled(kind) => kind,
            How::Rapier(_) => BackendKind::Rapier,
        }
    }

    pub fn is_controlled(&self) -> bool {
        matches!(self.how, How::Controlled(_))
    }

    /// Options at this step, or this tolerance on the rim of `load`.
    ///
    /// # Panics
    /// When a method with steps gets a tolerance or the other way round.
    pub fn options(&self, level: Level, load: &Load) -> BackendOptions {
        match (self.how, level) {
            (How::QuasiStatic(cone_solver), Level::Step(step)) => {
                BackendOptions { cone_solver, ..BackendOptions::new(BackendKind::QuasiStatic, step) }
            }
            (How::QuasiStaticSecondOrder, Level::Step(step)) => {
                BackendOptions { second_order: true, ..BackendOptions::new(BackendKind::QuasiStatic, step) }
            }
            (How::Inertial(integrator), Level::Step(step)) => {
                BackendOptions { integrator, ..BackendOptions::new(BackendKind::Inertial, step) }
            }
            (How::Rapier(rapier), Level::Step(step)) => BackendOptions { rapier, ..BackendOptions::new(BackendKind::Rapier, step) },
            (How::Controlled(kind), Level::Tolerance(tolerance)) => BackendOptions::within(kind, Tolerance::on_rim(tolerance, load)),
            (_, level) => panic!("{level:?} is none of {}", self.name),
        }
    }
}
