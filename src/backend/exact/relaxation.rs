//! Relaxation of a quasi-static load on damped springs.
//!
//! What the method neglects is the force of inertia and nothing else. With the shapes s_j of the
//! damped springs, their energy U and the friction h, the load moves so that
//!
//! ```text
//! 0 in dU/dq + sum_j S_j' C_j s_j' + dh(q')        S_j = ds_j/dq
//! ```
//!
//! That is the equation of motion in the limit without mass, at the same dashpots. A step is one of
//! implicit Euler: it adds `|s_1 - s_0|_C^2 / 2 h` to what is minimised, with the shapes at its end
//! and at its start. A relaxation is resolved by steps much shorter than its time; much longer
//! steps lead to its end.
//!
//! Where all attached springs are damped, every velocity is finite, whatever the sign of the
//! springs' stiffness: `w q' = 0 < h(q')` along a motion that changes no shape. The load relaxes
//! where it would jump without dashpots. Springs that are not damped can still turn a load at once
//! about the tip of a damped one. Such a jump is a step of vanishing duration.

use super::bdf2::{Past, weights};
use super::contact::GroundContact;
use super::load::Exact;
use super::quasi_static::QuasiStatic;
use super::viscous::{Viscous, is_damped};
use crate::backend::numerics::{FIRST_MACRO_STEP, LOST_ENERGY, RIGID_DASHPOT, SAME_INSTANT, SAME_VELOCITY, STRAIGHT_TIP};
use crate::backend::report::{Status, StepReport};
use crate::backend::springs::{Attachment, TipPaths};
use crate::backend::stepping::Stepping;
use crate::math::{Pose, Vec2};
use crate::model::{PolarSpring, System};

impl Exact<QuasiStatic> {
    /// Attached springs with their radial dashpots (N s/m).
    fn radial_dashpots(&self) -> impl Iterator<Item = (&PolarSpring, f64)> {
        let of = |attached: &Attachment| &self.system.springs[attached.spring];
        self.springs.iter().map(of).map(|spring| (spring, self.system.dashpot(spring).0))
    }

    /// Whether a dashpot of an attached spring acts.
    pub(super) fn is_damped(&self) -> bool {
        self.method.viscous.acts && self.springs.iter().any(|it| is_damped(&self.system, &self.system.springs[it.spring]))
    }

    /// Whether an attached spring acts without a dashpot, so that the load can jump.
    pub(super) fn can_jump(&self) -> bool {
        !self.method.viscous.acts || self.springs.iter().any(|it| !is_damped(&self.system, &self.system.springs[it.spring]))
    }

    /// Sets the dashpots of a step of this length (s), with the tips of the blocks at its end.
    #[inline(never)]
    pub(super) fn set_dashpots(&mut self, step: f64) {
        let Self { method: QuasiStatic { viscous, .. }, system, springs, state, .. } = self;
        if viscous.acts {
            let pose = &state.motion.pose;
            viscous.start.clear();
            viscous.start.extend(springs.iter().map(|last| (last.tip, last.shape(&system.springs, pose))));
            viscous.dashpots.renew(system, springs, pose, step);
            viscous.by_differences = false;
        }
    }

    /// Sets the dashpots of a step by backward differences after the `past` one, about the shapes
    /// that it carries on. Returns `false` where the tips do not go straight on.
    pub(super) fn carry_dashpots_on(&mut self, past: &Past, step: f64) -> bool {
        let Self { method: QuasiStatic { viscous, .. }, system, springs, state, .. } = self;
        if !viscous.acts {
            return true;
        }
        let (Some((a, b)), tips) = (weights(step / past.duration), &state.memory.viscous.tips) else { return false };
        let goes_on = |((last, next), before): ((&Attachment, Vec2), &Vec2)| {
            let missed = next - last.tip - step / past.duration * (last.tip - before);
            missed.norm() <= STRAIGHT_TIP * (system.load.radius + next.norm())
        };
        if tips.len() != springs.len() || !springs.iter().zip(springs.block_tips()).zip(tips).all(goes_on) {
            return false;
        }
        let Pose { position, heading } = state.motion.pose;
        let earlier = Pose { position: position - past.shift, heading: heading - past.turn };
        let start = &viscous.start;
        let carried_on = |at: usize, last: &Attachment| {
            let before = Attachment { tip: tips[at], ..*last };
            start[at].1.going_on(&before.shape(&system.springs, &earlier), a)
        };
        viscous.dashpots.renew_about(system, springs, &state.motion.pose, b * step, carried_on);
        viscous.by_differences = true;
        true
    }

