//! The path of a baseline beside that of the new run, as a CSV table.

use std::io::Write;

use super::measure::{COLUMNS, MEASURES, Row};
use crate::output::json::NotFinite;
use crate::output::lines::TableError;

/// Writes rows of two runs at the same times: the time, every other column as expected and as
/// found, and the difference in every measure.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_pairs(pairs: &[(Row, Row)], out: impl Write) -> Result<(), TableError> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
    let sides = COLUMNS[1..].iter().flat_map(|name| [format!("expected_{name}"), format!("found_{name}")]);
    let apart = MEASURES.iter().map(|measure| format!("apart_{}", measure.name));
    let head: Vec<_> = ["time_s".to_owned()].into_iter().chain(sides).chain(apart).collect();
    writer.write_record(&head)?;
    for (expected, found) in pairs {
        let sides = expected[1..].iter().zip(&found[1..]).flat_map(|(expected, found)| [*expected, *found]);
        let apart = MEASURES.iter().map(|measure| measure.apart(expected, found));
        let row: Vec<_> = [expected[0]].into_iter().chain(sides).chain(apart).collect();
        if let Some((path, value)) = head.iter().zip(&row).find(|(_, value)| !value.is_finite()) {
            return Err(NotFinite { path: path.clone(), value: *value }.into());
        }
        writer.serialize(row)?;
    }
    writer.flush()?;
    Ok(())
}
