//! How long ants hold on under a pull: the release law of Eq. (18) by maximum likelihood.
//!
//! An ant that decides at any time lets go with the rate h(F) = softplus(zeta (F - F_m / 2)) / D_r.
//! Over the time between two frames it holds on with the probability exp(-H), where H is the
//! integral of h by the trapezoidal rule. An ant that decides once per period D_r after its grasp
//! holds on with the probability of Eq. (18), which is exp(-softplus z): the same law with one
//! exposure of the duration D_r for each decision.
//!
//! The three parameters are ln zeta, F_m and ln D_r in units of the root mean square of the pulls
//! and of the mean duration of an attachment.

use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::attachments::Attachment;
use super::profile::{Cost, Minimum, N_PASSES, Parameter, Slope, minimum, parameter, threshold};
use cohaul::math::{Mat3, Vec3};
use cohaul::model::behaviour::ReleaseLaw;
use cohaul::stop;

/// The pulls at both ends of some time (N), its duration (s), and whether the ant let go in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    pub pulls: [f64; 2],
    pub duration: f64,
    pub is_release: bool,
}

impl Exposure {
    /// (N)
    fn mean_pull(&self) -> f64 {
        0.5 * (self.pulls[0] + self.pulls[1])
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HoldFit {
    /// Steepness zeta (1/N).
    pub steepness_per_n: Parameter,
    /// F_m (N).
    pub strong_pull_n: Parameter,
    /// D_r (s).
    pub decision_period_s: Parameter,
    /// The law of highest likelihood. Its parameters may be undetermined where its rates are not.
    #[serde(skip)]
    pub law: ReleaseLaw,
    pub log_likelihood: f64,
    pub bins: Vec<Bin>,
    /// Chi squared of the releases in the bins, and the probability of a larger one; `null` with
    /// fewer than four bins.
    pub chi_squared: Option<f64>,
    pub p_value: Option<f64>,
}

/// Releases within a range of pulls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    pub pull_low_n: f64,
    pub pull_high_n: f64,
    pub mean_pull_n: f64,
    /// Time under these pulls, of all ants (s).
    pub duration_s: f64,
    pub n_releases: usize,
    pub n_expected: f64,
}

/// Exposures of ants that decide at any time.
pub fn exposures(attachments: &[Attachment]) -> Vec<Exposure> {
    let of = |own: &Attachment| {
        let mut points: Vec<(f64, f64)> = own.held.iter().map(|held| (held.time, held.pull)).collect();
        points.extend(own.release);
        let n = points.len();
        let exposure = |i: usize| Exposure {
            pulls: [points[i].1, points[i + 1].1],
            duration: points[i + 1].0 - points[i].0,
            is_release: own.release.is_some() && i + 2 == n,
        };
        (0..n.saturating_sub(1)).map(exposure).filter(|exposure| exposure.duration > 0.0).collect::<Vec<_>>()
    };
    attachments.iter().flat_map(of).collect()
}

/// Exposures of ants that decide once per `period` (s) after their grasp. A release belongs to the
/// nearest decision. Attachments whose grasp was not seen are left out.
pub fn aged_exposures(attachments: &[Attachment], period: f64) -> Vec<Exposure> {
    let mut found = Vec::new();
    for own in attachments.iter().filter(|own| own.has_grasp) {
        let (begin, ages) = (own.held[0].time, own.duration() / period);
        let n = if own.release.is_some() { ages.round().max(1.0) } else { (ages + 1e-6).floor() } as usize;
        for decision in 1..=n {
            let is_release = own.release.is_some() && decision == n;
            let time = begin + decision as f64 * period;
            let at = own.held.partition_point(|held| held.time < time - 1e-6 * period);
            let pull = match own.release {
                Some((_, pull)) if is_release => pull,
                _ => own.held[at.min(own.held.len() - 1)].pull,
            };
            found.push(Exposure { pulls: [pull; 2], duration: period, is_release });
        }
    }
    found
}

/// Distance from a bound within which a parameter is at the bound.
const EDGE: f64 = 1e-6;

/// So many exposures to nearly the same pull (N), with their mean duration (s).
#[derive(Clone, Copy, Debug)]
struct Group {
    pull: f64,
    duration: f64,
    n: f64,
}

/// Number of groups: the law hardly changes between the pulls of one.
const N_GROUPS: usize = 200;

fn groups(exposures: &[Exposure]) -> Vec<Group> {
    let mut sorted = exposures.to_vec();
    sorted.sort_by(|a, b| a.mean_pull().total_cmp(&b.mean_pull()));
    let group = |own: &[Exposure]| {
        let n = own.len() as f64;
        let mean = |of: fn(&Exposure) -> f64| own.iter().map(of).sum::<f64>() / n;
        Group { pull: mean(Exposure::mean_pull), duration: mean(|exposure| exposure.duration), n }
    };
    sorted.chunks(exposures.len().div_ceil(N_GROUPS)).map(group).collect()
}

/// Negative logarithm of the likelihood.
struct Likelihood<'a> {
    exposures: &'a [Exposure],
    /// Units of pull (N) and time (s).
    pull: f64,
    time: f64,
    /// The given ln D_r.
    period: Option<f64>,
    /// Confidence level of intervals.
    level: f64,
    /// The exposures in groups, for means over data.
    groups: &'a [Group],
}

