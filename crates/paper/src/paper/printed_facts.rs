//! Everything that the paper prints about its simulation, as one list: numbers, and claims with
//! their limits. Parameter sets and readings of the paper are compared by it.

use serde::Serialize;

use super::claims::{Claim, Null, claims};
use super::measures::Measure;
use super::sampling::Sampling;
use super::units::Unit;
use super::{largest, trial::Trial};
use cohaul::model::paper as printed;
use cohaul_report::quantity::{number, quantity};

/// A printed number or claim beside a value of runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fact {
    pub fact: String,
    pub unit: &'static str,
    /// The printed number, or the limit of the claim.
    pub paper: String,
    pub value: Option<f64>,
    /// Whether the value is near the printed number (10 %, or 0.05 of a share), or on the side of
    /// the claim.
    pub is_met: bool,
    /// Whether sets are ranked by it: a change of phase needs many runs.
    pub is_ranked: bool,
}

/// Relative deviation of pulls that counts as near (1).
pub const NEAR_PULL: f64 = 0.1;
/// Deviation of a fraction that counts as near (1).
pub const NEAR_SHARE: f64 = 0.05;

/// The list with the values `of` measures, the largest pull of a sample of the printed size (N),
/// and the statistics of all claims in their order.
pub fn printed_facts(of: &dyn Fn(Measure) -> Option<f64>, largest_pull: Option<f64>, of_claims: &[Option<f64>]) -> Vec<Fact> {
    let pull = |name: String, printed: f64, value: Option<f64>| {
        let is_met = value.is_some_and(|value| (value / printed - 1.0).abs() <= NEAR_PULL);
        Fact { fact: name, unit: "N", paper: quantity(printed, "N"), value, is_met, is_ranked: true }
    };
    let share = |size: usize| {
        let (measure, printed) = (Measure::SizeShare(size), printed::share_of_size(size));
        let value = of(measure);
        let is_met = value.is_some_and(|value| (value - printed).abs() <= NEAR_SHARE);
        Fact { fact: measure.name(), unit: "", paper: number(printed), value, is_met, is_ranked: true }
    };
    let claim = |(claim, value): (Claim, &Option<f64>)| {
        let is_met = value.is_some_and(|value| (value < claim.limit) == claim.below);
        let paper = format!("{}: {} {}", claim.statistic, claim.side(), number(claim.limit));
        let is_ranked = claim.contradicts != Null::NoPhases;
        Fact { fact: claim.claim.to_owned(), unit: "", paper, value: *value, is_met, is_ranked }
    };
    let pulls = [
        pull(Measure::PULL_MEAN.name(), printed::PULL_MEAN_N, of(Measure::PULL_MEAN)),
        pull(Measure::PULL_SD.name(), printed::PULL_SD_N, of(Measure::PULL_SD)),
        pull(format!("pull, largest of {}", printed::N_PULLS), printed::PULL_MAX_N, largest_pull),
    ];
    let shares = (printed::SMALLEST_OF_TEN..=Trial::TEN_TEN.n_ants()).map(share);
    // Without runs, the claims have no values, but their names and limits.
    pulls.into_iter().chain(shares).chain(claims(&[]).into_iter().zip(of_claims).map(claim)).collect()
}

/// The list of some runs.
pub fn facts_of(units: &[Unit]) -> Vec<Fact> {
    let claims: Vec<Option<f64>> = claims(units).iter().map(|claim| claim.found.map(|found| found.value)).collect();
    printed_facts(&|measure| measure.of(units), largest(units, Sampling::AtDecisions).map(|found| found.expected), &claims)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every printed number and every claim stands once; a value beyond near or the limit is
    /// missed.
    #[test]
    fn facts_are_met_up_to_near_and_on_the_side_of_claims() {
        let at = |factor: f64, shift: f64, statistic: f64| {
            let of = move |measure: Measure| match measure {
                Measure::PULL_MEAN => Some(factor * printed::PULL_MEAN_N),
                Measure::PULL_SD => Some(factor * printed::PULL_SD_N),
                Measure::SizeShare(size) => Some(printed::share_of_size(size) + shift),
                _ => None,
            };
            printed_facts(&of, Some(factor * printed::PULL_MAX_N), &vec![Some(statistic); claims(&[]).len()])
        };
        let n_met = |facts: &[Fact]| facts[..8].iter().filter(|fact| fact.is_met).count();
        assert_eq!([n_met(&at(1.09, 0.049, 0.0)), n_met(&at(1.11, 0.049, 0.0)), n_met(&at(1.0, -0.051, 0.0))], [8, 5, 3]);
        let facts = at(1.0, 0.0, 0.24);
        assert_eq!(facts.len(), 8 + claims(&[]).len());
        let found = |name: &str| facts.iter().find(|fact| fact.fact == name).unwrap();
        assert!(found("one ant hardly moves the load").is_met && !found("no increase beyond five ants").is_met);
        assert_eq!(facts.iter().filter(|fact| !fact.is_ranked).count(), 4);
    }
}
