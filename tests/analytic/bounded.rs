//! The backend without inertia with an auditor in front of it, who checks the energy of every step
//! against bounds that hold for every minimiser.
//!
//! With U the elastic energy for tips p and pose q, D the friction loss of the step, on the ground
//! and at obstacles that stand still, and dE = U(p1, q1) - U(p0, q0) + D,
//!
//! ```text
//! U(p1, q1) - U(p0, q1)  <=  dE  <=  U(p1, q0) - U(p0, q0)
//! ```
//!
//! The upper bound says that the new pose is no worse than the old one, the lower that the old pose
//! was stable under the old tips. Where it is not, the load jumps, and only the upper bound holds:
//! after a spring was attached or released, when that bound is zero, and at the end of a balance.

use cohaul::backend::springs::Attachments;
use cohaul::backend::{
    Backend, BackendKind, BackendOptions, Hook, Motion, Shared, Skip, Skips, StepReport, TransitionKind, Wrapped, build,
};
use cohaul::math::{Arc, Pose, Vec2, rotation};
use cohaul::model::System;
use cohaul::model::support::slip_velocity;

/// What the auditor found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Findings {
    pub n_steps: u32,
    /// Steps with friction loss.
    pub n_moving: u32,
    pub n_jumps: u32,
    /// Largest excess over a bound, over the energies in it (1).
    pub above: f64,
    pub below: f64,
    /// Largest difference between the friction loss in the ledger and that of the motion, over the
    /// energies (1).
    pub misbooked: f64,
    /// Most negative friction loss of a step in the ledger (J).
    pub least_loss: f64,
}

/// Checks every step of the backend that it is called with.
pub struct Auditor {
    system: System,
    held: Attachments,
    disturbed: bool,
    findings: Shared<Findings>,
}

/// A quasi-static backend with an auditor in front of it, and where the findings appear.
pub fn audited(system: &System, start: Motion) -> (Wrapped<Auditor>, Shared<Findings>) {
    let findings = Shared::new(Findings::default());
    let options = BackendOptions::new(BackendKind::QuasiStatic, f64::INFINITY);
    let inside = build(system, start, &BackendOptions { skips: Skips::ALL.without(Skip::StickCertificate), ..options });
    let hook = Auditor { system: system.clone(), held: Attachments::default(), disturbed: false, findings: findings.clone() };
    (Wrapped { inside, hook }, findings)
}

impl Auditor {
    /// One step of the inner backend, with the ledger read before and after.
    fn step(&mut self, inner: &mut dyn Backend, targets: &[Vec2], duration: f64, is_jump: bool) -> StepReport {
        let springs = &self.system.springs;
        let (q0, booked, booked_at_sides) = (inner.motion().pose, inner.energy().friction, inner.energy().side_friction);
        let before = self.held.clone();
        self.held.place_tips(&before, targets, 1.0);
        let report = inner.advance(targets, duration);
        let is_jump = is_jump || inner.transitions().iter().any(|transition| matches!(transition.kind, TransitionKind::Jump { .. }));
        let q1 = inner.motion().pose;

        let booked_loss = inner.energy().friction - booked;
        // A jump may have several iterations, which the poses at its ends do not show.
        let loss = if is_jump { booked_loss } else { friction_loss(&self.system, &q0, &q1) };
        let [before_at_q0, before_at_q1] = [q0, q1].map(|q| before.energy(springs, &q));
        let [after_at_q0, after_at_q1] = [q0, q1].map(|q| self.held.energy(springs, &q));
        self.held.accept(springs, &q1);
        let gain = after_at_q1 - before_at_q0 + loss + inner.energy().side_friction - booked_at_sides;
        let scale = loss + before_at_q0.max(before_at_q1).max(after_at_q0).max(after_at_q1) + f64::MIN_POSITIVE;

        let mut found = self.findings.borrow();
        found.n_steps += 1;
        found.n_moving += u32::from(loss > 0.0);
        found.n_jumps += u32::from(is_jump && loss > 0.0);
        found.above = found.above.max((gain - (after_at_q0 - before_at_q0) - ROUNDING) / scale);
        if !is_jump {
            found.below = found.below.max((after_at_q1 - before_at_q1 - gain - ROUNDING) / scale);
        }
        found.misbooked = found.misbooked.max((booked_loss - loss).abs() / (scale + booked));
        found.least_loss = found.least_loss.min(booked_loss);
        report
    }
}

/// Energy (J) of a spring that is deformed by nothing but rounding of its tip's place: k (1e-16
/// m)^2 is 1e-32 or less in all scenes but the stiffest, where what moves is a million times that.
const ROUNDING: f64 = 1e-30;

/// Loss (J) along the constant twist from one pose to another, worked back from the poses.
fn friction_loss(system: &System, from: &Pose, to: &Pose) -> f64 {
    let turn = to.heading - from.heading;
    let shift = rotation(from.heading).tr_mul(&(to.position - from.position));
    let twist = (Arc::of(turn).mean_rotation().try_inverse().expect("less than a whole turn") * shift).push(turn);
    let supports = system.ground.supports.iter().zip(system.ground.slip_limits());
    supports.map(|(support, limit)| limit * slip_velocity(&support.offset, &twist).norm()).sum()
}

impl Hook for Auditor {
    fn attach(&mut self, inner: &mut dyn Backend, spring: usize, tip: Vec2) {
        self.held.attach(&self.system.springs, spring, tip, &inner.motion().pose);
        inner.attach(spring, tip);
        self.disturbed = true;
    }

    fn release(&mut self, inner: &mut dyn Backend, spring: usize) {
        self.held.release(&self.system.springs, spring, &inner.motion().pose);
        inner.release(spring);
        self.disturbed = true;
    }

    fn advance(&mut self, inner: &mut dyn Backend, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let mut report = StepReport::default();
        if self.disturbed {
            let mut here = tip_targets.to_vec();
            self.held.iter().for_each(|attachment| here[attachment.spring] = attachment.tip);
            report.add(&self.step(inner, &here, duration, true));
            self.disturbed = false;
        }
        report.add(&self.step(inner, tip_targets, duration, false));
        report
    }
}
