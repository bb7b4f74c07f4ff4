//! CPU time and real time, least and median.

use std::time::Instant;

use cpu_time::ThreadTime;
use serde::Serialize;

use crate::methods::Method;

/// A median this far above the least time says that the machine was busy with something else (1).
pub const MOST_SPREAD: f64 = 1.25;
/// Share of such times from which on no conclusion should be drawn (1).
pub const NOISY_SHARE: f64 = 0.1;
/// Shorter work is repeated until it has taken so long (s): clocks and calls have costs of their
/// own.
const LEAST: f64 = 2e-3;

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Timing {
    pub min_s: f64,
    pub median_s: f64,
    /// Median over least (1).
    pub spread: f64,
    pub n_runs: usize,
}

impl Timing {
    /// `None` of no times.
    pub fn of(seconds: &[f64]) -> Option<Self> {
        let mut sorted = seconds.to_vec();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        let min_s = *sorted.first()?;
        let median_s = 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
        let spread = if min_s > 0.0 { median_s / min_s } else { 1.0 };
        Some(Self { min_s, median_s, spread, n_runs: n })
    }
}

/// Whether too many of these times have a median too far above the least to conclude anything from
/// their ratios.
pub fn is_noisy(timings: &[Timing]) -> bool {
    let n_spread = timings.iter().filter(|timing| timing.spread > MOST_SPREAD).count();
    n_spread as f64 > NOISY_SHARE * timings.len() as f64
}

/// A clock that runs while this thread does, or all the time.
pub enum Clock {
    Thread(ThreadTime),
    Real(Instant),
}

impl Clock {
    pub fn start() -> Self {
        Clock::Thread(ThreadTime::now())
    }

    /// A clock for a method: CPU time says nothing of an engine that computes elsewhere.
    pub fn of(method: &Method) -> Self {
        if method.is_of_user { Clock::Real(Instant::now()) } else { Clock::start() }
    }

    /// Time since the start (s).
    pub fn seconds(&self) -> f64 {
        match self {
            Clock::Thread(start) => start.elapsed().as_secs_f64(),
            Clock::Real(start) => start.elapsed().as_secs_f64(),
        }
    }
}

/// CPU time of `work` (s), repeated while it is too short to time.
pub fn time_of(mut work: impl FnMut()) -> f64 {
    let (clock, mut n) = (Clock::start(), 0u32);
    loop {
        work();
        n += 1;
        let seconds = clock.seconds();
        if seconds >= LEAST {
            return seconds / f64::from(n);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timing(seconds: &[f64]) -> Timing {
        Timing::of(seconds).unwrap()
    }

    #[test]
    fn a_timing_has_the_least_and_the_middle_time() {
        assert_eq!(Timing::of(&[]), None);
        let odd = timing(&[3.0, 1.0, 2.0]);
        assert_eq!((odd.min_s, odd.median_s, odd.spread, odd.n_runs), (1.0, 2.0, 2.0, 3));
        assert_eq!(timing(&[4.0, 1.0, 2.0, 3.0]).median_s, 2.5);
    }

    #[test]
    fn a_machine_is_noisy_when_more_than_a_tenth_of_its_times_spread() {
        let (calm, busy) = (timing(&[1.0, 1.0, 1.25]), timing(&[1.0, 1.26, 1.3]));
        assert!(!is_noisy(&[]) && !is_noisy(&[calm; 5]) && is_noisy(&[busy]));
        let with_busy = |n: usize| [vec![calm; 10 - n], vec![busy; n]].concat();
        assert!(!is_noisy(&with_busy(1)) && is_noisy(&with_busy(2)));
    }

    #[test]
    fn short_work_is_repeated() {
        let mut n = 0;
        let seconds = time_of(|| n += 1);
        assert!(n > 1 && seconds < LEAST);
    }
}
