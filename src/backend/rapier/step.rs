//! One finished step as its readers see it: where it began and ended, what was asked and what the engine answered.

use super::joints::{FrictionJoint, SpringJoint};
use super::springs::SpringSum;
use crate::backend::Motion;
use crate::backend::held::Grip;
use crate::math::Wrench;

pub struct Step {
    /// (s)
    pub duration: f64,
    pub start: Motion,
    pub end: Motion,
    /// The held springs with their tips at the start.
    pub from: Vec<Grip>,
    /// The held springs as joints, one each, in the same order.
    pub springs: Vec<SpringJoint>,
    /// Their sum at the start, with the tips at the end.
    pub sum: SpringSum,
    pub friction: Vec<FrictionJoint>,
    /// Force of each friction joint on the load, and its moment about where it acts.
    pub wrenches: Vec<Wrench>,
}
