//! The result of a comparison: two answers for each quantity, the word that follows from them, and
//! the causes of what exceeds the tolerance.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// Both differences are within the tolerance.
    #[serde(rename = "agree")]
    Agree,
    /// The inertia effect exceeds the tolerance.
    #[serde(rename = "inertia", alias = "differ by inertia")]
    Inertia,
    /// The engine error exceeds the tolerance.
    #[serde(rename = "engine", alias = "differ by the engine")]
    Engine,
    /// Both exceed the tolerance.
    #[serde(rename = "inertia and engine")]
    InertiaAndEngine,
    /// The reference error is too large to decide, or a reference run is doubtful.
    #[serde(rename = "inconclusive", alias = "below own error")]
    Inconclusive,
    /// The load never moves, with inertia or without: there is nothing to compare.
    #[serde(rename = "nothing moved")]
    NothingMoved,
    /// Runs separated after a decision that differed, and there is only one seed.
    #[serde(rename = "decorrelated")]
    Decorrelated,
    /// A run failed, and there is nothing to compare.
    #[serde(rename = "not computed")]
    NotComputed,
}

/// Whether the quasi-static model is valid for a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum InertiaAnswer {
    /// The inertia effect is within the tolerance: quasi-static is valid.
    #[serde(rename = "negligible")]
    Negligible,
    /// The inertia effect exceeds the tolerance: quasi-static is not valid.
    #[serde(rename = "not negligible")]
    NotNegligible,
    /// The reference error or a doubtful run leaves it open.
    #[serde(rename = "open")]
    Open,
    /// The load never moves, with inertia or without.
    #[serde(rename = "nothing moved")]
    NothingMoved,
}

/// Whether the engine is right about a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EngineAnswer {
    /// The engine error is within the tolerance.
    #[serde(rename = "within")]
    Within,
    /// The engine error exceeds the tolerance.
    #[serde(rename = "not within")]
    NotWithin,
    /// The reference error or a doubtful run leaves it open.
    #[serde(rename = "open")]
    Open,
}

/// The two answers on one quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Answers {
    pub inertia: InertiaAnswer,
    pub engine: EngineAnswer,
}

/// Cause of a difference that exceeds the tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Cause {
    /// What remains of the inertia effect without restitution. It vanishes with the mass.
    #[serde(rename = "inertia")]
    Inertia,
    /// Rebound from an obstacle: restitution does not vanish with the mass.
    #[serde(rename = "impact")]
    Impact,
    /// Another motion was admissible, and the runs may have taken different ones.
    #[serde(rename = "not unique")]
    NotUnique,
    /// Part of the engine error that vanishes with the engine's step.
    #[serde(rename = "time step")]
    TimeStep,
    /// Part of the engine error that does not vanish with the step.
    #[serde(rename = "engine model")]
    EngineModel,
    /// Engine error of which time step and model cannot be told apart at this step.
    #[serde(rename = "engine")]
    Engine,
}

impl Cause {
    /// The word that text, maps and JSON use.
    pub fn text(self) -> &'static str {
        match self {
            Cause::Inertia => "inertia",
            Cause::Impact => "impact",
            Cause::NotUnique => "not unique",
            Cause::TimeStep => "time step",
            Cause::EngineModel => "engine model",
            Cause::Engine => "engine",
        }
    }

    /// Whether it is a part of the engine error.
    pub fn is_of_engine(self) -> bool {
        matches!(self, Cause::TimeStep | Cause::EngineModel | Cause::Engine)
    }
}

impl Answers {
    /// Answers that nothing is known of.
    pub const OPEN: Self = Self { inertia: InertiaAnswer::Open, engine: EngineAnswer::Open };

    /// Answers on an inertia effect and an engine error that lie in these ranges, divided by the
    /// tolerance (1).
    pub fn of([inertia, engine]: [[f64; 2]; 2]) -> Self {
        Self {
            inertia: match within(inertia) {
                Some(true) => InertiaAnswer::Negligible,
                Some(false) => InertiaAnswer::NotNegligible,
                None => InertiaAnswer::Open,
            },
            engine: match within(engine) {
                Some(true) => EngineAnswer::Within,
                Some(false) => EngineAnswer::NotWithin,
                None => EngineAnswer::Open,
            },
        }
    }

    /// The word that follows. An exceeded tolerance is named whatever else is open; `engine` alone
    /// does not say that inertia is negligible.
    pub fn verdict(self) -> Verdict {
        match (self.inertia, self.engine) {
            (InertiaAnswer::NotNegligible, EngineAnswer::NotWithin) => Verdict::InertiaAndEngine,
            (InertiaAnswer::NotNegligible, _) => Verdict::Inertia,
            (_, EngineAnswer::NotWithin) => Verdict::Engine,
            (InertiaAnswer::Open, _) | (_, EngineAnswer::Open) => Verdict::Inconclusive,
            (InertiaAnswer::NothingMoved, EngineAnswer::Within) => Verdict::NothingMoved,
            (InertiaAnswer::Negligible, EngineAnswer::Within) => Verdict::Agree,
        }
    }

