//! A controller that is written in Python: a function of what it sees, once in each control period.

use std::sync::{Arc, Mutex};

use cohaul::backend::Motion;
use cohaul::math::{Pose, Vec2};
use cohaul::model::ObstaclePose;
use cohaul::scenario::Scenario;
use cohaul::simulation::{self, Commands, Controller, Event, EventKind, Hand, HandError};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::points::{index, point, point_array, points};
use crate::seen::{Contact, Pushes, Seen};

/// A Python function that decides, and the first exception that it raised.
pub struct Written {
    decide: Py<PyAny>,
    raised: Mutex<Option<PyErr>>,
}

/// What a controller sees of a run, and where its commands go.
#[pyclass(module = "cohaul")]
pub struct View {
    time_s: f64,
    until_s: f64,
    motion: Motion,
    tips: Vec<Option<Vec2>>,
    pulls: Vec<Vec2>,
    seen: Seen,
    events: Vec<(EventKind, usize)>,
    /// Where obstacles shall be at the end of the control period, and what holds one of them.
    pushes: Pushes,
    is_finished: bool,
}

/// One run of a [`Written`] controller.
pub struct Instance {
    written: Arc<Written>,
    /// Tips at the start and at the end of the control period (m, world).
    period: [Vec<Vec2>; 2],
    /// Start and end of the control period (s).
    times: [f64; 2],
    targets: Vec<Vec2>,
    /// Obstacles that are steered: poses at the start and at the end of the control period.
    steered: Vec<(Pose, ObstaclePose)>,
    pushers: Vec<ObstaclePose>,
    /// What is held until the end of the control period.
    hand: Option<Hand>,
    is_finished: Option<bool>,
}

impl Written {
    pub fn new(decide: Py<PyAny>) -> Arc<Self> {
        Arc::new(Self { decide, raised: Mutex::default() })
    }

    pub fn instance(self: &Arc<Self>, scenario: &Scenario) -> Instance {
        let still = vec![Vec2::zeros(); scenario.system.springs.len()];
        Instance {
            written: Arc::clone(self),
            period: [still.clone(), still.clone()],
            times: [0.0; 2],
            targets: still,
            steered: Vec::new(),
            pushers: Vec::new(),
            hand: None,
            is_finished: None,
        }
    }

    /// Whether nothing was raised so far.
    pub fn is_well(&self) -> bool {
        self.raised.lock().is_ok_and(|raised| raised.is_none())
    }

    /// # Errors
    /// With what was raised.
    pub fn check(&self) -> PyResult<()> {
        self.raised.lock().ok().and_then(|mut raised| raised.take()).map_or(Ok(()), Err)
    }

    fn keep(&self, error: PyErr) {
        if let Ok(mut raised) = self.raised.lock() {
            raised.get_or_insert(error);
        }
    }
}

/// A Python function that makes a controller for a seed, and the controllers that it made.
pub struct Makers {
    make: Py<PyAny>,
    made: Mutex<Vec<Arc<Written>>>,
    failed: Arc<Written>,
}

impl Makers {
    pub fn new(make: Py<PyAny>) -> Self {
        let failed = Python::with_gil(|py| Written::new(py.None()));
        Self { make, made: Mutex::default(), failed }
    }

    /// The controller of a run. If it cannot be made, one that does nothing: the run ends at once.
    pub fn controller(&self, scenario: &Scenario) -> Box<dyn Controller> {
        let made = Python::with_gil(|py| self.make.call1(py, (scenario.seed,)));
        let written = match made {
            Ok(decide) => Written::new(decide),
            Err(error) => {
                self.failed.keep(error);
                Arc::clone(&self.failed)
            }
        };
        if let Ok(mut made) = self.made.lock() {
            made.push(Arc::clone(&written));
        }
        Box::new(written.instance(scenario))
    }

    pub fn are_well(&self) -> bool {
        self.made.lock().is_ok_and(|made| made.iter().all(|written| written.is_well()))
    }

    /// # Errors
    /// With the first exception of a controller.
    pub fn check(&self) -> PyResult<()> {
        self.made.lock().map_or(Ok(()), |made| made.iter().try_for_each(|written| written.check()))
    }
}

