//! Where a page's numbers come from: enough to run it again.

use crate::manifest::Manifest;
use crate::page::content::{Block, Number, Section};
use crate::table::Table;

pub fn section(manifest: &Manifest) -> Section {
    let commit = manifest.commit.unwrap_or("not built from a repository");
    let machine = &manifest.machine;
    let cpus = machine.n_cpus.map_or(String::new(), |n| format!(", {n} processors"));
    let libraries = &manifest.libraries;
    let mut numbers = vec![
        Number::new("command", manifest.command_line.join(" "), ""),
        Number::new("started", manifest.started.clone(), "UTC"),
        Number::new("program", format!("{} {}", manifest.program, manifest.version), commit),
        Number::new("machine", format!("{} {} {}{cpus}", machine.architecture, machine.system, machine.environment), ""),
        Number::new("scenario, SHA-256", manifest.scenario_sha256.clone(), "of its expanded form below"),
    ];
    if let Some(seed) = manifest.seed {
        numbers.push(Number::new("seed", seed.to_string(), ""));
    }
    let table = Table::new("Libraries that can change a number", ["library", "version"])
        .row(["rapier2d", libraries.rapier2d])
        .row(["parry2d", libraries.parry2d])
        .row(["nalgebra", libraries.nalgebra])
        .row(["clarabel", libraries.clarabel]);
    let pretty = |value: &serde_json::Value| format!("{value:#}");
    let folded = |heading: &str, value| Block::Folded { heading: heading.to_owned(), blocks: vec![Block::Code(pretty(value))] };
    let blocks = vec![
        Block::Numbers(numbers),
        Block::Table(table),
        folded("Options", &manifest.options),
        folded("Scenario as run, defaults filled in", &manifest.scenario),
    ];
    Section { heading: "Where it comes from".to_owned(), blocks }
}
