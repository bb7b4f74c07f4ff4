//! The contract that everything which moves a load keeps.

use super::report::{EnergyLedger, Motion, PoseError, RestoreError, SaveError, SavedState, SideContact, StepReport, Transition};
use super::springs::AttachedTip;
use crate::math::{Pose, Vec2};
use crate::model::ObstaclePose;

/// What a backend computes beside the pose of the load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Computes {
    pub twist: bool,
    pub energy: bool,
    /// Forces of obstacles.
    pub contacts: bool,
}

impl Computes {
    pub const ALL: Self = Self { twist: true, energy: true, contacts: true };
}

/// A method that moves the load.
///
/// A spring is named by its index in [`crate::model::System::springs`]. Attaching an attached
/// spring or releasing a free one is an error of the caller and panics.
///
/// In this example a tip is drawn 40 mm along the spring. The load follows as soon as the spring
/// pulls with the slip limit f, and stays f / k behind the tip.
///
/// ```
/// use cohaul::backend::{BackendKind, BackendOptions, Status, build};
/// use cohaul::math::Vec2;
/// use cohaul::scenario::Scenario;
///
/// let scenario = Scenario::read("scenarios/analytic/centre-pull.json".as_ref())?;
/// let system = &scenario.system;
/// let mut load = build(system, scenario.start, &BackendOptions::new(BackendKind::QuasiStatic, 1e-3));
/// load.attach(0, Vec2::new(0.0, 0.0));
/// for tick in 1..=400 {
///     let report = load.advance(&[Vec2::new(1e-4 * f64::from(tick), 0.0)], 1e-3);
///     assert_eq!(report.status, Status::Converged);
/// }
/// let behind = system.total_slip_limit() / system.springs[0].radial_stiffness;
/// assert!((load.motion().pose.position.x - (0.04 - behind)).abs() < 1e-12);
/// // The pull is as large as the resistance of friction.
/// assert!((load.pull(0).norm() - system.total_slip_limit()).abs() < 1e-12);
/// # Ok::<(), cohaul::scenario::ScenarioError>(())
/// ```
pub trait Backend: Send {
    /// Attaches the tip of a free spring at `tip` (m, world), to an ant, a robot or a guide.
    fn attach(&mut self, spring: usize, tip: Vec2);

    /// Releases an attached spring. It relaxes at once and pulls no more.
    fn release(&mut self, spring: usize);

    /// Moves the tips of all attached springs along straight lines, at constant speed, to
    /// `tip_targets` (m, world, one entry a spring; entries of free springs are not read) within
    /// `duration` (s), and moves the load with them.
    ///
    /// The tips are given as targets, not velocities: their path then has no rounding that depends
    /// on how time is divided. Tips or targets that are not finite or beyond 1e60 m, and a duration
    /// that is not positive, are answered by [`super::Status::Failed`], and nothing moves. After
    /// such tips rapier does not move again.
    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport;

    /// Sends an obstacle along a `course` from now on: times from now (s), increasing from 0, and
    /// poses (m, rad, world). It moves straight from pose to pose, first from where it is, and
    /// stands after the last one. A course that begins at the time 0 begins at its pose.
    ///
    /// Returns whether it did. It does not if there is no such obstacle, if the course is none or
    /// has numbers that are not finite, and by default: for a backend whose obstacles keep to the
    /// paths of the scenario.
    fn steer(&mut self, _obstacle: usize, _course: &[(f64, Pose)]) -> bool {
        false
    }

    /// Poses of the obstacles that were steered, in their order. All others are on the paths of the
    /// scenario.
    fn steered(&self) -> Vec<ObstaclePose> {
        Vec::new()
    }

    /// Pose and twist of the load. A method without inertia reports the last displacement over its
    /// time as the twist.
    fn motion(&self) -> Motion;

    /// Tip of an attached spring (m, world); `None` for a free spring.
    fn tip(&self, spring: usize) -> Option<Vec2>;

    /// Pull on the tip, the force of what it is attached to (N, world): dU/d(tip) and the dashpot's
    /// share, the negative of Eq. (10). It is zero for a free spring.
    fn pull(&self, spring: usize) -> Vec2;

    /// Energy of the run so far, by where it is and where it went (J).
    fn energy(&self) -> EnergyLedger;

    /// What this backend computes. A comparison has no numbers of what it does not.
    fn computes(&self) -> Computes {
        Computes::ALL
    }

    /// Friction force of the ground on each support (N, world), averaged over the last step; empty
    /// for a backend that does not compute it.
    fn friction_forces(&self) -> Vec<Vec2> {
        Vec::new()
    }

    /// Closed contacts with obstacles, with their forces in the last step; empty for a backend that
    /// does not compute them.
    fn side_contacts(&self) -> Vec<SideContact> {
        Vec::new()
    }

    /// Force of all contacts with an obstacle on the load in the last step (N, world).
    fn contact_force(&self, obstacle: usize) -> Vec2 {
        self.side_contacts().iter().filter(|contact| contact.obstacle == obstacle).map(|contact| contact.force).sum()
    }

    /// Writes position and pull into `tips`: all attached tips in the order of their springs.
    fn read_tips(&self, tips: &mut [AttachedTip]) {
        for tip in tips {
            tip.position = self.tip(tip.spring).unwrap_or(tip.position);
            tip.pull = self.pull(tip.spring);
        }
    }

    /// Instants of the last advance at which the motion of the load was not smooth, in the order of
    /// time; empty for a backend that cannot tell.
    fn transitions(&self) -> &[Transition] {
        &[]
    }

    /// Bound of the error of the pose so far; `None` for a backend that does not find one.
    fn pose_error(&self) -> Option<PoseError> {
        None
    }

    /// The less exact run beside this one, whose distance estimates the error of every quantity;
    /// `None` for a backend without one.
    fn companion(&self) -> Option<&dyn Backend> {
        None
    }

    /// Complete state, from which a backend of the same system and options continues bit for bit.
    ///
    /// # Errors
    /// When this backend cannot be saved, as by default.
    fn save(&self) -> Result<SavedState, SaveError> {
        Err(SaveError)
    }

    /// Continues from a saved state. The caller promises that the system is the same.
    ///
    /// # Errors
    /// When the state was not saved by a backend of this kind, or does not fit the springs and
    /// supports of this system; always by default.
    fn restore(&mut self, _state: &SavedState) -> Result<(), RestoreError> {
        Err(RestoreError("this backend cannot be restored".into()))
    }
}
