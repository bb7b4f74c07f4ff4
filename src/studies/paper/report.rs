//! The paper's results made again, for programs: tables that follow from the answers of a study.

use serde::Serialize;

use crate::backend::{BackendKind, Status};
use crate::model::paper as printed;
use crate::studies::paper::why::{why, why_maximum};
use crate::studies::paper::{
    Answer, Claim, Conclusion, Estimate, Experiment, Extreme, ForceRow, Grade, MEASURES, Measure, Missed, Mixture, OtherSet, Plan, Printed,
    Replayed, RunFacts, Sample, Sampling, Speeds, TableRow, Task, Trial, Unit, claims, conclusions, experiment, extreme, force_rows,
    load_speeds, missed, mixture, units,
};

/// What `paper --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Paper {
    /// What became of the printed numbers and of the claims.
    pub answer: String,
    pub preset: &'static str,
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

/// The runs of all sets, by set.
pub struct Runs<'a> {
    pub by_set: Vec<Vec<(Trial, u64, &'a RunFacts)>>,
}

impl<'a> Runs<'a> {
    pub fn new(plan: &Plan, done: &'a [Answer]) -> Self {
        let mut by_set: Vec<Vec<(Trial, u64, &RunFacts)>> = vec![Vec::new(); plan.sets.len()];
        for (task, answer) in answers(plan, done) {
            if let (Task::Run { set, trial, seed }, Answer::Run(facts)) = (task, answer) {
                by_set[set].push((trial, seed, facts));
            }
        }
        by_set.iter_mut().for_each(|runs| runs.sort_by_key(|(trial, seed, _)| (*trial, *seed)));
        Self { by_set }
    }

    /// All runs with the number of their set.
    pub fn flat(&self) -> Vec<(usize, Trial, u64, &'a RunFacts)> {
        let of_set = |(set, runs): (usize, &Vec<(Trial, u64, &'a RunFacts)>)| {
            runs.iter().map(|(trial, seed, facts)| (set, *trial, *seed, *facts)).collect::<Vec<_>>()
        };
        self.by_set.iter().enumerate().flat_map(of_set).collect()
    }

    pub fn units(&self, set: usize) -> Vec<Unit<'a>> {
        units(self.by_set[set].iter().copied())
    }
}

fn answers<'a>(plan: &Plan, done: &'a [Answer]) -> impl Iterator<Item = (Task, &'a Answer)> {
    plan.tasks().into_iter().zip(done)
}

