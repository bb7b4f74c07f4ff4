//! The spring law lane by lane.

use super::attachments::Attachment;
use super::place::Place;
use crate::math::{LANES, Mat3, Numbers, SMALL_TANGENT, Vec2, Vec3, Vectors, direction, small_arctangent};
use crate::model::spring::SHORTEST_LENGTH;
use crate::model::{PolarSpring, Reaction};

/// Where swings come from.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Swings {
    /// Computed from the tips.
    Found,
    /// Taken from the attachments.
    Given,
}

/// A few springs, one a lane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block {
    root: Vectors,
    /// Unit vector along the undeformed spring (load axes).
    bearing: Vectors,
    rest_length: Numbers,
    /// Least stretch that a force answers to (m).
    least_stretch: Numbers,
    /// Length at and below which a spring has no direction (m). It is negative in lanes beyond the
    /// last spring.
    shortest: Numbers,
    radial: Numbers,
    torsional: Numbers,
    /// Tip now (m, world).
    pub tip: Vectors,
    /// Swing at the accepted pose (rad), and its whole turns.
    pub swing: Numbers,
    turns: Numbers,
    /// Tip (m, world) and the pull on it (N, world) at the accepted pose.
    pub accepted_tip: Vectors,
    pub accepted_pull: Vectors,
    /// Unit vector from root to tip at the accepted pose (load axes).
    accepted_direction: Vectors,
    /// Squared product of the change of the pulls and the displacement of the tips, from the
    /// accepted pose before to this one (J^2).
    squared_error: Numbers,
    /// Whether a pose was evaluated far from the accepted swing since it was accepted.
    pub is_far: bool,
    /// Swing (rad), pull on the tip (N, load axes) and unit vector from root to tip (load axes)
    /// at the pose that was evaluated last.
    last_swing: Numbers,
    pub last_pull: Vectors,
    last_direction: Vectors,
}

/// Sums over springs in load axes: the parts of a [`Reaction`].
#[derive(Clone, Copy, Default)]
pub(super) struct Sums {
    energy: Numbers,
    pull: Vectors,
    moment: Numbers,
    stiffness: [Numbers; 3],
    mixed: Vectors,
    angular: Numbers,
}

impl Block {
    /// Puts a spring into lane `k`, without stiffness if it does not act. `bearing` is the unit
    /// vector along the undeformed spring (load axes).
    pub fn set_spring(&mut self, k: usize, spring: &PolarSpring, bearing: Vec2, acts: bool) {
        self.root.set_lane(k, spring.root);
        self.bearing.set_lane(k, bearing);
        let stiffness = |value: f64| if acts { value } else { 0.0 };
        self.rest_length.as_mut_array()[k] = spring.rest_length;
        self.least_stretch.as_mut_array()[k] = spring.law.least_stretch();
        self.shortest.as_mut_array()[k] = if acts { (SHORTEST_LENGTH * spring.rest_length).max(f64::MIN_POSITIVE) } else { -1.0 };
        self.radial.as_mut_array()[k] = stiffness(spring.radial_stiffness);
        self.torsional.as_mut_array()[k] = stiffness(spring.torsional_stiffness);
    }

    /// Puts tip and swing of an attachment into lane `k`.
    pub fn set_attachment(&mut self, k: usize, attachment: &Attachment) {
        self.tip.set_lane(k, attachment.tip);
        self.swing.as_mut_array()[k] = attachment.swing;
        self.turns.as_mut_array()[k] = whole_turns(attachment.swing);
    }

    /// Sets the accepted direction to that of the accepted swing.
    pub fn aim(&mut self) {
        let directions = self.swing.to_array().map(direction);
        let [cos, sin] = [directions.map(|turn| turn.x), directions.map(|turn| turn.y)].map(Numbers::new);
        self.accepted_direction = self.bearing.turned(cos, sin);
    }

