//! Scenes scaled by a factor: the speed of what drives the load, the size of everything, or the
//! inertia of the load.
//!
//! Without dashpots each of them leaves the shape of the quasi-static path as it is, so that only
//! the inertia effect changes. A factor s multiplies
//!
//! ```text
//!                                            speed     size      inertia
//! lengths                                    1         s         1
//! times, control period, decision periods    1/s       s         1
//! speeds of tips, obstacles, ants and start  s         1         1
//! mass                                       1         s^3       s
//! moment of inertia                          1         s^5       s
//! normal loads, pulls of ants                1         s^3       1
//! radial and torsional stiffness             1         s^2, s^4  1
//! damping ratios                             1         1         s^(-1/2)
//! dashpot coefficients                       1         s^(5/2)   1
//! ```
//!
//! *Speed* stretches all times alike, so that a slow motion is not cut off and every control tick
//! falls on the same place of the paths. Rates and decision periods of ants are times too: their
//! random numbers belong to ticks and stay.
//!
//! *Size* is geometric similarity at the same density, gravity and speeds. The weight grows with
//! the volume. Springs are those with which the quasi-static problem stays similar: f / (k l), with
//! the slip limit f, and the ratio of the two stiffnesses to l^2 do not change. What changes is the
//! Froude number v^2 / (g l), by 1/s; *speed* changes it by s^2. A scene of s times the size is
//! therefore similar to one at s^(-1/2) times the speed.
//!
//! *Inertia* changes epsilon and Phi at the same friction and the same dashpots.

use super::data::{AntDrive, Drive, Scenario, TipPath};
use crate::model::{Obstacle, Outline, OutlinePart, PolarSpring};

impl Scenario {
    /// Multiplies the speed of everything that drives the load by a `factor` (1): tips, obstacles
    /// that move, the start, and all clocks and speeds of ants. Times stretch by its inverse, and
    /// so do releases, the duration and the control period.
    pub fn scale_speed(&mut self, factor: f64) {
        self.stretch_times(factor.recip());
        self.scale_start_speed(factor);
        if let Drive::Ants(ants) = &mut self.drive {
            ants.search_speed *= factor;
            ants.pull_speed *= factor;
        }
    }

    /// Multiplies all lengths by a `factor` (1), and masses and stiffnesses so that the scene stays
    /// similar at the same density, gravity and speeds.
    pub fn scale_size(&mut self, factor: f64) {
        let weight = factor.powi(3);
        self.stretch_times(factor);
        self.start.pose.position *= factor;
        self.start.twist.angular /= factor;
        let system = &mut self.system;
        system.load.radius *= factor;
        system.load.mass *= weight;
        system.load.inertia *= weight * factor.powi(2);
        for support in &mut system.ground.supports {
            support.offset *= factor;
            support.normal_load *= weight;
        }
        system.springs.iter_mut().for_each(|spring| scale_spring(spring, factor));
        scale_outline(&mut system.world.outline, factor);
        system.world.obstacles.iter_mut().for_each(|obstacle| scale_obstacle(obstacle, factor));
        match &mut self.drive {
            Drive::Tips(paths) => paths.iter_mut().flat_map(|path| &mut path.waypoints).for_each(|at| at.position *= factor),
            Drive::Ants(ants) => scale_ants(ants, factor),
        }
    }

    /// Multiplies all times by a `factor` (1): those of tips, releases and obstacles, the duration,
    /// the control period, and the clocks of ants.
    pub fn stretch_times(&mut self, factor: f64) {
        self.duration *= factor;
        self.control_period *= factor;
        let obstacles = self.system.world.obstacles.iter_mut();
        obstacles.flat_map(|obstacle| &mut obstacle.path.waypoints).for_each(|(time, _)| *time *= factor);
        match &mut self.drive {
            Drive::Tips(paths) => paths.iter_mut().for_each(|path| stretch_path(path, factor)),
            Drive::Ants(ants) => stretch_clocks(ants, factor),
        }
    }

    /// Multiplies the velocity of the load at the start by a `factor` (1).
    pub fn scale_start_speed(&mut self, factor: f64) {
        self.start.twist.linear *= factor;
        self.start.twist.angular *= factor;
    }

    /// Largest speed of what drives the load (m/s): of a tip, of the points of an obstacle, of the
    /// edge of the load at the start, or of an ant that pulls. Zero if nothing does.
    pub fn drive_speed(&self) -> f64 {
        let twist = &self.start.twist;
        let start = twist.linear.norm() + self.system.load.radius * twist.angular.abs();
        let of_drive = match &self.drive {
            Drive::Tips(paths) => paths.iter().map(tip_speed).fold(0.0, f64::max),
            Drive::Ants(ants) => ants.pull_speed,
        };
        let obstacles = self.system.world.obstacles.iter().map(obstacle_speed).fold(0.0, f64::max);
        start.max(of_drive).max(obstacles)
    }
}

fn stretch_path(path: &mut TipPath, factor: f64) {
    path.waypoints.iter_mut().for_each(|at| at.time *= factor);
    path.release = path.release.map(|time| time * factor);
}

fn stretch_clocks(ants: &mut AntDrive, factor: f64) {
    ants.steering_gain /= factor;
    for period in [&mut ants.target_redraw_period, &mut ants.grasp_decision_period, &mut ants.release.period] {
        *period *= factor;
    }
}

fn tip_speed(path: &TipPath) -> f64 {
    let speed = |pair: &[super::Waypoint]| (pair[1].position - pair[0].position).norm() / (pair[1].time - pair[0].time);
    path.waypoints.windows(2).map(speed).fold(0.0, f64::max)
}

fn obstacle_speed(obstacle: &Obstacle) -> f64 {
    let times: Vec<f64> = obstacle.path.waypoints.iter().map(|(time, _)| *time).collect();
    let speed = |pair: &[f64]| obstacle.path_length(pair[0], pair[1]) / (pair[1] - pair[0]);
    times.windows(2).map(speed).fold(0.0, f64::max)
}

fn scale_spring(spring: &mut PolarSpring, factor: f64) {
    spring.root *= factor;
    spring.rest_length *= factor;
    spring.radial_stiffness *= factor.powi(2);
    spring.torsional_stiffness *= factor.powi(4);
}

fn scale_obstacle(obstacle: &mut Obstacle, factor: f64) {
    scale_outline(&mut obstacle.outline, factor);
    obstacle.path.waypoints.iter_mut().for_each(|(_, pose)| pose.position *= factor);
}

fn scale_outline(outline: &mut Outline, factor: f64) {
    for part in &mut outline.parts {
        match part {
            OutlinePart::Disc { centre, radius } => {
                *centre *= factor;
                *radius *= factor;
            }
            OutlinePart::Polygon { corners: points } | OutlinePart::Polyline { points } => {
                points.iter_mut().for_each(|point| *point *= factor);
            }
        }
    }
}

/// Lengths of ants, and the pulls of which their releases depend.
fn scale_ants(ants: &mut AntDrive, factor: f64) {
    let lengths = [
        &mut ants.arrival_radius,
        &mut ants.start_half_width,
        &mut ants.sensing_range,
        &mut ants.control_offset,
        &mut ants.body_radius,
        &mut ants.look_ahead,
    ];
    lengths.into_iter().for_each(|length| *length *= factor);
    ants.nest_position *= factor;
    ants.target_variance *= factor.powi(2);
    ants.release.strong_pull *= factor.powi(3);
    ants.release.steepness /= factor.powi(3);
}
