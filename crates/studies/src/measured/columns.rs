//! Columns of a recording: which of them a table has, in which units.

use cohaul::math::{Pose, Vec2};
use cohaul::scenario::nearest;

use crate::csv_input::Table;

/// Units of columns and their size in SI units.
const UNITS: [(&str, &str, f64); 13] = [
    ("m", "m", 1.0),
    ("cm", "m", 1e-2),
    ("mm", "m", 1e-3),
    ("um", "m", 1e-6),
    ("s", "s", 1.0),
    ("ms", "s", 1e-3),
    ("us", "s", 1e-6),
    ("rad", "rad", 1.0),
    ("mrad", "rad", 1e-3),
    ("deg", "rad", std::f64::consts::PI / 180.0),
    ("n", "n", 1.0),
    ("mn", "n", 1e-3),
    ("un", "n", 1e-6),
];

/// How a table is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// Names of this page, and the columns that have these names in the table.
    pub columns: Vec<(String, String)>,
    /// Least confidence with which a pose counts (1), where the table has confidences.
    pub least_confidence: f64,
}

/// Columns of a recording.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    pub run: Option<String>,
    pub time: Column,
    pub bodies: Vec<BodyColumns>,
    /// Standard deviations of position and heading of the load.
    pub uncertainty: Option<Pair>,
    /// What was passed over or converted.
    pub notes: Vec<String>,
}

/// A column with the factor that brings its numbers to SI units.
#[derive(Clone, Debug, Default)]
pub struct Column {
    pub name: String,
    pub factor: f64,
}

/// Two columns whose numbers are given together or not at all.
#[derive(Clone, Debug)]
pub struct Pair(pub [Column; 2]);

/// What a pose belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Body {
    Load,
    Obstacle(String),
    /// The tip of a spring.
    Tip(usize),
}

/// Columns of a body.
#[derive(Clone, Debug)]
pub struct BodyColumns {
    pub body: Body,
    position: Pair,
    /// `None` for a heading of zero.
    heading: Option<Column>,
    pub confidence: Option<String>,
    pub force: Option<Pair>,
}

/// Finds the columns of a table, and remembers which of them have a meaning.
struct Finder<'a> {
    table: &'a Table,
    reading: &'a Reading,
    used: Vec<String>,
    converted: Vec<(&'static str, &'static str)>,
}

impl Columns {
    /// Columns of `table` for a scene with these `obstacles` and springs. What is missing is
    /// reported there.
    pub fn of(table: &mut Table, (obstacles, n_springs): (&[String], usize), reading: &Reading) -> Self {
        report_wrong_names(table, reading);
        let mut finder = Finder { table, reading, used: Vec::new(), converted: Vec::new() };
        let mut missing = Vec::new();
        let time = finder.quantity("time", "s");
        let load = finder.body(Body::Load, "load");
        let tips = (0..n_springs).filter_map(|spring| finder.body(Body::Tip(spring), &format!("tip{spring}")));
        let mut bodies: Vec<BodyColumns> = tips.collect();
        bodies.extend(obstacles.iter().filter_map(|name| finder.body(Body::Obstacle(name.clone()), name)));
        let uncertainty = finder.pair(["load_uncertainty", "load_heading_uncertainty"], ["m", "rad"]);
        let run = finder.word("run");
        match &load {
            None => missing.extend(["load_x_m", "load_y_m"].iter().filter(|name| finder.quantity(&name[..6], "m").is_none()).copied()),
            Some(load) if load.heading.is_none() => missing.push("load_heading_rad"),
            Some(_) => {}
        }
        if time.is_none() {
            missing.push("time_s");
        }
        let notes = finder.notes();
        let found = table.columns().join(", ");
        for name in &missing {
            table.report("header", &format!("must have a column {name}"), &found);
        }
        if missing.is_empty() && bodies.is_empty() {
            let names: Vec<String> = obstacles.iter().map(|name| format!("{name}_x_m, {name}_y_m")).collect();
            let names = if names.is_empty() { "tip0_x_m, tip0_y_m".to_owned() } else { names.join(", ") };
            table.report("header", &format!("must have the places of an obstacle or tip of the scene, as {names}"), &found);
        }
        bodies.extend(load);
        Self { run, time: time.unwrap_or_default(), bodies, uncertainty, notes }
    }
}

