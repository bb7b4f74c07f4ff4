//! Damping of the springs.
//!
//! A dashpot is a spring of stiffness c / t about the shape at the start of the step, evaluated
//! after the time t. Its force is c times the mean rate in that time, and twice its energy over t
//! is the power that it takes. In a step of backward differences (`touching`), it is a spring about
//! the shape that the last step carries on.

use crate::backend::springs::{AttachedSprings, Attachment, SpringBlocks};
use crate::math::{Pose, Vec2};
use crate::model::{PolarSpring, SpringShape, System};

/// Dashpots of one step as springs. The index of a dashpot is the place of its attachment; there
/// are none without damping.
#[derive(Default)]
pub struct Dashpots {
    springs: Vec<PolarSpring>,
    attachments: Vec<Attachment>,
    blocks: SpringBlocks,
    /// Time after which their springs are evaluated (s).
    time: f64,
}

impl Dashpots {
    /// Sets one dashpot for each attached spring. The attachments are those at the start of the
    /// step, with the load at `before`. The springs are evaluated with the tips of the blocks after
    /// `time` (s).
    pub fn renew(&mut self, system: &System, attached: &AttachedSprings, before: &Pose, time: f64) {
        self.renew_about(system, attached, before, time, |_, last| last.shape(&system.springs, before));
    }

    /// As [`Self::renew`], about the shape that `about` gives for an attachment and its place.
    pub fn renew_about(
        &mut self,
        system: &System,
        attached: &AttachedSprings,
        before: &Pose,
        time: f64,
        about: impl Fn(usize, &Attachment) -> SpringShape,
    ) {
        let stiffness = |spring: &PolarSpring| {
            let (radial, torsional) = system.dashpot(spring);
            (radial / time, torsional / time)
        };
        self.renew_as(system, attached, before, stiffness, about);
        self.time = time;
    }

    /// Sets one spring of this radial and torsional stiffness (N/m, N m/rad) for each attached
    /// spring, about the shape that `about` gives for an attachment and its place.
    pub fn renew_as(
        &mut self,
        system: &System,
        attached: &AttachedSprings,
        before: &Pose,
        stiffness: impl Fn(&PolarSpring) -> (f64, f64),
        about: impl Fn(usize, &Attachment) -> SpringShape,
    ) {
        self.springs.clear();
        self.attachments.clear();
        for (at, (last, tip)) in attached.iter().zip(attached.block_tips()).enumerate() {
            let spring = &system.springs[last.spring];
            let (radial, torsional) = stiffness(spring);
            let dashpot = spring.about(&about(at, last), radial, torsional);
            self.attachments.push(Attachment { spring: at, tip, swing: dashpot.shape(before, &tip, 0.0).swing });
            self.springs.push(dashpot);
        }
        self.blocks.fill(&self.springs, &self.attachments);
    }

    /// The dashpots as springs, if there are any.
    pub fn blocks(&mut self) -> Option<&mut SpringBlocks> {
        (!self.blocks.is_empty()).then_some(&mut self.blocks)
    }

    /// Energy lost in a step of `step` (s), with the load at `stage` when they are evaluated (J).
    pub fn loss(&mut self, stage: &Pose, step: f64) -> f64 {
        if self.blocks.is_empty() { 0.0 } else { 2.0 * self.blocks.energy(stage) * step / self.time }
    }

    /// Forces on the tips (N, world).
    pub fn forces(&self, stage: &Pose) -> impl Iterator<Item = Vec2> {
        self.springs.iter().zip(&self.attachments).map(|(spring, attached)| -spring.pull(stage, &attached.shape(&self.springs, stage)))
    }
}