    /// Adds the work and the loss of the dashpots in a step (s) to the ledger, and keeps their
    /// forces at its end. Work and loss are those of the mean rate, also in a step by backward
    /// differences.
    #[inline(never)]
    pub(super) fn account_for_dashpots(&mut self, step: f64) -> StepReport {
        let Self { method: QuasiStatic { viscous: Viscous { dashpots, start, by_differences, .. }, .. }, system, springs, state, .. } =
            self;
        let (pose, memory) = (&state.motion.pose, &mut state.memory.viscous);
        memory.on_tip.resize(system.springs.len(), Vec2::zeros());
        for (force, attached) in dashpots.forces(pose).zip(springs.iter()) {
            memory.on_tip[attached.spring] = force;
        }
        if *by_differences {
            dashpots.renew_about(system, springs, pose, step, |at, _| start[at].1);
        }
        let moved = springs.iter().zip(&*start).map(|(attached, (tip, _))| attached.tip - tip);
        let work = -dashpots.forces(pose).zip(moved).map(|(force, moved)| force.dot(&moved)).sum::<f64>();
        let damping = dashpots.loss(pose, step);
        memory.tips.clear();
        memory.tips.extend(start.iter().map(|(tip, _)| *tip));
        if !(work + damping).is_finite() {
            memory.on_tip.fill(Vec2::zeros());
            return StepReport { status: Status::Failed, ..StepReport::default() };
        }
        state.energy.damping += damping;
        state.energy.tip_work += work;
        StepReport::default()
    }

    /// Takes note of a load at rest with tips that stood still. Dashpots pull no more then, and the
    /// next step repeats this one unless a tip moves.
    #[inline(never)]
    pub(super) fn note_settled(&mut self, before: &Pose, paths: &TipPaths) {
        let stood = |start: &Attachment| start.tip == paths.targets[start.spring];
        if self.state.motion.pose == *before && paths.from.iter().all(stood) {
            self.state.contact = GroundContact::Settled(self.state.contact.last());
        }
    }

    /// Shortens the next macro-step where forces or velocities of tips change at once as an advance
    /// begins.
    pub(super) fn pace_relaxation(&mut self, paths: &TipPaths) {
        let Stepping::Controlled(control) = self.stepping else { return };
        if !self.is_damped() {
            return;
        }
        let longest = self.radial_dashpots().map(|(spring, radial)| radial / spring.radial_stiffness);
        let longest = longest.filter(|time| time.is_finite()).fold(0.0, f64::max);
        let velocity = |start: &Attachment| (paths.targets[start.spring] - start.tip) / paths.duration;
        let velocities = &mut self.state.memory.viscous.velocities;
        velocities.resize(self.system.springs.len(), None);
        let (now, same) = (self.state.side.time, SAME_INSTANT * paths.duration);
        let mut goes_on = self.obstacles.is_none() || self.system.world.next_corner(now - same) > now + same;
        for start in paths.from {
            let (next, last) = (velocity(start), &mut velocities[start.spring]);
            let change = last.replace(next).map(|last| (next - last).norm());
            goes_on &= change.is_some_and(|change| change * longest <= SAME_VELOCITY * control.position);
        }
        if !goes_on {
            self.pace.macro_step = self.pace.macro_step.min(FIRST_MACRO_STEP * self.shortest_relaxation());
        }
    }

    /// Shortest time in which the load can relax on its attached springs (s): the weakest dashpot
    /// over the stiffness of all of them.
    fn shortest_relaxation(&self) -> f64 {
        let weakest = self.radial_dashpots().map(|(_, radial)| radial).filter(|radial| *radial > 0.0).fold(f64::INFINITY, f64::min);
        weakest / self.springs.largest_stiffness(&self.system.springs)
    }

    /// Sets the dashpots of a step of vanishing duration.
    #[inline(never)]
    pub(super) fn set_rigid_dashpots(&mut self) {
        let Self { method: QuasiStatic { viscous, .. }, system, springs, state, .. } = self;
        if viscous.acts {
            let pose = &state.motion.pose;
            let rigid = |spring: &PolarSpring| rigid_dashpot(system, springs.largest_stiffness(&system.springs), spring);
            viscous.dashpots.renew_as(system, springs, pose, rigid, |_, last| last.shape(&system.springs, pose));
        }
    }

    /// Stiffness of the dashpots that decide where a jump leads (N/m, N m/rad): those of damped
    /// springs in a vanishing time, and others in proportion to the springs that have none.
    pub(super) fn stiffness_in_jump(&self, spring: &PolarSpring) -> (f64, f64) {
        if self.method.viscous.acts && is_damped(&self.system, spring) {
            return rigid_dashpot(&self.system, self.springs.largest_stiffness(&self.system.springs), spring);
        }
        (spring.radial_stiffness, spring.torsional_stiffness)
    }

    /// Takes note of energy (J) that a step misses and that went into the dashpots: one much longer
    /// than a relaxation leads to its end at once. Under error control it is an error.
    pub(super) fn account_for_relaxation(&mut self, missing: f64) {
        if matches!(self.stepping, Stepping::Fixed(_)) {
            self.state.energy.damping += missing;
        }
    }

    /// Energy that a step may miss besides the error of the trapezoid rule without having jumped
    /// (J); `None` where what is missing went into the dashpots.
    pub(super) fn lost_without_jump(&self) -> Option<f64> {
        if !self.is_damped() {
            return Some(0.0);
        }
        match self.stepping {
            Stepping::Controlled(control) if self.can_jump() => Some(LOST_ENERGY * control.energy),
            _ => None,
        }
    }
}

/// Stiffness of a dashpot in a vanishing time, on springs of this stiffness in all (N/m, N m/rad).
fn rigid_dashpot(system: &System, stiffness: f64, spring: &PolarSpring) -> (f64, f64) {
    let (radial, torsional) = system.dashpot(spring);
    if radial == 0.0 { (0.0, 0.0) } else { (RIGID_DASHPOT * stiffness, RIGID_DASHPOT * stiffness * torsional / radial) }
}
