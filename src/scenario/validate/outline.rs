//! Rules of outlines, and the parts of short forms and compounds.

use std::fmt::Display;

use crate::math::{Pose, Vec2};
use crate::model::geometry::{convex_pieces, first_crossing, turned_counter_clockwise};
use crate::model::{Outline, OutlinePart};
use crate::scenario::error::{Findings, number};
use crate::scenario::format::{OutlineEntry, PartEntry};

/// Largest number of parts, corners and ends of walls of one outline (1). Every pair of them is
/// compared.
const MOST_POINTS: usize = 1000;

/// Distance of neighbouring corners over the size of a polygon that counts as one point (1).
const SAME_POINT: f64 = 1e-9;

/// The outline at `path`; `None` where it breaks a rule.
pub fn outline(entry: &OutlineEntry, path: &str, findings: &mut Findings) -> Option<Outline> {
    let n_before = findings.0.len();
    let n_points = n_points(entry);
    if n_points > MOST_POINTS {
        findings.report(path, format!("must have at most {MOST_POINTS} points and parts in all"), n_points);
        return None;
    }
    let mut parts = Vec::new();
    add_parts(entry, path, &Pose::new(0.0, 0.0, 0.0), &mut parts, findings);
    let outline = Outline { parts };
    if findings.0.len() == n_before && convex_pieces(&outline).is_none() {
        findings.report(path, "must enclose an area that can be cut into convex pieces", "one that is too small or too narrow");
    }
    (findings.0.len() == n_before).then_some(outline)
}

/// Number of discs, corners and ends of walls, with those of parts (1).
fn n_points(entry: &OutlineEntry) -> usize {
    match entry {
        OutlineEntry::Disc(_) => 1,
        OutlineEntry::Rectangle(_) => 4,
        OutlineEntry::Polygon(polygon) => polygon.points_m.len(),
        OutlineEntry::Polyline(polyline) => polyline.points_m.len(),
        OutlineEntry::Compound(compound) => compound.parts.iter().map(|part| n_points(&part.outline)).sum(),
    }
}

/// Adds the parts of an outline whose frame is at the pose `at` in that of the body.
fn add_parts(entry: &OutlineEntry, path: &str, at: &Pose, parts: &mut Vec<OutlinePart>, findings: &mut Findings) {
    let placed = |points: &[[f64; 2]]| points.iter().map(|point| at.to_world(&Vec2::from(*point))).collect::<Vec<_>>();
    match entry {
        OutlineEntry::Disc(disc) => {
            findings.positive_size(format_args!("{path}.disc.radius_m"), disc.radius_m);
            parts.push(OutlinePart::Disc { centre: at.position, radius: disc.radius_m });
        }
        OutlineEntry::Rectangle(rectangle) => {
            for (axis, length) in rectangle.size_m.iter().enumerate() {
                findings.positive_size(format_args!("{path}.rectangle.size_m[{axis}]"), *length);
            }
            let [x, y] = rectangle.size_m.map(|length| 0.5 * length);
            let corners = placed(&[[-x, -y], [x, -y], [x, y], [-x, y]]);
            if rectangle.size_m.iter().all(|length| *length > 0.0) && corners.iter().flatten().all(|value| value.is_finite()) {
                check_rectangle(&corners, &rectangle.size_m, &format!("{path}.rectangle.size_m"), findings);
            }
            parts.push(OutlinePart::Polygon { corners });
        }
        OutlineEntry::Polygon(polygon) => {
            let corners = placed(&polygon.points_m);
            check_polygon(&polygon.points_m, &corners, &format!("{path}.polygon.points_m"), findings);
            parts.push(OutlinePart::Polygon { corners: turned_counter_clockwise(corners) });
        }
        OutlineEntry::Polyline(polyline) => {
            let ends = placed(&polyline.points_m);
            check_polyline(&polyline.points_m, &ends, &format!("{path}.polyline.points_m"), findings);
            parts.push(OutlinePart::Polyline { points: ends });
        }
        OutlineEntry::Compound(compound) => {
            if compound.parts.is_empty() {
                findings.report(format_args!("{path}.compound.parts"), "must have at least one part", "none");
            }
            for (index, part) in compound.parts.iter().enumerate() {
                add_part(part, &format!("{path}.compound.parts[{index}]"), at, parts, findings);
            }
        }
    }
}

