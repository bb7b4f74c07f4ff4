//! Results of a stress test as data and as text.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::methods::Method;
use crate::stress::{Judged, Map, Outcome, Row};
use crate::variants;
use cohaul::formats::{self, Format, Versioned};
use cohaul::simulation::Health;
use cohaul_report::quantity::quantity;
use cohaul_report::table::{Field, Table, wrapped};
use cohaul_report::text::WIDTH;

/// What `stress --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stress {
    /// No panic, no number without a value, nothing unexplained.
    pub holds: bool,
    pub n_cells: usize,
    /// Cells times backends.
    pub n_runs: usize,
    pub n_panicked: usize,
    pub n_not_finite: usize,
    pub n_unexplained: usize,
    pub quick: bool,
    pub wall_s: f64,
    /// Number of runs by backend and outcome.
    pub outcomes: Counts,
    /// What runs with a known answer said of themselves, by backend.
    pub accounts: BTreeMap<&'static str, Accounts>,
    pub maps: Vec<MapSummary>,
    /// The first of what must not be.
    pub defects: Vec<Defect>,
}

impl Versioned for Stress {
    const FORMAT: Format = formats::STRESS;
}

/// Numbers of runs by what they said of themselves and whether it is so. Right is an end that is
/// off by at most a tenth of the displacement, with a ledger that closes to a tenth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Accounts {
    pub n_ok: usize,
    pub n_ok_and_right: usize,
    /// Runs that are ok, and right to a tenth or to the step error that they stated.
    pub n_ok_and_as_stated: usize,
    pub n_not_ok: usize,
    /// False alarms: runs that are doubtful or failed, and right.
    pub n_not_ok_and_right: usize,
}

impl Accounts {
    fn add(&mut self, judged: &Judged) {
        let (is_right, is_as_stated) = (usize::from(judged.is_right), usize::from(judged.is_as_stated));
        if judged.health == Health::Ok {
            self.n_ok += 1;
            self.n_ok_and_right += is_right;
            self.n_ok_and_as_stated += is_as_stated;
        } else {
            self.n_not_ok += 1;
            self.n_not_ok_and_right += is_right;
        }
    }
}

pub type Counts = BTreeMap<&'static str, BTreeMap<&'static str, usize>>;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapSummary {
    pub name: &'static str,
    pub what: &'static str,
    pub x: &'static str,
    pub y: &'static str,
    pub n_cells: usize,
    pub outcomes: Counts,
}

/// A run that panicked, had a number without a value, or is unexplained.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Defect {
    pub map: String,
    pub x: f64,
    pub y: f64,
    pub backend: &'static str,
    pub outcome: &'static str,
    pub cause: String,
}

const MOST_DEFECTS: usize = 20;

impl Stress {
    /// Summary of the `rows` of `maps`, in the order of their cells.
    pub fn new(maps: &[Map], rows: &[Row], quick: bool, wall_s: f64) -> Self {
        let n_of = |outcome: Outcome| rows.iter().filter(|row| row.outcome == outcome).count();
        let of_map = |map: &Map| MapSummary {
            name: map.name,
            what: map.what,
            x: map.x.name,
            y: map.y.name,
            n_cells: map.n_cells(),
            outcomes: counts(rows.iter().filter(|row| row.map == map.name)),
        };
        let defects = rows.iter().filter(|row| row.outcome.is_defect()).take(MOST_DEFECTS).map(Defect::of);
        Self {
            holds: !rows.iter().any(|row| row.outcome.is_defect()),
            n_cells: maps.iter().map(Map::n_cells).sum(),
            n_runs: rows.len(),
            n_panicked: n_of(Outcome::Panicked),
            n_not_finite: n_of(Outcome::NotFinite),
            n_unexplained: n_of(Outcome::Unexplained),
            quick,
            wall_s,
            outcomes: counts(rows.iter()),
            accounts: accounts(rows),
            maps: maps.iter().map(of_map).collect(),
            defects: defects.collect(),
        }
    }
}

