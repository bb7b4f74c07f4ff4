//! DXF: LWPOLYLINE and POLYLINE with bulges, chains of LINE and ARC, and CIRCLE.
//!
//! The text is pairs of lines, a group code and a value (AutoCAD 2012 DXF Reference). It is read
//! here and not by a crate, so that faults name their lines.

use std::collections::BTreeMap;

use cohaul::scenario::{Findings, is_in_range};
use kurbo::Point;

use super::flatten;
use super::part::{Found, Part, Shape};

/// Group code and value, with the line of the value.
type Pair<'a> = (i64, &'a str, usize);

/// Lengths of the units of `$INSUNITS` (m).
const UNITS: [(i64, f64); 6] = [(1, 0.0254), (2, 0.3048), (4, 1e-3), (5, 1e-2), (6, 1.0), (13, 1e-6)];
/// Gap between the ends of two lines that belong together, over the size of the drawing (1).
const SAME_POINT: f64 = 1e-6;
/// Most lines and arcs that are joined to chains (1): each pair of ends is compared.
const MOST_EDGES: usize = 5000;

/// One entity with its pairs.
struct Entity<'a> {
    kind: &'a str,
    pairs: Vec<Pair<'a>>,
    line: usize,
}

/// Closed parts of a drawing, with curves flattened to `tolerance` of its size.
pub fn read(text: &str, tolerance: f64, findings: &mut Findings) -> Found {
    let pairs = pairs(text, findings);
    let mut found = Found::default();
    let units = pairs.windows(2).find(|pair| pair[0].0 == 9 && pair[0].1 == "$INSUNITS").and_then(|pair| pair[1].1.parse().ok());
    found.unit = units.and_then(|code: i64| UNITS.iter().find(|(known, _)| *known == code).map(|(_, unit)| *unit));
    let entities = entities(&pairs);
    if entities.is_empty() {
        findings.report("ENTITIES", "must hold polylines, lines, arcs or circles", "nothing");
    }
    let tolerance = tolerance * size(&entities);
    let (mut edges, mut others): (Vec<Vec<Point>>, BTreeMap<&str, usize>) = (Vec::new(), BTreeMap::new());
    let mut at = 0;
    while at < entities.len() {
        let entity = &entities[at];
        at += 1;
        match entity.kind {
            "LWPOLYLINE" => polyline(entity, &vertices(&entity.pairs, findings), tolerance, &mut edges, &mut found),
            "POLYLINE" => {
                let n = entities[at..].iter().take_while(|entity| entity.kind == "VERTEX").count();
                let corners: Vec<_> = entities[at..at + n].iter().flat_map(|vertex| vertices(&vertex.pairs, findings)).collect();
                at += n;
                polyline(entity, &corners, tolerance, &mut edges, &mut found);
            }
            "LINE" => edges.extend(entity.point(10, 20, findings).zip(entity.point(11, 21, findings)).map(|(a, b)| vec![a, b])),
            "ARC" => edges.extend(arc(entity, tolerance, &mut found, findings)),
            "CIRCLE" => {
                let centre = entity.point(10, 20, findings);
                if let Some((centre, radius)) = centre.zip(entity.radius(findings)) {
                    let name = format!("circle {}", found.parts.len() + 1);
                    found.parts.push(Part { name, shape: Shape::Disc { centre, radius }, is_line: true });
                }
            }
            "SEQEND" | "VERTEX" => {}
            other => *others.entry(other).or_default() += 1,
        }
    }
    found.left_out.extend(others.iter().map(|(kind, n)| format!("{n} of kind {kind}")));
    chains(edges, &entities, &mut found, findings);
    found
}

/// Pairs of group codes and values.
fn pairs<'a>(text: &'a str, findings: &mut Findings) -> Vec<Pair<'a>> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let mut found = Vec::new();
    for (at, pair) in lines.chunks(2).enumerate() {
        match (pair[0].parse(), pair.get(1)) {
            (Ok(code), Some(value)) => found.push((code, *value, 2 * at + 2)),
            (Err(_), None) if pair[0].is_empty() => {}
            (Ok(0), None) => {}
            _ => {
                findings.report(
                    format_args!("line {}", 2 * at + 1),
                    "must be a group code, a whole number, with a value below it",
                    pair[0],
                );
                break;
            }
        }
    }
    found
}

/// Entities of the section ENTITIES; all of them in a text without sections.
fn entities<'a>(pairs: &[Pair<'a>]) -> Vec<Entity<'a>> {
    let begin = pairs.windows(2).position(|pair| pair[0].1 == "SECTION" && pair[1].1 == "ENTITIES").map_or(0, |at| at + 2);
    let mut found: Vec<Entity> = Vec::new();
    for (code, value, line) in &pairs[begin..] {
        match (code, *value) {
            (0, "ENDSEC" | "EOF") => break,
            (0, kind) => found.push(Entity { kind, pairs: Vec::new(), line: *line }),
            _ => {
                if let Some(entity) = found.last_mut() {
                    entity.pairs.push((*code, value, *line));
                }
            }
        }
    }
    found.retain(|entity| entity.kind != "SECTION");
    found
}

/// Largest extent of all points (1).
fn size(entities: &[Entity]) -> f64 {
    let of = |codes: [i64; 2]| {
        let values = entities.iter().flat_map(|entity| &entity.pairs).filter(|(code, _, _)| codes.contains(code));
        let values = values.filter_map(|(_, value, _)| value.parse::<f64>().ok()).filter(|value| is_in_range(*value));
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
    };
    let radius = entities.iter().filter(|entity| matches!(entity.kind, "CIRCLE" | "ARC")).flat_map(|entity| &entity.pairs);
    let radius = radius.filter(|(code, _, _)| *code == 40).filter_map(|(_, value, _)| value.parse::<f64>().ok());
    let size = [of([10, 11]), of([20, 21])].map(|[low, high]| high - low).into_iter().chain(radius.map(|radius| 2.0 * radius));
    size.filter(|size| is_in_range(*size)).fold(0.0, f64::max)
}

