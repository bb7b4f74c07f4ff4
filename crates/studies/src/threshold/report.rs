//! Thresholds as data: the answer, the tables and the text.

use serde::Serialize;

use super::bands::{Band, bands};
use super::point::{Class, Point};
use super::search::sorted;
use super::words::Parameter;
use crate::sweep::{Factor, Plan};
use crate::vary::report::QUANTITIES;
use cohaul::analysis::compare::Settings;
use cohaul::formats::{self, Format, Versioned};
use cohaul_report::quantity::{quantity, short, short_quantity};
use cohaul_report::table::{Column, Field, Table};
use cohaul_report::text::Lines;

/// Result of `cohaul compare --threshold`, as `--json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Thresholds {
    pub answer: String,
    pub scenario: String,
    pub seed: u64,
    pub settings: Settings,
    pub parameter: Parameter,
    /// Those that say something: without a spring that is ever attached there are no pulls.
    pub quantities: Vec<QuantityBands>,
    pub n_failed: usize,
    /// In the order of their values.
    pub points: Vec<Point>,
    /// Real time that all calls took (s).
    pub wall_s: f64,
}

/// Ranges of one answer on a quantity, which together are the range of the search.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuantityBands {
    pub quantity: &'static str,
    pub bands: Vec<Band>,
}

/// Why an answer is open without a doubt.
const BY_ERROR: &str = "the reference error is too large";

impl Versioned for Thresholds {
    const FORMAT: Format = formats::THRESHOLD;
}

impl Class {
    /// The word that tables use.
    pub fn text(self) -> &'static str {
        match self {
            Class::Valid => "valid",
            Class::NotValid => "not valid",
            Class::Open => "open",
            Class::NothingMoves => "nothing moves",
            Class::Failed => "not computed",
        }
    }
}

impl QuantityBands {
    pub fn of(&self, class: Class) -> Vec<&Band> {
        self.bands.iter().filter(|band| band.class == class).collect()
    }
}

impl Thresholds {
    pub fn new(plan: &Plan, settings: &Settings, points: &[Point], wall_s: f64) -> Self {
        let sorted = sorted(points);
        let path = plan.identity.design.axes[0].path.clone();
        let speed_m_per_s = (Factor::named(&path) == Some(Factor::Speed)).then(|| plan.base().drive_speed());
        let all_failed = points.iter().all(|point| point.failure.is_some());
        let has = |at: &usize| all_failed || points.iter().any(|point| point.effects[*at].is_some());
        let of_quantity = |at: usize| QuantityBands { quantity: QUANTITIES[at].0, bands: bands(&sorted, at) };
        let mut found = Self {
            answer: String::new(),
            scenario: plan.base().name.clone(),
            seed: plan.identity.first_seed,
            settings: *settings,
            parameter: Parameter { path, range: [sorted[0].value, sorted[sorted.len() - 1].value], speed_m_per_s },
            quantities: (0..QUANTITIES.len()).filter(has).map(of_quantity).collect(),
            n_failed: points.iter().filter(|point| point.failure.is_some()).count(),
            points: sorted.into_iter().cloned().collect(),
            wall_s,
        };
        found.answer = found.sentences();
        found
    }

    /// Where quasi-static is valid, then all ranges without an answer.
    fn sentences(&self) -> String {
        let valid = self.grouped(|of| Some(self.where_valid(of)));
        let error = self.largest_error().map_or(String::new(), |error| format!("; each limit is known to {:.1} %", 100.0 * error));
        let mut text = format!("Quasi-static is valid {}{error}.", list(&valid));
        for (class, what) in
            [(Class::Open, "The answer is open"), (Class::NothingMoves, "Nothing moves"), (Class::Failed, "There is no result")]
        {
            let places = self.grouped(|of| Some(of.of(class)).filter(|bands| !bands.is_empty()).map(|bands| self.places(&bands)));
            if !places.is_empty() {
                let why = self.why(class).map_or(String::new(), |why| format!(": {why}"));
                text += &format!(" {what} {}{why}.", list(&places));
            }
        }
        text
    }

    /// Phrases with the quantities of which they are true, as `up to 126 mm/s (path, energy)`.
    fn grouped(&self, phrase_of: impl Fn(&QuantityBands) -> Option<String>) -> Vec<String> {
        let mut groups: Vec<(String, Vec<&str>)> = Vec::new();
        for of in &self.quantities {
            let Some(phrase) = phrase_of(of) else { continue };
            match groups.iter_mut().find(|(other, _)| *other == phrase) {
                Some((_, names)) => names.push(of.quantity),
                None => groups.push((phrase, vec![of.quantity])),
            }
        }
        groups.into_iter().map(|(phrase, names)| format!("{phrase} ({})", names.join(", "))).collect()
    }

