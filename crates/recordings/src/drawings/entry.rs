//! Outlines of scenarios as parts: rings that close twice, overlapping parts, any origin.

use cohaul::math::{Pose, Vec2};
use cohaul::scenario::format::OutlineEntry;
use kurbo::Point;

use super::part::{Found, Part, Shape};

/// Parts of an outline whose frame is at the pose `at`.
pub fn add(entry: &OutlineEntry, at: &Pose, found: &mut Found) {
    let number = found.parts.len() + 1;
    let placed = |[x, y]: [f64; 2]| {
        let point: Vec2 = at.to_world(&Vec2::new(x, y));
        Point::new(point.x, point.y)
    };
    match entry {
        OutlineEntry::Disc(disc) => {
            let shape = Shape::Disc { centre: placed([0.0, 0.0]), radius: disc.radius_m };
            found.parts.push(Part { name: format!("disc {number}"), shape, is_line: false });
        }
        OutlineEntry::Rectangle(rectangle) => {
            let [x, y] = rectangle.size_m.map(|length| 0.5 * length);
            let ring = [[-x, -y], [x, -y], [x, y], [-x, y]].map(placed).to_vec();
            found.parts.push(Part::ring(format!("rectangle {number}"), ring));
        }
        OutlineEntry::Polygon(polygon) => {
            found.parts.push(Part::ring(format!("polygon {number}"), polygon.points_m.iter().map(|point| placed(*point)).collect()));
        }
        OutlineEntry::Polyline(_) => found.left_out.push("a polyline, which encloses nothing".to_owned()),
        OutlineEntry::Compound(compound) => {
            for part in &compound.parts {
                let [x, y] = part.position_m;
                let position: Vec2 = at.to_world(&Vec2::new(x, y));
                add(&part.outline, &Pose { position, heading: at.heading + part.heading_rad }, found);
            }
        }
    }
}
