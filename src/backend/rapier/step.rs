//! One finished step as its readers see it: where it began and ended, what was asked and what the engine answered.

use super::joints::{FrictionJoint, SpringJoint};
use super::springs::{SpringSum, Strand};
use crate::backend::Motion;
use crate::backend::springs::Attachment;
use crate::math::{Twist, Vec2, Wrench};

pub struct Step<'a> {
    /// (s)
    pub duration: f64,
    pub start: Motion,
    pub end: Motion,
    /// Unit vector of the load's x axis at the start.
    pub facing: Vec2,
    /// The held springs with their tips at the start.
    pub from: &'a [Attachment],
    /// The same with their tips at the end.
    pub to: &'a [Attachment],
    /// The held springs at both ends of the step, in the same order.
    pub strands: [&'a [Strand]; 2],
    /// The held springs as joints, one each, in the same order.
    pub springs: &'a [SpringJoint],
    /// Their sum at the start, with the tips at the end.
    pub sum: &'a SpringSum,
    /// Whether the springs pushed as explicit forces.
    pub is_explicit: bool,
    pub friction: &'a [FrictionJoint],
    /// Force of each friction joint on the load, and its moment about where it acts.
    pub wrenches: &'a [Wrench],
}

impl Step<'_> {
    /// The motion that the dashpots see.
    pub fn damped_twist(&self) -> &Twist {
        if self.is_explicit { &self.start.twist } else { &self.end.twist }
    }
}
