//! Many barriers to a disc: which of them it touches first, and how deep it lies in them.
//!
//! Boxes about the barriers that stand still, wider by the radius of the disc, are the leaves of a
//! tree. Barriers beyond their boxes are not looked at. What is found is the same without the tree,
//! to the bit: of equal distances, that of the barrier that comes first in the list counts.

use std::cell::Cell;

use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::math::Vector;
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};

use super::barrier::{FirstContact, Gap, PlacedBarrier};
use crate::math::Vec2;

/// Barriers to discs of one radius.
pub struct Barriers {
    placed: Vec<PlacedBarrier>,
    /// Indices of those that move, which are all looked at.
    moving: Vec<usize>,
    /// Boxes of the others.
    tree: Bvh,
}

/// Barriers, and perhaps one more, which comes last.
#[derive(Clone, Copy)]
pub struct Among<'a> {
    pub barriers: &'a Barriers,
    pub other: Option<&'a PlacedBarrier>,
}

/// Rounding of a coordinate in a frame over its size, times a hundred (1).
const ROUNDING: f64 = 1e-13;

impl Barriers {
    /// Barriers to discs of at most this `radius` (m). Those of the indices `moving` may be placed
    /// anew.
    pub fn new(placed: Vec<PlacedBarrier>, moving: Vec<usize>, radius: f64) -> Self {
        let still = placed.iter().enumerate().filter(|(index, _)| !moving.contains(index));
        let leaves: Vec<(usize, Aabb)> = still.filter_map(|(index, barrier)| Some((index, box_of(barrier, radius)?))).collect();
        let tree = Bvh::from_iter(BvhBuildStrategy::Binned, leaves);
        Self { placed, moving, tree }
    }

    /// One of those that move.
    pub fn moving(&mut self, index: usize) -> &mut PlacedBarrier {
        debug_assert!(self.moving.contains(&index));
        &mut self.placed[index]
    }

    /// These alone.
    pub fn alone(&self) -> Among<'_> {
        Among { barriers: self, other: None }
    }

    /// These and one more.
    pub fn with<'a>(&'a self, other: Option<&'a PlacedBarrier>) -> Among<'a> {
        Among { barriers: self, other }
    }
}

/// Box about a barrier, wider by the radius of a disc (m); `None` for one without parts.
fn box_of(barrier: &PlacedBarrier, radius: f64) -> Option<Aabb> {
    let [least, most] = barrier.bounds()?;
    let wider = radius + ROUNDING * (radius + least.amax().max(most.amax()));
    Some(Aabb::new(vector(&least.add_scalar(-wider)), vector(&most.add_scalar(wider))))
}

fn vector(v: &Vec2) -> Vector {
    Vector::new(v.x, v.y)
}

impl<'a> Among<'a> {
    /// Barriers that no box is about, with their places in the list.
    fn unboxed(self) -> impl Iterator<Item = (usize, &'a PlacedBarrier)> {
        let Barriers { placed, moving, .. } = self.barriers;
        moving.iter().map(|index| (*index, &placed[*index])).chain(self.other.map(|other| (usize::MAX, other)))
    }

    /// Barriers whose boxes a point lies in, and those without a box.
    fn about(self, at: &Vec2) -> impl Iterator<Item = (usize, &'a PlacedBarrier)> {
        let Barriers { placed, tree, .. } = self.barriers;
        let point = vector(at);
        let leaves = tree.leaves(move |node| {
            let (least, most) = (node.mins(), node.maxs());
            least.x <= point.x && point.x <= most.x && least.y <= point.y && point.y <= most.y
        });
        leaves.map(|index| (index as usize, &placed[index as usize])).chain(self.unboxed())
    }

    /// First contact of a disc of `radius` (m) about `from` that moves along the unit vector
    /// `ahead` by at most `length` (m).
    pub fn first_contact(self, from: &Vec2, ahead: &Vec2, length: f64, radius: f64) -> Option<FirstContact> {
        // The distance of the first contact, and the place of its barrier in the list.
        let (first, contact) = (Cell::new((f64::INFINITY, usize::MAX)), Cell::new(None));
        let look = |index: usize, barrier: &PlacedBarrier| {
            let found = barrier.first_contact(from, ahead, length, radius)?;
            if is_before((found.distance, index), first.get()) {
                first.set((found.distance, index));
                contact.set(Some(found));
            }
            // A box that is entered as late as the best contact is left out. One with a contact at
            // the same distance must be looked at.
            Some(found.distance.next_up())
        };
        self.unboxed().for_each(|(index, barrier)| {
            look(index, barrier);
        });
        let Barriers { placed, tree, .. } = self.barriers;
        let inverse = ahead.map(f64::recip);
        let entry = |node: &BvhNode, _best: f64| entry_into(node, from, &inverse);
        tree.find_best(length.min(first.get().0).next_up(), entry, |index, _best| look(index as usize, &placed[index as usize]));
        contact.get()
    }

