//! A trace as CSV tables: `trace.csv` with a row at every control tick, `events.csv` with every grasp and release,
//! `transitions.csv` with every instant at which the load's motion is not smooth.
//!
//! Floats are written with the fewest digits that read back as the same number. An empty field means "there is none": the pull on a spring
//! that nobody holds, the ant of a prescribed path, the size of what is no jump.

use std::io::Write;

use super::lines::Lines;
use super::{NotFinite, finite};
use crate::backend::{Transition, TransitionKind};
use crate::check;
use crate::simulation::{EventKind, Row, Trace};

/// Above this number of springs `trace.csv` has no columns of pulls: they would be most of the file. `n_transporting` stays.
pub const MOST_SPRINGS_WITH_COLUMNS: usize = 32;

/// Columns of `trace.csv` that every run has.
pub const TRACE_COLUMNS: [&str; 14] = [
    "time_s",
    "x_m",
    "y_m",
    "heading_rad",
    "vx_m_per_s",
    "vy_m_per_s",
    "turn_rate_rad_per_s",
    "elastic_j",
    "kinetic_j",
    "dissipated_j",
    "tip_work_j",
    "defect_j",
    "interaction_n",
    "n_transporting",
];

/// Columns of `events.csv`.
pub const EVENT_COLUMNS: [&str; 6] = ["time_s", "event", "spring", "ant", "tip_x_m", "tip_y_m"];

/// Columns of `transitions.csv`.
pub const TRANSITION_COLUMNS: [&str; 6] = ["time_s", "transition", "support", "shift_m", "turn_rad", "energy_j"];

