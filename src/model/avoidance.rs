//! How a walker avoids barriers: it turns aside in time, and steps aside where it would overlap.
//!
//! `Deviation:` the paper's ants know no obstacles (Eq. 17-23). Here a walker is a disc about its
//! position, and two rules are added.
//!
//! 1. Sidestep: where a displacement would end in a barrier, it is replaced by the nearest one
//!    outside. This is Moreau's sweeping process: the velocity is projected onto those that keep
//!    the walker clear. A barrier that moves pushes the walker along.
//! 2. Turn: while the straight way to the target is blocked, the walker faces the tangent of what
//!    blocks it, inflated by the walker's radius. It takes the side of the smaller turn and keeps
//!    it until the way to the target is free, as in the tangent bug algorithm (Kamon, Rimon,
//!    Rivlin, "TangentBug: a range-sensor-based navigation algorithm", Int. J. Robotics Research
//!    17, 1998).
//!
//! The tangent is the first free direction on that side, up to the point where it touches. Inside
//! of a concave pocket it leads out along the pocket's wall. A walker that is closed in faces its
//! target and goes on against the barrier.

use std::f64::consts::{FRAC_PI_2, TAU};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::geometry::{Among, FirstContact, Piece};
use crate::math::{Vec2, rotation};

/// How walkers avoid obstacles and the load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Avoidance {
    /// Walkers pass through everything, as in the paper.
    #[default]
    None,
    /// Walkers turn aside before an obstacle, and step aside where they would overlap one, as ants
    /// can.
    Sidestep,
    /// Walkers turn aside before an obstacle and stop where they would overlap one, as robots with
    /// wheels do. Only what moves pushes them aside.
    Turn,
}

/// Side on which a walker passes a barrier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The walker turns left, counter-clockwise.
    Left,
    /// The walker turns right.
    Right,
}

/// A disc that walks among barriers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walker {
    /// Radius of the disc (m).
    pub radius: f64,
    /// Distance at which a walker begins to turn aside (m).
    pub look_ahead: f64,
}

/// Share of the radius by which a walker may overlap a barrier that it touches (1): rounding must
/// not block one that walks along it.
const GRAZE: f64 = 1e-6;
/// Turns to the left and to the right that differ by less are equal (rad). It is far above
/// rounding.
const TIE: f64 = 1e-9;
/// Most tangents that are tried one after another (1); a walker beyond is closed in.
const MOST_TANGENTS: usize = 100;
/// Most barriers that are left one after another (1). Between two walls at a right angle two are
/// enough; the overlap shrinks by the squared cosine of the angle between walls.
const MOST_PUSHES: usize = 64;

impl Walker {
    /// First contact on the way along the unit vector `ahead` (m).
    fn first_contact(&self, among: Among, from: &Vec2, ahead: &Vec2, length: f64) -> Option<FirstContact> {
        among.first_contact(from, ahead, length, (1.0 - GRAZE) * self.radius)
    }

    /// Whether the straight way between two points is free.
    pub fn is_way_free(&self, among: Among, from: &Vec2, to: &Vec2) -> bool {
        let length = (to - from).norm();
        length == 0.0 || self.first_contact(among, from, &((to - from) / length), length).is_none()
    }

    /// Whether a walker at this point overlaps no barrier.
    pub fn is_clear(&self, among: Among, at: &Vec2) -> bool {
        among.deepest(at, (1.0 - GRAZE) * self.radius).is_none()
    }

    /// Direction in which a walker at `from` that faces `ahead` wants to go to reach a target, a
    /// vector of any length. The `side` is kept from tick to tick, and drawn where both are equal.
    pub fn desired(
        &self,
        among: Among,
        from: &Vec2,
        ahead: &Vec2,
        target: &Vec2,
        side: &mut Option<Side>,
        draw: impl FnOnce() -> Side,
    ) -> Vec2 {
        let straight = target - from;
        let distance = straight.norm();
        if distance == 0.0 {
            return straight;
        }
        let towards = straight / distance;
        // A walker that turns aside already looks as far as its target.
        let range = if side.is_some() { distance } else { distance.min(self.look_ahead) };
        let Some(contact) = self.first_contact(among, from, &towards, range) else {
            *side = None;
            return straight;
        };
        let around = |side: Side| self.tangent(among, from, &towards, &contact.piece, side);
        if let Some(kept) = *side {
            return around(kept).unwrap_or(straight);
        }
        let turn = |direction: &Vec2| ahead.perp(direction).atan2(ahead.dot(direction)).abs();
        let (chosen, direction) = match (around(Side::Left), around(Side::Right)) {
            (None, None) => return straight,
            (Some(left), None) => (Side::Left, left),
            (None, Some(right)) => (Side::Right, right),
            (Some(left), Some(right)) => {
                let more = turn(&left) - turn(&right);
                let chosen = if more.abs() < TIE {
                    draw()
                } else if more < 0.0 {
                    Side::Left
                } else {
                    Side::Right
                };
                (chosen, if chosen == Side::Left { left } else { right })
            }
        };
        *side = Some(chosen);
        direction
    }

