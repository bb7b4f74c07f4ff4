//! What a case found beside what is known.

use std::ops::{Add, Mul, Sub};

use serde::{Deserialize, Serialize};

use cohaul::backend::StepReport;

#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    pub values: Vec<Value>,
    /// Length (m) by which errors in angles are made comparable with those in lengths: that of the
    /// load's supports from its centre.
    pub arm: f64,
    /// Endings of all steps behind the values.
    pub report: StepReport,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    pub unit: Unit,
    pub found: f64,
    pub known: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    Metres,
    Radians,
    /// Ratios, powers and what else has no unit.
    One,
}

/// Largest error in each unit; `None` where nothing has it. Bounds of errors have the same form.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// (m)
    pub metres: Option<f64>,
    /// (rad)
    pub radians: Option<f64>,
    /// (1)
    pub ratio: Option<f64>,
}

impl Value {
    pub fn metres(found: f64, known: f64) -> Self {
        Self { unit: Unit::Metres, found, known }
    }

    pub fn radians(found: f64, known: f64) -> Self {
        Self { unit: Unit::Radians, found, known }
    }

    pub fn ratio(found: f64, known: f64) -> Self {
        Self { unit: Unit::One, found, known }
    }

    /// (x, y, heading) of a pose.
    pub fn pose(found: [f64; 3], known: [f64; 3]) -> [Value; 3] {
        let [x, y, heading] = [0, 1, 2].map(|i| (found[i], known[i]));
        [Self::metres(x.0, x.1), Self::metres(y.0, y.1), Self::radians(heading.0, heading.1)]
    }
}

impl Measured {
    pub fn errors(&self) -> Errors {
        let largest = |unit| {
            let errors = self.values.iter().filter(|value| value.unit == unit).map(|value| (value.found - value.known).abs());
            // A value that is not finite must not lose against one that is, as it would in
            // `f64::max`.
            errors.reduce(|one, other| if one >= other || one.is_nan() { one } else { other })
        };
        Errors { metres: largest(Unit::Metres), radians: largest(Unit::Radians), ratio: largest(Unit::One) }
    }
}

/// The answers at step zero from those at a step, its half, its quarter ... Endings are those of
/// all runs.
///
/// # Panics
/// When there are no answers, or they are of different cases.
pub fn limit_of(answers: &[Measured]) -> Measured {
    let mut limit = answers[0].clone();
    limit.report = StepReport::default();
    answers.iter().for_each(|answer| limit.report.add(&answer.report));
    for (i, value) in limit.values.iter_mut().enumerate() {
        let found: Vec<f64> = answers.iter().map(|answer| answer.values[i].found).collect();
        value.found = extrapolated(&found);
    }
    limit
}

/// The value at step zero from values at a step, its half, its quarter ... (Romberg's table), where
/// errors are a series in whole powers of the step.
///
/// # Panics
/// When there are no values.
pub fn extrapolated<T>(values: &[T]) -> T
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    let mut column = values.to_vec();
    let mut weight = 2.0;
    while column.len() > 1 {
        column = column.windows(2).map(|pair| pair[1] + (pair[1] - pair[0]) * (1.0 / (weight - 1.0))).collect();
        weight *= 2.0;
    }
    column[0]
}

impl Errors {
    pub const NONE: Errors = Errors { metres: None, radians: None, ratio: None };

    /// In the order metres, radians, ratio.
    pub fn entries(&self) -> [Option<f64>; 3] {
        [self.metres, self.radians, self.ratio]
    }

    pub fn map(&self, change: impl Fn(f64) -> f64) -> Errors {
        Errors { metres: self.metres.map(&change), radians: self.radians.map(&change), ratio: self.ratio.map(&change) }
    }

    /// Whether there is a bound for every error, and none above it. What is not finite is within no
    /// bound.
    pub fn within(&self, bounds: &Errors) -> bool {
        self.entries().into_iter().zip(bounds.entries()).all(|pair| match pair {
            (None, _) => true,
            (Some(error), Some(bound)) => error <= bound,
            (Some(_), None) => false,
        })
    }

    pub fn is_finite(&self) -> bool {
        self.entries().into_iter().flatten().all(f64::is_finite)
    }

    /// One number for all (m), with angles times `arm` (m): what a point of the load may be off by.
    /// Of ratios where there is nothing else.
    pub fn size(&self, arm: f64) -> Option<f64> {
        match (self.metres, self.radians) {
            (None, None) => self.ratio,
            (metres, radians) => Some(metres.unwrap_or(0.0).hypot(arm * radians.unwrap_or(0.0))),
        }
    }
}
