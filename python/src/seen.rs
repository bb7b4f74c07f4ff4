//! What is seen of obstacles, contacts and friction, and poses that are commanded.

use cohaul::backend::{Backend, SideContact};
use cohaul::math::{Pose, Vec2};
use cohaul::model::{ObstaclePose, System};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::points::{LARGEST, array_of, index, point_array};

/// A contact for Python: obstacle, point (m, world) and force on the load (N, world).
pub type Contact = (usize, (f64, f64), (f64, f64));

/// What the obstacles and the ground do at one instant.
pub struct Seen {
    /// Poses of all obstacles (m, rad, world).
    pub obstacles: Vec<Pose>,
    contacts: Vec<SideContact>,
    /// Friction force on each support (N, world).
    friction: Vec<Vec2>,
}

impl Seen {
    /// What is seen of a backend at `time` (s).
    pub fn of(system: &System, backend: &dyn Backend, time: f64) -> Self {
        let friction = backend.friction_forces();
        if system.world.is_empty() {
            return Self { obstacles: Vec::new(), contacts: Vec::new(), friction };
        }
        let mut obstacles: Vec<Pose> = system.world.obstacles.iter().map(|obstacle| obstacle.path.pose_at(time)).collect();
        backend.steered().iter().for_each(|steered| obstacles[steered.obstacle] = steered.pose);
        Self { obstacles, contacts: backend.side_contacts(), friction }
    }

    /// x, y (m, world) and heading (rad) of each obstacle.
    pub fn obstacle_array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array_of(py, self.obstacles.iter().flat_map(|pose| [pose.position.x, pose.position.y, pose.heading]), 3)
    }

    pub fn contacts(&self) -> Vec<Contact> {
        let pair = |of: &Vec2| (of.x, of.y);
        self.contacts.iter().map(|contact| (contact.obstacle, pair(&contact.point), pair(&contact.force))).collect()
    }

    /// Sum of the forces of each obstacle on the load (N, world).
    pub fn force_array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        point_array(py, force_of_each(self.obstacles.len(), &self.contacts).into_iter())
    }

    pub fn friction_array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        point_array(py, self.friction.iter().copied())
    }
}

/// Sum of the forces of each of `n` obstacles on the load (N, world).
pub fn force_of_each(n: usize, contacts: &[SideContact]) -> Vec<Vec2> {
    let mut forces = vec![Vec2::zeros(); n];
    contacts.iter().for_each(|contact| forces[contact.obstacle] += contact.force);
    forces
}

/// Reads a pose: x, y (m, world) and heading (rad).
///
/// # Errors
/// When it is not three finite numbers.
pub fn pose(value: &Bound<PyAny>, path: &str) -> PyResult<Pose> {
    let entries = if value.is_instance_of::<PyString>() { None } else { value.extract::<Vec<f64>>().ok() };
    let Some([x, y, heading]) = entries.as_deref() else {
        let found = value.str().map_or_else(|_| "something else".to_owned(), |text| text.to_string());
        return Err(PyTypeError::new_err(format!("{path}: must be three numbers (x, y, heading), found {found}")));
    };
    match [x, y, heading].into_iter().find(|entry| entry.is_nan() || entry.abs() > LARGEST) {
        Some(entry) => Err(PyValueError::new_err(format!("{path}: must be finite and at most {LARGEST:e} in size, found {entry}"))),
        None => Ok(Pose::new(*x, *y, *heading)),
    }
}

/// Reads the poses of a mapping from obstacles, of which there are `n`.
///
/// # Errors
/// When an obstacle is not there, or a pose is none.
pub fn pushers(value: Option<&Bound<PyDict>>, n: usize) -> PyResult<Vec<ObstaclePose>> {
    let Some(given) = value else { return Ok(Vec::new()) };
    let read = |(obstacle, value): (Bound<PyAny>, Bound<PyAny>)| {
        let obstacle = index(&obstacle, "pushers: obstacle", n)?;
        Ok(ObstaclePose { obstacle, pose: pose(&value, &format!("pushers[{obstacle}]"))? })
    };
    given.iter().map(read).collect()
}
