//! A trace as Parquet, with the columns of `trace.csv`.

use std::io::Write;

use crate::lines::TableError;
use crate::manifest::Manifest;
use crate::table::{Field, Kind, ParquetWriter};
use crate::trace_csv::{N_TRANSPORTING, TraceColumns, forces_of, motion_of, pulls_of};
use cohaul::simulation::{Row, Trace};

/// Writes these columns of a trace of the run with this manifest.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_trace(trace: &Trace, columns: TraceColumns, manifest: &Manifest, out: &mut (dyn Write + Send)) -> Result<(), TableError> {
    let kind = |name: &String| if name == N_TRANSPORTING { Kind::Whole } else { Kind::Number };
    let named = columns.names().into_iter().map(|name| (name.clone(), kind(&name))).collect();
    let mut writer = ParquetWriter::new(named, Some(manifest), out)?;
    let mut pulls = vec![f64::NAN; 2 * columns.n_pulls()];
    trace.rows.iter().try_for_each(|row| writer.add(fields(row, columns, &mut pulls)))?;
    Ok(writer.finish()?)
}

fn fields(row: &Row, columns: TraceColumns, pulls: &mut [f64]) -> Vec<Field> {
    let mut fields: Vec<Field> = motion_of(row).map(Field::from).to_vec();
    if columns != TraceColumns::Motion {
        fields.extend(forces_of(row).map(Field::from));
    }
    fields.push(row.tips.len().into());
    pulls_of(row, pulls);
    // A spring without attachment has no pull.
    fields.extend(pulls.iter().map(|pull| if pull.is_nan() { Field::Empty } else { Field::from(*pull) }));
    fields
}
