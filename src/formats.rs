//! Names and versions of all formats that users keep or that other programs read.
//!
//! A version stays as long as keys are only added. It changes when a key is renamed or removed, or
//! when its type, unit or meaning changes. `tests/program/formats` compares the keys of real
//! outputs with stored lists.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A format of files or of JSON that is printed. Its JSON is `{"name": ..., "version": ...}`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Format {
    /// Name, the same in all versions.
    pub name: &'static str,
    /// Version that this program writes. The first one is 1.
    pub version: u32,
    /// Where data of this format are written.
    #[serde(skip)]
    pub place: &'static str,
    /// Versions that this program reads.
    #[serde(skip)]
    pub reads: Reads,
}

/// Versions of a format that this program reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reads {
    /// None: the program only writes the format.
    None,
    /// The version that it writes and all older ones. Data without a version are of the first one.
    Older,
    /// The version that it writes, and no other.
    Same,
    /// What the same build of the program has written, and nothing else.
    SameBuild,
}

impl Reads {
    /// What happens to data of an older and of a newer version.
    pub fn answers(self) -> [&'static str; 2] {
        match self {
            Self::None => ["not read", "not read"],
            Self::Older => ["read", "refused"],
            Self::Same => ["refused", "refused"],
            Self::SameBuild => ["refused, as those of any other build", "refused"],
        }
    }
}

/// Name and version that were found in a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Found {
    /// Name of the format.
    pub name: String,
    /// Version of the format.
    pub version: u32,
}

impl Format {
    /// Checks the key `format` of an object that was read. An object without it is of the first
    /// version.
    ///
    /// # Errors
    /// When the object has another format, or a version that this program does not read.
    pub fn check(&self, object: &Value) -> Result<(), String> {
        let Some(found) = object.get("format") else { return Ok(()) };
        match Found::deserialize(found) {
            Ok(found) => self.check_found(&found),
            Err(error) => Err(format!("format: must be {{\"name\": ..., \"version\": ...}}, found {found}: {error}")),
        }
    }

    /// The same for a name and a version.
    ///
    /// # Errors
    /// As [`Format::check`].
    pub fn check_found(&self, found: &Found) -> Result<(), String> {
        if found.name != self.name {
            return Err(format!("format.name: must be {:?}, found {:?}", self.name, found.name));
        }
        if !(1..=self.version).contains(&found.version) {
            return Err(format!("format.version: {}, found {}", self.version_rule(), found.version));
        }
        Ok(())
    }

    /// What a version must be for this program to read it.
    pub fn version_rule(&self) -> String {
        let Self { name, version, .. } = self;
        let range = if *version == 1 { "1".to_owned() } else { format!("from 1 to {version}") };
        format!("must be {range}, which this program reads of {name:?}")
    }

    /// Name and version as owned data.
    pub fn found(&self) -> Found {
        Found { name: self.name.to_owned(), version: self.version }
    }
}

/// Data that leave the program as a JSON object of some format.
pub trait Versioned: Serialize {
    /// The format of the object.
    const FORMAT: Format;
}

/// Data with their format as the first key.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Stamped<'a, T> {
    format: Format,
    #[serde(flatten)]
    data: &'a T,
}

/// The data with their format as the first key, for writing.
pub fn stamped<T: Versioned>(data: &T) -> Stamped<'_, T> {
    Stamped { format: T::FORMAT, data }
}

