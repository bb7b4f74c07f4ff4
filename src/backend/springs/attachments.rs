//! Springs whose tips are attached to an ant or a robot: tips, branches of the swings, energies
//! and pulls, spring by spring.

use std::ops::Deref;

use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use crate::backend::numerics::{EXACT, LARGEST_ENTRY, LARGEST_SWING};
use crate::backend::report::RestoreError;
use crate::math::{Pose, Vec2};
use crate::model::{PolarSpring, Reaction, SpringShape, System};

/// One attached spring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Attachment {
    pub spring: usize,
    /// Position of the tip (m, world).
    pub tip: Vec2,
    /// Swing at the last accepted pose (rad). The next swing lies on the branch nearest to it.
    pub swing: f64,
}

/// Position and pull of an attached tip at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttachedTip {
    pub spring: usize,
    /// (m, world)
    pub position: Vec2,
    /// Force of the ant or robot on the tip (N, world): the negative of Eq. (10).
    pub pull: Vec2,
}

/// Attached tips; up to four of them need no memory of their own.
pub type AttachedTips = SmallVec<[AttachedTip; 4]>;

/// All attached springs in the order of their index. Sums over them do not depend on the order in
/// which they were attached.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Attachments {
    list: Vec<Attachment>,
    /// Number of tips that were attached at a position without a finite energy.
    #[serde(skip)]
    n_nowhere: usize,
}

impl Deref for Attachments {
    type Target = [Attachment];

    fn deref(&self) -> &[Attachment] {
        &self.list
    }
}

impl Attachments {
    /// The attachments, to change tips and swings. Which springs are attached stays.
    pub(in crate::backend) fn as_mut_slice(&mut self) -> &mut [Attachment] {
        &mut self.list
    }

    /// Place of an attached spring in the list; `None` for a free spring.
    pub fn place(&self, spring: usize) -> Option<usize> {
        // A spring stands at its own index where all springs before it are attached.
        match self.list.get(spring) {
            Some(attachment) if attachment.spring == spring => Some(spring),
            _ => self.list.binary_search_by_key(&spring, |attachment| attachment.spring).ok(),
        }
    }

    /// Tip of an attached spring (m, world); `None` for a free spring.
    pub fn tip(&self, spring: usize) -> Option<Vec2> {
        self.place(spring).map(|at| self.list[at].tip)
    }

    /// Attaches a spring on the principal branch of its swing and returns its elastic energy (J).
    ///
    /// # Panics
    /// When the spring is attached already or does not exist.
    pub fn attach(&mut self, springs: &[PolarSpring], spring: usize, tip: Vec2, pose: &Pose) -> f64 {
        assert!(spring < springs.len(), "spring {spring} of {} springs", springs.len());
        let at = self.list.binary_search_by_key(&spring, |attachment| attachment.spring).expect_err("a spring is attached once");
        let shape = springs[spring].shape(pose, &tip, 0.0);
        self.list.insert(at, Attachment { spring, tip, swing: shape.swing });
        self.n_nowhere += usize::from(!is_somewhere(&tip));
        finite_or_zero(springs[spring].energy(&shape))
    }

    /// Releases a spring and returns the elastic energy that it takes away (J).
    ///
    /// # Panics
    /// When the spring is not attached.
    pub fn release(&mut self, springs: &[PolarSpring], spring: usize, pose: &Pose) -> f64 {
        let at = self.list.binary_search_by_key(&spring, |attachment| attachment.spring).expect("only an attached spring is released");
        let attachment = self.list.remove(at);
        self.n_nowhere = self.n_nowhere.saturating_sub(usize::from(!is_somewhere(&attachment.tip)));
        finite_or_zero(springs[spring].energy(&attachment.shape(springs, pose)))
    }

    /// Elastic energy at `pose` (J).
    pub fn energy(&self, springs: &[PolarSpring], pose: &Pose) -> f64 {
        self.iter()
            .map(|attachment| springs[attachment.spring].energy(&attachment.shape(springs, pose)))
            .fold(0.0, |sum, energy| sum + energy)
    }

    /// Sum of the largest stiffnesses of the attached springs (N/m).
    pub fn largest_stiffness(&self, springs: &[PolarSpring]) -> f64 {
        self.iter().map(|attachment| springs[attachment.spring].largest_stiffness()).sum()
    }

    /// Sum of the reactions of the attached springs at `pose`.
    pub fn reaction(&self, springs: &[PolarSpring], pose: &Pose) -> Reaction {
        let mut sum = Reaction::ZERO;
        for attachment in self.iter() {
            sum.add(&springs[attachment.spring].reaction(pose, &attachment.shape(springs, pose)));
        }
        sum
    }

    /// Pull on the tip of a spring (N, world); zero for a free spring.
    pub fn pull(&self, springs: &[PolarSpring], spring: usize, pose: &Pose) -> Vec2 {
        self.place(spring).map_or(Vec2::zeros(), |at| springs[spring].pull(pose, &self.list[at].shape(springs, pose)))
    }

