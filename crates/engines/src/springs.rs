//! Forces of the springs on the load, by their law: an engine may ask for them in place of springs
//! of its own.

use std::sync::Mutex;

use cohaul::math::{Pose, Twist, Vec2, Wrench, perpendicular, rotation};
use cohaul::model::{PolarSpring, SpringShape, System};

use crate::protocol::{Ask, WrenchOnLoad};

/// The springs of a load with the tips that are attached.
pub struct Springs {
    system: System,
    held: Mutex<Vec<Option<Held>>>,
}

/// An attached tip in one advance, in which it moves straight from here to there.
#[derive(Clone, Copy, Debug)]
struct Held {
    /// (m, world)
    from: Vec2,
    to: Vec2,
    /// Velocity (m/s).
    velocity: Vec2,
    /// Swing of the spring at the start of the advance, with its whole turns (rad).
    swing: f64,
}

impl Springs {
    pub fn new(system: &System) -> Self {
        Self { held: Mutex::new(vec![None; system.springs.len()]), system: system.clone() }
    }

    /// Attaches the tip of a spring at `tip` (m) to a load at `pose`.
    pub fn attach(&self, spring: usize, tip: Vec2, pose: &Pose) {
        let swing = self.system.springs[spring].shape(pose, &tip, 0.0).swing;
        self.locked()[spring] = Some(Held { from: tip, to: tip, velocity: Vec2::zeros(), swing });
    }

    pub fn release(&self, spring: usize) {
        self.locked()[spring] = None;
    }

    /// Begins an advance of a `duration` (s) to these `targets` (m).
    pub fn set_out(&self, targets: &[Vec2], duration: f64) {
        for (held, target) in self.locked().iter_mut().zip(targets) {
            if let Some(held) = held {
                (held.to, held.velocity) = (*target, (target - held.from) / duration);
            }
        }
    }

    /// Ends the advance of a load that is at `pose` now.
    pub fn arrive(&self, pose: &Pose) {
        for (held, spring) in self.locked().iter_mut().zip(&self.system.springs) {
            if let Some(held) = held {
                *held = Held { from: held.to, swing: spring.shape(pose, &held.to, held.swing).swing, ..*held };
            }
        }
    }

    /// Tip of an attached spring at the start of the advance (m, world).
    pub fn tip(&self, spring: usize) -> Option<Vec2> {
        self.locked()[spring].map(|held| held.from)
    }

    /// Targets of the attached tips (m).
    pub fn targets(&self) -> Vec<Option<[f64; 2]>> {
        self.locked().iter().map(|held| held.map(|held| [held.to.x, held.to.y])).collect()
    }

    /// Pull on the tip of a spring (N, world), with that of its dashpot; zero if it is free. After
    /// an advance, the tip moves as in it.
    pub fn pull(&self, spring: usize, pose: &Pose, twist: &Twist) -> Vec2 {
        let Some(held) = self.locked()[spring] else { return Vec2::zeros() };
        let of = &self.system.springs[spring];
        self.pull_of(of, &of.shape(pose, &held.from, held.swing), (pose, twist), &held.velocity)
    }

    /// Elastic energy of the attached springs (J).
    pub fn energy(&self, pose: &Pose) -> f64 {
        let held = self.locked();
        let attached = held.iter().zip(&self.system.springs).filter_map(|(held, spring)| held.map(|held| (held, spring)));
        attached.map(|(held, spring)| spring.energy(&spring.shape(pose, &held.from, held.swing))).fold(0.0, |sum, energy| sum + energy)
    }

    /// Wrench of all attached springs on a load, after this `share` (1) of the advance.
    pub fn wrench(&self, pose: &Pose, twist: &Twist, share: f64) -> Wrench {
        let mut sum = Wrench { force: Vec2::zeros(), torque: 0.0 };
        for (held, spring) in self.locked().iter().zip(&self.system.springs) {
            let Some(held) = held else { continue };
            let tip = held.from + share * (held.to - held.from);
            let shape = spring.shape(pose, &tip, held.swing);
            let pull = self.pull_of(spring, &shape, (pose, twist), &held.velocity);
            sum.force += pull;
            // The spring has no inertia: the load feels the pull where the tip is.
            sum.torque += (tip - pose.position).perp(&pull);
        }
        sum
    }

