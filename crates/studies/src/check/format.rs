//! Layout of a baseline's file.

use serde::{Deserialize, Serialize};

use super::measure::Row;
use cohaul::formats::BASELINE;

/// Value of `format` in every baseline.
pub const FORMAT: &str = BASELINE.name;
/// Version of the format that this program reads and writes.
pub const VERSION: u32 = BASELINE.version;

/// Keys of a file, in its order.
pub const KEYS: [&str; 10] =
    ["format", "version", "build", "scenario_sha256", "scenario", "options", "tolerances", "ending", "events", "path"];

/// Rows under the names of their columns.
#[derive(Serialize, Deserialize)]
pub struct PathEntry {
    pub columns: Vec<String>,
    pub rows: Vec<Row>,
}
