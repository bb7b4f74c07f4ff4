//! Columns of a trace. numpy reads them where they are, through the array interface.

use std::mem::size_of;
use std::sync::Arc;

use cohaul::model::World;
use cohaul::scenario::Scenario;
use cohaul::simulation::{Row, Trace};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::seen::force_of_each;

/// Trace of a run.
#[pyclass(frozen, module = "cohaul._native")]
pub struct TraceData {
    trace: Arc<Trace>,
    n_springs: usize,
    /// Obstacles on the paths of the scenario.
    world: World,
}

/// Numbers in memory that this object keeps alive and nobody changes.
#[pyclass(frozen, module = "cohaul._native")]
pub struct Column {
    _owner: Owner,
    address: usize,
    /// Length, and bytes from one entry to the next, along each axis.
    axes: Vec<(usize, usize)>,
}

/// What holds the numbers of a column.
#[expect(dead_code, reason = "it is held, so that the memory stays")]
enum Owner {
    Rows(Arc<Trace>),
    Numbers(Arc<Vec<f64>>),
}

/// Columns that are fields of a row, and are read in place.
const IN_PLACE: [&str; 11] = [
    "time_s",
    "x_m",
    "y_m",
    "heading_rad",
    "vx_m_per_s",
    "vy_m_per_s",
    "turn_rate_rad_per_s",
    "elastic_j",
    "kinetic_j",
    "friction_j",
    "tip_work_j",
];

/// Columns that are computed from the rows.
const COMPUTED: [&str; 8] =
    ["dissipated_j", "defect_j", "interaction_n", "n_transporting", "tips_m", "pulls_n", "obstacles", "contact_forces_n"];

fn field<'a>(row: &'a Row, name: &str) -> Option<&'a f64> {
    let Row { time, motion, energy, .. } = row;
    Some(match name {
        "time_s" => time,
        "x_m" => &motion.pose.position.x,
        "y_m" => &motion.pose.position.y,
        "heading_rad" => &motion.pose.heading,
        "vx_m_per_s" => &motion.twist.linear.x,
        "vy_m_per_s" => &motion.twist.linear.y,
        "turn_rate_rad_per_s" => &motion.twist.angular,
        "elastic_j" => &energy.elastic,
        "kinetic_j" => &energy.kinetic,
        "friction_j" => &energy.friction,
        "tip_work_j" => &energy.tip_work,
        _ => return None,
    })
}

impl TraceData {
    pub fn new(trace: Arc<Trace>, scenario: &Scenario) -> Self {
        Self { trace, n_springs: scenario.system.springs.len(), world: scenario.system.world.clone() }
    }

    /// One number of each row.
    fn numbers(&self, of: impl Fn(&Row) -> f64) -> Column {
        Column::of_numbers(self.trace.rows.iter().map(of).collect::<Vec<f64>>(), &[self.trace.rows.len()])
    }

    /// So many numbers of each obstacle in each row.
    fn of_obstacles<const N: usize>(&self, of: impl Fn(&Row) -> Vec<[f64; N]>) -> Column {
        let numbers: Vec<f64> = self.trace.rows.iter().flat_map(|row| of(row).into_iter().flatten()).collect();
        Column::of_numbers(numbers, &[self.trace.rows.len(), self.world.obstacles.len(), N])
    }

    /// x, y and heading of each obstacle.
    fn poses(&self, row: &Row) -> Vec<[f64; 3]> {
        let pose = |(index, obstacle)| {
            let pose = row.pose_of(index, obstacle);
            [pose.position.x, pose.position.y, pose.heading]
        };
        self.world.obstacles.iter().enumerate().map(pose).collect()
    }

