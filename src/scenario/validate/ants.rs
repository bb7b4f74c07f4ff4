//! Rules of the ants' parameters, and defaults from their preset.

use std::f64::consts::PI;

use super::shared::MOST_ANTS;
use crate::model::avoidance::Avoidance;
use crate::model::behaviour::{GraspPace, ReleaseLaw, ReleasePace};
use crate::scenario::AntDrive;
use crate::scenario::error::{Findings, number};
use crate::scenario::format::AntsEntry;
use crate::scenario::presets;

/// Least radius of an ant over the distance that it walks in a control period (1). A longer step is
/// taken in more pieces, each shorter than the ant.
const LEAST_RADIUS: f64 = 0.01;

/// Ants on `n_springs` springs with this control period (s), where those are known, with or without
/// obstacles.
pub fn ants(
    entry: &AntsEntry,
    n_springs: Option<usize>,
    control_period: Option<f64>,
    has_obstacles: bool,
    findings: &mut Findings,
) -> AntDrive {
    let ants = with_defaults(entry, has_obstacles);
    findings.count("drive.n_ants", ants.n_ants, MOST_ANTS);
    if n_springs == Some(0) {
        findings.report("springs", "must have at least one spring for the ants", "none");
    }
    check_walk(&ants, findings);
    check_grasp(&ants, findings);
    check_release(&ants, control_period, findings);
    check_avoidance(&ants, control_period, findings);
    ants
}

fn with_defaults(entry: &AntsEntry, has_obstacles: bool) -> AntDrive {
    let preset = presets::ants(entry.preset.unwrap_or_default(), entry.n_ants);
    AntDrive {
        n_ants: entry.n_ants,
        nest_position: entry.nest_position_m.map_or(preset.nest_position, Into::into),
        arrival_radius: entry.arrival_radius_m.unwrap_or(preset.arrival_radius),
        start_half_width: entry.start_half_width_m.unwrap_or(preset.start_half_width),
        search_speed: entry.search_speed_m_per_s.unwrap_or(preset.search_speed),
        pull_speed: entry.pull_speed_m_per_s.unwrap_or(preset.pull_speed),
        sensing_range: entry.sensing_range_m.unwrap_or(preset.sensing_range),
        target_variance: entry.target_variance_m2.unwrap_or(preset.target_variance),
        target_redraw_period: entry.target_redraw_period_s.unwrap_or(preset.target_redraw_period),
        steering_gain: entry.steering_gain_per_s.unwrap_or(preset.steering_gain),
        steering_half_angle: entry.steering_half_angle_rad.unwrap_or(preset.steering_half_angle),
        control_offset: entry.control_offset_m.unwrap_or(preset.control_offset),
        grasp_probability: entry.grasp_probability.unwrap_or(preset.grasp_probability),
        grasp_decision_period: entry.grasp_decision_period_s.unwrap_or(preset.grasp_decision_period),
        grasp_pace: entry.grasp_pace.unwrap_or(preset.grasp_pace),
        release: ReleaseLaw {
            strong_pull: entry.strong_pull_n.unwrap_or(preset.release.strong_pull),
            steepness: entry.release_steepness_per_n.unwrap_or(preset.release.steepness),
            period: entry.release_decision_period_s.unwrap_or(preset.release.period),
        },
        release_pace: entry.release_pace.unwrap_or(preset.release_pace),
        avoidance: entry.avoidance.unwrap_or(if has_obstacles { Avoidance::Sidestep } else { preset.avoidance }),
        body_radius: entry.body_radius_m.unwrap_or(preset.body_radius),
        look_ahead: entry.look_ahead_m.unwrap_or(preset.look_ahead),
    }
}

fn check_walk(ants: &AntDrive, findings: &mut Findings) {
    findings.finite_vector("drive.nest_position_m", ants.nest_position.as_slice());
    findings.positive_size("drive.arrival_radius_m", ants.arrival_radius);
    findings.not_negative("drive.start_half_width_m", ants.start_half_width);
    findings.not_negative("drive.search_speed_m_per_s", ants.search_speed);
    findings.not_negative("drive.pull_speed_m_per_s", ants.pull_speed);
    findings.not_negative("drive.sensing_range_m", ants.sensing_range);
    findings.not_negative("drive.target_variance_m2", ants.target_variance);
    findings.positive_size("drive.target_redraw_period_s", ants.target_redraw_period);
    findings.not_negative("drive.steering_gain_per_s", ants.steering_gain);
    let half_angle = ants.steering_half_angle;
    findings.require((0.0..=PI).contains(&half_angle), "drive.steering_half_angle_rad", "must be from 0 to pi", half_angle);
    findings.not_negative("drive.control_offset_m", ants.control_offset);
}

fn check_grasp(ants: &AntDrive, findings: &mut Findings) {
    let probability = ants.grasp_probability;
    let (holds, rule) = match ants.grasp_pace {
        // A certain event has no finite hazard.
        GraspPace::Hazard => ((0.0..1.0).contains(&probability), "must be at least 0 and below 1 for the pace \"hazard\""),
        GraspPace::PerTick => ((0.0..=1.0).contains(&probability), "must be from 0 to 1"),
    };
    findings.require(holds, "drive.grasp_probability", rule, probability);
    findings.positive_size("drive.grasp_decision_period_s", ants.grasp_decision_period);
}

fn check_release(ants: &AntDrive, control_period: Option<f64>, findings: &mut Findings) {
    let ReleaseLaw { strong_pull, steepness, period } = ants.release;
    findings.not_negative("drive.strong_pull_n", strong_pull);
    findings.not_negative("drive.release_steepness_per_n", steepness);
    findings.positive_size("drive.release_decision_period_s", period);
    // An ant decides at ticks: with more than one decision a tick the printed odds would be those
    // of another period.
    if ants.release_pace == ReleasePace::Aged && period > 0.0 && control_period.is_some_and(|tick| period < tick) {
        let rule = "must not be shorter than the control period for the release pace \"aged\"";
        findings.report("drive.release_decision_period_s", rule, number(period));
    }
}

fn check_avoidance(ants: &AntDrive, control_period: Option<f64>, findings: &mut Findings) {
    findings.positive_size("drive.body_radius_m", ants.body_radius);
    findings.positive_size("drive.look_ahead_m", ants.look_ahead);
    let Some(period) = control_period.filter(|_| ants.avoidance != Avoidance::None && ants.body_radius > 0.0) else { return };
    let least = LEAST_RADIUS * ants.search_speed.max(ants.pull_speed) * period;
    if ants.body_radius < least {
        let rule = format!("must be at least {}, a hundredth of the distance that an ant walks in a control period", number(least));
        findings.report("drive.body_radius_m", rule, number(ants.body_radius));
    }
}
