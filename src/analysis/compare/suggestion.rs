//! Suggested changes: what makes a difference smaller than the tolerance.

use std::f64::consts::PI;

use serde::Serialize;

use super::jump_mode::JumpMode;
use super::numbers::Predicted;
use crate::analysis::trigger::ByTrigger;
use crate::model::System;
use crate::scenario::{Drive, Scenario};

/// One change of the scene or the engine that reduces one cause, by the law of that cause.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "change", rename_all = "snake_case")]
pub enum SuggestedChange {
    /// Smaller time step of the engine: its time-step error is of first order.
    SmallerStep { step_s: f64 },
    /// Other friction or spring model in the engine: its model error does not depend on the step.
    OtherModel,
    /// Tip speeds times this factor: the load lags by speed over omega_n.
    SlowerTips { factor: f64 },
    /// Speeds of the obstacles times this factor, where they alone drive the load: behind a push it
    /// coasts by the square of the speed.
    SlowerObstacles { factor: f64 },
    /// Start speed times this factor: the coasting distance grows with the square of the speed.
    SlowerStart { factor: f64 },
    /// Springs with at least this damping ratio: the overshoot after a release becomes smaller.
    SpringDamping { damping_ratio: f64 },
    /// Mass and moment of inertia times this factor, with the same normal loads and dashpots: the
    /// load then settles within one control period after a release.
    ReducedInertia { factor: f64 },
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
        use SuggestedChange::{ReducedInertia, SlowerStart, SpringDamping};
        self.slows_drive() || matches!(self, SlowerStart { .. } | SpringDamping { .. } | ReducedInertia { .. })
    }

    /// Whether the change slows what drives the load, so that a run takes longer.
    pub fn slows_drive(&self) -> bool {
        matches!(self, SuggestedChange::SlowerTips { .. } | SuggestedChange::SlowerObstacles { .. })
    }

    /// Makes the change in a scene. Slower tips and obstacles take longer, and releases come
    /// later.
    pub fn apply(&self, scenario: &mut Scenario) {
        match *self {
            SuggestedChange::SlowerTips { factor } => {
                if let Drive::Tips(paths) = &mut scenario.drive {
                    for path in paths {
                        path.waypoints.iter_mut().for_each(|at| at.time /= factor);
                        path.release = path.release.map(|time| time / factor);
                    }
                }
                scenario.duration /= factor;
            }
            SuggestedChange::SlowerObstacles { factor } => {
                let paths = scenario.system.world.obstacles.iter_mut().map(|obstacle| &mut obstacle.path);
                paths.flat_map(|path| &mut path.waypoints).for_each(|(time, _)| *time /= factor);
                scenario.duration /= factor;
            }
            SuggestedChange::SlowerStart { factor } => {
                scenario.start.twist.linear *= factor;
                scenario.start.twist.angular *= factor;
            }
            SuggestedChange::SpringDamping { damping_ratio } => {
                scenario.system.springs.iter_mut().for_each(|spring| spring.damping_ratio = spring.damping_ratio.max(damping_ratio));
            }
            SuggestedChange::ReducedInertia { factor } => {
                scenario.system.scale_inertia(factor);
            }
            SuggestedChange::SmallerStep { .. } | SuggestedChange::OtherModel | SuggestedChange::TighterTolerance { .. } => {}
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
}

/// What drives the load, and can be slower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Driver {
    Tips,
    Obstacles,
    Nothing,
}

