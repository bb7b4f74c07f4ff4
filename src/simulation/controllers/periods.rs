//! Periods of time that need not be multiples of a tick.

/// Ticks at which a period of time ends. Ticks are counted from the start of the first period.
#[derive(Clone, Copy, Debug)]
pub struct Periods {
    /// Length of a tick (s).
    tick: f64,
    /// Length of a period (s).
    period: f64,
}

/// A period has passed when at most this share of it is left (1).
const NEARLY: f64 = 1e-9;

impl Periods {
    pub fn new(tick: f64, period: f64) -> Self {
        Self { tick, period }
    }

    /// Number of periods that have passed after `ticks`.
    pub fn passed(&self, ticks: u64) -> f64 {
        (ticks as f64 * self.tick / self.period + NEARLY).floor()
    }

    /// Whether a period ends with the tick of this number, which is above zero.
    pub fn ends_with(&self, ticks: u64) -> bool {
        self.passed(ticks) > self.passed(ticks - 1)
    }

    /// Number of ticks after `ticks` in which no period can end, at least one.
    pub fn quiet_after(&self, ticks: u64) -> u64 {
        // The margin is larger than rounding.
        let next = (self.passed(ticks) + 1.0 - NEARLY) * (self.period / self.tick) * (1.0 - 1e-12);
        (next.ceil() as u64).saturating_sub(ticks).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No period ends in a tick that is passed over, and at most one other tick is tested in vain.
    #[test]
    fn no_period_ends_in_quiet_ticks() {
        for (tick, period) in [(0.0025, 0.25), (0.0025, 0.0025), (0.1, 0.25), (0.003, 0.1), (0.01, 0.003), (1.0 / 3.0, 7.0), (0.0025, 1e30)]
        {
            let periods = Periods::new(tick, period);
            let (mut next, mut n_looks, mut n_found) = (periods.quiet_after(0), 0u64, 0u64);
            for age in 1..20_000 {
                let ends = periods.ends_with(age);
                assert!(!ends || age >= next, "{tick} {period} {age}");
                if age >= next {
                    next = age.saturating_add(periods.quiet_after(age));
                    (n_looks, n_found) = (n_looks + 1, n_found + u64::from(ends));
                }
            }
            assert!(n_looks <= n_found + 1, "{tick} {period}: {n_looks} looks for {n_found}");
        }
    }
}
