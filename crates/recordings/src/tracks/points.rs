//! What all readers give: points of a file in the units of the file.

/// What counts the time of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// Seconds.
    Seconds,
    /// Numbers of frames of a camera.
    Frames,
}

/// Unit of angles in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AngleUnit {
    Radians,
    Degrees,
    /// The file does not say.
    #[default]
    Unknown,
}

/// Unit of lengths in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LengthUnit {
    /// So many metres.
    Metres(f64),
    /// Pixels of a camera.
    Pixels,
    /// The file does not say.
    #[default]
    Unknown,
}

/// One thing in one frame.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Line of the file, from 1.
    pub line: u64,
    /// Time (s) or number of the frame.
    pub clock: f64,
    /// Index of the name of the thing.
    pub name: usize,
    /// Position; `None` where the thing was not seen.
    pub position: Option<[f64; 2]>,
    pub heading: Option<f64>,
    pub confidence: Option<f64>,
    /// Whether a tip is let go here.
    pub is_release: bool,
}

/// All points of a file.
#[derive(Clone, Debug)]
pub struct Points {
    pub file: String,
    pub clock: Clock,
    pub length: LengthUnit,
    pub angle: AngleUnit,
    /// Whether the y axis points down, as in images.
    pub y_down: bool,
    /// Names of the things that points belong to.
    pub names: Vec<String>,
    pub points: Vec<Point>,
    /// Pose of the load in columns of its own. The names of these points mean nothing.
    pub load: Vec<Point>,
    /// Whether names are indices of springs.
    pub are_springs: bool,
    /// Rows of numbers (1).
    pub n_rows: usize,
    /// Names of columns that were not used.
    pub left_out: Vec<String>,
    /// Numbers with a comma in place of the point (1).
    pub n_decimal_commas: usize,
}

impl Points {
    pub fn new(file: &str, clock: Clock) -> Self {
        Self {
            file: file.to_owned(),
            clock,
            length: LengthUnit::Unknown,
            angle: AngleUnit::Unknown,
            y_down: false,
            names: Vec::new(),
            points: Vec::new(),
            load: Vec::new(),
            are_springs: false,
            n_rows: 0,
            left_out: Vec::new(),
            n_decimal_commas: 0,
        }
    }
}
