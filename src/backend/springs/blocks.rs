//! Attached springs side by side in SIMD lanes: what the exact backends evaluate in their inner
//! loop.
//!
//! The law is that of [`PolarSpring`], written in the axes of the load, so that the heading costs
//! one rotation for all springs. With d from root to tip, e = d / l and t a quarter turn further,
//!
//! ```text
//! f = k_r (l - l_0) e + (k_t psi / l) t
//! H = k_r ee' + (k_r (1 - l_0 / l) + k_t / l^2) tt' - (k_t psi / l^2) (et' + te')
//! ```
//!
//! The swing psi is the polar angle of d less the bearing, on the branch nearest to the swing at
//! the last accepted pose. Mostly it differs from that one by a small angle, for which five or nine
//! terms of the series of the arctangent suffice. Their roundings add up like a random walk of
//! 1e-16 a step. [`PolarSpring`] itself evaluates a block with a spring too short to have a
//! direction. Lanes beyond the last spring repeat the first spring of their block without
//! stiffness.

use super::attachments::Attachment;
use super::block::{Block, Sums, Swings};
use super::place::Place;
use crate::math::{LANES, Mat2, Numbers, Pose, Vec2, Vec3, direction};
use crate::model::{PolarSpring, Reaction};

/// All attached springs, in the order of their attachments.
#[derive(Clone, Debug, Default)]
pub struct SpringBlocks {
    n: usize,
    blocks: Vec<Block>,
    /// Spring and attachment of each lane.
    lanes: Vec<(PolarSpring, Attachment)>,
    /// Bearing of each spring that was ever attached (rad), and the unit vector there. Springs come
    /// and go, their bearings mostly stay.
    bearings: Vec<(f64, Vec2)>,
    evaluated: Evaluated,
    accepted: Evaluated,
    most_swung: f64,
}

/// Energy (J) of all springs at a place, and its gradient in world axes.
#[derive(Clone, Copy, Debug)]
struct Evaluated {
    at: Place,
    energy: f64,
    gradient: Vec3,
}

/// Energies between the last accepted pose and a new one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Accepted {
    /// Elastic energy now (J).
    pub elastic: f64,
    /// Work on the tips (J): the energy gained by the springs where the load
    /// stood still, by the trapezoid rule elsewhere.
    pub of_tips: f64,
    /// Work of the springs on the load by the trapezoid rule (J).
    pub on_load: f64,
    /// Whether no tip has moved.
    pub tips_stood: bool,
}

impl Default for Evaluated {
    fn default() -> Self {
        let nowhere = Place { pose: Pose::new(f64::NAN, f64::NAN, f64::NAN), turn: Mat2::zeros() };
        Self { at: nowhere, energy: 0.0, gradient: Vec3::zeros() }
    }
}

impl SpringBlocks {
    /// Takes over the attached springs. Nothing is accepted yet. Memory is reused.
    pub fn fill(&mut self, springs: &[PolarSpring], attachments: &[Attachment]) {
        self.n = attachments.len();
        self.lanes.clear();
        self.blocks.clear();
        for chunk in attachments.chunks(LANES) {
            let lane = |k: usize| chunk.get(k).unwrap_or(&chunk[0]);
            let mut block = Block::default();
            for k in 0..LANES {
                let (attachment, spring) = (*lane(k), springs[lane(k).spring]);
                let bearing = bearing_of(&mut self.bearings, attachment.spring, spring.bearing);
                block.set_spring(k, &spring, bearing, k < chunk.len());
                block.set_attachment(k, &attachment);
                self.lanes.push((spring, attachment));
            }
            self.blocks.push(block);
        }
        (self.evaluated, self.accepted) = (Evaluated::default(), Evaluated::default());
    }

    /// Sets the accepted directions to those of the swings, so that small changes of swing are
    /// recognised without an accepted pose.
    pub fn aim(&mut self) {
        self.blocks.iter_mut().for_each(Block::aim);
    }

    pub fn is_empty(&self) -> bool {
        self.n == 0
    }

