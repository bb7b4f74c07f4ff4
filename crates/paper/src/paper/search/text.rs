//! The accepted sets, for people.

use super::rank::Ranked;
use super::report::{ChoiceRow, ClaimRow, IndexRow, QuantityRow, SEEDS, Search, Shares, Spread};
use super::sensitivity::Index;
use cohaul::model::open_choices::Chosen;
use cohaul_report::quantity::{number, quantity};
use cohaul_report::table::Table;
use cohaul_report::text::Detail;

/// The answer, the counts of sets and the claims; in full, a table each of claims, quantities,
/// choices and indices.
pub fn search_text(found: &Search, detail: Detail) -> String {
    let head = format!(
        "{}\n\n{} sets, {} close, {} looked at again, {} accepted; {} and {} seeds, in {}\n",
        found.answer,
        found.n_sets,
        found.n_close,
        found.n_judged,
        found.n_accepted,
        found.plan.n_screening_seeds,
        found.plan.n_judging_seeds,
        quantity(found.wall_s, "s")
    );
    let tables = if detail == Detail::Full { tables(found) } else { vec![claims_in_brief(found)] };
    let tables = tables.iter().filter(|table| !table.rows.is_empty());
    head + &tables.map(|table| format!("\n{}\n{}\n", table.caption, table.text().trim_end())).collect::<String>()
}

/// Tables for text, README and page.
pub(super) fn tables(found: &Search) -> Vec<Table> {
    let all = [best(found), claims(found), held_out(found), choices(found), dependences(found)];
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

/// Sets beside each other in the table of the best.
const N_BEST: usize = 4;

/// The best sets side by side: printed facts, then the choices of each.
fn best(found: &Search) -> Table {
    let best = &found.ranked[..found.ranked.len().min(N_BEST)];
    let heads = ["printed fact or choice", "paper"].map(str::to_owned).into_iter();
    let mut table =
        Table::new("The best sets by the printed facts that they meet", heads.chain(best.iter().map(|row| format!("set {}", row.set))));
    let Some(first) = best.first() else { return table };
    for (at, fact) in first.facts.iter().enumerate() {
        let here = best.iter().map(|row| {
            let fact = &row.facts[at];
            let value = fact.value.map_or_else(|| "-".to_owned(), |value| quantity(value, fact.unit));
            if fact.is_met { value } else { format!("{value}, missed") }
        });
        table.push([fact.fact.clone(), fact.paper.clone()].into_iter().chain(here));
    }
    let n_ranked = first.facts.iter().filter(|fact| fact.is_ranked).count();
    let summary = best.iter().map(|row| row.n_met.to_string());
    table.push(["facts met".to_owned(), format!("of {n_ranked}, without the phase change")].into_iter().chain(summary));
    table.push(["distance to the targets".to_owned(), String::new()].into_iter().chain(best.iter().map(|row| number(row.distance))));
    for (at, choice) in found.choices.iter().enumerate() {
        let value = |row: &Ranked| match &found.sets[row.set].values[at] {
            Chosen::Number(value) => quantity(*value, choice.unit),
            Chosen::Word(word) => (*word).to_owned(),
        };
        table.push([choice.choice.to_owned(), String::new()].into_iter().chain(best.iter().map(value)));
    }
    table
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
    let row = |row: &ChoiceRow| {
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
    let total = |row: &IndexRow| row.total.expect("it has a total index");
    let text = |row: &&IndexRow| {
        let Index { value, interval_95 } = total(row);
        format!("{}: {value:.2} ({:.2} to {:.2})", row.choice, interval_95.low, interval_95.high)
    };
    let rows: Vec<&IndexRow> = found.indices.iter().filter(|row| row.total.is_some()).collect();
    for of_quantity in rows.chunk_by(|a, b| a.quantity == b.quantity) {
        let (of_seeds, mut of_choices): (Vec<&IndexRow>, Vec<&IndexRow>) = of_quantity.iter().partition(|row| row.choice == SEEDS);
        of_choices.sort_by(|a, b| total(b).value.total_cmp(&total(a).value));
        let seeds = of_seeds.first().map_or_else(String::new, |row| format!("{:.2}", total(row).value));
        if !of_choices.is_empty() {
            table.push([of_quantity[0].quantity.clone()].into_iter().chain(of_choices.iter().take(3).map(text)).chain([seeds]));
        }
    }
    table
}
