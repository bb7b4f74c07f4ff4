//! SVG, read by usvg: paths with all transforms, units and references resolved.

use kurbo::{Affine, BezPath};
use usvg::tiny_skia_path::{PathSegment, Point as SvgPoint};
use usvg::{FillRule, Group, Node, Options, Path, Tree};

use super::flatten;
use super::part::{Found, Part, Shape};

/// Length of a pixel of CSS (m): 96 are an inch.
const PIXEL: f64 = 0.0254 / 96.0;

/// Closed paths of a drawing in pixels of CSS, with curves flattened to `tolerance` of its size.
///
/// # Errors
/// When the text is no SVG.
pub fn read(bytes: &[u8], tolerance: f64) -> Result<Found, String> {
    let text = std::str::from_utf8(bytes).map_err(|error| format!("text in UTF-8, found {error}"))?;
    let document = roxmltree::Document::parse_with_options(text, options()).map_err(|error| format!("XML, found {error}"))?;
    let tree = Tree::from_str(text, &Options::default()).map_err(|error| format!("SVG, found {error}"))?;
    let width = document.root_element().attribute("width").unwrap_or_default().trim().to_lowercase();
    let is_length = ["mm", "cm", "in", "pt", "pc"].iter().any(|unit| width.ends_with(unit));
    let mut found = Found { unit: is_length.then_some(PIXEL), y_down: true, ..Found::default() };
    let bounds = tree.root().abs_bounding_box();
    let size = f64::from(bounds.width().max(bounds.height()));
    add_group(tree.root(), tolerance * size, &mut found);
    let not_drawn = ["text", "image"]
        .map(|kind| (kind, document.descendants().filter(|node| node.has_tag_name(kind) || node.tag_name().name() == kind).count()));
    found.left_out.extend(not_drawn.iter().filter(|(_, n)| *n > 0).map(|(kind, n)| format!("{n} of kind {kind}")));
    const SHAPES: [&str; 7] = ["path", "rect", "circle", "ellipse", "polygon", "polyline", "line"];
    let n_shapes = document.descendants().filter(|node| SHAPES.contains(&node.tag_name().name())).count();
    let n_drawn = n_paths(tree.root());
    if n_drawn < n_shapes {
        found.left_out.push(format!("{} shapes that are not drawn", n_shapes - n_drawn));
    }
    Ok(found)
}

/// Entities of XML may grow without bound.
fn options<'a>() -> roxmltree::ParsingOptions<'a> {
    roxmltree::ParsingOptions { allow_dtd: true, nodes_limit: 1_000_000, ..roxmltree::ParsingOptions::default() }
}

fn n_paths(group: &Group) -> usize {
    let of_node = |node: &Node| match node {
        Node::Group(group) => n_paths(group),
        Node::Path(_) => 1,
        Node::Image(_) | Node::Text(_) => 0,
    };
    group.children().iter().map(of_node).sum()
}

fn add_group(group: &Group, tolerance: f64, found: &mut Found) {
    for node in group.children() {
        match node {
            Node::Group(group) => add_group(group, tolerance, found),
            Node::Path(path) => add_path(path, tolerance, found),
            Node::Image(_) | Node::Text(_) => {}
        }
    }
}

/// Adds the closed rings of a path. A filled path is closed; a line is if its ends meet.
fn add_path(path: &Path, tolerance: f64, found: &mut Found) {
    let name = if path.id().is_empty() { format!("path {}", found.parts.len() + 1) } else { path.id().to_owned() };
    let transform = path.abs_transform();
    let affine = Affine::new([transform.sx, transform.ky, transform.kx, transform.sy, transform.tx, transform.ty].map(f64::from));
    let (mut bezier, mut n_curves) = (BezPath::new(), 0);
    let point = |at: SvgPoint| kurbo::Point::new(at.x.into(), at.y.into());
    for segment in path.data().segments() {
        match segment {
            PathSegment::MoveTo(at) => bezier.move_to(point(at)),
            PathSegment::LineTo(at) => bezier.line_to(point(at)),
            PathSegment::QuadTo(a, at) => bezier.quad_to(point(a), point(at)),
            PathSegment::CubicTo(a, b, at) => bezier.curve_to(point(a), point(b), point(at)),
            PathSegment::Close => bezier.close_path(),
        }
        n_curves += usize::from(matches!(segment, PathSegment::QuadTo(..) | PathSegment::CubicTo(..)));
    }
    let is_filled = path.fill().is_some();
    let mut rings = Vec::new();
    for (points, is_closed) in flatten::path(&(affine * bezier), tolerance) {
        let meets = points.len() > 2 && points.first().zip(points.last()).is_some_and(|(a, b)| a.distance(*b) <= tolerance);
        if is_closed || is_filled || meets { rings.push(points) } else { found.left_out.push(format!("{name}, an open line")) }
    }
    if !rings.is_empty() {
        found.n_curves += n_curves;
        let is_even_odd = path.fill().is_none_or(|fill| fill.rule() == FillRule::EvenOdd);
        found.parts.push(Part { name, shape: Shape::Rings { rings, is_even_odd }, is_line: !is_filled });
    }
}
