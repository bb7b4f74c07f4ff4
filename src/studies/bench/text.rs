//! A benchmark as text: what each error costs, scene by scene, then solvers, growth and how far the
//! times can be trusted.

use std::fmt::Write;

use crate::output::quantity::{number, quantity};
use crate::output::table::Table;
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
    if found.rows.iter().any(|row| row.method.starts_with("rapier")) {
        text.push_str(ENGINE_SETTINGS);
    }
    text.push_str(&trust_text(found));
    text
}

/// Settings behind the names of the engine's variants.
const ENGINE_SETTINGS: &str = "\
rapier engine defaults: four substeps with one sweep each, friction in boxes, contacts as springs of 60 Hz
all other variants of rapier: one substep with 24 or 48 sweeps, contacts rigid and found in every step
";

/// Levels of error to the right, methods downwards; in each cell CPU time and, in brackets, what
/// that is over the best rapier variant.
fn scene_text(facts: &SceneFacts, found: &Benchmark) -> String {
    let lines: Vec<&EqualError> = found.equal_error.iter().filter(|line| line.scene == facts.scene).collect();
    let methods = METHODS.iter().map(|method| method.name).filter(|name| lines.iter().any(|line| line.method == *name));
    let mut levels: Vec<f64> = lines.iter().filter(|line| line.cpu_s.is_some()).map(|line| line.error).collect();
    levels.dedup();
    let inertia = facts.inertia_effect_m.map_or(String::new(), |apart| format!(", inertia effect {}", quantity(apart, "m")));
    let mut text = format!("{}: path length {}{inertia}\n", facts.scene, quantity(facts.path_length_m, "m"));
    let heads = levels.iter().map(|level| format!("{level:.0e}"));
    let mut table = Table::new("", ["error / path length".to_owned()].into_iter().chain(heads));
    for method in methods {
        let cell = |level: &f64| {
            let line = lines.iter().find(|line| line.error == *level && line.method == method);
            line.and_then(|line| line.cpu_s.map(|cpu| (cpu, line.over_rapier)))
                .map_or("-".to_owned(), |(cpu, ratio)| quantity(cpu, "s") + &ratio.map_or(String::new(), |ratio| format!(" ({ratio:.3})")))
        };
        table.push([method.to_owned()].into_iter().chain(levels.iter().map(cell)));
    }
    text.push_str(&table.text());
    let failures = found.rows.iter().filter(|row| row.scene == facts.scene && row.cause.is_some()).count();
    if failures > 0 {
        writeln!(text, "  {failures} settings failed or took too long; bench.csv says why").expect("a string takes all");
    }
    text
}

fn solvers_text(found: &Benchmark) -> String {
    if found.solvers.is_empty() {
        return String::new();
    }
    let mut table = Table::new("", ["problems", "solver", "number", "time each", "over exact", "median residual", "largest"]);
    for line in &found.solvers {
        table.push([
            line.problems.to_owned(),
            line.solver.to_owned(),
            line.n_problems.to_string(),
            line.cpu_min_s.map_or("-".to_owned(), |cpu| quantity(cpu, "s")),
            line.over_exact.map_or("-".to_owned(), |ratio| format!("{ratio:.1}")),
            number(line.residual_median),
            number(line.residual_max),
        ]);
    }
    format!("solvers on the friction problems of four ants on four springs\n{}", table.text())
}

fn growth_text(fits: &[FitLine]) -> String {
    if fits.is_empty() {
        return String::new();
    }
    let with_error = |value: Option<f64>, error: Option<f64>, show: &dyn Fn(f64) -> String| {
        value.map_or("-".to_owned(), |value| show(value) + &error.map_or(String::new(), |error| format!(" +- {}", show(error))))
    };
    let mut table = Table::new("", ["number of", "backend", "exponent", "cost of one more", "constant cost"]);
    for fit in fits {
        table.push([
            fit.quantity.to_owned(),
            fit.backend.to_owned(),
            with_error(fit.exponent, fit.exponent_error, &|value| format!("{value:.3}")),
            with_error(fit.slope_s, fit.slope_error_s, &|value| quantity(value, "s")),
            fit.offset_s.map_or("-".to_owned(), |offset| quantity(offset, "s")),
        ]);
    }
    format!("growth of the CPU time of a step, or of a control tick with ants\n{}", table.text())
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
    writeln!(text, "{n} of {all} median times exceed {limit} times the least; the benchmark took {}", quantity(found.wall_s, "s"))
        .expect("a string takes all");
    text
}
