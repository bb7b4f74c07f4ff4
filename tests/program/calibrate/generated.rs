//! Generated measurements with a known truth: forces of the model, trials with different stiffness,
//! and noise. They serve tests and the planning of experiments.

use std::fmt::Write;

use cohaul::math::{RandomStreams, Stream};
use cohaul::model::SpringDesign;
use cohaul_paper::calibrate::{Case, Measurement, Measurements};

/// Plan of the measurements, and their errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    pub n_trials: usize,
    /// Number of points, equally spaced from one step above zero to the largest displacement.
    pub n_points: usize,
    /// Largest stretch (m), and swings of the two tangential cases (rad).
    pub reach: [f64; 3],
    /// Standard deviation of Young's modulus between trials, relative to the true one (1).
    pub between_trials: f64,
    /// Standard deviation of a force (N).
    pub noise: f64,
    /// Whether the noise is stated as an error bar.
    pub states_noise: bool,
    pub seed: u64,
}

impl Plan {
    pub const EXAMPLE: Plan =
        Plan { n_trials: 5, n_points: 10, reach: [1e-2, 0.8, -0.5], between_trials: 0.03, noise: 1e-4, states_noise: true, seed: 2010 };
}

/// Comment at the top of `data/spring-calibration.csv`.
pub const EXAMPLE_COMMENT: &str =
    "Generated, not measured: the paper's spring (E = 1.66 MPa), trials 3 % apart, 0.1 mN of noise, seed 2010.
cargo run --example generate_measurements prints this file.";

/// Measurements of all cases with a largest displacement other than zero.
pub fn measurements(truth: &SpringDesign, plan: &Plan) -> Measurements {
    let streams = RandomStreams::new(plan.seed);
    let mut found = Measurements::default();
    for (index, (case, reach)) in Case::ALL.into_iter().zip(plan.reach).enumerate().filter(|(_, (_, reach))| *reach != 0.0) {
        for trial in 0..plan.n_trials {
            let agent = (index * plan.n_trials + trial) as u32;
            let stiffer = 1.0 + plan.between_trials * streams.normal_pair(Stream::Scene, agent, 0).x;
            for i in 1..=plan.n_points {
                let at = reach * i as f64 / plan.n_points as f64;
                let noise = plan.noise * streams.normal_pair(Stream::Scene, agent, i as u64).x;
                let point = Measurement { at, force: stiffer * case.force(truth, at) + noise, sd: plan.states_noise.then_some(plan.noise) };
                found.add(case, (trial + 1).to_string(), point);
            }
        }
    }
    found
}

/// The measurements as a CSV file. Its last digits are micrometres, 0.1 mrad and 10 nN.
pub fn to_csv(measurements: &Measurements, comment: &str) -> String {
    let mut text: String = comment.lines().map(|line| format!("# {line}\n")).collect();
    let has_sds = measurements.has_sds();
    text.push_str("case,trial,displacement_m,swing_rad,force_n");
    text.push_str(if has_sds { ",force_sd_n\n" } else { "\n" });
    for trial in &measurements.trials {
        for point in &trial.points {
            let at = if trial.case.is_radial() { format!("{:.6},", point.at) } else { format!(",{:.4}", point.at) };
            let sd = point.sd.map_or(String::new(), |sd| format!(",{sd:.8}"));
            writeln!(text, "{},{},{at},{:.8}{sd}", trial.case.name(), trial.name, point.force).expect("a string takes all");
        }
    }
    text
}
