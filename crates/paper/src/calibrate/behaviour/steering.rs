//! Steering gain k, half angle beta and speed v of pulling ants, by least squares on the paths of
//! their tips.
//!
//! Each attachment has a place and a direction of its own at its beginning. For each value of the
//! three common parameters these are fitted anew, so that the cost depends on the three alone.

use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::attachments::Attachment;
use super::path::{Residuals, Track};
use super::profile::{Cost, Minimum, N_PASSES, Parameter, Slope, minimum, parameter};
use cohaul::math::{Mat3, Vec2, Vec3, student};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteeringFit {
    /// k (1/s).
    pub steering_gain_per_s: Parameter,
    /// beta (rad).
    pub steering_half_angle_rad: Parameter,
    /// Speed of a pulling ant (m/s).
    pub pull_speed_m_per_s: Parameter,
    /// Attachments that were long enough, and their samples.
    pub n_tracks: usize,
    pub n_samples: usize,
    /// Residuals of tip positions along either axis, corrected for the number of parameters (m).
    pub residual_rms_m: f64,
    /// Probability of residuals as large, if the stated noise of the tips were the only one; `null`
    /// without stated noise.
    pub p_value: Option<f64>,
}

/// Least number of samples of a track: with fewer, its own three parameters leave too little.
const LEAST_SAMPLES: usize = 6;
/// Number of tracks that choose among the starts.
const N_CHOOSING: usize = 24;
/// Relative change of the cost of a track below which its beginning counts as found.
const SETTLED: f64 = 1e-10;
/// Least noise of a tip along either axis (m): no camera measures more exactly.
const LEAST_NOISE: f64 = 1e-9;

struct Paths<'a> {
    tracks: &'a [Track],
    nest: Vec2,
    starts: Vec<Vec3>,
}

impl Paths<'_> {
    /// Residuals of one track with its best beginning.
    fn settled(&mut self, index: usize, steering: &Vec3) -> Residuals {
        let (track, nest) = (&self.tracks[index], self.nest);
        let mut found = track.residuals(&nest, &self.starts[index], steering);
        let exact = 1e-6 * track.times.len() as f64 * LEAST_NOISE * LEAST_NOISE;
        for _ in 0..20 {
            let Some(mut step) = found.step() else { break };
            let promised = -0.5 * found.gradient.fixed_rows::<3>(0).dot(&step);
            if promised <= SETTLED * found.cost + exact {
                break;
            }
            let mut is_better = false;
            for _ in 0..6 {
                let start = self.starts[index] + step;
                let next = track.residuals(&nest, &start, steering);
                is_better = next.cost < found.cost;
                if is_better {
                    (self.starts[index], found) = (start, next);
                    break;
                }
                step *= 0.25;
            }
            if !is_better {
                break;
            }
        }
        found
    }

    /// Tries other directions at the beginning of each track: some may have settled in a minimum
    /// that is not the lowest.
    fn look_around(&mut self, steering: &Vec3) {
        for index in 0..self.tracks.len() {
            let (before, kept) = (self.settled(index, steering).cost, self.starts[index]);
            self.starts[index] = self.tracks[index].start(&self.nest, steering);
            if self.settled(index, steering).cost >= before {
                self.starts[index] = kept;
            }
        }
    }
}

impl Cost for Paths<'_> {
    fn at(&mut self, point: &Vec3) -> Slope {
        let mut slope = Slope { cost: 0.0, gradient: Vec3::zeros(), curvature: Mat3::zeros() };
        for index in 0..self.tracks.len() {
            let found = self.settled(index, point);
            slope.cost += found.cost;
            if let Some((gradient, curvature)) = found.reduced() {
                slope.gradient += gradient;
                slope.curvature += curvature;
            }
        }
        slope
    }

    fn resolution(&self) -> f64 {
        self.tracks.iter().map(|track| track.times.len()).sum::<usize>() as f64 * 1e-6 * LEAST_NOISE * LEAST_NOISE
    }

    fn bounds(&self) -> [[f64; 2]; 3] {
        [[-3.0, 7.0], [0.0, std::f64::consts::PI], [0.0, 10.0]]
    }
}

/// Fits the steering of all attachments that have enough samples in world axes. `tip_error` is the
/// stated standard deviation of a tip along either axis (m). `None` without such attachments.
pub fn fit(attachments: &[Attachment], nest: Vec2, tip_error: f64, level: f64) -> Option<SteeringFit> {
    let tracks: Vec<Track> = attachments.iter().filter_map(|own| Track::of(own, &nest, LEAST_SAMPLES)).collect();
    let n_samples: usize = tracks.iter().map(|track| track.times.len()).sum();
    let free = 2.0 * n_samples as f64 - 3.0 * tracks.len() as f64 - 3.0;
    if tracks.is_empty() {
        return None;
    }
    let steering = chosen_start(&tracks, nest)?;
    let starts = tracks.iter().map(|track| track.start(&nest, &steering)).collect();
    let mut cost = Paths { tracks: &tracks, nest, starts };
    let mut best = minimum(&mut cost, &steering, [false; 3]);
    cost.look_around(&best.point);
    best = minimum(&mut cost, &best.point, [false; 3]);
    let variance = |best: &Minimum| (2.0 * best.slope.cost / free).max(LEAST_NOISE * LEAST_NOISE);
    let mut found = [Parameter::default(); 3];
    for _ in 0..N_PASSES {
        let before = best.slope.cost;
        let rise = 0.5 * variance(&best) * student(level, free).powi(2);
        found = std::array::from_fn(|i| parameter(&mut cost, &mut best, i, rise));
        if best.slope.cost > before - 1e-3 * rise {
            break;
        }
        best = minimum(&mut cost, &best.point, [false; 3]);
    }
    let chi_squared = 2.0 * best.slope.cost / (tip_error * tip_error);
    Some(SteeringFit {
        steering_gain_per_s: found[0].map(f64::exp),
        steering_half_angle_rad: found[1],
        pull_speed_m_per_s: found[2],
        n_tracks: tracks.len(),
        n_samples,
        residual_rms_m: (2.0 * best.slope.cost / free).sqrt(),
        p_value: if tip_error > 0.0 { ChiSquared::new(free).ok().map(|law| law.sf(chi_squared)) } else { None },
    })
}

/// The best of several starts on the longest tracks.
fn chosen_start(tracks: &[Track], nest: Vec2) -> Option<Vec3> {
    let mut longest: Vec<Track> = tracks.to_vec();
    longest.sort_by_key(|track| std::cmp::Reverse(track.times.len()));
    longest.truncate(N_CHOOSING);
    let speed = longest.iter().map(Track::mean_speed).fold(0.0, f64::max);
    let start = |gain: f64, half_angle: f64| {
        let steering = Vec3::new(gain.ln(), half_angle, speed);
        let starts = longest.iter().map(|track| track.start(&nest, &steering)).collect();
        minimum(&mut Paths { tracks: &longest, nest, starts }, &steering, [false; 3])
    };
    let all = [3.0, 15.0].into_iter().flat_map(|gain| [0.4, 0.9, 1.4].map(|half_angle| start(gain, half_angle)));
    all.min_by(|a, b| a.slope.cost.total_cmp(&b.slope.cost)).map(|best| best.point)
}
