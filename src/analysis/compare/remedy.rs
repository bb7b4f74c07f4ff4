//! What would have to change to bring paths together that lie apart.

use std::f64::consts::PI;

use serde::Serialize;

use super::{InertiaFrom, Numbers, Predicted};

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
    /// By the engine at its step.
    pub engine: f64,
    /// What of it no step removes, at least: own errors do not count.
    pub engine_model: f64,
    pub tolerance: f64,
    /// Of the way without inertia alone, which is what is left when a remedy has worked.
    pub tolerance_without_inertia: f64,
}

/// A remedy is to bring the part of its cause to this share of the tolerance (1): laws hold in the limit of what is small, and who follows one is to find that the
/// paths agree.
const AIM: f64 = 2.0 / 3.0;

impl Apart {
    /// Against the engine's part, at its step (s).
    pub fn against_engine(&self, step_s: f64) -> Remedy {
        if self.engine_model >= self.tolerance {
            return Remedy::OtherModel;
        }
        Remedy::SmallerStep { step_s: step_s * (AIM * (self.tolerance - self.engine_model) / (self.engine - self.engine_model)).min(1.0) }
    }

    /// Against the parts of inertia that are beyond the tolerance, the largest first.
    pub fn against_inertia(&self, from: &InertiaFrom, numbers: &Numbers, predicted: &Predicted, tick_angle: f64) -> Vec<Remedy> {
        let aim = AIM * self.tolerance_without_inertia;
        let InertiaFrom { start_m: start, jumps_m: jumps, driving_m: driving } = *from;
        // Tips may have stopped before the lag was at its largest, where slower ones give it the time; and a start without speed leaves it.
        let lag = predicted.where_tips_stop_m.filter(|_| start.max(driving) > self.tolerance);
        let driving = lag.map_or(driving, |lag| lag.max(driving));
        let mut parts = [
            (start, vec![Remedy::SlowerStart { factor: (aim / start).sqrt() }]),
            (jumps, against_jumps(aim / jumps, numbers.zeta, tick_angle)),
            (driving, vec![Remedy::SlowerTips { factor: aim / driving }]),
        ];
        parts.sort_by(|a, b| b.0.total_cmp(&a.0));
        parts.into_iter().filter(|(part, _)| *part > self.tolerance).flat_map(|(_, remedies)| remedies).collect()
    }
}

/// To leave this `share` (1) of what a load with damping ratio `zeta` does after a grasp, a release or a jump, seen `tick_angle` (rad) of its oscillation later.
fn against_jumps(share: f64, zeta: f64, tick_angle: f64) -> Vec<Remedy> {
    let log = share.ln();
    // exp(-pi zeta / sqrt(1 - zeta^2)): share of the swing that a damped load overshoots by.
    let damping_ratio = -log / (PI * PI + log * log).sqrt();
    let damping_ratio = (damping_ratio > zeta).then_some(damping_ratio);
    // A swing that damping stops is over within a control period; one that is damped enough is to have died out by that much more.
    let swing = |zeta: f64| PI / (1.0 - zeta * zeta).sqrt();
    let angle = damping_ratio.map_or_else(|| died_out(zeta, tick_angle, share), swing);
    let factor = (tick_angle / angle).powi(2);
    let damping = damping_ratio.map(|damping_ratio| Remedy::Damping { damping_ratio });
    damping.into_iter().chain((factor < 1.0).then_some(Remedy::LighterLoad { factor })).collect()
}

/// Angle (rad) at which what is left of the way to a new balance is this `share` (1) of what is left at `angle`, by a damped load: `(1 + y) exp(-y)` with y the slowest
/// rate of decay times the angle, which is exact for critical damping.
fn died_out(zeta: f64, angle: f64, share: f64) -> f64 {
    let rate = if zeta > 1.0 { zeta - (zeta * zeta - 1.0).sqrt() } else { zeta };
    let y = rate * angle;
    let left = share * (1.0 + y) * (-y).exp();
    // A contraction by 1 / (1 + y).
    (0..64).fold(y, |y, _| ((1.0 + y) / left).ln()) / rate
}

#[cfg(test)]
mod tests {
    use super::*;

    const APART: Apart = Apart { engine: 2e-3, engine_model: 0.0, tolerance: 1e-3, tolerance_without_inertia: 1e-3 };

