//! Floor 2: what moves the load. One question to all, one kind of answer from all.
//!
//! A backend owns the load, its springs and the friction under it. It is told which springs are held and where their tips go, and knows
//! neither ants nor scenario files. Between two calls of [`Backend::advance`] nothing moves.

mod controlled;
mod forecast;
pub mod friction;
pub mod held;
pub mod increment;
pub mod inertial;
mod ledger;
mod options;
pub mod quasi_static;
pub mod rapier;
mod skips;
pub(crate) mod spring_blocks;
mod step_report;
mod stick_bound;
mod tandem;
mod transition;

use serde::{Deserialize, Serialize};

use crate::math::{Pose, Twist, Vec2};
use crate::model::System;
use controlled::{Column, Control};
use options::CHECK_SHARE;
use tandem::Tandem;

pub use held::{HeldTip, HeldTips};
pub use inertial::Integrator;
pub use ledger::{DefectParts, EnergyLedger};
pub use options::{BackendKind, BackendOptions, ConeSolver, Tolerance};
pub use rapier::RapierOptions;
pub use skips::{Skip, SkipCounts, Skips};
pub use step_report::{Status, StepReport};
pub use transition::{Transition, TransitionCounts, TransitionKind};

/// Where the load is and how it moves, in world axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    pub pose: Pose,
    pub twist: Twist,
}

impl Motion {
    /// x, y, heading and their rates (m, m, rad, m/s, m/s, rad/s).
    fn entries(&self) -> [f64; 6] {
        let Motion { pose, twist } = self;
        [pose.position.x, pose.position.y, pose.heading, twist.linear.x, twist.linear.y, twist.angular]
    }

    /// Of the first six of `entries`.
    fn of_entries(entries: &[f64]) -> Self {
        let twist = Twist { linear: Vec2::new(entries[3], entries[4]), angular: entries[5] };
        Motion { pose: Pose::new(entries[0], entries[1], entries[2]), twist }
    }
}

/// What moves the load.
///
/// Stepped by hand, a tip is drawn 40 mm along the spring: the load follows as soon as the spring pulls with its slip limit f, and stays f / k behind.
///
/// ```
/// use cohaul::backend::{BackendKind, BackendOptions, Status, build};
/// use cohaul::math::Vec2;
/// use cohaul::scenario::Scenario;
///
/// let scenario = Scenario::read("scenarios/analytic/centre-pull.json".as_ref())?;
/// let system = &scenario.system;
/// let mut load = build(system, scenario.start, &BackendOptions::new(BackendKind::QuasiStatic, 1e-3));
/// load.grasp(0, Vec2::new(0.0, 0.0));
/// for tick in 1..=400 {
///     let report = load.advance(&[Vec2::new(1e-4 * f64::from(tick), 0.0)], 1e-3);
///     assert_eq!(report.status, Status::Converged);
/// }
/// let behind = system.total_slip_limit() / system.springs[0].radial_stiffness;
/// assert!((load.motion().pose.position.x - (0.04 - behind)).abs() < 1e-12);
/// // The holder feels what friction takes.
/// assert!((load.force_on_tip(0).norm() - system.total_slip_limit()).abs() < 1e-12);
/// # Ok::<(), cohaul::scenario::ScenarioError>(())
/// ```
///
/// A spring is named by its index in [`System::springs`]. Grasping a held spring or releasing a free one is a broken promise of the caller and
/// panics.
pub trait Backend {
    /// Puts the tip of a free spring at `tip` (m, world) and holds it there.
    fn grasp(&mut self, spring: usize, tip: Vec2);

    /// Lets go of a held spring: it relaxes to its rest shape at once and pulls no more.
    fn release(&mut self, spring: usize);

    /// Moves the tips of all held springs in straight lines, at constant speed, to `tip_targets` (m, world, one entry a spring; those of
    /// free springs are not read) within `duration` (s), and the load with them.
    ///
    /// Targets, not velocities: the path of the tips then has no rounding that depends on how time was cut. Tips that are or go nowhere (not finite, or beyond
    /// 1e60 m) and a time that does not pass are answered by [`Status::Failed`], and nothing moves; after such tips rapier stays where it is for good.
    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport;

