//! Ranges of the parameter with one answer on a quantity, and the boundaries between them.

use serde::Serialize;

use super::point::{Class, Point};
use super::search::{PRECISION, crossing};

/// A range with one answer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    pub class: Class,
    pub from: Bound,
    pub to: Bound,
}

/// End of a range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// Value of the parameter.
    pub value: f64,
    /// Values between which it lies: the last one with the answer on one side and the first one
    /// with that on the other.
    pub range: [f64; 2],
    /// Whether the search ends here, and not the answer.
    pub is_end: bool,
}

/// Points with one answer: the first and the last.
#[derive(Clone, Copy)]
struct Stretch {
    class: Class,
    points: [usize; 2],
}

/// Largest width of a range that the reference error alone leaves open at a boundary, in the
/// logarithm (1): two gaps and the points between them.
const OPEN_BY_ERROR: f64 = 4.0 * PRECISION;

/// Ranges of one answer on a quantity, from points in the order of their values.
pub fn bands(points: &[&Point], quantity: usize) -> Vec<Band> {
    let mut stretches: Vec<Stretch> = Vec::new();
    for (at, point) in points.iter().enumerate() {
        match stretches.last_mut() {
            Some(last) if last.class == point.class(quantity) => last.points[1] = at,
            _ => stretches.push(Stretch { class: point.class(quantity), points: [at; 2] }),
        }
    }
    let kept = without_reference_error(points, &stretches);
    let end = |at: usize| Bound { value: points[at].value, range: [points[at].value; 2], is_end: true };
    let band = |at: usize| Band {
        class: kept[at].class,
        from: if at == 0 { end(0) } else { bound(points, [&kept[at - 1], &kept[at]], quantity) },
        to: if at + 1 == kept.len() { end(points.len() - 1) } else { bound(points, [&kept[at], &kept[at + 1]], quantity) },
    };
    (0..kept.len()).map(band).collect()
}

/// All but the narrow open ranges at boundaries, which the ranges of the boundaries contain.
fn without_reference_error(points: &[&Point], stretches: &[Stretch]) -> Vec<Stretch> {
    let is_kept = |at: &usize| {
        let (Some(before), Some(after)) = (at.checked_sub(1).map(|at| stretches[at]), stretches.get(at + 1)) else { return true };
        let [from, to] = [points[before.points[1]], points[after.points[0]]].map(|point| point.value.ln());
        let decides = |class: Class| matches!(class, Class::Valid | Class::NotValid);
        let is_boundary = decides(before.class) && decides(after.class) && before.class != after.class;
        stretches[*at].class != Class::Open || !is_boundary || to - from > OPEN_BY_ERROR
    };
    (0..stretches.len()).filter(is_kept).map(|at| stretches[at]).collect()
}

/// Boundary between two ranges: where the effect is its tolerance, or the middle.
fn bound(points: &[&Point], [before, after]: [&Stretch; 2], quantity: usize) -> Bound {
    let pair = [points[before.points[1]], points[after.points[0]]];
    let range = pair.map(|point| point.value);
    let middle = 0.5 * (range[0].ln() + range[1].ln());
    let at = crossing(pair, quantity).unwrap_or(middle);
    Bound { value: at.exp().clamp(range[0], range[1]), range, is_end: false }
}
