//! The list of backends with what is true of each, and the options of a run.

use serde::{Deserialize, Serialize};

use super::exact::Integrator;
use super::friction::ConeSolver;
use super::rapier::{Precision, RapierOptions};
use super::report::Skips;
use super::tolerance::Tolerance;

/// The ways to move a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BackendKind {
    /// The paper's max-min step, without inertia.
    QuasiStatic,
    /// The quasi-static step with the mass matrix added: the reference dynamics.
    Inertial,
    /// The rigid-body engine rapier2d.
    Rapier,
}

/// An option that only some backends read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// [`BackendOptions::integrator`].
    Integrator,
    /// [`BackendOptions::cone_solver`].
    ConeSolver,
    /// [`BackendOptions::second_order`].
    SecondOrder,
    /// [`BackendOptions::adapts_step`].
    AdaptsStep,
    /// [`BackendOptions::rate_independent`], which is read under error control as well.
    RateIndependent,
    /// [`BackendOptions::rapier`].
    Engine,
}

/// What is true of a backend.
struct Properties {
    name: &'static str,
    has_inertia: bool,
    is_exact: bool,
    reads: &'static [Setting],
}

impl BackendKind {
    /// All backends, the simplest first.
    pub const ALL: [BackendKind; 3] = [BackendKind::QuasiStatic, BackendKind::Inertial, BackendKind::Rapier];
    /// The backends that a comparison runs, in the order of its traces: without inertia, with
    /// inertia, and the engine.
    pub const COMPARED: [BackendKind; 3] = [BackendKind::QuasiStatic, BackendKind::Inertial, BackendKind::Rapier];

    const fn properties(self) -> Properties {
        match self {
            BackendKind::QuasiStatic => {
                let reads = &[Setting::ConeSolver, Setting::SecondOrder, Setting::RateIndependent];
                Properties { name: "quasi-static", has_inertia: false, is_exact: true, reads }
            }
            BackendKind::Inertial => {
                Properties { name: "inertial", has_inertia: true, is_exact: true, reads: &[Setting::Integrator, Setting::AdaptsStep] }
            }
            BackendKind::Rapier => Properties { name: "rapier", has_inertia: true, is_exact: false, reads: &[Setting::Engine] },
        }
    }

    /// Name in options, files and reports.
    pub const fn name(self) -> &'static str {
        self.properties().name
    }

    /// Whether the mass of the load matters.
    pub const fn has_inertia(self) -> bool {
        self.properties().has_inertia
    }

    /// Whether springs and friction are solved exactly. Only such a backend has error control, an
    /// estimate of its error, and transitions of the contact mode.
    pub const fn is_exact(self) -> bool {
        self.properties().is_exact
    }

    /// Whether the inertia effect is estimated along a run: that needs an exact solution without
    /// inertia.
    pub const fn has_inertia_estimate(self) -> bool {
        self.is_exact() && !self.has_inertia()
    }

    /// Whether this backend reads an option that not all backends read.
    pub fn reads(self, setting: Setting) -> bool {
        self.properties().reads.contains(&setting)
    }

    /// Names of the backends of which `is_asked` holds, in words: `inertial and rapier`.
    pub fn names_of(is_asked: impl Fn(Self) -> bool) -> String {
        let names: Vec<&str> = Self::ALL.into_iter().filter(|kind| is_asked(*kind)).map(Self::name).collect();
        match names.split_last() {
            Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
            _ => names.concat(),
        }
    }

    /// The rule that a tolerance for a backend without error control breaks.
    pub fn tolerance_rule(self) -> String {
        format!("applies to {} only; the steps of {} are fixed", Self::names_of(Self::is_exact), self.name())
    }
}

/// How to move the load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BackendOptions {
    /// The backend.
    pub kind: BackendKind,
    /// Longest step (s). A duration is divided into the fewest equal steps that do not exceed it.
    /// The step is infinite under error control.
    #[serde(default = "unlimited", skip_serializing_if = "is_unlimited")]
    pub step_s: f64,
    /// Error control in place of the step, for exact backends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<Tolerance>,
    /// Integrator of the inertial backend at a fixed step.
    pub integrator: Integrator,
    /// Options of the engine.
    pub rapier: RapierOptions,
    /// Work that is left out because its outcome is known.
    #[serde(default, skip_serializing_if = "is_default")]
    pub skips: Skips,
    /// Solver of the friction problem of the quasi-static backend at a fixed step.
    #[serde(default, skip_serializing_if = "is_default")]
    pub cone_solver: ConeSolver,
    /// Whether quasi-static steps of fixed length are of second order while the load keeps
    /// slipping.
    #[serde(default, skip_serializing_if = "is_default")]
    pub second_order: bool,
    /// Whether the inertial backend takes shorter steps where the attached springs are deformed so
    /// far that the load oscillates much faster than on springs at rest. The default step does so.
    #[serde(default, skip_serializing_if = "is_default")]
    pub adapts_step: bool,
    /// Whether the quasi-static backend leaves the dashpots of the springs out, as the paper does:
    /// then the path of the load does not depend on the speed of the tips.
    #[serde(default, skip_serializing_if = "is_default")]
    pub rate_independent: bool,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn unlimited() -> f64 {
    f64::INFINITY
}

fn is_unlimited(step: &f64) -> bool {
    step.is_infinite()
}

impl BackendOptions {
    /// Default options with this longest step (s).
    pub fn new(kind: BackendKind, step_s: f64) -> Self {
        Self {
            kind,
            step_s,
            tolerance: None,
            integrator: Integrator::default(),
            rapier: RapierOptions::default(),
            skips: Skips::ALL,
            cone_solver: ConeSolver::Exact,
            second_order: false,
            adapts_step: false,
            rate_independent: false,
        }
    }

    /// Default options of an exact backend under error control.
    pub fn within(kind: BackendKind, tolerance: Tolerance) -> Self {
        Self { tolerance: Some(tolerance), ..Self::new(kind, f64::INFINITY) }
    }

    /// Whether a run with these options reads an option that not all backends read.
    pub fn reads(&self, setting: Setting) -> bool {
        self.kind.reads(setting) && (self.tolerance.is_none() || setting == Setting::RateIndependent)
    }

    /// Whether the load is moved in single precision.
    pub fn is_single_precision(&self) -> bool {
        self.kind.reads(Setting::Engine) && self.rapier.precision != Precision::F64
    }
}
