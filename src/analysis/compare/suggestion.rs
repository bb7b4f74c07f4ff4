//! Suggested changes: what makes a difference smaller than the tolerance.

use serde::Serialize;

use super::jump_mode::JumpMode;
use super::numbers::Predicted;
use crate::analysis::trigger::ByTrigger;
use crate::model::SpringLaw;
use crate::scenario::{Drive, Scenario, TipPath};

/// One change of the scene or the engine that reduces one cause, by the law of that cause.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "change", rename_all = "snake_case")]
pub enum SuggestedChange {
    /// Smaller time step of the engine, by the order of its time-step error.
    SmallerStep { step_s: f64 },
    /// More halvings of the engine's step in the comparison: time step and model cannot be told
    /// apart.
    MoreHalvings { halvings: u32 },
    /// Other friction or spring model in the engine: its model error does not depend on the step.
    OtherModel,
    /// Tip speeds times this factor: the load lags by speed over omega_n. Obstacles that move keep
    /// pace with the tips.
    SlowerTips { factor: f64 },
    /// Speeds of the obstacles times this factor, where they alone drive the load: behind a push it
    /// coasts by the square of the speed.
    SlowerObstacles { factor: f64 },
    /// Start speed times this factor: the coasting distance grows with the square of the speed.
    SlowerStart { factor: f64 },
    /// Springs with at least this damping ratio: the load with inertia then relaxes as that without
    /// it after a release. Less mass at the same dashpots does the same: the ratio grows with the
    /// inverse of its square root.
    SpringDamping { damping_ratio: f64 },
    /// Smaller tolerance of the quasi-static and inertial runs: the verdict is inconclusive.
    TighterTolerance { tolerance_m: f64 },
}

/// Outcome of a trial of suggested changes against inertia, all of them together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// Inertia effect on the path of the changed scene: largest edge displacement (m).
    pub inertia_effect_m: f64,
    /// Largest edge displacement that counts as agreement there (m).
    pub tolerance_m: f64,
    /// Whether the inertia effect and its reference error are within the tolerance.
    pub is_enough: bool,
}

impl Tried {
    /// Inertia effect over the tolerance (1).
    pub fn share(&self) -> f64 {
        self.inertia_effect_m / self.tolerance_m
    }
}

impl SuggestedChange {
    /// Whether the change is one of the scene, and not of the engine or the comparison.
    pub fn is_of_scene(&self) -> bool {
        use SuggestedChange::{SlowerStart, SpringDamping};
        self.slows_drive() || matches!(self, SlowerStart { .. } | SpringDamping { .. })
    }

    /// Whether the change slows what drives the load, so that a run takes longer.
    pub fn slows_drive(&self) -> bool {
        matches!(self, SuggestedChange::SlowerTips { .. } | SuggestedChange::SlowerObstacles { .. })
    }

    /// Makes the change in a scene. Slower tips and obstacles take longer, and releases come
    /// later.
    pub fn apply(&self, scenario: &mut Scenario) {
        match *self {
            SuggestedChange::SlowerTips { factor } | SuggestedChange::SlowerObstacles { factor } => scenario.stretch_times(factor.recip()),
            SuggestedChange::SlowerStart { factor } => scenario.scale_start_speed(factor),
            SuggestedChange::SpringDamping { damping_ratio } => {
                let damped = scenario.system.springs.iter_mut().filter(|spring| spring.law != SpringLaw::Rope);
                damped.for_each(|spring| spring.damping_ratio = spring.damping_ratio.max(damping_ratio));
            }
            SuggestedChange::SmallerStep { .. }
            | SuggestedChange::MoreHalvings { .. }
            | SuggestedChange::OtherModel
            | SuggestedChange::TighterTolerance { .. } => {}
        }
    }
}

/// Largest edge displacements between the paths, and the tolerance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Differences {
    /// Engine error at its step (m).
    pub engine: f64,
    /// Model error of the engine, less its uncertainty (m).
    pub model: f64,
    /// Largest edge displacement that counts as agreement (m).
    pub tolerance: f64,
    /// Tolerance from the quasi-static path length alone, which applies after the change (m).
    pub tolerance_without_inertia: f64,
    pub driver: Driver,
    pub has_springs: bool,
}

/// What drives the load, and can be slower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Driver {
    Tips,
    Obstacles,
    Nothing,
}

impl Driver {
    pub fn of(scenario: &Scenario) -> Self {
        let moves = |path: &TipPath| path.waypoints.windows(2).any(|pair| pair[0].position != pair[1].position);
        let tips_move = match &scenario.drive {
            Drive::Tips(paths) => paths.iter().any(moves),
            Drive::Ants(_) => true,
        };
        match scenario.system.world.obstacles.iter().any(|obstacle| obstacle.path.moves()) {
            _ if tips_move => Driver::Tips,
            true => Driver::Obstacles,
            false => Driver::Nothing,
        }
    }

