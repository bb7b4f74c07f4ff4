//! A question with its known answer, and what an engine answered.

use serde::{Deserialize, Serialize};

use super::asked::Asked;
use super::grade::Grade;
use crate::subject::Ended;

/// A question, put to an engine at a step.
#[derive(Clone, Copy)]
pub struct Test {
    /// Its number, as in `C1`.
    pub key: &'static str,
    /// One or two words.
    pub name: &'static str,
    pub what: &'static str,
    /// Where the known answer comes from.
    pub source: &'static str,
    /// What a wrong answer means to a user.
    pub meaning: &'static str,
    /// Whether the answer is that of a load with inertia.
    pub has_inertia: bool,
    pub run: fn(&Asked) -> Result<Vec<Measure>, Ended>,
}

/// A measured number beside the known one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    pub name: String,
    /// SI unit; empty for a number without one.
    pub unit: String,
    pub known: f64,
    pub found: f64,
    /// Found minus known, in the unit; for an answer that should reach the known one at least, what
    /// is missing.
    pub error: f64,
    /// Error over the size of the known answer, or over what the test names where that is zero (1).
    pub relative_error: f64,
    pub grade: Grade,
    /// How well the answer itself is known, in the unit.
    pub accuracy: f64,
}

/// What came of a test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    pub key: String,
    pub outcome: Outcome,
    /// Why there are no numbers.
    pub why: Option<String>,
    /// Beside the numbers.
    pub note: Option<String>,
    /// The worst one of the measures.
    pub grade: Option<Grade>,
    pub measures: Vec<Measure>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    Answered,
    /// The engine does not take the scene, which is no failure.
    Refused,
    Failed,
}

impl Measure {
    /// A number whose error counts over the known one. The answer is known to `accuracy`, in the
    /// unit.
    pub fn new(name: &str, unit: &str, known: f64, found: f64, accuracy: f64) -> Self {
        Self::over(known, name, unit, known, found, accuracy)
    }

    /// A number whose error counts over a `size`, in the unit.
    pub fn over(size: f64, name: &str, unit: &str, known: f64, found: f64, accuracy: f64) -> Self {
        let error = found - known;
        Self::with_error(error, error / size.abs(), name, unit, [known, found, accuracy])
    }

    /// A number that should be at least the known one.
    pub fn at_least(name: &str, unit: &str, known: f64, found: f64, accuracy: f64) -> Self {
        let error = (found - known).min(0.0);
        Self::with_error(error, error / known, name, unit, [known, found, accuracy])
    }

    fn with_error(error: f64, relative_error: f64, name: &str, unit: &str, [known, found, accuracy]: [f64; 3]) -> Self {
        let grade = Grade::of(relative_error);
        Self { name: name.to_owned(), unit: unit.to_owned(), known, found, error, relative_error, grade, accuracy }
    }
}

impl Test {
    /// Asks an engine; `None` when the user stopped it.
    pub fn ask(&self, asked: &Asked) -> Option<Answer> {
        let measured = (self.run)(asked).and_then(|measures| match measures.iter().find(|measure| !measure.relative_error.is_finite()) {
            Some(bad) => Err(Ended::Failed(format!("{}: must be finite, found {}", bad.name, bad.found))),
            None => Ok(measures),
        });
        let (outcome, why, measures) = match measured {
            Ok(measures) => (Outcome::Answered, None, measures),
            Err(Ended::Refused(why)) => (Outcome::Refused, Some(why), Vec::new()),
            Err(Ended::Failed(why)) => (Outcome::Failed, Some(why), Vec::new()),
            Err(Ended::Stopped) => return None,
        };
        let grade = measures.iter().map(|measure| measure.grade).max();
        Some(Answer { key: self.key.to_owned(), outcome, why, note: asked.note(), grade, measures })
    }

    /// The answer of an engine that is not asked.
    pub fn refused(&self, why: &str) -> Answer {
        let (key, why) = (self.key.to_owned(), Some(why.to_owned()));
        Answer { key, outcome: Outcome::Refused, why, note: None, grade: None, measures: Vec::new() }
    }
}
