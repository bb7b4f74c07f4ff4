//! The path of a baseline beside that of the new run, as a CSV table.

use std::io::Write;

use super::measure::{COLUMNS, MEASURES, Row};
use crate::output::lines::TableError;
use crate::output::table::Table;

/// Writes rows of two runs at the same times: the time, every other column as expected and as
/// found, and the difference in every measure.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_pairs(pairs: &[(Row, Row)], out: impl Write) -> Result<(), TableError> {
    let sides = COLUMNS[1..].iter().flat_map(|name| [format!("expected_{name}"), format!("found_{name}")]);
    let apart = MEASURES.iter().map(|measure| format!("apart_{}", measure.name));
    let mut table = Table::new("", ["time_s".to_owned()].into_iter().chain(sides).chain(apart));
    for (expected, found) in pairs {
        let sides = expected[1..].iter().zip(&found[1..]).flat_map(|(expected, found)| [*expected, *found]);
        let apart = MEASURES.iter().map(|measure| measure.apart(expected, found));
        table.push([expected[0]].into_iter().chain(sides).chain(apart));
    }
    table.write_csv(out)
}
