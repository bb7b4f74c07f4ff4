//! A trace as CSV tables: `trace.csv` with a row at every control tick, `events.csv` with every
//! grasp and release, `transitions.csv` with every instant at which the load's motion is not
//! smooth.
//!
//! Floats are written with the fewest digits that read back as the same number. A field is empty
//! where there is no value: the pull on a spring without attachment, the ant of a prescribed path,
//! the size of a transition other than a jump.

use std::io::Write;

use crate::lines::{Lines, TableError};
use cohaul::backend::{Transition, TransitionKind};
use cohaul::simulation::{Row, Trace};

/// Largest number of springs for which `trace.csv` has columns of pulls. With more springs these
/// would be most of the file; the column `n_transporting` remains.
pub const MOST_SPRINGS_WITH_COLUMNS: usize = 32;

/// First columns of every `trace.csv`: the time and the load's motion.
pub const MOTION_COLUMNS: [&str; 7] = ["time_s", "x_m", "y_m", "heading_rad", "vx_m_per_s", "vy_m_per_s", "turn_rate_rad_per_s"];

/// Columns of a full `trace.csv`, before those of pulls: the energy ledger, and the sum of Eq. (4)
/// over all pairs of attachments.
pub const FORCE_COLUMNS: [&str; 6] = ["elastic_j", "kinetic_j", "dissipated_j", "tip_work_j", "defect_j", "interaction_n"];

/// The column of every `trace.csv` with the number of attached springs, after the motion and, in a
/// full file, the [`FORCE_COLUMNS`].
pub const N_TRANSPORTING: &str = "n_transporting";

/// Which columns a `trace.csv` has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceColumns {
    /// [`MOTION_COLUMNS`] and [`N_TRANSPORTING`].
    Motion,
    /// All columns of [`TraceColumns::Motion`], [`FORCE_COLUMNS`], and `pull_x_<j>_n,pull_y_<j>_n`
    /// for each spring j: the force of the attached ant or robot on the tip (world axes). Files
    /// with more than [`MOST_SPRINGS_WITH_COLUMNS`] springs have no columns of pulls. The file is
    /// about four times as large.
    Full { n_springs: usize },
}

impl TraceColumns {
    /// Number of springs whose pulls have columns.
    pub(super) fn n_pulls(self) -> usize {
        match self {
            Self::Full { n_springs } if n_springs <= MOST_SPRINGS_WITH_COLUMNS => n_springs,
            _ => 0,
        }
    }

    pub(super) fn names(self) -> Vec<String> {
        let forces = if self == Self::Motion { &[][..] } else { &FORCE_COLUMNS };
        let pulls = (0..self.n_pulls()).flat_map(|j| [format!("pull_x_{j}_n"), format!("pull_y_{j}_n")]);
        MOTION_COLUMNS.iter().chain(forces).chain([&N_TRANSPORTING]).map(|name| (*name).to_owned()).chain(pulls).collect()
    }
}

/// Columns of `events.csv`.
pub const EVENT_COLUMNS: [&str; 6] = ["time_s", "event", "spring", "ant", "tip_x_m", "tip_y_m"];

/// Columns of `transitions.csv`.
pub const TRANSITION_COLUMNS: [&str; 8] = ["time_s", "transition", "support", "shift_m", "turn_rad", "energy_j", "obstacle", "law"];

/// Writer of a `trace.csv`.
pub struct TraceTable<W> {
    columns: TraceColumns,
    lines: Lines<W>,
    /// Buffer of the pulls of one row (N, world).
    pulls: Vec<f64>,
}

impl<W: Write> TraceTable<W> {
    /// Begins the file with the names of its columns.
    ///
    /// # Errors
    /// When `out` fails.
    pub fn new(columns: TraceColumns, out: W) -> Result<Self, TableError> {
        Ok(Self { columns, lines: Lines::new(out, &columns.names())?, pulls: vec![f64::NAN; 2 * columns.n_pulls()] })
    }

    /// Writes these rows.
    ///
    /// # Errors
    /// When a number is not finite, or `out` fails.
    pub fn add(&mut self, rows: &[Row]) -> Result<(), TableError> {
        for row in rows {
            self.lines.begin()?;
            self.lines.numbers(&motion_of(row))?;
            if self.columns != TraceColumns::Motion {
                self.lines.numbers(&forces_of(row))?;
            }
            self.lines.count(row.tips.len());
            if !self.pulls.is_empty() {
                pulls_of(row, &mut self.pulls);
                self.lines.numbers_or_nothing(&self.pulls)?;
            }
            self.lines.end();
        }
        Ok(())
    }

