//! Outlines of loads and obstacles as lines in the plane.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use cohaul::math::{Pose, Vec2, direction};
use cohaul::model::{Outline, OutlinePart};

/// Number of sides of the polygon that stands for a disc (1).
const SIDES: u32 = 72;

/// Points of each part of an outline at a pose, one after another (m, world). Discs and polygons
/// end where they begin.
pub fn edges(outline: &Outline, pose: &Pose) -> Vec<Vec<Vec2>> {
    let of_part = |part: &OutlinePart| match part {
        OutlinePart::Disc { centre, radius } => circle(&pose.to_world(centre), *radius, pose.heading),
        OutlinePart::Polygon { corners } => corners.iter().chain(corners.first()).map(|corner| pose.to_world(corner)).collect(),
        OutlinePart::Polyline { points } => points.iter().map(|point| pose.to_world(point)).collect(),
    };
    outline.parts.iter().map(of_part).collect()
}

/// Points of a circle, the first and the last of them in the direction `heading` (rad).
pub fn circle(centre: &Vec2, radius: f64, heading: f64) -> Vec<Vec2> {
    (0..=SIDES).map(|k| centre + radius * direction(heading + TAU * f64::from(k) / f64::from(SIDES))).collect()
}

/// Distance from the origin along the heading at which an outline ends (m); its extent where the
/// heading meets no edge.
pub fn front(outline: &Outline) -> f64 {
    if let Some(radius) = outline.centred_radius() {
        return radius;
    }
    let edges = edges(outline, &Pose::new(0.0, 0.0, 0.0));
    let crossing = |ends: &[Vec2]| {
        let [a, b] = [ends[0], ends[1]];
        ((a.y <= 0.0) != (b.y <= 0.0)).then(|| a.x - a.y * (b.x - a.x) / (b.y - a.y))
    };
    let crossings = edges.iter().flat_map(|edge| edge.windows(2)).filter_map(crossing);
    let farthest = crossings.fold(0.0, f64::max);
    if farthest > 0.0 { farthest } else { outline.extent() }
}

/// Lines across the inside of a closed `edge`, `distance` apart and turned by 45 degrees (m).
pub fn hatching(edge: &[Vec2], distance: f64) -> Vec<[Vec2; 2]> {
    // Along the lines and across them.
    let turned = |point: &Vec2| FRAC_1_SQRT_2 * Vec2::new(point.x + point.y, point.y - point.x);
    let back = |point: &Vec2| FRAC_1_SQRT_2 * Vec2::new(point.x - point.y, point.x + point.y);
    let edge: Vec<Vec2> = edge.iter().map(turned).collect();
    let (low, high) = edge.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| (low.min(point.y), high.max(point.y)));
    let (first, last) = ((low / distance).ceil(), (high / distance).floor());
    if last - first > MOST_LINES || (last - first).is_nan() {
        return Vec::new();
    }
    let mut lines = Vec::new();
    for k in 0..=(last - first).max(-1.0) as i64 {
        let level = (first + k as f64) * distance;
        let crosses = |ends: &&[Vec2]| (ends[0].y <= level) != (ends[1].y <= level);
        let at = |ends: &[Vec2]| ends[0].x + (level - ends[0].y) * (ends[1].x - ends[0].x) / (ends[1].y - ends[0].y);
        let mut crossings: Vec<f64> = edge.windows(2).filter(crosses).map(at).collect();
        crossings.sort_by(f64::total_cmp);
        lines.extend(crossings.chunks_exact(2).map(|pair| [pair[0], pair[1]].map(|x| back(&Vec2::new(x, level)))));
    }
    lines
}

/// Most lines of a hatching (1). An obstacle that would have more is far larger than what is seen
/// of it, and stays empty.
const MOST_LINES: f64 = 2000.0;

/// A box with sides along the axes: its lower left and upper right corner (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View(pub [Vec2; 2]);

impl View {
    /// The smallest one around these points; `None` without any that is finite.
    pub fn around(points: impl Iterator<Item = Vec2>) -> Option<Self> {
        let finite = points.filter(|point| point.x.is_finite() && point.y.is_finite());
        finite.fold(None, |view: Option<Self>, point| {
            let [low, high] = view.map_or([point; 2], |view| view.0);
            Some(Self([low.inf(&point), high.sup(&point)]))
        })
    }

    /// The box with a `margin` (m) on all sides.
    pub fn widened(self, margin: f64) -> Self {
        let [low, high] = self.0;
        Self([low.add_scalar(-margin), high.add_scalar(margin)])
    }

    /// Part of a segment inside of the box; `None` when all of it is outside.
    pub fn clip(&self, [a, b]: [Vec2; 2]) -> Option<[Vec2; 2]> {
        let (mut from, mut to, way) = (0.0_f64, 1.0_f64, b - a);
        for axis in 0..2 {
            let [low, high] = self.0.map(|corner| corner[axis] - a[axis]);
            if way[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let [one, other] = [low / way[axis], high / way[axis]];
            (from, to) = (from.max(one.min(other)), to.min(one.max(other)));
        }
        let at = |share: f64| if share == 1.0 { b } else { a + share * way };
        (from <= to).then(|| [at(from), at(to)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Vec2> {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]].map(Vec2::from).to_vec()
    }

    /// Lines that are `distance` apart fill an area with their lengths times that distance.
    #[test]
    fn hatching_fills_the_inside() {
        let distance = 1e-3;
        let length: f64 = hatching(&square(), distance).iter().map(|[a, b]| (b - a).norm()).sum();
        // The sum is a rule of first order over two triangles.
        assert!((length * distance - 1.0).abs() < 3.0 * distance, "{length}");
        assert!(hatching(&square(), 1e-6).is_empty());
    }

    #[test]
    fn the_front_is_where_the_heading_leaves_the_outline() {
        assert_eq!(front(&Outline::disc(0.0122)), 0.0122);
        let corners = [[-2.0, -1.0], [3.0, -1.0], [3.0, 1.0], [-2.0, 1.0]].map(Vec2::from).to_vec();
        assert_eq!(front(&Outline { parts: vec![OutlinePart::Polygon { corners }] }), 3.0);
    }

    #[test]
    fn a_view_cuts_lines_at_its_sides() {
        let view = View::around(square().into_iter()).unwrap();
        let line = |a: [f64; 2], b: [f64; 2]| [Vec2::from(a), Vec2::from(b)];
        assert_eq!(view.clip(line([-1.0, 0.5], [3.0, 0.5])), Some(line([0.0, 0.5], [1.0, 0.5])));
        assert_eq!(view.clip(line([-1.0, 1.5], [3.0, 1.5])), None);
        assert_eq!(view.clip(line([0.2, 0.2], [0.4, 0.9])), Some(line([0.2, 0.2], [0.4, 0.9])));
    }
}
