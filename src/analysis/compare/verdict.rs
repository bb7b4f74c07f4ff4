//! The result of a comparison in one word.

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

/// Cause of a difference that exceeds the tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    Inertia,
    Engine,
}

impl Verdict {
    /// Verdict on two differences, the reference error and the tolerance, all in one unit.
    ///
    /// A cause is named if its difference exceeds the tolerance wherever the true values lie within
    /// the reference error, and agreement if no difference can exceed it.
    pub fn of(inertia_effect: f64, engine_error: f64, reference_error: f64, tolerance: f64) -> Self {
        let exceeds = |difference: f64| difference - reference_error > tolerance;
        Self::of_causes([exceeds(inertia_effect), exceeds(engine_error)]).unwrap_or(
            match inertia_effect.max(engine_error) + reference_error <= tolerance {
                true => Verdict::Agree,
                false => Verdict::Inconclusive,
            },
        )
    }

    /// Verdict that names these causes, inertia and engine; `None` without any.
    pub(super) fn of_causes(are_causes: [bool; 2]) -> Option<Self> {
        match are_causes {
            [true, true] => Some(Verdict::InertiaAndEngine),
            [true, false] => Some(Verdict::Inertia),
            [false, true] => Some(Verdict::Engine),
            [false, false] => None,
        }
    }

    /// Verdict on two numbers together: every cause of either, else what is left open.
    pub fn and(self, other: Self) -> Self {
        let any = |is: fn(Self) -> bool| is(self) || is(other);
        let left = if self == Verdict::Agree { other } else { self };
        Self::of_causes([any(Self::has_inertia), any(Self::has_engine)]).unwrap_or(left)
    }

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
    fn every_cause_is_named_on_both_sides_of_each_threshold() {
        let verdict = |inertia, engine, reference| Verdict::of(inertia, engine, reference, 1e-3);
        assert_eq!(verdict(0.0, 0.0, 0.0), Verdict::Agree);
        assert_eq!(verdict(0.9e-3, 0.2e-3, 0.09e-3), Verdict::Agree);
        assert_eq!(verdict(0.9e-3, 0.2e-3, 0.11e-3), Verdict::Inconclusive);
        assert_eq!(verdict(1.1e-3, 0.2e-3, 1e-6), Verdict::Inertia);
        assert_eq!(verdict(0.9e-3, 1.2e-3, 1e-6), Verdict::Engine);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 1e-6), Verdict::InertiaAndEngine);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 0.19e-3), Verdict::Engine);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 0.21e-3), Verdict::Inconclusive);
    }

    #[test]
    fn numbers_together_have_every_cause_of_each() {
        use Verdict::{Agree, Engine, Inconclusive, Inertia, InertiaAndEngine};
        for (a, b, both) in [
            (Agree, Agree, Agree),
            (Agree, Inconclusive, Inconclusive),
            (Inconclusive, Inertia, Inertia),
            (Engine, Agree, Engine),
            (Engine, Inertia, InertiaAndEngine),
            (InertiaAndEngine, Inconclusive, InertiaAndEngine),
        ] {
            assert_eq!((a.and(b), b.and(a)), (both, both));
        }
    }
}
