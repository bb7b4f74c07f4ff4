//! Trials of the suggested changes: quasi-static and inertial runs of the changed scene.

use super::difference::{Difference, Jumps};
use super::doubt;
use super::pathwise::{self, Pathwise};
use super::question::Question;
use super::settings::{Settings, Tier};
use super::suggestion::{SuggestedChange, Tried};
use super::verdict::Cause;
use crate::backend::{BackendKind, Status};
use crate::scenario::Scenario;
use crate::stop::Stop;

/// Parts of the tolerance that the changes of each trial aim at, over that of the first (1).
const AIMS: [f64; 3] = [1.0, 1.0 / 3.0, 1.0 / 9.0];
/// Longest duration of a trial over that of the scene (1).
pub const LONGEST: f64 = 50.0;

/// Compares paths, and tries the changes that are suggested against the inertia effect. Up to three
/// trials are made, each with stronger changes. A trial leaves rapier out.
pub(super) fn compare(question: &Question, watch: impl Fn(f64) -> bool + Sync) -> Option<Pathwise> {
    let Question { scenario, settings, .. } = *question;
    let mut found = pathwise::compare(question, &watch)?;
    if question.exact.is_some() || !settings.check_suggestions || !found.causes.contains(&Cause::Inertia) {
        return Some(found);
    }
    let mut best = f64::INFINITY;
    for aim in AIMS {
        let changes = found.suggestions(scenario, settings, aim);
        let Some(changed) = changed(question, &changes) else { break };
        let tried = tried_to_its_tolerance(&Question { scenario: &changed, ..*question }, &found, &watch)?;
        let share = tried.share();
        if share < best {
            (best, found.suggested_changes, found.tried) = (share, changes, Some(tried));
        }
        if tried.is_enough {
            break;
        }
    }
    Some(found)
}

/// The scene after all changes against inertia; `None` if one cannot be tried.
fn changed(question: &Question, changes: &[SuggestedChange]) -> Option<Scenario> {
    let mut changed = question.scenario.clone();
    // Recorded motions, and controllers of one's own, have their own speed.
    let can_slow = question.tier == Tier::Prescribed;
    let mut n_changes = 0;
    for change in changes.iter().filter(|change| change.is_of_scene()) {
        if change.slows_drive() && !can_slow {
            return None;
        }
        change.apply(&mut changed);
        n_changes += 1;
    }
    (n_changes > 0 && changed.duration <= LONGEST * question.scenario.duration).then_some(changed)
}

/// What is left of the inertia effect in a changed scene. The reference error is that of the
/// comparison first. A changed scene with a far shorter path has a far smaller tolerance, for which
/// a smaller one is asked.
fn tried_to_its_tolerance(question: &Question, before: &Pathwise, watch: &(impl Fn(f64) -> bool + Sync)) -> Option<Tried> {
    let given = question.settings.reference_tolerance_m;
    let to = |tolerance_m: f64| tried(question, given.unwrap_or(pathwise::needed_reference_error(tolerance_m)), watch);
    let found = to(before.tolerance_m)?;
    let is_open = !found.is_enough && found.share() <= 1.0 && given.is_none();
    if is_open { to(found.tolerance_m.min(before.tolerance_m)) } else { Some(found) }
}

/// What is left of the inertia effect in a changed scene, to this reference error (m).
fn tried(question: &Question, needed: f64, watch: &(impl Fn(f64) -> bool + Sync)) -> Option<Tried> {
    let Question { scenario: changed, .. } = *question;
    let settings = Settings { reference_tolerance_m: Some(needed), ..*question.settings };
    let stop = Stop::current();
    let options = |kind| settings.under_error_control(changed, kind);
    let find = |kind| stop.within(|| question.solution(&options(kind), question.references, |_| watch(1.0)));
    let (quasi_static, inertial) = rayon::join(|| find(BackendKind::QuasiStatic), || find(BackendKind::Inertial));
    let [mut quasi_static, mut inertial] = [quasi_static?, inertial?];
    let n = quasi_static.points.len().min(inertial.points.len());
    [&mut quasi_static, &mut inertial].into_iter().for_each(|solution| solution.shorten_to(n));
    let radius = changed.system.load.radius;
    let jumps = Jumps::of(&quasi_static.trace, changed.control_period);
    let effect = Difference::outside_jumps(&inertial.points, &quasi_static.points, radius, &jumps).edge_displacement_max_m;
    let error = [&quasi_static, &inertial].map(|solution| Difference::error_of(&solution.limit, radius).edge_displacement_max_m);
    let tolerance_m = settings.tolerance_path(quasi_static.path_length(radius).max(inertial.reach(radius)), radius);
    let has_failed = [&quasi_static, &inertial].iter().any(|solution| solution.steps.status == Status::Failed);
    let is_trusted = !has_failed && doubt::of_references(&[quasi_static, inertial], changed).is_empty();
    let is_enough = is_trusted && effect + error[0].max(error[1]) <= tolerance_m;
    Some(Tried { inertia_effect_m: effect, tolerance_m, is_enough })
}
