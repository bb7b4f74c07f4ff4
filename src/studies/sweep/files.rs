//! Files of a sweep: `runs.csv`, `runs.parquet`, `groups.csv`, a figure, a report, summary and
//! manifest. Rows are copied one by one, so that memory does not grow with their number.

use std::io::Write;
use std::path::Path;

use crate::math::Interval;
use crate::output::folder::{FolderError, OutputFolder};
use crate::output::manifest::Manifest;
use crate::output::page::REPORT;
use crate::output::table::Field;
use crate::studies::sweep::figure::Times;
use crate::studies::sweep::figure::sweep as draw;
use crate::studies::sweep::page::sweep_page;
use crate::studies::sweep::report::{FAILED, Failure, MOST_FAILURES, SweepSummary};
use crate::studies::sweep::{Group, Grouper, Identity, MEASURES, SweepError, Table, fields_of, head_of};

/// Writes the folder `target`, all or nothing. Returns `summary`, completed with the counts and
/// groups of the rows.
///
/// # Errors
/// When the folder may not be written, the table cannot be read, or the disk fails.
pub fn write_sweep(
    target: &Path,
    identity: &Identity,
    table: &dyn Table,
    mut summary: SweepSummary,
    manifest: &Manifest,
) -> Result<SweepSummary, FolderError> {
    let mut folder = OutputFolder::create(target)?;
    let mut times = Times::default();
    folder.write("runs.csv", |out| write_runs(identity, table, &mut summary, &mut times, out))?;
    folder.write("groups.csv", |out| write_groups(identity, table, &mut summary, out))?;
    #[cfg(feature = "parquet")]
    folder.write("runs.parquet", |out| write_parquet(identity, table, manifest, out))?;
    let figure = draw(identity, summary.groups.as_deref().unwrap_or_default(), &times);
    if let Some(svg) = &figure {
        folder.write("figure.svg", |out| out.write_all(svg.as_bytes()))?;
    }
    folder.write(REPORT, |out| out.write_all(sweep_page(&summary, figure, manifest).to_html().as_bytes()))?;
    folder.write_json("summary.json", &summary)?;
    folder.finish(manifest)?;
    Ok(summary)
}

/// Writes the rows as Parquet.
#[cfg(feature = "parquet")]
fn write_parquet(identity: &Identity, table: &dyn Table, manifest: &Manifest, out: &mut dyn Write) -> Result<(), SweepError> {
    let failed = |error: crate::output::lines::TableError| SweepError::Output(error.to_string());
    let columns = identity.columns.iter().map(|column| (column.name.clone(), column.kind)).collect();
    let mut writer = crate::output::table::ParquetWriter::new(columns, Some(manifest), out).map_err(|error| failed(error.into()))?;
    table.visit(&mut |line| writer.add(fields_of(line, &identity.columns)?).map_err(failed))?;
    writer.finish().map_err(|error| failed(error.into()))
}

/// Copies the lines and counts them.
fn write_runs(
    identity: &Identity,
    table: &dyn Table,
    summary: &mut SweepSummary,
    times: &mut Times,
    out: &mut dyn Write,
) -> Result<(), SweepError> {
    let failed = |error: std::io::Error| SweepError::Output(error.to_string());
    let at = |name: &str| identity.column(name).expect("every table has it");
    let [status, cause, backend, step, time] = ["status", "cause", "backend", "step_s", "time_to_nest_s"].map(at);
    writeln!(out, "{}", head_of(&identity.columns)).map_err(failed)?;
    table.visit(&mut |line| {
        writeln!(out, "{line}").map_err(failed)?;
        let fields = fields_of(line, &identity.columns)?;
        let cell = summary.n_runs;
        summary.n_runs += 1;
        if let Field::Word(word) = &fields[status] {
            *summary.statuses.entry(word.clone()).or_default() += 1;
        }
        if let (Field::Word(status), Field::Word(cause)) = (&fields[status], &fields[cause])
            && status == FAILED
            && summary.failures.len() < MOST_FAILURES
        {
            summary.failures.push(Failure { cell, cause: cause.clone() });
        }
        if let (Field::Word(backend), Some(time)) = (&fields[backend], fields[time].number()) {
            times.add(identity.variant_name(backend, fields[step].number()), time);
        }
        Ok(())
    })
}

fn write_groups(identity: &Identity, table: &dyn Table, summary: &mut SweepSummary, out: &mut dyn Write) -> Result<(), SweepError> {
    let failed = |error: csv::Error| SweepError::Output(error.to_string());
    let mut writer = csv::Writer::from_writer(out);
    let mut grouper = Grouper::new(identity);
    writer.write_record(group_columns(identity)).map_err(failed)?;
    let mut put = |group: Option<Group>| {
        let Some(group) = group else { return Ok(()) };
        writer.write_record(group_record(&group)).map_err(failed)?;
        summary.add_group(group);
        Ok(())
    };
    table.visit(&mut |line| put(grouper.add(line)?))?;
    put(grouper.finish())?;
    writer.flush().map_err(|error| SweepError::Output(error.to_string()))
}

fn group_columns(identity: &Identity) -> Vec<String> {
    let counts =
        ["n", "n_finished", "n_failed", "n_with_nest", "n_arrived", "arrival_share", "arrival_share_low_95", "arrival_share_high_95"];
    let measures = MEASURES.iter().flat_map(|name| ["n", "mean", "sd", "low_95", "high_95"].map(|part| format!("{name}_{part}")));
    let shares = identity.columns.iter().map(|column| &column.name).filter(|name| name.starts_with("time_share_")).cloned();
    let parameters = identity.parameters().iter().map(|column| column.name.clone());
    let plain = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    [plain(&["point"]), parameters.collect(), plain(&["backend", "step_s"]), plain(&counts), measures.collect(), shares.collect()].concat()
}

fn group_record(group: &Group) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| zmij::Buffer::new().format(value).to_owned());
    let ends = |interval: Option<Interval>| [number(interval.map(|it| it.low)), number(interval.map(|it| it.high))];
    let counts = [group.n, group.n_finished, group.n_failed, group.n_with_nest, group.n_arrived].map(|n| n.to_string());
    let mut record = vec![group.point.to_string()];
    record.extend(group.parameters.iter().cloned());
    record.extend([group.backend.clone(), number(group.step_s)]);
    record.extend(counts);
    record.push(number(group.arrival_share));
    record.extend(ends(group.arrival_interval_95));
    for measure in &group.measures {
        record.extend([measure.n.to_string(), number(measure.mean), number(measure.sd)]);
        record.extend(ends(measure.mean_interval_95));
    }
    record.extend(group.time_shares.iter().map(|share| number(Some(*share))));
    record
}