    /// Two numbers of each spring in each row; NaN for a free spring.
    fn pairs(&self, of: impl Fn(&cohaul::simulation::AttachedTip) -> [f64; 2]) -> Column {
        let width = 2 * self.n_springs;
        let mut numbers = vec![f64::NAN; self.trace.rows.len() * width];
        for (row, out) in self.trace.rows.iter().zip(numbers.chunks_exact_mut(width.max(1))) {
            row.tips.iter().for_each(|tip| out[2 * tip.spring..2 * tip.spring + 2].copy_from_slice(&of(tip)));
        }
        Column::of_numbers(numbers, &[self.trace.rows.len(), self.n_springs, 2])
    }
}

#[pymethods]
impl TraceData {
    fn __len__(&self) -> usize {
        self.trace.rows.len()
    }

    #[staticmethod]
    fn names() -> Vec<&'static str> {
        IN_PLACE.into_iter().chain(COMPUTED).collect()
    }

    fn column(&self, py: Python, name: &str) -> PyResult<Column> {
        let first = self.trace.rows.first().and_then(|row| field(row, name));
        if let Some(first) = first {
            let axes = vec![(self.trace.rows.len(), size_of::<Row>())];
            return Ok(Column { _owner: Owner::Rows(Arc::clone(&self.trace)), address: std::ptr::from_ref(first).addr(), axes });
        }
        py.allow_threads(|| {
            Ok(match name {
                "dissipated_j" => self.numbers(|row| row.energy.dissipated()),
                "defect_j" => self.numbers(|row| row.energy.defect()),
                "interaction_n" => self.numbers(Row::interaction),
                "n_transporting" => self.numbers(|row| row.tips.len() as f64),
                "tips_m" => self.pairs(|tip| [tip.position.x, tip.position.y]),
                "obstacles" => self.of_obstacles(|row| self.poses(row)),
                "contact_forces_n" => self.of_obstacles(|row| {
                    force_of_each(self.world.obstacles.len(), &row.contacts).iter().map(|force| [force.x, force.y]).collect()
                }),
                "pulls_n" => self.pairs(|tip| [tip.pull.x, tip.pull.y]),
                _ if IN_PLACE.contains(&name) => Column::of_numbers(Vec::new(), &[0]),
                _ => return Err(PyKeyError::new_err(format!("{name}: must be one of {}", Self::names().join(", ")))),
            })
        })
    }

    /// Time (s), kind, spring, ant and tip (m, world) of each grasp and release.
    #[expect(clippy::type_complexity, reason = "a tuple for Python")]
    fn events(&self) -> Vec<(f64, &'static str, usize, Option<usize>, (f64, f64))> {
        self.trace.events.iter().map(|of| (of.time, of.kind.name(), of.spring, of.ant, (of.tip.x, of.tip.y))).collect()
    }

    /// Instants at which the motion is not smooth, as JSON.
    fn transitions(&self) -> String {
        serde_json::to_string(&self.trace.transitions).expect("transitions are plain data")
    }
}

impl Column {
    pub fn of_numbers(numbers: impl Into<Arc<Vec<f64>>>, shape: &[usize]) -> Self {
        let numbers = numbers.into();
        let mut axes: Vec<(usize, usize)> = shape.iter().map(|n| (*n, size_of::<f64>())).collect();
        for at in (1..axes.len()).rev() {
            axes[at - 1].1 = axes[at].0 * axes[at].1;
        }
        Self { address: numbers.as_ptr().addr(), _owner: Owner::Numbers(numbers), axes }
    }
}

#[pymethods]
impl Column {
    /// The array interface of numpy, version 3: read-only.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let interface = PyDict::new(py);
        let little = if cfg!(target_endian = "little") { "<f8" } else { ">f8" };
        interface.set_item("version", 3)?;
        interface.set_item("typestr", little)?;
        interface.set_item("data", (self.address, true))?;
        interface.set_item("shape", PyTuple::new(py, self.axes.iter().map(|(n, _)| *n))?)?;
        interface.set_item("strides", PyTuple::new(py, self.axes.iter().map(|(_, bytes)| *bytes))?)?;
        Ok(interface)
    }
}
