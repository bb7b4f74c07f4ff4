//! The attached springs of an exact backend: one owner of tips, swings and evaluated springs.

use std::ops::Deref;

use serde::{Deserialize, Serialize};

use super::attachments::{AttachedTip, Attachment, Attachments};
use super::blocks::{Accepted, SpringBlocks};
use super::place::Place;
use crate::backend::report::RestoreError;
use crate::math::{Mat2, Pose, Vec2, Vec3, rotation};
use crate::model::PolarSpring;

/// Straight paths of the attached tips in one advance, at constant speed.
#[derive(Clone, Copy)]
pub struct TipPaths<'a> {
    /// Attachments at the start.
    pub from: &'a [Attachment],
    /// Tips at the end (m, world, one entry a spring).
    pub targets: &'a [Vec2],
    /// (s)
    pub duration: f64,
}

/// Attachments, and the same springs in blocks as a cache. Reading the attachments is as cheap as
/// reading a list.
#[derive(Debug, Default)]
pub struct AttachedSprings {
    attachments: Attachments,
    blocks: SpringBlocks,
    cache: Cache,
}

/// How the blocks relate to the attachments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Cache {
    /// The blocks are to be filled: springs were attached, released or restored.
    #[default]
    Stale,
    /// Attachments and blocks agree at the accepted place.
    Accepted,
    /// The tips moved while the load stood still; their work is not accepted yet.
    Ahead,
}

/// What is saved of the attached springs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedSprings {
    attachments: Attachments,
    /// Rotation by the heading at the accepted place, to its last bits; `None` where the cache was
    /// stale.
    turn: Option<Mat2>,
    /// Tips at the accepted place, if they have moved since (m, world).
    accepted_tips: Option<Vec<Vec2>>,
}

impl Deref for AttachedSprings {
    type Target = Attachments;

    fn deref(&self) -> &Attachments {
        &self.attachments
    }
}

impl AttachedSprings {
    /// Attaches a spring and returns its elastic energy (J). See [`Attachments::attach`].
    pub fn attach(&mut self, springs: &[PolarSpring], spring: usize, tip: Vec2, pose: &Pose) -> f64 {
        self.cache = Cache::Stale;
        self.attachments.attach(springs, spring, tip, pose)
    }

    /// Releases a spring and returns its elastic energy (J). See [`Attachments::release`].
    pub fn release(&mut self, springs: &[PolarSpring], spring: usize, pose: &Pose) -> f64 {
        self.cache = Cache::Stale;
        self.attachments.release(springs, spring, pose)
    }

    /// Replaces the attachments.
    pub fn reset(&mut self, attachments: Attachments) {
        (self.attachments, self.cache) = (attachments, Cache::Stale);
    }

    /// Moves the swings to the branches at a pose that was found without the blocks.
    pub fn accept_outside(&mut self, springs: &[PolarSpring], pose: &Pose) {
        self.attachments.accept(springs, pose);
        self.cache = Cache::Stale;
    }

    /// Fills the blocks anew before their next use.
    pub fn invalidate(&mut self) {
        self.cache = Cache::Stale;
    }

    /// Fills the blocks with the load at `pose`, if they are stale.
    pub fn refresh(&mut self, springs: &[PolarSpring], pose: &Pose) {
        if self.cache == Cache::Stale {
            self.fill(springs, &Place::of(pose));
        }
    }

    fn fill(&mut self, springs: &[PolarSpring], place: &Place) {
        self.blocks.fill(springs, &self.attachments);
        self.blocks.start(place);
        self.cache = Cache::Accepted;
    }

    /// Puts the tips of the blocks at a `share` of their paths. The attachments follow when a pose
    /// is accepted.
    pub fn place_tips(&mut self, paths: &TipPaths, share: f64) {
        self.blocks.place_tips(paths.from, paths.targets, share);
    }

    /// Moves the tips to a `share` of their paths, to be accepted later, if the load sticks:
    /// `sticks` is asked with the gradient of the energy (N, N, N m; load axes) and the blocks
    /// there. Nothing changes otherwise. The blocks must be fresh.
    pub fn move_ahead(&mut self, paths: &TipPaths, share: f64, sticks: impl FnOnce(Vec3, &SpringBlocks) -> bool) -> bool {
        self.place_tips(paths, share);
        let gradient = self.blocks.gradient_at_rest();
        let moves = sticks(gradient, &self.blocks);
        if moves {
            self.attachments.place_tips(paths.from, paths.targets, share);
            self.cache = Cache::Ahead;
        } else {
            self.blocks.set_tips(&self.attachments);
            self.blocks.gradient_at_rest();
        }
        moves
    }