    /// Ends the file and returns `out`.
    ///
    /// # Errors
    /// When `out` fails.
    pub fn finish(self) -> Result<W, TableError> {
        Ok(self.lines.finish()?)
    }
}

/// Writes `trace.csv` with these columns.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_trace(trace: &Trace, columns: TraceColumns, out: impl Write) -> Result<(), TableError> {
    let mut table = TraceTable::new(columns, out)?;
    table.add(&trace.rows)?;
    table.finish().map(drop)
}

/// Writes the pulls on the first springs into `pulls`, x and y of each (N, world). Springs without
/// attachment have NaN.
pub(super) fn pulls_of(row: &Row, pulls: &mut [f64]) {
    pulls.fill(f64::NAN);
    for tip in &row.tips {
        if let Some(pull) = pulls.get_mut(2 * tip.spring..2 * tip.spring + 2) {
            pull.copy_from_slice(&[tip.pull.x, tip.pull.y]);
        }
    }
}

/// Writes `events.csv` with [`EVENT_COLUMNS`], in the order of time.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_events(trace: &Trace, out: impl Write) -> Result<(), TableError> {
    let mut lines = Lines::new(out, &EVENT_COLUMNS)?;
    for event in &trace.events {
        lines.begin()?;
        lines.numbers(&[event.time])?;
        lines.word(event.kind.name());
        lines.count(event.spring);
        match event.ant {
            Some(ant) => lines.count(ant),
            None => lines.nothing(1),
        }
        lines.numbers(&[event.tip.x, event.tip.y])?;
        lines.end();
    }
    lines.finish()?;
    Ok(())
}

/// Writes `transitions.csv` with [`TRANSITION_COLUMNS`], in the order of time: slip onsets, stops,
/// pinnings and unpinnings of supports, jumps, and what happens at obstacles. Shift and turn belong
/// to jumps. The energy is what a jump would have given to a load with inertia, or what an impact
/// lost; the law is the one that the velocity after an impact follows.
///
/// # Errors
/// When a number is not finite, or `out` fails.
pub fn write_transitions(trace: &Trace, out: impl Write) -> Result<(), TableError> {
    let mut lines = Lines::new(out, &TRANSITION_COLUMNS)?;
    for Transition { time, kind } in &trace.transitions {
        lines.begin()?;
        lines.numbers(&[*time])?;
        lines.word(kind.name());
        match kind {
            TransitionKind::Pinning { support } | TransitionKind::Unpinning { support } => {
                lines.count(*support);
                lines.nothing(5);
            }
            TransitionKind::Jump { shift, turn, energy, .. } => {
                lines.nothing(1);
                lines.numbers(&[*shift, *turn, *energy])?;
                lines.nothing(2);
            }
            TransitionKind::Touch { obstacle }
            | TransitionKind::Separation { obstacle }
            | TransitionKind::SideStick { obstacle }
            | TransitionKind::SideSlip { obstacle }
            | TransitionKind::NotUnique { obstacle }
            | TransitionKind::Squeeze { obstacle } => {
                lines.nothing(4);
                lines.count(*obstacle);
                lines.nothing(1);
            }
            TransitionKind::Impact { obstacle, energy, law } => {
                lines.nothing(3);
                lines.numbers(&[*energy])?;
                lines.count(*obstacle);
                lines.word(law.name());
            }
            TransitionKind::SlipOnset | TransitionKind::Stop => lines.nothing(6),
        }
        lines.end();
    }
    lines.finish()?;
    Ok(())
}

/// [`MOTION_COLUMNS`] of a row.
pub(super) fn motion_of(row: &Row) -> [f64; MOTION_COLUMNS.len()] {
    let (pose, twist) = (&row.motion.pose, &row.motion.twist);
    [row.time, pose.position.x, pose.position.y, pose.heading, twist.linear.x, twist.linear.y, twist.angular]
}