impl Defect {
    fn of(row: &Row) -> Self {
        let (backend, outcome) = (row.method.key, row.outcome.name());
        Self { map: row.map.clone(), x: row.x, y: row.y, backend, outcome, cause: row.cause.clone() }
    }
}

fn accounts(rows: &[Row]) -> BTreeMap<&'static str, Accounts> {
    let mut accounts = BTreeMap::<_, Accounts>::new();
    for (row, judged) in rows.iter().filter_map(|row| Some((row, row.account.as_ref()?))) {
        accounts.entry(row.method.key).or_default().add(judged);
    }
    accounts
}

fn counts<'a>(rows: impl Iterator<Item = &'a Row>) -> Counts {
    let mut counts = Counts::new();
    for row in rows {
        *counts.entry(row.method.key).or_default().entry(row.outcome.name()).or_default() += 1;
    }
    counts
}

/// Numbers of outcomes, a table a map and one over all, then what must not be, then whether all
/// holds.
pub fn stress_text(found: &Stress) -> String {
    let mut text = String::new();
    let line = |text: &str| format!("{}\n", wrapped(text, 2, WIDTH - 2));
    for map in &found.maps {
        text += &line(&format!("{} ({} cells, {} x {}): {}", map.name, map.n_cells, map.x, map.y, map.what));
        text.push_str(&table(&map.outcomes));
    }
    if found.maps.len() > 1 {
        text += "all maps\n";
        text.push_str(&table(&found.outcomes));
    }
    text.push_str("what runs with a known answer said of themselves\n");
    text.push_str(&account_table(&found.accounts).text());
    for Defect { map, x, y, backend, outcome, cause } in &found.defects {
        text += &line(&format!("{outcome}: {map} at {x:e}, {y:e} by {backend}: {cause}"));
    }
    let (cells, runs, wall) = (found.n_cells, found.n_runs, quantity(found.wall_s, "s"));
    let Stress { n_panicked, n_not_finite, n_unexplained, .. } = found;
    text + &line(&format!(
        "{cells} cells, {runs} runs: {n_panicked} panics, {n_not_finite} not finite, {n_unexplained} unexplained; {wall}"
    ))
}

/// A line a backend, a column an outcome that occurs.
fn table(counts: &Counts) -> String {
    let occurs = |outcome: &Outcome| counts.values().any(|of_backend| of_backend.contains_key(outcome.name()));
    let columns: Vec<&str> = variants::all::<Outcome>().filter(occurs).map(Outcome::name).collect();
    let mut table = Table::new("", ["backend"].into_iter().chain(columns.iter().copied()));
    for (method, counts) in Method::all_stressed().filter_map(|method| Some((method, counts.get(method.key)?))) {
        let numbers = columns.iter().map(|name| counts.get(name).copied().unwrap_or(0).into());
        table.push([Field::from(method.key)].into_iter().chain(numbers));
    }
    table.text()
}

/// A line a backend.
pub fn account_table(accounts: &BTreeMap<&'static str, Accounts>) -> Table {
    let columns = ["backend", "ok", "ok and right", "ok and as stated", "not ok", "not ok and right"];
    let methods = Method::all_stressed().filter_map(|method| Some((method, accounts.get(method.key)?)));
    let row = |(method, of): (Method, &Accounts)| {
        let numbers = [of.n_ok, of.n_ok_and_right, of.n_ok_and_as_stated, of.n_not_ok, of.n_not_ok_and_right];
        [Field::from(method.key)].into_iter().chain(numbers.map(Field::from)).collect::<Vec<_>>()
    };
    Table::new("", columns).with_rows(methods.map(row))
}

/// Names of the maps, their parameters and what they do.
pub fn stress_list(maps: &[Map]) -> String {
    let cells = |map: &Map| {
        let [n_x, n_y] = [&map.x, &map.y].map(|axis| axis.values.len());
        [map.name.to_owned(), format!("{}; {n_x} x {n_y} cells over {} and {}", map.what, map.x.name, map.y.name)]
    };
    maps.iter().fold(Table::list(), |table, map| table.row(cells(map))).text()
}
