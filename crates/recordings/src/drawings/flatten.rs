//! Curves as straight lines within a tolerance.

use std::f64::consts::TAU;

use kurbo::{BezPath, PathEl, Point};

/// Most corners of a curve (1): an outline has at most 1000.
const MOST_CORNERS: f64 = 10_000.0;

/// Points of an arc from its start to its end, both of them included, no farther than `tolerance`
/// from the arc. `sweep` (rad) is positive counter-clockwise.
pub fn arc(centre: Point, radius: f64, start: f64, sweep: f64, tolerance: f64) -> Vec<Point> {
    // A chord over the angle a is off by r (1 - cos(a / 2)).
    let half = (1.0 - (tolerance / radius).clamp(1e-9, 1.0)).acos().max(1e-6);
    let n = (sweep.abs() / (2.0 * half)).ceil().clamp(2.0, MOST_CORNERS) as usize;
    let at = |k: usize| start + sweep * k as f64 / n as f64;
    (0..=n).map(|k| Point::new(centre.x + radius * at(k).cos(), centre.y + radius * at(k).sin())).collect()
}

/// Corners of a regular polygon that is nowhere farther than `tolerance` from a circle.
pub fn circle(centre: Point, radius: f64, tolerance: f64) -> Vec<Point> {
    let mut points = arc(centre, radius, 0.0, TAU, tolerance);
    points.pop();
    points
}

/// Points from `from` to `to` on an arc of a bulge, the tangent of a quarter of its angle, without
/// the first one.
pub fn bulge(from: Point, to: Point, bulge: f64, tolerance: f64) -> Vec<Point> {
    let (chord, middle) = (to - from, from.midpoint(to));
    if bulge == 0.0 || chord.hypot() == 0.0 {
        return vec![to];
    }
    let sweep = 4.0 * bulge.atan();
    // The centre is to the left of the chord for arcs of less than a half turn.
    let offset = 0.5 * (1.0 / bulge - bulge) / 2.0;
    let centre = Point::new(middle.x - chord.y * offset, middle.y + chord.x * offset);
    let start = from - centre;
    let mut points = arc(centre, start.hypot(), start.y.atan2(start.x), sweep.clamp(-TAU, TAU), tolerance);
    points.remove(0);
    // The end is where the drawing says, to the last digit.
    if let Some(last) = points.last_mut() {
        *last = to;
    }
    points
}

/// Subpaths as points, and whether each is closed.
pub fn path(path: &BezPath, tolerance: f64) -> Vec<(Vec<Point>, bool)> {
    let mut found: Vec<(Vec<Point>, bool)> = Vec::new();
    kurbo::flatten(path, tolerance, |element| match element {
        PathEl::MoveTo(at) => found.push((vec![at], false)),
        PathEl::LineTo(at) => {
            if let Some((points, _)) = found.last_mut() {
                points.push(at);
            }
        }
        PathEl::ClosePath => {
            if let Some((_, is_closed)) = found.last_mut() {
                *is_closed = true;
            }
        }
        PathEl::QuadTo(..) | PathEl::CurveTo(..) => {}
    });
    found
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn arcs_stay_within_the_tolerance_and_end_where_they_should() {
        for tolerance in [1e-2, 1e-4] {
            let corners = circle(Point::new(1.0, 2.0), 3.0, tolerance);
            let sagitta = 3.0 - corners[0].midpoint(corners[1]).distance(Point::new(1.0, 2.0));
            assert!(sagitta <= tolerance * (1.0 + 1e-9) && sagitta > 0.2 * tolerance, "{sagitta} of {tolerance}");
        }
        // A bulge of one is a half circle, to the right of the line between its ends.
        let half = bulge(Point::new(1.0, 0.0), Point::new(-1.0, 0.0), 1.0, 1e-3);
        assert!(half.iter().all(|at| (at.to_vec2().hypot() - 1.0).abs() < 1e-12 && at.y >= 0.0), "{half:?}");
        let quarter = bulge(Point::new(1.0, 0.0), Point::new(0.0, 1.0), (PI / 8.0).tan(), 1e-3);
        assert!(quarter.iter().all(|at| (at.to_vec2().hypot() - 1.0).abs() < 1e-12), "{quarter:?}");
        assert_eq!(quarter.last(), Some(&Point::new(0.0, 1.0)));
    }
}
