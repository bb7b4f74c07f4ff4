//! Steering gain k, half angle beta and speed v of pulling ants, by least squares on the paths of
//! their tips.
//!
//! Each attachment has a place and a direction of its own at its beginning. For each value of the
//! three common parameters these are fitted anew, so that the cost depends on the three alone.

use rayon::prelude::*;
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::attachments::Attachment;
use super::path::{Residuals, Track};
use super::profile::{Cost, Minimum, N_PASSES, Parameter, Slope, minimum, parameter};
use cohaul::math::{Mat3, Vec2, Vec3, student};
use cohaul::stop::{self, Stop};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteeringFit {
    /// k (1/s).
    pub steering_gain_per_s: Parameter,
    /// beta (rad).
    pub steering_half_angle_rad: Parameter,
    /// Speed of a pulling ant (m/s).
    pub pull_speed_m_per_s: Parameter,
    /// k (1/s), beta (rad) and speed (m/s) of the smallest residuals. They need not be determined.
    #[serde(skip)]
    pub best: [f64; 3],
    /// Attachments that were long enough, and their samples.
    pub n_tracks: usize,
    pub n_samples: usize,
    /// Residuals of tip positions along either axis, corrected for the number of parameters (m).
    pub residual_rms_m: f64,
    /// Noise of tip positions along either axis, by their second differences from frame to frame
    /// (m). It needs no fit, and residuals far above it show that ants follow another law.
    pub noise_between_frames_m: f64,
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
pub(super) const LEAST_NOISE: f64 = 1e-9;

struct Paths<'a> {
    tracks: &'a [Track],
    nest: Vec2,
}

/// Place and direction (m, m, rad) at the beginning of each track.
type Starts = Vec<Vec3>;

impl Paths<'_> {
    /// Residuals of a track with its best beginning, and that beginning, by steps from `start`.
    fn settled(&self, track: &Track, steering: &Vec3, mut start: Vec3) -> (Residuals, Vec3) {
        stop::point();
        let mut found = track.residuals(&self.nest, &start, steering);
        let exact = 1e-6 * track.times.len() as f64 * LEAST_NOISE * LEAST_NOISE;
        for _ in 0..20 {
            let Some(step) = found.step() else { break };
            let promised = -0.5 * found.gradient.fixed_rows::<3>(0).dot(&step);
            if promised <= SETTLED * found.cost + exact {
                break;
            }
            let shorter = (0..6).map(|halvings| start + 0.25f64.powi(halvings) * step);
            let mut tried = shorter.map(|start| (track.residuals(&self.nest, &start, steering), start));
            let Some(better) = tried.find(|(next, _)| next.cost < found.cost) else { break };
            (found, start) = better;
        }
        (found, start)
    }

    /// All tracks with their best beginnings. The threads share the tracks, and the sums do not
    /// depend on that.
    fn all_settled(&self, steering: &Vec3, near: &Starts) -> Vec<(Residuals, Vec3)> {
        let stop = Stop::current();
        let settled = |(track, start): (&Track, &Vec3)| stop.within(|| self.settled(track, steering, *start));
        self.tracks.par_iter().zip(near).map(settled).collect()
    }

    /// Beginnings on a grid of directions.
    fn first_starts(&self, steering: &Vec3) -> Starts {
        self.tracks.iter().map(|track| track.start(&self.nest, steering)).collect()
    }
}

