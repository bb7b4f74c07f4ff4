//! A grid of two parameters over a scene.

use crate::runner::Effort;
use cohaul::scenario::{Scenario, ScenarioError};

#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Name with its unit, as in `step_s`.
    pub name: &'static str,
    pub values: Vec<f64>,
    /// Names in place of numbers: the values are then 0, 1, 2 ...
    pub names: Vec<String>,
}

impl Axis {
    /// `n` values from `low` to `high`, both above zero, by equal factors.
    pub fn log(name: &'static str, low: f64, high: f64, n: usize) -> Self {
        let (low, high) = (low.log10(), high.log10());
        let value = |i: usize| 10f64.powf(low + (high - low) * i as f64 / (n - 1) as f64);
        Self { name, values: (0..n).map(value).collect(), names: Vec::new() }
    }

    /// `n` values from `low` to `high` in equal steps.
    pub fn linear(name: &'static str, low: f64, high: f64, n: usize) -> Self {
        Self { name, values: (0..n).map(|i| low + (high - low) * i as f64 / (n - 1) as f64).collect(), names: Vec::new() }
    }

    /// Whole numbers from `low` to `high` by about equal factors, each once.
    pub fn counts(name: &'static str, low: f64, high: f64, n: usize) -> Self {
        let mut axis = Self::log(name, low, high, n);
        axis.values.iter_mut().for_each(|value| *value = value.round());
        axis.values.dedup();
        axis
    }

    pub fn of_names(name: &'static str, names: Vec<String>) -> Self {
        Self { name, values: (0..names.len()).map(|i| i as f64).collect(), names }
    }

    /// The axis with zero before all values.
    pub fn and_zero(mut self) -> Self {
        self.values.insert(0, 0.0);
        self
    }

    /// At most `n` values (two or more), spread evenly, the first and the last among them.
    pub fn thinned(&self, n: usize) -> Self {
        let len = self.values.len();
        if len <= n {
            return self.clone();
        }
        let kept = |i: usize| i * (len - 1) / (n - 1);
        let names = if self.names.is_empty() { Vec::new() } else { (0..n).map(|i| self.names[kept(i)].clone()).collect() };
        Self { values: (0..n).map(|i| self.values[kept(i)]).collect(), names, ..*self }
    }
}

/// A map: what is stressed, and the scene at each of its cells.
#[derive(Clone, Debug)]
pub struct Map {
    pub name: &'static str,
    /// What is done, and what is known of the answer.
    pub what: &'static str,
    pub x: Axis,
    pub y: Axis,
    pub cell: fn(f64, f64) -> Cell,
}

impl Map {
    pub fn n_cells(&self) -> usize {
        self.x.values.len() * self.y.values.len()
    }

    /// Parameters of the cell of this index; x is the faster one.
    pub fn parameters(&self, index: usize) -> [f64; 2] {
        let n = self.x.values.len();
        [self.x.values[index % n], self.y.values[index / n]]
    }

    /// The map, or one of four values an axis, the extreme ones among them.
    pub fn at(&self, effort: Effort) -> Self {
        match effort {
            Effort::Full => self.clone(),
            Effort::Quick => Self { x: self.x.thinned(4), y: self.y.thinned(4), ..self.clone() },
        }
    }
}

/// One cell: a scenario, or why there is none, and what is asked of it. Its control period is the
/// step.
#[derive(Debug)]
pub struct Cell {
    pub scenario: Result<Scenario, ScenarioError>,
    pub asked: Asked,
}

#[derive(Debug, Default)]
pub struct Asked {
    /// Pulls stay below the limit: nothing may move.
    pub sticks: bool,
    /// The scene is its own mirror image in the x axis: nothing may leave the axis.
    pub symmetric: bool,
    /// Moving obstacles leave the load less room than it needs by this length (m), so that the
    /// scene has no answer; `None` where the load has room.
    pub squeeze: Option<f64>,
    pub answer: Answer,
}

impl Asked {
    /// The answer of an exact backend at finer steps.
    pub fn finer() -> Self {
        Self { answer: Answer::Finer, ..Self::default() }
    }

    /// A known shift along the axis of a symmetric scene.
    pub fn shift(quasi_static: f64, inertial: f64, scale: f64) -> Self {
        Self { symmetric: true, answer: Answer::Shift { quasi_static, inertial, scale }, ..Self::default() }
    }
}

/// What is known of the pose at the end.
#[derive(Debug, Default)]
pub enum Answer {
    #[default]
    Unknown,
    /// Final x of the load without and with inertia (m), and the length that errors are divided by
    /// (m).
    Shift { quasi_static: f64, inertial: f64, scale: f64 },
    /// That of an exact backend with an eighth of the step: quasi-static for itself, midpoint for
    /// all with inertia.
    Finer,
    /// That of the same backend in this scene, `length` (m) here for each metre there.
    Scaled { base: Box<Scenario>, length: f64 },
}
