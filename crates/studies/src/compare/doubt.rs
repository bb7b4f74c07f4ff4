//! Doubts of the exact runs in words.

use cohaul::analysis::compare::{ClosedLoop, Doubt, DoubtKind, Pathwise};
use cohaul_report::quantity::of_run::short_quantity;

/// Why an exact run is doubtful and from when on, as a clause.
pub fn in_words(doubt: &Doubt) -> String {
    let time = short_quantity(doubt.time_s, "s");
    let run = doubt.backend.map_or("exact", |kind| kind.name());
    let name = doubt.obstacle.map_or("an obstacle".to_owned(), |obstacle| format!("obstacle {obstacle}"));
    match doubt.kind {
        DoubtKind::Overlap => format!("after {time} the {run} load lies inside {name}"),
        DoubtKind::GateCut => format!("after {time} a step of the {run} run had to be cut, since it ended inside {name}"),
        DoubtKind::NotUnique => format!("from {time} on the {run} motion is not unique: at {name} another one is admissible too"),
        DoubtKind::OpenLedger => format!("from {time} on the energy ledger of the {run} run does not close"),
        DoubtKind::NotConverged => format!("from {time} on some steps of the {run} run did not converge"),
        DoubtKind::SameStop => {
            format!(
                "from {time} on {name} holds both exact loads where the load of the engine passes, and they share the code for contacts"
            )
        }
    }
}

/// Why nothing more is claimed of paths; `None` without doubts.
pub fn of_paths(found: &Pathwise) -> Option<String> {
    found.doubts.first().map(in_words)
}

/// Why nothing is claimed of distributions; `None` without doubts.
pub fn of_ensemble(found: &ClosedLoop) -> Option<String> {
    let first = found.doubts.first()?;
    let n = found.doubts.len();
    let others = match n - 1 {
        0 => String::new(),
        1 => ", and 1 other seed is doubtful".to_owned(),
        n => format!(", and {n} other seeds are doubtful"),
    };
    Some(format!("with seed {}, {}{others}", first.seed, in_words(&first.doubt)))
}
