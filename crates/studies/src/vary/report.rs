//! A map of comparisons as data: the answer, the table and the text.

use serde::Serialize;
use serde_json::Value;

use super::{Cell, Compared, Question};
use crate::sweep::{Axis, Plan};
use cohaul::analysis::compare::{EngineAnswer, InertiaAnswer};
use cohaul::analysis::estimate::CLEAR;
use cohaul::formats::{self, Format, Versioned};
use cohaul_report::quantity::of_run::quantity;
use cohaul_report::quantity::short;
use cohaul_report::table::{Column, Field, Table};
use cohaul_report::text::Lines;

/// Quantities in the order of [`Cell::compared`], with their units.
pub const QUANTITIES: [(&str, &str); 6] =
    [("path", "m"), ("heading", "rad"), ("pulls", "N"), ("contacts", "N"), ("speed", "m/s"), ("energy", "J")];

/// Result of `cohaul compare --vary`, as `--json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Map {
    pub answer: String,
    pub scenario: String,
    pub seed: u64,
    pub question: Question,
    pub axes: Vec<Axis>,
    /// Number of points at which all three backends were compared.
    pub n_compared: usize,
    /// Number of points at which the estimate alone decided.
    pub n_by_estimate: usize,
    pub n_failed: usize,
    /// In the order of the grid, with the last parameter fastest.
    pub cells: Vec<Cell>,
    /// Real time that all calls took (s).
    pub wall_s: f64,
}

impl Versioned for Map {
    const FORMAT: Format = formats::MAP;
}

impl Map {
    pub fn new(plan: &Plan, question: &Question, cells: Vec<Cell>, wall_s: f64) -> Self {
        let mut map = Self {
            answer: String::new(),
            scenario: plan.base().name.clone(),
            seed: plan.identity.first_seed,
            question: *question,
            axes: plan.identity.design.axes.clone(),
            n_compared: cells.iter().filter(|cell| cell.compared.is_some()).count(),
            n_by_estimate: cells.iter().filter(|cell| cell.decided_by_estimate().is_some()).count(),
            n_failed: cells.iter().filter(|cell| cell.failure.is_some()).count(),
            cells,
            wall_s,
        };
        map.answer = map.sentence();
        map
    }

    /// Number of points at which quasi-static is valid for the path.
    pub fn n_valid(&self) -> usize {
        self.cells.iter().filter(|cell| cell.is_valid_for_path() == Some(true)).count()
    }

    fn sentence(&self) -> String {
        let n_at_rest = self.cells.iter().filter(|cell| cell.nothing_moved()).count();
        let n_unknown = self.cells.iter().filter(|cell| cell.is_valid_for_path().is_none()).count();
        let open = [
            ("open", n_unknown - n_at_rest - self.n_failed),
            ("no answer because nothing moved", n_at_rest),
            ("not computed", self.n_failed),
        ];
        let open: String = open.iter().filter(|(_, n)| *n > 0).map(|(what, n)| format!(", {what} at {n}")).collect();
        let all = |cell: &&Cell| cell.compared.as_ref().is_some_and(|of| of.iter().all(|of| of.is_valid == Some(true)));
        let engine = |cell: &&Cell| cell.compared.as_ref().is_some_and(|of| of.iter().any(|of| of.verdict.has_engine()));
        let [n_all, n_engine] = [self.cells.iter().filter(all).count(), self.cells.iter().filter(engine).count()];
        format!(
            "Quasi-static is valid for the path at {} of {} points{}{open}. Of {} points that were compared in full, it is valid for all \
             quantities at {n_all}, and the engine error of rapier exceeds a tolerance at {n_engine}.",
            self.n_valid(),
            self.cells.len(),
            self.range(),
            self.n_compared
        )
    }

    /// The values of one parameter between which quasi-static is valid, if they are neighbours.
    fn range(&self) -> String {
        let valid: Vec<usize> = (0..self.cells.len()).filter(|at| self.cells[*at].is_valid_for_path() == Some(true)).collect();
        let [axis] = &self.axes[..] else { return String::new() };
        match (valid.first(), valid.last()) {
            (Some(first), Some(last)) if last - first + 1 == valid.len() && valid.len() < self.cells.len() => {
                let value = |at: &usize| value_text(&self.cells[*at].values[0]);
                let ends = if first == last {
                    format!("{} = {}", axis.path, value(first))
                } else {
                    format!("{} from {} to {}", axis.path, value(first), value(last))
                };
                format!(" ({ends})")
            }
            _ => String::new(),
        }
    }

    /// All numbers of all points.
    pub fn table(&self) -> Table {
        let column = |name: String, unit| Column { name, unit };
        let parameters = self.axes.iter().map(|axis| column(axis.path.clone(), ""));
        let estimate = ["estimated inertia effect", "estimated tolerance"].map(|name| column(name.to_owned(), "m"));
        let of_quantity = |(name, unit): (&str, &'static str)| {
            let number = |what: &str| column(format!("{name} {what}"), unit);
            let [inertia, engine, reference, tolerance] = ["inertia effect", "engine error", "reference error", "tolerance"].map(number);
            [column(format!("{name} verdict"), ""), inertia, engine, reference, tolerance]
        };
        let columns =
            parameters.chain([column("decided by".to_owned(), "")]).chain(estimate).chain(QUANTITIES.into_iter().flat_map(of_quantity));
        Table { caption: String::new(), columns: columns.collect(), rows: self.cells.iter().map(record).collect() }
    }

