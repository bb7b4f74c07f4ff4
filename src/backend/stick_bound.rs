//! How far the held tips may go before a load at rest can begin to slip.
//!
//! Friction forces f_i that balance the wrench w with room to spare also balance any wrench near it: with the least change in units of the limits, each f_i
//! changes by at most `c_i^2 |B_i M|` times the change of w, M as in the certificate of rest. As long as the load stands, w depends on nothing but where the tips
//! are, and a tip that is within a ball about its place now changes w by at most a Lipschitz constant times its distance:
//!
//! ```text
//! |dF/dp| <= K = max(k_r, |k_r (1 - l_0 / l)| + k_t / l^2) + k_t |psi| / l^2        |d tau/dp| <= |F| + |arm| K
//! ```
//!
//! each at its largest in the ball. Straight ways between two places of the ball stay in it.

use serde::{Deserialize, Serialize};

use super::friction::FrictionSolver;
use super::held::{Grip, HeldSprings};
use crate::math::{Pose, Vec2};
use crate::model::PolarSpring;

/// Radius of the ball over the length of the spring (1): the law changes little in it.
const BALL: f64 = 0.125;
/// What the direction of a spring can change by in it (rad): arcsin(1/8), rounded up.
const LARGEST_TURN: f64 = 0.1254;
/// Left for rounding, of the room there is (1).
const MARGIN: f64 = 1e-9;

/// A certificate of rest for tips near the ones that it was made for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StickBound {
    /// Change of the wrench that friction surely takes (scaled).
    room: f64,
    /// One a grip, in their order.
    balls: Vec<Ball>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Ball {
    spring: usize,
    /// (m, world)
    centre: Vec2,
    /// (m)
    radius: f64,
    /// Change of the wrench by the tip's way (scaled, 1/m).
    slope: f64,
}

impl StickBound {
    /// Takes the rest of a load at `pose` that `solver` has just found for the tips of `held`.
    pub fn renew(&mut self, springs: &[PolarSpring], held: &HeldSprings, pose: &Pose, solver: &FrictionSolver) {
        self.balls.clear();
        self.room = (1.0 - MARGIN) * solver.stick_room();
        if self.room > 0.0 {
            self.balls.extend(held.grips().iter().map(|grip| Ball::about(grip, springs, pose, solver)));
        }
    }

    pub fn forget(&mut self) {
        self.room = 0.0;
    }

    /// The share of the tips' straight way from where they are to their entries of `targets` (m, world), at most one, on which the load surely sticks.
    pub fn share(&self, held: &HeldSprings, targets: &[Vec2]) -> f64 {
        if self.room <= 0.0 {
            return 0.0;
        }
        let (mut start, mut way, mut share) = (0.0, 0.0, 1.0_f64);
        for (ball, grip) in self.balls.iter().zip(held.grips()) {
            let at = (grip.tip - ball.centre).norm();
            let goes = (targets[ball.spring] - grip.tip).norm();
            start += ball.slope * at;
            way += ball.slope * goes;
            if at + goes > ball.radius {
                share = share.min((ball.radius - at) / goes);
            }
        }
        if start + way > self.room {
            share = share.min((self.room - start) / way);
        }
        share.max(0.0)
    }
}

impl Ball {
    fn about(grip: &Grip, springs: &[PolarSpring], pose: &Pose, solver: &FrictionSolver) -> Self {
        let spring = &springs[grip.spring];
        let shape = grip.shape(springs, pose);
        let (radial, torsional) = (spring.radial_stiffness, spring.torsional_stiffness);
        let arm = (grip.tip - pose.position).norm();
        let (radius, stiffness) = if spring.is_isotropic() {
            (arm.max(spring.root.norm()), radial)
        } else {
            let radius = BALL * shape.length;
            let (shortest, longest) = (shape.length - radius, shape.length + radius);
            let across = radial * (1.0 - spring.rest_length / shortest).abs().max((1.0 - spring.rest_length / longest).abs());
            let torsion = torsional / (shortest * shortest);
            (radius, radial.max(across + torsion) + torsion * (shape.swing.abs() + LARGEST_TURN))
        };
        let force = spring.force_on_tip(pose, &shape).norm() + stiffness * radius;
        let slope = solver.scaled_wrench(stiffness, force + (arm + radius) * stiffness);
        Self { spring: grip.spring, centre: grip.tip, radius, slope }
    }
}
