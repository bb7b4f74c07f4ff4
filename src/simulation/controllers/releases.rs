//! Which ants let go of their springs, Eq. (18).
//!
//! An ant draws a number at every tick, and nearly every draw is far above the probability of a
//! release. A draw is a function of the tick, so that several are computed together, ahead of time.
//! Until the next low draw, only a rarely exceeded pull can cause a release; for all other pulls
//! the probability is not computed.

use super::periods::Periods;
use crate::math::{RandomStreams, Stream, Summary, Vec2};
use crate::model::behaviour::{ReleaseLaw, ReleasePace, probability_within};
use crate::scenario::AntDrive;

/// Release decisions of all ants of a run.
pub struct Releases {
    law: ReleaseLaw,
    pace: ReleasePace,
    streams: RandomStreams,
    /// Control period (s).
    control_period: f64,
    /// Periods between decisions. The pull at a decision is a sample of the run's pulls.
    decisions: Periods,
    /// Square of a pull that is rarely exceeded (N^2).
    strong_squared: f64,
    /// Largest draw that can still cause a release at or below that pull (1).
    low: f64,
    ants: Vec<Ahead>,
}

/// What is known ahead of time about one ant.
#[derive(Clone, Copy, Debug)]
struct Ahead {
    /// First tick at which it may decide.
    decision: u64,
    /// First tick whose draw is known, and the first whose draw is not.
    from: u64,
    to: u64,
    /// One bit for each known draw, set when the draw is low.
    low: u32,
}

/// Number of draws that are computed ahead of time, and number that are computed side by side. A
/// register has room for the products of two.
const N_AHEAD: u64 = 16;
const N_BESIDE: usize = 2;

const UNKNOWN: Ahead = Ahead { decision: 0, from: 0, to: 0, low: 0 };

impl Releases {
    pub fn new(drive: &AntDrive, streams: RandomStreams, control_period: f64) -> Self {
        let (law, pace) = (drive.release, drive.release_pace);
        // A unit of the logistic curve beyond even odds.
        let strong = 0.5 * law.strong_pull + 1.0 / law.steepness;
        Self {
            law,
            pace,
            streams,
            control_period,
            decisions: Periods::new(control_period, if pace == ReleasePace::PerTick { control_period } else { law.period }),
            // The margin is far larger than the rounding of a square.
            strong_squared: (strong * (1.0 - 1e-12)).powi(2),
            low: law.most_hazard(strong) * control_period,
            ants: vec![UNKNOWN; drive.n_ants],
        }
    }

    /// Forgets all draws, for ants whose state was restored.
    pub fn forget(&mut self) {
        self.ants.fill(UNKNOWN);
    }

    /// Notes that an ant grasped a spring at a tick.
    pub fn begin(&mut self, ant: usize, tick: u64) {
        self.ants[ant].decision = tick.saturating_add(self.decisions.quiet_after(0));
    }

    /// Whether an ant lets go at a tick under a `pull` (N), `age` ticks after its grasp. The pull
    /// at a decision is added to `pulls`.
    #[inline]
    pub fn lets_go(&mut self, ant: usize, tick: u64, age: u64, pull: impl FnOnce() -> Vec2, pulls: &mut Summary) -> bool {
        let is_decision = tick >= self.ants[ant].decision && age > 0 && {
            self.ants[ant].decision = tick.saturating_add(self.decisions.quiet_after(age));
            self.decisions.ends_with(age)
        };
        if age == 0 || self.pace == ReleasePace::Aged && !is_decision {
            return false;
        }
        let pull = pull();
        if is_decision {
            pulls.add(pull.norm());
        }
        match self.pace {
            ReleasePace::Aged | ReleasePace::PerTick => self.draw(ant, tick) < self.law.probability(pull.norm()),
            ReleasePace::Hazard => {
                let is_common = pull.norm_squared() <= self.strong_squared;
                (!is_common || self.is_low(ant, tick)) && self.ends(self.draw(ant, tick), pull.norm())
            }
        }
    }

    /// Whether a draw is below the probability of a release within a tick. The hazard times the
    /// time is an upper bound of the probability that needs no exponential.
    fn ends(&self, drawn: f64, pull: f64) -> bool {
        drawn <= self.law.most_hazard(pull) * self.control_period && drawn < probability_within(self.law.hazard(pull), self.control_period)
    }

    fn draw(&self, ant: usize, tick: u64) -> f64 {
        self.streams.uniform(Stream::Release, ant as u32, tick)
    }

    /// Whether the draw at a tick is low enough for a release under a pull that is not strong.
    fn is_low(&mut self, ant: usize, tick: u64) -> bool {
        let Self { streams, ants, low, .. } = self;
        let ahead = &mut ants[ant];
        if !(ahead.from..ahead.to).contains(&tick) {
            *ahead = Ahead { from: tick, to: tick.saturating_add(N_AHEAD), low: 0, ..*ahead };
            for begin in (0..N_AHEAD).step_by(N_BESIDE) {
                let draws: [f64; N_BESIDE] = streams.uniforms(Stream::Release, ant as u32, tick.wrapping_add(begin));
                draws.iter().zip(begin..).for_each(|(drawn, k)| ahead.low |= u32::from(*drawn <= *low) << k);
            }
        }
        ahead.low >> (tick - ahead.from) & 1 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Drive, Scenario};

    /// Draws that are computed ahead cause the same releases as draws computed one by one: under
    /// common and strong pulls, for the default preset and the one with a threshold at 10 mN, and
    /// for ticks so long that most draws are low.
    #[test]
    fn draws_computed_ahead_cause_the_same_releases() {
        for preset in ["paper", "fitted", "literal-millinewtons", "literal-newtons", "aged"] {
            let text = include_str!("../../../scenarios/paper/four-ants-four-springs.json")
                .replace("\"n_ants\": 4", &format!("\"n_ants\": 4, \"preset\": \"{preset}\", \"release_pace\": \"hazard\""));
            let Drive::Ants(drive) = Scenario::parse(&text, preset).unwrap().drive else { panic!("ants drive this scene") };
            for control_period in [0.0025, 0.2] {
                let (streams, mut pulls) = (RandomStreams::new(3), Summary::default());
                let mut releases = Releases::new(&drive, streams, control_period);
                let (mut n_ends, mut n_strong) = (0, 0);
                for tick in 1..20_000 {
                    for ant in 0..drive.n_ants {
                        let pull = 0.012 * (1.0 + (0.01 * (tick * (ant as u64 + 1)) as f64).sin());
                        let drawn = streams.uniform(Stream::Release, ant as u32, tick);
                        let ends = drawn < probability_within(drive.release.hazard(pull), control_period);
                        // The ant is not attached for a while.
                        if tick / 500 % 5 == ant as u64 {
                            continue;
                        }
                        assert_eq!(
                            releases.lets_go(ant, tick, 1, || Vec2::new(0.6 * pull, -0.8 * pull), &mut pulls),
                            ends,
                            "{preset} {control_period} {tick} {ant}"
                        );
                        (n_ends, n_strong) = (n_ends + u32::from(ends), n_strong + u32::from(pull * pull > releases.strong_squared));
                    }
                }
                assert!(n_ends > 100 && n_strong > 1000, "{preset} {control_period}: {n_ends} {n_strong}");
            }
        }
    }
}
