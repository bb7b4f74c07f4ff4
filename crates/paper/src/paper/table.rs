//! The table of quantities: computed numbers beside printed ones on every set of runs, why they are
//! where they are, and what of the paper they do not reproduce.

use serde::Serialize;

use super::claims::Claim;
use super::maximum::{Extreme, largest};
use super::measures::{Measure, measures};
use super::sampling::Sampling;
use super::units::{Estimate, Unit, with_interval};
use super::verdict::Grade;
use cohaul::model::paper as printed;
use cohaul_report::quantity::{number, quantity};

/// A quantity beside the printed one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableRow {
    pub quantity: String,
    pub unit: &'static str,
    pub printed: Option<f64>,
    /// On the first set.
    pub ours: Option<Estimate>,
    pub grade: Option<Grade>,
    pub why: String,
    /// On the other sets, in their order.
    pub on_others: Vec<OtherSet>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OtherSet {
    pub set: String,
    pub value: Option<Estimate>,
    pub grade: Option<Grade>,
    /// Minus the first set, paired by seed.
    pub minus_first: Option<Estimate>,
    /// Whether the interval of that leaves out zero.
    pub is_shifted: bool,
}

/// Value on one set, and its grade.
type Graded = (Option<Estimate>, Option<Grade>);

/// Rows of all quantities on named sets of units, with the largest pulls behind the other pulls.
pub fn table(sets: &[(String, Vec<Unit>)]) -> Vec<TableRow> {
    let mut rows: Vec<TableRow> = measures().into_iter().map(|measure| row_of(measure, sets)).collect();
    for (at, sampling) in Sampling::ALL.into_iter().enumerate() {
        rows.insert(2 + 3 * at, maximum_row(sets, sampling));
    }
    rows
}

fn row_of(measure: Measure, sets: &[(String, Vec<Unit>)]) -> TableRow {
    let first = &sets[0].1;
    let (ours, grade) = measure.graded(first);
    TableRow {
        quantity: measure.name(),
        unit: measure.unit(),
        printed: measure.printed().map(|printed| printed.value),
        ours,
        grade,
        why: why(measure).to_owned(),
        on_others: on_others(sets, |units| (measure.graded(units), measure.difference(units, first))),
    }
}

/// The largest pull of a sample of the printed size; its interval is that of one such sample.
fn maximum_row(sets: &[(String, Vec<Unit>)], sampling: Sampling) -> TableRow {
    let of = |units: &[Unit]| -> Graded {
        let found = largest(units, sampling);
        let estimate = |found: Extreme| {
            let interval_95 = Some(found.draw_95);
            Estimate { value: found.expected, interval_95, standard_error: None, n_units: units.len() }
        };
        (found.map(estimate), found.map(|found| found.grade()))
    };
    let (ours, grade) = of(&sets[0].1);
    TableRow {
        quantity: format!("pull, largest of {}, {}", printed::N_PULLS, sampling.name()),
        unit: "N",
        printed: Some(printed::PULL_MAX_N),
        ours,
        grade,
        why: largest(&sets[0].1, sampling).map_or_else(String::new, |found| why_maximum(&found)),
        on_others: on_others(sets, |units| (of(units), None)),
    }
}

/// A quantity on all sets but the first: `of` gives value and grade, and the value minus the first.
fn on_others(sets: &[(String, Vec<Unit>)], of: impl Fn(&[Unit]) -> (Graded, Option<Estimate>)) -> Vec<OtherSet> {
    let other = |(name, units): &(String, Vec<Unit>)| {
        let ((value, grade), minus_first) = of(units);
        OtherSet { set: name.clone(), value, grade, minus_first, is_shifted: minus_first.is_some_and(|found| found.is_not_zero()) }
    };
    sets[1..].iter().map(other).collect()
}

/// What makes the difference, or the agreement, of one quantity.
fn why(measure: Measure) -> &'static str {
    match measure {
        Measure::PULL_MEAN | Measure::PULL_SD => {
            "fixed by what a spring gains between two decisions, which the paper leaves open and the parameter search sets; which trials it sampled is inferred from the sample's size"
        }
        Measure::PullMean(_, Sampling::ByTime) | Measure::PullSd(_, Sampling::ByTime) => {
            "a large pull ends within a few decisions but lasts for many control periods; the paper does not say when pulls were taken"
        }
        Measure::PullMean(_, Sampling::WithoutZeros) | Measure::PullSd(_, Sampling::WithoutZeros) => {
            "the same pulls without the zero at which each attachment begins"
        }
        Measure::PullMean(..) | Measure::PullSd(..) => {
            "not printed by trial: a load that follows its ants slackens their springs, one that sticks does not"
        }
        Measure::SizeShare(_) => {
            "set by how soon an ant that has let go finds a free tip, so by the reach; ours spread wider than a binomial, as ants come back unequally fast"
        }
        Measure::MixtureShare(_) => {
            "the weights of the trials are those that bring all printed counts closest; the paper does not print how many runs each trial had"
        }
        Measure::ShareOfOne => "a guess without a grade: the paper does not print how many runs each trial had",
        Measure::Lasts(_) => "the paper's one run of four ants changes at 83 s; goes with the inferred walking speed of pulling ants",
        Measure::Phase(..) => "the paper shows one run; chance makes 2.5 % of runs significant, and 5 % of the change of all three",
        Measure::TimeToNest(_) => "goes with the inferred walking speed of pulling ants",
        Measure::Arrived(_) => "within the longest time of the scenario; not printed",
        _ => "a ratio that no inferred speed changes much",
    }
}

/// The same of the largest pull.
fn why_maximum(found: &Extreme) -> String {
    format!(
        "one draw of an extreme: the interval is that of a sample of the printed size, foreseen from {} pulls, whose largest was {}",
        found.n,
        quantity(found.met, "N")
    )
}

/// A printed number or claim that is not reproduced.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Missed {
    pub what: String,
    /// As printed, or the limit of a claim.
    pub paper: String,
    pub here: String,
    /// `false` where the seeds do not tell.
    pub is_certain: bool,
}

/// Graded quantities that differ or are undecided, and claims that do not hold or are undecided;
/// certain ones first.
pub fn missed(table: &[TableRow], claims: &[Claim]) -> Vec<Missed> {
    let rows = table.iter().filter_map(|row| {
        let grade = row.grade.filter(|grade| !grade.is_met())?;
        Some(Missed {
            what: row.quantity.clone(),
            paper: quantity(row.printed?, row.unit),
            here: with_interval(&row.ours, row.unit),
            is_certain: grade == Grade::Differs,
        })
    });
    let claims = claims.iter().filter(|claim| claim.holds != Some(true)).map(|claim| Missed {
        what: format!("{} ({})", claim.claim, claim.source),
        paper: format!("{} {} {}", claim.statistic, claim.side(), number(claim.limit)),
        here: with_interval(&claim.found, ""),
        is_certain: claim.holds == Some(false),
    });
    let mut found: Vec<Missed> = rows.chain(claims).collect();
    found.sort_by_key(|missed| !missed.is_certain);
    found
}
