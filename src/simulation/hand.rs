//! A hand: an obstacle that is not placed but held by a spring, as a robot under impedance control
//! holds its finger.
//!
//! The hand has no mass. Over a step it moves straight along its axis, to where the spring's force
//! is the one that the load withstands:
//!
//! ```text
//! F(s) = clamp(k (a - s), -F_max, F_max)      s moved, a to the target at the start of the step
//! F(s) = f(s)                                 without inertia: force on the load at the end
//! F(s) s = W(s)                               with inertia: mean force, from the hand's work W
//! ```
//!
//! Without inertia a mean over the step would count what the spring does before the hand touches.
//! With inertia it contains the impact, which a force at an instant does not.
//!
//! The force that a load withstands grows with s: a bracket finds the root, by trials from a saved
//! state. A load that stands withstands any force up to its limit, and the hand stands before it.

use crate::backend::{Backend, RestoreError, SavedState, Status, StepReport};
use crate::math::{Pose, Vec2};
use crate::model::World;
use crate::model::geometry::overlap_depth;

/// Displacement of a hand over the radius of the load's outline by which it is tried whether the
/// load gives way (1): the work on it is known to 1e-7 at 1 m from the origin.
const TRIED: f64 = 1e-7;
/// Error of the displacement of a hand over the radius of the load's outline (1).
const RESOLVED: f64 = 1e-10;
/// Depth of the load inside the hand over the radius of its outline from which it does not give way
/// (1): an engine lets a hand go into what a wall holds. Its usual depths are smaller by far.
const DEEPEST: f64 = 0.01;
/// Most trials within a bracket (1): one of 1e10 times its error is halved 34 times.
const MOST_TRIALS: usize = 120;
/// Growth of the displacement that is tried (1), and most times that it grows: to 1e8 radii.
const GROWTH: f64 = 16.0;
const MOST_GROWN: usize = 12;

/// An obstacle that is pushed by a spring along an axis. Across it and in its heading it is stiff.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hand {
    /// Index in [`World::obstacles`].
    pub obstacle: usize,
    /// Where the spring pulls the origin of the obstacle (m, world). What of it lies across the
    /// axis has no effect.
    pub target: Vec2,
    /// Direction of the spring, of length one (world).
    pub axis: Vec2,
    /// (N/m)
    pub stiffness: f64,
    /// Largest force of the spring (N). It may be infinite.
    pub force_limit: f64,
}

/// Why a hand cannot push.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HandError {
    #[error("hand: must be an obstacle of the scenario, found {0}")]
    NotThere(usize),
    #[error("hand: must have a finite target, an axis of length one, a stiffness above 0 and a force limit of at least 0, found {0:?}")]
    Numbers(Hand),
    #[error("hand: must be the only obstacle that moves, found that obstacle {0} moves as well")]
    OtherMoves(usize),
    #[error("hand: must be on a backend that steers obstacles and can be saved, found one that cannot")]
    Backend,
    #[error("hand: must have a target near which spring and load balance, found one {0:e} m away without")]
    NoBalance(f64),
    #[error("hand: {0}")]
    Restore(#[from] RestoreError),
}

/// One step of a hand.
struct Step<'a> {
    hand: &'a Hand,
    backend: &'a mut dyn Backend,
    world: &'a World,
    /// Start and end of the step (s).
    times: [f64; 2],
    targets: &'a [Vec2],
    has_inertia: bool,
    start: Pose,
    /// To the target (m).
    ahead: f64,
    /// Radius of the load's outline (m).
    radius: f64,
    /// State at the start of the step, and the displacement (m) and report of the last trial.
    saved: SavedState,
    last: Option<(f64, StepReport)>,
}

impl Hand {
    /// Checks the numbers, and that the obstacle is one of so many.
    ///
    /// # Errors
    /// When they are those of no hand.
    pub fn check(&self, n_obstacles: usize) -> Result<(), HandError> {
        let Self { obstacle, target, axis, stiffness, force_limit } = *self;
        if obstacle >= n_obstacles {
            return Err(HandError::NotThere(obstacle));
        }
        // A force is wrong by as much of itself.
        let is_unit = (axis.norm() - 1.0).abs() <= 1e-9;
        let is_one = target.norm().is_finite() && is_unit && stiffness > 0.0 && stiffness.is_finite() && force_limit >= 0.0;
        if is_one { Ok(()) } else { Err(HandError::Numbers(*self)) }
    }

    /// Force of the spring along the axis, on a hand whose origin is at `position` (N). In
    /// equilibrium it is that of the hand on the load.
    pub fn force(&self, position: &Vec2) -> f64 {
        self.force_ahead((self.target - position).dot(&self.axis))
    }

    fn force_ahead(&self, ahead: f64) -> f64 {
        (self.stiffness * ahead).clamp(-self.force_limit, self.force_limit)
    }

    /// Advances a backend from one time to another (s) with its tips to `targets`, while the hand
    /// pushes a load that `has_inertia` or not. All other obstacles of `world` must stand still.
    /// Only the advance in which the hand moves as far as it does is reported.
    ///
    /// # Errors
    /// When the hand is none, another obstacle moves, nothing balances the spring, or the backend
    /// can neither be steered nor saved. The backend may then stand anywhere within the step.
    pub fn advance(
        &self,
        backend: &mut dyn Backend,
        world: &World,
        times: [f64; 2],
        targets: &[Vec2],
        has_inertia: bool,
    ) -> Result<StepReport, HandError> {
        self.check(world.obstacles.len())?;
        let start = pose_at(backend, world, self.obstacle, times[0]);
        let ahead = (self.target - start.position).dot(&self.axis);
        let (saved, last) = (backend.save().map_err(|_| HandError::Backend)?, None);
        let radius = world.outline.extent();
        Step { hand: self, backend, world, times, targets, has_inertia, start, ahead, radius, saved, last }.advance()
    }
}

