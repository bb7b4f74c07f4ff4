//! Standstills before obstacles: how long a load makes no progress, and how that ends.
//!
//! The paper asks what sustained interaction forces do to avoid obstacles and to overcome deadlocks
//! (Section VIII). Progress is a new smallest distance to the nest, by a millimetre or more. A time
//! of at least [`HOLD_S`] without progress, from the first grasp on, is a standstill. It ends as
//! the load goes on without having gone back, after it has backed off by 5 mm or more, or with the
//! run.

use serde::{Deserialize, Serialize};

use super::units::Estimate;
use cohaul::backend::{BackendKind, BackendOptions};
use cohaul::formats::{self, Format, Versioned};
use cohaul::math::{Summary, Vec2};
use cohaul::scenario::{Drive, Scenario};
use cohaul::simulation::{Keep, Row, Simulation};
use cohaul_report::quantity::quantity;
use cohaul_report::table::Table;
use cohaul_report::text::wrapped_markdown;
use cohaul_studies::runner::Tasks;

/// Shortest time without progress that is a standstill (s): longer than any ant of the default
/// preset stays attached, so that every ant has had another try.
pub const HOLD_S: f64 = 10.0;
/// Decrease of the distance to the nest that is progress (m), and increase that is backing off.
const PROGRESS_M: f64 = 1e-3;
const BACK_M: f64 = 5e-3;

/// How a standstill ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// The load went on from where it stood.
    WentOn,
    /// The load went back by 5 mm or more before it came nearer.
    BackedOff,
    /// The run ended before the load came nearer.
    EndOfRun,
}

/// One time without progress.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standstill {
    pub from_s: f64,
    pub to_s: f64,
    pub ending: Ending,
    /// Share of its ticks at which the load touches an obstacle (1).
    pub touching: f64,
}

/// Standstills of one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunStandstills {
    pub arrived: bool,
    /// From the first grasp to the end of the run (s).
    pub duration_s: f64,
    pub standstills: Vec<Standstill>,
}

/// Times of at least `hold` (s) without progress towards the `nest` (m), in the order of time.
pub fn standstills(rows: &[Row], nest: Vec2, hold: f64, arrived: bool) -> Vec<Standstill> {
    let mut found = Vec::new();
    let Some(first) = rows.iter().position(|row| !row.tips.is_empty()) else { return found };
    let distance = |row: &Row| (row.motion.pose.position - nest).norm();
    let (mut nearest, mut since) = (distance(&rows[first]), first);
    let (mut farthest, mut n_touching) = (0.0f64, 0usize);
    let mut end = |since: usize, at: usize, ending: Ending, n_touching: usize| {
        let (from_s, to_s) = (rows[since].time, rows[at].time);
        if to_s - from_s >= hold {
            found.push(Standstill { from_s, to_s, ending, touching: n_touching as f64 / (at - since).max(1) as f64 });
        }
    };
    for (at, row) in rows.iter().enumerate().skip(first + 1) {
        n_touching += usize::from(!row.contacts.is_empty());
        let away = distance(row) - nearest;
        farthest = farthest.max(away);
        if away <= -PROGRESS_M {
            end(since, at, if farthest >= BACK_M { Ending::BackedOff } else { Ending::WentOn }, n_touching);
            (nearest, since, farthest, n_touching) = (distance(row), at, 0.0, 0);
        }
    }
    if !arrived {
        end(since, rows.len() - 1, Ending::EndOfRun, n_touching);
    }
    found
}

/// Runs a scene of ants on a backend and finds its standstills; `None` when `watch` said no, or
/// without ants.
pub fn run(scenario: &Scenario, backend: BackendKind, hold: f64, watch: impl Fn() -> bool) -> Option<RunStandstills> {
    let Drive::Ants(ants) = &scenario.drive else { return None };
    let options = BackendOptions::at_step(None, backend, &scenario.system, scenario.control_period);
    let mut run = Simulation::new(scenario, &options, Keep::Trace);
    run.run(|_| watch());
    if !run.is_finished() {
        return None;
    }
    let (trace, outcome) = run.into_results();
    let arrived = outcome.arrived == Some(true);
    let start = trace.rows.iter().find(|row| !row.tips.is_empty()).map_or(outcome.time, |row| row.time);
    let standstills = standstills(&trace.rows, ants.nest_position, hold, arrived);
    Some(RunStandstills { arrived, duration_s: outcome.time - start, standstills })
}

/// Scenes with ants, on all backends, at several seeds.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Names and scenes.
    pub scenes: Vec<(String, Scenario)>,
    pub first_seed: u64,
    pub n_seeds: u64,
    /// Shortest standstill (s).
    pub hold_s: f64,
}

