//! What the paper prints and the runs do not reproduce: it stands first in every report.

use serde::Serialize;

use super::claims::Claim;
use super::table_row::TableRow;
use super::units::with_interval;
use super::verdict::Grade;
use crate::output::quantity::{number, quantity};

/// A printed number or claim that is not reproduced.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Missed {
    pub what: String,
    /// As printed, or the limit of a claim.
    pub paper: String,
    pub here: String,
    /// `false` where the seeds do not tell.
    pub is_certain: bool,
}

/// Graded quantities that differ or are undecided, and claims that do not hold or are undecided;
/// certain ones first.
pub fn missed(table: &[TableRow], claims: &[Claim]) -> Vec<Missed> {
    let rows = table.iter().filter_map(|row| {
        let grade = row.grade.filter(|grade| !grade.is_met())?;
        Some(Missed {
            what: row.quantity.clone(),
            paper: quantity(row.printed?, row.unit),
            here: with_interval(&row.ours, row.unit),
            is_certain: grade == Grade::Differs,
        })
    });
    let claims = claims.iter().filter(|claim| claim.holds != Some(true)).map(|claim| Missed {
        what: format!("{} ({})", claim.claim, claim.source),
        paper: format!("{} {} {}", claim.statistic, claim.side(), number(claim.limit)),
        here: with_interval(&claim.found, ""),
        is_certain: claim.holds == Some(false),
    });
    let mut found: Vec<Missed> = rows.chain(claims).collect();
    found.sort_by_key(|missed| !missed.is_certain);
    found
}