/// Makes a constant of each format, and the list of all.
macro_rules! formats {
    ($($(#[$about:meta])* $constant:ident = ($name:literal, $version:literal, $place:literal, $reads:ident);)*) => {
        $($(#[$about])* pub const $constant: Format =
            Format { name: $name, version: $version, place: $place, reads: Reads::$reads };)*

        /// All formats, files first.
        pub const ALL: &[Format] = &[$($constant),*];
    };
}

formats! {
    /// A scenario file.
    SCENARIO = ("cohaul scenario", 1, "key `format` of a scenario, a whole number; it may be left out", Older);
    /// A stored run that later builds are compared with.
    BASELINE = ("cohaul baseline", 1, "keys `format` and `version` of each file of `check store`", Same);
    /// Stored errors of an engine that later builds of it are compared with.
    GATE_RECORD = ("cohaul gate record", 1, "each file of `gate --record`", Same);
    /// The manifest of an output folder.
    MANIFEST = ("cohaul manifest", 1, "`manifest.json` of each output folder", Older);
    /// The state of a run, from which it continues.
    STATE = ("cohaul state", 1, "key `format` of the record in the file of `run --state`", SameBuild);
    /// Finished records of a study that was interrupted.
    JOURNAL = ("cohaul journal", 1, "key `identity.format` of the first line of `DIR.journal` and of `run --state`", SameBuild);
    /// Rows of a sweep.
    SHARD = ("cohaul sweep rows", 3, "key `identity.format` of the first line of each shard, and of the journal of a sweep", SameBuild);
    /// Messages between the live page and its server.
    LIVE = ("cohaul live", 2, "messages of type `scene` of `view`, and each scene that the page saves", Older);
    /// Result of `run`.
    RUN = ("cohaul run", 1, "`run --json`, `summary.json`", None);
    /// Result of `compare`.
    COMPARE = ("cohaul compare", 3, "`compare --json`, `summary.json`", None);
    /// Result of `compare --vary`.
    MAP = ("cohaul compare map", 1, "`compare --vary --json`, `summary.json`", None);
    /// Result of `compare --threshold`.
    THRESHOLD = ("cohaul threshold", 1, "`compare --threshold --json`, `summary.json`", None);
    /// Result of `measured`.
    MEASURED = ("cohaul measured", 1, "`measured --json`, `summary.json`", None);
    /// Result of `sweep` and `merge`.
    SWEEP = ("cohaul sweep", 1, "`sweep --json`, `merge --json`, `summary.json`", Older);
    /// Result of `sweep --shard`.
    SWEEP_SHARD = ("cohaul sweep shard", 1, "`sweep --shard --json`", None);
    /// Result of `check`.
    CHECK = ("cohaul check", 1, "`check --json`, `summary.json`", None);
    /// Result of `verify`.
    VERIFY = ("cohaul verify", 1, "`verify --json`, `verify.json`", None);
    /// Result of `conformance`.
    CONFORMANCE = ("cohaul conformance", 1, "`conformance --json`, `summary.json`", None);
    /// Result of `gate`.
    GATE = ("cohaul gate", 1, "`gate --json`, `summary.json`", None);
    /// Result of `stress`.
    STRESS = ("cohaul stress", 1, "`stress --json`, `summary.json`", None);
    /// Result of `bench`.
    BENCH = ("cohaul bench", 1, "`bench --json`, `bench.json`", None);
    /// Result of `regime`.
    REGIME = ("cohaul regime", 1, "`regime --json`, `summary.json`", None);
    /// Result of `paper`.
    PAPER = ("cohaul paper", 1, "`paper --json`, `summary.json`", None);
    /// Result of `paper search`.
    PAPER_SEARCH = ("cohaul paper search", 1, "`paper search --json`, `summary.json`", None);
    /// Readings of the paper beside each other.
    PAPER_READINGS = ("cohaul paper readings", 1, "`paper readings --json`, `summary.json`", None);
    /// Standstills of scenes with obstacles.
    PAPER_DEADLOCKS = ("cohaul paper deadlocks", 1, "`paper deadlocks --json`, `summary.json`", None);
    /// Result of `calibrate fit`.
    CALIBRATE_FIT = ("cohaul calibrate fit", 1, "`calibrate fit --json`, `calibration.json`", Older);
    /// Result of `calibrate grid`.
    CALIBRATE_GRID = ("cohaul calibrate grid", 1, "`calibrate grid --json`, `grid.json`", None);
    /// Result of `calibrate design`.
    CALIBRATE_DESIGN = ("cohaul calibrate design", 1, "`calibrate design --json`, `design.json`", None);
    /// Result of `calibrate forces`.
    CALIBRATE_FORCES = ("cohaul calibrate forces", 1, "`calibrate forces --json`, `forces.json`", None);
    /// Result of `calibrate behaviour`.
    CALIBRATE_BEHAVIOUR = ("cohaul calibrate behaviour", 1, "`calibrate behaviour --json`, `behaviour.json`", None);
    /// Result of `calibrate pulls`.
    CALIBRATE_PULLS = ("cohaul calibrate pulls", 1, "`calibrate pulls --json`, `pulls.json`", None);
    /// What an import did to a recording or a drawing.
    IMPORT = ("cohaul import", 1, "`scenario import --json`, `NAME.import.json` beside its `--out`", None);
    /// Result of `colony`.
    COLONY = ("cohaul colony", 1, "`colony --json`, `colony.json`", None);
    /// Result of `scenario check`.
    SCENARIO_CHECK = ("cohaul scenario check", 1, "`scenario check --json`", None);
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[derive(Serialize)]
    struct Result {
        answer: &'static str,
        end_s: f64,
    }

    impl Versioned for Result {
        const FORMAT: Format = RUN;
    }

    #[test]
    fn the_format_is_the_first_key() {
        let text = serde_json::to_string(&stamped(&Result { answer: "yes", end_s: 0.1 })).unwrap();
        assert_eq!(text, r#"{"format":{"name":"cohaul run","version":1},"answer":"yes","end_s":0.1}"#);
    }

    #[test]
    fn an_object_without_a_version_is_of_the_first_one_and_a_newer_one_is_refused_by_name_and_number() {
        let second = Format { version: 2, ..RUN };
        for format in [RUN, second] {
            assert_eq!(format.check(&json!({ "answer": "yes" })), Ok(()));
            assert_eq!(format.check(&json!({ "format": format })), Ok(()));
            assert_eq!(format.check(&json!({ "format": RUN })), Ok(()));
        }
        for (format, found, why) in [
            (RUN, json!(second), "format.version: must be 1, which this program reads of \"cohaul run\", found 2"),
            (second, json!(Format { version: 3, ..RUN }), "must be from 1 to 2, which this program reads of \"cohaul run\", found 3"),
            (RUN, json!(CHECK), "format.name: must be \"cohaul run\", found \"cohaul check\""),
            (RUN, json!(1), "format: must be {\"name\": ..., \"version\": ...}, found 1"),
        ] {
            let error = format.check(&json!({ "format": found })).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
    }

    #[test]
    fn every_name_is_there_once() {
        for (at, format) in ALL.iter().enumerate() {
            assert!(ALL[..at].iter().all(|other| other.name != format.name) && format.version > 0, "{}", format.name);
        }
    }
}
