//! What holds over the accepted sets: values of the searched choices, claims, printed quantities,
//! and the effect of inertia on one ant.

use serde::Serialize;

use super::Plan;
use super::judge::{Judged, Standing, reported};
use super::space::Searched;
use crate::paper::{Claim, Estimate, Measure, Trial, claims};
use cohaul::model::open_choices::{Chosen, Range};
use cohaul::model::paper as printed;

/// A searched choice, and where the accepted sets lie.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChoiceRow {
    pub choice: &'static str,
    pub key: &'static str,
    pub unit: &'static str,
    pub searched: String,
    /// Smallest, median and largest value of the accepted sets; `null` for words.
    pub accepted: Option<Spread>,
    /// Whether the accepted sets reach the last tenth of the range, at either end.
    pub reaches_an_end: bool,
    /// Number of accepted sets by word or number of a list.
    pub counts: Vec<(String, usize)>,
}

/// Smallest, median and largest of some values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    pub least: f64,
    pub median: f64,
    pub most: f64,
}

/// A claim over the accepted sets. Fractions are of those sets.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimRow {
    pub claim: &'static str,
    pub statistic: String,
    pub limit: f64,
    pub below: bool,
    /// Without and with inertia.
    pub on: [Shares; 2],
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shares {
    pub holds: f64,
    pub fails: f64,
    /// The seeds of the set do not tell.
    pub unknown: f64,
    /// Value of the claim's statistic.
    pub values: Option<Spread>,
    /// Sets whose value is on the side of the claim, certainly or not.
    pub on_its_side: f64,
}

/// A quantity over the accepted sets.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuantityRow {
    pub quantity: String,
    pub unit: &'static str,
    pub printed: Option<f64>,
    /// Whether sets were accepted by it. Other printed numbers are held out.
    pub is_target: bool,
    pub values: Option<Spread>,
    /// Fraction of the accepted sets that meet the printed number or are near.
    pub met: Option<f64>,
    /// Inertial minus quasi-static.
    pub inertia_effect: Option<Spread>,
    /// Fraction of the accepted sets in which that is certainly not zero, at 95 %.
    pub shifted_by_inertia: Option<f64>,
}

/// Effect of inertia on one ant's time to the nest on an accepted set.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OneAnt {
    pub set: usize,
    pub quasi_static_s: f64,
    pub inertia_effect: Estimate,
}

/// An accepted set.
pub(super) struct Accepted<'a> {
    pub set: usize,
    pub values: &'a [Chosen],
    pub judged: &'a Judged,
}

pub(super) fn spread(values: impl IntoIterator<Item = f64>) -> Option<Spread> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let (least, most) = (*values.first()?, *values.last()?);
    Some(Spread { least, median: values[values.len() / 2], most })
}

pub(super) fn choice_rows(plan: &Plan, accepted: &[Accepted]) -> Vec<ChoiceRow> {
    let row = |(at, choice): (usize, &Searched)| {
        let values: Vec<Chosen> = accepted.iter().map(|row| row.values[at]).collect();
        let is_list = !matches!(choice.range, Range::Between { .. });
        let all = spread(values.iter().filter(|_| !is_list).map(number));
        let end = |share: f64| choice.range.at(share).as_ref().map_or(f64::NAN, number);
        let reaches = |spread: Spread| spread.least < end(0.1) || spread.most > end(0.9);
        let count = |word: &String| values.iter().filter(|value| text(value) == *word).count();
        ChoiceRow {
            choice: choice.name,
            key: choice.key,
            unit: choice.unit,
            searched: searched_text(choice.range),
            accepted: all,
            reaches_an_end: all.is_some_and(reaches),
            counts: words(choice.range).iter().map(|word| (word.clone(), count(word))).collect(),
        }
    };
    plan.design().searched.iter().enumerate().map(row).collect()
}

/// The number of a value; NaN of a word.
pub(super) fn number(value: &Chosen) -> f64 {
    if let Chosen::Number(value) = value { *value } else { f64::NAN }
}