impl Plan {
    /// Scene, backend and seed of a task.
    fn of(&self, task: usize) -> (usize, BackendKind, u64) {
        let n = self.n_seeds as usize;
        (
            task / n / BackendKind::COMPARED.len(),
            BackendKind::COMPARED[task / n % BackendKind::COMPARED.len()],
            self.first_seed + (task % n) as u64,
        )
    }

    /// All runs, scene by scene and backend by backend.
    pub fn tasks(&self) -> Tasks<'_, RunStandstills> {
        Tasks::equal(self.scenes.len() * BackendKind::COMPARED.len() * self.n_seeds as usize, |task, go_on| {
            let (scene, backend, seed) = self.of(task);
            run(&Scenario { seed, ..self.scenes[scene].1.clone() }, backend, self.hold_s, go_on)
        })
    }
}

/// Standstills of one scene on one backend.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeadlockRow {
    pub scene: String,
    pub backend: &'static str,
    pub n_runs: usize,
    pub n_arrived: usize,
    /// Share of the time from the first grasp on that is in standstills, mean over runs (1).
    pub share_of_time: Estimate,
    /// Runs with a standstill, and number of standstills by how they end.
    pub n_runs_with: usize,
    pub n_went_on: usize,
    pub n_backed_off: usize,
    pub n_end_of_run: usize,
    /// Longest standstill (s), and mean share of a standstill in which the load touches an obstacle
    /// (1); `null` without any.
    pub longest_s: Option<f64>,
    pub touching: Option<f64>,
}

/// What `paper deadlocks --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Deadlocks {
    pub first_seed: u64,
    pub n_seeds: u64,
    pub hold_s: f64,
    pub rows: Vec<DeadlockRow>,
}

impl Versioned for Deadlocks {
    const FORMAT: Format = formats::PAPER_DEADLOCKS;
}

impl Deadlocks {
    /// Of all runs of the plan.
    pub fn new(plan: &Plan, runs: &[RunStandstills]) -> Self {
        let rows = runs.chunks(plan.n_seeds as usize).enumerate().map(|(at, runs)| {
            let (scene, backend, _) = plan.of(at * plan.n_seeds as usize);
            DeadlockRow::of(&plan.scenes[scene].0, backend, runs)
        });
        Self { first_seed: plan.first_seed, n_seeds: plan.n_seeds, hold_s: plan.hold_s, rows: rows.collect() }
    }

    pub fn table(&self) -> Table {
        let heads = [
            "scene",
            "backend",
            "arrived",
            "share of time (95 %)",
            "runs with",
            "went on",
            "backed off",
            "end of run",
            "longest",
            "touching",
        ];
        let row = |row: &DeadlockRow| {
            // Equal runs have no spread, which is no certainty.
            let share = if row.n_runs_with == 0 { "0".to_owned() } else { super::with_interval(&Some(row.share_of_time), "") };
            let counts = [row.n_runs_with, row.n_went_on, row.n_backed_off, row.n_end_of_run].map(|n| n.to_string());
            let longest = row.longest_s.map_or_else(String::new, |time| quantity(time, "s"));
            let touching = row.touching.map_or_else(String::new, |share| format!("{:.0} %", 100.0 * share));
            let arrived = format!("{} of {}", row.n_arrived, row.n_runs);
            [vec![row.scene.clone(), row.backend.to_owned(), arrived, share], counts.to_vec(), vec![longest, touching]].concat()
        };
        Table::new("Standstills", heads).with_rows(self.rows.iter().map(row))
    }

    pub fn readme(&self) -> String {
        wrapped_markdown(&format!(
            "# Standstills before obstacles\n\nA standstill is a time of at least {} without progress, from the first grasp on: the load comes \
             no millimetre nearer to the nest than before. It ends as the load goes on, after it has backed off by 5 mm or more, or with the run. \
             The share of time is a mean over runs. Touching is the part of the standstills in which the load touches an obstacle. {} seeds from \
             {}.\n\n{}",
            quantity(self.hold_s, "s"),
            self.n_seeds,
            self.first_seed,
            self.table().markdown()
        ))
    }

    /// One row for each scene and backend.
    pub fn rows_table(&self) -> Table {
        let interval = |row: &DeadlockRow| row.share_of_time.interval_95;
        Table::of(
            &self.rows,
            &[
                ("scene", "", &|row| row.scene.as_str().into()),
                ("backend", "", &|row| row.backend.into()),
                ("n runs", "", &|row| row.n_runs.into()),
                ("n arrived", "", &|row| row.n_arrived.into()),
                ("share of time", "", &|row| row.share_of_time.value.into()),
                ("low 95", "", &|row| interval(row).map(|interval| interval.low).into()),
                ("high 95", "", &|row| interval(row).map(|interval| interval.high).into()),
                ("n runs with", "", &|row| row.n_runs_with.into()),
                ("n went on", "", &|row| row.n_went_on.into()),
                ("n backed off", "", &|row| row.n_backed_off.into()),
                ("n end of run", "", &|row| row.n_end_of_run.into()),
                ("longest", "s", &|row| row.longest_s.into()),
                ("touching", "", &|row| row.touching.into()),
            ],
        )
    }
}

