//! Output folder of `paper search`: tables as CSV, figures, README, page, summary and manifest.

use std::path::Path;

use super::figure::figures;
use super::report::{IndexRow, Search, SetRow};
use super::screen::SCREENED;
use super::sensitivity::Index;
use super::text::tables;
use super::{ACCEPTED, CLOSE, reported};
use crate::paper::figure::Figures;
use cohaul::model::open_choices::Chosen;
use cohaul_report::folder::{FolderError, OutputFolder};
use cohaul_report::manifest::Manifest;
use cohaul_report::page::{Answer, Block, Headline, Page, REPORT};
use cohaul_report::quantity::quantity;
use cohaul_report::table::{Column, Field, Table};
use cohaul_report::text::wrapped_markdown;

/// Writes `sets.csv`, `accepted.csv`, `ranked.csv`, `claims.csv`, `quantities.csv`, `choices.csv`,
/// `indices.csv`, the figures, `README.md`, `report.html`, `summary.json` and `manifest.json` to
/// the folder `target`, all or nothing. A table without rows is left out.
///
/// # Errors
/// When the folder may not be written, or the disk fails.
pub fn write_search(target: &Path, found: &Search, manifest: &Manifest) -> Result<(), FolderError> {
    let mut folder = OutputFolder::create(target)?;
    let written = [
        ("sets.csv", sets(found)),
        ("accepted.csv", accepted(found)),
        ("ranked.csv", ranked(found)),
        ("claims.csv", claims(found)),
        ("quantities.csv", quantities(found)),
        ("choices.csv", choices(found)),
        ("indices.csv", indices(found)),
    ];
    for (name, table) in written.iter().filter(|(_, table)| !table.rows.is_empty()) {
        folder.write(name, |out| table.write_csv(out))?;
    }
    let figures = figures(found);
    for (name, _, svg) in &figures {
        folder.write(&format!("{name}.svg"), |out| out.write_all(svg.as_bytes()))?;
    }
    folder.write("README.md", |out| out.write_all(readme(found, &figures, target).as_bytes()))?;
    folder.write(REPORT, |out| out.write_all(page(found, figures, manifest).to_html().as_bytes()))?;
    folder.write_json("summary.json", found)?;
    folder.finish(manifest)
}