    /// Adds the reactions at a place, with second derivatives where it is `CURVED`, and keeps
    /// swings and pulls. Returns `false`, and adds nothing, when a spring is too short to have a
    /// direction.
    #[inline]
    pub fn add_to<const CURVED: bool>(&mut self, sums: &mut Sums, at: &Place, swings: Swings) -> bool {
        // From world axes to load axes.
        let (cos, sin) = (Numbers::splat(at.turn.m11), Numbers::splat(-at.turn.m21));
        let arm = self.tip.less(Vectors::splat(at.pose.position)).turned(cos, sin);
        let d = arm.less(self.root);
        let length = d.dot(d).sqrt();
        if length.simd_le(self.shortest).any() {
            return false;
        }
        let inverse = Numbers::ONE / length;
        let (e_x, e_y) = (d.x * inverse, d.y * inverse);
        let swing = if swings == Swings::Given { self.swing } else { self.swing_of(d) };
        let from_rest = length - self.rest_length;
        let stretch = from_rest.fast_max(self.least_stretch);
        let (radial_pull, torsion) = (self.radial * stretch, self.torsional * inverse);
        let torsional_pull = torsion * swing;
        let pull = Vectors { x: radial_pull * e_x - torsional_pull * e_y, y: radial_pull * e_y + torsional_pull * e_x };
        (self.last_swing, self.last_pull, self.last_direction) = (swing, pull, Vectors { x: e_x, y: e_y });
        // How the tip moves in load axes when the load turns: minus a quarter turn of its arm.
        let by_turn = Vectors { x: arm.y, y: -arm.x };
        sums.energy += self.radial * stretch * stretch + self.torsional * swing * swing;
        sums.pull.x += pull.x;
        sums.pull.y += pull.y;
        sums.moment += pull.dot(by_turn);
        if !CURVED {
            return true;
        }
        // A rope has no stiffness while it is slack.
        let radial = self.radial & from_rest.simd_ge(self.least_stretch);
        let across = (radial_pull + torsion) * inverse;
        let coupling = -torsional_pull * inverse;
        let (xx, yy, xy) = (e_x * e_x, e_y * e_y, e_x * e_y);
        let twice = coupling * (xy + xy);
        let stiffness =
            [radial * xx + across * yy - twice, radial * yy + across * xx + twice, (radial - across) * xy + coupling * (xx - yy)];
        let stiff_turn =
            Vectors { x: stiffness[0] * by_turn.x + stiffness[2] * by_turn.y, y: stiffness[2] * by_turn.x + stiffness[1] * by_turn.y };
        for (sum, entry) in sums.stiffness.iter_mut().zip(stiffness) {
            *sum += entry;
        }
        sums.mixed.x += pull.y - stiff_turn.x;
        sums.mixed.y -= pull.x + stiff_turn.y;
        sums.angular += by_turn.dot(stiff_turn) - pull.dot(arm);
        true
    }

    /// Polar angle of d less the bearing, on the branch of the accepted swing (rad).
    #[inline]
    fn swing_of(&mut self, d: Vectors) -> Numbers {
        let along = self.accepted_direction.dot(d);
        let tangent = self.accepted_direction.perp(d) / along;
        // Not a number is not small.
        if (tangent.abs().simd_le(Numbers::splat(SMALL_TANGENT)) & along.simd_gt(Numbers::ZERO)).all() {
            return self.swing + small_arctangent(tangent);
        }
        self.far_swing_of(d)
    }

    /// Swing at any distance from the accepted one (rad).
    #[cold]
    fn far_swing_of(&mut self, d: Vectors) -> Numbers {
        self.is_far = true;
        let principal = self.bearing.perp(d).atan2(self.bearing.dot(d));
        let swing = principal + self.turns;
        let (pi, whole) = (Numbers::splat(std::f64::consts::PI), Numbers::splat(std::f64::consts::TAU));
        let change = swing - self.swing;
        let turns = (change.simd_gt(pi) & whole) - ((-change).simd_gt(pi) & whole);
        swing - turns
    }

