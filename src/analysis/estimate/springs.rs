//! Attached springs and dashpots on the reduced model, by body twists from where it is.
//!
//! The model has the springs of the load, with the same tips and on the same branches, evaluated at
//! its own pose. A model at rest needs only their gradient.

use super::interval::Interval;
use crate::backend::increment::in_body_increments;
use crate::backend::springs::{Place, SpringBlocks};
use crate::math::{Mat3, Vec3};
use crate::model::{Reaction, System};

/// Forces and stiffness with the tips at the end of an interval.
pub struct SpringForces {
    pub elastic: Reaction,
    /// `None` without dashpots.
    pub dashpots: Option<Dashpots>,
}

pub struct Dashpots {
    /// Damping matrix (N s/m, N s, N m s/rad).
    pub damping: Mat3,
    /// Wrench of the moving tips on a load at rest (N, N, N m).
    pub drag: Vec3,
}

/// Attached springs, ready for evaluation. Everything here follows from the attachments.
#[derive(Clone, Debug)]
pub struct ModelSprings {
    blocks: SpringBlocks,
    /// Whether attachments or branches changed since the blocks were filled.
    is_stale: bool,
    /// Sum of the radial stiffnesses of the attached springs (N/m).
    pub radial: f64,
    pub is_damped: bool,
}

impl ModelSprings {
    pub fn new(system: &System) -> Self {
        let is_damped = system.springs.iter().any(|spring| spring.damping_ratio != 0.0);
        Self { blocks: SpringBlocks::default(), is_stale: true, radial: 0.0, is_damped }
    }

    /// Must be called when attachments or branches change.
    pub fn change(&mut self) {
        self.is_stale = true;
    }

    pub fn forces(&mut self, system: &System, interval: &Interval, at: &Place) -> SpringForces {
        self.place_tips(system, interval, 1.0);
        SpringForces { elastic: by_increments(self.blocks.reaction(at)), dashpots: self.is_damped.then(|| dashpots(system, interval, at)) }
    }

    /// Gradient of the springs' energy with the tips at a `share` (1) of their displacement in the
    /// interval (N, N, N m).
    pub fn gradient(&mut self, system: &System, interval: &Interval, at: &Place, share: f64) -> Vec3 {
        self.place_tips(system, interval, share);
        self.blocks.gradient(at)
    }

    /// Wrench of the moving tips through the dashpots on a load at rest (N, N, N m).
    pub fn drag(&self, system: &System, interval: &Interval, at: &Place) -> Vec3 {
        if self.is_damped { dashpots(system, interval, at).drag } else { Vec3::zeros() }
    }

    fn place_tips(&mut self, system: &System, interval: &Interval, share: f64) {
        let attachments = interval.attachments;
        if std::mem::take(&mut self.is_stale) {
            self.blocks.fill(&system.springs, attachments);
            self.blocks.aim();
            self.radial = attachments.iter().map(|attachment| system.springs[attachment.spring].radial_stiffness).sum();
        }
        self.blocks.place_tips(attachments, interval.targets, share);
    }
}

/// A dashpot is a spring of stiffness c / t about its shape at the start of the interval.
fn dashpots(system: &System, interval: &Interval, at: &Place) -> Dashpots {
    let mut sum = Reaction::ZERO;
    for attachment in interval.attachments.iter() {
        let spring = &system.springs[attachment.spring];
        if spring.damping_ratio > 0.0 {
            let (radial, torsional) = system.dashpot(spring);
            let shape = attachment.shape(&system.springs, &at.pose);
            let dashpot = spring.about(&shape, radial / interval.duration, torsional / interval.duration);
            sum.add(&dashpot.reaction(&at.pose, &dashpot.shape(&at.pose, &interval.targets[attachment.spring], 0.0)));
        }
    }
    let sum = in_body_increments(&sum, &at.turn);
    Dashpots { damping: interval.duration * sum.hessian, drag: -sum.gradient }
}

/// Converts derivatives by shifts along the load's axes and by its turn into derivatives by a
/// body-twist increment. Its shifts turn by half its turn on average.
fn by_increments(mut local: Reaction) -> Reaction {
    let half = 0.5 * local.gradient;
    let (x, y) = (local.hessian.m13 + half.y, local.hessian.m23 - half.x);
    (local.hessian.m13, local.hessian.m31, local.hessian.m23, local.hessian.m32) = (x, x, y, y);
    local
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::springs::Attachments;
    use crate::math::{Pose, Vec2, direction, rotation};
    use crate::scenario::Scenario;

    /// All springs together give the sum of single springs on the same branches.
    #[test]
    fn the_model_has_the_springs_of_the_load_on_their_branches() {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/paper/four-ants-four-springs.json");
        let system = Scenario::read(scene.as_ref()).unwrap().system;
        let (still, pose) = (Pose::new(0.0, 0.0, 0.0), Pose::new(0.01, -0.004, 0.3));
        let mut attachments = Attachments::default();
        for (i, spring) in system.springs.iter().enumerate() {
            attachments.attach(&system.springs, i, spring.rest_tip(), &still);
        }
        let about = |angle: f64| -> Vec<Vec2> {
            system.springs.iter().map(|spring| spring.root + 0.024 * direction(spring.bearing + angle)).collect()
        };
        for step in 1..=30 {
            attachments.move_tips(&about(0.2 * f64::from(step)));
            attachments.accept(&system.springs, &still);
        }
        let targets = about(6.1);
        let mut springs = ModelSprings::new(&system);
        let interval =
            Interval { before: &still, after: &still, attachments: &attachments, targets: &targets, is_event: false, duration: 0.01 };
        let found = springs.forces(&system, &interval, &Place::of(&pose)).elastic;
        let before = springs.gradient(&system, &interval, &Place::of(&pose), 0.0);
        let after = springs.gradient(&system, &interval, &Place::of(&pose), 1.0);
        let by_one = |attachments: &Attachments| in_body_increments(&attachments.reaction(&system.springs, &pose), &rotation(pose.heading));
        // Rounding of torques of 4.5e-4 N m/rad times 6 rad, four times, and of stiffnesses of a
        // few N/m.
        assert!((before - by_one(&attachments).gradient).amax() < 1e-16 && before.norm() > 1e-3, "{before}");
        attachments.move_tips(&targets);
        let expected = by_one(&attachments);
        assert!((found.gradient - expected.gradient).amax() < 1e-16, "{found:?} {expected:?}");
        assert!((after - expected.gradient).amax() < 1e-16, "{after} {expected:?}");
        assert!((found.hessian - expected.hessian).amax() < 1e-14, "{found:?} {expected:?}");
    }
}