/// A table of sets: number, choices, then the columns `names` with the fields that `of` takes from
/// a set.
fn table_of_sets(found: &Search, names: Vec<(String, &'static str)>, of: impl Fn(&SetRow) -> Option<Vec<Field>>) -> Table {
    let choices = found.choices.iter().map(|row| (row.choice.replace(['(', ')', '\''], ""), row.unit));
    let columns = [("set".to_owned(), "")].into_iter().chain(choices).chain(names).map(|(name, unit)| Column { name, unit });
    let value = |value: &Chosen| match value {
        Chosen::Number(value) => Field::from(*value),
        Chosen::Word(word) => Field::from(*word),
    };
    let row = |row: &SetRow| Some([vec![row.set.into()], row.values.iter().map(value).collect(), of(row)?].concat());
    Table { columns: columns.collect(), ..Table::default() }.with_rows(found.sets.iter().filter_map(row))
}

fn sets(found: &Search) -> Table {
    let measures = SCREENED.iter().map(|measure| (file_name(&measure.name()), measure.unit()));
    let names = [("distance".to_owned(), "")]
        .into_iter()
        .chain(measures)
        .chain([("largest pull".to_owned(), "N"), ("is within the box".to_owned(), "")])
        .collect();
    table_of_sets(found, names, |row| {
        let screened = &row.screened;
        let numbers = [screened.distance].into_iter().chain(screened.values.iter().copied()).chain([screened.largest_pull_n]);
        Some(numbers.map(Field::from).chain([row.is_within.into()]).collect())
    })
}

fn file_name(measure: &str) -> String {
    measure.replace(['(', ')', ','], "").replace('/', " on ")
}

fn accepted(found: &Search) -> Table {
    let measures = reported().into_iter().flat_map(|measure| {
        let name = file_name(&measure.name());
        [(name.clone(), measure.unit()), (format!("inertia effect on {name}"), measure.unit())]
    });
    let names = [("distance".to_owned(), ""), ("largest pull".to_owned(), "N")].into_iter().chain(measures).collect();
    table_of_sets(found, names, |row| {
        let judged = row.judged.as_ref().filter(|_| row.is_accepted)?;
        let pair = |it: &super::judge::OnBoth| [it.quasi_static.map(|it| it.value), it.minus.map(|it| it.value)];
        let numbers =
            [judged.distance, judged.largest_pull.map(|it| it.expected_n)].into_iter().chain(judged.measures.iter().flat_map(pair));
        Some(numbers.map(Field::from).collect())
    })
}

/// One row for each accepted set and printed fact.
fn ranked(found: &Search) -> Table {
    let facts: Vec<_> = found.ranked.iter().flat_map(|row| row.facts.iter().map(move |fact| (row, fact))).collect();
    Table::of(
        &facts,
        &[
            ("rank", "", &|(row, _)| row.rank.into()),
            ("set", "", &|(row, _)| row.set.into()),
            ("n met", "", &|(row, _)| row.n_met.into()),
            ("distance", "", &|(row, _)| row.distance.into()),
            ("fact", "", &|(_, fact)| fact.fact.as_str().into()),
            ("unit", "", &|(_, fact)| fact.unit.into()),
            ("paper", "", &|(_, fact)| fact.paper.as_str().into()),
            ("value", "", &|(_, fact)| fact.value.into()),
            ("is met", "", &|(_, fact)| fact.is_met.into()),
            ("is ranked", "", &|(_, fact)| fact.is_ranked.into()),
        ],
    )
}

fn claims(found: &Search) -> Table {
    Table::of(
        &found.claims,
        &[
            ("claim", "", &|it| it.claim.into()),
            ("statistic", "", &|it| it.statistic.as_str().into()),
            ("side", "", &|it| if it.below { "below" } else { "above" }.into()),
            ("limit", "", &|it| it.limit.into()),
            ("holds", "", &|it| it.on[0].holds.into()),
            ("fails", "", &|it| it.on[0].fails.into()),
            ("unknown", "", &|it| it.on[0].unknown.into()),
            ("on its side", "", &|it| it.on[0].on_its_side.into()),
            ("least", "", &|it| it.on[0].values.map(|of| of.least).into()),
            ("median", "", &|it| it.on[0].values.map(|of| of.median).into()),
            ("most", "", &|it| it.on[0].values.map(|of| of.most).into()),
            ("holds with inertia", "", &|it| it.on[1].holds.into()),
            ("fails with inertia", "", &|it| it.on[1].fails.into()),
            ("unknown with inertia", "", &|it| it.on[1].unknown.into()),
            ("median with inertia", "", &|it| it.on[1].values.map(|of| of.median).into()),
        ],
    )
}

fn quantities(found: &Search) -> Table {
    Table::of(
        &found.quantities,
        &[
            ("quantity", "", &|it| it.quantity.as_str().into()),
            ("unit", "", &|it| it.unit.into()),
            ("printed", "", &|it| it.printed.into()),
            ("role", "", &|it| if it.is_target { "target" } else { "held out" }.into()),
            ("least", "", &|it| it.values.map(|of| of.least).into()),
            ("median", "", &|it| it.values.map(|of| of.median).into()),
            ("most", "", &|it| it.values.map(|of| of.most).into()),
            ("met", "", &|it| it.met.into()),
            ("least inertia effect", "", &|it| it.inertia_effect.map(|of| of.least).into()),
            ("median inertia effect", "", &|it| it.inertia_effect.map(|of| of.median).into()),
            ("most inertia effect", "", &|it| it.inertia_effect.map(|of| of.most).into()),
            ("shifted by inertia", "", &|it| it.shifted_by_inertia.into()),
        ],
    )
}

fn choices(found: &Search) -> Table {
    Table::of(
        &found.choices,
        &[
            ("choice", "", &|it| it.choice.into()),
            ("key", "", &|it| it.key.into()),
            ("unit", "", &|it| it.unit.into()),
            ("searched", "", &|it| it.searched.as_str().into()),
            ("least accepted", "", &|it| it.accepted.map(|of| of.least).into()),
            ("median accepted", "", &|it| it.accepted.map(|of| of.median).into()),
            ("most accepted", "", &|it| it.accepted.map(|of| of.most).into()),
            ("reaches an end", "", &|it| it.reaches_an_end.into()),
        ],
    )
}

fn indices(found: &Search) -> Table {
    let value = |index: Option<Index>| Field::from(index.map(|index| index.value));
    let low = |index: Option<Index>| Field::from(index.map(|index| index.interval_95.low));
    let high = |index: Option<Index>| Field::from(index.map(|index| index.interval_95.high));
    Table::of(
        &found.indices,
        &[
            ("quantity", "", &|it: &IndexRow| it.quantity.as_str().into()),
            ("choice", "", &|it| it.choice.into()),
            ("first order", "", &|it| value(it.first_order)),
            ("first order low 95", "", &|it| low(it.first_order)),
            ("first order high 95", "", &|it| high(it.first_order)),
            ("total", "", &|it| value(it.total)),
            ("total low 95", "", &|it| low(it.total)),
            ("total high 95", "", &|it| high(it.total)),
            ("first order among accepted", "", &|it| value(it.among_accepted)),
            ("among accepted low 95", "", &|it| low(it.among_accepted)),
            ("among accepted high 95", "", &|it| high(it.among_accepted)),
            ("first order of inertia effect", "", &|it| value(it.of_inertia_effect)),
            ("of inertia effect low 95", "", &|it| low(it.of_inertia_effect)),
            ("of inertia effect high 95", "", &|it| high(it.of_inertia_effect)),
        ],
    )
}

/// How sets are made and accepted, for README and page.
fn method(found: &Search) -> String {
    let plan = &found.plan;
    format!(
        "Every set has all values that the paper prints. What it leaves open varies within the ranges below: \
         Sobol's sequence and a Latin hypercube of {} sets each, and the sets that exchange one choice between them. \
         Further {} sets fill the smallest box around the 2 % that came closest. \
         The first look runs the trials 4/4, 2/10, 5/10 and 10/10 without inertia on {} seeds. The distance of a set is its \
         worst deviation from the targets: mean and standard deviation of the pulls over 10 %, and the fractions of six to \
         ten pulling ants over 0.05. Sets within {CLOSE:.2} are looked at again on {} other seeds, with and without inertia, and \
         accepted within {ACCEPTED}. All other printed numbers are held out. The accepted sets are ranked by how many printed facts \
         they meet, the claims included but for the phase change, and then by their distance.",
        plan.n_rows, plan.n_within, plan.n_screening_seeds, plan.n_judging_seeds
    )
}

fn readme(found: &Search, figures: &Figures, target: &Path) -> String {
    let folder = target.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let plan = &found.plan;
    let command = format!(
        "`cohaul paper search --rows {} --within {} --seeds {} --more-seeds {} --most {} --out {folder}`",
        plan.n_rows, plan.n_within, plan.n_screening_seeds, plan.n_judging_seeds, plan.most_judged
    );
    let mut page = format!(
        "# All parameter sets that the paper allows\n\n{}\n\n{command} made all that is in this folder, in {}. Of {} sets, {} came close, \
         {} were looked at again, and {} were accepted.\n\n{}\n\n",
        found.answer,
        quantity(found.wall_s, "s"),
        found.n_sets,
        found.n_close,
        found.n_judged,
        found.n_accepted,
        method(found)
    );
    page.extend(figures.iter().map(|(name, caption, _)| format!("![{caption}]({name}.svg)\n\n")));
    page.extend(tables(found).iter().map(|table| format!("## {}\n\n{}\n", table.caption, table.markdown())));
    wrapped_markdown(&(page + NOTES))
}

const NOTES: &str = "
A claim holds on a set where the whole 95 % interval is on its side. The total index of a choice is the share of a \
quantity's variance in which it takes part. Runs are random, so that seeds have one, too, and all others contain it. \
Choices of accepted sets depend on each other. For them, `indices.csv` has first-order indices from the sets alone.

- `sets.csv` every set of the first look with its quantities;
- `accepted.csv` the accepted sets with all quantities, and the inertia effect on each;
- `ranked.csv` the accepted sets with their printed facts, the best first;
- `claims.csv`, `quantities.csv`, `choices.csv`, `indices.csv` the tables above with all columns.
";

fn page(found: &Search, figures: Figures, manifest: &Manifest) -> Page {
    let tone = if found.n_accepted > 0 { Answer::None } else { Answer::No };
    let page = Page::new("All parameter sets that the paper allows", Headline::new(tone, found.answer.clone()));
    let page = page.section("Method", vec![Block::Text(method(found))]);
    let page =
        tables(found).into_iter().fold(page, |page, table| page.section(table.caption.clone(), vec![Block::Table(table.titled(""))]));
    page.section("Figures", figures.into_iter().map(|(_, caption, svg)| Block::figure(svg, caption)).collect()).from(manifest)
}
