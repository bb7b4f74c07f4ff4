//! What the paper says in words, as statistics with limits.
//!
//! A claim has power if a model that contradicts it fails it. Three such models are kept in mind:
//!
//! ```text
//! proportional   the speed of the load is proportional to the number of ants
//! no phases      a run has the same statistics from its team's gathering to the nest's neighbourhood
//! short runs     one run in twenty, or fewer, lasts as long as the printed one
//! ```
//!
//! Each limit is the value that one of these models has, or lies beyond it. A claim holds where the
//! whole 95 % interval is on the other side, which the model achieves in 2.5 % of studies.

use serde::Serialize;

use super::measures::{Measure, PhaseSign};
use super::trial::Trial;
use super::units::{Estimate, Unit};

/// Something that the paper says in words, as a statistic on one side of a limit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    pub claim: &'static str,
    /// Where the paper says it, and of what.
    pub source: &'static str,
    pub statistic: String,
    pub below: bool,
    pub limit: f64,
    /// Model that the claim contradicts.
    pub contradicts: Null,
    pub found: Option<Estimate>,
    /// Whether the whole interval is on the side of the claim: `null` when the limit lies in it.
    pub holds: Option<bool>,
}

impl Claim {
    /// Side of the limit on which the claim holds.
    pub fn side(&self) -> &'static str {
        if self.below { "below" } else { "above" }
    }
}

/// Model that a claim contradicts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Null {
    /// The speed of the load is proportional to the number of ants.
    Proportional,
    /// A run has the same statistics from its team's gathering to the nest's neighbourhood.
    NoPhases,
    /// At most one run in twenty lasts as long as the printed one.
    ShortRuns,
}

impl Null {
    pub fn name(self) -> &'static str {
        match self {
            Null::Proportional => "proportional speed",
            Null::NoPhases => "no phases",
            Null::ShortRuns => "short runs",
        }
    }
}

const EXPERIMENT: &str = "IV-C.3, experiment";
const SIMULATION: &str = "VII, simulation";
/// Most runs that may last longer than the printed one, which is then one of twenty (1).
const ONE_OF_TWENTY: f64 = 0.05;

/// Tests of a change of mean are significant in a twentieth of runs without one, half of them in
/// the printed direction: a series and its reverse are equally likely.
const ONE_DIRECTION: f64 = 0.025;

