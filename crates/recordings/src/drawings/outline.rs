//! Parts of a drawing as one outline about its centroid.

use cohaul::math::Vec2;
use cohaul::model::geometry::moments_of_polygon;
use cohaul::scenario::Findings;
use cohaul::scenario::format::{CompoundEntry, DiscEntry, OutlineEntry, PartEntry, PolygonEntry};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::simplify::SimplifyShape;
use i_overlay::float::single::SingleFloatOverlay;
use kurbo::Point;

use super::flatten;
use super::part::{Part, Shape};
use crate::account::{Account, Kind, Note, Place};

/// A ring of corners (m).
type Ring = Vec<[f64; 2]>;
/// A ring and the holes in it.
type Region = Vec<Ring>;

/// An outline about its centroid.
#[derive(Clone, Debug)]
pub struct Outlined {
    pub entry: OutlineEntry,
    /// Centroid of the drawing (m), which is the origin of the outline.
    pub centroid: Vec2,
    /// Area (m^2).
    pub area: f64,
}

/// Distance of neighbouring corners over the size of the outline that is one point (1), as the
/// rules of a scenario have it.
const SAME_POINT: f64 = 1e-9;
/// Area over the square of the size that is nothing (1): slivers of rounding.
const SLIVER: f64 = 1e-12;
/// Most parts of a drawing (1).
const MOST_PARTS: usize = 100_000;
/// Most lines that may lie within each other (1): each pair of them is compared.
const MOST_LINES: usize = 300;

/// The outline that parts in metres enclose together, with its centroid as origin. A single disc
/// stays a disc. Lines within lines are holes, other parts are joined. An outline is cut through
/// its holes. Discs beside others become polygons within `tolerance` (m).
pub fn outline(parts: &[Part], tolerance: f64, findings: &mut Findings, account: &mut Account) -> Option<Outlined> {
    if parts.is_empty() || parts.len() > MOST_PARTS {
        findings.report("drawing", format!("must have from 1 to {MOST_PARTS} closed shapes"), parts.len());
        return None;
    }
    if let [Part { shape: Shape::Disc { centre, radius }, .. }] = parts {
        let entry = OutlineEntry::Disc(DiscEntry { radius_m: *radius });
        let centroid = Vec2::new(centre.x, centre.y);
        shifted(centroid, size(parts), account);
        return Some(Outlined { entry, centroid, area: std::f64::consts::PI * radius * radius });
    }
    let regions = regions(parts, tolerance, findings, account)?;
    let pieces: Vec<Ring> = regions.into_iter().flat_map(|region| without_holes(region, account)).collect();
    let all: Vec<Vec<Vec2>> = pieces.iter().map(|ring| ring.iter().map(|[x, y]| Vec2::new(*x, *y)).collect()).collect();
    let (mut area, mut first) = (0.0, Vec2::zeros());
    for corners in &all {
        let moments = moments_of_polygon(corners);
        area += moments.area;
        first += moments.first;
    }
    if !(area > 0.0 && area.is_finite()) {
        findings.report("drawing", "must enclose an area", format_args!("{area} m^2"));
        return None;
    }
    let centroid: Vec2 = first / area;
    shifted(centroid, size(parts), account);
    let polygon = |ring: &Vec<Vec2>| {
        OutlineEntry::Polygon(PolygonEntry { points_m: ring.iter().map(|corner| <[f64; 2]>::from(corner - centroid)).collect() })
    };
    let entry = match &all[..] {
        [one] => polygon(one),
        _ => {
            let part = |ring| PartEntry { outline: polygon(ring), position_m: [0.0; 2], heading_rad: 0.0 };
            OutlineEntry::Compound(CompoundEntry { parts: all.iter().map(part).collect() })
        }
    };
    Some(Outlined { entry, centroid, area })
}

/// Notes the shift of the origin, unless it is rounding.
fn shifted(centroid: Vec2, size: f64, account: &mut Account) {
    if centroid.norm() > SAME_POINT * size {
        let text = format!("origin, moved to the centroid, [{:.6e}, {:.6e}] m in the drawing", centroid.x, centroid.y);
        account.add(Note::new(Kind::Moved, 1, text).sized(Some(centroid.norm()), None, "m"));
    }
}

