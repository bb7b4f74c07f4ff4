//! Parsers of option values.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use cohaul::scenario::nearest;
use cohaul_report::glossary::{self, Entry};
use cohaul_studies::variants::names;

/// Parser of a plain enum by its serialized names. The help lists them with the first sentence of
/// the glossary on each.
pub fn choice<T: Serialize + DeserializeOwned + Clone + Send + Sync + 'static>() -> impl TypedValueParser<Value = T> {
    choice_of("")
}

/// The same for names that mean something else elsewhere: the glossary explains them as
/// `NAME KIND`, as in `aged preset`.
pub fn choice_of<T: Serialize + DeserializeOwned + Clone + Send + Sync + 'static>(kind: &str) -> impl TypedValueParser<Value = T> {
    let names = names::<T>();
    let explained = |name: &str| glossary::entry(&format!("{name} {kind}")).or_else(|| glossary::entry(name));
    let possible = names.iter().map(|name| {
        // The help wants static names: a few bytes for each option that is built.
        let plain: &'static str = name.replace('_', "-").leak();
        let is_shared =
            |entry: &&Entry| names.iter().any(|other| other != name && !is_alias::<T>(other) && explained(other) == Some(*entry));
        let about = explained(plain).filter(|entry| !is_shared(entry));
        let value = PossibleValue::new(plain).hide(is_alias::<T>(name));
        about.map_or(value.clone(), |entry| value.help(entry.summary().to_owned()))
    });
    PossibleValuesParser::new(possible).map(|name: String| parse::<T>(&name).expect("the name is listed"))
}

/// The value of this name.
pub fn parse<T: DeserializeOwned>(name: &str) -> Option<T> {
    let of = |name: String| serde_json::from_value(Value::String(name)).ok();
    of(name.to_owned()).or_else(|| of(name.replace('-', "_")))
}

/// Hint at the known word that is most like a wrong one; empty if none is near.
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(word, known).map_or_else(String::new, |near| format!("; did you mean {near}?"))
}

/// Whether the type reads this name and writes another.
fn is_alias<T: Serialize + DeserializeOwned>(name: &str) -> bool {
    parse::<T>(name).and_then(|found| serde_json::to_value(found).ok()) != Some(Value::from(name))
}

/// Smallest and largest number of an option (1), as those of a scenario: products of a few such
/// numbers are neither zero nor infinite.
const SMALLEST: f64 = 1e-50;
const LARGEST: f64 = 1e50;

pub fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("must be a number, found {text}"))?;
    match value {
        SMALLEST..=LARGEST => Ok(value),
        _ if value.is_finite() && value > 0.0 => Err(format!("must be from {SMALLEST:e} to {LARGEST:e}, found {text}")),
        _ => Err(format!("must be positive and finite, found {text}")),
    }
}

/// A step or an instant (s).
pub fn seconds(text: &str) -> Result<f64, String> {
    positive(text).map_err(|error| error.replace("a number", "a number of seconds"))
}

pub fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (0.0..=LARGEST).contains(&value) => Ok(value),
        Ok(value) if f64::is_finite(value) && value > LARGEST => Err(format!("must be at most {LARGEST:e}, found {text}")),
        _ => Err(format!("must be a finite number, zero or more, found {text}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::analysis::compare::{Tier, Verdict};
    use cohaul::backend::rapier::{EngineSettings, FrictionModel, Precision, SpringModel};
    use cohaul::backend::{BackendKind, Integrator, Skip, Status};
    use cohaul::scenario::presets::Preset;
    use cohaul_paper::calibrate::Case;
    use cohaul_studies::methods::METHODS;
    use cohaul_studies::{regime, sweep};

    fn plain<T: Serialize + DeserializeOwned>() -> Vec<&'static str> {
        names::<T>().iter().copied().filter(|name| !is_alias::<T>(name)).collect()
    }

    /// Contact modes, transitions and triggers are printed by hand.
    const PRINTED: [&str; 14] = [
        "sticking",
        "pinned",
        "slipping",
        "onset",
        "stop",
        "pinning",
        "unpinning",
        "jump",
        "start",
        "release",
        "grasp",
        "slip onset",
        "driving",
        "engine error",
    ];

    #[test]
    fn every_printed_name_is_explained() {
        let options = [plain::<BackendKind>(), plain::<Integrator>(), plain::<Skip>(), plain::<Tier>(), plain::<Preset>()];
        let engine = [plain::<EngineSettings>(), plain::<FrictionModel>(), plain::<Precision>(), plain::<SpringModel>()];
        let studies = [
            plain::<Case>(),
            METHODS.iter().filter(|method| method.is_stressed).map(|method| method.key).collect(),
            plain::<regime::Scene>(),
            plain::<sweep::Method>(),
        ];
        let results = [plain::<Verdict>(), plain::<Status>(), PRINTED.to_vec()];
        for name in [&options[..], &engine, &studies, &results].concat().concat() {
            assert!(glossary::entry(name).is_some(), "{name} has no entry in the glossary");
        }
    }

    /// A hair below and a hair above each bound; what is denormal has no finite inverse.
    #[test]
    fn numbers_of_options_are_of_a_size_to_compute_with() {
        for good in ["1e-50", "1e50", "0.01"] {
            assert_eq!(positive(good), Ok(good.parse().unwrap()));
        }
        for bad in ["9.9e-51", "5e-324", "1.1e50", "1e308"] {
            assert_eq!(positive(bad), Err(format!("must be from 1e-50 to 1e50, found {bad}")));
        }
        for bad in ["0", "-1", "nan", "inf", "1e-400"] {
            assert_eq!(positive(bad), Err(format!("must be positive and finite, found {bad}")));
        }
        assert_eq!((not_negative("0"), not_negative("1e50")), (Ok(0.0), Ok(1e50)));
        assert_eq!(not_negative("1e308"), Err("must be at most 1e50, found 1e308".into()));
    }

    #[test]
    fn names_of_options_are_those_of_the_types() {
        assert_eq!(names::<BackendKind>(), BackendKind::ALL.map(BackendKind::name));
        assert_eq!(parse("inertial"), Some(BackendKind::Inertial));
        assert_eq!(parse("closed-loop"), Some(Tier::ClosedLoop));
        assert_eq!(parse::<BackendKind>("bullet"), None);
        assert!(names::<f64>().is_empty());
    }
}
