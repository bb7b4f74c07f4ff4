//! Values and ranges of the parameter in words.

use serde::Serialize;

use super::bands::{Band, Bound};
use crate::sweep::Factor;
use cohaul_report::quantity::{number, short, short_quantity};

/// The parameter that is searched over.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    pub path: String,
    /// Ends of the range of the search.
    pub range: [f64; 2],
    /// Largest speed of what drives the load at the factor 1 (m/s); left out for parameters other
    /// than the factor on the speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_m_per_s: Option<f64>,
}

impl Parameter {
    /// A value with its unit, if it has one.
    pub fn value(&self, value: f64) -> String {
        self.speed_m_per_s.map_or_else(|| short(value), |speed| short_quantity(value * speed, "m/s"))
    }

    /// Words before and after values: `load.mass_kg = ...`, or `... times the inertia`.
    fn around(&self) -> (String, String) {
        match (self.factor(), self.speed_m_per_s) {
            (None, _) => (format!("{} = ", self.path), String::new()),
            (Some(_), Some(_)) => Default::default(),
            (Some(_), None) => (String::new(), format!(" times the {}", self.noun())),
        }
    }

    fn factor(&self) -> Option<Factor> {
        Factor::named(&self.path)
    }

    /// What has values.
    pub fn noun(&self) -> &str {
        match self.factor() {
            Some(Factor::Speed) => "speed",
            Some(Factor::Size) => "size",
            Some(Factor::Inertia) => "inertia",
            None => &self.path,
        }
    }

    /// Name and unit of an axis on which the values stand at [`Parameter::place`].
    pub fn label(&self) -> String {
        match (self.factor(), self.noun()) {
            (Some(Factor::Speed), _) => "largest speed of what drives the load (m/s)".to_owned(),
            (Some(_), noun) => format!("{noun} / present {noun} (1)"),
            (None, path) => path.to_owned(),
        }
    }

    /// Where a value stands on the axis of a figure.
    pub fn place(&self, value: f64) -> f64 {
        value * self.speed_m_per_s.unwrap_or(1.0)
    }

    /// The whole range of the search after a word such as `every`.
    pub fn whole(&self, word: &str) -> String {
        let ([from, to], (_, after)) = (self.range.map(|end| self.value(end)), self.around());
        let after = if after.is_empty() { "" } else { " times that given" };
        format!("at {word} {} from {from} to {to}{after}", self.noun())
    }

    /// One range of values, of which those at the ends of the search are left out.
    pub fn of_band(&self, band: &Band) -> String {
        let ([from, to], (before, after)) = ([band.from, band.to].map(|bound| self.value(bound.value)), self.around());
        match (band.from.is_end, band.to.is_end) {
            (true, true) => self.whole("every"),
            (true, false) => format!("up to {before}{to}{after}"),
            (false, true) => format!("from {before}{from}{after} on"),
            (false, false) => format!("from {before}{from} to {to}{after}"),
        }
    }

    /// The values between which the end of a range lies, or that the search ends there.
    pub fn of_end(&self, bound: &Bound) -> String {
        let [from, to] = bound.range.map(number);
        if bound.is_end { format!("{to}, end of the search") } else { format!("{from} to {to}") }
    }

    /// What these values are.
    pub fn head_of_ends(&self) -> &'static str {
        if self.factor().is_some() { "factor at the end" } else { "the end lies in" }
    }
}