/// What all parts enclose, with holes.
fn regions(parts: &[Part], tolerance: f64, findings: &mut Findings, account: &mut Account) -> Option<Vec<Region>> {
    let size = size(parts);
    let mut all: Vec<(bool, Vec<Region>)> = Vec::new();
    let mut n_repeated = 0;
    for part in parts {
        let (rings, is_even_odd) = match &part.shape {
            Shape::Disc { centre, radius } => (vec![flatten::circle(*centre, *radius, tolerance)], false),
            Shape::Rings { rings, is_even_odd } => (rings.clone(), *is_even_odd),
        };
        let rings: Vec<Ring> = rings.iter().map(|ring| cleaned(ring, SAME_POINT * size, &mut n_repeated)).collect();
        let rings: Vec<Ring> = rings.into_iter().filter(|ring| area(ring).abs() > SLIVER * size * size).map(counter_clockwise).collect();
        match &rings[..] {
            [] => {}
            [_] => all.push((part.is_line, vec![rings])),
            _ => {
                let rule = if is_even_odd { FillRule::EvenOdd } else { FillRule::NonZero };
                all.push((part.is_line, rings.simplify_shape_as::<i64>(rule)));
            }
        }
    }
    account.add(Note::new(Kind::Repeated, n_repeated, "corners that stand twice, as the last one of a closed ring"));
    if let [(_, region)] = &all[..] {
        // A single ring keeps its corners to the last digit.
        return Some(region.clone());
    }
    let (lines, solids): (Vec<_>, Vec<_>) = all.into_iter().partition(|(is_line, _)| *is_line);
    if lines.len() > MOST_LINES {
        findings.report("drawing", format!("must have at most {MOST_LINES} closed lines"), lines.len());
        return None;
    }
    let lines: Vec<Vec<Region>> = lines.into_iter().map(|(_, regions)| regions).collect();
    let depth = |at: usize| (0..lines.len()).filter(|other| *other != at && is_within(&lines[at], &lines[*other])).count();
    let (outer, inner): (Vec<usize>, Vec<usize>) = (0..lines.len()).partition(|at| depth(*at) % 2 == 0);
    let gather = |indices: &[usize]| indices.iter().flat_map(|at| lines[*at].clone()).collect::<Vec<Region>>();
    let mut joined: Vec<Region> = gather(&outer);
    joined.extend(solids.into_iter().flat_map(|(_, regions)| regions));
    let n = joined.len();
    let mut joined = joined.simplify_shape_as::<i64>(FillRule::NonZero);
    account.add(Note::new(Kind::Joined, n - n.min(joined.len()), "parts that touch or overlap others, joined to their union"));
    if !inner.is_empty() {
        joined = joined.overlay_as::<i64>(&gather(&inner), OverlayRule::Difference, FillRule::NonZero);
    }
    joined.retain(|region| region.first().is_some_and(|outer| area(outer).abs() > SLIVER * size * size));
    Some(joined)
}

/// Whether nothing of `inner` lies outside of `outer`.
fn is_within(inner: &[Region], outer: &[Region]) -> bool {
    inner.to_vec().overlay_as::<i64>(&outer.to_vec(), OverlayRule::Difference, FillRule::NonZero).is_empty()
}

/// The region as rings without holes: it is cut along an upright line through each hole.
fn without_holes(region: Region, account: &mut Account) -> Vec<Ring> {
    let Some((outer, holes)) = region.split_first() else { return Vec::new() };
    let places = holes.iter().map(|hole| {
        let [x, y] = middle(hole);
        Place { name: format!("{} corners about [{x:.6}, {y:.6}] m, {:.4e} m^2", hole.len(), area(hole).abs()), time_s: None }
    });
    let note = Note::new(Kind::Holes, holes.len(), "holes, through which the outline is cut");
    account.add(Note { places: places.collect(), ..note });
    let [low, high] = bounds(outer);
    let mut pieces = vec![region.clone()];
    for hole in holes {
        let [cut, _] = middle(hole);
        let half = |from: f64, to: f64| vec![[from, low[1] - 1.0], [to, low[1] - 1.0], [to, high[1] + 1.0], [from, high[1] + 1.0]];
        let (left, right) = (half(low[0] - 1.0, cut), half(cut, high[0] + 1.0));
        let cut_by = |piece: &Region, half: &Ring| piece.overlay_as::<i64>(half, OverlayRule::Intersect, FillRule::EvenOdd);
        pieces = pieces.iter().flat_map(|piece| [cut_by(piece, &left), cut_by(piece, &right)].concat()).collect();
    }
    // A cut through the middle opens every hole; what is left of one is none.
    pieces.into_iter().filter_map(|piece| piece.into_iter().next()).filter(|ring| ring.len() > 2).collect()
}

/// Corners without those that stand twice.
fn cleaned(ring: &[Point], near: f64, n_repeated: &mut usize) -> Ring {
    let mut kept: Vec<Point> = Vec::new();
    for point in ring {
        if kept.last().is_none_or(|last| last.distance(*point) > near) {
            kept.push(*point);
        }
    }
    while kept.len() > 1 && kept[0].distance(kept[kept.len() - 1]) <= near {
        kept.pop();
    }
    *n_repeated += ring.len() - kept.len();
    kept.into_iter().map(|point| [point.x, point.y]).collect()
}

fn counter_clockwise(mut ring: Ring) -> Ring {
    if area(&ring) < 0.0 {
        ring.reverse();
    }
    ring
}

/// Signed area of a ring, positive counter-clockwise (m^2).
fn area(ring: &[[f64; 2]]) -> f64 {
    let Some(&[x0, y0]) = ring.first() else { return 0.0 };
    let next = ring.iter().cycle().skip(1);
    0.5 * ring.iter().zip(next).map(|(a, b)| (a[0] - x0) * (b[1] - y0) - (b[0] - x0) * (a[1] - y0)).sum::<f64>()
}

fn bounds(ring: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let fold = |of: fn(f64, f64) -> f64, axis: usize| ring.iter().map(|point| point[axis]).reduce(of).unwrap_or(0.0);
    [[fold(f64::min, 0), fold(f64::min, 1)], [fold(f64::max, 0), fold(f64::max, 1)]]
}

fn middle(ring: &[[f64; 2]]) -> [f64; 2] {
    let [low, high] = bounds(ring);
    [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]))
}

/// Largest extent of all parts (m).
pub fn size(parts: &[Part]) -> f64 {
    let corners: Vec<[f64; 2]> = parts.iter().flat_map(Part::corners).map(|point| [point.x, point.y]).collect();
    let [low, high] = bounds(&corners);
    (high[0] - low[0]).max(high[1] - low[1])
}
