//! The grid, and the points that follow from those before.
//!
//! Points come in rounds: the grid first, then one point at each boundary of each quantity that is
//! not yet known well enough, and two about each extremum of an effect that may reach its tolerance
//! between the points. A round follows from the records before it alone, so that a search which was
//! stopped goes on to the same points.

use super::point::{Class, Point};
use crate::journal::JournalError;
use crate::runner::{Records, Tasks, Watch};
use crate::sweep::Plan;
use crate::vary::report::QUANTITIES;
use cohaul::analysis::compare::Settings;

/// Largest ratio of the values on both sides of a boundary, less one (1).
pub const PRECISION: f64 = 0.01;
/// Distance from a neighbour in the logarithm at which the other side of a boundary is looked for
/// (1).
const ASIDE: f64 = PRECISION / 2.0;
/// Most rounds after the grid (1). Halving alone takes a factor of 2 to a percent in seven.
const MOST_ROUNDS: usize = 20;
/// Every round of this number halves, whatever the laws of the effects are.
const HALVING: usize = 3;
/// Distance of an effect from its tolerance in the logarithm below which an open answer is due to
/// the reference error (1).
const NEAR: f64 = 0.1;
/// Smallest effect over its tolerance of which a law is looked for (1).
const LEAST_SHARE: f64 = 1e-6;

/// Compares the models on the grid of the plan and at all boundaries, until `watch` ends the work.
/// Returns the number of points asked for; some have no record if the work was ended.
///
/// # Errors
/// When the journal cannot be written.
pub fn search(plan: &Plan, settings: &Settings, records: &mut Records<Point>, watch: &Watch) -> Result<usize, JournalError> {
    let grid = (0..plan.identity.n_cells).map(|at| plan.values(at)[0].as_f64().expect("a grid has numbers"));
    let mut values: Vec<f64> = grid.collect();
    // What is needed after the grid is not known before it: about as much again.
    let n_expected = 2.0 * values.len() as f64;
    for round in 0..=MOST_ROUNDS {
        let run = |task: usize, go_on: &(dyn Fn() -> bool + Sync)| Point::of(plan, settings, values[task], go_on);
        let share = values.len() as f64 / n_expected.max(values.len() as f64);
        Tasks::equal(values.len(), run).run(records, &|done| watch(done * share))?;
        let points: Option<Vec<&Point>> = (0..values.len()).map(|task| records.get(task)).collect();
        let Some(points) = points else { break };
        let next = next_values(&sorted(points), round % HALVING == HALVING - 1);
        if next.is_empty() {
            break;
        }
        values.extend(next);
    }
    Ok(values.len())
}

/// Points in the order of their values.
pub fn sorted<'a>(points: impl IntoIterator<Item = &'a Point>) -> Vec<&'a Point> {
    let mut points: Vec<&Point> = points.into_iter().collect();
    points.sort_by(|a, b| a.value.total_cmp(&b.value));
    points
}

/// Values at boundaries that are not yet known well enough, and about extrema.
fn next_values(points: &[&Point], halves: bool) -> Vec<f64> {
    let quantities = |between: &dyn Fn(usize) -> Vec<f64>| (0..QUANTITIES.len()).flat_map(between).collect::<Vec<f64>>();
    let pairs = points.windows(2).flat_map(|pair| quantities(&|at| at_boundary([pair[0], pair[1]], at, halves)));
    let triples = points.windows(3).flat_map(|near| quantities(&|at| about_extremum([near[0], near[1], near[2]], at)));
    let mut values: Vec<f64> = pairs.chain(triples).collect();
    values.sort_by(f64::total_cmp);
    values.dedup_by(|b, a| *b < *a * (1.0 + ASIDE / 2.0));
    values
}

fn is_known([from, to]: [&Point; 2]) -> bool {
    to.value <= (1.0 + PRECISION) * from.value
}

/// A value between two points at which the answers on a quantity differ, unless they are near.
fn at_boundary(pair: [&Point; 2], quantity: usize, halves: bool) -> Vec<f64> {
    let differs = pair[0].class(quantity) != pair[1].class(quantity);
    if differs && !is_known(pair) { vec![value_between(pair, quantity, halves)] } else { Vec::new() }
}

/// The middles about a point at which an effect is nearer to its tolerance than at both neighbours,
/// where it may reach it: it is less far from it than from the farther neighbour.
fn about_extremum(near: [&Point; 3], quantity: usize) -> Vec<f64> {
    let class = near[1].class(quantity);
    let is_one_answer = matches!(class, Class::Valid | Class::NotValid) && near.iter().all(|point| point.class(quantity) == class);
    let distance = near.map(|point| point.share(quantity).unwrap_or_default().max(LEAST_SHARE).ln().abs());
    let is_extremum = distance[1] <= distance[0].min(distance[2]);
    let may_reach = 2.0 * distance[1] < distance[0].max(distance[2]);
    let pairs = [[near[0], near[1]], [near[1], near[2]]].into_iter().filter(|pair| !is_known(*pair));
    let middles = pairs.map(|[from, to]| (from.value * to.value).sqrt());
    if is_one_answer && is_extremum && may_reach { middles.collect() } else { Vec::new() }
}

/// A value between two points at which the answers on a quantity differ.
fn value_between(pair: [&Point; 2], quantity: usize, halves: bool) -> f64 {
    let [from, to] = pair.map(|point| point.value.ln());
    let middle = 0.5 * (from + to);
    let crossing = crossing(pair, quantity).filter(|_| !halves);
    crossing.map_or(middle, |at| at.clamp(from + ASIDE, to - ASIDE)).exp()
}

