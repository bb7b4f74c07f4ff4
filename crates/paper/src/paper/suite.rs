//! What a study of the paper consists of: runs and replays, as tasks.

use serde::{Deserialize, Serialize};

use super::trial::{Case, Trial};
use super::{RunFacts, facts};
use cohaul::analysis::compare::{Settings, ThreeWay};
use cohaul::backend::BackendKind;
use cohaul::scenario::presets::Preset;
use cohaul_studies::runner::Tasks;

/// What a study is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    pub preset: Preset,
    pub first_seed: u64,
    /// Each with its numbers of seeds.
    pub sets: Vec<Set>,
    /// Trials that are replayed pathwise.
    pub replayed: Vec<Trial>,
    /// Followed no longer than this (s).
    pub replayed_s: f64,
}

/// Seeds of one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Set {
    pub case: Case,
    pub n_seeds: u64,
    /// Of the first seeds, those that are run with other numbers of ants on ten springs, too.
    pub n_crowd_seeds: u64,
}

/// One piece of work.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Task {
    Run { set: usize, trial: Trial, seed: u64 },
    Replay { trial: Trial },
}

/// What came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    Run(Box<RunFacts>),
    Replay(Box<Replayed>),
}

/// Summary of a pathwise comparison of the backends: largest edge displacements (m).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Replayed {
    pub trial: Trial,
    pub seed: u64,
    pub duration_s: f64,
    pub verdict: String,
    pub inertia_effect_m: f64,
    pub engine_error_m: f64,
    pub reference_error_m: f64,
    /// Path length (m).
    pub path_length_m: f64,
    /// Edge displacement that counts as agreement (m).
    pub tolerance_m: f64,
    pub causes: Vec<String>,
    /// Time at which the inertia effect first exceeds the tolerance (s); `null` if it does not.
    pub first_divergence_s: Option<f64>,
}

impl Plan {
    /// Tasks in their order. Expensive tasks come first, so that no processor is left with one at
    /// the end.
    pub fn tasks(&self) -> Vec<Task> {
        let seeds = |n: u64| self.first_seed..self.first_seed + n;
        let crowds = (1..=10).map(Trial::OnTen).filter(|trial| !Trial::ALL.contains(trial));
        let trials = |set: &Set| {
            let (of_paper, of_crowd) = (seeds(set.n_seeds), seeds(set.n_crowd_seeds));
            let of_paper = Trial::ALL.into_iter().flat_map(move |trial| of_paper.clone().map(move |seed| (trial, seed)));
            of_paper.chain(crowds.clone().flat_map(move |trial| of_crowd.clone().map(move |seed| (trial, seed))))
        };
        let runs = self.sets.iter().enumerate();
        let runs = runs.flat_map(|(set, of)| trials(of).map(move |(trial, seed)| Task::Run { set, trial, seed }));
        let replays = self.replayed.iter().map(|trial| Task::Replay { trial: *trial });
        let mut tasks: Vec<Task> = replays.chain(runs).collect();
        tasks.sort_by(|a, b| self.cost(b).total_cmp(&self.cost(a)));
        tasks
    }

    /// About the time that a task takes (s); for progress and order only.
    fn cost(&self, task: &Task) -> f64 {
        match task {
            Task::Replay { .. } => 0.3 * self.replayed_s,
            Task::Run { set, trial, .. } => {
                let case = &self.sets[*set].case;
                let simulated = match trial {
                    Trial::OneOne => 240.0,
                    Trial::FourFour => 85.0,
                    Trial::OnTen(n_ants) => 30.0 + 240.0 / f64::from(*n_ants).powi(2),
                };
                simulated
                    * match (case.backend.is_exact(), case.backend.has_inertia()) {
                        (true, false) => 1e-3,
                        (true, true) => 3e-3 / case.inertia.sqrt().clamp(0.3, 1.5),
                        (false, _) => 2e-2,
                    }
            }
        }
    }

    fn answer(&self, task: &Task, watch: &(impl Fn() -> bool + Sync)) -> Option<Answer> {
        match task {
            Task::Run { set, trial, seed } => Some(Answer::Run(Box::new(facts::run(*trial, &self.sets[*set].case, *seed, |_| watch())?))),
            Task::Replay { trial } => Some(Answer::Replay(Box::new(self.replay(*trial, watch)?))),
        }
    }

    fn replay(&self, trial: Trial, watch: &(impl Fn() -> bool + Sync)) -> Option<Replayed> {
        let first = &self.sets[0].case;
        let case = Case { backend: BackendKind::QuasiStatic, inertia: 1.0, ..first.clone() };
        let mut scenario = trial.scenario(&case, self.first_seed);
        scenario.duration = scenario.duration.min(self.replayed_s);
        let found = ThreeWay::new(&scenario, &Settings::default()).replayed(|_| watch())?;
        Some(Replayed {
            trial,
            seed: self.first_seed,
            duration_s: found.solutions[1].trace.rows.last().map_or(0.0, |row| row.time),
            verdict: found.verdict.text().to_owned(),
            inertia_effect_m: found.edge_displacement.inertia_effect_m,
            engine_error_m: found.edge_displacement.engine_error_m,
            reference_error_m: found.edge_displacement.reference_error_m,
            path_length_m: found.path_length_m,
            tolerance_m: found.tolerance_m,
            causes: found.causes.iter().map(|cause| cause.text().to_owned()).collect(),
            first_divergence_s: found.first_divergence.inertia_effect.map(|divergence| divergence.time_s),
        })
    }
}

/// The tasks of `plan`, numbered as [`Plan::tasks`] does.
pub fn tasks(plan: &Plan) -> Tasks<'_, Answer> {
    let tasks = plan.tasks();
    let costs = tasks.iter().map(|task| plan.cost(task)).collect();
    Tasks { costs, run: Box::new(move |task, go_on| plan.answer(&tasks[task], &go_on)) }
}
