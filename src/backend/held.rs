//! The springs that are held now: tips, branches of their swings, energy and forces. Shared by all backends.

use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use super::RestoreError;
use super::friction::EXACT;
use crate::math::{Pose, Vec2};
use crate::model::{PolarSpring, Reaction, SpringShape, System};

/// Whether a spring of this elastic energy (J) may pull at the load by more than what counts as exact.
pub fn pulls_with(system: &System, spring: usize, energy: f64) -> bool {
    let largest_pull = (2.0 * energy * system.springs[spring].largest_stiffness()).sqrt();
    let is_at_rest = energy == 0.0 || largest_pull <= EXACT * system.total_slip_limit();
    !is_at_rest
}

/// One held spring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grip {
    pub spring: usize,
    /// Tip (m, world).
    pub tip: Vec2,
    /// Swing at the last accepted pose (rad): tells which branch the next one lies on.
    pub swing: f64,
}

/// A held tip at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldTip {
    pub spring: usize,
    /// (m, world)
    pub position: Vec2,
    /// Force of the holder on the tip, opposite to Eq. (10) (N, world).
    pub pull: Vec2,
}

/// Up to four without memory elsewhere: mostly there are no more.
pub type HeldTips = SmallVec<[HeldTip; 4]>;

/// All held springs in the order of their index. What depends on their sum does not depend on the order of grasping.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct HeldSprings {
    grips: Vec<Grip>,
    /// How many of them were grasped nowhere.
    #[serde(skip)]
    n_nowhere: usize,
}

impl HeldSprings {
    pub fn grips(&self) -> &[Grip] {
        &self.grips
    }

    /// Where tips and swings may be changed; which springs are held may not.
    pub(super) fn grips_mut(&mut self) -> &mut [Grip] {
        &mut self.grips
    }

    pub fn is_empty(&self) -> bool {
        self.grips.is_empty()
    }

    pub fn get(&self, spring: usize) -> Option<&Grip> {
        self.place(spring).map(|at| &self.grips[at])
    }

    /// Place of a held spring among the grips.
    pub fn place(&self, spring: usize) -> Option<usize> {
        // Where all springs before it are held, it stands at its own number.
        match self.grips.get(spring) {
            Some(grip) if grip.spring == spring => Some(spring),
            _ => self.grips.binary_search_by_key(&spring, |grip| grip.spring).ok(),
        }
    }

    /// Tip of a held spring (m, world); `None` for a free one.
    pub fn tip(&self, spring: usize) -> Option<Vec2> {
        self.get(spring).map(|grip| grip.tip)
    }

    /// Adds a grip on the principal branch of its swing and returns the elastic energy that it brings (J).
    ///
    /// # Panics
    /// When the spring is held already or does not exist.
    pub fn grasp(&mut self, springs: &[PolarSpring], spring: usize, tip: Vec2, pose: &Pose) -> f64 {
        assert!(spring < springs.len(), "spring {spring} of {} springs", springs.len());
        let at = self.grips.binary_search_by_key(&spring, |grip| grip.spring).expect_err("a spring is grasped once");
        let shape = springs[spring].shape(pose, &tip, 0.0);
        self.grips.insert(at, Grip { spring, tip, swing: shape.swing });
        self.n_nowhere += usize::from(!is_somewhere(&tip));
        known(springs[spring].energy(&shape))
    }

    /// Removes a grip and returns the elastic energy that goes with it (J).
    ///
    /// # Panics
    /// When the spring is not held.
    pub fn release(&mut self, springs: &[PolarSpring], spring: usize, pose: &Pose) -> f64 {
        let at = self.grips.binary_search_by_key(&spring, |grip| grip.spring).expect("only a held spring is released");
        let grip = self.grips.remove(at);
        self.n_nowhere = self.n_nowhere.saturating_sub(usize::from(!is_somewhere(&grip.tip)));
        known(springs[spring].energy(&grip.shape(springs, pose)))
    }

    /// Elastic energy at `pose` (J).
    pub fn energy(&self, springs: &[PolarSpring], pose: &Pose) -> f64 {
        self.grips.iter().map(|grip| springs[grip.spring].energy(&grip.shape(springs, pose))).fold(0.0, |sum, energy| sum + energy)
    }

    /// Sum of the largest stiffnesses of all held springs (N/m).
    pub fn largest_stiffness(&self, springs: &[PolarSpring]) -> f64 {
        self.grips.iter().map(|grip| springs[grip.spring].largest_stiffness()).sum()
    }

    /// Sum of the reactions of all held springs at `pose`.
    pub fn reaction(&self, springs: &[PolarSpring], pose: &Pose) -> Reaction {
        let mut sum = Reaction::ZERO;
        for grip in &self.grips {
            sum.add(&springs[grip.spring].reaction(pose, &grip.shape(springs, pose)));
        }
        sum
    }

