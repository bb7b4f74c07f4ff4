//! Forces on recorded tips, and their errors.
//!
//! The force on a tip is dU/dd of the polar spring, the negative of Eq. (10). Tip positions have
//! the error sigma along both axes, and the stiffnesses have errors of their own. The force F =
//! |f|, with u = f / F, then has the variance
//!
//! ```text
//! sigma^2 |H_d u|^2 + (u_r (l - l_0) sd(kappa_rho))^2 + (u_t psi / l sd(kappa_tau))^2
//! ```
//!
//! The first term differs from frame to frame and averages out. The other two are the same in all
//! frames and do not. Where the force is small beside sigma |H_d u|, it is biased upwards, as the
//! length of any noisy vector.
//!
//! Eq. (1) gives the force along the spring too, with its stiffening, while its pivots turn by at
//! most [`MOST_TURN`]. Eq. (2) and (3) hold only for tips on the path of their mechanism, which an
//! attached tip leaves. The force across the spring is therefore that of the linear law.

use std::collections::BTreeMap;

use serde::Serialize;

use super::case::{Case, MOST_TURN};
use super::recording::{Recording, Sample, Tip};
use super::sensor::Sensor;
use crate::paper::Transport;
use cohaul::formats::{self, Format, Versioned};
use cohaul::math::{Pose, Summary, Vec2};
use cohaul::model::{PolarSpring, SpringDesign, SpringShape};

/// Force on one tip at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Force {
    /// (s)
    pub time: f64,
    pub spring: usize,
    pub shape: SpringShape,
    /// Force outwards along the spring, and across it counter-clockwise (N).
    pub radial: f64,
    pub tangential: f64,
    /// Length of the force vector (N).
    pub size: f64,
    pub size_sd: f64,
    /// Part of the standard deviation that comes from the tip position (N). The rest is the same in
    /// all frames.
    pub tip_part: f64,
    /// Force outwards along the spring by Eq. (1) (N); `None` beyond its range or without a model.
    pub radial_by_model: Option<f64>,
    /// Force in world axes (N); `None` for a tip in the frame of its root.
    pub in_world: Option<Vec2>,
}

/// Share of the rest length below which a tip counts as near to its root (1).
const NEAR_ROOT: f64 = 0.1;

/// Summary of the forces on one spring, or on all.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ForceSummary {
    /// `null` for all springs together.
    pub spring: Option<usize>,
    pub n: u64,
    pub mean_n: f64,
    pub sd_n: f64,
    pub max_n: f64,
    pub max_sd_n: f64,
    pub time_of_max_s: f64,
    /// Standard error of the mean from the errors of the stiffnesses (N).
    pub mean_error_n: f64,
    /// Largest difference along the spring between the linear law and Eq. (1); `null` if all tips
    /// are beyond its range.
    pub linear_less_model_n: Option<f64>,
}

/// The result of `calibrate forces`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ForcesReport {
    pub n_frames: usize,
    /// One entry for each recorded spring, then one for all together.
    pub springs: Vec<ForceSummary>,
    pub tip_noise_m: f64,
    /// Load speed, turn rate, interaction forces and group size, with the test for a phase change;
    /// `null` for tips in the frames of their roots, and for a recording below half a second.
    pub transport: Option<Transport>,
    pub warnings: Vec<String>,
}

impl Versioned for ForcesReport {
    const FORMAT: Format = formats::CALIBRATE_FORCES;
}

/// Forces on the tips of a recording, in its order. Each swing is on the branch of the previous
/// frame.
pub fn tip_forces(recording: &Recording, sensor: &Sensor) -> Vec<Force> {
    let (mut frame, mut time) = (0usize, f64::NEG_INFINITY);
    let mut last: BTreeMap<usize, (usize, f64)> = BTreeMap::new();
    let mut forces = Vec::with_capacity(recording.samples.len());
    for sample in &recording.samples {
        if sample.time > time {
            (frame, time) = (frame + 1, sample.time);
        }
        // A tip without a previous frame begins at rest.
        let near = last.get(&sample.spring).filter(|(seen, _)| seen + 1 >= frame).map_or(0.0, |(_, swing)| *swing);
        let force = sensor.force(sample, near);
        last.insert(sample.spring, (frame, force.shape.swing));
        forces.push(force);
    }
    forces
}

impl Sensor {
    /// Number of tips beyond the range of the fit.
    pub fn n_beyond_fit(&self, found: &[Force]) -> usize {
        let stretch = |force: &Force| force.shape.length - self.spring(force.spring).rest_length;
        found.iter().filter(|force| self.fitted_to.ends_before(stretch(force), force.shape.swing)).count()
    }

    /// Number of tips so near to their root that the direction of the spring is uncertain.
    pub fn n_near_root(&self, found: &[Force]) -> usize {
        found.iter().filter(|force| force.shape.length < NEAR_ROOT * self.spring(force.spring).rest_length).count()
    }

