//! The result of a comparison in one word.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// All paths agree within the tolerance.
    #[serde(rename = "agree")]
    Agree,
    /// A difference exceeds the tolerance, and the inertia effect is the larger cause.
    #[serde(rename = "inertia", alias = "differ by inertia")]
    Inertia,
    /// A difference exceeds the tolerance, and the engine error is the larger cause.
    #[serde(rename = "engine", alias = "differ by the engine")]
    Engine,
    /// The reference error is too large to decide.
    #[serde(rename = "inconclusive", alias = "below own error")]
    Inconclusive,
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
    /// Verdict on two largest edge displacements, the reference error and the tolerance (all m).
    ///
    /// Whether paths agree does not depend on where the true paths lie within the reference error.
    /// Which of two nearly equal causes is the larger one may depend on it.
    pub fn on_paths(inertia_effect: f64, engine_error: f64, reference_error: f64, tolerance: f64) -> Self {
        let largest = inertia_effect.max(engine_error);
        if largest + reference_error <= tolerance {
            Verdict::Agree
        } else if largest - reference_error <= tolerance {
            Verdict::Inconclusive
        } else if inertia_effect >= engine_error {
            Verdict::Inertia
        } else {
            Verdict::Engine
        }
    }

    /// The word that reports and JSON use.
    pub fn text(self) -> &'static str {
        match self {
            Verdict::Agree => "agree",
            Verdict::Inertia => "inertia",
            Verdict::Engine => "engine",
            Verdict::Inconclusive => "inconclusive",
            Verdict::Decorrelated => "decorrelated",
            Verdict::NotComputed => "not computed",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_larger_share_names_the_cause_on_both_sides_of_each_threshold() {
        let verdict = |inertia, engine, reference| Verdict::on_paths(inertia, engine, reference, 1e-3);
        assert_eq!(verdict(0.0, 0.0, 0.0), Verdict::Agree);
        assert_eq!(verdict(0.9e-3, 0.2e-3, 0.09e-3), Verdict::Agree);
        assert_eq!(verdict(0.9e-3, 0.2e-3, 0.11e-3), Verdict::Inconclusive);
        assert_eq!(verdict(1.1e-3, 0.2e-3, 1e-6), Verdict::Inertia);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 1e-6), Verdict::Engine);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 0.19e-3), Verdict::Engine);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 0.21e-3), Verdict::Inconclusive);
    }
}
