//! What is kept of a run: sums that add over runs, and where its series change.

use serde::{Deserialize, Serialize};

use super::change::{Change, change_of_mean};
use super::force::{ForceAt, inertial_forces};
use super::phase::{PhaseChange, phase_change};
use super::trial::{Case, Trial};
use super::window::{gathered, window};
use cohaul::backend::{BackendOptions, Status};
use cohaul::math::{Summary, Vec2};
use cohaul::model::interaction_force;
use cohaul::model::paper::MEASURED_LIMIT_N;
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{EventKind, Keep, Row, Simulation, Trace};

/// One run in a few numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunFacts {
    pub arrived: bool,
    /// End of the run (s): arrival, or the longest time.
    pub time_s: f64,
    /// From start to end as the crow flies (m).
    pub displacement_m: f64,
    pub status: Status,
    /// Pulls at the ants' decisions, and a zero at each grasp (N).
    pub pulls: Summary,
    pub n_grasps: u64,
    /// Pulls at every control tick (N): the same forces by time, not by decision.
    pub pulls_by_time: Summary,
    /// Number of those above the printed 30 mN.
    pub n_pulls_above: u64,
    /// By how many ants pulled, from none.
    pub by_size: Vec<OfSize>,
    /// Sums by the mean number of pulling ants in a window, rounded, for each of [`WINDOWS`]. A
    /// jump at a release then counts for the group that caused it.
    pub by_window: [Vec<OfSize>; WINDOWS.len()],
    pub changes: Changes,
    /// Inertial force of the load by smoothing time; empty on a backend without inertia.
    pub inertial_force: Vec<ForceAt>,
}

#[cfg(test)]
impl RunFacts {
    /// Of a run of a second in which nothing happened but that it arrived.
    pub fn nothing() -> Self {
        Self { arrived: true, time_s: 1.0, ..Self::default() }
    }
}

/// Time and displacement of the load while a number of ants pulled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OfSize {
    pub time_s: f64,
    pub way_m: f64,
}

/// Where the three series of a run change their mean within its [`window`]; `None` where a series
/// is too short.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Changes {
    pub speed: Option<At<Change>>,
    pub turn_rate: Option<At<Change>>,
    pub interaction: Option<At<Change>>,
    /// The printed change of all three at once.
    pub phase: Option<At<PhaseChange>>,
}

/// A change, and its time in the run (s).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct At<T> {
    pub time_s: f64,
    #[serde(flatten)]
    pub change: T,
}

/// Speed of the load, its turn rate and the sum of all interaction forces (Eq. 4), as means over
/// windows of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Start of the first window (s).
    pub start_s: f64,
    /// Length of a window (s): [`WINDOW_S`], rounded to whole periods.
    pub window_s: f64,
    /// (m/s)
    pub speed: Vec<f64>,
    /// (rad/s), of either sense.
    pub turn_rate: Vec<f64>,
    /// (N)
    pub interaction: Vec<f64>,
}

/// Length of a window (s): a few decisions.
pub const WINDOW_S: f64 = 0.5;
/// Lengths of the windows by which speeds are sorted by group size (s).
pub const WINDOWS: [f64; 3] = [0.1, WINDOW_S, 2.0];
/// Place of [`WINDOW_S`] among them.
pub const MIDDLE_WINDOW: usize = 1;
/// Windows in a block of the test for a change: 4 s, longer than any ant holds on.
pub const BLOCK: usize = 8;
/// Time between two evaluations of all interaction forces (s). They change with decisions, not with
/// ticks.
const LOOK_S: f64 = 0.02;

/// Runs `trial` at `seed`. `watch` receives the fraction done (1) and returns whether to go on; the
/// result is `None` if it ended the run.
pub fn run(trial: Trial, case: &Case, seed: u64, watch: impl Fn(f64) -> bool) -> Option<RunFacts> {
    let scenario = trial.scenario(case, seed);
    run_scenario(trial, &scenario, &case.options(&scenario), watch)
}

