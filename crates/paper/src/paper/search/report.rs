//! Result of a search: every set, what holds over the accepted ones, and sensitivity indices.

use serde::Serialize;

use super::accepted::{Accepted, choice_rows, claim_rows, one_ant, quantity_rows, spread};
pub use super::accepted::{ChoiceRow, ClaimRow, OneAnt, QuantityRow, Shares, Spread};
use super::judge::{Judged, reported};
use super::rank::{Ranked, ranked};
use super::screen::{SCREENED, Screened};
use super::sensitivity::{Index, Triple, given_data, sobol};
use super::space::Block;
use super::{ACCEPTED, Answer, Plan, Stage};
use crate::paper::Measure;
use cohaul::formats::{self, Format, Versioned};
use cohaul::model::open_choices::{Chosen, Range};
use cohaul::model::paper as printed;

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
    /// The accepted sets by the number of printed facts that they meet, the best first.
    pub ranked: Vec<Ranked>,
    #[serde(skip)]
    pub sets: Vec<SetRow>,
}

impl Versioned for Search {
    const FORMAT: Format = formats::PAPER_SEARCH;
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
        let row = |(set, task): (usize, usize)| {
            let judged: Option<Judged> = judged[task].take();
            SetRow {
                set,
                is_within: task >= design.n_tasks(),
                values: plan.values(&design, stage, task),
                screened: screened[task].clone(),
                is_accepted: judged.as_ref().and_then(|judged| judged.distance).is_some_and(|distance| distance <= ACCEPTED),
                judged,
            }
        };
        let sets: Vec<SetRow> = (0..plan.n_first()[1]).filter(|task| design.is_set(*task)).enumerate().map(row).collect();
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
            ranked: ranked(&accepted),
            sets,
        }
    }
}

/// Place of a word in a list (1).
fn place_of(range: Range, word: &str) -> f64 {
    let Range::Words(all) = range else { return f64::NAN };
    all.iter().position(|own| *own == word).map_or(f64::NAN, |place| place as f64)
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
            Chosen::Word(word) => place_of(design.searched[choice].range, word),
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

#[cfg(test)]
mod tests {
    use super::super::judge::{OnBoth, Standing};
    use super::*;
    use crate::paper::{Estimate, claims};
    use cohaul::math::Interval;

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
        // All facts are met or missed alike: the closer set is the better one.
        assert_eq!(found.ranked.iter().map(|row| (row.rank, row.set)).collect::<Vec<_>>(), [(1, 2), (2, 0)]);
        assert_eq!(found.ranked[0].n_met, found.ranked[0].facts.iter().filter(|fact| fact.is_ranked && fact.is_met).count());
        assert!(found.answer.starts_with("2 of 29 parameter sets"), "{}", found.answer);
    }
}
