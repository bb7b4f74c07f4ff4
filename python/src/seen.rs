//! What is seen of obstacles, contacts and friction, and poses that are commanded.

use cohaul::backend::{Backend, SideContact};
use cohaul::math::{Pose, Vec2};
use cohaul::model::{ObstaclePose, System};
use cohaul::simulation::Hand;
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
        Self { obstacles: obstacle_poses(system, backend, time), contacts: backend.side_contacts(), friction }
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

/// Poses of all obstacles at `time` (s) (m, rad, world).
pub fn obstacle_poses(system: &System, backend: &dyn Backend, time: f64) -> Vec<Pose> {
    let mut poses: Vec<Pose> = system.world.obstacles.iter().map(|obstacle| obstacle.path.pose_at(time)).collect();
    if !poses.is_empty() {
        backend.steered().iter().for_each(|steered| poses[steered.obstacle] = steered.pose);
    }
    poses
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

/// What an obstacle is sent by: a pose where it shall be, or a spring that holds it.
pub enum Push {
    To(ObstaclePose),
    By(Hand),
}

/// Commands to obstacles.
#[derive(Default)]
pub struct Pushes {
    pub poses: Vec<ObstaclePose>,
    pub hand: Option<Hand>,
}

impl Pushes {
    /// Takes a command to one of `n` obstacles.
    ///
    /// # Errors
    /// When the obstacle has one, or it is a second hand.
    pub fn add(&mut self, push: Push, n: usize) -> PyResult<()> {
        let (Push::To(ObstaclePose { obstacle, .. }) | Push::By(Hand { obstacle, .. })) = push;
        if self.poses.iter().map(|pose| pose.obstacle).chain(self.hand.map(|hand| hand.obstacle)).any(|other| other == obstacle) {
            return Err(PyValueError::new_err(format!("obstacle: must be steered once at an instant, found {obstacle} again")));
        }
        match push {
            Push::To(pose) => self.poses.push(pose),
            Push::By(hand) => {
                if let Some(other) = self.hand {
                    let found = format!("found obstacles {} and {obstacle}", other.obstacle);
                    return Err(PyValueError::new_err(format!("hand: must be the only one at an instant, {found}")));
                }
                hand.check(n).map_err(|error| PyValueError::new_err(error.to_string()))?;
                self.hand = Some(hand);
            }
        }
        Ok(())
    }
}

/// Reads what an obstacle is sent by: a pose, or a `cohaul.Hand`.
///
/// # Errors
/// When it is neither.
pub fn push(obstacle: usize, value: &Bound<PyAny>, path: &str) -> PyResult<Push> {
    if !value.hasattr("target_m")? {
        return Ok(Push::To(ObstaclePose { obstacle, pose: pose(value, path)? }));
    }
    let pair = |name: &str| value.getattr(name)?.extract::<(f64, f64)>().map(|(x, y)| Vec2::new(x, y));
    let number = |name: &str| value.getattr(name)?.extract::<f64>();
    let (target, axis) = (pair("target_m")?, pair("axis")?);
    let [stiffness, force_limit] = [number("stiffness_n_per_m")?, number("force_limit_n")?];
    Ok(Push::By(Hand { obstacle, target, axis, stiffness, force_limit }))
}

/// Reads the commands of a mapping from obstacles, of which there are `n`.
///
/// # Errors
/// When an obstacle is not there, or a command is none.
pub fn pushers(value: Option<&Bound<PyDict>>, n: usize) -> PyResult<Pushes> {
    let mut pushes = Pushes::default();
    for (obstacle, value) in value.into_iter().flatten() {
        let obstacle = index(&obstacle, "pushers: obstacle", n)?;
        pushes.add(push(obstacle, &value, &format!("pushers[{obstacle}]"))?, n)?;
    }
    Ok(pushes)
}