impl Step<'_> {
    fn advance(mut self) -> Result<StepReport, HandError> {
        let way = self.way()?;
        if self.last.is_none_or(|(tried, _)| tried != way) {
            self.excess(way)?;
        }
        Ok(self.last.expect("a way was tried").1)
    }

    /// Advances while the hand moves by `way` (m), and returns by how much the spring's force
    /// exceeds what the load withstands (N).
    fn excess(&mut self, way: f64) -> Result<f64, HandError> {
        self.backend.restore(&self.saved)?;
        let Self { hand, world, times: [from, until], targets, start, ahead, .. } = *self;
        let others = |backend: &dyn Backend, time: f64| -> Vec<Pose> {
            (0..world.obstacles.len()).filter(|at| *at != hand.obstacle).map(|at| pose_at(backend, world, at, time)).collect()
        };
        let (before, work) = (others(&*self.backend, from), self.backend.energy().obstacle_work);
        let end = Pose { position: start.position + way * hand.axis, ..start };
        if !self.backend.steer(hand.obstacle, &[(until - from, end)]) {
            return Err(HandError::Backend);
        }
        let report = self.backend.advance(targets, until - from);
        let moves = before.iter().zip(others(&*self.backend, until)).position(|(before, now)| *before != now);
        if let Some(other) = moves {
            return Err(HandError::OtherMoves(other + usize::from(other >= hand.obstacle)));
        }
        let gives_way = report.status != Status::Failed && self.depth(&end) <= DEEPEST * self.radius;
        let withstood = match (gives_way, self.has_inertia) {
            (false, _) => f64::INFINITY.copysign(way),
            (true, true) => (self.backend.energy().obstacle_work - work) / way,
            (true, false) => self.backend.contact_force(hand.obstacle).dot(&hand.axis),
        };
        self.last = Some((way, report));
        Ok(hand.force_ahead(ahead - way) - if way == 0.0 { 0.0 } else { withstood })
    }

    /// Depth by which the load lies inside a hand at this pose (m).
    fn depth(&self, end: &Pose) -> f64 {
        let World { outline, obstacles } = self.world;
        overlap_depth(outline, &self.backend.motion().pose, &obstacles[self.hand.obstacle].outline, end).unwrap_or(0.0)
    }

    /// The way that the hand moves (m). `excess` falls with the way.
    fn way(&mut self) -> Result<f64, HandError> {
        let (least, ahead) = (TRIED * self.radius, self.ahead);
        let touches = self.backend.side_contacts().iter().any(|contact| contact.obstacle == self.hand.obstacle);
        if !touches && (ahead == 0.0 || self.excess(ahead)? == 0.0) {
            return Ok(ahead);
        }
        let on = (least, self.excess(least)?);
        let ends = if on.1 > 0.0 {
            [on, self.march(on)?]
        } else {
            let back = (-least, self.excess(-least)?);
            if back.1 >= 0.0 {
                // What stands withstands what comes, and the hand stands as well.
                return Ok(0.0);
            }
            [self.march(back)?, back]
        };
        self.root(ends)
    }

    /// Goes on to where the excess has the other sign, ever faster, but first to the target.
    fn march(&mut self, (first, value): (f64, f64)) -> Result<(f64, f64), HandError> {
        let mut at = first;
        for _ in 0..MOST_GROWN {
            let passes = (at - self.ahead) * (GROWTH * at - self.ahead) < 0.0;
            at = if passes { self.ahead } else { GROWTH * at };
            let found = self.excess(at)?;
            if found * value <= 0.0 {
                return Ok((at, found));
            }
        }
        Err(HandError::NoBalance(self.ahead))
    }

    /// Where between two ends the excess is zero, or behind which it is below: regula falsi after
    /// Illinois, and bisection where a trial has no finite force.
    fn root(&mut self, [mut low, mut high]: [(f64, f64); 2]) -> Result<f64, HandError> {
        if low.1 == 0.0 || high.1 == 0.0 {
            return Ok(if low.1 == 0.0 { low.0 } else { high.0 });
        }
        let (mut weights, mut last) = ([1.0, 1.0], 0.0);
        for _ in 0..MOST_TRIALS {
            if high.0 - low.0 <= RESOLVED * self.radius {
                break;
            }
            let [below, above] = [weights[0] * low.1, weights[1] * high.1];
            let secant = (low.0 * above - high.0 * below) / (above - below);
            let way = if secant > low.0 && secant < high.0 { secant } else { 0.5 * (low.0 + high.0) };
            let value = self.excess(way)?;
            if value == 0.0 {
                return Ok(way);
            }
            // The end that stays twice counts half.
            let kept = if value * last > 0.0 { 0.5 } else { 1.0 };
            if value > 0.0 {
                (low, weights) = ((way, value), [1.0, kept * weights[1]]);
            } else {
                (high, weights) = ((way, value), [kept * weights[0], 1.0]);
            }
            last = value;
        }
        // The load gives way up to here at least.
        Ok(low.0)
    }
}

/// Pose of an obstacle at a time (m, rad, world).
pub(super) fn pose_at(backend: &dyn Backend, world: &World, obstacle: usize, time: f64) -> Pose {
    let steered = backend.steered().into_iter().find(|other| other.obstacle == obstacle);
    steered.map_or_else(|| world.obstacles[obstacle].path.pose_at(time), |steered| steered.pose)
}
