//! The held springs and their dashpots as a shadow feels them, by body twists from where it is.
//!
//! The shadow's springs are those of the load, with the same tips and on the same branches, evaluated side by side at another pose. A shadow at rest, as it
//! mostly is, asks for no more than their gradient.

use super::shadow::Tick;
use crate::backend::increment::in_body_increments;
use crate::backend::springs::Attachments;
use crate::backend::springs::{Place, SpringBlocks};
use crate::math::{Mat3, Vec3};
use crate::model::{Reaction, System};

/// With the tips at the end of a tick.
pub struct Pulls {
    pub elastic: Reaction,
    /// Of the dashpots; `None` where there are none.
    pub dashpots: Option<Dashpots>,
}

pub struct Dashpots {
    /// C (N s/m, N s, N m s/rad).
    pub damping: Mat3,
    /// Of the moving tips on a load at rest (N, N, N m).
    pub drag: Vec3,
}

/// The held springs at hand. All of it follows from which are held, where, and on which branches.
#[derive(Clone, Debug)]
pub struct Attached {
    blocks: SpringBlocks,
    /// Springs were grasped or let go, or branches looked at, since they were gathered.
    is_stale: bool,
    /// Sum of the radial stiffnesses (N/m).
    radial: f64,
    /// Whether the system has dashpots.
    is_damped: bool,
}

impl Attached {
    pub fn new(system: &System) -> Self {
        let is_damped = system.springs.iter().any(|spring| spring.damping_ratio != 0.0);
        Self { blocks: SpringBlocks::default(), is_stale: true, radial: 0.0, is_damped }
    }

    /// To be called when other springs are held, or on other branches.
    pub fn change(&mut self) {
        self.is_stale = true;
    }

    pub fn is_damped(&self) -> bool {
        self.is_damped
    }

    /// Sum of the radial stiffnesses of the springs that pulled last (N/m).
    pub fn radial(&self) -> f64 {
        self.radial
    }

    /// On a shadow at a place.
    pub fn pulls(&mut self, system: &System, tick: &Tick, at: &Place) -> Pulls {
        self.place_tips(system, tick, 1.0);
        Pulls { elastic: by_increments(self.blocks.reaction(at)), dashpots: self.is_damped.then(|| dashpots(system, tick, at)) }
    }

    /// Gradient of the springs' energy alone, with the tips at a `share` of their ways (N, N, N m).
    pub fn gradient(&mut self, system: &System, tick: &Tick, at: &Place, share: f64) -> Vec3 {
        self.place_tips(system, tick, share);
        self.blocks.gradient(at)
    }

    /// Pull of the moving tips through the dashpots on a load at rest (N, N, N m).
    pub fn drag(&self, system: &System, tick: &Tick, at: &Place) -> Vec3 {
        if self.is_damped { dashpots(system, tick, at).drag } else { Vec3::zeros() }
    }

    fn place_tips(&mut self, system: &System, tick: &Tick, share: f64) {
        self.gather(system, tick.held);
        self.blocks.place_tips(tick.held, tick.targets, share);
    }

    fn gather(&mut self, system: &System, held: &Attachments) {
        if std::mem::take(&mut self.is_stale) {
            self.blocks.gather(&system.springs, held);
            self.blocks.aim();
            self.radial = held.iter().map(|grip| system.springs[grip.spring].radial_stiffness).sum();
        }
    }
}

/// A dashpot is a spring of stiffness c / t about its shape at the start of the tick.
fn dashpots(system: &System, tick: &Tick, at: &Place) -> Dashpots {
    let mut sum = Reaction::ZERO;
    for grip in tick.held.iter() {
        let spring = &system.springs[grip.spring];
        if spring.damping_ratio > 0.0 {
            let (radial, torsional) = system.dashpot(spring);
            let shape = grip.shape(&system.springs, &at.pose);
            let dashpot = spring.about(&shape, radial / tick.duration, torsional / tick.duration);
            sum.add(&dashpot.reaction(&at.pose, &dashpot.shape(&at.pose, &tick.targets[grip.spring], 0.0)));
        }
    }
    let sum = in_body_increments(&sum, &at.turn);
    Dashpots { damping: tick.duration * sum.hessian, drag: -sum.gradient }
}

/// Derivatives by shifts along the load's axes and by its turn, turned into derivatives by a body-twist increment from there: its shifts turn on the way, on
/// average by half its turn.
fn by_increments(mut local: Reaction) -> Reaction {
    let half = 0.5 * local.gradient;
    let (x, y) = (local.hessian.m13 + half.y, local.hessian.m23 - half.x);
    (local.hessian.m13, local.hessian.m31, local.hessian.m23, local.hessian.m32) = (x, x, y, y);
    local
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Pose, Vec2, direction, rotation};
    use crate::scenario::Scenario;

    /// Block by block it is what the springs say one by one, on the branch that the grips have and no other.
    #[test]
    fn a_shadow_feels_the_springs_of_the_load_on_their_branches() {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/paper/four-ants-four-springs.json");
        let system = Scenario::read(scene.as_ref()).unwrap().system;
        let (still, pose) = (Pose::new(0.0, 0.0, 0.0), Pose::new(0.01, -0.004, 0.3));
        let mut held = Attachments::default();
        for (i, spring) in system.springs.iter().enumerate() {
            held.attach(&system.springs, i, spring.rest_tip(), &still);
        }
        let about = |angle: f64| -> Vec<Vec2> {
            system.springs.iter().map(|spring| spring.root + 0.024 * direction(spring.bearing + angle)).collect()
        };
        for step in 1..=30 {
            held.move_tips(&about(0.2 * f64::from(step)));
            held.accept(&system.springs, &still);
        }
        let targets = about(6.1);
        let mut attached = Attached::new(&system);
        let tick = Tick { before: &still, after: &still, held: &held, targets: &targets, is_event: false, duration: 0.01 };
        let found = attached.pulls(&system, &tick, &Place::of(&pose)).elastic;
        let before = attached.gradient(&system, &tick, &Place::of(&pose), 0.0);
        let after = attached.gradient(&system, &tick, &Place::of(&pose), 1.0);
        let by_one = |held: &Attachments| in_body_increments(&held.reaction(&system.springs, &pose), &rotation(pose.heading));
        // Roundings of torques of 4.5e-4 N m/rad times 6 rad, four of them, and of stiffnesses of a few N/m.
        assert!((before - by_one(&held).gradient).amax() < 1e-16 && before.norm() > 1e-3, "{before}");
        held.move_tips(&targets);
        let expected = by_one(&held);
        assert!((found.gradient - expected.gradient).amax() < 1e-16, "{found:?} {expected:?}");
        assert!((after - expected.gradient).amax() < 1e-16, "{after} {expected:?}");
        assert!((found.hessian - expected.hessian).amax() < 1e-14, "{found:?} {expected:?}");
    }
}
