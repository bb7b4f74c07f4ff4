//! Output folder of `paper`: tables as CSV, figures, summary and manifest.

use std::path::Path;

use crate::paper::figure::Figures;
use crate::paper::readme::{paper_page, paper_readme};
use crate::paper::report::{Paper, Runs};
use crate::paper::text::paper_text;
use crate::paper::{Estimate, Grade, OtherSet, TableRow, printed_share};
use cohaul::model::paper::SIMULATED_SAMPLES;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::REPORT;
use cohaul_report::table::{Field, Table, write_rows};
use cohaul_report::text::Detail;

/// Writes `table.csv`, `not-reproduced.csv`, `claims.csv`, `group-size.csv`, `samples.csv`,
/// `experiment.csv`, `inertial-force.csv`, `transitions.csv`, `conclusions.csv`, `replayed.csv`,
/// `runs.csv`, the `figures`, `README.md`, `report.html`, `table.txt`, `summary.json`
/// and `manifest.json` to the folder `target`, all or nothing. A table without rows is left out.
///
/// # Errors
///
/// When the folder may not be written, or the disk fails.
pub fn write_paper(target: &Path, found: &Paper, runs: &[Runs], figures: &Figures, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    let tables = [
        ("table.csv", quantities(found)),
        ("not-reproduced.csv", not_reproduced(found)),
        ("claims.csv", claims(found)),
        ("group-size.csv", group_sizes(found)),
        ("samples.csv", samples(found)),
        ("experiment.csv", experiment(found)),
        ("inertial-force.csv", inertial_force(found)),
        ("conclusions.csv", conclusions(found)),
        ("replayed.csv", replayed(found)),
        ("runs.csv", run_table(found, runs)),
    ];
    for (name, table) in tables.iter().filter(|(_, table)| !table.rows.is_empty()) {
        folder.write(name, |out| table.write_csv(out))?;
    }
    if !found.transitions.is_empty() {
        folder.write("transitions.csv", |out| write_rows(&found.transitions, out))?;
    }
    for (name, _, svg) in figures {
        folder.write(&format!("{name}.svg"), |out| out.write_all(svg.as_bytes()))?;
    }
    folder.write("README.md", |out| out.write_all(paper_readme(found).as_bytes()))?;
    folder.write(REPORT, |out| out.write_all(paper_page(found, figures, manifest).to_html().as_bytes()))?;
    folder.write("table.txt", |out| out.write_all(paper_text(found, Detail::Full).as_bytes()))?;
    folder.write_json("summary.json", found)?;
    folder.finish(manifest)
}

fn value(estimate: &Option<Estimate>) -> Field {
    estimate.map(|estimate| estimate.value).into()
}

fn low(estimate: &Option<Estimate>) -> Field {
    estimate.and_then(|estimate| estimate.interval_95).map(|interval| interval.low).into()
}

fn high(estimate: &Option<Estimate>) -> Field {
    estimate.and_then(|estimate| estimate.interval_95).map(|interval| interval.high).into()
}

/// One row for each quantity and set.
fn quantities(found: &Paper) -> Table {
    let mut rows: Vec<(&TableRow, OtherSet, &str)> = Vec::new();
    for row in &found.table {
        let set = found.sets[0].name.clone();
        rows.push((row, OtherSet { set, value: row.ours, grade: row.grade, minus_first: None, is_shifted: false }, &row.why));
        rows.extend(row.on_others.iter().map(|other| (row, other.clone(), "")));
    }
    Table::of(
        &rows,
        &[
            ("quantity", "", &|(row, ..)| row.quantity.as_str().into()),
            ("unit", "", &|(row, ..)| row.unit.into()),
            ("printed", "", &|(row, ..)| row.printed.into()),
            ("set", "", &|(_, on, _)| on.set.as_str().into()),
            ("value", "", &|(_, on, _)| value(&on.value)),
            ("low 95", "", &|(_, on, _)| low(&on.value)),
            ("high 95", "", &|(_, on, _)| high(&on.value)),
            ("n seeds", "", &|(_, on, _)| on.value.map_or(0, |estimate| estimate.n_units).into()),
            ("grade", "", &|(_, on, _)| on.grade.map_or("", Grade::name).into()),
            ("minus first", "", &|(_, on, _)| value(&on.minus_first)),
            ("minus first low 95", "", &|(_, on, _)| low(&on.minus_first)),
            ("minus first high 95", "", &|(_, on, _)| high(&on.minus_first)),
            ("why", "", &|(.., why)| (*why).into()),
        ],
    )
}

