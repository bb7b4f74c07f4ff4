//! What moves the load. Every backend answers the same calls in the same way.
//!
//! A backend owns the load, its springs and the friction under it. Its caller says which springs
//! are attached and where their tips go. It has no ants and reads no scenario files. Nothing moves
//! between two calls of [`Backend::advance`].
//!
//! A backend that observes another one, or adds to what it does, is a [`Wrapped`] with a [`Hook`].

pub mod contact;
mod default_step;
mod exact;
pub mod friction;
pub mod increment;
mod interface;
mod numerics;
mod options;
pub mod rapier;
mod report;
mod shared;
mod shortcuts;
pub mod springs;
mod steered;
mod stepping;
mod tandem;
mod tolerance;
mod unmoved;
mod wrapped;

pub use default_step::{default_step, step_of};
pub use exact::Integrator;
pub use friction::ConeSolver;
pub use interface::{Backend, Computes};
pub use numerics::{CLARABEL_ACCURACY, CLOSED_LEDGER, LONGEST_MACRO_STEP, WORK_PER_SECOND};
pub use options::{BackendKind, BackendOptions, Setting};
pub use rapier::RapierOptions;
pub use report::{
    Balance, DefectParts, Doubts, EnergyLedger, ImpactLaw, Motion, PoseError, RestoreError, SaveError, SavedState, SideContact, Skip,
    SkipCounts, Skips, Status, StepReport, Transition, TransitionCounts, TransitionKind, closed_share, judge_exact,
};
pub use shared::Shared;
pub use springs::{AttachedTip, AttachedTips};
pub use stepping::{Stepping, n_steps_in};
pub use tolerance::Tolerance;
pub use unmoved::Unmoved;
pub use wrapped::{Hook, Wrapped};

use crate::model::System;
use default_step::settling_time;
use exact::{Column, Control, Exact};
use numerics::CHECK_SHARE;
use tandem::tandem;

/// Backend that the options ask for.
///
/// # Panics
/// When the step or the tolerance is not positive, or when a backend without error control is given
/// a tolerance.
pub fn build(system: &System, start: Motion, options: &BackendOptions) -> Box<dyn Backend> {
    assert!(options.step_s > 0.0, "steps must be positive, found {} s", options.step_s);
    let Some(tolerance) = &options.tolerance else { return with_stepping(system, start, options, Stepping::Fixed(options.step_s)) };
    let Tolerance { position_m, heading_rad, .. } = tolerance;
    assert!(*position_m > 0.0 && *heading_rad > 0.0, "tolerances must be positive, found {position_m} m and {heading_rad} rad");
    assert!(options.kind.is_exact(), "{} has no error control", options.kind.name());
    let controlled = |control| with_stepping(system, start, options, Stepping::Controlled(control));
    let answer = tolerance.control(system, settling_time(options.kind, system));
    let check = Control {
        position: CHECK_SHARE * answer.position,
        heading: CHECK_SHARE * answer.heading,
        energy: CHECK_SHARE * answer.energy,
        keeps: Column::LastButOne,
        ..answer
    };
    Box::new(tandem(controlled(answer), controlled(check), tolerance, system))
}

/// Backend with this stepping: the only place that maps kinds to code. Options of fixed steps are
/// ignored under error control.
fn with_stepping(system: &System, start: Motion, options: &BackendOptions, stepping: Stepping) -> Box<dyn Backend> {
    let is_fixed = matches!(stepping, Stepping::Fixed(_));
    match options.kind {
        BackendKind::QuasiStatic => {
            let backend = Exact::quasi_static(system, start, stepping, options.skips);
            let backend = if options.rate_independent { backend.rate_independent() } else { backend };
            Box::new(if is_fixed { backend.with_options(options.cone_solver, options.second_order) } else { backend })
        }
        BackendKind::Inertial => {
            let integrator = if is_fixed { options.integrator } else { Integrator::Euler };
            Box::new(Exact::inertial(system, start, stepping, integrator, options.skips).adapting(options.adapts_step))
        }
        BackendKind::Rapier => rapier::build(system.clone(), start, options),
    }
}
