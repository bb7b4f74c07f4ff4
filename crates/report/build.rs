//! Tells the program the compiler, how it is built, and the versions of the libraries that can change
//! a number.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if let (Ok(profile), Ok(level)) = (env::var("PROFILE"), env::var("OPT_LEVEL")) {
        println!("cargo::rustc-env=COHAUL_PROFILE={profile} profile, opt-level {level}");
    }
    let compiler = env::var_os("RUSTC").and_then(|rustc| Command::new(rustc).arg("--version").output().ok());
    if let Some(output) = compiler.filter(|output| output.status.success()) {
        println!("cargo::rustc-env=COHAUL_COMPILER={}", String::from_utf8_lossy(&output.stdout).trim());
    }
    tell_versions();
}

/// The libraries with their versions, and where one comes from that is not the published one.
fn tell_versions() {
    let folders = ["CARGO_MANIFEST_DIR", "OUT_DIR"].map(|name| PathBuf::from(env::var_os(name).unwrap_or_default()));
    let found = folders.iter().flat_map(|folder| folder.ancestors()).map(|folder| folder.join("Cargo.lock")).find(|lock| lock.exists());
    let lock = found.as_deref().and_then(|lock| fs::read_to_string(lock).ok()).unwrap_or_default();
    found.iter().for_each(|lock| println!("cargo::rerun-if-changed={}", Path::display(lock)));
    for (library, package) in [("RAPIER2D", "rapier2d-f64"), ("PARRY2D", "parry2d-f64"), ("NALGEBRA", "nalgebra"), ("CLARABEL", "clarabel")]
    {
        println!("cargo::rustc-env=COHAUL_{library}={}", version(&lock, package).unwrap_or_else(|| "unknown".to_owned()));
    }
}

/// Version of a package in a lock file, with its source if that is not a registry: of a fork.
fn version(lock: &str, package: &str) -> Option<String> {
    let entry = lock.split("[[package]]").find(|entry| entry.lines().any(|line| line == format!("name = \"{package}\"")))?;
    let value = |key: &str| entry.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = \"")?.strip_suffix('"'));
    let version = value("version")?;
    Some(match value("source") {
        Some(source) if source.starts_with("registry+") || source.starts_with("sparse+") => version.to_owned(),
        Some(source) => format!("{version} from {source}"),
        None => format!("{version} from a folder"),
    })
}
