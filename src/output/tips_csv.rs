//! `tips.csv`: attached tips with the load's pose, as a camera records them. `cohaul calibrate
//! forces` reads it.

use std::io::Write;

use crate::output::lines::{Lines, TableError};
use crate::simulation::Trace;

/// Columns of `tips.csv`, all in world axes.
pub const TIP_COLUMNS: [&str; 7] = ["time_s", "spring", "x_m", "y_m", "heading_rad", "tip_x_m", "tip_y_m"];

/// Writes `tips.csv`: a row for each attached tip at each control tick.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_tips(trace: &Trace, out: impl Write) -> Result<(), TableError> {
    let mut lines = Lines::new(out, &TIP_COLUMNS)?;
    for row in &trace.rows {
        let pose = &row.motion.pose;
        for tip in &row.tips {
            lines.begin()?;
            lines.numbers(&[row.time])?;
            lines.count(tip.spring);
            lines.numbers(&[pose.position.x, pose.position.y, pose.heading, tip.position.x, tip.position.y])?;
            lines.end();
        }
    }
    lines.finish()?;
    Ok(())
}