    /// Pose and twist of the load now. The twist of a method without inertia is the last displacement over its time.
    fn motion(&self) -> Motion;

    /// Tip of a held spring (m, world); `None` for a free one.
    fn tip(&self, spring: usize) -> Option<Vec2>;

    /// Force of the spring on its tip (N, world), Eq. (10), its dashpot's included; zero for a free spring. The ant pulls with its opposite.
    fn force_on_tip(&self, spring: usize) -> Vec2;

    /// Puts place and pull now into `tips`: all that are held, in the order of their springs.
    fn look_at(&self, tips: &mut [HeldTip]) {
        for tip in tips {
            tip.position = self.tip(tip.spring).unwrap_or(tip.position);
            tip.pull = -self.force_on_tip(tip.spring);
        }
    }

    /// Friction force of the ground on each support (N, world), averaged over the last step.
    fn friction_forces(&self) -> Vec<Vec2>;

    fn energy(&self) -> EnergyLedger;

    /// Where in the last advance the load's motion was not smooth, in the order of time; empty for a backend that cannot tell.
    fn transitions(&self) -> &[Transition] {
        &[]
    }

    /// How far the pose may be wrong now; `None` for a backend that does not know.
    fn pose_error(&self) -> Option<PoseError> {
        None
    }

    /// The whole state. A backend of the same system and options that restores it goes on bit for bit as this one would.
    fn save(&self) -> SavedState;

    /// # Errors
    /// When the state is not one that a backend of this kind saved, or does not fit the springs and supports of this system. That the system is the same otherwise
    /// is the caller's promise.
    fn restore(&mut self, state: &SavedState) -> Result<(), RestoreError>;
}

/// How far a pose may be wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoseError {
    /// (m)
    pub position: f64,
    /// (rad)
    pub heading: f64,
}

impl PoseError {
    /// Entry by entry the larger one.
    pub fn max(&self, other: &Self) -> Self {
        Self { position: self.position.max(other.position), heading: self.heading.max(other.heading) }
    }
}

/// A backend's state as a JSON value: floats are written with all their digits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SavedState(pub serde_json::Value);

impl SavedState {
    /// A number that is not finite becomes `null`, from which nothing can be restored.
    ///
    /// # Panics
    /// When `state` is nothing that JSON can hold.
    pub fn of<T: Serialize>(state: &T) -> Self {
        SavedState(serde_json::to_value(state).expect("a backend's state is plain data"))
    }

    /// # Errors
    /// When the value has another shape than `T`.
    pub fn read<T: for<'de> Deserialize<'de>>(&self) -> Result<T, RestoreError> {
        T::deserialize(&self.0).map_err(|error| RestoreError(error.to_string()))
    }
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("saved state does not fit this run: {0}")]
pub struct RestoreError(pub String);

/// Shortest step (s) that is taken unasked: a scene may be too stiff to resolve in reasonable time, and all methods are stable beyond.
const SHORTEST_UNASKED: f64 = 1e-5;

/// Longest step (s) of quasi-static that is taken unasked, the paper's control period: over longer ones, tips go so far that a load's jumps are not seen as such.
const LONGEST_UNASKED: f64 = 2.5e-3;

/// The step (s) for who asks for none: the control period, but no more than 2.5 ms, and with inertia no more than a tenth of a radian of the fastest oscillation (its
/// numerical damping ratio is then 0.05 at most) and a millisecond, but no less than 10 us.
pub fn default_step(kind: BackendKind, system: &System, control_period: f64) -> f64 {
    match kind {
        BackendKind::QuasiStatic => control_period.min(LONGEST_UNASKED),
        BackendKind::Inertial | BackendKind::Rapier => (0.1 / system.fastest_rate()).clamp(SHORTEST_UNASKED, 1e-3).min(control_period),
    }
}

