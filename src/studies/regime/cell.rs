//! One point of the plane: the same script with inertia and without, both under error control.

use serde::{Deserialize, Serialize};

use super::scene::{Scene, Setting, Staged};
use super::script::Script;
use super::theory;
use crate::analysis::compare::{Difference, Solution};
use crate::backend::{BackendKind, Status, TransitionKind};
use crate::simulation::{Controller, backend_of};
use crate::studies::verify::scenes::SLIP_STRETCH;

/// A point of the plane, measured. Ways and distances are those of the rim: shift plus radius times
/// turn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    pub scene: Scene,
    pub zeta: f64,
    pub phi: f64,
    pub epsilon: f64,
    /// Length of the way without inertia (m).
    pub way_m: f64,
    /// Largest distance of the two paths (m), and the part of it that is turn (1).
    pub distance_m: f64,
    pub turn_share: f64,
    /// How far the two may still be wrong (m).
    pub own_error_m: f64,
    /// Largest jump of the load without inertia (m).
    pub jump_m: f64,
    /// Shifts along the x axis from start to end (m).
    pub shift_quasi_static_m: f64,
    pub shift_inertial_m: f64,
    /// Speed of the rim at the end (m/s): zero once the load has come to rest.
    pub end_speed_m_per_s: f64,
    pub is_converged: bool,
}

impl Cell {
    /// `None` when `watch` said to stop.
    pub fn measure(scene: Scene, at: &Setting, watch: impl Fn() -> bool + Sync) -> Option<Self> {
        let staged = scene.staged(at);
        let solve = |kind| solution(&staged, kind, &watch);
        let (still, moving) = (solve(BackendKind::QuasiStatic)?, solve(BackendKind::Inertial)?);
        let radius = staged.scenario.system.load.radius;
        let apart = Difference::between(&moving.points, &still.points, radius);
        let distance_m = apart.edge_displacement_max_m;
        let own = [&still, &moving].map(|solution| Difference::error_of(&solution.limit, radius).edge_displacement_max_m);
        let shift =
            |solution: &Solution| solution.points.last().map_or(0.0, |end| end.pose.position.x - solution.points[0].pose.position.x);
        let jump =
            |kind: &TransitionKind| if let TransitionKind::Jump { shift, turn, .. } = kind { shift + radius * turn.abs() } else { 0.0 };
        let end = moving.trace.rows.last().map(|row| row.motion.twist);
        Some(Self {
            scene,
            zeta: at.zeta,
            phi: at.phi,
            epsilon: at.epsilon,
            way_m: still.path_length(radius),
            distance_m,
            turn_share: if distance_m > 0.0 { radius * apart.heading_max_rad / distance_m } else { 0.0 },
            own_error_m: own[0] + own[1],
            jump_m: still.trace.transitions.iter().map(|transition| jump(&transition.kind)).fold(0.0, f64::max),
            shift_quasi_static_m: shift(&still),
            shift_inertial_m: shift(&moving),
            end_speed_m_per_s: end.map_or(0.0, |twist| twist.edge_speed(radius)),
            is_converged: [&still, &moving].iter().all(|solution| solution.steps.status == Status::Converged),
        })
    }

    /// Whether the load without inertia goes anywhere.
    pub fn moves(&self) -> bool {
        self.way_m > 1e-3 * self.epsilon * self.phi * SLIP_STRETCH
    }

    /// Largest distance over the way without inertia (1), by which verdicts go too unless the load
    /// with inertia gets farther; `None` where nothing moves or no end was found.
    pub fn share(&self) -> Option<f64> {
        (self.is_converged && self.moves()).then(|| self.distance_m / self.way_m)
    }

    /// Own error over the way (1).
    pub fn own_share(&self) -> Option<f64> {
        (self.is_converged && self.moves()).then(|| self.own_error_m / self.way_m)
    }

    /// Shift with inertia over that without (1).
    pub fn displacement_ratio(&self) -> Option<f64> {
        let goes = self.shift_quasi_static_m.abs() > 0.05 * self.way_m;
        (self.is_converged && self.moves() && goes).then(|| self.shift_inertial_m / self.shift_quasi_static_m)
    }

    /// Whether the distance is above what errors of the paths could make of nothing.
    pub fn is_resolved(&self) -> bool {
        self.distance_m > 3.0 * self.own_error_m
    }

    /// What theory expects of [`Cell::share`]. In the haul, where only continuous driving has a
    /// law, `2 epsilon f / k`.
    pub fn predicted_share(&self) -> Option<f64> {
        match self.scene {
            Scene::Excursion => Some(theory::excursion_share(self.phi, self.epsilon, self.zeta)),
            Scene::TugOfWar => Some(0.5),
            Scene::Haul => self.moves().then(|| 2.0 * self.epsilon * SLIP_STRETCH / self.way_m),
        }
    }

    /// What theory expects of [`Cell::displacement_ratio`]; `None` where there is none.
    pub fn predicted_ratio(&self) -> Option<f64> {
        match self.scene {
            Scene::Excursion => Some(theory::excursion(self.phi, self.epsilon, self.zeta)),
            Scene::TugOfWar => Some(theory::release(self.phi, self.epsilon, self.zeta)),
            Scene::Haul => None,
        }
    }
}

fn solution(staged: &Staged, kind: BackendKind, watch: &(impl Fn() -> bool + Sync)) -> Option<Solution> {
    let controller = || Box::new(Script::new(staged.cues.clone(), staged.scenario.system.springs.len())) as Box<dyn Controller>;
    Solution::find(&staged.scenario, &staged.options(kind), 1, &backend_of, controller, |_| watch())
}
