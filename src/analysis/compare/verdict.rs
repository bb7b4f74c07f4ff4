//! What a comparison amounts to.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// All paths lie within the tolerance of each other.
    #[serde(rename = "agree")]
    Agree,
    /// They part, and inertia has the larger share in it.
    #[serde(rename = "differ by inertia")]
    Inertia,
    /// They part, and the engine's error has the larger share in it.
    #[serde(rename = "differ by the engine")]
    Engine,
    /// The differences are smaller than the errors of the runs that they are between: a smaller step would tell.
    #[serde(rename = "below own error")]
    BelowOwnError,
    /// Runs went separate ways after some decision: paths say nothing, distributions do.
    #[serde(rename = "decorrelated")]
    Decorrelated,
    /// Some run failed: there is nothing to compare.
    #[serde(rename = "not computed")]
    NotComputed,
}

impl Verdict {
    /// Of the largest displacements (m) between paths, with `own` the error of the reference runs and `tolerance` what counts as agreement. Whether
    /// paths agree does not depend on where within that error the true ones are; which of two causes is the larger one may, where they are nearly the same.
    pub fn on_paths(inertia: f64, engine: f64, own: f64, tolerance: f64) -> Self {
        let largest = inertia.max(engine);
        if largest + own <= tolerance {
            Verdict::Agree
        } else if largest - own <= tolerance {
            // The paths may agree, but their own errors could hide as much as would part them.
            Verdict::BelowOwnError
        } else if inertia >= engine {
            Verdict::Inertia
        } else {
            Verdict::Engine
        }
    }

    pub fn text(self) -> &'static str {
        match self {
            Verdict::Agree => "agree",
            Verdict::Inertia => "differ by inertia",
            Verdict::Engine => "differ by the engine",
            Verdict::BelowOwnError => "below own error",
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
        let verdict = |inertia, engine, own| Verdict::on_paths(inertia, engine, own, 1e-3);
        assert_eq!(verdict(0.0, 0.0, 0.0), Verdict::Agree);
        assert_eq!(verdict(0.9e-3, 0.2e-3, 0.09e-3), Verdict::Agree);
        assert_eq!(verdict(0.9e-3, 0.2e-3, 0.11e-3), Verdict::BelowOwnError);
        assert_eq!(verdict(1.1e-3, 0.2e-3, 1e-6), Verdict::Inertia);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 1e-6), Verdict::Engine);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 0.19e-3), Verdict::Engine);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 0.21e-3), Verdict::BelowOwnError);
    }
}
