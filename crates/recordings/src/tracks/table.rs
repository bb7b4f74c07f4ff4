//! Tables with one header row: plain ones, and those of SLEAP, idtracker.ai, TRex, tracktor and
//! SwisTrack.

use std::collections::HashMap;

use cohaul::scenario::ScenarioError;
use cohaul::stop;

use super::cells::Cells;
use super::columns::{Columns, PlaceColumns};
use super::format::TrackFormat;
use super::points::{AngleUnit, Clock, LengthUnit, Point, Points};
use super::track::LOAD;

/// The only event: a tip is let go where it is.
const RELEASE: &str = "release";
/// Names of the points of which a file of TRex or SwisTrack has several, the best first.
const PREFERRED: [&str; 5] = ["world_center", "center", "wcentroid", "", "centroid"];

/// Points of a table. `name` is that of a track in a file without names.
///
/// # Errors
/// When the table breaks a rule: each with its line.
pub fn read(mut cells: Cells, format: TrackFormat, name: &str) -> Result<Points, ScenarioError> {
    let header: Vec<String> = cells.row(0).iter().map(|name| (*name).to_owned()).collect();
    let names: Vec<&str> = header.iter().map(String::as_str).collect();
    cells.require_fields(1, names.len());
    let columns = match Columns::of(&names) {
        Ok(columns) => Some(columns),
        Err([one, other]) => {
            cells.report("header", "must have each quantity once", format_args!("{:?} and {:?}", names[one], names[other]));
            None
        }
    };
    let mut cells = cells.whole()?;
    let Some(mut columns) = columns else { return Err(impossible(cells)) };
    let is_world = format == TrackFormat::SwisTrack && has_world_places(&cells, &columns);
    if format == TrackFormat::SwisTrack && !is_world {
        columns.places.retain(|place| !place.name.eq_ignore_ascii_case(PREFERRED[0]));
    }
    if matches!(format, TrackFormat::SwisTrack | TrackFormat::TRex) {
        columns.prefer(&PREFERRED);
    }
    let load = load_columns(&mut columns);
    check(&mut cells, &columns, load.as_ref(), &names);
    let cells = cells.whole()?;
    let format = if is_world { TrackFormat::Table } else { format };
    Rows { columns, load, header, format, name: name.to_owned(), indices: HashMap::new() }.read(cells)
}

/// The error of a table whose faults were all reported.
fn impossible(mut cells: Cells) -> ScenarioError {
    cells.report("header", "must have columns that can be told apart", "others");
    cells.whole().err().expect("a fault was reported")
}

/// Whether SwisTrack was calibrated: without that its world places are all zero.
fn has_world_places(cells: &Cells, columns: &Columns) -> bool {
    let Some(place) = columns.places.iter().find(|place| place.name.eq_ignore_ascii_case(PREFERRED[0])) else { return false };
    let is_other = |column: Option<usize>, row| column.is_some_and(|column| !matches!(cells.text(row, column), "" | "0" | "0.0"));
    (1..cells.n_rows()).any(|row| is_other(place.x, row) || is_other(place.y, row))
}

/// In a table of tips plain `x`, `y` and `heading` are the pose of the load.
fn load_columns(columns: &mut Columns) -> Option<PlaceColumns> {
    let tip = columns.places.iter().position(|place| place.name.eq_ignore_ascii_case("tip"))?;
    let load = columns.places.iter().position(|place| place.name.is_empty() && columns.id.is_some());
    columns.places[tip].name = String::new();
    columns.places[tip].heading = None;
    load.map(|load| PlaceColumns { confidence: None, ..columns.places.remove(load) })
}

/// Rules of the header.
fn check(cells: &mut Cells, columns: &Columns, load: Option<&PlaceColumns>, names: &[&str]) {
    let found = names.join(", ");
    if columns.time.is_none() && columns.frame.is_none() {
        cells.report("header", "must have a column of times or frames, as time_s or frame", &found);
    }
    if columns.places.is_empty() {
        cells.report("header", "must have columns of places, as x_m and y_m, x_px and y_px, or x1 and y1", &found);
    }
    if columns.places.iter().any(|place| place.name == "tip_in_root") {
        cells.report("header", "must have tips in world axes, as tip_x_m and tip_y_m", "tips in the frames of their roots");
    }
    let lengths: Vec<LengthUnit> = columns.places.iter().chain(load).map(|place| place.length).collect();
    if lengths.windows(2).any(|pair| pair[0] != pair[1]) {
        cells.report("header", "must have one unit of length", &found);
    }
    let with_heading = columns.places.iter().chain(load).filter(|place| place.heading.is_some());
    let angles: Vec<AngleUnit> = with_heading.map(|place| place.angle).collect();
    if angles.windows(2).any(|pair| pair[0] != pair[1]) {
        cells.report("header", "must have one unit of angles", &found);
    }
}