    /// Answer to an engine that asks: force (N, N) and torque (N m).
    ///
    /// # Errors
    /// When it asks for what no load has, or what no advance has, in words.
    pub fn answer(&self, ask: &Ask) -> Result<WrenchOnLoad, String> {
        let Ask::Wrench { pose: [x, y, heading], twist: [u, v, turn_rate], share } = *ask;
        if !(0.0..=1.0).contains(&share) {
            return Err(format!("wrench: must have a share from 0 to 1, found {share}"));
        }
        let twist = Twist { linear: Vec2::new(u, v), angular: turn_rate };
        let wrench = self.wrench(&Pose::new(x, y, heading), &twist, share);
        let wrench = [wrench.force.x, wrench.force.y, wrench.torque];
        if wrench.iter().all(|entry| entry.is_finite()) {
            return Ok(WrenchOnLoad { wrench });
        }
        Err(format!("wrench: must have a pose and a twist with finite pulls, found {:?} and {:?}", [x, y, heading], [u, v, turn_rate]))
    }

    /// Pull of a spring of this shape on its tip (N, world), which moves at `tip_velocity` (m/s).
    fn pull_of(&self, spring: &PolarSpring, shape: &SpringShape, (pose, twist): (&Pose, &Twist), tip_velocity: &Vec2) -> Vec2 {
        let (radial, torsional) = self.system.dashpot(spring);
        let pull = spring.pull(pose, shape);
        if radial == 0.0 && torsional == 0.0 {
            return pull;
        }
        let turn = rotation(pose.heading + spring.bearing);
        let arm = turn * shape.tip_in_root + rotation(pose.heading) * spring.root;
        let velocity = turn.tr_mul(&(tip_velocity - twist.linear - twist.angular * perpendicular(&arm)));
        let damping = if spring.is_isotropic() {
            radial * velocity
        } else {
            let (length, along) = spring.polar_axis(shape);
            let across = perpendicular(&along);
            radial * along.dot(&velocity) * along + torsional / (length * length) * across.dot(&velocity) * across
        };
        pull + turn * damping
    }

    fn locked(&self) -> std::sync::MutexGuard<'_, Vec<Option<Held>>> {
        self.held.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::scenario::Scenario;

    /// The wrench is the negative gradient of the energy, and its power against the tip and the
    /// load that of the dashpots.
    #[test]
    fn the_wrench_is_that_of_the_springs_energy() {
        let mut scenario = Scenario::parse(include_str!("../../../scenarios/paper/four-ants-four-springs.json"), "ants").unwrap();
        let system = &mut scenario.system;
        for damping_ratio in [0.0, 0.4] {
            system.springs.iter_mut().for_each(|spring| spring.damping_ratio = damping_ratio);
            let springs = Springs::new(system);
            let pose = Pose::new(0.003, -0.002, 0.3);
            for (at, spring) in system.springs.iter().enumerate() {
                springs.attach(at, pose.to_world(&spring.rest_tip()) + Vec2::new(0.004, 0.001 * at as f64), &pose);
            }
            let twist = Twist { linear: Vec2::new(0.02, -0.01), angular: 0.7 };
            let still = springs.wrench(&pose, &Twist::ZERO, 0.0);
            let step = 1e-7;
            let slope = |moved: [Pose; 2]| (springs.energy(&moved[1]) - springs.energy(&moved[0])) / (2.0 * step);
            let by = |dx: f64, dy: f64, turn: f64| Pose::new(pose.position.x + dx, pose.position.y + dy, pose.heading + turn);
            let gradient = [
                slope([by(-step, 0.0, 0.0), by(step, 0.0, 0.0)]),
                slope([by(0.0, -step, 0.0), by(0.0, step, 0.0)]),
                slope([by(0.0, 0.0, -step), by(0.0, 0.0, step)]),
            ];
            // A difference quotient at this step has six digits.
            let found = [still.force.x, still.force.y, still.torque];
            let size = still.force.norm();
            assert!(found.iter().zip(gradient).all(|(wrench, slope)| (wrench + slope).abs() < 1e-6 * size), "{found:?} {gradient:?}");
            // What the dashpots add takes energy from the load, and nothing without them.
            let moving = springs.wrench(&pose, &twist, 0.0);
            let power = (moving.force - still.force).dot(&twist.linear) + (moving.torque - still.torque) * twist.angular;
            assert!(if damping_ratio > 0.0 { power < 0.0 } else { power == 0.0 }, "{power:e}");
        }
    }
}