impl Driver {
    pub fn of(system: &System) -> Self {
        match system.world.obstacles.iter().any(|obstacle| obstacle.path.moves()) {
            _ if !system.springs.is_empty() => Driver::Tips,
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
    /// Change against the engine error, at its step (s).
    pub fn against_engine(&self, step_s: f64) -> SuggestedChange {
        if self.model >= self.tolerance {
            return SuggestedChange::OtherModel;
        }
        SuggestedChange::SmallerStep { step_s: step_s * (AIM * (self.tolerance - self.model) / (self.engine - self.model)).min(1.0) }
    }

    /// Changes against those parts of the inertia effect that exceed the tolerance, the largest
    /// first.
    pub fn against_inertia(&self, effect: &ByTrigger, predicted: &Predicted, mode: &JumpMode) -> Vec<SuggestedChange> {
        let aim = AIM * self.tolerance_without_inertia;
        let ByTrigger { start_m: start, jumps_m: jumps, driving_m: driving, .. } = *effect;
        // Tips may stop before the lag is largest. Slower tips, or a start at rest, show all of it.
        let lag = predicted.where_tips_stop_m.filter(|_| start.max(driving) > self.tolerance);
        let driving = lag.map_or(driving, |lag| lag.max(driving));
        let mut parts = [
            (start, vec![SuggestedChange::SlowerStart { factor: (aim / start).sqrt() }]),
            (jumps, against_jumps(aim / jumps, mode)),
            (driving, self.driver.slower(aim / driving).into_iter().collect()),
        ];
        parts.sort_by(|a, b| b.0.total_cmp(&a.0));
        parts.into_iter().filter(|(part, _)| *part > self.tolerance).flat_map(|(_, changes)| changes).collect()
    }
}

/// Changes that leave this `share` (1) of the inertia effect after a jump that excites this `mode`.
fn against_jumps(share: f64, mode: &JumpMode) -> Vec<SuggestedChange> {
    let JumpMode { zeta, tick_angle, .. } = *mode;
    let log = share.ln();
    // Overshoot of a damped load: exp(-pi zeta / sqrt(1 - zeta^2)).
    let damping_ratio = -log / (PI * PI + log * log).sqrt();
    let damping_ratio = (damping_ratio > zeta).then_some(damping_ratio);
    // With more damping, half a swing must fit into a control period; with enough damping, the
    // decay must be stronger by the share.
    let swing = |zeta: f64| PI / (1.0 - zeta * zeta).sqrt();
    let angle = damping_ratio.map_or_else(|| decayed(zeta, tick_angle, share), swing);
    let factor = (tick_angle / angle).powi(2);
    let damping = damping_ratio.filter(|_| mode.zeta_of_unit > 0.0);
    // The ratio of each spring gives that of the oscillation.
    let damping = damping.map(|of_mode| SuggestedChange::SpringDamping { damping_ratio: of_mode / mode.zeta_of_unit });
    damping.into_iter().chain((factor > 0.0 && factor < 1.0).then_some(SuggestedChange::ReducedInertia { factor })).collect()
}

/// Phase (rad) at which the remaining displacement is this `share` (1) of that at the phase
/// `angle`. It decays as `(1 + y) exp(-y)`, with y the slowest decay rate times the phase, which is
/// exact for critical damping.
fn decayed(zeta: f64, angle: f64, share: f64) -> f64 {
    // The slower root, zeta - sqrt(zeta^2 - 1), without cancellation.
    let rate = if zeta > 1.0 { 1.0 / (zeta * (1.0 + (1.0 - zeta.recip() / zeta).sqrt())) } else { zeta };
    let y = rate * angle;
    let left = share * (1.0 + y) * (-y).exp();
    // A contraction by 1 / (1 + y).
    (0..64).fold(y, |y, _| ((1.0 + y) / left).ln()) / rate
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIFFERENCES: Differences =
        Differences { engine: 2e-3, model: 0.0, tolerance: 1e-3, tolerance_without_inertia: 1e-3, driver: Driver::Tips };

    #[test]
    fn a_time_step_error_needs_a_smaller_step_and_a_model_error_another_model() {
        let step = |model: f64| match (Differences { model, ..DIFFERENCES }).against_engine(1e-3) {
            SuggestedChange::SmallerStep { step_s } => step_s,
            other => panic!("{other:?}"),
        };
        // Half of the error is the tolerance. With half of that as model error, the step must
        // remove two thirds of the rest.
        assert!((step(0.0) - AIM * 1e-3 / 2.0).abs() < 1e-18 && (step(5e-4) - AIM * 1e-3 / 3.0).abs() < 1e-18);
        assert_eq!(Differences { model: 1e-3, ..DIFFERENCES }.against_engine(1e-3), SuggestedChange::OtherModel);
    }

    /// The post takes four times as long, and the load has no springs whose tips could be slower.
    #[test]
    fn a_load_that_only_obstacles_drive_has_slower_obstacles() {
        let mut scenario = Scenario::parse(include_str!("../../../scenarios/contact/pusher.json"), "pushed").unwrap();
        let effect = ByTrigger { driving_m: 16.0 * AIM * 1e-3, ..ByTrigger::default() };
        let mode = JumpMode { tick_angle: 0.1, zeta: 0.0, zeta_of_unit: 1.0 };
        let changes = |driver| Differences { driver, ..DIFFERENCES }.against_inertia(&effect, &Predicted::default(), &mode);
        let [change] = changes(Driver::of(&scenario.system))[..] else { panic!("one change expected") };
        let SuggestedChange::SlowerObstacles { factor } = change else { panic!("{change:?}") };
        // Rounding of a square root.
        assert!((factor - 0.25).abs() < 1e-15);
        change.apply(&mut scenario);
        let end = scenario.system.world.obstacles[0].path.waypoints[1].0;
        assert!((end - 4.0).abs() < 1e-14 && (scenario.duration - 4.0).abs() < 1e-14, "{end} {}", scenario.duration);
        scenario.system.world.obstacles.clear();
        assert_eq!(changes(Driver::of(&scenario.system)), []);
    }

    #[test]
    fn changes_against_inertia_follow_its_triggers() {
        let mode = |zeta: f64, tick_angle: f64| JumpMode { tick_angle, zeta, zeta_of_unit: 1.0 };
        let predicted = Predicted::default();
        let changes = |[start_m, jumps_m, driving_m]: [f64; 3], mode: &JumpMode, predicted: &Predicted| {
            DIFFERENCES.against_inertia(&ByTrigger { start_m, jumps_m, driving_m, ..ByTrigger::default() }, predicted, mode)
        };
        // Two thirds of the tolerance, which is a quarter of the effect.
        let share = AIM / 4.0;
        let small = 0.9e-3;
        assert_eq!(changes([small, small, 4e-3], &mode(0.0, 0.1), &predicted), [SuggestedChange::SlowerTips { factor: share }]);
        assert_eq!(changes([4e-3, 0.0, small], &mode(0.0, 0.1), &predicted), [SuggestedChange::SlowerStart { factor: share.sqrt() }]);
        // Tips stop before the lag is largest; a slower start leaves the lag as it is.
        let longer = Predicted { where_tips_stop_m: Some(8e-3), ..predicted };
        let tips = SuggestedChange::SlowerTips { factor: share / 2.0 };
        assert_eq!(changes([0.0, 0.0, 4e-3], &mode(0.0, 0.1), &longer), [tips]);
        assert_eq!(changes([4e-3, 0.0, small], &mode(0.0, 0.1), &longer), [tips, SuggestedChange::SlowerStart { factor: share.sqrt() }]);
        assert_eq!(changes([0.0, 4e-3, small], &mode(0.0, 0.1), &longer).len(), 2, "tips are not the cause");

        let jumps = |zeta: f64, tick_angle: f64| changes([0.0, 4e-3, 0.0], &mode(zeta, tick_angle), &predicted);
        let [SuggestedChange::SpringDamping { damping_ratio }, SuggestedChange::ReducedInertia { factor }] = jumps(0.0, PI / 10.0)[..]
        else {
            panic!("damping and reduced inertia expected")
        };
        // The overshoot of the step response gives the share back.
        assert!(((-PI * damping_ratio / (1.0 - damping_ratio * damping_ratio).sqrt()).exp() - share).abs() < 1e-14);
        // Half a swing takes longer by 1 / sqrt(1 - zeta^2) with damping.
        assert!((factor - 0.01 * (1.0 - damping_ratio * damping_ratio)).abs() < 1e-15);
        // At critical damping the control period is too short for the decay.
        let [SuggestedChange::ReducedInertia { factor }] = jumps(1.0, 2.0)[..] else { panic!("reduced inertia alone expected") };
        let left = |angle: f64| (1.0 + angle) * (-angle).exp();
        assert!((left(2.0 / factor.sqrt()) / left(2.0) - share).abs() < 1e-12);
        // All triggers at once, the largest first.
        let kinds = |changes: &[SuggestedChange]| changes.iter().map(std::mem::discriminant).collect::<Vec<_>>();
        let all = changes([2e-3, 4e-3, 3e-3], &mode(0.0, PI / 10.0), &predicted);
        assert_eq!(kinds(&all[..2]), kinds(&jumps(0.0, PI / 10.0)));
        let tips = SuggestedChange::SlowerTips { factor: AIM / 3.0 };
        assert_eq!(all[2..], [tips, SuggestedChange::SlowerStart { factor: (AIM / 2.0f64).sqrt() }]);
    }
}
