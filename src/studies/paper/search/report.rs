//! The accepted sets in numbers.

use serde::Serialize;

use super::judge::{Judged, reported};
use super::screen::{SCREENED, Screened};
use super::sensitivity::{Index, Triple, given_data, sobol};
use super::space::Block;
use super::{ACCEPTED, Answer, Plan, Stage};
use crate::backend::BackendKind;
use crate::model::open_choices::{Chosen, Range};
use crate::model::paper as printed;
use crate::studies::paper::{Estimate, Measure, Trial, claims};

/// What `paper search --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Search {
    pub answer: String,
    pub plan: Plan,
    pub wall_s: f64,
    /// Different sets of the first look.
    pub n_sets: usize,
    /// Of them, those close to the targets, those looked at again, and those accepted.
    pub n_close: usize,
    pub n_judged: usize,
    pub n_accepted: usize,
    pub choices: Vec<ChoiceRow>,
    pub claims: Vec<ClaimRow>,
    pub quantities: Vec<QuantityRow>,
    /// Effect of inertia on one ant's time to the nest, set by set.
    pub one_ant: Vec<OneAnt>,
    pub indices: Vec<IndexRow>,
    /// The accepted set with the smallest distance.
    pub closest: Option<SetRow>,
    #[serde(skip)]
    pub sets: Vec<SetRow>,
}

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

/// How much of a quantity's variance comes from a choice.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IndexRow {
    pub quantity: String,
    pub choice: &'static str,
    /// Over all sets.
    pub first_order: Option<Index>,
    pub total: Option<Index>,
    /// Over the accepted sets, of the quantity and of the inertia effect on it.
    pub among_accepted: Option<Index>,
    pub of_inertia_effect: Option<Index>,
}

/// A set of the first look.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SetRow {
    pub set: usize,
    /// Whether it is one of those in the box around the closest.
    pub is_within: bool,
    pub values: Vec<Chosen>,
    pub screened: Screened,
    pub judged: Option<Judged>,
    pub is_accepted: bool,
}

/// Name of the last row of indices of a quantity.
pub const SEEDS: &str = "seeds";

impl Search {
    /// Of a finished search.
    pub fn new(plan: &Plan, stage: &Stage, answers: Vec<Answer>, wall_s: f64) -> Self {
        let (design, close) = (plan.design(), &stage.close);
        let (mut screened, mut judged) = (Vec::new(), vec![None; plan.n_first()[1]]);
        let mut again = close.iter();
        for answer in answers {
            match answer {
                Answer::Screened(found) => screened.push(found),
                Answer::Judged(found) => judged[*again.next().expect("one answer a close set")] = Some(*found),
            }
        }
        let is_set = |task: usize| task < design.n_sets() || task >= design.n_tasks();
        let sets: Vec<SetRow> = judged
            .into_iter()
            .enumerate()
            .filter(|(task, _)| is_set(*task))
            .zip(0..)
            .map(|((task, judged), set)| SetRow {
                set,
                is_within: task >= design.n_tasks(),
                values: plan.values(&design, stage, task),
                screened: screened[task].clone(),
                is_accepted: judged.as_ref().and_then(|judged: &Judged| judged.distance).is_some_and(|distance| distance <= ACCEPTED),
                judged,
            })
            .collect();
        let n_close = sets.iter().filter(|row| row.screened.distance.is_some_and(|distance| distance <= super::CLOSE)).count();
        let accepted: Vec<Accepted> = sets
            .iter()
            .filter(|row| row.is_accepted)
            .filter_map(|row| Some(Accepted { set: row.set, values: &row.values, judged: row.judged.as_ref()? }))
            .collect();
        let distance = |row: &&Accepted| row.judged.distance.unwrap_or(f64::INFINITY);
        let closest = accepted.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).map(|row| sets[row.set].clone());
        let (claims, one_ant) = (claim_rows(&accepted), one_ant(&accepted));
        Self {
            answer: answer(plan, accepted.len(), &claims, &one_ant),
            plan: *plan,
            wall_s,
            n_sets: plan.n_sets(),
            n_close,
            n_judged: close.len(),
            n_accepted: accepted.len(),
            choices: choice_rows(plan, &accepted),
            claims,
            quantities: quantity_rows(&accepted),
            one_ant,
            indices: index_rows(plan, &screened, &accepted),
            closest,
            sets,
        }
    }
}

