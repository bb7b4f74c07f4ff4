//! Straight steps: the load's position and its heading go on from the last step, and depart from
//! there by an increment.
//!
//! ```text
//! position = position_0 + carried shift + A u        heading = heading_0 + carried turn + delta
//! ```
//!
//! The increment (u, delta) has the axes A, those of the load at the end as far as a forecast tells
//! them. It is proportional to the velocity at the end where the carried parts are those of
//! backward differences.

use super::objective::{Objective, rounding_of_places};
use super::potential::{Coasting, Course, Increment, friction_loss};
use crate::backend::friction::ContactMode;
use crate::backend::report::StepReport;
use crate::backend::springs::{Place, SpringBlocks, Travel};
use crate::math::{Arc, Mat2, Pose, Vec2, Vec3};
use crate::model::support::slip_velocity;
use crate::model::{Ground, Reaction};

/// Potential of a straight step.
pub struct Straight<'a> {
    pub springs: &'a mut SpringBlocks,
    /// Dashpots as springs of this step.
    pub dashpots: Option<&'a mut SpringBlocks>,
    /// Inertia of the load; `None` neglects it.
    pub inertia: Option<Coasting>,
    pub ground: &'a Ground,
    /// Place at the start of the step.
    pub start: &'a Place,
    /// Radius of the load (m).
    pub radius: f64,
    /// Shift (m, world) and turn (rad) that the last step carries on.
    pub carried: (Vec2, f64),
    /// Rotation from the axes of the increment to world axes.
    pub axes: Mat2,
    /// Turn that these axes belong to (rad).
    pub expected_turn: f64,
}

/// Place at an increment: shift (m, world) and turn (rad) of the whole step, and the rotation from
/// the axes there to those of the increment.
pub struct Displacement {
    shift: Vec2,
    turn: f64,
    back: Mat2,
}

impl Straight<'_> {
    fn place(&self, Displacement { shift, turn, back }: &Displacement) -> Place {
        let Pose { position, heading } = self.start.pose;
        Place::turned(Pose { position: position + shift, heading: heading + turn }, self.axes * back.column(0))
    }

    /// Shift (m, world) and turn (rad) at an increment.
    pub fn displacement(&self, at: &Vec3) -> (Vec2, f64) {
        let (shift, turn) = self.carried;
        (shift + self.axes * at.xy(), turn + at.z)
    }

    /// Whether all supports slip on in the direction of this twist at the end of the `increment`.
    pub fn goes_on(&self, at: &Vec3, increment: &Increment) -> bool {
        let goes_on = |offset: &Vec2| slip_velocity(offset, &increment.twist).dot(&slip_velocity(offset, at)) > 0.0;
        increment.mode == ContactMode::Slip && self.ground.supports.iter().all(|support| goes_on(&support.offset))
    }
}

impl Objective for Straight<'_> {
    fn rounding(&self) -> f64 {
        rounding_of_places(&self.start.pose.position, self.radius)
    }

    fn at(&mut self, at: &Vec3) -> Reaction {
        let moved = self.moved(at);
        let place = self.place(&moved);
        let mut sum = self.springs.reaction(&place);
        if let Some(dashpots) = &mut self.dashpots {
            sum.add(&dashpots.reaction(&place));
        }
        let mut sum = sum.in_axes(&moved.back.transpose());
        if let Some(coasting) = &self.inertia {
            sum.add(&coasting.straight(&self.axes, at));
        }
        sum
    }

    fn gradient(&mut self, at: &Vec3) -> Vec3 {
        let moved = self.moved(at);
        let place = self.place(&moved);
        let mut gradient = self.springs.gradient(&place);
        if let Some(dashpots) = &mut self.dashpots {
            gradient += dashpots.gradient(&place);
        }
        let sum = (moved.back * gradient.xy()).push(gradient.z);
        self.inertia.as_ref().map_or(sum, |coasting| sum + coasting.straight(&self.axes, at).gradient)
    }
}

impl Course for Straight<'_> {
    type Moved = Displacement;

    fn ground(&self) -> &Ground {
        self.ground
    }

    fn length(&self) -> f64 {
        self.radius
    }

    fn moved(&self, at: &Vec3) -> Displacement {
        let (shift, turn) = self.displacement(at);
        Displacement { shift, turn, back: Arc::of(turn - self.expected_turn).rotation() }
    }

    fn seen(&self, start: &Place, _at: &Vec3, Displacement { shift, turn, .. }: &Displacement) -> Travel {
        Travel { shift: start.turn * self.start.turn.tr_mul(shift), arc: Arc::of(*turn) }
    }

    fn by_increment(&self, local: &Reaction, _at: &Vec3, moved: &Displacement) -> Reaction {
        local.in_axes(&moved.back.transpose())
    }

    /// The body twist of the whole step is less than a whole turn.
    fn found(&self, at: &Vec3, mode: ContactMode, report: StepReport) -> Increment {
        let (shift, turn) = self.displacement(at);
        let twist = crate::math::increment_of(&self.start.turn, &shift, turn);
        Increment { twist, shift, friction: friction_loss(self.ground, &twist), mode, report }
    }
}