impl Likelihood<'_> {
    /// Twice the expected number of releases for D_r = 1 from the pull at one end, and its
    /// derivatives by ln zeta and F_m.
    fn end(&self, point: &Vec3, pull: f64) -> [f64; 3] {
        let steepness = point[0].exp();
        let z = steepness * (pull / self.pull - 0.5 * point[1]);
        let small = (-z.abs()).exp();
        let logistic = if z > 0.0 { 1.0 / (1.0 + small) } else { small / (1.0 + small) };
        [z.max(0.0) + small.ln_1p(), logistic * z, -0.5 * steepness * logistic]
    }

    /// Distance of the law at a point from the nearest edge of the parameter `index`, in standard
    /// deviations: the root of twice the mean rise of the cost to the best law at that edge, over
    /// data of the law at the point. As pulls, those that occurred are taken.
    fn distance(&self, point: &Vec3, index: usize) -> f64 {
        let mean = MeanLikelihood { of: self, truth: *point };
        let here = mean.at(point, &()).0.cost;
        let rise = |(fixed, start): (usize, Vec3)| {
            minimum(&mean, Minimum::start(&mean, &start, &()), std::array::from_fn(|i| i == fixed)).slope.cost - here
        };
        let least = self.edges(point, index).map(rise).into_iter().fold(f64::INFINITY, f64::min);
        (2.0 * least.max(0.0)).sqrt()
    }

    /// Both edges of a parameter: which parameter is at its bound there, and a law near by.
    ///
    /// F_m and the inverse of D_r end with the law that is exponential in the pull, D_r and zeta
    /// with the law that is zero up to F_m / 2 and linear above ([`Cost::is_far_out`]).
    fn edges(&self, point: &Vec3, index: usize) -> [(usize, Vec3); 2] {
        let bounds = self.bounds();
        let at = |index: usize, bound: f64| {
            let mut law = *point;
            law[index] = bound;
            (index, law)
        };
        let [low, high] = [0, 1].map(|side| at(index, bounds[index][side]));
        if self.period.is_some() {
            return [low, high];
        }
        let (_, mut exponential) = at(2, bounds[2][0]);
        exponential[1] += 2.0 * (point[2] - exponential[2]) / point[0].exp();
        exponential[1] = exponential[1].min(bounds[1][1]);
        let (_, mut linear) = at(0, bounds[0][1]);
        linear[2] += linear[0] - point[0];
        linear[2] = linear[2].min(bounds[2][1]);
        match index {
            0 => [low, (0, linear)],
            1 => [low, (2, exponential)],
            _ => [(2, exponential), (0, linear)],
        }
    }
}

