//! Recorded tip positions: in the frame of the root, or in world axes together with the pose of the
//! load.

use cohaul::math::{Pose, Vec2};
use cohaul::scenario::ScenarioError;
use cohaul_studies::csv_input::Table;

/// Columns of a recording: the first two, then either the next two or the five after them. The last
/// one may be left out.
const COLUMNS: [&str; 10] =
    ["time_s", "spring", "tip_in_root_x_m", "tip_in_root_y_m", "x_m", "y_m", "heading_rad", "tip_x_m", "tip_y_m", EVENT];
const EVENT: &str = "event";
/// The only event: the tip is let go where it is.
pub const RELEASE: &str = "release";
const IN_ROOT: std::ops::Range<usize> = 2..4;
const IN_WORLD: std::ops::Range<usize> = 4..9;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tip {
    /// From the root, x along the undeformed spring (m).
    InRoot(Vec2),
    /// In world axes (m), with the pose of the load.
    InWorld { load: Pose, tip: Vec2 },
}

/// Position of an attached tip in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// (s)
    pub time: f64,
    pub spring: usize,
    pub tip: Tip,
}

/// Samples in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    pub samples: Vec<Sample>,
}

/// Largest distance from root to tip in rest lengths (1). A larger one has another unit.
const LONGEST: f64 = 100.0;

impl Recording {
    pub fn is_in_world(&self) -> bool {
        self.samples.iter().any(|sample| matches!(sample.tip, Tip::InWorld { .. }))
    }

    pub fn n_frames(&self) -> usize {
        self.samples.chunk_by(|one, next| one.time == next.time).count()
    }

    /// Reads a recording of `n_springs` springs, or of any number, with about this rest length (m),
    /// and the tips that were let go, in the order of time; `None` without a column for them.
    /// `file` is the name of the text in errors.
    ///
    /// # Errors
    /// When any row cannot be the position of a tip.
    pub fn with_releases(
        text: &str,
        file: &str,
        n_springs: Option<usize>,
        rest_length: f64,
    ) -> Result<(Self, Option<Vec<Sample>>), ScenarioError> {
        let mut table = Table::parse(text, file, &COLUMNS)?;
        table.require(&COLUMNS[..2]);
        let is_in_root = table.has(COLUMNS[2]) || table.has(COLUMNS[3]);
        table.require(&COLUMNS[if is_in_root { IN_ROOT } else { IN_WORLD }]);
        if is_in_root && COLUMNS[IN_WORLD].iter().any(|name| table.has(name)) {
            table.report("header", "must have tips in the root's frame or in world axes", "both");
        }
        let mut table = table.whole()?;
        let mut samples: Vec<Sample> = Vec::with_capacity(table.n_rows());
        let mut releases = table.has(EVENT).then(Vec::new);
        for row in 0..table.n_rows() {
            let Some(sample) = sample(&mut table, row, is_in_root) else { continue };
            if n_springs.is_some_and(|n| sample.spring >= n) {
                table.at(row, "spring", &format!("must be below {}, the number of springs", n_springs.unwrap_or(0)), sample.spring);
            }
            if samples.last().is_some_and(|last| sample.time < last.time) {
                table.at(row, "time_s", "must not go back", sample.time);
            }
            if is_release(&mut table, row) {
                releases.iter_mut().for_each(|releases| releases.push(sample));
                continue;
            }
            let same_frame = samples.iter().rev().take_while(|other| other.time == sample.time);
            if same_frame.into_iter().any(|other| other.spring == sample.spring) {
                table.at(row, "spring", "must stand once in a frame", sample.spring);
            }
            if sample.tip.distance() > LONGEST * rest_length {
                let column = if is_in_root { COLUMNS[2] } else { "tip_x_m" };
                let rule = format!(
                    "must lie within {LONGEST} rest lengths, {:.3} m, of its root (is it in millimetres? divide by 1000)",
                    LONGEST * rest_length
                );
                table.at(row, column, &rule, format!("{:.4} m", sample.tip.distance()));
            }
            samples.push(sample);
        }
        if table.n_rows() == 0 {
            table.report("rows", "must hold tips", "none");
        }
        table.whole()?;
        Ok((Self { samples }, releases))
    }
}

/// Whether the tip of a row is let go.
fn is_release(table: &mut Table, row: usize) -> bool {
    let event = table.text(row, EVENT).to_owned();
    if !event.is_empty() && event != RELEASE {
        table.at(row, EVENT, &format!("must be {RELEASE} or empty"), &event);
    }
    event == RELEASE
}

impl Tip {
    /// Distance from the root, or from the origin of the load (m).
    fn distance(&self) -> f64 {
        match self {
            Tip::InRoot(tip) => tip.norm(),
            Tip::InWorld { load, tip } => (tip - load.position).norm(),
        }
    }
}

fn sample(table: &mut Table, row: usize, is_in_root: bool) -> Option<Sample> {
    let time = table.number(row, "time_s");
    let spring = table.text(row, "spring").parse().ok();
    if spring.is_none() {
        let found = table.text(row, "spring").to_owned();
        table.at(row, "spring", "must be a whole number from 0", found);
    }
    let columns = &COLUMNS[if is_in_root { IN_ROOT } else { IN_WORLD }];
    let numbers: Vec<Option<f64>> = columns.iter().map(|column| table.number(row, column)).collect();
    let numbers: Vec<f64> = numbers.into_iter().collect::<Option<_>>()?;
    let tip = match numbers[..] {
        [x, y] => Tip::InRoot(Vec2::new(x, y)),
        _ => Tip::InWorld { load: Pose::new(numbers[0], numbers[1], numbers[2]), tip: Vec2::new(numbers[3], numbers[4]) },
    };
    Some(Sample { time: time?, spring: spring?, tip })
}
