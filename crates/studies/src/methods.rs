//! The one list of the ways to move a load that studies compare: name, options, and what each can
//! answer.
//!
//! `bench` measures all of them, `verify` and `stress` those that say so. A new backend is measured
//! by itself, and becomes part of the other two by a line in `LISTED`. An engine of the user joins
//! the list by its name.

use std::str::FromStr;
use std::sync::{LazyLock, Mutex, PoisonError};

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use cohaul::backend::rapier::{EngineSettings, FrictionModel, Precision, SpringModel};
use cohaul::backend::{BackendKind, BackendOptions, ConeSolver, Integrator, RapierOptions, Tolerance};

/// A way to move a load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    /// Full name, as `bench` prints it.
    pub name: &'static str,
    /// Name where the friction models of the engine are not compared.
    pub short_name: &'static str,
    /// Short name as one word, for options and files.
    pub key: &'static str,
    pub kind: BackendKind,
    /// Whether error control replaces the step.
    pub is_controlled: bool,
    /// Whether `verify` asks it for known answers.
    pub is_verified: bool,
    /// Whether `stress` runs its maps on it.
    pub is_stressed: bool,
    /// Whether it is an engine of the user, in the place of rapier.
    pub is_of_user: bool,
    integrator: Integrator,
    cone_solver: ConeSolver,
    second_order: bool,
    rapier: RapierOptions,
}

const ENGINE: RapierOptions = RapierOptions {
    friction: FrictionModel::Aligned,
    springs: SpringModel::Joint,
    precision: Precision::F64,
    settings: EngineSettings::Recommended,
};
const ENGINE_DEFAULTS: RapierOptions = RapierOptions { friction: FrictionModel::Box, settings: EngineSettings::EngineDefaults, ..ENGINE };

/// All methods, in the order of tables. A backend that is not `LISTED` has one, with a step.
pub static METHODS: LazyLock<Vec<Method>> = LazyLock::new(|| {
    let unlisted = BackendKind::ALL.into_iter().filter(|kind| LISTED.iter().all(|method| method.kind != *kind));
    LISTED.into_iter().chain(unlisted.map(|kind| Method::with_step(kind.name(), kind.name(), kind))).collect()
});

/// Engines of the user, which are methods from the moment they have named themselves.
static OF_USER: Mutex<Vec<Method>> = Mutex::new(Vec::new());

/// The methods of the three backends.
const LISTED: [Method; 15] = [
    Method::QUASI_STATIC,
    Method { second_order: true, ..Method::with_step("quasi-static second order", "quasi-static-second-order", BackendKind::QuasiStatic) },
    Method {
        cone_solver: ConeSolver::Clarabel,
        ..Method::with_step("quasi-static clarabel", "quasi-static-clarabel", BackendKind::QuasiStatic)
    },
    Method::QUASI_STATIC_CONTROLLED,
    Method::INERTIAL_EULER,
    Method::INERTIAL_MIDPOINT,
    Method::INERTIAL_CONTROLLED,
    Method::RAPIER,
    Method::engine("rapier polygon", "rapier-polygon", RapierOptions { friction: FrictionModel::Polygon, ..ENGINE }),
    Method::engine("rapier box", "rapier-box", RapierOptions { friction: FrictionModel::Box, ..ENGINE }),
    Method::RAPIER_F32,
    Method::engine("rapier aligned aggregate", "rapier-aggregate", RapierOptions { springs: SpringModel::Aggregate, ..ENGINE }),
    Method::engine("rapier aligned force", "rapier-force", RapierOptions { springs: SpringModel::Force, ..ENGINE }),
    Method::RAPIER_ENGINE_DEFAULTS,
    Method::engine(
        "rapier engine defaults f32",
        "rapier-engine-defaults-f32",
        RapierOptions { precision: Precision::F32, ..ENGINE_DEFAULTS },
    ),
];

impl Method {
    pub const QUASI_STATIC: Method = Method::with_step("quasi-static", "quasi-static", BackendKind::QuasiStatic).verified().stressed();
    pub const QUASI_STATIC_CONTROLLED: Method =
        Method::controlled("quasi-static controlled", "quasi-static-controlled", BackendKind::QuasiStatic);
    pub const INERTIAL_EULER: Method =
        Method { integrator: Integrator::Euler, ..Method::with_step("inertial euler", "inertial-euler", BackendKind::Inertial) }
            .verified()
            .stressed();
    pub const INERTIAL_MIDPOINT: Method =
        Method { integrator: Integrator::Midpoint, ..Method::with_step("inertial midpoint", "inertial-midpoint", BackendKind::Inertial) }
            .verified()
            .stressed();
    pub const INERTIAL_CONTROLLED: Method = Method::controlled("inertial controlled", "inertial-controlled", BackendKind::Inertial);
    pub const RAPIER: Method = Method { short_name: "rapier", ..Method::engine("rapier aligned", "rapier", ENGINE) }.verified().stressed();
    pub const RAPIER_F32: Method = Method {
        short_name: "rapier f32",
        ..Method::engine("rapier aligned f32", "rapier-f32", RapierOptions { precision: Precision::F32, ..ENGINE })
    }
    .stressed();
    /// The engine by its own defaults, whose errors are shown and not judged.
    pub const RAPIER_ENGINE_DEFAULTS: Method =
        Method::engine("rapier engine defaults", "rapier-engine-defaults", ENGINE_DEFAULTS).verified().stressed();

