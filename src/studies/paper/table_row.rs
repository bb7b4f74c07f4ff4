//! A row of the table of quantities.

use serde::Serialize;

use super::units::Estimate;
use super::verdict::Grade;

/// A quantity beside the printed one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableRow {
    pub quantity: String,
    pub unit: &'static str,
    pub printed: Option<f64>,
    /// On the first set.
    pub ours: Option<Estimate>,
    pub grade: Option<Grade>,
    pub why: String,
    /// On the other sets, in their order.
    pub on_others: Vec<OtherSet>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OtherSet {
    pub set: String,
    pub value: Option<Estimate>,
    pub grade: Option<Grade>,
    /// Minus the first set, paired by seed.
    pub minus_first: Option<Estimate>,
    /// Whether the interval of that leaves out zero.
    pub is_shifted: bool,
}