#[derive(Debug, thiserror::Error)]
pub enum TableError {
    #[error(transparent)]
    NotFinite(#[from] NotFinite),
    #[error(transparent)]
    Csv(#[from] csv::Error),
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

/// Writes `trace.csv`: [`TRACE_COLUMNS`], of which `interaction_n` is the sum of Eq. (4) over all pairs of holders, then `pull_x_<j>_n,pull_y_<j>_n` for each spring j, the force of its holder on its tip (world axes),
/// unless there are more than [`MOST_SPRINGS_WITH_COLUMNS`].
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_trace(trace: &Trace, n_springs: usize, out: impl Write) -> Result<(), TableError> {
    let n_pulls = if n_springs <= MOST_SPRINGS_WITH_COLUMNS { n_springs } else { 0 };
    let mut lines = Lines::new(out, TRACE_COLUMNS.len() + 2 * n_pulls);
    let pull_names = (0..n_pulls).flat_map(|j| [format!("pull_x_{j}_n"), format!("pull_y_{j}_n")]);
    let names: Vec<_> = TRACE_COLUMNS.iter().map(|name| (*name).to_owned()).chain(pull_names).collect();
    lines.head(&names)?;
    let mut pulls = vec![None; 2 * n_pulls];
    for row in &trace.rows {
        let state = state_of(row);
        TRACE_COLUMNS.iter().zip(state).try_for_each(|(name, value)| finite(name, value).map(drop))?;
        pulls_of(row, &mut pulls)?;
        lines.begin()?;
        lines.numbers(&state.map(Some));
        lines.count(row.tips.len());
        lines.numbers(&pulls);
        lines.end();
    }
    lines.finish()?;
    Ok(())
}

/// Puts the pulls on the first springs into `pulls`, x and y of each (N, world); nothing where nobody holds.
fn pulls_of(row: &Row, pulls: &mut [Option<f64>]) -> Result<(), NotFinite> {
    pulls.fill(None);
    for tip in &row.tips {
        if let Some(pull) = pulls.get_mut(2 * tip.spring..2 * tip.spring + 2) {
            pull[0] = Some(finite("pull_x_n", tip.pull.x)?);
            pull[1] = Some(finite("pull_y_n", tip.pull.y)?);
        }
    }
    Ok(())
}

/// Writes `events.csv` with [`EVENT_COLUMNS`], in the order of time.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_events(trace: &Trace, out: impl Write) -> Result<(), TableError> {
    let mut lines = Lines::new(out, EVENT_COLUMNS.len());
    lines.head(&EVENT_COLUMNS)?;
    for event in &trace.events {
        lines.begin()?;
        lines.number(finite("time_s", event.time)?);
        lines.word(match event.kind {
            EventKind::Grasp => "grasp",
            EventKind::Release => "release",
        });
        lines.count(event.spring);
        match event.ant {
            Some(ant) => lines.count(ant),
            None => lines.nothing(1),
        }
        lines.numbers(&[Some(finite("tip_x_m", event.tip.x)?), Some(finite("tip_y_m", event.tip.y)?)]);
        lines.end();
    }
    lines.finish()?;
    Ok(())
}

/// Writes `transitions.csv` with [`TRANSITION_COLUMNS`], in the order of time: what the backend saw of onsets, stops, captures of supports and jumps. The
/// last three columns are those of a jump: where it led, and the energy that a load with inertia would have got into motion.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_transitions(trace: &Trace, out: impl Write) -> Result<(), TableError> {
    let mut lines = Lines::new(out, TRANSITION_COLUMNS.len());
    lines.head(&TRANSITION_COLUMNS)?;
    for Transition { time, kind } in &trace.transitions {
        lines.begin()?;
        lines.number(finite("time_s", *time)?);
        lines.word(kind.name());
        match kind {
            TransitionKind::Capture { support } | TransitionKind::Freed { support } => {
                lines.count(*support);
                lines.nothing(3);
            }
            TransitionKind::Jump { shift, turn, energy } => {
                lines.nothing(1);
                let (shift, turn, energy) = (finite("shift_m", *shift)?, finite("turn_rad", *turn)?, finite("energy_j", *energy)?);
                lines.numbers(&[Some(shift), Some(turn), Some(energy)]);
            }
            TransitionKind::Onset | TransitionKind::Stop => lines.nothing(4),
        }
        lines.end();
    }
    lines.finish()?;
    Ok(())
}

/// Writes a table of rows of two runs at the same instants: the time, every other column as expected and as found, and how far the two lie apart in
/// every measure.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_pairs(pairs: &[(check::Row, check::Row)], out: impl Write) -> Result<(), TableError> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
    let sides = check::COLUMNS[1..].iter().flat_map(|name| [format!("expected_{name}"), format!("found_{name}")]);
    let apart = check::MEASURES.iter().map(|measure| format!("apart_{}", measure.name));
    let head: Vec<_> = ["time_s".to_owned()].into_iter().chain(sides).chain(apart).collect();
    writer.write_record(&head)?;
    for (expected, found) in pairs {
        let sides = expected[1..].iter().zip(&found[1..]).flat_map(|(expected, found)| [*expected, *found]);
        let apart = check::MEASURES.iter().map(|measure| measure.apart(expected, found));
        let row: Vec<_> = [expected[0]].into_iter().chain(sides).chain(apart).collect();
        for (name, value) in head.iter().zip(&row) {
            finite(name, *value)?;
        }
        writer.serialize(row)?;
    }
    writer.flush()?;
    Ok(())
}