impl DeadlockRow {
    fn of(scene: &str, backend: BackendKind, runs: &[RunStandstills]) -> Self {
        let all = || runs.iter().flat_map(|run| &run.standstills);
        let duration = |standstill: &Standstill| standstill.to_s - standstill.from_s;
        let share = |run: &RunStandstills| run.standstills.iter().map(duration).sum::<f64>() / run.duration_s.max(f64::MIN_POSITIVE);
        let shares = Summary::of(runs.iter().map(share));
        let n_of = |ending: Ending| all().filter(|standstill| standstill.ending == ending).count();
        let touching = Summary::of(all().map(|standstill| standstill.touching));
        let error = (shares.n() > 1).then(|| shares.sd() / (shares.n() as f64).sqrt());
        Self {
            scene: scene.to_owned(),
            backend: backend.name(),
            n_runs: runs.len(),
            n_arrived: runs.iter().filter(|run| run.arrived).count(),
            share_of_time: Estimate::students(shares.mean(), error, runs.len()),
            n_runs_with: runs.iter().filter(|run| !run.standstills.is_empty()).count(),
            n_went_on: n_of(Ending::WentOn),
            n_backed_off: n_of(Ending::BackedOff),
            n_end_of_run: n_of(Ending::EndOfRun),
            longest_s: all().map(duration).reduce(f64::max),
            touching: (touching.n() > 0).then(|| touching.mean()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::backend::{EnergyLedger, Motion};
    use cohaul::math::{Pose, Twist};
    use cohaul::simulation::{AttachedTip, AttachedTips};

    /// A load on a line to the nest at 1 m: its place at these times (s, m), straight between; an
    /// ant pulls from the second on.
    fn rows(course: &[[f64; 2]]) -> Vec<Row> {
        let tip = AttachedTip { spring: 0, position: Vec2::zeros(), pull: Vec2::zeros() };
        let at = |time: f64| {
            let next = course.iter().position(|[end, _]| *end >= time).unwrap().max(1);
            let ([from, start], [to, end]) = (course[next - 1], course[next]);
            start + (end - start) * (time - from) / (to - from)
        };
        let row = |tick: u32| {
            let time = 0.5 * f64::from(tick);
            Row {
                time,
                motion: Motion { pose: Pose::new(at(time), 0.0, 0.0), twist: Twist::default() },
                energy: EnergyLedger::default(),
                tips: AttachedTips::from_vec(if time < 1.0 { Vec::new() } else { vec![tip] }),
                contacts: Vec::new(),
                steered: Vec::new(),
                error: None,
            }
        };
        (0..=(2.0 * course.last().unwrap()[0]) as u32).map(row).collect()
    }

    /// The load goes, stands for 12 s, goes, goes back by 8 mm and on after 20 s in all, stands for
    /// 5 s, which is none, and then for good.
    #[test]
    fn standstills_are_found_with_their_endings() {
        let course = [
            [0.0, 0.0],
            [10.0, 0.1],
            [22.0, 0.1],
            [30.0, 0.2],
            [40.0, 0.192],
            [50.0, 0.2],
            [60.0, 0.3],
            [65.0, 0.3],
            [70.0, 0.35],
            [90.0, 0.35],
        ];
        let nest = Vec2::new(1.0, 0.0);
        let found = standstills(&rows(&course), nest, 10.0, false);
        let endings: Vec<Ending> = found.iter().map(|one| one.ending).collect();
        assert_eq!(endings, [Ending::WentOn, Ending::BackedOff, Ending::EndOfRun]);
        // Between ticks of half a second, at 10 mm/s or more.
        for (one, [from, to]) in found.iter().zip([[10.0, 22.0], [30.0, 50.0], [70.0, 90.0]]) {
            assert!((one.from_s - from).abs() <= 0.5 && (one.to_s - to).abs() <= 0.5, "{one:?}");
        }
        assert_eq!(standstills(&rows(&course), nest, 10.0, true).len(), 2);
        assert_eq!(standstills(&rows(&course), nest, 4.0, true).len(), 3);
        // Without an ant nothing is looked for.
        assert!(standstills(&rows(&course)[..2], nest, 0.0, false).is_empty());
        let runs = [true, false].map(|arrived| RunStandstills {
            arrived,
            duration_s: 80.0,
            standstills: standstills(&rows(&course), nest, 10.0, arrived),
        });
        let row = DeadlockRow::of("line", BackendKind::QuasiStatic, &runs);
        assert_eq!((row.n_arrived, row.n_runs_with, row.n_backed_off, row.n_end_of_run), (1, 2, 2, 1));
        assert!((row.share_of_time.value - (32.0 + 52.0) / 160.0).abs() < 0.03, "{row:?}");
    }
}
