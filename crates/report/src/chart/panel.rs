//! A panel as data: what is drawn, not how.

use crate::chart::thin::Column;

/// One pair of axes and what is in it, in the units of its labels.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    pub x_label: String,
    pub y_label: String,
    pub scale: Scale,
    /// Names that stand at x = 1, 2, ... in place of numbers; empty for an axis of numbers.
    pub x_names: Vec<String>,
    /// Under the curves, in this order.
    pub marks: Vec<Mark>,
    pub curves: Vec<Curve>,
    /// Cuts the y axis above this value.
    pub ceiling: Option<f64>,
    /// A line of text above the axes.
    pub note: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Time to the right, tight; a linear y axis.
    Linear,
    /// As linear, and the y axis contains zero.
    FromZero,
    /// As from zero, for whole numbers.
    Count,
    /// Time to the right, tight; a logarithmic y axis. Values that have no logarithm are gaps.
    Log,
    LogLog,
    /// Both axes linear with the same length for the same number.
    Plane,
}

/// A line through points. A point that is not finite is a gap.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    pub points: Vec<[f64; 2]>,
    /// What the points of a graph stand for, if they are not all there were.
    pub columns: Vec<Column>,
    pub style: Style,
    pub shape: Shape,
}

impl Curve {
    /// A curve with all points that there were.
    pub fn new(points: Vec<[f64; 2]>, style: Style, shape: Shape) -> Self {
        Self { points, columns: Vec::new(), style, shape }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// y over x, straight between points.
    Graph,
    /// y over x, constant up to the next point.
    Steps,
    /// Any line in the plane.
    Path,
    /// As a graph, with a dot at each point.
    Marked,
    /// A cross at each point, and no line.
    Crosses,
    /// A dot at each point, and no line.
    Dots,
    /// The area between pairs of points, the lower end of each first.
    Area,
    /// Nothing: the axes have room for the points.
    Unseen,
}

/// A line across the whole panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    pub at: Across,
    pub style: Style,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Across {
    /// At this x.
    Vertical(f64),
    /// At this y.
    Horizontal(f64),
}

impl Across {
    /// The y of a horizontal line.
    pub fn level(&self) -> Option<f64> {
        match self {
            Across::Horizontal(level) => Some(*level),
            Across::Vertical(_) => None,
        }
    }
}

/// How a line looks. An empty `dash` is a solid line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    pub color: &'static str,
    pub dash: &'static str,
    pub width: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub label: String,
    pub style: Style,
    pub sample: Sample,
}

/// What stands before a label of the legend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    Line,
    /// A line that stands upright, as those that it explains.
    Upright,
    Dot,
}

const DASHES: [&str; 4] = ["", "7 3", "2 2.5", "9 3 2 3"];

impl Style {
    /// The look of trace `index`: the first is widest, so that it shows beside those drawn over it.
    pub fn of_trace(index: usize) -> Self {
        const COLORS: [&str; 4] = ["#0072B2", "#D55E00", "#000000", "#CC79A7"];
        let width = if index == 0 { 2.2 } else { 1.5 };
        Self { color: COLORS[index % COLORS.len()], dash: DASHES[index % DASHES.len()], width }
    }

    /// The look of pair `index`: other colours than those of traces.
    pub fn of_pair(index: usize) -> Self {
        const COLORS: [&str; 3] = ["#009E73", "#E69F00", "#56B4E9"];
        Self { color: COLORS[index % COLORS.len()], dash: DASHES[index % DASHES.len()], width: 1.6 }
    }

    /// The same, thin.
    pub fn thin(self) -> Self {
        Self { width: 1.0, ..self }
    }

    pub const START: Style = Style { color: "#888888", dash: "", width: 1.2 };
    pub const NEST: Style = Style { color: "#009E73", dash: "2 2", width: 1.4 };
    pub const OBSTACLE: Style = Style { color: "#555555", dash: "", width: 1.6 };
    pub const HATCHING: Style = Style { color: "#aaaaaa", dash: "", width: 0.6 };
    pub const OBSTACLE_START: Style = Style { color: "#888888", dash: "3 3", width: 1.0 };
    pub const OBSTACLE_PATH: Style = Style { color: "#888888", dash: "1.5 2.5", width: 1.0 };
    pub const CONTACT: Style = Style { color: "#CC3311", dash: "", width: 1.0 };
    pub const SLIP_LIMIT: Style = Style { color: "#666666", dash: "10 4", width: 1.0 };
    pub const TOLERANCE: Style = Style { color: "#CC3311", dash: "6 3", width: 1.3 };
    pub const GRASP: Style = Style { color: "#999999", dash: "1.5 2.5", width: 0.9 };
    pub const RELEASE: Style = Style { color: "#bbbbbb", dash: "", width: 0.9 };
}

impl Entry {
    pub fn line(label: impl Into<String>, style: Style) -> Self {
        Self { label: label.into(), style, sample: Sample::Line }
    }

    pub fn upright(label: impl Into<String>, style: Style) -> Self {
        Self { label: label.into(), style, sample: Sample::Upright }
    }

    pub fn dot(label: impl Into<String>, style: Style) -> Self {
        Self { label: label.into(), style, sample: Sample::Dot }
    }
}