/// An accepted set.
struct Accepted<'a> {
    set: usize,
    values: &'a [Chosen],
    judged: &'a Judged,
}

fn answer(plan: &Plan, n_accepted: usize, claims: &[ClaimRow], one_ant: &[OneAnt]) -> String {
    if n_accepted == 0 {
        return format!("None of {} parameter sets with all printed values meets the calibration targets.", plan.n_sets());
    }
    let everywhere = claims.iter().filter(|claim| claim.on[0].holds == 1.0).count();
    let nowhere = claims.iter().filter(|claim| claim.on[0].holds == 0.0).count();
    let effects = spread(one_ant.iter().map(|row| row.inertia_effect.value));
    let of_one = effects.map_or_else(String::new, |effects| {
        format!(
            " Inertia changes the time of one ant by {:+.0} to {:+.0} s, {:+.0} s in the median.",
            effects.least, effects.most, effects.median
        )
    });
    let n_sets = plan.n_sets();
    format!(
        "{n_accepted} of {n_sets} parameter sets with all printed values meet the calibration targets. \
         Claims that certainly hold on all of them: {everywhere} of {}; on none: {nowhere}.{of_one}",
        claims.len()
    )
}

fn spread(values: impl IntoIterator<Item = f64>) -> Option<Spread> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let (least, most) = (*values.first()?, *values.last()?);
    Some(Spread { least, median: values[values.len() / 2], most })
}

fn choice_rows(plan: &Plan, accepted: &[Accepted]) -> Vec<ChoiceRow> {
    let row = |(at, choice): (usize, &super::space::Searched)| {
        let values: Vec<Chosen> = accepted.iter().map(|row| row.values[at]).collect();
        let numbers = values.iter().filter_map(|value| if let Chosen::Number(value) = value { Some(*value) } else { None });
        let all = spread(numbers);
        let end = |share: f64| if let Some(Chosen::Number(value)) = choice.range.at(share) { value } else { f64::NAN };
        let is_list = !matches!(choice.range, Range::Between { .. });
        let reaches = |spread: Spread| spread.least < end(0.1) || spread.most > end(0.9);
        let listed = if is_list { words(choice.range) } else { Vec::new() };
        let count = |word: &String| values.iter().filter(|value| text(value) == *word).count();
        ChoiceRow {
            choice: choice.name,
            key: choice.key,
            unit: choice.unit,
            searched: searched_text(choice.range),
            accepted: all.filter(|_| !is_list),
            reaches_an_end: all.is_some_and(|all| !is_list && reaches(all)),
            counts: listed.iter().map(|word| (word.clone(), count(word))).collect(),
        }
    };
    plan.design().searched.iter().enumerate().map(row).collect()
}

fn words(range: Range) -> Vec<String> {
    match range {
        Range::Numbers(all) => all.iter().map(f64::to_string).collect(),
        Range::Words(all) => all.iter().map(|word| (*word).to_owned()).collect(),
        Range::Between { .. } | Range::Fixed(_) => Vec::new(),
    }
}