/// A table that is being read.
struct Rows {
    columns: Columns,
    load: Option<PlaceColumns>,
    header: Vec<String>,
    format: TrackFormat,
    /// Name of the track in a file without names.
    name: String,
    /// Indices of the names so far.
    indices: HashMap<String, usize>,
}

impl Rows {
    fn read(mut self, mut cells: Cells) -> Result<Points, ScenarioError> {
        let file = cells.file().to_owned();
        let mut points = Points::new(&file, if self.columns.time.is_some() { Clock::Seconds } else { Clock::Frames });
        let (places, is_image) = (self.columns.places.iter().chain(&self.load), self.format.is_of_images());
        points.length = places.clone().next().map(|place| place.length).unwrap_or_default();
        if points.length == LengthUnit::Unknown {
            points.length = self.format.length();
        }
        points.angle = places.clone().find(|place| place.heading.is_some()).map(|place| place.angle).unwrap_or_default();
        if points.angle == AngleUnit::Unknown && self.format != TrackFormat::Table {
            points.angle = AngleUnit::Radians;
        }
        points.y_down = is_image || points.length == LengthUnit::Pixels;
        points.are_springs = self.columns.id.is_some_and(|id| self.header[id].eq_ignore_ascii_case("spring"));
        points.left_out = self.columns.left_out.iter().map(|at| self.header[*at].clone()).filter(|name| !name.is_empty()).collect();
        for row in 1..cells.n_rows() {
            stop::point();
            self.row(&mut cells, row, &mut points);
        }
        points.n_rows = cells.n_rows() - 1;
        points.n_decimal_commas = cells.n_decimal_commas;
        cells.whole()?;
        Ok(points)
    }

    fn row(&mut self, cells: &mut Cells, row: usize, points: &mut Points) {
        let (column, unit) = self.columns.time.or(self.columns.frame.map(|at| (at, 1.0))).expect("it was checked");
        let name = self.header[column].clone();
        let Some(clock) = cells.required(row, column, &name) else { return };
        let is_missing = self.columns.missing.is_some_and(|at| cells.text(row, at) == "1");
        let event = self.columns.event.map(|at| cells.text(row, at).to_owned()).unwrap_or_default();
        if !event.is_empty() && event != RELEASE {
            cells.at(row, "event", &format!("must be {RELEASE} or empty"), &event);
        }
        let id = self.columns.id.map(|at| cells.text(row, at).to_owned()).unwrap_or_default();
        if points.are_springs && id.parse::<usize>().is_err() && id != LOAD {
            cells.at(row, "spring", "must be a whole number from 0", if id.is_empty() { "nothing" } else { &id });
        }
        let places = std::mem::take(&mut self.columns.places);
        for place in &places {
            let name = self.index(&named(&id, &place.name), &mut points.names);
            let point = self.point(cells, row, place);
            let position = point.position.filter(|_| !is_missing);
            points.points.push(Point { clock: clock * unit, name, position, is_release: event == RELEASE, ..point });
        }
        self.columns.places = places;
        if let Some(load) = self.load.take() {
            let point = self.point(cells, row, &load);
            points.load.push(Point { clock: clock * unit, ..point });
            self.load = Some(load);
        }
    }

    /// The place of one thing in a row, without time and name.
    fn point(&self, cells: &mut Cells, row: usize, place: &PlaceColumns) -> Point {
        let mut number = |column: Option<usize>| column.and_then(|column| cells.number(row, column, &self.header[column]));
        let (x, y) = (number(place.x), number(place.y));
        let (heading, confidence) = (number(place.heading), number(place.confidence));
        let position = x.zip(y).map(|(x, y)| [x, y]);
        Point { line: cells.line(row), clock: 0.0, name: 0, position, heading, confidence, is_release: false }
    }

    fn index(&mut self, name: &str, names: &mut Vec<String>) -> usize {
        let name = if name.is_empty() { self.name.as_str() } else { name };
        *self.indices.entry(name.to_owned()).or_insert_with(|| {
            names.push(name.to_owned());
            names.len() - 1
        })
    }
}

/// Name of a track: that of the thing, and that of the point on it. Whole numbers are written as
/// such, for some trackers write `2.0`.
fn named(id: &str, point: &str) -> String {
    let whole = id.parse::<f64>().ok().filter(|number| number.fract() == 0.0 && number.abs() < 1e15);
    let id = whole.map_or_else(|| id.to_owned(), |number| format!("{number:.0}"));
    match (id.is_empty(), point.is_empty()) {
        (_, true) => id,
        (true, false) => point.to_owned(),
        (false, false) => format!("{id}.{point}"),
    }
}
