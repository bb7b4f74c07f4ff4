//! Output folder of `paper`: tables as CSV, figures, summary and manifest.

use std::path::Path;

use serde::Serialize;

use crate::output::folder::{FolderError, OutputFolder};
use crate::output::manifest::Manifest;
use crate::studies::paper::readme::paper_readme;
use crate::studies::paper::report::Paper;
use crate::studies::paper::text::paper_text;
use crate::studies::paper::{Estimate, RunFacts, Trial};

/// Figures by the name of their file.
pub type Figures = Vec<(&'static str, String)>;

/// Writes `table.csv`, `claims.csv`, `group-size.csv`, `transitions.csv`, `conclusions.csv`,
/// `replayed.csv`, `fit.csv`, `runs.csv`, the `figures`, `README.md`, `table.txt`, `summary.json`
/// and `manifest.json` to the folder `target`, all or nothing. A table without rows is left out.
///
/// # Errors
///
/// When the folder may not be written, or the disk fails.
pub fn write_paper(
    target: &Path,
    found: &Paper,
    runs: &[(usize, Trial, u64, &RunFacts)],
    figures: &Figures,
    manifest: &Manifest,
) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    write_lines(&mut folder, "table.csv", table_lines(found))?;
    write_lines(&mut folder, "claims.csv", claim_lines(found))?;
    write_lines(&mut folder, "group-size.csv", size_lines(found))?;
    write_lines(&mut folder, "transitions.csv", found.transitions.iter())?;
    write_lines(&mut folder, "conclusions.csv", conclusion_lines(found))?;
    write_lines(&mut folder, "replayed.csv", replayed_lines(found))?;
    write_lines(&mut folder, "fit.csv", fit_lines(found))?;
    write_lines(&mut folder, "runs.csv", run_lines(found, runs))?;
    for (name, svg) in figures {
        folder.write(&format!("{name}.svg"), |out| out.write_all(svg.as_bytes()))?;
    }
    folder.write("README.md", |out| out.write_all(paper_readme(found).as_bytes()))?;
    folder.write("table.txt", |out| out.write_all(paper_text(found).as_bytes()))?;
    folder.write_json("summary.json", found)?;
    folder.finish(manifest)
}

/// Writes a table with the names of its columns, unless it has no rows.
fn write_lines<T: Serialize>(folder: &mut OutputFolder, name: &str, rows: impl Iterator<Item = T>) -> Result<(), FolderError> {
    let mut rows = rows.peekable();
    if rows.peek().is_none() {
        return Ok(());
    }
    folder.write(name, |out| -> Result<(), csv::Error> {
        let mut writer = csv::Writer::from_writer(out);
        rows.try_for_each(|row| writer.serialize(row))?;
        Ok(writer.flush()?)
    })
}

/// A number with its interval, as cells.
#[derive(Serialize, Default)]
struct Cells {
    value: Option<f64>,
    low_95: Option<f64>,
    high_95: Option<f64>,
    n_seeds: usize,
}

impl Cells {
    fn of(estimate: Option<Estimate>) -> Self {
        estimate.map_or_else(Self::default, |estimate| Self {
            value: Some(estimate.value),
            low_95: estimate.interval_95.map(|interval| interval.low),
            high_95: estimate.interval_95.map(|interval| interval.high),
            n_seeds: estimate.n_units,
        })
    }
}

#[derive(Serialize)]
struct TableLine<'a> {
    quantity: &'a str,
    unit: &'a str,
    printed: Option<f64>,
    set: &'a str,
    value: Option<f64>,
    low_95: Option<f64>,
    high_95: Option<f64>,
    n_seeds: usize,
    grade: &'a str,
    minus_first: Option<f64>,
    minus_first_low_95: Option<f64>,
    minus_first_high_95: Option<f64>,
    why: &'a str,
}