/// The step (s) that is asked for, which ends with the control period, or that for who asks for none.
pub fn step_of(asked: Option<f64>, kind: BackendKind, system: &System, control_period: f64) -> f64 {
    asked.map_or_else(|| default_step(kind, system, control_period), |step| step.min(control_period))
}

/// The one place that joins kinds and code.
///
/// # Panics
/// When the step or the tolerance is not positive, or a tolerance is asked of rapier: an engine has no error control.
pub fn build(system: &System, start: Motion, options: &BackendOptions) -> Box<dyn Backend> {
    assert!(options.step_s > 0.0, "steps must be positive, found {} s", options.step_s);
    if let Some(tolerance) = &options.tolerance {
        let Tolerance { position_m, heading_rad, .. } = tolerance;
        assert!(*position_m > 0.0 && *heading_rad > 0.0, "tolerances must be positive, found {position_m} m and {heading_rad} rad");
        let controlled = |control| controlled(system, start, options, control);
        let answer = tolerance.control(system, settling_time(options.kind, system));
        let check = Control {
            position: CHECK_SHARE * answer.position,
            heading: CHECK_SHARE * answer.heading,
            energy: CHECK_SHARE * answer.energy,
            keeps: Column::LastButOne,
            ..answer
        };
        return Box::new(Tandem { answer: controlled(answer), check: controlled(check) });
    }
    match options.kind {
        BackendKind::QuasiStatic => {
            let backend = quasi_static::QuasiStatic::new(system.clone(), start, Stepping::Fixed(options.step_s), options.skips);
            let backend = backend.through(options.cone_solver);
            Box::new(if options.second_order { backend.of_second_order() } else { backend })
        }
        BackendKind::Inertial => {
            let stepping = Stepping::Fixed(options.step_s);
            Box::new(inertial::Inertial::new(system.clone(), start, stepping, options.integrator, options.skips))
        }
        BackendKind::Rapier => rapier::build(system.clone(), start, options),
    }
}

fn controlled(system: &System, start: Motion, options: &BackendOptions, control: Control) -> Box<dyn Backend> {
    let (system, stepping) = (system.clone(), Stepping::Controlled(control));
    match options.kind {
        BackendKind::QuasiStatic => Box::new(quasi_static::QuasiStatic::new(system, start, stepping, options.skips)),
        BackendKind::Inertial => Box::new(inertial::Inertial::new(system, start, stepping, Integrator::Euler, options.skips)),
        BackendKind::Rapier => panic!("rapier has no error control"),
    }
}

/// How an exact backend cuts an advance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stepping {
    /// Into the fewest equal steps of at most this length (s).
    Fixed(f64),
    Controlled(Control),
}

/// Time over which a wrong speed makes the position wrong (s): that of an oscillation by a radian, or that in which friction takes the speed with which the
/// load crosses its radius, whichever is shorter. Without springs and friction there is neither, and speeds stay right.
fn settling_time(kind: BackendKind, system: &System) -> Option<f64> {
    if kind == BackendKind::QuasiStatic {
        return None;
    }
    let load = &system.load;
    let stiffness =
        system.springs.iter().map(|spring| spring.radial_stiffness).filter(|stiffness| *stiffness > 0.0).fold(f64::INFINITY, f64::min);
    let swing = (load.mass / stiffness).sqrt();
    let braking = (load.mass * load.radius / system.total_slip_limit()).sqrt();
    Some([swing, braking].into_iter().filter(|time| time.is_finite() && *time > 0.0).fold(f64::INFINITY, f64::min).min(1e9))
}

/// The fewest equal steps of at most `longest` (s) that make up `duration` (s): their number. A share of 1e-9 of a step is forgiven, so that
/// a period that is a multiple of the step up to rounding is cut into just that many.
pub fn n_steps_in(duration: f64, longest: f64) -> u64 {
    const FORGIVEN: f64 = 1e-9;
    if duration <= (1.0 + FORGIVEN) * longest {
        return 1;
    }
    (duration / longest - FORGIVEN).ceil().max(1.0) as u64
}
