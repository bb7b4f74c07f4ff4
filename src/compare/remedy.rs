//! What would have to change to bring paths together that lie apart.

use std::f64::consts::PI;

use serde::Serialize;

use super::difference::{OccasionKind, Parting};
use super::{Numbers, Predicted};

/// One change that works against one cause, by the laws that the cause follows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "change", rename_all = "snake_case")]
pub enum Remedy {
    /// Steps of the engine of at most this: its error is of first order.
    SmallerStep { step_s: f64 },
    /// Another model of friction or springs in the engine, or its recommended settings: what is wrong does not go with its step.
    OtherModel,
    /// Tips, or ants, that are slower by this factor at least (1): the lag behind them is their speed over omega_n.
    SlowerTips { factor: f64 },
    /// A start that is slower by this factor at least (1): coasting goes with the square of the speed.
    SlowerStart { factor: f64 },
    /// Springs damped at least so much (1): less of the swing after a release stays when the load comes to rest.
    Damping { damping_ratio: f64 },
    /// A load lighter by this factor at least (1), at the same friction: it then follows a release within a control period.
    LighterLoad { factor: f64 },
    /// Errors of the reference runs of at most this (m): the verdict drowns in them.
    TighterTolerance { tolerance_m: f64 },
}

/// Displacements of the load's rim (m) and what counts as agreement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Apart {
    pub inertia: f64,
    pub engine_step: f64,
    pub engine_model: f64,
    pub tolerance: f64,
}

impl Apart {
    /// Against the engine's part, at its step (s).
    pub fn against_engine(&self, step_s: f64) -> Remedy {
        if self.engine_model >= self.tolerance {
            return Remedy::OtherModel;
        }
        Remedy::SmallerStep { step_s: step_s * ((self.tolerance - self.engine_model) / self.engine_step).min(1.0) }
    }

    /// Against the part of inertia, by what came before the paths parted.
    pub fn against_inertia(&self, parting: Option<&Parting>, numbers: &Numbers, predicted: &Predicted, tick_angle: f64) -> Vec<Remedy> {
        let share = (self.tolerance / self.inertia).min(1.0);
        let after = parting.and_then(|parting| parting.after).map(|occasion| occasion.kind);
        match after {
            Some(OccasionKind::Release | OccasionKind::Grasp | OccasionKind::Jump) => {
                let log = share.ln();
                // exp(-pi zeta / sqrt(1 - zeta^2)): share of the swing that a damped load overshoots by.
                let damping_ratio = -log / (PI * PI + log * log).sqrt();
                let damping = (damping_ratio > numbers.zeta).then_some(Remedy::Damping { damping_ratio });
                let lighter = Remedy::LighterLoad { factor: (tick_angle / PI).powi(2).min(1.0) };
                damping.into_iter().chain([lighter]).collect()
            }
            _ if predicted.coasting_m.is_some_and(|coasting| coasting >= self.tolerance) => {
                vec![Remedy::SlowerStart { factor: share.sqrt() }]
            }
            _ => vec![Remedy::SlowerTips { factor: share }],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Occasion;

    const APART: Apart = Apart { inertia: 4e-3, engine_step: 2e-3, engine_model: 0.0, tolerance: 1e-3 };

    #[test]
    fn an_error_of_the_step_wants_a_smaller_one_and_a_floor_another_model() {
        assert_eq!(APART.against_engine(1e-3), Remedy::SmallerStep { step_s: 5e-4 });
        assert_eq!(Apart { engine_model: 1e-3, ..APART }.against_engine(1e-3), Remedy::OtherModel);
    }

    #[test]
    fn inertia_is_met_by_its_cause() {
        let numbers = Numbers { epsilon: Some(0.1), phi: None, zeta: 0.0 };
        let predicted = |coasting| Predicted {
            while_driven_m: None,
            where_tips_stop_m: None,
            coasting_m: Some(coasting),
            release_factor: None,
            quasi_static_is_sound: false,
            estimated_m: None,
        };
        let after = |kind| Parting { time_s: 1.0, after: Some(Occasion { kind, spring: Some(0), support: None, time_s: 0.9 }) };
        let remedies = |kind, coasting| APART.against_inertia(Some(&after(kind)), &numbers, &predicted(coasting), PI / 10.0);
        assert_eq!(remedies(OccasionKind::Onset, 0.0), [Remedy::SlowerTips { factor: 0.25 }]);
        assert_eq!(remedies(OccasionKind::Onset, 1e-3), [Remedy::SlowerStart { factor: 0.5 }]);
        let [Remedy::Damping { damping_ratio }, Remedy::LighterLoad { factor }] = remedies(OccasionKind::Release, 0.0)[..] else {
            panic!("damping and a lighter load expected")
        };
        // The overshoot factor of the step response, put back in.
        assert!(((-PI * damping_ratio / (1.0 - damping_ratio * damping_ratio).sqrt()).exp() - 0.25).abs() < 1e-14);
        assert!((factor - 0.01).abs() < 1e-15);
    }
}