/// The same of a scenario of `trial` made elsewhere.
pub(super) fn run_scenario(trial: Trial, scenario: &Scenario, options: &BackendOptions, watch: impl Fn(f64) -> bool) -> Option<RunFacts> {
    let mut run = Simulation::new(scenario, options, Keep::Trace);
    run.run(|time| watch(time / scenario.duration));
    if !run.is_finished() {
        return None;
    }
    let (trace, outcome) = run.into_results();
    let n_grasps = trace.events.iter().filter(|event| event.kind == EventKind::Grasp).count() as u64;
    let pulls = || trace.rows.iter().flat_map(|row| row.tips.iter().map(|tip| tip.pull.norm()));
    Some(RunFacts {
        arrived: outcome.arrived == Some(true),
        time_s: outcome.time,
        displacement_m: (outcome.motion.pose.position - scenario.start.pose.position).norm(),
        status: outcome.steps.status,
        pulls: outcome.pulls,
        n_grasps,
        pulls_by_time: Summary::of(pulls()),
        n_pulls_above: pulls().filter(|pull| *pull > MEASURED_LIMIT_N).count() as u64,
        by_size: by_size(&trace, trial.n_ants(), 1),
        by_window: WINDOWS.map(|window| by_size(&trace, trial.n_ants(), ticks_in(window, scenario.control_period))),
        changes: Changes::of(&series_in_window(&trace, scenario), scenario.seed),
        inertial_force: if options.kind.has_inertia() { inertial_forces(&trace, scenario.system.load.mass) } else { Vec::new() },
    })
}

/// Sums by the rounded mean number of pulling ants over `ticks` ticks each.
fn by_size(trace: &Trace, n_ants: usize, ticks: usize) -> Vec<OfSize> {
    let mut found = vec![OfSize::default(); n_ants + 1];
    let last = trace.rows.len().saturating_sub(1);
    for from in (0..last).step_by(ticks) {
        let rows = &trace.rows[from..=(from + ticks).min(last)];
        let n_holders: usize = rows[..rows.len() - 1].iter().map(|row| row.tips.len()).sum();
        let of_size = &mut found[(n_holders as f64 / (rows.len() - 1) as f64).round() as usize];
        of_size.time_s += rows[rows.len() - 1].time - rows[0].time;
        of_size.way_m += rows.windows(2).map(|pair| (pair[1].motion.pose.position - pair[0].motion.pose.position).norm()).sum::<f64>();
    }
    found
}

/// The three series of a run from its first grasp to its end; empty without a grasp.
pub fn series_of(trace: &Trace, scenario: &Scenario) -> Series {
    let first = trace.rows.partition_point(|row| row.tips.is_empty());
    Series::of_rows(&trace.rows[first..], scenario.control_period, 1)
}

/// The three series of a run within its [`window`]; empty where no window begins.
pub fn series_in_window(trace: &Trace, scenario: &Scenario) -> Series {
    let Drive::Ants(ants) = &scenario.drive else { return Series::default() };
    let n_pulling = ants.n_ants.min(scenario.system.springs.len());
    Series::of_rows(window(&trace.rows, n_pulling, Some(ants.nest_position)), scenario.control_period, 1)
}

/// Number of periods in a duration (s): at least one, and one that rows can have (1).
pub fn ticks_in(duration: f64, period: f64) -> usize {
    (duration / period).round().clamp(1.0, 1e9) as usize
}

impl Series {
    /// Those of rows at equal times, `period` apart (s), once the team has gathered.
    pub fn once_gathered(rows: &[Row], period: f64, nest: Option<Vec2>) -> Self {
        Self::of_rows(window(rows, gathered(rows), nest), period, ticks_in(WINDOW_S, period))
    }