impl Cost for Likelihood<'_> {
    type Hidden = ();

    fn at(&self, point: &Vec3, (): &()) -> (Slope, ()) {
        stop::point();
        let mut slope = Slope { cost: 0.0, gradient: Vec3::zeros(), curvature: Mat3::zeros() };
        let rate = (-point[2]).exp();
        let mut last = (f64::NAN, [0.0; 3]);
        for exposure in self.exposures {
            let [from, to] = exposure.pulls;
            let begin = if last.0 == from { last.1 } else { self.end(point, from) };
            let end = if to == from { begin } else { self.end(point, to) };
            last = (to, end);
            let half = 0.5 * rate * exposure.duration / self.time;
            let [expected, by_steepness, by_pull] = std::array::from_fn(|i| half * (begin[i] + end[i]));
            let expected: f64 = f64::max(expected, f64::MIN_POSITIVE);
            let by = Vec3::new(by_steepness, by_pull, -expected);
            let odds = expected.exp_m1();
            let (cost, factor) = if exposure.is_release { (-(-(-expected).exp_m1()).ln(), -1.0 / odds) } else { (expected, 1.0) };
            slope.cost += cost;
            slope.gradient += factor * by;
            // Fisher's information of a release with this probability.
            slope.curvature += by * by.transpose() / odds;
        }
        (slope, ())
    }

    fn bounds(&self) -> [[f64; 2]; 3] {
        [[-7.0, 7.0], [0.0, 100.0], self.period.map_or([-10.0, 10.0], |period| [period; 2])]
    }

    /// Where zeta F_m / 2 is large, the rate is exponential in the pull at all pulls that occur: it
    /// is exp(zeta F) times a factor that F_m and D_r share. Where zeta is large, the rate is zero
    /// below F_m / 2 and linear above, with a slope that zeta and D_r share.
    fn is_far_out(&self, point: &Vec3, index: usize) -> bool {
        let [steepness, _, period] = self.bounds();
        self.period.is_none()
            && match index {
                0 => point[2] >= period[1] - EDGE,
                1 => point[2] <= period[0] + EDGE,
                _ => point[0] >= steepness[1] - EDGE,
            }
    }

    fn allowed_share(&self, point: &Vec3, index: usize) -> f64 {
        let distance = self.distance(point, index);
        threshold(self.level, distance) / threshold(self.level, f64::INFINITY)
    }
}

/// Mean of the negative logarithm of the likelihood over data of the law at `truth`.
struct MeanLikelihood<'a> {
    of: &'a Likelihood<'a>,
    truth: Vec3,
}

impl Cost for MeanLikelihood<'_> {
    type Hidden = ();

    fn at(&self, point: &Vec3, (): &()) -> (Slope, ()) {
        let mut slope = Slope { cost: 0.0, gradient: Vec3::zeros(), curvature: Mat3::zeros() };
        for Group { pull, duration, n } in self.of.groups {
            let expected = |law: &Vec3| {
                let [rate, by_steepness, by_pull] = self.of.end(law, *pull);
                let time = (-law[2]).exp() * duration / self.of.time;
                (f64::max(time * rate, f64::MIN_POSITIVE), Vec3::new(time * by_steepness, time * by_pull, -time * rate))
            };
            let (releases, (expected, by)) = (-(-expected(&self.truth).0).exp_m1(), expected(point));
            let odds = expected.exp_m1();
            slope.cost += *n * ((1.0 - releases) * expected - releases * (-(-expected).exp_m1()).ln());
            slope.gradient += *n * (1.0 - releases - releases / odds) * by;
            slope.curvature += *n * by * by.transpose() / odds;
        }
        (slope, ())
    }

    fn bounds(&self) -> [[f64; 2]; 3] {
        self.of.bounds()
    }
}

