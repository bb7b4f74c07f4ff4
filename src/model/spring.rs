//! The polar spring (Eq. 8-10) as an energy, with gradient and Hessian by the load's pose.
//!
//! The root R is fixed to the load, and the undeformed spring points along `bearing` in the load's
//! frame. With Q the rotation by heading + bearing, the tip seen from the root is `d = Q^T (p - x)
//! - a`, where `a` is the root in axes turned by the bearing. In polar form d = (length, swing) and
//!
//! ```text
//! U = 1/2 k_r (l - l_0)^2 + 1/2 k_t psi^2          f = dU/dd = k_r (l - l_0) e_r + (k_t psi / l) e_t
//! H_d = k_r e_r e_r' + (k_r (1 - l_0 / l) + k_t / l^2) e_t e_t' - (k_t psi / l^2) (e_r e_t' + e_t e_r')
//! dd/dx = -Q^T,  dd/dtheta = -J (d + a)            with J a quarter turn
//! ```
//!
//! The second derivative of the force by the tip along a unit vector u, at an angle from e_r, is
//!
//! ```text
//! (A sin^2 + B sin 2) e_r + (B cos 2 + A sin 2) e_t,   at most (2 / sqrt 3) |A| + |B|
//! A = (k_r l_0 - 2 k_t / l) / l^2,   B = 2 k_t psi / l^3
//! ```
//!
//! Deviation: Eq. (8) sets the tip frame to the world's orientation, so that an undeformed spring
//! beside the load would carry 27 mN. The swing here is the polar angle of the tip in the root's
//! frame.
//!
//! Deviation: Eq. (16) pairs a body twist with a wrench about the root, which counts the couple
//! twice. Forces here are derivatives of one energy, so power and energy agree.
//!
//! Eq. (10) is the force on the tip; the load gets its opposite.
//!
//! A rope is such a spring without torsion that pulls only: while it is shorter than l_0, its
//! energy and all derivatives are zero. [`SpringLaw::least_stretch`] is all that says so, here and,
//! lane by lane, in the block of springs of the exact backends.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::math::{Mat2, Mat3, Pose, Vec2, Vec3, direction, perpendicular, rotation, unwrap_near};

/// Law of a spring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpringLaw {
    /// It pulls and pushes (Eq. 8-10).
    #[default]
    Polar,
    /// It pulls where it is longer than its rest length, and is slack elsewhere. It has neither
    /// torsional stiffness nor damping.
    Rope,
}

impl SpringLaw {
    /// Least stretch that a force answers to (m); below it the spring is slack.
    pub fn least_stretch(self) -> f64 {
        match self {
            Self::Polar => f64::NEG_INFINITY,
            Self::Rope => 0.0,
        }
    }
}

/// One spring of the load. Nothing in it changes during a run. The default is the base of others:
/// it has no length, no stiffness and no damping.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolarSpring {
    /// Root in the load's frame (m).
    pub root: Vec2,
    /// Direction of the undeformed spring in the load's frame (rad).
    pub bearing: f64,
    /// Length without force (m). A spring without rest length and torsional stiffness is isotropic.
    pub rest_length: f64,
    /// Stiffness against change of length (N/m).
    pub radial_stiffness: f64,
    /// Stiffness against swing about the root (N m/rad).
    pub torsional_stiffness: f64,
    /// Damping over critical damping of the load's mass on this spring (1).
    pub damping_ratio: f64,
    pub law: SpringLaw,
}

/// Tip of an attached spring in the frame of its root. Where a spring has a direction, its law is
/// the same in all axes: with a tip in axes turned otherwise, pull and stiffness are in these axes
/// too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringShape {
    /// Tip from root in the frame turned by the bearing (m).
    pub tip_in_root: Vec2,
    /// Distance from root to tip (m).
    pub length: f64,
    /// Polar angle of the tip in that frame, continued over whole turns (rad).
    pub swing: f64,
}

impl SpringShape {
    /// Shape of a spring that goes on from here by this `weight` of its change since `before`.
    pub fn going_on(&self, before: &Self, weight: f64) -> Self {
        Self {
            tip_in_root: self.tip_in_root + weight * (self.tip_in_root - before.tip_in_root),
            length: self.length + weight * (self.length - before.length),
            swing: self.swing + weight * (self.swing - before.swing),
        }
    }
}

/// Energy of attached springs at one pose of the load, with its derivatives by the pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction {
    /// Elastic energy (J).
    pub energy: f64,
    /// Derivative of the energy by (x, y, heading) in world axes: minus the wrench on the load (N,
    /// N, N m).
    pub gradient: Vec3,
    /// Second derivative by (x, y, heading) (N/m, N, N m/rad).
    pub hessian: Mat3,
}

