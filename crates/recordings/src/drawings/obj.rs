//! OBJ meshes: the footprint, which is the union of all faces seen along an axis.

use cohaul::scenario::{Findings, is_in_range};
use kurbo::Point;

use super::part::{Found, Part};

/// Most faces (1): their union is a polygon of at most 1000 corners.
const MOST_FACES: usize = 100_000;

/// Faces of a mesh, projected along the z axis, or with `y_up` along the y axis. The unit is that
/// of the file, which does not state it.
pub fn read(text: &str, y_up: bool, findings: &mut Findings) -> Found {
    let mut found = Found::default();
    let mut vertices: Vec<Point> = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let place = format!("line {}", at + 1);
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).filter(|value| is_in_range(*value)).collect();
                match numbers[..] {
                    // Seen from above, x of a mesh with y up goes right and z goes down.
                    [x, _, z, ..] if y_up => vertices.push(Point::new(x, -z)),
                    [x, y, _, ..] => vertices.push(Point::new(x, y)),
                    _ => {
                        findings.report(&place, "must be v and three numbers", line);
                        vertices.push(Point::ZERO);
                    }
                }
            }
            Some("f") => {
                let corners: Option<Vec<Point>> = words.map(|word| corner(word, &vertices)).collect();
                match corners {
                    Some(corners) if corners.len() >= 3 => found.parts.push(Part::ring(format!("face {}", found.parts.len() + 1), corners)),
                    _ => findings.report(&place, "must be f and at least three vertices that stand before it", line),
                }
            }
            _ => {}
        }
        if findings.0.len() > 1000 {
            break;
        }
    }
    if found.parts.is_empty() && findings.0.is_empty() {
        findings.report("f", "must have faces", "none");
    } else if found.parts.len() > MOST_FACES {
        findings.report("f", format!("must have at most {MOST_FACES} faces"), found.parts.len());
    }
    found
}

/// The vertex of `7`, `7/1`, `7//3` or, counted from the end, `-1`.
fn corner(word: &str, vertices: &[Point]) -> Option<Point> {
    let index: i64 = word.split('/').next()?.parse().ok()?;
    let at = if index < 0 { vertices.len() as i64 + index } else { index - 1 };
    vertices.get(usize::try_from(at).ok()?).copied()
}
