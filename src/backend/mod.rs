//! Floor 2: what moves the load. One question to all, one kind of answer from all.
//!
//! A backend owns the load, its springs and the friction under it. It is told which springs are held and where their tips go, and knows
//! neither ants nor scenario files. Between two calls of [`Backend::advance`] nothing moves.

mod controlled;
pub mod friction;
pub mod held;
pub mod increment;
pub mod inertial;
pub mod quasi_static;
pub mod rapier;
mod skips;
mod spring_blocks;
mod stick_bound;
mod tandem;
mod transition;

use serde::{Deserialize, Serialize};

use crate::math::{Pose, Twist, Vec2};
use crate::model::{Load, System};
use controlled::{Column, Control};
use tandem::Tandem;

pub use inertial::Integrator;
pub use rapier::RapierOptions;
pub use skips::{Skip, SkipCounts, Skips};
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
    /// Targets, not velocities: the path of the tips then has no rounding that depends on how time was cut.
    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport;

    /// Pose and twist of the load now. The twist of a method without inertia is the last displacement over its time.
    fn motion(&self) -> Motion;

    /// Tip of a held spring (m, world); `None` for a free one.
    fn tip(&self, spring: usize) -> Option<Vec2>;

    /// Force of the spring on its tip (N, world), Eq. (10), its dashpot's included; zero for a free spring. The ant pulls with its opposite.
    fn force_on_tip(&self, spring: usize) -> Vec2;

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
    /// When the state is not one that a backend of this kind and system saved.
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
    /// # Panics
    /// When `state` holds a number that JSON cannot.
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

/// Where the energy of a run is and where it went (J).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyLedger {
    /// In the held springs now.
    pub elastic: f64,
    /// In the moving load now; zero for a method without inertia.
    pub kinetic: f64,
    /// Lost to the ground by friction so far.
    pub friction: f64,
    /// Lost in the springs' dashpots so far.
    pub damping: f64,
    /// Lost with springs that were let go so far: a free spring relaxes by itself.
    pub released: f64,
    /// Done by the tips' holders so far, grasps of deformed springs included.
    pub tip_work: f64,
    /// At the start, kinetic.
    pub initial: f64,
    /// Lost in jumps of a load without inertia so far; one with inertia would have got it into motion.
    pub jumps: f64,
    /// Lost by the moving load so far to nobody but the way in which steps are cut: what the springs did on it less what friction took and what it has
    /// kept in motion.
    pub numerical_damping: f64,
}

/// Where a ledger's defect comes from (J). The parts add up to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DefectParts {
    /// Minus what was lost in jumps.
    pub jumps: f64,
    /// Minus what steps took from the moving load.
    pub numerical_damping: f64,
    /// What remains: error of the trapezoid sums of work.
    pub quadrature: f64,
}

impl EnergyLedger {
    /// Books a grasp whose spring brings `brought` (J): its holder deformed it.
    pub fn book_grasp(&mut self, brought: f64) {
        self.tip_work += brought;
        self.elastic += brought;
    }

    /// Books a release whose spring takes `lost` (J) and leaves `elastic` (J) in the others.
    pub fn book_release(&mut self, lost: f64, elastic: f64) {
        self.released += lost;
        self.elastic = elastic;
    }

    /// All that was lost on purpose: friction, damping and released springs (J).
    pub fn dissipated(&self) -> f64 {
        self.friction + self.damping + self.released
    }

    /// Energy that appeared from nowhere (J): negative is numerical damping, or a jump of a method without inertia.
    pub fn defect(&self) -> f64 {
        self.elastic + self.kinetic + self.dissipated() - self.tip_work - self.initial
    }