impl Instance {
    fn ask(&mut self, py: Python, view: &simulation::View, commands: &mut Commands) -> PyResult<()> {
        let springs = 0..view.scenario.system.springs.len();
        let seen = View {
            time_s: view.time,
            until_s: view.time + view.scenario.control_period,
            motion: view.motion,
            tips: springs.clone().map(|spring| view.backend.tip(spring)).collect(),
            pulls: springs.map(|spring| view.pull(spring)).collect(),
            seen: Seen::of(&view.scenario.system, view.backend, view.time),
            events: Vec::new(),
            pushes: Pushes::default(),
            is_finished: false,
        };
        let seen = Bound::new(py, seen)?;
        let answer = self.written.decide.bind(py).call1((&seen,))?;
        let seen = seen.try_borrow()?;
        let [start, end] = &mut self.period;
        for (tip, start) in seen.tips.iter().zip(start.iter_mut()) {
            *start = tip.unwrap_or_default();
        }
        match answer.is_none() {
            true => end.clone_from(start),
            false => points(&answer, start.len(), end, |spring| seen.tips[spring].is_some())?,
        }
        for kind in [EventKind::Release, EventKind::Grasp] {
            let of_kind = seen.events.iter().filter(|(of, _)| *of == kind);
            commands.events.extend(of_kind.map(|(kind, spring)| Event {
                time: view.time,
                kind: *kind,
                spring: *spring,
                ant: None,
                tip: seen.tips[*spring].or(view.backend.tip(*spring)).unwrap_or_default(),
            }));
        }
        self.steered.clear();
        self.steered.extend(seen.pushes.poses.iter().map(|target| (seen.seen.obstacles[target.obstacle], *target)));
        self.hand = seen.pushes.hand;
        self.times = [seen.time_s, seen.until_s];
        self.is_finished = self.is_finished.or(seen.is_finished.then_some(true));
        Ok(())
    }
}

impl Instance {
    /// Share of the control period at a time (s); `None` at its end.
    fn share(&self, until: f64) -> Option<f64> {
        let [from, to] = self.times;
        Some((until - from) / (to - from)).filter(|share| *share <= 1.0 - 1e-9)
    }
}

impl Controller for Instance {
    fn decide(&mut self, view: &simulation::View, commands: &mut Commands) {
        if view.tick.is_some() && self.written.is_well() {
            Python::with_gil(|py| self.ask(py, view, commands)).unwrap_or_else(|error| {
                commands.events.clear();
                self.steered.clear();
                self.hand = None;
                self.written.keep(error);
            });
        }
    }

    fn targets(&mut self, _view: &simulation::View, until: f64) -> &[Vec2] {
        let (share, [start, end]) = (self.share(until), &self.period);
        for ((target, start), end) in self.targets.iter_mut().zip(start).zip(end) {
            *target = share.map_or(*end, |share| start + share * (end - start));
        }
        &self.targets
    }

    fn pushers(&mut self, _view: &simulation::View, until: f64) -> &[ObstaclePose] {
        let share = self.share(until);
        let part = |(start, end): &(Pose, ObstaclePose)| {
            let pose = share.map_or(end.pose, |share| start.towards(&end.pose, share));
            ObstaclePose { pose, ..*end }
        };
        self.pushers.clear();
        self.pushers.extend(self.steered.iter().map(part));
        &self.pushers
    }

    fn hand(&mut self, _view: &simulation::View, _until: f64) -> Option<Hand> {
        self.hand
    }

    fn cannot_push(&mut self, error: HandError) {
        self.written.keep(PyValueError::new_err(error.to_string()));
    }

    fn arrived(&self, _motion: &Motion) -> Option<bool> {
        self.is_finished
    }
}

#[pymethods]
impl View {
    /// Time of the instant (s).
    #[getter]
    fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Time until the tips are where the controller sends them (s).
    #[getter]
    fn control_period_s(&self) -> f64 {
        self.until_s - self.time_s
    }

    /// Number of springs (1).
    #[getter]
    fn n_springs(&self) -> usize {
        self.tips.len()
    }

