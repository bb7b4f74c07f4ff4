//! MJCF models of MuJoCo: the planar part of the geoms of one body.
//!
//! Boxes, cylinders, spheres, capsules and ellipsoids that lie flat are read; meshes and height
//! fields are named as not read. Source: the XML reference of MuJoCo, elements `body` and `geom`.

use cohaul::scenario::{Findings, is_in_range};
use kurbo::{Affine, Point};
use roxmltree::{Document, Node};

use super::flatten;
use super::part::{Found, Part, Shape};

/// Angle between the z axis of a geom and that of the world that counts as rounding (rad).
const FLAT: f64 = 1e-6;

/// What is known while the tree is walked.
struct Reader<'a> {
    /// Radians of the unit of angles.
    angle: f64,
    tolerance: f64,
    findings: &'a mut Findings,
    found: Found,
}

/// Geoms of the body `name`, or of the only one that has any, in metres and in the body's frame.
pub fn read(text: &str, name: Option<&str>, tolerance: f64, findings: &mut Findings) -> Found {
    let document = match Document::parse(text) {
        Ok(document) => document,
        Err(error) => {
            findings.report(format_args!("line {}", error.pos().row), "must be XML", error);
            return Found::default();
        }
    };
    let has_geom = |body: &Node| body.children().any(|child| child.has_tag_name("geom"));
    let bodies: Vec<Node> = document.descendants().filter(|node| node.has_tag_name("body") && has_geom(node)).collect();
    let names = || bodies.iter().map(|body| body.attribute("name").unwrap_or("(without a name)")).collect::<Vec<_>>().join(", ");
    let wanted: Vec<&Node> = bodies.iter().filter(|body| name.is_none_or(|name| body.attribute("name") == Some(name))).collect();
    let [body] = wanted[..] else {
        findings.report(
            "worldbody",
            "must have one body with geoms, or need --body NAME",
            if bodies.is_empty() { "none".into() } else { names() },
        );
        return Found::default();
    };
    let is_degree =
        document.descendants().find(|node| node.has_tag_name("compiler")).and_then(|node| node.attribute("angle")) != Some("radian");
    let angle = if is_degree { 1.0_f64.to_radians() } else { 1.0 };
    let mut reader = Reader { angle, tolerance, findings, found: Found { unit: Some(1.0), ..Found::default() } };
    reader.body(body, Affine::IDENTITY);
    if reader.found.parts.is_empty() && reader.findings.0.is_empty() {
        let left_out = reader.found.left_out.join(", ");
        reader.findings.report("geom", "must have a geom that is read: box, cylinder, sphere, capsule or ellipsoid", left_out);
    }
    reader.found
}

