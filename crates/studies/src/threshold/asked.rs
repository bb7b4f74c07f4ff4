//! A parameter and the range in which its threshold is sought, as written on the command line.
//!
//! ```text
//! speed              from 1/32 to 32 times the present value, four points for each factor of 2
//! speed=0.1:10       this range
//! speed=0.1:10:40    this range on a grid of 40 points
//! ```

use std::str::FromStr;

use crate::sweep::{Axis, SweepError, Values};

/// What `--threshold` asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Asked {
    /// A factor on the scene, or a key of the scenario with a number.
    pub path: String,
    range: Option<String>,
}

/// Largest factor by default on either side of the present value (1).
const REACH: f64 = 32.0;
/// Number of points of the grid for each factor of 2 (1): an oscillation of the inertia effect over
/// the parameter is seen if its half period is a factor of 2^(1/4) or more.
const POINTS_PER_OCTAVE: f64 = 4.0;
/// Fewest and most points of a grid that is not given (1).
const N_POINTS: [f64; 2] = [5.0, 200.0];

impl FromStr for Asked {
    type Err = SweepError;

    fn from_str(text: &str) -> Result<Self, SweepError> {
        let (path, range) = text.split_once('=').map_or((text, None), |(path, range)| (path, Some(range.trim().to_owned())));
        let (path, is_empty) = (path.trim().to_owned(), range.as_ref().is_some_and(String::is_empty));
        if path.is_empty() || is_empty {
            return Err(refused(text));
        }
        Ok(Self { path, range })
    }
}

impl Asked {
    /// Whether the default range about the present value is asked for.
    pub fn needs_present_value(&self) -> bool {
        self.range.is_none()
    }

    /// The grid, about the present value if no range is given.
    ///
    /// # Errors
    /// When the range is not one from a positive number to a larger one.
    pub fn axis(&self, present: f64) -> Result<Axis, SweepError> {
        let (from, to, n) = match &self.range {
            Some(range) => self.ends(range)?,
            None => ((present / REACH).to_string(), (present * REACH).to_string(), None),
        };
        // Any number of points gives the ends as numbers.
        let axis = Axis::new(&self.path, &format!("log:{from}:{to}:{}", n.as_deref().unwrap_or("2")))?;
        let Values::Grid { first, last, .. } = axis.values else { return Err(refused(&self.path)) };
        if first >= last {
            return Err(SweepError::axis(&self.path, "must be a range from low to high", format!("{from}:{to}")));
        }
        let n_usual = (POINTS_PER_OCTAVE * (last / first).log2()).ceil() + 1.0;
        let values = match n {
            Some(_) => axis.values,
            None => Values::Grid { first, last, n: n_usual.clamp(N_POINTS[0], N_POINTS[1]) as u64, is_logarithmic: true },
        };
        Ok(Axis { values, ..axis })
    }

    /// Ends of a range, and the number of points if it is given.
    fn ends(&self, range: &str) -> Result<(String, String, Option<String>), SweepError> {
        let parts: Vec<String> = range.split(':').map(|part| part.trim().to_owned()).collect();
        match &parts[..] {
            [from, to] => Ok((from.clone(), to.clone(), None)),
            [from, to, n] => Ok((from.clone(), to.clone(), Some(n.clone()))),
            _ => Err(refused(&format!("{}={range}", self.path))),
        }
    }
}

fn refused(text: &str) -> SweepError {
    SweepError::axis("--threshold", "must be PARAM, PARAM=FROM:TO or PARAM=FROM:TO:N", text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(text: &str) -> Result<(f64, f64, u64), String> {
        let axis = text.parse::<Asked>().and_then(|asked| asked.axis(2.0)).map_err(|error| error.to_string())?;
        let Values::Grid { first, last, n, is_logarithmic: true } = axis.values else { panic!("a logarithmic grid: {axis:?}") };
        Ok((first, last, n))
    }

    #[test]
    fn a_range_is_given_or_lies_about_the_present_value() {
        assert_eq!(grid("load.mass_kg"), Ok((0.0625, 64.0, 41)));
        assert_eq!(grid("speed = 0.5:8"), Ok((0.5, 8.0, 17)));
        assert_eq!(grid("speed=0.5:0.6"), Ok((0.5, 0.6, 5)));
        assert_eq!(grid("speed=0.5:8:33"), Ok((0.5, 8.0, 33)));
    }

    #[test]
    fn errors_name_the_rule_that_is_broken() {
        for (text, why) in [
            ("", "--threshold: must be PARAM, PARAM=FROM:TO or PARAM=FROM:TO:N"),
            ("speed=", "--threshold: must be PARAM"),
            ("speed=1", "--threshold: must be PARAM"),
            ("speed=2:1", "speed: must be a range from low to high, found 2:1"),
            ("speed=1:1", "speed: must take every value once"),
            ("speed=0:1", "speed: must be positive to have a logarithm, found 0"),
            ("speed=1:fast", "speed: must be a finite number, found fast"),
            ("speed=1:2:1", "speed: must have from 2 to"),
        ] {
            let error = grid(text).unwrap_err();
            assert!(error.contains(why), "{text}: {error}");
        }
    }
}