impl Reaction {
    /// Reaction of no spring.
    pub const ZERO: Reaction =
        Reaction { energy: 0.0, gradient: Vec3::new(0.0, 0.0, 0.0), hessian: Mat3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0) };

    /// Adds the reaction of other springs.
    pub fn add(&mut self, other: &Reaction) {
        self.energy += other.energy;
        self.gradient += other.gradient;
        self.hessian += other.hessian;
    }

    /// This reaction with derivatives by shifts along axes that `turn` rotates to world axes.
    pub fn in_axes(&self, turn: &Mat2) -> Reaction {
        let gradient = turn.tr_mul(&self.gradient.xy());
        let linear = turn.tr_mul(&self.hessian.fixed_view::<2, 2>(0, 0).into_owned()) * turn;
        let mixed = turn.tr_mul(&Vec2::new(self.hessian.m13, self.hessian.m23));
        let hessian = Mat3::new(linear.m11, linear.m12, mixed.x, linear.m21, linear.m22, mixed.y, mixed.x, mixed.y, self.hessian.m33);
        Reaction { energy: self.energy, gradient: gradient.push(self.gradient.z), hessian }
    }
}

/// Shortest length of a spring over its rest length (1). Below it the direction of the spring has
/// no physical meaning, and the polar law is continued with the tip at this distance, so that
/// forces stay finite.
pub const SHORTEST_LENGTH: f64 = 1e-6;

impl PolarSpring {
    /// Whether the law is linear in the position of the tip, without a preferred direction: that is
    /// so without rest length and torsional stiffness.
    pub fn is_isotropic(&self) -> bool {
        self.rest_length == 0.0 && self.torsional_stiffness == 0.0
    }

    /// Stiffness against a displacement of the tip from rest, along or across the spring, whichever
    /// is larger (N/m).
    pub fn largest_stiffness(&self) -> f64 {
        let across = if self.torsional_stiffness == 0.0 { 0.0 } else { self.torsional_stiffness / self.rest_length.powi(2) };
        self.radial_stiffness.max(across)
    }

    /// Stiffness or damping along and across a spring of this length (m), from its radial and
    /// torsional coefficient (N/m, N m/rad; N s/m, N m s/rad).
    pub fn along_and_across(&self, length: f64, (radial, torsional): (f64, f64)) -> [f64; 2] {
        if self.is_isotropic() {
            return [radial, radial];
        }
        let length = length.max(SHORTEST_LENGTH * self.rest_length).max(f64::MIN_POSITIVE);
        let square = 1.0 / length / length;
        [radial, torsional * square]
    }

    /// Change of length from rest that the force answers to, at this length (m).
    fn stretch(&self, length: f64) -> f64 {
        (length - self.rest_length).max(self.law.least_stretch())
    }

    /// Whether the spring has no force at this length (m) and near it.
    pub fn is_slack(&self, length: f64) -> bool {
        length - self.rest_length < self.law.least_stretch()
    }

    /// Stiffness against change of length and against swing at this length (N/m, N m/rad).
    pub fn stiffness_at(&self, length: f64) -> (f64, f64) {
        if self.is_slack(length) { (0.0, 0.0) } else { (self.radial_stiffness, self.torsional_stiffness) }
    }

    /// Pull along the spring at this length (N).
    pub fn radial_pull(&self, length: f64) -> f64 {
        self.radial_stiffness * self.stretch(length)
    }

    /// Entries of H_d at this length (m), which is positive, and swing (rad): along the spring,
    /// across it, and between the two (N/m).
    pub fn polar_stiffness(&self, length: f64, swing: f64) -> [f64; 3] {
        if self.is_slack(length) {
            return [0.0; 3];
        }
        let torsion = self.torsional_stiffness / (length * length);
        let across = self.radial_stiffness * (1.0 - self.rest_length / length) + torsion;
        [self.radial_stiffness, across, -(torsion * swing)]
    }

    /// Bound of the second derivative of the pull by the tip, at lengths of `shortest` (m) or more
    /// and swings of at most `swing` (rad) (N/m^2). It is infinite where the stiffness jumps, as
    /// that of a rope does at its rest length.
    pub fn largest_curvature(&self, shortest: f64, swing: f64) -> f64 {
        if self.is_slack(shortest) {
            return f64::INFINITY;
        }
        let torsional = self.torsional_stiffness;
        let largest_a = (self.radial_stiffness * self.rest_length).max(2.0 * torsional / shortest) / (shortest * shortest);
        let largest_b = 2.0 * torsional * swing / (shortest * shortest * shortest);
        // 2 / sqrt 3, rounded up.
        1.155 * largest_a + largest_b
    }