impl Cost for Paths<'_> {
    type Hidden = Starts;

    fn at(&self, point: &Vec3, near: &Starts) -> (Slope, Starts) {
        let mut slope = Slope { cost: 0.0, gradient: Vec3::zeros(), curvature: Mat3::zeros() };
        let (residuals, starts): (Vec<Residuals>, Starts) = self.all_settled(point, near).into_iter().unzip();
        for found in residuals {
            slope.cost += found.cost;
            if let Some((gradient, curvature)) = found.reduced() {
                slope.gradient += gradient;
                slope.curvature += curvature;
            }
        }
        (slope, starts)
    }

    /// Tries other directions at the beginning of each track: some may have settled in a minimum
    /// that is not the lowest.
    fn look_around(&self, point: &Vec3, found: &Starts) -> Starts {
        let [kept, other] = [found.clone(), self.first_starts(point)].map(|starts| self.all_settled(point, &starts));
        kept.into_iter().zip(other).map(|(kept, other)| if other.0.cost < kept.0.cost { other.1 } else { kept.1 }).collect()
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
///
/// `done` receives the share of the work done (1).
pub fn fit(attachments: &[Attachment], nest: Vec2, tip_error: f64, level: f64, done: &dyn Fn(f64)) -> Option<SteeringFit> {
    let tracks: Vec<Track> = attachments.iter().filter_map(|own| Track::of(own, &nest, LEAST_SAMPLES)).collect();
    let n_samples: usize = tracks.iter().map(|track| track.times.len()).sum();
    let free = 2.0 * n_samples as f64 - 3.0 * tracks.len() as f64 - 3.0;
    if tracks.is_empty() {
        return None;
    }
    let steering = chosen_start(&tracks, nest)?;
    done(0.1);
    let cost = Paths { tracks: &tracks, nest };
    let mut best = minimum(&cost, Minimum::start(&cost, &steering, &cost.first_starts(&steering)), [false; 3]);
    best = minimum(&cost, Minimum::start(&cost, &best.point, &cost.look_around(&best.point, &best.hidden)), [false; 3]);
    done(0.25);
    let variance = |best: &Minimum<Starts>| (2.0 * best.slope.cost / free).max(LEAST_NOISE * LEAST_NOISE);
    let mut found = [Parameter::default(); 3];
    for _ in 0..N_PASSES {
        let before = best.slope.cost;
        let rise = 0.5 * variance(&best) * student(level, free).powi(2);
        found = std::array::from_fn(|i| {
            let found = parameter(&cost, &mut best, i, rise);
            done(0.5 + 0.25 * i as f64);
            found
        });
        if best.slope.cost > before - 1e-3 * rise {
            break;
        }
        best = minimum(&cost, best, [false; 3]);
    }
    let chi_squared = 2.0 * best.slope.cost / (tip_error * tip_error);
    Some(SteeringFit {
        steering_gain_per_s: found[0].map(f64::exp),
        steering_half_angle_rad: found[1],
        pull_speed_m_per_s: found[2],
        best: [best.point[0].exp(), best.point[1], best.point[2]],
        n_tracks: tracks.len(),
        n_samples,
        residual_rms_m: (2.0 * best.slope.cost / free).sqrt(),
        noise_between_frames_m: noise_between_frames(&tracks),
        p_value: if tip_error > 0.0 { ChiSquared::new(free).ok().map(|law| law.sf(chi_squared)) } else { None },
    })
}

/// Noise of the tips along either axis (m). The second difference of three independent positions
/// has six times their variance; the walk between three frames is nearly straight.
fn noise_between_frames(tracks: &[Track]) -> f64 {
    let second = |three: &[Vec2]| three[0] - 2.0 * three[1] + three[2];
    let squares: Vec<f64> = tracks.iter().flat_map(|track| track.tips.windows(3).map(move |three| second(three).norm_squared())).collect();
    (squares.iter().sum::<f64>() / (12.0 * squares.len().max(1) as f64)).sqrt()
}

/// The best of several starts on the longest tracks.
fn chosen_start(tracks: &[Track], nest: Vec2) -> Option<Vec3> {
    let mut longest: Vec<Track> = tracks.to_vec();
    longest.sort_by_key(|track| std::cmp::Reverse(track.times.len()));
    longest.truncate(N_CHOOSING);
    let speed = longest.iter().map(Track::mean_speed).fold(0.0, f64::max);
    let start = |gain: f64, half_angle: f64| {
        let steering = Vec3::new(gain.ln(), half_angle, speed);
        let paths = Paths { tracks: &longest, nest };
        minimum(&paths, Minimum::start(&paths, &steering, &paths.first_starts(&steering)), [false; 3])
    };
    let all = [3.0, 15.0].into_iter().flat_map(|gain| [0.4, 0.9, 1.4].map(|half_angle| start(gain, half_angle)));
    all.min_by(|a, b| a.slope.cost.total_cmp(&b.slope.cost)).map(|best| best.point)
}