/// One line for each quantity and set.
fn table_lines(found: &Paper) -> impl Iterator<Item = TableLine<'_>> {
    found.table.iter().flat_map(|row| {
        let line = move |set, value: Option<Estimate>, grade: Option<crate::studies::paper::Grade>, minus: Option<Estimate>, why| {
            let (cells, minus) = (Cells::of(value), Cells::of(minus));
            TableLine {
                quantity: &row.quantity,
                unit: row.unit,
                printed: row.printed,
                set,
                value: cells.value,
                low_95: cells.low_95,
                high_95: cells.high_95,
                n_seeds: cells.n_seeds,
                grade: grade.map_or("", |grade| grade.name()),
                minus_first: minus.value,
                minus_first_low_95: minus.low_95,
                minus_first_high_95: minus.high_95,
                why,
            }
        };
        let first = line(&found.sets[0].name[..], row.ours, row.grade, None, &row.why[..]);
        let others = row.on_others.iter().map(move |other| line(&other.set[..], other.value, other.grade, other.minus_first, ""));
        std::iter::once(first).chain(others)
    })
}

#[derive(Serialize)]
struct ClaimLine<'a> {
    claim: &'a str,
    statistic: &'a str,
    side: &'a str,
    limit: f64,
    value: Option<f64>,
    low_95: Option<f64>,
    high_95: Option<f64>,
    holds: Option<bool>,
}

fn claim_lines(found: &Paper) -> impl Iterator<Item = ClaimLine<'_>> {
    found.claims.iter().map(|claim| {
        let cells = Cells::of(claim.found);
        ClaimLine {
            claim: claim.claim,
            statistic: &claim.statistic,
            side: if claim.below { "below" } else { "above" },
            limit: claim.limit,
            value: cells.value,
            low_95: cells.low_95,
            high_95: cells.high_95,
            holds: claim.holds,
        }
    })
}

#[derive(Serialize)]
struct SizeLine {
    n_transporting: usize,
    trial: Trial,
    load_speed_m_per_s: Option<f64>,
    low_95: Option<f64>,
    high_95: Option<f64>,
    sd_over_runs_m_per_s: Option<f64>,
    load_speed_by_tick_m_per_s: Option<f64>,
    time_s: f64,
    n_instants: u64,
    printed_instants: Option<u64>,
    headway_m_per_s: Option<f64>,
    headway_low_95: Option<f64>,
    headway_high_95: Option<f64>,
}

fn size_lines(found: &Paper) -> impl Iterator<Item = SizeLine> + '_ {
    found.load_speed.iter().map(|speeds| {
        let (cells, headway) = (Cells::of(speeds.load_speed_m_per_s), Cells::of(speeds.headway_m_per_s));
        SizeLine {
            n_transporting: speeds.n_transporting,
            trial: speeds.trial,
            load_speed_m_per_s: cells.value,
            low_95: cells.low_95,
            high_95: cells.high_95,
            sd_over_runs_m_per_s: speeds.sd_over_runs_m_per_s,
            load_speed_by_tick_m_per_s: speeds.load_speed_by_tick_m_per_s,
            time_s: speeds.time_s,
            n_instants: speeds.n_instants,
            printed_instants: speeds.printed_instants,
            headway_m_per_s: headway.value,
            headway_low_95: headway.low_95,
            headway_high_95: headway.high_95,
        }
    })
}

#[derive(Serialize)]
struct ConclusionLine<'a> {
    conclusion: &'a str,
    set: &'a str,
    value: Option<f64>,
    holds: Option<bool>,
    is_changed: bool,
}

fn conclusion_lines(found: &Paper) -> impl Iterator<Item = ConclusionLine<'_>> {
    found.conclusions.iter().flat_map(|conclusion| {
        conclusion.on.iter().map(|standing| ConclusionLine {
            conclusion: &conclusion.conclusion,
            set: &standing.set,
            value: standing.value,
            holds: standing.holds,
            is_changed: conclusion.changed_on.contains(&standing.set),
        })
    })
}

#[derive(Serialize)]
struct ReplayedLine<'a> {
    trial: Trial,
    seed: u64,
    duration_s: f64,
    verdict: &'a str,
    inertia_effect_m: f64,
    engine_error_m: f64,
    reference_error_m: f64,
    path_length_m: f64,
    tolerance_m: f64,
    first_divergence_s: Option<f64>,
}