    /// Inertia effects over their tolerances at all points, and the largest engine error over its
    /// tolerance; [`NUMBERS`] explains them.
    pub fn shares(&self) -> Table {
        let name = |axis: &Axis| axis.path.rsplit_once('.').map_or(axis.path.as_str(), |(_, last)| last).to_owned();
        let quantities = self.quantities();
        let head = quantities.iter().map(|at| QUANTITIES[*at].0).chain(["engine"]).map(str::to_owned);
        let row = |cell: &Cell| {
            let shares = quantities.iter().map(|at| share_text(cell, *at)).chain([engine_text(cell)]);
            cell.values.iter().map(value_text).chain(shares).collect::<Vec<_>>()
        };
        Table::new("Difference over tolerance by point", self.axes.iter().map(name).chain(head)).with_rows(self.cells.iter().map(row))
    }

    /// Places in [`QUANTITIES`] of the path and of those that differ at some point: without springs
    /// there are no pulls, and without a touch no contact forces.
    pub fn quantities(&self) -> Vec<usize> {
        let differs = |of: &Compared| of.inertia_effect + of.engine_error > 0.0;
        let exists = |at: &usize| self.cells.iter().any(|cell| cell.compared.as_ref().is_some_and(|of| differs(&of[*at])));
        (0..QUANTITIES.len()).filter(|at| *at == 0 || exists(at)).collect()
    }

    /// The answer, the table and what it means.
    pub fn text(&self) -> String {
        let mut lines = Lines::default();
        lines.answer(&self.answer);
        lines.text += &self.shares().text();
        lines.row("numbers", NUMBERS);
        lines.row("decided by", &rule(&self.question));
        if let Some(why) = self.cells.iter().find_map(|cell| cell.failure.as_ref()) {
            lines.row("first failure", why);
        }
        lines.row("wall time", &quantity(self.wall_s, "s"));
        lines.text
    }
}

/// Where all three backends were compared, and why elsewhere not.
pub fn rule(question: &Question) -> String {
    if question.everywhere {
        return "all three backends are compared at every point".to_owned();
    }
    format!(
        "the quasi-static estimate alone where it is at most 1/{CLEAR} or at least {CLEAR} times the tolerance of the path; all three backends are \
         compared elsewhere, at the corners, and where there is no valid estimate (--everywhere: at every point)"
    )
}

/// What the numbers of a point are.
pub const NUMBERS: &str = "inertia effects over their tolerances, and the largest engine error over its tolerance: up to 1 quasi-static is \
                           valid, and the engine within. ~ by estimate alone, ? open";

/// Inertia effect over the tolerance (1) in a quantity, by its place in [`QUANTITIES`]: measured,
/// or for the path by estimate. `None` where there is neither.
pub fn share(cell: &Cell, quantity: usize) -> Option<f64> {
    let measured = cell.compared.as_ref().map(|of| of[quantity].inertia_effect / of[quantity].tolerance);
    let estimated = cell.decided_by_estimate().filter(|_| quantity == 0).map(|estimate| estimate.margin());
    measured.or(estimated).filter(|share| share.is_finite())
}

fn share_text(cell: &Cell, quantity: usize) -> String {
    let answer = cell.compared.as_ref().map(|of| of[quantity].inertia);
    match (share(cell, quantity), answer) {
        _ if cell.failure.is_some() => "failed".to_owned(),
        (_, Some(InertiaAnswer::NothingMoved)) => "at rest".to_owned(),
        (Some(share), Some(InertiaAnswer::Open)) => format!("{}?", rounded(share)),
        (Some(share), Some(_)) => rounded(share),
        (Some(share), None) => format!("~{}", rounded(share)),
        (None, _) => "-".to_owned(),
    }
}

/// Largest engine error over its tolerance (1).
fn engine_text(cell: &Cell) -> String {
    let Some(compared) = &cell.compared else { return "-".to_owned() };
    let shares = compared.iter().filter(|of| of.tolerance > 0.0).map(|of| of.engine_error / of.tolerance);
    let is_open = compared.iter().any(|of| of.engine == EngineAnswer::Open);
    format!("{}{}", rounded(shares.fold(0.0, f64::max)), if is_open { "?" } else { "" })
}

/// A difference over its tolerance (1) for people: what is far below one is noise.
fn rounded(share: f64) -> String {
    const NOISE: f64 = 1e-3;
    if share < NOISE { format!("<{NOISE}") } else { short(share) }
}

/// A value of a parameter for people.
pub fn value_text(value: &Value) -> String {
    match value {
        Value::String(word) => word.clone(),
        value => value.as_f64().map_or_else(|| value.to_string(), short),
    }
}

fn record(cell: &Cell) -> Vec<Field> {
    let parameter = |value: &Value| value.as_f64().map_or_else(|| Field::Word(value_text(value)), Field::Number);
    let by = match (&cell.failure, &cell.compared) {
        (Some(why), _) => format!("failed: {why}"),
        (None, Some(_)) => "comparison".to_owned(),
        (None, None) => "estimate".to_owned(),
    };
    let of_quantity = |at: usize| {
        let of = cell.compared.as_ref().map(|of| &of[at]);
        let verdict = of.map_or(Field::Empty, |of| Field::Word(of.words.clone()));
        let numbers =
            [of.map(|of| of.inertia_effect), of.map(|of| of.engine_error), of.map(|of| of.reference_error), of.map(|of| of.tolerance)];
        std::iter::once(verdict).chain(numbers.map(Field::from)).collect::<Vec<_>>()
    };
    let estimate = [cell.estimate.map(|of| of.inertia_effect_m), cell.estimate.map(|of| of.tolerance_m)].map(Field::from);
    let head = cell.values.iter().map(parameter).chain([Field::Word(by)]).chain(estimate);
    head.chain((0..QUANTITIES.len()).flat_map(of_quantity)).collect()
}
