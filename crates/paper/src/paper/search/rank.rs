//! Accepted sets by how much of what is printed they meet.
//!
//! The targets alone do not tell accepted sets apart. The first set is the one that meets the most
//! printed facts: the calibration targets, the largest pull, and the claims, but for the phase
//! change, which a few runs do not tell. Of sets that meet as many, the first is the one that is
//! closest to the targets.

use serde::Serialize;

use super::accepted::Accepted;
use super::judge::reported;
use crate::paper::{Fact, Measure, printed_facts};

/// An accepted set with its printed facts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ranked {
    /// From one.
    pub rank: usize,
    pub set: usize,
    /// Number of ranked facts that it meets.
    pub n_met: usize,
    /// To the calibration targets (1).
    pub distance: f64,
    pub facts: Vec<Fact>,
}

/// All accepted sets, the best first.
pub(super) fn ranked(accepted: &[Accepted]) -> Vec<Ranked> {
    let reported = reported();
    let row = |row: &Accepted| {
        let value = |measure: Measure| {
            let at = reported.iter().position(|other| *other == measure)?;
            row.judged.measures[at].quasi_static.map(|found| found.value)
        };
        let claims: Vec<Option<f64>> = row.judged.claims.iter().map(|standings| standings[0].value).collect();
        let facts = printed_facts(&value, row.judged.largest_pull.map(|found| found.expected_n), &claims);
        let n_met = facts.iter().filter(|fact| fact.is_ranked && fact.is_met).count();
        Ranked { rank: 0, set: row.set, n_met, distance: row.judged.distance.unwrap_or(f64::INFINITY), facts }
    };
    let mut found: Vec<Ranked> = accepted.iter().map(row).collect();
    found.sort_by(|a, b| b.n_met.cmp(&a.n_met).then(a.distance.total_cmp(&b.distance)));
    found.iter_mut().zip(1..).for_each(|(row, rank)| row.rank = rank);
    found
}
