//! Values of one parameter, as written on the command line.
//!
//! ```text
//! load.mass_kg=0.001,0.002       these values
//! load.mass_kg=0.001:0.002:5     five evenly spaced values
//! load.mass_kg=log:1e-4:1e-2:7   seven values, evenly spaced in the logarithm
//! load.mass_kg=1e-4..1e-2        a range, for a sample
//! load.mass_kg=log:1e-4..1e-2    a range that is sampled in the logarithm
//! ```

use std::str::FromStr;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::error::SweepError;

/// Path of the axis that `--scale-inertia` makes, another name of the factor `inertia`.
pub const INERTIA: &str = "inertia_scale";

/// One parameter and its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    pub path: String,
    #[serde(flatten)]
    pub values: Values,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Values {
    /// These numbers or words.
    List(Vec<Value>),
    /// `n` evenly spaced numbers from the first to the last.
    Grid { first: f64, last: f64, n: u64, is_logarithmic: bool },
    /// Numbers between these that a sample chooses.
    Range { low: f64, high: f64, is_logarithmic: bool },
}

/// Largest number of values of a grid. With more, neighbours may round to the same number.
const MOST_VALUES: u64 = 1 << 32;

impl FromStr for Axis {
    type Err = SweepError;

    fn from_str(text: &str) -> Result<Self, SweepError> {
        let (path, spec) = text.split_once('=').ok_or_else(|| SweepError::axis("--vary", "must be PATH=VALUES", text))?;
        Self::new(path.trim(), spec)
    }
}

impl Axis {
    /// Axis of the parameter at `path` with the values that `spec` describes.
    ///
    /// # Errors
    /// When `spec` has none of the forms above, or repeats a value.
    pub fn new(path: &str, spec: &str) -> Result<Self, SweepError> {
        let spec = spec.trim();
        if path.is_empty() || spec.is_empty() {
            return Err(SweepError::axis("--vary", "must be PATH=VALUES", format!("{path}={spec}")));
        }
        let rest = ["log:", "log "].iter().find_map(|prefix| spec.strip_prefix(prefix));
        let (body, is_logarithmic) = (rest.unwrap_or(spec).trim(), rest.is_some());
        let values = if let Some((low, high)) = body.split_once("..") {
            range(path, low, high, is_logarithmic)?
        } else if body.contains(':') {
            grid(path, body, is_logarithmic)?
        } else if is_logarithmic {
            return Err(SweepError::axis(path, "must be log:LOW:HIGH:N or log:LOW..HIGH", spec));
        } else {
            list(path, body)?
        };
        Ok(Self { path: path.to_owned(), values })
    }

    /// Number of values; `None` for a range.
    pub fn n_values(&self) -> Option<u64> {
        match &self.values {
            Values::List(list) => Some(list.len() as u64),
            Values::Grid { n, .. } => Some(*n),
            Values::Range { .. } => None,
        }
    }

    /// Value `index` of a list or a grid; the lower end of a range.
    pub fn value(&self, index: u64) -> Value {
        match &self.values {
            Values::List(list) => list[index as usize].clone(),
            Values::Grid { first, last, n, is_logarithmic } => {
                Value::from(between(*first, *last, *is_logarithmic, index as f64 / (n - 1) as f64))
            }
            Values::Range { low, .. } => Value::from(*low),
        }
    }

    /// Whether every value is a whole number. A range may have whole values.
    pub fn is_whole(&self) -> bool {
        let is_whole = |value: &Value| value.as_f64().is_some_and(|value| value.fract() == 0.0 && value >= 0.0);
        match &self.values {
            Values::List(list) => list.iter().all(is_whole),
            // With a whole first value, all are whole when the second is.
            Values::Grid { is_logarithmic, .. } => !is_logarithmic && is_whole(&self.value(0)) && is_whole(&self.value(1)),
            Values::Range { .. } => true,
        }
    }

    pub fn has_words(&self) -> bool {
        matches!(&self.values, Values::List(list) if list.iter().any(Value::is_string))
    }
}

impl Values {
    /// Value at the fraction `u` in [0, 1) of a range. Whole numbers are equally likely.
    pub fn within(low: f64, high: f64, is_logarithmic: bool, is_whole: bool, u: f64) -> Value {
        if is_whole {
            return Value::from((low + (u * (high - low + 1.0)).floor()).min(high) as u64);
        }
        Value::from(between(low, high, is_logarithmic, u))
    }
}

/// Value at a fraction between `low` and `high`, which are exact at the ends.
fn between(low: f64, high: f64, is_logarithmic: bool, share: f64) -> f64 {
    match share {
        0.0 => low,
        1.0 => high,
        _ if is_logarithmic => 10f64.powf(low.log10() + share * (high.log10() - low.log10())),
        _ => low + share * (high - low),
    }
}

