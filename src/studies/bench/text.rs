//! A benchmark as text: what each error costs, scene by scene, then solvers, growth and how far the times can be trusted.

use std::fmt::Write;

use crate::output::quantity::{number, quantity};
use crate::studies::bench::report::{Benchmark, FitLine};
use crate::studies::bench::{EqualError, SceneFacts};
use crate::studies::methods::METHODS;

/// Everything that people read; all settings are in the tables.
pub fn bench_text(found: &Benchmark) -> String {
    let mut text = String::new();
    for facts in &found.scenes {
        text.push_str(&scene_text(facts, found));
    }
    text.push_str(&solvers_text(found));
    text.push_str(&growth_text(&found.fits));
    text.push_str(&trust_text(found));
    text
}

/// Levels of error to the right, methods downwards; in each cell CPU time and, in brackets, what that is over the best rapier variant.
fn scene_text(facts: &SceneFacts, found: &Benchmark) -> String {
    let lines: Vec<&EqualError> = found.equal_error.iter().filter(|line| line.scene == facts.scene).collect();
    let methods = METHODS.iter().map(|method| method.name).filter(|name| lines.iter().any(|line| line.method == *name));
    let mut levels: Vec<f64> = lines.iter().filter(|line| line.cpu_s.is_some()).map(|line| line.error).collect();
    levels.dedup();
    let inertia = facts.inertia_effect_m.map_or(String::new(), |apart| format!(", inertia moves the rim by {}", quantity(apart, "m")));
    let mut text = format!("{}: way of {}{inertia}\n", facts.scene, quantity(facts.path_length_m, "m"));
    let heads = levels.iter().map(|level| format!("{level:.0e}")).collect();
    let mut table = vec![("error of the way".to_owned(), heads)];
    for method in methods {
        let cell = |level: &f64| {
            let line = lines.iter().find(|line| line.error == *level && line.method == method);
            line.and_then(|line| line.cpu_s.map(|cpu| (cpu, line.over_rapier)))
                .map_or("-".to_owned(), |(cpu, ratio)| quantity(cpu, "s") + &ratio.map_or(String::new(), |ratio| format!(" ({ratio:.3})")))
        };
        table.push((method.to_owned(), levels.iter().map(cell).collect::<Vec<String>>()));
    }
    text.push_str(&aligned(&table));
    let failures = found.rows.iter().filter(|row| row.scene == facts.scene && row.cause.is_some()).count();
    if failures > 0 {
        writeln!(text, "  {failures} settings without a plain success, with their causes in bench.csv and under rows in the JSON")
            .expect("a string takes all");
    }
    text
}

/// Rows of a head and cells, in columns.
fn aligned(table: &[(String, Vec<String>)]) -> String {
    let head = table.iter().map(|(head, _)| head.chars().count()).max().unwrap_or(0);
    let n = table.iter().map(|(_, cells)| cells.len()).max().unwrap_or(0);
    let width = |column: usize| table.iter().filter_map(|(_, cells)| cells.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..n).map(width).collect();
    let row = |(name, cells): &(String, Vec<String>)| {
        let cells: String = cells.iter().zip(&widths).map(|(cell, width)| format!("  {cell:<width$}")).collect();
        format!("  {name:<head$}{cells}").trim_end().to_owned() + "\n"
    };
    table.iter().map(row).collect()
}

fn solvers_text(found: &Benchmark) -> String {
    if found.solvers.is_empty() {
        return String::new();
    }
    let mut table = vec![(
        "friction problems".to_owned(),
        ["solver", "number", "time each", "over exact", "residual, median", "at most"].map(str::to_owned).to_vec(),
    )];
    for line in &found.solvers {
        let cells = vec![
            line.solver.to_owned(),
            line.n_problems.to_string(),
            line.cpu_min_s.map_or("-".to_owned(), |cpu| quantity(cpu, "s")),
            line.over_exact.map_or("-".to_owned(), |ratio| format!("{ratio:.1}")),
            number(line.residual_median),
            number(line.residual_max),
        ];
        table.push((line.problems.to_owned(), cells));
    }
    format!("solvers on the friction problems of four ants on four springs\n{}", aligned(&table))
}

fn growth_text(fits: &[FitLine]) -> String {
    if fits.is_empty() {
        return String::new();
    }
    let with_error = |value: Option<f64>, error: Option<f64>, show: &dyn Fn(f64) -> String| {
        value.map_or("-".to_owned(), |value| show(value) + &error.map_or(String::new(), |error| format!(" +- {}", show(error))))
    };
    let mut table = vec![(
        "cost of a step, or of a tick, over".to_owned(),
        ["backend", "grows as n to the", "one more costs", "besides"].map(str::to_owned).to_vec(),
    )];
    for fit in fits {
        let cells = vec![
            fit.backend.to_owned(),
            with_error(fit.exponent, fit.exponent_error, &|value| format!("{value:.3}")),
            with_error(fit.slope_s, fit.slope_error_s, &|value| quantity(value, "s")),
            fit.offset_s.map_or("-".to_owned(), |offset| quantity(offset, "s")),
        ];
        table.push((fit.quantity.to_owned(), cells));
    }
    aligned(&table)
}

fn trust_text(found: &Benchmark) -> String {
    let (host, noise) = (&found.host, &found.noise);
    let cpu = host.cpu.as_deref().unwrap_or("unknown processor");
    let cpus = host.n_cpus.map_or(String::new(), |n| format!(", {n} processors"));
    let load = host.load_average.map_or(String::new(), |load| format!(", load {load:.2} at the start"));
    let mut text = format!("CPU times of one thread, the least of up to {} rounds, on {cpu}{cpus}{load}\n", found.effort.repeats);
    let compiler = host.rustc.unwrap_or("unknown compiler");
    let commit = host.commit.map_or(String::new(), |commit| format!(", commit {}", commit.chars().take(12).collect::<String>()));
    writeln!(text, "cohaul {}{commit}, {compiler}", host.version).expect("a string takes all");
    let (n, all, limit) = (noise.n_spread, noise.n_timings, noise.most_spread);
    writeln!(text, "{n} of {all} medians are more than {limit} times the least; {}", quantity(found.wall_s, "s"))
        .expect("a string takes all");
    text
}