    /// Change that leaves this `share` (1) of the inertia effect while the load is driven.
    fn slower(self, share: f64) -> Option<SuggestedChange> {
        match self {
            Driver::Tips => Some(SuggestedChange::SlowerTips { factor: share }),
            Driver::Obstacles => Some(SuggestedChange::SlowerObstacles { factor: share.sqrt() }),
            Driver::Nothing => None,
        }
    }
}

/// Aim of a suggested change, divided by the tolerance (1). The laws hold for small effects only,
/// and the paths must agree after the change.
const AIM: f64 = 2.0 / 3.0;

impl Differences {
    /// Change against the engine error, of which the time step's part falls with this order from
    /// its step (s) on; it counts as first order if it is unknown.
    pub fn against_engine(&self, step_s: f64, order: Option<f64>) -> SuggestedChange {
        if self.model >= self.tolerance {
            return SuggestedChange::OtherModel;
        }
        let share = (AIM * (self.tolerance - self.model) / (self.engine - self.model)).min(1.0);
        SuggestedChange::SmallerStep { step_s: step_s * share.powf(order.unwrap_or(1.0).recip()) }
    }

    /// Changes against those parts of the inertia effect that exceed the tolerance, the largest
    /// first.
    pub fn against_inertia(&self, effect: &ByTrigger, predicted: &Predicted, mode: &JumpMode) -> Vec<SuggestedChange> {
        let aim = AIM * self.tolerance_without_inertia;
        let ByTrigger { start_m: start, jumps_m: mut jumps, driving_m: mut driving, .. } = *effect;
        if !self.has_springs {
            // Only what drives the load makes it jump, and there is nothing to be damped.
            (driving, jumps) = (driving.max(jumps), 0.0);
        }
        // Tips may stop before the lag is largest. Slower tips, or a start at rest, show all of it.
        let lag = predicted.where_tips_stop_m.filter(|_| start.max(driving) > self.tolerance);
        let driving = lag.map_or(driving, |lag| lag.max(driving));
        let mut parts = [
            (start, vec![SuggestedChange::SlowerStart { factor: (aim / start).sqrt() }]),
            (jumps, against_jumps(aim / jumps, mode).into_iter().collect()),
            (driving, self.driver.slower(aim / driving).into_iter().collect()),
        ];
        parts.sort_by(|a, b| b.0.total_cmp(&a.0));
        parts.into_iter().filter(|(part, _)| *part > self.tolerance).flat_map(|(_, changes)| changes).collect()
    }
}

/// Change that leaves this `share` (1) of the inertia effect after an event that excites this
/// `mode`.
fn against_jumps(share: f64, mode: &JumpMode) -> Option<SuggestedChange> {
    let of_mode = damping_ratio_with(share * lag_after_event(mode.zeta));
    // The ratio of each spring gives that of the oscillation.
    (mode.zeta_of_unit > 0.0).then(|| SuggestedChange::SpringDamping { damping_ratio: of_mode / mode.zeta_of_unit })
}

/// Largest distance between the loads with and without inertia after a release, in units of the
/// way to the balance (1), at the damping ratio `zeta` (1). The load without inertia relaxes as
/// `exp(-w t / (2 zeta))`; the one with it oscillates up to its first stop, where friction holds
/// it. The formula has the limits for no damping and for strong damping, and lies within 5 % of
/// the truth between them.
fn lag_after_event(zeta: f64) -> f64 {
    (1.0 + LAG_SLOPE * zeta + 4.0 * zeta * zeta).recip()
}

/// Inverse of [`lag_after_event`].
fn damping_ratio_with(lag: f64) -> f64 {
    ((LAG_SLOPE * LAG_SLOPE + 16.0 * (lag.recip() - 1.0)).sqrt() - LAG_SLOPE) / 8.0
}

/// Coefficient of the formula for the lag after an event that fits between its limits (1).
const LAG_SLOPE: f64 = 2.2;

#[cfg(test)]
mod tests {
    use super::*;

    const DIFFERENCES: Differences =
        Differences { engine: 2e-3, model: 0.0, tolerance: 1e-3, tolerance_without_inertia: 1e-3, driver: Driver::Tips, has_springs: true };

    #[test]
    fn a_time_step_error_needs_a_smaller_step_and_a_model_error_another_model() {
        let of_order = |model: f64, order: Option<f64>| match (Differences { model, ..DIFFERENCES }).against_engine(1e-3, order) {
            SuggestedChange::SmallerStep { step_s } => step_s,
            other => panic!("{other:?}"),
        };
        let step = |model: f64| of_order(model, None);
        // An error that falls with the square needs half as many halvings.
        assert!((of_order(0.0, Some(2.0)) - (AIM / 2.0).sqrt() * 1e-3).abs() < 1e-18);
        // Half of the error is the tolerance. With half of that as model error, the step must
        // remove two thirds of the rest.
        assert!((step(0.0) - AIM * 1e-3 / 2.0).abs() < 1e-18 && (step(5e-4) - AIM * 1e-3 / 3.0).abs() < 1e-18);
        assert_eq!(Differences { model: 1e-3, ..DIFFERENCES }.against_engine(1e-3, None), SuggestedChange::OtherModel);
    }

