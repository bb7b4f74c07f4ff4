//! Stored and new errors: better, worse or the same.

use serde::Serialize;

use super::record::{Error, Quantity, SceneRecord};

/// Least change of an error that counts, over the stored one, unless another is asked for (1). An
/// event that falls into another part of a step moves an error by about as much, and a user sees
/// nothing of it.
pub const MARGIN: f64 = 0.01;

/// Rounding of an error over the tolerance of its quantity (1). Another machine moves a run by 1e-8
/// of the scales of its scene at most (see `check`), of which tolerances are a hundredth or more.
const ROUNDING: f64 = 1e-6;

/// What became of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    Better,
    Same,
    Worse,
}

/// A scene in both builds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneChange {
    pub scene: String,
    /// Worse where anything is, better where something is and nothing worse.
    pub change: Change,
    /// What happened to the scene as a whole; `null` where both builds have errors on it.
    pub why: Option<String>,
    /// Whether the new build failed on it.
    pub failed: bool,
    pub quantities: Vec<QuantityChange>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuantityChange {
    pub quantity: String,
    pub unit: String,
    pub change: Change,
    /// What happened to the quantity as a whole; `null` where both builds state it.
    pub why: Option<String>,
    pub errors: Vec<MeasureChange>,
}

/// An error in both builds, in the unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasureChange {
    pub name: String,
    pub stored: f64,
    pub now: f64,
    /// Largest difference that counts as the same.
    pub allowed: f64,
    pub change: Change,
}

impl Change {
    pub const ALL: [Change; 3] = [Change::Better, Change::Same, Change::Worse];

    pub fn name(self) -> &'static str {
        match self {
            Change::Better => "better",
            Change::Same => "same",
            Change::Worse => "worse",
        }
    }

    /// The change of a whole whose parts changed so: worse wins, then better.
    fn of(parts: impl Iterator<Item = Change>) -> Self {
        parts.fold(Change::Same, |whole, part| match (whole, part) {
            (Change::Worse, _) | (_, Change::Worse) => Change::Worse,
            (Change::Better, _) | (_, Change::Better) => Change::Better,
            _ => Change::Same,
        })
    }
}

impl MeasureChange {
    fn of(stored: &Error, now: &Error, margin: f64) -> Self {
        let reference = stored.reference_error + now.reference_error;
        let rounding = ROUNDING * stored.tolerance.max(now.tolerance);
        let allowed = reference.max(rounding).max(margin * stored.engine_error);
        let difference = now.engine_error - stored.engine_error;
        let change = match () {
            () if difference > allowed => Change::Worse,
            () if difference < -allowed => Change::Better,
            () => Change::Same,
        };
        Self { name: stored.name.clone(), stored: stored.engine_error, now: now.engine_error, allowed, change }
    }
}

impl QuantityChange {
    fn of(stored: &Quantity, now: Option<&Quantity>, margin: f64) -> Self {
        let pairs = |now: &Quantity| -> Option<Vec<MeasureChange>> {
            let same = |error: &Error| now.errors.iter().find(|other| other.name == error.name);
            stored.errors.iter().map(|error| Some(MeasureChange::of(error, same(error)?, margin))).collect()
        };
        let errors = now.and_then(pairs);
        let why = errors.is_none().then(|| "the new build states it no more".to_owned());
        let errors = errors.unwrap_or_default();
        let change = if why.is_some() { Change::Worse } else { Change::of(errors.iter().map(|error| error.change)) };
        Self { quantity: stored.quantity.clone(), unit: stored.unit.clone(), change, why, errors }
    }
}