    #[test]
    fn an_error_of_the_step_wants_a_smaller_one_and_a_floor_another_model() {
        let step = |model: f64| match (Apart { engine_model: model, ..APART }).against_engine(1e-3) {
            Remedy::SmallerStep { step_s } => step_s,
            other => panic!("{other:?}"),
        };
        // Half of the error is agreement, and a third of the part that goes with the step is where half of it is the model's.
        assert!((step(0.0) - AIM * 1e-3 / 2.0).abs() < 1e-18 && (step(5e-4) - AIM * 1e-3 / 3.0).abs() < 1e-18);
        assert_eq!(Apart { engine_model: 1e-3, ..APART }.against_engine(1e-3), Remedy::OtherModel);
    }

    #[test]
    fn inertia_is_met_by_its_causes() {
        let numbers = Numbers { epsilon: Some(0.1), phi: None, zeta: 0.0 };
        let predicted = Predicted {
            while_driven_m: None,
            where_tips_stop_m: None,
            coasting_m: None,
            release_factor: None,
            quasi_static_is_sound: false,
            estimated_m: None,
        };
        let remedies = |[start_m, jumps_m, driving_m]: [f64; 3], numbers: &Numbers, predicted: &Predicted, tick_angle: f64| {
            APART.against_inertia(&InertiaFrom { start_m, jumps_m, driving_m }, numbers, predicted, tick_angle)
        };
        // A third less than the quarter that is agreement.
        let share = AIM / 4.0;
        let small = 0.9e-3;
        assert_eq!(remedies([small, small, 4e-3], &numbers, &predicted, 0.1), [Remedy::SlowerTips { factor: share }]);
        assert_eq!(remedies([4e-3, 0.0, small], &numbers, &predicted, 0.1), [Remedy::SlowerStart { factor: share.sqrt() }]);
        // Tips stop before the lag is at its largest, and a start without speed leaves them to drive the load.
        let longer = Predicted { where_tips_stop_m: Some(8e-3), ..predicted };
        let tips = Remedy::SlowerTips { factor: share / 2.0 };
        assert_eq!(remedies([0.0, 0.0, 4e-3], &numbers, &longer, 0.1), [tips]);
        assert_eq!(remedies([4e-3, 0.0, small], &numbers, &longer, 0.1), [tips, Remedy::SlowerStart { factor: share.sqrt() }]);
        assert_eq!(remedies([0.0, 4e-3, small], &numbers, &longer, 0.1).len(), 2, "tips have nothing to do with it");

        let jumps = |zeta: f64, tick_angle: f64| remedies([0.0, 4e-3, 0.0], &Numbers { zeta, ..numbers }, &predicted, tick_angle);
        let [Remedy::Damping { damping_ratio }, Remedy::LighterLoad { factor }] = jumps(0.0, PI / 10.0)[..] else {
            panic!("damping and a lighter load expected")
        };
        // The overshoot factor of the step response, put back in.
        assert!(((-PI * damping_ratio / (1.0 - damping_ratio * damping_ratio).sqrt()).exp() - share).abs() < 1e-14);
        // Half a swing of a damped load goes by at sqrt(1 - zeta^2) of the rate of one that is not.
        assert!((factor - 0.01 * (1.0 - damping_ratio * damping_ratio)).abs() < 1e-15);
        // A load that is damped critically is let down by a control period that ends too early.
        let [Remedy::LighterLoad { factor }] = jumps(1.0, 2.0)[..] else { panic!("a lighter load alone expected") };
        let left = |angle: f64| (1.0 + angle) * (-angle).exp();
        assert!((left(2.0 / factor.sqrt()) / left(2.0) - share).abs() < 1e-12);
        // All at once, the largest first.
        let kinds = |remedies: &[Remedy]| remedies.iter().map(std::mem::discriminant).collect::<Vec<_>>();
        let all = remedies([2e-3, 4e-3, 3e-3], &numbers, &predicted, PI / 10.0);
        assert_eq!(kinds(&all[..2]), kinds(&jumps(0.0, PI / 10.0)));
        let tips = Remedy::SlowerTips { factor: AIM / 3.0 };
        assert_eq!(all[2..], [tips, Remedy::SlowerStart { factor: (AIM / 2.0f64).sqrt() }]);
    }
}