    /// Position (m, world) and heading (rad) of the load: (x, y, heading).
    #[getter]
    fn pose(&self) -> (f64, f64, f64) {
        let pose = &self.motion.pose;
        (pose.position.x, pose.position.y, pose.heading)
    }

    /// Velocity (m/s, world) and turn rate (rad/s) of the load.
    #[getter]
    fn twist(&self) -> (f64, f64, f64) {
        let twist = &self.motion.twist;
        (twist.linear.x, twist.linear.y, twist.angular)
    }

    /// Whether each spring is attached.
    #[getter]
    fn attached(&self) -> Vec<bool> {
        self.tips.iter().map(Option::is_some).collect()
    }

    /// Tip of each spring (m, world); NaN for a free one.
    #[getter]
    fn tips<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        point_array(py, self.tips.iter().map(|tip| tip.unwrap_or(Vec2::new(f64::NAN, f64::NAN))))
    }

    /// Pull on the tip of each spring (N, world); zero for a free one.
    #[getter]
    fn pulls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        point_array(py, self.pulls.iter().copied())
    }

    /// x, y (m, world) and heading (rad) of each obstacle.
    #[getter]
    fn obstacles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.seen.obstacle_array(py)
    }

    /// Contacts with obstacles in the last step: obstacle, point (m, world), and force on the load
    /// (N, world).
    #[getter]
    fn contacts(&self) -> Vec<Contact> {
        self.seen.contacts()
    }

    /// Force of each obstacle on the load in the last step (N, world).
    #[getter]
    fn contact_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.seen.force_array(py)
    }

    /// Friction force of the ground on each support in the last step (N, world).
    #[getter]
    fn friction_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.seen.friction_array(py)
    }

    /// Sends an obstacle straight to `pose` (x, y in m, heading in rad, world) by the end of the
    /// control period, or pushes it by the spring of a hand. It leaves the path of the scenario for
    /// good.
    fn steer(&mut self, obstacle: &Bound<PyAny>, pose: &Bound<PyAny>) -> PyResult<()> {
        let n = self.seen.obstacles.len();
        self.pushes.add(crate::seen::push(index(obstacle, "obstacle", n)?, pose, "pose")?, n)
    }

    /// Attaches a free spring with its tip at `tip` (m, world).
    fn attach(&mut self, spring: &Bound<PyAny>, tip: &Bound<PyAny>) -> PyResult<()> {
        let (tip, spring) = (point(tip)?, must_be(&self.tips, spring, false)?);
        self.once(spring)?;
        self.tips[spring] = Some(tip);
        self.events.push((EventKind::Grasp, spring));
        Ok(())
    }

    /// Releases an attached spring.
    fn release(&mut self, spring: &Bound<PyAny>) -> PyResult<()> {
        let spring = must_be(&self.tips, spring, true)?;
        self.once(spring)?;
        self.tips[spring] = None;
        self.pulls[spring] = Vec2::zeros();
        self.events.push((EventKind::Release, spring));
        Ok(())
    }

    /// Ends the run at the next tick: the load has arrived.
    fn finish(&mut self) {
        self.is_finished = true;
    }
}

impl View {
    fn once(&self, spring: usize) -> PyResult<()> {
        match self.events.iter().any(|(_, other)| *other == spring) {
            true => Err(PyValueError::new_err(format!("spring: must be attached or released once at an instant, found {spring} again"))),
            false => Ok(()),
        }
    }
}

/// The index of a spring that is attached, or is not.
///
/// # Errors
/// When there is no such spring, or it is attached and must not be, or the reverse.
pub fn must_be(tips: &[Option<Vec2>], spring: &Bound<PyAny>, attached: bool) -> PyResult<usize> {
    let spring = index(spring, "spring", tips.len())?;
    match (tips[spring].is_some(), attached) {
        (true, false) => Err(PyValueError::new_err(format!("spring: must be free, found {spring}, which is attached"))),
        (false, true) => Err(PyValueError::new_err(format!("spring: must be attached, found {spring}, which is free"))),
        _ => Ok(spring),
    }
}
