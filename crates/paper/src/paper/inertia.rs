//! Conclusions that change with inertia or with the engine: the same claims and grades on every set
//! of runs.

use serde::Serialize;

use super::claims::{Claim, claims};
use super::measures::{Measure, measures};
use super::units::{Unit, paired};
use super::verdict::Grade;

/// One conclusion on all sets, in their order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Conclusion {
    pub conclusion: String,
    pub on: Vec<Standing>,
    /// Sets on which it is certainly another than on the first.
    pub changed_on: Vec<String>,
}

/// How a conclusion stands on one set.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Standing {
    pub set: String,
    pub value: Option<f64>,
    /// Whether it holds: `null` when these seeds do not tell.
    pub holds: Option<bool>,
}

/// Conclusions on named sets of units, which are compared with the first set: claims, and whether
/// printed numbers are met or near.
pub fn conclusions(sets: &[(String, Vec<Unit>)]) -> Vec<Conclusion> {
    let of_claims: Vec<Vec<Claim>> = sets.iter().map(|(_, units)| claims(units)).collect();
    let claims = of_claims.iter().take(1).flatten().enumerate().map(|(n, claim)| {
        let name = format!("{} (contradicts: {})", claim.claim, claim.contradicts.name());
        Conclusion::new(name, sets, |at, _| (of_claims[at][n].found.map(|found| found.value), of_claims[at][n].holds))
    });
    let printed = measures().into_iter().filter(|measure| measure.printed().is_some()).map(|measure| {
        Conclusion::new(format!("{} is near what is printed", measure.name()), sets, |_, units| {
            let (ours, grade) = measure.graded(units);
            (ours.map(|ours| ours.value), grade.filter(|grade| *grade != Grade::Undecided).map(Grade::is_met))
        })
    });
    claims.chain(printed).chain(Measure::MOVABLE.map(|measure| unmoved(measure, sets))).collect()
}

/// Share up to which a shifted quantity is the same (1).
const SAME: f64 = 0.1;

/// Whether a quantity is within 10 % of that of the first set, in pairs of seeds. A set without a
/// value fails.
fn unmoved(measure: Measure, sets: &[(String, Vec<Unit>)]) -> Conclusion {
    let first = &sets[0].1;
    Conclusion::new(format!("{} is within 10 % of that on the first set", measure.name()), sets, |_, units| {
        let (own, of_first) = paired(units, first);
        let reference = measure.of(&of_first);
        let shift = measure.difference(units, first);
        let holds = match (reference, shift.and_then(|shift| shift.interval_95)) {
            (Some(reference), Some(shift)) => {
                let margin = SAME * reference.abs();
                let (is_within, is_beyond) = (shift.low >= -margin && shift.high <= margin, shift.low > margin || shift.high < -margin);
                (is_within || is_beyond).then_some(is_within)
            }
            (Some(_), None) if own.len() > 1 && measure.of(&own).is_none() => Some(false),
            _ => None,
        };
        (measure.of(&own), holds)
    })
}

impl Conclusion {
    /// `of` tells the value on a set, by its place, and whether the conclusion holds there.
    fn new(conclusion: String, sets: &[(String, Vec<Unit>)], of: impl Fn(usize, &[Unit]) -> (Option<f64>, Option<bool>)) -> Self {
        let standing = |(at, (set, units)): (usize, &(String, Vec<Unit>))| {
            let (value, holds) = of(at, units);
            Standing { set: set.clone(), value, holds }
        };
        let on: Vec<Standing> = sets.iter().enumerate().map(standing).collect();
        let first = on.first().and_then(|standing| standing.holds);
        let is_changed = |standing: &&Standing| first.is_some() && standing.holds.is_some() && standing.holds != first;
        let changed_on = on.iter().filter(is_changed).map(|standing| standing.set.clone()).collect();
        Self { conclusion, on, changed_on }
    }
}
