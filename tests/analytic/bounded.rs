//! The backend without inertia with an auditor in front of it, who checks the energy of every step against bounds that hold for every minimiser.
//!
//! With U the elastic energy for tips p and pose q, D the friction loss of the step and dE = U(p1, q1) - U(p0, q0) + D,
//!
//! ```text
//! U(p1, q1) - U(p0, q1)  <=  dE  <=  U(p1, q0) - U(p0, q0)
//! ```
//!
//! The upper bound says that the new pose is no worse than the old one, the lower that the old pose was stable under the old tips. After a grasp or a
//! release it was not: for that jump only the upper bound holds, which is zero then.

use std::cell::RefCell;
use std::rc::Rc;

use cohaul::backend::quasi_static::QuasiStatic;
use cohaul::backend::springs::Attachments;
use cohaul::backend::{Backend, EnergyLedger, Motion, Skip, Skips, StepReport, Stepping};
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
    /// Largest difference between the friction loss in the ledger and that of the motion, over the energies (1).
    pub misbooked: f64,
    /// Most negative friction loss of a step in the ledger (J).
    pub least_loss: f64,
}

pub struct Audited {
    inner: QuasiStatic,
    system: System,
    held: Attachments,
    disturbed: bool,
    findings: Rc<RefCell<Findings>>,
}

impl Audited {
    /// The backend, and where its findings appear.
    pub fn new(system: &System, start: Motion) -> (Self, Rc<RefCell<Findings>>) {
        let findings = Rc::new(RefCell::new(Findings::default()));
        let inner = QuasiStatic::new(system.clone(), start, Stepping::Fixed(f64::INFINITY), Skips::ALL.without(Skip::StickBound));
        let audited = Self { inner, system: system.clone(), held: Attachments::default(), disturbed: false, findings: findings.clone() };
        (audited, findings)
    }

    /// One step of the inner backend, with the books read before and after.
    fn step(&mut self, targets: &[Vec2], duration: f64, is_jump: bool) -> StepReport {
        let springs = &self.system.springs;
        let (q0, booked) = (self.inner.motion().pose, self.inner.energy().friction);
        let before = self.held.clone();
        self.held.place_tips(&before, targets, 1.0);
        let report = self.inner.advance(targets, duration);
        let q1 = self.inner.motion().pose;

        let booked_loss = self.inner.energy().friction - booked;
        // A jump may have several legs, which the poses at its ends do not show.
        let loss = if is_jump { booked_loss } else { friction_loss(&self.system, &q0, &q1) };
        let [before_at_q0, before_at_q1] = [q0, q1].map(|q| before.energy(springs, &q));
        let [after_at_q0, after_at_q1] = [q0, q1].map(|q| self.held.energy(springs, &q));
        self.held.accept(springs, &q1);
        let gain = after_at_q1 - before_at_q0 + loss;
        let scale = loss + before_at_q0.max(before_at_q1).max(after_at_q0).max(after_at_q1) + f64::MIN_POSITIVE;

        let mut found = self.findings.borrow_mut();
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

/// Energy (J) of a spring that is deformed by nothing but rounding of its tip's place: k (1e-16 m)^2 is 1e-32 or less in all scenes but the stiffest, where
/// what moves is a million times that.
const ROUNDING: f64 = 1e-30;

/// Loss (J) along the constant twist from one pose to another, worked back from the poses.
fn friction_loss(system: &System, from: &Pose, to: &Pose) -> f64 {
    let turn = to.heading - from.heading;
    let shift = rotation(from.heading).tr_mul(&(to.position - from.position));
    let twist = (Arc::of(turn).mean_rotation().try_inverse().expect("less than a whole turn") * shift).push(turn);
    let supports = system.ground.supports.iter().zip(system.ground.slip_limits());
    supports.map(|(support, limit)| limit * slip_velocity(&support.offset, &twist).norm()).sum()
}

impl Backend for Audited {
    fn attach(&mut self, spring: usize, tip: Vec2) {
        self.held.attach(&self.system.springs, spring, tip, &self.inner.motion().pose);
        self.inner.attach(spring, tip);
        self.disturbed = true;
    }

    fn release(&mut self, spring: usize) {
        self.held.release(&self.system.springs, spring, &self.inner.motion().pose);
        self.inner.release(spring);
        self.disturbed = true;
    }

    fn advance(&mut self, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let mut report = StepReport::default();
        if self.disturbed {
            let mut here = tip_targets.to_vec();
            self.held.iter().for_each(|grip| here[grip.spring] = grip.tip);
            report.add(&self.step(&here, duration, true));
            self.disturbed = false;
        }
        report.add(&self.step(tip_targets, duration, false));
        report
    }

    fn motion(&self) -> Motion {
        self.inner.motion()
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.inner.tip(spring)
    }

    fn pull(&self, spring: usize) -> Vec2 {
        self.inner.pull(spring)
    }

    fn friction_forces(&self) -> Vec<Vec2> {
        self.inner.friction_forces()
    }

    fn energy(&self) -> EnergyLedger {
        self.inner.energy()
    }
}
