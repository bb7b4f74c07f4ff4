//! One point of the plane. The same script runs with inertia and without, both under error control.

use serde::{Deserialize, Serialize};

use super::scene::{Scene, Setting, Staged};
use super::script::Script;
use super::theory;
use crate::verify::scenes::SLIP_STRETCH;
use cohaul::analysis::compare::{Difference, LEAST_HALVINGS, Solution};
use cohaul::backend::{BackendKind, Status, TransitionKind};
use cohaul::simulation::{Controller, backend_of};

/// A measured point of the plane. The distance of two poses is their edge displacement: |dx| + R
/// |dtheta|.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    pub scene: Scene,
    pub zeta: f64,
    pub phi: f64,
    pub epsilon: f64,
    /// Path length of the quasi-static solution (m).
    pub path_length_m: f64,
    /// Largest distance between the inertial and the quasi-static path (m).
    pub distance_m: f64,
    /// Part of that distance that the heading contributes (1).
    pub turn_share: f64,
    /// Reference error of the two solutions together (m).
    pub reference_error_m: f64,
    /// Largest jump of the quasi-static solution (m).
    pub jump_m: f64,
    /// Displacement of the quasi-static solution along the x axis, from start to end (m).
    pub displacement_quasi_static_m: f64,
    /// Displacement of the inertial solution along the x axis, from start to end (m).
    pub displacement_inertial_m: f64,
    /// Edge speed of the inertial solution at the end (m/s), zero once the load has come to rest.
    pub end_speed_m_per_s: f64,
    /// Whether every step of both solutions converged.
    pub is_converged: bool,
}

impl Cell {
    /// The measured cell, or `None` when `watch` returned false.
    pub fn measure(scene: Scene, at: &Setting, watch: impl Fn() -> bool + Sync) -> Option<Self> {
        let staged = scene.staged(at);
        let solve = |kind| solution(&staged, kind, &watch);
        let (still, moving) = (solve(BackendKind::QuasiStatic)?, solve(BackendKind::Inertial)?);
        let radius = staged.scenario.system.load.radius;
        let difference = Difference::between(&moving.points, &still.points, radius);
        let distance_m = difference.edge_displacement_max_m;
        let errors = [&still, &moving].map(|solution| Difference::error_of(&solution.limit, radius).edge_displacement_max_m);
        let displacement =
            |solution: &Solution| solution.points.last().map_or(0.0, |end| end.pose.position.x - solution.points[0].pose.position.x);
        let jump =
            |kind: &TransitionKind| if let TransitionKind::Jump { shift, turn, .. } = kind { shift + radius * turn.abs() } else { 0.0 };
        let end = moving.trace.rows.last().map(|row| row.motion.twist);
        Some(Self {
            scene,
            zeta: at.zeta,
            phi: at.phi,
            epsilon: at.epsilon,
            path_length_m: still.path_length(radius),
            distance_m,
            turn_share: if distance_m > 0.0 { radius * difference.heading_max_rad / distance_m } else { 0.0 },
            reference_error_m: errors[0] + errors[1],
            jump_m: still.trace.transitions.iter().map(|transition| jump(&transition.kind)).fold(0.0, f64::max),
            displacement_quasi_static_m: displacement(&still),
            displacement_inertial_m: displacement(&moving),
            end_speed_m_per_s: end.map_or(0.0, |twist| twist.edge_speed(radius)),
            is_converged: [&still, &moving].iter().all(|solution| solution.steps.status == Status::Converged),
        })
    }

    /// Whether the load moves in the quasi-static solution.
    pub fn moves(&self) -> bool {
        self.path_length_m > 1e-3 * self.epsilon * self.phi * SLIP_STRETCH
    }

    /// Largest distance divided by the quasi-static path length (1). `compare` judges by the same
    /// ratio, unless the inertial path is longer. `None` where nothing moves or a step did not
    /// converge.
    pub fn distance_ratio(&self) -> Option<f64> {
        (self.is_converged && self.moves()).then(|| self.distance_m / self.path_length_m)
    }

    /// Reference error divided by the quasi-static path length (1); `None` as in
    /// [`Cell::distance_ratio`].
    pub fn reference_error_ratio(&self) -> Option<f64> {
        (self.is_converged && self.moves()).then(|| self.reference_error_m / self.path_length_m)
    }

    /// Displacement along x with inertia divided by that without (1). `None` also where the
    /// quasi-static solution ends within 5 % of its path length from where it started.
    pub fn displacement_ratio(&self) -> Option<f64> {
        let is_displaced = self.displacement_quasi_static_m.abs() > 0.05 * self.path_length_m;
        (self.is_converged && self.moves() && is_displaced).then(|| self.displacement_inertial_m / self.displacement_quasi_static_m)
    }

    /// Whether the distance exceeds the reference error. Otherwise the cell is inconclusive.
    pub fn is_conclusive(&self) -> bool {
        self.distance_m > self.reference_error_m
    }

    /// Prediction of theory for [`Cell::distance_ratio`]. In the haul only continuous driving has a
    /// law, `2 epsilon f / k`.
    pub fn predicted_distance_ratio(&self) -> Option<f64> {
        match self.scene {
            Scene::Excursion => Some(theory::excursion_distance_ratio(self.phi, self.epsilon, self.zeta)),
            Scene::TugOfWar => Some(0.5),
            Scene::Haul => self.moves().then(|| 2.0 * self.epsilon * SLIP_STRETCH / self.path_length_m),
        }
    }

    /// Prediction of theory for [`Cell::displacement_ratio`]; `None` where theory has no law.
    pub fn predicted_displacement_ratio(&self) -> Option<f64> {
        match self.scene {
            Scene::Excursion => Some(theory::excursion(self.phi, self.epsilon, self.zeta)),
            Scene::TugOfWar => Some(theory::release(self.phi, self.epsilon, self.zeta)),
            Scene::Haul => None,
        }
    }
}

fn solution(staged: &Staged, kind: BackendKind, watch: &(impl Fn() -> bool + Sync)) -> Option<Solution> {
    let controller = || Box::new(Script::new(staged.cues.clone(), staged.scenario.system.springs.len())) as Box<dyn Controller>;
    Solution::find(&staged.scenario, &staged.options(kind), (1, LEAST_HALVINGS), &backend_of, controller, |_| watch())
}
