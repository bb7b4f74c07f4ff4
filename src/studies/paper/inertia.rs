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
    let of_claims: Vec<_> = sets.iter().map(|(_, units)| claims(units)).collect();
    let mut found: Vec<Conclusion> = (0..of_claims.first().map_or(0, Vec::len))
        .map(|at| {
            let standing = |((name, _), claims): (&(String, _), &Vec<Claim>)| Standing {
                set: name.clone(),
                value: claims[at].found.map(|found| found.value),
                holds: claims[at].holds,
            };
            Conclusion::new(
                format!("{} (contradicts: {})", of_claims[0][at].claim, of_claims[0][at].contradicts.name()),
                sets.iter().zip(&of_claims).map(standing).collect(),
            )
        })
        .collect();
    for measure in measures().into_iter().filter(|measure| measure.printed().is_some()) {
        let standing = |(name, units): &(String, Vec<Unit>)| {
            let (ours, grade) = measure.graded(units);
            let holds = grade.filter(|grade| *grade != Grade::Undecided).map(Grade::is_met);
            Standing { set: name.clone(), value: ours.map(|ours| ours.value), holds }
        };
        found.push(Conclusion::new(format!("{} is near what is printed", measure.name()), sets.iter().map(standing).collect()));
    }
    found.extend(Measure::MOVABLE.map(|measure| unmoved(measure, sets)));
    found
}

/// Share up to which a shifted quantity is the same (1).
const SAME: f64 = 0.1;

/// Whether a quantity is within 10 % of that of the first set, in pairs of seeds. A set without a
/// value fails.
fn unmoved(measure: Measure, sets: &[(String, Vec<Unit>)]) -> Conclusion {
    let first = &sets[0].1;
    let standing = |(name, units): &(String, Vec<Unit>)| {
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
        Standing { set: name.clone(), value: measure.of(&own), holds }
    };
    Conclusion::new(format!("{} is within 10 % of that on the first set", measure.name()), sets.iter().map(standing).collect())
}

impl Conclusion {
    fn new(conclusion: String, on: Vec<Standing>) -> Self {
        let first = on.first().and_then(|standing| standing.holds);
        let is_changed = |standing: &&Standing| first.is_some() && standing.holds.is_some() && standing.holds != first;
        let changed_on = on.iter().filter(is_changed).map(|standing| standing.set.clone()).collect();
        Self { conclusion, on, changed_on }
    }
}