    /// Whether tips have moved whose work is not accepted yet.
    pub fn are_ahead(&self) -> bool {
        self.cache == Cache::Ahead
    }

    /// Elastic energy with the tips ahead of the accepted place (J).
    pub fn energy_ahead(&self) -> f64 {
        self.blocks.last_energy()
    }

    /// Accepts `pose` and the tips as the blocks have them.
    pub fn accept(&mut self, pose: &Pose) -> Accepted {
        let accepted = self.blocks.accept(pose);
        self.blocks.write_accepted(self.attachments.as_mut_slice());
        self.cache = Cache::Accepted;
        accepted
    }

    /// The springs as they are evaluated. They must be fresh.
    pub fn blocks(&mut self) -> &mut SpringBlocks {
        &mut self.blocks
    }

    /// Tips of the blocks in the order of the attachments (m, world).
    pub fn block_tips(&self) -> impl Iterator<Item = Vec2> + '_ {
        self.blocks.tips()
    }

    /// The accepted place. The blocks must be fresh.
    pub fn place(&self) -> &Place {
        self.blocks.place()
    }

    /// Bound of the error of the work that was accepted last (J). See [`SpringBlocks::work_error`].
    pub fn last_work_error(&self) -> f64 {
        self.blocks.work_error()
    }

    /// Pull on the tip of a spring, with the load at `pose` (N, world); zero for a
    /// free spring.
    pub fn pull(&self, springs: &[PolarSpring], spring: usize, pose: &Pose) -> Vec2 {
        match (self.attachments.place(spring), self.cache) {
            (Some(at), Cache::Accepted) => self.blocks.pull(at),
            (Some(at), Cache::Ahead) => self.blocks.last_pull(at),
            _ => self.attachments.pull(springs, spring, pose),
        }
    }

    /// Writes position and pull of all attached tips into `tips`, in the order of their springs.
    pub fn read_tips(&self, springs: &[PolarSpring], pose: &Pose, tips: &mut [AttachedTip]) {
        for (tip, attachment) in tips.iter_mut().zip(self.iter()) {
            tip.position = attachment.tip;
        }
        if self.cache == Cache::Stale {
            tips.iter_mut().for_each(|tip| tip.pull = self.attachments.pull(springs, tip.spring, pose));
        } else {
            self.blocks.see_pulls(self.are_ahead(), |at, pull| tips[at].pull = pull);
        }
    }

    pub fn save(&self) -> SavedSprings {
        SavedSprings {
            attachments: self.attachments.clone(),
            turn: (self.cache != Cache::Stale).then_some(self.blocks.place().turn),
            accepted_tips: self.are_ahead().then(|| self.blocks.accepted_tips().collect()),
        }
    }

    /// Springs as they were saved, with the load at `pose`.
    ///
    /// # Errors
    /// When the state does not fit the springs, or its rotation does not fit the pose.
    pub fn restored(saved: SavedSprings, springs: &[PolarSpring], pose: &Pose) -> Result<Self, RestoreError> {
        let SavedSprings { attachments, turn, accepted_tips } = saved;
        attachments.check(springs)?;
        let mut restored = Self { attachments, ..Self::default() };
        let Some(turn) = turn else { return Ok(restored) };
        // Roundings of many steps are smaller.
        if (turn - rotation(pose.heading)).amax() > 1e-6 {
            return Err(RestoreError(format!("a rotation that is not by the heading, {} rad", pose.heading)));
        }
        let place = Place { pose: *pose, turn };
        let Some(tips) = accepted_tips else {
            restored.fill(springs, &place);
            return Ok(restored);
        };
        if tips.len() != restored.attachments.len() {
            return Err(RestoreError(format!("{} accepted tips of {} attached springs", tips.len(), restored.attachments.len())));
        }
        let ahead = restored.attachments.clone();
        restored.attachments.as_mut_slice().iter_mut().zip(tips).for_each(|(attachment, tip)| attachment.tip = tip);
        restored.fill(springs, &place);
        restored.attachments = ahead;
        restored.blocks.set_tips(&restored.attachments);
        restored.blocks.gradient_at_rest();
        restored.cache = Cache::Ahead;
        Ok(restored)
    }
}
