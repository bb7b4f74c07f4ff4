//! Layout of a baseline's file, and the faults that a reader finds in one.

use serde::{Deserialize, Serialize};

use super::measure::Row;
use crate::scenario::Finding;

/// Value of `format` in every baseline.
pub const FORMAT: &str = "cohaul baseline";
/// Version of the format that this program reads and writes.
pub const VERSION: u64 = 1;

/// Keys of a file, in its order.
pub const KEYS: [&str; 10] =
    ["format", "version", "build", "scenario_sha256", "scenario", "options", "tolerances", "ending", "events", "path"];

/// Rows under the names of their columns.
#[derive(Serialize, Deserialize)]
pub struct PathEntry {
    pub columns: Vec<String>,
    pub rows: Vec<Row>,
}

/// Faults in the order in which they were found.
#[derive(Debug, Default)]
pub struct Faults(pub Vec<Finding>);

impl Faults {
    pub fn report(&mut self, path: &str, rule: impl Into<String>, found: impl Into<String>) {
        self.0.push(Finding { path: path.to_owned(), rule: rule.into(), found: found.into() });
    }

    pub fn require(&mut self, holds: bool, path: &str, rule: &str, found: f64) {
        if !holds {
            self.report(path, rule, format!("{found:?}"));
        }
    }
}
