//! GeoJSON (RFC 7946): polygons with holes, by themselves, in collections or as features.

use cohaul::scenario::{Findings, is_in_range};
use kurbo::Point;
use serde_json::Value;

use super::part::{Found, Part, Shape};

/// Polygons in the units of the file, which does not state them.
pub fn read(value: &Value, findings: &mut Findings) -> Found {
    let mut found = Found::default();
    add(value, "", "", &mut found, findings);
    if found.parts.is_empty() && findings.0.is_empty() {
        findings.report("type", "must hold a Polygon or a MultiPolygon", "none");
    }
    found
}

fn add(value: &Value, path: &str, name: &str, found: &mut Found, findings: &mut Findings) {
    let kind = value["type"].as_str().unwrap_or_default();
    let list = |key: &str| value[key].as_array().map_or(&[][..], Vec::as_slice);
    match kind {
        "FeatureCollection" | "GeometryCollection" => {
            let key = if kind == "FeatureCollection" { "features" } else { "geometries" };
            list(key).iter().enumerate().for_each(|(at, part)| add(part, &format!("{path}{key}[{at}]."), name, found, findings));
        }
        "Feature" => {
            let name = value["properties"]["name"].as_str().or(value["id"].as_str()).unwrap_or_default();
            add(&value["geometry"], &format!("{path}geometry."), name, found, findings);
        }
        "Polygon" => polygon(list("coordinates"), &format!("{path}coordinates"), name, found, findings),
        "MultiPolygon" => {
            for (at, rings) in list("coordinates").iter().enumerate() {
                let rings = rings.as_array().map_or(&[][..], Vec::as_slice);
                polygon(rings, &format!("{path}coordinates[{at}]"), name, found, findings);
            }
        }
        "Point" | "MultiPoint" | "LineString" | "MultiLineString" => found.left_out.push(format!("a {kind}")),
        other => {
            let rule = "must be Polygon, MultiPolygon, Feature, FeatureCollection or GeometryCollection";
            findings.report(format_args!("{path}type"), rule, if other.is_empty() { "nothing" } else { other });
        }
    }
}

fn polygon(rings: &[Value], path: &str, name: &str, found: &mut Found, findings: &mut Findings) {
    let n_before = findings.0.len();
    let mut all = Vec::new();
    for (at, ring) in rings.iter().enumerate() {
        let points = ring.as_array().map_or(&[][..], Vec::as_slice);
        if points.len() < 4 {
            findings.report(
                format_args!("{path}[{at}]"),
                "must have at least four positions, the last one equal to the first",
                points.len(),
            );
        }
        let point = |(index, point): (usize, &Value)| {
            let [x, y] = [0, 1].map(|axis| point[axis].as_f64().filter(|value| is_in_range(*value)));
            if x.is_none() || y.is_none() {
                findings.report(format_args!("{path}[{at}][{index}]"), "must be two numbers of at most 1e50", point);
            }
            Some(Point::new(x?, y?))
        };
        all.push(points.iter().enumerate().filter_map(point).collect::<Vec<_>>());
    }
    if rings.is_empty() {
        findings.report(path, "must have at least one ring", "none");
    }
    if findings.0.len() == n_before {
        let name = if name.is_empty() { format!("polygon {}", found.parts.len() + 1) } else { name.to_owned() };
        found.parts.push(Part { name, shape: Shape::Rings { rings: all, is_even_odd: true }, is_line: false });
    }
}
