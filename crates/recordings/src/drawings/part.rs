//! What all readers give: parts of a drawing in the units of the file.

use kurbo::Point;

/// A closed part of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Name in the drawing, or its kind and number.
    pub name: String,
    pub shape: Shape,
    /// Whether the part is drawn as a line: one line within another is then a hole.
    pub is_line: bool,
}

/// The shape of a part.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    Disc {
        centre: Point,
        radius: f64,
    },
    /// Closed rings. What they enclose is said by the non-zero rule, or by the even-odd one.
    Rings {
        rings: Vec<Vec<Point>>,
        is_even_odd: bool,
    },
}

/// All that a reader found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    pub parts: Vec<Part>,
    /// Length of the unit of the file (m); `None` if the file does not say.
    pub unit: Option<f64>,
    /// Whether the y axis points down.
    pub y_down: bool,
    /// Curves that were replaced by straight lines (1).
    pub n_curves: usize,
    /// Shapes that are not read, with the reason.
    pub left_out: Vec<String>,
}

impl Part {
    /// A part of one ring.
    pub fn ring(name: impl Into<String>, ring: Vec<Point>) -> Self {
        Self { name: name.into(), shape: Shape::Rings { rings: vec![ring], is_even_odd: false }, is_line: false }
    }

    /// Corners of the part, or of the square about a disc.
    pub fn corners(&self) -> Vec<Point> {
        match &self.shape {
            Shape::Disc { centre, radius } => {
                [[-1.0, -1.0], [1.0, 1.0]].map(|[x, y]| Point::new(centre.x + x * radius, centre.y + y * radius)).to_vec()
            }
            Shape::Rings { rings, .. } => rings.concat(),
        }
    }
}
