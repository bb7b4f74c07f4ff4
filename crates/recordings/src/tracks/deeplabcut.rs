//! Tables of DeepLabCut: header rows `scorer`, `bodyparts` and `coords`, and with several animals
//! `individuals` after the first. A row is a frame, and its first cell the number of the frame.

use cohaul::scenario::ScenarioError;
use cohaul::stop;

use super::cells::Cells;
use super::points::{AngleUnit, Clock, LengthUnit, Point, Points};

/// Columns of one point of an animal.
#[derive(Default)]
struct Part {
    name: String,
    x: Option<usize>,
    y: Option<usize>,
    likelihood: Option<usize>,
}

/// Points of a table of DeepLabCut.
///
/// # Errors
/// When the header rows or a number break a rule: each with its line.
pub fn read(mut cells: Cells) -> Result<Points, ScenarioError> {
    let row_of =
        |cells: &Cells, name: &str| (0..cells.n_rows().min(4)).find(|row| cells.row(*row).first().is_some_and(|cell| *cell == name));
    let [individuals, parts, coords] = ["individuals", "bodyparts", "coords"].map(|name| row_of(&cells, name));
    let (Some(parts), Some(coords)) = (parts, coords) else {
        let found = (0..cells.n_rows().min(4)).map(|row| cells.row(row).first().copied().unwrap_or_default().to_owned());
        let found = found.collect::<Vec<_>>().join(", ");
        cells.report("header", "must have rows that begin with scorer, bodyparts and coords", found);
        return Err(cells.whole().err().expect("a fault was reported"));
    };
    let n = cells.row(coords).len();
    cells.require_fields(0, n);
    let mut cells = cells.whole()?;
    let found = columns(&mut cells, individuals, parts, coords);
    let mut cells = cells.whole()?;
    let file = cells.file().to_owned();
    let mut points = Points::new(&file, Clock::Frames);
    (points.length, points.angle, points.y_down) = (LengthUnit::Pixels, AngleUnit::Radians, true);
    points.names = found.iter().map(|part| part.name.clone()).collect();
    for row in coords + 1..cells.n_rows() {
        stop::point();
        let Some(clock) = cells.required(row, 0, "frame") else { continue };
        for (name, part) in found.iter().enumerate() {
            let mut number = |column: Option<usize>| column.and_then(|column| cells.number(row, column, &part.name));
            let position = number(part.x).zip(number(part.y)).map(|(x, y)| [x, y]);
            let confidence = number(part.likelihood);
            points.points.push(Point { line: cells.line(row), clock, name, position, heading: None, confidence, is_release: false });
        }
    }
    points.n_rows = cells.n_rows() - coords - 1;
    points.n_decimal_commas = cells.n_decimal_commas;
    cells.whole()?;
    Ok(points)
}

/// The columns of all points, from the header rows.
fn columns(cells: &mut Cells, individuals: Option<usize>, parts: usize, coords: usize) -> Vec<Part> {
    let mut found: Vec<Part> = Vec::new();
    for column in 1..cells.row(coords).len() {
        let part = cells.text(parts, column);
        let name = individuals.map_or_else(|| part.to_owned(), |row| format!("{}.{part}", cells.text(row, column)));
        let at = found.iter().position(|part| part.name == name).unwrap_or_else(|| {
            found.push(Part { name, ..Part::default() });
            found.len() - 1
        });
        let part = &mut found[at];
        let coord = cells.text(coords, column).to_owned();
        let place = match coord.as_str() {
            "x" => &mut part.x,
            "y" => &mut part.y,
            "likelihood" => &mut part.likelihood,
            _ => {
                cells.at(coords, "coords", "must be x, y or likelihood", &coord);
                continue;
            }
        };
        if place.replace(column).is_some() {
            cells.at(coords, "coords", &format!("must have {coord} of {} once", part.name), "it twice");
        }
    }
    if let Some(part) = found.iter().find(|part| part.x.is_none() || part.y.is_none()) {
        cells.at(coords, "coords", &format!("must have x and y of {}", part.name), "one of them");
    }
    if found.is_empty() {
        cells.at(coords, "coords", "must have x and y of a body part", "none");
    }
    found
}