    /// Gap to the barrier that a disc of `radius` (m) about a point lies deepest in; `None` where
    /// it overlaps none.
    pub fn deepest(self, at: &Vec2, radius: f64) -> Option<Gap> {
        let gaps = self.about(at).filter(|(_, barrier)| barrier.is_near(at, radius));
        let gaps = gaps.filter_map(|(index, barrier)| Some((index, barrier.gap(at)?))).filter(|(_, gap)| gap.distance < radius);
        let deeper = |a: &(usize, Gap), b: &(usize, Gap)| a.1.distance.total_cmp(&b.1.distance).then(a.0.cmp(&b.0));
        gaps.min_by(deeper).map(|(_, gap)| gap)
    }
}

/// Distance at which a ray enters a box, zero inside of it; infinite where it does not. The inverse
/// of its direction has infinite entries where it is parallel to sides.
///
/// The cast of parry2d divides for each box, and took a quarter of all instructions of ants among a
/// thousand walls.
fn entry_into(node: &BvhNode, from: &Vec2, inverse: &Vec2) -> f64 {
    let (least, most) = (node.mins(), node.maxs());
    let (mut enter, mut leave) = (0.0, f64::INFINITY);
    for (least, most, from, inverse) in [(least.x, most.x, from.x, inverse.x), (least.y, most.y, from.y, inverse.y)] {
        let (near, far) = if inverse >= 0.0 { (least, most) } else { (most, least) };
        // A ray along a side lies in the box: the product is no number there, and not compared.
        let (in_by, out_by) = ((near - from) * inverse, (far - from) * inverse);
        enter = if in_by > enter { in_by } else { enter };
        leave = if out_by < leave { out_by } else { leave };
    }
    if enter <= leave { enter } else { f64::INFINITY }
}

/// Whether a contact at a distance (m) with a barrier of an index comes before another one.
fn is_before(one: (f64, usize), other: (f64, usize)) -> bool {
    one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)).is_lt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Pose, RandomStreams, Stream, direction};
    use crate::model::geometry::Barrier;
    use crate::model::{Outline, OutlinePart};

    const RADIUS: f64 = 0.002;

    /// Posts, walls on a lattice that meet at their ends, and boxes, some of them turned.
    fn random_barriers(streams: &RandomStreams) -> Vec<PlacedBarrier> {
        let uniform = |number: u32, of: u64| streams.uniform(Stream::Scene, number, of);
        let lattice = |value: f64| (8.0 * value).floor() / 8.0;
        let one = |number: u32| {
            let [x, y] = [0, 1].map(|of| lattice(uniform(number, of)));
            let points = |list: &[[f64; 2]]| list.iter().copied().map(Vec2::from).collect();
            let (part, heading) = match number % 3 {
                0 => (OutlinePart::Disc { centre: Vec2::zeros(), radius: 0.01 + 0.02 * uniform(number, 2) }, 0.0),
                1 => (OutlinePart::Polyline { points: points(&[[0.0, 0.0], [0.125, 0.0], [0.125, 0.125]]) }, 0.0),
                _ => (
                    OutlinePart::Polygon { corners: points(&[[0.0, 0.0], [0.03, 0.0], [0.03, 0.01], [0.0, 0.01]]) },
                    6.0 * uniform(number, 3),
                ),
            };
            PlacedBarrier::new(Barrier::of(&Outline { parts: vec![part] }), &Pose::new(x, y, heading))
        };
        (0..60).map(one).collect()
    }

    /// The same with all barriers in the list of those that move.
    #[test]
    fn the_tree_changes_no_bit() {
        let (mut n_contacts, mut n_overlaps) = (0, 0);
        for case in 0..40 {
            let streams = RandomStreams::new(case);
            let placed = random_barriers(&streams);
            let other = placed[0].clone();
            let plain = Barriers::new(placed.clone(), (0..placed.len()).collect(), RADIUS);
            let fast = Barriers::new(placed, vec![7, 20], RADIUS);
            for number in 100..400 {
                let uniform = |of: u64| streams.uniform(Stream::Scene, number, of);
                // Every third one starts on the lattice and goes along it, where walls meet.
                let is_on_lattice = number % 3 == 0;
                let place = |value: f64| if is_on_lattice { (8.0 * value).floor() / 8.0 } else { value };
                let from = Vec2::new(place(uniform(0)), place(uniform(1)));
                let angle = if is_on_lattice { std::f64::consts::FRAC_PI_4 * (8.0 * uniform(2)).floor() } else { 7.0 * uniform(2) };
                let of = |barriers: &Barriers| {
                    let among = barriers.with((number % 2 == 0).then_some(&other));
                    let reach = [0.5, 1.0][(number % 2) as usize] * RADIUS;
                    (among.first_contact(&from, &direction(angle), 0.2 * uniform(3), reach), among.deepest(&from, reach))
                };
                let (expected, found) = (of(&plain), of(&fast));
                assert_eq!(found, expected, "{case} {number}");
                n_contacts += u32::from(found.0.is_some());
                n_overlaps += u32::from(found.1.is_some());
            }
        }
        assert!(n_contacts > 1000 && n_overlaps > 300, "{n_contacts} {n_overlaps}");
    }
}
