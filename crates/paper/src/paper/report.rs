//! The paper's results made again, for programs: tables that follow from the answers of a study.

use serde::Serialize;
use serde_json::Value;

use crate::paper::{
    Answer, At, Change, ChangeOf, Changes, Claim, Conclusion, Experiment, ForceRow, Grade, Missed, Mixture, Plan, Replayed, RunFacts, Set,
    Speeds, TableRow, Task, Trial, Unit, claims, conclusions, experiment, force_rows, load_speeds, missed, mixture, table, units,
};
use cohaul::backend::{BackendKind, Status};
use cohaul::formats::{self, Format, Versioned};

/// What `paper --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Paper {
    /// What became of the printed numbers and of the claims.
    pub answer: String,
    pub preset: &'static str,
    /// Keys of the scenarios that were set, with their values.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<(String, Value)>,
    pub first_seed: u64,
    pub quick: bool,
    pub wall_s: f64,
    /// The worst ending of a step in all runs.
    pub status: Status,
    pub sets: Vec<SetLine>,
    /// What is printed and not reproduced, on the first set.
    pub not_reproduced: Vec<Missed>,
    /// On the first set, beside the others.
    pub table: Vec<TableRow>,
    pub claims: Vec<Claim>,
    /// The printed counts of Fig. 9 as a mixture of the trials of the first set.
    pub mixture: Option<Mixture>,
    /// What the paper measured on ants, beside the first set.
    pub experiment: Vec<Experiment>,
    /// Inertial force of the load, on the set with the paper's inertia.
    pub inertial_force: Vec<ForceRow>,
    pub load_speed: Vec<Speeds>,
    pub transitions: Vec<TransitionRow>,
    pub conclusions: Vec<Conclusion>,
    pub replayed: Vec<Replayed>,
}

impl Versioned for Paper {
    const FORMAT: Format = formats::PAPER;
}

/// A set of runs that have all in common but trial and seed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SetLine {
    pub name: String,
    pub preset: &'static str,
    pub backend: &'static str,
    /// Over that of the paper's load (1).
    pub inertia: f64,
    pub n_seeds: u64,
    pub n_runs: usize,
    pub n_arrived: usize,
}

/// Changes of mean in one series over the runs of one trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TransitionRow {
    pub trial: Trial,
    pub series: &'static str,
    pub n_runs: usize,
    /// In which a change is significant at 5 %; chance alone makes a twentieth of them so.
    pub n_significant: usize,
    /// Of those, in which the mean rises.
    pub n_rising: usize,
    /// Medians over the significant changes: time (s), time over that of the run (1), and mean
    /// after over mean before (1).
    pub median_time_s: Option<f64>,
    pub median_time_share: Option<f64>,
    pub median_ratio: Option<f64>,
}

/// Runs of one set with their trials and seeds.
pub type Runs<'a> = Vec<(Trial, u64, &'a RunFacts)>;

/// The runs of each set, by trial and seed.
pub fn runs_by_set<'a>(plan: &Plan, done: &'a [Answer]) -> Vec<Runs<'a>> {
    let mut by_set: Vec<Runs> = vec![Vec::new(); plan.sets.len()];
    for (task, answer) in plan.tasks().into_iter().zip(done) {
        if let (Task::Run { set, trial, seed }, Answer::Run(facts)) = (task, answer) {
            by_set[set].push((trial, seed, facts));
        }
    }
    by_set.iter_mut().for_each(|runs| runs.sort_by_key(|(trial, seed, _)| (*trial, *seed)));
    by_set
}

