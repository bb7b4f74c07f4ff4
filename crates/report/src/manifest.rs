//! Where a result comes from: enough to run it again and to know on what it ran.

use std::sync::OnceLock;
use std::time::SystemTime;

use serde::Serialize;
use serde_json::Value;

use crate::json;
use cohaul::analysis::compare::EngineName;
use cohaul::backend::BackendKind;
use cohaul::formats::{self, Format};

/// What `manifest.json` says of a run, the list of files aside.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Manifest {
    pub format: Format,
    /// Always `cohaul`: an output folder is known by it.
    pub program: &'static str,
    pub version: &'static str,
    /// Commit of the source; `null` where it was not built from a repository.
    pub commit: Option<&'static str>,
    pub libraries: Libraries,
    pub machine: Machine,
    pub command_line: Vec<String>,
    /// Start of the run, in UTC as of ISO 8601.
    pub started: String,
    /// `null` of a result of several seeds, which then stand in the scenarios.
    pub seed: Option<u64>,
    /// Backend and steps of a run; settings of a comparison or a check.
    pub options: Value,
    /// SHA-256 of the scenario as the caller hashed it, in hexadecimal.
    pub scenario_sha256: String,
    /// The scenario as run, defaults filled in.
    pub scenario: Value,
}

/// Versions of the libraries that can change a number, as the program was built with them. One that
/// is not the published one, as a fork of rapier, has its source too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Libraries {
    pub rapier2d: &'static str,
    pub parry2d: &'static str,
    pub nalgebra: &'static str,
    pub clarabel: &'static str,
}

/// What the program was built for and runs on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    pub architecture: &'static str,
    pub system: &'static str,
    /// C library of the target, part of which are `sin` and `exp`: `gnu`, `musl` or `msvc`.
    pub environment: &'static str,
    /// Processors this program may use; `null` when the system does not say.
    pub n_cpus: Option<usize>,
}

impl Libraries {
    pub const USED: Libraries = Libraries {
        rapier2d: env!("COHAUL_RAPIER2D"),
        parry2d: env!("COHAUL_PARRY2D"),
        nalgebra: env!("COHAUL_NALGEBRA"),
        clarabel: env!("COHAUL_CLARABEL"),
    };

    /// A backend of this program as an engine: rapier in its own version.
    pub fn engine(kind: BackendKind) -> EngineName {
        let version = if kind.is_exact() { env!("CARGO_PKG_VERSION") } else { Self::USED.rapier2d };
        EngineName { name: kind.name().into(), version: Some(version.to_owned()) }
    }
}

impl Machine {
    pub fn here() -> Self {
        let environment = match (cfg!(target_env = "gnu"), cfg!(target_env = "musl"), cfg!(target_env = "msvc")) {
            (true, ..) => "gnu",
            (_, true, _) => "musl",
            (.., true) => "msvc",
            _ => "",
        };
        Self {
            architecture: std::env::consts::ARCH,
            system: std::env::consts::OS,
            environment,
            n_cpus: std::thread::available_parallelism().ok().map(usize::from),
        }
    }
}

impl Manifest {
    /// The manifest of a run of `scenario` by this program on this machine.
    ///
    /// # Panics
    /// When a number of the scenario or the options is not finite.
    pub fn new(
        scenario: &impl Serialize,
        scenario_sha256: String,
        seed: impl Into<Option<u64>>,
        options: &impl Serialize,
        command_line: Vec<String>,
        started: SystemTime,
    ) -> Self {
        let (version, commit) = build_of_program();
        Self {
            format: formats::MANIFEST,
            program: PROGRAM,
            version,
            commit,
            libraries: Libraries::USED,
            machine: Machine::here(),
            command_line,
            started: humantime::format_rfc3339_seconds(started).to_string(),
            seed: seed.into(),
            options: json::plain(options),
            scenario_sha256,
            scenario: json::plain(scenario),
        }
    }
}

/// Version of this program, and the commit that it was built from, if that is known.
pub fn build_of_program() -> (&'static str, Option<&'static str>) {
    (env!("CARGO_PKG_VERSION"), COMMIT.get().copied())
}

static COMMIT: OnceLock<&'static str> = OnceLock::new();

/// Says which commit the program is built from, which only its own build script knows.
pub fn built_from(commit: Option<&'static str>) {
    if let Some(commit) = commit {
        COMMIT.get_or_init(|| commit);
    }
}

/// Compiler of this program, if it is known.
pub const COMPILER: Option<&str> = option_env!("COHAUL_COMPILER");

/// The value of `program` in a manifest.
pub(crate) const PROGRAM: &str = "cohaul";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::manifest;
    use cohaul::scenario::sha256_hex;

    #[test]
    fn library_versions_are_those_of_the_lock_file() {
        let lock = include_str!("../../../Cargo.lock");
        let used = Libraries::USED;
        for (name, version) in [
            ("rapier2d", used.rapier2d),
            ("rapier2d-f64", used.rapier2d),
            ("parry2d", used.parry2d),
            ("parry2d-f64", used.parry2d),
            ("nalgebra", used.nalgebra),
            ("clarabel", used.clarabel),
        ] {
            let heads: Vec<_> = lock.match_indices(&format!("name = \"{name}\"\n")).collect();
            assert_eq!(heads.len(), 1, "{name} is there once");
            let rest = &lock[heads[0].0 + heads[0].1.len()..];
            assert_eq!(rest.lines().next(), Some(format!("version = \"{version}\"").as_str()), "{name}");
        }
    }

    #[test]
    fn the_start_is_a_utc_time_and_the_hash_a_known_one() {
        // A leap day, by `date -u -d @1709210096`.
        assert_eq!(manifest().started, "2024-02-29T12:34:56Z");
        // FIPS 180-2, the one-block example.
        assert_eq!(sha256_hex(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }
}