    /// Whether one of both is open.
    pub fn is_open(self) -> bool {
        self.inertia == InertiaAnswer::Open || self.engine == EngineAnswer::Open
    }
}

impl InertiaAnswer {
    /// The word that text and JSON use.
    pub fn text(self) -> &'static str {
        match self {
            InertiaAnswer::Negligible => "negligible",
            InertiaAnswer::NotNegligible => "not negligible",
            InertiaAnswer::Open => "open",
            InertiaAnswer::NothingMoved => "nothing moved",
        }
    }
}

impl EngineAnswer {
    /// The word that text and JSON use.
    pub fn text(self) -> &'static str {
        match self {
            EngineAnswer::Within => "within",
            EngineAnswer::NotWithin => "not within",
            EngineAnswer::Open => "open",
        }
    }
}

/// Whether a difference in this range, divided by the tolerance (1), is within the tolerance;
/// `None` if that is open, or if the range is not a number.
fn within([least, most]: [f64; 2]) -> Option<bool> {
    match () {
        () if least > 1.0 => Some(false),
        () if most <= 1.0 => Some(true),
        () => None,
    }
}

/// Which of two parts are the cause of a difference beyond the tolerance, all in one unit. A part
/// is one if it exceeds the tolerance alone, or if the other part is within the tolerance, both
/// beyond the error of the parts. The error may leave both open.
pub(super) fn causes_among(parts: [f64; 2], error: f64, tolerance: f64) -> [bool; 2] {
    [0, 1].map(|at| parts[at] - error > tolerance || parts[1 - at] + error <= tolerance)
}

impl Verdict {
    pub fn has_inertia(self) -> bool {
        matches!(self, Verdict::Inertia | Verdict::InertiaAndEngine)
    }

    pub fn has_engine(self) -> bool {
        matches!(self, Verdict::Engine | Verdict::InertiaAndEngine)
    }

    /// The word that reports and JSON use.
    pub fn text(self) -> &'static str {
        match self {
            Verdict::Agree => "agree",
            Verdict::Inertia => "inertia",
            Verdict::Engine => "engine",
            Verdict::InertiaAndEngine => "inertia and engine",
            Verdict::Inconclusive => "inconclusive",
            Verdict::NothingMoved => "nothing moved",
            Verdict::Decorrelated => "decorrelated",
            Verdict::NotComputed => "not computed",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_answer_is_given_on_both_sides_of_each_threshold() {
        let of = |inertia: f64, engine: f64, error: f64| {
            Answers::of([inertia, engine].map(|effect: f64| [(effect - error) / 1e-3, (effect + error) / 1e-3]))
        };
        let verdict = |inertia, engine, error| of(inertia, engine, error).verdict();
        assert_eq!(verdict(0.0, 0.0, 0.0), Verdict::Agree);
        assert_eq!(verdict(0.9e-3, 0.2e-3, 0.09e-3), Verdict::Agree);
        assert_eq!(verdict(0.9e-3, 0.2e-3, 0.11e-3), Verdict::Inconclusive);
        assert_eq!(verdict(1.1e-3, 0.2e-3, 1e-6), Verdict::Inertia);
        assert_eq!(verdict(0.9e-3, 1.2e-3, 1e-6), Verdict::Engine);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 1e-6), Verdict::InertiaAndEngine);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 0.19e-3), Verdict::Engine);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 0.21e-3), Verdict::Inconclusive);
        assert!(of(1.1e-3, 1.2e-3, 0.19e-3).is_open() && of(1.2e-3, 1.1e-3, 0.15e-3).is_open());
        assert_eq!(of(f64::NAN, f64::NAN, 0.0), Answers::OPEN);
        assert_eq!(Answers { inertia: InertiaAnswer::NothingMoved, engine: EngineAnswer::Open }.verdict(), Verdict::Inconclusive);
    }

    /// The whole difference exceeds the tolerance of 1.
    #[test]
    fn the_cause_is_the_part_without_which_the_tolerance_would_hold() {
        assert_eq!(causes_among([1.2, 0.1], 0.05, 1.0), [true, false]);
        assert_eq!(causes_among([0.1, 1.2], 0.05, 1.0), [false, true]);
        assert_eq!(causes_among([1.2, 1.3], 0.05, 1.0), [true, true]);
        // Neither exceeds it alone.
        assert_eq!(causes_among([0.7, 0.6], 0.05, 1.0), [true, true]);
        // A model error that may be anything up to 1.5.
        assert_eq!(causes_among([1.4, 0.9], 0.6, 1.0), [false, false]);
    }
}