/// Reports names that no column has.
fn report_wrong_names(table: &mut Table, reading: &Reading) {
    for (name, column) in &reading.columns {
        if !table.has(column) {
            let known = table.columns().to_vec();
            let hint = nearest(column, known.iter().map(String::as_str)).map_or(String::new(), |near| format!("; did you mean {near}?"));
            table.report(name, "must be a column of the table", format!("{column}{hint}"));
        }
    }
}

impl Finder<'_> {
    /// The column of the table that has this name, under its own or another.
    fn word(&mut self, name: &str) -> Option<String> {
        let other = self.reading.columns.iter().find(|(of, _)| of == name).map(|(_, column)| column.clone());
        let found = other.or_else(|| self.table.has(name).then(|| name.to_owned()))?;
        self.used.push(found.clone());
        Some(found)
    }

    /// The column of a quantity in any unit of this kind.
    fn quantity(&mut self, name: &str, kind: &str) -> Option<Column> {
        UNITS.iter().filter(|(_, of, _)| *of == kind).find_map(|(unit, si, factor)| {
            let name = self.word(&format!("{name}_{unit}"))?;
            if *factor != 1.0 && !self.converted.contains(&(unit, si)) {
                self.converted.push((unit, si));
            }
            Some(Column { name, factor: *factor })
        })
    }

    fn pair(&mut self, names: [&str; 2], kinds: [&str; 2]) -> Option<Pair> {
        let [first, second] = [0, 1].map(|at| self.quantity(names[at], kinds[at]));
        Some(Pair([first?, second?]))
    }

    fn body(&mut self, body: Body, name: &str) -> Option<BodyColumns> {
        let position = self.pair([&format!("{name}_x"), &format!("{name}_y")], ["m", "m"])?;
        let force = self.pair([&format!("{name}_force_x"), &format!("{name}_force_y")], ["n", "n"]);
        let heading = self.quantity(&format!("{name}_heading"), "rad");
        Some(BodyColumns { body, position, heading, confidence: self.word(&format!("{name}_confidence")), force })
    }

    fn notes(&self) -> Vec<String> {
        let passed: Vec<&str> = self.table.columns().iter().filter(|name| !self.used.contains(name)).map(String::as_str).collect();
        let converted =
            self.converted.iter().map(|(unit, si)| format!("numbers in {unit} were converted to {}", if *si == "n" { "N" } else { si }));
        let passed = (!passed.is_empty()).then(|| format!("columns without a meaning here: {}: passed over", passed.join(", ")));
        passed.into_iter().chain(converted).collect()
    }
}

impl Pair {
    /// The two numbers of a row; `Some(None)` where both are missing, `None` where there is a
    /// fault.
    pub fn numbers(&self, table: &mut Table, row: usize) -> Option<Option<[f64; 2]>> {
        let Self([first, second]) = self;
        match [first, second].map(|column| is_missing(table.text(row, &column.name))) {
            [true, true] => Some(None),
            [false, false] => {
                let number = |table: &mut Table, column: &Column| Some(table.number(row, &column.name)? * column.factor);
                Some(Some([number(table, first)?, number(table, second)?]))
            }
            [true, false] => missing_beside(table, row, first, second),
            [false, true] => missing_beside(table, row, second, first),
        }
    }
}

fn missing_beside<T>(table: &mut Table, row: usize, missing: &Column, there: &Column) -> Option<T> {
    table.at(row, &missing.name, &format!("must be there with {}, or both left out", there.name), "nothing");
    None
}

impl BodyColumns {
    /// Pose in a row; `Some(None)` where the body was not seen, `None` where there is a fault.
    pub fn pose(&self, table: &mut Table, row: usize) -> Option<Option<Pose>> {
        let Some([x, y]) = self.position.numbers(table, row)? else { return Some(None) };
        let heading = match &self.heading {
            // A position without a heading is no pose.
            Some(column) if is_missing(table.text(row, &column.name)) => return Some(None),
            Some(column) => table.number(row, &column.name)? * column.factor,
            None => 0.0,
        };
        Some(Some(Pose::new(x, y, heading)))
    }

    /// Force in a row, as [`BodyColumns::pose`].
    pub fn force(&self, table: &mut Table, row: usize) -> Option<Option<Vec2>> {
        match &self.force {
            Some(columns) => Some(columns.numbers(table, row)?.map(Vec2::from)),
            None => Some(None),
        }
    }
}

/// Whether a field stands for nothing.
fn is_missing(text: &str) -> bool {
    text.is_empty() || ["nan", "na", "null", "none"].iter().any(|word| text.eq_ignore_ascii_case(word))
}
