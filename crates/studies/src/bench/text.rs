//! A benchmark as text: what each error costs, scene by scene, then solvers, growth and how far the
//! times can be trusted.

use std::fmt::Write;

use crate::bench::report::Benchmark;
use crate::bench::{Ending, EqualError, Fit, SceneFacts, SolverRow, fits};
use crate::methods::Method;
use cohaul_report::quantity::{number, quantity};
use cohaul_report::table::{Table, wrapped};
use cohaul_report::text::WIDTH;

/// Everything that people read; all settings are in the tables.
pub fn bench_text(found: &Benchmark) -> String {
    let mut text = String::new();
    for facts in &found.scenes {
        text.push_str(&scene_text(facts, found));
    }
    text.push_str(&solvers_text(found));
    text.push_str(&growth_text(&fits(&found.measured.growth)));
    if found.measured.rows.iter().any(|row| row.method.starts_with("rapier")) {
        text.push_str(ENGINE_SETTINGS);
    }
    for engine in &found.engines {
        writeln!(text, "{}: real time after its start, since it computes elsewhere", engine.text()).expect("a string takes all");
    }
    for (engine, what) in found.faults() {
        writeln!(text, "{engine}: {what}").expect("a string takes all");
    }
    text.push_str(&trust_text(found));
    text
}

/// Settings behind the names of the engine's variants.
const ENGINE_SETTINGS: &str = "\
rapier engine defaults: four substeps with one sweep each, friction in boxes,
  contacts as springs of 60 Hz
all other variants of rapier: one substep with 24 or 48 sweeps, contacts rigid
  and found in every step
";

fn scene_text(facts: &SceneFacts, found: &Benchmark) -> String {
    let inertia = facts.inertia_effect_m.map_or(String::new(), |apart| format!(", inertia effect {}", quantity(apart, "m")));
    let mut text = format!("{}: path length {}{inertia}\n", facts.scene, quantity(facts.path_length_m, "m"));
    text.push_str(&equal_error_table(facts, found, "error / path length", "-", |ratio| format!("{ratio:.3}")).text());
    let failures = found.measured.rows.iter().filter(|row| row.scene == facts.scene && row.ending != Ending::Converged).count();
    if failures > 0 {
        writeln!(text, "  {failures} settings failed or took too long; bench.csv says why").expect("a string takes all");
    }
    text
}

/// Levels of error to the right, methods downwards; in each cell CPU time and, in brackets, what
/// that is over the best rapier variant.
pub fn equal_error_table(facts: &SceneFacts, found: &Benchmark, head: &str, missing: &str, shown: impl Fn(f64) -> String) -> Table {
    let lines: Vec<&EqualError> = found.equal_error.iter().filter(|line| line.scene == facts.scene).collect();
    let mut levels: Vec<f64> = lines.iter().filter(|line| line.cpu_s.is_some()).map(|line| line.error).collect();
    levels.dedup();
    let heads = levels.iter().map(|level| format!("{level:.0e}"));
    let mut table = Table::new("", [head.to_owned()].into_iter().chain(heads));
    for method in Method::all().map(|method| method.name).filter(|name| lines.iter().any(|line| line.method == *name)) {
        let cell = |level: &f64| {
            let line = lines.iter().find(|line| line.error == *level && line.method == method)?;
            let ratio = line.over_rapier.map_or(String::new(), |ratio| format!(" ({})", shown(ratio)));
            line.cpu_s.map(|cpu| quantity(cpu, "s") + &ratio)
        };
        let cells = levels.iter().map(|level| cell(level).unwrap_or_else(|| missing.to_owned()));
        table.push([method.to_owned()].into_iter().chain(cells));
    }
    table
}

fn solvers_text(found: &Benchmark) -> String {
    if found.measured.solvers.is_empty() {
        return String::new();
    }
    let table = solver_table(found, ["median residual", "largest"], "-", |ratio| format!("{ratio:.1}"));
    format!("solvers on the friction problems of four ants on four springs\n{}", table.text())
}

/// A solver a row; `residuals` are the heads of the last columns.
pub fn solver_table(found: &Benchmark, residuals: [&str; 2], missing: &str, shown: impl Fn(f64) -> String) -> Table {
    let rows = &found.measured.solvers;
    let cells = |row: &SolverRow| {
        [
            row.sequence.name().to_owned(),
            row.solver.name().to_owned(),
            row.n_problems.to_string(),
            row.timing().map_or(missing.to_owned(), |timing| quantity(timing.min_s, "s")),
            row.over_exact(rows).map_or(missing.to_owned(), &shown),
            number(row.residual_median),
            number(row.residual_max),
        ]
    };
    let head = ["problems", "solver", "number", "time each", "over exact"].into_iter().chain(residuals);
    Table::new("", head).with_rows(rows.iter().map(cells))
}

fn growth_text(fits: &[Fit]) -> String {
    if fits.is_empty() {
        return String::new();
    }
    let with_error = |value: Option<f64>, error: Option<f64>, show: &dyn Fn(f64) -> String| {
        value.map_or("-".to_owned(), |value| show(value) + &error.map_or(String::new(), |error| format!(" +- {}", show(error))))
    };
    let mut table = Table::new("", ["number of", "backend", "exponent", "cost of one more", "constant cost"]);
    for fit in fits {
        let (law, line) = (fit.power_law, fit.line);
        table.push([
            fit.quantity.name().to_owned(),
            fit.backend.name().to_owned(),
            with_error(law.map(|law| law.exponent), law.and_then(|law| law.exponent_error), &|value| format!("{value:.3}")),
            with_error(line.map(|line| line.slope), line.and_then(|line| line.slope_error), &|value| quantity(value, "s")),
            line.map_or("-".to_owned(), |line| quantity(line.offset, "s")),
        ]);
    }
    format!("growth of the CPU time of a step, or of a control tick with ants\n{}", table.text())
}

fn trust_text(found: &Benchmark) -> String {
    let (host, noise) = (&found.host, &found.noise);
    let cpu = host.cpu.as_deref().unwrap_or("unknown processor");
    let cpus = host.n_cpus.map_or(String::new(), |n| format!(", {n} processors"));
    let load = host.load_average.map_or(String::new(), |load| format!(", load {load:.2} at the start"));
    let compiler = host.rustc.unwrap_or("unknown compiler");
    let commit = host.commit.map_or(String::new(), |commit| format!(", commit {}", commit.chars().take(12).collect::<String>()));
    let (n, all, limit, took) = (noise.n_spread, noise.n_timings, noise.most_spread, quantity(found.wall_s, "s"));
    [
        format!("CPU times of one thread, the least of up to {} rounds, on {cpu}{cpus}{load}", found.effort.repeats),
        format!("cohaul {}{commit}, {compiler}", host.version),
        format!("{n} of {all} median times exceed {limit} times the least; the benchmark took {took}"),
    ]
    .map(|line| format!("{}\n", wrapped(&line, 2, WIDTH - 2)))
    .concat()
}
