//! The tables of a regime map, for text and Markdown.

use crate::regime::report::Regime;
use cohaul_report::quantity::number;
use cohaul_report::table::{Field, Table};

/// Counts of cells, a row a panel.
pub fn panels(found: &Regime) -> Table {
    Table::of(
        &found.maps,
        &[
            ("scene", "", &|map| map.scene.name().into()),
            ("zeta", "", &|map| word(map.zeta)),
            ("cells", "", &|map| map.n_cells.into()),
            ("that move", "", &|map| map.n_moving.into()),
            ("that agree within 1 %", "", &|map| map.n_agree.into()),
            ("inconclusive", "", &|map| map.n_inconclusive.into()),
            ("no path found", "", &|map| map.n_not_converged.into()),
            ("reference error", "", &|map| map.reference_error_max_ratio.into()),
        ],
    )
}

/// Measurement over theory, a row a law and damping ratio.
pub fn laws(found: &Regime) -> Table {
    let ratio = |at: usize| move |outcome: &super::LawOutcome| number(outcome.ratio.unwrap_or_default()[at]).into();
    let [least, median, largest] = [0, 1, 2].map(ratio);
    Table::of(
        &found.laws,
        &[
            ("scene", "", &|outcome| outcome.law.scene().name().into()),
            ("law", "", &|outcome| outcome.law.name().into()),
            ("zeta", "", &|outcome| word(outcome.zeta)),
            ("holds in", "", &|outcome| format!("{} of {}", outcome.n_within, outcome.n_cells).into()),
            ("least", "", &least),
            ("median", "", &median),
            ("largest", "", &largest),
            ("causes elsewhere", "", &|outcome| {
                let causes: Vec<String> = outcome.causes.iter().map(|(cause, n)| format!("{} {n}", cause.name())).collect();
                causes.join(", ").into()
            }),
        ],
    )
}

/// The rule of thumb compared with the measurement, a row a scene.
pub fn rule(found: &Regime) -> Table {
    Table::of(
        &found.rule,
        &[
            ("scene", "", &|rule| rule.scene.name().into()),
            ("valid, agrees", "", &|rule| rule.n_valid_and_agree.into()),
            ("valid, differs", "", &|rule| rule.n_valid_but_differ.into()),
            ("not valid, agrees", "", &|rule| rule.n_not_valid_but_agree.into()),
            ("not valid, differs", "", &|rule| rule.n_not_valid_and_differ.into()),
        ],
    )
}

/// A number of the grid, with the digits with which it was chosen.
fn word(value: f64) -> Field {
    format!("{value}").into()
}