fn range(path: &str, low: &str, high: &str, is_logarithmic: bool) -> Result<Values, SweepError> {
    let [low, high] = [number(path, low)?, number(path, high)?];
    if low >= high {
        return Err(SweepError::axis(path, "must be a range from low to high", format!("{low}..{high}")));
    }
    check_logarithm(path, is_logarithmic, [low, high])?;
    Ok(Values::Range { low, high, is_logarithmic })
}

fn grid(path: &str, body: &str, is_logarithmic: bool) -> Result<Values, SweepError> {
    let parts: Vec<&str> = body.split(':').collect();
    let [first, last, n] = parts[..] else {
        return Err(SweepError::axis(path, "must be FIRST:LAST:N", body));
    };
    let ends = [number(path, first)?, number(path, last)?];
    let n: u64 = n.trim().parse().ok().filter(|n| (2..=MOST_VALUES).contains(n)).ok_or_else(|| {
        let rule = format!("must have from 2 to {MOST_VALUES} values");
        SweepError::axis(path, rule, n)
    })?;
    check_logarithm(path, is_logarithmic, ends)?;
    if ends[0] == ends[1] {
        return Err(SweepError::axis(path, "must take every value once", format!("{} again", ends[0])));
    }
    Ok(Values::Grid { first: ends[0], last: ends[1], n, is_logarithmic })
}

fn check_logarithm(path: &str, is_logarithmic: bool, ends: [f64; 2]) -> Result<(), SweepError> {
    match ends.into_iter().find(|end| is_logarithmic && *end <= 0.0) {
        Some(end) => Err(SweepError::axis(path, "must be positive to have a logarithm", end)),
        None => Ok(()),
    }
}

/// Numbers and words; the scenario decides whether it accepts words.
fn list(path: &str, body: &str) -> Result<Values, SweepError> {
    let value = |text: &str| match text.trim() {
        "" => Err(SweepError::axis(path, "must be values with commas between them", body)),
        text => Ok(serde_json::from_str(text).ok().filter(Value::is_number).unwrap_or_else(|| Value::from(text))),
    };
    let values: Vec<Value> = body.split(',').map(value).collect::<Result<_, _>>()?;
    let mut texts: Vec<String> =
        values.iter().map(|value| value.as_f64().map_or_else(|| value.to_string(), |value| value.to_string())).collect();
    texts.sort_unstable();
    match texts.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(SweepError::axis(path, "must take every value once", format!("{} again", pair[0]))),
        None => Ok(Values::List(values)),
    }
}

fn number(path: &str, text: &str) -> Result<f64, SweepError> {
    let value = text.trim().parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| SweepError::axis(path, "must be a finite number", text))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(spec: &str) -> Vec<f64> {
        let axis = Axis::new("a", spec).unwrap();
        (0..axis.n_values().unwrap()).map(|index| axis.value(index).as_f64().unwrap()).collect()
    }

    #[test]
    fn grids_have_both_ends_exactly_and_even_steps() {
        assert_eq!(values("0:0.5:6").len(), 6);
        assert_eq!((values("0:0.5:6")[0], values("0:0.5:6")[5]), (0.0, 0.5));
        let log = values("log:1e-4:1e-2:3");
        assert_eq!((log[0], log[2]), (1e-4, 1e-2));
        // Two roundings of a logarithm of about 9 and one of an exponential.
        assert!((log[1] / 1e-3 - 1.0).abs() < 1e-14);
        assert_eq!(values("3,1e-3,2"), [3.0, 1e-3, 2.0]);
    }

    #[test]
    fn ranges_and_words_are_read() {
        let range = Values::Range { low: 0.5, high: 2.0, is_logarithmic: true };
        assert_eq!(Axis::new("a", "log 0.5..2").unwrap().values, range);
        assert_eq!(Axis::new("a", "log:0.5..2").unwrap().values, range);
        assert_eq!(Axis::new("a", "hazard,paper-speed").unwrap().value(1), "paper-speed");
        // Whole numbers from 2 to 4, each a third.
        let whole = |u| Values::within(2.0, 4.0, false, true, u);
        assert_eq!([whole(0.0), whole(0.34), whole(0.99)], [2.into(), 3.into(), Value::from(4)]);
    }

    #[test]
    fn errors_name_the_rule_that_is_broken() {
        for (text, why) in [
            ("load.mass_kg", "must be PATH=VALUES"),
            ("load.mass_kg=", "must be PATH=VALUES"),
            ("a=1:2", "must be FIRST:LAST:N"),
            ("a=1:2:1", "from 2 to 4294967296"),
            ("a=1:2:many", "from 2 to 4294967296"),
            ("a=2..1", "from low to high"),
            ("a=nan..1", "must be a finite number"),
            ("a=log:0:1:3", "must be positive"),
            ("a=log:-1..1", "must be positive"),
            ("a=log:3", "log:LOW:HIGH:N"),
            ("a=1,,2", "commas between"),
            ("a=1,2,1.0", "every value once, found 1 again"),
            ("a=5:5:2", "every value once"),
        ] {
            let error = text.parse::<Axis>().unwrap_err().to_string();
            assert!(error.contains(why), "{text}: {error}");
        }
    }
}