fn number(pair: &Pair, findings: &mut Findings) -> Option<f64> {
    let value = pair.1.parse().ok().filter(|value| is_in_range(*value));
    if value.is_none() {
        findings.report(format_args!("line {}", pair.2), &*format!("must be a number of at most 1e50 for group code {}", pair.0), pair.1);
    }
    value
}

impl Entity<'_> {
    fn value(&self, code: i64, findings: &mut Findings) -> Option<f64> {
        match self.pairs.iter().find(|(found, _, _)| *found == code) {
            Some(pair) => number(pair, findings),
            None => {
                findings.report(format_args!("line {}", self.line), format!("must have the group code {code}"), self.kind);
                None
            }
        }
    }

    fn point(&self, x: i64, y: i64, findings: &mut Findings) -> Option<Point> {
        Some(Point::new(self.value(x, findings)?, self.value(y, findings)?))
    }

    fn radius(&self, findings: &mut Findings) -> Option<f64> {
        let radius = self.value(40, findings)?;
        if radius <= 0.0 {
            findings.report(format_args!("line {}", self.line), "must have a positive radius", radius);
        }
        Some(radius).filter(|radius| *radius > 0.0)
    }

    /// Name of the layer.
    fn layer(&self) -> &str {
        self.pairs.iter().find(|(code, _, _)| *code == 8).map_or("", |(_, layer, _)| layer)
    }
}

/// Corners with their bulges.
fn vertices(pairs: &[Pair], findings: &mut Findings) -> Vec<(Point, f64)> {
    let mut found: Vec<(Point, f64)> = Vec::new();
    for pair in pairs.iter().filter(|(code, _, _)| [10, 20, 42].contains(code)) {
        let Some(value) = number(pair, findings) else { continue };
        match (pair.0, found.last_mut()) {
            (10, _) => found.push((Point::new(value, 0.0), 0.0)),
            (20, Some((point, _))) => point.y = value,
            (42, Some((_, bulge))) => *bulge = value,
            _ => findings.report(format_args!("line {}", pair.2), "must stand after the x of a corner, group code 10", pair.0),
        }
    }
    found
}

/// A polyline: a part if it is closed, and otherwise an edge of a chain.
fn polyline(entity: &Entity, corners: &[(Point, f64)], tolerance: f64, edges: &mut Vec<Vec<Point>>, found: &mut Found) {
    let is_closed = entity.pairs.iter().any(|(code, flags, _)| *code == 70 && flags.parse::<i64>().is_ok_and(|flags| flags & 1 == 1));
    let Some((first, _)) = corners.first() else { return };
    let mut points = vec![*first];
    for (at, (from, bulge)) in corners.iter().enumerate() {
        let next = match corners.get(at + 1) {
            Some((next, _)) => next,
            None if is_closed => first,
            None => break,
        };
        points.extend(flatten::bulge(*from, *next, *bulge, tolerance));
        found.n_curves += usize::from(*bulge != 0.0);
    }
    if is_closed || (points.len() > 3 && points.last() == Some(first)) {
        let layer = entity.layer();
        let name = format!("polyline {}{}", found.parts.len() + 1, if layer.is_empty() { String::new() } else { format!(" on {layer}") });
        found.parts.push(Part { is_line: true, ..Part::ring(name, points) });
    } else {
        edges.push(points);
    }
}

fn arc(entity: &Entity, tolerance: f64, found: &mut Found, findings: &mut Findings) -> Option<Vec<Point>> {
    let (centre, radius) = (entity.point(10, 20, findings)?, entity.radius(findings)?);
    let [start, end] = [entity.value(50, findings)?, entity.value(51, findings)?].map(f64::to_radians);
    found.n_curves += 1;
    // Arcs go counter-clockwise.
    let sweep = (end - start).rem_euclid(std::f64::consts::TAU);
    Some(flatten::arc(centre, radius, start, if sweep == 0.0 { std::f64::consts::TAU } else { sweep }, tolerance))
}

/// Joins edges whose ends meet to closed rings.
fn chains(mut edges: Vec<Vec<Point>>, entities: &[Entity], found: &mut Found, findings: &mut Findings) {
    if edges.len() > MOST_EDGES {
        findings.report("ENTITIES", format!("must have at most {MOST_EDGES} lines and arcs: join them to polylines"), edges.len());
        return;
    }
    let near = SAME_POINT * size(entities);
    while let Some(mut chain) = edges.pop() {
        loop {
            let (first, last) = (chain[0], chain[chain.len() - 1]);
            if chain.len() > 2 && first.distance(last) <= near {
                found.parts.push(Part { is_line: true, ..Part::ring(format!("chain {}", found.parts.len() + 1), chain) });
                break;
            }
            let meets = |edge: &Vec<Point>| edge[0].distance(last) <= near || edge[edge.len() - 1].distance(last) <= near;
            match edges.iter().position(meets) {
                Some(at) => {
                    let mut next = edges.swap_remove(at);
                    if next[0].distance(last) > near {
                        next.reverse();
                    }
                    chain.extend(next.into_iter().skip(1));
                }
                None => {
                    found.left_out.push(format!("an open line from [{}, {}]", first.x, first.y));
                    break;
                }
            }
        }
    }
}
