//! Files of a sweep: `runs.csv`, `runs.parquet`, `groups.csv`, a figure, a report, summary and
//! manifest. Rows are copied one by one, so that memory does not grow with their number.

use std::io::Write;
use std::path::Path;

use crate::sweep::column::{line_of, text_of};
use crate::sweep::figure::{Times, sweep as draw};
use crate::sweep::page::sweep_page;
use crate::sweep::report::{FAILED, Failure, MOST_FAILURES, SweepSummary};
use crate::sweep::{Group, Grouper, Identity, MEASURES, SweepError, Table, fields_of, head_of};
use cohaul::math::Interval;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::REPORT;
use cohaul_report::table::Field;

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
fn write_parquet(identity: &Identity, table: &dyn Table, manifest: &Manifest, out: &mut (dyn Write + Send)) -> Result<(), SweepError> {
    let columns = identity.columns.iter().map(|column| (column.name.clone(), column.kind)).collect();
    let mut writer = cohaul_report::table::ParquetWriter::new(columns, Some(manifest), out)?;
    table.visit(&mut |line| Ok(writer.add(fields_of(line, &identity.columns)?)?))?;
    Ok(writer.finish()?)
}

/// Copies the lines and counts them.
fn write_runs(
    identity: &Identity,
    table: &dyn Table,
    summary: &mut SweepSummary,
    times: &mut Times,
    out: &mut dyn Write,
) -> Result<(), SweepError> {
    let at = |name: &str| identity.column(name).expect("every table has it");
    let [status, cause, backend, step, time] = ["status", "cause", "backend", "step_s", "time_to_nest_s"].map(at);
    writeln!(out, "{}", head_of(&identity.columns))?;
    table.visit(&mut |line| {
        writeln!(out, "{line}")?;
        let fields = fields_of(line, &identity.columns)?;
        let cell = summary.n_runs;
        summary.n_runs += 1;
        if let Field::Word(status) = &fields[status] {
            *summary.statuses.entry(status.clone()).or_default() += 1;
            if status == FAILED && summary.failures.len() < MOST_FAILURES {
                summary.failures.push(Failure { cell, cause: text_of(&fields[cause]) });
            }
        }
        if let (Field::Word(backend), Some(time)) = (&fields[backend], fields[time].number()) {
            times.add(identity.variant_name(backend, fields[step].number()), time);
        }
        Ok(())
    })
}

fn write_groups(identity: &Identity, table: &dyn Table, summary: &mut SweepSummary, out: &mut dyn Write) -> Result<(), SweepError> {
    let mut grouper = Grouper::new(identity);
    writeln!(out, "{}", line_of(&group_columns(identity)))?;
    let mut put = |group: Option<Group>| {
        let Some(group) = group else { return Ok(()) };
        writeln!(out, "{}", line_of(&group_record(&group)))?;
        summary.add_group(group);
        Ok(())
    };
    table.visit(&mut |line| put(grouper.add(line)?))?;
    put(grouper.finish())
}

fn group_columns(identity: &Identity) -> Vec<Field> {
    let counts =
        ["n", "n_finished", "n_failed", "n_with_nest", "n_arrived", "arrival_share", "arrival_share_low_95", "arrival_share_high_95"];
    let measures = MEASURES.iter().flat_map(|name| ["n", "mean", "sd", "low_95", "high_95"].map(|part| format!("{name}_{part}")));
    let shares = identity.columns.iter().map(|column| &*column.name).filter(|name| name.starts_with("time_share_")).map(Field::from);
    let parameters = identity.parameters().iter().map(|column| column.name.as_str().into());
    let head = std::iter::once("point".into()).chain(parameters);
    head.chain(["backend", "step_s"].into_iter().chain(counts).map(Field::from)).chain(measures.map(Field::from)).chain(shares).collect()
}

fn group_record(group: &Group) -> Vec<Field> {
    let ends = |interval: Option<Interval>| [interval.map(|it| it.low), interval.map(|it| it.high)].map(Field::from);
    let mut record = vec![group.point.into()];
    record.extend(group.parameters.iter().map(|value| value.as_str().into()));
    record.extend([group.backend.as_str().into(), group.step_s.into()]);
    record.extend([group.n, group.n_finished, group.n_failed, group.n_with_nest, group.n_arrived].map(Field::from));
    record.push(group.arrival_share.into());
    record.extend(ends(group.arrival_interval_95));
    for measure in &group.measures {
        record.extend([measure.n.into(), measure.mean.into(), measure.sd.into()]);
        record.extend(ends(measure.mean_interval_95));
    }
    record.extend(group.time_shares.iter().map(|share| Field::from(*share)));
    record
}
