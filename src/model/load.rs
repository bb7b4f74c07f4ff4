//! The load, and the whole mechanism a backend moves: load, ground and springs.

use super::{Ground, PolarSpring, SpringLaw, World};
use crate::math::Twist;

/// A rigid body in the plane. The origin of its frame is its centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Mass (kg).
    pub mass: f64,
    /// Moment of inertia about the origin (kg m^2).
    pub inertia: f64,
    /// Largest distance of the outline from the origin (m), the radius of a disc. It is the measure
    /// of displacements.
    pub radius: f64,
}

impl Load {
    /// Kinetic energy (J).
    pub fn kinetic_energy(&self, twist: &Twist) -> f64 {
        0.5 * self.mass * twist.linear.norm_squared() + 0.5 * self.inertia * twist.angular * twist.angular
    }
}

/// The mechanism that a backend moves: load, ground, springs and obstacles. Nothing in it changes
/// during a run.
#[derive(Clone, Debug, PartialEq)]
pub struct System {
    /// The load.
    pub load: Load,
    /// Friction and supports.
    pub ground: Ground,
    /// Springs of the load. A spring is named by its index.
    pub springs: Vec<PolarSpring>,
    /// Outline of the load and obstacles.
    pub world: World,
}

impl System {
    /// Sum of the slip limits, mu m g on level ground (N).
    pub fn total_slip_limit(&self) -> f64 {
        self.ground.slip_limits().sum()
    }

    /// Deceleration of a load that slides without turning, mu g on level ground (m/s^2).
    pub fn braking(&self) -> f64 {
        self.total_slip_limit() / self.load.mass
    }

    /// Largest torque of friction about the origin (N m): that of a load which turns about it.
    pub fn total_slip_torque(&self) -> f64 {
        self.ground.slip_limits().zip(&self.ground.supports).map(|(limit, support)| limit * support.offset.norm()).sum()
    }

    /// Estimate of the fastest oscillation of the load on all its springs at rest, in translation
    /// or turning; zero without springs (rad/s). It bounds either motion alone. With springs on one
    /// side of the load's origin the motions couple, and the rate may be higher by a factor of
    /// sqrt(2) at most.
    pub fn fastest_rate(&self) -> f64 {
        self.fastest_rate_on(self.springs.iter())
    }

    /// [`System::fastest_rate`] on some of the springs (rad/s).
    pub fn fastest_rate_on<'a>(&self, springs: impl Iterator<Item = &'a PolarSpring>) -> f64 {
        let (mut linear, mut angular) = (0.0, 0.0);
        for spring in springs {
            let stiffness = spring.largest_stiffness();
            linear += stiffness;
            angular += stiffness * spring.rest_tip().norm_squared();
        }
        (linear / self.load.mass).max(angular / self.load.inertia).sqrt()
    }

    /// Multiplies mass and moment of inertia by a `factor` (1) and nothing else: normal loads and
    /// dashpots stay. A damping ratio is one of the mass, and falls with its square root.
    pub fn scale_inertia(&mut self, factor: f64) {
        self.load.mass *= factor;
        self.load.inertia *= factor;
        self.springs.iter_mut().for_each(|spring| spring.damping_ratio /= factor.sqrt());
    }

    /// Radial and torsional dashpot coefficient of a spring on this load: stiffness times 2 zeta /
    /// omega_n with omega_n = sqrt(radial stiffness / mass). The dashpot of an isotropic spring
    /// resists every direction alike (N s/m, N m s/rad). A rope has none.
    pub fn dashpot(&self, spring: &PolarSpring) -> (f64, f64) {
        if spring.damping_ratio == 0.0 || spring.radial_stiffness == 0.0 || spring.law == SpringLaw::Rope {
            return (0.0, 0.0);
        }
        let time = 2.0 * spring.damping_ratio * (self.load.mass / spring.radial_stiffness).sqrt();
        (time * spring.radial_stiffness, time * spring.torsional_stiffness)
    }
}
