//! The sample counts of Fig. 9 as a mixture of the trials.
//!
//! The paper counts the samples in which 1 to 10 ants pulled over all its simulation trials,
//! without saying how many runs each trial has. Each trial has its own fractions of samples by
//! number of pulling ants; the weights of the trials are those of the largest likelihood of the
//! printed counts (expectation and maximization). Samples with one ant come mostly from the trial
//! of one ant, whose weight they fix; the fractions are therefore compared among samples with two
//! or more.

use serde::Serialize;

use super::by_size::sum_of_size;
use super::trial::Trial;
use super::units::{Unit, runs};
use cohaul::model::paper::SIMULATED_SAMPLES;

/// The printed counts explained by the trials.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mixture {
    /// Trials in the order of [`Trial::ALL`].
    pub trials: Vec<TrialShare>,
    /// Fraction of samples with 1 to 10 pulling ants in the mixture (1).
    pub shares: [f64; 10],
}

/// A trial in the mixture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrialShare {
    pub trial: Trial,
    /// Fraction of the printed samples (1).
    pub weight: f64,
    /// Number of runs that have as many samples at every control period (1).
    pub n_runs: f64,
}

/// Updates of the weights. The fractions of the trials differ so much that they settle within
/// thirty.
const N_UPDATES: usize = 60;

/// Mixture of the trials in `units`; `None` where one of them has no run.
pub fn mixture(units: &[Unit], control_period: f64) -> Option<Mixture> {
    // Time with 1 to 10 pulling ants in all runs of each trial (s).
    let sums = Trial::ALL.map(|trial| std::array::from_fn::<f64, 10, _>(|at| sum_of_size(units, trial, at + 1).time_s));
    let totals = sums.map(|sum| sum.iter().sum::<f64>());
    if totals.iter().any(|total| *total <= 0.0) {
        return None;
    }
    let fractions: Vec<[f64; 10]> = sums.iter().zip(&totals).map(|(sum, total)| sum.map(|time| time / total)).collect();
    let weights = weights(&fractions, &SIMULATED_SAMPLES.map(|n| n as f64));
    let n_printed: u64 = SIMULATED_SAMPLES.iter().sum();
    let share = |(at, trial): (usize, Trial)| {
        let n_runs = runs(units, trial).count() as f64;
        let samples_of_run = totals[at] / control_period / n_runs;
        TrialShare { trial, weight: weights[at], n_runs: weights[at] * n_printed as f64 / samples_of_run }
    };
    Some(Mixture {
        trials: Trial::ALL.into_iter().enumerate().map(share).collect(),
        shares: std::array::from_fn(|size| weights.iter().zip(&fractions).map(|(weight, fraction)| weight * fraction[size]).sum()),
    })
}

/// Weights of the `fractions` that make `counts` likeliest.
fn weights(fractions: &[[f64; 10]], counts: &[f64; 10]) -> Vec<f64> {
    let total: f64 = counts.iter().sum();
    let mut weights = vec![1.0 / fractions.len() as f64; fractions.len()];
    for _ in 0..N_UPDATES {
        let mixed: [f64; 10] = std::array::from_fn(|size| weights.iter().zip(fractions).map(|(weight, of)| weight * of[size]).sum());
        let share = |(weight, of): (&f64, &[f64; 10])| {
            let explained = (0..10).filter(|size| mixed[*size] > 0.0).map(|size| counts[size] / total * weight * of[size] / mixed[size]);
            explained.sum::<f64>()
        };
        weights = weights.iter().zip(fractions).map(share).collect();
        // Counts that no trial explains are lost.
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
    }
    weights
}

impl Mixture {
    /// Number of the printed samples that the mixture has with `size` pulling ants (1).
    pub fn n_samples(&self, size: usize) -> u64 {
        (self.shares[size - 1] * SIMULATED_SAMPLES.iter().sum::<u64>() as f64).round() as u64
    }

    /// Fraction of samples with `size` pulling ants among those with two or more (1).
    pub fn share_of_two_or_more(&self, size: usize) -> f64 {
        self.shares[size - 1] / self.shares[1..].iter().sum::<f64>()
    }

    /// Fraction of samples that the mixture has with other numbers of ants than printed (1): half
    /// of the sum of the differences, among samples with two or more.
    pub fn misplaced(&self) -> f64 {
        (2..=10).map(|size| (self.share_of_two_or_more(size) - printed_share(size)).abs()).sum::<f64>() / 2.0
    }
}

/// Printed fraction of samples with `size` pulling ants among those with two or more (1).
pub fn printed_share(size: usize) -> f64 {
    SIMULATED_SAMPLES[size - 1] as f64 / SIMULATED_SAMPLES[1..].iter().sum::<u64>() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts of a known mixture give its weights back.
    #[test]
    fn a_mixture_is_taken_apart() {
        let binomial = |n: usize, p: f64| -> [f64; 10] {
            let choose = |k: usize| (1..=k).map(|i| (n + 1 - i) as f64 / i as f64).product::<f64>();
            let of = |k: usize| if k <= n { choose(k) * p.powi(k as i32) * (1.0 - p).powi((n - k) as i32) } else { 0.0 };
            let none = of(0);
            std::array::from_fn(|k| of(k + 1) / (1.0 - none))
        };
        let fractions = [(1, 0.9), (4, 0.8), (5, 0.85), (10, 0.84)].map(|(n, p)| binomial(n, p));
        let known = [0.8, 0.06, 0.04, 0.1];
        let counts = std::array::from_fn(|size| 1e6 * known.iter().zip(&fractions).map(|(weight, of)| weight * of[size]).sum::<f64>());
        let found = weights(&fractions, &counts);
        // The trials of four and five ants differ least, and settle last.
        assert!(found.iter().zip(known).all(|(found, known)| (found - known).abs() < 2e-3), "{found:?}");
    }

    #[test]
    fn printed_fractions_add_up() {
        assert!(((2..=10).map(printed_share).sum::<f64>() - 1.0).abs() < 1e-15);
        // 50522 of 269270.
        assert!((printed_share(3) - 0.187_626).abs() < 1e-6);
    }
}