    /// The defect by its causes.
    ///
    /// With W the trapezoid work of the springs on the load in a step, D what friction and dashpots took there, K the kinetic and U the elastic energy,
    ///
    /// ```text
    /// defect of a step = dU + dK + D - tip work = (dK + D - W) + (dU + W - tip work)
    /// ```
    ///
    /// The first bracket is the load's own balance: for implicit Euler minus 1/2 |dv|^2_M + 1/2 dx' K (dx - dp) to leading order, first order in the step. The
    /// second is that of the springs, whose energy depends on nothing but poses and tips, so that only the trapezoids are wrong there: second order.
    pub fn defect_parts(&self) -> DefectParts {
        let (jumps, numerical_damping) = (0.0 - self.jumps, 0.0 - self.numerical_damping);
        DefectParts { jumps, numerical_damping, quadrature: self.defect() - jumps - numerical_damping }
    }
}

/// How an advance ended. The order is that of severity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Every step met its tolerance.
    #[default]
    Converged,
    /// Some step ended above its tolerance; its best point was kept.
    NotConverged,
    /// Some step had no finite answer: the load stayed where it was.
    Failed,
}

/// What an advance cost and how well it ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepReport {
    pub status: Status,
    /// Largest residual of a step, relative to the forces in it (1).
    pub residual: f64,
    /// Steps of the backend's own; under error control strides.
    pub n_steps: u64,
    /// Solutions of the friction problem.
    pub n_solves: u64,
    /// Newton iterations over all of them.
    pub n_iterations: u64,
    /// Steps that were known without solving.
    pub n_skipped: u64,
    /// Steps that did not converge.
    pub n_not_converged: u64,
    /// Strides that error control found too long.
    pub n_rejected: u64,
    /// What was left out, by kind.
    #[serde(default)]
    pub skipped: SkipCounts,
}

impl StepReport {
    pub fn add(&mut self, other: &StepReport) {
        self.status = self.status.max(other.status);
        self.residual = self.residual.max(other.residual);
        self.n_steps += other.n_steps;
        self.n_solves += other.n_solves;
        self.n_iterations += other.n_iterations;
        self.n_skipped += other.n_skipped;
        self.n_not_converged += other.n_not_converged;
        self.n_rejected += other.n_rejected;
        self.skipped.add(&other.skipped);
    }
}

/// The ways to move a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum BackendKind {
    /// The paper's max-min step: no inertia.
    QuasiStatic,
    /// The same step with the mass matrix: the reference dynamics.
    Inertial,
    /// The rigid-body engine rapier2d.
    Rapier,
}

impl BackendKind {
    pub const ALL: [BackendKind; 3] = [BackendKind::QuasiStatic, BackendKind::Inertial, BackendKind::Rapier];

    pub fn name(self) -> &'static str {
        match self {
            BackendKind::QuasiStatic => "quasi-static",
            BackendKind::Inertial => "inertial",
            BackendKind::Rapier => "rapier",
        }
    }
}

/// How to move the load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BackendOptions {
    pub kind: BackendKind,
    /// Longest step (s): a duration is cut into the fewest equal steps that do not exceed it. Infinite under error control.
    #[serde(default = "unlimited", skip_serializing_if = "is_unlimited")]
    pub step_s: f64,
    /// Error control in place of the step, for the exact backends.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<Tolerance>,
    /// Of the inertial backend at a fixed step.
    pub integrator: Integrator,
    pub rapier: RapierOptions,
    /// What may be left out.
    #[serde(default, skip_serializing_if = "is_default")]
    pub skips: Skips,
    /// Of the quasi-static backend at a fixed step.
    #[serde(default, skip_serializing_if = "is_default")]
    pub cone_solver: ConeSolver,
}

/// What solves the friction problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ConeSolver {
    /// The exact one of [`friction`].
    #[default]
    Exact,
    /// An interior-point solver, for comparison: see [`quasi_static::conic`].
    Clarabel,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn unlimited() -> f64 {
    f64::INFINITY
}

fn is_unlimited(step: &f64) -> bool {
    step.is_infinite()
}

impl BackendOptions {
    /// The usual settings at this longest step (s).
    pub fn new(kind: BackendKind, step_s: f64) -> Self {
        Self {
            kind,
            step_s,
            tolerance: None,
            integrator: Integrator::default(),
            rapier: RapierOptions::default(),
            skips: Skips::ALL,
            cone_solver: ConeSolver::Exact,
        }
    }