/// All of [`TRACE_COLUMNS`] but the count at their end.
fn state_of(row: &Row) -> [f64; TRACE_COLUMNS.len() - 1] {
    let (pose, twist, energy) = (&row.motion.pose, &row.motion.twist, &row.energy);
    [
        row.time,
        pose.position.x,
        pose.position.y,
        pose.heading,
        twist.linear.x,
        twist.linear.y,
        twist.angular,
        energy.elastic,
        energy.kinetic,
        energy.dissipated(),
        energy.tip_work,
        energy.defect(),
        row.interaction(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;
    use crate::report::synthetic;

    fn text(trace: &Trace, n_springs: usize) -> String {
        let mut bytes = Vec::new();
        write_trace(trace, n_springs, &mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    fn columns(text: &str) -> Vec<String> {
        csv::Reader::from_reader(text.as_bytes()).headers().unwrap().iter().map(str::to_owned).collect()
    }

    #[test]
    fn every_number_reads_back_as_it_was() {
        let mut trace = synthetic::trace(400, 1.0);
        // The hard cases: no short decimal, smallest subnormal, largest, negative zero.
        trace.rows[0].motion.pose.position = Vec2::new(0.1 + 0.2, f64::from_bits(1));
        trace.rows[0].motion.twist.linear = Vec2::new(-f64::MAX, -0.0);
        let text = text(&trace, 4);
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let mut n = 0;
        for (row, record) in trace.rows.iter().zip(reader.records()) {
            let record = record.unwrap();
            for (value, field) in state_of(row).iter().zip(&record) {
                assert_eq!(field.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{field}");
            }
            assert_eq!(record[TRACE_COLUMNS.len() - 1].parse::<usize>().unwrap(), row.tips.len());
            for j in 0..4 {
                let pull = row.tips.iter().find(|tip| tip.spring == j).map(|tip| tip.pull);
                assert_eq!(record[TRACE_COLUMNS.len() + 2 * j].parse().ok(), pull.map(|pull| pull.x));
                assert_eq!(record[TRACE_COLUMNS.len() + 1 + 2 * j].parse().ok(), pull.map(|pull| pull.y));
            }
            n += 1;
        }
        assert_eq!(n, trace.rows.len());
        assert!(trace.rows.iter().any(|row| row.tips.is_empty()) && trace.rows.iter().any(|row| row.tips.len() > 1));
    }

    #[test]
    fn the_contract_of_trace_csv_holds_and_many_springs_have_no_columns() {
        let trace = synthetic::trace(3, 1.0);
        let contract = "time_s,x_m,y_m,heading_rad,vx_m_per_s,vy_m_per_s,turn_rate_rad_per_s,";
        assert!(text(&trace, 1).starts_with(contract));
        assert_eq!(columns(&text(&trace, 1))[TRACE_COLUMNS.len()..], ["pull_x_0_n", "pull_y_0_n"]);
        assert_eq!(columns(&text(&trace, MOST_SPRINGS_WITH_COLUMNS)).len(), TRACE_COLUMNS.len() + 64);
        assert_eq!(columns(&text(&trace, MOST_SPRINGS_WITH_COLUMNS + 1)).len(), TRACE_COLUMNS.len());
    }

    #[test]
    fn events_name_the_ant_only_where_there_is_one() {
        let mut trace = synthetic::trace(400, 1.0);
        trace.events[0].ant = None;
        let mut bytes = Vec::new();
        write_events(&trace, &mut bytes).unwrap();
        let mut reader = csv::Reader::from_reader(&bytes[..]);
        assert_eq!(reader.headers().unwrap().iter().collect::<Vec<_>>(), EVENT_COLUMNS);
        let records: Vec<_> = reader.records().map(Result::unwrap).collect();
        assert_eq!(records.len(), trace.events.len());
        assert_eq!((&records[0][1], &records[0][3]), ("grasp", ""));
        assert_eq!(records[1][3], trace.events[1].ant.unwrap().to_string());
        assert_eq!(records[0][0].parse(), Ok(trace.events[0].time));
    }

    #[test]
    fn transitions_have_fields_only_where_there_is_something() {
        let kinds = [
            TransitionKind::Onset,
            TransitionKind::Capture { support: 2 },
            TransitionKind::Freed { support: 2 },
            TransitionKind::Jump { shift: 4e-3, turn: -0.1, energy: 2.5e-5 },
            TransitionKind::Stop,
        ];
        let transitions = kinds.map(|kind| Transition { time: 0.1 + 0.2, kind }).to_vec();
        let mut trace = Trace { transitions, ..Trace::default() };
        let mut bytes = Vec::new();
        write_transitions(&trace, &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let time = "0.30000000000000004";
        let rows =
            ["onset,,,,", "capture,2,,,", "freed,2,,,", "jump,,0.004,-0.1,0.000025", "stop,,,,"].map(|row| format!("{time},{row}\n"));
        assert_eq!(text, format!("{}\n{}", TRANSITION_COLUMNS.join(","), rows.concat()));

        trace.transitions[3].kind = TransitionKind::Jump { shift: 0.0, turn: f64::NAN, energy: 0.0 };
        assert!(write_transitions(&trace, Vec::new()).unwrap_err().to_string().starts_with("turn_rad is NaN"));
    }

    #[test]
    fn a_number_that_is_not_finite_is_refused_by_name() {
        let mut trace = synthetic::trace(5, 1.0);
        trace.rows[3].motion.pose.heading = f64::NAN;
        let error = write_trace(&trace, 1, Vec::new()).unwrap_err();
        assert!(error.to_string().starts_with("heading_rad is NaN"), "{error}");
    }
}