    /// Puts every tip at a `share` of the line from its attachment to its entry of `targets`. A
    /// share of one lands exactly on the target.
    pub fn place_tips(&mut self, from: &[Attachment], targets: &[Vec2], share: f64) {
        for (block, from) in self.blocks.iter_mut().zip(from.chunks(LANES)) {
            for k in 0..LANES {
                block.tip.set_lane(k, from.get(k).unwrap_or(&from[0]).tip_towards(targets, share));
            }
        }
        self.evaluated = Evaluated::default();
    }

    /// Puts every tip where its attachment is.
    pub fn set_tips(&mut self, attachments: &[Attachment]) {
        for (block, chunk) in self.blocks.iter_mut().zip(attachments.chunks(LANES)) {
            (0..LANES).for_each(|k| block.tip.set_lane(k, chunk.get(k).unwrap_or(&chunk[0]).tip));
        }
        self.evaluated = Evaluated::default();
    }

    /// Gradient at the accepted place, for a load that stands still while its tips move.
    pub fn gradient_at_rest(&mut self) -> Vec3 {
        let place = self.accepted.at;
        self.gradient(&place)
    }

    /// Accepts a place, with the swings of the attachments.
    pub fn start(&mut self, at: &Place) {
        self.evaluate::<false>(at, Swings::Given);
        self.accept(&at.pose);
    }

    /// Sum of the reactions of all springs, with derivatives by shifts along the axes of the load
    /// and by its heading.
    pub fn reaction(&mut self, at: &Place) -> Reaction {
        self.evaluate::<true>(at, Swings::Found)
    }

    /// First derivatives of the energy alone, at less cost.
    pub fn gradient(&mut self, at: &Place) -> Vec3 {
        self.evaluate::<false>(at, Swings::Found).gradient
    }

    /// Reaction at a place, without second derivatives where it is not `CURVED`.
    fn evaluate<const CURVED: bool>(&mut self, at: &Place, swings: Swings) -> Reaction {
        let mut sums = Sums::default();
        for block in &mut self.blocks {
            if !block.add_to::<CURVED>(&mut sums, at, swings) {
                return self.evaluate_short::<CURVED>(at, swings);
            }
        }
        self.keep(at, sums.in_load::<CURVED>())
    }

    /// Reaction where some springs are too short to have a direction. It is a function of its own,
    /// because what it keeps between blocks needs all registers.
    #[cold]
    fn evaluate_short<const CURVED: bool>(&mut self, at: &Place, swings: Swings) -> Reaction {
        let (mut sums, mut apart) = (Sums::default(), Reaction::ZERO);
        for (i, block) in self.blocks.iter_mut().enumerate() {
            if !block.add_to::<CURVED>(&mut sums, at, swings) {
                let n = (self.n - i * LANES).min(LANES);
                apart.add(&block.reaction_apart(&self.lanes[i * LANES..i * LANES + n], at));
            }
        }
        let mut reaction = sums.in_load::<CURVED>();
        reaction.add(&apart.in_axes(&at.turn));
        self.keep(at, reaction)
    }

    /// Stores the reaction at a place as the last one evaluated.
    fn keep(&mut self, at: &Place, reaction: Reaction) -> Reaction {
        let force = at.turn * reaction.gradient.xy();
        self.evaluated = Evaluated { at: *at, energy: reaction.energy, gradient: force.push(reaction.gradient.z) };
        reaction
    }

    /// Evaluates at `pose` unless that was the last one evaluated.
    fn evaluate_at(&mut self, pose: &Pose) {
        if self.evaluated.at.pose != *pose {
            self.gradient(&Place::of(pose));
        }
    }

