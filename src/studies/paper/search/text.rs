//! The accepted sets, for people.

use std::fmt::Write;

use super::report::{ClaimRow, IndexRow, QuantityRow, Search, Shares, Spread};
use crate::output::quantity::{number, quantity};
use crate::output::table::Table;
use crate::output::text::Detail;

/// The answer, the counts of sets and the claims; in full, a table each of claims, quantities,
/// choices and indices.
pub fn search_text(found: &Search, detail: Detail) -> String {
    let mut text = format!("{}\n\n", found.answer);
    let counts = format!(
        "{} sets, {} close, {} looked at again, {} accepted; {} and {} seeds, in {}",
        found.n_sets,
        found.n_close,
        found.n_judged,
        found.n_accepted,
        found.plan.n_screening_seeds,
        found.plan.n_judging_seeds,
        quantity(found.wall_s, "s")
    );
    writeln!(text, "{counts}").expect("a string takes all");
    let tables = if detail == Detail::Full { tables(found) } else { vec![claims_in_brief(found)] };
    for table in tables.iter().filter(|table| !table.rows.is_empty()) {
        writeln!(text, "\n{}\n{}", table.caption, table.text().trim_end()).expect("a string takes all");
    }
    text
}

/// Tables for text, README and page.
pub(super) fn tables(found: &Search) -> Vec<Table> {
    let all = [claims(found), held_out(found), choices(found), dependences(found)];
    all.into_iter().filter(|table| !table.rows.is_empty()).collect()
}

/// A fraction of the accepted sets.
fn share(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

fn between(spread: Option<Spread>, unit: &str) -> String {
    let text =
        |spread: Spread| format!("{} ({} to {})", quantity(spread.median, unit), quantity(spread.least, unit), quantity(spread.most, unit));
    spread.map_or_else(|| "-".to_owned(), text)
}

fn claims(found: &Search) -> Table {
    let standing = |of: &Shares| format!("{} / {} / {}", share(of.holds), share(of.fails), share(of.unknown));
    let row = |row: &ClaimRow| {
        let limit = format!("{} {}", if row.below { "below" } else { "above" }, number(row.limit));
        [row.claim.to_owned(), standing(&row.on[0]), standing(&row.on[1]), limit, between(row.on[0].values, "")]
    };
    Table::new(
        "Claims: sets in which each holds / fails / cannot be told",
        ["claim", "without inertia", "with inertia", "limit", "values (median and range)"],
    )
    .with_rows(found.claims.iter().map(row))
}

/// The claims on lines of 80 columns.
fn claims_in_brief(found: &Search) -> Table {
    let row = |row: &ClaimRow| {
        let [without, with] = &row.on;
        [row.claim.to_owned(), share(without.holds), share(without.unknown), share(with.holds)]
    };
    Table::new("Claims over the accepted sets", ["claim", "holds", "unknown", "with inertia"]).with_rows(found.claims.iter().map(row))
}

fn held_out(found: &Search) -> Table {
    let row = |row: &QuantityRow| {
        let role = if row.is_target { "target" } else { "held out" };
        [
            row.quantity.clone(),
            row.printed.map_or_else(|| "not printed".to_owned(), |printed| quantity(printed, row.unit)),
            role.to_owned(),
            between(row.values, row.unit),
            row.met.map_or_else(String::new, share),
            between(row.inertia_effect, row.unit),
            row.shifted_by_inertia.map_or_else(String::new, share),
        ]
    };
    Table::new(
        "Quantities over the accepted sets: median and range",
        ["quantity", "paper", "role", "here", "sets that certainly meet it", "inertia effect", "sets that inertia certainly shifts"],
    )
    .with_rows(found.quantities.iter().filter(|row| row.values.is_some()).map(row))
}

fn choices(found: &Search) -> Table {
    let row = |row: &super::report::ChoiceRow| {
        let counted = row.counts.iter().map(|(word, n)| format!("{word}: {n}")).collect::<Vec<_>>().join(", ");
        let accepted = if counted.is_empty() { between(row.accepted, row.unit) } else { counted };
        let end = if row.reaches_an_end { "yes" } else { "" };
        [row.choice.to_owned(), format!("{} {}", row.searched, row.unit), accepted, end.to_owned()]
    };
    Table::new("Open choices of the accepted sets", ["choice", "searched", "accepted", "reaches an end"])
        .with_rows(found.choices.iter().map(row))
}

/// For each quantity of the first look, the choices that explain most of it.
fn dependences(found: &Search) -> Table {
    let mut table = Table::new(
        "What each quantity depends on: largest total indices (95 %), and that of the seeds",
        ["quantity", "first", "second", "third", "seeds"],
    );
    let mut names: Vec<&str> = Vec::new();
    for row in found.indices.iter().filter(|row| row.total.is_some() && row.choice != super::report::SEEDS) {
        if !names.contains(&row.quantity.as_str()) {
            names.push(&row.quantity);
        }
    }
    let total = |row: &IndexRow| row.total.map_or(f64::NEG_INFINITY, |index| index.value);
    let text = |row: &IndexRow| {
        let interval = row.total.expect("it has a total index").interval_95;
        format!("{}: {:.2} ({:.2} to {:.2})", row.choice, total(row), interval.low, interval.high)
    };
    for name in names {
        let (mut of_choices, mut of_seeds) = (Vec::new(), String::new());
        for row in found.indices.iter().filter(|row| row.quantity == name && row.total.is_some()) {
            if row.choice == super::report::SEEDS { of_seeds = format!("{:.2}", total(row)) } else { of_choices.push(row) }
        }
        of_choices.sort_by(|a, b| total(b).total_cmp(&total(a)));
        let largest = of_choices.iter().take(3).map(|row| text(row));
        table.push([name.to_owned()].into_iter().chain(largest).chain([of_seeds]));
    }
    table
}