    fn where_valid(&self, of: &QuantityBands) -> String {
        let valid = of.of(Class::Valid);
        let is_known = [Class::Open, Class::Failed].iter().all(|class| of.of(*class).is_empty());
        let known = if is_known { "" } else { " certain" };
        match valid.is_empty() {
            true => self.parameter.whole(&format!("no{known}")),
            false => self.places(&valid),
        }
    }

    fn places(&self, bands: &[&Band]) -> String {
        list(&bands.iter().map(|band| self.parameter.of_band(band)).collect::<Vec<_>>())
    }

    /// Why the first point of a class is so; `None` if there is nothing to say.
    fn why(&self, class: Class) -> Option<String> {
        let mut of = self.points.iter().filter(|point| (0..QUANTITIES.len()).any(|at| point.class(at) == class));
        let why = |point: &Point| match class {
            Class::Open => Some(point.doubt.clone().unwrap_or_else(|| BY_ERROR.to_owned())),
            Class::Failed => point.failure.clone(),
            _ => None,
        };
        of.find_map(why)
    }

    /// Largest distance of a boundary of what is valid from the ends of its range (1).
    fn largest_error(&self) -> Option<f64> {
        let valid = self.quantities.iter().flat_map(|of| of.of(Class::Valid));
        let bounds = valid.flat_map(|band| [band.from, band.to]).filter(|bound| !bound.is_end);
        let error = |bound: super::Bound| (bound.range[1] / bound.value - 1.0).max(1.0 - bound.range[0] / bound.value);
        bounds.map(error).reduce(f64::max)
    }

    /// All ranges, with the values between which their upper ends lie.
    pub fn table(&self) -> Table {
        let row = |name: &str, band: &Band| {
            let end = |value: f64| self.parameter.value(value);
            let range = self.parameter.of_end(&band.to);
            [name.to_owned(), band.class.text().to_owned(), end(band.from.value), end(band.to.value), range]
        };
        let rows = self.quantities.iter().flat_map(|of| of.bands.iter().map(|band| row(of.quantity, band)));
        Table::new("Ranges", ["quantity", "quasi-static", "from", "to", self.parameter.head_of_ends()]).with_rows(rows)
    }

    /// All numbers of all points.
    pub fn table_of_points(&self) -> Table {
        let column = |name: String, unit| Column { name, unit };
        let of_quantity = |(name, unit): (&str, &'static str)| {
            let number = |what: &str| column(format!("{name} {what}"), unit);
            let [inertia, reference, tolerance] = ["inertia effect", "reference error", "tolerance"].map(number);
            [column(format!("quasi-static for {name}"), ""), inertia, reference, tolerance]
        };
        let speed = self.parameter.speed_m_per_s.map(|_| column("drive speed".to_owned(), "m/s"));
        let head = std::iter::once(column(self.parameter.path.clone(), "")).chain(speed);
        let columns = head.chain(QUANTITIES.into_iter().flat_map(of_quantity)).chain([column("failure".to_owned(), "")]);
        let row = |point: &Point| {
            let speed = self.parameter.speed_m_per_s.map(|speed| Field::Number(speed * point.value));
            let head = std::iter::once(Field::Number(point.value)).chain(speed);
            let of_quantity = |at: usize| {
                let effect = point.effects[at];
                let numbers = [effect.map(|of| of.inertia_effect), effect.map(|of| of.reference_error), effect.map(|of| of.tolerance)];
                std::iter::once(point.class(at).text().to_owned().into()).chain(numbers.map(Field::from)).collect::<Vec<Field>>()
            };
            let failure = Field::from(point.failure.clone());
            head.chain((0..QUANTITIES.len()).flat_map(of_quantity)).chain([failure]).collect::<Vec<_>>()
        };
        Table { caption: String::new(), columns: columns.collect(), rows: self.points.iter().map(row).collect() }
    }

    /// The answer, the table and what it means.
    pub fn text(&self) -> String {
        let mut lines = Lines::default();
        lines.answer(&self.answer);
        lines.text += &self.table().text();
        lines.row("parameter", &self.meaning());
        lines.row("valid", "the inertia effect and its reference error are within the tolerance of the quantity");
        lines.row("points", &self.points.len().to_string());
        lines.row("wall time", &quantity(self.wall_s, "s"));
        lines.text
    }

    /// What the values in the table are.
    pub fn meaning(&self) -> String {
        let name = &self.parameter.path;
        match self.parameter.speed_m_per_s {
            Some(speed) => {
                let [from, to] = self.parameter.range.map(short);
                format!("{name}, from {from} to {to} times the {} of the fastest tip, obstacle, ant or start", short_quantity(speed, "m/s"))
            }
            None if Factor::named(name).is_some() => format!("{name}, over that of the scene as given"),
            None => name.clone(),
        }
    }
}

fn list(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}
