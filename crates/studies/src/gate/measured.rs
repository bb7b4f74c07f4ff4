//! The errors of an engine on scenes.

use std::sync::Mutex;

use super::record::{Error, Quantity, Record, SceneRecord};
use crate::subject::{Ended, Fresh, Meet};
use cohaul::analysis::compare::{EngineName, Pathwise, Settings, ThreeWay, Verdict};
use cohaul::backend::{Backend, BackendKind, BackendOptions, Unmoved};
use cohaul::scenario::{Drive, Scenario};
use cohaul_report::json;
use cohaul_report::manifest::build_of_program;

/// Tolerance of the exact runs over the load's radius (1). It makes the reference error small
/// beside engine errors of some micrometres and more, so that changes of a percent are seen.
const REFERENCE: f64 = 1e-6;

/// Settings of the comparisons: at a step (s), or at the default of each scene.
pub fn settings(scenario: &Scenario, step_s: Option<f64>) -> Settings {
    let reference_tolerance_m = Some(REFERENCE * scenario.system.load.radius);
    Settings { step_s, reference_tolerance_m, check_suggestions: false, ..Settings::default() }
}

/// Errors on all scenes; `None` when `watch` ended the work, which receives the share done (1).
pub fn record(
    engine: &EngineName,
    meet: &Meet,
    scenes: &[(String, Scenario)],
    step_s: Option<f64>,
    watch: &(dyn Fn(f64) -> bool + Sync),
) -> Option<Record> {
    let n = scenes.len() as f64;
    let of = |(at, (name, scenario)): (usize, &(String, Scenario))| {
        on_scene(engine, meet, (name, scenario), step_s, &|share| watch((at as f64 + share) / n))
    };
    let scenes = scenes.iter().enumerate().map(of).collect::<Option<Vec<_>>>()?;
    let (version, commit) = build_of_program();
    let cohaul = commit.map_or(version.to_owned(), |commit| format!("{version} ({commit})"));
    Some(Record { engine: engine.clone(), cohaul, step_s, scenes })
}

fn on_scene(
    engine: &EngineName,
    meet: &Meet,
    (name, scenario): (&str, &Scenario),
    step_s: Option<f64>,
    watch: &(dyn Fn(f64) -> bool + Sync),
) -> Option<SceneRecord> {
    let settings = settings(scenario, step_s);
    let first = Mutex::new(None);
    let complaints = Mutex::new(Vec::new());
    let make = |scenario: &Scenario, options: &BackendOptions| -> Box<dyn Backend> {
        match meet(scenario, options) {
            Ok(Fresh { backend, complaint }) => {
                complaints.lock().expect("nothing panics here").push(complaint);
                backend
            }
            Err(ended) => {
                first.lock().expect("nothing panics here").get_or_insert(ended);
                Box::new(Unmoved(scenario.start))
            }
        }
    };
    // An engine that does not take the scene is not compared on it.
    let met = meet(scenario, &settings.at_fixed_step(scenario, BackendKind::Rapier)).map(drop);
    let runs = ThreeWay::new(scenario, &settings).engine(&make).named(engine);
    let compared = match (met, &scenario.drive) {
        (Err(ended), _) => Err(ended),
        (Ok(()), Drive::Tips(_)) => Ok(runs.prescribed(watch)?),
        (Ok(()), Drive::Ants(_)) => Ok(runs.replayed(watch)?),
    };
    let complaint = complaints.into_inner().expect("nothing panics here").iter().find_map(|complaint| complaint());
    let ended = first.into_inner().expect("nothing panics here").or(complaint.map(Ended::Failed));
    let found = match (compared, ended) {
        (Ok(found), None) if found.verdict == Verdict::NotComputed => Err(Ended::Failed(not_computed(&found))),
        (Ok(found), None) => Ok(found),
        (Ok(_), Some(ended)) | (Err(ended), _) => Err(ended),
    };
    let (quantities, refused, failed) = match found {
        Ok(found) => (quantities(&found), None, None),
        Err(Ended::Refused(why)) => (Vec::new(), Some(why), None),
        Err(Ended::Failed(why)) => (Vec::new(), None, Some(why)),
        Err(Ended::Stopped) => return None,
    };
    Some(SceneRecord { name: name.to_owned(), scenario: json::plain(&scenario.expanded()), refused, failed, quantities })
}

fn not_computed(found: &Pathwise) -> String {
    let failed = found.solutions.iter().find(|solution| solution.account.health == cohaul::simulation::Health::Failed);
    let cause = failed.and_then(|solution| cohaul_report::account_words::cause(&solution.account));
    cause.map_or_else(|| "the comparison was not computed".to_owned(), |cause| cause.to_string())
}

fn quantities(found: &Pathwise) -> Vec<Quantity> {
    let of = |(name, verdict): (&'static str, &cohaul::analysis::compare::QuantityVerdict)| {
        let whole = || Error {
            name: format!("largest difference of the {name}"),
            engine_error: verdict.engine_error,
            reference_error: verdict.reference_error,
            tolerance: verdict.tolerance,
        };
        let errors = verdict.measures.iter().map(|measure| Error {
            name: measure.label(),
            engine_error: measure.engine_error.abs(),
            reference_error: measure.reference_error,
            tolerance: measure.tolerance,
        });
        let errors: Vec<Error> = if verdict.measures.is_empty() { vec![whole()] } else { errors.collect() };
        Quantity { quantity: name.to_owned(), unit: verdict.unit.to_owned(), errors }
    };
    found.verdicts.shown().map(of).collect()
}