fn add_part(part: &PartEntry, path: &str, at: &Pose, parts: &mut Vec<OutlinePart>, findings: &mut Findings) {
    findings.finite_vector(format_args!("{path}.position_m"), &part.position_m);
    findings.finite(format_args!("{path}.heading_rad"), part.heading_rad);
    let inner = Pose { position: at.to_world(&part.position_m.into()), heading: at.heading + part.heading_rad };
    add_parts(&part.outline, &format!("{path}.outline"), &inner, parts, findings);
}

/// What makes corners no simple polygon.
enum Fault {
    /// This corner is the same point as the one before it.
    SamePoint(usize),
    /// The sides from these two corners cross or touch.
    Crossing(usize, usize),
}

fn fault_of(corners: &[Vec2]) -> Option<Fault> {
    let n = corners.len();
    let size = corners.iter().map(|corner| (corner - corners[0]).norm()).fold(0.0, f64::max);
    let repeated = (0..n).find(|at| (corners[*at] - corners[(at + 1) % n]).norm() <= SAME_POINT * size);
    match repeated {
        Some(at) => Some(Fault::SamePoint((at + 1) % n)),
        None => first_crossing(corners).map(|(one, other)| Fault::Crossing(one, other)),
    }
}

fn check_rectangle(corners: &[Vec2], size: &[f64; 2], path: &str, findings: &mut Findings) {
    if fault_of(corners).is_some() {
        findings.report(path, format!("must have no side below {SAME_POINT:e} of the other or of its distance"), pair(size));
    }
}

/// Rules of the `points` of a polygon, which are `corners` in the frame of the body.
fn check_polygon(points: &[[f64; 2]], corners: &[Vec2], path: &str, findings: &mut Findings) {
    let n_before = findings.0.len();
    if points.len() < 3 {
        findings.report(path, "must have at least 3 corners", points.len());
    }
    check_points(points, path, findings);
    if findings.0.len() > n_before || !corners.iter().flatten().all(|value| value.is_finite()) {
        return;
    }
    match fault_of(corners) {
        Some(Fault::SamePoint(at)) => {
            findings.report(format_args!("{path}[{at}]"), "must not be the same point as the corner before it", pair(&points[at]));
        }
        Some(Fault::Crossing(one, other)) => {
            let found = format!("the sides from corners {one} and {other} that do");
            findings.report(path, "must not cross or touch itself", found);
        }
        None => {}
    }
}

/// Rules of the `points` of a polyline, which are `ends` of walls in the frame of the body.
fn check_polyline(points: &[[f64; 2]], ends: &[Vec2], path: &str, findings: &mut Findings) {
    if points.len() < 2 {
        findings.report(path, "must have at least 2 points", points.len());
    }
    check_points(points, path, findings);
    if let Some(at) = (1..points.len()).find(|at| ends[*at] == ends[at - 1]) {
        findings.report(format_args!("{path}[{at}]"), "must not be the same point as the one before it", pair(&points[at]));
    }
}

fn check_points(points: &[[f64; 2]], path: &str, findings: &mut Findings) {
    for (index, point) in points.iter().enumerate() {
        findings.finite_vector(format_args!("{path}[{index}]"), point);
    }
}

fn pair(point: &[f64; 2]) -> String {
    format!("[{}, {}]", number(point[0]), number(point[1]))
}

/// Rule of a coefficient of restitution (1).
pub fn restitution(path: impl Display, found: f64, findings: &mut Findings) {
    findings.require((0.0..=1.0).contains(&found), path, "must be from 0 to 1", found);
}