fn not_reproduced(found: &Paper) -> Table {
    Table::of(
        &found.not_reproduced,
        &[
            ("what", "", &|it| it.what.as_str().into()),
            ("paper", "", &|it| it.paper.as_str().into()),
            ("here", "", &|it| it.here.as_str().into()),
            ("is certain", "", &|it| it.is_certain.into()),
        ],
    )
}

/// One row for each number of pulling ants: printed samples beside the mixture of the trials.
fn samples(found: &Paper) -> Table {
    let sizes: Vec<usize> = if found.mixture.is_some() { (1..=10).collect() } else { Vec::new() };
    Table::of(
        &sizes,
        &[
            ("n pulling", "", &|size| (*size).into()),
            ("printed samples", "", &|size| SIMULATED_SAMPLES[size - 1].into()),
            ("samples of the mixture", "", &|size| found.mixture.as_ref().map(|mixture| mixture.n_samples(*size)).into()),
            ("printed share of 2 or more", "", &|size| Some(printed_share(*size)).filter(|_| *size > 1).into()),
            ("share of the mixture", "", &|size| {
                found.mixture.as_ref().filter(|_| *size > 1).map(|mixture| mixture.share_of_two_or_more(*size)).into()
            }),
        ],
    )
}

fn experiment(found: &Paper) -> Table {
    Table::of(
        &found.experiment,
        &[
            ("quantity", "", &|it| it.quantity.as_str().into()),
            ("unit", "", &|it| it.unit.into()),
            ("measured on ants", "", &|it| it.measured.into()),
            ("n measured", "", &|it| it.n_measured.into()),
            ("here", "", &|it| value(&it.here)),
            ("low 95", "", &|it| low(&it.here)),
            ("high 95", "", &|it| high(&it.here)),
        ],
    )
}

fn inertial_force(found: &Paper) -> Table {
    Table::of(
        &found.inertial_force,
        &[
            ("trial", "", &|it| it.trial.name().into()),
            ("smoothing", "s", &|it| it.smoothing_s.into()),
            ("mean", "N", &|it| value(&it.mean_n)),
            ("mean low 95", "N", &|it| low(&it.mean_n)),
            ("mean high 95", "N", &|it| high(&it.mean_n)),
            ("rms", "N", &|it| value(&it.rms_n)),
            ("largest", "N", &|it| it.largest_n.into()),
            ("n accelerations", "", &|it| it.n.into()),
        ],
    )
}

fn claims(found: &Paper) -> Table {
    Table::of(
        &found.claims,
        &[
            ("claim", "", &|claim| claim.claim.into()),
            ("source", "", &|claim| claim.source.into()),
            ("contradicts", "", &|claim| claim.contradicts.name().into()),
            ("statistic", "", &|claim| claim.statistic.as_str().into()),
            ("side", "", &|claim| claim.side().into()),
            ("limit", "", &|claim| claim.limit.into()),
            ("value", "", &|claim| value(&claim.found)),
            ("low 95", "", &|claim| low(&claim.found)),
            ("high 95", "", &|claim| high(&claim.found)),
            ("holds", "", &|claim| claim.holds.into()),
        ],
    )
}

