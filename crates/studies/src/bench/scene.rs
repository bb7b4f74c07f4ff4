//! A scenario with its references, and the steps and tolerances to try.

use serde::{Deserialize, Serialize};

use super::reference::Reference;
use crate::methods::Method;
use cohaul::backend::{BackendKind, BackendOptions, Tolerance, default_step};
use cohaul::math::Twist;
use cohaul::model::Load;
use cohaul::scenario::Scenario;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// (s)
    Step(f64),
    /// Tolerance on the edge displacement (m).
    Tolerance(f64),
}

impl Level {
    /// (s)
    pub fn step(self) -> Option<f64> {
        if let Level::Step(step) = self { Some(step) } else { None }
    }

    /// (m)
    pub fn tolerance(self) -> Option<f64> {
        if let Level::Tolerance(tolerance) = self { Some(tolerance) } else { None }
    }

    /// Options of `method` at this step, or this tolerance on the edge of `load`.
    pub fn options(self, method: &Method, load: &Load) -> BackendOptions {
        match self {
            Level::Step(step) => method.options(step),
            Level::Tolerance(tolerance) => method.within(Tolerance::at_edge(tolerance, load)),
        }
    }
}

/// A scenario whose ticks are as long as the longest step that is tried: prescribed tips do not
/// read them, but rows and steps end there.
pub struct Scene {
    pub name: String,
    pub scenario: Scenario,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneFacts {
    pub scene: String,
    /// Path length of the load's edge in the longer of the references (m); errors are divided by
    /// it.
    pub path_length_m: f64,
    /// Time between two rows (s).
    pub row_period_s: f64,
    /// Inertia effect: largest edge displacement between the references without and with inertia
    /// (m); `null` where there is only one.
    pub inertia_effect_m: Option<f64>,
    /// Sources and reference errors of both references (edge displacement, m); `null` where there
    /// is none without inertia.
    pub quasi_static_reference: Option<String>,
    pub quasi_static_reference_error_m: Option<f64>,
    pub inertial_reference: String,
    pub inertial_reference_error_m: f64,
}

/// References of a scene: without inertia, where a load without it moves at all, and with it.
pub struct References {
    pub quasi_static: Option<Reference>,
    pub inertial: Reference,
}

/// Rows that a run should have at least, where its control period allows.
const ROWS: f64 = 100.0;
/// Steps without inertia and with it, each half of the one before.
const N_QUASI_STATIC: i32 = 11;
const N_INERTIAL: i32 = 10;
/// Tolerances over the length of the path (1), from a hundredth on.
const TOLERANCES: [f64; 6] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];
/// The longest step with inertia over the default one (1): four radians of the fastest oscillation.
const LONGEST: f64 = 40.0;

impl Scene {
    pub fn new(name: impl Into<String>, scenario: &Scenario) -> Self {
        let mut control_period = scenario.control_period;
        while scenario.duration >= 2.0 * ROWS * control_period {
            control_period *= 2.0;
        }
        Self { name: name.into(), scenario: Scenario { control_period, ..scenario.clone() } }
    }

    /// Whether `method` can answer: without inertia a load that starts with a speed has none, and
    /// one that neither springs nor moving obstacles act on has no path.
    pub fn asks(&self, method: &Method) -> bool {
        method.kind.has_inertia() || self.moves_without_inertia()
    }

    fn moves_without_inertia(&self) -> bool {
        let system = &self.scenario.system;
        let is_pushed = system.world.obstacles.iter().any(|obstacle| obstacle.path.moves());
        self.scenario.start.twist == Twist::ZERO && (is_pushed || !system.springs.is_empty())
    }

    /// Steps or tolerances at which `method` is tried, the coarsest first; a quick benchmark takes
    /// every second one.
    pub fn levels(&self, method: &Method, path_length: f64, is_quick: bool) -> Vec<Level> {
        let row = self.scenario.control_period;
        let all: Vec<Level> = if method.is_controlled {
            TOLERANCES.iter().map(|share| Level::Tolerance(share * path_length)).collect()
        } else if !method.kind.has_inertia() {
            (0..N_QUASI_STATIC).map(|i| Level::Step(row * 0.5f64.powi(i))).collect()
        } else {
            let longest = LONGEST * default_step(method.kind, &self.scenario.system, row);
            let halvings = (row / longest - 1e-9).max(1.0).log2().ceil() as i32;
            (0..N_INERTIAL).map(|i| Level::Step(row * 0.5f64.powi(halvings + i))).collect()
        };
        all.into_iter().step_by(if is_quick { 2 } else { 1 }).collect()
    }

    /// `watch` as in [`Reference::find`].
    ///
    /// # Errors
    /// When a reference has no finite answer.
    pub fn references(&self, mut watch: impl FnMut(f64) -> bool) -> Option<Result<References, String>> {
        let find = |kind, watch: &mut dyn FnMut(f64) -> bool| Reference::find(&self.scenario, kind, watch);
        let quasi_static =
            if self.moves_without_inertia() { Some(find(BackendKind::QuasiStatic, &mut |share| watch(0.5 * share))?) } else { None };
        let inertial = find(BackendKind::Inertial, &mut |share| watch(0.5 + 0.5 * share))?;
        Some(quasi_static.transpose().and_then(|quasi_static| Ok(References { quasi_static, inertial: inertial? })))
    }

    pub fn facts(&self, references: &References) -> SceneFacts {
        let radius = self.scenario.system.load.radius;
        let References { quasi_static, inertial } = references;
        let apart = |other: &Reference| {
            let distances = other.poses.iter().zip(&inertial.poses).map(|(one, other)| one.edge_displacement(other, radius));
            distances.fold(0.0, f64::max)
        };
        let lengths = quasi_static.iter().chain([inertial]).map(|reference| reference.path_length(radius));
        SceneFacts {
            scene: self.name.clone(),
            path_length_m: lengths.fold(0.0, f64::max),
            row_period_s: self.scenario.control_period,
            inertia_effect_m: quasi_static.as_ref().map(apart),
            quasi_static_reference: quasi_static.as_ref().map(|reference| reference.source.clone()),
            quasi_static_reference_error_m: quasi_static.as_ref().map(|reference| reference.reference_error),
            inertial_reference: inertial.source.clone(),
            inertial_reference_error_m: inertial.reference_error,
        }
    }
}

impl SceneFacts {
    /// Source and error (m) of the reference for methods of this kind.
    pub fn reference(&self, kind: BackendKind) -> (Option<&str>, Option<f64>) {
        if kind.has_inertia() {
            (Some(&self.inertial_reference), Some(self.inertial_reference_error_m))
        } else {
            (self.quasi_static_reference.as_deref(), self.quasi_static_reference_error_m)
        }
    }
}

impl References {
    /// Reference for methods of this kind.
    ///
    /// # Panics
    /// When a load without inertia has no path in the scene.
    pub fn of(&self, kind: BackendKind) -> &Reference {
        if kind.has_inertia() { &self.inertial } else { self.quasi_static.as_ref().expect("the scene was asked") }
    }
}