    /// The series of rows at equal times, `period` apart (s), from the first one on. Motion is the
    /// sum of the displacements over `step` rows each: over single rows, noise of recorded poses
    /// would count as motion. A window holds a whole number of steps.
    pub fn of_rows(rows: &[Row], period: f64, step: usize) -> Self {
        let (stride, ticks) = (ticks_in(LOOK_S, period), ticks_in(WINDOW_S, period));
        let (start_s, window_s) = (rows.first().map_or(0.0, |row| row.time), ticks as f64 * period);
        let mut series = Series { start_s, window_s, ..Series::default() };
        for rows in rows.windows(ticks + 1).step_by(ticks) {
            let duration = rows[ticks].time - rows[0].time;
            let places: Vec<&Row> = rows.iter().step_by(step).collect();
            let along = |way: fn(&Row, &Row) -> f64| places.windows(2).map(|pair| way(pair[0], pair[1])).sum::<f64>() / duration;
            series.speed.push(along(|a, b| (b.motion.pose.position - a.motion.pose.position).norm()));
            series.turn_rate.push(along(|a, b| (b.motion.pose.heading - a.motion.pose.heading).abs()));
            let looked_at = rows[..ticks].iter().step_by(stride);
            let n = looked_at.len() as f64;
            series.interaction.push(looked_at.map(interaction).sum::<f64>() / n);
        }
        series
    }

    /// Start of the first window and end of the last one (s).
    pub fn span(&self) -> [f64; 2] {
        [self.start_s, self.start_s + self.window_s * self.speed.len() as f64]
    }
}

/// Sum of the sizes of the interaction forces of all pairs (N).
fn interaction(row: &Row) -> f64 {
    let pairs = row.tips.iter().enumerate().flat_map(|(i, a)| row.tips[i + 1..].iter().map(move |b| (a, b)));
    pairs.map(|(a, b)| interaction_force([a.position, b.position], [a.pull, b.pull]).abs()).sum()
}

/// One of the changes of a run.
pub type ChangeOf = fn(&Changes) -> Option<At<Change>>;

impl Changes {
    /// The changes of the three series by their names.
    pub const OF_SERIES: [(&'static str, ChangeOf); 3] =
        [("speed", |of| of.speed), ("turn rate", |of| of.turn_rate), ("interaction", |of| of.interaction)];

    pub fn of(series: &Series, seed: u64) -> Self {
        let time_s = |at: usize| series.start_s + series.window_s * at as f64;
        let of = |values: &[f64]| change_of_mean(values, BLOCK, seed).map(|change| At { time_s: time_s(change.at), change });
        let phase = phase_change([&series.speed, &series.turn_rate, &series.interaction], BLOCK, seed);
        let phase = phase.map(|change| At { time_s: time_s(change.at), change });
        Self { speed: of(&series.speed), turn_rate: of(&series.turn_rate), interaction: of(&series.interaction), phase }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::backend::BackendKind;
    use cohaul::scenario::presets::Preset;

    /// Times by group size add up to the run, decisions include the grasps, and an ended run has no
    /// result.
    #[test]
    fn a_run_is_accounted_for() {
        let case = Case::new(Preset::default(), BackendKind::QuasiStatic);
        let facts = run(Trial::TEN_TEN, &case, 1, |_| true).unwrap();
        assert!(facts.arrived && facts.by_size.len() == 11);
        let time: f64 = facts.by_size.iter().map(|of_size| of_size.time_s).sum();
        // Rounding of a sum of ten thousand ticks.
        assert!((time - facts.time_s).abs() < 1e-9, "{time} {}", facts.time_s);
        let way: f64 = facts.by_size.iter().map(|of_size| of_size.way_m).sum();
        assert!(way >= facts.displacement_m);
        assert!(facts.n_grasps > 100 && facts.pulls.n() > facts.n_grasps);
        assert_eq!(run(Trial::TEN_TEN, &case, 1, |share| share < 0.01), None);
    }
}
