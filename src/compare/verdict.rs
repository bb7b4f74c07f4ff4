//! What a comparison amounts to.

use serde::{Deserialize, Serialize};

use super::Difference;

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
}

impl Verdict {
    /// Of paths whose largest distances are known, with `own_error` that of the reference runs and `tolerance` (m) what counts as agreement.
    pub fn on_paths(inertia: &Difference, engine: &Difference, own_error: &Difference, tolerance: f64) -> Self {
        let (inertia, engine, own) = (inertia.position_max_m, engine.position_max_m, own_error.position_max_m);
        if inertia.max(engine) + own <= tolerance {
            Verdict::Agree
        } else if inertia.max(engine) <= own {
            Verdict::BelowOwnError
        } else if inertia.max(engine) <= tolerance {
            // The paths agree as far as these runs can tell, but their own errors could hide as much again.
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
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apart(position_max_m: f64) -> Difference {
        Difference { position_max_m, ..Difference::default() }
    }

    #[test]
    fn the_larger_share_names_the_cause_on_both_sides_of_each_threshold() {
        let verdict = |inertia, engine, own| Verdict::on_paths(&apart(inertia), &apart(engine), &apart(own), 1e-3);
        assert_eq!(verdict(0.0, 0.0, 0.0), Verdict::Agree);
        assert_eq!(verdict(0.9e-3, 0.2e-3, 0.09e-3), Verdict::Agree);
        assert_eq!(verdict(0.9e-3, 0.2e-3, 0.11e-3), Verdict::BelowOwnError);
        assert_eq!(verdict(1.1e-3, 0.2e-3, 1e-6), Verdict::Inertia);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 1e-6), Verdict::Engine);
        assert_eq!(verdict(1.1e-3, 1.2e-3, 1.3e-3), Verdict::BelowOwnError);
    }
}