    /// The post takes four times as long, and the load has no springs whose tips could be slower.
    #[test]
    fn a_load_that_only_obstacles_drive_has_slower_obstacles() {
        let mut scenario = Scenario::parse(include_str!("../../../scenarios/contact/pusher.json"), "pushed").unwrap();
        let effect = ByTrigger { driving_m: 16.0 * AIM * 1e-3, ..ByTrigger::default() };
        let mode = JumpMode { zeta: 0.0, zeta_of_unit: 1.0 };
        let changes =
            |driver| Differences { driver, has_springs: false, ..DIFFERENCES }.against_inertia(&effect, &Predicted::default(), &mode);
        let [change] = changes(Driver::of(&scenario))[..] else { panic!("one change expected") };
        let SuggestedChange::SlowerObstacles { factor } = change else { panic!("{change:?}") };
        // Rounding of a square root.
        assert!((factor - 0.25).abs() < 1e-15);
        change.apply(&mut scenario);
        let end = scenario.system.world.obstacles[0].path.waypoints[1].0;
        assert!((end - 4.0).abs() < 1e-14 && (scenario.duration - 4.0).abs() < 1e-14, "{end} {}", scenario.duration);
        let jump = ByTrigger { jumps_m: 16.0 * AIM * 1e-3, ..ByTrigger::default() };
        let driver = Driver::of(&scenario);
        assert_eq!(
            Differences { driver, has_springs: false, ..DIFFERENCES }.against_inertia(&jump, &Predicted::default(), &mode),
            [change]
        );
        scenario.system.world.obstacles.clear();
        assert_eq!(changes(Driver::of(&scenario)), []);
    }

    #[test]
    fn changes_against_inertia_follow_its_triggers() {
        let predicted = Predicted::default();
        let changes = |[start_m, jumps_m, driving_m]: [f64; 3], zeta: f64, predicted: &Predicted| {
            let mode = JumpMode { zeta, zeta_of_unit: 0.5 };
            DIFFERENCES.against_inertia(&ByTrigger { start_m, jumps_m, driving_m, ..ByTrigger::default() }, predicted, &mode)
        };
        // Two thirds of the tolerance, which is a quarter of the effect.
        let share = AIM / 4.0;
        let small = 0.9e-3;
        assert_eq!(changes([small, small, 4e-3], 0.0, &predicted), [SuggestedChange::SlowerTips { factor: share }]);
        assert_eq!(changes([4e-3, 0.0, small], 0.0, &predicted), [SuggestedChange::SlowerStart { factor: share.sqrt() }]);
        // Tips stop before the lag is largest; a slower start leaves the lag as it is.
        let longer = Predicted { where_tips_stop_m: Some(8e-3), ..predicted };
        let tips = SuggestedChange::SlowerTips { factor: share / 2.0 };
        assert_eq!(changes([0.0, 0.0, 4e-3], 0.0, &longer), [tips]);
        assert_eq!(changes([4e-3, 0.0, small], 0.0, &longer), [tips, SuggestedChange::SlowerStart { factor: share.sqrt() }]);
        for zeta in [0.0, 0.2, 3.0] {
            // Tips are not the cause.
            let [SuggestedChange::SpringDamping { damping_ratio }] = changes([0.0, 4e-3, 0.0], zeta, &longer)[..] else {
                panic!("damping expected")
            };
            // Rounding of a root of a quadratic equation.
            assert!((lag_after_event(0.5 * damping_ratio) / lag_after_event(zeta) - share).abs() < 1e-14, "{damping_ratio}");
        }
        // All triggers at once, the largest first.
        let kinds = |changes: &[SuggestedChange]| changes.iter().map(std::mem::discriminant).collect::<Vec<_>>();
        let all = changes([2e-3, 4e-3, 3e-3], 0.0, &predicted);
        assert_eq!(kinds(&all[..1]), kinds(&changes([0.0, 4e-3, 0.0], 0.0, &predicted)));
        let tips = SuggestedChange::SlowerTips { factor: AIM / 3.0 };
        assert_eq!(all[1..], [tips, SuggestedChange::SlowerStart { factor: (AIM / 2.0f64).sqrt() }]);
    }

    /// The motion of the load with inertia by the semi-implicit Euler method.
    #[test]
    fn the_lag_after_an_event_is_that_of_two_relaxations() {
        for zeta in [0.0, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 3.0, 10.0] {
            let (step, mut left, mut speed, mut largest) = (1e-4, 1.0, 0.0, 0.0f64);
            for at in 1..=400_000 {
                speed -= step * (left + 2.0 * zeta * speed);
                left += step * if speed > 0.0 { 0.0 } else { speed };
                let relaxed = (-step * f64::from(at) / (2.0 * zeta)).exp();
                largest = largest.max((left - relaxed).abs());
                if speed > 0.0 {
                    break;
                }
            }
            let found = lag_after_event(zeta);
            assert!((found / largest - 1.0).abs() < 0.05, "{zeta}: {found} for {largest}");
        }
    }
}
