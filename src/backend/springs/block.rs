//! Springs side by side: their law, lane by lane.

use super::attachments::Attachment;
use super::place::Place;
use crate::math::{LANES, Mat3, Numbers, SMALL_TANGENT, Vec2, Vec3, Vectors, direction, small_arctangent};
use crate::model::spring::SHORTEST_LENGTH;
use crate::model::{PolarSpring, Reaction};

/// Where swings come from.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Swings {
    /// From where the tips are.
    Found,
    /// As the attachments have them.
    Given,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block {
    root: Vectors,
    /// Unit vector along the undeformed spring (load axes).
    bearing: Vectors,
    rest_length: Numbers,
    /// Length at and below which a spring has no direction (m); negative in lanes beyond the last spring.
    shortest: Numbers,
    radial: Numbers,
    torsional: Numbers,
    /// Now (m, world).
    pub tip: Vectors,
    /// Swing at the accepted pose (rad), and its whole turns.
    pub swing: Numbers,
    turns: Numbers,
    /// Tip at the accepted pose (m, world), and the pull of its holder there (N, world).
    pub accepted_tip: Vectors,
    pub accepted_pull: Vectors,
    /// Unit vector from root to tip there (load axes).
    accepted_direction: Vectors,
    /// Square of the change of the pulls on the way there times the way of the tips (J^2).
    squared_error: Numbers,
    /// Swing (rad), pull of the holder (N, load axes) and unit vector from root to tip (load axes) at the last pose evaluated.
    swing_there: Numbers,
    pub pull_there: Vectors,
    direction_there: Vectors,
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
    /// `bearing` is the direction of the undeformed spring.
    pub fn set_spring(&mut self, k: usize, spring: &PolarSpring, bearing: Vec2, acts: bool) {
        self.root.set_lane(k, spring.root);
        self.bearing.set_lane(k, bearing);
        let stiffness = |value: f64| if acts { value } else { 0.0 };
        self.rest_length.as_mut_array()[k] = spring.rest_length;
        self.shortest.as_mut_array()[k] = if acts { (SHORTEST_LENGTH * spring.rest_length).max(f64::MIN_POSITIVE) } else { -1.0 };
        self.radial.as_mut_array()[k] = stiffness(spring.radial_stiffness);
        self.torsional.as_mut_array()[k] = stiffness(spring.torsional_stiffness);
    }

    pub fn set_grip(&mut self, k: usize, attachment: &Attachment) {
        self.tip.set_lane(k, attachment.tip);
        self.swing.as_mut_array()[k] = attachment.swing;
        self.turns.as_mut_array()[k] = whole_turns(attachment.swing);
    }

    /// Takes the direction that belongs to the accepted swing for that of the accepted pose.
    pub fn aim(&mut self) {
        let directions = self.swing.to_array().map(direction);
        let [cos, sin] = [directions.map(|turn| turn.x), directions.map(|turn| turn.y)].map(Numbers::new);
        self.accepted_direction = self.bearing.turned(cos, sin);
    }

    /// Adds the reactions at a place, second derivatives only if asked for, and keeps swings and pulls there; says no, and adds nothing, when a spring is too short to
    /// have a direction.
    #[inline]
    pub fn add_to<const CURVED: bool>(&mut self, sums: &mut Sums, at: &Place, swings: Swings) -> bool {
        // Back from the world's axes.
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
        let stretch = length - self.rest_length;
        let (radial_pull, torsion) = (self.radial * stretch, self.torsional * inverse);
        let torsional_pull = torsion * swing;
        let pull = Vectors { x: radial_pull * e_x - torsional_pull * e_y, y: radial_pull * e_y + torsional_pull * e_x };
        (self.swing_there, self.pull_there, self.direction_there) = (swing, pull, Vectors { x: e_x, y: e_y });
        // How the tip moves in load axes when the load turns: minus a quarter turn of its arm.
        let by_turn = Vectors { x: arm.y, y: -arm.x };
        sums.energy += self.radial * stretch * stretch + self.torsional * swing * swing;
        sums.pull.x += pull.x;
        sums.pull.y += pull.y;
        sums.moment += pull.dot(by_turn);
        if !CURVED {
            return true;
        }
        let across = (radial_pull + torsion) * inverse;
        let coupling = -torsional_pull * inverse;
        let (xx, yy, xy) = (e_x * e_x, e_y * e_y, e_x * e_y);
        let twice = coupling * (xy + xy);
        let stiffness = [
            self.radial * xx + across * yy - twice,
            self.radial * yy + across * xx + twice,
            (self.radial - across) * xy + coupling * (xx - yy),
        ];
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
    fn swing_of(&self, d: Vectors) -> Numbers {
        let along = self.accepted_direction.dot(d);
        let tangent = self.accepted_direction.perp(d) / along;
        // Not a number is not small.
        if (tangent.abs().simd_le(Numbers::splat(SMALL_TANGENT)) & along.simd_gt(Numbers::ZERO)).all() {
            return self.swing + small_arctangent(tangent);
        }
        self.far_swing_of(d)
    }

    /// The same however far it is from the accepted one.
    #[cold]
    fn far_swing_of(&self, d: Vectors) -> Numbers {
        let principal = self.bearing.perp(d).atan2(self.bearing.dot(d));
        let swing = principal + self.turns;
        let (pi, whole) = (Numbers::splat(std::f64::consts::PI), Numbers::splat(std::f64::consts::TAU));
        let change = swing - self.swing;
        let turns = (change.simd_gt(pi) & whole) - ((-change).simd_gt(pi) & whole);
        swing - turns
    }

    /// The same by [`PolarSpring`], spring by spring, with derivatives in world axes.
    pub fn reaction_apart(&mut self, lanes: &[(PolarSpring, Attachment)], Place { pose, turn }: &Place) -> Reaction {
        let mut sum = Reaction::ZERO;
        for (k, (spring, _)) in lanes.iter().enumerate() {
            let shape = spring.shape(pose, &self.tip.lane(k), self.swing.to_array()[k]);
            sum.add(&spring.reaction(pose, &shape));
            self.swing_there.as_mut_array()[k] = shape.swing;
            self.direction_there.set_lane(k, direction(spring.bearing + shape.swing));
            self.pull_there.set_lane(k, turn.tr_mul(&spring.pull(pose, &shape)));
        }
        for k in lanes.len()..LANES {
            self.swing_there.as_mut_array()[k] = self.swing_there.to_array()[0];
            self.direction_there.set_lane(k, self.direction_there.lane(0));
            self.pull_there.set_lane(k, Vec2::zeros());
        }
        sum
    }

    /// Twice the work of the holders by the trapezoid rule (J), and the squared way of the tips (m^2).
    pub fn accept(&mut self, cos: Numbers, sin: Numbers) -> [Numbers; 2] {
        let pull = self.pull_there.turned(cos, sin);
        let way = self.tip.less(self.accepted_tip);
        let change = pull.less(self.accepted_pull);
        let sum = Vectors { x: pull.x + self.accepted_pull.x, y: pull.y + self.accepted_pull.y };
        let squared_way = way.dot(way);
        self.squared_error = change.dot(change) * squared_way;
        (self.accepted_tip, self.accepted_pull, self.accepted_direction) = (self.tip, pull, self.direction_there);
        self.swing = self.swing_there;
        let turned = Numbers::splat(std::f64::consts::PI);
        if self.swing.abs().simd_gt(turned).any() || self.turns.abs().simd_gt(turned).any() {
            self.turns = Numbers::new(self.swing.to_array().map(whole_turns));
        }
        let acts = self.shortest.simd_gt(Numbers::ZERO);
        [sum.dot(way), acts & squared_way]
    }

    /// The change of the pulls times the way of the tips to the accepted pose (J).
    pub fn error(&self) -> Numbers {
        self.squared_error.sqrt()
    }
}

impl Sums {
    /// Energy and its derivatives by shifts along the load's axes and by the heading, the second ones only where they were summed.
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

/// The multiple of a whole turn in `swing` (rad) whose rest lies within half a turn.
fn whole_turns(swing: f64) -> f64 {
    if swing.abs() < std::f64::consts::PI {
        return 0.0;
    }
    (swing / std::f64::consts::TAU).round() * std::f64::consts::TAU
}