/// Logarithm of the value at which an effect that follows a power law between two points is its
/// tolerance; `None` if nothing suggests that it is so there.
pub fn crossing(pair: [&Point; 2], quantity: usize) -> Option<f64> {
    // A doubtful run says nothing of the effect.
    let is_law = |point: &&Point| match point.class(quantity) {
        Class::Valid | Class::NotValid => true,
        Class::Open => point.doubt.is_none(),
        Class::NothingMoves | Class::Failed => false,
    };
    if !pair.iter().all(is_law) {
        return None;
    }
    let [a, b] = pair.map(|point| point.share(quantity).unwrap_or_default().max(LEAST_SHARE).ln());
    let is_there = (a <= 0.0) != (b <= 0.0) || a.abs().min(b.abs()) < NEAR;
    let [from, to] = pair.map(|point| point.value.ln());
    Some(from + (to - from) * a / (a - b)).filter(|at| is_there && at.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::threshold::bands::bands;
    use crate::threshold::point::Effect;

    /// A point at which the effect on a quantity over the tolerance is `share`, to a thousandth.
    fn point(value: f64, share: f64, quantity: usize) -> Point {
        let class = match share {
            _ if share < 0.999 => Class::Valid,
            _ if share > 1.001 => Class::NotValid,
            _ => Class::Open,
        };
        let effect = Effect { class, inertia_effect: share, reference_error: 1e-3, tolerance: 1.0 };
        let mut effects = [None; QUANTITIES.len()];
        effects[quantity] = Some(effect);
        Point { value, effects, doubt: None, failure: None }
    }

    /// Boundaries with their ranges, and the number of points after a grid from 1/32 to 32 with two
    /// points for each factor of 2.
    fn found(law: impl Fn(f64) -> f64, quantity: usize) -> (Vec<(f64, [f64; 2])>, usize) {
        let of = |value: f64| point(value, law(value), quantity);
        let mut points: Vec<Point> = (0..=20).map(|at| of(2f64.powf(0.5 * f64::from(at) - 5.0))).collect();
        for round in 0..MOST_ROUNDS {
            let next = next_values(&sorted(&points), round % HALVING == HALVING - 1);
            points.extend(next.into_iter().map(of));
        }
        let bounds = bands(&sorted(&points), quantity)[1..].iter().map(|band| (band.from.value, band.from.range)).collect();
        (bounds, points.len() - 21)
    }

    /// A power law needs two points or three, and a jump as many as halvings to a percent.
    #[test]
    fn boundaries_are_found_to_a_percent_with_few_points() {
        let wave = |x: f64| 1.0 + 0.5 * (4.0 * x.ln() + 1.0).sin();
        let waves: Vec<f64> = (-6..=6).map(|k| ((f64::from(k) * std::f64::consts::PI - 1.0) / 4.0).exp()).collect();
        let waves: Vec<f64> = waves.into_iter().filter(|x| (1.0 / 32.0..32.0).contains(x)).collect();
        type Law<'a> = (&'a dyn Fn(f64) -> f64, &'a [f64], usize);
        // A peak between two points of the grid, 0.35 apart in the logarithm.
        let peak = |x: f64| 1.1 - 6.0 * (x / 3.3).ln().powi(2).min(0.15);
        let ends = [-1.0, 1.0].map(|side| 3.3 * (side * (0.1f64 / 6.0).sqrt()).exp());
        let laws: [Law; 7] = [
            (&peak, &ends, 9),
            (&|x| x / 3.0, &[3.0], 3),
            // The reference error hides the answer next to the limit.
            (&|x| (x / 3.0).powf(0.2), &[3.0], 5),
            (&|x| (3.0 / x).powi(4), &[3.0], 3),
            (&|x| if x < 3.0 { 0.1 } else { 7.0 }, &[3.0], 6),
            (&|x| 0.5 + (x / 3.0).powi(6), &[3.0 * 0.5f64.powf(1.0 / 6.0)], 5),
            (&|_| 0.3, &[], 0),
        ];
        for (law, expected, most) in laws {
            let (bounds, n) = found(law, 0);
            assert_eq!(bounds.len(), expected.len(), "{bounds:?} {expected:?}");
            assert!(n <= most, "{n} points for {expected:?}");
            for ((value, [from, to]), expected) in bounds.iter().zip(expected) {
                assert!(from <= expected && expected <= to && to / from < 1.0 + 3.0 * PRECISION, "{from} {to} {expected}");
                assert!((value / expected - 1.0).abs() < PRECISION, "{value} {expected}");
            }
        }
        let (bounds, _) = found(wave, 0);
        assert!(bounds.len() >= waves.len() - 2 && waves.len() > 5, "{bounds:?} {waves:?}");
        for (value, _) in bounds {
            assert!(waves.iter().any(|expected| (value / expected - 1.0).abs() < PRECISION), "{value} {waves:?}");
        }
    }

    #[test]
    fn boundaries_of_every_quantity_are_found() {
        for (quantity, (name, _)) in QUANTITIES.iter().enumerate() {
            let (bounds, _) = found(|x| x / 3.0, quantity);
            assert!(bounds.len() == 1 && (bounds[0].0 / 3.0 - 1.0).abs() < PRECISION, "{name}: {bounds:?}");
        }
    }
}
