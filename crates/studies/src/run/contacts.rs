//! What a run says of its contacts with obstacles.

use cohaul::backend::EnergyLedger;
use cohaul::simulation::run_facts::Run;
use cohaul_report::quantity::of_run::{quantity, short_quantity};
use cohaul_report::table::Table;
use cohaul_report::text::{Detail, Lines};
use cohaul_report::transition_words::in_words;

/// Number of transitions at obstacles in a brief text (1).
const FEW: usize = 5;

/// Adds what happened at obstacles, where it went, and whether the contact forces are unique.
pub fn add_contacts(run: &Run, detail: Detail, lines: &mut Lines) {
    let world = &run.scenario.system.world;
    if world.is_empty() {
        return;
    }
    let (outcome, energy) = (run.outcome, &run.outcome.energy);
    let n_shown = if detail == Detail::Full { outcome.contact_transitions.len() } else { FEW };
    for (at, transition) in outcome.contact_transitions.iter().take(n_shown).enumerate() {
        let label = if at == 0 { "contacts" } else { "" };
        lines.row(label, &format!("{}: {}", short_quantity(transition.time, "s"), in_words(&transition.kind, world)));
    }
    let n_left = n_transitions(run).saturating_sub(n_shown as u64);
    match outcome.contact_transitions.is_empty() {
        true => lines.row("contacts", "none"),
        false if n_left > 0 => lines.row("", &format!("and {n_left} more, see transitions.csv of --out")),
        false => {}
    }
    if run.options.kind.is_exact() && outcome.steps.is_indeterminate {
        lines.row("contact forces", "not unique in some steps: other forces balance the load too");
    }
    if detail == Detail::Brief {
        lines.row("at obstacles", &losses(energy));
    }
}

fn losses(energy: &EnergyLedger) -> String {
    let [friction, impacts, work] = [energy.side_friction, energy.impacts, energy.obstacle_work].map(|value| short_quantity(value, "J"));
    format!("friction {friction}, impacts {impacts}, work on the load {work}")
}

/// Number of transitions at obstacles, with those that are not kept.
fn n_transitions(run: &Run) -> u64 {
    let counts = &run.outcome.transitions;
    let changes = counts.n_touch + counts.n_separation + counts.n_side_stick + counts.n_side_slip;
    changes + counts.n_impacts + counts.n_not_unique + counts.n_squeezes
}

/// The transitions at obstacles of a report; `None` for a scene without obstacles.
pub fn contact_table(run: &Run) -> Option<Table> {
    let world = &run.scenario.system.world;
    if world.is_empty() {
        return None;
    }
    let (kept, n_all) = (&run.outcome.contact_transitions, n_transitions(run));
    let caption = match kept.len() as u64 {
        0 => "The load touched no obstacle".to_owned(),
        n if n < n_all => format!("What the load did at obstacles: the first {n} of {n_all} transitions"),
        _ => "What the load did at obstacles".to_owned(),
    };
    let table = Table::new(caption, ["time", "the load"]);
    Some(kept.iter().fold(table, |table, it| table.row([quantity(it.time, "s"), in_words(&it.kind, world)])))
}
