//! Several engines side by side, on the same scene and the same exact paths.

use crate::compare::answer::words_of;
use crate::compare::comparison::Refusal;
use crate::compare::words::{WORDS, wrapped};
use cohaul::analysis::compare::{EngineAnswer, Pathwise, QuantityVerdict};
use cohaul_report::page::Block;
use cohaul_report::quantity::of_run::short_quantity;
use cohaul_report::quantity::short;
use cohaul_report::table::Table;

/// Columns for a name.
const NAME: usize = 20;

/// Whether there are others beside the one engine that was compared.
pub fn is_shown(found: &[&Pathwise], refused_by: &[Refusal]) -> bool {
    found.len() + refused_by.len() > 1
}

/// A line for each engine: its errors on the path, and what is not within its tolerance.
pub fn text(found: &[&Pathwise], refused_by: &[Refusal]) -> String {
    let row = |[name, path, step, order, model, beyond]: [&str; 6]| {
        format!("{}\n", format!("{name:<NAME$} {path:<9} {step:<9} {order:<9} {model:<9} {beyond}").trim_end())
    };
    let mut text = row(["Engine error", "path", "time step", "order", "model", "not within"]);
    for of in found {
        let [path, step, order, model] = on_path(of);
        let mut name = format!("  {}", of.engine.name);
        if name.chars().count() > NAME {
            // A long name has a line of its own.
            text += &format!("{name}\n");
            name.clear();
        }
        let mut words = wrapped(&beyond(of), WORDS).into_iter();
        text += &row([&name, &path, &step, &order, &model, &words.next().unwrap_or_default()]);
        words.for_each(|rest| text += &row(["", "", "", "", "", &rest]));
    }
    for Refusal { engine, .. } in refused_by {
        text += &format!("  {}: refuses the scene\n", engine.name);
    }
    text
}

/// The section of a report: the errors of each engine on every quantity.
pub fn section(found: &[&Pathwise], refused_by: &[Refusal]) -> Vec<Block> {
    let on_path_alone = ["engine", "version", "error on the path", "time step", "order", "model", "error of time step and model"];
    let mut paths = Table::new("Engine errors on the path; the tolerance is that of all", on_path_alone);
    let names: Vec<&str> = found.iter().flat_map(|of| of.verdicts.shown()).map(|(name, _)| name).collect();
    let mut quantities: Vec<&str> = Vec::new();
    names.into_iter().for_each(|name| {
        if !quantities.contains(&name) {
            quantities.push(name)
        }
    });
    let mut shares = Table::new("Engine errors over their tolerances (1)", ["engine"].into_iter().chain(quantities.iter().copied()));
    let mut causes = Table::new("Causes of what exceeds a tolerance", ["engine"].into_iter().chain(quantities.iter().copied()));
    for of in found {
        let name = || of.engine.name.to_string();
        let uncertainty = short_quantity(of.reference_error.engine.edge_displacement_max_m, "m");
        let [path, step, order, model] = on_path(of);
        paths.push([name(), of.engine.version.clone().unwrap_or_default(), path, step, order, model, uncertainty]);
        let cell = |quantity: &str, text: fn(&QuantityVerdict) -> String| {
            of.verdicts.shown().find(|(name, _)| *name == quantity).map_or("not judged".to_owned(), |(_, of)| text(of))
        };
        let row = |text: fn(&QuantityVerdict) -> String| [name()].into_iter().chain(quantities.iter().map(move |name| cell(name, text)));
        shares.push(row(share));
        causes.push(row(|of| Some(words_of(of, [false, true])).filter(|words| !words.is_empty()).unwrap_or_else(|| "within".to_owned())));
    }
    let mut refusals = Table::new("Engines that refuse the scene", ["engine", "version", "why"]);
    for Refusal { engine, why } in refused_by {
        refusals.push([engine.name.to_string(), engine.version.clone().unwrap_or_default(), why.clone()]);
    }
    let tables = [paths, shares, causes].into_iter().chain((!refused_by.is_empty()).then_some(refusals));
    tables.map(Block::Table).collect()
}

/// Error on the path, its part of the time step with the order, and its part of the model.
fn on_path(of: &Pathwise) -> [String; 4] {
    let metres = |value: f64| short_quantity(value, "m");
    let [step, model] = [&of.time_step_error, &of.model_error].map(|error| metres(error.edge_displacement_max_m));
    let order = of.time_step_order.map_or("none".to_owned(), |order| format!("{order:.2}"));
    [metres(of.edge_displacement.engine_error_m), step, order, model]
}

fn share(of: &QuantityVerdict) -> String {
    let (error, tolerance) = of.worst_of_engine().map_or((of.engine_error, of.tolerance), |it| (it.engine_error, it.tolerance));
    if tolerance > 0.0 { short(error / tolerance) } else { "not judged".to_owned() }
}

/// The quantities on which the engine is not within a tolerance.
fn beyond(of: &Pathwise) -> String {
    of.verdicts.shown().filter(|(_, of)| of.engine == EngineAnswer::NotWithin).map(|(name, _)| name).collect::<Vec<_>>().join(", ")
}
