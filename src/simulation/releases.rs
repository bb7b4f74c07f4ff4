//! Which ants let go of their springs (Eq. 18).
//!
//! An ant draws at every tick, and mostly lies far above any probability of letting go. Draws are functions of the tick, so some of them are looked at together, ahead
//! of time: before the next one that is low, a pull that is not uncommonly strong ends no hold, and neither it nor its probability is looked at any closer.

use super::periods::Periods;
use crate::math::{RandomStreams, Stream, Summary, Vec2};
use crate::model::behaviour::{ReleaseLaw, ReleasePace, probability_within};
use crate::scenario::AntDrive;

/// Decisions to let go of all ants of a run.
pub struct Releases {
    law: ReleaseLaw,
    pace: ReleasePace,
    streams: RandomStreams,
    /// (s)
    control_period: f64,
    /// Between decisions, at which pulls are looked at.
    decisions: Periods,
    /// Square of a pull that few are beyond (N^2), and what no draw that ends a hold by such a one or less exceeds.
    strong_squared: f64,
    low: f64,
    ants: Vec<Ahead>,
}

/// What is known of an ant ahead of time.
#[derive(Clone, Copy, Debug)]
struct Ahead {
    /// The first tick at which it may decide.
    decision: u64,
    /// Ticks whose draws were looked at, and which of them are low: a bit each.
    from: u64,
    to: u64,
    low: u32,
}

/// So many draws are looked at together, and so many of them are worked out side by side: as many of their words as a register has room for products of.
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
            // By far more than what roundings of a square can make of it.
            strong_squared: (strong * (1.0 - 1e-12)).powi(2),
            low: law.most_hazard(strong) * control_period,
            ants: vec![UNKNOWN; drive.n_ants],
        }
    }

    /// Forgets what was looked at, for ants that go on from elsewhere.
    pub fn forget(&mut self) {
        self.ants.fill(UNKNOWN);
    }

    /// An ant has grasped a spring at a tick.
    pub fn begin(&mut self, ant: usize, tick: u64) {
        self.ants[ant].decision = tick.saturating_add(self.decisions.quiet_after(0));
    }

    /// Whether an ant that has held its spring for `age` ticks lets go at a tick under a `pull` (N), which at a decision is added to `pulls`.
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

    /// Whether a draw lies below the probability of letting go within a tick. That is at most the hazard times the time, which takes no exponential.
    fn ends(&self, drawn: f64, pull: f64) -> bool {
        drawn <= self.law.most_hazard(pull) * self.control_period && drawn < probability_within(self.law.hazard(pull), self.control_period)
    }

    fn draw(&self, ant: usize, tick: u64) -> f64 {
        self.streams.uniform(Stream::Release, ant as u32, tick)
    }

    /// Whether the draw at a tick is low.
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

    /// Draws looked at ahead end the same holds as those looked at one by one: under common pulls and strong ones, for the default preset and the one with a wall at
    /// 10 mN, for ticks as short as those of the scene and so long that most draws are low.
    #[test]
    fn draws_looked_at_ahead_end_what_they_end_one_by_one() {
        for preset in ["default", "literal-millinewtons", "literal-newtons", "aged"] {
            let text = include_str!("../../scenarios/paper/four-ants-four-springs.json")
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
                        // Holds begin and end, and nobody asks meanwhile.
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