fn replayed_lines(found: &Paper) -> impl Iterator<Item = ReplayedLine<'_>> {
    found.replayed.iter().map(|one| ReplayedLine {
        trial: one.trial,
        seed: one.seed,
        duration_s: one.duration_s,
        verdict: &one.verdict,
        inertia_effect_m: one.inertia_effect_m,
        engine_error_m: one.engine_error_m,
        reference_error_m: one.reference_error_m,
        path_length_m: one.path_length_m,
        tolerance_m: one.tolerance_m,
        first_divergence_s: one.first_divergence_s,
    })
}

#[derive(Serialize)]
struct FitLine {
    preset: &'static str,
    release_pace: crate::model::behaviour::ReleasePace,
    pull_speed_m_per_s: f64,
    release_decision_period_s: f64,
    steering_half_angle_rad: f64,
    sensing_range_m: f64,
    score: f64,
    pull_mean_n: f64,
    pull_sd_n: f64,
    pull_max_n: f64,
    n_pulls: u64,
    share_of_6: f64,
    share_of_7: f64,
    share_of_8: f64,
    share_of_9: f64,
    share_of_10: f64,
    time_four_s: f64,
    time_five_s: f64,
    time_ten_s: f64,
}

fn fit_lines(found: &Paper) -> impl Iterator<Item = FitLine> + '_ {
    found.fit.iter().map(|row| {
        let (point, fitted) = (&row.point, &row.found);
        let [share_of_6, share_of_7, share_of_8, share_of_9, share_of_10] = fitted.size_shares;
        FitLine {
            preset: point.preset.map_or("", |preset| preset.name()),
            release_pace: point.release_pace,
            pull_speed_m_per_s: point.pull_speed_m_per_s,
            release_decision_period_s: point.release_decision_period_s,
            steering_half_angle_rad: point.steering_half_angle_rad,
            sensing_range_m: point.sensing_range_m,
            score: row.score,
            pull_mean_n: fitted.pull_mean_n,
            pull_sd_n: fitted.pull_sd_n,
            pull_max_n: fitted.pull_max_n,
            n_pulls: fitted.n_pulls,
            share_of_6,
            share_of_7,
            share_of_8,
            share_of_9,
            share_of_10,
            time_four_s: fitted.time_four_s,
            time_five_s: fitted.time_five_s,
            time_ten_s: fitted.time_ten_s,
        }
    })
}

#[derive(Serialize)]
struct RunLine<'a> {
    set: &'a str,
    trial: Trial,
    seed: u64,
    arrived: bool,
    time_s: f64,
    displacement_m: f64,
    n_grasps: u64,
    pull_mean_n: f64,
    pull_sd_n: f64,
    pull_max_n: f64,
    n_pulls: u64,
    /// Over time, not over decisions.
    pull_mean_by_time_n: f64,
    pull_sd_by_time_n: f64,
    speed_changes_at_s: Option<f64>,
    speed_change_p: Option<f64>,
}

fn run_lines<'a>(found: &'a Paper, runs: &'a [(usize, Trial, u64, &RunFacts)]) -> impl Iterator<Item = RunLine<'a>> {
    runs.iter().map(|(set, trial, seed, facts)| RunLine {
        set: &found.sets[*set].name,
        trial: *trial,
        seed: *seed,
        arrived: facts.arrived,
        time_s: facts.time_s,
        displacement_m: facts.displacement_m,
        n_grasps: facts.n_grasps,
        pull_mean_n: facts.pulls.mean(),
        pull_sd_n: facts.pulls.sd(),
        pull_max_n: facts.pulls.max(),
        n_pulls: facts.pulls.n(),
        pull_mean_by_time_n: facts.pulls_by_time.mean(),
        pull_sd_by_time_n: facts.pulls_by_time.sd(),
        speed_changes_at_s: facts.changes.speed.map(|change| change.time_s),
        speed_change_p: facts.changes.speed.map(|change| change.change.p_value),
    })
}