fn words(range: Range) -> Vec<String> {
    match range {
        Range::Numbers(all) => all.iter().map(f64::to_string).collect(),
        Range::Words(all) => all.iter().map(|word| (*word).to_owned()).collect(),
        Range::Between { .. } | Range::Fixed(_) => Vec::new(),
    }
}

fn text(value: &Chosen) -> String {
    match value {
        Chosen::Number(value) => value.to_string(),
        Chosen::Word(word) => (*word).to_owned(),
    }
}

fn searched_text(range: Range) -> String {
    match range {
        Range::Between { low, high, .. } => format!("{low} to {high}"),
        of_list => words(of_list).join(", "),
    }
}

pub(super) fn claim_rows(accepted: &[Accepted]) -> Vec<ClaimRow> {
    let n = accepted.len() as f64;
    let row = |(at, claim): (usize, Claim)| {
        let on = |with: usize| {
            let all = || accepted.iter().map(|row| row.judged.claims[at][with]);
            let share = |is: &dyn Fn(Standing) -> bool| all().filter(|standing| is(*standing)).count() as f64 / n;
            Shares {
                holds: share(&|standing| standing.holds == Some(true)),
                fails: share(&|standing| standing.holds == Some(false)),
                unknown: share(&|standing| standing.holds.is_none()),
                values: spread(all().filter_map(|standing| standing.value)),
                on_its_side: share(&|standing| standing.value.is_some_and(|value| (value < claim.limit) == claim.below)),
            }
        };
        ClaimRow { claim: claim.claim, limit: claim.limit, below: claim.below, on: [on(0), on(1)], statistic: claim.statistic }
    };
    // Without runs, the claims have no values, but their names and limits.
    let stated = if accepted.is_empty() { Vec::new() } else { claims(&[]) };
    stated.into_iter().enumerate().map(row).collect()
}

pub(super) fn quantity_rows(accepted: &[Accepted]) -> Vec<QuantityRow> {
    let n = accepted.len() as f64;
    let share = |hits: Vec<bool>| (!hits.is_empty()).then(|| hits.iter().filter(|hit| **hit).count() as f64 / n);
    let row = |(at, measure): (usize, Measure)| {
        let all = || accepted.iter().map(move |row| row.judged.measures[at]);
        let effects: Vec<Estimate> = all().filter_map(|found| found.minus).collect();
        let certain = effects.iter().filter(|effect| effect.interval_95.is_some()).map(Estimate::is_not_zero);
        QuantityRow {
            quantity: measure.name(),
            unit: measure.unit(),
            printed: measure.printed().map(|printed| printed.value),
            is_target: matches!(measure, Measure::PULL_MEAN | Measure::PULL_SD | Measure::SizeShare(_)),
            values: spread(all().filter_map(|found| Some(found.quasi_static?.value))),
            met: share(all().filter_map(|found| Some(found.grade?.is_met())).collect()),
            inertia_effect: spread(effects.iter().map(|effect| effect.value)),
            shifted_by_inertia: share(certain.collect()),
        }
    };
    let largest = accepted.iter().filter_map(|row| row.judged.largest_pull);
    let of_largest = QuantityRow {
        quantity: format!("pull, largest of {}", printed::N_PULLS),
        unit: "N",
        printed: Some(printed::PULL_MAX_N),
        is_target: false,
        values: spread(largest.clone().map(|found| found.expected_n)),
        met: share(largest.map(|found| found.grade.is_met()).collect()),
        inertia_effect: None,
        shifted_by_inertia: None,
    };
    [of_largest].into_iter().chain(reported().into_iter().enumerate().map(row)).collect()
}

pub(super) fn one_ant(accepted: &[Accepted]) -> Vec<OneAnt> {
    let at = reported().iter().position(|measure| *measure == Measure::TimeToNest(Trial::OneOne)).expect("a reported quantity");
    let row = |row: &Accepted| {
        let found = row.judged.measures[at];
        Some(OneAnt { set: row.set, quasi_static_s: found.quasi_static?.value, inertia_effect: found.minus? })
    };
    accepted.iter().filter_map(row).collect()
}
