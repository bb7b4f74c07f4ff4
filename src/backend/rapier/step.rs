//! One finished step: its start and end, the joints that were set, and the answer of the engine.

use super::contacts::ContactPoint;
use super::joints::{FrictionJoint, SpringJoint};
use super::springs::{SpringState, SpringSum};
use crate::backend::report::Motion;
use crate::backend::springs::Attachment;
use crate::math::{Twist, Vec2, Wrench};

/// One finished step. All lists of springs have the order of the attachments.
pub struct Step<'a> {
    /// (s)
    pub duration: f64,
    pub start: Motion,
    pub end: Motion,
    /// Unit vector of the load's x axis at the start.
    pub facing: Vec2,
    /// Attached springs with their tips at the start.
    pub from: &'a [Attachment],
    /// Attached springs with their tips at the end.
    pub to: &'a [Attachment],
    /// Attached springs at both ends of the step.
    pub springs: [&'a [SpringState]; 2],
    /// Attached springs as joints, one each.
    pub joints: &'a [SpringJoint],
    /// Sum of the joints at the start, with the tips at the end.
    pub sum: &'a SpringSum,
    /// Whether the springs acted as explicit forces.
    pub is_explicit: bool,
    pub friction: &'a [FrictionJoint],
    /// Force of each friction joint on the load, and its moment about the point where it acts.
    pub wrenches: &'a [Wrench],
    /// Last digit of the engine's numbers (1).
    pub digit: f64,
    /// Contacts with obstacles and their forces.
    pub contacts: &'a [ContactPoint],
}

impl Step<'_> {
    /// Twist that the dashpots act on.
    pub fn damped_twist(&self) -> &Twist {
        if self.is_explicit { &self.start.twist } else { &self.end.twist }
    }
}