/// [`FORCE_COLUMNS`] of a row.
pub(super) fn forces_of(row: &Row) -> [f64; FORCE_COLUMNS.len()] {
    let energy = &row.energy;
    [energy.elastic, energy.kinetic, energy.dissipated(), energy.tip_work, energy.defect(), row.interaction()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use cohaul::backend::ImpactLaw;
    use cohaul::math::Vec2;

    fn text(trace: &Trace, columns: TraceColumns) -> String {
        let mut bytes = Vec::new();
        write_trace(trace, columns, &mut bytes).unwrap();
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
        let [motion, full] = [TraceColumns::Motion, TraceColumns::Full { n_springs: 4 }].map(|columns| text(&trace, columns));
        let [mut motion, mut full] = [&motion, &full].map(|text| csv::Reader::from_reader(text.as_bytes()));
        let bits = |fields: Vec<&str>| fields.iter().map(|field| field.parse::<f64>().unwrap().to_bits()).collect::<Vec<_>>();
        let (n_motion, n_forces) = (MOTION_COLUMNS.len(), FORCE_COLUMNS.len());
        let mut n = 0;
        for ((row, motion), full) in trace.rows.iter().zip(motion.records()).zip(full.records()) {
            let (motion, full) = (motion.unwrap(), full.unwrap());
            let expected: Vec<u64> = motion_of(row).iter().chain(&forces_of(row)).map(|value| value.to_bits()).collect();
            assert_eq!(bits(full.iter().take(n_motion + n_forces).collect()), expected);
            assert_eq!(full[n_motion + n_forces].parse(), Ok(row.tips.len()));
            for j in 0..4 {
                let pull = row.tips.iter().find(|tip| tip.spring == j).map(|tip| tip.pull);
                assert_eq!(full[n_motion + n_forces + 1 + 2 * j].parse().ok(), pull.map(|pull| pull.x));
                assert_eq!(full[n_motion + n_forces + 2 + 2 * j].parse().ok(), pull.map(|pull| pull.y));
            }
            assert!(
                motion.iter().eq(full.iter().take(n_motion).chain([&full[n_motion + n_forces]])),
                "the same fields: {motion:?} {full:?}"
            );
            n += 1;
        }
        assert_eq!(n, trace.rows.len());
        assert!(trace.rows.iter().any(|row| row.tips.is_empty()) && trace.rows.iter().any(|row| row.tips.len() > 1));
    }

    #[test]
    fn the_contract_of_trace_csv_holds_and_many_springs_have_no_columns() {
        let trace = synthetic::trace(3, 1.0);
        let contract = "time_s,x_m,y_m,heading_rad,vx_m_per_s,vy_m_per_s,turn_rate_rad_per_s,";
        assert!(text(&trace, TraceColumns::Motion).starts_with(&format!("{contract}n_transporting\n")));
        let of_springs = |n_springs| columns(&text(&trace, TraceColumns::Full { n_springs }));
        let n_others = MOTION_COLUMNS.len() + FORCE_COLUMNS.len() + 1;
        assert!(text(&trace, TraceColumns::Full { n_springs: 1 }).starts_with(contract));
        assert_eq!(of_springs(1)[n_others - 1..], ["n_transporting", "pull_x_0_n", "pull_y_0_n"]);
        assert_eq!(of_springs(MOST_SPRINGS_WITH_COLUMNS).len(), n_others + 64);
        assert_eq!(of_springs(MOST_SPRINGS_WITH_COLUMNS + 1).len(), n_others);
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
            TransitionKind::SlipOnset,
            TransitionKind::Pinning { support: 2 },
            TransitionKind::Unpinning { support: 2 },
            TransitionKind::Touch { obstacle: 1 },
            TransitionKind::Jump { shift: 4e-3, turn: -0.1, energy: 2.5e-5, is_uncertain: true },
            TransitionKind::Impact { obstacle: 0, energy: 0.5, law: ImpactLaw::Poisson },
            TransitionKind::Stop,
        ];
        let transitions = kinds.map(|kind| Transition { time: 0.1 + 0.2, kind }).to_vec();
        let mut trace = Trace { transitions, ..Trace::default() };
        let mut bytes = Vec::new();
        write_transitions(&trace, &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let time = "0.30000000000000004";
        let rows = [
            "slip_onset,,,,,,",
            "pinning,2,,,,,",
            "unpinning,2,,,,,",
            "touch,,,,,1,",
            "jump,,0.004,-0.1,0.000025,,",
            "impact,,,,0.5,0,poisson",
            "stop,,,,,,",
        ]
        .map(|row| format!("{time},{row}\n"));
        assert_eq!(text, format!("{}\n{}", TRANSITION_COLUMNS.join(","), rows.concat()));

        trace.transitions[4].kind = TransitionKind::Jump { shift: 0.0, turn: f64::NAN, energy: 0.0, is_uncertain: false };
        assert!(write_transitions(&trace, Vec::new()).unwrap_err().to_string().starts_with("turn_rad is NaN"));
    }
}