    /// A spring with the same root and these stiffnesses (N/m, N m/rad) that is undeformed in
    /// `shape`.
    pub fn about(&self, shape: &SpringShape, radial_stiffness: f64, torsional_stiffness: f64) -> PolarSpring {
        let softened = PolarSpring { radial_stiffness, torsional_stiffness, damping_ratio: 0.0, law: SpringLaw::Polar, ..*self };
        if self.is_isotropic() {
            PolarSpring { root: self.root + rotation(self.bearing) * shape.tip_in_root, ..softened }
        } else {
            PolarSpring { bearing: self.bearing + shape.swing, rest_length: shape.length, ..softened }
        }
    }

    /// Tip of the undeformed spring in the load's frame (m).
    pub fn rest_tip(&self) -> Vec2 {
        self.root + self.rest_length * direction(self.bearing)
    }

    /// Shape of the spring between the load at `pose` and `tip` (m, world), on the branch of the
    /// swing nearest to `swing_near`.
    pub fn shape(&self, pose: &Pose, tip: &Vec2, swing_near: f64) -> SpringShape {
        let tip_in_root = rotation(pose.heading + self.bearing).tr_mul(&(tip - pose.position)) - self.root_in_bearing();
        let length = tip_in_root.norm();
        let swing = if length > 0.0 { unwrap_near(tip_in_root.y.atan2(tip_in_root.x), swing_near) } else { swing_near };
        SpringShape { tip_in_root, length, swing }
    }

    /// Elastic energy (J).
    pub fn energy(&self, shape: &SpringShape) -> f64 {
        let stretch = self.stretch(shape.length);
        0.5 * self.radial_stiffness * stretch * stretch + 0.5 * self.torsional_stiffness * shape.swing * shape.swing
    }

    /// Force dU/dd on the load at the tip, in the frame turned by the bearing (N). The ant pulls
    /// the tip with the same force. Eq. (10) is its opposite.
    pub fn pull_in_root(&self, shape: &SpringShape) -> Vec2 {
        if self.is_isotropic() {
            return self.radial_stiffness * shape.tip_in_root;
        }
        let (length, radial) = self.polar_axis(shape);
        let torsional = self.torsional_stiffness * shape.swing / length;
        self.radial_pull(length) * radial + torsional * perpendicular(&radial)
    }

    /// Force of the ant or robot on the tip (N, world axes): dU/d(tip), the negative of Eq. (10).
    pub fn pull(&self, pose: &Pose, shape: &SpringShape) -> Vec2 {
        rotation(pose.heading + self.bearing) * self.pull_in_root(shape)
    }

    /// Energy with its first and second derivatives by the pose of the load, for a tip at rest.
    pub fn reaction(&self, pose: &Pose, shape: &SpringShape) -> Reaction {
        let turn = rotation(pose.heading + self.bearing);
        let pull = self.pull_in_root(shape);
        let arm = shape.tip_in_root + self.root_in_bearing();
        let by_heading = -perpendicular(&arm);
        let stiffness = self.stiffness_in_root(shape);

        let force = turn * pull;
        let mixed = -(turn * (perpendicular(&pull) + stiffness * by_heading));
        let linear = turn * stiffness * turn.transpose();
        let angular = by_heading.dot(&(stiffness * by_heading)) - pull.dot(&arm);
        Reaction {
            energy: self.energy(shape),
            gradient: Vec3::new(-force.x, -force.y, pull.dot(&by_heading)),
            hessian: Mat3::new(
                linear.m11, linear.m12, mixed.x, //
                linear.m21, linear.m22, mixed.y, //
                mixed.x, mixed.y, angular,
            ),
        }
    }

    /// H_d: second derivative of the energy by the tip's position in the frame turned by the
    /// bearing (N/m).
    pub fn stiffness_in_root(&self, shape: &SpringShape) -> Mat2 {
        if self.is_isotropic() {
            return Mat2::from_diagonal_element(self.radial_stiffness);
        }
        let (length, radial) = self.polar_axis(shape);
        let tangential = perpendicular(&radial);
        let [along, across, between] = self.polar_stiffness(length, shape.swing);
        let mixed = radial * tangential.transpose();
        along * radial * radial.transpose() + across * tangential * tangential.transpose() + between * (mixed + mixed.transpose())
    }

    /// Length, kept away from zero (m), and unit vector from root to tip.
    pub fn polar_axis(&self, shape: &SpringShape) -> (f64, Vec2) {
        let shortest = SHORTEST_LENGTH * self.rest_length;
        if shape.length > shortest {
            (shape.length, shape.tip_in_root / shape.length)
        } else {
            (shortest.max(f64::MIN_POSITIVE), direction(shape.swing))
        }
    }

    fn root_in_bearing(&self) -> Vec2 {
        rotation(self.bearing).tr_mul(&self.root)
    }
}