    /// Force on the tip of a sample, with its swing on the branch nearest to `swing_near` (rad).
    pub fn force(&self, sample: &Sample, swing_near: f64) -> Force {
        let spring = self.spring(sample.spring);
        let (shape, in_world) = match &sample.tip {
            Tip::InRoot(tip) => (in_root(spring, tip, swing_near), None),
            Tip::InWorld { load, tip } => {
                let shape = spring.shape(load, tip, swing_near);
                (shape, Some(spring.pull(load, &shape)))
            }
        };
        Force { time: sample.time, spring: sample.spring, in_world, ..force(spring, &shape, self) }
    }
}

fn in_root(spring: &PolarSpring, tip: &Vec2, near: f64) -> SpringShape {
    PolarSpring { root: Vec2::zeros(), bearing: 0.0, ..*spring }.shape(&Pose::new(0.0, 0.0, 0.0), tip, near)
}

/// The force without time, spring and world axes.
fn force(spring: &PolarSpring, shape: &SpringShape, sensor: &Sensor) -> Force {
    let pull = spring.pull_in_root(shape);
    let along = if shape.length > 0.0 { shape.tip_in_root / shape.length } else { Vec2::new(1.0, 0.0) };
    let (radial, tangential) = (pull.dot(&along), along.perp(&pull));
    let size = pull.norm();
    let direction = if size > 0.0 { pull / size } else { along };
    // The load is turned so that the spring points along x. The force is then in the frame of the
    // root.
    let hessian = spring.reaction(&Pose::new(0.0, 0.0, -spring.bearing), shape).hessian;
    let tip_part = sensor.tip_error * (hessian.fixed_view::<2, 2>(0, 0) * direction).norm();
    let share = |part: f64, stiffness: f64, error: f64| if stiffness > 0.0 { part * error / stiffness } else { 0.0 };
    let by_radial = share(direction.dot(&along) * radial, spring.radial_stiffness, sensor.radial_error);
    let by_torsional = share(along.perp(&direction) * tangential, spring.torsional_stiffness, sensor.torsional_error);
    let stretch = shape.length - spring.rest_length;
    let within_reach = |model: &&SpringDesign| stretch.abs() <= MOST_TURN.sin() * Case::Radial.limit(model);
    Force {
        time: 0.0,
        spring: 0,
        shape: *shape,
        radial,
        tangential,
        size,
        size_sd: tip_part.hypot(by_radial).hypot(by_torsional),
        tip_part,
        radial_by_model: sensor.model.as_ref().filter(within_reach).map(|model| model.radial_force(stretch)),
        in_world: None,
    }
}

/// Of each spring in the order of their indices, then of all.
pub fn summaries(found: &[Force], sensor: &Sensor) -> Vec<ForceSummary> {
    let mut springs: Vec<usize> = found.iter().map(|force| force.spring).collect();
    springs.sort_unstable();
    springs.dedup();
    let each = springs.iter().map(Some).chain([None]);
    each.filter_map(|spring| {
        let own: Vec<&Force> = found.iter().filter(|force| spring.is_none_or(|spring| force.spring == *spring)).collect();
        summary(spring.copied(), &own, sensor)
    })
    .collect()
}

fn summary(spring: Option<usize>, forces: &[&Force], sensor: &Sensor) -> Option<ForceSummary> {
    let mut sizes = Summary::default();
    sizes.extend(forces.iter().map(|force| force.size));
    let strongest = forces.iter().max_by(|a, b| a.size.total_cmp(&b.size))?;
    let n = forces.len() as f64;
    let mean = |of: &dyn Fn(&Force) -> f64| forces.iter().map(|force| of(force)).sum::<f64>() / n;
    // dF/dkappa times kappa is the square of a component over the length.
    let share = |part: f64, size: f64| if size > 0.0 { part * part / size } else { 0.0 };
    let relative = |error: f64, of: fn(&PolarSpring) -> f64| {
        let stiffness = of(sensor.spring(strongest.spring));
        if stiffness > 0.0 { error / stiffness } else { 0.0 }
    };
    let by_radial = mean(&|force| share(force.radial, force.size)) * relative(sensor.radial_error, |spring| spring.radial_stiffness);
    let by_torsional =
        mean(&|force| share(force.tangential, force.size)) * relative(sensor.torsional_error, |spring| spring.torsional_stiffness);
    let apart = forces.iter().filter_map(|force| Some(force.radial - force.radial_by_model?));
    Some(ForceSummary {
        spring,
        n: sizes.n(),
        mean_n: sizes.mean(),
        sd_n: sizes.sd(),
        max_n: sizes.max(),
        max_sd_n: strongest.size_sd,
        time_of_max_s: strongest.time,
        mean_error_n: by_radial.hypot(by_torsional),
        linear_less_model_n: apart.max_by(|a, b| a.abs().total_cmp(&b.abs())),
    })
}
