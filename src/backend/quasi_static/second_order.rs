//! A step of second order for a load that goes on slipping: Gear's backward differences (BDF2) of its position and heading.
//!
//! With the last step (d_n over h_n), the next one over h and w = h / h_n, the velocity at the end is, up to an error of second order,
//!
//! ```text
//! h v = (d - a d_n) / b        a = w^2 / (1 + 2 w)    b = (1 + w) / (1 + 2 w)
//! ```
//!
//! and friction at the end, opposite to the slip of v there, has to balance the springs. That is again a minimum, over x = d - a d_n:
//!
//! ```text
//! minimise over x    E(q + a d_n + x) + sum_i c_i |B_i x|        x by shifts along the load's axes at the end, and turn
//! ```
//!
//! These axes are taken from a forecast, whose error is of second order as well. One solution a step, as implicit Euler takes it (`increment`), and like that it
//! damps what it does not resolve (it is L-stable). What it needs is a past: two steps of slip of all supports. Onsets, turns about a support, jumps and whatever else
//! does not lie near its forecast are Euler's.

use serde::{Deserialize, Serialize};

use crate::backend::friction::{FrictionSolver, Regime};
use crate::backend::increment::{Glided, Increment, Objective, Wanted, friction_loss, glide, rounding_of_places};
use crate::backend::springs::{Place, SpringBlocks};
use crate::math::{Arc, Mat2, Pose, Vec2, Vec3, shift_of};
use crate::model::support::slip_velocity;
use crate::model::{Reaction, System};

/// Largest length of a step over that of the last one (1): the method is stable up to 1 + sqrt(2) (Grigorieff, 1983).
const LARGEST_RATIO: f64 = 2.0;

/// The last step of a load that slipped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Past {
    /// How far the load's origin went (m, world).
    pub shift: Vec2,
    /// (rad)
    pub turn: f64,
    /// How long it took (s).
    pub duration: f64,
}

/// Springs along straight ways of position and heading.
struct Straight<'a> {
    springs: &'a mut SpringBlocks,
    /// At the start of the step.
    start: &'a Pose,
    /// Of the load (m).
    radius: f64,
    /// What the past carries on: shift (m, world) and turn (rad).
    carried: (Vec2, f64),
    /// Takes the axes of the increment to world axes.
    axes: Mat2,
    /// Turn that they belong to (rad).
    expected_turn: f64,
}

impl Straight<'_> {
    /// Shift (m, world) and turn (rad) of the whole step.
    fn way(&self, at: &Vec3) -> (Vec2, f64) {
        let (shift, turn) = self.carried;
        (shift + self.axes * at.xy(), turn + at.z)
    }

    /// Where it leads, and the rotation from the axes there to those of the increment.
    fn place(&self, at: &Vec3) -> (Place, Mat2) {
        let (shift, turn) = self.way(at);
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

/// The step from `start` over `duration` (s) near the body-twist increment `guess` (m, m, rad), for a load that slips on all supports and did so in `past`. `None`
/// where there is no such step near the guess.
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
    let Glided { at, regime, report } = glide(&mut objective, solver, system.load.radius, near, None, Wanted::Nearest)?;
    let (shift, turned) = objective.way(&at);
    let straight = Arc::of(turned).mean_rotation().try_inverse()? * turn.tr_mul(&shift);
    let twist = straight.push(turned);
    let goes_on = |offset: &Vec2| slip_velocity(offset, &twist).dot(&slip_velocity(offset, &at)) > 0.0;
    let is_slip = regime == Regime::Slip && system.ground.supports.iter().all(|support| goes_on(&support.offset));
    is_slip.then(|| Increment { twist, shift, friction: friction_loss(&system.ground, &twist), regime, report })
}