    /// Reaction by [`PolarSpring`], spring by spring, with derivatives in world axes.
    pub fn reaction_apart(&mut self, lanes: &[(PolarSpring, Attachment)], Place { pose, turn }: &Place) -> Reaction {
        let mut sum = Reaction::ZERO;
        for (k, (spring, _)) in lanes.iter().enumerate() {
            let shape = spring.shape(pose, &self.tip.lane(k), self.swing.to_array()[k]);
            sum.add(&spring.reaction(pose, &shape));
            self.last_swing.as_mut_array()[k] = shape.swing;
            self.last_direction.set_lane(k, direction(spring.bearing + shape.swing));
            self.last_pull.set_lane(k, turn.tr_mul(&spring.pull(pose, &shape)));
        }
        for k in lanes.len()..LANES {
            self.last_swing.as_mut_array()[k] = self.last_swing.to_array()[0];
            self.last_direction.set_lane(k, self.last_direction.lane(0));
            self.last_pull.set_lane(k, Vec2::zeros());
        }
        sum
    }

    /// Accepts tips and swings, and returns twice the work on the tips by the trapezoid rule (J)
    /// and the squared displacement of the tips (m^2).
    pub fn accept(&mut self, cos: Numbers, sin: Numbers) -> [Numbers; 2] {
        let pull = self.last_pull.turned(cos, sin);
        let displacement = self.tip.less(self.accepted_tip);
        let change = pull.less(self.accepted_pull);
        let sum = Vectors { x: pull.x + self.accepted_pull.x, y: pull.y + self.accepted_pull.y };
        let squared = displacement.dot(displacement);
        self.squared_error = change.dot(change) * squared;
        (self.accepted_tip, self.accepted_pull, self.accepted_direction) = (self.tip, pull, self.last_direction);
        self.swing = self.last_swing;
        let turned = Numbers::splat(std::f64::consts::PI);
        if self.swing.abs().simd_gt(turned).any() || self.turns.abs().simd_gt(turned).any() {
            self.turns = Numbers::new(self.swing.to_array().map(whole_turns));
        }
        let acts = self.shortest.simd_gt(Numbers::ZERO);
        [sum.dot(displacement), acts & squared]
    }

    /// Change of swing from the accepted pose to the one that was evaluated last (rad). A spring
    /// without a rest length has no direction, and of one without a pull it does not matter.
    #[cold]
    pub fn take_swung(&mut self) -> f64 {
        self.is_far = false;
        let has_direction = self.rest_length.simd_gt(Numbers::ZERO) & self.last_pull.dot(self.last_pull).simd_gt(Numbers::ZERO);
        let swung = (self.last_swing - self.swing).abs() & has_direction;
        swung.to_array().into_iter().fold(0.0, f64::max)
    }

    /// Change of the pulls times displacement of the tips on the way to the accepted pose (J).
    pub fn error(&self) -> Numbers {
        self.squared_error.sqrt()
    }
}

impl Sums {
    /// Energy with its derivatives by shifts along the axes of the load and by the heading. Second
    /// derivatives are zero where it is not `CURVED`.
    pub fn in_load<const CURVED: bool>(&self) -> Reaction {
        let pull = self.pull.sum();
        let first = Reaction {
            energy: 0.5 * self.energy.reduce_add(),
            gradient: Vec3::new(-pull.x, -pull.y, self.moment.reduce_add()),
            ..Reaction::ZERO
        };
        if !CURVED {
            return first;
        }
        let [xx, yy, xy] = self.stiffness.map(Numbers::reduce_add);
        let mixed = self.mixed.sum();
        let hessian = Mat3::new(
            xx,
            xy,
            mixed.x, //
            xy,
            yy,
            mixed.y, //
            mixed.x,
            mixed.y,
            self.angular.reduce_add(),
        );
        Reaction { hessian, ..first }
    }
}

/// Multiple of a whole turn from which `swing` differs by at most half a turn (rad).
fn whole_turns(swing: f64) -> f64 {
    if swing.abs() < std::f64::consts::PI {
        return 0.0;
    }
    (swing / std::f64::consts::TAU).round() * std::f64::consts::TAU
}