    const fn with_step(name: &'static str, key: &'static str, kind: BackendKind) -> Self {
        Self {
            name,
            short_name: name,
            key,
            kind,
            is_controlled: false,
            is_verified: false,
            is_stressed: false,
            is_of_user: false,
            integrator: Integrator::Midpoint,
            cone_solver: ConeSolver::Exact,
            second_order: false,
            rapier: ENGINE,
        }
    }

    const fn controlled(name: &'static str, key: &'static str, kind: BackendKind) -> Self {
        Self { is_controlled: true, ..Self::with_step(name, key, kind) }.verified()
    }

    const fn engine(name: &'static str, key: &'static str, rapier: RapierOptions) -> Self {
        Self { rapier, ..Self::with_step(name, key, BackendKind::Rapier) }
    }

    const fn verified(self) -> Self {
        Self { is_verified: true, ..self }
    }

    const fn stressed(self) -> Self {
        Self { is_stressed: true, ..self }
    }

    /// The method of an engine of the user, which has inertia and a step, by its name. Names live
    /// as long as the program.
    ///
    /// # Errors
    /// When a method of this program has the name.
    pub fn of_user(name: &str) -> Result<Method, String> {
        let mut known = OF_USER.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(method) = known.iter().find(|method| method.name == name) {
            return Ok(*method);
        }
        if METHODS.iter().any(|method| [method.name, method.short_name, method.key].contains(&name)) {
            return Err(format!("name: must differ from the methods of this program, found {name}"));
        }
        let name: &'static str = String::from(name).leak();
        known.push(Method { is_of_user: true, ..Method::with_step(name, name, BackendKind::Rapier) });
        Ok(known[known.len() - 1])
    }

    /// All methods and the engines of the user after them, in the order of tables.
    pub fn all() -> impl Iterator<Item = Method> {
        let of_user = OF_USER.lock().unwrap_or_else(PoisonError::into_inner).clone();
        METHODS.iter().copied().chain(of_user)
    }

    /// The methods that `verify` asks, in the order of tables.
    pub fn all_verified() -> impl Iterator<Item = Method> {
        METHODS.iter().copied().filter(|method| method.is_verified)
    }

    /// The methods with a step whose errors `verify` judges.
    pub fn all_judged() -> impl Iterator<Item = Method> {
        Self::all_verified().filter(|method| !method.is_controlled && !method.has_engine_defaults())
    }

    /// The methods with a step and with inertia whose errors `verify` judges.
    pub fn all_judged_with_inertia() -> impl Iterator<Item = Method> {
        Self::all_judged().filter(|method| method.kind.has_inertia())
    }

    /// The methods that `stress` runs, in the order of tables.
    pub fn all_stressed() -> impl Iterator<Item = Method> {
        METHODS.iter().copied().filter(|method| method.is_stressed)
    }

    /// Options at a longest step (s).
    pub fn options(&self, step_s: f64) -> BackendOptions {
        let Self { integrator, cone_solver, second_order, rapier, .. } = *self;
        BackendOptions { integrator, cone_solver, second_order, rapier, ..BackendOptions::new(self.kind, step_s) }
    }

    /// Options under error control.
    pub fn within(&self, tolerance: Tolerance) -> BackendOptions {
        BackendOptions::within(self.kind, tolerance)
    }

    /// Whether the engine runs with its own defaults, which this project does not answer for.
    pub fn has_engine_defaults(&self) -> bool {
        self.rapier.settings == EngineSettings::EngineDefaults
    }

    /// The exact method that knows the same answer better.
    pub fn exact(&self) -> Method {
        if self.kind.has_inertia() { Method::INERTIAL_MIDPOINT } else { Method::QUASI_STATIC }
    }
}

impl FromStr for Method {
    type Err = String;

    /// The method of this name, short name or key. A former key of the engine's defaults is
    /// accepted.
    fn from_str(text: &str) -> Result<Self, String> {
        let alias = "as-shipped";
        let name = text.replace(alias, "engine-defaults");
        let found = Self::all().find(|method| [method.name, method.short_name, method.key].contains(&name.as_str()));
        found.ok_or_else(|| format!("there is no method {text}"))
    }
}

impl Serialize for Method {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key)
    }
}

impl<'de> Deserialize<'de> for Method {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_and_key_names_one_method() {
        for method in METHODS.iter().copied() {
            for name in [method.name, method.short_name, method.key] {
                assert_eq!(name.parse(), Ok(method));
            }
            assert_eq!(METHODS.iter().filter(|other| other.key == method.key || other.name == method.name).count(), 1);
            assert_eq!(serde_json::from_str::<Method>(&serde_json::to_string(&method).unwrap()).unwrap(), method);
        }
        assert_eq!("rapier-as-shipped".parse(), Ok(Method::RAPIER_ENGINE_DEFAULTS));
        assert!("flying".parse::<Method>().unwrap_err().contains("flying"));
        let flying = Method::of_user("flying").unwrap();
        assert!(flying.is_of_user && Method::of_user("flying") == Ok(flying) && "flying".parse() == Ok(flying));
        assert!(Method::of_user("rapier box").unwrap_err().contains("rapier box"));
    }

    #[test]
    fn default_options_are_those_of_the_backends() {
        for (method, kind) in [(Method::INERTIAL_MIDPOINT, BackendKind::Inertial), (Method::RAPIER, BackendKind::Rapier)] {
            assert_eq!(method.options(1e-3), BackendOptions::new(kind, 1e-3));
        }
        assert_eq!(Method::RAPIER_ENGINE_DEFAULTS.options(1e-3).rapier, RapierOptions::engine_defaults());
    }
}