    /// First direction on a side of `towards` that is free up to the point where it touches what
    /// blocks it, a unit vector; `None` for a walker that is closed in.
    fn tangent(&self, among: Among, from: &Vec2, towards: &Vec2, blocking: &Piece, side: Side) -> Option<Vec2> {
        let sign = if side == Side::Left { 1.0 } else { -1.0 };
        let (mut piece, mut turned) = (*blocking, 0.0);
        for _ in 0..MOST_TANGENTS {
            let direction = rotation(sign * turned) * towards;
            let (turn, distance) = self.turn_past(&piece, from, &direction, sign);
            turned += turn.max(TIE);
            if turned > TAU {
                return None;
            }
            let direction = rotation(sign * turned) * towards;
            match self.first_contact(among, from, &direction, distance) {
                None => return Some(direction),
                Some(next) => piece = next.piece,
            }
        }
        None
    }

    /// Turn to one side of `direction` after which the way passes a piece (rad), and distance of
    /// the end that it touches (m).
    fn turn_past(&self, piece: &Piece, from: &Vec2, direction: &Vec2, sign: f64) -> (f64, f64) {
        let reach = self.radius + piece.rounding;
        let past = |end: &Vec2| {
            let to = end - from;
            let distance = to.norm();
            let aside = if distance > reach { (reach / distance).asin() } else { FRAC_PI_2 };
            (sign * direction.perp(&to).atan2(direction.dot(&to)) + aside, distance)
        };
        let [one, other] = piece.ends.each_ref().map(past);
        if one.0 >= other.0 { one } else { other }
    }

    /// Point nearest to `at` where a walker overlaps no barrier, found by leaving the deepest one
    /// again and again; `None` where it overlaps one after many of these pushes.
    pub fn pushed_out(&self, among: Among, at: &Vec2) -> Option<Vec2> {
        let mut at = *at;
        for _ in 0..MOST_PUSHES {
            let Some(gap) = among.deepest(&at, self.radius) else { return Some(at) };
            at += (self.radius - gap.distance) * gap.normal;
        }
        self.is_clear(among, &at).then_some(at)
    }