/// The claims on these units.
pub fn claims(units: &[Unit]) -> Vec<Claim> {
    let judged = |claim, source, measure: Measure, below, limit: f64, contradicts| {
        // Not all seeds have all numbers of ants.
        let trials = measure.trials();
        let complete: Vec<Unit> = units.iter().filter(|unit| trials.iter().all(|trial| unit.of(*trial).is_some())).copied().collect();
        let found = measure.estimate(&complete);
        let holds = found.and_then(|found| {
            let interval = found.interval_95?;
            let (is_below, is_above) = (interval.high < limit, interval.low > limit);
            (is_below || is_above).then_some(is_below == below)
        });
        Claim { claim, source, statistic: measure.name(), below, limit, contradicts, found, holds }
    };
    let of_speed = |claim, source, measure, below, limit| judged(claim, source, measure, below, limit, Null::Proportional);
    let lasts = Measure::Lasts(Trial::FourFour);
    // A run without phases shows the change in the fraction `limit` of runs.
    let of_phase = |claim, sign, limit| judged(claim, SIMULATION, Measure::Phase(sign, Trial::FourFour), false, limit, Null::NoPhases);
    vec![
        of_speed("one ant hardly moves the load", EXPERIMENT, Measure::SpeedOfOne, true, 1.0 / 4.0),
        of_speed("three ants are needed", EXPERIMENT, Measure::TwoOverThree, true, 2.0 / 3.0),
        of_speed("each further ant adds less", SIMULATION, Measure::LateGain, true, 1.0),
        of_speed("the speed grows by less and less up to ten", SIMULATION, Measure::Curvature, true, 0.0),
        // No increase, up to a tenth. Speed may not have saturated at ten in the paper's
        // simulation.
        of_speed("no increase beyond five ants", EXPERIMENT, Measure::TenOverFive, false, 0.9),
        judged("a run of four ants changes at 83 s", SIMULATION, lasts, false, ONE_OF_TWENTY, Null::ShortRuns),
        of_phase("the load speed rises in one change", PhaseSign::SpeedRises, ONE_DIRECTION),
        of_phase("the turn rate rises in one change", PhaseSign::TurnRateRises, ONE_DIRECTION),
        of_phase("the sum of interaction forces falls in one change", PhaseSign::InteractionFalls, ONE_DIRECTION),
        of_phase("all three change at once", PhaseSign::AllAtOnce, 0.05),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::facts::{Changes, OfSize, RunFacts, Series, WINDOWS};
    use crate::paper::units::units;
    use cohaul::math::{RandomStreams, Stream};

    /// Mean load speed of so many ants (m/s), and steps of speed, turn rate and interaction at two
    /// thirds of a run, in standard deviations.
    struct Model {
        speed: fn(usize) -> f64,
        steps: [f64; 3],
    }

    /// Speed proportional to the number of ants, no phases, and four ants at the nest after 62 s.
    const NULLS: Model = Model { speed: |n| 1e-3 * n as f64, steps: [0.0; 3] };
    /// Speeds and phases as the paper describes them, and four ants at the nest after 93 s.
    const AS_PRINTED: Model = Model { speed: |n| 3e-3 * [0.0, 0.05, 0.18, 0.75, 0.9, 1.0][n.min(5)], steps: [2.0, 2.0, -2.0] };

    /// Runs of `n_seeds` seeds; each run scatters by 10 %.
    fn study(model: &Model, n_seeds: u64, study: u64) -> Vec<(Trial, u64, RunFacts)> {
        let trials = [Trial::OneOne, Trial::FourFour, Trial::OnTen(2), Trial::FIVE_TEN, Trial::TEN_TEN];
        let of_seed = |seed: u64| trials.into_iter().map(move |trial| (trial, seed, run(model, trial, 1000 * study + seed)));
        (0..n_seeds).flat_map(of_seed).collect()
    }

    fn run(model: &Model, trial: Trial, seed: u64) -> RunFacts {
        let streams = RandomStreams::new(seed);
        let noise = |draw: u64| (0.1 * streams.normal_pair(Stream::Scene, trial.n_ants() as u32, draw).x).exp();
        let of_size = |size: usize| {
            let time_s = (1.0 + size as f64) * noise(10 + size as u64);
            OfSize { time_s, way_m: (model.speed)(size) * time_s * noise(30 + size as u64) }
        };
        let by_size: Vec<OfSize> = (0..=trial.n_ants()).map(of_size).collect();
        let time_s = 0.25 / ((model.speed)(trial.n_ants()) * noise(1));
        let series = series(&streams, model.steps, if trial == Trial::FourFour { 160 } else { 0 });
        RunFacts {
            time_s,
            displacement_m: 0.25,
            by_window: WINDOWS.map(|_| by_size.clone()),
            changes: Changes::of(&series, seed),
            ..RunFacts::nothing()
        }
    }

    /// Series that drift slowly and together.
    fn series(streams: &RandomStreams, steps: [f64; 3], n: usize) -> Series {
        let mut level = [0.0; 3];
        let mut found = Series::default();
        for i in 0..n {
            let shared = streams.normal_pair(Stream::Resample, 9, i as u64).x;
            for (k, level) in level.iter_mut().enumerate() {
                *level = 0.5 * *level + 0.5 * shared + 0.7 * streams.normal_pair(Stream::Resample, k as u32, i as u64).x;
            }
            let value = |k: usize| 10.0 + level[k] + if i < 2 * n / 3 { 0.0 } else { steps[k] };
            found.speed.push(value(0));
            found.turn_rate.push(value(1));
            found.interaction.push(value(2));
        }
        found
    }

    /// In how many of 40 studies each claim holds.
    fn n_holding(model: &Model, n_seeds: u64) -> Vec<(Claim, u32)> {
        let mut found: Vec<(Claim, u32)> = Vec::new();
        for at in 0..40 {
            let runs = study(model, n_seeds, at);
            let judged = claims(&units(&runs));
            if found.is_empty() {
                found = judged.iter().map(|claim| (claim.clone(), 0)).collect();
            }
            found.iter_mut().zip(&judged).for_each(|((_, n), claim)| *n += u32::from(claim.holds == Some(true)));
        }
        found
    }

    /// With speeds proportional to the number of ants, without phases and with short runs, every
    /// claim fails, but
    /// for the 2.5 % of an interval: 1 of 40 studies, of which 5 are allowed (0.3 % of chance).
    #[test]
    fn the_null_models_fail_every_claim() {
        for n_seeds in [12, 40] {
            for (claim, n) in n_holding(&NULLS, n_seeds) {
                assert!(claim.found.is_some() && n <= 5, "{} holds in {n} of 40 studies of {n_seeds} seeds", claim.claim);
            }
        }
    }

    /// And each claim holds where things are as printed, so that it does not fail everything.
    #[test]
    fn a_model_as_printed_passes_every_claim() {
        for (claim, n) in n_holding(&AS_PRINTED, 40) {
            assert!(n >= 36, "{} holds in {n} of 40 studies: {:?}", claim.claim, claim.found);
        }
    }
}
