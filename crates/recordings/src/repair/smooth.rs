//! The smoothest path within a bound, and an estimate of the noise.
//!
//! Smoothing is penalised least squares (Whittaker 1923, Henderson 1924): the places z minimise
//! `sum (z - y)^2 + w sum (second difference of z)^2`. The weight w is the largest one for which no
//! place moves by more than the bound.

use cohaul::math::Vec2;
use cohaul::stop;

use super::attachments::Attachment;
use crate::account::{Account, Kind, Note};
use crate::tracks::Sample;

/// Weights of the penalty that are tried, as powers of ten. With the largest one a path is straight
/// over thousands of frames; a larger one would cost digits.
const WEIGHTS: [f64; 2] = [-4.0, 9.0];
/// Halvings of that range: the weight is then right within a percent.
const HALVINGS: usize = 12;

/// Moves the places of each attachment onto the smoothest path that is nowhere farther than `bound`
/// (m) from them. Headings stay.
pub fn smooth(all: &mut [Vec<Attachment>], bound: f64, account: &mut Account) {
    let (mut n, mut largest) = (0, 0.0);
    for attachment in all.iter_mut().flatten().filter(|attachment| attachment.places.len() > 2) {
        stop::point();
        let raw: Vec<Vec2> = attachment.places.iter().map(|place| place.position).collect();
        let found = smoothest(&attachment.places, &raw, bound);
        for (place, position) in attachment.places.iter_mut().zip(found) {
            largest = f64::max(largest, (place.position - position).norm());
            place.position = position;
            n += 1;
        }
        if let Some(release) = &mut attachment.release {
            release.position = attachment.places.last().map_or(release.position, |last| last.position);
        }
    }
    account.add(Note::new(Kind::Smoothed, n, "places smoothed by penalised least squares").sized(Some(largest), Some(bound), "m"));
}

/// Turns the headings of an obstacle onto the smoothest path that is nowhere farther than `bound`
/// (m) from them at its `radius` (m), if all places have headings.
pub fn smooth_headings(places: &mut [Sample], radius: f64, bound: f64) {
    let raw: Option<Vec<Vec2>> = places.iter().map(|place| Some(Vec2::new(radius * place.heading?, 0.0))).collect();
    let Some(raw) = raw.filter(|raw| raw.len() > 2 && radius > 0.0) else { return };
    let found = smoothest(places, &raw, bound);
    for (place, found) in places.iter_mut().zip(found) {
        place.heading = Some(found.x / radius);
    }
}

/// The smoothest path through `raw`, at the times of `places`.
fn smoothest(places: &[Sample], raw: &[Vec2], bound: f64) -> Vec<Vec2> {
    let is_within = |found: &[Vec2]| found.iter().zip(raw).all(|(a, b)| (a - b).norm() <= bound);
    let [mut low, mut high] = WEIGHTS;
    let straight = smoothed(places, raw, 10_f64.powf(high));
    if is_within(&straight) {
        return straight;
    }
    let mut best = raw.to_vec();
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let found = smoothed(places, raw, 10_f64.powf(middle));
        if is_within(&found) {
            (low, best) = (middle, found);
        } else {
            high = middle;
        }
    }
    best
}

/// The places that minimise the sum of squares with this weight of the penalty (1). Second
/// differences are those of times in units of the mean interval.
fn smoothed(places: &[Sample], raw: &[Vec2], weight: f64) -> Vec<Vec2> {
    let n = raw.len();
    let mean = (places[n - 1].time - places[0].time) / (n - 1) as f64;
    // Diagonal of the matrix and the two next to it.
    let mut bands = vec![[1.0, 0.0, 0.0]; n];
    for at in 1..n - 1 {
        let [before, after] = [places[at].time - places[at - 1].time, places[at + 1].time - places[at].time].map(|step| step / mean);
        let difference = [1.0 / before, -1.0 / before - 1.0 / after, 1.0 / after].map(|value| 2.0 * value / (before + after));
        for i in 0..3 {
            for j in i..3 {
                bands[at - 1 + i][j - i] += weight * difference[i] * difference[j];
            }
        }
    }
    solve(&mut bands, raw)
}

/// Solution of a symmetric positive definite system with two bands beside the diagonal, by the
/// factors L D L^T.
fn solve(bands: &mut [[f64; 3]], right: &[Vec2]) -> Vec<Vec2> {
    let n = bands.len();
    let mut found = right.to_vec();
    for at in 0..n {
        let [pivot, one, two] = bands[at];
        if at + 1 < n {
            let factor = one / pivot;
            bands[at + 1][0] -= factor * one;
            bands[at + 1][1] -= factor * two;
            let part = factor * found[at];
            found[at + 1] -= part;
            bands[at][1] = factor;
        }
        if at + 2 < n {
            let factor = two / pivot;
            bands[at + 2][0] -= factor * two;
            let part = factor * found[at];
            found[at + 2] -= part;
            bands[at][2] = factor;
        }
    }
    for at in (0..n).rev() {
        let mut value = found[at] / bands[at][0];
        if at + 1 < n {
            value -= bands[at][1] * found[at + 1];
        }
        if at + 2 < n {
            value -= bands[at][2] * found[at + 2];
        }
        found[at] = value;
    }
    found
}

/// Standard deviation of a third difference of independent errors over that of the errors (1):
/// the root of 1 + 9 + 9 + 1.
const THIRD_DIFFERENCE: f64 = 4.472_135_954_999_58;
/// Median of the size of a normal variable over its standard deviation (1).
const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196_081_7;
/// Noise that is the rounding of numbers (m).
const ROUNDING: f64 = 1e-12;
/// Speed of the noise over that of the tips from which on it may decide a verdict (1).
const LOUD: f64 = 0.1;

/// Notes the noise of the places from frame to frame, per axis (m), as the median of third
/// differences gives it: motions that last for several frames hardly count. The track and the axis
/// with the largest noise decide.
pub fn note_noise(all: &[Vec<Attachment>], account: &mut Account) {
    let (mut largest, mut n_places, mut is_loud) = (0.0, 0, false);
    for track in all {
        let (mut thirds, mut steps) = ([Vec::new(), Vec::new()], Vec::new());
        for four in track.iter().flat_map(|attachment| attachment.places.windows(4)) {
            let [a, b, c, d] = [0, 1, 2, 3].map(|at| four[at].position);
            let third: Vec2 = d - 3.0 * c + 3.0 * b - a;
            thirds.iter_mut().zip([third.x, third.y]).for_each(|(thirds, third)| thirds.push(third.abs()));
            steps.push((d - a).norm() / 3.0);
        }
        let noise = thirds.iter_mut().map(|thirds| median(thirds)).fold(0.0, f64::max) / (MEDIAN_OF_NORMAL * THIRD_DIFFERENCE);
        largest = f64::max(largest, noise);
        n_places += steps.len();
        // A step has the noise of two places.
        is_loud |= noise > ROUNDING && noise * std::f64::consts::SQRT_2 > LOUD * median(&mut steps);
    }
    let note = |text: &str| Note::new(Kind::Noise, n_places, text).sized(Some(largest), None, "m");
    if is_loud {
        account.add(note("places with noise that is large beside the steps of a track: a verdict about inertia is open, unless it is the same at half and at twice --smooth-m").warning());
    } else if largest > ROUNDING {
        account.add(note("places with noise from frame to frame"));
    }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