    /// Point where a walker arrives that steps from one point to another. It is the end of the step
    /// pushed out of all barriers, in pieces shorter than the walker, so that no wall is passed.
    pub fn stepped(&self, among: Among, from: &Vec2, to: &Vec2, avoidance: Avoidance) -> Option<Vec2> {
        let step = to - from;
        let length = step.norm();
        if avoidance == Avoidance::Turn && length > 0.0 {
            let contact = self.first_contact(among, from, &(step / length), length);
            let free = contact.map_or(1.0, |contact| (contact.distance / length).min(1.0));
            return self.pushed_out(among, &(from + free * step));
        }
        let n_pieces = (length / (0.5 * self.radius)).ceil().max(1.0);
        (0..n_pieces as usize).try_fold(*from, |at, _| self.pushed_out(among, &(at + step / n_pieces)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Pose, direction};
    use crate::model::geometry::{Barrier, Barriers, PlacedBarrier};
    use crate::model::{Outline, OutlinePart};

    const WALKER: Walker = Walker { radius: 0.002, look_ahead: 0.03 };

    fn still(barriers: &[PlacedBarrier]) -> Barriers {
        Barriers::new(barriers.to_vec(), Vec::new(), WALKER.radius)
    }

    fn disc(x: f64, y: f64, radius: f64) -> PlacedBarrier {
        PlacedBarrier::new(Barrier::of(&Outline::disc(radius)), &Pose::new(x, y, 0.3))
    }

    fn wall(list: &[[f64; 2]]) -> PlacedBarrier {
        let outline = Outline { parts: vec![OutlinePart::Polyline { points: list.iter().copied().map(Vec2::from).collect() }] };
        PlacedBarrier::new(Barrier::of(&outline), &Pose::new(0.0, 0.0, 0.0))
    }

    /// Desired direction (rad) of a walker at the origin that faces `facing` (rad).
    fn desired(barriers: &[PlacedBarrier], facing: f64, target: [f64; 2], side: &mut Option<Side>) -> f64 {
        let at = WALKER.desired(still(barriers).alone(), &Vec2::zeros(), &direction(facing), &target.into(), side, || Side::Right);
        at.y.atan2(at.x)
    }

    /// The tangent of a disc of radius r at the distance d is asin((r + b) / d) off its centre.
    #[test]
    fn the_tangent_of_a_post_is_that_of_the_inflated_disc() {
        let post = [disc(0.03, 0.0, 0.01)];
        let aside = (0.012f64 / 0.03).asin();
        for (facing, side, expected) in [(0.1, Side::Left, aside), (-0.1, Side::Right, -aside), (0.0, Side::Right, -aside)] {
            let mut found = None;
            // Rounding of angles of order one; the last one is drawn.
            assert!((desired(&post, facing, [0.1, 0.0], &mut found) - expected).abs() < 1e-12);
            assert_eq!(found, Some(side));
            // The side is kept, whatever the walker faces.
            assert!((desired(&post, -facing, [0.1, 0.0], &mut found) - expected).abs() < 1e-12);
            assert_eq!(found, Some(side));
        }
        // A target before the post, or a post beyond the look-ahead: 0.018 m to the contact.
        assert_eq!(desired(&post, 0.5, [0.017, 0.0], &mut None), 0.0);
        assert_eq!(desired(&[disc(0.043, 0.0, 0.01)], 0.5, [0.1, 0.0], &mut None), 0.0);
        assert!(desired(&[disc(0.0419, 0.0, 0.01)], 0.5, [0.1, 0.0], &mut None) > 0.2);
        // The side ends where the way is free.
        let mut side = Some(Side::Left);
        assert_eq!(desired(&post, 0.0, [0.0, 0.1], &mut side), 0.5 * std::f64::consts::PI);
        assert_eq!(side, None);
    }

    /// A hair above and below the width of the walker.
    #[test]
    fn a_gap_is_used_where_the_walker_fits() {
        for (width, fits) in [(0.00401, true), (0.00399, false)] {
            let gap = [wall(&[[0.01, -0.1], [0.01, -0.5 * width]]), wall(&[[0.01, 0.5 * width], [0.01, 0.1]])];
            assert_eq!(WALKER.is_way_free(still(&gap).alone(), &Vec2::zeros(), &Vec2::new(0.02, 0.0)), fits);
            let angle = desired(&gap, 0.1, [0.02, 0.0], &mut None);
            // The end of the wall is 84 degrees off.
            assert!(if fits { angle == 0.0 } else { angle > 1.4 }, "{angle}");
        }
    }

    /// A pocket of 40 mm x 40 mm, open behind the walker: the way out passes the end of an arm.
    #[test]
    fn the_way_out_of_a_pocket_leads_along_its_wall() {
        let pocket = [wall(&[[-0.02, 0.02], [0.02, 0.02], [0.02, -0.02], [-0.02, -0.02]])];
        let end = Vec2::new(-0.02, 0.02);
        let expected = 0.75 * std::f64::consts::PI + (0.002 / end.norm()).asin();
        let mut side = None;
        assert!((desired(&pocket, 0.1, [0.1, 0.0], &mut side) - expected).abs() < 1e-12);
        assert_eq!(side, Some(Side::Left));
        // A closed room has no way out.
        let room = [wall(&[[-0.02, 0.02], [0.02, 0.02], [0.02, -0.02], [-0.02, -0.02], [-0.02, 0.02]])];
        assert_eq!(desired(&room, 0.1, [0.1, 0.0], &mut None), 0.0);
    }

    #[test]
    fn steps_end_where_the_walker_is_clear() {
        let floor = [wall(&[[-1.0, 0.0], [1.0, 0.0]])];
        let from = Vec2::new(0.0, 0.002);
        let to = Vec2::new(3e-4, 0.002 - 4e-4);
        let slid = WALKER.stepped(still(&floor).alone(), &from, &to, Avoidance::Sidestep).unwrap();
        assert!((slid - Vec2::new(3e-4, 0.002)).norm() < 1e-17, "{slid}");
        // The contact is found within the share by which a walker may overlap what it touches.
        let stopped = WALKER.stepped(still(&floor).alone(), &from, &to, Avoidance::Turn).unwrap();
        assert!((stopped - from).norm() < GRAZE * WALKER.radius, "{stopped}");
        // A step as long as ten walkers does not pass the wall either.
        let far = WALKER.stepped(still(&floor).alone(), &from, &Vec2::new(0.0, -0.02), Avoidance::Sidestep).unwrap();
        assert!((far - from).norm() < 1e-17, "{far}");
        // In a corner of 90 degrees both walls hold.
        let corner = [wall(&[[-1.0, 0.0], [0.01, 0.0], [0.01, 1.0]])];
        let held = WALKER.stepped(still(&corner).alone(), &Vec2::new(0.0, 0.01), &Vec2::new(0.03, -0.02), Avoidance::Sidestep).unwrap();
        assert!((held - Vec2::new(0.008, 0.002)).norm() < 1e-15, "{held}");
        // What moves pushes both kinds.
        let pushed = WALKER.stepped(still(&[disc(-0.0105, 0.0, 0.01)]).alone(), &Vec2::zeros(), &Vec2::zeros(), Avoidance::Turn).unwrap();
        assert!((pushed - Vec2::new(0.0015, 0.0)).norm() < 1e-16, "{pushed}");
    }
}
