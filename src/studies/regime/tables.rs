//! The tables of a regime map, for text and Markdown.

use crate::output::quantity::number;
use crate::output::table::{Field, Table};
use crate::studies::regime::report::Regime;

/// Panels in numbers.
pub fn panels(found: &Regime) -> Table {
    Table::of(
        &found.maps,
        &[
            ("scene", "", &|map| map.scene.name().into()),
            ("zeta", "", &|map| word(map.zeta)),
            ("cells", "", &|map| map.n_cells.into()),
            ("moving", "", &|map| map.n_moving.into()),
            ("agree", "", &|map| map.n_agree.into()),
            ("unresolved", "", &|map| map.n_unresolved.into()),
            ("not found", "", &|map| map.n_not_converged.into()),
            ("reference error", "", &|map| map.own_error_max_share.into()),
        ],
    )
}

/// Measurement over theory, a row a law and damping ratio.
pub fn laws(found: &Regime) -> Table {
    let ratio = |at: usize| move |standing: &super::Standing| number(standing.ratio.unwrap_or_default()[at]).into();
    let [least, median, largest] = [0, 1, 2].map(ratio);
    Table::of(
        &found.laws,
        &[
            ("scene", "", &|standing| standing.law.scene().name().into()),
            ("law", "", &|standing| standing.law.name().into()),
            ("zeta", "", &|standing| word(standing.zeta)),
            ("within", "", &|standing| format!("{}/{}", standing.n_within, standing.n_cells).into()),
            ("least", "", &least),
            ("median", "", &median),
            ("largest", "", &largest),
            ("causes of the others", "", &|standing| {
                let causes: Vec<String> = standing.causes.iter().map(|(cause, n)| format!("{} {n}", cause.name())).collect();
                causes.join(", ").into()
            }),
        ],
    )
}

/// The rule of thumb against the measurement.
pub fn rule(found: &Regime) -> Table {
    Table::of(
        &found.rule,
        &[
            ("scene", "", &|rule| rule.scene.name().into()),
            ("valid, agrees", "", &|rule| rule.n_sound_and_agree.into()),
            ("valid, differs", "", &|rule| rule.n_sound_but_apart.into()),
            ("not valid, agrees", "", &|rule| rule.n_unsound_but_agree.into()),
            ("not valid, differs", "", &|rule| rule.n_unsound_and_apart.into()),
        ],
    )
}

/// A number as it was chosen, without more digits.
fn word(value: f64) -> Field {
    format!("{value}").into()
}