    /// Tips in the order of the attachments (m, world).
    pub fn tips(&self) -> impl Iterator<Item = Vec2> + '_ {
        self.blocks.iter().flat_map(|block| (0..LANES).map(|k| block.tip.lane(k))).take(self.n)
    }

    /// Tips at the accepted pose in the order of the attachments (m, world).
    pub fn accepted_tips(&self) -> impl Iterator<Item = Vec2> + '_ {
        self.blocks.iter().flat_map(|block| (0..LANES).map(|k| block.accepted_tip.lane(k))).take(self.n)
    }

    /// Elastic energy at `pose` (J).
    pub fn energy(&mut self, pose: &Pose) -> f64 {
        self.evaluate_at(pose);
        self.evaluated.energy
    }

    /// Elastic energy where the springs were evaluated last (J).
    pub fn last_energy(&self) -> f64 {
        self.evaluated.energy
    }

    /// Accepts `pose` and the tips as they are as the new start.
    pub fn accept(&mut self, pose: &Pose) -> Accepted {
        self.evaluate_at(pose);
        let turn = &self.evaluated.at.turn;
        let (cos, sin) = (Numbers::splat(turn.m11), Numbers::splat(turn.m21));
        let (mut work, mut displacement) = (Numbers::ZERO, Numbers::ZERO);
        for block in &mut self.blocks {
            if block.is_far {
                self.most_swung = self.most_swung.max(block.take_swung());
            }
            let [of_tips, moved] = block.accept(cos, sin);
            work += of_tips;
            displacement += moved;
        }
        let last = std::mem::replace(&mut self.accepted, self.evaluated);
        let (from, now) = (&last.at.pose, &self.accepted);
        let moved = (pose.position - from.position).push(pose.heading - from.heading);
        Accepted {
            elastic: now.energy,
            of_tips: if *pose == *from { now.energy - last.energy } else { 0.5 * work.reduce_add() },
            on_load: -0.5 * (last.gradient + now.gradient).dot(&moved),
            tips_stood: displacement.reduce_add() == 0.0,
        }
    }

    /// Bound of the error of the work on the tips that was accepted last, on a smooth path (J):
    /// half the change of the pulls times the displacement of the tips.
    pub fn work_error(&self) -> f64 {
        0.5 * self.blocks.iter().map(|block| block.error().reduce_add()).sum::<f64>()
    }

    /// Largest change of the direction of a spring about its root from an accepted pose to the next
    /// one, since the last call (rad); zero where all are small.
    pub fn take_most_swung(&mut self) -> f64 {
        std::mem::take(&mut self.most_swung)
    }

    /// The accepted place.
    pub fn place(&self) -> &Place {
        &self.accepted.at
    }

    /// Pull on the tip of the attachment in this place at the accepted pose (N, world).
    pub fn pull(&self, at: usize) -> Vec2 {
        self.blocks[at / LANES].accepted_pull.lane(at % LANES)
    }

    /// Pull on the tip of the attachment in this place where the springs were evaluated last
    /// (N, world).
    pub fn last_pull(&self, at: usize) -> Vec2 {
        self.evaluated.at.turn * self.blocks[at / LANES].last_pull.lane(at % LANES)
    }

    /// Passes the pulls on the tips (N, world) to `see`, in the order of the attachments: those
    /// at the accepted pose, or the `last` ones evaluated.
    pub fn see_pulls(&self, last: bool, mut see: impl FnMut(usize, Vec2)) {
        let turn = &self.evaluated.at.turn;
        let (cos, sin) = (Numbers::splat(turn.m11), Numbers::splat(turn.m21));
        for (i, block) in self.blocks.iter().enumerate() {
            let pulls = if last { block.last_pull.turned(cos, sin) } else { block.accepted_pull };
            (i * LANES..self.n).zip(pulls.lanes()).for_each(|(at, pull)| see(at, pull));
        }
    }

    /// Writes tips and swings of the accepted pose to the attachments.
    pub fn write_accepted(&self, attachments: &mut [Attachment]) {
        for (block, chunk) in self.blocks.iter().zip(attachments.chunks_mut(LANES)) {
            let swing = block.swing.to_array();
            for (k, attachment) in chunk.iter_mut().enumerate() {
                (attachment.tip, attachment.swing) = (block.accepted_tip.lane(k), swing[k]);
            }
        }
    }
}

/// Unit vector at the `bearing` (rad) of a spring, computed only where it is not the known one.
fn bearing_of(known: &mut Vec<(f64, Vec2)>, spring: usize, bearing: f64) -> Vec2 {
    if known.len() <= spring {
        known.resize(spring + 1, (0.0, Vec2::new(1.0, 0.0)));
    }
    let (at, unit) = &mut known[spring];
    if *at != bearing {
        (*at, *unit) = (bearing, direction(bearing));
    }
    *unit
}