impl SceneChange {
    /// The change from a stored scene to the same one now.
    pub fn of(stored: &SceneRecord, now: &SceneRecord, margin: f64) -> Self {
        let whole = |change, why: Option<String>| Self {
            scene: stored.name.clone(),
            change,
            why,
            failed: now.failed.is_some(),
            quantities: Vec::new(),
        };
        match (&stored.refused, &now.refused, &now.failed) {
            (_, _, Some(why)) => whole(Change::Worse, Some(format!("failed: {why}"))),
            (Some(_), Some(why), _) => whole(Change::Same, Some(format!("refused: {why}"))),
            (None, Some(why), _) => whole(Change::Worse, Some(format!("refused, and was not: {why}"))),
            (Some(_), None, _) => whole(Change::Better, Some("taken, and was refused".to_owned())),
            (None, None, None) => {
                let same = |quantity: &Quantity| now.quantities.iter().find(|other| other.quantity == quantity.quantity);
                let of = |quantity: &Quantity| QuantityChange::of(quantity, same(quantity), margin);
                let quantities: Vec<QuantityChange> = stored.quantities.iter().map(of).collect();
                Self { quantities: quantities.clone(), ..whole(Change::of(quantities.iter().map(|of| of.change)), None) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(engine_error: f64, reference_error: f64) -> Error {
        Error { name: "peak".to_owned(), engine_error, reference_error, tolerance: 1e-3 }
    }

    /// A hair below and a hair above what the largest of the three bounds allows.
    #[test]
    fn a_change_counts_beyond_reference_errors_rounding_and_margin() {
        const HAIR: f64 = 1e-6;
        for (stored, now, margin, allowed) in [
            (error(1e-4, 1e-6), error(1e-4, 2e-6), 0.0, 3e-6),
            (error(1e-4, 0.0), error(1e-4, 0.0), 0.0, 1e-9),
            (error(1e-4, 1e-7), error(1e-4, 1e-7), 0.05, 5e-6),
        ] {
            let change = |by: f64| MeasureChange::of(&stored, &Error { engine_error: stored.engine_error + by, ..now.clone() }, margin);
            assert!((change(0.0).allowed - allowed).abs() <= 1e-12 * allowed, "{:e}", change(0.0).allowed);
            let at = |share: f64| change(share * allowed).change;
            assert_eq!([at(1.0 - HAIR), at(HAIR - 1.0)], [Change::Same; 2]);
            assert_eq!([at(1.0 + HAIR), at(-1.0 - HAIR)], [Change::Worse, Change::Better]);
        }
    }

    #[test]
    fn worse_wins_over_better_and_better_over_same() {
        use Change::{Better, Same, Worse};
        for (parts, whole) in [(vec![], Same), (vec![Same, Better], Better), (vec![Better, Worse, Same], Worse)] {
            assert_eq!(Change::of(parts.into_iter()), whole);
        }
    }

    #[test]
    fn a_scene_or_a_quantity_that_is_lost_is_worse() {
        let taken = SceneRecord {
            name: "scene".to_owned(),
            scenario: serde_json::Value::Null,
            refused: None,
            failed: None,
            quantities: vec![Quantity { quantity: "path".to_owned(), unit: "m".to_owned(), errors: vec![error(1e-4, 0.0)] }],
        };
        let refused = SceneRecord { refused: Some("no walls".to_owned()), quantities: Vec::new(), ..taken.clone() };
        let failed = SceneRecord { failed: Some("NaN".to_owned()), quantities: Vec::new(), ..taken.clone() };
        let silent = SceneRecord { quantities: Vec::new(), ..taken.clone() };
        let change = |stored: &SceneRecord, now: &SceneRecord| {
            let found = SceneChange::of(stored, now, 0.0);
            (found.change, found.failed)
        };
        assert_eq!(change(&taken, &taken), (Change::Same, false));
        assert_eq!(change(&taken, &refused), (Change::Worse, false));
        assert_eq!(change(&refused, &taken), (Change::Better, false));
        assert_eq!(change(&refused, &refused), (Change::Same, false));
        assert_eq!(change(&refused, &failed), (Change::Worse, true));
        assert_eq!(change(&taken, &silent), (Change::Worse, false));
    }
}