    /// Force of a spring on its tip (N, world); zero when it is free.
    pub fn force_on_tip(&self, springs: &[PolarSpring], spring: usize, pose: &Pose) -> Vec2 {
        self.get(spring).map_or(Vec2::zeros(), |grip| springs[spring].force_on_tip(pose, &grip.shape(springs, pose)))
    }

    /// Puts every tip a `share` of the way from `from` to its entry of `targets`; a share of one lands exactly there.
    pub fn place_tips(&mut self, from: &[Grip], targets: &[Vec2], share: f64) {
        for (grip, start) in self.grips.iter_mut().zip(from) {
            let target = targets[grip.spring];
            grip.tip = if share == 1.0 { target } else { start.tip + share * (target - start.tip) };
        }
    }

    /// Puts every tip at its entry of `targets`, and gives the longest of their straight ways there (m).
    pub fn move_tips(&mut self, targets: &[Vec2]) -> f64 {
        let longest = self.farthest_way(targets);
        self.grips.iter_mut().for_each(|grip| grip.tip = targets[grip.spring]);
        longest
    }

    /// The longest of the tips' straight ways to their entries of `targets` (m).
    pub fn farthest_way(&self, targets: &[Vec2]) -> f64 {
        self.grips.iter().map(|grip| (targets[grip.spring] - grip.tip).norm_squared()).fold(0.0, f64::max).sqrt()
    }

    /// Whether tips that are somewhere are asked to go somewhere, in a time that passes (s): without that no step has an answer.
    pub fn can_go(&self, targets: &[Vec2], duration: f64) -> bool {
        // A sum without a value is below nothing. One over x and one over y, as they need not wait for each other.
        let targets = self.grips.iter().map(|grip| &targets[grip.spring]);
        let [x, y] = targets.fold([0.0f64; 2], |[x, y], tip| [x + tip.x.abs(), y + tip.y.abs()]);
        x + y < FARTHEST && self.n_nowhere == 0 && duration > 0.0 && duration.is_finite()
    }

    /// Whether no held tip differs from its entry of `targets`.
    pub fn tips_are_at(&self, targets: &[Vec2]) -> bool {
        self.grips.iter().all(|grip| grip.tip == targets[grip.spring])
    }

    /// What bounds the error of the tips' work by trapezoids on a smooth path (J), since they were where `from` has them: half the change of the pulls times the way of the tips.
    pub fn largest_work_error(&self, springs: &[PolarSpring], from: &Self, before: &Pose, after: &Pose) -> f64 {
        let bound = |(now, last): (&Grip, &Grip)| {
            let spring = &springs[now.spring];
            let change = spring.force_on_tip(after, &now.shape(springs, after)) - spring.force_on_tip(before, &last.shape(springs, before));
            0.5 * change.norm() * (now.tip - last.tip).norm()
        };
        self.grips.iter().zip(&from.grips).map(bound).fold(0.0, |sum, bound| sum + bound)
    }

    /// # Errors
    /// When these are not grips of distinct ones of `springs` in the order of their index.
    pub fn check(&self, springs: &[PolarSpring]) -> Result<(), RestoreError> {
        let in_order = self.grips.windows(2).all(|pair| pair[0].spring < pair[1].spring);
        let exist = self.grips.iter().all(|grip| grip.spring < springs.len());
        if in_order && exist { Ok(()) } else { Err(RestoreError(format!("grips that are not of {} springs", springs.len()))) }
    }

    /// Keeps the branch of every swing at the accepted `pose`.
    pub fn accept(&mut self, springs: &[PolarSpring], pose: &Pose) {
        for grip in &mut self.grips {
            grip.swing = grip.shape(springs, pose).swing;
        }
    }

    /// The same for who has worked them out already: one a grip (rad).
    pub fn keep_swings(&mut self, swings: impl IntoIterator<Item = f64>) {
        for (grip, swing) in self.grips.iter_mut().zip(swings) {
            grip.swing = swing;
        }
    }
}

/// Beyond, energies have no finite value (m); scenarios end at 1e50 m.
const FARTHEST: f64 = 1e60;

fn far(tip: &Vec2) -> f64 {
    tip.x.abs() + tip.y.abs()
}

fn is_somewhere(tip: &Vec2) -> bool {
    far(tip) < FARTHEST
}

/// The energy (J) of a spring whose tip is nowhere is nobody's.
fn known(energy: f64) -> f64 {
    if energy.is_finite() { energy } else { 0.0 }
}

impl Grip {
    pub fn shape(&self, springs: &[PolarSpring], pose: &Pose) -> SpringShape {
        springs[self.spring].shape(pose, &self.tip, self.swing)
    }
}
