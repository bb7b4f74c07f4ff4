//! Code verification: questions whose answers are known from theory, put to every backend that can
//! answer them.
//!
//! A [`Case`] is one question: a scene, what is measured in it, and the known answer with its
//! source. Its [`Plan`]s say which methods it is put to, at which steps, how the error should fall
//! with the step, and within which bounds. A [`Row`] is what came out at one step, and whether it
//! holds.
//!
//! Errors fall with the step as the method promises, or the case misses: a wrong answer, a wrong
//! order and a floor under the error are all visible. First-order methods are extrapolated over
//! their halved steps as well, which meets the known answers to nine digits and more.
//!
//! ```text
//! case.rs        a question, its plans and bounds
//! measured.rs    what was found beside what is known
//! row.rs         runs of a plan -> rows that hold or miss
//! suite.rs       all plans as tasks
//! scenes.rs      loads, springs and tips that cases share
//! slide.rs ...   the cases, one file a family
//! ```

mod case;
pub mod contact;
pub mod figure;
pub mod limit_surface;
pub mod mass;
pub mod max_min;
mod measured;
pub mod peers;
pub mod pull;
pub mod reference;
pub mod release;
pub mod report;
mod row;
pub mod scenes;
pub mod slide;
mod suite;
pub mod symmetry;
pub mod towing;
pub mod tripod;

use crate::methods::Method;

pub use crate::runner::Effort;
pub use case::{Bound, Case, Expected, Family, Levels, Plan, Run, put_to};
pub use measured::{Errors, Measured, Unit, Value, extrapolated};
pub use row::{Outcome, Row, RowKind};
pub use suite::tasks;

/// All cases, in the order of their families. Where a pose is the answer, an exact backend under
/// error control is asked for it as well.
pub fn all() -> Vec<Case> {
    let families = [
        slide::cases,
        tripod::cases,
        pull::cases,
        release::cases,
        limit_surface::cases,
        max_min::cases,
        towing::cases,
        contact::cases,
        symmetry::cases,
        mass::cases,
        reference::cases,
        peers::cases,
    ];
    let mut cases: Vec<Case> = families.iter().flat_map(|cases| cases()).collect();
    cases.iter_mut().for_each(add_controlled);
    cases
}

/// Plans under error control beside those of the same backends at steps. A tolerance is one of
/// poses: cases that measure lengths of decay, powers, amplitudes and rests are left out.
fn add_controlled(case: &mut Case) {
    let load = match case.family {
        Family::Slide | Family::Tripod | Family::Pull | Family::Release | Family::Reference => scenes::paper_system(Vec::new()).load,
        Family::Peers => scenes::peers_system(Vec::new()).load,
        Family::LimitSurface | Family::MaxMin | Family::Towing | Family::Contact | Family::Symmetry | Family::Mass => return,
    };
    if case.name.ends_with("-stays") || ["peers-ripple", "peers-creep"].contains(&case.name.as_str()) {
        return;
    }
    for (at_steps, controlled) in
        [(Method::QUASI_STATIC, Method::QUASI_STATIC_CONTROLLED), (Method::INERTIAL_EULER, Method::INERTIAL_CONTROLLED)]
    {
        if let Some(plan) = case.plans.iter().find(|plan| plan.method == at_steps) {
            let plan = Plan::controlled(controlled, &load, &plan.bound.errors);
            case.plans.push(plan);
        }
    }
}