    /// Puts every tip at a `share` of the line from `from` to its entry of `targets`. A share of
    /// one lands exactly on the target.
    pub fn place_tips(&mut self, from: &[Attachment], targets: &[Vec2], share: f64) {
        self.list.iter_mut().zip(from).for_each(|(attachment, start)| attachment.tip = start.tip_towards(targets, share));
    }

    /// Puts every tip at its entry of `targets` and returns the longest displacement (m).
    pub fn move_tips(&mut self, targets: &[Vec2]) -> f64 {
        let longest = self.longest_displacement(targets);
        self.list.iter_mut().for_each(|attachment| attachment.tip = targets[attachment.spring]);
        longest
    }

    /// Longest displacement from a tip to its entry of `targets` (m).
    pub fn longest_displacement(&self, targets: &[Vec2]) -> f64 {
        self.iter().map(|attachment| (targets[attachment.spring] - attachment.tip).norm_squared()).fold(0.0, f64::max).sqrt()
    }

    /// Whether tips and targets have finite energies and the duration (s) is positive and finite.
    /// No step has an answer otherwise.
    pub fn can_move(&self, targets: &[Vec2], duration: f64) -> bool {
        // A sum that is not a number fails the comparison. Two sums, so that neither waits for the
        // other.
        let targets = self.iter().map(|attachment| &targets[attachment.spring]);
        let [x, y] = targets.fold([0.0f64; 2], |[x, y], tip| [x + tip.x.abs(), y + tip.y.abs()]);
        x + y < LARGEST_ENTRY && self.n_nowhere == 0 && duration > 0.0 && duration.is_finite()
    }

    /// Whether every tip is at its entry of `targets`.
    pub fn tips_are_at(&self, targets: &[Vec2]) -> bool {
        self.iter().all(|attachment| attachment.tip == targets[attachment.spring])
    }

    /// Bound of the error of the tips' work by the trapezoid rule on a smooth path from `from` (J):
    /// half the change of the pulls times the displacement of the tips.
    pub fn work_error(&self, springs: &[PolarSpring], from: &Self, before: &Pose, after: &Pose) -> f64 {
        let bound = |(now, last): (&Attachment, &Attachment)| {
            let spring = &springs[now.spring];
            let change = spring.pull(after, &now.shape(springs, after)) - spring.pull(before, &last.shape(springs, before));
            0.5 * change.norm() * (now.tip - last.tip).norm()
        };
        self.iter().zip(from.iter()).map(bound).fold(0.0, |sum, bound| sum + bound)
    }

    /// # Errors
    /// When the list does not hold distinct ones of `springs` in the order of their index, or when
    /// a tip is so far away that its energy is not finite.
    pub fn check(&self, springs: &[PolarSpring]) -> Result<(), RestoreError> {
        let in_order = self.windows(2).all(|pair| pair[0].spring < pair[1].spring);
        let exist = self.iter().all(|attachment| attachment.spring < springs.len());
        if !(in_order && exist) {
            return Err(RestoreError(format!("attachments that are not of {} springs", springs.len())));
        }
        match self.iter().find(|attachment| !is_somewhere(&attachment.tip) || attachment.swing.abs() > LARGEST_SWING) {
            Some(Attachment { spring, tip, swing }) => {
                Err(RestoreError(format!("spring {spring} with its tip at [{}, {}] m and a swing of {swing} rad", tip.x, tip.y)))
            }
            None => Ok(()),
        }
    }

    /// Keeps the branch of every swing at the accepted `pose`.
    pub fn accept(&mut self, springs: &[PolarSpring], pose: &Pose) {
        for attachment in &mut self.list {
            attachment.swing = attachment.shape(springs, pose).swing;
        }
    }

    /// Stores swings that are known already, one for each attachment (rad).
    pub fn set_swings(&mut self, swings: impl IntoIterator<Item = f64>) {
        for (attachment, swing) in self.list.iter_mut().zip(swings) {
            attachment.swing = swing;
        }
    }
}

impl Attachment {
    /// Point at a `share` of the line from the tip to its entry of `targets` (m, world). A share of
    /// one lands exactly on the target.
    pub fn tip_towards(&self, targets: &[Vec2], share: f64) -> Vec2 {
        let target = targets[self.spring];
        if share == 1.0 { target } else { self.tip + share * (target - self.tip) }
    }

    /// Shape of the spring with the load at `pose`.
    pub fn shape(&self, springs: &[PolarSpring], pose: &Pose) -> SpringShape {
        springs[self.spring].shape(pose, &self.tip, self.swing)
    }
}

/// Whether a spring with this elastic energy (J) can pull on the load by more than the tolerance of
/// the friction solver.
pub fn pulls_with(system: &System, spring: usize, energy: f64) -> bool {
    let largest_pull = (2.0 * energy * system.springs[spring].largest_stiffness()).sqrt();
    let is_at_rest = energy == 0.0 || largest_pull <= EXACT * system.total_slip_limit();
    !is_at_rest
}

fn is_somewhere(tip: &Vec2) -> bool {
    tip.x.abs() + tip.y.abs() < LARGEST_ENTRY
}

fn finite_or_zero(energy: f64) -> f64 {
    if energy.is_finite() { energy } else { 0.0 }
}