impl Paper {
    /// Of a study that is done.
    pub fn new(plan: &Plan, done: &[Answer], quick: bool, wall_s: f64) -> Self {
        let runs = runs_by_set(plan, done);
        let sets: Vec<(String, Vec<Unit>)> = plan.sets.iter().zip(&runs).map(|(set, runs)| (set_name(plan, set), units(runs))).collect();
        // Other presets are other models: no conclusion is about them.
        let is_same_model = |set: &Set| set.case.preset == plan.preset;
        let same_model: Vec<_> = sets.iter().zip(&plan.sets).filter(|(_, set)| is_same_model(set)).map(|(set, _)| set.clone()).collect();
        let first = &sets[0].1;
        let control_period = Trial::TEN_TEN.scenario(&plan.sets[0].case, 1).control_period;
        let (table, claims) = (table(&sets), claims(first));
        // The exact model, with the inertia of the paper's load.
        let is_inertial = |set: &Set| set.case.backend == BackendKind::Inertial && set.case.inertia == 1.0 && is_same_model(set);
        let inertial = plan.sets.iter().position(is_inertial);
        let replayed = |answer: &Answer| if let Answer::Replay(found) = answer { Some((**found).clone()) } else { None };
        Self {
            answer: answer(&table, &claims),
            preset: plan.preset.name(),
            set: plan.sets[0].case.set.clone(),
            first_seed: plan.first_seed,
            quick,
            wall_s,
            status: runs.iter().flatten().map(|(_, _, facts)| facts.status).max().unwrap_or_default(),
            sets: plan.sets.iter().zip(&runs).map(|(set, runs)| SetLine::new(set_name(plan, set), set, runs)).collect(),
            not_reproduced: missed(&table, &claims),
            table,
            claims,
            mixture: mixture(first, control_period),
            experiment: experiment(first),
            inertial_force: inertial.map_or_else(Vec::new, |at| force_rows(&sets[at].1)),
            load_speed: load_speeds(first, control_period),
            transitions: transitions(&runs[0]),
            conclusions: conclusions(&same_model),
            replayed: done.iter().filter_map(replayed).collect(),
        }
    }
}

fn answer(table: &[TableRow], claims: &[Claim]) -> String {
    let of_grade = |grade: Grade| table.iter().filter(|row| row.grade == Some(grade)).count();
    let of_claims = |holds: Option<bool>| claims.iter().filter(|claim| claim.holds == holds).count();
    format!(
        "Of {} printed numbers, {} are met and {} were calibrated; {} differ, and {} are undecided. Of {} claims, {} hold, {} do not, and {} cannot be told.",
        table.iter().filter(|row| row.grade.is_some()).count(),
        of_grade(Grade::Match) + of_grade(Grade::Near),
        of_grade(Grade::Calibrated),
        of_grade(Grade::Differs),
        of_grade(Grade::Undecided),
        claims.len(),
        of_claims(Some(true)),
        of_claims(Some(false)),
        of_claims(None)
    )
}

impl Paper {
    /// The preset and what was set beside it, for people.
    pub fn reading(&self) -> String {
        let set = self.set.iter().map(|(key, value)| format!(" with {key} = {value}"));
        format!("preset {}{}", self.preset, set.collect::<Vec<_>>().join(","))
    }
}

/// Backend, inertia and preset, as far as they differ from the usual.
fn set_name(plan: &Plan, set: &Set) -> String {
    let case = &set.case;
    if case.preset != plan.preset {
        return case.preset.name().to_owned();
    }
    if case.inertia == 1.0 { case.backend.name().to_owned() } else { format!("inertia x {}", case.inertia) }
}

impl SetLine {
    fn new(name: String, Set { case, n_seeds, .. }: &Set, runs: &Runs) -> Self {
        Self {
            name,
            preset: case.preset.name(),
            backend: case.backend.name(),
            inertia: if case.backend.has_inertia() { case.inertia } else { 0.0 },
            n_seeds: *n_seeds,
            n_runs: runs.len(),
            n_arrived: runs.iter().filter(|(_, _, facts)| facts.arrived).count(),
        }
    }
}

fn transitions(runs: &Runs) -> Vec<TransitionRow> {
    let row = |trial: Trial, (series, change): (&'static str, ChangeOf)| {
        let own = runs.iter().filter(|(of, ..)| *of == trial);
        let found: Vec<_> = own.filter_map(|(.., facts)| Some((change(&facts.changes)?, facts.time_s))).collect();
        let significant: Vec<_> = found.iter().filter(|(at, _)| at.change.is_significant()).collect();
        let median = |of: fn(&Change, f64, f64) -> f64| {
            median(significant.iter().map(|(At { time_s, change }, duration)| of(change, *time_s, *duration)).collect())
        };
        TransitionRow {
            trial,
            series,
            n_runs: found.len(),
            n_significant: significant.len(),
            n_rising: significant.iter().filter(|(at, _)| at.change.mean_after > at.change.mean_before).count(),
            median_time_s: median(|_, time_s, _| time_s),
            median_time_share: median(|_, time_s, duration| time_s / duration),
            median_ratio: median(|change, _, _| change.mean_after / change.mean_before).filter(|ratio| ratio.is_finite()),
        }
    };
    let trials = Trial::ALL.into_iter().filter(|trial| trial.n_ants() > 1);
    trials.flat_map(|trial| Changes::OF_SERIES.map(|series| row(trial, series))).collect()
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