impl Paper {
    /// Of a study that is done.
    pub fn new(plan: &Plan, done: &[Answer], quick: bool, wall_s: f64) -> Self {
        let runs = Runs::new(plan, done);
        let names: Vec<String> = (0..plan.sets.len()).map(|at| set_name(plan, at)).collect();
        let sets: Vec<(String, Vec<Unit>)> = names.iter().cloned().zip((0..names.len()).map(|at| runs.units(at))).collect();
        // Other presets are other models: no conclusion is about them.
        let same_model: Vec<_> =
            sets.iter().zip(&plan.sets).filter(|(_, set)| set.case.preset == plan.preset).map(|(set, _)| set.clone()).collect();
        let first = &sets[0].1;
        let control_period = Trial::TEN_TEN.scenario(&plan.sets[0].case, 1).control_period;
        let (table, claims) = (table(&sets), claims(first));
        // The exact model, with the inertia of the paper's load.
        let is_inertial = |set: &crate::studies::paper::Set| set.case.backend == BackendKind::Inertial && set.case.inertia == 1.0;
        let inertial = plan.sets.iter().position(|set| is_inertial(set) && set.case.preset == plan.preset);
        Self {
            answer: answer(&table, &claims),
            preset: plan.preset.name(),
            first_seed: plan.first_seed,
            quick,
            wall_s,
            status: runs.by_set.iter().flatten().map(|(_, _, facts)| facts.status).max().unwrap_or_default(),
            sets: (0..names.len()).map(|at| set_line(plan, at, &names[at], &runs.by_set[at])).collect(),
            not_reproduced: missed(&table, &claims),
            table,
            claims,
            mixture: mixture(first, control_period),
            experiment: experiment(first),
            inertial_force: inertial.map_or_else(Vec::new, |at| force_rows(&sets[at].1)),
            load_speed: load_speeds(first, control_period),
            transitions: transitions(&runs.by_set[0]),
            conclusions: conclusions(&same_model),
            replayed: answers(plan, done)
                .filter_map(|(_, answer)| if let Answer::Replay(found) = answer { Some((**found).clone()) } else { None })
                .collect(),
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

/// Backend, inertia and preset, as far as they differ from the usual.
fn set_name(plan: &Plan, at: usize) -> String {
    let case = &plan.sets[at].case;
    if case.preset != plan.preset {
        return case.preset.name().to_owned();
    }
    if case.inertia == 1.0 { case.backend.name().to_owned() } else { format!("inertia x {}", case.inertia) }
}

fn set_line(plan: &Plan, at: usize, name: &str, runs: &[(Trial, u64, &RunFacts)]) -> SetLine {
    let case = &plan.sets[at].case;
    SetLine {
        name: name.to_owned(),
        preset: case.preset.name(),
        backend: case.backend.name(),
        inertia: if case.backend.has_inertia() { case.inertia } else { 0.0 },
        n_seeds: plan.sets[at].n_seeds,
        n_runs: runs.len(),
        n_arrived: runs.iter().filter(|(_, _, facts)| facts.arrived).count(),
    }
}

fn table(sets: &[(String, Vec<Unit>)]) -> Vec<TableRow> {
    let mut rows: Vec<TableRow> = MEASURES.iter().map(|measure| row_of(*measure, sets)).collect();
    for (at, sampling) in Sampling::ALL.into_iter().enumerate() {
        rows.insert(2 + 3 * at, maximum_row(sets, sampling));
    }
    rows
}

fn row_of(measure: Measure, sets: &[(String, Vec<Unit>)]) -> TableRow {
    let first = &sets[0].1;
    let printed = measure.printed();
    let graded = |units: &[Unit], ours: &Option<Estimate>| ours.as_ref().and_then(|ours| measure.grade(units, ours));
    let other = |(name, units): &(String, Vec<Unit>)| {
        let value = measure.estimate(units);
        let minus_first = measure.difference(units, first);
        let is_shifted = minus_first.and_then(|found| found.interval_95).is_some_and(|interval| interval.low > 0.0 || interval.high < 0.0);
        OtherSet { set: name.clone(), value, grade: graded(units, &value), minus_first, is_shifted }
    };
    let ours = measure.estimate(first);
    TableRow {
        quantity: measure.name(),
        unit: measure.unit(),
        printed: printed.map(|printed| printed.value),
        ours,
        grade: graded(first, &ours),
        why: why(measure).to_owned(),
        on_others: sets[1..].iter().map(other).collect(),
    }
}

/// The largest pull of a sample of the printed size; its interval is that of one such sample.
fn maximum_row(sets: &[(String, Vec<Unit>)], sampling: Sampling) -> TableRow {
    let printed = Printed::new(printed::PULL_MAX_N, 0.05e-3);
    let of = |units: &[Unit]| -> Option<(Estimate, Grade)> {
        let found = largest(units, sampling)?;
        let estimate = Estimate { value: found.expected, interval_95: Some(found.draw_95), standard_error: None, n_units: units.len() };
        Some((estimate, printed.graded(found.expected, Some(found.error_95), found.draw)))
    };
    let other = |(name, units): &(String, Vec<Unit>)| {
        let found = of(units);
        let (value, grade) = (found.map(|found| found.0), found.map(|found| found.1));
        OtherSet { set: name.clone(), value, grade, minus_first: None, is_shifted: false }
    };
    let first = of(&sets[0].1);
    let why = largest(&sets[0].1, sampling).map_or_else(String::new, |found| why_maximum(&found));
    TableRow {
        quantity: format!("pull, largest of {}, {}", printed::N_PULLS, sampling.name()),
        unit: "N",
        printed: Some(printed.value),
        ours: first.map(|found| found.0),
        grade: first.map(|found| found.1),
        why,
        on_others: sets[1..].iter().map(other).collect(),
    }
}

/// The largest pull of a sample of the printed size from the printed trials.
pub fn largest(units: &[Unit], sampling: Sampling) -> Option<Extreme> {
    extreme(units, |unit| Sample::Printed.runs(unit).into_iter().map(|run| sampling.pulls(run)).collect(), printed::N_PULLS)
}

fn transitions(runs: &[(Trial, u64, &RunFacts)]) -> Vec<TransitionRow> {
    let series = ["speed", "turn rate", "interaction"];
    let row = |trial: Trial, at: usize| {
        let own: Vec<&RunFacts> = runs.iter().filter(|(of, ..)| *of == trial).map(|(_, _, facts)| *facts).collect();
        let change = |facts: &&RunFacts| {
            let changes = [facts.changes.speed, facts.changes.turn_rate, facts.changes.interaction];
            changes[at].map(|change| (change, facts.time_s))
        };
        let found: Vec<_> = own.iter().filter_map(change).collect();
        let significant: Vec<_> = found.iter().filter(|(change, _)| change.change.is_significant()).collect();
        let median = |of: &dyn Fn(&(crate::studies::paper::ChangeAt, f64)) -> f64| median(significant.iter().map(|one| of(one)).collect());
        TransitionRow {
            trial,
            series: series[at],
            n_runs: found.len(),
            n_significant: significant.len(),
            n_rising: significant.iter().filter(|(change, _)| change.change.mean_after > change.change.mean_before).count(),
            median_time_s: median(&|(change, _)| change.time_s),
            median_time_share: median(&|(change, duration)| change.time_s / duration),
            median_ratio: median(&|(change, _)| change.change.mean_after / change.change.mean_before).filter(|ratio| ratio.is_finite()),
        }
    };
    Trial::ALL
        .into_iter()
        .filter(|trial| trial.n_ants() > 1)
        .flat_map(|trial| (0..3).map(move |at| (trial, at)))
        .map(|(trial, at)| row(trial, at))
        .collect()
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