    /// An exact backend under error control.
    pub fn within(kind: BackendKind, tolerance: Tolerance) -> Self {
        Self { tolerance: Some(tolerance), ..Self::new(kind, f64::INFINITY) }
    }
}

/// Error that the pose of a run may have at any instant, given its grasps, releases and tip motions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    pub position_m: f64,
    pub heading_rad: f64,
    /// How often the errors of strides, which add up to that of the run, have been divided by ten because they added up to too much.
    #[serde(default)]
    pub tightened: u32,
}

/// Error of a stride over that of the run (1). The former add up, but friction and springs bring a load back to its path, so that it is not for long.
const STRIDE_SHARE: f64 = 1e-4;
/// Largest error of a stride over the load's radius (1): beyond, an error is no longer small against what it is estimated from.
const LARGEST_STRIDE_ERROR: f64 = 1e-3;
/// Smallest error of a stride over the load's radius (1): below, roundings of places decide.
const SMALLEST_STRIDE_ERROR: f64 = 1e-13;
/// How often a run is repeated with smaller errors of strides.
const MOST_TIGHTENED: u32 = 3;
/// Tolerance of the run that checks another one, over that one's (1).
const CHECK_SHARE: f64 = 4.0;

impl Tolerance {
    /// Of a load whose rim may be off by `position_m` (m) through a shift, and by as much through a turn.
    pub fn on_rim(position_m: f64, load: &Load) -> Self {
        Self { position_m, heading_rad: position_m / load.radius, tightened: 0 }
    }

    /// The same, for a run whose strides err a tenth as much; `None` when that would not help any more.
    pub fn tightened(&self) -> Option<Self> {
        (self.tightened < MOST_TIGHTENED).then_some(Self { tightened: self.tightened + 1, ..*self })
    }

    /// Whether an error keeps to it.
    pub fn allows(&self, error: &PoseError) -> bool {
        error.position <= self.position_m && error.heading <= self.heading_rad
    }

    fn control(&self, system: &System, settling_time: Option<f64>) -> Control {
        let load = &system.load;
        // What friction or a spring stretched by the load's radius has: energies err by that times the error of the position.
        let stiffness = system.springs.iter().map(|spring| spring.radial_stiffness).fold(0.0, f64::max);
        let force = system.total_slip_limit() + stiffness * load.radius;
        let share = STRIDE_SHARE * 0.1f64.powi(self.tightened as i32);
        let of_stride = |error: f64, size: f64| (share * error).clamp(SMALLEST_STRIDE_ERROR * size, LARGEST_STRIDE_ERROR * size);
        Control {
            position: of_stride(self.position_m, load.radius),
            heading: of_stride(self.heading_rad, 1.0),
            energy: of_stride(self.position_m, load.radius) * force,
            settling_time,
            keeps: Column::Last,
        }
    }
}

/// Shortest step (s) that is taken unasked: a scene may be too stiff to resolve in reasonable time, and all methods are stable beyond.
const SHORTEST_UNASKED: f64 = 1e-5;

/// The step (s) for who asks for none: the control period, and with inertia no more than a tenth of a radian of the fastest oscillation (its
/// numerical damping ratio is then 0.05 at most) and a millisecond, but no less than 10 us.
pub fn default_step(kind: BackendKind, system: &System, control_period: f64) -> f64 {
    match kind {
        BackendKind::QuasiStatic => control_period,
        BackendKind::Inertial | BackendKind::Rapier => (0.1 / system.fastest_rate()).clamp(SHORTEST_UNASKED, 1e-3).min(control_period),
    }
}

/// The one place that joins kinds and code.
///
/// # Panics
/// When a tolerance is asked of rapier: an engine has no error control.
pub fn build(system: &System, start: Motion, options: &BackendOptions) -> Box<dyn Backend> {
    if let Some(tolerance) = &options.tolerance {
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
            Box::new(backend.through(options.cone_solver))
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
    (duration / longest - 1e-9).ceil().max(1.0) as u64
}