fn group_sizes(found: &Paper) -> Table {
    Table::of(
        &found.load_speed,
        &[
            ("n_transporting", "", &|it| it.n_transporting.into()),
            ("trial", "", &|it| it.trial.name().into()),
            ("load speed", "m/s", &|it| value(&it.load_speed_m_per_s)),
            ("low 95", "", &|it| low(&it.load_speed_m_per_s)),
            ("high 95", "", &|it| high(&it.load_speed_m_per_s)),
            ("sd over runs", "m/s", &|it| it.sd_over_runs_m_per_s.into()),
            ("load speed by tick", "m/s", &|it| it.load_speed_by_tick_m_per_s.into()),
            ("load speed in windows of 0.1 s", "m/s", &|it| it.load_speed_by_window_m_per_s[0].into()),
            ("load speed in windows of 0.5 s", "m/s", &|it| it.load_speed_by_window_m_per_s[1].into()),
            ("load speed in windows of 2 s", "m/s", &|it| it.load_speed_by_window_m_per_s[2].into()),
            ("time", "s", &|it| it.time_s.into()),
            ("n instants", "", &|it| it.n_instants.into()),
            ("printed instants", "", &|it| it.printed_instants.into()),
            ("headway", "m/s", &|it| value(&it.headway_m_per_s)),
            ("headway low 95", "", &|it| low(&it.headway_m_per_s)),
            ("headway high 95", "", &|it| high(&it.headway_m_per_s)),
        ],
    )
}

/// One row for each conclusion and set.
fn conclusions(found: &Paper) -> Table {
    let on_sets = found.conclusions.iter().flat_map(|conclusion| conclusion.on.iter().map(move |on| (conclusion, on)));
    Table::of(
        &on_sets.collect::<Vec<_>>(),
        &[
            ("conclusion", "", &|(conclusion, _)| conclusion.conclusion.as_str().into()),
            ("set", "", &|(_, on)| on.set.as_str().into()),
            ("value", "", &|(_, on)| on.value.into()),
            ("holds", "", &|(_, on)| on.holds.into()),
            ("is changed", "", &|(conclusion, on)| conclusion.changed_on.contains(&on.set).into()),
        ],
    )
}

fn replayed(found: &Paper) -> Table {
    Table::of(
        &found.replayed,
        &[
            ("trial", "", &|one| one.trial.name().into()),
            ("seed", "", &|one| one.seed.into()),
            ("duration", "s", &|one| one.duration_s.into()),
            ("verdict", "", &|one| one.verdict.as_str().into()),
            ("inertia effect", "m", &|one| one.inertia_effect_m.into()),
            ("engine error", "m", &|one| one.engine_error_m.into()),
            ("reference error", "m", &|one| one.reference_error_m.into()),
            ("path length", "m", &|one| one.path_length_m.into()),
            ("tolerance", "m", &|one| one.tolerance_m.into()),
            ("first divergence", "s", &|one| one.first_divergence_s.into()),
        ],
    )
}

fn run_table(found: &Paper, runs: &[Runs]) -> Table {
    let of_sets = found.sets.iter().zip(runs);
    Table::of(
        &of_sets.flat_map(|(set, runs)| runs.iter().map(move |(trial, seed, facts)| (set, trial, *seed, facts))).collect::<Vec<_>>(),
        &[
            ("set", "", &|(set, ..)| set.name.as_str().into()),
            ("trial", "", &|(_, trial, ..)| trial.name().into()),
            ("seed", "", &|(_, _, seed, _)| (*seed).into()),
            ("arrived", "", &|(.., facts)| facts.arrived.into()),
            ("time", "s", &|(.., facts)| facts.time_s.into()),
            ("displacement", "m", &|(.., facts)| facts.displacement_m.into()),
            ("n grasps", "", &|(.., facts)| facts.n_grasps.into()),
            ("pull mean", "N", &|(.., facts)| facts.pulls.mean().into()),
            ("pull sd", "N", &|(.., facts)| facts.pulls.sd().into()),
            ("pull max", "N", &|(.., facts)| facts.pulls.max().into()),
            ("n pulls", "", &|(.., facts)| facts.pulls.n().into()),
            // Over control ticks, where the columns before are over decisions.
            ("pull mean by time", "N", &|(.., facts)| facts.pulls_by_time.mean().into()),
            ("pull sd by time", "N", &|(.., facts)| facts.pulls_by_time.sd().into()),
            ("speed changes at", "s", &|(.., facts)| facts.changes.speed.map(|change| change.time_s).into()),
            ("speed change p", "", &|(.., facts)| facts.changes.speed.map(|change| change.change.p_value).into()),
            ("phase change at", "s", &|(.., facts)| facts.changes.phase.map(|at| at.time_s).into()),
            ("phase change p", "", &|(.., facts)| facts.changes.phase.map(|at| at.change.p_value).into()),
        ],
    )
}