pub(super) fn text(value: &Chosen) -> String {
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

fn claim_rows(accepted: &[Accepted]) -> Vec<ClaimRow> {
    let n = accepted.len() as f64;
    let row = |(at, claim): (usize, crate::studies::paper::Claim)| {
        let on = |with: usize| {
            let all = || accepted.iter().map(|row| row.judged.claims[at][with]);
            let share = |is: &dyn Fn(super::judge::Standing) -> bool| all().filter(|standing| is(*standing)).count() as f64 / n;
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

/// Measures by which sets are accepted.
fn is_target(measure: Measure) -> bool {
    use crate::studies::paper::Sample::Printed;
    matches!(measure, Measure::PullMean(Printed) | Measure::PullSd(Printed) | Measure::SizeShare(_))
}

fn quantity_rows(accepted: &[Accepted]) -> Vec<QuantityRow> {
    let n = accepted.len() as f64;
    let share = |hits: Vec<bool>| (!hits.is_empty()).then(|| hits.iter().filter(|hit| **hit).count() as f64 / n);
    let row = |(at, measure): (usize, Measure)| {
        let all = || accepted.iter().map(move |row| row.judged.measures[at]);
        let effects: Vec<Estimate> = all().filter_map(|found| found.minus).collect();
        let certain = effects.iter().filter_map(|effect| effect.interval_95).map(|interval| interval.low > 0.0 || interval.high < 0.0);
        QuantityRow {
            quantity: measure.name(),
            unit: measure.unit(),
            printed: measure.printed().map(|printed| printed.value),
            is_target: is_target(measure),
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

fn one_ant(accepted: &[Accepted]) -> Vec<OneAnt> {
    let at = reported().iter().position(|measure| *measure == Measure::TimeToNest(Trial::OneOne)).expect("a reported quantity");
    let row = |row: &Accepted| {
        let found = row.judged.measures[at];
        Some(OneAnt { set: row.set, quasi_static_s: found.quasi_static?.value, inertia_effect: found.minus? })
    };
    accepted.iter().filter_map(row).collect()
}

/// Rows of the indices: each first-look quantity by each choice and by seeds, then each further
/// quantity over the accepted sets alone.
fn index_rows(plan: &Plan, screened: &[Screened], accepted: &[Accepted]) -> Vec<IndexRow> {
    let (design, n) = (plan.design(), plan.n_rows as usize);
    let blocks = design.blocks();
    let value = |block: Block, row: usize, of: usize| {
        let at = blocks.iter().position(|other| *other == block).expect("a block of the design");
        let found = &screened[at * n + row];
        if of < SCREENED.len() { found.values[of] } else { found.largest_pull_n }
    };
    let triples = |block: Block, of: usize| -> Vec<Triple> {
        let row = |row: usize| Some(Triple { a: value(Block::A, row, of)?, b: value(Block::B, row, of)?, swapped: value(block, row, of)? });
        (0..n).filter_map(row).collect()
    };
    let reported = reported();
    let among = |measure: Option<Measure>, choice: usize, of: &dyn Fn(&Accepted, usize) -> Option<f64>| {
        let at = reported.iter().position(|other| Some(*other) == measure)?;
        let x = |row: &Accepted| match row.values[choice] {
            Chosen::Number(value) => value,
            Chosen::Word(word) => f64::from(u8::from(word == "aged")),
        };
        given_data(&accepted.iter().filter_map(|row| Some([x(row), of(row, at)?])).collect::<Vec<_>>())
    };
    let plain = |row: &Accepted, at: usize| Some(row.judged.measures[at].quasi_static?.value);
    let effect = |row: &Accepted, at: usize| Some(row.judged.measures[at].minus?.value);
    let later = reported.iter().filter(|measure| !SCREENED.contains(measure)).copied();
    let quantities = SCREENED.into_iter().enumerate().map(|(of, measure)| (Some(measure), Some(of)));
    let quantities = quantities.chain([(None, Some(SCREENED.len()))]).chain(later.map(|measure| (Some(measure), None)));
    let mut rows = Vec::new();
    for (measure, of) in quantities {
        let quantity = measure.map_or_else(|| format!("pull, largest of {}", printed::N_PULLS), Measure::name);
        for (at, choice) in design.searched.iter().enumerate() {
            let indices = of.and_then(|of| sobol(&triples(Block::Swapped(at), of)));
            rows.push(IndexRow {
                quantity: quantity.clone(),
                choice: choice.name,
                first_order: indices.map(|found| found[0]),
                total: indices.map(|found| found[1]),
                among_accepted: among(measure, at, &plain),
                of_inertia_effect: among(measure, at, &effect),
            });
        }
        if let Some(indices) = of.and_then(|of| sobol(&triples(Block::OtherSeeds, of))) {
            let total = Some(indices[1]);
            rows.push(IndexRow { quantity, choice: SEEDS, first_order: None, total, among_accepted: None, of_inertia_effect: None });
        }
    }
    rows.retain(|row| row.total.is_some() || row.among_accepted.is_some() || row.of_inertia_effect.is_some());
    rows
}

/// Methods of the two columns of claims.
pub const METHODS: [BackendKind; 2] = [BackendKind::QuasiStatic, BackendKind::Inertial];

#[cfg(test)]
mod tests {
    use super::super::judge::{OnBoth, Standing};
    use super::*;
    use crate::math::Interval;

    const PLAN: Plan = Plan { n_rows: 2, n_within: 5, n_screening_seeds: 1, n_judging_seeds: 2, most_judged: 3 };

    fn screened(distance: Option<f64>) -> Answer {
        Answer::Screened(Screened { values: vec![Some(1.0); SCREENED.len()], largest_pull_n: Some(0.03), distance })
    }

    fn judged(distance: f64, holds: Option<bool>, effect_s: f64) -> Answer {
        let of = |value: f64| {
            Some(Estimate { value, interval_95: Some(Interval { low: value - 1.0, high: value + 1.0 }), standard_error: None, n_units: 2 })
        };
        let both = OnBoth { quasi_static: of(300.0), inertial: of(300.0 + effect_s), minus: of(effect_s), grade: None };
        let standing = Standing { value: Some(0.5), holds };
        let claims = vec![[standing, Standing { holds: Some(false), ..standing }]; claims(&[]).len()];
        Answer::Judged(Box::new(Judged { distance: Some(distance), measures: vec![both; reported().len()], largest_pull: None, claims }))
    }

    /// Close sets are looked at again, spread over all where there are too many, and repetitions
    /// with other seeds are no sets.
    #[test]
    fn close_sets_are_looked_at_again() {
        let close = |answers: &[Answer]| PLAN.after_first(PLAN.after_design(answers), answers).close;
        let mut answers: Vec<Answer> = (0..PLAN.n_first()[1]).map(|_| screened(Some(9.0))).collect();
        assert!(close(&answers).is_empty());
        answers[PLAN.design().n_sets()] = screened(Some(0.1));
        answers[3] = screened(Some(super::super::CLOSE));
        answers[4] = screened(None);
        answers[PLAN.n_first()[0]] = screened(Some(0.1));
        assert_eq!(close(&answers), [3, PLAN.n_first()[0]]);
        answers[PLAN.n_first()[0]] = screened(None);
        answers[..12].fill(screened(Some(0.5)));
        assert_eq!(close(&answers), [0, 4, 8]);
    }

    /// The second look decides, and fractions are of the accepted sets.
    #[test]
    fn claims_and_effects_are_reported_over_the_accepted_sets() {
        let mut answers: Vec<Answer> = (0..PLAN.n_first()[1]).map(|set| screened(Some(if set < 3 { 0.2 } else { 5.0 }))).collect();
        answers.extend([judged(0.9, Some(true), 2.0), judged(1.1, Some(true), 99.0), judged(0.6, None, -0.5)]);
        let stage = Stage { close: vec![0, 1, 2], ..PLAN.after_design(&answers[..26]) };
        let found = Search::new(&PLAN, &stage, answers, 1.0);
        assert_eq!((found.n_sets, found.n_close, found.n_judged, found.n_accepted), (29, 3, 3, 2));
        assert_eq!(found.closest.as_ref().map(|row| row.set), Some(2));
        let claim = found.claims[0].on;
        assert_eq!((claim[0].holds, claim[0].fails, claim[0].unknown), (0.5, 0.0, 0.5));
        assert_eq!((claim[1].holds, claim[1].fails, claim[1].unknown), (0.0, 1.0, 0.0));
        let effects: Vec<f64> = found.one_ant.iter().map(|row| row.inertia_effect.value).collect();
        assert_eq!(effects, [2.0, -0.5]);
        let time = found.quantities.iter().find(|row| row.quantity == "time to nest, 1/1").unwrap();
        // 2 s +- 1 s is certainly not zero, -0.5 s +- 1 s may be.
        assert_eq!((time.shifted_by_inertia, time.inertia_effect.unwrap().most), (Some(0.5), 2.0));
        assert!(found.answer.starts_with("2 of 29 parameter sets"), "{}", found.answer);
    }
}
