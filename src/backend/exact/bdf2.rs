//! Step of second order for a load that goes on slipping: backward differences (BDF2) of its
//! position and heading.
//!
//! With the last step (d_n over h_n), the next one over h and w = h / h_n, the velocity at the end
//! is, up to an error of second order,
//!
//! ```text
//! h v = (d - a d_n) / b        a = w^2 / (1 + 2 w)    b = (1 + w) / (1 + 2 w)
//! ```
//!
//! Friction at the end opposes the slip of v there and balances the springs. That is again a
//! minimum, over x = d - a d_n:
//!
//! ```text
//! minimise over x    E(q + a d_n + x) + sum_i c_i |B_i x|
//! ```
//!
//! Here x is a shift along the axes of the load at the end, and a turn. These axes come from a
//! forecast, whose error is of second order as well. A step takes one solution, as implicit Euler
//! does (`increment`), and damps what it does not resolve (it is L-stable). It needs two earlier
//! steps in which all supports slip. Slip onsets, turns about a support, jumps and whatever else
//! does not lie near its forecast are left to Euler.

use serde::{Deserialize, Serialize};

use crate::backend::friction::{ContactMode, FrictionSolver};
use crate::backend::increment::{Corrected, Increment, Objective, Wanted, correct, friction_loss, rounding_of_places};
use crate::backend::springs::{Place, SpringBlocks};
use crate::math::{Arc, Mat2, Pose, Vec2, Vec3, shift_of};
use crate::model::support::slip_velocity;
use crate::model::{Reaction, System};

/// Largest length of a step over that of the last one (1). The method is stable up to 1 + sqrt(2)
/// (Grigorieff, 1983).
const LARGEST_RATIO: f64 = 2.0;

/// The last step of a load that slipped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Past {
    /// Shift of the load's origin (m, world).
    pub shift: Vec2,
    /// (rad)
    pub turn: f64,
    /// (s)
    pub duration: f64,
}

/// Springs along straight paths of position and heading.
struct Straight<'a> {
    springs: &'a mut SpringBlocks,
    /// Pose at the start of the step.
    start: &'a Pose,
    /// Radius of the load (m).
    radius: f64,
    /// Shift (m, world) and turn (rad) that the last step carries on.
    carried: (Vec2, f64),
    /// Rotation from the axes of the increment to world axes.
    axes: Mat2,
    /// Turn that these axes belong to (rad).
    expected_turn: f64,
}

impl Straight<'_> {
    /// Shift (m, world) and turn (rad) of the whole step.
    fn displacement(&self, at: &Vec3) -> (Vec2, f64) {
        let (shift, turn) = self.carried;
        (shift + self.axes * at.xy(), turn + at.z)
    }

    /// Place at the end of the step, and the rotation from the axes there to those of the
    /// increment.
    fn place(&self, at: &Vec3) -> (Place, Mat2) {
        let (shift, turn) = self.displacement(at);
        let pose = Pose { position: self.start.position + shift, heading: self.start.heading + turn };
        let back = Arc::of(turn - self.expected_turn).rotation();
        (Place::turned(pose, self.axes * back.column(0)), back)
    }
}

impl Objective for Straight<'_> {
    fn rounding(&self) -> f64 {
        rounding_of_places(&self.start.position, self.radius)
    }

    fn at(&mut self, at: &Vec3) -> Reaction {
        let (place, back) = self.place(at);
        self.springs.reaction(&place).in_axes(&back.transpose())
    }

    fn gradient(&mut self, at: &Vec3) -> Vec3 {
        let (place, back) = self.place(at);
        let gradient = self.springs.gradient(&place);
        (back * gradient.xy()).push(gradient.z)
    }
}

/// Step from `start` over `duration` (s), for a load that slips on all supports and did so in
/// `past`. `None` where there is no such step near the `guess`, a body-twist increment (m, m, rad).
pub fn step(
    system: &System,
    (start, past): (&Place, &Past),
    duration: f64,
    guess: &Vec3,
    springs: &mut SpringBlocks,
    solver: &mut FrictionSolver,
) -> Option<Increment> {
    let ratio = duration / past.duration;
    if ratio > LARGEST_RATIO {
        return None;
    }
    let weight = ratio * ratio / (1.0 + 2.0 * ratio);
    let (shift, turned) = (weight * past.shift, weight * past.turn);
    let turn = start.turn;
    let axes = turn * Arc::of(guess.z).rotation();
    let near = axes.tr_mul(&(shift_of(&turn, guess) - shift)).push(guess.z - turned);
    let mut objective =
        Straight { springs, start: &start.pose, radius: system.load.radius, carried: (shift, turned), axes, expected_turn: guess.z };
    let Corrected { at, mode, report } = correct(&mut objective, solver, system.load.radius, near, None, Wanted::Nearest)?;
    let (shift, turned) = objective.displacement(&at);
    let straight = Arc::of(turned).mean_rotation().try_inverse()? * turn.tr_mul(&shift);
    let twist = straight.push(turned);
    let goes_on = |offset: &Vec2| slip_velocity(offset, &twist).dot(&slip_velocity(offset, &at)) > 0.0;
    let is_slip = mode == ContactMode::Slip && system.ground.supports.iter().all(|support| goes_on(&support.offset));
    is_slip.then(|| Increment { twist, shift, friction: friction_loss(&system.ground, &twist), mode, report })
}