/// Fits the release law. A `period` (s) that is given is not fitted. `None` without a release, or
/// without a pull.
pub fn fit(exposures: &[Exposure], period: Option<f64>, level: f64) -> Option<HoldFit> {
    let n_releases = exposures.iter().filter(|exposure| exposure.is_release).count();
    let total: f64 = exposures.iter().map(|exposure| exposure.duration).sum();
    let square = |exposure: &Exposure| exposure.duration * exposure.pulls[1] * exposure.pulls[1];
    let pull = (exposures.iter().map(square).sum::<f64>() / total).sqrt();
    if n_releases == 0 || !(pull > 0.0 && pull.is_finite()) {
        return None;
    }
    let time = total / n_releases as f64;
    let (groups, given) = (groups(exposures), period.map(|period| (period / time).ln()));
    let cost = Likelihood { exposures, pull, time, period: given, level, groups: &groups };
    let mut best = minimum(&cost, start(&cost), [false; 3]);
    let rise = 0.5 * threshold(level, f64::INFINITY);
    let mut found = [Parameter::default(); 3];
    for _ in 0..N_PASSES {
        let before = best.slope.cost;
        found = std::array::from_fn(|i| match period.filter(|_| i == 2) {
            Some(period) => Parameter::given(period),
            None => parameter(&cost, &mut best, i, rise),
        });
        if best.slope.cost > before - 1e-3 * rise {
            break;
        }
        best = minimum(&cost, best, [false; 3]);
    }
    let law = ReleaseLaw { strong_pull: pull * best.point[1], steepness: best.point[0].exp() / pull, period: time * best.point[2].exp() };
    let bins = bins(exposures, &law);
    let free = bins.len() as f64 - if period.is_some() { 2.0 } else { 3.0 };
    let chi_squared = (free > 0.0).then(|| bins.iter().map(|bin| (bin.n_releases as f64 - bin.n_expected).powi(2) / bin.n_expected).sum());
    Some(HoldFit {
        steepness_per_n: found[0].map(|value| value.exp() / pull),
        strong_pull_n: found[1].map(|value| pull * value),
        decision_period_s: if period.is_some() { found[2] } else { found[2].map(|value| time * value.exp()) },
        law,
        log_likelihood: -best.slope.cost,
        p_value: chi_squared.and_then(|chi: f64| Some(ChiSquared::new(free).ok()?.sf(chi))),
        chi_squared,
        bins,
    })
}

/// The best of several starts. For a steepness and F_m, the period follows from the number of
/// releases unless it is given.
fn start(cost: &Likelihood) -> Minimum<()> {
    let n_releases = cost.exposures.iter().filter(|exposure| exposure.is_release).count() as f64;
    let start = |steepness: f64, strong: f64| {
        let mut point = Vec3::new(steepness.ln(), strong, 0.0);
        let mean = |exposure: &Exposure| 0.5 * exposure.duration * exposure.pulls.map(|pull| cost.end(&point, pull)[0]).iter().sum::<f64>();
        let expected = cost.exposures.iter().map(mean).sum::<f64>() / cost.time;
        let [low, high] = cost.bounds()[2];
        point[2] = (expected / n_releases).ln().clamp(low, high);
        Minimum::start(cost, &point, &())
    };
    let mut best = start(1.0, 2.0);
    for (steepness, strong) in [0.3, 1.0, 3.0, 10.0].into_iter().flat_map(|steepness| [0.5, 2.0, 4.0].map(|strong| (steepness, strong))) {
        let found = start(steepness, strong);
        if found.slope.cost < best.slope.cost {
            best = found;
        }
    }
    best
}

/// Largest number of bins, and least number of releases expected in each.
const N_BINS: usize = 10;
const LEAST_EXPECTED: f64 = 5.0;

/// Bins of the mean pull with about the same expected number of releases.
fn bins(exposures: &[Exposure], law: &ReleaseLaw) -> Vec<Bin> {
    let expected = |exposure: &Exposure| {
        let [from, to] = exposure.pulls.map(|pull| law.hazard(pull));
        -(-0.5 * exposure.duration * (from + to)).exp_m1()
    };
    let mut sorted: Vec<&Exposure> = exposures.iter().collect();
    sorted.sort_by(|a, b| a.mean_pull().total_cmp(&b.mean_pull()));
    let total: f64 = sorted.iter().map(|exposure| expected(exposure)).sum();
    let n = ((total / LEAST_EXPECTED) as usize).clamp(1, N_BINS);
    let (mut found, mut reached): (Vec<Bin>, f64) = (Vec::new(), 0.0);
    for exposure in sorted {
        let (at, own) = (exposure.mean_pull(), expected(exposure));
        // Equal pulls stay in one bin.
        let is_full = reached >= total * found.len() as f64 / n as f64;
        if is_full && found.len() < n && found.last().is_none_or(|bin| bin.pull_high_n < at) {
            found.push(Bin { pull_low_n: at, pull_high_n: at, mean_pull_n: 0.0, duration_s: 0.0, n_releases: 0, n_expected: 0.0 });
        }
        let bin = found.last_mut().expect("the first pull begins a bin");
        bin.pull_high_n = at;
        bin.mean_pull_n += at * exposure.duration;
        bin.duration_s += exposure.duration;
        bin.n_releases += usize::from(exposure.is_release);
        bin.n_expected += own;
        reached += own;
    }
    found.iter_mut().for_each(|bin| bin.mean_pull_n /= bin.duration_s);
    found
}