impl Reader<'_> {
    /// Adds the geoms of a body and of the bodies in it.
    fn body(&mut self, body: &Node, at: Affine) {
        for child in body.children() {
            match child.tag_name().name() {
                "geom" => self.geom(&child, at),
                "body" => {
                    if let Some(inner) = self.pose(&child) {
                        self.body(&child, at * inner);
                    }
                }
                _ => {}
            }
        }
    }

    fn geom(&mut self, geom: &Node, at: Affine) {
        let kind = geom.attribute("type").unwrap_or("sphere");
        let number = self.found.parts.len() + 1;
        let name = geom.attribute("name").map_or_else(|| format!("{kind} {number}"), str::to_owned);
        if !["box", "cylinder", "sphere", "capsule", "ellipsoid"].contains(&kind) {
            self.found.left_out.push(format!("{name} of type {kind}"));
            return;
        }
        let (size, fromto) = (self.numbers(geom, "size"), self.numbers(geom, "fromto"));
        let n = match kind {
            "box" | "ellipsoid" => 2,
            _ => 1,
        };
        if size.len() < n || size.iter().take(n).any(|size| *size <= 0.0) {
            self.fault(geom, &format!("must have a size of {n} positive numbers"), geom.attribute("size").unwrap_or("nothing"));
            return;
        }
        if let [x1, y1, z1, x2, y2, z2] = fromto[..] {
            let (a, b) = (at * Point::new(x1, y1), at * Point::new(x2, y2));
            if kind == "capsule" && (z1 - z2).abs() <= FLAT * (a.distance(b) + size[0]) {
                let ring = self.stadium(a, b, size[0]);
                self.found.parts.push(Part::ring(name, ring));
            } else if kind != "box" && a.distance(b) <= FLAT * size[0] {
                self.found.parts.push(Part { name, shape: Shape::Disc { centre: a, radius: size[0] }, is_line: false });
            } else {
                self.fault(geom, "must lie flat, or stand upright", format_args!("a {kind} from {a:?} to {b:?}"));
            }
            return;
        }
        let Some(own) = self.pose(geom) else { return };
        let place = at * own;
        let disc = |radius: f64| Shape::Disc { centre: place * Point::ZERO, radius };
        let shape = match kind {
            "box" => {
                let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
                Shape::Rings {
                    rings: vec![corners.map(|[x, y]| place * Point::new(x * size[0], y * size[1])).to_vec()],
                    is_even_odd: false,
                }
            }
            "ellipsoid" => {
                self.found.n_curves += 1;
                let circle = flatten::circle(Point::ZERO, 1.0, 2.0 * self.tolerance);
                let ring = circle.iter().map(|at| place * Point::new(at.x * size[0], at.y * size[1])).collect();
                Shape::Rings { rings: vec![ring], is_even_odd: false }
            }
            // Cylinders and capsules stand upright: their axis is that of the geom.
            _ => disc(size[0]),
        };
        self.found.parts.push(Part { name, shape, is_line: false });
    }

    /// All points within `radius` of the line from `a` to `b`.
    fn stadium(&mut self, a: Point, b: Point, radius: f64) -> Vec<Point> {
        self.found.n_curves += 2;
        let along = (b - a).atan2();
        let tolerance = self.tolerance * (a.distance(b) + 2.0 * radius);
        let half = |centre, start| flatten::arc(centre, radius, start, std::f64::consts::PI, tolerance);
        [half(b, along - std::f64::consts::FRAC_PI_2), half(a, along + std::f64::consts::FRAC_PI_2)].concat()
    }

    /// The planar pose of an element; `None` if it is turned out of the plane.
    fn pose(&mut self, node: &Node) -> Option<Affine> {
        let position = self.numbers(node, "pos");
        let heading = self.heading(node)?;
        let [x, y] = [0, 1].map(|axis| position.get(axis).copied().unwrap_or(0.0));
        Some(Affine::translate((x, y)) * Affine::rotate(heading))
    }

    /// Turn about the z axis (rad).
    fn heading(&mut self, node: &Node) -> Option<f64> {
        let [quat, euler, axisangle] = ["quat", "euler", "axisangle"].map(|name| self.numbers(node, name));
        let heading = if let [w, x, y, z] = quat[..] {
            ((x * x + y * y).sqrt() <= FLAT).then(|| 2.0 * z.atan2(w))
        } else if let [x, y, z] = euler[..] {
            (x.abs() * self.angle <= FLAT && y.abs() * self.angle <= FLAT).then_some(z * self.angle)
        } else if let [x, y, z, angle] = axisangle[..] {
            (x.hypot(y) <= FLAT * z.abs()).then_some(angle * self.angle * z.signum())
        } else {
            Some(0.0)
        };
        let other = ["xyaxes", "zaxis"].into_iter().find(|name| node.attribute(*name).is_some());
        if heading.is_none() || other.is_some() {
            self.fault(node, "must be turned about the z axis only, by quat, euler or axisangle", other.unwrap_or("another axis"));
            return None;
        }
        heading
    }

    fn numbers(&mut self, node: &Node, name: &str) -> Vec<f64> {
        let text = node.attribute(name).unwrap_or_default();
        let numbers: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok().filter(|value| is_in_range(*value))).collect();
        if numbers.is_none() {
            self.fault(node, &format!("must have numbers of at most 1e50 in {name}"), text);
        }
        numbers.unwrap_or_default()
    }

    fn fault(&mut self, node: &Node, rule: &str, found: impl std::fmt::Display) {
        let line = node.document().text_pos_at(node.range().start).row;
        self.findings.report(format_args!("line {line}, {}", node.tag_name().name()), rule, found);
    }
}
