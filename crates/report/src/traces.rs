//! Traces as files of an output folder, in the format asked for.

use serde::{Deserialize, Serialize};

use crate::folder::{FolderError, OutputFolder};
use crate::manifest::Manifest;
use crate::trace_csv::{self, TraceColumns};
use cohaul::simulation::Trace;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TraceFormat {
    /// A row of text for each control tick.
    Csv,
    /// The same columns as Parquet, with metadata.
    #[cfg(feature = "parquet")]
    Parquet,
}

/// Writes `STEM.csv` or `STEM.parquet` with these columns.
///
/// # Errors
/// When a number is not finite, or the disk fails.
#[cfg_attr(not(feature = "parquet"), expect(unused_variables, reason = "only Parquet has metadata"))]
pub fn write_trace(
    folder: &mut OutputFolder,
    stem: &str,
    (trace, columns): (&Trace, TraceColumns),
    format: TraceFormat,
    manifest: &Manifest,
) -> Result<(), FolderError> {
    match format {
        TraceFormat::Csv => folder.write(&format!("{stem}.csv"), |out| trace_csv::write_trace(trace, columns, out)),
        #[cfg(feature = "parquet")]
        TraceFormat::Parquet => {
            folder.write(&format!("{stem}.parquet"), |out| super::trace_parquet::write_trace(trace, columns, manifest, out))
        }
    }
}
