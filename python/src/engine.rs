//! Engines in the place of rapier: classes in Python, commands, or rapier beside them.

use std::sync::{Arc, Mutex};

use cohaul_engines::protocol::Ask;
use cohaul_engines::{Channel, Pipe, Springs};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// An engine as it is asked for.
pub enum Asked {
    Rapier,
    /// Command of a shell.
    Command(String),
    Written(Arc<Written>),
}

impl Asked {
    /// Of `"rapier"`, of a command, or of a function that makes engines.
    ///
    /// # Errors
    /// When the Python part is missing.
    pub fn new(py: Python, asked: Py<PyAny>) -> PyResult<Self> {
        match asked.extract::<String>(py) {
            Ok(name) if name == "rapier" => Ok(Self::Rapier),
            Ok(command) => Ok(Self::Command(command)),
            Err(_) => Written::new(py, asked).map(Self::Written),
        }
    }

    /// A channel to a new run.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn open(&self) -> Result<Box<dyn Channel>, String> {
        match self {
            Self::Rapier => unreachable!("rapier has no channel"),
            Self::Command(command) => Ok(Box::new(Pipe::start(command, Pipe::PATIENCE)?)),
            Self::Written(written) => written.open(),
        }
    }

    /// # Errors
    /// With what was raised.
    pub fn check(&self) -> PyResult<()> {
        if let Self::Written(written) = self { written.check() } else { Ok(()) }
    }
}

/// A function that makes engines, and the first exception that one of them raised.
pub struct Written {
    /// Makes a session, which answers requests.
    session: Py<PyAny>,
    raised: Mutex<Option<PyErr>>,
}

impl Written {
    /// # Errors
    /// When the Python part is missing.
    pub fn new(py: Python, make: Py<PyAny>) -> PyResult<Arc<Self>> {
        let class = py.import("cohaul.engines")?.getattr("Session")?;
        let partial = py.import("functools")?.getattr("partial")?;
        let session = partial.call1((class, make))?.unbind();
        Ok(Arc::new(Self { session, raised: Mutex::default() }))
    }

    /// A channel to a new run.
    ///
    /// # Errors
    /// What was raised, in words.
    pub fn open(self: &Arc<Self>) -> Result<Box<dyn Channel>, String> {
        let session = Python::with_gil(|py| self.session.call0(py)).map_err(|error| self.keep(error))?;
        Ok(Box::new(Conversation { session, written: Arc::clone(self) }))
    }

    /// # Errors
    /// With what was raised.
    pub fn check(&self) -> PyResult<()> {
        self.raised.lock().ok().and_then(|mut raised| raised.take()).map_or(Ok(()), Err)
    }

    /// Keeps an exception, and returns it in words.
    fn keep(&self, error: PyErr) -> String {
        let text = error.to_string();
        if let Ok(mut raised) = self.raised.lock() {
            raised.get_or_insert(error);
        }
        text
    }
}

/// One run of an engine.
struct Conversation {
    session: Py<PyAny>,
    written: Arc<Written>,
}

impl Channel for Conversation {
    fn exchange(&mut self, line: &str, springs: &Arc<Springs>) -> Result<String, String> {
        let answer = Python::with_gil(|py| {
            let asker = Asker { springs: Arc::clone(springs) };
            self.session.call_method1(py, "asked", (line, asker))?.extract::<String>(py)
        });
        answer.map_err(|error| self.written.keep(error))
    }
}

/// Gives the wrench of the springs to an engine that asks.
#[pyclass(frozen)]
struct Asker {
    springs: Arc<Springs>,
}

#[pymethods]
impl Asker {
    fn __call__(&self, pose: [f64; 3], twist: [f64; 3], share: f64) -> PyResult<[f64; 3]> {
        let answer = self.springs.answer(&Ask::Wrench { pose, twist, share });
        answer.map(|answer| answer.wrench).map_err(PyValueError::new_err)
    }
}
