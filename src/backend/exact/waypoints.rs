//! Waypoints of obstacles, at which they change their velocity at once.
//!
//! Steps end there. A load that touches the obstacle then approaches it, or parts from it, at a
//! finite speed, and the law of impacts holds as for a touch.

use super::impacts::without_law;
use super::inertial::Inertial;
use super::load::{Exact, Method};
use crate::backend::contact::Touching;
use crate::backend::numerics::SAME_INSTANT;
use crate::backend::report::{ImpactLaw, StepReport};
use crate::backend::springs::TipPaths;
use crate::math::Vec2;

impl<M: Method> Exact<M> {
    /// Share of the paths up to which no obstacle changes its velocity after a share of them: at
    /// most the second one of these.
    pub(super) fn until_waypoint(&self, paths: &TipPaths, [from, to]: [f64; 2]) -> f64 {
        if self.obstacles.is_none() {
            return to;
        }
        let [start, end] = [from, to].map(|share| self.time_at(paths, share));
        let same = SAME_INSTANT * (end - start);
        let waypoint = self.system.world.next_corner(start + same);
        if waypoint < end - same { from + (waypoint - start) / paths.duration } else { to }
    }
}

impl Exact<Inertial> {
    /// Applies the law of impacts at the start of a part of the motion between two times (s), where
    /// an obstacle that the load touches has another velocity than in the part before.
    pub(super) fn meet_waypoint(&mut self, [from, to]: [f64; 2]) -> StepReport {
        let within = 0.5 * (from + to);
        let Some(before) = self.state.side.within.replace(within) else { return StepReport::default() };
        let turns = |touching: &Touching| {
            let path = &self.system.world.obstacles[touching.key.obstacle].path;
            path.moves() && path.twist_after(before) != path.twist_after(within)
        };
        if !self.state.side.touching.iter().any(turns) {
            return StepReport::default();
        }
        let pressed = self.pressed();
        let step = to - from;
        let limits = self.speed_limits(self.acceleration_by(&pressed) * step, [step, step]);
        if self.strike(&[], limits, from) == Some(ImpactLaw::None) { without_law() } else { StepReport::default() }
    }

    /// Contacts that press.
    pub(super) fn pressed(&self) -> Vec<Touching> {
        self.state.side.touching.iter().filter(|touching| touching.force.normal > 0.0).copied().collect()
    }

    /// Acceleration of the load's edge by the forces of these contacts, or more (m/s^2): what
    /// brings a load back that rebounds from them.
    fn acceleration_by(&self, touching: &[Touching]) -> f64 {
        let (load, centre) = (&self.system.load, self.state.motion.pose.position);
        let (mut force, mut torque) = (Vec2::zeros(), 0.0);
        for Touching { on_load: [of_contact, point], .. } in touching {
            force += of_contact;
            torque += (point - centre).perp(of_contact);
        }
        force.norm() / load.mass + load.radius * torque.abs() / load.inertia
    }
}
