//! `tips.csv`: attached tips with the load's pose, as a camera records them. `cohaul calibrate
//! forces` and `cohaul scenario from-tips` read it.

use std::io::Write;

use crate::lines::{Lines, TableError};
use cohaul::backend::AttachedTip;
use cohaul::simulation::{EventKind, Row, Trace};

/// Columns of `tips.csv`, all in world axes. The event is `release` where a tip is let go, and
/// empty elsewhere.
pub const TIP_COLUMNS: [&str; 8] = ["time_s", "spring", "x_m", "y_m", "heading_rad", "tip_x_m", "tip_y_m", "event"];

/// Writes `tips.csv`: a row for each attached tip at each control tick and wherever a tip turns
/// between two ticks, and a row for each release.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_tips(trace: &Trace, out: impl Write) -> Result<(), TableError> {
    let mut lines = Lines::new(out, &TIP_COLUMNS)?;
    let mut rows: Vec<&Row> = trace.rows.iter().chain(&trace.between).collect();
    rows.sort_by(|a, b| a.time.total_cmp(&b.time));
    for row in rows {
        let at = trace.events.partition_point(|event| event.time < row.time);
        let now = trace.events[at..].iter().take_while(|event| event.time == row.time);
        for release in now.filter(|event| event.kind == EventKind::Release) {
            add(&mut lines, row, release.spring, [release.tip.x, release.tip.y], "release")?;
        }
        for AttachedTip { spring, position, .. } in &row.tips {
            add(&mut lines, row, *spring, [position.x, position.y], "")?;
        }
    }
    lines.finish()?;
    Ok(())
}

fn add<W: Write>(lines: &mut Lines<W>, row: &Row, spring: usize, [x, y]: [f64; 2], event: &'static str) -> Result<(), TableError> {
    let pose = &row.motion.pose;
    lines.begin()?;
    lines.numbers(&[row.time])?;
    lines.count(spring);
    lines.numbers(&[pose.position.x, pose.position.y, pose.heading, x, y])?;
    match event {
        "" => lines.nothing(1),
        word => lines.word(word),
    }
    lines.end();
    Ok(())
}
